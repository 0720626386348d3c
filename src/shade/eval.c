/* SPDX-License-Identifier: MIT */
/* What every model's evaluator needs: unit normals, sums of radiance, codes. */
#include "eval_inner.h"

void shade_eval_gain(int64_t log2_q16, int16_t *gain, uint8_t *shift)
{
    const int64_t whole = (log2_q16 >> 16) + 1, left = 14 - whole;

    *gain = (int16_t)eval_least(fx_real_fixed(fx_real_exp2(log2_q16 - whole * 65536), 15), 32767);
    *shift = (uint8_t)(left < 0 ? 0 : left > 30 ? 30 : left);
}

int16_t shade_eval_q14(int32_t x_q28)
{
    const int64_t x = fx_shift(x_q28, 14);

    return (int16_t)(x > 16384 ? 16384 : x < -16384 ? -16384 : x);
}

void shade_normalise(uint32_t *xy, int16_t *z, int count)
{
    int i;

    for (i = 0; i < count; i++) {
        const eval_surface n = eval_unit(xy[i], z[i]);

        xy[i] = shade_pack_xy(n.x, n.y);
        z[i] = (int16_t)n.z;
    }
}

void shade_rgb_fill(shade_rgb radiance, int count, const fx_real ambient[3])
{
    const uint32_t r = ambient ? (uint32_t)fx_real_fixed(ambient[0], 16) : 0;
    const uint32_t g = ambient ? (uint32_t)fx_real_fixed(ambient[1], 16) : 0;
    const uint32_t b = ambient ? (uint32_t)fx_real_fixed(ambient[2], 16) : 0;
    int i;

    for (i = 0; i < count; i++) {
        radiance.r[i] = r;
        radiance.g[i] = g;
        radiance.b[i] = b;
    }
}

static uint32_t srgb_code(uint32_t radiance)
{
    const eval_split s = eval_split_of(radiance < 8 ? 8 : radiance > 65536 ? 65536 : radiance);
    const int32_t code = eval_between(shade_lut_srgb[eval_node(s, 3) - 24], eval_fraction(s, 3));

    return (uint32_t)((code >> 16) + 64) >> 7;
}

/* Square root by bits; for outputs that are seldom asked for. */
static uint32_t other_code(uint32_t radiance, nacre_output output)
{
    const uint32_t l = radiance > 65536 ? 65536 : radiance;

    return (output == NACRE_OUTPUT_SQRT ? fx_isqrt((uint64_t)l << 16) * 255 + 32768 : l * 255 + 32768) >> 16;
}

void shade_encode(shade_rgb radiance, int count, nacre_output output, uint32_t *rgba)
{
    int i;

    if (output != NACRE_OUTPUT_SRGB) {
        for (i = 0; i < count; i++)
            rgba[i] = 255u << 24 | other_code(radiance.b[i], output) << 16 | other_code(radiance.g[i], output) << 8 |
                      other_code(radiance.r[i], output);
        return;
    }
    for (i = 0; i < count; i++)
        rgba[i] =
            255u << 24 | srgb_code(radiance.b[i]) << 16 | srgb_code(radiance.g[i]) << 8 | srgb_code(radiance.r[i]);
}
