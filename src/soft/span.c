/* SPDX-License-Identifier: MIT */
/* A row's normals into pixels: runs of one item, some pixels at a time. */
#include "soft.h"

#include <string.h>

enum { BATCH = 32 }; /* pixels at a time: 500 bytes of stack */

/* The texel of a bisector: offset from the middle by h.xy / |h| x 5/8 size. */
static inline uint32_t texel_of(uint32_t size, uint32_t xy, int32_t z, uint32_t scale)
{
    const int32_t x = shade_x_of(xy), y = shade_y_of(xy);
    const int32_t length = (int32_t)(shade_lut_unit[(uint32_t)(x * x + y * y + z * z) >> 20] * scale >> 15);
    const int32_t half = (int32_t)size * 32768;

    const uint32_t at = (uint32_t)((half - y * length) >> 16) * size + (uint32_t)((half + x * length) >> 16);

    /* far corners of a triangle at the eye have few bits: their sums may point anywhere */
    return at < size * size ? at : 0;
}

void soft_lit(const nacre_soft_lit *lit, const uint32_t *xy, const int16_t *z, int count, unsigned bytes, void *to)
{
    const uint32_t size = lit->size, scale = size * 40; /* 5/8 size, for q14 to q16, x 16 */
    int i;

    if (bytes == 2) {
        uint16_t *const out = to;
        const uint16_t *const texels = lit->texels;

        for (i = 0; i < count; i++) out[i] = texels[texel_of(size, xy[i], z[i], scale)];
    } else if (bytes == 1) {
        uint8_t *const out = to;
        const uint8_t *const texels = lit->texels;

        for (i = 0; i < count; i++) out[i] = texels[texel_of(size, xy[i], z[i], scale)];
    } else {
        uint32_t *const out = to;
        const uint32_t *const texels = lit->texels;

        for (i = 0; i < count; i++) out[i] = texels[texel_of(size, xy[i], z[i], scale)];
    }
}

/* The same with directions per pixel, a few at a time. */
static void shade_near(const soft_item *item, const uint32_t *xy, const int16_t *z, const uint16_t *depth, int32_t x,
                       int32_t y, int count, shade_rgb radiance)
{
    enum { FEW = 8 };
    int32_t place[3][FEW];
    int32_t *const position[3] = {place[0], place[1], place[2]};
    uint32_t eye_xy[FEW];
    int16_t eye_z[FEW];
    int i, k;

    for (i = 0; i < count; i += FEW) {
        const int now = count - i < FEW ? count - i : FEW;
        const shade_seen seen = {xy + i, eye_xy, z + i, eye_z, {place[0], place[1], place[2]}, now};
        const shade_rgb part = {radiance.r + i, radiance.g + i, radiance.b + i};

        soft_lens_look(item, x + i, y, depth + i, now, position, eye_xy, eye_z);
        for (k = 0; k < item->lights; k++) {
            if (item->near)
                shade_table_persp_add(item->near, &item->near_light[k], &seen, part);
            else
                shade_spheres_persp_add(item->near_spheres, &item->near_light[k], &seen, part);
        }
    }
}

/* Up to BATCH pixels of an item, by its own model. */
static void shade_batch(const nacre_soft *soft, const soft_item *item, const soft_pixels *from, uint32_t at, int32_t x,
                        int32_t y, int count, uint32_t *rgba)
{
    uint32_t *const xy = from->xy + at;
    int16_t *const z = from->z + at;
    const nacre_soft_kernels *const k = soft->desc.kernels;
    uint32_t sum[3][BATCH];
    const shade_rgb radiance = {sum[0], sum[1], sum[2]};
    int i;

    if (SHADE_HAS_SBRDF && item->sbrdf) {
        memcpy(rgba, xy, (size_t)count * sizeof *rgba);
        return;
    }
    if (SHADE_HAS_TABLES && item->one_code) {
        k->table_code(item->table, xy, z, count, rgba);
        return;
    }
    k->normalise(xy, z, count);
    shade_rgb_fill(radiance, count, item->ambient);
    if (SHADE_HAS_NEAR && item->near_light) {
        shade_near(item, xy, z, from->depth + at, x, y, count, radiance);
        k->encode(radiance, count, (nacre_output)item->output, rgba);
        return;
    }
    for (i = 0; i < item->lights; i++) {
        if (SHADE_HAS_TABLES && item->table)
            k->table_add(&item->table[i], xy, z, count, radiance);
        else if (SHADE_HAS_SPHERES)
            shade_spheres_add(&item->spheres[i], xy, z, count, radiance);
    }
    k->encode(radiance, count, (nacre_output)item->output, rgba);
}

static void shade_run(const nacre_soft *soft, const soft_item *item, const soft_pixels *from, uint32_t at, int32_t x,
                      int32_t y, int32_t count, uint8_t *to)
{
    const unsigned bytes = soft_pixel_bytes(soft->desc.format);
    uint32_t rgba[BATCH];

    if (item->lit) {
        soft->desc.kernels->lit(item->lit, from->xy + at, from->z + at, count, bytes, to);
        return;
    }
    if (SHADE_HAS_TABLES && item->codes_565) {
        soft->desc.kernels->table_565(item->table, from->xy + at, from->z + at, count, (uint16_t *)(void *)to);
        if (soft->desc.format == NACRE_SOFT_RGB565_SWAPPED) soft_swap((uint16_t *)(void *)to, count);
        return;
    }
    while ((SHADE_HAS_TABLES || SHADE_HAS_SPHERES || SHADE_HAS_SBRDF) && count > 0) {
        const int32_t now = count < BATCH ? count : BATCH;

        shade_batch(soft, item, from, at, x, y, now, rgba);
        soft_store(&soft->desc, x, y, rgba, now, to);
        at += (uint32_t)now;
        x += now;
        to += (uint32_t)now * bytes;
        count -= now;
    }
}

static void clear_run(const nacre_soft *soft, int32_t x, int32_t y, int32_t count, uint8_t *to)
{
    const size_t all = (size_t)count * soft_pixel_bytes(soft->desc.format);
    const uint32_t rgba[4] = {soft->clear, soft->clear, soft->clear, soft->clear};
    size_t done, more;

    /* four pixels, where dither begins again; then what is there, twice as much each time */
    soft_store(&soft->desc, x, y, rgba, count < 4 ? count : 4, to);
    for (done = 4 * soft_pixel_bytes(soft->desc.format); done < all; done += more) {
        more = done < all - done ? done : all - done;
        memcpy(to + done, to, more);
    }
}

static uint32_t mixed(uint32_t under, uint32_t over, uint32_t alpha)
{
    uint32_t out = 0;
    int shift;

    for (shift = 0; shift < 24; shift += 8) {
        const uint32_t sum = (under >> shift & 255) * (255 - alpha) + (over >> shift & 255) * alpha;

        out |= ((sum * 257 + 32896) >> 16) << shift;
    }
    /* what is under it may be transparent itself */
    return out | (((under >> 24) * (255 - alpha) + 255 * alpha) * 257 + 32896) >> 16 << 24;
}

void soft_blend_row(const nacre_soft *soft, const soft_item *item, const soft_pixels *from, int32_t row, void *to)
{
    const unsigned bytes = soft_pixel_bytes(soft->desc.format);
    const uint32_t line = (uint32_t)((row - from->row0) * from->stride);
    int32_t x;

    for (x = from->x0; x < from->x1; x++) {
        const uint32_t at = line + (uint32_t)x;
        uint8_t *const pixel = (uint8_t *)to + (uint32_t)x * bytes;
        uint32_t under, over[1];

        if (from->xy[at] == SOFT_EMPTY) continue;
        soft_load(&soft->desc, pixel, 1, &under);
        if (item->lit) {
            soft->desc.kernels->lit(item->lit, from->xy + at, from->z + at, 1, bytes, pixel);
            soft_load(&soft->desc, pixel, 1, over);
        } else {
            shade_batch(soft, item, from, at, x, row, 1, over);
        }
        over[0] = mixed(under, over[0], from->item[at]);
        soft_store(&soft->desc, x, row, over, 1, pixel);
    }
}

/* How many of the pixels from `at` on are covered by what covers the first, or empty as it is. */
static int32_t run_length(const soft_pixels *from, uint32_t at, int32_t most)
{
    const uint16_t *const depth = from->depth + at;
    const uint8_t *const owner = from->item ? from->item + at : 0;
    int32_t i = 1;

    if (*depth == SOFT_FAR) {
        for (; i + 4 <= most; i += 4)
            if ((depth[i] & depth[i + 1] & depth[i + 2] & depth[i + 3]) != SOFT_FAR) break;
        while (i < most && depth[i] == SOFT_FAR) i++;
        return i;
    }
    for (; i + 4 <= most; i += 4)
        if (depth[i] == SOFT_FAR || depth[i + 1] == SOFT_FAR || depth[i + 2] == SOFT_FAR || depth[i + 3] == SOFT_FAR)
            break;
    while (i < most && depth[i] != SOFT_FAR) i++;
    if (owner) {
        most = i;
        for (i = 1; i < most && owner[i] == owner[0];) i++;
    }
    return i;
}

void soft_shade_row(const nacre_soft *soft, const soft_pixels *from, int32_t row, void *to)
{
    const uint32_t line = (uint32_t)((row - from->row0) * from->stride);
    const unsigned bytes = soft_pixel_bytes(soft->desc.format);
    int32_t x = from->x0;

    while (x < from->x1) {
        const uint32_t at = line + (uint32_t)x;
        const int32_t count = run_length(from, at, from->x1 - x);
        uint8_t *const out = (uint8_t *)to + (uint32_t)x * bytes;

        if (from->depth[at] == SOFT_FAR)
            clear_run(soft, x, row, count, out);
        else
            shade_run(soft, &soft->item[from->item ? from->item[at] : 0], from, at, x, row, count, out);
        x += count;
    }
}
