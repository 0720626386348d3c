/* SPDX-License-Identifier: MIT */
/* Bilinear texels of sphere images, whole and quarters, at level 0: rows run downwards, coordinates are held to the edge. */
#ifndef SHADE_EVAL_IMAGE_H
#define SHADE_EVAL_IMAGE_H

#include "eval_inner.h"

typedef struct image_place { /* between texels along one axis */
    uint32_t at, next;       /* byte offsets */
    int32_t f;               /* q15 */
} image_place;

/* texel: from the first one's centre, q17. step: bytes from texel to texel. */
static inline image_place image_between(int32_t texel, int32_t size, uint32_t step)
{
    const int32_t most = (size - 1) * 131072, held = eval_clip(texel, most);
    const uint32_t index = (uint32_t)held >> 17;
    image_place out;

    out.at = index * step;
    out.next = out.at + (index + 1 < (uint32_t)size ? step : 0);
    out.f = held >> 2 & 32767;
    return out;
}

/* coordinate: texture coordinate - 1/2, q29. */
static inline image_place image_whole(int32_t coordinate, int32_t size, uint32_t step)
{
    return image_between(((coordinate >> 12) + 65536) * size - 65536, size, step);
}

/* x: q29. log2(8 |x| + 1) = log2(|x| + 1/8) + 3 */
static inline image_place image_quarter(int32_t x, int32_t texels_per_log2, int32_t size, uint32_t step)
{
    const int32_t octaves = eval_log2((uint32_t)(x < 0 ? -x : x) + (1u << 26)) - 26 * 4096;

    return image_between((octaves * texels_per_log2 + 8) >> 4, size, step);
}

static inline int32_t image_mix(int32_t a, int32_t b, int32_t f)
{
    return a + ((b - a) * f >> 15);
}

/* Codes x 128. */
static inline void image_sample(const uint8_t *image, image_place x, image_place y, int32_t out[3])
{
    const uint8_t *const t00 = image + y.at + x.at, *const t10 = image + y.at + x.next;
    const uint8_t *const t01 = image + y.next + x.at, *const t11 = image + y.next + x.next;
    int i;

    for (i = 0; i < 3; i++)
        out[i] = image_mix(image_mix(t00[i] * 128, t10[i] * 128, x.f), image_mix(t01[i] * 128, t11[i] * 128, x.f), y.f);
}

#endif
