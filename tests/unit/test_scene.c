/* SPDX-License-Identifier: MIT */
/* The double renderer against closed forms: what a pixel sees, how bright it is, how it is coded. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

#include <cmocka.h> /* last: it makes a macro of fail */

#define PI 3.14159265358979323846

static void check(int code, const failure *f)
{
    if (code) printf("%s\n", f->text);
    assert_int_equal(code, 0);
}

typedef struct stage {
    mesh shape;
    brdf *matt; /* Lambert, albedo 0.5 */
    scene s;
    image_u8 out;
} stage;

static void begin(stage *g, const char *mesh_name, const scene_camera *camera, int width, int height)
{
    failure f = {0};

    *g = (stage){0};
    check(mesh_open(&g->shape, mesh_name, &f), &f);
    check(brdf_open(&g->matt, "lambert:albedo=.5", &f), &f);
    scene_begin(&g->s, &g->shape, width, height);
    check(scene_aim(&g->s, camera, &f), &f);
}

static void draw(stage *g)
{
    failure f = {0};

    image_u8_free(&g->out);
    check(scene_draw_double(&g->s, g->matt, NULL, NULL, &g->out, &f), &f);
}

static void end(stage *g)
{
    image_u8_free(&g->out);
    brdf_close(g->matt);
    mesh_free(&g->shape);
}

static const uint8_t *pixel(const stage *g, int i, int j)
{
    return g->out.texel + 4 * (j * g->out.width + i);
}

/* The code of a linear value; the curve is written out here from IEC 61966-2-1. */
static double srgb(double x)
{
    double y = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;

    return 255 * fmin(fmax(y, 0), 1);
}

static void near_code(int actual, double expected)
{
    if (!(fabs(actual - expected) <= 0.501)) printf("code %d, expected %.3f\n", actual, expected);
    assert_true(fabs(actual - expected) <= 0.501); /* nearest, whichever way a half is rounded */
}

/* Radiance of a matt sphere: albedo / pi x irradiance x n.l, with n from the pixel's place as documented. */
static void matt_sphere(void **state)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_ORTHO};
    const double power[3] = {1, 2, 3}, polar = 50 * PI / 180, azimuth = 70 * PI / 180;
    const double l[3] = {sin(polar) * cos(azimuth), sin(polar) * sin(azimuth), cos(polar)};
    enum { W = 40, H = 24 }; /* not square: the sphere still fills the frame */
    stage g;
    int i, j, k, covered = 0;

    (void)state;
    begin(&g, "sphere", &camera, W, H);
    scene_add_light(&g.s, 50, 70, power);
    draw(&g);
    for (j = 0; j < H; j++)
        for (i = 0; i < W; i++) {
            double x = (2 * i + 1) / (double)W - 1, y = 1 - (2 * j + 1) / (double)H, zz = 1 - x * x - y * y;
            assert_int_equal(pixel(&g, i, j)[3], zz > 0 ? 255 : 0);
            covered += zz > 0;
            for (k = 0; k < 3 && zz > 0; k++) {
                double cosine = fmax(0, x * l[0] + y * l[1] + sqrt(zz) * l[2]);
                near_code(pixel(&g, i, j)[k], srgb(0.5 / PI * power[k] * cosine));
            }
            if (zz <= 0) assert_int_equal(pixel(&g, i, j)[0] | pixel(&g, i, j)[1] | pixel(&g, i, j)[2], 0);
        }
    assert_in_range(covered, (unsigned long)(W * H * PI / 4 - 20), (unsigned long)(W * H * PI / 4 + 20));
    end(&g);
}

/* Three codings of the same radiance, exposure and tint. */
static void outputs(void **state)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_ORTHO};
    const double power[3] = {PI, PI, PI};
    stage g;

    (void)state;
    begin(&g, "sphere", &camera, 9, 9);
    scene_add_light(&g.s, 0, 0, power);
    g.s.exposure = 0.8;
    g.s.tint[1] = 0.5;
    g.s.tint[2] = 4;
    draw(&g); /* the middle pixel: 0.5 x 0.8 x tint */
    near_code(pixel(&g, 4, 4)[0], srgb(0.4));
    near_code(pixel(&g, 4, 4)[1], srgb(0.2));
    assert_int_equal(pixel(&g, 4, 4)[2], 255);
    g.s.output = NACRE_OUTPUT_SQRT;
    draw(&g);
    near_code(pixel(&g, 4, 4)[0], 255 * sqrt(0.4));
    g.s.output = NACRE_OUTPUT_LINEAR;
    draw(&g);
    near_code(pixel(&g, 4, 4)[0], 102);
    end(&g);
}

static void ambient_and_shadow(void **state)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_ORTHO};
    const double power[3] = {PI, PI, PI}, albedo[3] = {0.1, 0.2, 0.3};
    stage g;
    failure f = {0};

    (void)state;
    begin(&g, "sphere", &camera, 9, 9);
    g.s.output = NACRE_OUTPUT_LINEAR;
    g.s.ambient[0] = g.s.ambient[1] = g.s.ambient[2] = PI;
    draw(&g); /* no light: albedo x irradiance / pi */
    near_code(pixel(&g, 4, 4)[0], 127.5);
    near_code(pixel(&g, 1, 4)[0], 127.5);
    scene_add_light(&g.s, 0, 0, power);
    g.s.light[0].shadow = 0.75;
    image_u8_free(&g.out);
    check(scene_draw_double(&g.s, g.matt, albedo, NULL, &g.out, &f), &f);
    near_code(pixel(&g, 4, 4)[0], 255 * (0.1 + 0.125));
    near_code(pixel(&g, 4, 4)[2], 255 * (0.3 + 0.125));
    end(&g);
}

/* A plane under a perspective camera and a point light: where the ray through each pixel meets it, the irradiance is
   intensity x cosine / distance squared. */
static void plane_in_perspective(void **state)
{
    const scene_camera camera = {
        .kind = SCENE_CAMERA_LOOK, .eye = {0.4, -0.3, 3}, .target = {0.4, -0.3, 0}, .fovy_deg = 50};
    const double lamp[3] = {0.3, 0.5, -2.2}, strength[3] = {2, 2, 2}; /* view space; the plane lies at z = -3 */
    enum { W = 48, H = 32 };
    stage g;
    int i, j, tested = 0;

    (void)state;
    begin(&g, "plane", &camera, W, H);
    scene_add_point(&g.s, lamp, strength);
    draw(&g);
    for (j = 0; j < H; j++)
        for (i = 0; i < W; i++) {
            double half = tan(25 * PI / 180);
            double x = 3 * half * W / H * ((2 * i + 1) / (double)W - 1), y = 3 * half * (1 - (2 * j + 1) / (double)H);
            int inside = fabs(x + 0.4) < 1 && fabs(y - 0.3) < 1;
            double dx = lamp[0] - x, dy = lamp[1] - y, dz = 0.8, dd = dx * dx + dy * dy + dz * dz;
            assert_int_equal(pixel(&g, i, j)[3], inside ? 255 : 0);
            if (inside) near_code(pixel(&g, i, j)[1], srgb(0.5 / PI * 2 * dz / sqrt(dd) / dd));
            tested += inside;
        }
    assert_true(tested > 300);
    end(&g);
}

/* The camera stands between the plane's edges: corners behind the eye must not smear over the frame. */
static void plane_through_the_eye(void **state)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_LOOK, .eye = {0, 0, 0.5}, .target = {0, 1, 0.5}, .fovy_deg = 90};
    stage g;
    int i, j;

    (void)state;
    begin(&g, "plane", &camera, 32, 32);
    scene_add_light(&g.s, 0, 0, NULL);
    draw(&g);
    /* It looks along +y over the plane z = 0, up being +z: the far edge, 1 away and 0.5 below, halves the lower half. */
    for (j = 0; j < 32; j++)
        for (i = 14; i < 18; i++) assert_int_equal(pixel(&g, i, j)[3], j < 24 ? 0 : 255);
    end(&g);
}

/* Of two triangles the nearer is seen, whichever comes first. */
static void nearest_wins(void **state)
{
    float position[6][3] = {{-3, -3, 0}, {3, -3, 0}, {0, 3, 0}, {-3, -3, .5f}, {3, -3, .5f}, {0, 3, .5f}};
    float normal[6][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
    uint32_t order[2][6] = {{0, 1, 2, 3, 4, 5}, {3, 4, 5, 0, 1, 2}};
    const scene_camera camera = {.kind = SCENE_CAMERA_LOOK, .eye = {0, 0, 9}, .target = {0, 0, 0}};
    stage g;
    mesh pair = {.vertex_count = 6, .index_count = 6, .position = position, .normal = normal, .name = "pair"};
    int k;

    (void)state;
    begin(&g, "plane", &camera, 8, 8);
    g.s.shape = &pair;
    scene_add_light(&g.s, 0, 0, NULL);
    for (k = 0; k < 2; k++) {
        pair.index = order[k];
        draw(&g);
        assert_int_equal(pixel(&g, 4, 4)[3], 255);
        assert_int_equal(pixel(&g, 4, 4)[0], 0); /* its normal is across the light */
    }
    end(&g);
}

/* The tessellated sphere under the same camera is the exact one, but for a pixel along its outline. */
static void sphere_as_mesh(void **state)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_FIT, .fovy_deg = 60};
    stage g;
    image_u8 exact;
    int i, k, worst = 0, outline = 0;

    (void)state;
    begin(&g, "sphere", &camera, 64, 64);
    scene_add_light(&g.s, 40, 200, NULL);
    g.s.exposure = 5;
    draw(&g);
    exact = g.out;
    g.out = (image_u8){0};
    g.s.exact_sphere = 0;
    draw(&g);
    for (i = 0; i < 64 * 64; i++) {
        const uint8_t *a = exact.texel + 4 * i, *b = g.out.texel + 4 * i;
        int inside = 1;
        outline += a[3] != b[3];
        if (i < 65 || i >= 64 * 63 - 1) continue;
        for (k = 0; k < 9; k++) inside &= exact.texel[4 * (i + k % 3 - 1 + 64 * (k / 3 - 1)) + 3] == 255;
        for (k = 0; k < 3 && inside; k++) worst = abs(a[k] - b[k]) > worst ? abs(a[k] - b[k]) : worst;
    }
    printf("tessellated sphere: %d codes, %d outline pixels\n", worst, outline);
    assert_true(worst <= 1);
    assert_true(outline <= 12);
    image_u8_free(&exact);
    end(&g);
}

/* Fit: the mesh touches none of the frame's edges and comes near two opposite ones. */
static void fit_fills_the_frame(void **state)
{
    static const char *const names[] = {"teapot", "torus", "plane"};
    const scene_camera camera = {.yaw_deg = 30, .pitch_deg = 20, .margin = 0.05};
    int n, i;

    (void)state;
    for (n = 0; n < 3; n++) {
        stage g;
        int left = 100, right = -1, top = 100, bottom = -1;
        begin(&g, names[n], &camera, 100, 60);
        scene_add_light(&g.s, 0, 0, NULL);
        draw(&g);
        for (i = 0; i < 6000; i++) {
            if (!g.out.texel[4 * i + 3]) continue;
            left = i % 100 < left ? i % 100 : left;
            right = i % 100 > right ? i % 100 : right;
            top = i / 100 < top ? i / 100 : top;
            bottom = i / 100 > bottom ? i / 100 : bottom;
        }
        assert_true(left >= 4 && right <= 95 && top >= 2 && bottom <= 57);
        assert_true(left <= 6 || right >= 93 || top <= 4 || bottom >= 55);
        end(&g);
    }
}

/* A normal map of one tilt is a turned plane. Its upper half here lies flat: row 0 of the picture is the top, v = 1. */
static void normal_map(void **state)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_LOOK, .eye = {0, 0, 3}, .target = {0, 0, 0}};
    const double power[3] = {PI, PI, PI}, tilt[3] = {0.2, 0.6, sqrt(1 - 0.04 - 0.36)};
    const double polar = 40 * PI / 180, azimuth = 100 * PI / 180;
    const double l[3] = {sin(polar) * cos(azimuth), sin(polar) * sin(azimuth), cos(polar)};
    image_u8 map = image_u8_make(2, 8, 3);
    stage g;
    failure f = {0};
    double flat[3] = {2 * 128 / 255.0 - 1, 2 * 128 / 255.0 - 1, 1}, cosine[2] = {0, 0}, length[2] = {0, 0};
    int i, k;

    (void)state;
    for (k = 0; k < 3; k++) {
        int code = (int)(255 * (0.5 + 0.5 * tilt[k]) + 0.5);
        double n = 2 * code / 255.0 - 1;
        for (i = 0; i < 16; i++) map.texel[3 * i + k] = (uint8_t)(i < 8 ? k == 2 ? 255 : 128 : code);
        cosine[0] += flat[k] * l[k];
        length[0] += flat[k] * flat[k];
        cosine[1] += n * l[k];
        length[1] += n * n;
    }
    begin(&g, "plane", &camera, 16, 16);
    g.s.output = NACRE_OUTPUT_LINEAR;
    scene_add_light(&g.s, 40, 100, power);
    check(scene_draw_double(&g.s, g.matt, NULL, &map, &g.out, &f), &f);
    for (i = 0; i < 2; i++) near_code(pixel(&g, 8, i ? 11 : 4)[0], 255 * 0.5 * cosine[i] / sqrt(length[i]));
    image_u8_free(&map);
    end(&g);
}

/* Half the samples white and half black is half the light: sRGB 188. A quarter covered is a quarter alpha. */
static void averages(void **state)
{
    image_u8 frame = image_u8_make(4, 2, 4), out;

    (void)state;
    memset(frame.texel, 255, 4 * 8);
    frame.texel[0] = frame.texel[1] = frame.texel[2] = 0; /* block 0: two black */
    frame.texel[16] = frame.texel[17] = frame.texel[18] = 0;
    memset(frame.texel + 4 * 2, 0, 8); /* block 1: one white left */
    memset(frame.texel + 4 * 6, 0, 4);
    scene_average(&frame, 2, NACRE_OUTPUT_SRGB, &out);
    assert_int_equal(out.width, 2);
    assert_int_equal(out.height, 1);
    assert_int_equal(out.texel[0], 188);
    assert_int_equal(out.texel[3], 255);
    assert_int_equal(out.texel[4], 255);
    assert_int_equal(out.texel[7], 64);
    image_u8_free(&out);
    scene_average(&frame, 2, NACRE_OUTPUT_LINEAR, &out);
    assert_int_equal(out.texel[0], 128);
    image_u8_free(&out);
    image_u8_free(&frame);
}

static void inverse(void **state)
{
    const double m[16] = {2, 0, 0, 0, 0, 0, 3, 1, 1, -1, 0, 0, 0, 4, 1, 5};
    const double singular[16] = {1, 2, 3, 4, 2, 4, 6, 8, 0, 0, 1, 0, 0, 0, 0, 1};
    double i[16], product[16];
    int k;

    (void)state;
    assert_int_equal(matrix_invert(i, m), 1);
    matrix_multiply(product, m, i);
    for (k = 0; k < 16; k++) assert_true(fabs(product[k] - (k % 5 == 0)) < 1e-12);
    assert_int_equal(matrix_invert(i, singular), 0);
}

static void camera_errors(void **state)
{
    const scene_camera nowhere = {.kind = SCENE_CAMERA_LOOK, .eye = {1, 2, 3}, .target = {1, 2, 3}};
    stage g;
    failure f = {0};

    (void)state;
    begin(&g, "plane", &(scene_camera){0}, 8, 8);
    assert_int_equal(scene_aim(&g.s, &nowhere, &f), FAIL_USAGE);
    assert_non_null(strstr(f.text, "eye"));
    end(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(matt_sphere),
        cmocka_unit_test(outputs),
        cmocka_unit_test(ambient_and_shadow),
        cmocka_unit_test(plane_in_perspective),
        cmocka_unit_test(plane_through_the_eye),
        cmocka_unit_test(nearest_wins),
        cmocka_unit_test(sphere_as_mesh),
        cmocka_unit_test(fit_fills_the_frame),
        cmocka_unit_test(normal_map),
        cmocka_unit_test(averages),
        cmocka_unit_test(inverse),
        cmocka_unit_test(camera_errors),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
