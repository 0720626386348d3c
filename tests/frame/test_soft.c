/* SPDX-License-Identifier: MIT */
/* The case table (tests/support/cases.c) by the CPU renderer: against the double renderer's decoding of the same file, and
   against the GLES backend at highp, on llvmpipe, which filters texels in 8 bits, and on softpipe, which does in float.
   NACRE_CASE=WORDS in the environment picks cases by name. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "drivers.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { LLVMPIPE = 1, SOFTPIPE = 3 }; /* of drivers[] */

static int side = 160;   /* pixels */
static scene_gles *gles; /* NULL: no such driver here */

static const char *mesh_of(const frame_case *c)
{
    return c->mesh ? c->mesh : "sphere";
}

typedef struct totals {
    int cases, failed, unsupported;
    double mean, pixels, beyond, uncovered, all;
} totals;

static void note(totals *t, const compare_result *r)
{
    t->mean += r->mean * (double)r->pixels;
    t->pixels += (double)r->pixels;
    t->beyond += (double)r->beyond;
    t->uncovered += (double)r->uncovered;
    t->all += side * side;
}

/* Within 2 codes but for these parts of the pixels. GLES filters textures in steps of 1/256, which shows near white, in
   linear light, with directions per pixel and with normal maps, where it is up to 6 codes off the double renderer (this
   one 3); outlines of parts before others are one pixel wide. */
static double beyond_of(const frame_case *c)
{
    const int plain = !c->mesh && !c->normal_map && !c->points && c->camera != CASE_PERSPECTIVE;

    return c->normal_map ? 0.08 : plain && c->output != NACRE_OUTPUT_LINEAR ? 0.004 : 0.05;
}

/* Pictures of lit spheres are read at the nearest texel: up to half a texel of 256 away, seen on flanks of highlights. */
static const compare_bound nearest_texel = {-12, 12, .01, .001};

static int against_double(const frame_case *c, const scene *s, const case_asset *asset, const image_u8 *actual)
{
    compare_bound bound = c->lit ? nearest_texel : *c->fp32;
    image_u8 expected;
    char name[200];
    failure f = {0};
    int ok;

    /* the plane's right edge is 1/100 pixel beyond a column of centres: vertices are held in 1/16 */
    if (bound.coverage > 0) bound.coverage = 0.006;
    snprintf(name, sizeof name, "soft: %s", c->name);
    scene_draw_double(s, asset->decoded, asset->albedo, c->normal_map ? &asset->normal_map : NULL, &expected, &f);
    ok = compare_frames(name, actual, &expected, c->mesh != NULL, &bound, NULL);
    image_u8_free(&expected);
    return ok;
}

static int against_gles(const frame_case *c, const scene *s, const case_asset *asset, const image_u8 *actual, totals *t)
{
    const compare_bound bound = {-2, 2, beyond_of(c), 0.006};
    char name[200];
    image_u8 expected;
    compare_result r = {0};
    failure f = {0};
    int ok;

    if (c->lit) return 1;
    if (scene_gles_draw(gles, s, &asset->material, &expected, &f)) {
        printf("%s: %s\n", c->name, f.text);
        return 0;
    }
    snprintf(name, sizeof name, "soft / gles: %s", c->name);
    ok = compare_frames(name, actual, &expected, c->mesh != NULL, &bound, &r);
    note(t, &r);
    image_u8_free(&expected);
    return ok;
}

static int run_case(const frame_case *c, int with_double, totals *t)
{
    image_u8 actual;
    case_asset asset;
    failure f = {0};
    scene s;
    mesh shape;
    int code, ok;

    assert_int_equal(mesh_open(&shape, mesh_of(c), &f), 0);
    case_asset_open(&asset, c->model, c->brdf, c->normal_map, NULL);
    case_scene(&s, c, &shape, side, side);
    code = scene_draw_soft(&s, &asset.material, &actual, &f);
    if (code) {
        printf("%s: %s\n", c->name, f.text);
        t->unsupported += code == FAIL_UNSUPPORTED;
        ok = code == FAIL_UNSUPPORTED;
    } else {
        ok = !with_double || against_double(c, &s, &asset, &actual);
        if (gles) ok &= against_gles(c, &s, &asset, &actual, t);
        image_u8_free(&actual);
        t->cases++;
    }
    case_asset_close(&asset);
    mesh_free(&shape);
    return ok;
}

static totals run_cases(int with_double, int step)
{
    const char *words = getenv("NACRE_CASE");
    totals t = {0};
    int i;

    for (i = 0; i < frame_case_count; i += step)
        if (!words || strstr(frame_cases[i].name, words)) t.failed += !run_case(&frame_cases[i], with_double, &t);
    printf("%d cases, %d unsupported, %d failed", t.cases, t.unsupported, t.failed);
    return t;
}

/* On all cases together coverage differs on less than 0.1 % of the pixels, and codes inside edges by .25 in the mean where
   texels are filtered as the double renderer does. softpipe takes its time: every third case, all with NACRE_LONG=1. */
static int run_driver(int index)
{
    const int soft = index == SOFTPIPE;
    failure f = {0};
    totals t;

    if (soft) side = 96;
    if (scene_gles_open(&gles, drivers[index].backend, side, side, &f)) {
        printf("SKIPPED: %s: %s\n", drivers[index].name, f.text);
        gles = NULL;
        if (soft) return DRIVER_SKIPPED;
    }
    t = run_cases(!soft, soft && !getenv("NACRE_LONG") && !getenv("NACRE_CASE") ? 3 : 1);
    if (!gles) return t.failed ? 1 : DRIVER_SKIPPED;
    printf("; against %s: mean %.3f, beyond 2: %.3f %%, coverage %.4f %%\n", drivers[index].name, t.mean / t.pixels,
           100 * t.beyond / t.pixels, 100 * t.uncovered / t.all);
    scene_gles_close(gles);
    return t.failed || t.mean > (soft ? 0.25 : 0.36) * t.pixels || t.beyond > (soft ? 0.003 : 0.005) * t.pixels ||
           t.uncovered > 0.001 * t.all;
}

static void frames(void **state)
{
    const int code = driver_run((int)(intptr_t)*state, "frames");

    if (code == DRIVER_SKIPPED) skip();
    assert_int_equal(code, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        {"against double and llvmpipe", frames, NULL, NULL, (void *)(intptr_t)LLVMPIPE},
        {"against softpipe", frames, NULL, NULL, (void *)(intptr_t)SOFTPIPE},
    };
    const char *argument;
    const int index = driver_of_arguments(argc, argv, &argument);

    return index >= 0 ? run_driver(index) : cmocka_run_group_tests(tests, NULL, NULL);
}
