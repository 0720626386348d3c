/* SPDX-License-Identifier: MIT */
/*
 * eval_persp - tables with directions per pixel: near viewers and point lights (PERSP of shaders_gles/table.glsl)
 *
 * Radiance is put together from logarithms, so that no product leaves its range: p log2 y + log2 n.l - log2 2 l.h + log2 of
 * the light - log2 of its distance squared.
 */
#ifndef SHADE_EVAL_PERSP_H
#define SHADE_EVAL_PERSP_H

#include "eval.h"

/* Pixels: unit normals and directions to the eye (as in eval.h, q14), positions in view space (q16; for
   point lights alone). */
typedef struct shade_seen {
    const uint32_t *normal_xy, *eye_xy;
    const int16_t *normal_z, *eye_z;
    const int32_t *position[3];
    int count;
} shade_seen;

typedef struct shade_persp_light {
    int32_t place[3];    /* directional: unit vector to the light, q14; point: position, q16 */
    int32_t log2_q12[3]; /* light x set-up factors; point: at distance 1 */
    uint8_t point, dark;
} shade_persp_light;

typedef struct shade_table_persp {
    const uint8_t *texels[2];
    int32_t two_eps;                     /* q28 */
    int32_t log_middle, at_middle, last; /* as in shade_table_eval */
    int16_t scale;
    int32_t phi_q12[3];                         /* W; early fine tier: K1, K2 */
    int32_t d_q12[3], v_q12[3], k2_q12, k4_q12; /* fine */
    int32_t rows_q15;                           /* B of the row curve */
    uint16_t width, height;
    int32_t p_q12;
    uint8_t fine, early;
} shade_table_persp;

/* light, set: one of the view's, before and after shade_setup with persp = 1 and form SHADE_LINEAR. position_shift: of its
   frame. */
void shade_persp_light_prepare(shade_persp_light *out, const nacre_light *light, const shade_light *set,
                               int position_shift);
/* 0: as for shade_table_eval_prepare. */
int shade_table_persp_prepare(shade_table_persp *out, const shade_table *table, int fine, int early,
                              const uint8_t *const texels[2]);

void shade_table_persp_add(const shade_table_persp *table, const shade_persp_light *light, const shade_seen *seen,
                           shade_rgb radiance);

/* 1 / x for x > 0: *inverse (q30, 2^29..2^30) x 2^-*shift. Without a division. */
void shade_reciprocal(uint32_t x, uint32_t *inverse, int *shift);

#endif
