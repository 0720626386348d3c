/* SPDX-License-Identifier: MIT */
/* From roots and coefficients to 8-bit codes. */
#include <math.h>
#include <stdlib.h>

#include "table_parts.h"

#define SWEEPS 12

/* The code of an unknown of a texel: base roots in RGB of the first layer; the default tier's coefficient in its alpha;
   fine: coefficients of a^2 in RGB of the second layer, that of |a| in the first one's alpha. */
static uint8_t *code_of(const table_asset *t, int texel, int unknown)
{
    uint8_t *first = t->rgba + (size_t)texel * 4;
    if (unknown < 3) return first + unknown;
    if (t->layers == 1 || unknown == 6) return first + 3;
    return first + (size_t)(t->width * t->height) * 4 + (unknown - 3);
}

/* What a full step of code, 0 to 255, is worth in an unknown. */
static double range_of(const table_asset *t, int unknown)
{
    if (unknown < 3) return t->ymax;
    if (t->layers == 2) return t->ymax * (unknown == 6 ? t->k2 : t->k1);
    return t->ymax * fmax(fabs(t->w[0]), fmax(fabs(t->w[1]), fabs(t->w[2])));
}

static double value_of(const table_asset *t, int texel, int unknown)
{
    double x = *code_of(t, texel, unknown) / 255.0;
    return (unknown < 3 ? x : x - 0.5) * range_of(t, unknown);
}

static int nearest(double value, double range, int unknown)
{
    double x = range > 0 ? value / range : 0;
    if (unknown >= 3) x += 0.5;
    return (int)(fmin(fmax(x, 0), 1) * 255 + 0.5);
}

/* Least y of a texel's channel over |a| in 0..1. */
static double least(double base, double square, double linear)
{
    double low = fmin(base, base + square + linear);
    double at = square > 0 ? -linear / (2 * square) : -1;
    return at > 0 && at < 1 ? fmin(low, base - linear * linear / (4 * square)) : low;
}

/* 1 if no |a| in 0..1 gives a negative y: a power of such a value differs from device to device. */
static int positive(const table_asset *t, int texel)
{
    const uint8_t *base = t->rgba + (size_t)texel * 4, *second = base + (size_t)(t->width * t->height) * 4;
    double alpha = base[3] / 255.0 - 0.5;
    for (int k = 0; k < 3; k++) {
        double square = t->layers == 2 ? (second[k] / 255.0 - 0.5) * t->k1 : alpha * t->w[k];
        double linear = t->layers == 2 ? alpha * t->k2 : 0;
        if (least(base[k] / 255.0, square, linear) < 0) return 0;
    }
    return 1;
}

/* Nearest codes; coefficients towards zero, and at last the base up, until the texel is positive. */
static void round_texel(table_asset *t, const table_model *m, int texel, const double *x)
{
    for (int k = 0; k < table_unknowns(m); k++) *code_of(t, texel, k) = (uint8_t)nearest(x[k], range_of(t, k), k);
    while (!positive(t, texel)) {
        int moved = 0;
        for (int k = 3; k < table_unknowns(m); k++) {
            uint8_t *code = code_of(t, texel, k);
            int step = (*code < 127) - (*code > 128);
            *code = (uint8_t)(*code + step);
            moved |= step;
        }
        for (int k = 0; k < 3 && !moved; k++) *code_of(t, texel, k) = (uint8_t)(*code_of(t, texel, k) + 1);
    }
}

/* Move one code to where the error is least among the positive ones on the way; gradient follows. */
static int improve(const table_problem *p, table_asset *t, int texel, int unknown, double *gradient)
{
    double range = range_of(t, unknown);
    double stiffness = table_stiffness(p, texel, unknown);
    if (!(range > 0 && stiffness > 0)) return 0;
    uint8_t *code = code_of(t, texel, unknown);
    int old = *code;
    double before = value_of(t, texel, unknown);
    int wanted = nearest(before - gradient[texel * p->n + unknown] / stiffness, range, unknown);
    *code = (uint8_t)wanted;
    while (*code != old && !positive(t, texel)) *code = (uint8_t)(*code + (*code < old ? 1 : -1));
    if (*code == old) return 0;
    table_apply_one(p, texel, unknown, value_of(t, texel, unknown) - before, gradient);
    return 1;
}

static double settle(const table_problem *p, table_asset *t, const double *x, double *z, double *gradient)
{
    int n = p->n, count = p->texels * n;
    double *rhs = need_memory((size_t)count, sizeof *rhs), error = 0;
    table_add_smoothing(p, x, rhs);
    for (int i = 0; i < count; i++) rhs[i] = p->rhs[i] - rhs[i];
    for (int i = 0; i < count; i++) z[i] = value_of(t, i / n, i % n) - x[i];
    table_apply(p, z, gradient);
    for (int i = 0; i < count; i++) gradient[i] -= rhs[i];
    for (int sweep = 0, moved = 1; sweep < SWEEPS && moved; sweep++) {
        moved = 0;
        for (int i = 0; i < count; i++) moved |= improve(p, t, i / n, i % n, gradient);
    }
    for (int i = 0; i < count; i++) error += (value_of(t, i / n, i % n) - x[i]) * (gradient[i] - rhs[i]) / 2;
    free(rhs);
    return error;
}

double table_round(table_asset *t, const table_problem *p, const double *x)
{
    size_t count = (size_t)(p->texels * p->n);
    double *z = need_memory(2 * count, sizeof *z);
    for (int i = 0; i < p->texels * (t->layers == 2 ? 2 : 1); i++) {
        t->rgba[4 * i + 3] = i < p->texels ? 128 : 255;
    }
    for (int i = 0; i < p->texels; i++) round_texel(t, p->model, i, x + i * p->n);
    double error = settle(p, t, x, z, z + count);
    free(z);
    return error;
}
