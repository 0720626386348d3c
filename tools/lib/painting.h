/* SPDX-License-Identifier: MIT */
/*
 * Painted materials: named BRDFs laid over each other through mask pictures, by a text of one statement a line:
 *
 *   size 256 256                 texels; before all else but lobes
 *   lobes 2                      1..3 a texel (1); for Lafortune maps, which fit each material with so many
 *   material NAME BRDF           later statements use NAME
 *   fill NAME [words]            the whole map
 *   paint NAME MASK.png [words]  where the mask is bright, over what is there; grey mixes the two
 *   opacity MASK.png             alpha
 *   index PICTURE.png            palettes, in place of fill and paint: grey codes are the materials' numbers from 0 on
 *
 * words: tint=F.png multiplies the diffuse albedo, shine=F.png the lobe albedos (both sRGB pictures), turn=DEGREES turns
 * the material about the normal, direction=F.png turns it along a picture's R and G (128: 0, 255: 1). # begins a comment.
 * File names are relative to the text's place.
 */
#ifndef PAINTING_H
#define PAINTING_H

#include "failure.h"
#include "output.h"
#include "pixels.h"

enum { PAINTING_MATERIALS = 256, PAINTING_COATS = 256 };

typedef struct sbrdf_sources { /* files that went in, for depfiles; malloc'd */
    char **path;
    int count;
} sbrdf_sources;
void sbrdf_sources_add(sbrdf_sources *s, const char *path);
void sbrdf_sources_free(sbrdf_sources *s);

typedef struct painting_material {
    char name[64], brdf[512];
    int line; /* of the text */
} painting_material;

/* One fill or paint. */
typedef struct painting_coat {
    int material, line;
    image_u8 mask, tint, shine, direction; /* texel NULL: none */
    double turn[2];                        /* cosine and sine */
} painting_coat;

typedef struct painting {
    const char *path; /* borrowed */
    int width, height, lobes;
    painting_material material[PAINTING_MATERIALS];
    int material_count;
    painting_coat coat[PAINTING_COATS];
    int coat_count;
    image_u8 opacity, index; /* texel NULL: none */
} painting;

/* Read text and pictures. path is borrowed by *out. FAIL_INVALID names the text's line. *sources receives the pictures (also
   when it fails; free it). Free *out with painting_close in any case; it is large: not for the stack. */
int painting_open(painting *out, const char *path, sbrdf_sources *sources, failure *f);
void painting_close(painting *p);

/* A line of the text in a message. */
int painting_fail(const painting *p, int line, failure *f, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* What shows at a texel: coats from the top one down to one that hides the rest, and how much of each. Returns how many. */
int painting_visible(const painting *p, long texel, int coat[PAINTING_COATS], double weight[PAINTING_COATS]);

#endif
