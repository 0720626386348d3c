/* SPDX-License-Identifier: MIT */
/*
 * key - which shader text: a few small numbers, their name, and the text they give
 *
 * Keys are compared with memcmp: zero the whole struct first.
 */
#ifndef GLES_KEY_H
#define GLES_KEY_H

#include <stddef.h>
#include <stdint.h>

#include "shade.h"

typedef enum gles_key_model {
    GLES_KEY_TABLE,
    GLES_KEY_FINE,
    GLES_KEY_EARLY, /* the fine tier of nine numbers */
    GLES_KEY_SPHERES,
    GLES_KEY_PAPER,
    GLES_KEY_QUARTER,
    GLES_KEY_SBRDF,
    GLES_KEY_PALETTE, /* tables of one layer and p = 4, chosen by an index map */
    GLES_KEY_LIT      /* draws by lit spheres: no lights of its own */
} gles_key_model;

/* Passes, for light counts that one program can't hold. SUM reads both bytes of the previous sum, which is 0 before the first
   lights, adds its 1, 2, 4 or 8 lights, and writes two RGBA8 targets of the viewport's size, one for the high and one for the
   low byte of the new sum: at once in ES 3; else it is drawn twice (uniform u_byte), one program so that both round alike.
   LAST has no lights: it reads the sum, adds ambient, encodes to the caller's target. Sums are kept in 16 bits and clamped to 1 (srgb,
   sqrt) or to 16 (linear output, held x 1/16; gles_uniforms_set scales). The previous sum is read with texture2DProj at
   the pixel's own place: nearest filter, clamp to edge; the viewport is the whole target. */
typedef enum gles_key_pass { GLES_PASS_NONE, GLES_PASS_SUM, GLES_PASS_LAST } gles_key_pass;

typedef struct gles_key {
    uint8_t model;      /* gles_key_model */
    uint8_t phid;       /* table: 1 when any W is not 0 (fine, early, palette: always 1; others: 0) */
    uint8_t lights;     /* 0..8 of this pass; 0: ambient alone */
    uint8_t persp;      /* shade_needs_persp; 0 when lights is 0. */
    uint8_t output;     /* nacre_output; as the view says, also for SUM passes */
    uint8_t power48;    /* tables: 1: p = 4.8, 0: p = 4; others 0 */
    uint8_t toe;        /* tables drawn in SHADE_SRGB: 1: with the curve's linear toe (of a sphere always); others 0 */
    uint8_t normal_map; /* 0, 1 */
    uint8_t es3;        /* 1: GLSL ES 3.00 */
    uint8_t ambient;    /* 1: the view's ambient is not 0 (in passes: LAST only) */
    uint8_t pass;       /* gles_key_pass */
    uint8_t
        layers; /* persp: spheres and paper: 4, 6 or 8 units; quarter: images / 4, rounded up to 1, 2 or 4; others 0 */
    uint8_t sphere;     /* 1: the picture of a lit sphere, not a mesh (dist; no normal map) */
    uint8_t lobes;      /* sbrdf with lights: 1..3 of this pass; others 0 */
    uint8_t power;      /* sbrdf: 1: x^n by the table, 0: pow */
    uint8_t direction;  /* sbrdf: 1: direction of anisotropy a texel, 2: the same in a pass without the first lobe */
    uint8_t no_diffuse; /* sbrdf, SUM passes: 1: lobes alone, the diffuse albedo is in another pass */
    uint8_t blend;      /* palette: 1: between four texels of the index map */
    uint8_t mask;       /* lit: 1 alpha from the mask, 2 and a second sphere mixed by it; others 0 */
} gles_key;

#define GLES_KEY_NAME_SIZE 64

/* 1: a half-vector table, fine, early and palette too. */
int gles_key_is_table(const gles_key *key);

/* "table_phid_l1_dist_srgb_nm"; without extension. out: GLES_KEY_NAME_SIZE bytes. */
void gles_key_name(const gles_key *key, char *out);

/* Zero or fix what makes no difference, so that equal texts have equal keys; call before comparing or naming. Lights 0:
   ambient alone, whatever the model; SUM passes: the same for every output and without ambient; lit: of all that is said
   above only normal_map, es3 and mask. */
void gles_key_canonical(gles_key *key);

/* Class 1, 2 or 4 of a quarter program for so many images, 2..16. */
uint8_t gles_key_quarter_class(unsigned images);

/* Smallest layer class (4, 6, 8) that holds layers, at most what so many texture units hold (4..8). */
uint8_t gles_key_layer_class(unsigned layers, unsigned units);

/* What a program needs of the device. Vectors as GLSL ES 1.00 appendix A counts them. */
unsigned gles_key_uniform_vectors(const gles_key *key); /* fragment stage */
unsigned gles_key_units(const gles_key *key);           /* texture units in use */

/* Texture units, in this order: the model's own from 0: table: 0; fine, early: 0 and 1 (second layer); spheres dist: 2 i and
   2 i + 1 hold frame.light[i].is.spheres.layer[0] and [1]; spheres persp: unit i holds frame.layer[i]; quarter: 0.
   palette: 0 the tables, 1 the index map.
   lit: 0, and 1 for a second sphere. sbrdf: diffuse albedo (not with no_diffuse), layers 2 j and 2 j + 1 of each lobe,
   layers 0 and 2 where they are needed for the direction and no lobe's (gles_key_unit_direction), power table. Then,
   where the key has them, the normal map, the mask, and the two bytes of the
   previous sum. -1: none. */
int gles_key_unit_normal(const gles_key *key);
int gles_key_unit_mask(const gles_key *key);
int gles_key_unit_sum(const gles_key *key);                 /* high; the low one follows */
int gles_key_unit_direction(const gles_key *key, int axis); /* of layer 0 (axis 0) or 2 (axis 1) */

/* How light factors are prepared for this program (argument of shade_setup). */
shade_form gles_key_form(const gles_key *key);

/* Most lights (1..8, or 0 if not even one) that a program like key can take on a device with so many fragment uniform
   vectors and texture units; pass is a gles_key_pass (with one: 1, 2 or 4, of a sphere also 8); the key's own lights and pass are ignored.
   GLSL ES 1.00 programs stop at fewer, because compilers of ES 2.0 GPUs would refuse more. Under dist: 6 lights (fine), 4
   (sbrdf, blended palettes); under persp: 4 (tables, fine, palettes, sbrdf), 2 (blended palettes, spheres, quarter) or 1
   (paper). */
unsigned gles_key_max_lights(const gles_key *key, unsigned pass, unsigned uniform_vectors, unsigned units);

/* Every key that can arise with 8 texture units, in a fixed order; returns the number, writes up to count keys. */
unsigned gles_key_list(gles_key *out, unsigned count);

#define GLES_TEXT_PARTS   5
#define GLES_DEFINES_SIZE 768

/* Parts of the source for glShaderSource: version and #defines (written to defines, GLES_DEFINES_SIZE bytes), then
   embedded files. Returns the number of parts, at most GLES_TEXT_PARTS. */
int gles_text(const gles_key *key, int fragment, const char *part[GLES_TEXT_PARTS], int length[GLES_TEXT_PARTS],
              char *defines);

#endif
