/* SPDX-License-Identifier: MIT */
/* A triangle span by span, for files that have a fill_span. */
#ifndef SOFT_RASTER_H
#define SOFT_RASTER_H

#include "setup.h"

/* Before fill_span: the same test. */
static void own_span(const soft_triangle *t, uint32_t d, const soft_pixels *to, uint32_t at, int32_t count,
                     unsigned item)
{
    int32_t i;

    for (i = 0; i < count; i++, d += t->plane[0].dx)
        if (d >> 15 < to->depth[at + (uint32_t)i]) to->item[at + (uint32_t)i] = (uint8_t)item;
}

static void fill_part(const soft_triangle *t, soft_edge *left, soft_edge *right, int32_t row, int32_t end,
                      const soft_pixels *to, unsigned item)
{
    const soft_plane *const p = t->plane;
    const uint32_t below = (uint32_t)(row - t->row0);
    uint32_t at = (uint32_t)((row - to->row0) * to->stride);
    soft_values line; /* at x0 */

    line.depth = p[0].at + p[0].dy * below;
    line.x = p[1].at + p[1].dy * below;
    line.y = p[2].at + p[2].dy * below;
    line.z = p[3].at + p[3].dy * below;
    for (; row < end; row++) {
        const int32_t x0 = left->x < to->x0 ? to->x0 : left->x, x1 = right->x > to->x1 ? to->x1 : right->x;

        if (x0 < x1) {
            const uint32_t over = (uint32_t)(x0 - t->x0);
            soft_values v;

            v.depth = line.depth + p[0].dx * over;
            v.x = line.x + p[1].dx * over;
            v.y = line.y + p[2].dx * over;
            v.z = line.z + p[3].dx * over;
            if (to->item) own_span(t, v.depth, to, at + (uint32_t)x0, x1 - x0, item);
            fill_span(t, v, to, at + (uint32_t)x0, x1 - x0);
        }
        line.depth += p[0].dy;
        line.x += p[1].dy;
        line.y += p[2].dy;
        line.z += p[3].dy;
        at += (uint32_t)to->stride;
        soft_step_edge(left);
        soft_step_edge(right);
    }
}

static inline void draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    soft_triangle t;
    soft_edge *const whole = &t.edge[0];

    if (!soft_triangle_set(&t, corner, cull, to)) return;
    fill_part(&t, t.long_left ? whole : &t.edge[1], t.long_left ? &t.edge[1] : whole, t.y0, t.y1, to, item);
    fill_part(&t, t.long_left ? whole : &t.edge[2], t.long_left ? &t.edge[2] : whole, t.y1, t.y2, to, item);
}

#endif
