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

#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define EVAL_INLINE static inline __attribute__((always_inline))
#else
#define EVAL_INLINE static inline
#endif

/* for each channel k; three times the text where speed is asked for */
#if defined(__clang__) && !defined(__OPTIMIZE_SIZE__)
#define EVAL_CHANNELS(k) _Pragma("clang loop unroll(full)") for (k = 0; k < 3; k++)
#elif defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define EVAL_CHANNELS(k) _Pragma("GCC unroll 3") for (k = 0; k < 3; k++)
#else
#define EVAL_CHANNELS(k) for (k = 0; k < 3; k++)
#endif

extern const uint32_t shade_lut_log2[16];
extern const uint32_t shade_lut_root48[117];      /* 8 to an octave, from 2^9: 2^23 is 1.0 */
extern const uint32_t shade_lut_srgb[105];        /* 8 to an octave, from 2^3: 2^16 is white; codes x 128 */
extern const uint32_t shade_lut_inverse_root[32]; /* of 1..4 */
extern const uint32_t shade_lut_length[65];       /* 2^14 / sqrt(x / 64), x from 16 on */

#define SHADE_CODE_LOW 29412557 /* .055 x 255 x 2^21 */
/* With the toe 5.75 (.0985 - c)^2 is added to c < .0985, as in shaders_gles/table.glsl: 4 (t f)^2, t = .0985 - c in steps of
   2^14 and f this part of 2^15, f^2 = 5.75 x 2^26 / (255 x 2^21). */
#define SHADE_CODE_TOE  52675215 /* .0985 x 255 x 2^21 */
#define SHADE_TOE_PART  27834
#define SHADE_CODE_MOST 23774 /* its square less SHADE_CODE_LOW is code 255; anything above is held there */

/* Product of two numbers of 16 bits. */
EVAL_INLINE int32_t eval_mul16(int32_t a, int32_t b)
{
    return a * b;
}

/* Between a node and the next, q31. */
EVAL_INLINE int32_t eval_between(uint32_t word, int32_t f_q15)
{
    return (int32_t)word + eval_mul16((int16_t)(word & 65535u), f_q15);
}

/* (a b + 1/2) >> 15, as pmulhrsw and SQRDMULH do. */
EVAL_INLINE int32_t eval_mul_q15(int32_t a, int32_t b)
{
    return (a * b + 16384) >> 15;
}

EVAL_INLINE int32_t eval_least(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* 0..most; one instruction on ARM where most is 2^n - 1. */
EVAL_INLINE int32_t eval_clip(int32_t x, int32_t most)
{
    return x < 0 ? 0 : x > most ? most : x;
}

/* x in 1..2^31: the zeros above its leading one, and x without them. */
typedef struct eval_split {
    int32_t zeros;
    uint32_t bits;
} eval_split;

EVAL_INLINE eval_split eval_split_of(uint32_t x)
{
    eval_split out;

    out.zeros = fx_leading_zeros(x);
    out.bits = x << out.zeros;
    return out;
}

/* Index among 2^bits nodes to an octave, counted from x = 1, and the fraction behind it. */
EVAL_INLINE int32_t eval_node(eval_split s, int bits)
{
    return (int32_t)(s.bits >> (31 - bits)) - (s.zeros << bits) + (30 << bits);
}

EVAL_INLINE int32_t eval_fraction(eval_split s, int bits)
{
    return (int32_t)(s.bits >> (16 - bits) & 32767u);
}

/* 1 / sqrt of what is left of x = 4^n (1..4), q31. */
EVAL_INLINE int32_t eval_inverse_root(eval_split s)
{
    return eval_between(shade_lut_inverse_root[(~(uint32_t)s.zeros & 1) << 4 | (s.bits >> 27 & 15)],
                        eval_fraction(s, 4));
}

/* log2 of x > 0, q12. */
EVAL_INLINE int32_t eval_log2(uint32_t x)
{
    const eval_split s = eval_split_of(x);

    return (31 - s.zeros) * 4096 + (eval_between(shade_lut_log2[s.bits >> 27 & 15], eval_fraction(s, 4)) >> 19);
}

/* 2^x for x in q12 below 30: the whole part of it. */
EVAL_INLINE uint32_t eval_exp2(int32_t x)
{
    const int32_t whole = x >> 12, f = (x & 4095) * 8;
    /* 2^f = 1 + f (0.6952 + f (0.2260 + 0.0780 f)), 1e-4 */
    int32_t m = eval_mul_q15(2574, f) + 7427;

    m = 32768 + eval_mul_q15(eval_mul_q15(m, f) + 22767, f);
    return whole >= 15 ? (uint32_t)m << (whole - 15) : whole < -1 ? 0 : (uint32_t)m >> (15 - whole);
}

/* 4.8th root of x / 2^23, q15; below 2^-14 that of 2^-14. */
EVAL_INLINE int32_t eval_root48(int32_t x)
{
    const eval_split s = eval_split_of((uint32_t)(x < 512 ? 512 : x));

    return eval_between(shade_lut_root48[eval_node(s, 3) - 72], eval_fraction(s, 3)) >> 16;
}

/* v^2.4, both q15: v^2 times a cubic for v^0.4, within 0.2 codes of 255 in what becomes of it (v: 4.8th root of a quarter
   of the radiance). Coefficients x 1/2. */
EVAL_INLINE int32_t eval_pow24(int32_t v)
{
    int32_t c = eval_mul_q15(6031, v) - 16375;

    c = eval_mul_q15(c, v) + 21971;
    c = eval_mul_q15(c, v) + 4784;
    return eval_least(2 * eval_mul_q15(eval_mul_q15(v, v), c), 32767);
}

/* q16 radiance of its root / 2, q15. */
EVAL_INLINE uint32_t eval_square(int32_t r)
{
    return (uint32_t)(r * r) >> 12;
}

EVAL_INLINE int32_t eval_product(int32_t root, int32_t gain, int shift)
{
    return eval_least(root * gain >> shift, 32767);
}

typedef struct eval_surface { /* what every light of a pixel shares */
    int32_t x, y, z;
    int32_t square; /* |n|^2, q28 */
} eval_surface;

EVAL_INLINE int32_t eval_square_of(const eval_surface *n)
{
    return eval_mul16(n->x, n->x) + eval_mul16(n->y, n->y) + eval_mul16(n->z, n->z);
}

EVAL_INLINE eval_surface eval_surface_of(uint32_t xy, int32_t z)
{
    eval_surface n = {shade_x_of(xy), shade_y_of(xy), z, 0};

    n.square = eval_square_of(&n);
    return n;
}

/* The unit normal of a q14 one. From half of unit length on by one look-up; shorter ones by their exponent: |n|^2 x 2^24 =
   4^half x (1..4). */
EVAL_INLINE eval_surface eval_unit(uint32_t xy, int32_t z)
{
    eval_surface n = eval_surface_of(xy, z);
    const uint32_t square = (uint32_t)n.square;
    int32_t inverse, shift = 14;

    if (square >> 26) {
        inverse =
            eval_between(shade_lut_length[square >> 22 < 64 ? square >> 22 : 64], (int32_t)(square >> 7 & 32767)) >> 16;
    } else {
        const eval_split s = eval_split_of(square >> 4 ? square >> 4 : 1);

        inverse = eval_inverse_root(s) >> 16;
        shift = ((31 - s.zeros) >> 1) + 3;
    }
    n.x = (eval_mul16(n.x, inverse) + (1 << shift >> 1)) >> shift;
    n.y = (eval_mul16(n.y, inverse) + (1 << shift >> 1)) >> shift;
    n.z = (eval_mul16(n.z, inverse) + (1 << shift >> 1)) >> shift;
    n.square = eval_square_of(&n);
    return n;
}

/* 2^log2 as gain x 2^-shift on a product of q14 and q15 that is to be q15. */
void shade_eval_gain(int64_t log2_q16, int16_t *gain, uint8_t *shift);
/* Largest number in a table's columns, q16: 1 but for the fine tier. */
int64_t shade_table_most_root(const shade_material *material);
/* scale, log_middle, at_middle, last of a table; 0: too wide. */
int shade_eval_coordinate(shade_table_eval *out, const shade_table *table);
/* q14, -1..1. */
int16_t shade_eval_q14(int32_t x_q28);

/* ---- tables ------------------------------------------------------------------------------------------------------ */

/*
 * Columns of a light: the two rows around its l.h, blended. Four words for each: R G B L; eight in the fine tier, where T.r
 * T.g T.b F follow. y k = RGB + T a^2 + L |a| phi + F a^4 phi (one layer: RGB + L a^2 phi) with k = (light of the channel /
 * light of the brightest channel)^(1/p). Values q13, x 2^-down; L of one layer, which is large where a is small, q11.
 */

EVAL_INLINE int32_t eval_dot(const eval_surface *n, uint32_t xy, int32_t z)
{
    return eval_mul16(n->x, shade_x_of(xy)) + eval_mul16(n->y, shade_y_of(xy)) + eval_mul16(n->z, z);
}

/* u of the table, q15. |n - h|^2 + 2 eps = |n|^2 + (|h|^2 + 2 eps) - 2 n.h: exact in integers. */
EVAL_INLINE int32_t eval_column(const shade_table_eval *e, const eval_surface *n)
{
    const int32_t distance = n->square + eval_dot(n, e->half_xy, e->half_z) + e->offset;
    const int32_t u = ((eval_log2((uint32_t)distance >> 7) - e->log_middle) * e->scale >> 8) + e->at_middle;

    return eval_least(u, e->last);
}

/* A light's place in its columns. */
typedef struct eval_place {
    const uint32_t *w;
    int32_t f;              /* q15 */
    int32_t linear, square; /* what phi and (fine) T are multiplied by: q14, q15 */
} eval_place;

/* nl: q28 */
EVAL_INLINE eval_place eval_place_of(const shade_table_eval *e, const eval_surface *n, int32_t nl, int fine)
{
    const int32_t u = eval_column(e, n), a = (nl >> 14) - n->z, limit = e->limit;
    const int32_t size = fine ? eval_least(a < 0 ? -a : a, limit) : 0;
    eval_place p;
    int32_t shared;

    p.f = u & 32767;
    p.w = e->columns + (u >> 15) * (fine ? 8 : 4);
    p.square = fine ? size * size >> 13 : eval_least((int32_t)((uint32_t)a * (uint32_t)a >> 13), limit * limit >> 13);
    shared = eval_between(p.w[3], p.f) >> 15;
    p.linear = fine ? shared * (2 * size) >> 15 : shared * p.square >> 13;
    if (fine) p.linear += ((eval_between(p.w[7], p.f) >> 15) * (p.square * p.square >> 15)) >> 15;
    return p;
}

/* Root of pi E f_r l.h x light of channel i, q14, at least 0. */
EVAL_INLINE int32_t eval_root(const shade_table_eval *e, const eval_place *p, int i, int fine)
{
    const int32_t plain = eval_between(p->w[i], p->f) + eval_mul16(p->linear, e->phi[i]);

    return eval_clip((fine ? plain + (eval_between(p->w[4 + i], p->f) >> 15) * p->square : plain) >> 15, 32767);
}

#endif
