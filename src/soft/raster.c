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

void soft_draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    draw(corner, cull, to, item);
}
