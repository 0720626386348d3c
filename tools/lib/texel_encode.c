/* SPDX-License-Identifier: MIT */
#include "texel_encode.h"

#include <stdlib.h>

#include "etc1.h"
#include "etc2.h"
#include "failure.h"
#include "nacre_asset.h"
#include "pixels.h"

size_t texel_bytes(int format, int width, int height)
{
    size_t count = (size_t)width * (size_t)height;
    switch (format) {
    case NACRE_FORMAT_RGBA8:
        return 4 * count;
    case NACRE_FORMAT_RGB8:
        return 3 * count;
    case NACRE_FORMAT_RGB565:
        return 2 * count;
    case NACRE_FORMAT_ETC2_RGB8:
        return etc1_size(width, height);
    default:
        return 0;
    }
}

static unsigned nearest(float x, unsigned most)
{
    return x > 0 ? x < 1 ? (unsigned)(x * (float)most + 0.5F) : most : 0;
}

static void encode_etc(int etc2, const float *rgb, int width, int height, uint8_t *out)
{
    size_t count = 3 * (size_t)width * (size_t)height;
    uint8_t *codes = need_memory(count, 1);
    for (size_t i = 0; i < count; i++) codes[i] = (uint8_t)nearest(rgb[i], 255);
    if (etc2)
        etc2_encode(codes, width, height, out);
    else
        etc1_encode(codes, width, height, out);
    free(codes);
}

void texel_encode(int format, int etc2, const float *rgb, int width, int height, uint8_t *out)
{
    size_t count = (size_t)width * (size_t)height;
    size_t step = format == NACRE_FORMAT_RGB8 ? 3 : 4;
    if (format == NACRE_FORMAT_ETC2_RGB8) {
        encode_etc(etc2, rgb, width, height, out);
        return;
    }
    for (size_t i = 0; i < count; i++, rgb += 3) {
        if (format == NACRE_FORMAT_RGB565) {
            unsigned code = nearest(rgb[0], 31) << 11 | nearest(rgb[1], 63) << 5 | nearest(rgb[2], 31);
            out[2 * i] = (uint8_t)code;
            out[2 * i + 1] = (uint8_t)(code >> 8);
        } else {
            for (int c = 0; c < 3; c++) out[step * i + (size_t)c] = (uint8_t)nearest(rgb[c], 255);
            if (step == 4) out[4 * i + 3] = 255;
        }
    }
}

void texel_decode(int format, const uint8_t *texel, int width, int height, float *rgb)
{
    size_t count = (size_t)width * (size_t)height, step = format == NACRE_FORMAT_RGB8 ? 3 : 4;
    if (format == NACRE_FORMAT_ETC2_RGB8) {
        uint8_t *codes = need_memory(count, 3);
        etc2_decode(texel, width, height, codes);
        for (size_t i = 0; i < 3 * count; i++) rgb[i] = (float)codes[i] / 255;
        free(codes);
        return;
    }
    for (size_t i = 0; i < count; i++, rgb += 3) {
        if (format == NACRE_FORMAT_RGB565) {
            unsigned code = texel[2 * i] | (unsigned)texel[2 * i + 1] << 8;
            rgb[0] = (float)(code >> 11) / 31;
            rgb[1] = (float)(code >> 5 & 63) / 63;
            rgb[2] = (float)(code & 31) / 31;
        } else {
            for (int c = 0; c < 3; c++) rgb[c] = (float)texel[step * i + (size_t)c] / 255;
        }
    }
}
