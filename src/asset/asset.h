/* SPDX-License-Identifier: MIT */
/* asset - from the bytes of a file to nacre_image, and its keys as numbers. The profile is nacre_asset.h. */
#ifndef ASSET_H
#define ASSET_H

#include "nacre.h"
#include "nacre_asset.h"

/* Little-endian loads from any address. */
static inline uint32_t asset_u16le(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

static inline uint32_t asset_u32le(const uint8_t *p)
{
    return asset_u16le(p) | asset_u16le(p + 2) << 16;
}

/* One format of the profile. */
typedef struct asset_format {
    uint8_t format;      /* NACRE_FORMAT_* */
    uint8_t block_bytes; /* of a texel, or of a block of 4 x 4 texels */
    uint8_t type_bytes;  /* KTX2's typeSize: of the unit that has a byte order */
    uint8_t block_shift; /* 2: blocks of 4 x 4 texels; 0: single texels */
} asset_format;

/* The format with this number, NULL if the profile has none. Static. */
const asset_format *asset_format_find(uint32_t format);

/* Bytes of one layer of one face of a level of this size, at most 2^27. width, height: level 0, 1..4096. */
uint32_t asset_part_bytes(const asset_format *format, uint32_t width, uint32_t height, unsigned level);

/* NACRE_OK if the key/value entries are well formed: lengths inside size, a key that is not empty and its NUL. */
nacre_result asset_kv_check(const uint8_t *kv, uint32_t size);

/* Values of a key that is exactly count numbers long; returns 1, or 0 and leaves out alone if it is not. */
int asset_key_u32(const nacre_image *image, const char *key, uint32_t *out, unsigned count);
int asset_key_q16(const nacre_image *image, const char *key, nacre_q16 *out, unsigned count);

/* 1 if the key's value is exactly this text with its NUL. */
int asset_key_is(const nacre_image *image, const char *key, const char *text);

#endif
