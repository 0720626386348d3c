/* SPDX-License-Identifier: MIT */
/* One triangle's edges and planes: the only divisions of the rasteriser. */
#include "setup.h"

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

int soft_triangle_rows(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c, int cull, int32_t height,
                       int32_t *y0, int32_t *y1)
{
    const int64_t area = soft_area(a, b, c);
    const int32_t top = a->y < b->y ? a->y : b->y, bottom = a->y > b->y ? a->y : b->y;

    if (soft_culled(area, cull)) return 0;
    *y0 = soft_line_of(top < c->y ? top : c->y);
    *y1 = soft_line_of(bottom > c->y ? bottom : c->y);
    if (*y0 < 0) *y0 = 0;
    if (*y1 > height) *y1 = height;
    return *y0 < *y1;
}

/* The pixel x where the edge is crossed in a row is ceil(n / whole) off the column of the top. From `row` up to `end`. */
static void set_edge(soft_edge *out, const soft_vertex *top, const soft_vertex *bottom, int32_t row, int32_t end)
{
    const int32_t dx = bottom->x - top->x, dy = bottom->y - top->y, from = top->x - 8, whole = 16 * dy;
    const int64_t n = (int64_t)(16 * row + 8 - top->y) * dx + (int64_t)(from & 15) * dy + whole - 1;
    const int32_t first = floor_div(n, whole), step = end - row > 1 ? floor_div(dx, dy) : 0;

    out->x = (from >> 4) + first;
    out->rest = (int32_t)(n - (int64_t)first * whole);
    out->step = step;
    out->rest_step = 16 * (dx - step * dy);
    out->whole = whole;
}

int soft_triangle_set(soft_triangle *out, const soft_vertex *const corner[3], int cull, const soft_pixels *to)
{
    const soft_vertex *const a = corner[0], *const b = corner[1], *const c = corner[2];
    const soft_vertex *top = a, *middle = b, *bottom = c, *swap;
    const int64_t area = soft_area(a, b, c);
    int clockwise = area > 0; /* in the order top, middle, bottom: the middle is on the right */
    int32_t y1;

    if (soft_culled(area, cull)) return 0;
#define SWAP(p, q) (swap = p, p = q, q = swap, clockwise = !clockwise)
    if (top->y > middle->y) SWAP(top, middle);
    if (middle->y > bottom->y) SWAP(middle, bottom);
    if (top->y > middle->y) SWAP(top, middle);
#undef SWAP
    out->y0 = soft_line_of(top->y);
    y1 = soft_line_of(middle->y);
    out->y2 = soft_line_of(bottom->y);
    if (out->y0 < to->y0) out->y0 = to->y0;
    if (out->y2 > to->y1) out->y2 = to->y1;
    if (out->y0 >= out->y2) return 0;
    out->y1 = y1 < out->y0 ? out->y0 : y1 > out->y2 ? out->y2 : y1;
    out->long_left = (uint8_t)clockwise;
    set_edge(&out->edge[0], top, bottom, out->y0, out->y2);
    if (out->y1 > out->y0) set_edge(&out->edge[1], top, middle, out->y0, out->y1);
    if (out->y2 > out->y1) set_edge(&out->edge[2], middle, bottom, out->y1, out->y2);
    out->x0 = a->x >> 4;
    out->row0 = a->y >> 4;
    soft_set_planes(out->plane, corner, area);
    return 1;
}
