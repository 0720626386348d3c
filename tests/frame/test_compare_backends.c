/* SPDX-License-Identifier: MIT */
/*
 * nacre compare through the shaders, on every driver, and by the CPU renderer. Directions reach the runtime in steps of 1/16384; normals and
 * positions are the metric's own, a quad per pixel. What a driver may cost, in dB of PSNR against the truth:
 *  - tables that do not ask for the linear toe of the sRGB curve are drawn without it: up to 2.3 codes low where it is nearly
 *    black. On material that is dark 2 stops down that is 4 dB of a table with 59; of one with 45 it is half a dB.
 *  - llvmpipe rounds each filtered texel to 8 bits once more, which is an error of the size of the table's own rounding;
 *    softpipe filters in floats, as GPUs do, and the CPU renderer in finer steps.
 *  - mediump is fp16 on three drivers: held to 0.3 dB of the same driver in fp32 on materials.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "compare_device.h"
#include "drivers.h"
#include "sphere_bake.h"
#include "table_bake.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { CASES = 5, FRAME_BYTES = METRIC_SIZE * METRIC_SIZE * 3, FP32 = 0, SOFTPIPE = 3, FP16 = 4 };

static char kept[] = "/tmp/nacre-compare-XXXXXX";

typedef enum asset_kind { DEFAULT_TABLE, FINE_TABLE, SPHERES } asset_kind;

/* What a driver may lose against the decoding in double, at the full light and 2 stops down, and how near to the decoded
   frames it must come: all in dB, pooled; of softpipe, of llvmpipe, and of the CPU renderer. */
static const struct {
    const char *brdf;
    asset_kind kind;
    double fov_deg;
    double loss[3], dim_loss[3], agreement[3];
} cases[CASES] = {
    /* n.l alone: shows that the geometry is exact to a fraction of a code */
    {"lambert:albedo=.5", DEFAULT_TABLE, 0, {0.5, 5.5, 0.8}, {2.2, 6, 0.9}, {70, 55.5, 63}},
    {"sgd:red-plastic", DEFAULT_TABLE, 40, {0.4, 5.2, 0.2}, {1.3, 4.8, 0.3}, {66, 52, 62}},
    /* so near to the truth in double, 53 and 60 dB, that most of what is left is the drivers' own rounding */
    {"sgd:chrome", DEFAULT_TABLE, 0, {0.5, 3, 0.1}, {2.6, 3.8, 0.3}, {62, 53, 64}},
    {"sgd:gold-metallic-paint", FINE_TABLE, 0, {2.1, 6.3, 0.9}, {6.2, 8, 1.1}, {61, 52, 62}},
    {"sgd:white-diffuse-bball", SPHERES, 0, {0.4, 1.2, 0.3}, {1.5, 2, 0.4}, {57, 55, 59}},
};

/* ---- a child draws and keeps all frames ------------------------------------------------------------------------------ */

static int draw_case(const compare_device *device, int index, double exposure, const char *directory, FILE *to)
{
    char path[300];
    compare_asset asset;
    metric_frames frames;
    failure f = {0};
    int code;

    snprintf(path, sizeof path, "%s/%d.ktx2", directory, index);
    code = compare_asset_open(&asset, path, &f);
    if (!code) code = compare_device_draw(&frames, device, &asset, exposure, cases[index].fov_deg, &f);
    if (code) {
        printf("%s: %s\n", cases[index].brdf, f.text);
        return code;
    }
    for (int i = 0; i < METRIC_LIGHTS * METRIC_FRAMES; i++)
        fwrite(frames.shown[i / METRIC_FRAMES][i % METRIC_FRAMES].texel, FRAME_BYTES, 1, to);
    metric_frames_free(&frames);
    compare_asset_close(&asset);
    return 0;
}

/* A place behind the drivers. */
static int soft_index(void)
{
    return driver_count;
}

static const char *name_of(int at)
{
    return at == soft_index() ? "soft" : drivers[at].name;
}

static FILE *open_kept(const char *directory, const char *name, int index, const char *mode)
{
    char path[300];

    snprintf(path, sizeof path, "%s/%s-%d", directory, name, index);
    return fopen(path, mode);
}

static int run_driver(int index, const char *directory)
{
    static const compare_backend backend[GL_BACKEND_COUNT] = {COMPARE_EGL2, COMPARE_EGL3, COMPARE_OSMESA};
    const struct driver *d = &drivers[index];
    compare_device *device;
    failure f = {0};
    double exposure[CASES];
    FILE *in = open_kept(directory, "exposures", 0, "rb"), *out;
    int failed = 0;

    if (!in || fread(exposure, sizeof exposure, 1, in) != 1) return 1;
    fclose(in);
    if (compare_device_open(&device, backend[d->backend], &f)) {
        printf("SKIPPED: driver %s: %s\n", d->name, f.text);
        return DRIVER_SKIPPED;
    }
    printf("%s: %s\n", d->name, compare_device_description(device));
    if (d->half && strstr(compare_device_description(device), "mediump is fp32")) {
        printf("SKIPPED: driver %s: mediump is fp32 on this machine (no F16C), no half floats to test\n", d->name);
        return DRIVER_SKIPPED;
    }
    failed += !strstr(compare_device_description(device), d->half ? "mediump is fp16" : "mediump is fp32");
    out = open_kept(directory, "frames", index, "wb");
    if (!out) return 1;
    for (int i = 0; i < CASES; i++) failed += draw_case(device, i, exposure[i], directory, out) != 0;
    compare_device_close(device);
    return failed || fclose(out) ? 1 : 0;
}

/* ---- the parent knows the truth --------------------------------------------------------------------------------------- */

typedef struct known {
    compare_truth truth;
    metric_frames decoded;
    compare_result exact;
} known;
static known all[CASES];

static int bake(bytes *file, const brdf *b, asset_kind kind, failure *f)
{
    int code;

    if (kind == SPHERES) {
        sphere_asset s = {0};
        code = sphere_bake(&s, b, &(sphere_options){.size = 128}, f);
        if (!code) sphere_write(&s, file);
        sphere_free(&s);
    } else {
        table_asset t = {0};
        code = table_bake(&t, b, &(table_options){.tier = kind == FINE_TABLE ? TABLE_FINE : TABLE_DEFAULT}, f);
        if (!code) table_write(&t, file);
        table_free(&t);
    }
    return code;
}

static int prepare_case(int index, failure *f)
{
    known *k = &all[index];
    char path[300];
    bytes file = {0};
    compare_asset asset;
    int code = compare_truth_open(&k->truth, cases[index].brdf, cases[index].fov_deg, f);

    if (!code) code = bake(&file, k->truth.b, cases[index].kind, f);
    snprintf(path, sizeof path, "%s/%d.ktx2", kept, index);
    if (!code) code = output_write(path, &file, f);
    if (!code) code = compare_asset_take(&asset, &file, "asset", f);
    if (!code) code = compare_run(&k->exact, &k->decoded, &k->truth, &asset, NULL, f);
    if (!code) compare_asset_close(&asset);
    return code;
}

static int prepare(void **state)
{
    double exposure[CASES];
    failure f = {0};
    FILE *out;

    (void)state;
    if (!mkdtemp(kept)) return 1;
    for (int i = 0; i < CASES; i++) {
        if (prepare_case(i, &f)) {
            print_error("%s: %s\n", cases[i].brdf, f.text);
            return 1;
        }
        exposure[i] = all[i].truth.exposure;
    }
    out = open_kept(kept, "exposures", 0, "wb");
    return !out || fwrite(exposure, sizeof exposure, 1, out) != 1 || fclose(out);
}

static int end(void **state)
{
    (void)state;
    for (int i = 0; i < CASES; i++) {
        compare_truth_close(&all[i].truth);
        metric_frames_free(&all[i].decoded);
    }
    driver_remove_directory(kept);
    return 0;
}

static void test_draw(void **state)
{
    int code = driver_run((int)(intptr_t)*state, kept);

    if (code == DRIVER_SKIPPED) skip();
    assert_int_equal(code, 0);
}

/* In this process: it needs no driver. */
static void soft_draws(void **state)
{
    compare_device *device;
    failure f = {0};
    FILE *out = open_kept(kept, "frames", soft_index(), "wb");

    (void)state;
    assert_non_null(out);
    assert_int_equal(compare_device_open(&device, COMPARE_SOFT, &f), 0);
    for (int i = 0; i < CASES; i++) assert_int_equal(draw_case(device, i, all[i].truth.exposure, kept, out), 0);
    compare_device_close(device);
    assert_int_equal(fclose(out), 0);
}

/* Frames of a driver and a case; 0 where the driver was skipped. */
static int read_frames(metric_frames *out, int at, int index)
{
    FILE *in = open_kept(kept, "frames", at, "rb");

    *out = (metric_frames){0};
    if (!in) return 0;
    assert_int_equal(fseek(in, (long)index * METRIC_LIGHTS * METRIC_FRAMES * FRAME_BYTES, SEEK_SET), 0);
    for (int i = 0; i < METRIC_LIGHTS * METRIC_FRAMES; i++) {
        image_u8 *frame = &out->shown[i / METRIC_FRAMES][i % METRIC_FRAMES];
        *frame = image_u8_make(METRIC_SIZE, METRIC_SIZE, 3);
        assert_int_equal(fread(frame->texel, FRAME_BYTES, 1, in), 1);
    }
    fclose(in);
    return 1;
}

static int check_case(int at, int index)
{
    const known *k = &all[index];
    int who = at == SOFTPIPE ? 0 : at == soft_index() ? 2 : 1, ok;
    metric_frames drawn;
    metric_result full, dim, between;

    if (!read_frames(&drawn, at, index)) return 1;
    metric_score(&full, &k->truth.frames, &drawn, METRIC_FULL);
    metric_score(&dim, &k->truth.frames, &drawn, METRIC_DIM);
    metric_score(&between, &k->decoded, &drawn, METRIC_FULL);
    metric_frames_free(&drawn);
    ok = full.pooled_psnr_db >= k->exact.full.pooled_psnr_db - cases[index].loss[who] &&
         dim.pooled_psnr_db >= k->exact.dim.pooled_psnr_db - cases[index].dim_loss[who] &&
         between.pooled_psnr_db >= cases[index].agreement[who];
    print_message("%-17s %-24s %.2f / %.2f dB, in double %.2f / %.2f; each other %.2f dB%s\n", name_of(at),
                  cases[index].brdf, full.pooled_psnr_db, dim.pooled_psnr_db, k->exact.full.pooled_psnr_db,
                  k->exact.dim.pooled_psnr_db, between.pooled_psnr_db, ok ? "" : "  OUT OF BOUNDS");
    return ok;
}

static void figures_are_those_of_double(void **state)
{
    int failed = 0;

    (void)state;
    for (int at = 0; at <= soft_index(); at++)
        for (int i = 0; i < CASES; i++) failed += !check_case(at, i);
    assert_int_equal(failed, 0);
}

/* The pooled PSNR of one driver under two settings, and between contexts that do the same. */
static double pooled(int at, int index)
{
    metric_frames drawn;
    metric_result r;

    if (!read_frames(&drawn, at, index)) return -1;
    metric_score(&r, &all[index].truth.frames, &drawn, METRIC_FULL);
    metric_frames_free(&drawn);
    return r.pooled_psnr_db;
}

static void contexts_of_one_driver_agree(void **state)
{
    static const int pair[][2] = {{0, 1}, {0, 2}, {4, 5}, {4, 6}}; /* OSMesa, ES 2, ES 3 of llvmpipe */

    (void)state;
    for (size_t p = 0; p < sizeof pair / sizeof *pair; p++)
        for (int i = 0; i < CASES; i++) {
            double a = pooled(pair[p][0], i), b = pooled(pair[p][1], i);
            if (a >= 0 && b >= 0) assert_true(fabs(a - b) < 0.02);
        }
}

/* A little over half a dB for the lambertian sphere at 56 dB, a tenth or two for what a material has. */
static void half_floats_cost_little(void **state)
{
    (void)state;
    for (int i = 0; i < CASES; i++) {
        double fp32 = pooled(FP32, i), fp16 = pooled(FP16, i);
        if (fp32 >= 0 && fp16 >= 0) assert_true(fp16 > fp32 - (i ? 0.3 : 0.7));
    }
}

int main(int argc, char **argv)
{
    const char *directory;
    int index = driver_of_arguments(argc, argv, &directory);
    struct CMUnitTest tests[16];
    int count = 0;

    if (index >= 0) return run_driver(index, directory);
    for (int i = 0; i < driver_count; i++)
        tests[count++] = (struct CMUnitTest){drivers[i].name, test_draw, NULL, NULL, (void *)(intptr_t)i};
    tests[count++] = (struct CMUnitTest)cmocka_unit_test(soft_draws);
    tests[count++] = (struct CMUnitTest)cmocka_unit_test(figures_are_those_of_double);
    tests[count++] = (struct CMUnitTest)cmocka_unit_test(contexts_of_one_driver_agree);
    tests[count++] = (struct CMUnitTest)cmocka_unit_test(half_floats_cost_little);
    return _cmocka_run_group_tests("compare on every driver", tests, (size_t)count, prepare, end);
}
