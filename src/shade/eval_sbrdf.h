/* SPDX-License-Identifier: MIT */
/*
 * eval_sbrdf - one point of a surface whose every texel is a Lafortune BRDF (McAllister et al. 2002, eq. 2): what
 * shaders_gles/sbrdf.glsl computes, in integers
 *
 *   pi f_r = albedo + sum of lobe albedo x max(Cx lx vx + Cy ly vy + Cz lz vz, 0)^n
 *
 * in the frame of tangent, bitangent and normal. x^255 makes 255 times as much of every error of x, so that directions are q28
 * here and their lengths right to 2^-22; powers, light and distance are added as logarithms, so that no product leaves its
 * range. No division.
 */
#ifndef SHADE_EVAL_SBRDF_H
#define SHADE_EVAL_SBRDF_H

#include "shade.h"

typedef struct shade_sbrdf_eval {                   /* constant over a draw */
    int32_t shape_q28[NACRE_MAX_LOBES];             /* C of one code above NACRE_CODE_ZERO */
    int32_t log2_weight_q12[NACRE_MAX_LOBES];       /* of a lobe albedo's code over the diffuse one's */
    uint32_t ambient_q16[3], ambient_albedo_q16[3]; /* radiance; and where the diffuse albedo's code is 255 */
    uint8_t lobes, direction;
} shade_sbrdf_eval;

typedef struct shade_sbrdf_eval_light {
    int32_t place[3]; /* directional: towards the light, q28; point: position, q16 */
    int32_t
        log2_q12; /* of what the brightest channel's light adds where the diffuse code is 255; point: at distance 1 */
    uint16_t part_q15[3]; /* of that, in every channel */
    uint8_t point, dark;
} shade_sbrdf_eval_light;

/* What is seen of the surface. Vectors of any length, parts below 2^29. */
typedef struct shade_sbrdf_point {
    int32_t normal[3], tangent[3]; /* a tangent without length: any, for materials that don't care */
    int32_t to_eye[3];
    int32_t position_q16[3]; /* view space; for point lights alone */
    int mirrored;            /* 1: the bitangent is tangent x normal */
} shade_sbrdf_point;

/* Codes x 65536 of a texel: diffuse albedo, then two layers a lobe; or three for one lobe with a direction. */
typedef int32_t shade_sbrdf_codes[1 + 2 * NACRE_MAX_LOBES][4];

/* frame: of shade_setup, form SHADE_LINEAR; light, set: one of its lights, before and after. */
void shade_sbrdf_eval_prepare(shade_sbrdf_eval *out, const shade_sbrdf *sbrdf, const shade_frame *frame);
void shade_sbrdf_light_prepare(shade_sbrdf_eval_light *out, const nacre_light *light, const shade_light *set,
                               const shade_frame *frame);

/* Radiance of all lights together, 65536: white. One light adds at most 4 white. */
void shade_sbrdf_shade(const shade_sbrdf_eval *eval, const shade_sbrdf_eval_light *lights, int count,
                       shade_sbrdf_codes codes, const shade_sbrdf_point *point, uint32_t radiance_q16[3]);

#endif
