/* SPDX-License-Identifier: MIT */
/* Animated PNG (PNG specification, third edition, section 11.3.3): what a browser shows in place of a picture. */
#ifndef APNG_H
#define APNG_H

#include "output.h"
#include "pixels.h"

/* frames: count pictures of one size and number of channels, shown in turn for 1 / per_second seconds each, for ever. A
   program that knows no animation shows the first. Atomic, deterministic, tagged sRGB. */
int apng_write(const char *path, const image_u8 *frames, int count, int per_second, failure *f);

#endif
