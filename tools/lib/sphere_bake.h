/* SPDX-License-Identifier: MIT */
/* Sphere images of Mihalik & Durikovic 2015: quarters of them without the cosine (default), whole ones without it, or
   exactly as the paper. */
#ifndef SPHERE_BAKE_H
#define SPHERE_BAKE_H

#include "brdf.h"
#include "nacre.h"
#include "output.h"
#include "progress.h"

enum { SPHERE_MAX_LAYERS = 16, SPHERE_MIN_SIZE = 8, SPHERE_MAX_SIZE = 2048, SPHERE_MAX_QUARTER = 128 };
#define SPHERE_MIN_STEP_DEG 0.5 /* least difference of neighbouring light polar angles */

typedef enum sphere_mode { SPHERE_QUARTER, SPHERE_COSINE_FREE, SPHERE_PAPER } sphere_mode;
extern const char *const sphere_mode_names[3]; /* "quarter", "cosine-free", "paper" */

typedef struct sphere_options { /* zero means default */
    double polar[64];           /* degrees, rising, 0..179 */
    int polar_count;
    int images; /* how many, where polar gives none: 1..16, quarters 2..16 (4; quarters 6). At 180 i / images degrees, quarters
                   as quarter_polar says */
    int size; /* texels a side, 8..2048, quarters 8..128 (256; paper 512; quarters 32) */
    sphere_mode mode;
    int format; /* NACRE_FORMAT_RGBA8, _RGB8 (quarters' default), _RGB565, _ETC2_RGB8 */
    int etc2;   /* _ETC2_RGB8: 1: any mode of ETC2; 0: modes of ETC1 only, which GLES 2 can read */
    int no_pad; /* 1: disc touches the image's edge; always so in paper mode */
    int no_mips;
    progress *progress; /* told of images; may be NULL */
} sphere_options;

typedef struct sphere_asset {
    int size, layers, levels, format;
    int etc2; /* blocks may be in any mode of ETC2 */
    sphere_mode mode;
    double polar[64]; /* degrees, as stored (bam) */
    double scale[3];  /* as stored (q16) */
    double disc;      /* disc diameter / image width, as stored */
    double albedo[3];
    bytes level[12]; /* encoded texels */
    char name[256];
} sphere_asset;

int sphere_bake(sphere_asset *out, const brdf *b, const sphere_options *options, failure *f);
void sphere_write(const sphere_asset *s, bytes *out); /* KTX2 */
int sphere_read(sphere_asset *out, const nacre_image *image, const char *path, failure *f);
void sphere_free(sphere_asset *s);

/* The spheres as a BRDF in double: level 0, bilinear, the rotation and blend of the runtime. With phi = angle(to_light,
   to_eye), the normal n in the images' frame, and R_y (x' = x c + z s, z' = -x s + z c):
     polar[i] <= phi <= polar[i+1]: codes of image i at R_y(k (polar[i] - phi)) n and of i+1 likewise, blended with
     t = (phi - polar[i]) / (polar[i+1] - polar[i]); cosine-free k = 1/2, paper k of eq. 3.
     Below the first and above the last angle: that image alone, k = 1/2, paper k = 3/4.
     Quarters: quarter_fit.h.
   A normal turned past the rim (z' < 0) stays at the rim. In paper mode only eval_cosine is exact. Takes a copy.
   Variants of the paper's figure 4: */
typedef struct sphere_decode_options { /* zero means default */
    double k;      /* fixed rotation coefficient for all angles; 0: as above. Negative turns the wrong way */
    double shrink; /* 0: 1 cosine-free, 0.995 paper mode; 1: none (rim artefact, fig. 4 d) */
} sphere_decode_options;
brdf *sphere_brdf(const sphere_asset *s, const sphere_decode_options *options);

#endif
