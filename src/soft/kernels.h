/* SPDX-License-Identifier: MIT */
/*
 * The inner loops for SIMD units, LANES pixels at a time: line by line what eval_inner.h, raster.c and span.c define, with
 * the same bits. One text for all instruction sets; kernels_NAME.c includes it after lanes_NAME.h.
 *
 * Numbers of 16 bits stand in the lower halves of 32-bit lanes; product() multiplies them when the upper half of one factor
 * is 0. The highest bit of a number below 2^24 is found by converting it to float, which is exact there.
 */
#ifndef SOFT_KERNELS_H
#define SOFT_KERNELS_H

#include "eval_inner.h"
#include "setup.h"
#include "soft.h"

/* Exponent and mantissa of x < 2^25 as a float has them. */
static inline lanes split(lanes x)
{
    return float_bits(without(x, DOWN(x, 24))); /* of 25 bits the last is cut, not rounded */
}

/* What is behind the node, of 8 and of 16 nodes to an octave. */
static inline lanes fraction_of_8(lanes split)
{
    return both(DOWN(split, 5), all(32767));
}

static inline lanes fraction_of_16(lanes split)
{
    return both(DOWN(split, 4), all(32767));
}

static inline lanes between(lanes word, lanes f)
{
    return plus(word, product(word, f));
}

/* ---- normals ------------------------------------------------------------------------------------------------------------- */

/* In place. 0, and nothing done: one is shorter than half; shade_normalise takes another way there. */
static inline int unit(lanes *xy, lanes *z)
{
    const lanes square = plus(product(*xy, *xy), times(*z, *z)), round = all(1 << 13);
    const lanes node = least(DOWN(square, 22), all(64));
    lanes inverse, x, y;

    if (any(above(all(1 << 26), square))) return 0;
    inverse = between(look_up(shade_lut_length, node), both(DOWN(square, 7), all(32767)));
    inverse = DOWN(inverse, 16);
    x = DOWN_SIGNED(plus(product(*xy, inverse), round), 14);
    y = DOWN_SIGNED(plus(product(*xy, UP(inverse, 16)), round), 14);
    *z = DOWN_SIGNED(plus(product(*z, inverse), round), 14);
    *xy = halves(x, UP(y, 16));
    return 1;
}

static void normalise(uint32_t *xy, int16_t *z, int count)
{
    int i;

    for (i = 0; i + LANES <= count; i += LANES) {
        lanes n = load(xy + i), nz = load_16(z + i);

        if (unit(&n, &nz)) {
            store(xy + i, n);
            store_16(z + i, nz);
        } else {
            shade_normalise(xy + i, z + i, LANES);
        }
    }
    shade_normalise(xy + i, z + i, count - i);
}

/* ---- tables -------------------------------------------------------------------------------------------------------------- */

typedef struct constants {
    lanes light_xy, light_z, half_xy, half_z, offset, middle, scale, at_middle, last, limit, phi[3], gain;
    sixteen log2;
} constants;

static inline lanes low_half(int32_t x)
{
    return all(x & 65535);
}

static inline constants constants_of(const shade_table_eval *e, int32_t gain)
{
    constants c;
    int i;

    c.light_xy = all((int32_t)e->to_light_xy);
    c.light_z = low_half(e->to_light_z);
    c.half_xy = all((int32_t)e->half_xy);
    c.half_z = low_half(e->half_z);
    c.offset = all(e->offset);
    c.middle = all(e->log_middle + 127 * 4096);
    c.scale = low_half(e->scale);
    c.at_middle = all(e->at_middle);
    c.last = all(e->last);
    c.limit = all(e->limit);
    for (i = 0; i < 3; i++) c.phi[i] = low_half(e->phi[i]);
    c.log2 = sixteen_of(shade_lut_log2);
    c.gain = all(gain);
    return c;
}

static inline lanes dot(lanes xy, lanes z, lanes to_xy, lanes to_z)
{
    return plus(product(xy, to_xy), product(z, to_z));
}

/* log2 x - log_middle, q12 */
static inline lanes log2_from_middle(lanes x, const constants *c)
{
    const lanes s = split(x), word = sixteen_at(&c->log2, DOWN(s, 19));
    const lanes exponent = UP(DOWN(s, 23), 12);

    return minus(plus(exponent, DOWN(between(word, fraction_of_16(s)), 19)), c->middle);
}

static inline lanes clip_root(lanes root_q29)
{
    return least(most(DOWN_SIGNED(root_q29, 15), all(0)), all(32767));
}

EVAL_INLINE void roots(const shade_table_eval *e, const constants *c, lanes xy, lanes z, lanes nl, int fine,
                       lanes root[3])
{
    const lanes square = plus(product(xy, xy), times(z, z));
    const lanes distance = plus(plus(square, dot(xy, z, c->half_xy, c->half_z)), c->offset);
    const lanes from_middle = log2_from_middle(DOWN(distance, 7), c);
    const lanes u = least(plus(DOWN_SIGNED(product(from_middle, c->scale), 8), c->at_middle), c->last);
    const lanes f = both(u, all(32767)), column = DOWN(u, 15);
    const lanes a = size_of(minus(DOWN_SIGNED(nl, 14), z));
    const lanes size = least(a, c->limit), bent = DOWN(product(size, size), 13);
    lanes w[4], shared;
    int i;

    look_up_4(e->columns, fine ? UP(column, 3) : UP(column, 2), w);
    shared = DOWN_SIGNED(between(w[3], f), 15);
    if (fine) {
        const lanes fourth = DOWN(times(bent, bent), 15);
        lanes linear = DOWN_SIGNED(product(shared, UP(size, 1)), 15), t[4];

        look_up_4(e->columns + 4, UP(column, 3), t);
        linear = plus(linear, DOWN_SIGNED(times(DOWN_SIGNED(between(t[3], f), 15), fourth), 15));
        for (i = 0; i < 3; i++)
            root[i] = clip_root(plus(plus(between(w[i], f), product(DOWN_SIGNED(between(t[i], f), 15), bent)),
                                     product(linear, c->phi[i])));
    } else {
        const lanes bend = DOWN_SIGNED(product(shared, bent), 13);

        for (i = 0; i < 3; i++) root[i] = clip_root(plus(between(w[i], f), product(bend, c->phi[i])));
    }
}

static inline lanes root48(lanes x)
{
    const lanes s = split(most(x, all(512)));
    const lanes node = minus(DOWN(s, 20), all(127 * 8 + 72));

    return DOWN(between(look_up(shade_lut_root48, node), fraction_of_8(s)), 16);
}

/* On both halves of the lanes. */
static inline lanes pow24(lanes v)
{
    lanes c = plus_halves(times_q15(all_halves(6031), v), all_halves(-16375));

    c = plus_halves(times_q15(c, v), all_halves(21971));
    c = plus_halves(times_q15(c, v), all_halves(4784));
    c = times_q15(times_q15(v, v), c);
    return twice_halves(c);
}

static inline lanes scaled(lanes root, lanes gain, int shift)
{
    return least(down_by(product(root, gain), shift), all(32767));
}

static inline void accumulate(uint32_t *to, lanes half_root, lanes lit)
{
    const lanes sum = DOWN(product(half_root, half_root), 12);

    store(to, plus(load(to), both(sum, lit)));
}

static inline void add(const shade_table_eval *e, const constants *c, const uint32_t *xy, const int16_t *z,
                       shade_rgb radiance, int i, int fine, int power4)
{
    const lanes n = load(xy + i), nz = load_16(z + i), nl = dot(n, nz, c->light_xy, c->light_z);
    const lanes lit = above(nl, all(0));
    lanes root[3], cosine, red_green;
    int k;

    if (!any(lit)) return;
    cosine = root48(DOWN_SIGNED(nl, 5));
    if (power4) cosine = both(pow24(cosine), all(65535));
    cosine = times_q15(cosine, c->gain);
    roots(e, c, n, nz, nl, fine, root);
    if (power4) {
        for (k = 0; k < 3; k++)
            root[k] = scaled(least(DOWN(product(root[k], root[k]), 14), all(32767)), cosine, e->shift);
    } else {
        for (k = 0; k < 3; k++) root[k] = scaled(root[k], cosine, e->shift);
        red_green = pow24(either(root[0], UP(root[1], 16)));
        root[0] = both(red_green, all(65535));
        root[1] = DOWN(red_green, 16);
        root[2] = both(pow24(root[2]), all(65535));
    }
    accumulate(radiance.r + i, root[0], lit);
    accumulate(radiance.g + i, root[1], lit);
    accumulate(radiance.b + i, root[2], lit);
}

static void table_add(const shade_table_eval *e, const uint32_t *xy, const int16_t *z, int count, shade_rgb radiance)
{
    const constants c = constants_of(e, e->gain);
    shade_rgb rest;
    int i = 0;

    if (e->dark) return;
    if (e->fine)
        for (; i + LANES <= count; i += LANES) add(e, &c, xy, z, radiance, i, 1, e->power4);
    else if (e->power4)
        for (; i + LANES <= count; i += LANES) add(e, &c, xy, z, radiance, i, 0, 1);
    else
        for (; i + LANES <= count; i += LANES) add(e, &c, xy, z, radiance, i, 0, 0);
    rest.r = radiance.r + i;
    rest.g = radiance.g + i;
    rest.b = radiance.b + i;
    shade_table_add(e, xy + i, z + i, count - i, rest);
}

static inline lanes code_of(lanes root, lanes gain, int shift, int toe)
{
    const lanes z = least(down_by(product(root, gain), shift), all(SHADE_CODE_MOST)), square = product(z, z);
    lanes code = minus(square, all(SHADE_CODE_LOW - (1 << 20)));

    if (toe) {
        const lanes below = times_q15(DOWN(most(minus(all(SHADE_CODE_TOE), square), all(0)), 14), all(SHADE_TOE_PART));

        code = plus(code, UP(product(below, below), 2));
    }
    return most(DOWN_SIGNED(code, 21), all(0));
}

EVAL_INLINE void code(const shade_table_eval *e, const constants *c, const uint32_t *xy, const int16_t *z,
                      uint32_t *rgba, int fine)
{
    const lanes opaque = all((int32_t)(255u << 24));
    lanes n = load(xy), nz = load_16(z), nl, lit, root[3], cosine, out;

    if (!unit(&n, &nz)) {
        shade_table_code(e, xy, z, LANES, rgba);
        return;
    }
    nl = dot(n, nz, c->light_xy, c->light_z);
    lit = above(nl, all(0));
    if (!any(lit)) {
        store(rgba, opaque);
        return;
    }
    cosine = times_q15(root48(DOWN_SIGNED(nl, 5)), c->gain);
    roots(e, c, n, nz, nl, fine, root);
    out = code_of(root[0], cosine, e->shift_code, e->toe);
    out = either(out, UP(code_of(root[1], cosine, e->shift_code, e->toe), 8));
    out = either(out, UP(code_of(root[2], cosine, e->shift_code, e->toe), 16));
    store(rgba, either(both(out, lit), opaque));
}

static void table_code(const shade_table_eval *e, const uint32_t *xy, const int16_t *z, int count, uint32_t *rgba)
{
    const constants c = constants_of(e, e->gain_code);
    int i = 0;

    if (!e->dark && e->fine)
        for (; i + LANES <= count; i += LANES) code(e, &c, xy + i, z + i, rgba + i, 1);
    else if (!e->dark)
        for (; i + LANES <= count; i += LANES) code(e, &c, xy + i, z + i, rgba + i, 0);
    shade_table_code(e, xy + i, z + i, count - i, rgba + i);
}

/* ---- codes ------------------------------------------------------------------------------------------------------------------ */

static inline lanes srgb_code(const uint32_t *radiance)
{
    const lanes s = split(least_unsigned(most_unsigned(load(radiance), all(8)), all(65536)));
    const lanes node = minus(DOWN(s, 20), all(127 * 8 + 24));
    const lanes value = DOWN(between(look_up(shade_lut_srgb, node), fraction_of_8(s)), 16);

    return DOWN(plus(value, all(64)), 7);
}

static void encode(shade_rgb radiance, int count, nacre_output output, uint32_t *rgba)
{
    shade_rgb rest;
    int i = 0;

    for (; i + LANES <= count && output == NACRE_OUTPUT_SRGB; i += LANES) {
        const lanes r = srgb_code(radiance.r + i), g = UP(srgb_code(radiance.g + i), 8);
        const lanes b = UP(srgb_code(radiance.b + i), 16);

        store(rgba + i, either(either(r, g), either(b, all((int32_t)(255u << 24)))));
    }
    rest.r = radiance.r + i;
    rest.g = radiance.g + i;
    rest.b = radiance.b + i;
    shade_encode(rest, count - i, output, rgba + i);
}

/* ---- triangles -------------------------------------------------------------------------------------------------------------- */

typedef struct walk {                           /* planes: depth, normal x, y, z */
    lanes line[SOFT_PLANES], down[SOFT_PLANES]; /* a row's values, the way to the next row */
    lanes step[SOFT_PLANES];                    /* the way to the next column */
} walk;

/* at, dx, dy: of nx, ny, nz and depth, in the first four lanes. */
static inline void set_walk(walk *w, lanes at, lanes dx, lanes dy)
{
#define SET_PLANE(plane, lane)                                                                                         \
    (w->step[plane] = SPREAD(dx, lane), w->down[plane] = SPREAD(dy, lane),                                             \
     w->line[plane] = plus(SPREAD(at, lane), times(w->step[plane], ramp())))

    SET_PLANE(0, 3);
    SET_PLANE(1, 0);
    SET_PLANE(2, 1);
    SET_PLANE(3, 2);
#undef SET_PLANE
}

static inline void fill_lanes(const lanes value[SOFT_PLANES], const soft_pixels *to, size_t at, lanes inside,
                              unsigned item)
{
    const lanes old = load_u16(to->depth + at), depth = DOWN(value[0], 15), front = both(above(old, depth), inside);

    if (!any(front)) return;
    store(to->xy + at, choose(front, halves(DOWN(value[1], 16), value[2]), load(to->xy + at)));
    store_16(to->depth + at, choose(front, depth, old));
    store_16(to->z + at, choose(front, DOWN(value[3], 16), load_16(to->z + at)));
    if (to->item) store_bytes_where(front, to->item + at, (uint8_t)item);
}

/* count pixels of the row, from `right` columns on. */
static inline void fill_span(const walk *w, int32_t right, const soft_pixels *to, size_t at, int32_t count,
                             unsigned item)
{
    lanes value[SOFT_PLANES], leap[SOFT_PLANES];
    int i;

    for (i = 0; i < SOFT_PLANES; i++) {
        value[i] = plus(w->line[i], times(w->step[i], all(right)));
        leap[i] = times(w->step[i], all(LANES));
    }
    for (;;) {
        fill_lanes(value, to, at, above(all(count), ramp()), item);
        count -= LANES;
        if (count <= 0) return;
        at += LANES;
        for (i = 0; i < SOFT_PLANES; i++) value[i] = plus(value[i], leap[i]);
    }
}

static inline void fill_part(const soft_triangle *t, walk *w, soft_edge *left, soft_edge *right, int32_t row,
                             int32_t end, const soft_pixels *to, unsigned item)
{
    size_t at = (size_t)((row - to->row0) * to->stride);
    int i;

    for (; row < end; row++) {
        const int32_t x0 = soft_most(left->x, to->x0), x1 = soft_least(right->x, to->x1);

        if (x0 < x1) fill_span(w, x0 - t->x0, to, at + (size_t)x0, x1 - x0, item);
        for (i = 0; i < SOFT_PLANES; i++) w->line[i] = plus(w->line[i], w->down[i]);
        at += (size_t)to->stride;
        soft_step_edge(left);
        soft_step_edge(right);
    }
}

static void set_walk_of(walk *w, const soft_triangle *t)
{
    const soft_plane *const depth = &t->plane[0], *const x = &t->plane[1], *const y = &t->plane[2],
                            *const z = &t->plane[3];
    const uint32_t at[8] = {x->at, y->at, z->at, depth->at}, dx[8] = {x->dx, y->dx, z->dx, depth->dx},
                   dy[8] = {x->dy, y->dy, z->dy, depth->dy};
    const lanes below = load(dy);

    set_walk(w, plus(load(at), times(below, all(t->y0 - t->row0))), load(dx), below);
}

static void fill(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    soft_triangle t;
    soft_edge *const whole = &t.edge[0], *const upper = &t.edge[1], *const lower = &t.edge[2];
    walk w;

    if (!soft_triangle_set(&t, corner, cull, to)) return;
    set_walk_of(&w, &t);
    if (t.long_left) {
        fill_part(&t, &w, whole, upper, t.y0, t.y1, to, item);
        fill_part(&t, &w, whole, lower, t.y1, t.y2, to, item);
    } else {
        fill_part(&t, &w, upper, whole, t.y0, t.y1, to, item);
        fill_part(&t, &w, lower, whole, t.y1, t.y2, to, item);
    }
}

/* ---- small triangles: a few columns, every pixel tested against the three edges ---------------------------------------------- */

static inline lanes side_at(soft_side s, lanes *down)
{
    *down = all(s.down);
    return plus(all(s.at), times(all(s.right), ramp()));
}

/* Which of a row's columns are inside all edges. */
static inline lanes inside_of(const lanes edge[3], lanes columns)
{
    return without(columns, DOWN_SIGNED(either(either(edge[0], edge[1]), edge[2]), 31));
}

/* nx, ny, nz and depth of a corner in the first four lanes: 17 bits. */
static inline lanes corner_of(const soft_vertex *v, int perspective, int up)
{
    lanes n = load_four_16(v->normal);

    if (perspective) n = DOWN_SIGNED(times(n, all((int32_t)((uint32_t)v->nearness << up))), 16);
    return WITH_FOURTH(n, v->z >> 15);
}

/* soft_set_planes for triangles below SOFT_SMALL, whose numerators have 28 bits: at the sample that is so many
   columns and rows from the first corner's. */
static inline void set_small_walk(walk *w, const soft_vertex *const corner[3], int64_t area, int32_t right,
                                  int32_t below)
{
    const soft_vertex *const a = corner[0], *const b = corner[1], *const c = corner[2];
    const int32_t dxb = b->x - a->x, dyb = b->y - a->y, dxc = c->x - a->x, dyc = c->y - a->y;
    const uint32_t size = (uint32_t)(area < 0 ? -area : area);
    const int zeros = fx_leading_zeros(size), shift = 43 - zeros;
    const int32_t reciprocal = (int32_t)fx_reciprocal(size << zeros), inverse = area < 0 ? -reciprocal : reciprocal;
    const int perspective = ((uint32_t)a->nearness & b->nearness & c->nearness) != 65535;
    const int up = fx_leading_zeros((uint32_t)a->nearness | b->nearness | c->nearness) - 16;
    const lanes first = corner_of(a, perspective, up), normals = WITH_FOURTH(all(-1), 0);
    const lanes db = minus(corner_of(b, perspective, up), first), dc = minus(corner_of(c, perspective, up), first);
    const lanes sx = all(8 - (a->x & 15)), sy = all(8 - (a->y & 15));
    lanes nx = minus(times(db, all(dyc)), times(dc, all(dyb)));
    lanes ny = minus(times(dc, all(dxb)), times(db, all(dxc)));
    lanes at, dx, dy, x_above, y_above, fits;

    nx = plus(nx, both(nx, normals)); /* normals have 16 bits more, depth 15 */
    ny = plus(ny, both(ny, normals));
    dx = times_wide(nx, inverse, shift, &x_above);
    dy = times_wide(ny, inverse, shift, &y_above);
    fits = both(same(x_above, DOWN_SIGNED(dx, 31)), same(y_above, DOWN_SIGNED(dy, 31)));
    dx = both(dx, fits);
    dy = both(dy, fits);
    at = WITH_FOURTH(plus(UP(first, 16), all(32768)), a->z + 16384);
    /* (dx sx + dy sy) >> 4 of 36 bits */
    at = plus(at, plus(times(DOWN_SIGNED(dx, 4), sx), times(DOWN_SIGNED(dy, 4), sy)));
    at = plus(at, DOWN_SIGNED(plus(times(both(dx, all(15)), sx), times(both(dy, all(15)), sy)), 4));
    set_walk(w, plus(at, plus(times(dx, all(right)), times(dy, all(below)))), dx, dy);
}

/* Columns from x0 on, at most LANES. */
static inline void fill_small(const soft_vertex *const corner[3], int64_t area, const soft_box *box, int32_t x0,
                              const soft_pixels *to, unsigned item)
{
    const soft_vertex *const a = corner[0], *const b = corner[area > 0 ? 1 : 2], *const c = corner[area > 0 ? 2 : 1];
    const lanes columns = above(all(box->x1 - x0), ramp());
    int32_t y = box->y0;
    size_t at = (size_t)((y - to->row0) * to->stride + x0);
    lanes edge[3], down[3];
    walk w;
    int i;

    edge[0] = side_at(soft_side_of(a, b, x0, y), &down[0]);
    edge[1] = side_at(soft_side_of(b, c, x0, y), &down[1]);
    edge[2] = side_at(soft_side_of(c, a, x0, y), &down[2]);
    while (!any(inside_of(edge, columns))) { /* most slivers hit no sample at all */
        if (++y == box->y1) return;
        at += (size_t)to->stride;
        for (i = 0; i < 3; i++) edge[i] = plus(edge[i], down[i]);
    }
    set_small_walk(&w, corner, area, x0 - (a->x >> 4), y - (a->y >> 4));
    for (; y < box->y1; y++, at += (size_t)to->stride) {
        fill_lanes(w.line, to, at, inside_of(edge, columns), item);
        for (i = 0; i < 3; i++) edge[i] = plus(edge[i], down[i]);
        for (i = 0; i < SOFT_PLANES; i++) w.line[i] = plus(w.line[i], w.down[i]);
    }
}

static void draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    const int64_t area = soft_area(corner[0], corner[1], corner[2]);
    soft_box box;
    int32_t x;

    if (soft_culled(area, cull) || !soft_box_of(&box, corner, to)) return;
    if (box.x1 - box.x0 > 8 || box.size >= SOFT_SMALL)
        fill(corner, cull, to, item);
    else
        for (x = box.x0; x < box.x1; x += LANES) fill_small(corner, area, &box, x, to, item);
}

#define KERNELS                                                                                                        \
    {                                                                                                                  \
        draw, normalise, table_add, table_code, encode, soft_lit, 0                                                    \
    }

#endif
