/* SPDX-License-Identifier: MIT */
/*
 * The unlit side stays dark: pixels of the sphere with n.l <= 0 come out at most 2 codes, for shiny materials under grazing
 * lights, where 1 / l.h is large and a floor under the logarithm of n.l would show first.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "cases.h"
#include "drivers.h"
#include "metric.h"

#include <cmocka.h> /* last: it makes a macro of fail */

#define PI   3.14159265358979323846
#define SIZE 96

static const struct {
    case_model model;
    const char *brdf;
} materials[] = {{CASE_TABLE, "sgd:color-changing-paint3"},
                 {CASE_TABLE, "sgd:two-layer-gold"},
                 {CASE_TABLE, "sgd:blue-rubber"},
                 {CASE_FINE, "sgd:two-layer-gold"},
                 {CASE_TABLE_P4, "sgd:two-layer-gold"},
                 {CASE_SPHERES, "sgd:two-layer-gold"},
                 {CASE_QUARTER, "sgd:two-layer-gold"},
                 /* strong phi_d terms, which run free there */
                 {CASE_TABLE, "ngan-lafortune:natural-209"},
                 {CASE_TABLE, "ngan-lafortune:aventurnine"},
                 {CASE_FINE, "ngan-lafortune:natural-209"}};

/* Largest code among unlit pixels; *count receives how many there are. */
static int brightest_unlit(const image_u8 *frame, double polar_deg, int *count)
{
    const double light[3] = {sin(polar_deg * PI / 180), 0, cos(polar_deg * PI / 180)};
    int most = 0;

    *count = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        double n[3];

        if (!metric_normal(i % SIZE, i / SIZE, SIZE, n) || n[0] * light[0] + n[2] * light[2] > 0) continue;
        for (int k = 0; k < 3; k++)
            if (frame->texel[4 * i + k] > most) most = frame->texel[4 * i + k];
        ++*count;
    }
    return most;
}

static int run_driver(int index)
{
    const frame_case empty = {.name = "unlit side"};
    scene_gles *g;
    mesh shape;
    failure f = {0};
    int failed = 0;

    if (scene_gles_open(&g, drivers[index].backend, SIZE, SIZE, &f)) {
        printf("SKIPPED: driver %s: %s\n", drivers[index].name, f.text);
        return DRIVER_SKIPPED;
    }
    if (mesh_open(&shape, "sphere", &f)) return 1;
    for (size_t m = 0; m < sizeof materials / sizeof *materials; m++) {
        case_asset asset;
        int most = 0, count, all = 0;

        case_asset_open(&asset, materials[m].model, materials[m].brdf, 0, NULL);
        for (int polar = 120; polar <= 178; polar += 2) {
            const double power[3] = {2 * PI, 2 * PI, 2 * PI};
            image_u8 frame;
            scene s;

            case_scene(&s, &empty, &shape, SIZE, SIZE);
            scene_add_light(&s, polar, 0, power);
            if (scene_gles_draw(g, &s, &asset.material, &frame, &f)) {
                printf("%s\n", f.text);
                return 1;
            }
            const int code = brightest_unlit(&frame, polar, &count);
            if (code > most) most = code;
            all += count;
            image_u8_free(&frame);
        }
        printf("%s: model %d, %s: at most %d in %d unlit pixels\n", drivers[index].name, (int)materials[m].model,
               materials[m].brdf, most, all);
        failed += most > 2;
        case_asset_close(&asset);
    }
    mesh_free(&shape);
    scene_gles_close(g);
    return failed ? 1 : 0;
}

static void test_driver(void **state)
{
    const int code = driver_run((int)(intptr_t)*state, "dark");

    if (code == DRIVER_SKIPPED) skip();
    assert_int_equal(code, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        {"egl gles 2, fp32", test_driver, NULL, NULL, (void *)(intptr_t)1},
        {"egl gles 2, fp16", test_driver, NULL, NULL, (void *)(intptr_t)5},
    };
    const char *argument;
    const int index = driver_of_arguments(argc, argv, &argument);

    return index >= 0 ? run_driver(index) : cmocka_run_group_tests(tests, NULL, NULL);
}
