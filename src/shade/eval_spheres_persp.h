/* SPDX-License-Identifier: MIT */
/*
 * eval_spheres_persp - sphere images with directions per pixel (PERSP of shaders_gles/spheres.glsl): whole, quarters, and
 * with the cosine in them (paper mode), for which a distant viewer is one with the same direction everywhere
 */
#ifndef SHADE_EVAL_SPHERES_PERSP_H
#define SHADE_EVAL_SPHERES_PERSP_H

#include "eval_persp.h"

#define SHADE_EVAL_MAX_IMAGES 16 /* of a file with more, as many are spread over it */

typedef struct shade_spheres_persp {
    const uint8_t *texels; /* of all images, one behind the other */
    uint32_t image_bytes;
    int32_t half_disc_q15;                       /* of what a coordinate covers; paper: x 0.995 */
    int32_t texels_per_log2;                     /* quarters; 0: whole spheres */
    uint32_t inverse_q30[SHADE_EVAL_MAX_IMAGES]; /* of the step from at_q15 to the next */
    uint16_t at_q15[SHADE_EVAL_MAX_IMAGES];      /* the light's polar angle / pi; quarters: sqrt(1 - l.h) */
    uint8_t layer[SHADE_EVAL_MAX_IMAGES];
    uint16_t size; /* texels a side */
    uint8_t texel_bytes, count, paper;
} shade_spheres_persp;

/* texels: of level 0, RGB8 or RGBA8 by texel_bytes, layers of size x size. */
void shade_spheres_persp_prepare(shade_spheres_persp *out, const shade_spheres *spheres, const uint8_t *texels,
                                 unsigned size, unsigned texel_bytes);

/* Add one light's radiance. */
void shade_spheres_persp_add(const shade_spheres_persp *spheres, const shade_persp_light *light, const shade_seen *seen,
                             shade_rgb radiance);

#endif
