/* SPDX-License-Identifier: MIT */
/* Pictures in memory, rows from the top, channels interleaved. */
#ifndef PIXELS_H
#define PIXELS_H

#include <stddef.h>
#include <stdint.h>

typedef struct image_u8 {
    int width, height, channels;
    uint8_t *texel; /* malloc'd */
} image_u8;

typedef struct image_f32 {
    int width, height, channels;
    float *texel; /* malloc'd */
} image_f32;

image_u8 image_u8_make(int width, int height, int channels); /* zero */
image_f32 image_f32_make(int width, int height, int channels);
void image_u8_free(image_u8 *image);
void image_f32_free(image_f32 *image);

/* The sRGB curve (IEC 61966-2-1), both ways, without clamping above 1; negative gives 0. */
double srgb_encode(double linear);
double srgb_decode(double encoded);
/* clamp to 0..1, x255, nearest */
uint8_t unorm8(double x);

#endif
