/* SPDX-License-Identifier: MIT */
/* The fits of a table: closed form on weighted roots, and Gauss-Newton steps on display values. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "table_parts.h"

#define SLOPE_FLOOR   0.01 /* closed form: weight of values whose display hardly moves */
#define SLOPE_MIN     0.003
#define SLOPE_MAX     3.0
#define UPDATE_LIMIT  1.5
#define HALVINGS      6
#define SMOOTH        5e-5  /* in parts of samples per ten texels */
#define SMOOTH_TEXELS 504.0 /* larger tables: second differences shrink with the step, samples per texel too */
#define COEFFICIENT   0.5

table_hold table_hold_of(const table_samples *s, const table_asset *t, double ridge)
{
    double texels = t->width * t->height, unit = (double)s->count / (10 * texels);
    double finer = fmax(1, texels / SMOOTH_TEXELS);
    return (table_hold){SMOOTH * unit * finer * finer, ridge * unit, COEFFICIENT};
}

double *table_start(const table_model *m, const table_samples *s)
{
    int n = table_unknowns(m), texels = m->width * m->height;
    double *x = need_memory((size_t)(texels * n), sizeof *x), sum[3] = {0}, weight = 0;
    for (size_t i = 0; i < s->count; i++) {
        for (int k = 0; k < 3; k++) sum[k] += s->sample[i].weight * s->sample[i].root[k];
        weight += s->sample[i].weight;
    }
    for (int t = 0; t < texels; t++)
        for (int k = 0; k < 3; k++) x[t * n + k] = weight > 0 ? sum[k] / weight : 0;
    return x;
}

void table_solve_closed(const table_model *m, const table_samples *s, const table_hold *hold, double *x)
{
    table_problem p = table_problem_make(m, s, NULL, hold);
    double *dx = need_memory((size_t)(p.texels * p.n), sizeof *dx);
    for (size_t i = 0; i < s->count; i++) {
        const table_sample *sample = &s->sample[i];
        double root[3], slope[3], residual[3];
        table_drawn(&p, sample, x, root);
        for (int k = 0; k < 3; k++) {
            slope[k] = fmax(SLOPE_FLOOR, sample->slope[k]);
            residual[k] = slope[k] * (sample->root[k] - root[k]);
        }
        table_accumulate(&p, sample, slope, residual);
    }
    table_solve(&p, x, dx);
    for (int i = 0; i < p.texels * p.n; i++) x[i] += dx[i];
    free(dx);
    table_problem_free(&p);
}

/* Sum of squares that a display step lowers: data and smoothness. */
static double cost(const table_problem *p, const double *x, double *scratch)
{
    double sum = 0;
    for (size_t i = 0; i < p->samples->count; i++) {
        const table_sample *s = &p->samples->sample[i];
        double root[3];
        table_drawn(p, s, x, root);
        for (int k = 0; k < 3; k++) {
            double slope, d = s->display[k] - table_show(s, p->model->power, root[k], &slope);
            sum += s->weight * d * d;
        }
    }
    int count = p->texels * p->n;
    memset(scratch, 0, (size_t)count * sizeof *scratch);
    table_add_smoothing(p, x, scratch);
    for (int i = 0; i < count; i++) sum += x[i] * scratch[i];
    if (p->sky) {
        double residual[TABLE_SKY_TERMS];
        table_sky_residuals(p, x, NULL, residual);
        for (int k = 0; k < TABLE_SKY_TERMS; k++) sum += residual[k] * residual[k];
    }
    return sum;
}

void table_linearize(table_problem *p, const double *x)
{
    double power = p->model->power;
    memset(p->block, 0, (size_t)(p->texels * TABLE_STENCIL) * (size_t)(p->n * p->n) * sizeof *p->block);
    memset(p->rhs, 0, (size_t)(p->texels * p->n) * sizeof *p->rhs);
    for (size_t i = 0; i < p->samples->count; i++) {
        const table_sample *s = &p->samples->sample[i];
        double root[3], slope[3], residual[3];
        table_drawn(p, s, x, root);
        for (int k = 0; k < 3; k++) {
            residual[k] = s->display[k] - table_show(s, power, root[k], &slope[k]);
            slope[k] = fmin(fmax(slope[k], SLOPE_MIN), SLOPE_MAX);
        }
        table_accumulate(p, s, slope, residual);
    }
    if (p->sky) {
        double residual[TABLE_SKY_TERMS];
        table_sky_residuals(p, x, p->pull, residual);
        for (int i = 0; i < p->texels * p->n; i++) p->rhs[i] += table_pulled(p, i, residual);
    }
}

void table_solve_display(const table_model *m, const table_samples *s, const table_sky *sky, const table_hold *hold,
                         int steps, double *x)
{
    table_problem p = table_problem_make(m, s, sky, hold);
    int count = p.texels * p.n;
    double *dx = need_memory(3 * (size_t)count, sizeof *dx), *next = dx + count, *scratch = next + count;
    double best = cost(&p, x, scratch);
    for (int step = 0; step < steps; step++) {
        table_linearize(&p, x);
        table_solve(&p, x, dx);
        for (int i = 0; i < count; i++) dx[i] = fmin(fmax(dx[i], -UPDATE_LIMIT), UPDATE_LIMIT);
        double scale = 1;
        for (int half = 0; half < HALVINGS; half++, scale /= 2) {
            for (int i = 0; i < count; i++) next[i] = x[i] + scale * dx[i];
            double reached = cost(&p, next, scratch);
            if (reached >= best) continue;
            best = reached;
            memcpy(x, next, (size_t)count * sizeof *x);
            break;
        }
    }
    free(dx);
    table_problem_free(&p);
}

/* Unit eigenvector of the largest eigenvalue of a symmetric positive 3 x 3 matrix: its high powers have nothing else
   left. The eigenvalue's share is taken out of m. */
static void take_leading_eigenvector(double m[9], double out[3])
{
    double high[9], value = 0, length = 0;
    memcpy(high, m, sizeof high);
    for (int round = 0; round < 30; round++) {
        double square[9] = {0}, trace = high[0] + high[4] + high[8];
        if (!(trace > 0)) break;
        for (int i = 0; i < 27; i++)
            square[i / 9 * 3 + i % 3] += high[i / 9 * 3 + i / 3 % 3] * high[i / 3 % 3 * 3 + i % 3];
        for (int i = 0; i < 9; i++) high[i] = square[i] / (trace * trace);
    }
    int widest = high[0] >= high[4] ? (high[0] >= high[8] ? 0 : 2) : (high[4] >= high[8] ? 1 : 2);
    for (int k = 0; k < 3; k++) length += high[3 * k + widest] * high[3 * k + widest];
    for (int k = 0; k < 3; k++) out[k] = length > 0 ? high[3 * k + widest] / sqrt(length) : 0;
    for (int i = 0; i < 9; i++) value += out[i / 3] * m[i] * out[i % 3];
    for (int i = 0; i < 9; i++) m[i] -= value * out[i / 3] * out[i % 3];
}

void table_weight_vectors(const table_model *m, const table_samples *s, const double *x, int count, double w[2][3])
{
    table_hold none = {0, 0, 0};
    table_problem p = table_problem_make(m, s, NULL, &none);
    double *weight = need_memory((size_t)p.texels, sizeof *weight), sum[9] = {0};
    for (size_t i = 0; i < s->count; i++) {
        const table_sample *sample = &s->sample[i];
        double square = 0, basis = sample->basis[m->coefficient[0].kind];
        int index[4];
        for (int k = 0; k < 3; k++) square += pow(fmax(SLOPE_FLOOR, sample->slope[k]) * basis, 2) / 3;
        table_corners(&sample->at, p.width, index);
        for (int c = 0; c < 4; c++)
            weight[index[c]] += sample->weight * square * sample->at.weight[c] * sample->at.weight[c];
    }
    for (int t = 0; t < p.texels; t++)
        for (int i = 0; i < 9; i++) sum[i] += weight[t] * x[t * p.n + 3 + i / 3] * x[t * p.n + 3 + i % 3];
    for (int j = 0; j < count; j++) {
        take_leading_eigenvector(sum, w[j]);
        double most = fmax(fabs(w[j][0]), fmax(fabs(w[j][1]), fabs(w[j][2])));
        double sign = w[j][0] + w[j][1] + w[j][2] < 0 ? -1 : 1;
        for (int k = 0; k < 3; k++) w[j][k] = most > 0 ? sign * w[j][k] / most : k == j;
    }
    free(weight);
    table_problem_free(&p);
}
