/* SPDX-License-Identifier: MIT */
/* Quartered sphere images (nacre_asset.h, NACRE_KEY_QUARTERS). */
#include "shade.h"

#define LOG2_9_Q28 850920263 /* log2(9) */
#define ROOT_2_Q28 379625062 /* sqrt(2) */
#define PLACES     3         /* log2(8 x + 1) = log2(x + 1/8) + 3 */

/* l.h is the cosine of half the angle: sqrt(2) sin(polar / 4). */
int32_t shade_quarter_step(const shade_spheres *spheres, int layer)
{
    return (int32_t)fx_shift((int64_t)ROOT_2_Q28 * fx_sin_q28((uint32_t)spheres->polar_bam[layer] << 14), 28);
}

void shade_quarter_light(shade_quarter_setup *out, const shade_incoming *in, const shade_spheres *spheres)
{
    const int64_t s = fx_isqrt((uint64_t)shade_away(in) << 28);
    int64_t low, high;
    int i, layer = 0;

    shade_own_frame(out->own_turn_q28, &out->sin_q28, &out->cos_q28, in);
    for (i = 0; i < 3; i++) {
        out->x_q28[i] = out->own_turn_q28[0][i];
        out->y_q28[i] = out->own_turn_q28[1][i];
        out->to_light_q28[i] = in->to_light_q28[i];
        out->root4[i] = fx_real_make(0, 0);
    }
    while (layer < spheres->layers - 2 && s >= shade_quarter_step(spheres, layer + 1)) layer++;
    low = shade_quarter_step(spheres, layer);
    high = shade_quarter_step(spheres, layer + 1);
    out->layer = (uint8_t)layer;
    out->weight_q28 = s <= low ? 0 : s >= high ? FX_Q28_ONE : (int32_t)fx_div((s - low) * FX_Q28_ONE, high - low);
}

int32_t shade_quarter_texels(unsigned size)
{
    /* 2^17 texels x 2^4 for log2(9), q12 */
    return (int32_t)fx_div((int64_t)(size - 1) * ((int64_t)1 << 37), LOG2_9_Q28);
}

void shade_quarter_prepare(shade_quarter_draw *out, const shade_spheres *spheres)
{
    const int64_t size = spheres->size, layers = spheres->layers;
    const int64_t scale = fx_div((size - 1) * ((int64_t)1 << 56), size * LOG2_9_Q28);
    const int64_t bias = PLACES * scale + fx_div(FX_Q28_ONE / 2, size);
    int i;

    out->scale_q28[0] = (int32_t)scale;
    out->scale_q28[1] = (int32_t)fx_div(scale, layers);
    out->bias_q28[0] = (int32_t)bias;
    out->bias_q28[1] = (int32_t)fx_div(bias, layers);
    out->step_q28 = (int32_t)fx_div(FX_Q28_ONE, layers);
    for (i = 0; i < SHADE_MAX_QUARTERS; i++) {
        int64_t low, range;

        out->ramp[i][0] = out->ramp[i][1] = fx_real_make(0, 0);
        if (i + 1 >= layers) continue;
        low = shade_quarter_step(spheres, i);
        range = shade_quarter_step(spheres, i + 1) - low;
        out->ramp[i][0] = fx_real_make(fx_div((int64_t)1 << 60, range), -32);
        out->ramp[i][1] = fx_real_make(-fx_div(low << 24, range), -24);
    }
}
