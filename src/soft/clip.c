/* SPDX-License-Identifier: MIT */
/* Triangles that leave the frustum: Sutherland and Hodgman 1974, in homogeneous coordinates. */
#include "soft.h"

typedef struct corner {
    int32_t clip[4];
    int16_t normal[3];
    soft_detail detail;
} corner;

enum { PLANES = 7 };

/* Not below 0 inside. The last one keeps w positive whatever the matrix is. */
static int64_t distance(const int32_t clip[4], int plane)
{
    const int64_t w = clip[3];

    switch (plane) {
    case 0:
        return w + clip[2];
    case 1:
        return w - clip[2];
    case 2:
        return 4 * w + clip[0];
    case 3:
        return 4 * w - clip[0];
    case 4:
        return 4 * w + clip[1];
    case 5:
        return 4 * w - clip[1];
    default:
        return w - 16;
    }
}

static int16_t between(int16_t a, int16_t b, int64_t part_q30)
{
    return (int16_t)(a + fx_shift((int64_t)(b - a) * part_q30, 30));
}

/* Where the way from inside to outside meets the plane: from the same end for both triangles at an edge. */
static void cross(corner *out, const corner *in, const corner *beyond, int64_t d_in, int64_t d_beyond)
{
    const int64_t all = d_in - d_beyond; /* > 0 */
    const int down = all >> 32 ? fx_top_bit((uint64_t)all) - 31 : 0;
    const int64_t part_q30 = fx_div((d_in >> down) * ((int64_t)1 << 30), all >> down);
    int i;

    for (i = 0; i < 4; i++)
        out->clip[i] = in->clip[i] + (int32_t)fx_shift(((int64_t)beyond->clip[i] - in->clip[i]) * part_q30, 30);
    for (i = 0; i < 3; i++) {
        out->normal[i] = between(in->normal[i], beyond->normal[i], part_q30);
        out->detail.tangent[i] = between(in->detail.tangent[i], beyond->detail.tangent[i], part_q30);
    }
    for (i = 0; i < 2; i++) out->detail.uv[i] = between(in->detail.uv[i], beyond->detail.uv[i], part_q30);
    out->detail.handed = in->detail.handed;
}

/* In place. A convex polygon gains one corner at most, which is written after the next one has been read; where rounding has
   bent it, one may be lost. */
static int clip_plane(corner *polygon, int count, int plane)
{
    const corner first = polygon[0];
    corner from = first, to;
    int64_t d_from = distance(from.clip, plane), d_to;
    int i, kept = 0;

    for (i = 0; i < count; i++) {
        to = i + 1 < count ? polygon[i + 1] : first;
        d_to = distance(to.clip, plane);
        if (d_from >= 0) polygon[kept++] = from;
        if (d_from >= 0 && d_to < 0 && kept < i + 2) cross(&polygon[kept++], &from, &to, d_from, d_to);
        if (d_from < 0 && d_to >= 0 && kept < i + 2) cross(&polygon[kept++], &to, &from, d_to, d_from);
        from = to;
        d_from = d_to;
    }
    return kept;
}

int soft_clip(const nacre_soft *soft, const soft_item *item, const uint32_t index[3],
              soft_vertex out[SOFT_MOST_CORNERS], soft_detail detail[SOFT_MOST_CORNERS])
{
    corner polygon[SOFT_MOST_CORNERS + 1];
    int i, k, plane, count = 3;

    for (i = 0; i < 3; i++) {
        corner *const c = &polygon[i];
        const soft_vertex *const v = &soft->vertex[item->first_vertex + index[i]];

        soft_clip_position(&item->camera, item->mesh->vertices[index[i]].position, c->clip);
        for (k = 0; k < 3; k++) c->normal[k] = v->normal[k];
        if (SHADE_HAS_MAPS) soft_detail_of(item, index[i], &c->detail);
    }
    for (plane = 0; plane < PLANES && count; plane++) count = clip_plane(polygon, count, plane);
    if (count > SOFT_MOST_CORNERS) count = SOFT_MOST_CORNERS;
    for (i = 0; i < count; i++) {
        const corner *const c = &polygon[i];

        soft_project(soft, &item->camera, c->clip, &out[i]);
        for (k = 0; k < 3; k++) out[i].normal[k] = c->normal[k];
        detail[i] = c->detail;
    }
    return count;
}
