/* SPDX-License-Identifier: MIT */
/* Half-vector tables per unit normal: TABLE of include/nacre_asset.h for a distant viewer. */
#include "eval_inner.h"

#define LOG2_CODE_ROOT_Q16 (-30422) /* log2(sqrt(255 1.055 2^21) / 32768) */
#define MOST_OCTAVES       (13 * 65536)

/* ---- one light --------------------------------------------------------------------------------------------------- */

#define HALF_CODE_Q15 (127 * 32768 + 16384) /* 127.5 */

/* One channel of the two rows around a light's l.h. */
typedef struct channel {
    const uint8_t *row[2]; /* its first texel in either */
    int32_t weight_q15;    /* of row[1] */
    int32_t zero_q15;      /* code that stands for 0 */
    int64_t factor_q30;    /* what 255 codes are worth */
} channel;

static channel channel_of(const shade_table *table, int32_t row_q28, const uint8_t *texels, unsigned index,
                          int32_t zero_q15, int64_t factor_q30)
{
    const int64_t at = (int64_t)row_q28 * table->height - FX_Q28_ONE / 2;
    int64_t first = at < 0 ? 0 : at >> 28;
    channel out;

    out.weight_q15 = at < 0 ? 0 : (int32_t)(at >> 13 & 32767);
    if (first >= table->height - 1) {
        first = table->height - 1;
        out.weight_q15 = 0;
    }
    out.row[0] = texels + first * table->width * 4 + index;
    out.row[1] = first + 1 < table->height ? out.row[0] + table->width * 4 : out.row[0];
    out.zero_q15 = zero_q15;
    out.factor_q30 = factor_q30;
    return out;
}

/* Sum of (blended code - zero) / 255 x factor, q13. */
static int32_t value_of(const channel *of, int count, unsigned column)
{
    int64_t value = 0;
    int i;

    for (i = 0; i < count; i++) {
        const int64_t code = (int64_t)of[i].row[0][4 * column] * (32768 - of[i].weight_q15) +
                             (int64_t)of[i].row[1][4 * column] * of[i].weight_q15 - of[i].zero_q15;

        value += fx_shift(fx_shift(code * 8421505, 16) * fx_shift(of[i].factor_q30, 15), 32); /* 2^31 / 255 */
    }
    return (int32_t)(value < -8191 ? -8191 : value > 8191 ? 8191 : value);
}

static void set_column(uint32_t *columns, unsigned stride, unsigned width, const channel *of, int count)
{
    int32_t next = value_of(of, count, 0);
    unsigned i;

    for (i = 0; i < width; i++) {
        const int32_t value = next;

        if (i + 1 < width) next = value_of(of, count, i + 1);
        columns[i * stride] = (uint32_t)value << 16 | ((uint32_t)(2 * (next - value)) & 65535u);
    }
}

static int64_t largest(const int64_t v[3])
{
    int64_t most = v[0] > v[1] ? v[0] : v[1];

    return v[2] > most ? v[2] : most;
}

/* Sets how the shared terms are spread over the channels: like v. Returns the largest. */
static int64_t spread(shade_table_eval *out, const int64_t v[3])
{
    const int64_t most = largest(v);
    int i;

    for (i = 0; i < 3; i++)
        out->phi[i] = (int16_t)(most > 0 ? eval_least((int32_t)fx_div(v[i] * 32768, most), 32767) : 0);
    return most;
}

static int64_t times_q16(int64_t a, nacre_q16 b)
{
    return fx_shift(a * b, 16);
}

/* Fine tier: base + A D, coefficients of a^2 by channel, |a|, a^4. */
static void set_columns_fine(shade_table_eval *out, uint32_t *columns, int32_t row_q28, const shade_table *table,
                             const int64_t part_q30[3], const uint8_t *const texels[2])
{
    const int64_t most = spread(out, part_q30);
    channel of[2];
    unsigned i;

    for (i = 0; i < 3; i++) {
        of[0] = channel_of(table, row_q28, texels[0], i, 0, part_q30[i]);
        of[1] = channel_of(table, row_q28, texels[0], 3, 0, times_q16(part_q30[i], table->d[i]));
        set_column(columns + i, 8, table->width, of, 2);
        of[0] = channel_of(table, row_q28, texels[1], 0, HALF_CODE_Q15, times_q16(part_q30[i], table->w[i]));
        of[1] = channel_of(table, row_q28, texels[1], 1, HALF_CODE_Q15, times_q16(part_q30[i], table->v[i]));
        set_column(columns + 4 + i, 8, table->width, of, 2);
    }
    of[0] = channel_of(table, row_q28, texels[1], 2, HALF_CODE_Q15, times_q16(most, table->k2));
    set_column(columns + 3, 8, table->width, of, 1);
    of[0] = channel_of(table, row_q28, texels[1], 3, HALF_CODE_Q15, times_q16(most, table->k4));
    set_column(columns + 7, 8, table->width, of, 1);
}

/* One layer, or two of the early fine tier. */
static void set_columns(shade_table_eval *out, uint32_t *columns, int32_t row_q28, const shade_table *table,
                        const int64_t part_q30[3], const uint8_t *const texels[2])
{
    const unsigned stride = SHADE_HAS_FINE && out->fine ? 8 : 4, width = table->width;
    int64_t bend_q30[3], most;
    channel of;
    unsigned i;

    for (i = 0; i < 3; i++) {
        of = channel_of(table, row_q28, texels[0], i, 0, part_q30[i]);
        set_column(columns + i, stride, width, &of, 1);
        bend_q30[i] = times_q16(part_q30[i], SHADE_HAS_FINE && out->fine ? table->k2 : table->w[i]);
    }
    most = spread(out, bend_q30);
    of = channel_of(table, row_q28, texels[0], 3, HALF_CODE_Q15, stride == 4 ? most / 4 : most);
    set_column(columns + 3, stride, width, &of, 1);
    for (i = 0; i < 4 && SHADE_HAS_FINE && out->fine; i++) {
        of = channel_of(table, row_q28, texels[1], i, HALF_CODE_Q15, i < 3 ? times_q16(part_q30[i], table->k1) : 0);
        set_column(columns + 4 + i, stride, width, &of, 1);
    }
}

int64_t shade_table_most_root(const shade_material *material)
{
    const shade_table *const table = &material->is.table;
    int64_t most = 65536;
    int i;

    if (!shade_is_fine(material) || material->early) return most;
    if (table->k4 / 2 > most) most = table->k4 / 2;
    if (table->k2 / 2 > most) most = table->k2 / 2;
    for (i = 0; i < 3; i++) {
        const int64_t w = table->w[i] < 0 ? -(int64_t)table->w[i] : table->w[i],
                      v = table->v[i] < 0 ? -(int64_t)table->v[i] : table->v[i];

        if (65536 + (int64_t)table->d[i] > most) most = 65536 + (int64_t)table->d[i];
        if ((w + v) / 2 > most) most = (w + v) / 2;
    }
    return most;
}

/* Halvings that bring everything in a table's columns below 1. */
static int halvings(const shade_material *material)
{
    const int64_t most = shade_table_most_root(material);
    int down = 0;

    while (most >> down > 65536) down++;
    return down;
}

/* u: 0 at n = h, (width - 1) at t = 1. */
int shade_eval_coordinate(shade_table_eval *out, const shade_table *table)
{
    const int64_t range = fx_log2_u64((uint64_t)table->eps + 65536) - fx_log2_u64((uint64_t)table->eps);
    const int64_t two_eps_q28 = (int64_t)table->eps << 13;
    int64_t scale_q11;

    if (range <= 0 || range > MOST_OCTAVES || table->width > SHADE_EVAL_MAX_WIDTH) return 0;
    scale_q11 = fx_div((int64_t)(table->width - 1) * 65536 * 2048, range);
    if (scale_q11 > 32767) return 0;
    out->scale = (int16_t)scale_q11;
    out->log_middle = eval_log2((uint32_t)(two_eps_q28 >> 7)) + (int32_t)(range >> 5);
    out->at_middle = -(int32_t)((-(range >> 5) * scale_q11) >> 8);
    out->last = ((int32_t)table->width - 1) * 32768 - 1;
    if (out->last < 0) out->last = 0;
    return 1;
}

static void set_directions(shade_table_eval *out, const shade_table_setup *setup, const shade_table *table)
{
    const int32_t hx = shade_eval_q14(setup->half_q28[0]), hy = shade_eval_q14(setup->half_q28[1]),
                  hz = shade_eval_q14(setup->half_q28[2]);
    const int64_t most = fx_shift((int64_t)setup->sin_q28 * setup->cos_q28, 41);

    out->to_light_xy = shade_pack_xy(shade_eval_q14(setup->to_light_q28[0]), shade_eval_q14(setup->to_light_q28[1]));
    out->to_light_z = shade_eval_q14(setup->to_light_q28[2]);
    out->half_xy = shade_pack_xy(hx <= -16384 ? 32767 : -2 * hx, hy <= -16384 ? 32767 : -2 * hy);
    out->half_z = (int16_t)(hz <= -16384 ? 32767 : -2 * hz);
    out->offset = hx * hx + hy * hy + hz * hz + (int32_t)((int64_t)table->eps << 13);
    out->limit = (int16_t)(most > 16383 ? 16383 : most);
}

int shade_table_eval_prepare(shade_table_eval *out, uint32_t *columns, const shade_light *light,
                             const shade_material *material, const uint8_t *const texels[2])
{
    const shade_table *const table = &material->is.table;
    shade_table_eval eval = {0};
    const int down = halvings(material);
    int64_t log2_of[3], part_q30[3], most = FX_LOG2_ZERO;
    int i;

    if (!shade_eval_coordinate(&eval, table)) return 0;
    eval.columns = columns;
    eval.fine = (uint8_t)shade_is_fine(material);
    eval.power4 = table->p == 4 * 65536;
    eval.toe = table->toe;
    for (i = 0; i < 3; i++) {
        log2_of[i] = fx_real_log2_q16(light->linear[i]);
        if (log2_of[i] > most) most = log2_of[i];
    }
    eval.dark = most <= FX_LOG2_ZERO;
    for (i = 0; i < 3; i++) {
        const int64_t below = log2_of[i] <= FX_LOG2_ZERO ? 2 * FX_LOG2_ZERO : (log2_of[i] - most) * 65536;

        part_q30[i] = (2 * (int64_t)fx_real_fixed(fx_real_exp2(fx_div(below, table->p)), 29)) >> down;
    }
    set_directions(&eval, &light->is.table, table);
    if (shade_is_fine(material) && !material->early)
        set_columns_fine(&eval, columns, light->is.table.row_q28, table, part_q30, texels);
    else
        set_columns(&eval, columns, light->is.table.row_q28, table, part_q30, texels);
    if (eval.power4) {
        shade_eval_gain(fx_shift(most - 2 * 65536, 1) + 2 * down * 65536, &eval.gain, &eval.shift);
    } else {
        shade_eval_gain(fx_div((most - 2 * 65536) * 5, 24) + down * 65536, &eval.gain, &eval.shift);
        shade_eval_gain(fx_div(most * 5, 24) + down * 65536 + LOG2_CODE_ROOT_Q16, &eval.gain_code, &eval.shift_code);
    }
    *out = eval;
    return 1;
}

int shade_table_has_code(const shade_table_eval *eval)
{
    return !eval->power4;
}

/* ---- pixels ------------------------------------------------------------------------------------------------------ */

/* Root of the light's radiance / 2, q15: (y (n.l)^(1/4.8) gain)^2.4, or y^2 (n.l)^(1/2) gain. */
EVAL_INLINE int32_t half_root(const shade_table_eval *e, int32_t y, int32_t cosine)
{
    if (e->power4) return eval_product(eval_least(y * y >> 14, 32767), cosine, e->shift);
    return eval_pow24(eval_product(y, cosine, e->shift));
}

EVAL_INLINE void add(const shade_table_eval *e, const uint32_t *xy, const int16_t *z, int count, shade_rgb radiance,
                     int fine)
{
    uint32_t *const to[3] = {radiance.r, radiance.g, radiance.b};
    int i, k;

    for (i = 0; i < count; i++) {
        const eval_surface n = eval_surface_of(xy[i], z[i]);
        const int32_t nl = eval_dot(&n, e->to_light_xy, e->to_light_z);
        eval_place at;
        int32_t cosine;

        if (nl <= 0) continue;
        cosine = eval_root48(nl >> 5);
        if (e->power4) cosine = eval_pow24(cosine);
        cosine = eval_mul_q15(cosine, e->gain);
        at = eval_place_of(e, &n, nl, fine);
        EVAL_CHANNELS(k) to[k][i] += eval_square(half_root(e, eval_root(e, &at, k, fine), cosine));
    }
}

void shade_table_add(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count, shade_rgb radiance)
{
    if (eval->dark) return;
    if (SHADE_HAS_FINE && eval->fine)
        add(eval, xy, z, count, radiance, 1);
    else
        add(eval, xy, z, count, radiance, 0);
}

/* y^2 (n.l)^(1/2.4) e - .055 = z^2 - .055, and the parabola that stands for the toe. */
EVAL_INLINE uint32_t code_of(int32_t root, int32_t cosine, int shift, int toe)
{
    const int32_t z = eval_least(root * cosine >> shift, 32767), square = z * z;
    int32_t code = square - SHADE_CODE_LOW + (1 << 20);

    if (toe && square < SHADE_CODE_TOE) {
        const int32_t below = eval_mul_q15(SHADE_TOE_PART, (SHADE_CODE_TOE - square) >> 14);

        code += 4 * below * below;
    }
    return (uint32_t)eval_clip(code >> 21, 255);
}

EVAL_INLINE void code(const shade_table_eval *e, const uint32_t *xy, const int16_t *z, int count, uint32_t *rgba,
                      int fine, int toe)
{
    int i, k;

    for (i = 0; i < count; i++) {
        const eval_surface n = eval_unit(xy[i], z[i]);
        const int32_t nl = eval_dot(&n, e->to_light_xy, e->to_light_z);
        uint32_t out = 255u << 24;

        if (nl > 0) {
            const int32_t cosine = eval_mul_q15(eval_root48(nl >> 5), e->gain_code);
            const eval_place at = eval_place_of(e, &n, nl, fine);

            EVAL_CHANNELS(k) out |= code_of(eval_root(e, &at, k, fine), cosine, e->shift_code, toe) << 8 * k;
        }
        rgba[i] = out;
    }
}

void shade_table_code(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count, uint32_t *rgba)
{
    int i;

    if (eval->dark)
        for (i = 0; i < count; i++) rgba[i] = 255u << 24;
    else if (eval->toe)
        code(eval, xy, z, count, rgba, SHADE_HAS_FINE && eval->fine, 1);
    else if (SHADE_HAS_FINE && eval->fine)
        code(eval, xy, z, count, rgba, 1, 0);
    else
        code(eval, xy, z, count, rgba, 0, 0);
}
