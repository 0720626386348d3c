/* SPDX-License-Identifier: MIT */
/* Half-vector tables: bake, write, read back, decode in double. Equations: nacre_asset.h. */
#ifndef TABLE_BAKE_H
#define TABLE_BAKE_H

#include <stdint.h>

#include "brdf.h"
#include "nacre.h"
#include "output.h"
#include "progress.h"

#define TABLE_MIN_SIDE 4
#define TABLE_MAX_SIDE 128
#define TABLE_MAX_D    6.5 /* of TABLE_TWO_LAYERS: its power stays inside fp16 */

/* A directional light nearer than this to "from behind, towards the eye" is dropped: h is undefined there. */
#define TABLE_MIN_L_DOT_V (-0.999)

typedef enum table_tier { TABLE_DEFAULT, TABLE_FINE, TABLE_RGB } table_tier;

/* What the texels of a file hold: nacre_asset.h, NACRE_KEY_TABLE. */
typedef enum table_layout { TABLE_ONE_LAYER, TABLE_TWO_LAYERS, TABLE_TWO_LAYERS_EARLY } table_layout;

/* Numbers that tables have in common; what is 0 each finds for itself. */
typedef struct table_shared {
    double e, eps; /* E and eps */
    int has_rows;  /* 1: the row curve is rows */
    double rows;   /* B */
    double ymax;   /* and W, as stored; larger roots are cut */
    double w[3];
} table_shared;

typedef struct table_options {  /* zero means default */
    int width, height;          /* texels, 4..128 (24 x 21; fine 32 x 21) */
    table_tier tier;            /* TABLE_RGB: no phi_d term, W = 0 */
    double power;               /* p: 4.8 or 4 (4.8) */
    double eps;                 /* 2^-16..1/2 (what suits the BRDF) */
    progress *progress;         /* told of steps; may be NULL */
    const table_shared *shared; /* one layer: numbers that are given; may be NULL */
} table_options;

typedef struct table_asset {
    int width, height, layers;
    table_layout layout;
    uint8_t *rgba; /* layers x height x width x 4, malloc'd */
    /* as stored, multiples of 2^-16; 0 where the layout has no such number */
    double e, ymax, w[3], p, eps, k1, k2, rows, d[3], v[3], k4;
    double albedo[3];
    int toe; /* 1: shaders that output sRGB draw the curve's linear toe */
    char name[256];
} table_asset;

/* Bake b. The bytes depend on b and the options alone.
   FAIL_USAGE: an option out of range. FAIL_UNSUPPORTED: b is anisotropic. FAIL_INVALID: b returned a value that is not
   a finite number. *out is untouched on failure; free it with table_free. */
int table_bake(table_asset *out, const brdf *b, const table_options *options, failure *f);

/* Append a KTX2 file to *out. */
void table_write(const table_asset *t, bytes *out);

/* The table in an opened image; path is for messages only. FAIL_INVALID: not a table, or its keys are out of range. */
int table_read(table_asset *out, const nacre_image *image, const char *path, failure *f);

void table_free(table_asset *t);

/* Reflected radiance over irradiance/(pi E), i.e. pi E f_r max(n.l, 0), R G B, for unit vectors in the local frame: 8-bit
   codes, bilinear filter with clamp, equations in double; 0 below the horizon of either direction and where
   l.v < TABLE_MIN_L_DOT_V. */
void table_decode(const table_asset *t, const double to_light[3], const double to_eye[3], double radiance[3]);

/* The table as a BRDF. Takes a copy. */
brdf *table_brdf(const table_asset *t);

#endif
