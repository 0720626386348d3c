/* SPDX-License-Identifier: MIT */
/* Mip levels: closed forms. Values are small dyadic fractions, so that every mean is exact in float. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "mip.h"

#include <cmocka.h>

static void counts(void **state)
{
    (void)state;
    assert_int_equal(mip_count(1, 1), 1);
    assert_int_equal(mip_count(256, 256), 9);
    assert_int_equal(mip_count(2048, 2048), 12);
    assert_int_equal(mip_count(64, 4), 7);
    assert_int_equal(mip_count(240, 240), 1); /* no power of two: no mips in GLES 2 */
    assert_int_equal(mip_count(256, 100), 1);
}

static void constant_stays_constant(void **state)
{
    (void)state;
    float texel[16 * 16 * 3], coverage[16 * 16];
    for (int i = 0; i < 16 * 16 * 3; i++) texel[i] = 0.375F * (float)(i % 3 + 1);
    for (int i = 0; i < 16 * 16; i++) coverage[i] = (float)(i % 5) / 4;
    for (int size = 16; size > 1; size /= 2) {
        mip_halve(texel, coverage, size, size, 3, texel, coverage);
        /* weights w / sum(w) add up to 1 within a few units of double; one rounding to float */
        for (int i = 0; i < size * size / 4 * 3; i++) assert_float_equal(texel[i], 0.375F * (float)(i % 3 + 1), 1e-6);
    }
}

static void means(void **state)
{
    (void)state;
    const float texel[8] = {1, 2, 3, 4, 5, 6, 7, 8}; /* 4 x 2, one channel */
    float out[2], out_coverage[2];
    mip_halve(texel, NULL, 4, 2, 1, out, out_coverage);
    assert_float_equal(out[0], (1 + 2 + 5 + 6) / 4.0, 0);
    assert_float_equal(out[1], (3 + 4 + 7 + 8) / 4.0, 0);
    assert_float_equal(out_coverage[0], 1, 0);

    float row[4] = {1, 3, 5, 9}; /* 4 x 1, then 2 x 1 */
    mip_halve(row, NULL, 4, 1, 1, row, NULL);
    assert_float_equal(row[0], 2, 0);
    assert_float_equal(row[1], 7, 0);
    mip_halve(row, NULL, 2, 1, 1, row, NULL);
    assert_float_equal(row[0], 4.5, 0);

    float column[2] = {1, 4}; /* 1 x 2 */
    mip_halve(column, NULL, 1, 2, 1, column, NULL);
    assert_float_equal(column[0], 2.5, 0);
}

static void coverage_weighs(void **state)
{
    (void)state;
    const float texel[4] = {8, 100, 16, 100}, half[4] = {1, 0, 0.5F, 0}, none[4] = {0, 0, 0, 0};
    float out, coverage;
    mip_halve(texel, half, 2, 2, 1, &out, &coverage);
    assert_float_equal(out, (8 * 1 + 16 * 0.5) / 1.5, 1e-6);
    assert_float_equal(coverage, 1.5 / 4, 0);
    mip_halve(texel, none, 2, 2, 1, &out, &coverage);
    assert_float_equal(out, (8 + 100 + 16 + 100) / 4.0, 0);
    assert_float_equal(coverage, 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts),
        cmocka_unit_test(constant_stays_constant),
        cmocka_unit_test(means),
        cmocka_unit_test(coverage_weighs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
