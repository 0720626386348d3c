/* SPDX-License-Identifier: MIT */
/*
 * eval - the models per unit normal, in integers: what a fragment shader computes, for CPUs
 *
 * For a distant viewer and directional lights (shade_setup with persp = 0), radiance depends on the normal alone. One light
 * is prepared at a time, and then evaluated for any number of normals:
 *
 *   shade_setup(&frame, &view, centre, &material, SHADE_LINEAR, 0, 2);
 *   for each light i of frame.light_count:
 *       shade_table_eval_prepare(&eval, columns, &frame.light[i], &material, texels);
 *       shade_table_add(&eval, xy, z, count, radiance);          adds this light's radiance
 *   shade_encode(radiance, count, NACRE_OUTPUT_SRGB, rgba);       codes of the sum
 *
 * or, for the only light of a table with p = 4.8 and sRGB codes, shade_table_code at once: TABLE's display form, with
 * the curve's linear toe where the file asks for it (elsewhere at most 2.7 codes too dark near black), as shaders do.
 *
 * Normals are in the turned frame of shade_setup (the eye is along +z; orthographic views: view space), q14, at most 1.39
 * long. x and y share a word: x in its lower half (shade_pack_xy); z stands apart. shade_normalise makes unit normals.
 * Radiance includes tint, exposure and light power: 65536 is white. One light adds at most 4 white.
 *
 * Every step is defined by 16 x 16 bit products and 32-bit sums, so that SIMD units (soft/kernels.h) give the same bits.
 */
#ifndef SHADE_EVAL_H
#define SHADE_EVAL_H

#include "shade.h"

#define SHADE_EVAL_MAX_WIDTH 64 /* columns of a table */

/* Words of a table's columns: 4 (fine: 8) for each. */
#define SHADE_TABLE_WORDS(width, fine) ((uint32_t)(width) * ((fine) ? 8u : 4u))

static inline uint32_t shade_pack_xy(int32_t x, int32_t y)
{
    return ((uint32_t)x & 65535u) | (uint32_t)y << 16;
}

static inline int32_t shade_x_of(uint32_t xy)
{
    return (int16_t)(xy & 65535u);
}

static inline int32_t shade_y_of(uint32_t xy)
{
    return (int32_t)xy >> 16;
}

/* Radiance of count pixels, one array a channel. */
typedef struct shade_rgb {
    uint32_t *r, *g, *b; /* q16 */
} shade_rgb;

/* One light on a table. */
typedef struct shade_table_eval {
    const uint32_t *columns; /* the light's row of the table, see eval_inner.h; caller's memory */
    uint32_t to_light_xy, half_xy;
    int16_t to_light_z, half_z; /* l; -2 h */
    int32_t offset;             /* |h|^2 + 2 eps, q28 */
    int32_t log_middle;         /* u = ((log2 - log_middle) scale >> 8) + at_middle */
    int32_t at_middle, last;    /* q15 */
    int16_t scale;              /* texels per octave, q11 */
    int16_t limit;              /* most that |n.l - n.v| is where lit and seen, q14 */
    int16_t phi[3];             /* R G B of the columns' shared terms, over the largest, q15 */
    int16_t gain, gain_code;    /* of the 4.8th root of n.l, q15, for radiance and for codes ... */
    uint8_t shift, shift_code;  /* ... and what its product with the root is shifted by */
    uint8_t fine, power4, toe;  /* toe: codes have the linear toe of sRGB */
    uint8_t dark;               /* the light adds nothing */
} shade_table_eval;

/* light: of shade_setup, form SHADE_LINEAR, persp 0. texels: both layers of the table for the fine tier, else one.
   columns: SHADE_TABLE_WORDS of them, borrowed by *out. 0 (out untouched): the table is wider than SHADE_EVAL_MAX_WIDTH or
   its columns lie more than 16 to an octave. */
int shade_table_eval_prepare(shade_table_eval *out, uint32_t *columns, const shade_light *light,
                             const shade_material *material, const uint8_t *const texels[2]);

/* 1: shade_table_code may be used. */
int shade_table_has_code(const shade_table_eval *eval);

/* One light on spheres without the cosine in them; bilinear texels of level 0. */
typedef struct shade_spheres_eval {
    const uint8_t *image[2];       /* the pair of layers */
    int16_t x[2][3], y[3], rim[3]; /* rows: texture coordinate - 1/2 of a q14 normal, q15; quarters: x[0] and y, the
                                      axes themselves */
    int32_t texels_per_log2;       /* quarters: texels an octave of 8 |x| + 1, q9 from q12; 0: whole spheres */
    uint32_t to_light_xy;
    int16_t to_light_z;
    int16_t weight;      /* of image[1], q15 */
    uint16_t size;       /* texels a side */
    uint8_t texel_bytes; /* 3 or 4 */
    uint8_t shift, dark;
    int16_t part[3]; /* square root of the channel's light over the brightest one's, q15 */
    int16_t gain;    /* of the root of n.l, q15 */
} shade_spheres_eval;

/* As above. layers[i]: texels of level 0 of layer i, RGB8 or RGBA8 by texel_bytes, size x size. 0: paper mode (the cosine
   is in the images). */
int shade_spheres_eval_prepare(shade_spheres_eval *out, const shade_light *light, const shade_material *material,
                               const uint8_t *const layers[], unsigned size, unsigned texel_bytes);

/* Unit normals, in place. */
void shade_normalise(uint32_t *xy, int16_t *z, int count);

/* Add one light's radiance. */
void shade_table_add(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count, shade_rgb radiance);
void shade_spheres_add(const shade_spheres_eval *eval, const uint32_t *xy, const int16_t *z, int count,
                       shade_rgb radiance);

/* Codes R | G << 8 | B << 16 | 255 << 24. shade_table_code takes normals of any length up to 1. */
void shade_table_code(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count, uint32_t *rgba);
void shade_encode(shade_rgb radiance, int count, nacre_output output, uint32_t *rgba);

/* 1 / |n| for small tables of pictures, q11: [|n|^2 >> 20], n in q14. Within 0.4 % down to |n| = 1/2, below not above the
   truth. */
extern const uint16_t shade_lut_unit[257];

/* Start a sum: ambient radiance, or nothing. */
void shade_rgb_fill(shade_rgb radiance, int count, const fx_real ambient[3]);

#endif
