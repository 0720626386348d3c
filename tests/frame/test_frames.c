/* SPDX-License-Identifier: MIT */
/*
 * One table of frames (tests/support/cases.c) on every driver, against the double renderer's decoding of the same file.
 * Frames computed in fp32 must also agree with each other. NACRE_CASE=WORDS in the environment picks cases by name.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cases.h"
#include "drivers.h"
#include "gl_probe.h"
#include "png_io.h"

#include <cmocka.h> /* last: it makes a macro of fail */

static char kept[] = "/tmp/nacre-frames-XXXXXX"; /* baked files and frames, for the children and for comparing */

static int wanted(const frame_case *c)
{
    const char *words = getenv("NACRE_CASE");

    return !words || strstr(c->name, words);
}

static const char *mesh_of(const frame_case *c)
{
    return c->mesh ? c->mesh : "sphere";
}

/* ---- a child: all cases on one driver --------------------------------------------------------------------------- */

static int run_case(scene_gles *g, const driver *d, int index, int driver_index, const char *directory)
{
    const frame_case *c = &frame_cases[index];
    char name[200], path[300];
    image_u8 actual, expected;
    case_asset asset;
    failure f = {0};
    scene s;
    mesh shape;
    int ok;

    snprintf(name, sizeof name, "%s: %s", d->name, c->name);
    if (mesh_open(&shape, mesh_of(c), &f)) {
        printf("%s: %s\n", name, f.text);
        return 0;
    }
    case_asset_open(&asset, c->model, c->brdf, c->normal_map, directory);
    case_scene(&s, c, &shape, d->size, d->size);
    ok = !scene_gles_draw(g, &s, &asset.material, &actual, &f) &&
         !scene_draw_double(&s, asset.decoded, asset.albedo, c->normal_map ? &asset.normal_map : NULL, &expected, &f);
    if (ok) {
        ok = compare_frames(name, &actual, &expected, c->mesh != NULL, d->half ? c->fp16 : c->fp32, NULL);
        snprintf(path, sizeof path, "%s/%d.%d.png", directory, driver_index, index);
        ok &= !png_write(path, &actual, &f);
        image_u8_free(&actual);
        image_u8_free(&expected);
    } else {
        printf("%s: %s\n", name, f.text);
    }
    case_asset_close(&asset);
    mesh_free(&shape);
    return ok;
}

static int check_precision(const driver *d)
{
    gl_headless *gl;
    failure f = {0};
    int found;

    if (gl_headless_open(&gl, d->backend, 16, 16, &f)) {
        printf("SKIPPED: driver %s: %s\n", d->name, f.text);
        return DRIVER_SKIPPED;
    }
    printf("%s: %s\n", d->name, gl_headless_description(gl));
    found = gl_probe_mediump(gl);
    gl_headless_close(gl);
    if (d->half && found == 128) {
        printf("SKIPPED: driver %s: mediump is fp32 on this machine (no F16C), no half floats to test\n", d->name);
        return DRIVER_SKIPPED;
    }
    if (found == (d->half ? 0 : 128)) return 0;
    printf("%s: mediump fract(4096.5) = %d / 255, expected %d\n", d->name, found, d->half ? 0 : 128);
    return 1;
}

static int run_driver(int index, const char *directory)
{
    const driver *d = &drivers[index];
    scene_gles *g;
    failure f = {0};
    int i, failed = check_precision(d);

    if (failed) return failed;
    if (scene_gles_open(&g, d->backend, d->size, d->size, &f)) {
        printf("%s: %s\n", d->name, f.text);
        return 1;
    }
    for (i = 0; i < frame_case_count; i++)
        if (wanted(&frame_cases[i])) failed += !run_case(g, d, i, index, directory);
    scene_gles_close(g);
    if (failed) printf("%s: %d cases failed\n", d->name, failed);
    return failed ? 1 : 0;
}

/* ---- the parent --------------------------------------------------------------------------------------------------- */

static void test_driver(void **state)
{
    int code = driver_run((int)(intptr_t)*state, kept);

    if (code == DRIVER_SKIPPED) skip();
    assert_int_equal(code, 0);
}

/* No driver in fp32 is right alone: their texture filters and roots differ by a code or two. */
static void fp32_drivers_agree(void **state)
{
    const compare_bound bound = {-2, 2, 0.004, 0.003};
    int i, k, failed = 0, compared = 0;

    (void)state;
    for (i = 0; i < frame_case_count; i++) {
        image_u8 first = {0};
        for (k = 0; k < driver_count; k++) {
            char path[300], name[200];
            image_u8 frame;
            snprintf(path, sizeof path, "%s/%d.%d.png", kept, k, i);
            if (drivers[k].half || drivers[k].size != drivers[0].size || access(path, R_OK)) continue;
            assert_int_equal(png_read(&frame, path, 4, NULL), 0);
            snprintf(name, sizeof name, "%s / first: %s", drivers[k].name, frame_cases[i].name);
            if (!first.texel) {
                first = frame;
                continue;
            }
            failed += !compare_frames(name, &frame, &first, frame_cases[i].mesh != NULL, &bound, NULL);
            compared++;
            image_u8_free(&frame);
        }
        image_u8_free(&first);
    }
    if (!compared) skip();
    assert_int_equal(failed, 0);
}

/* The bounds can fail: a light moved by a degree is seen. */
static void bounds_are_tight(void **state)
{
    frame_case moved = frame_cases[0];
    image_u8 a, b;
    case_asset asset;
    scene s;
    mesh shape;
    failure f = {0};
    compare_result r = {0};

    (void)state;
    assert_int_equal(mesh_open(&shape, "sphere", &f), 0);
    case_asset_open(&asset, moved.model, moved.brdf, 0, kept);
    case_scene(&s, &frame_cases[0], &shape, 96, 96);
    assert_int_equal(scene_draw_double(&s, asset.decoded, asset.albedo, NULL, &a, &f), 0);
    moved.polar_deg = 36;
    case_scene(&s, &moved, &shape, 96, 96);
    assert_int_equal(scene_draw_double(&s, asset.decoded, asset.albedo, NULL, &b, &f), 0);
    compare_frames("(for comparison) light moved by 1 degree", &a, &b, 0, &(compare_bound){-255, 255, 1, 1}, &r);
    assert_true(r.least < moved.fp32->low || r.most > moved.fp32->high);
    image_u8_free(&a);
    image_u8_free(&b);
    case_asset_close(&asset);
    mesh_free(&shape);
}

static int bake_all(void **state)
{
    int i;

    (void)state;
    if (!mkdtemp(kept)) return -1;
    for (i = 0; i < frame_case_count; i++) {
        case_asset asset;
        if (!wanted(&frame_cases[i])) continue;
        case_asset_open(&asset, frame_cases[i].model, frame_cases[i].brdf, 0, kept);
        case_asset_close(&asset);
    }
    return 0;
}

static int remove_all(void **state)
{
    (void)state;
    driver_remove_directory(kept);
    return 0;
}

int main(int argc, char **argv)
{
    struct CMUnitTest tests[16] = {cmocka_unit_test(bounds_are_tight)};
    const char *directory;
    int i, count = 1, index = driver_of_arguments(argc, argv, &directory);

    if (index >= 0) return run_driver(index, directory);
    for (i = 0; i < driver_count; i++)
        tests[count++] = (struct CMUnitTest){drivers[i].name, test_driver, NULL, NULL, (void *)(intptr_t)i};
    tests[count++] = (struct CMUnitTest)cmocka_unit_test(fp32_drivers_agree);
    return _cmocka_run_group_tests("frames", tests, (size_t)count, bake_all, remove_all);
}
