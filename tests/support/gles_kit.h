/* SPDX-License-Identifier: MIT */
/* What GLES tests draw: small smooth assets, a lumpy ball, views; and contexts that can be made anew. */
#ifndef GLES_KIT_H
#define GLES_KIT_H

#include "fake_gl.h"
#include "gl_headless.h"
#include "nacre_gles.h"
#include "workspace.h"

typedef enum kit_model {
    KIT_TABLE,   /* 24 x 21, p = 4.8, phi_d */
    KIT_FINE,    /* two layers, p = 4 */
    KIT_SPHERES, /* 4 layers of 32 x 32, 6 levels */
    KIT_PAPER,   /* the same of 128 x 128, 8 levels, cosine in the image */
    KIT_ETC1,    /* spheres of ETC1 blocks */
    KIT_RGB565,  /* spheres, 5 layers of 20 x 12, mips cut short */
    KIT_QUARTER, /* spheres, 5 quarters of 16 x 16, RGB8 */
    KIT_EARLY,   /* as KIT_FINE, a file of nine numbers */
    KIT_SBRDF,   /* maps of 16 x 16, 5 levels: diffuse albedo, */
    KIT_LOBES,   /* three lobes with a direction, */
    KIT_POWER,   /* and x^n, 32 x 16 */
    KIT_PALETTE, /* five tables of 8 x 5 in tiles, and maps of 16 x 16, 5 levels: */
    KIT_INDEX,   /* by the nearest texel, */
    KIT_BLEND,   /* and between four */
    KIT_NORMAL,  /* 8 x 8 normal map, RGB8 */
    KIT_MODELS
} kit_model;

typedef struct kit {
    void *file[KIT_MODELS]; /* KTX2 bytes */
    nacre_image image[KIT_MODELS];
    nacre_mesh ball; /* object space: centre (.25,.5,-.125), half extent (1,.75,.5) */
    float *floats;   /* the same mesh as floats: position 3, normal 3, tangent 4, uv 2 */
} kit;

void kit_open(kit *k);
void kit_close(kit *k);
/* normal: 1 with the normal map. KIT_SBRDF takes its other maps along, KIT_PALETTE the map of nearest texels, KIT_BLEND the
   tables. */
nacre_material kit_material(const kit *k, kit_model model, int normal);
/* lights: 0..8 of a fixed set, the last `points` of them point lights. The view keeps pointing to a static array. */
nacre_view kit_view(int lights, int points, int perspective);

/* What no sane host leaves behind, without a real loader: odd bindings and switches everywhere. The objects, 6, stay the
   host's. */
void kit_hostile_state(int es);

/* A real context with a fresh w x h framebuffer; 0 when this machine has none of that kind. */
int kit_context(gl_headless **out, gl_backend backend, int width, int height);
/* Largest difference of any channel, and at *covered (may be NULL) how many pixels of a are not background. */
int kit_difference(const image_u8 *a, const image_u8 *b, int *covered);

/* An object in a guarded block of its own, on the loader of fake_gl (started by the caller). */
typedef struct kit_world {
    workspace block;
    nacre_gles *gles; /* NULL: not begun */
    nacre_gles_desc desc;
    char log[4000];
} kit_world;

/* Fills in get_proc, log and user; desc may be NULL. Makes the block, calls nothing. */
void kit_world_make(kit_world *w, const nacre_gles_desc *desc);
nacre_result kit_world_init(kit_world *w);
/* Returns 1 when the block's surroundings are as they were. */
int kit_world_free(kit_world *w);

#endif
