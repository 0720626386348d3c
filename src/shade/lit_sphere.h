/* SPDX-License-Identifier: MIT */
/*
 * lit_sphere - all lights of a view on a small sphere, in integers: codes by normal, for one fetch per pixel later
 *
 * The picture's place p (SHADE_LIT_HALF at its edges, 0 in its middle) holds the normal n whose bisector with the eye has
 * these x and y: n = 2 sqrt(1 - |p|^2) (p, 0) + (1 - 2 |p|^2) z, in the turned frame of shade_setup (an equal-area map of
 * the directions, Lambert 1772). Row 0 is the top (+y). Beyond the rim, |p|^2 > 1/2, the map goes on by 16 degrees.
 *
 * Any rows may be asked for, in any order and at any time: a picture made row by row over several frames has the same bits.
 */
#ifndef SHADE_LIT_SPHERE_H
#define SHADE_LIT_SPHERE_H

#include "eval.h"

#define SHADE_LIT_LEAST 8 /* texels a side */
#define SHADE_LIT_MOST  512

/* Kernels of one instruction set; all give the same bits. */
typedef struct shade_lit_kernels {
    void (*table_add)(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count,
                      shade_rgb radiance);
    void (*encode)(shade_rgb radiance, int count, nacre_output output, uint32_t *rgba);
} shade_lit_kernels;

typedef struct shade_lit {
    const nacre_view *view;         /* lights (directional), exposure, ambient, tint, output */
    nacre_q16 centre[3];            /* object space, seen from the eye's direction to it */
    const shade_material *material; /* TABLE or SPHERES */
    const uint8_t *const *layers;   /* texels of level 0, one behind the other: tables 1 (fine: 2), spheres all */
    unsigned sphere_size, sphere_texel_bytes;
    unsigned size; /* of the picture */
    const shade_lit_kernels *kernels;
} shade_lit;

/* Bytes of scratch, 4-byte aligned, for so many rows at a time: that of a shade_frame + 4 SHADE_TABLE_WORDS (paper mode:
   the evaluator) + 30 a texel. More rows cost less, as the set-up of all lights is repeated for each portion. */
uint32_t shade_lit_scratch(const shade_lit *lit, unsigned rows);

/* Shade rows y0 .. y0 + rows - 1. Returns their codes R | G << 8 | B << 16 | 255 << 24, which lie in scratch; NULL: the
   evaluators can't draw this material. */
const uint32_t *shade_lit_rows(const shade_lit *lit, unsigned y0, unsigned rows, void *scratch);

/* Packed x y and z of the normals of one row, q14. */
void shade_lit_normals(unsigned size, unsigned y, uint32_t *xy, int16_t *z);

#endif
