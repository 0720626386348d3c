/* SPDX-License-Identifier: MIT */
/*
 * The inner loops with AVX2, eight pixels at a time: line by line what eval_inner.h, raster.c and span.c define, with the
 * same bits. Compile this file with -mavx2; without it, it is empty.
 *
 * Numbers of 16 bits stand in the lower halves of 32-bit lanes; pmaddwd multiplies them when the upper half of one factor
 * is 0. The highest bit of a number below 2^24 is found by converting it to float, which is exact there.
 */
#include "soft.h"

#ifdef __AVX2__

#include <immintrin.h>
#include <string.h>

#include "eval_inner.h"
#include "setup.h"

typedef __m256i lanes;

static inline lanes all(int32_t x)
{
    return _mm256_set1_epi32(x);
}

static inline lanes product(lanes a, lanes b)
{
    return _mm256_madd_epi16(a, b);
}

static inline lanes load(const void *p)
{
    return _mm256_loadu_si256((const lanes *)p);
}

static inline void store(void *p, lanes x)
{
    _mm256_storeu_si256((lanes *)p, x);
}

static inline lanes load_16(const int16_t *p)
{
    return _mm256_cvtepi16_epi32(_mm_loadu_si128((const __m128i *)(const void *)p));
}

/* The lower halves. */
static inline __m128i narrow(lanes x)
{
    const lanes order = _mm256_setr_epi8(0, 1, 4, 5, 8, 9, 12, 13, -1, -1, -1, -1, -1, -1, -1, -1, 0, 1, 4, 5, 8, 9, 12,
                                         13, -1, -1, -1, -1, -1, -1, -1, -1);

    return _mm256_castsi256_si128(_mm256_permute4x64_epi64(_mm256_shuffle_epi8(x, order), 0x08));
}

/* Exponent and mantissa of x < 2^25 as a float has them. */
static inline lanes split(lanes x)
{
    const lanes even = _mm256_andnot_si256(_mm256_srli_epi32(x, 24), x); /* of 25 bits the last is cut, not rounded */

    return _mm256_castps_si256(_mm256_cvtepi32_ps(even));
}

static inline lanes fraction(lanes split, int bits)
{
    return _mm256_and_si256(_mm256_srli_epi32(split, 8 - bits), all(32767));
}

static inline lanes between(lanes word, lanes f)
{
    return _mm256_add_epi32(word, product(word, f));
}

static inline lanes look_up(const uint32_t *table, lanes at)
{
    return _mm256_i32gather_epi32((const int *)table, at, 4);
}

/* ---- normals ------------------------------------------------------------------------------------------------------------- */

/* In place. 0, and nothing done: one is shorter than half; shade_normalise takes another way there. */
static inline int unit(lanes *xy, lanes *z)
{
    const lanes square = _mm256_add_epi32(product(*xy, *xy), _mm256_mullo_epi32(*z, *z)), round = all(1 << 13);
    const lanes node = _mm256_min_epi32(_mm256_srli_epi32(square, 22), all(64));
    lanes inverse, x, y;

    if (_mm256_movemask_epi8(_mm256_cmpgt_epi32(all(1 << 26), square))) return 0;
    inverse = between(look_up(shade_lut_length, node), _mm256_and_si256(_mm256_srli_epi32(square, 7), all(32767)));
    inverse = _mm256_srli_epi32(inverse, 16);
    x = _mm256_srai_epi32(_mm256_add_epi32(product(*xy, inverse), round), 14);
    y = _mm256_srai_epi32(_mm256_add_epi32(product(*xy, _mm256_slli_epi32(inverse, 16)), round), 14);
    *z = _mm256_srai_epi32(_mm256_add_epi32(product(*z, inverse), round), 14);
    *xy = _mm256_blend_epi16(x, _mm256_slli_epi32(y, 16), 0xAA);
    return 1;
}

static void normalise(uint32_t *xy, int16_t *z, int count)
{
    int i;

    for (i = 0; i + 8 <= count; i += 8) {
        lanes n = load(xy + i), nz = load_16(z + i);

        if (unit(&n, &nz)) {
            store(xy + i, n);
            _mm_storeu_si128((__m128i *)(void *)(z + i), narrow(nz));
        } else {
            shade_normalise(xy + i, z + i, 8);
        }
    }
    shade_normalise(xy + i, z + i, count - i);
}

/* ---- tables -------------------------------------------------------------------------------------------------------------- */

typedef struct constants {
    lanes light_xy, light_z, half_xy, half_z, offset, middle, scale, at_middle, last, limit, phi[3], log_low, log_high,
        gain;
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
    c.log_low = load(shade_lut_log2);
    c.log_high = load(shade_lut_log2 + 8);
    c.gain = all(gain);
    return c;
}

static inline lanes dot(lanes xy, lanes z, lanes to_xy, lanes to_z)
{
    return _mm256_add_epi32(product(xy, to_xy), product(z, to_z));
}

/* log2 x - log_middle, q12 */
static inline lanes log2_from_middle(lanes x, const constants *c)
{
    const lanes s = split(x), node = _mm256_srli_epi32(s, 19);
    const lanes low = _mm256_permutevar8x32_epi32(c->log_low, node),
                high = _mm256_permutevar8x32_epi32(c->log_high, node);
    const lanes word = _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(low), _mm256_castsi256_ps(high),
                                                            _mm256_castsi256_ps(_mm256_slli_epi32(node, 28))));
    const lanes exponent = _mm256_slli_epi32(_mm256_srli_epi32(s, 23), 12);

    return _mm256_sub_epi32(_mm256_add_epi32(exponent, _mm256_srli_epi32(between(word, fraction(s, 4)), 19)),
                            c->middle);
}

/* Four words at each of eight places, as four lanes of words. */
static inline void transpose(const uint32_t *columns, lanes at, lanes w[4])
{
    uint32_t place[8];
    lanes r[4], s[4];
    int i;

    store(place, at);
    for (i = 0; i < 4; i++)
        r[i] = _mm256_inserti128_si256(
            _mm256_castsi128_si256(_mm_loadu_si128((const __m128i *)(const void *)(columns + place[i]))),
            _mm_loadu_si128((const __m128i *)(const void *)(columns + place[i + 4])), 1);
    s[0] = _mm256_unpacklo_epi32(r[0], r[1]);
    s[1] = _mm256_unpackhi_epi32(r[0], r[1]);
    s[2] = _mm256_unpacklo_epi32(r[2], r[3]);
    s[3] = _mm256_unpackhi_epi32(r[2], r[3]);
    w[0] = _mm256_unpacklo_epi64(s[0], s[2]);
    w[1] = _mm256_unpackhi_epi64(s[0], s[2]);
    w[2] = _mm256_unpacklo_epi64(s[1], s[3]);
    w[3] = _mm256_unpackhi_epi64(s[1], s[3]);
}

static inline lanes clip_root(lanes root_q29)
{
    return _mm256_min_epi32(_mm256_max_epi32(_mm256_srai_epi32(root_q29, 15), all(0)), all(32767));
}

EVAL_INLINE void roots(const shade_table_eval *e, const constants *c, lanes xy, lanes z, lanes nl, int fine,
                       lanes root[3])
{
    const lanes square = _mm256_add_epi32(product(xy, xy), _mm256_mullo_epi32(z, z));
    const lanes distance = _mm256_add_epi32(_mm256_add_epi32(square, dot(xy, z, c->half_xy, c->half_z)), c->offset);
    const lanes from_middle = log2_from_middle(_mm256_srli_epi32(distance, 7), c);
    const lanes u =
        _mm256_min_epi32(_mm256_add_epi32(_mm256_srai_epi32(product(from_middle, c->scale), 8), c->at_middle), c->last);
    const lanes f = _mm256_and_si256(u, all(32767)), column = _mm256_srli_epi32(u, 15);
    const lanes a = _mm256_abs_epi32(_mm256_sub_epi32(_mm256_srai_epi32(nl, 14), z));
    const lanes size = _mm256_min_epi32(a, c->limit), bent = _mm256_srli_epi32(product(size, size), 13);
    lanes w[4], shared;
    int i;

    transpose(e->columns, _mm256_slli_epi32(column, fine ? 3 : 2), w);
    shared = _mm256_srai_epi32(between(w[3], f), 15);
    if (fine) {
        const lanes fourth = _mm256_srli_epi32(_mm256_mullo_epi32(bent, bent), 15);
        lanes linear = _mm256_srai_epi32(product(shared, _mm256_slli_epi32(size, 1)), 15), t[4];

        transpose(e->columns + 4, _mm256_slli_epi32(column, 3), t);
        linear = _mm256_add_epi32(
            linear, _mm256_srai_epi32(_mm256_mullo_epi32(_mm256_srai_epi32(between(t[3], f), 15), fourth), 15));
        for (i = 0; i < 3; i++)
            root[i] = clip_root(_mm256_add_epi32(
                _mm256_add_epi32(between(w[i], f), product(_mm256_srai_epi32(between(t[i], f), 15), bent)),
                product(linear, c->phi[i])));
    } else {
        const lanes bend = _mm256_srai_epi32(product(shared, bent), 15);

        for (i = 0; i < 3; i++) root[i] = clip_root(_mm256_add_epi32(between(w[i], f), product(bend, c->phi[i])));
    }
}

static inline lanes root48(lanes x)
{
    const lanes s = split(_mm256_max_epi32(x, all(512)));
    const lanes node = _mm256_sub_epi32(_mm256_srli_epi32(s, 20), all(127 * 8 + 72));

    return _mm256_srli_epi32(between(look_up(shade_lut_root48, node), fraction(s, 3)), 16);
}

/* On both halves of the lanes. */
static inline lanes pow24(lanes v)
{
    lanes c = _mm256_sub_epi16(_mm256_mulhrs_epi16(_mm256_set1_epi16(6031), v), _mm256_set1_epi16(16375));

    c = _mm256_add_epi16(_mm256_mulhrs_epi16(c, v), _mm256_set1_epi16(21971));
    c = _mm256_add_epi16(_mm256_mulhrs_epi16(c, v), _mm256_set1_epi16(4784));
    c = _mm256_mulhrs_epi16(_mm256_mulhrs_epi16(v, v), c);
    return _mm256_adds_epi16(c, c);
}

static inline lanes scaled(lanes root, lanes gain, int shift)
{
    return _mm256_min_epi32(_mm256_srl_epi32(product(root, gain), _mm_cvtsi32_si128(shift)), all(32767));
}

static inline void accumulate(uint32_t *to, lanes half_root, lanes lit)
{
    const lanes sum = _mm256_srli_epi32(product(half_root, half_root), 12);

    store(to, _mm256_add_epi32(load(to), _mm256_and_si256(sum, lit)));
}

static inline void add(const shade_table_eval *e, const constants *c, const uint32_t *xy, const int16_t *z,
                       shade_rgb radiance, int i, int fine, int power4)
{
    const lanes n = load(xy + i), nz = load_16(z + i), nl = dot(n, nz, c->light_xy, c->light_z);
    const lanes lit = _mm256_cmpgt_epi32(nl, all(0));
    lanes root[3], cosine, red_green;
    int k;

    if (!_mm256_movemask_epi8(lit)) return;
    cosine = root48(_mm256_srai_epi32(nl, 5));
    if (power4) cosine = _mm256_and_si256(pow24(cosine), all(65535));
    cosine = _mm256_mulhrs_epi16(cosine, c->gain);
    roots(e, c, n, nz, nl, fine, root);
    if (power4) {
        for (k = 0; k < 3; k++)
            root[k] = scaled(_mm256_min_epi32(_mm256_srli_epi32(product(root[k], root[k]), 14), all(32767)), cosine,
                             e->shift);
    } else {
        for (k = 0; k < 3; k++) root[k] = scaled(root[k], cosine, e->shift);
        red_green = pow24(_mm256_or_si256(root[0], _mm256_slli_epi32(root[1], 16)));
        root[0] = _mm256_and_si256(red_green, all(65535));
        root[1] = _mm256_srli_epi32(red_green, 16);
        root[2] = _mm256_and_si256(pow24(root[2]), all(65535));
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
        for (; i + 8 <= count; i += 8) add(e, &c, xy, z, radiance, i, 1, e->power4);
    else if (e->power4)
        for (; i + 8 <= count; i += 8) add(e, &c, xy, z, radiance, i, 0, 1);
    else
        for (; i + 8 <= count; i += 8) add(e, &c, xy, z, radiance, i, 0, 0);
    rest.r = radiance.r + i;
    rest.g = radiance.g + i;
    rest.b = radiance.b + i;
    shade_table_add(e, xy + i, z + i, count - i, rest);
}

static inline lanes code_of(lanes root, lanes gain, int shift)
{
    const lanes z =
        _mm256_min_epi32(_mm256_srl_epi32(product(root, gain), _mm_cvtsi32_si128(shift)), all(SHADE_CODE_MOST));
    const lanes code = _mm256_srai_epi32(_mm256_sub_epi32(product(z, z), all(SHADE_CODE_LOW - (1 << 20))), 21);

    return _mm256_max_epi32(code, all(0));
}

EVAL_INLINE void code(const shade_table_eval *e, const constants *c, const uint32_t *xy, const int16_t *z,
                      uint32_t *rgba, int fine)
{
    const lanes opaque = all((int32_t)(255u << 24));
    lanes n = load(xy), nz = load_16(z), nl, lit, root[3], cosine, out;

    if (!unit(&n, &nz)) {
        shade_table_code(e, xy, z, 8, rgba);
        return;
    }
    nl = dot(n, nz, c->light_xy, c->light_z);
    lit = _mm256_cmpgt_epi32(nl, all(0));
    if (!_mm256_movemask_epi8(lit)) {
        store(rgba, opaque);
        return;
    }
    cosine = _mm256_mulhrs_epi16(root48(_mm256_srai_epi32(nl, 5)), c->gain);
    roots(e, c, n, nz, nl, fine, root);
    out = code_of(root[0], cosine, e->shift_code);
    out = _mm256_or_si256(out, _mm256_slli_epi32(code_of(root[1], cosine, e->shift_code), 8));
    out = _mm256_or_si256(out, _mm256_slli_epi32(code_of(root[2], cosine, e->shift_code), 16));
    store(rgba, _mm256_or_si256(_mm256_and_si256(out, lit), opaque));
}

static void table_code(const shade_table_eval *e, const uint32_t *xy, const int16_t *z, int count, uint32_t *rgba)
{
    const constants c = constants_of(e, e->gain_code);
    int i = 0;

    if (!e->dark && e->fine)
        for (; i + 8 <= count; i += 8) code(e, &c, xy + i, z + i, rgba + i, 1);
    else if (!e->dark)
        for (; i + 8 <= count; i += 8) code(e, &c, xy + i, z + i, rgba + i, 0);
    shade_table_code(e, xy + i, z + i, count - i, rgba + i);
}

/* ---- codes ------------------------------------------------------------------------------------------------------------------ */

static inline lanes srgb_code(const uint32_t *radiance)
{
    const lanes s = split(_mm256_min_epu32(_mm256_max_epu32(load(radiance), all(8)), all(65536)));
    const lanes node = _mm256_sub_epi32(_mm256_srli_epi32(s, 20), all(127 * 8 + 24));
    const lanes value = _mm256_srli_epi32(between(look_up(shade_lut_srgb, node), fraction(s, 3)), 16);

    return _mm256_srli_epi32(_mm256_add_epi32(value, all(64)), 7);
}

static void encode(shade_rgb radiance, int count, nacre_output output, uint32_t *rgba)
{
    shade_rgb rest;
    int i = 0;

    for (; i + 8 <= count && output == NACRE_OUTPUT_SRGB; i += 8) {
        const lanes r = srgb_code(radiance.r + i), g = _mm256_slli_epi32(srgb_code(radiance.g + i), 8);
        const lanes b = _mm256_slli_epi32(srgb_code(radiance.b + i), 16);

        store(rgba + i, _mm256_or_si256(_mm256_or_si256(r, g), _mm256_or_si256(b, all((int32_t)(255u << 24)))));
    }
    rest.r = radiance.r + i;
    rest.g = radiance.g + i;
    rest.b = radiance.b + i;
    shade_encode(rest, count - i, output, rgba + i);
}

/* ---- triangles -------------------------------------------------------------------------------------------------------------- */

typedef struct walk {                           /* planes: depth, normal x, y, z */
    lanes ramp[SOFT_PLANES], leap[SOFT_PLANES]; /* step x 0..7, step x 8 */
    __m128i at, dx, dy;
} walk;

static inline walk walk_of(const soft_triangle *t)
{
    const lanes eight = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    walk w;
    int i;

    for (i = 0; i < SOFT_PLANES; i++) {
        const lanes step = all((int32_t)t->plane[i].dx);

        w.ramp[i] = _mm256_mullo_epi32(step, eight);
        w.leap[i] = _mm256_slli_epi32(step, 3);
    }
    w.at = _mm_setr_epi32((int)t->plane[0].at, (int)t->plane[1].at, (int)t->plane[2].at, (int)t->plane[3].at);
    w.dx = _mm_setr_epi32((int)t->plane[0].dx, (int)t->plane[1].dx, (int)t->plane[2].dx, (int)t->plane[3].dx);
    w.dy = _mm_setr_epi32((int)t->plane[0].dy, (int)t->plane[1].dy, (int)t->plane[2].dy, (int)t->plane[3].dy);
    return w;
}

static inline void fill_eight(const lanes value[SOFT_PLANES], const soft_pixels *to, size_t at, lanes inside,
                              unsigned item)
{
    const lanes old = _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)(to->depth + at)));
    const lanes depth = _mm256_srli_epi32(value[0], 15);
    const lanes front = _mm256_and_si256(_mm256_cmpgt_epi32(old, depth), inside);
    __m128i narrow_front, z, owner;

    if (!_mm256_movemask_epi8(front)) return;
    _mm256_maskstore_epi32((int *)to->xy + at, front,
                           _mm256_blend_epi16(_mm256_srli_epi32(value[1], 16), value[2], 0xAA));
    narrow_front = narrow(front);
    _mm_storeu_si128((__m128i *)(void *)(to->depth + at), narrow(_mm256_blendv_epi8(old, depth, front)));
    z = _mm_loadu_si128((const __m128i *)(const void *)(to->z + at));
    z = _mm_blendv_epi8(z, narrow(_mm256_srli_epi32(value[3], 16)), narrow_front);
    _mm_storeu_si128((__m128i *)(void *)(to->z + at), z);
    if (!to->item) return;
    owner = _mm_loadl_epi64((const __m128i *)(const void *)(to->item + at));
    owner = _mm_blendv_epi8(owner, _mm_set1_epi8((char)item), _mm_packs_epi16(narrow_front, narrow_front));
    _mm_storel_epi64((__m128i *)(void *)(to->item + at), owner);
}

static inline void fill_span(const walk *w, __m128i start, const soft_pixels *to, size_t at, int32_t count,
                             unsigned item)
{
    const lanes eight = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    lanes value[SOFT_PLANES];

    value[0] = _mm256_add_epi32(_mm256_broadcastd_epi32(start), w->ramp[0]);
    value[1] = _mm256_add_epi32(_mm256_broadcastd_epi32(_mm_shuffle_epi32(start, 0x55)), w->ramp[1]);
    value[2] = _mm256_add_epi32(_mm256_broadcastd_epi32(_mm_shuffle_epi32(start, 0xAA)), w->ramp[2]);
    value[3] = _mm256_add_epi32(_mm256_broadcastd_epi32(_mm_shuffle_epi32(start, 0xFF)), w->ramp[3]);
    for (;;) {
        int i;

        fill_eight(value, to, at, _mm256_cmpgt_epi32(all(count), eight), item);
        count -= 8;
        if (count <= 0) return;
        at += 8;
        for (i = 0; i < SOFT_PLANES; i++) value[i] = _mm256_add_epi32(value[i], w->leap[i]);
    }
}

static inline void step_edge(soft_edge *e)
{
    const int32_t rest = e->rest + e->rest_step, over = rest >= e->whole;

    e->x += e->step + over;
    e->rest = over ? rest - e->whole : rest;
}

static inline void fill_part(const soft_triangle *t, const walk *w, soft_edge *left, soft_edge *right, int32_t row,
                             int32_t end, const soft_pixels *to, unsigned item)
{
    __m128i line = _mm_add_epi32(w->at, _mm_mullo_epi32(w->dy, _mm_set1_epi32(row - t->row0)));
    size_t at = (size_t)((row - to->row0) * to->stride);

    for (; row < end; row++) {
        const int32_t x0 = left->x < to->x0 ? to->x0 : left->x, x1 = right->x > to->x1 ? to->x1 : right->x;

        if (x0 < x1)
            fill_span(w, _mm_add_epi32(line, _mm_mullo_epi32(w->dx, _mm_set1_epi32(x0 - t->x0))), to, at + (size_t)x0,
                      x1 - x0, item);
        line = _mm_add_epi32(line, w->dy);
        at += (size_t)to->stride;
        step_edge(left);
        step_edge(right);
    }
}

static void fill(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    soft_triangle t;
    soft_edge *const whole = &t.edge[0], *const upper = &t.edge[1], *const lower = &t.edge[2];
    walk w;

    if (!soft_triangle_set(&t, corner, cull, to)) return;
    w = walk_of(&t);
    if (t.long_left) {
        fill_part(&t, &w, whole, upper, t.y0, t.y1, to, item);
        fill_part(&t, &w, whole, lower, t.y1, t.y2, to, item);
    } else {
        fill_part(&t, &w, upper, whole, t.y0, t.y1, to, item);
        fill_part(&t, &w, lower, whole, t.y1, t.y2, to, item);
    }
}

/* ---- small triangles: at most eight columns, every pixel tested against the three edges ------------------------------------- */

static inline int32_t least(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline int32_t most(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* From p to q, the inside on the right: 0 and up at samples inside, or on a left or top edge. */
static inline lanes edge_at(const soft_vertex *p, const soft_vertex *q, int32_t x, int32_t y, lanes *down)
{
    const int32_t dx = q->x - p->x, dy = q->y - p->y;
    const int32_t at = dx * (y - p->y) - dy * (x - p->x) - !(dy < 0 || (!dy && dx > 0));

    *down = all(16 * dx);
    return _mm256_add_epi32(all(at), _mm256_mullo_epi32(all(-16 * dy), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)));
}

/* Nothing of a row's columns is inside all edges. */
static inline int empty(const lanes edge[3], lanes columns)
{
    const lanes out = _mm256_or_si256(_mm256_or_si256(edge[0], edge[1]), edge[2]);

    return !_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_andnot_si256(out, columns)));
}

static inline void fill_small(const soft_vertex *const corner[3], int64_t area, int32_t x0, int32_t x1, int32_t y0,
                              int32_t y1, const soft_pixels *to, unsigned item)
{
    const soft_vertex *const a = corner[0], *const b = corner[area > 0 ? 1 : 2], *const c = corner[area > 0 ? 2 : 1];
    const lanes eight = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), columns = _mm256_cmpgt_epi32(all(x1 - x0), eight);
    const int32_t x = 16 * x0 + 8, y = 16 * y0 + 8;
    size_t at = (size_t)((y0 - to->row0) * to->stride + x0);
    lanes edge[3], down[3], value[SOFT_PLANES], step[SOFT_PLANES];
    soft_plane plane[SOFT_PLANES];
    int i;

    edge[0] = edge_at(a, b, x, y, &down[0]);
    edge[1] = edge_at(b, c, x, y, &down[1]);
    edge[2] = edge_at(c, a, x, y, &down[2]);
    while (empty(edge, columns)) { /* most slivers hit no sample at all */
        if (++y0 == y1) return;
        at += (size_t)to->stride;
        for (i = 0; i < 3; i++) edge[i] = _mm256_add_epi32(edge[i], down[i]);
    }
    soft_set_planes(plane, corner, area);
    for (i = 0; i < SOFT_PLANES; i++) {
        const soft_plane *const p = &plane[i];

        value[i] = _mm256_add_epi32(all((int32_t)(p->at + p->dx * (uint32_t)(x0 - (corner[0]->x >> 4)) +
                                                  p->dy * (uint32_t)(y0 - (corner[0]->y >> 4)))),
                                    _mm256_mullo_epi32(all((int32_t)p->dx), eight));
        step[i] = all((int32_t)p->dy);
    }
    for (; y0 < y1; y0++, at += (size_t)to->stride) {
        const lanes out = _mm256_or_si256(_mm256_or_si256(edge[0], edge[1]), edge[2]);

        fill_eight(value, to, at, _mm256_andnot_si256(_mm256_srai_epi32(out, 31), columns), item);
        for (i = 0; i < 3; i++) edge[i] = _mm256_add_epi32(edge[i], down[i]);
        for (i = 0; i < SOFT_PLANES; i++) value[i] = _mm256_add_epi32(value[i], step[i]);
    }
}

static void draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item)
{
    const soft_vertex *const a = corner[0], *const b = corner[1], *const c = corner[2];
    const int64_t area = soft_area(a, b, c);
    int32_t left, right, top, bottom, x0, x1, y0, y1;

    if (soft_culled(area, cull)) return;
    left = least(least(a->x, b->x), c->x);
    right = most(most(a->x, b->x), c->x);
    top = least(least(a->y, b->y), c->y);
    bottom = most(most(a->y, b->y), c->y);
    x0 = most(soft_line_of(left), to->x0);
    x1 = least(soft_line_of(right), to->x1);
    y0 = most(soft_line_of(top), to->y0);
    y1 = least(soft_line_of(bottom), to->y1);
    if (x0 >= x1 || y0 >= y1) return;
    if (x1 - x0 <= 8 && right - left < 2048 && bottom - top < 2048)
        fill_small(corner, area, x0, x1, y0, y1, to, item);
    else
        fill(corner, cull, to, item);
}

const nacre_soft_kernels nacre_soft_avx2 = {draw, normalise, table_add, table_code, encode, soft_lit};

#endif
