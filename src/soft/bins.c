/* SPDX-License-Identifier: MIT */
/* Triangles into bands: counted, then listed band after band in their order. */
#include "soft.h"

#include <string.h>

static uint32_t get(const nacre_soft *soft, uint32_t i)
{
    return soft->desc.max_triangles <= 65536 ? ((const uint16_t *)soft->reference)[i]
                                             : ((const uint32_t *)soft->reference)[i];
}

static void put(nacre_soft *soft, uint32_t i, uint32_t number)
{
    if (soft->desc.max_triangles <= 65536)
        ((uint16_t *)soft->reference)[i] = (uint16_t)number;
    else
        ((uint32_t *)soft->reference)[i] = number;
}

static void indices_of(const soft_item *item, uint32_t number, uint32_t index[3])
{
    const uint16_t *const at = item->mesh->indices + 3 * (number - item->first_triangle);

    index[0] = at[0];
    index[1] = at[1];
    index[2] = at[2];
}

/* Bands that a triangle touches. */
static int bands_of(const nacre_soft *soft, const soft_item *item, uint32_t number, uint32_t *first, uint32_t *last)
{
    const soft_vertex *const v = soft->vertex + item->first_vertex;
    uint32_t index[3];
    int32_t y0 = 0, y1 = soft->desc.height;

    indices_of(item, number, index);
    if (v[index[0]].z == SOFT_OUTSIDE || v[index[1]].z == SOFT_OUTSIDE || v[index[2]].z == SOFT_OUTSIDE) {
        *first = 0;
        *last = soft->bands - 1;
        return 1;
    }
    if (!soft_triangle_rows(&v[index[0]], &v[index[1]], &v[index[2]], item->cull, soft->desc.height, &y0, &y1))
        return 0;
    *first = soft_band_of(soft, y0);
    *last = soft_band_of(soft, y1 - 1);
    return 1;
}

/* count 1: count references of every band into band_begin[band + 2]; 0: place them from band_begin[band + 1] on, which
   leaves it at the next band's begin. */
static void each_reference(nacre_soft *soft, int count)
{
    uint32_t i, n, first, last;

    for (i = 0; i < soft->item_count; i++) {
        const soft_item *const item = &soft->item[i];

        for (n = item->first_triangle; n < item->first_triangle + item->triangle_count; n++) {
            if (!bands_of(soft, item, n, &first, &last)) continue;
            for (; first <= last; first++) {
                if (count)
                    soft->band_begin[first + 2]++;
                else
                    put(soft, soft->band_begin[first + 1]++, n);
            }
        }
    }
}

void soft_sort(nacre_soft *soft)
{
    uint32_t *const begin = soft->band_begin;
    uint32_t i;

    soft->sorted = 0;
    if (soft->bands == 1) return; /* one band looks at all */
    memset(begin, 0, (soft->bands + 2) * sizeof *begin);
    each_reference(soft, 1);
    for (i = 0; i < soft->bands; i++) begin[i + 2] += begin[i + 1];
    soft->sorted = begin[soft->bands + 1] <= soft->reference_room;
    if (soft->sorted) each_reference(soft, 0);
}

void soft_each_triangle(const nacre_soft *soft, uint32_t band, soft_each *each, void *user)
{
    const uint32_t begin = soft->sorted ? soft->band_begin[band] : 0;
    const uint32_t end = soft->sorted ? soft->band_begin[band + 1] : soft->triangle_count;
    uint32_t i, index[3];
    unsigned at = 0;

    for (i = begin; i < end; i++) {
        const uint32_t number = soft->sorted ? get(soft, i) : i;

        while (number >= soft->item[at].first_triangle + soft->item[at].triangle_count) at++;
        indices_of(&soft->item[at], number, index);
        each(user, &soft->item[at], at, index);
    }
}
