/* SPDX-License-Identifier: MIT */
/* Sphere images without the cosine, whole or quarters, per unit normal (shaders_gles/spheres.glsl): bilinear, level 0. */
#include "eval_image.h"

#include <string.h>

#define CODE_LOG2_Q16 740 /* log2(32768 / 32640) twice, as texels of 255 are 32640 here */

static void to_q15(int16_t out[3], const int32_t row_q28[3], int sign)
{
    int i;

    for (i = 0; i < 3; i++) out[i] = (int16_t)(sign * (int32_t)fx_shift(row_q28[i], 13));
}

/* From the light's set-up: where in which images. */
static void set_whole(shade_spheres_eval *out, const shade_spheres_setup *setup, const uint8_t *const layers[])
{
    int i;

    for (i = 0; i < 2; i++) {
        out->image[i] = layers[setup->layer[i]];
        to_q15(out->x[i], setup->x_q28[i], 1);
    }
    to_q15(out->y, setup->y_q28, -1); /* rows run downwards */
    to_q15(out->rim, setup->rim_q28, 1);
    out->weight = (int16_t)eval_least((int32_t)fx_shift(setup->weight_q28, 13), 32767);
}

static void set_quarters(shade_spheres_eval *out, const shade_quarter_setup *setup, const uint8_t *const layers[],
                         unsigned size)
{
    out->image[0] = layers[setup->layer];
    out->image[1] = layers[setup->layer + 1];
    to_q15(out->x[0], setup->x_q28, 1);
    to_q15(out->y, setup->y_q28, 1);
    out->weight = (int16_t)eval_least((int32_t)fx_shift(setup->weight_q28, 13), 32767);
    out->texels_per_log2 = shade_quarter_texels(size);
}

int shade_spheres_eval_prepare(shade_spheres_eval *out, const shade_light *light, const shade_material *material,
                               const uint8_t *const layers[], unsigned size, unsigned texel_bytes)
{
    const int quarters = material->is.spheres.size != 0;
    const int32_t *const l = quarters ? light->is.quarter.to_light_q28 : light->is.spheres.to_light_q28;
    shade_spheres_eval eval;
    int64_t log2_of[3], most = FX_LOG2_ZERO;
    int i;

    if (material->is.spheres.cosine) return 0;
    memset(&eval, 0, sizeof eval);
    if (quarters)
        set_quarters(&eval, &light->is.quarter, layers, size);
    else
        set_whole(&eval, &light->is.spheres, layers);
    eval.to_light_xy = shade_pack_xy(shade_eval_q14(l[0]), shade_eval_q14(l[1]));
    eval.to_light_z = shade_eval_q14(l[2]);
    eval.size = (uint16_t)size;
    eval.texel_bytes = (uint8_t)texel_bytes;
    for (i = 0; i < 3; i++) {
        log2_of[i] = fx_real_log2_q16(light->linear[i]);
        if (log2_of[i] > most) most = log2_of[i];
    }
    eval.dark = most <= FX_LOG2_ZERO;
    for (i = 0; i < 3; i++)
        eval.part[i] = log2_of[i] <= FX_LOG2_ZERO
                           ? 0
                           : (int16_t)eval_least(fx_real_fixed(fx_real_exp2((log2_of[i] - most) / 2), 15), 32767);
    /* the root squared is q15 here, not q14 */
    shade_eval_gain(fx_shift(most - 2 * 65536, 1) - 65536 + CODE_LOG2_Q16, &eval.gain, &eval.shift);
    *out = eval;
    return 1;
}

static inline int32_t dot(const eval_surface *n, const int16_t row[3])
{
    return n->x * row[0] + n->y * row[1] + n->z * row[2];
}

static inline void add_pixel(const shade_spheres_eval *e, const eval_surface *n, int32_t nl, uint32_t *const out[3])
{
    const uint32_t texel = e->texel_bytes, stride = texel * e->size;
    const int32_t cosine = eval_mul_q15(eval_pow24(eval_root48(nl >> 5)), e->gain);
    int32_t root[2][3];
    int i;

    if (e->texels_per_log2) {
        const image_place x = image_quarter(dot(n, e->x[0]), e->texels_per_log2, e->size, texel);
        const image_place y = image_quarter(dot(n, e->y), e->texels_per_log2, e->size, stride);

        image_sample(e->image[0], x, y, root[0]);
        image_sample(e->image[1], x, y, root[1]);
    } else {
        const int32_t depth = dot(n, e->rim);
        const image_place y = image_whole(dot(n, e->y), e->size, stride);

        image_sample(e->image[0], image_whole(dot(n, e->x[0]), e->size, texel), y, root[0]);
        image_sample(e->image[1], image_whole(dot(n, e->x[1]) + (depth > 0 ? depth : 0), e->size, texel), y, root[1]);
    }
    for (i = 0; i < 3; i++) {
        const int32_t value = image_mix(root[0][i], root[1][i], e->weight);

        *out[i] += eval_square(eval_product(eval_mul_q15(eval_mul_q15(value, value), e->part[i]), cosine, e->shift));
    }
}

void shade_spheres_add(const shade_spheres_eval *eval, const uint32_t *xy, const int16_t *z, int count,
                       shade_rgb radiance)
{
    int i;

    if (eval->dark) return;
    for (i = 0; i < count; i++) {
        const eval_surface n = eval_surface_of(xy[i], z[i]);
        const int32_t nl = eval_dot(&n, eval->to_light_xy, eval->to_light_z);
        uint32_t *const out[3] = {radiance.r + i, radiance.g + i, radiance.b + i};

        if (nl > 0) add_pixel(eval, &n, nl, out);
    }
}
