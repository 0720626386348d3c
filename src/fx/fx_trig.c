/* SPDX-License-Identifier: MIT */
#include "fx.h"

#define TURN_TO_RADIANS_Q60 ((int64_t)1686629713) /* 2 pi 2^28: turn in 2^-32 x this is radians in q60 */

/* sin and cos of 0 <= x <= pi/4 in q30: Taylor series, first dropped terms x^11/11! and x^12/12! below 2^-29. */
static int64_t sin_q30(int64_t x)
{
    const int64_t square = fx_shift(x * x, 30);
    int64_t sum = 2959; /* 2^30 / 9! */

    sum = 213044 - fx_shift(sum * square, 30);    /* 2^30 / 7! */
    sum = 8947849 - fx_shift(sum * square, 30);   /* 2^30 / 5! */
    sum = 178956971 - fx_shift(sum * square, 30); /* 2^30 / 3! */
    return x - fx_shift(fx_shift(sum * square, 30) * x, 30);
}

static int64_t cos_q30(int64_t x)
{
    const int64_t square = fx_shift(x * x, 30);
    int64_t sum = 296; /* 2^30 / 10! */

    sum = 26631 - fx_shift(sum * square, 30);    /* 2^30 / 8! */
    sum = 1491308 - fx_shift(sum * square, 30);  /* 2^30 / 6! */
    sum = 44739243 - fx_shift(sum * square, 30); /* 2^30 / 4! */
    sum = 536870912 - fx_shift(sum * square, 30);
    return 1073741824 - fx_shift(sum * square, 30);
}

int32_t fx_sin_q28(uint32_t turn)
{
    const uint32_t quarter = (uint32_t)1 << 30, eighth = quarter / 2;
    uint32_t rest = turn & (2 * quarter - 1); /* within half a turn */
    int64_t value;

    if (rest > quarter) rest = 2 * quarter - rest;
    if (rest <= eighth)
        value = sin_q30(fx_shift((int64_t)rest * TURN_TO_RADIANS_Q60, 30));
    else
        value = cos_q30(fx_shift((int64_t)(quarter - rest) * TURN_TO_RADIANS_Q60, 30));
    value = fx_shift(value, 2);
    return (int32_t)(turn >> 31 ? -value : value);
}

int32_t fx_cos_q28(uint32_t turn)
{
    return fx_sin_q28(turn + ((uint32_t)1 << 30));
}

/* atan(2^-i) in 2^-32 turns, i = 0..29: round(2^32 atan(2^-i) / (2 pi)). */
static const uint32_t arctangent[30] = {
    536870912, 316933406, 167458907, 85004756, 42667331, 21354465, 10679838, 5340245, 2670163, 1335087,
    667544,    333772,    166886,    83443,    41722,    20861,    10430,    5215,    2608,    1304,
    652,       326,       163,       81,       41,       20,       10,       5,       3,       1};

uint32_t fx_atan2(int64_t y, int64_t x)
{
    const uint64_t ax = x < 0 ? 0 - (uint64_t)x : (uint64_t)x, ay = y < 0 ? 0 - (uint64_t)y : (uint64_t)y;
    uint32_t turn = 0;
    int64_t u, v;
    int shift, i;

    if (!ay) return x < 0 ? (uint32_t)FX_BAM_HALF * 65536u : 0;
    /* CORDIC in the first quadrant; parts below 2^60 leave room for its gain of 1.65 x sqrt 2 */
    shift = fx_top_bit(ax | ay) - 59;
    u = (int64_t)(shift > 0 ? ax >> shift : ax << -shift);
    v = (int64_t)(shift > 0 ? ay >> shift : ay << -shift);
    for (i = 0; i < 30; i++) {
        const int64_t du = i ? fx_shift(v, i) : v, dv = i ? fx_shift(u, i) : u;

        if (v > 0) {
            u += du;
            v -= dv;
            turn += arctangent[i];
        } else {
            u -= du;
            v += dv;
            turn -= arctangent[i];
        }
    }
    if (turn >> 31) turn = 0; /* the last step went below */
    if (x < 0) turn = (uint32_t)FX_BAM_HALF * 65536u - turn;
    return y < 0 ? 0 - turn : turn;
}
