/* SPDX-License-Identifier: MIT */
/* Triangles with textures or blended: what raster.c does, and per pixel in front the texel's normal, alpha and, of materials
   that vary over the surface, the code. */
#include "setup.h"

enum { DETAILS = 5 }; /* tangent x y z, u, v */

typedef struct mapped {
    const soft_item *item;
    const soft_triangle *t;
    soft_plane detail[DETAILS]; /* q30; u v: q11 in the upper half, too */
    soft_plane nearness;        /* q30 */
    int flat;                   /* all at one distance */
    int handed;
} mapped;

FX_APART static void set_details(mapped *m, const soft_vertex *const corner[3], const soft_detail *const detail[3])
{
    const uint32_t most = (uint32_t)corner[0]->nearness | corner[1]->nearness | corner[2]->nearness;
    const int up = fx_leading_zeros(most) - 16;
    int32_t near[3];
    soft_slope s;
    int i, k;

    m->flat = corner[0]->nearness == corner[1]->nearness && corner[0]->nearness == corner[2]->nearness;
    soft_set_slope(&s, corner[0], corner[1], corner[2], soft_area(corner[0], corner[1], corner[2]));
    s.x = 8 - (corner[0]->x & 15);
    s.y = 8 - (corner[0]->y & 15);
    for (k = 0; k < 3; k++) near[k] = m->flat ? 65536 : (int32_t)((uint32_t)corner[k]->nearness << up);
    soft_set_plane(&m->nearness, &s, near[0] >> 2, near[1] >> 2, near[2] >> 2, 16, near[0] * 16384);
    for (i = 0; i < DETAILS; i++) {
        int32_t value[3];

        for (k = 0; k < 3; k++) {
            const int32_t x = i < 3 ? detail[k]->tangent[i] : detail[k]->uv[i - 3];

            value[k] = (int32_t)(((int64_t)x * near[k] + 32768) >> 16);
        }
        /* tangents are cut to their upper half, where half a step rounds; u and v are used whole */
        soft_set_plane(&m->detail[i], &s, value[0], value[1], value[2], 16, value[0] * 65536 + (i < 3 ? 32768 : 0));
    }
    m->handed = detail[0]->handed;
}

static int32_t value_at(const soft_plane *p, const soft_triangle *t, int32_t x, int32_t y)
{
    return (int32_t)(p->at + p->dx * (uint32_t)(x - t->x0) + p->dy * (uint32_t)(y - t->row0));
}

/* q27 of q27 / (q14 in q30). */
static int32_t divided(int32_t value, uint32_t inverse, int shift)
{
    return (int32_t)(((int64_t)value * inverse) >> shift);
}

typedef struct texture_place {
    int32_t u, v;  /* q27 */
    uint32_t rate; /* the most that either changes a pixel, q27 */
} texture_place;

static uint32_t larger(uint32_t most, int32_t x)
{
    const uint32_t size = x < 0 ? 0 - (uint32_t)x : (uint32_t)x;

    return size > most ? size : most;
}

static texture_place look_up_place(const mapped *m, int32_t x, int32_t y)
{
    const soft_plane *const uv = &m->detail[3], *const w = &m->nearness;
    texture_place out = {value_at(&uv[0], m->t, x, y), value_at(&uv[1], m->t, x, y), 0};
    int32_t slope[4] = {(int32_t)uv[0].dx, (int32_t)uv[0].dy, (int32_t)uv[1].dx, (int32_t)uv[1].dy};
    int i;

    if (!m->flat) {
        const int32_t near = value_at(w, m->t, x, y) >> 8;
        uint32_t inverse;
        int shift;

        shade_reciprocal((uint32_t)(near < 64 ? 64 : near), &inverse, &shift);
        out.u = divided(out.u, inverse, shift - 22);
        out.v = divided(out.v, inverse, shift - 22);
        for (i = 0; i < 4 && m->item->sbrdf; i++) /* (U / w)' = (U' - u w') / w */
            slope[i] =
                divided(slope[i] - (int32_t)((int64_t)(i < 2 ? out.u : out.v) * (int32_t)(i & 1 ? w->dy : w->dx) >> 30),
                        inverse, shift - 22);
    }
    for (i = 0; i < 4; i++) out.rate = larger(out.rate, slope[i]);
    out.v = (int32_t)((1u << 27) - (uint32_t)out.v); /* rows run from the top, v upwards */
    return out;
}

/* The texel's normal in the frame of tangent, bitangent and normal; by a lit sphere half of it and the eye. */
FX_APART static void bend(const mapped *m, int32_t x, int32_t y, const texture_place *place, uint32_t *xy, int16_t *z)
{
    int32_t code[1][4], part[3], n[3], sum[3];
    uint32_t tangent_xy =
        shade_pack_xy(value_at(&m->detail[0], m->t, x, y) >> 16, value_at(&m->detail[1], m->t, x, y) >> 16);
    int16_t tangent_z = (int16_t)(value_at(&m->detail[2], m->t, x, y) >> 16), out[3];
    int32_t t[3], b[3];
    int i;

    shade_normalise(xy, z, 1);
    shade_normalise(&tangent_xy, &tangent_z, 1);
    n[0] = shade_x_of(*xy), n[1] = shade_y_of(*xy), n[2] = *z;
    t[0] = shade_x_of(tangent_xy), t[1] = shade_y_of(tangent_xy), t[2] = tangent_z;
    b[0] = (n[1] * t[2] - n[2] * t[1]) >> 14;
    b[1] = (n[2] * t[0] - n[0] * t[2]) >> 14;
    b[2] = (n[0] * t[1] - n[1] * t[0]) >> 14;
    soft_sample(&m->item->normal_map, 1, place->u, place->v, 0, code);
    /* 2 code / 255 - 1, q13: codes are x 65536 */
    for (i = 0; i < 3; i++) part[i] = (int32_t)(((int64_t)code[0][i] * 2 - 255 * 65536) * 8192 / 65536 * 257 >> 16);
    for (i = 0; i < 3; i++)
        sum[i] = (t[i] * part[0] + b[i] * (m->handed < 0 ? -part[1] : part[1]) + n[i] * part[2]) >> 14;
    *xy = shade_pack_xy(sum[0], sum[1]);
    *z = (int16_t)sum[2];
    if (!m->item->lit) return;
    shade_normalise(xy, z, 1);
    out[0] = (int16_t)shade_x_of(*xy), out[1] = (int16_t)shade_y_of(*xy), out[2] = *z;
    soft_to_half(out);
    *xy = shade_pack_xy(out[0], out[1]);
    *z = out[2];
}

/* Of the mask, or of the material's own texel; q16 codes. */
static int32_t opacity(const mapped *m, const texture_place *place, shade_sbrdf_codes codes)
{
    const soft_texture *const mask = &m->item->mask;
    int32_t alpha[1][4] = {{0, 0, 0, 255 * 65536}};

    if (m->item->sbrdf) soft_sbrdf_sample(m->item, place->u, place->v, place->rate, codes);
    if (!mask->texels) return m->item->sbrdf ? codes[0][3] : alpha[0][3];
    soft_sample(mask, 1, place->u, place->v, 0, alpha);
    return alpha[0][mask->channels == 2 ? 1 : 3];
}

static void put(const mapped *m, int32_t x, int32_t y, const soft_pixels *to, unsigned item)
{
    const uint32_t at = (uint32_t)((y - to->row0) * to->stride + x);
    const uint32_t depth = (uint32_t)value_at(&m->t->plane[0], m->t, x, y) >> 15;
    shade_sbrdf_codes codes;
    texture_place place;
    int16_t tangent[3];
    int32_t alpha;
    int i;

    if (depth >= to->depth[at]) return;
    place = look_up_place(m, x, y);
    alpha = opacity(m, &place, codes);
    if (alpha + 32768 < m->item->alpha_least * 65536) return;
    to->depth[at] = (uint16_t)depth;
    to->xy[at] = (uint32_t)value_at(&m->t->plane[1], m->t, x, y) >> 16 |
                 ((uint32_t)value_at(&m->t->plane[2], m->t, x, y) & 0xFFFF0000u);
    to->z[at] = (int16_t)(value_at(&m->t->plane[3], m->t, x, y) >> 16);
    if (m->item->normal_map.texels) bend(m, x, y, &place, &to->xy[at], &to->z[at]);
    if (m->item->sbrdf) {
        for (i = 0; i < 3; i++) tangent[i] = (int16_t)(value_at(&m->detail[i], m->t, x, y) >> 16);
        soft_sbrdf_put(m->item, tangent, m->handed < 0, codes, alpha, to, x, y);
    }
    if (to->item) to->item[at] = m->item->blend ? (uint8_t)((alpha + 32768) >> 16) : (uint8_t)item;
}

static void fill_part(const mapped *m, soft_edge *left, soft_edge *right, int32_t row, int32_t end,
                      const soft_pixels *to, unsigned item)
{
    for (; row < end; row++) {
        int32_t x = left->x < to->x0 ? to->x0 : left->x;
        const int32_t x1 = right->x > to->x1 ? to->x1 : right->x;

        for (; x < x1; x++) put(m, x, row, to, item);
        soft_step_edge(left);
        soft_step_edge(right);
    }
}

void soft_draw_mapped(const soft_item *item, const soft_vertex *const corner[3], const soft_detail *const detail[3],
                      const soft_pixels *to, unsigned index)
{
    soft_triangle t;
    mapped m;

    if (!soft_triangle_set(&t, corner, item->cull, to)) return;
    m.item = item;
    m.t = &t;
    set_details(&m, corner, detail);
    fill_part(&m, &t.edge[t.long_left ? 0 : 1], &t.edge[t.long_left ? 1 : 0], t.y0, t.y1, to, index);
    fill_part(&m, &t.edge[t.long_left ? 0 : 2], &t.edge[t.long_left ? 2 : 0], t.y1, t.y2, to, index);
}

void soft_detail_of(const soft_item *item, uint32_t index, soft_detail *out)
{
    const nacre_vertex *const v = &item->mesh->vertices[index];
    int i;

    for (i = 0; i < 3; i++) {
        const int32_t *const m = item->camera.tangent[i];

        out->tangent[i] = (int16_t)((m[0] * v->tangent[0] + m[1] * v->tangent[1] + m[2] * v->tangent[2]) >> 8);
    }
    out->handed = (int16_t)((v->tangent[3] < 0) != item->camera.mirrored ? -1 : 1);
    out->uv[0] = v->uv[0];
    out->uv[1] = v->uv[1];
}
