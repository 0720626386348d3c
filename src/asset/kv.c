// SPDX-License-Identifier: MIT
#include "asset.h"

/* One entry: u32 length of key and value, key, NUL, value, zeros up to a multiple of 4. */

static uint32_t padded(uint32_t length)
{
    return (length + 3) & ~(uint32_t)3;
}

nacre_result asset_kv_check(const uint8_t *kv, uint32_t size)
{
    while (size) {
        uint32_t length, i;

        if (size < 8) return NACRE_ERR_ASSET;
        length = asset_u32le(kv);
        size -= 4;
        kv += 4;
        if (length > size || padded(length) > size) return NACRE_ERR_ASSET;
        for (i = 0; i < length && kv[i]; i++) {}
        if (i == 0 || i == length) return NACRE_ERR_ASSET;
        kv += padded(length);
        size -= padded(length);
    }
    return NACRE_OK;
}

/* Bytes of key with its NUL if the entry at kv has this key, else 0; asset_kv_check has seen the entry's own NUL. */
static uint32_t match(const uint8_t *kv, const char *key)
{
    uint32_t i = 0;

    while (kv[i] == (uint8_t)key[i])
        if (!kv[i++]) return i;
    return 0;
}

const uint8_t *nacre_image_key(const nacre_image *image, const char *key, uint32_t *size)
{
    const uint8_t *kv, *end;

    if (!image || !key || !image->bytes) return 0;
    kv = image->bytes + image->kv_offset;
    end = kv + image->kv_size;
    while (kv < end) {
        const uint32_t length = asset_u32le(kv), skip = match(kv + 4, key);

        if (skip) {
            if (size) *size = length - skip;
            return kv + 4 + skip;
        }
        kv += 4 + padded(length);
    }
    return 0;
}

int asset_key_u32(const nacre_image *image, const char *key, uint32_t *out, unsigned count)
{
    uint32_t size;
    const uint8_t *value = nacre_image_key(image, key, &size);
    unsigned i;

    if (!value || size != 4 * (uint32_t)count) return 0;
    for (i = 0; i < count; i++) out[i] = asset_u32le(value + 4 * i);
    return 1;
}

int asset_key_q16(const nacre_image *image, const char *key, nacre_q16 *out, unsigned count)
{
    /* int32_t is two's complement, and C lets an object be written as its unsigned twin */
    return asset_key_u32(image, key, (uint32_t *)out, count);
}

int asset_key_is(const nacre_image *image, const char *key, const char *text)
{
    uint32_t size, length;
    const uint8_t *value = nacre_image_key(image, key, &size);

    if (!value) return 0;
    for (length = 0; length < size && value[length] == (uint8_t)text[length]; length++)
        if (!text[length]) return length + 1 == size;
    return 0;
}
