/* SPDX-License-Identifier: MIT */
/* Tangent-space normal maps as files of role "normal" (nacre_asset.h). */
#ifndef NORMAL_FILE_H
#define NORMAL_FILE_H

#include "output.h"
#include "pixels.h"

/* Append a KTX2 file of an RGBA picture's codes: xyz = 2 code/255 - 1, +y up. x and y are multiplied by scale and normals
   brought to unit length again; smaller levels hold means of unit length. no_mips: 1: one level; 0: the full chain where both
   sides are powers of two. */
void normal_file_write(const image_u8 *picture, double scale, int no_mips, const char *name, bytes *out);

#endif
