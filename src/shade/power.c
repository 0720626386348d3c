/* SPDX-License-Identifier: MIT */
/* Powers by a table of logarithms and one of their inverse: 2 KB in place of the 64 KB of a table over x and n, and no
   error of interpolation in n. */
#include "shade.h"

int64_t shade_minus_log2_q24(uint32_t m)
{
    const int top = fx_top_bit(m);
    const uint32_t fraction = (m << (31 - top)) & 0x7FFFFFFFu; /* q31 above the leading 1 */
    const uint32_t i = fraction >> 23, rest = fraction >> 7 & 0xFFFFu;
    const uint32_t step = shade_log2_table[i + 1] - shade_log2_table[i];

    return ((int64_t)(31 - top) << 24) - shade_log2_table[i] - (step * (uint64_t)rest >> 16);
}

/* 2^(-e) in q16 for e >= 0 in q24. */
static uint32_t exp2_minus_q16(int64_t e_q24)
{
    const uint32_t i = (uint32_t)e_q24 >> 16 & 255, rest = (uint32_t)e_q24 & 0xFFFFu;
    uint32_t step, value;

    if (e_q24 >= (int64_t)17 << 24) return 0;
    step = shade_exp2_table[i] - shade_exp2_table[i + 1];
    value = shade_exp2_table[i] - (uint32_t)(step * (uint64_t)rest >> 16);
    return (uint32_t)fx_shift(value, 15 + (int)(e_q24 >> 24));
}

int32_t shade_exponent_q16(uint32_t code)
{
    /* 65536/255 = 65793/256 + 2^-16; 255^2 x 65793 is below 2^32 */
    return (int32_t)((code * code * 65793 + 128) >> 8);
}

uint32_t shade_power_q16(int32_t x_q28, int32_t n_q16)
{
    if (x_q28 <= 0) return 0;
    if (x_q28 >= FX_Q28_ONE) return 65536;
    return exp2_minus_q16(fx_shift(shade_minus_log2_q24((uint32_t)x_q28 << 3) * n_q16, 16));
}

/* x^(n/2) = x'^(n/4) at x' = at / (2 width - 1), q16. at = 2 column + 1 in texel centres. */
static int32_t power_at(unsigned at, unsigned width, int32_t n_q16)
{
    const uint32_t last = 2 * width - 1;
    const int64_t minus_log2 = at < last ? shade_minus_log2_q24(at) - shade_minus_log2_q24(last) : 0;

    return at ? (int32_t)exp2_minus_q16(fx_shift(minus_log2 * n_q16, 18)) : 0;
}

uint32_t shade_power_texel(unsigned column, unsigned row, unsigned width, unsigned height)
{
    /* n = 255 ((2 row + 1) / (2 height))^2 */
    const int64_t odd = 2 * (int64_t)row + 1;
    const int32_t n_q16 = (int32_t)fx_div(255 * odd * odd * 65536, 4 * (int64_t)height * height);
    const unsigned at = 2 * column + 1;
    const int32_t value = power_at(at, width, n_q16);
    int64_t above = 0; /* twice what the chords to either side lie above it in their middles */

    if (column + 1 == width) return 65535;
    if (!column) return 0; /* where x <= 0 */
    above += power_at(at - 2, width, n_q16) + value - 2 * power_at(at - 1, width, n_q16);
    above += power_at(at + 2, width, n_q16) + value - 2 * power_at(at + 1, width, n_q16);
    above = value - fx_shift(above, 3);
    return above < 0 ? 0 : above > 65535 ? 65535 : (uint32_t)above;
}
