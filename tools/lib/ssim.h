/* SPDX-License-Identifier: MIT */
/* Mean structural similarity of two pictures: Wang, Bovik, Sheikh and Simoncelli, "Image quality assessment: from error
   visibility to structural similarity", IEEE Transactions on Image Processing 13(4), 2004, equations 13 to 17, with the
   constants given there: a Gaussian window of 11 x 11 with a standard deviation of 1.5, K1 = 0.01, K2 = 0.03, L = 255. */
#ifndef SSIM_H
#define SSIM_H

#include "pixels.h"

#define SSIM_WINDOW 11

/* Mean over the windows that lie wholly inside and whose middle pixel is in mask (width x height, not 0: in; NULL: all
   of them), and over the channels, each taken alone. 1: equal; at least -1. Both pictures have one size, 11 pixels a side or
   more, and the same channels. 1 where no window is left. */
double ssim_mean(const image_u8 *a, const image_u8 *b, const uint8_t *mask);

#endif
