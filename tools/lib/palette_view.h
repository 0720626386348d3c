/* SPDX-License-Identifier: MIT */
/* How near a palette comes to the painting it was baked from, beside maps of Lafortune lobes of the same painting. */
#ifndef PALETTE_VIEW_H
#define PALETTE_VIEW_H

#include "palette.h"
#include "png_io.h"

/* Nearest texel, between four, and Lafortune maps of 1, 2 and 3 lobes. */
enum { PALETTE_WAYS = 5 };
extern const char *const palette_way_names[PALETTE_WAYS];

typedef struct palette_score {
    double inside_db;           /* PSNR over all lights' pixels between four texels of one material */
    double pooled_db, worst_db; /* over all pixels, edges between materials too; and of the worst picture */
} palette_score;

/* Spheres under the map, 192 x 192, from straight ahead, under one light at 0, 15 .. 165 degrees from the eye, exposed by the
   palette's E, drawn in double: the painting's own BRDFs (their mean in proportion to what shows of each, and between texels
   bilinear), and each way. sheet receives pictures of three lights. The painting is read again from path. */
int palette_view(const palette *p, const char *path, palette_score score[PALETTE_WAYS], image_u8 *sheet,
                 progress *meter, failure *f);

/* The painting's own BRDFs as one that varies over the surface. Takes the painting over (malloc'd), also when it fails. */
int painting_brdf(brdf **out, painting *p, failure *f);

#endif
