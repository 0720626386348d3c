/* SPDX-License-Identifier: MIT */
/* The object in the caller's block. */
#include "soft.h"

#include <string.h>

const nacre_soft_kernels nacre_soft_portable = {
    soft_draw,
    shade_normalise,
    SHADE_HAS_TABLES ? shade_table_add : 0,
    SHADE_HAS_TABLES ? shade_table_code : 0,
    SHADE_HAS_TABLES || SHADE_HAS_SPHERES ? shade_encode : 0,
    soft_lit,
    0,
};

static nacre_soft_desc with_defaults(const nacre_soft_desc *desc)
{
    nacre_soft_desc d = *desc;

    if (!d.band_rows) d.band_rows = 8;
    if (!d.max_items) d.max_items = 1;
    if (!d.max_lights) d.max_lights = 1;
    if (!d.table_columns) d.table_columns = 32;
    if (!d.kernels) d.kernels = &nacre_soft_portable;
    return d;
}

static int valid(const nacre_soft_desc *d)
{
    return d->width >= 1 && d->width <= 4096 && d->height >= 1 && d->height <= 4096 && d->format <= NACRE_SOFT_RGBA8 &&
           d->band_rows <= 4096 && d->max_vertices >= 1 && d->max_vertices <= 1u << 24 && d->max_triangles >= 1 &&
           d->max_triangles <= 1u << 24 && d->max_items <= 255 && d->max_lights <= NACRE_MAX_LIGHTS &&
           d->table_columns >= 2 && d->table_columns <= SHADE_EVAL_MAX_WIDTH;
}

static uint32_t band_count(const nacre_soft_desc *d)
{
    return ((uint32_t)d->height + d->band_rows - 1) * (uint32_t)(fx_div(1 << 24, d->band_rows) + 1) >> 24;
}

static size_t rounded(size_t bytes)
{
    return (bytes + 15) / 16 * 16;
}

size_t soft_light_bytes(const nacre_soft_desc *d)
{
    const size_t table = sizeof(shade_table_eval) + 4 * SHADE_TABLE_WORDS(d->table_columns, d->fine);
    const size_t near = sizeof(shade_table_persp) + sizeof(shade_persp_light);
    const size_t spheres = sizeof(shade_spheres_persp) + sizeof(shade_persp_light);
    const size_t sbrdf = sizeof(shade_sbrdf_eval) + sizeof(shade_sbrdf_eval_light);
    size_t most = spheres;

    if (table > most) most = table;
    if (near > most) most = near;
    return rounded(sbrdf > most ? sbrdf : most);
}

/* References: two a triangle; the room is the shade_frame's too, while preparing. */
static size_t reference_bytes(const nacre_soft_desc *d)
{
    const size_t bytes = (size_t)d->max_triangles * 2 * (d->max_triangles <= 65536 ? 2 : 4);

    return rounded(bytes > sizeof(shade_frame) ? bytes : sizeof(shade_frame));
}

size_t nacre_soft_size(const nacre_soft_desc *desc)
{
    nacre_soft_desc d;

    if (!desc) return 0;
    d = with_defaults(desc);
    if (!valid(&d)) return 0;
    return 16 + rounded(sizeof(nacre_soft)) + rounded(d.max_vertices * sizeof(soft_vertex)) + reference_bytes(&d) +
           rounded((band_count(&d) + 2) * sizeof(uint32_t)) + rounded(d.max_items * sizeof(soft_item)) +
           (size_t)d.max_items * d.max_lights * soft_light_bytes(&d);
}

nacre_result nacre_soft_init(nacre_soft **out, void *block, size_t size, const nacre_soft_desc *desc)
{
    uint8_t *at = block;
    nacre_soft *soft;

    if (!out || !block || !nacre_soft_size(desc)) return NACRE_ERR_ARGUMENT;
    if (size < nacre_soft_size(desc)) return NACRE_ERR_MEMORY;
    at += (16 - ((uintptr_t)at & 15)) & 15;
    soft = (nacre_soft *)(void *)at;
    memset(soft, 0, sizeof *soft);
    soft->desc = with_defaults(desc);
    soft->bands = band_count(&soft->desc);
    soft->band_inverse = (uint32_t)fx_div(1 << 24, soft->desc.band_rows) + 1;
    at += rounded(sizeof *soft);
    soft->vertex = (soft_vertex *)(void *)at;
    at += rounded(soft->desc.max_vertices * sizeof(soft_vertex));
    soft->reference = at;
    soft->frame = (shade_frame *)(void *)at;
    soft->reference_room = (uint32_t)(reference_bytes(&soft->desc) /
                                      (soft->desc.max_triangles <= 65536 ? sizeof(uint16_t) : sizeof(uint32_t)));
    at += reference_bytes(&soft->desc);
    soft->band_begin = (uint32_t *)(void *)at;
    at += rounded((soft->bands + 2) * sizeof(uint32_t));
    soft->item = (soft_item *)(void *)at;
    at += rounded(soft->desc.max_items * sizeof(soft_item));
    soft->light_room = at;
    nacre_soft_scissor(soft, 0, 0, soft->desc.width, soft->desc.height);
    *out = soft;
    return NACRE_OK;
}

void nacre_soft_clear_color(nacre_soft *soft, uint32_t rgba)
{
    if (soft) soft->clear = rgba;
}

static int32_t held(int x, int32_t most)
{
    return x < 0 ? 0 : x > most ? most : x;
}

void nacre_soft_scissor(nacre_soft *soft, int x0, int y0, int x1, int y1)
{
    if (!soft) return;
    soft->scissor[0] = held(x0, soft->desc.width);
    soft->scissor[1] = held(y0, soft->desc.height);
    soft->scissor[2] = held(x1, soft->desc.width);
    soft->scissor[3] = held(y1, soft->desc.height);
}
