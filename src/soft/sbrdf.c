/* SPDX-License-Identifier: MIT */
/* Pixels of materials that vary over the surface: texels of two levels, then light. No scratch could hold what such a pixel
   needs until its row is shaded, so they are shaded where they are rasterised. */
#include "eval_inner.h"
#include "soft.h"

/* Albedo and lobes of one level; share as of soft_sample. */
static void sample_level(const soft_item *item, unsigned level, int32_t u, int32_t v, int32_t share,
                         shade_sbrdf_codes out)
{
    const nacre_image *const image = item->albedo;
    soft_texture t;

    t.width = (uint16_t)(image->width >> level ? image->width >> level : 1);
    t.height = (uint16_t)(image->height >> level ? image->height >> level : 1);
    t.channels = 4;
    t.flags = item->texture_flags;
    t.texels = image->bytes + image->level_offset[level];
    soft_sample(&t, 1, u, v, share, out);
    t.texels = item->lobes->bytes + item->lobes->level_offset[level];
    soft_sample(&t, item->lobes->layers, u, v, share, out + 1);
}

/* log2 of the texels of level 0 that a pixel steps over, q12, within what levels there are. */
static int32_t level_of(const soft_item *item, uint32_t rate_q27)
{
    const uint32_t width = item->albedo->width, height = item->albedo->height;
    const uint64_t texels = (uint64_t)rate_q27 * (width > height ? width : height) >> 15; /* q12 */
    const int32_t last = (item->albedo->levels - 1) * 4096;

    if (texels <= 4096) return 0;
    return eval_least(texels >> 31 ? last : eval_log2((uint32_t)texels) - 12 * 4096, last);
}

void soft_sbrdf_sample(const soft_item *item, int32_t u_q27, int32_t v_q27, uint32_t rate_q27, shade_sbrdf_codes out)
{
    const int nearest = (item->texture_flags & SOFT_NEAREST) != 0;
    const int32_t lod = level_of(item, rate_q27) + (nearest ? 2048 : 0), part = lod & 4095;
    const unsigned level = (unsigned)lod >> 12;

    sample_level(item, level, u_q27, v_q27, 0, out);
    if (!nearest && part >> 4) sample_level(item, level + 1, u_q27, v_q27, part >> 4, out);
}

FX_APART static void set_point(shade_sbrdf_point *out, const soft_item *item, const soft_pixels *from, uint32_t at,
                               int32_t x, int32_t y)
{
    int32_t *const position[3] = {&out->position_q16[0], &out->position_q16[1], &out->position_q16[2]};
    uint32_t eye_xy = 0;
    int16_t eye_z = 16384;

    if (item->persp) soft_lens_look(item, x, y, from->depth + at, 1, position, &eye_xy, &eye_z);
    out->normal[0] = shade_x_of(from->xy[at]);
    out->normal[1] = shade_y_of(from->xy[at]);
    out->normal[2] = from->z[at];
    out->to_eye[0] = shade_x_of(eye_xy);
    out->to_eye[1] = shade_y_of(eye_xy);
    out->to_eye[2] = eye_z;
}

void soft_sbrdf_put(const soft_item *item, const int16_t tangent[3], int mirrored, shade_sbrdf_codes codes,
                    int32_t alpha, const soft_pixels *to, int32_t x, int32_t y)
{
    const uint32_t at = (uint32_t)((y - to->row0) * to->stride + x);
    uint32_t radiance[3], code;
    const shade_rgb sum = {&radiance[0], &radiance[1], &radiance[2]};
    shade_sbrdf_point point;
    int i;

    set_point(&point, item, to, at, x, y);
    for (i = 0; i < 3; i++) point.tangent[i] = tangent[i];
    point.mirrored = mirrored;
    shade_sbrdf_shade(item->sbrdf, item->sbrdf_light, item->lights, codes, &point, radiance);
    shade_encode(sum, 1, (nacre_output)item->output, &code);
    code = (code & 0xFFFFFFu) | (uint32_t)((alpha + 32768) >> 16) << 24;
    to->xy[at] = code == SOFT_EMPTY ? code + 1 : code;
}
