/* SPDX-License-Identifier: MIT */
/* Mip levels of linear values. */
#ifndef MIP_H
#define MIP_H

#include <stddef.h>

/* Levels of a full chain down to 1 x 1 (256: 9); 1 where a side is no power of two: GLES 2 samples such textures
   without mips only. */
int mip_count(int width, int height);

/* Next smaller level by a box filter: the mean of 2 x 2 texels (2 x 1, 1 x 2 where a side is 1 already), each weighted
   by its coverage, so that texels outside the subject (0) leave no trace; where nothing is covered, the plain mean.
   width, height: even or 1. coverage: one weight a texel, NULL for 1 everywhere. out_coverage (may be NULL) receives
   the mean weight. Works in place: out == texel and out_coverage == coverage are allowed. */
void mip_halve(const float *texel, const float *coverage, int width, int height, int channels, float *out,
               float *out_coverage);

#endif
