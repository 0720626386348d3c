/* SPDX-License-Identifier: MIT */
/* Pictures of floats: portable float maps, PF (RGB) and Pf (one channel). */
#ifndef PFM_IO_H
#define PFM_IO_H

#include "output.h"
#include "pixels.h"

int pfm_write(const char *path, const image_f32 *image, failure *f); /* 1 or 3 channels */
/* FAIL_INVALID: no PFM, or of another length than its header says. The scale is not applied, only its sign. */
int pfm_read(image_f32 *out, const char *path, failure *f);

/* A PNG's codes or a PFM's floats, by the name's ending; *is_float says which. PNG: converted to so many channels; PFM:
   1 or 3 channels, as many as asked for at most. */
int float_map_read(image_f32 *out, const char *path, int channels, int *is_float, failure *f);

#endif
