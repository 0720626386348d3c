/* SPDX-License-Identifier: MIT */
/*
 * What half floats cost: tables drawn by ES 2.0 in mediump = fp16 against the decoding of the same files in double, both
 * compared with the truth. llvmpipe is told to filter texels in floats, as GPUs do, instead of 8 bits once more. Bound: half
 * a dB, of materials near and far from black; the linear toe of the sRGB curve, which the dark ones' files ask for, is
 * shown to be worth it by the same files without that key.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "compare_device.h"
#include "drivers.h"
#include "table_bake.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { HALF_FLOATS = 5 }; /* of drivers[]: ES 2.0, mediump is fp16 */
static const double most_lost = 0.5;

/* without: what the program without the toe loses at least, dB; 0 where files don't ask for it. */
static const struct {
    const char *brdf;
    double fov_deg, without;
} cases[] = {
    {"sgd:black-phenolic", 0, 2},
    {"sgd:color-changing-paint3", 0, 1},
    {"sgd:black-oxidized-steel", 0, 0.6},
    {"sgd:black-obsidian", 30, 0.5},
    {"sgd:chrome", 30, 0.3},
    {"sgd:green-acrylic", 0, 0},
};

/* The table as a file in memory, and as an asset; toe: 0 takes the key away. */
static int open_table(compare_asset *out, const brdf *b, int toe, int *asked, failure *f)
{
    table_asset t = {0};
    bytes file = {0};
    int code = table_bake(&t, b, NULL, f);

    if (code) return code;
    *asked = t.toe;
    t.toe = t.toe && toe;
    table_write(&t, &file);
    table_free(&t);
    return compare_asset_take(out, &file, "table", f);
}

/* dB that device loses against double; 99 on failure. */
static double lost(compare_device *device, const compare_truth *truth, int toe, int *asked, failure *f)
{
    compare_asset asset;
    compare_result exact, drawn;

    if (open_table(&asset, truth->b, toe, asked, f)) return 99;
    int code = compare_run(&exact, NULL, truth, &asset, NULL, f);
    if (!code) code = compare_run(&drawn, NULL, truth, &asset, device, f);
    compare_asset_close(&asset);
    return code ? 99 : exact.full.pooled_psnr_db - drawn.full.pooled_psnr_db;
}

static int run_case(compare_device *device, size_t i)
{
    compare_truth truth;
    failure f = {0};
    int asked, ok;

    if (compare_truth_open(&truth, cases[i].brdf, cases[i].fov_deg, &f)) {
        printf("%s: %s\n", cases[i].brdf, f.text);
        return 0;
    }
    const double with = lost(device, &truth, 1, &asked, &f);
    const double without = cases[i].without > 0 ? lost(device, &truth, 0, &asked, &f) : 0;
    ok = with <= most_lost && without >= cases[i].without && asked == (cases[i].without > 0);
    printf("%-28s %2.0f degrees: %5.2f dB lost, %5.2f without the toe %s%s\n", cases[i].brdf, cases[i].fov_deg, with,
           without, f.text, ok ? "" : "  OUT OF BOUNDS");
    compare_truth_close(&truth);
    return ok;
}

static int run_driver(void)
{
    compare_device *device;
    failure f = {0};
    int failed = 0;

    if (compare_device_open(&device, COMPARE_EGL2, &f)) {
        printf("SKIPPED: %s\n", f.text);
        return DRIVER_SKIPPED;
    }
    if (strstr(compare_device_description(device), "mediump is fp32")) {
        printf("SKIPPED: mediump is fp32 on this machine (no F16C), no half floats to test\n");
        return DRIVER_SKIPPED;
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) failed += !run_case(device, i);
    compare_device_close(device);
    return failed ? 1 : 0;
}

static void half_floats_lose_little(void **state)
{
    (void)state;
    assert_int_equal(setenv("GALLIVM_PERF", "no_aos_sampling", 1), 0);
    const int code = driver_run(HALF_FLOATS, "");

    if (code == DRIVER_SKIPPED) skip();
    assert_int_equal(code, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(half_floats_lose_little)};
    const char *argument;

    if (driver_of_arguments(argc, argv, &argument) >= 0) return run_driver();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
