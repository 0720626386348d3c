/* SPDX-License-Identifier: MIT */
/*
 * eval_inner - the arithmetic of the evaluators, one pixel at a time: the definition that SIMD variants repeat
 *
 * Look-up tables hold words: the value at a node in the upper half, twice the way to the next node in the lower half. With
 * f in q15, word + (int16)word x f is the value between them, in the upper half.
 */
#ifndef SHADE_EVAL_INNER_H
#define SHADE_EVAL_INNER_H

#include "eval.h"

extern const uint32_t shade_lut_log2[16];
extern const uint32_t shade_lut_root48[117]; /* 8 to an octave, from 2^9: 2^23 is 1.0 */
extern const uint32_t shade_lut_srgb[105];   /* 8 to an octave, from 2^3: 2^16 is white; codes x 128 */
extern const uint32_t shade_lut_inverse_root[32];

#define SHADE_CODE_LOW 29412557 /* .055 x 255 x 2^21 */

static inline int32_t eval_x(uint32_t xy)
{
    return (int16_t)(xy & 65535u);
}

static inline int32_t eval_y(uint32_t xy)
{
    return (int32_t)xy >> 16;
}

/* Between a node and the next, q31. */
static inline int32_t eval_between(uint32_t word, int32_t f_q15)
{
    return (int32_t)word + (int16_t)(word & 65535u) * f_q15;
}

/* (a b + 1/2) >> 15, as pmulhrsw and SQRDMULH do. */
static inline int32_t eval_mul_q15(int32_t a, int32_t b)
{
    return (a * b + 16384) >> 15;
}

static inline int32_t eval_least(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* x in 1..2^31: e = floor(log2 x), and the bits below the leading one from bit 31 downwards. */
typedef struct eval_split {
    int32_t exponent;
    uint32_t mantissa;
} eval_split;

static inline eval_split eval_split_of(uint32_t x)
{
    const int zeros = fx_leading_zeros(x);
    eval_split out;

    out.exponent = 31 - zeros;
    out.mantissa = x << zeros << 1;
    return out;
}

/* Index among 2^bits nodes to an octave, and the fraction behind it. */
static inline int32_t eval_node(eval_split s, int bits)
{
    return (s.exponent << bits) + (int32_t)(s.mantissa >> (32 - bits));
}

static inline int32_t eval_fraction(eval_split s, int bits)
{
    return (int32_t)(s.mantissa >> (17 - bits) & 32767u);
}

/* log2 of x > 0, q12. */
static inline int32_t eval_log2(uint32_t x)
{
    const eval_split s = eval_split_of(x);

    return s.exponent * 4096 + (eval_between(shade_lut_log2[s.mantissa >> 28], eval_fraction(s, 4)) >> 19);
}

/* 4.8th root of x / 2^23, q15; below 2^-14 that of 2^-14. */
static inline int32_t eval_root48(int32_t x)
{
    const eval_split s = eval_split_of((uint32_t)(x < 512 ? 512 : x));

    return eval_between(shade_lut_root48[eval_node(s, 3) - 72], eval_fraction(s, 3)) >> 16;
}

/* v^2.4, both q15: v^2 times a cubic for v^0.4, within 0.2 codes of 255 in what becomes of it (v: 4.8th root of a quarter
   of the radiance). Coefficients x 1/2. */
static inline int32_t eval_pow24(int32_t v)
{
    int32_t c = eval_mul_q15(6031, v) - 16375;

    c = eval_mul_q15(c, v) + 21971;
    c = eval_mul_q15(c, v) + 4784;
    return eval_least(2 * eval_mul_q15(eval_mul_q15(v, v), c), 32767);
}

/* q16 radiance of its root / 2, q15. */
static inline uint32_t eval_square(int32_t r)
{
    return (uint32_t)(r * r) >> 12;
}

static inline int32_t eval_product(int32_t root, int32_t gain, int shift)
{
    return eval_least(root * gain >> shift, 32767);
}

/* 2^log2 as gain x 2^-shift on a product of q14 and q15 that is to be q15. */
void shade_eval_gain(int64_t log2_q16, int16_t *gain, uint8_t *shift);
/* q14, -1..1. */
int16_t shade_eval_q14(int32_t x_q28);

/* ---- tables ------------------------------------------------------------------------------------------------------ */

/*
 * Columns of a light: the two rows around its l.h, blended. Four words for each: R G B A; eight in the fine tier: R G B A
 * and T.r T.g T.b -. Values q13: RGB x k with k = (light of the channel / light of the brightest channel)^(1/p) ; (A - 1/2)
 * max(k W), or (A - 1/2) max(k K2); (T - 1/2) k K1.
 */

typedef struct eval_surface { /* what every light of a pixel shares */
    int32_t x, y, z;
    int32_t square; /* |n|^2, q28 */
} eval_surface;

static inline eval_surface eval_surface_of(uint32_t xy, int32_t z)
{
    eval_surface n;

    n.x = eval_x(xy);
    n.y = eval_y(xy);
    n.z = z;
    n.square = n.x * n.x + n.y * n.y + z * z;
    return n;
}

static inline int32_t eval_dot(const eval_surface *n, uint32_t xy, int32_t z)
{
    return n->x * eval_x(xy) + n->y * eval_y(xy) + n->z * z;
}

/* u of the table, q15. |n - h|^2 + 2 eps = |n|^2 + (|h|^2 + 2 eps) - 2 n.h: exact in integers. */
static inline int32_t eval_column(const shade_table_eval *e, const eval_surface *n)
{
    const int32_t distance = n->square + eval_dot(n, e->half_xy, e->half_z) + e->offset;
    const int32_t u = ((eval_log2((uint32_t)distance >> 7) - e->log_middle) * e->scale >> 8) + e->at_middle;

    return eval_least(u, e->last);
}

static inline int32_t eval_clip_root(int32_t root_q29)
{
    const int32_t root = root_q29 >> 15;

    return root < 0 ? 0 : eval_least(root, 32767);
}

/* Roots of pi E f_r l.h x light, q14, at least 0. nl: q28 */
static inline void eval_table_roots(const shade_table_eval *e, const eval_surface *n, int32_t nl, int fine,
                                    int32_t root[3])
{
    const int32_t u = eval_column(e, n), f = u & 32767;
    const uint32_t *const w = e->columns + (u >> 15) * (fine ? 8 : 4);
    const int32_t a = (nl >> 14) - n->z, size = eval_least(a < 0 ? -a : a, e->limit), square = size * size >> 13;
    const int32_t shared = eval_between(w[3], f) >> 15;
    int i;

    if (fine) {
        for (i = 0; i < 3; i++)
            root[i] = eval_clip_root(eval_between(w[i], f) + (eval_between(w[4 + i], f) >> 15) * square +
                                     (shared * (2 * size) >> 15) * e->phi[i]);
    } else {
        const int32_t bend = shared * square >> 15;

        for (i = 0; i < 3; i++) root[i] = eval_clip_root(eval_between(w[i], f) + bend * e->phi[i]);
    }
}

#endif
