/* SPDX-License-Identifier: MIT */
#include "fx.h"

int fx_top_bit(uint64_t x)
{
#if defined(__GNUC__)
    return x >> 32 ? 63 - __builtin_clz((uint32_t)(x >> 32)) : 31 - __builtin_clz((uint32_t)x);
#else
    int bit = 0, step;

    for (step = 32; step; step >>= 1)
        if (x >> step) {
            x >>= step;
            bit += step;
        }
    return bit;
#endif
}

int32_t fx_log2_u64(uint64_t x)
{
    const int top = fx_top_bit(x);
    uint64_t m = top > 31 ? x >> (top - 31) : x << (31 - top); /* 1..2 in q31 */
    int32_t bits = 0;
    int i;

    /* Squaring doubles the logarithm: its next binary digit is whether the square reaches 2. One digit more than q16
       keeps, to round. */
    for (i = 0; i < 17; i++) {
        m = m * m >> 31;
        bits <<= 1;
        if (m >> 32) {
            m >>= 1;
            bits |= 1;
        }
    }
    return (int32_t)top * 65536 + ((bits + 1) >> 1);
}

int32_t fx_log2_q16(nacre_q16 x)
{
    return x > 0 ? fx_log2_u64((uint64_t)x) - 16 * 65536 : FX_LOG2_ZERO;
}

/* 2^(2^-i) in q30, i = 1..16: round(2^30 * 2^(1 / 2^i)). */
static const uint32_t root_of_two_q30[16] = {1518500250, 1276901417, 1170923762, 1121280436, 1097253708, 1085434106,
                                             1079572136, 1076653033, 1075196443, 1074468888, 1074105294, 1073923544,
                                             1073832680, 1073787251, 1073764537, 1073753181};

fx_real fx_real_exp2(int64_t log2_q16)
{
    const int64_t whole = log2_q16 >> 16;
    const uint32_t fraction = (uint32_t)log2_q16 & 65535;
    uint64_t m = (uint64_t)1 << 30;
    fx_real zero = {0, 0};
    int i;

    if (whole < -63) return zero;
    for (i = 0; i < 16; i++)
        if (fraction >> (15 - i) & 1) m = m * root_of_two_q30[i] >> 30;
    return fx_real_make((int64_t)m, whole > 1000 ? 1000 : (int)whole - 30);
}

int32_t fx_real_log2_q16(fx_real x)
{
    return x.m > 0 ? fx_log2_u64((uint64_t)x.m) + x.e * 65536 : FX_LOG2_ZERO;
}

fx_real fx_real_make(int64_t x, int e)
{
    const int negative = x < 0;
    uint64_t m = negative ? 0 - (uint64_t)x : (uint64_t)x;
    fx_real out = {0, 0};
    int shift;

    if (!m) return out;
    shift = fx_top_bit(m) - 29;
    if (shift > 0) {
        m = (m + ((uint64_t)1 << (shift - 1))) >> shift;
        if (m >> 30) {
            m >>= 1;
            shift++;
        }
    } else {
        m <<= -shift;
    }
    out.m = negative ? -(int32_t)m : (int32_t)m;
    out.e = e + shift;
    return out;
}

fx_real fx_real_mul(fx_real a, fx_real b)
{
    return fx_real_make((int64_t)a.m * b.m, a.e + b.e);
}

int32_t fx_real_fixed(fx_real x, int fraction_bits)
{
    const int shift = -(x.e + fraction_bits);

    if (!x.m) return 0;
    if (shift < 0) return x.m > 0 ? INT32_MAX : -INT32_MAX;
    if (shift == 0) return x.m;
    return shift > 60 ? 0 : (int32_t)fx_shift(x.m, shift);
}
