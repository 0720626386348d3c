/* SPDX-License-Identifier: MIT */
/* Texels of maps: repeated or clamped, bilinear or nearest. */
#include "soft.h"

/* Texel and its neighbour along an axis, and the way between them (q8). uv: q27, 2^27 is one repetition. */
typedef struct place {
    uint32_t at, next;
    int32_t f;
} place;

static uint32_t fold(int32_t texel, uint32_t size, int clamp)
{
    if (clamp) return texel < 0 ? 0 : (uint32_t)texel < size ? (uint32_t)texel : size - 1;
    if (texel < 0) return (uint32_t)texel + size;
    return (uint32_t)texel < size ? (uint32_t)texel : (uint32_t)texel - size;
}

static place place_of(int32_t uv_q27, uint32_t size, unsigned flags)
{
    const int clamp = (flags & SOFT_CLAMP) != 0;
    const uint32_t inside = (uint32_t)uv_q27 & 0x7FFFFFFu;
    /* repeated: within one repetition; clamped: as it is. q8 texels */
    const int64_t texels = ((clamp ? uv_q27 : (int64_t)inside) * size) >> 19;
    const int64_t from = flags & SOFT_NEAREST ? texels : texels - 128;
    place p;

    p.at = fold((int32_t)(from >> 8), size, clamp);
    p.next = fold((int32_t)(from >> 8) + 1, size, clamp);
    p.f = flags & SOFT_NEAREST ? 0 : (int32_t)(from & 255);
    return p;
}

void soft_sample(const soft_texture *t, unsigned layers, int32_t u_q27, int32_t v_q27, int32_t share, int32_t (*out)[4])
{
    const place x = place_of(u_q27, t->width, t->flags), y = place_of(v_q27, t->height, t->flags);
    const uint32_t row = (uint32_t)t->width * t->channels;
    const uint8_t *top = t->texels + y.at * row, *low = t->texels + y.next * row;
    unsigned i;

    for (; layers; layers--, out++, top += row * t->height, low += row * t->height)
        for (i = 0; i < t->channels; i++) {
            const uint32_t a = x.at * t->channels + i, b = x.next * t->channels + i;
            const int32_t upper = top[a] * 256 + (top[b] - top[a]) * x.f;
            const int32_t lower = low[a] * 256 + (low[b] - low[a]) * x.f;

            const int32_t code = upper * 256 + (lower - upper) * y.f;

            (*out)[i] = share ? (*out)[i] + ((code - (*out)[i]) >> 8) * share : code;
        }
}
