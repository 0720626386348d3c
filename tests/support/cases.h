/* SPDX-License-Identifier: MIT */
/* The one table of frames: every driver draws these, and the double renderer says what they should be. */
#ifndef CASES_H
#define CASES_H

#include "compare.h"
#include "scene.h"

typedef enum case_model {
    CASE_TABLE,     /* default tier, p = 4.8, phi_d term */
    CASE_TABLE_P4,  /* p = 4 */
    CASE_TABLE_RGB, /* no phi_d term */
    CASE_FINE,
    CASE_SPHERES, /* cosine-free, 0,45,90,135 at 256 */
    CASE_PAPER,   /* 0,45,90,135 at 512 */
    CASE_QUARTER, /* default: 6 quarters of 32 */
    CASE_QUARTER_ETC1,
    CASE_SBRDF,  /* one lobe, turned; these three: 8 x 8 texels painted here, no BRDF */
    CASE_SBRDF2, /* the second anisotropic and turned */
    CASE_SBRDF3,
    CASE_PALETTE, /* 256 tables made up; no BRDF */
    CASE_PALETTE_BLEND,
    CASE_MODEL_COUNT
} case_model;

typedef enum case_camera { CASE_ORTHO, CASE_PERSPECTIVE, CASE_DISTANT } case_camera;

typedef struct frame_case {
    const char *name;
    case_model model;
    const char *brdf;
    const char *mesh;
    case_camera camera;
    int lights, points;        /* so many of the fixed sets */
    int distant;               /* so many more directional lights all around */
    int lit;                   /* drawn by a lit sphere of so many texels a side, 0: directly */
    int output;                /* nacre_output */
    int normal_map;            /* 1: the bumpy one */
    double exposure;           /* 0: 2.5 */
    double ambient;            /* irradiance, grey */
    double tint;               /* 0: white; else r = 1, g = tint, b = tint squared */
    double shadow;             /* of the first light */
    double polar_deg;          /* of the first light, when not 0 */
    const compare_bound *fp32; /* against double, fragment arithmetic in fp32 */
    const compare_bound *fp16; /* mediump really being fp16 */
} frame_case;

extern const frame_case frame_cases[];
extern const int frame_case_count;

/* A baked file in memory and its decoding in double. Points into itself: leave it where it is. */
typedef struct case_asset {
    bytes file, normal_file, second_file; /* second: of models in two files, lobes or index */
    nacre_image image, normal_image, second_image;
    nacre_material material;
    image_u8 normal_map;
    brdf *decoded;
    double albedo[3];
} case_asset;

/* Bake, or read what an earlier call left in directory (NULL: never keep). Ends the program on failure. */
void case_asset_open(case_asset *out, case_model model, const char *brdf_name, int normal_map, const char *directory);
void case_asset_close(case_asset *a);

/* The scene of a case at the given size; shape must outlive it. */
void case_scene(scene *s, const frame_case *c, const mesh *shape, int width, int height);

#endif
