/* SPDX-License-Identifier: MIT */
/* What every set of kernels does for a triangle: culling, and the planes of depth and normal. */
#ifndef SOFT_SETUP_H
#define SOFT_SETUP_H

#include "soft.h"

static inline int64_t soft_area(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    return (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
}

/* Counter-clockwise fronts have a negative area where y runs downwards. */
static inline int soft_culled(int64_t area, int cull)
{
    return cull == NACRE_SOFT_CULL_BACK ? area >= 0 : cull == NACRE_SOFT_CULL_FRONT ? area <= 0 : !area;
}

/* The planes' values at a pixel: no array, because compilers that make vectors of it wait for its parts. */
typedef struct soft_values {
    uint32_t depth, x, y, z;
} soft_values;

typedef struct soft_slope { /* value x 16 / area = value x inverse 2^-shift */
    int64_t inverse;
    int shift;
    int32_t dxb, dyb, dxc, dyc;
    int32_t x, y; /* from the first corner to the sample where the planes begin, 28.4 */
} soft_slope;

static inline void soft_set_slope(soft_slope *s, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c,
                                  int64_t area)
{
    const uint64_t size = area < 0 ? 0 - (uint64_t)area : (uint64_t)area;
    const int up = 31 - fx_top_bit(size);

    s->inverse = fx_reciprocal(up >= 0 ? (uint32_t)size << up : (uint32_t)(size >> -up));
    s->shift = 58 - up;
    if (area < 0) s->inverse = -s->inverse;
    s->dxb = b->x - a->x;
    s->dyb = b->y - a->y;
    s->dxc = c->x - a->x;
    s->dyc = c->y - a->y;
}

/* n: below 2^36; the step a pixel with `fraction` more bits. 0: more than 32 bits hold. */
static inline int soft_gradient(const soft_slope *s, int64_t n, int fraction, int32_t *out)
{
    const int small = n == (int32_t)n, shift = s->shift - fraction - (small ? 0 : 5);
    const int64_t g = (small ? n : n >> 5) * s->inverse;

    if (shift < 0) return 0;
    *out = (int32_t)(g >> shift);
    return g >> shift == *out;
}

/* a, b, c: 17 bits; at: a with `fraction` more bits, rounding included. Steeper than 32 bits hold, a sliver is drawn in its
   first corner's value. */
static inline void soft_set_plane(soft_plane *out, const soft_slope *s, int32_t a, int32_t b, int32_t c, int fraction,
                                  int32_t at)
{
    const int64_t db = b - a, dc = c - a;
    int32_t gx, gy;

    if (!soft_gradient(s, db * s->dyc - dc * s->dyb, fraction, &gx) ||
        !soft_gradient(s, dc * s->dxb - db * s->dxc, fraction, &gy))
        gx = gy = 0;
    out->at = (uint32_t)at + (uint32_t)(((int64_t)gx * s->x + (int64_t)gy * s->y) >> 4);
    out->dx = (uint32_t)gx;
    out->dy = (uint32_t)gy;
}

/* Normals times 1/w are linear on the screen, and point the same way: the largest 1/w between 1/2 and 1. */
static inline void soft_set_normals(soft_plane plane[SOFT_PLANES], const soft_slope *s,
                                    const soft_vertex *const corner[3])
{
    const uint32_t all = (uint32_t)corner[0]->nearness & corner[1]->nearness & corner[2]->nearness;
    const uint32_t most = (uint32_t)corner[0]->nearness | corner[1]->nearness | corner[2]->nearness;
    const int up = fx_leading_zeros(most) - 16;
    int i, k;

    for (i = 0; i < 3; i++) {
        int32_t value[3];

        for (k = 0; k < 3; k++) {
            value[k] = corner[k]->normal[i];
            if (all != 65535) value[k] = value[k] * (int32_t)((uint32_t)corner[k]->nearness << up) >> 16;
        }
        soft_set_plane(&plane[1 + i], s, value[0], value[1], value[2], 16, value[0] * 65536 + 32768);
    }
}

/* First sample row at or below y, or column at or right of x. */
static inline int32_t soft_line_of(int32_t y)
{
    return (y + 7) >> 4;
}

static inline void soft_step_edge(soft_edge *e)
{
    e->x += e->step;
    e->rest += e->rest_step;
    if (e->rest >= e->whole) {
        e->rest -= e->whole;
        e->x++;
    }
}

#define SOFT_SMALL 2048 /* triangles below it in width and height: products of their edges have 24 bits */

typedef struct soft_box {
    int32_t x0, x1, y0, y1; /* columns and rows with samples */
    int32_t size;           /* of the corners' larger extent, 28.4 */
} soft_box;

static inline int32_t soft_least(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline int32_t soft_most(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* What of `to` a triangle may touch. 0: nothing. */
static inline int soft_box_of(soft_box *out, const soft_vertex *const corner[3], const soft_pixels *to)
{
    const soft_vertex *const a = corner[0], *const b = corner[1], *const c = corner[2];
    const int32_t left = soft_least(soft_least(a->x, b->x), c->x), right = soft_most(soft_most(a->x, b->x), c->x);
    const int32_t top = soft_least(soft_least(a->y, b->y), c->y), bottom = soft_most(soft_most(a->y, b->y), c->y);

    out->x0 = soft_most(soft_line_of(left), to->x0);
    out->x1 = soft_least(soft_line_of(right), to->x1);
    out->y0 = soft_most(soft_line_of(top), to->y0);
    out->y1 = soft_least(soft_line_of(bottom), to->y1);
    out->size = soft_most(right - left, bottom - top);
    return out->x0 < out->x1 && out->y0 < out->y1;
}

typedef struct soft_side { /* 0 and up at samples inside an edge, or on it if that is a left or top one */
    int32_t at, right, down;
} soft_side;

/* From p to q, the inside on the right, of a triangle below SOFT_SMALL: at the sample of column x and row y. */
static inline soft_side soft_side_of(const soft_vertex *p, const soft_vertex *q, int32_t x, int32_t y)
{
    const int32_t dx = q->x - p->x, dy = q->y - p->y;
    soft_side s;

    s.at = dx * (16 * y + 8 - p->y) - dy * (16 * x + 8 - p->x) - !(dy < 0 || (!dy && dx > 0));
    s.right = -16 * dy;
    s.down = 16 * dx;
    return s;
}

/* Planes begin at the first corner's pixel, whatever part is drawn: no band changes a bit. */
static inline void soft_set_planes(soft_plane plane[SOFT_PLANES], const soft_vertex *const corner[3], int64_t area)
{
    const soft_vertex *const a = corner[0], *const b = corner[1], *const c = corner[2];
    soft_slope s;

    soft_set_slope(&s, a, b, c, area);
    s.x = 8 - (a->x & 15);
    s.y = 8 - (a->y & 15);
    soft_set_plane(&plane[0], &s, a->z >> 15, b->z >> 15, c->z >> 15, 15, a->z + 16384);
    soft_set_normals(plane, &s, corner);
}

#endif
