/* SPDX-License-Identifier: MIT */
/* From roots and coefficients to 8-bit codes. */
#include <math.h>
#include <stdlib.h>

#include "table_parts.h"

#define SWEEPS 12
#define REACH  4.0 /* codes */

/* The code of an unknown of a texel: base roots in RGB of the first layer; one layer: the coefficient in its alpha; two:
   coefficients in the second layer. The first layer's alpha then belongs to the base roots, see round_base. */
static uint8_t *code_of(const table_asset *t, int texel, int unknown)
{
    uint8_t *first = t->rgba + (size_t)texel * 4;
    if (unknown < 3) return first + unknown;
    if (t->layers == 1) return first + 3;
    return first + (size_t)(t->width * t->height) * 4 + (unknown - 3);
}

static double largest3(const double v[3])
{
    return fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
}

/* What a full step of code, 0 to 255, is worth in an unknown. */
static double range_of(const table_asset *t, int unknown)
{
    if (unknown < 3) return t->ymax;
    double range[4] = {largest3(t->w), largest3(t->v), t->k2, t->k4};
    return t->ymax * range[unknown - 3];
}

static double value_of(const table_asset *t, int texel, int unknown)
{
    double x = *code_of(t, texel, unknown) / 255.0;
    if (unknown >= 3) return (x - 0.5) * range_of(t, unknown);
    if (t->layers == 2) x += t->rgba[4 * texel + 3] / 255.0 * t->d[unknown];
    return x * t->ymax;
}

static int nearest(double value, double range, int unknown)
{
    double x = range > 0 ? value / range : 0;
    if (unknown >= 3) x += 0.5;
    return (int)(fmin(fmax(x, 0), 1) * 255 + 0.5);
}

/* Codes R G B A whose sums RGB + A D come nearest to three base roots. A is the least that leaves RGB no more than 255, so
   that it is 0 but near the peak: where neighbours share their alpha, its filter is exact on GPUs that filter in 8 bits
   too. */
static void round_base(const table_asset *t, const double root[3], uint8_t code[4])
{
    double wanted[3], a = 0;
    for (int k = 0; k < 3; k++) {
        wanted[k] = root[k] / t->ymax * 255;
        a = fmax(a, ceil((wanted[k] - 255) / t->d[k]));
    }
    a = fmin(a, 255);
    for (int k = 0; k < 3; k++) code[k] = (uint8_t)(fmin(fmax(wanted[k] - a * t->d[k], 0), 255) + 0.5);
    code[3] = (uint8_t)a;
}

/* 1 if no |a| that a lit and seen point near the texel can have gives a negative y: a power of such a value differs from
   device to device. */
static int positive(const table_asset *t, int texel)
{
    const double reach = table_reach(t, texel % t->width, texel / t->width);
    const uint8_t *first = t->rgba + (size_t)texel * 4, *second = first + (size_t)(t->width * t->height) * 4;
    double c[4] = {0}, ymax = t->ymax;
    for (int j = 0; j < (t->layers == 2 ? 4 : 1); j++) c[j] = (t->layers == 2 ? second[j] : first[3]) / 255.0 - 0.5;
    for (int k = 0; k < 3; k++) {
        double base = value_of(t, texel, k) / ymax, square = c[0] * t->w[k] + c[1] * t->v[k], linear = c[2] * t->k2,
               fourth = c[3] * t->k4;
        if (base + reach * (fmin(linear, 0) + reach * (fmin(square, 0) + reach * reach * fmin(fourth, 0))) >= 0)
            continue;
        for (int i = 0; i <= 64; i++) {
            double a = reach * i / 64;
            if (base + a * (linear + a * (square + a * a * fourth)) < 0) return 0;
        }
    }
    return 1;
}

static void round_texel(table_asset *t, const table_problem *p, int texel, const double *x)
{
    for (int k = 0; k < p->n; k++) *code_of(t, texel, k) = (uint8_t)nearest(x[k], range_of(t, k), k);
    if (t->layers == 2) round_base(t, x, t->rgba + 4 * texel);
    /* coefficients towards zero, and at last the base up, until the texel is positive */
    while (!positive(t, texel)) {
        int moved = 0;
        for (int k = 3; k < p->n; k++) {
            uint8_t *code = code_of(t, texel, k);
            int step = (*code < 127) - (*code > 128);
            *code = (uint8_t)(*code + step);
            moved |= step;
        }
        for (int k = 0; k < 3 && !moved; k++) *code_of(t, texel, k) = (uint8_t)(*code_of(t, texel, k) + 1);
    }
}

/* What is left of the gradient: H z without albedos in gradient, their share from the sums of pull z. */
typedef struct descent {
    double *gradient, sky[TABLE_SKY_TERMS];
    const double *x;
} descent;

static double slope_at(const table_problem *p, const descent *d, int index)
{
    return d->gradient[index] + (p->sky ? table_pulled(p, index, d->sky) : 0);
}

/* Where an unknown is wanted, not further from x than its linearised errors hold. */
static double wanted_at(const table_problem *p, const table_asset *t, const descent *d, int texel, int unknown,
                        double before, double stiffness)
{
    int index = texel * p->n + unknown;
    double step = REACH * range_of(t, unknown) / 255, wanted = before - slope_at(p, d, index) / stiffness;
    return p->sky ? fmin(fmax(wanted, d->x[index] - step), d->x[index] + step) : wanted;
}

static void moved_by(const table_problem *p, int texel, int unknown, double delta, descent *d)
{
    table_apply_one(p, texel, unknown, delta, d->gradient);
    if (!p->sky) return;
    const double *pull = p->pull + (size_t)(texel * p->n + unknown) * TABLE_SKY_TERMS;
    for (int k = 0; k < TABLE_SKY_TERMS; k++) d->sky[k] += pull[k] * delta;
}

/* Move one code to where the error is least among the positive ones on the way; gradient follows. */
static int improve(const table_problem *p, table_asset *t, int texel, int unknown, descent *d)
{
    double range = range_of(t, unknown);
    double stiffness = table_stiffness(p, texel, unknown);
    if (!(range > 0 && stiffness > 0)) return 0;
    uint8_t *code = code_of(t, texel, unknown);
    int old = *code;
    double before = value_of(t, texel, unknown), wanted = wanted_at(p, t, d, texel, unknown, before, stiffness);
    if (unknown < 3 && t->layers == 2) wanted -= t->ymax * t->rgba[4 * texel + 3] / 255.0 * t->d[unknown];
    *code = (uint8_t)nearest(wanted, range, unknown);
    while (*code != old && !positive(t, texel)) *code = (uint8_t)(*code + (*code < old ? 1 : -1));
    if (*code == old) return 0;
    moved_by(p, texel, unknown, value_of(t, texel, unknown) - before, d);
    return 1;
}

/* The same for a texel's three base roots at once, where an alpha binds them: H has no terms between them. */
static int improve_base(const table_problem *p, table_asset *t, int texel, descent *d)
{
    uint8_t *code = t->rgba + 4 * texel, old[4], next[4];
    double before[3], wanted[3], stiffness[3], gain = 0;
    for (int k = 0; k < 3; k++) {
        stiffness[k] = table_stiffness(p, texel, k);
        if (!(stiffness[k] > 0)) return 0;
        before[k] = value_of(t, texel, k);
        wanted[k] = wanted_at(p, t, d, texel, k, before[k], stiffness[k]);
    }
    round_base(t, wanted, next);
    for (int c = 0; c < 4; c++) old[c] = code[c];
    for (int c = 0; c < 4; c++) code[c] = next[c];
    for (int k = 0; k < 3; k++)
        gain += stiffness[k] * (pow(before[k] - wanted[k], 2) - pow(value_of(t, texel, k) - wanted[k], 2));
    if (!(gain > 0) || !positive(t, texel)) {
        for (int c = 0; c < 4; c++) code[c] = old[c];
        return 0;
    }
    for (int k = 0; k < 3; k++) moved_by(p, texel, k, value_of(t, texel, k) - before[k], d);
    return 1;
}

static int improve_texel(const table_problem *p, table_asset *t, int texel, descent *d)
{
    int moved = 0, first = 0;
    if (t->layers == 2) {
        moved = improve_base(p, t, texel, d);
        first = 3;
    }
    for (int k = first; k < p->n; k++) moved |= improve(p, t, texel, k, d);
    return moved;
}

static double settle(const table_problem *p, table_asset *t, const double *x, double *z, double *gradient)
{
    int n = p->n, count = p->texels * n;
    double *rhs = need_memory((size_t)count, sizeof *rhs), error = 0;
    descent d = {gradient, {0}, x};
    table_add_smoothing(p, x, rhs);
    for (int i = 0; i < count; i++) rhs[i] = p->rhs[i] - rhs[i];
    for (int i = 0; i < count; i++) z[i] = value_of(t, i / n, i % n) - x[i];
    table_apply(p, z, gradient);
    for (int i = 0; i < count && p->sky; i++)
        for (int k = 0; k < TABLE_SKY_TERMS; k++) d.sky[k] += p->pull[i * TABLE_SKY_TERMS + k] * z[i];
    for (int i = 0; i < count; i++) gradient[i] -= rhs[i] + (p->sky ? table_pulled(p, i, d.sky) : 0);
    for (int sweep = 0, moved = 1; sweep < SWEEPS && moved; sweep++) {
        moved = 0;
        for (int i = 0; i < p->texels; i++) moved |= improve_texel(p, t, i, &d);
    }
    for (int i = 0; i < count; i++) error += (value_of(t, i / n, i % n) - x[i]) * (slope_at(p, &d, i) - rhs[i]) / 2;
    free(rhs);
    return error;
}

double table_round(table_asset *t, const table_problem *p, const double *x)
{
    size_t count = (size_t)(p->texels * p->n);
    double *z = need_memory(2 * count, sizeof *z);
    for (int i = 0; i < p->texels; i++) {
        for (int c = 3; c < 4 * t->layers; c++)
            *(c < 4 ? t->rgba + 4 * i + c : t->rgba + 4 * (p->texels + i) + c - 4) = 128;
        round_texel(t, p, i, x + i * p->n);
    }
    double error = settle(p, t, x, z, z + count);
    free(z);
    return error;
}
