/* SPDX-License-Identifier: MIT */
/* The common metric against closed forms. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "metric.h"

#include <cmocka.h> /* last: it makes fail a macro */

static const double pi = 3.14159265358979323846;

/* A source whose reflected radiance (f_r x cosine) is one number wherever the light is above the horizon. */
typedef struct flat_source {
    brdf base;
    double value;
    int holes; /* no data left of the middle of the light's frame */
} flat_source;

static int flat_cosine(const brdf *b, const double to_light[3], const double to_eye[3], double out[3])
{
    const flat_source *s = (const flat_source *)b;
    (void)to_eye;
    int hole = s->holes && to_light[2] < 0.5;
    out[0] = out[1] = out[2] = hole ? 0 : s->value;
    return !hole;
}

static int flat_eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    int valid = flat_cosine(b, to_light, to_eye, f_r);
    for (int k = 0; k < 3; k++) f_r[k] /= to_light[2];
    return valid;
}

static void no_close(brdf *b)
{
    (void)b;
}

static flat_source flat(double value)
{
    flat_source s = {.base = {.eval = flat_eval, .eval_cosine = flat_cosine, .close = no_close, .name = "flat"},
                     .value = value};
    return s;
}

static int lambert_eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    (void)b;
    (void)to_light;
    (void)to_eye;
    f_r[0] = 0.8 / pi;
    f_r[1] = 0.4 / pi;
    f_r[2] = 0.1 / pi;
    return 1;
}

static const brdf lambert = {.eval = lambert_eval, .close = no_close, .name = "lambert"};

/* Disc pixels of a frame, and how many of them the light at phi reaches, counted in integers where that is exact. */
static int count_pixels(int size, double phi_deg, int *lit)
{
    int disc = 0;
    *lit = 0;
    for (int j = 0; j < size; j++)
        for (int i = 0; i < size; i++) {
            int a = 2 * i + 1 - size, b = size - 2 * j - 1;
            if (a * a + b * b >= size * size) continue;
            disc++;
            double x = (double)a / size, z = sqrt(1 - x * x - (double)b * b / size / size);
            *lit += x * sin(phi_deg * pi / 180) + z * cos(phi_deg * pi / 180) > 0;
        }
    return disc;
}

static void normals_fill_the_disc(void **state)
{
    (void)state;
    double n[3];
    int disc = 0, lit;
    for (int j = 0; j < 96; j++)
        for (int i = 0; i < 96; i++) {
            if (!metric_normal(i, j, 96, n)) continue;
            disc++;
            assert_true(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-14);
        }
    assert_int_equal(disc, count_pixels(96, 0, &lit));
    assert_false(metric_normal(0, 0, 96, n));
    assert_true(metric_normal(72, 24, 96, n)); /* right of the middle and above it */
    assert_true(fabs(n[0] - 49.0 / 96) < 1e-15 && fabs(n[1] - 47.0 / 96) < 1e-15 && n[2] > 0);
}

static void local_frame_keeps_angles(void **state)
{
    (void)state;
    static const double normal[4][3] = {{0, 0, 1}, {0.6, 0, 0.8}, {-0.48, 0.6, 0.64}, {1, 0, 0}};
    for (int i = 0; i < 4; i++)
        for (double phi = 0; phi <= 180; phi += 7.5) {
            double l[3], v[3], s = sin(phi * pi / 180), c = cos(phi * pi / 180);
            metric_local(normal[i], phi, l, v);
            assert_true(fabs(l[0] * l[0] + l[1] * l[1] + l[2] * l[2] - 1) < 1e-12);
            assert_true(fabs(l[0] * v[0] + l[1] * v[1] + l[2] * v[2] - c) < 1e-12);
            assert_true(fabs(l[2] - s * normal[i][0] - c * normal[i][2]) < 1e-12);
            assert_true(fabs(v[2] - normal[i][2]) < 1e-12);
        }
    double l[3], v[3];
    metric_local(normal[0], 30, l, v); /* at the middle of the disc the frame is the view's own */
    assert_true(fabs(l[0] - 0.5) < 1e-12 && fabs(l[1]) < 1e-12 && v[2] == 1);
}

/* L = scale x albedo x n.l, through the published constants of the curve, within the rounding of a code. */
static void lambert_frame_is_its_cosine(void **state)
{
    (void)state;
    static const double albedo[3] = {0.8, 0.4, 0.1};
    image_u8 frame;
    metric_frame(&lambert, 60, 1.5, 32, &frame);
    for (int j = 0; j < 32; j++)
        for (int i = 0; i < 32; i++)
            for (int k = 0; k < 3; k++) {
                double x = (i + 0.5) / 16 - 1, y = 1 - (j + 0.5) / 16, z2 = 1 - x * x - y * y, code = 0;
                double n_dot_l = z2 > 0 ? x * sqrt(0.75) + sqrt(z2) / 2 : 0;
                double radiance = fmin(1, fmax(0, 1.5 * albedo[k] * n_dot_l));
                code = 255 * (radiance <= 0.0031308 ? 12.92 * radiance : 1.055 * pow(radiance, 1 / 2.4) - 0.055);
                assert_true(fabs(frame.texel[3 * (j * 32 + i) + k] - code) < 0.5001);
            }
    image_u8_free(&frame);
}

static void errors_of_known_pairs(void **state)
{
    (void)state;
    image_u8 a = image_u8_make(96, 96, 3), b = image_u8_make(96, 96, 3);
    int lit, disc = count_pixels(96, 0, &lit);
    assert_true(metric_mse(&a, &b) == 0);
    memset(b.texel, 7, 96 * 96 * 3);
    assert_true(metric_mse(&a, &b) == 49);
    assert_true(metric_mse(&b, &a) == 49);
    memset(b.texel, 0, 96 * 96 * 3);
    b.texel[0] = 255; /* a corner is outside the disc */
    assert_true(metric_mse(&a, &b) == 0);
    b.texel[3 * (48 * 96 + 48) + 1] = 30; /* one channel of one pixel */
    assert_true(fabs(metric_mse(&a, &b) - 900.0 / (3.0 * disc)) < 1e-12);
    image_u8_free(&a);
    image_u8_free(&b);
}

static void psnr_of_known_errors(void **state)
{
    (void)state;
    assert_true(metric_psnr(0) == 99);
    assert_true(metric_psnr(1e-12) == 99); /* nothing is better than equal */
    assert_true(fabs(metric_psnr(65025) - 0) < 1e-12);
    assert_true(fabs(metric_psnr(1) - 48.130803608679) < 1e-9); /* 20 log10 255 */
    assert_true(fabs(metric_psnr(100) - 28.130803608679) < 1e-9);
}

static void equal_sources_give_99(void **state)
{
    (void)state;
    metric_result r;
    metric_compare(&lambert, &lambert, 0, &r);
    assert_true(r.pooled_psnr_db == 99 && r.worst_frame_db == 99);
    metric_compare(&lambert, &lambert, 2, &r);
    assert_true(r.pooled_psnr_db == 99);
}

/* Truth of one code on every lit pixel, an approximation some codes brighter: all figures follow from pixel counts. */
static void expect_constant_difference(double stops)
{
    flat_source truth = flat(0.05);
    double scale = brdf_exposure(&truth.base) * exp2(-stops), sum = 0, worst = 1e9;
    double code = floor(255 * (1.055 * pow(pi * scale * 0.05, 1 / 2.4) - 0.055) + 0.5) + 3, worst_deg = -1;
    flat_source other = flat(pow((code / 255 + 0.055) / 1.055, 2.4) / (pi * scale));
    metric_result r;
    metric_compare(&truth.base, &other.base, stops, &r);
    for (int k = 0; k < METRIC_FRAMES; k++) {
        int lit, disc = count_pixels(96, 5.0 * k, &lit);
        double mse = 9.0 * lit / disc, db = lit ? 10 * log10(65025 / mse) : 99;
        assert_true(fabs(r.frame_db[k] - db) < 0.01); /* pixels at the very terminator may fall on either side */
        sum += mse;
        if (db < worst) worst_deg = 5.0 * k;
        worst = fmin(worst, db);
    }
    assert_true(fabs(r.pooled_psnr_db - 10 * log10(65025 * METRIC_FRAMES / sum)) < 0.001);
    assert_true(fabs(r.worst_frame_db - worst) < 1e-9 && r.worst_frame_deg == worst_deg);
}

static void constant_difference(void **state)
{
    (void)state;
    expect_constant_difference(0);
}

static void constant_difference_two_stops_down(void **state)
{
    (void)state;
    expect_constant_difference(2);
}

/* Where the truth has no data it counts as black, and an approximation that draws something there is charged for it. */
static void holes_count_as_black(void **state)
{
    (void)state;
    flat_source truth = flat(0.05), filled = flat(0.05);
    truth.holes = 1;
    double scale = brdf_exposure(&truth.base);
    double code = floor(255 * (1.055 * pow(pi * scale * 0.05, 1 / 2.4) - 0.055) + 0.5);
    metric_result r;
    metric_compare(&truth.base, &filled.base, 0, &r);
    int disc = 0, hole = 0; /* at phi = 0: n.l = z < 1/2 */
    for (int j = 0; j < 96; j++)
        for (int i = 0; i < 96; i++) {
            int squared = (2 * i - 95) * (2 * i - 95) + (2 * j - 95) * (2 * j - 95);
            disc += squared < 96 * 96;
            hole += squared < 96 * 96 && 4 * squared > 3 * 96 * 96;
        }
    assert_true(fabs(r.frame_db[0] - 10 * log10(65025 / (code * code * hole / disc))) < 0.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_fill_the_disc),       cmocka_unit_test(local_frame_keeps_angles),
        cmocka_unit_test(lambert_frame_is_its_cosine), cmocka_unit_test(errors_of_known_pairs),
        cmocka_unit_test(psnr_of_known_errors),        cmocka_unit_test(equal_sources_give_99),
        cmocka_unit_test(constant_difference),         cmocka_unit_test(constant_difference_two_stops_down),
        cmocka_unit_test(holes_count_as_black),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
