/* SPDX-License-Identifier: MIT */
/* Quartered spheres: coordinates in closed form, a decoding of our own from the texels, what the symmetry promises, set-up in
   integers, accuracy. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* before cmocka.h, which defines a macro fail() */
#include "brdf_kit.h"
#include "metric.h"
#include "nacre_asset.h"
#include "quarter_fit.h"
#include "shade.h"
#include "sphere_bake.h"

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* ---- coordinates ---------------------------------------------------------------------------- */

static void places(void **state)
{
    (void)state;
    /* log2(8 x + 1) / log2(9): 1/8 is log_9 of 2, 1/4 is half-way, for 8/4 + 1 = 3 */
    assert_float_equal(quarter_place(0), 0, 1e-15);
    assert_float_equal(quarter_place(0.125), log(2) / log(9), 1e-12);
    assert_float_equal(quarter_place(-0.25), 0.5, 1e-12);
    assert_float_equal(quarter_place(1), 1, 1e-12);
    for (int i = 0; i <= 100; i++) assert_float_equal(quarter_place(quarter_unplace(i / 100.0)), i / 100.0, 1e-12);
    /* l.h is the cosine of half the angle between light and eye */
    for (int deg = 0; deg < 180; deg += 7) assert_float_equal(quarter_step(deg), sqrt(1 - cos(deg * pi / 360)), 1e-7);
    for (int count = 2; count <= 16; count++) {
        assert_float_equal(quarter_polar(0, count), 0, 1e-9);
        assert_float_equal(quarter_polar(count - 1, count), 165, 1e-9);
        for (int i = 1; i < count; i++) assert_true(quarter_polar(i, count) > quarter_polar(i - 1, count) + 1);
    }
}

/* ---- f_r is constant: everything is known --------------------------------------------------- */

static void lambert(void **state)
{
    (void)state;
    sphere_asset s = bake_spheres("lambert:albedo=.5", NULL);
    assert_int_equal(s.size, 32);
    assert_int_equal(s.layers, 6);
    assert_int_equal(s.levels, 1);
    assert_int_equal(s.format, NACRE_FORMAT_RGB8);
    assert_int_equal(s.level[0].size, 6 * 32 * 32 * 3);
    brdf *d = sphere_brdf(&s, NULL);
    uint32_t seed = 7;
    for (int i = 0; i < 4000; i++) {
        double l[3], v[3], f[3];
        random_direction(&seed, l);
        random_direction(&seed, v);
        double dot = l[0] * v[0] + l[1] * v[1] + l[2] * v[2];
        if (dot < -0.5) continue; /* towards the last images l.h, and with it the code, falls ever faster */
        d->eval(d, l, v, f);
        /* fourth roots of l.h are blended linearly in s between images, and a code is 1.6 % of f_r */
        for (int c = 0; c < 3; c++) assert_float_equal(f[c], 0.5 / pi, 0.05 * 0.5 / pi);
    }
    brdf_close(d);
    sphere_free(&s);
}

/* ---- a second decoder ----------------------------------------------------------------------- */

static double texel(const sphere_asset *s, int layer, int i, int j, int c)
{
    return s->level[0]
               .data[3 * (((size_t)layer * (size_t)s->size + (size_t)j) * (size_t)s->size + (size_t)i) + (size_t)c] /
           255.0;
}

/* From Rusinkiewicz angles: x = sin(theta_h) cos(phi_d), y = sin(theta_h) sin(phi_d), in the frame where l - v lies along
   phi_d = 0; theta_d gives the images. */
static void reference_eval(const sphere_asset *s, double theta_h, double theta_d, double phi_d, double f_r[3])
{
    double at[2] = {fabs(sin(theta_h) * cos(phi_d)), fabs(sin(theta_h) * sin(phi_d))}, part[2];
    int low[2], image = 0;
    for (int k = 0; k < 2; k++) {
        double u = log(8 * at[k] + 1) / log(9) * (s->size - 1);
        low[k] = (int)floor(u) < s->size - 1 ? (int)floor(u) : s->size - 2;
        part[k] = u - low[k];
    }
    double step = sqrt(1 - cos(theta_d)), before = 0, after = 0;
    for (image = 0; image < s->layers - 1; image++) {
        before = sqrt(1 - cos(s->polar[image] * pi / 360));
        after = sqrt(1 - cos(s->polar[image + 1] * pi / 360));
        if (step < after || image == s->layers - 2) break;
    }
    double t = fmin(fmax((step - before) / (after - before), 0), 1);
    for (int c = 0; c < 3; c++) {
        double code = 0;
        for (int n = 0; n < 8; n++) {
            double w = (n & 1 ? part[0] : 1 - part[0]) * (n & 2 ? part[1] : 1 - part[1]) * (n & 4 ? t : 1 - t);
            code += w * texel(s, image + (n >> 2), low[0] + (n & 1), low[1] + (n >> 1 & 1), c);
        }
        f_r[c] = s->scale[c] * pow(code, 4) / (pi * cos(theta_d));
    }
}

static void agrees_with_second_decoder(void **state)
{
    (void)state;
    const sphere_options cases[] = {
        {.size = 32}, {.size = 12, .images = 2}, {.size = 17, .polar = {20, 60, 150}, .polar_count = 3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sphere_asset s = bake_spheres("sgd:gold-metallic-paint", &cases[k]);
        brdf *d = sphere_brdf(&s, NULL);
        uint32_t seed = 11;
        int used = 0;
        for (int i = 0; i < 8000; i++) {
            double theta_h = pi / 2 * random_unit(&seed), theta_d = 1.5 * random_unit(&seed);
            double phi_d = 2 * pi * random_unit(&seed), l[3], v[3], found[3], expected[3];
            half_to_directions(theta_h, theta_d, phi_d, l, v);
            if (l[2] < 0.01 || v[2] < 0.01 || theta_d < 0.01) continue;
            used++;
            assert_int_equal(d->eval(d, l, v, found), 1);
            reference_eval(&s, theta_h, theta_d, phi_d, expected);
            for (int c = 0; c < 3; c++)
                if (fabs(found[c] - expected[c]) > 1e-6 * (1 + expected[c]))
                    fail_msg("case %zu pair %d channel %d: found %g, expected %g", k, i, c, found[c], expected[c]);
        }
        assert_true(used > 1500);
        brdf_close(d);
        sphere_free(&s);
    }
}

/* Exchanging light and eye, and mirroring at their plane, change nothing: to the last bit but for rounding of angles. */
static void reciprocal_and_mirrored(void **state)
{
    (void)state;
    sphere_asset s = bake_spheres("sgd:brass", &(sphere_options){.size = 16});
    brdf *d = sphere_brdf(&s, NULL);
    uint32_t seed = 5;
    for (int i = 0; i < 2000; i++) {
        double l[3], v[3], f[3], swapped[3], mirrored[3];
        random_direction(&seed, l);
        random_direction(&seed, v);
        d->eval(d, l, v, f);
        d->eval(d, v, l, swapped);
        const double lm[3] = {l[0], -l[1], l[2]}, vm[3] = {v[0], -v[1], v[2]};
        d->eval(d, lm, vm, mirrored);
        for (int c = 0; c < 3; c++) {
            assert_float_equal(f[c], swapped[c], 1e-9 * (1 + f[c]));
            assert_float_equal(f[c], mirrored[c], 1e-9 * (1 + f[c]));
        }
    }
    brdf_close(d);
    sphere_free(&s);
}

/* ---- set-up in integers --------------------------------------------------------------------- */

/* Rows, images and weight against the formulas in double, light by light. */
static void set_up(void **state)
{
    (void)state;
    shade_material m = {.model = NACRE_MODEL_SPHERES};
    double polar[6];
    m.is.spheres.layers = 6;
    m.is.spheres.size = 32;
    for (int i = 0; i < 6; i++) {
        m.is.spheres.polar_bam[i] = (uint16_t)(quarter_polar(i, 6) * 32768 / 180 + 0.5);
        polar[i] = m.is.spheres.polar_bam[i] * 180 / 32768.0;
    }
    for (int i = 0; i < 3; i++) m.is.spheres.scale[i] = 65536;
    for (int deg = 5; deg < 175; deg += 10)
        for (int azimuth = 0; azimuth < 360; azimuth += 45) {
            double p = deg * pi / 180, a = azimuth * pi / 180, weight, half = p / 2;
            nacre_light light = {.power = {65536, 65536, 65536}};
            light.direction = nacre_dir_from_float((float)(sin(p) * cos(a)), (float)(sin(p) * sin(a)), (float)cos(p));
            nacre_view view = {.lights = &light, .light_count = 1};
            const nacre_q16 centre[3] = {0, 0, 0};
            shade_frame frame;
            for (int i = 0; i < 16; i += 5) view.object_to_view.m[i] = view.view_to_clip.m[i] = 65536;
            shade_setup(&frame, &view, centre, &m, SHADE_ROOT, 0, 2);
            const shade_quarter_setup *s = &frame.light[0].is.quarter;
            /* x along l - v, y across, h between */
            const double x[3] = {cos(half) * cos(a), cos(half) * sin(a), -sin(half)}, y[3] = {-sin(a), cos(a), 0};
            for (int k = 0; k < 3; k++) {
                assert_float_equal(s->x_q28[k] / 268435456.0, x[k], 2e-4); /* q14 directions */
                assert_float_equal(s->y_q28[k] / 268435456.0, y[k],
                                   1e-3); /* near the eye they say less of the azimuth */
                /* factor: scale / l.h at power 1 and exposure 1, pi f_r = scale code^4 / l.h */
                double root4 = ldexp(s->root4[k].m, s->root4[k].e);
                assert_float_equal(pow(root4, 4) * pi, 1 / cos(half), 0.02 / cos(half));
            }
            int layer = quarter_pair(polar, 6, quarter_step(deg), &weight);
            if (fabs(weight) > 0.01 && fabs(weight - 1) > 0.01) {
                assert_int_equal(s->layer, layer);
                assert_float_equal(s->weight_q28 / 268435456.0, weight, 2e-3);
            }
            /* the first and the last texel's centre of image 0 */
            const shade_quarter_draw *d = &frame.is.quarter;
            double scale = d->scale_q28[0] / 268435456.0, bias = d->bias_q28[0] / 268435456.0;
            assert_float_equal(scale * log2(0.125) + bias, 0.5 / 32, 1e-6);
            assert_float_equal(scale * log2(1.125) + bias, 31.5 / 32, 1e-6);
            assert_float_equal(d->scale_q28[1] / 268435456.0 * log2(1.125) + d->bias_q28[1] / 268435456.0, 31.5 / 192,
                               1e-6);
            assert_float_equal(d->step_q28 / 268435456.0, 1.0 / 6, 1e-8);
            /* persp: the ramps add up to the image's number */
            double number = 0, wanted = layer + weight, step = quarter_step(deg);
            for (int i = 0; i < SHADE_MAX_QUARTERS; i++)
                number += fmin(
                    fmax(ldexp(d->ramp[i][0].m, d->ramp[i][0].e) * step + ldexp(d->ramp[i][1].m, d->ramp[i][1].e), 0),
                    1);
            assert_float_equal(number, wanted, 1e-4);
        }
}

/* ---- accuracy ------------------------------------------------------------------------------- */

/* More images, finer images and more bits are better; 18 KB of quarters beat 2 MB of whole spheres. */
static void accuracy(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        sphere_options options;
    } rows[] = {{"etc1", {.format = NACRE_FORMAT_ETC2_RGB8}},
                {"etc2", {.format = NACRE_FORMAT_ETC2_RGB8, .etc2 = 1}},
                {"rgb565", {.format = NACRE_FORMAT_RGB565}},
                {"rgb8", {.size = 32}},
                {"12 images", {.images = 12}}};
    enum { ROWS = sizeof rows / sizeof *rows };
    static const char *const names[] = {"sgd:gold-metallic-paint", "sgd:yellow-plastic"};
    for (int n = 0; n < 2; n++) {
        brdf *b = open_name(names[n]);
        double db[ROWS];
        for (int i = 0; i < ROWS; i++) {
            sphere_asset s = bake_spheres(names[n], &rows[i].options);
            brdf *d = sphere_brdf(&s, NULL);
            metric_result r;
            metric_compare(b, d, 0, &r);
            db[i] = r.pooled_psnr_db;
            print_message("%-26s %-10s %.2f dB\n", names[n], rows[i].what, db[i]);
            brdf_close(d);
            sphere_free(&s);
        }
        assert_true(db[0] >= 40 && db[1] > db[0] && db[3] > db[1] && db[3] > db[2] && db[4] > db[3]);
        assert_true(db[3] >= 47);
        brdf_close(b);
    }
}

static void deterministic(void **state)
{
    (void)state;
    assert_spheres_need_no_threads("sgd:chrome", &(sphere_options){.size = 16});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places),
        cmocka_unit_test(lambert),
        cmocka_unit_test(agrees_with_second_decoder),
        cmocka_unit_test(reciprocal_and_mirrored),
        cmocka_unit_test(set_up),
        cmocka_unit_test(accuracy),
        cmocka_unit_test(deterministic),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
