/* SPDX-License-Identifier: MIT */
/* Sphere images of Mihalik & Durikovic 2015 (cosine-free by default, or exactly as the paper). */
#ifndef SPHERE_BAKE_H
#define SPHERE_BAKE_H

#include "brdf.h"
#include "nacre.h"
#include "output.h"

typedef enum sphere_mode { SPHERE_COSINE_FREE, SPHERE_PAPER } sphere_mode;

typedef struct sphere_options { /* zero means default */
    double polar[64]; /* degrees, rising, 0..179 (cosine-free: 0,45,90,135; the same in paper mode) */
    int polar_count;
    int size;         /* texels, 8..2048 (256; paper 512) */
    sphere_mode mode;
    int format;       /* NACRE_FORMAT_RGBA8 (default), _RGB565, _ETC2_RGB8 (ETC1 modes only) */
    int no_pad;       /* 1: disc touches the image's edge; always so in paper mode */
    int no_mips;
} sphere_options;

typedef struct sphere_asset {
    int size, layers, levels, format;
    sphere_mode mode;
    double polar[64];  /* degrees, as stored (bam) */
    double scale[3];   /* as stored (q16) */
    double disc;       /* disc diameter / image width, as stored */
    double albedo[3];
    bytes level[12];   /* encoded texels */
    char name[256];
} sphere_asset;

int sphere_bake(sphere_asset *out, const brdf *b, const sphere_options *options, failure *f);
void sphere_write(const sphere_asset *s, bytes *out); /* KTX2 */
int sphere_read(sphere_asset *out, const nacre_image *image, const char *path, failure *f);
void sphere_free(sphere_asset *s);

/* The spheres as a BRDF in double: level 0, bilinear, the rotation and blend of the runtime. In paper mode only
   eval_cosine is exact. Variants of the paper's figure 4: */
typedef struct sphere_decode_options { /* zero means default */
    double k;        /* fixed rotation coefficient; 0: k = 1/2 cosine-free, eq. 3 in paper mode */
    double shrink;   /* 0: 1 cosine-free, 0.995 paper mode; 1: none (rim artefact, fig. 4 d) */
} sphere_decode_options;
brdf *sphere_brdf(const sphere_asset *s, const sphere_decode_options *options);

#endif
