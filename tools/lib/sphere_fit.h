/* SPDX-License-Identifier: MIT */
/* Texels whose bilinear reconstruction comes nearest to a function, in the sense of weighted least squares. */
#ifndef SPHERE_FIT_H
#define SPHERE_FIT_H

#include <stddef.h>

/* target, weight (> 0): (size x samples)^2 values at positions ((I + 1/2) / samples, (J + 1/2) / samples) in texels from
   the image's corner, rows in order. texel: size x size with a stride of `stride` floats; holds a first guess and receives the
   result, rounded to k / levels so that the errors of neighbours cancel (levels 0: not rounded, not clamped). */
void sphere_fit(float *texel, size_t stride, const float *target, const float *weight, int size, int samples,
                int levels);

#endif
