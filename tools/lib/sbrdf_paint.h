/* SPDX-License-Identifier: MIT */
/*
 * Painted materials: named BRDFs laid over each other through mask pictures, by a text of one statement a line:
 *
 *   size 256 256                 texels; before all else but lobes
 *   lobes 2                      1..3 a texel (1)
 *   material NAME BRDF           fitted with that many lobes, to what is seen; later statements use NAME
 *   fill NAME [words]            the whole map
 *   paint NAME MASK.png [words]  where the mask is bright, over what is there; grey mixes the two
 *   opacity MASK.png             alpha
 *
 * words: tint=F.png multiplies the diffuse albedo, shine=F.png the lobe albedos (both sRGB pictures), turn=DEGREES turns
 * the material about the normal, direction=F.png turns it along a picture's R and G (128: 0, 255: 1). # begins a comment.
 * File names are relative to the text's place.
 */
#ifndef SBRDF_PAINT_H
#define SBRDF_PAINT_H

#include "sbrdf_field.h"

typedef struct sbrdf_sources { /* files that went in, for depfiles; malloc'd */
    char **path;
    int count;
} sbrdf_sources;
void sbrdf_sources_add(sbrdf_sources *s, const char *path);
void sbrdf_sources_free(sbrdf_sources *s);

/* FAIL_INVALID names the text's line. *sources receives the pictures (also when it fails; free it). */
int sbrdf_paint(sbrdf_field *out, const char *path, sbrdf_sources *sources, progress *p, failure *f);

#endif
