/* SPDX-License-Identifier: MIT */
/* A triangle's pixels: depth test, and the normals of those in front. */
#include "setup.h"

/* Pixels x .. x + count - 1 of a row, v: at x. */
static inline void fill_span(const soft_triangle *t, soft_values v, const soft_pixels *to, uint32_t at, int32_t count)
{
    uint16_t *depth = to->depth + at, *const end = depth + count;
    uint32_t *xy = to->xy + at;
    int16_t *z = to->z + at;
    const uint32_t dd = t->plane[0].dx, dx = t->plane[1].dx, dy = t->plane[2].dx, dz = t->plane[3].dx;

    do {
        if (v.depth >> 15 < *depth) {
            *depth = (uint16_t)(v.depth >> 15);
            *xy = v.x >> 16 | (v.y & 0xFFFF0000u);
            *z = (int16_t)(v.z >> 16);
        }
        depth++;
        xy++;
        z++;
        v.depth += dd;
        v.x += dx;
        v.y += dy;
        v.z += dz;
    } while (depth != end);
}

#include "raster.h"

/* ---- small triangles: no spans, so fewer branches; eight columns and four rows at a time. Left out of code for size ---- */

#ifndef __OPTIMIZE_SIZE__

enum { COLUMNS = 8, ROWS = 4 };

/* Samples inside all sides, row after row from the highest bit. Sides: at the first one. */
static inline uint32_t inside(const soft_side side[3], int32_t columns, int32_t rows)
{
    uint32_t mask = 0;
    int32_t row, i;

    for (row = 0; row < rows; row++) {
        int32_t a = side[0].at + row * side[0].down, b = side[1].at + row * side[1].down,
                c = side[2].at + row * side[2].down;
        uint32_t bits = 0;

        for (i = 0; i < columns; i++) {
            bits = bits << 1 | (uint32_t) ~(a | b | c) >> 31;
            a += side[0].right;
            b += side[1].right;
            c += side[2].right;
        }
        mask |= bits << (32 - columns) >> COLUMNS * row;
    }
    return mask;
}

/* right, below: of the first sample from where the planes begin. */
static inline void fill_mask(uint32_t mask, const soft_plane p[SOFT_PLANES], int32_t right, int32_t below,
                             const soft_pixels *to, uint32_t at, unsigned item)
{
    while (mask) {
        const int n = fx_leading_zeros(mask), column = n % COLUMNS, row = n / COLUMNS;
        const uint32_t x = (uint32_t)(right + column), y = (uint32_t)(below + row);
        const uint32_t here = at + (uint32_t)(row * to->stride + column),
                       depth = (p[0].at + p[0].dx * x + p[0].dy * y) >> 15;

        mask &= ~(0x80000000u >> n);
        if (depth >= to->depth[here]) continue;
        to->depth[here] = (uint16_t)depth;
        to->xy[here] =
            (p[1].at + p[1].dx * x + p[1].dy * y) >> 16 | ((p[2].at + p[2].dx * x + p[2].dy * y) & 0xFFFF0000u);
        to->z[here] = (int16_t)((p[3].at + p[3].dx * x + p[3].dy * y) >> 16);
        if (to->item) to->item[here] = (uint8_t)item;
    }
}

static void draw_small(const soft_vertex *const corner[3], int64_t area, const soft_box *box, const soft_pixels *to,
                       unsigned item)
{
    const soft_vertex *const a = corner[0], *const b = corner[area > 0 ? 1 : 2], *const c = corner[area > 0 ? 2 : 1];
    soft_plane plane[SOFT_PLANES];
    int32_t y;
    int set = 0;

    for (y = box->y0; y < box->y1; y += ROWS) {
        const soft_side side[3] = {soft_side_of(a, b, box->x0, y), soft_side_of(b, c, box->x0, y),
                                   soft_side_of(c, a, box->x0, y)};
        const uint32_t mask = inside(side, box->x1 - box->x0, soft_least(box->y1 - y, ROWS));

        if (!mask) continue; /* most slivers hit no sample at all */
        if (!set) soft_set_planes(plane, corner, area);
        set = 1;
        fill_mask(mask, plane, box->x0 - (a->x >> 4), y - (a->y >> 4), to,
                  (uint32_t)((y - to->row0) * to->stride + box->x0), item);
    }
}

/* 0: it is not small. */
static int drawn_small(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    const int64_t area = soft_area(corner[0], corner[1], corner[2]);
    soft_box box;

    if (soft_culled(area, cull) || !soft_box_of(&box, corner, to)) return 1;
    if (box.x1 - box.x0 > COLUMNS || box.y1 - box.y0 > 2 * ROWS || box.size >= SOFT_SMALL) return 0;
    draw_small(corner, area, &box, to, item);
    return 1;
}

#endif

void soft_draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
#ifndef __OPTIMIZE_SIZE__
    if (drawn_small(corner, cull, to, item)) return;
#endif
    draw(corner, cull, to, item);
}
