/* SPDX-License-Identifier: MIT */
/*
 * Palettes: up to 256 half-vector tables with common numbers, and a map of which texel is of which, so that every texel of a
 * surface can be a measured material. Files: roles "palette" and "index" in nacre_asset.h.
 */
#ifndef PALETTE_H
#define PALETTE_H

#include "painting.h"
#include "table_bake.h"

typedef struct palette {
    int count;          /* of tables, 1..256 */
    table_asset *table; /* one layer, p = 4; e, ymax, w, eps, rows and size are the same in all */
    int width, height;  /* of the index map */
    int levels, blend;  /* blend: between four texels */
    uint8_t *code[NACRE_MAX_LEVELS];
    double white_sky[3]; /* mean over the map */
    char name[128];
} palette;

typedef struct palette_options { /* zero means default */
    int width, height;           /* of a table, texels, 4..128 (24 x 21) */
    int blend;                   /* 1: between four texels */
    int no_mips;                 /* 1: one level */
    progress *progress;          /* told of tables; may be NULL */
} palette_options;

/* Bake a painting's materials and paint its map: each texel takes the material of which most shows. FAIL_UNSUPPORTED: what a
   table can't hold (anisotropic BRDFs; tint, shine, turn, direction, opacity). FAIL_INVALID: a code of an index picture
   beyond the materials. *out is untouched on failure. */
int palette_bake(palette *out, const char *path, const palette_options *options, sbrdf_sources *sources, failure *f);
void palette_free(palette *p);

/* The two files. */
void palette_write(const palette *p, bytes *tables, bytes *index);
/* The palette in two opened images; paths are for messages. FAIL_INVALID: a key, format or size is not what nacre_asset.h
   says, or a code names no table. */
int palette_read(palette *out, const nacre_image *tables, const char *tables_path, const nacre_image *index,
                 const char *index_path, failure *f);
/* Either alone, checked. counts: count, columns, w, h of NACRE_KEY_TILES. */
int palette_check_tables(const nacre_image *image, const char *path, uint32_t counts[4], failure *f);
int palette_check_index(const nacre_image *image, const char *path, int *blend, int *most, failure *f);

/* As a BRDF: eval_at is what level 0 of the map draws, eval the mean over the map. Takes the palette over: *p is emptied. */
brdf *palette_brdf(palette *p);

/* Bytes of texels of both files. */
size_t palette_texel_bytes(const palette *p);
/* Columns of tiles for so many tables of w x h: fp16 knows more of a coordinate in a narrow image, and columns matter more
   than rows. 0: more than 2048 texels either way. */
int palette_columns(int count, int w, int h);

#endif
