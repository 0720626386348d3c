/* SPDX-License-Identifier: MIT */
#include "eval_persp_inner.h"

/* ---- set-up --------------------------------------------------------------------------------------------------------- */

void shade_persp_light_prepare(shade_persp_light *out, const nacre_light *light, const shade_light *set,
                               int position_shift)
{
    int64_t more = 0;
    int i;

    out->point = light->type == NACRE_LIGHT_POINT;
    out->dark = 1;
    /* set->linear holds the light at the distance where |r| is 1 */
    if (out->point) more = -2 * ((int64_t)fx_real_log2_q16(set->position[3]) + position_shift * 65536);
    for (i = 0; i < 3; i++) {
        const int64_t log2_of = fx_real_log2_q16(set->linear[i]);

        out->place[i] = out->point ? light->position[i] : fx_real_fixed(set->position[i], 14);
        out->log2_q12[i] = log2_of <= FX_LOG2_ZERO ? -64 * 4096 : (int32_t)fx_shift(log2_of + more, 4);
        if (log2_of > FX_LOG2_ZERO) out->dark = 0;
    }
}

static int32_t to_q12(nacre_q16 x)
{
    return (int32_t)fx_shift(x < -64 * 65536 ? -64 * 65536 : x > 64 * 65536 ? 64 * 65536 : x, 4);
}

int shade_table_persp_prepare(shade_table_persp *out, const shade_table *table, int fine, int early,
                              const uint8_t *const texels[2])
{
    shade_table_eval coordinate;
    int i;

    if (!shade_eval_coordinate(&coordinate, table)) return 0;
    out->two_eps = (int32_t)((int64_t)table->eps << 13);
    out->log_middle = coordinate.log_middle;
    out->at_middle = coordinate.at_middle;
    out->last = coordinate.last;
    out->scale = coordinate.scale;
    out->width = table->width;
    out->height = table->height;
    out->p_q12 = table->p >> 4;
    out->fine = (uint8_t)fine;
    out->early = (uint8_t)early;
    out->rows_q15 = table->rows / 2;
    for (i = 0; i < 3; i++) {
        const nacre_q16 phi = early ? (i == 0 ? table->k1 : i == 1 ? table->k2 : 0) : table->w[i];

        out->phi_q12[i] = to_q12(phi);
        out->d_q12[i] = to_q12(table->d[i]);
        out->v_q12[i] = to_q12(table->v[i]);
    }
    out->k2_q12 = to_q12(table->k2);
    out->k4_q12 = to_q12(table->k4);
    for (i = 0; i < 2; i++) out->texels[i] = texels[i];
    return 1;
}

/* ---- numbers -------------------------------------------------------------------------------------------------------- */

void shade_reciprocal(uint32_t x, uint32_t *inverse, int *shift)
{
    const int zeros = fx_leading_zeros(x);
    const uint32_t m = x << zeros; /* 1..2 in q31 */
    const int32_t root =
        eval_between(shade_lut_inverse_root[m >> 27 & 15], (int32_t)(m >> 12 & 32767)) >> 16; /* 1/sqrt, q15 */
    const uint32_t first = (uint32_t)(root * root);                                           /* 1/m, q30 */
    const uint32_t product = (uint32_t)((uint64_t)first * m >> 31);                           /* near 1, q30 */

    *inverse = (uint32_t)((uint64_t)first * (0x80000000u - product) >> 30);
    *shift = 61 - zeros;
}

/* Any vector to q14, its largest part with 13 or 14 bits: the factor is 2^-shift. */
static int shorten(const int32_t v[3], int32_t out[3])
{
    uint32_t all = 1;
    int i, shift;

    for (i = 0; i < 3; i++) all |= (uint32_t)(v[i] < 0 ? -(int64_t)v[i] : v[i]);
    shift = 18 - fx_leading_zeros(all);
    for (i = 0; i < 3; i++) out[i] = shift > 0 ? v[i] >> shift : v[i] * (1 << -shift);
    return shift;
}

/* ---- one light ------------------------------------------------------------------------------------------------------ */

shade_arriving shade_arriving_of(const shade_persp_light *light, const shade_seen *seen, int i)
{
    shade_arriving in;
    int32_t r[3], v[3];
    int k, shift;

    if (!light->point) {
        in.l.x = light->place[0];
        in.l.y = light->place[1];
        in.l.z = light->place[2];
        in.log2_square = 0;
        return in;
    }
    for (k = 0; k < 3; k++) {
        const int64_t d = (int64_t)light->place[k] - seen->position[k][i];

        r[k] = (int32_t)(d > INT32_MAX ? INT32_MAX : d < -INT32_MAX ? -INT32_MAX : d);
    }
    shift = shorten(r, v);
    for (k = 0; k < 3; k++) v[k] >>= 1; /* |v| below 2^14 */
    in.l = eval_unit(shade_pack_xy(v[0], v[1]), v[2]);
    in.log2_square = eval_log2((uint32_t)(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) | 1) + 2 * (shift + 1 - 16) * 4096;
    return in;
}

shade_halfway shade_halfway_of(const eval_surface *l, const eval_surface *v)
{
    const int32_t x = (l->x + v->x) >> 1, y = (l->y + v->y) >> 1, z = (l->z + v->z) >> 1;
    shade_halfway out;
    int32_t dx, dy, dz, square, s;

    out.h = eval_unit(shade_pack_xy(x, y), z);
    out.l_dot_h = eval_dot_of(l, &out.h) >> 14;
    if (out.l_dot_h < 256) out.l_dot_h = 256;
    dx = l->x - out.h.x;
    dy = l->y - out.h.y;
    dz = l->z - out.h.z;
    square = dx * dx + dy * dy + dz * dz; /* 2 (1 - l.h), q28 */
    if (square > 1 << 29) square = 1 << 29;
    s = (int32_t)fx_isqrt((uint64_t)(uint32_t)square << 1); /* q15 */
    if (s > 32767) s = 32767;
    out.s = s;
    out.away = square >> 14;
    return out;
}

/* Codes x 128 of one layer: 4 channels. */
static void sample(const uint8_t *texels, uint32_t width, int32_t column, int32_t row, uint32_t next_row, int32_t fx,
                   int32_t fy, int32_t out[4])
{
    const uint8_t *const a = texels + 4 * ((uint32_t)row * width + (uint32_t)column);
    const uint8_t *const b = a + 4 * width * next_row;
    int i;

    for (i = 0; i < 4; i++) {
        const int32_t top = a[i] * 128 + ((a[i + 4] - a[i]) * 128 * fx >> 15);
        const int32_t low = b[i] * 128 + ((b[i + 4] - b[i]) * 128 * fx >> 15);

        out[i] = top + ((low - top) * fy >> 15);
    }
}

/* Roots y, codes x 128. a: n.l - n.v, q14. */
static void roots(const shade_table_persp *t, const eval_surface *n, const shade_halfway *m, int32_t a, int32_t out[3])
{
    const int32_t dx = n->x - m->h.x, dy = n->y - m->h.y, dz = n->z - m->h.z;
    const uint32_t distance = (uint32_t)(dx * dx) + (uint32_t)(dy * dy) + (uint32_t)(dz * dz) + (uint32_t)t->two_eps;
    const int32_t u = eval_least(((eval_log2(distance >> 7) - t->log_middle) * t->scale >> 8) + t->at_middle, t->last);
    const int32_t v = ((m->s * 32768 + t->rows_q15 * (m->away - m->s)) >> 15) * (t->height - 1),
                  row = eval_least(v >> 15, t->height - 1);
    const int32_t limit = eval_least(2 * m->l_dot_h, 16383), size = eval_least(a < 0 ? -a : a, limit);
    const int32_t square = size * size >> 13; /* q15 */
    int32_t base[4], curve[4];
    int i;

    sample(t->texels[0], t->width, u >> 15, row, row + 1 < t->height, u & 32767, v & 32767, base);
    if (t->fine) sample(t->texels[1], t->width, u >> 15, row, row + 1 < t->height, u & 32767, v & 32767, curve);
    if (t->fine && !t->early) {
        const int64_t linear = ((curve[2] - 16320) * (2 * size) >> 15) * (int64_t)t->k2_q12;
        const int64_t fourth = ((curve[3] - 16320) * (square * square >> 15) >> 15) * (int64_t)t->k4_q12;

        for (i = 0; i < 3; i++) {
            const int64_t bend =
                (int64_t)(curve[0] - 16320) * t->phi_q12[i] + (int64_t)(curve[1] - 16320) * t->v_q12[i];

            out[i] =
                base[i] + (int32_t)((base[3] * (int64_t)t->d_q12[i] + (bend * square >> 15) + linear + fourth) >> 12);
        }
    } else if (t->fine) {
        for (i = 0; i < 3; i++)
            out[i] = base[i] + (int32_t)((int64_t)((curve[i] - 16320) * square >> 15) * t->phi_q12[0] >> 12) +
                     (int32_t)((int64_t)((base[3] - 16320) * (2 * size) >> 15) * t->phi_q12[1] >> 12);
    } else {
        for (i = 0; i < 3; i++)
            out[i] = base[i] + (int32_t)((int64_t)((base[3] - 16320) * square >> 15) * t->phi_q12[i] >> 12);
    }
}

static void add_pixel(const shade_table_persp *t, const shade_persp_light *light, const shade_seen *seen, int i,
                      uint32_t *const to[3])
{
    const eval_surface n = eval_surface_of(seen->normal_xy[i], seen->normal_z[i]);
    const eval_surface v = eval_surface_of(seen->eye_xy[i], seen->eye_z[i]);
    const shade_arriving in = shade_arriving_of(light, seen, i);
    const int32_t nl = eval_dot_of(&n, &in.l);
    shade_halfway m;
    int32_t y[3], shared;
    int k;

    if (nl <= 0) return;
    m = shade_halfway_of(&in.l, &v);
    roots(t, &n, &m, (nl - eval_dot_of(&n, &v)) >> 14, y);
    /* n.l / (2 l.h) / distance^2, and 16 more for q16 */
    shared =
        eval_log2((uint32_t)nl) - 28 * 4096 - (eval_log2((uint32_t)m.l_dot_h) - 13 * 4096) - in.log2_square + 16 * 4096;
    for (k = 0; k < 3; k++) {
        if (y[k] <= 0 || light->log2_q12[k] <= -64 * 4096) continue;
        *to[k] +=
            eval_exp2(eval_least((int32_t)((int64_t)(eval_log2((uint32_t)y[k]) - LOG2_CODE_Q12) * t->p_q12 >> 12) +
                                     shared + light->log2_q12[k],
                                 MOST_LOG2));
    }
}

void shade_table_persp_add(const shade_table_persp *table, const shade_persp_light *light, const shade_seen *seen,
                           shade_rgb radiance)
{
    int i;

    if (light->dark) return;
    for (i = 0; i < seen->count; i++) {
        uint32_t *const to[3] = {radiance.r + i, radiance.g + i, radiance.b + i};

        add_pixel(table, light, seen, i, to);
    }
}
