/* SPDX-License-Identifier: MIT */
/* PNG pictures, 8 bit, 1 to 4 channels. */
#ifndef PNG_IO_H
#define PNG_IO_H

#include "output.h"
#include "pixels.h"

int png_write(const char *path, const image_u8 *image, failure *f); /* atomic, deterministic, tagged sRGB */
int png_encode(bytes *out, const image_u8 *image, const char *name, failure *f); /* appends; name: for messages */
int png_read(image_u8 *out, const char *path, int channels, failure *f);         /* converted to so many channels */

#endif
