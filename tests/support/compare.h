/* SPDX-License-Identifier: MIT */
/* Frames against frames: signed per-channel bounds, figures for every comparison, pictures on a mismatch. */
#ifndef COMPARE_H
#define COMPARE_H

#include "pixels.h"

typedef struct compare_bound {
    int low, high;   /* actual - expected, in codes of 255, every channel */
    double beyond;   /* part of the compared pixels that may be outside: 0..1 */
    double coverage; /* part of all pixels where alpha may differ */
} compare_bound;

typedef struct compare_result {
    long pixels;     /* compared: inside by a pixel in both frames, or covered in both */
    long beyond;     /* of those, outside low..high */
    long uncovered;  /* alpha differs */
    int least, most; /* extreme signed differences of those compared */
    double mean;     /* of the absolute differences, per channel */
} compare_result;

/* Compare RGB where both frames are covered; with interior, only where their 8 neighbours are covered too. Prints one
   line. Returns 1 if the bound holds; if not, writes build/frames/NAME.{actual,expected,difference}.png (difference: grey
   128 + 8 x the signed difference) and returns 0. */
int compare_frames(const char *name, const image_u8 *actual, const image_u8 *expected, int interior,
                   const compare_bound *bound, compare_result *result);

#endif
