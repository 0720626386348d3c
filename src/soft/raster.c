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

/* Before fill_span: the same test. */
static inline void own_span(const soft_triangle *t, uint32_t d, const soft_pixels *to, uint32_t at, int32_t count,
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

void soft_draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    soft_triangle t;
    soft_edge *const whole = &t.edge[0], *const upper = &t.edge[1], *const lower = &t.edge[2];

    if (!soft_triangle_set(&t, corner, cull, to)) return;
    if (t.long_left) {
        fill_part(&t, whole, upper, t.y0, t.y1, to, item);
        fill_part(&t, whole, lower, t.y1, t.y2, to, item);
    } else {
        fill_part(&t, upper, whole, t.y0, t.y1, to, item);
        fill_part(&t, lower, whole, t.y1, t.y2, to, item);
    }
}
