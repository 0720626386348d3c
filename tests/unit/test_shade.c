/* SPDX-License-Identifier: MIT */
/* Set-up values against the formulas in double: tables (nacre_asset.h), spheres (Mihalik & Durikovic 2015, eq. 1-4). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "shade.h"

#include <cmocka.h>

#define PI 3.14159265358979323846

static double q28(int32_t x)
{
    return x / 268435456.;
}

static double real(fx_real x)
{
    return ldexp(x.m, x.e);
}

/* |a - b| <= bound, with the place printed when not. */
#define NEAR(a, b, bound)                                                                                              \
    do {                                                                                                               \
        const double near_a = (a), near_b = (b);                                                                       \
        if (!(fabs(near_a - near_b) <= (bound))) {                                                                     \
            printf("line %d: %s = %.9g, expected %s = %.9g\n", __LINE__, #a, near_a, #b, near_b);                      \
            fail();                                                                                                    \
        }                                                                                                              \
    } while (0)

/* relative */
#define CLOSE(a, b, bound) NEAR(a, b, (bound)*fabs((double)(b)))

/* Factors go through eight logarithms of 2^-17 each, times at most 4.8. */
#define FACTOR_ERROR 2e-4
/* Directions come from q14 parts, but are normalised at full width. */
#define DIRECTION_ERROR 2e-8

static nacre_view plain_view(const nacre_light *lights, int count)
{
    static const nacre_mat4 identity = {{65536, 0, 0, 0, 0, 65536, 0, 0, 0, 0, 65536, 0, 0, 0, 0, 65536}};
    nacre_view view;

    memset(&view, 0, sizeof view);
    view.object_to_view = view.view_to_clip = identity;
    view.lights = lights;
    view.light_count = (uint8_t)count;
    return view;
}

static void make_perspective(nacre_view *view)
{
    view->view_to_clip.m[10] = -70000;
    view->view_to_clip.m[11] = -65536;
    view->view_to_clip.m[14] = -140000;
    view->view_to_clip.m[15] = 0;
}

static nacre_light light_at(double polar_deg, double azimuth_deg, double r, double g, double b)
{
    const double p = polar_deg * PI / 180, a = azimuth_deg * PI / 180;
    nacre_light light;

    memset(&light, 0, sizeof light);
    light.direction = nacre_dir_from_float((float)(sin(p) * cos(a)), (float)(sin(p) * sin(a)), (float)cos(p));
    light.power = nacre_rgb_from_float((float)r, (float)g, (float)b);
    return light;
}

/* The light's direction as stored, normalised. */
static void direction_of(const nacre_light *light, double l[3])
{
    const double x = light->direction.x, y = light->direction.y, z = light->direction.z;
    const double length = sqrt(x * x + y * y + z * z);

    l[0] = x / length;
    l[1] = y / length;
    l[2] = z / length;
}

static shade_material table_material(double power)
{
    shade_material m;

    memset(&m, 0, sizeof m);
    m.model = NACRE_MODEL_TABLE;
    m.albedo[0] = 32768;
    m.albedo[1] = 16384;
    m.albedo[2] = 0;
    m.is.table.e = nacre_q16_from_float(0.8f);
    m.is.table.ymax = nacre_q16_from_float(1.9f);
    m.is.table.w[0] = 12345;
    m.is.table.w[1] = -2345;
    m.is.table.p = nacre_q16_from_float((float)power);
    m.is.table.eps = 256;
    m.is.table.rows = 19661; /* 0.3 */
    m.is.table.width = m.is.table.image_width = 24;
    m.is.table.height = m.is.table.image_height = 21;
    return m;
}

static shade_material spheres_material(int paper)
{
    static const double polar[] = {0, 45, 90, 135};
    shade_material m;
    int i;

    memset(&m, 0, sizeof m);
    m.model = NACRE_MODEL_SPHERES;
    m.is.spheres.layers = 4;
    m.is.spheres.cosine = (uint8_t)paper;
    for (i = 0; i < 4; i++) m.is.spheres.polar_bam[i] = (uint16_t)(polar[i] * 65536 / 360);
    for (i = 0; i < 3; i++) m.is.spheres.scale[i] = 65536 * (i + 1);
    m.is.spheres.disc = paper ? 65536 : 61440;
    return m;
}

static const nacre_q16 origin[3] = {0, 0, 0};

/* A rotation (view space here is the turned one) that takes h to +z, l and v to (+-sin, 0, cos). */
static void light_own_frame(const shade_table_setup *t, const double l[3], double lh)
{
    const double error = 3e-8 + 2e-9 / (lh * lh); /* 1 + l.v, which l.h is the root of, has 2^-28 steps */

    for (int i = 0; i < 3; i++) {
        const int32_t *row = t->own_turn_q28[i];
        const double of_l = q28(row[0]) * l[0] + q28(row[1]) * l[1] + q28(row[2]) * l[2];

        NEAR(of_l, i == 0 ? q28(t->sin_q28) : i == 2 ? q28(t->cos_q28) : 0, error);
        NEAR(q28(row[2]), i == 0 ? -q28(t->sin_q28) : i == 2 ? q28(t->cos_q28) : 0, error);
        for (int j = 0; j < 3; j++) {
            const int32_t *other = t->own_turn_q28[j];

            NEAR(q28(row[0]) * q28(other[0]) + q28(row[1]) * q28(other[1]) + q28(row[2]) * q28(other[2]), i == j,
                 error);
        }
    }
    NEAR(q28(t->cos_q28), lh, error);
}

static void one_table_light(double polar, double azimuth)
{
    const nacre_light light = light_at(polar, azimuth, 2, 0.5, 0);
    const shade_material m = table_material(4.8);
    const nacre_view view = plain_view(&light, 1);
    const double e = m.is.table.e / 65536., ymax = m.is.table.ymax / 65536., p = m.is.table.p / 65536.;
    shade_frame frame;
    double l[3], lh, s;
    int i;

    direction_of(&light, l);
    lh = fmax(sqrt((1 + l[2]) / 2), 0.022);
    s = sqrt(1 - lh);
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
    const shade_table_setup *t = &frame.light[0].is.table;
    if (l[2] < -0.999) {
        for (i = 0; i < 3; i++) assert_int_equal(frame.light[0].factor[i].m, 0);
        return;
    }
    for (i = 0; i < 3; i++) {
        NEAR(q28(t->to_light_q28[i]), l[i], DIRECTION_ERROR);
        NEAR(q28(t->half_q28[i]), (l[i] + (i == 2)) / (2 * lh),
             DIRECTION_ERROR + 4e-9 / (lh * lh)); /* 1 + l.v has 2^-28 steps */
    }
    NEAR(q28(t->row_q28), ((s + m.is.table.rows / 65536. * (s * s - s)) * 20 + 0.5) / 21, 1e-7);
    const double scale = pow(ymax, p) / (PI * e) / lh;
    CLOSE(real(frame.light[0].factor[0]), 2 * scale, FACTOR_ERROR);
    CLOSE(real(frame.light[0].factor[1]), 0.5 * scale, FACTOR_ERROR);
    assert_int_equal(frame.light[0].factor[2].m, 0);
    shade_setup(&frame, &view, origin, &m, SHADE_ROOT, 0, 8);
    CLOSE(real(frame.light[0].factor[0]), sqrt(2 * scale), FACTOR_ERROR);
    CLOSE(real(frame.light[0].linear[0]), 2 * scale, FACTOR_ERROR);
    shade_setup(&frame, &view, origin, &m, SHADE_SRGB, 0, 8);
    const int lift = frame.light[0].lift;
    CLOSE(real(frame.light[0].factor[0]), 1.055 * pow(2 * scale * ldexp(1, -lift), 1 / 2.4), FACTOR_ERROR);
    /* the unlit side, where the phi_d term may raise y to 1 + a^2 W / 2, a^2 = 4 (l.h)^2 (1 - (l.h)^2) */
    const double w = fmax(m.is.table.w[0], fmax(m.is.table.w[1], m.is.table.w[2])) / 65536.;
    const double floor_light = 2 * scale * pow(1 + 2 * lh * lh * (1 - lh * lh) * w, p) * ldexp(1, -14 - lift);
    assert_true(lift == 13 || floor_light <= ldexp(1, -10) * 1.001);
    assert_true(lift == 0 || lift == 13 || floor_light > ldexp(1, -11) * 0.999);
    light_own_frame(t, l, lh);
}

static void table_lights(void **unused)
{
    (void)unused;
    for (int polar = 0; polar <= 180; polar += 4)
        for (int azimuth = 0; azimuth < 360; azimuth += 45) one_table_light(polar, azimuth);
    one_table_light(177.3, 10); /* l.v > -.999: kept */
    one_table_light(177.6, 10); /* dropped */
}

/* Scale and bias are numbers of fp16 (11 bits): half a step of the bias, 2^-12, and a step of the scale, 2^-14 (2^-13 for
   eps > 1/26), at half the table's range of logarithms, 1 + log2(1 / eps) / 2. In texels of 24: 1/50 at most. */
#define COORDINATE_ERROR 8e-4

static int is_half(double x)
{
    int exponent;

    x = ldexp(frexp(x, &exponent), 11);
    return x == floor(x);
}

static void table_constants(void **unused)
{
    (void)unused;
    for (double eps = 1. / 65536; eps < 1; eps *= 4) {
        const nacre_light light = light_at(0, 0, 1, 1, 1);
        const nacre_view view = plain_view(&light, 1);
        shade_material m = table_material(4);
        shade_frame frame;

        m.is.table.eps = (nacre_q16)(eps * 65536);
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
        const shade_table_draw *t = &frame.is.table;
        for (double away = 0; away <= 2; away += 0.01) { /* 1 - n.h */
            const double u = log2(away / eps + 1) / log2(1 / eps + 1);
            const double at = real(t->scale) * log2(2 * away + real(t->two_eps)) + real(t->bias);

            NEAR(at, (23 * u + 0.5) / 24, COORDINATE_ERROR);
        }
        assert_true(is_half(real(t->scale)) && is_half(real(t->bias)));
        CLOSE(real(t->two_eps), 2 * eps, 1e-9);
        CLOSE(real(t->root_two_eps), sqrt(2 * eps), 2e-5); /* 17 bits at the smallest eps */
        NEAR(q28(t->row_q28[0]), (1 - 19661 / 65536.) * 20 / 21, 1e-8);
        NEAR(q28(t->row_q28[1]), 19661 / 65536. * 20 / 21, 1e-8);
        NEAR(q28(t->row_q28[2]), 0.5 / 21, 1e-8);
        assert_int_equal(t->phi_q16[0], 12345);
        assert_int_equal(t->phi_q16[1], -2345);
        m.fine = m.early = 1;
        m.is.table.k1 = 111;
        m.is.table.k2 = 222;
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
        assert_int_equal(frame.is.table.phi_q16[0], 111);
        assert_int_equal(frame.is.table.phi_q16[1], 222);
        m.early = 0;
        m.is.table.k4 = 333;
        m.is.table.d[2] = 444;
        m.is.table.v[1] = -555;
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
        assert_int_equal(frame.is.table.phi_q16[1], -2345);
        assert_int_equal(frame.is.table.k2_q16, 222);
        assert_int_equal(frame.is.table.k4_q16, 333);
        assert_int_equal(frame.is.table.d_q16[2], 444);
        assert_int_equal(frame.is.table.v_q16[1], -555);
    }
}

/* exposure, tint, shadow multiply; zero-initialised means 1, 1, unshadowed. */
static void light_scales(void **unused)
{
    nacre_light light = light_at(30, 0, 1, 1, 1);
    const shade_material m = table_material(4.8);
    nacre_view view = plain_view(&light, 1);
    shade_frame plain, frame;

    (void)unused;
    shade_setup(&plain, &view, origin, &m, SHADE_LINEAR, 0, 8);
    view.exposure = 3 * 65536;
    view.tint = nacre_rgb_from_float(0.5f, 1, 2);
    view.ambient = nacre_rgb_from_float(1, 2, 3);
    light.shadow = 4096;
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
    const double tint[3] = {0.5, 1, 2};
    for (int i = 0; i < 3; i++) {
        CLOSE(real(frame.light[0].factor[i]), real(plain.light[0].factor[i]) * 3 * tint[i] * 0.75, FACTOR_ERROR);
        assert_int_equal(plain.ambient[i].m, 0);
    }
    CLOSE(real(frame.ambient[0]), 0.5 * 1 / PI * 3 * 0.5, FACTOR_ERROR);
    CLOSE(real(frame.ambient[1]), 0.25 * 2 / PI * 3 * 1, FACTOR_ERROR);
    assert_int_equal(frame.ambient[2].m, 0); /* albedo 0 */
    light.shadow = 16384;
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
    for (int i = 0; i < 3; i++) assert_int_equal(frame.light[0].factor[i].m, 0);
    light.shadow = 0;
    light.power.r = -1;
    light.power.g = INT32_MAX;
    view.exposure = INT32_MAX;
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
    assert_int_equal(frame.light[0].factor[0].m, 0);
    CLOSE(real(frame.light[0].factor[1]), 2048, 1e-6); /* saturated: eight stay below 16,384 */
    light.direction.x = light.direction.y = light.direction.z = 0;
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
    assert_int_equal(frame.light[0].factor[1].m, 0);
    for (int i = 1; i < NACRE_MAX_LIGHTS; i++) assert_int_equal(frame.light[i].factor[1].m, 0);
}

static void point_lights(void **unused)
{
    static const double scale[] = {0.01, 1, 300};
    const shade_material m = table_material(4.8);

    (void)unused;
    for (int k = 0; k < 3; k++) {
        const double at[3] = {1 * scale[k], 2 * scale[k], -1 * scale[k]}, c[3] = {0.5 * scale[k], 0, -4 * scale[k]};
        nacre_light light = light_at(0, 0, 1, 1, 1);
        nacre_view view = plain_view(&light, 1);
        shade_frame frame;
        double distance = 0, to_eye = 0;

        light.type = NACRE_LIGHT_POINT;
        for (int i = 0; i < 3; i++) {
            light.position[i] = nacre_q16_from_float((float)at[i]);
            view.object_to_view.m[12 + i] = nacre_q16_from_float((float)c[i]);
            distance += (at[i] - c[i]) * (at[i] - c[i]);
            to_eye += c[i] * c[i];
        }
        make_perspective(&view);
        distance = sqrt(distance);
        to_eye = sqrt(to_eye);
        assert_true(shade_needs_persp(&view));
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 1, 8);
        const double unit = ldexp(1, frame.position_shift), grain = 1e-3 / scale[k] * 0.01 + 1e-4;
        assert_true(to_eye * unit >= 0.999 && to_eye * unit < 2);
        /* |r| is 1 at the centre, or where the factor comes within its limit: factor / |r|^2 stays what it is */
        const double ymax = m.is.table.ymax / 65536., p = m.is.table.p / 65536., e = m.is.table.e / 65536.;
        const double factor = 2 * pow(ymax, p) / (PI * e) / (distance * distance);
        const double near = factor > 2048 ? exp2(-ceil(log2(factor / 2048) / 2)) : 1;
        double r = 0;
        assert_true((scale[k] < 1) == (near < 1));
        for (int i = 0; i < 3; i++) {
            const double part = real(frame.light[0].position[i]) - real(frame.light[0].position[3]) * c[i] * unit;

            NEAR(part, (at[i] - c[i]) / distance * near, grain);
            r += part * part;
        }
        NEAR(r, near * near, 2 * grain);
        CLOSE(real(frame.light[0].factor[0]), factor * near * near, FACTOR_ERROR + 4 * grain);
        NEAR(real(frame.eye[3]), 1, 0);
        view.distant_viewer = 1; /* one direction to the eye, still per-pixel lights */
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 1, 8);
        NEAR(real(frame.eye[3]), 0, 0);
        for (int i = 0; i < 3; i++) NEAR(real(frame.eye[i]), -c[i] / to_eye, grain);
    }
}

static void camera_cases(void **unused)
{
    nacre_light light = light_at(40, 20, 1, 1, 1);
    nacre_view view = plain_view(&light, 1);

    (void)unused;
    assert_false(shade_needs_persp(&view));
    make_perspective(&view);
    assert_true(shade_needs_persp(&view));
    view.distant_viewer = 1;
    assert_false(shade_needs_persp(&view));
    light.type = NACRE_LIGHT_POINT;
    assert_true(shade_needs_persp(&view));
    view.light_count = 0;
    assert_false(shade_needs_persp(&view));
}

/* Under a perspective camera the distant viewer's direction becomes +z by a rotation, and the light turns with it. */
static void distant_viewer_turns(void **unused)
{
    static const double centre[][3] = {{0, 0, -3}, {1, 2, -3}, {-2, .5, -1}, {5, 0, -.01}};
    const nacre_light light = light_at(40, 20, 1, 1, 1);
    const shade_material m = table_material(4.8);

    (void)unused;
    for (unsigned k = 0; k < sizeof centre / sizeof *centre; k++) {
        nacre_view view = plain_view(&light, 1);
        shade_frame frame;
        double v[3], l[3], length = 0, turned[3];

        make_perspective(&view);
        view.distant_viewer = 1;
        for (int i = 0; i < 3; i++) {
            view.object_to_view.m[12 + i] = nacre_q16_from_float((float)centre[k][i]);
            v[i] = -view.object_to_view.m[12 + i] / 65536.;
            length += v[i] * v[i];
        }
        for (int i = 0; i < 3; i++) v[i] /= sqrt(length);
        direction_of(&light, l);
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
        for (int i = 0; i < 3; i++) {
            const int32_t *row = frame.turn_q28[i];

            turned[i] = q28(row[0]) * l[0] + q28(row[1]) * l[1] + q28(row[2]) * l[2];
            NEAR(q28(row[0]) * v[0] + q28(row[1]) * v[1] + q28(row[2]) * v[2], i == 2, 1e-7);
            for (int j = 0; j < 3; j++) {
                const int32_t *other = frame.turn_q28[j];
                const double dot =
                    q28(row[0]) * q28(other[0]) + q28(row[1]) * q28(other[1]) + q28(row[2]) * q28(other[2]);

                NEAR(dot, i == j, 1e-7);
            }
            NEAR(q28(frame.light[0].is.table.to_light_q28[i]), turned[i], 1e-7);
        }
        NEAR(turned[2], v[0] * l[0] + v[1] * l[1] + v[2] * l[2], 1e-7);
    }
}

/* R_y of eq. 2 in double, as ERRATA-free formulas: x' = x cos + z sin, z' = -x sin + z cos. */
static void one_spheres_light(double polar, double azimuth)
{
    static const double stored[] = {0, 45, 90, 135};
    const nacre_light light = light_at(polar, azimuth, 1, 1, 1);
    const shade_material m = spheres_material(0);
    const nacre_view view = plain_view(&light, 1);
    const double disc = m.is.spheres.disc / 65536. / 2;
    shade_frame frame;
    double l[3];

    direction_of(&light, l);
    const double sine = hypot(l[0], l[1]), phi = atan2(sine, l[2]), c = sine > 0 ? l[0] / sine : 1,
                 s = sine > 0 ? l[1] / sine : 0;
    int low = 0;
    while (low < 3 && stored[low + 1] * PI / 180 <= phi + 1e-12) low++;
    const int high = low < 3 ? low + 1 : 3;
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
    const shade_spheres_setup *t = &frame.light[0].is.spheres;
    const double weight = low == high ? 0 : (phi * 180 / PI - stored[low]) / (stored[high] - stored[low]);
    /* at a stored angle either neighbour is right: compare what is blended */
    NEAR(t->layer[0] + q28(t->weight_q28) * (t->layer[1] - t->layer[0]), low + weight * (high - low), 1e-6);
    for (int i = 0; i < 2; i++) {
        const double d = (stored[t->layer[i]] * PI / 180 - phi) / 2;

        NEAR(q28(t->x_q28[i][0]), c * cos(d) * disc, 1e-7);
        NEAR(q28(t->x_q28[i][1]), s * cos(d) * disc, 1e-7);
        NEAR(q28(t->x_q28[i][2]), sin(d) * disc, 1e-7);
        if (i && d > 0) {
            NEAR(q28(t->rim_q28[0]), tan(d / 2) * c * sin(d) * disc, 1e-7);
            NEAR(q28(t->rim_q28[1]), tan(d / 2) * s * sin(d) * disc, 1e-7);
            NEAR(q28(t->rim_q28[2]), tan(d / 2) * -cos(d) * disc, 1e-7);
        }
    }
    NEAR(q28(t->y_q28[0]), -s * disc, 1e-7);
    NEAR(q28(t->y_q28[1]), c * disc, 1e-7);
    for (int i = 0; i < 3; i++) CLOSE(real(frame.light[0].factor[i]), (i + 1) / PI, FACTOR_ERROR);
}

static void spheres_lights(void **unused)
{
    (void)unused;
    for (int polar = 0; polar <= 176; polar += 3)
        for (int azimuth = 0; azimuth < 360; azimuth += 30) one_spheres_light(polar, azimuth);
}

static void spheres_layers(void **unused)
{
    const nacre_light light = light_at(30, 0, 1, 1, 1);
    const nacre_view view = plain_view(&light, 1);
    shade_material m = spheres_material(0);
    shade_frame frame;

    (void)unused;
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 1, 4);
    const shade_spheres_draw *d = &frame.is.spheres;
    const double half = m.is.spheres.disc / 65536. / 2;
    assert_int_equal(d->count, 4);
    NEAR(q28(d->half_disc_q28), half, 1e-8);
    for (int i = 0; i < 4; i++) {
        const double phi = i * PI / 4;

        assert_int_equal(d->layer[i], i);
        NEAR(q28(d->polar_q28[i]), phi, 1e-7);
        NEAR(q28(d->cos_q28[i]), cos(phi / 2) * half, 1e-7);
        NEAR(q28(d->sin_q28[i]), sin(phi / 2) * half, 1e-7);
        NEAR(q28(d->rim_q28[i]), i ? tan(PI / 16) : 0, 1e-7);
        for (double at = 0; at < 3; at += 0.1)
            NEAR(real(d->ramp[i][0]) * at + real(d->ramp[i][1]), i < 3 ? (at - phi) / (PI / 4) : 0, 1e-6);
    }
    for (int i = 4; i < 8; i++) assert_int_equal(d->layer[i], 3);

    /* more layers than units: spread, ends kept, rising */
    m.is.spheres.layers = 19;
    for (int i = 0; i < 19; i++) m.is.spheres.polar_bam[i] = (uint16_t)(i * 1700);
    for (int units = 2; units <= 8; units++) {
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 1, units);
        assert_int_equal(d->count, units);
        assert_int_equal(d->layer[0], 0);
        assert_int_equal(d->layer[units - 1], 18);
        for (int i = 1; i < units; i++) assert_true(d->layer[i] > d->layer[i - 1]);
    }
    m.is.spheres.layers = 1; /* no pair: everything from the one image */
    shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 4);
    assert_int_equal(frame.light[0].is.spheres.layer[1], 0);
    assert_int_equal(d->count, 1);
}

/* Quadratics of the paper's turn: within 0.1 texel of 512 of sin and cos at every s, for differences up to 45 degrees. */
static void paper_turns(void **unused)
{
    const shade_material m = spheres_material(1);

    (void)unused;
    for (int polar = 0; polar <= 175; polar += 5) {
        const nacre_light light = light_at(polar, 77, 1, 1, 1);
        const nacre_view view = plain_view(&light, 1);
        shade_frame frame;
        double l[3];

        direction_of(&light, l);
        const double phi = acos(l[2]);
        shade_setup(&frame, &view, origin, &m, SHADE_LINEAR, 0, 8);
        const shade_spheres_setup *t = &frame.light[0].is.spheres;
        NEAR(q28(t->half_q28[0]), sin(phi / 2), 1e-4);
        NEAR(q28(t->half_q28[1]), cos(phi / 2), 1e-4);
        for (int i = 0; i < 2; i++)
            for (double s = 0; s <= 1; s += 0.05) {
                const double d = t->layer[i] * PI / 4 - phi, k = phi > 3 * PI / 4 + 1e-3 ? 0.75 : 0.5 + s / 2;

                for (int part = 0; part < 2; part++) {
                    const int c = 2 * part + i;
                    const double got =
                        q28(t->turn_q28[0][c]) + s * (q28(t->turn_q28[1][c]) + s * q28(t->turn_q28[2][c]));

                    NEAR(got, part ? cos(k * d) : sin(k * d), 0.1 / 256 + 1e-4);
                }
            }
        for (int i = 0; i < 3; i++) CLOSE(real(frame.light[0].factor[i]), 1 / (PI * (i + 1)), FACTOR_ERROR);
        NEAR(q28(frame.is.spheres.half_disc_q28), 0.4975, 1e-5);
        shade_setup(&frame, &view, origin, &m, SHADE_SRGB, 0, 8);
        CLOSE(real(frame.light[0].factor[0]), pow(1 / PI, 1 / 2.4), FACTOR_ERROR); /* encoded texels scale by this */
        CLOSE(real(frame.light[0].linear[0]), 1 / PI, FACTOR_ERROR);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_lights),   cmocka_unit_test(table_constants), cmocka_unit_test(light_scales),
        cmocka_unit_test(point_lights),   cmocka_unit_test(camera_cases),    cmocka_unit_test(distant_viewer_turns),
        cmocka_unit_test(spheres_lights), cmocka_unit_test(spheres_layers),  cmocka_unit_test(paper_turns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
