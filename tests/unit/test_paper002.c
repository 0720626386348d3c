/* SPDX-License-Identifier: MIT */
/*
 * Mihalik & Durikovic 2015 over the embedded materials: how near the paper's method comes to the truth with 4 and 6 images of
 * 512 and 128 texels, beside the cosine-free images and the half-vector table. The common metric (metric.h), dB.
 *
 * NACRE_LONG=1: all embedded parameter sets instead of some of each class.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* before cmocka.h, which defines a macro fail() */
#include "metric.h"
#include "nacre_asset.h"
#include "sphere_bake.h"
#include "table_bake.h"

#include <cmocka.h>

#if defined __has_feature
#if __has_feature(address_sanitizer)
#define SLOW 1
#endif
#endif
#if defined __SANITIZE_ADDRESS__ || defined SLOW
enum { SLOW_BUILD = 1 }; /* sanitizers: one material is enough to see errors; figures come from the release build */
#else
enum { SLOW_BUILD = 0 };
#endif

/* Paint, fabric, plastic, phenolic, metallic paint, metal, rubber, wood, stone. */
static const char *const some[] = {
    "sgd:yellow-plastic",      "sgd:red-specular-plastic", "sgd:alum-bronze",
    "sgd:orange-paint",        "sgd:red-fabric",           "sgd:specular-violet-phenolic",
    "sgd:gold-metallic-paint", "sgd:chrome",               "sgd:neoprene-rubber",
    "sgd:cherry-235",          "sgd:black-obsidian",       "ngan-cook-torrance:blue-acrylic",
    "ngan-cook-torrance:nickel", "ngan-lafortune:pink-felt", "ngan-lafortune:brass",
    "lafortune:blue-house-paint"};

typedef struct tally {
    double sum, least;
    int count;
} tally;

static void add(tally *t, double db)
{
    t->least = !t->count || db < t->least ? db : t->least;
    t->sum += db;
    t->count++;
}

static double mean(const tally *t)
{
    return t->sum / t->count;
}

static brdf *open_name(const char *name)
{
    brdf *b = NULL;
    failure f = {0};
    if (brdf_open(&b, name, &f)) fail_msg("%s: %s", name, f.text);
    return b;
}

static void bake(sphere_asset *s, const brdf *b, const sphere_options *o)
{
    failure f = {0};
    if (sphere_bake(s, b, o, &f)) fail_msg("%s: %s", b->name, f.text);
}

static double pooled(const brdf *truth, brdf *drawn)
{
    metric_result result;
    metric_compare(truth, drawn, 0, &result);
    brdf_close(drawn);
    return result.pooled_psnr_db;
}

static double spheres_db(const brdf *b, sphere_mode mode, int images, int size)
{
    sphere_options o = {.mode = mode, .size = size, .no_mips = 1};
    if (images == 6) {
        o.polar_count = 6;
        for (int i = 0; i < 6; i++) o.polar[i] = 30 * i;
    }
    sphere_asset s;
    bake(&s, b, &o);
    double db = pooled(b, sphere_brdf(&s, NULL));
    sphere_free(&s);
    return db;
}

static double table_db(const brdf *b)
{
    table_asset t;
    failure f = {0};
    if (table_bake(&t, b, NULL, &f)) fail_msg("%s: %s", b->name, f.text);
    double db = pooled(b, table_brdf(&t));
    table_free(&t);
    return db;
}

enum { PAPER4, PAPER6, PAPER4_SMALL, PAPER6_SMALL, FREE4, FREE6, TABLE, COLUMNS };

static void figures(void **state)
{
    (void)state;
    static const char *const titles[COLUMNS] = {"paper 4x512", "paper 6x512", "paper 4x128", "paper 6x128",
                                                "free 4x256",  "free 6x256",  "table"};
    size_t count = sizeof some / sizeof *some;
    const char *const *names = some;
    tally t[COLUMNS] = {{0}};
    if (getenv("NACRE_LONG")) names = brdf_names(&count);
    if (SLOW_BUILD) count = 1;
    print_message("%-34s", "pooled PSNR, dB");
    for (int k = 0; k < COLUMNS; k++) print_message("%12s", titles[k]);
    for (size_t i = 0; i < count; i++) {
        brdf *b = open_name(names[i]);
        int big = SLOW_BUILD ? 64 : 512, middle = SLOW_BUILD ? 64 : 256, small = SLOW_BUILD ? 32 : 128;
        const double db[COLUMNS] = {spheres_db(b, SPHERE_PAPER, 4, big),
                                    spheres_db(b, SPHERE_PAPER, 6, big),
                                    spheres_db(b, SPHERE_PAPER, 4, small),
                                    spheres_db(b, SPHERE_PAPER, 6, small),
                                    spheres_db(b, SPHERE_COSINE_FREE, 4, middle),
                                    spheres_db(b, SPHERE_COSINE_FREE, 6, middle),
                                    table_db(b)};
        brdf_close(b);
        print_message("\n%-34s", names[i]);
        for (int k = 0; k < COLUMNS; k++) {
            print_message("%12.2f", db[k]);
            add(&t[k], db[k]);
        }
    }
    print_message("\n%-34s", "mean");
    for (int k = 0; k < COLUMNS; k++) print_message("%12.2f", mean(&t[k]));
    print_message("\n%-34s", "least");
    for (int k = 0; k < COLUMNS; k++) print_message("%12.2f", t[k].least);
    print_message("\n");
    if (SLOW_BUILD) return;
}

/* 51 dB at the stored angles for every embedded material; by default for those known as hardest. */
static void stored_angles(void **state)
{
    (void)state;
    static const char *const hardest[] = {"ngan-cook-torrance:hematite", "ngan-lafortune:steel", "lafortune:felt"};
    size_t count = sizeof hardest / sizeof *hardest;
    const char *const *names = hardest;
    tally t = {0};
    if (SLOW_BUILD) skip();
    if (getenv("NACRE_LONG")) names = brdf_names(&count);
    for (size_t i = 0; i < count; i++) {
        brdf *b = open_name(names[i]);
        sphere_options o = {.no_mips = 1};
        sphere_asset s;
        bake(&s, b, &o);
        brdf *d = sphere_brdf(&s, NULL);
        double exposure = brdf_exposure(b), sum = 0;
        for (int k = 0; k < s.layers; k++) {
            image_u8 truth, drawn;
            metric_frame(b, s.polar[k], exposure, METRIC_SIZE, &truth);
            metric_frame(d, s.polar[k], exposure, METRIC_SIZE, &drawn);
            sum += metric_mse(&truth, &drawn);
            image_u8_free(&truth);
            image_u8_free(&drawn);
        }
        double db = metric_psnr(sum / s.layers);
        add(&t, db);
        if (db < 51) fail_msg("%s: found %.2f dB at the stored angles, expected 51 or more", names[i], db);
        brdf_close(d);
        sphere_free(&s);
        brdf_close(b);
    }
    print_message("stored angles, %zu materials: mean %.2f, least %.2f dB\n", count, mean(&t), t.least);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures),
        cmocka_unit_test(stored_angles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
