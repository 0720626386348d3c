/* SPDX-License-Identifier: MIT */
/* KTX2 files of the profile in nacre_asset.h; deterministic bytes. */
#ifndef KTX2_WRITE_H
#define KTX2_WRITE_H

#include "nacre.h"
#include "output.h"

#define KTX2_MAX_KEYS 16

typedef struct ktx2_image {
    int format; /* NACRE_FORMAT_* */
    int width, height;
    int layers;      /* 0: not an array */
    int faces;       /* 1 or 6 */
    int levels;      /* 1..12 */
    int srgb;        /* transfer function named in the data format descriptor: 1 sRGB, 0 linear */
    bytes level[12]; /* texels of level i: layers x faces x rows, tight */
    struct {
        char name[32];
        bytes value;
    } key[KTX2_MAX_KEYS]; /* any order; the writer sorts and adds KTXorientation, KTXwriter and nacre.asset_version */
    int key_count;
} ktx2_image;

/* Append a key. Numbers become little-endian u32; their names must be 4n - 1 characters long, as the NACRE_KEY_* of
   numbers are, so that values are aligned as KTX2 asks. Texts get their NUL. A name may be given once. */
void ktx2_key_text(ktx2_image *k, const char *name, const char *value);
void ktx2_key_u32(ktx2_image *k, const char *name, const uint32_t *value, int count);
void ktx2_key_q16(ktx2_image *k, const char *name, const double *value, int count); /* nearest q16, saturating */

/* Append the file to *out. An image that no file can hold (level bytes that do not fit the size, a key twice) is a
   mistake of the caller: one line and FAIL_INTERNAL. */
void ktx2_write(const ktx2_image *k, bytes *out);
void ktx2_free(ktx2_image *k);

/* nacre.role of an opened file, for messages, and nacre.name; cut to fit, "" if it has none. */
void ktx2_role(const nacre_image *image, char *out, size_t size);
void ktx2_name(const nacre_image *image, char *out, size_t size);

#endif
