/* SPDX-License-Identifier: MIT */
/* Texels of the sphere images' formats: codes in 0..1 in, bytes of the file out, and back. */
#ifndef TEXEL_ENCODE_H
#define TEXEL_ENCODE_H

#include <stddef.h>
#include <stdint.h>

/* Bytes of a width x height image in NACRE_FORMAT_RGBA8, _RGB8, _RGB565 or _ETC2_RGB8; 0 for other formats. */
size_t texel_bytes(int format, int width, int height);

/* Nearest codes of rgb (3 a texel, clamped to 0..1), no dither; alpha is 255. ETC2_RGB8: blocks of ETC1 modes, or with
   etc2 of any. */
void texel_encode(int format, int etc2, const float *rgb, int width, int height, uint8_t *out);

/* The values a GPU reads: code / 255, or / 31 and / 63. */
void texel_decode(int format, const uint8_t *texel, int width, int height, float *rgb);

#endif
