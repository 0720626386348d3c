/* SPDX-License-Identifier: MIT */
/* A triangle's pixels: depth test, and the normals of those in front. */
#include "setup.h"

/* Pixels x .. x + count - 1 of a row, the planes' values at x. */
static inline void fill_span(const soft_triangle *t, const uint32_t value[SOFT_PLANES], const soft_pixels *to,
                             uint32_t at, int32_t count)
{
    uint16_t *depth = to->depth + at, *const end = depth + count;
    uint32_t *xy = to->xy + at;
    int16_t *z = to->z + at;
    uint32_t d = value[0], nx = value[1], ny = value[2], nz = value[3];
    const uint32_t dd = t->plane[0].dx, dx = t->plane[1].dx, dy = t->plane[2].dx, dz = t->plane[3].dx;

    do {
        if (d >> 15 < *depth) {
            *depth = (uint16_t)(d >> 15);
            *xy = nx >> 16 | (ny & 0xFFFF0000u);
            *z = (int16_t)(nz >> 16);
        }
        depth++;
        xy++;
        z++;
        d += dd;
        nx += dx;
        ny += dy;
        nz += dz;
    } while (depth != end);
}

#include "raster.h"

void soft_draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    draw(corner, cull, to, item);
}
