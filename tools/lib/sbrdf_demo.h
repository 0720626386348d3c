/* SPDX-License-Identifier: MIT */
/* Six procedural materials in the spirit of McAllister et al. 2002, figures 5 and 6, as paintings (sbrdf_paint.h) with
   their pictures: gilded wallpaper, cherry wood, gift wrap, a composite of twelve, upholstery, brushed metal. */
#ifndef SBRDF_DEMO_H
#define SBRDF_DEMO_H

#include "failure.h"

enum { SBRDF_DEMO_COUNT = 6, SBRDF_DEMO_SIDE = 256 };

/* "wallpaper", "cherry-wood", "gift-wrap", "composite", "upholstery", "brushed-metal" */
const char *sbrdf_demo_name(int index);

/* Write DIRECTORY/NAME.txt and the PNGs it names, DIRECTORY/NAME-*.png. The directory must be there. */
int sbrdf_demo_write(int index, const char *directory, failure *f);

#endif
