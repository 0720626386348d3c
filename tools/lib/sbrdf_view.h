/* SPDX-License-Identifier: MIT */
/* How well a material's smaller levels stand for its texels: a flat sheet of it under a lamp, seen from so far that a pixel
   covers 4 x 4, 8 x 8 and 16 x 16 texels. */
#ifndef SBRDF_VIEW_H
#define SBRDF_VIEW_H

#include "pixels.h"
#include "sbrdf_map.h"

enum { SBRDF_VIEWS = 3 }; /* 1/4, 1/8, 1/16 */

typedef struct sbrdf_view {
    int factor;          /* 4, 8, 16 */
    double level_psnr;   /* dB of display codes, against supersampling: by the map's own level ... */
    double average_psnr; /* ... and by means of the codes of level 0, as a GPU would make them */
} sbrdf_view;

/* Fills view; those whose level the map lacks have factor 0. pictures (may be NULL) receives a row of three per factor:
   supersampled, the level, means of codes. Pixels are as large as what they cover. */
void sbrdf_view_levels(const sbrdf_map *m, sbrdf_view view[SBRDF_VIEWS], image_u8 *pictures);
/* The same pictures with names above, sizes beside and dB below them. */
image_u8 sbrdf_view_label(const image_u8 *pictures, const sbrdf_view view[SBRDF_VIEWS]);

#endif
