/* SPDX-License-Identifier: MIT */
/* Mihalik & Durikovic 2015: set-up of eq. 1-4. */
#include "shade.h"

#define PI_Q28    843314857
#define HALF_TURN 0x80000000u

int32_t shade_spheres_log2(const shade_spheres *spheres, int channel)
{
    const int32_t scale = fx_log2_q16(spheres->scale[channel]);

    /* paper: the file holds pi E f_r n.l; else pi f_r / scale */
    return spheres->cosine ? -scale - SHADE_LOG2_PI_Q16 : scale - SHADE_LOG2_PI_Q16;
}

static int32_t half_disc(const shade_spheres *spheres)
{
    const int64_t half_q28 = (int64_t)spheres->disc << 11;

    return (int32_t)(spheres->cosine ? fx_shift(half_q28 * SHADE_SHRINK_Q14, 14) : half_q28);
}

static uint32_t polar_turn(const shade_spheres *spheres, int layer)
{
    return (uint32_t)spheres->polar_bam[layer] << 16;
}

static int32_t mul_q28(int64_t a, int64_t b)
{
    return (int32_t)fx_shift(a * b, 28);
}

/* tan(turn / 2) for |turn| below a quarter. A normal past the rim by up to that angle, moved outwards by this x its
   depth, is at the rim or beyond it: cos d + tan(turn / 2) sin d >= 1 for 0 <= d <= turn. */
static int32_t tan_half(uint32_t turn)
{
    return (int32_t)fx_div((int64_t)fx_sin_q28(turn) * FX_Q28_ONE, (int64_t)FX_Q28_ONE + fx_cos_q28(turn));
}

/* The pair of layers around polar, and the second one's weight (eq. 1). */
static void find_pair(shade_spheres_setup *out, const shade_spheres *spheres, uint32_t polar)
{
    int next = 0;

    while (next < spheres->layers && polar_turn(spheres, next) <= polar) next++;
    out->layer[0] = (uint8_t)(next ? next - 1 : 0);
    out->layer[1] = (uint8_t)(next < spheres->layers ? next : spheres->layers - 1);
    out->weight_q28 = 0;
    if (out->layer[0] != out->layer[1]) {
        const uint32_t low = polar_turn(spheres, out->layer[0]), high = polar_turn(spheres, out->layer[1]);

        out->weight_q28 = (int32_t)fx_div((int64_t)(polar - low) * FX_Q28_ONE, (int64_t)(high - low));
    }
}

/* Quadratics through sin and cos of k difference at the Chebyshev nodes of s in 0..1, k = (1 + s) / 2 (eq. 3): worst
   error 4e-4 for a difference of 45 degrees. tail: k = 3/4 everywhere (section 3). */
static void fit_turns(shade_spheres_setup *out, int which, int32_t difference, int tail)
{
    /* nodes (1 + cos(pi/6, pi/2, 5 pi/6)) / 2 in q28 */
    static const int64_t node[3] = {250453690, 134217728, 17981766};
    int part;

    for (part = 0; part < 2; part++) {
        const int column = 2 * part + which;
        int64_t value[3], first, second, bend;
        int i;

        for (i = 0; i < 3; i++) {
            const int64_t k_q28 = tail ? 3 * (FX_Q28_ONE / 4) : (FX_Q28_ONE + node[i]) / 2;
            const uint32_t turn = (uint32_t)fx_shift(difference * k_q28, 28);

            value[i] = part ? fx_cos_q28(turn) : fx_sin_q28(turn);
        }
        /* Newton's divided differences, then powers of s */
        first = fx_div((value[1] - value[0]) * FX_Q28_ONE, node[1] - node[0]);
        second = fx_div((value[2] - value[1]) * FX_Q28_ONE, node[2] - node[1]);
        bend = fx_div((second - first) * FX_Q28_ONE, node[2] - node[0]);
        out->turn_q28[2][column] = (int32_t)bend;
        out->turn_q28[1][column] = (int32_t)(first - fx_shift(bend * (node[0] + node[1]), 28));
        out->turn_q28[0][column] =
            (int32_t)(value[0] - fx_shift(first * node[0], 28) + fx_shift(fx_shift(bend * node[0], 28) * node[1], 28));
    }
}

void shade_spheres_light(shade_spheres_setup *out, const shade_incoming *in, const shade_spheres *spheres)
{
    const int32_t *l = in->to_light_q28, disc = half_disc(spheres);
    const int64_t across = fx_isqrt((uint64_t)((int64_t)l[0] * l[0] + (int64_t)l[1] * l[1])); /* sin(polar) */
    const uint32_t polar = fx_atan2(across, l[2]);
    const int32_t c = across ? (int32_t)fx_div((int64_t)l[0] * FX_Q28_ONE, across) : FX_Q28_ONE;
    const int32_t s = across ? (int32_t)fx_div((int64_t)l[1] * FX_Q28_ONE, across) : 0;
    int i;

    find_pair(out, spheres, polar);
    for (i = 0; i < 3; i++) out->to_light_q28[i] = l[i];
    out->azimuth_q28[0] = c;
    out->azimuth_q28[1] = s;
    out->half_q28[0] = fx_sin_q28(polar / 2);
    out->half_q28[1] = fx_cos_q28(polar / 2);
    out->y_q28[0] = -mul_q28(s, disc);
    out->y_q28[1] = mul_q28(c, disc);
    out->y_q28[2] = 0;
    for (i = 0; i < 2; i++) {
        /* eq. 1; at most half a turn, so signed arithmetic holds it: polar angles are below half a turn */
        const int32_t difference = (int32_t)(polar_turn(spheres, out->layer[i]) - polar);
        const uint32_t half = (uint32_t)(difference / 2);
        const int32_t cos_half = fx_cos_q28(half), sin_half = fx_sin_q28(half);

        /* R_y: x' = x cos + z sin, of the normal turned by -azimuth */
        out->x_q28[i][0] = mul_q28(mul_q28(c, cos_half), disc);
        out->x_q28[i][1] = mul_q28(mul_q28(s, cos_half), disc);
        out->x_q28[i][2] = mul_q28(sin_half, disc);
        fit_turns(out, i, difference, polar > polar_turn(spheres, spheres->layers - 1));
        if (i) { /* z' = -x sin + z cos; a file without padding has nothing beyond the rim */
            const int32_t push = difference > 0 && spheres->disc < NACRE_Q16_ONE ? mul_q28(tan_half(half), disc) : 0;

            out->rim_q28[0] = mul_q28(mul_q28(c, sin_half), push);
            out->rim_q28[1] = mul_q28(mul_q28(s, sin_half), push);
            out->rim_q28[2] = -mul_q28(cos_half, push);
        }
    }
}

void shade_spheres_prepare(shade_spheres_draw *out, const shade_spheres *spheres, int units)
{
    const int32_t disc = half_disc(spheres);
    const int count = spheres->layers < units ? spheres->layers : units;
    uint32_t previous = 0;
    int i;

    out->count = (uint8_t)count;
    out->half_disc_q28 = disc;
    for (i = 0; i < SHADE_MAX_UNITS; i++) {
        const int unit = i < count ? i : count - 1;
        const int layer = count > 1 ? (int)fx_div((int64_t)unit * (spheres->layers - 1), count - 1) : 0;
        const uint32_t polar = polar_turn(spheres, layer);
        fx_real none = {0, 0};

        out->layer[i] = (uint8_t)layer;
        out->polar_q28[i] = (int32_t)fx_shift((int64_t)polar * PI_Q28, 31);
        out->cos_q28[i] = mul_q28(fx_cos_q28(polar / 2), disc);
        out->sin_q28[i] = mul_q28(fx_sin_q28(polar / 2), disc);
        out->rim_q28[i] = spheres->disc < NACRE_Q16_ONE ? tan_half((polar - previous) / 2) : 0;
        out->ramp[i][0] = out->ramp[i][1] = none;
        if (i && i < count && polar > previous) { /* polar / step - previous / step */
            const int64_t step = (int64_t)(polar - previous);

            out->ramp[i - 1][0] = fx_real_make(fx_div((int64_t)1 << 60, fx_shift(step * PI_Q28, 31)), -32);
            out->ramp[i - 1][1] = fx_real_make(-fx_div((int64_t)previous << 24, step), -24);
        }
        if (i < count) previous = polar;
    }
}
