/* SPDX-License-Identifier: MIT */
/* Integer functions against libm, over their whole ranges, with the worst errors that fx.h states. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "fx.h"

#include <cmocka.h>

#define PI 3.14159265358979323846

/* Deterministic 64-bit numbers (an xorshift generator). */
static uint64_t state = 88172645463325252u;
static uint64_t next(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    return state ^= state << 17;
}

/* Numbers of every magnitude: a random number of random bits. */
static uint64_t any_size(void)
{
    const uint64_t bits = next();

    return next() >> (bits % 64);
}

static double worst, worst_at;
static void note(double error, double at)
{
    if (!(fabs(error) <= worst)) {
        worst = fabs(error);
        worst_at = at;
    }
}

static void check(const char *what, double limit)
{
    printf("%-12s worst error %.4g of %.4g, at %.10g\n", what, worst, limit, worst_at);
    assert_true(worst <= limit);
    worst = worst_at = 0;
}

static void top_bit_finds_every_bit(void **unused)
{
    (void)unused;
    for (int i = 0; i < 64; i++) {
        assert_int_equal(fx_top_bit((uint64_t)1 << i), i);
        assert_int_equal(fx_top_bit(UINT64_MAX >> (63 - i)), i);
    }
}

static void isqrt_is_exact(void **unused)
{
    (void)unused;
    for (uint64_t i = 0; i < 200000; i++) {
        const uint64_t x = i < 1000 ? i : i < 2000 ? UINT64_MAX - (i - 1000) : any_size(), r = fx_isqrt(x);

        assert_true(r * r <= x);
        assert_true(r == UINT32_MAX || (r + 1) * (r + 1) > x);
    }
}

static void logarithm(void **unused)
{
    (void)unused;
    for (uint32_t i = 0; i < 400000; i++) {
        const uint64_t x = i < 100000 ? i + 1 : any_size() | 1;

        note(fx_log2_u64(x) - (double)log2l((long double)x) * 65536, (double)x);
    }
    check("log2_u64", 0.51);
    assert_int_equal(fx_log2_u64(UINT64_MAX), 64 * 65536);
    for (uint32_t i = 0; i < 200000; i++) {
        const nacre_q16 x = (nacre_q16)(i < 100000 ? i + 1 : (any_size() >> 33) + 1);

        note(fx_log2_q16(x) - log2(x / 65536.) * 65536, x);
    }
    check("log2_q16", 0.51);
    assert_int_equal(fx_log2_q16(0), FX_LOG2_ZERO);
    assert_int_equal(fx_log2_q16(-1), FX_LOG2_ZERO);
}

static double value(fx_real x)
{
    return ldexp(x.m, x.e);
}

static void exponential(void **unused)
{
    (void)unused;
    for (int32_t i = -63 * 65536; i <= 63 * 65536; i += 7) note(value(fx_real_exp2(i)) / exp2(i / 65536.) - 1, i);
    for (int32_t i = 0; i < 65536; i++) note(value(fx_real_exp2(i)) / exp2(i / 65536.) - 1, i);
    check("exp2", 1. / (1 << 26));
    assert_int_equal(fx_real_exp2(-64 * 65536).m, 0);
    assert_int_equal(fx_real_exp2((int64_t)FX_LOG2_ZERO * 8).m, 0);
}

static void sine_and_cosine(void **unused)
{
    (void)unused;
    for (uint32_t i = 0; i < 1000000; i++) {
        const uint32_t turn = i < 65536 * 8 ? i << 13 : (uint32_t)next();

        note(fx_sin_q28(turn) / 268435456. - sin(turn * (PI / 2147483648.)), turn);
        note(fx_cos_q28(turn) / 268435456. - cos(turn * (PI / 2147483648.)), turn);
    }
    check("sin, cos", 1. / (1 << 27));
    assert_int_equal(fx_sin_q28(0), 0);
    assert_int_equal(fx_sin_q28(1u << 30), FX_Q28_ONE);
    assert_int_equal(fx_cos_q28(0), FX_Q28_ONE);
    assert_int_equal(fx_cos_q28(1u << 31), -FX_Q28_ONE);
}

static int64_t signed_any_size(void)
{
    const int64_t x = (int64_t)(any_size() >> 1);

    return next() & 1 ? -x : x;
}

static void arctangent(void **unused)
{
    (void)unused;
    for (uint32_t i = 0; i < 400000; i++) {
        const int64_t y = signed_any_size(), x = signed_any_size();
        const double exact = atan2((double)y, (double)x) / (2 * PI);
        double error = fx_atan2(y, x) / 4294967296. - exact;

        error -= round(error);
        note(error, (double)y);
    }
    check("atan2, turns", 1. / (1 << 28));
    assert_int_equal(fx_atan2(0, 0), 0);
    assert_int_equal(fx_atan2(0, 5), 0);
    assert_int_equal(fx_atan2(0, -5), 0x80000000u);
    assert_true(fx_atan2(1, INT64_MAX) < 1000); /* not a whole turn */
}

static void division_rounds(void **unused)
{
    (void)unused;
    assert_int_equal(fx_div(7, 2), 4);
    assert_int_equal(fx_div(-7, 2), -4);
    assert_int_equal(fx_div(5, -3), -2);
    assert_int_equal(fx_div(4, 3), 1);
    assert_int_equal(fx_div(INT64_MIN, -1), INT64_MAX);
    assert_int_equal(fx_div(INT64_MIN + 1, 1), -INT64_MAX);
    for (uint32_t i = 0; i < 100000; i++) {
        const int64_t a = signed_any_size() >> 10, b = signed_any_size() | 1;
        const long double exact = (long double)a / (long double)b;

        note((double)((long double)fx_div(a, b) - exact), (double)a);
    }
    check("div", 0.5 + 1e-4);
}

static void normalizing(void **unused)
{
    (void)unused;
    for (uint32_t i = 0; i < 100000; i++) {
        int64_t v[3];
        int32_t unit[3];

        for (int k = 0; k < 3; k++) v[k] = signed_any_size() >> 4;
        if (!fx_normalize_q28(v, unit)) continue;
        const double length = sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
        for (int k = 0; k < 3; k++) note(unit[k] - v[k] / length * 268435456., i);
    }
    check("normalize", 1);
    const int64_t none[3] = {0, 0, 0};
    int32_t kept[3] = {1, 2, 3};
    assert_int_equal(fx_normalize_q28(none, kept), 0);
    assert_int_equal(kept[1], 2);
}

static void wide_numbers(void **unused)
{
    (void)unused;
    for (uint32_t i = 0; i < 200000; i++) {
        const int64_t x = signed_any_size() | 1, y = signed_any_size() | 1;
        const int e = (int)(next() % 80) - 40;
        const fx_real a = fx_real_make(x, e), b = fx_real_make(y, -e);

        assert_true(abs(a.m) >= 1 << 29 && abs(a.m) < 1 << 30);
        note(value(a) / ldexp((double)x, e) - 1, (double)x);
        note((value(fx_real_mul(a, b)) / ((double)x * (double)y) - 1) / 3, (double)x);
    }
    check("real", 1. / (1 << 30) * 1.001);
    assert_int_equal(fx_real_make(0, 5).m, 0);
    for (uint32_t i = 0; i < 100000; i++) {
        const fx_real a = fx_real_make((int64_t)(any_size() >> 1) | 1, -30);

        note(fx_real_log2_q16(a) - log2(value(a)) * 65536, value(a));
    }
    check("real log2", 0.51);
    assert_int_equal(fx_real_log2_q16(fx_real_make(-3, 0)), FX_LOG2_ZERO);
    assert_int_equal(fx_real_fixed(fx_real_make(3, -1), 16), 98304);
    assert_int_equal(fx_real_fixed(fx_real_make(-3, -1), 16), -98304);
    assert_int_equal(fx_real_fixed(fx_real_make(1, 40), 16), INT32_MAX);
    assert_int_equal(fx_real_fixed(fx_real_make(-1, 40), 16), -INT32_MAX);
    assert_int_equal(fx_real_fixed(fx_real_make(1, -40), 16), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(top_bit_finds_every_bit),
        cmocka_unit_test(isqrt_is_exact),
        cmocka_unit_test(logarithm),
        cmocka_unit_test(exponential),
        cmocka_unit_test(sine_and_cosine),
        cmocka_unit_test(arctangent),
        cmocka_unit_test(division_rounds),
        cmocka_unit_test(normalizing),
        cmocka_unit_test(wide_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
