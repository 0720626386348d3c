/* SPDX-License-Identifier: MIT */
#include "shade.h"

/* v = (1 - B) s + B s^2: both coefficients in q28. */
static void row_curve(const shade_table *table, int64_t *linear, int64_t *square)
{
    *square = (int64_t)table->rows * 4096;
    *linear = FX_Q28_ONE - *square;
}

int32_t shade_table_log2(const shade_table *table)
{
    /* p log2 Ymax; p and the logarithm are q16 */
    const int64_t power = fx_shift((int64_t)table->p * fx_log2_q16(table->ymax), 16);

    return (int32_t)(power - fx_log2_q16(table->e) - SHADE_LOG2_PI_Q16);
}

/* v' = (v (texels - 1) + 1/2 + guard) / of: the first and last texel's centres are v = 0 and 1. */
static int64_t end_aligned(int64_t v_q28, unsigned texels, unsigned guard, unsigned of)
{
    return fx_div(v_q28 * ((int64_t)texels - 1) + FX_Q28_ONE / 2 + guard * (int64_t)FX_Q28_ONE, of);
}

void shade_table_light(shade_table_setup *out, const shade_incoming *in, const shade_table *table)
{
    const int32_t *l = in->to_light_q28;
    const int64_t twice_lh = 2 * (int64_t)in->l_dot_h_q28, away = shade_away(in);
    const int64_t s = fx_isqrt((uint64_t)away << 28);
    int64_t linear, square;
    int i;

    row_curve(table, &linear, &square);
    for (i = 0; i < 3; i++) {
        const int32_t v = i == 2 ? FX_Q28_ONE : 0;

        out->to_light_q28[i] = l[i];
        out->half_q28[i] = in->lost ? v : (int32_t)fx_div(((int64_t)l[i] + v) * FX_Q28_ONE, twice_lh);
    }
    shade_own_frame(out->own_turn_q28, &out->sin_q28, &out->cos_q28, in);
    out->row_q28 = (int32_t)end_aligned(fx_shift(linear * s + square * away, 28), table->height, table->image_guard,
                                        table->image_height);
}

/* To the nearest number that fp16 holds. */
static int64_t to_half(int64_t x)
{
    const int shift = fx_top_bit((uint64_t)x) - 10;

    return shift > 0 ? fx_shift(x, shift) * ((int64_t)1 << shift) : x;
}

/* The coordinate's scale and bias as numbers of fp16: rounded by the GPU, they would move highlights by up to 1/80 texel.
   Of the two scales around the exact one, the one whose best bias comes nearest in the middle of the table. */
static void set_coordinate(shade_table_draw *out, int64_t scale_q28, int64_t bias_q28, int64_t middle_q16)
{
    const int shift = fx_top_bit((uint64_t)scale_q28) - 10;
    int64_t least = FX_Q28_ONE;
    int i;

    for (i = 0; i < 2; i++) {
        const int64_t scale = ((scale_q28 >> shift) + i) * ((int64_t)1 << shift);
        const int64_t wanted = bias_q28 + fx_shift((scale_q28 - scale) * middle_q16, 16);
        const int64_t bias = to_half(wanted), off = bias < wanted ? wanted - bias : bias - wanted;

        if (off >= least) continue;
        least = off;
        out->scale = fx_real_make(scale, -28);
        out->bias = fx_real_make(bias, -28);
    }
}

void shade_table_prepare(shade_table_draw *out, const shade_table *table, int early)
{
    const int64_t width = table->image_width, height = table->image_height;
    const int32_t log2_eps = fx_log2_q16(table->eps);
    const int64_t range = fx_log2_u64((uint64_t)table->eps + 65536) - 16 * 65536 - log2_eps; /* log2(1 / eps + 1) */
    const int64_t scale_q28 = fx_div((table->width - 1) * ((int64_t)1 << 44), width * range);
    int64_t linear, square;
    int i;

    set_coordinate(out, scale_q28,
                   fx_shift(scale_q28 * (-65536 - log2_eps), 16) +
                       end_aligned(0, table->width, table->image_guard, table->image_width),
                   65536 + log2_eps + range / 2);
    out->tile_q28[0] = (int32_t)end_aligned(FX_Q28_ONE, table->width, table->image_guard, table->image_width);
    out->tile_q28[1] = (int32_t)fx_div((table->height + 3) * (int64_t)FX_Q28_ONE, height);
    out->two_eps = fx_real_make(table->eps, -15);
    out->root_two_eps = fx_real_make(fx_isqrt((uint64_t)table->eps << 33), -24);
    out->phi_q16[0] = early ? table->k1 : table->w[0];
    out->phi_q16[1] = early ? table->k2 : table->w[1];
    out->phi_q16[2] = early ? 0 : table->w[2];
    for (i = 0; i < 3; i++) {
        out->d_q16[i] = table->d[i];
        out->v_q16[i] = table->v[i];
    }
    out->k2_q16 = table->k2;
    out->k4_q16 = table->k4;
    row_curve(table, &linear, &square);
    out->row_q28[0] = (int32_t)fx_div(linear * (table->height - 1), height);
    out->row_q28[1] = (int32_t)fx_div(square * (table->height - 1), height);
    out->row_q28[2] = (int32_t)end_aligned(0, table->height, table->image_guard, table->image_height);
}
