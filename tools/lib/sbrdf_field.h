/* SPDX-License-Identifier: MIT */
/* A material that varies over the surface before it is coded: one Lafortune BRDF a texel in double, and the way from there
   to the 8-bit maps with refitted mip levels. */
#ifndef SBRDF_FIELD_H
#define SBRDF_FIELD_H

#include "lafortune_pairs.h"
#include "progress.h"
#include "sbrdf_map.h"

typedef struct sbrdf_field {
    int width, height;
    int lobes;          /* of every texel, 1..3; those it does not need have ks 0 */
    int has_direction;  /* texels have directions of their own */
    sbrdf_texel *texel; /* rows from the top */
} sbrdf_field;

/* Texels of white paper: kd 1, opaque, no lobes lit. */
sbrdf_field sbrdf_field_make(int width, int height, int lobes, int has_direction);
void sbrdf_field_free(sbrdf_field *f);
/* 1 if a lobe somewhere has cx and cy that differ. */
int sbrdf_field_is_anisotropic(const sbrdf_field *f);

/* Into the frame of the codes: sums at most 1 (ks takes over the rest), lobes by falling exponent, n within 0..255, and
   |C| at most limit (1..2). Counts what had to be clamped; NaN or infinite values give FAIL_INVALID with their texel. */
typedef struct sbrdf_clamped {
    long exponents, shapes, albedos; /* lobes whose n or C, texels whose kd or ks was out of range */
} sbrdf_clamped;
int sbrdf_field_settle(sbrdf_field *f, double limit, sbrdf_clamped *clamped, const char *name, failure *fail);

/* ---- averages: sbrdf_mip.c -------------------------------------------------------------------------- */

/* The next smaller level, every texel fitted to the mean f_r of those it covers (sample, average, fit: McAllister et al.
   2002, section 7). Levels 0..count-1 of a power-of-two field, level[0] = *f itself; the caller frees those from 1 on. */
void sbrdf_field_levels(const sbrdf_field *f, sbrdf_field *level, int count, progress *p);
/* The same by means of the parameters: what refitting is compared with. */
void sbrdf_field_average(const sbrdf_field *f, sbrdf_field *level, int count);

/* ---- codes: sbrdf_quantise.c ------------------------------------------------------------------------ */

typedef struct sbrdf_quantised {
    double error_plain;  /* relative L2 of f cos, codes against texels, C at full scale in every lobe */
    double error_chosen; /* the same with magnitude moved between albedo and C where that serves the 8 bits */
} sbrdf_quantised;

/* Codes of count levels. name goes into the files. */
void sbrdf_quantise(const sbrdf_field *level, int count, const char *name, sbrdf_map *out, sbrdf_quantised *report);
/* Relative L2 of f cos of a level's codes against its texels, over at most a few thousand of them. */
double sbrdf_map_error(const sbrdf_map *m, const sbrdf_field *level, int index);

#endif
