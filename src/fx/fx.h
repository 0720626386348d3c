/* SPDX-License-Identifier: MIT */
/*
 * fx - numbers without float: logarithms, roots and angles in integers, and a wide-range number for set-up values
 *
 * Every function is pure. "worst" is the largest error over the whole range, as tests/unit/test_fx.c checks it.
 * Right shifts of negative numbers are arithmetic on every compiler this is built with, and are relied on.
 */
#ifndef FX_H
#define FX_H

#include <stdint.h>

#include "nacre.h"

#define FX_Q28_ONE   268435456
#define FX_BAM_HALF  32768         /* 180 degrees */
#define FX_LOG2_ZERO (-64 * 65536) /* fx_log2_q16 and fx_real_log2_q16 of 0: exp2 of it is as good as nothing */

/* x * 2^-shift rounded to nearest (halves up), shift 1..62; |x| < 2^62. */
static inline int64_t fx_shift(int64_t x, int shift)
{
    return (x + ((int64_t)1 << (shift - 1))) >> shift;
}

/* A function that is not put into its caller, whose frame would have to hold the variables of both. */
#if defined(__GNUC__)
#define FX_APART __attribute__((noinline))
#else
#define FX_APART
#endif

/* Zeros above the highest bit set, 0..31; x > 0. For per-pixel use. */
static inline int fx_leading_zeros(uint32_t x)
{
#if defined(__GNUC__)
    return __builtin_clz(x);
#else
    int zeros = 0;

    for (; !(x >> 31); x <<= 1) zeros++;
    return zeros;
#endif
}

/* Number of the highest bit set, 0..63; x > 0. */
int fx_top_bit(uint64_t x);

/* floor(sqrt(x)), exact. */
uint32_t fx_isqrt(uint64_t x);

/* log2 of the integer x > 0, in q16: 0 .. 64 * 65536; worst 0.51 ulp (ulp: 2^-16). log2 of a q16 is this minus 16 * 65536. */
int32_t fx_log2_u64(uint64_t x);

/* log2 of a q16, in q16; FX_LOG2_ZERO for 0 and below. worst 0.51 ulp. */
int32_t fx_log2_q16(nacre_q16 x);

/* sin and cos of a turn in 2^-32 units (a bam is the upper 16 bits), q28; worst 2^-27. */
int32_t fx_sin_q28(uint32_t turn);
int32_t fx_cos_q28(uint32_t turn);

/* Angle of (x, y) counter-clockwise from +x, in 2^-32 turns; 0 for (0, 0). worst 2^-28 turns. */
uint32_t fx_atan2(int64_t y, int64_t x);

/* a / b to nearest, b != 0; saturates at +-INT64_MAX. Set-up only: many targets have no divider. */
int64_t fx_div(int64_t a, int64_t b);

/* 2^62 / x for x with its highest bit set: 2^30 .. 2^31. worst relative 2^-29. Set-up only. */
uint32_t fx_reciprocal(uint32_t x);

/* v scaled to length 1 in q28; 0 and v untouched if it has no length. |v| < 2^60 per part. worst 1 ulp per part. */
int fx_normalize_q28(const int64_t v[3], int32_t out[3]);

/* Sum of products of q28 parts, in q28. worst 0.5 ulp. */
int32_t fx_dot_q28(const int32_t a[3], const int32_t b[3]);

/* ---- m x 2^e: what becomes one GLfloat -------------------------------------------------------- */

typedef struct fx_real {
    int32_t m; /* 0, or 2^29 <= |m| < 2^30 */
    int32_t e;
} fx_real;

/* x * 2^e, x any integer; relative error 2^-30. */
fx_real fx_real_make(int64_t x, int e);
/* 2^(log2_q16 / 65536): relative error 2^-26; exponents below -63 give 0. */
fx_real fx_real_exp2(int64_t log2_q16);
/* FX_LOG2_ZERO for m <= 0. worst 0.51 ulp of q16. */
int32_t fx_real_log2_q16(fx_real x);
fx_real fx_real_mul(fx_real a, fx_real b);
/* To a fixed number with so many fractional bits (0..30), to nearest, saturating at +-INT32_MAX. */
int32_t fx_real_fixed(fx_real x, int fraction_bits);

#endif
