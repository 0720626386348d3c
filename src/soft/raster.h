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
    for (; row < end; row++) {
        const int32_t x0 = left->x < to->x0 ? to->x0 : left->x, x1 = right->x > to->x1 ? to->x1 : right->x;

        if (x0 < x1) {
            uint32_t value[SOFT_PLANES], at;
            int i;

            for (i = 0; i < SOFT_PLANES; i++) {
                const soft_plane *const p = &t->plane[i];

                value[i] = p->at + p->dx * (uint32_t)(x0 - t->x0) + p->dy * (uint32_t)(row - t->row0);
            }
            at = (uint32_t)((row - to->row0) * to->stride + x0);
            if (to->item) own_span(t, value[0], to, at, x1 - x0, item);
            fill_span(t, value, to, at, x1 - x0);
        }
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
