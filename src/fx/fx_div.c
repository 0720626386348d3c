/* SPDX-License-Identifier: MIT */
/* What divides: for set-up values only, many targets have no divider. */
#include "fx.h"

static uint64_t magnitude(int64_t x)
{
    return x < 0 ? 0 - (uint64_t)x : (uint64_t)x;
}

int64_t fx_div(int64_t a, int64_t b)
{
    const uint64_t n = magnitude(a), d = magnitude(b);
    const uint64_t whole = n / d, rest = n - whole * d;
    const uint64_t rounded = whole + (rest >= d - rest);
    const int64_t out = rounded > INT64_MAX ? INT64_MAX : (int64_t)rounded;

    return (a < 0) != (b < 0) ? -out : out;
}

int fx_normalize_q28(const int64_t v[3], int32_t out[3])
{
    const uint64_t largest = magnitude(v[0]) | magnitude(v[1]) | magnitude(v[2]);
    int64_t scaled[3];
    uint64_t sum = 0;
    int shift, i;

    if (!largest) return 0;
    shift = fx_top_bit(largest) - 29; /* parts below 2^30: the sum of squares stays below 2^62 */
    for (i = 0; i < 3; i++) {
        scaled[i] = shift > 0 ? fx_shift(v[i], shift) : v[i] * ((int64_t)1 << -shift);
        sum += (uint64_t)(scaled[i] * scaled[i]);
    }
    for (i = 0; i < 3; i++) out[i] = (int32_t)fx_div(scaled[i] * FX_Q28_ONE, fx_isqrt(sum));
    return 1;
}

int32_t fx_dot_q28(const int32_t a[3], const int32_t b[3])
{
    return (int32_t)fx_shift((int64_t)a[0] * b[0] + (int64_t)a[1] * b[1] + (int64_t)a[2] * b[2], 28);
}

uint32_t fx_reciprocal(uint32_t x)
{
    /* 17 bits by division, the others by one step of Newton's method */
    const uint64_t first = (uint64_t)(0xFFFFFFFFu / (x >> 16)) << 14;
    const int64_t error = (int64_t)(((uint64_t)1 << 62) - first * x);

    const int64_t refined = (int64_t)first + (((error >> 31) * (int64_t)first) >> 31);

    return (uint32_t)(refined > INT32_MAX ? INT32_MAX : refined);
}
