/* SPDX-License-Identifier: MIT */
#include "eval_sbrdf.h"

#include "eval_inner.h"
#include "eval_persp.h"

#define ZERO          (NACRE_CODE_ZERO * 65536)
#define LOG2_CODE_Q12 23          /* log2(256 / 255): codes are 256ths of a whole here */
#define MOST_LOG2     (26 * 4096) /* 1024 white */
#define MOST          (4 << 16)   /* what is added at once, q16 */

/* ---- set-up ---------------------------------------------------------------------------------------------------------- */

static uint32_t held(fx_real radiance)
{
    return (uint32_t)eval_least(fx_real_fixed(radiance, 16), MOST);
}

void shade_sbrdf_eval_prepare(shade_sbrdf_eval *out, const shade_sbrdf *sbrdf, const shade_frame *frame)
{
    int i;

    out->lobes = sbrdf->lobes;
    out->direction = sbrdf->direction;
    for (i = 0; i < sbrdf->lobes; i++) {
        out->shape_q28[i] = (int32_t)fx_div((int64_t)sbrdf->shape_most[i] << 12, NACRE_CODE_STEPS);
        out->log2_weight_q12[i] = (fx_log2_q16(sbrdf->most[i]) - fx_log2_q16(sbrdf->albedo_most)) >> 4;
    }
    for (i = 0; i < 3; i++) {
        out->ambient_q16[i] = held(frame->ambient[i]);
        out->ambient_albedo_q16[i] = held(frame->is.sbrdf.ambient[i]);
    }
}

void shade_sbrdf_light_prepare(shade_sbrdf_eval_light *out, const nacre_light *light, const shade_light *set,
                               const shade_frame *frame)
{
    shade_persp_light with;
    int i;

    shade_persp_light_prepare(&with, light, set, frame->position_shift);
    out->point = with.point;
    out->dark = with.dark;
    out->log2_q12 = INT32_MIN;
    for (i = 0; i < 3; i++) {
        if (with.log2_q12[i] > out->log2_q12) out->log2_q12 = with.log2_q12[i];
        out->place[i] = with.point     ? with.place[i]
                        : frame->persp ? fx_real_fixed(set->position[i], 28)
                                       : set->is.sbrdf.to_light_q28[i];
    }
    for (i = 0; i < 3; i++)
        out->part_q15[i] = (uint16_t)fx_real_fixed(fx_real_exp2(((int64_t)with.log2_q12[i] - out->log2_q12) * 16), 15);
    out->log2_q12 += LOG2_CODE_Q12;
}

/* ---- vectors --------------------------------------------------------------------------------------------------------- */

static int32_t mul_q28(int32_t a, int32_t b)
{
    return (int32_t)((int64_t)a * b >> 28);
}

/* v / |v|, q28; the root of a table and one step of Newton's. Returns log2 |v|^2, q12. */
static int32_t unit(const int32_t v[3], int32_t out[3])
{
    const uint64_t square = (uint64_t)((int64_t)v[0] * v[0] + (int64_t)v[1] * v[1] + (int64_t)v[2] * v[2]) | 1;
    const int half = fx_top_bit(square) / 2, down = 2 * half - 28;
    const uint32_t m = (uint32_t)(down > 0 ? square >> down : square << -down);        /* 1..4, q28 */
    const uint32_t root = (uint32_t)eval_inverse_root(eval_split_of(m)) >> 16;         /* q15 */
    const uint32_t near_one = (uint32_t)((uint64_t)(root * root) * m >> 28);           /* q30 */
    const int64_t inverse = (int64_t)((uint64_t)root * ((3u << 30) - near_one) >> 16); /* q30 */
    int i;

    for (i = 0; i < 3; i++) out[i] = (int32_t)(v[i] * inverse >> (half + 2));
    return eval_log2(m) + down * 4096;
}

static void cross(int32_t out[3], const int32_t a[3], const int32_t b[3])
{
    int i;

    for (i = 0; i < 3; i++) {
        const int j = i < 2 ? i + 1 : 0, k = j < 2 ? j + 1 : 0;

        out[i] = (int32_t)(((int64_t)a[j] * b[k] - (int64_t)a[k] * b[j]) >> 28);
    }
}

/* ---- the surface ----------------------------------------------------------------------------------------------------- */

typedef struct surface {
    int32_t axis[3][3];                /* along and across the direction of anisotropy, normal */
    int32_t shape[NACRE_MAX_LOBES][3]; /* C x direction to the eye, per axis */
} surface;

/* Across the normal, nearest to the tangent. */
static void set_tangent(const int32_t normal[3], const int32_t tangent[3], int32_t out[3])
{
    int32_t t[3], along;
    int i;

    unit(tangent, t);
    along = fx_dot_q28(normal, t);
    for (i = 0; i < 3; i++) t[i] -= mul_q28(normal[i], along);
    if (unit(t, out) > 36 * 4096) return; /* 2^-10 of a unit vector */
    t[0] = t[1] = t[2] = 0;
    t[normal[0] < FX_Q28_ONE / 2 && normal[0] > -FX_Q28_ONE / 2 ? 0 : 1] = FX_Q28_ONE;
    cross(out, normal, t);
    unit(out, out);
}

/* Turn the first axis from the tangent to the texel's direction. */
static void turn(surface *s, int32_t x, int32_t y)
{
    const int32_t direction[3] = {x, y, 0};
    int32_t d[3];
    int i;

    if (!(x | y)) return;
    unit(direction, d);
    for (i = 0; i < 3; i++) s->axis[0][i] = mul_q28(s->axis[0][i], d[0]) + mul_q28(s->axis[1][i], d[1]);
    cross(s->axis[1], s->axis[2], s->axis[0]);
}

static void set_surface(surface *out, const shade_sbrdf_eval *eval, shade_sbrdf_codes codes,
                        const shade_sbrdf_point *point)
{
    int32_t *const along = out->axis[0], *const normal = out->axis[2];
    int32_t eye[3];
    int i, j;

    unit(point->normal, normal);
    set_tangent(normal, point->tangent, along);
    cross(out->axis[1], normal, along);
    if (eval->direction) turn(out, codes[1][3] - ZERO, point->mirrored ? ZERO - codes[3][3] : codes[3][3] - ZERO);
    unit(point->to_eye, eye);
    for (i = 0; i < 3; i++) {
        const int32_t part = fx_dot_q28(out->axis[i], eye);

        for (j = 0; j < eval->lobes; j++) {
            const int32_t c = (int32_t)((int64_t)(codes[2 + 2 * j][i] - ZERO) * eval->shape_q28[j] >> 16);

            out->shape[j][i] = mul_q28(c, part);
        }
    }
}

/* ---- one light --------------------------------------------------------------------------------------------------------- */

/* Towards the light, q28. Returns log2 of the distance squared, q12; 0 for directional lights. */
static int32_t arriving(const shade_sbrdf_eval_light *light, const shade_sbrdf_point *point, int32_t out[3])
{
    uint32_t all = 0;
    int32_t way[3]; /* q15 */
    int i, down;

    for (i = 0; i < 3; i++) {
        out[i] = light->place[i];
        way[i] = (light->place[i] >> 1) - (point->position_q16[i] >> 1);
        all |= (uint32_t)(way[i] < 0 ? -way[i] : way[i]);
    }
    if (!light->point) return 0;
    down = all >> 29 ? 3 : 0;
    for (i = 0; i < 3; i++) way[i] >>= down;
    return unit(way, out) + (2 * down - 30) * 4096;
}

/* n = 255 (code / 255)^2 */
static uint32_t exponent_q16(int32_t code)
{
    const uint32_t code_q8 = (uint32_t)code >> 8;

    return (uint32_t)((uint64_t)(code_q8 * code_q8) * 65793 >> 24);
}

/* log2 of max(x, 0)^n, q12; x above 1 counts as 1. */
static int32_t log2_power(int32_t x_q28, uint32_t n_q16)
{
    if (x_q28 >= FX_Q28_ONE) return 0;
    return -(int32_t)((shade_minus_log2_q24((uint32_t)x_q28 << 3) * n_q16) >> 28);
}

static void add_scaled(uint64_t sum[3], const int32_t code[4], int32_t log2_q12)
{
    const uint64_t scale = eval_exp2(eval_least(log2_q12, MOST_LOG2));
    int i;

    for (i = 0; i < 3; i++) sum[i] += scale * (uint32_t)code[i];
}

static void add_light(const shade_sbrdf_eval *eval, const shade_sbrdf_eval_light *light, shade_sbrdf_codes codes,
                      const shade_sbrdf_point *point, const surface *s, uint32_t radiance[3])
{
    uint64_t sum[3] = {0, 0, 0};
    int32_t to_light[3], l[3], log2_q12;
    int i;

    log2_q12 = light->log2_q12 - arriving(light, point, to_light);
    for (i = 0; i < 3; i++) l[i] = fx_dot_q28(s->axis[i], to_light);
    if (l[2] <= 0) return;
    log2_q12 += eval_log2((uint32_t)l[2]) - (28 - 16) * 4096;
    add_scaled(sum, codes[0], log2_q12);
    for (i = 0; i < eval->lobes; i++) {
        const int32_t x = fx_dot_q28(s->shape[i], l);

        if (x > 0)
            add_scaled(sum, codes[1 + 2 * i],
                       log2_q12 + eval->log2_weight_q12[i] + log2_power(x, exponent_q16(codes[2 + 2 * i][3])));
    }
    for (i = 0; i < 3; i++) {
        const uint64_t added = (sum[i] >> 24) * light->part_q15[i] >> 15;

        radiance[i] += added < MOST ? (uint32_t)added : (uint32_t)MOST;
    }
}

void shade_sbrdf_shade(const shade_sbrdf_eval *eval, const shade_sbrdf_eval_light *lights, int count,
                       shade_sbrdf_codes codes, const shade_sbrdf_point *point, uint32_t radiance_q16[3])
{
    surface s = {{{0}}, {{0}}};
    int i;

    set_surface(&s, eval, codes, point);
    for (i = 0; i < 3; i++)
        radiance_q16[i] = eval->ambient_q16[i] +
                          (uint32_t)((uint64_t)eval->ambient_albedo_q16[i] * (uint32_t)codes[0][i] * 257 >> 32);
    for (i = 0; i < count; i++)
        if (!lights[i].dark) add_light(eval, &lights[i], codes, point, &s, radiance_q16);
}
