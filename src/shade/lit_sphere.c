/* SPDX-License-Identifier: MIT */
#include "lit_sphere.h"

#include "eval_inner.h"
#include "eval_spheres_persp.h"

/* Dim lights are added up in units 16 times as fine, so that many of them together lose nothing to rounding. */
#define FINE_BITS      4
#define FINE_MOST_LOG2 (-3 * 65536) /* of a light's factor: 16 x 1/8 is half of what one light may add */

/* ---- normals ----------------------------------------------------------------------------------------------------- */

/* Square root of x, both q28, 0..1: the look-up's inverse root, improved once by Newton's step; worst 2^-20. */
static int64_t root_q28(int64_t x)
{
    eval_split s;
    int32_t half;
    int64_t inverse, scaled, root;

    if (x <= 0) return 0;
    s = eval_split_of((uint32_t)x);
    half = (31 - s.zeros) >> 1;
    scaled = x * ((int64_t)1 << (28 - 2 * half)); /* x = 4^half x scaled, which is 1..4 in q28 */
    inverse = eval_inverse_root(s);               /* 1 / root of scaled, q31 */
    inverse = fx_shift(inverse * (3 * ((int64_t)1 << 30) - fx_shift(fx_shift(inverse * inverse, 32) * scaled, 28)), 31);
    root = fx_shift(scaled * inverse, 31);
    return half < 14 ? fx_shift(root, 14 - half) : root;
}

void shade_lit_normals(unsigned size, unsigned y, uint32_t *xy, int16_t *z)
{
    /* half the way from texel to texel, q28 */
    const int64_t step = fx_div((int64_t)SHADE_LIT_HALF_Q16 << 12, size);
    const int64_t py = ((int64_t)size - 1 - 2 * (int64_t)y) * step, square_y = fx_shift(py * py, 28);
    int64_t px = (1 - (int64_t)size) * step;
    unsigned i;

    for (i = 0; i < size; i++, px += 2 * step) {
        const int64_t square = fx_shift(px * px, 28) + square_y, left = FX_Q28_ONE - square;
        const int64_t across = 2 * root_q28(left);
        const int64_t depth = left > 0 ? FX_Q28_ONE - 2 * square : -FX_Q28_ONE; /* the corners: straight behind */

        xy[i] = shade_pack_xy((int32_t)fx_shift(px * across, 42), (int32_t)fx_shift(py * across, 42));
        z[i] = (int16_t)fx_shift(depth, 14);
    }
}

/* ---- scratch ----------------------------------------------------------------------------------------------------- */

typedef struct parts { /* of the scratch */
    shade_frame *frame;
    uint32_t *columns;
    uint32_t *xy; /* normals, then codes */
    int16_t *z;
    shade_rgb sum, fine; /* q16; and in finer units, of dim lights */
} parts;

static int is_paper(const shade_material *m)
{
    return SHADE_HAS_SPHERES && SHADE_HAS_NEAR && m->model == NACRE_MODEL_SPHERES && m->is.spheres.cosine;
}

/* Of a table; in paper mode room for the evaluator, and for aligning it. */
static uint32_t column_words(const shade_material *m)
{
    if (is_paper(m)) return (sizeof(shade_spheres_persp) + sizeof(void *) + 3) / 4;
    return shade_is_table(m) ? SHADE_TABLE_WORDS(m->is.table.width, shade_is_fine(m)) : 0;
}

uint32_t shade_lit_scratch(const shade_lit *lit, unsigned rows)
{
    return (uint32_t)sizeof(shade_frame) + 4 * column_words(lit->material) + rows * lit->size * 30;
}

static parts split(const shade_lit *lit, unsigned rows, void *scratch)
{
    const uint32_t texels = rows * lit->size;
    uint32_t *words;
    parts p;

    p.frame = scratch;
    p.columns = (uint32_t *)(void *)(p.frame + 1);
    words = p.columns + column_words(lit->material);
    p.xy = words;
    p.sum.r = words + texels;
    p.sum.g = words + 2 * texels;
    p.sum.b = words + 3 * texels;
    p.fine.r = words + 4 * texels;
    p.fine.g = words + 5 * texels;
    p.fine.b = words + 6 * texels;
    p.z = (int16_t *)(void *)(words + 7 * texels);
    return p;
}

/* ---- lights ------------------------------------------------------------------------------------------------------ */

/* A light that is dim enough becomes 16 times as bright: 1. */
static int make_fine(shade_light *light, const shade_material *material)
{
    int64_t most_log2 = FINE_MOST_LOG2;
    int i;

    if (shade_is_table(material)) {
        const int64_t root_log2 = fx_log2_u64((uint64_t)shade_table_most_root(material)) - 16 * 65536;

        most_log2 -= fx_shift(material->is.table.p * root_log2, 16);
    }
    for (i = 0; i < 3; i++)
        if (fx_real_log2_q16(light->linear[i]) > most_log2) return 0;
    for (i = 0; i < 3; i++)
        if (light->linear[i].m) light->linear[i].e += FINE_BITS;
    return 1;
}

/* Images with the cosine in them are turned normal by normal; all are seen along +z. */
FX_APART static void add_paper(const shade_lit *lit, const parts *p, const shade_light *light, int count, shade_rgb to)
{
    enum { FEW = 8 };
    static const uint32_t eye_xy[FEW];
    static const int16_t eye_z[FEW] = {16384, 16384, 16384, 16384, 16384, 16384, 16384, 16384};
    shade_spheres_persp *const spheres =
        (shade_spheres_persp *)(((uintptr_t)p->columns + sizeof(void *) - 1) / sizeof(void *) * sizeof(void *));
    shade_persp_light from = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    int i;

    shade_spheres_persp_prepare(spheres, &lit->material->is.spheres, lit->layers[0], lit->sphere_size,
                                lit->sphere_texel_bytes);
    for (i = 0; i < 3; i++) {
        from.place[i] = shade_eval_q14(light->is.spheres.to_light_q28[i]);
        from.log2_q12[i] = fx_real_log2_q16(light->linear[i]) >> 4;
    }
    for (i = 0; i < count; i += FEW) {
        const shade_seen seen = {p->xy + i, eye_xy, p->z + i, eye_z, {NULL, NULL, NULL}, eval_least(count - i, FEW)};
        const shade_rgb part = {to.r + i, to.g + i, to.b + i};

        shade_spheres_persp_add(spheres, &from, &seen, part);
    }
}

static int add_light(const shade_lit *lit, const parts *p, shade_light *light, int count)
{
    const shade_rgb *const to = make_fine(light, lit->material) ? &p->fine : &p->sum;

    if (shade_is_table(lit->material)) {
        shade_table_eval eval;

        if (!shade_table_eval_prepare(&eval, p->columns, light, lit->material, lit->layers)) return 0;
        lit->kernels->table_add(&eval, p->xy, p->z, count, *to);
    } else if (is_paper(lit->material)) {
        add_paper(lit, p, light, count, *to);
    } else if (SHADE_HAS_SPHERES) {
        shade_spheres_eval eval;

        if (!shade_spheres_eval_prepare(&eval, light, lit->material, lit->layers, lit->sphere_size,
                                        lit->sphere_texel_bytes))
            return 0;
        shade_spheres_add(&eval, p->xy, p->z, count, *to);
    }
    return 1;
}

/* The view's lights in portions of what a shade_frame holds. */
static int add_lights(const shade_lit *lit, const parts *p, int count)
{
    nacre_view view = *lit->view;
    unsigned first, i;

    view.distant_viewer = 1;
    for (first = 0; !first || first < lit->view->light_count; first += NACRE_MAX_LIGHTS) {
        const unsigned left = lit->view->light_count - first;

        view.lights = lit->view->lights + first;
        view.light_count = (uint16_t)(left < NACRE_MAX_LIGHTS ? left : NACRE_MAX_LIGHTS);
        shade_setup(p->frame, &view, lit->centre, lit->material, SHADE_LINEAR, 0, 2);
        if (!first) shade_rgb_fill(p->sum, count, p->frame->ambient);
        for (i = 0; i < view.light_count; i++)
            if (!add_light(lit, p, &p->frame->light[i], count)) return 0;
    }
    return 1;
}

static void add_fine(uint32_t *sum, const uint32_t *fine, int count)
{
    int i;

    for (i = 0; i < count; i++) sum[i] += (fine[i] + (1u << FINE_BITS >> 1)) >> FINE_BITS;
}

const uint32_t *shade_lit_rows(const shade_lit *lit, unsigned y0, unsigned rows, void *scratch)
{
    const parts p = split(lit, rows, scratch);
    const int count = (int)(rows * lit->size);
    unsigned i;

    for (i = 0; i < rows; i++) shade_lit_normals(lit->size, y0 + i, p.xy + i * lit->size, p.z + i * lit->size);
    shade_rgb_fill(p.fine, count, NULL);
    if (!add_lights(lit, &p, count)) return NULL;
    add_fine(p.sum.r, p.fine.r, count);
    add_fine(p.sum.g, p.fine.g, count);
    add_fine(p.sum.b, p.fine.b, count);
    lit->kernels->encode(p.sum, count, (nacre_output)lit->view->output, p.xy);
    return p.xy;
}
