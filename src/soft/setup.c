/* SPDX-License-Identifier: MIT */
/* One triangle's edges and planes: the only divisions of the rasteriser. */
#include "soft.h"

/* floor(a / b), b > 0. */
static int32_t floor_div(int64_t a, int32_t b)
{
    int32_t q;

    if (a == (int32_t)a) {
        q = (int32_t)a / b;
        return q - (q * b > (int32_t)a);
    }
    q = (int32_t)(a / b);
    return q - ((int64_t)q * b > a);
}

/* First sample row at or below y. */
static int32_t row_of(int32_t y)
{
    return (y + 7) >> 4;
}

int soft_triangle_rows(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c, int cull, int32_t height,
                       int32_t *y0, int32_t *y1)
{
    const int64_t area = (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
    const int32_t top = a->y < b->y ? a->y : b->y, bottom = a->y > b->y ? a->y : b->y;

    /* counter-clockwise fronts have a negative area where y runs downwards */
    if (!area || (cull == NACRE_SOFT_CULL_BACK && area > 0) || (cull == NACRE_SOFT_CULL_FRONT && area < 0)) return 0;
    *y0 = row_of(top < c->y ? top : c->y);
    *y1 = row_of(bottom > c->y ? bottom : c->y);
    if (*y0 < 0) *y0 = 0;
    if (*y1 > height) *y1 = height;
    return *y0 < *y1;
}

/* The pixel x where the edge is crossed in a row is ceil(n / whole) off the column of the top. */
static void set_edge(soft_edge *out, const soft_vertex *top, const soft_vertex *bottom, int32_t row)
{
    const int32_t dx = bottom->x - top->x, dy = bottom->y - top->y, from = top->x - 8, whole = 16 * dy;
    const int64_t n = (int64_t)(16 * row + 8 - top->y) * dx + (int64_t)(from & 15) * dy + whole - 1;
    const int32_t first = floor_div(n, whole), step = floor_div(dx, dy);

    out->x = (from >> 4) + first;
    out->rest = (int32_t)(n - (int64_t)first * whole);
    out->step = step;
    out->rest_step = 16 * (dx - step * dy);
    out->whole = whole;
}

typedef struct slope { /* value x 16 / area = value x inverse 2^-shift */
    int64_t inverse;
    int shift;
    int32_t dxb, dyb, dxc, dyc;
    int32_t x, y; /* from the first corner to the sample where the planes begin, 28.4 */
} slope;

static void set_slope(slope *s, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c, int64_t area)
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
static int gradient(const slope *s, int64_t n, int fraction, int32_t *out)
{
    const int small = n == (int32_t)n, shift = s->shift - fraction - (small ? 0 : 5);
    const int64_t g = (small ? n : n >> 5) * s->inverse;

    if (shift < 0) return 0;
    *out = (int32_t)(g >> shift);
    return g >> shift == *out;
}

/* a, b, c: 17 bits; at: a with `fraction` more bits, rounding included. Steeper than 32 bits hold, a sliver is drawn in its
   first corner's value. */
static void set_plane(soft_plane *out, const slope *s, int32_t a, int32_t b, int32_t c, int fraction, int32_t at)
{
    const int64_t db = b - a, dc = c - a;
    int32_t gx, gy;

    if (!gradient(s, db * s->dyc - dc * s->dyb, fraction, &gx) ||
        !gradient(s, dc * s->dxb - db * s->dxc, fraction, &gy))
        gx = gy = 0;
    out->at = (uint32_t)at + (uint32_t)(((int64_t)gx * s->x + (int64_t)gy * s->y) >> 4);
    out->dx = (uint32_t)gx;
    out->dy = (uint32_t)gy;
}

/* Normals times 1/w are linear on the screen, and point the same way: the largest 1/w between 1/2 and 1. */
static void set_normals(soft_triangle *out, const slope *s, const soft_vertex *const corner[3])
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
        set_plane(&out->plane[1 + i], s, value[0], value[1], value[2], 16, value[0] * 65536 + 32768);
    }
}

int soft_triangle_set(soft_triangle *out, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c,
                      const soft_pixels *to)
{
    const soft_vertex *const corner[3] = {a, b, c};
    const soft_vertex *top = a, *middle = b, *bottom = c, *swap;
    const int64_t area = (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
    int clockwise = area > 0; /* in the order top, middle, bottom: the middle is on the right */
    int32_t y1;
    slope s;

#define SWAP(p, q) (swap = p, p = q, q = swap, clockwise = !clockwise)
    if (top->y > middle->y) SWAP(top, middle);
    if (middle->y > bottom->y) SWAP(middle, bottom);
    if (top->y > middle->y) SWAP(top, middle);
#undef SWAP
    out->y0 = row_of(top->y);
    y1 = row_of(middle->y);
    out->y2 = row_of(bottom->y);
    if (out->y0 < to->y0) out->y0 = to->y0;
    if (out->y2 > to->y1) out->y2 = to->y1;
    if (out->y0 >= out->y2) return 0;
    out->y1 = y1 < out->y0 ? out->y0 : y1 > out->y2 ? out->y2 : y1;
    out->long_left = (uint8_t)clockwise;
    set_edge(&out->edge[0], top, bottom, out->y0);
    if (out->y1 > out->y0) set_edge(&out->edge[1], top, middle, out->y0);
    if (out->y2 > out->y1) set_edge(&out->edge[2], middle, bottom, out->y1);
    set_slope(&s, a, b, c, area);
    out->x0 = a->x >> 4;
    s.x = 16 * out->x0 + 8 - a->x;
    s.y = 16 * out->y0 + 8 - a->y;
    set_plane(&out->plane[0], &s, a->z >> 15, b->z >> 15, c->z >> 15, 15, a->z + 16384);
    set_normals(out, &s, corner);
    return 1;
}
