/* SPDX-License-Identifier: MIT */
/* One band: its triangles into depth and normals, those into pixels. */
#include "soft.h"

#include <string.h>

typedef struct drawing {
    const nacre_soft *soft;
    soft_pixels pixels;
    const soft_item *blended; /* NULL: all that are not */
} drawing;

static void draw_corners(const drawing *d, const soft_item *item, unsigned item_index,
                         const soft_vertex *const corner[3], const soft_detail *const detail[3])
{
    if (SHADE_HAS_MAPS && item->mapped)
        soft_draw_mapped(item, corner, detail, &d->pixels, item_index);
    else
        d->soft->desc.kernels->draw(corner, item->cull, &d->pixels, item_index);
}

static void draw_clipped(const drawing *d, const soft_item *item, unsigned item_index, const uint32_t index[3])
{
    soft_vertex polygon[SOFT_MOST_CORNERS];
    soft_detail details[SOFT_MOST_CORNERS];
    const int count = soft_clip(d->soft, item, index, polygon, details);
    int i;

    for (i = 2; i < count; i++) {
        const soft_vertex *const corner[3] = {&polygon[0], &polygon[i - 1], &polygon[i]};
        const soft_detail *const detail[3] = {&details[0], &details[i - 1], &details[i]};

        draw_corners(d, item, item_index, corner, detail);
    }
}

FX_APART static void draw_mapped(const drawing *d, const soft_item *item, unsigned item_index, const uint32_t index[3],
                                 const soft_vertex *const corner[3])
{
    soft_detail details[3];
    const soft_detail *const detail[3] = {&details[0], &details[1], &details[2]};
    int i;

    for (i = 0; i < 3; i++) soft_detail_of(item, index[i], &details[i]);
    soft_draw_mapped(item, corner, detail, &d->pixels, item_index);
}

static void draw_triangle(void *user, const soft_item *item, unsigned item_index, const uint32_t index[3])
{
    const drawing *const d = user;
    const soft_vertex *const v = d->soft->vertex + item->first_vertex;
    const soft_vertex *const corner[3] = {&v[index[0]], &v[index[1]], &v[index[2]]};

    if (item->blend ? d->blended != item : d->blended != NULL) return;
    if (corner[0]->z == SOFT_OUTSIDE || corner[1]->z == SOFT_OUTSIDE || corner[2]->z == SOFT_OUTSIDE)
        draw_clipped(d, item, item_index, index);
    else if (SHADE_HAS_MAPS && item->mapped)
        draw_mapped(d, item, item_index, index, corner);
    else
        d->soft->desc.kernels->draw(corner, item->cull, &d->pixels, item_index);
}

static uint8_t *take(uint8_t **at, size_t bytes)
{
    uint8_t *const out = *at;

    *at += (bytes + 15) / 16 * 16;
    return out;
}

size_t nacre_soft_scratch_size(const nacre_soft_desc *desc)
{
    size_t pixels;

    if (!nacre_soft_size(desc)) return 0;
    pixels = (size_t)desc->width * (desc->band_rows ? desc->band_rows : 8);
    return pixels * (desc->max_items > 1 || desc->blend ? 9 : 8) + 4 * 16 +
           64; /* 16: alignment; 64: what SIMD kernels may touch beyond the end */
}

static void set_pixels(soft_pixels *out, const nacre_soft *soft, int y0, int y1, void *scratch)
{
    const size_t count = (size_t)(y1 - y0) * soft->desc.width;
    uint8_t *at = scratch;

    at += (16 - ((uintptr_t)at & 15)) & 15;
    out->xy = (uint32_t *)(void *)take(&at, count * 4);
    out->depth = (uint16_t *)(void *)take(&at, count * 2);
    out->z = (int16_t *)(void *)take(&at, count * 2);
    out->item = soft->desc.max_items > 1 || soft->desc.blend ? take(&at, count) : NULL;
    out->stride = soft->desc.width;
    out->row0 = y0;
    out->x0 = soft->scissor[0];
    out->x1 = soft->scissor[2];
    memset(out->depth, 0xFF, count * 2);
}

/* Band by band: every triangle is listed in each it touches. */
static void draw_rows(drawing *d, int y0, int y1)
{
    int y;

    for (y = y0; y < y1; y = d->pixels.y1) {
        const uint32_t band = soft_band_of(d->soft, y);
        const int end = (int)((band + 1) * d->soft->desc.band_rows);

        d->pixels.y0 = y;
        d->pixels.y1 = end < y1 ? end : y1;
        soft_each_triangle(d->soft, band, draw_triangle, d);
    }
}

nacre_result nacre_soft_band(const nacre_soft *soft, int y0, int y1, void *scratch, size_t size, void *pixels,
                             size_t stride)
{
    const unsigned bytes = soft ? soft_pixel_bytes(soft->desc.format) : 1;
    const int rows = y1 - y0;
    drawing d;
    int y, i;

    if (!soft || !scratch || !pixels || y0 < 0 || y1 > soft->desc.height || y0 >= y1 ||
        y1 - y0 > soft->desc.band_rows || ((uintptr_t)pixels | stride) & (bytes - 1) ||
        stride < bytes * (size_t)soft->desc.width)
        return NACRE_ERR_ARGUMENT;
    if (size < nacre_soft_scratch_size(&soft->desc)) return NACRE_ERR_MEMORY;
    d.soft = soft;
    d.blended = NULL;
    set_pixels(&d.pixels, soft, y0, y1, scratch);
    if (y0 < soft->scissor[1]) y0 = soft->scissor[1];
    if (y1 > soft->scissor[3]) y1 = soft->scissor[3];
    draw_rows(&d, y0, y1);
    for (y = y0; y < y1; y++)
        soft_shade_row(soft, &d.pixels, y, (uint8_t *)pixels + (size_t)(y - d.pixels.row0) * stride);
    for (i = 0; SHADE_HAS_MAPS && i < soft->item_count; i++) {
        if (!soft->item[i].blend) continue;
        d.blended = &soft->item[i];
        memset(d.pixels.xy, 0x80, (size_t)rows * soft->desc.width * 4);
        draw_rows(&d, y0, y1);
        for (y = y0; y < y1; y++)
            soft_blend_row(soft, d.blended, &d.pixels, y, (uint8_t *)pixels + (size_t)(y - d.pixels.row0) * stride);
    }
    return NACRE_OK;
}

nacre_result nacre_soft_frame(const nacre_soft *soft, void *scratch, size_t size, void *pixels, size_t stride)
{
    nacre_result r = soft ? NACRE_OK : NACRE_ERR_ARGUMENT;
    int y;

    for (y = 0; !r && y < soft->desc.height; y += soft->desc.band_rows) {
        const int end = y + soft->desc.band_rows > soft->desc.height ? soft->desc.height : y + soft->desc.band_rows;

        if (end <= soft->scissor[1] || y >= soft->scissor[3]) continue;
        r = nacre_soft_band(soft, y, end, scratch, size, pixels ? (uint8_t *)pixels + (size_t)y * stride : pixels,
                            stride);
    }
    return r;
}

int nacre_soft_bands(const nacre_soft *soft, void *scratch, size_t size, void *first, void *second, size_t stride,
                     nacre_soft_ready *ready, void *user)
{
    int y, odd = 0, r = soft && ready ? 0 : NACRE_ERR_ARGUMENT;

    for (y = 0; !r && y < soft->desc.height; y += soft->desc.band_rows) {
        const int end = y + soft->desc.band_rows > soft->desc.height ? soft->desc.height : y + soft->desc.band_rows;
        void *const to = odd && second ? second : first;

        if (end <= soft->scissor[1] || y >= soft->scissor[3]) continue;
        r = nacre_soft_band(soft, y, end, scratch, size, to, stride);
        if (!r) r = ready(user, y, end, to, stride);
        odd = !odd;
    }
    return r;
}
