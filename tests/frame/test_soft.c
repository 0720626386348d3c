/* SPDX-License-Identifier: MIT */
/* The case table (tests/support/cases.c) by the CPU renderer: against the double renderer's decoding of the same file, and
   against the GLES backend at highp. NACRE_CASE=WORDS in the environment picks cases by name. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { SIZE = 160 };

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
    t->all += SIZE * SIZE;
}

/* Within 2 codes but for these parts of the pixels. GLES filters textures in steps of 1/256, which shows near white, in
   linear light, with directions per pixel and with normal maps, where it is up to 6 codes off the double renderer (this
   one 3); outlines of parts before others are one pixel wide. */
static double beyond_of(const frame_case *c)
{
    const int plain = !c->mesh && !c->normal_map && !c->points && c->camera != CASE_PERSPECTIVE;

    return c->normal_map ? 0.08 : plain && c->output != NACRE_OUTPUT_LINEAR ? 0.004 : 0.05;
}

static int against_gles(const frame_case *c, const scene *s, const nacre_material *material, const image_u8 *actual,
                        totals *t)
{
    const compare_bound bound = {-2, 2, beyond_of(c), 0.006};
    char name[200];
    image_u8 expected;
    compare_result r = {0};
    failure f = {0};
    int ok;

    if (!gles) return 1;
    if (scene_gles_draw(gles, s, material, &expected, &f)) {
        printf("%s: %s\n", c->name, f.text);
        return 0;
    }
    snprintf(name, sizeof name, "soft / gles: %s", c->name);
    ok = compare_frames(name, actual, &expected, c->mesh != NULL, &bound, &r);
    note(t, &r);
    image_u8_free(&expected);
    return ok;
}

/* Pictures of lit spheres are read at the nearest texel: up to half a texel of 256 away, seen on flanks of highlights. */
static const compare_bound nearest_texel = {-12, 12, .01, .001};

static int run_case(const frame_case *c, totals *t)
{
    char name[200];
    image_u8 actual, expected;
    case_asset asset;
    compare_bound bound;
    failure f = {0};
    scene s;
    mesh shape;
    int code, ok = 1;

    assert_int_equal(mesh_open(&shape, mesh_of(c), &f), 0);
    case_asset_open(&asset, c->model, c->brdf, c->normal_map, NULL);
    case_scene(&s, c, &shape, SIZE, SIZE);
    code = scene_draw_soft(&s, &asset.material, &actual, &f);
    if (code) {
        printf("%s: %s\n", c->name, f.text);
        t->unsupported += code == FAIL_UNSUPPORTED;
        ok = code == FAIL_UNSUPPORTED;
    } else {
        snprintf(name, sizeof name, "soft: %s", c->name);
        scene_draw_double(&s, asset.decoded, asset.albedo, c->normal_map ? &asset.normal_map : NULL, &expected, &f);
        bound = c->lit ? nearest_texel : *c->fp32;
        /* the plane's right edge is 1/100 pixel beyond a column of centres: vertices are held in 1/16 */
        if (bound.coverage > 0) bound.coverage = 0.006;
        ok = compare_frames(name, &actual, &expected, c->mesh != NULL, &bound, NULL);
        if (!c->lit) ok &= against_gles(c, &s, &asset.material, &actual, t);
        image_u8_free(&actual);
        image_u8_free(&expected);
        t->cases++;
    }
    case_asset_close(&asset);
    mesh_free(&shape);
    return ok;
}

static void frames(void **state)
{
    const char *words = getenv("NACRE_CASE");
    totals t = {0};
    int i;

    (void)state;
    for (i = 0; i < frame_case_count; i++)
        if (!words || strstr(frame_cases[i].name, words)) t.failed += !run_case(&frame_cases[i], &t);
    print_message("%d cases, %d unsupported", t.cases, t.unsupported);
    if (t.pixels > 0)
        print_message("; against GLES: mean %.3f, beyond 2: %.4f %%, coverage %.4f %%", t.mean / t.pixels,
                      100 * t.beyond / t.pixels, 100 * t.uncovered / t.all);
    print_message("\n");
    assert_int_equal(t.failed, 0);
    if (!gles) skip();
    assert_true(t.mean <= 0.40 * t.pixels);
    assert_true(t.uncovered <= 0.001 * t.all);
}

static int open_gles(void **state)
{
    failure f = {0};

    (void)state;
    if (!scene_gles_open(&gles, GL_BACKEND_EGL2, SIZE, SIZE, &f)) return 0;
    print_message("SKIPPED against GLES: %s\n", f.text);
    gles = NULL;
    return 0;
}

static int close_gles(void **state)
{
    (void)state;
    scene_gles_close(gles);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames)};

    setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1", 0); /* mediump as fp32 */
    return cmocka_run_group_tests(tests, open_gles, close_gles);
}
