/* SPDX-License-Identifier: MIT */
#include "eval_spheres_persp.h"

#include "eval_image.h"
#include "eval_persp_inner.h"

#include <string.h>

/* ---- set-up --------------------------------------------------------------------------------------------------------- */

void shade_spheres_persp_prepare(shade_spheres_persp *out, const shade_spheres *spheres, const uint8_t *texels,
                                 unsigned size, unsigned texel_bytes)
{
    const int count = spheres->layers < SHADE_EVAL_MAX_IMAGES ? spheres->layers : SHADE_EVAL_MAX_IMAGES;
    int i;

    memset(out, 0, sizeof *out);
    out->texels = texels;
    out->image_bytes = size * size * texel_bytes;
    out->size = (uint16_t)size;
    out->texel_bytes = (uint8_t)texel_bytes;
    out->count = (uint8_t)count;
    out->paper = spheres->cosine;
    out->half_disc_q15 = spheres->disc >> 2;
    if (out->paper) out->half_disc_q15 = out->half_disc_q15 * SHADE_SHRINK_Q14 >> 14;
    if (spheres->size) out->texels_per_log2 = shade_quarter_texels(size);
    for (i = 0; i < count; i++) {
        out->layer[i] = (uint8_t)(count > 1 ? fx_div((int64_t)i * (spheres->layers - 1), count - 1) : 0);
        out->at_q15[i] = (uint16_t)(spheres->size ? shade_quarter_step(spheres, out->layer[i]) >> 13
                                                  : spheres->polar_bam[out->layer[i]]);
        if (i && out->at_q15[i] > out->at_q15[i - 1])
            out->inverse_q30[i - 1] = (uint32_t)fx_div(1 << 30, out->at_q15[i] - out->at_q15[i - 1]);
    }
}

/* ---- images ----------------------------------------------------------------------------------------------------------- */

/* Of one copy each: they are long, and needed here and there. */
static eval_surface unit(int32_t x, int32_t y, int32_t z)
{
    return eval_unit(shade_pack_xy(x, y), z);
}

static int32_t log2_of(uint32_t x)
{
    return eval_log2(x);
}

FX_APART static void sample(const uint8_t *image, image_place x, image_place y, int32_t out[3])
{
    image_sample(image, x, y, out);
}

typedef struct pair {
    const uint8_t *image[2];
    int32_t at[2];
    int32_t weight; /* of the second, q15 */
    int lone;       /* at or beyond the first or last */
} pair;

static pair pair_of(const shade_spheres_persp *s, int32_t at)
{
    pair out;
    int i, k;

    for (i = 0; i + 2 < s->count && at >= s->at_q15[i + 1]; i++) continue;
    for (k = 0; k < 2; k++) {
        const int unit = i + k < s->count ? i + k : i;

        out.image[k] = s->texels + s->layer[unit] * s->image_bytes;
        out.at[k] = s->at_q15[unit];
    }
    out.lone = at <= out.at[0] || at >= out.at[1];
    out.weight = at <= out.at[0] ? 0
                 : out.lone      ? 32767
                                 : (int32_t)((uint32_t)(at - out.at[0]) * s->inverse_q30[i] >> 15);
    return out;
}

static void blend(int32_t code[2][3], int32_t weight, int32_t out[3])
{
    int i;

    for (i = 0; i < 3; i++) out[i] = image_mix(code[0][i], code[1][i], weight);
}

/* ---- quarters: about the half vector ---------------------------------------------------------------------------------- */

/* Along l - v; where light and eye are one, across h: any direction will do. */
static eval_surface between(const eval_surface *l, const eval_surface *v, const eval_surface *h)
{
    const int32_t x = l->x - v->x, y = l->y - v->y, z = l->z - v->z;
    const int shift = ((x < 0 ? -x : x) | (y < 0 ? -y : y) | (z < 0 ? -z : z)) >> 14 ? 1 : 0;

    return x | y | z ? unit(x >> shift, y >> shift, z >> shift) : unit(h->z, 0, -h->x);
}

static eval_surface cross(const eval_surface *a, const eval_surface *b)
{
    const eval_surface out = {(a->y * b->z - a->z * b->y) >> 14, (a->z * b->x - a->x * b->z) >> 14,
                              (a->x * b->y - a->y * b->x) >> 14, 1 << 28};

    return out;
}

static void quarter_code(const shade_spheres_persp *s, const eval_surface *n, const eval_surface *l,
                         const eval_surface *v, const shade_halfway *m, int32_t out[3])
{
    const uint32_t texel = s->texel_bytes;
    const eval_surface d = between(l, v, &m->h), across = cross(&m->h, &d);
    const image_place x = image_quarter(2 * eval_dot_of(n, &d), s->texels_per_log2, s->size, texel);
    const image_place y = image_quarter(2 * eval_dot_of(n, &across), s->texels_per_log2, s->size, texel * s->size);
    const pair p = pair_of(s, m->s);
    int32_t code[2][3];

    sample(p.image[0], x, y, code[0]);
    sample(p.image[1], x, y, code[1]);
    blend(code, p.weight, out);
}

/* ---- whole spheres: the eye is +z, the light in the plane of x and z --------------------------------------------------- */

/* Angle between two unit vectors, pi: 32768. 2 asin(|l - v| / 2) by Abramowitz & Stegun 4.4.45. */
static int32_t angle_between(const eval_surface *l, const eval_surface *v)
{
    const int32_t x = l->x - v->x, y = l->y - v->y, z = l->z - v->z;
    const int32_t s = eval_least((int32_t)fx_isqrt((uint32_t)(x * x) + (uint32_t)(y * y) + (uint32_t)(z * z)), 32768);
    int32_t p = 1549 - (391 * s >> 15);

    p = 32767 + ((p * s >> 15) - 4425) * s / 32768;
    return 32768 - (int32_t)((fx_isqrt((uint64_t)(32768 - s) << 15) * (uint32_t)p) >> 15);
}

/* Code of an image whose sphere is turned about y (eq. 2); normals turned past the rim stay at the rim. */
static void turned_code(const shade_spheres_persp *s, const uint8_t *image, const eval_surface *n, uint32_t turn,
                        int32_t out[3])
{
    const int32_t cosine = fx_cos_q28(turn) >> 14, sine = fx_sin_q28(turn) >> 14;
    int32_t x = (n->x * cosine + n->z * sine) >> 14, y = n->y;

    if (n->z * cosine < n->x * sine) {
        const eval_surface rim = unit(x, y, 0);

        x = rim.x;
        y = rim.y;
    }
    sample(image, image_whole(x * s->half_disc_q15, s->size, s->texel_bytes),
           image_whole(-y * s->half_disc_q15, s->size, (uint32_t)s->texel_bytes * s->size), out);
}

/* k of eq. 3, q15: (1 + sine of the angle between half vector and (nx, 0, nz)) / 2 */
static int32_t rotation(const eval_surface *n, int32_t angle)
{
    const int32_t c = fx_cos_q28((uint32_t)angle << 15) >> 14, s = fx_sin_q28((uint32_t)angle << 15) >> 14;
    const eval_surface plane = unit(n->x, 0, n->z);
    const int32_t sine = (s * plane.z - c * plane.x) >> 14;

    return 16384 + eval_least(sine < 0 ? -sine : sine, 16384);
}

static void whole_code(const shade_spheres_persp *s, const eval_surface *n, const eval_surface *l,
                       const eval_surface *v, int32_t out[3])
{
    const int32_t cosine = eval_dot_of(l, v) >> 14, angle = angle_between(l, v);
    const int32_t ax = l->x - (v->x * cosine >> 14), ay = l->y - (v->y * cosine >> 14),
                  az = l->z - (v->z * cosine >> 14);
    const eval_surface x = ax | ay | az ? unit(ax, ay, az) : unit(v->z, 0, -v->x);
    const eval_surface y = cross(v, &x);
    const pair p = pair_of(s, angle);
    const eval_surface turned = {eval_dot_of(n, &x) >> 14, eval_dot_of(n, &y) >> 14, eval_dot_of(n, v) >> 14, 1 << 28};
    int32_t code[2][3], k = 16384;
    int i;

    if (s->paper) k = p.lone ? 24576 : rotation(&turned, angle); /* beyond the images 3/4, section 3 */
    for (i = 0; i < 2; i++) turned_code(s, p.image[i], &turned, (uint32_t)((p.at[i] - angle) * k) * 2, code[i]);
    blend(code, p.weight, out);
}

/* ---- light ------------------------------------------------------------------------------------------------------------- */

/* log2 of what a code stands for, q12: its fourth power; paper: the sRGB curve. */
static int32_t log2_decoded(const shade_spheres_persp *s, int32_t code)
{
    if (!s->paper) return 4 * (log2_of((uint32_t)code) - LOG2_CODE_Q12);
    if (code <= 1320) return log2_of((uint32_t)code) - LOG2_CODE_Q12 - 15120;      /* / 12.92 */
    return ((log2_of((uint32_t)code + 1795) - LOG2_CODE_Q12 - 316) * 9830) / 4096; /* ((y + .055) / 1.055)^2.4 */
}

static void add_pixel(const shade_spheres_persp *s, const shade_persp_light *light, const shade_seen *seen, int i,
                      uint32_t *const to[3])
{
    const eval_surface n = eval_surface_of(seen->normal_xy[i], seen->normal_z[i]);
    const eval_surface v = eval_surface_of(seen->eye_xy[i], seen->eye_z[i]);
    const shade_arriving in = shade_arriving_of(light, seen, i);
    const int32_t nl = eval_dot_of(&n, &in.l);
    int32_t code[3], shared = 16 * 4096 - in.log2_square; /* q16 */
    int k;

    if (!s->paper) {
        if (nl <= 0) return;
        shared += log2_of((uint32_t)nl) - 28 * 4096;
    }
    if (s->texels_per_log2) {
        const shade_halfway m = shade_halfway_of(&in.l, &v);

        quarter_code(s, &n, &in.l, &v, &m, code);
        shared -= log2_of((uint32_t)m.l_dot_h) - 13 * 4096; /* / (2 l.h) */
    } else {
        whole_code(s, &n, &in.l, &v, code);
    }
    for (k = 0; k < 3; k++)
        if (code[k] > 0 && light->log2_q12[k] > -64 * 4096)
            *to[k] += eval_exp2(eval_least(log2_decoded(s, code[k]) + shared + light->log2_q12[k], MOST_LOG2));
}

void shade_spheres_persp_add(const shade_spheres_persp *spheres, const shade_persp_light *light, const shade_seen *seen,
                             shade_rgb radiance)
{
    int i;

    for (i = 0; i < seen->count; i++) {
        uint32_t *const to[3] = {radiance.r + i, radiance.g + i, radiance.b + i};

        add_pixel(spheres, light, seen, i, to);
    }
}
