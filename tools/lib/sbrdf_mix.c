/* SPDX-License-Identifier: MIT */
#include "sbrdf_mix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "failure.h"

static const double pi = 3.14159265358979323846;
static const double good_enough = 0.01; /* relative error at which no other start is tried */

struct sbrdf_mixer {
    int lobes;
    lafortune_pairs pairs;
    lafortune_problem *problem;
};

sbrdf_mixer *sbrdf_mixer_make(int lobes, int anisotropic)
{
    const lafortune_options options = {.anisotropic = anisotropic,
                                       .n_min = SBRDF_EXPONENT_LEAST,
                                       .n_max = SBRDF_EXPONENT_MOST,
                                       .grazing_max = SBRDF_GRAZING_MAX,
                                       .tolerance = 1e-4,
                                       .starts = 2,
                                       .evaluations = 30};
    sbrdf_mixer *m = need_memory(1, sizeof *m);
    m->lobes = lobes;
    m->pairs = lafortune_pairs_make(LAFORTUNE_COARSE, anisotropic);
    m->problem = lafortune_problem_make(&m->pairs.samples, 3, lobes, &options);
    return m;
}

void sbrdf_mixer_free(sbrdf_mixer *m)
{
    if (!m) return;
    lafortune_pairs_free(&m->pairs);
    lafortune_problem_free(m->problem);
    free(m);
}

/* ---- sampling --------------------------------------------------------------------------------------- */

static void turned(const double axis[2], const double in[3], double out[3])
{
    out[0] = axis[0] * in[0] - axis[1] * in[1];
    out[1] = axis[1] * in[0] + axis[0] * in[1];
    out[2] = in[2];
}

/* Add weight x f_r of a texel at all pairs, whose directions are meant along the axis. */
static void add_texel(sbrdf_mixer *m, const sbrdf_texel *t, const double axis[2], double weight)
{
    for (int i = 0; i < m->pairs.samples.count; i++) {
        double l[3], v[3], f_r[3];
        turned(axis, m->pairs.direction[i], l);
        turned(axis, m->pairs.direction[i] + 3, v);
        sbrdf_texel_eval(t, l, v, f_r);
        for (int c = 0; c < 3; c++) m->pairs.value[3 * i + c] += weight * f_r[c];
    }
}

/* Directions of anisotropy are axes: opposite ones are the same, so angles are doubled to find their mean. */
static void mean_axis(const sbrdf_part *parts, int count, double axis[2])
{
    double twice[2] = {0, 0}, sum[2] = {0, 0};
    for (int i = 0; i < count; i++) {
        const double *d = parts[i].texel->direction, w = parts[i].weight;
        twice[0] += w * (d[0] * d[0] - d[1] * d[1]);
        twice[1] += w * 2 * d[0] * d[1];
        for (int k = 0; k < 2; k++) sum[k] += w * d[k];
    }
    double angle = hypot(twice[0], twice[1]) > 1e-9 ? atan2(twice[1], twice[0]) / 2 : 0;
    double sign = cos(angle) * sum[0] + sin(angle) * sum[1] < 0 ? -1 : 1;
    axis[0] = sign * cos(angle);
    axis[1] = sign * sin(angle);
}

/* Mean f_r, weighted with opacity too (if all is transparent: without), and mean opacity. */
static void average(sbrdf_mixer *m, const sbrdf_part *parts, int count, sbrdf_texel *out)
{
    double opaque = 0;
    mean_axis(parts, count, out->direction);
    for (int i = 0; i < count; i++) opaque += parts[i].weight * parts[i].texel->alpha;
    memset(m->pairs.value, 0, sizeof(double[3]) * (size_t)m->pairs.samples.count);
    for (int i = 0; i < count; i++)
        add_texel(m, parts[i].texel, out->direction,
                  parts[i].weight * (opaque > 0 ? parts[i].texel->alpha / opaque : 1));
    out->alpha = fmin(opaque, 1);
}

/* ---- starts ----------------------------------------------------------------------------------------- */

void sbrdf_mean_parameters(const sbrdf_part *parts, int count, sbrdf_texel *out)
{
    memset(out, 0, sizeof *out);
    out->brdf.lobes = parts[0].texel->brdf.lobes;
    for (int i = 0; i < count; i++) {
        const sbrdf_texel *t = parts[i].texel;
        double w = parts[i].weight;
        out->alpha += w * t->alpha;
        for (int k = 0; k < 2; k++) out->direction[k] += w * t->direction[k];
        for (int c = 0; c < 3; c++) out->brdf.kd[c] += w * t->brdf.kd[c];
        for (int j = 0; j < out->brdf.lobes; j++) {
            lafortune_shared_lobe *lobe = &out->brdf.lobe[j];
            for (int c = 0; c < 3; c++) {
                lobe->c[c] += w * t->brdf.lobe[j].c[c];
                lobe->ks[c] += w * t->brdf.lobe[j].ks[c];
            }
            lobe->n += w * sqrt(t->brdf.lobe[j].n);
        }
    }
    for (int j = 0; j < out->brdf.lobes; j++) out->brdf.lobe[j].n *= out->brdf.lobe[j].n;
}

/* About the radiance under light from everywhere. */
static double strength(const lafortune_shared *s)
{
    double sum = s->kd[0] + s->kd[1] + s->kd[2];
    for (int j = 0; j < s->lobes; j++)
        sum += pi * (s->lobe[j].ks[0] + s->lobe[j].ks[1] + s->lobe[j].ks[2]) / (s->lobe[j].n + 1);
    return sum;
}

typedef struct best_fit {
    double error;
    lafortune_shared brdf;
} best_fit;

static void try_start(sbrdf_mixer *m, const lafortune_shared *start, best_fit *best)
{
    lafortune_shared trial = *start;
    double error = lafortune_refine(m->problem, m->pairs.value, &trial);
    if (!(error < best->error)) return;
    best->error = error;
    best->brdf = trial;
}

/* From the parameters' mean, from the strongest hint, and if neither will do, from the solver's own grid. */
static void fit_mean(sbrdf_mixer *m, const sbrdf_part *hints, int count, lafortune_shared *out)
{
    best_fit best = {.error = HUGE_VAL};
    sbrdf_texel middle;
    int strongest = 0;
    sbrdf_mean_parameters(hints, count, &middle);
    try_start(m, &middle.brdf, &best);
    for (int i = 1; i < count; i++)
        if (hints[i].weight * strength(&hints[i].texel->brdf) >
            hints[strongest].weight * strength(&hints[strongest].texel->brdf))
            strongest = i;
    if (best.error > good_enough) try_start(m, &hints[strongest].texel->brdf, &best);
    if (best.error > 3 * good_enough) {
        lafortune_shared trial;
        double error = lafortune_solve(m->problem, m->pairs.value, m->lobes, &trial, NULL);
        if (error < best.error) best.brdf = trial;
    }
    *out = best.brdf;
}

static int lobe_order(const void *a, const void *b)
{
    const lafortune_shared_lobe *p = a, *q = b;
    int p_lit = p->ks[0] + p->ks[1] + p->ks[2] > 0, q_lit = q->ks[0] + q->ks[1] + q->ks[2] > 0;
    return p_lit != q_lit ? q_lit - p_lit : (p->n < q->n) - (p->n > q->n);
}

void sbrdf_sort_lobes(sbrdf_texel *t)
{
    qsort(t->brdf.lobe, (size_t)t->brdf.lobes, sizeof *t->brdf.lobe, lobe_order);
}

void sbrdf_mix(sbrdf_mixer *m, const sbrdf_part *parts, int count, const sbrdf_part *hints, int hint_count,
               sbrdf_texel *out)
{
    average(m, parts, count, out);
    fit_mean(m, hints, hint_count, &out->brdf);
    sbrdf_sort_lobes(out);
}
