/* SPDX-License-Identifier: MIT */
/* Codes into the frame's pixels. */
#include "soft.h"

#include <string.h>

/* 4 x 4 thresholds of Bayer 1973, 0..15. */
static const uint8_t pattern[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};

unsigned soft_pixel_bytes(unsigned format)
{
    return format == NACRE_SOFT_RGBA8 ? 4 : format == NACRE_SOFT_GRAY8 ? 1 : 2;
}

/* code x most / 255, nearest; plus the threshold (of 16) of a step */
static uint32_t fewer(uint32_t code, uint32_t most, uint32_t threshold)
{
    const uint32_t x = code * most * 16 + threshold * 255 + 1;

    return (x + (x >> 8) + (x >> 16)) >> 12; /* floor((x - 1) / 255) / 16 for all of them */
}

static uint32_t rgb565(uint32_t c, uint32_t threshold)
{
    return fewer(c & 255, 31, threshold) << 11 | fewer(c >> 8 & 255, 63, threshold) << 5 |
           fewer(c >> 16 & 255, 31, threshold);
}

/* The same without a threshold: nearest, in two instructions a channel. */
uint16_t soft_565(uint32_t c)
{
    return (uint16_t)((((c & 255) * 249 + 1014) >> 11) << 11 | (((c >> 8 & 255) * 253 + 505) >> 10) << 5 |
                      ((c >> 16 & 255) * 249 + 1014) >> 11);
}

void soft_swap(uint16_t *pixels, int count)
{
    int i;

    for (i = 0; i < count; i++) pixels[i] = (uint16_t)(pixels[i] >> 8 | pixels[i] << 8);
}

static void store_565(const nacre_soft_desc *desc, int32_t x, int32_t y, const uint32_t *rgba, int count, uint16_t *to)
{
    int i;

    if (desc->dither)
        for (i = 0; i < count; i++) to[i] = (uint16_t)rgb565(rgba[i], pattern[y & 3][(x + i) & 3]);
    else
        for (i = 0; i < count; i++) to[i] = soft_565(rgba[i]);
    if (desc->format == NACRE_SOFT_RGB565_SWAPPED) soft_swap(to, count);
}

static void store_rgba(const uint32_t *rgba, int count, uint8_t *to)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    memcpy(to, rgba, 4 * (size_t)count);
#else
    int i, k;

    for (i = 0; i < count; i++)
        for (k = 0; k < 4; k++) to[4 * i + k] = (uint8_t)(rgba[i] >> (8 * k));
#endif
}

void soft_load(const nacre_soft_desc *desc, const void *from, int count, uint32_t *rgba)
{
    const uint16_t *const pixel = from;
    const uint8_t *const byte = from;
    int i;

    for (i = 0; i < count; i++) {
        uint32_t p;

        if (desc->format == NACRE_SOFT_RGBA8) {
            rgba[i] = (uint32_t)byte[4 * i] | (uint32_t)byte[4 * i + 1] << 8 | (uint32_t)byte[4 * i + 2] << 16 |
                      (uint32_t)byte[4 * i + 3] << 24;
        } else if (desc->format == NACRE_SOFT_GRAY8) {
            rgba[i] = byte[i] * 0x010101u | 255u << 24;
        } else {
            p = desc->format == NACRE_SOFT_RGB565_SWAPPED ? (uint32_t)(pixel[i] >> 8 | (pixel[i] & 255) << 8)
                                                          : pixel[i];
            rgba[i] = ((p >> 11) * 527 + 23) >> 6 | (((p >> 5 & 63) * 259 + 33) >> 6) << 8 |
                      (((p & 31) * 527 + 23) >> 6) << 16 | 255u << 24;
        }
    }
}

void soft_store(const nacre_soft_desc *desc, int32_t x, int32_t y, const uint32_t *rgba, int count, void *to)
{
    uint8_t *const gray = to;
    int i;

    switch (desc->format) {
    case NACRE_SOFT_GRAY8:
        for (i = 0; i < count; i++) /* 0.2126, 0.7152, 0.0722 of 256 */
            gray[i] =
                (uint8_t)(((rgba[i] & 255) * 54 + (rgba[i] >> 8 & 255) * 183 + (rgba[i] >> 16 & 255) * 19 + 128) >> 8);
        break;
    case NACRE_SOFT_RGBA8:
        store_rgba(rgba, count, to);
        break;
    default:
        store_565(desc, x, y, rgba, count, to);
        break;
    }
}
