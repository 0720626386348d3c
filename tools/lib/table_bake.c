/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "table_parts.h"

#define DISPLAY_STEPS 3
#define SMOOTH        5e-5  /* both in parts of samples per ten texels */
#define SMOOTH_TEXELS 504.0 /* larger tables: second differences shrink with the step, samples per texel too */
#define RIDGE         1e-3
#define RIDGE_CLOSED  1e-7
#define COEFFICIENT   0.5
#define RANGES        7
#define RANGE_STEP    1.3
#define WEIGHT_LIMIT  16.0 /* of |W|, K1, K2: far above what measured materials ask for (10 at most) */
#define ONE_Q16       65536.0

static double round_q16(double x)
{
    return round(x * ONE_Q16) / ONE_Q16;
}

static int check_options(const table_options *o, failure *f)
{
    if (o->width < TABLE_MIN_SIDE || o->width > TABLE_MAX_SIDE || o->height < TABLE_MIN_SIDE ||
        o->height > TABLE_MAX_SIDE)
        return fail(f, FAIL_USAGE, "--size: found %dx%d, expected %d..%d texels a side", o->width, o->height,
                    TABLE_MIN_SIDE, TABLE_MAX_SIDE);
    if (o->power != 4.8 && o->power != 4) return fail(f, FAIL_USAGE, "--power: found %g, expected 4.8 or 4", o->power);
    if (!(o->eps >= 1 / ONE_Q16 && o->eps <= 0.5))
        return fail(f, FAIL_USAGE, "--eps: found %g, expected 2^-16..0.5", o->eps);
    return FAIL_NONE;
}

static table_options with_defaults(const table_options *given)
{
    table_options o = given ? *given : (table_options){0};
    if (!o.width && !o.height) {
        o.width = o.tier == TABLE_FINE ? 32 : 24;
        o.height = 21;
    }
    if (o.power == 0) o.power = 4.8;
    if (o.eps == 0) o.eps = 1.0 / 256;
    return o;
}

static table_hold hold_of(const table_samples *s, const table_asset *t, double ridge)
{
    double texels = t->width * t->height, unit = (double)s->count / (10 * texels);
    double finer = fmax(1, texels / SMOOTH_TEXELS);
    return (table_hold){SMOOTH * unit * finer * finer, ridge * unit, COEFFICIENT};
}

/* Every texel at the mean of the roots, without coefficients. */
static double *start(const table_model *m, const table_samples *s)
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

static double *fit(const table_model *m, const table_samples *s, const table_asset *t, int steps)
{
    table_hold closed = hold_of(s, t, RIDGE_CLOSED), display = hold_of(s, t, RIDGE);
    double *x = start(m, s);
    table_solve_closed(m, s, &closed, x);
    table_solve_display(m, s, &display, steps, x);
    return x;
}

/* Coefficients of a^2, one per channel. */
static void square_coefficients(table_model *m)
{
    m->coefficients = 3;
    for (int k = 0; k < 3; k++) {
        m->coefficient[k].kind = 0;
        m->coefficient[k].g[k] = 1;
    }
}

/* The model of a tier; for the default one this fits its weight vector first. */
static table_model model_of(table_tier tier, const table_asset *t, const table_samples *s)
{
    table_model m = {.width = t->width, .height = t->height, .power = t->p};
    if (tier == TABLE_RGB) return m;
    square_coefficients(&m);
    if (tier == TABLE_FINE) {
        m.coefficient[3].kind = 1;
        for (int k = 0; k < 3; k++) m.coefficient[3].g[k] = 1;
        m.coefficients = 4;
        return m;
    }
    table_hold closed = hold_of(s, t, RIDGE_CLOSED);
    double *x = start(&m, s);
    table_solve_closed(&m, s, &closed, x);
    table_solve_display(&m, s, &closed, 1, x);
    table_model shared = {.width = t->width, .height = t->height, .power = t->p, .coefficients = 1};
    table_weight_vector(&m, s, x, shared.coefficient[0].g);
    free(x);
    return shared;
}

/* Base roots that no sample asks for (out in the smoothed margins) come back into the material's own range. */
static void clamp_roots(const table_model *m, const table_samples *s, double *x)
{
    double low[3] = {1e9, 1e9, 1e9}, high[3] = {0, 0, 0};
    for (size_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], s->sample[i].root[k]);
            high[k] = fmax(high[k], s->sample[i].root[k]);
        }
    int n = table_unknowns(m);
    for (int t = 0; t < m->width * m->height; t++)
        for (int k = 0; k < 3; k++) x[t * n + k] = fmin(fmax(x[t * n + k], fmin(low[k], high[k])), high[k]);
}

static double largest(const table_model *m, const double *x, int first, int count)
{
    double most = 0;
    int n = table_unknowns(m);
    for (int t = 0; t < m->width * m->height; t++)
        for (int k = first; k < first + count; k++) most = fmax(most, fabs(x[t * n + k]));
    return most;
}

/* Ymax, W, K1, K2 as they are stored; the coefficients' ranges are shrunk by the factor given. */
static void set_scales(table_asset *t, const table_model *m, table_tier tier, const double *x, double factor)
{
    double most = largest(m, x, 0, 3);
    t->ymax = most > 0 ? fmax(ceil(most * ONE_Q16), 1) / ONE_Q16 : 1;
    double unit = 2 * factor / t->ymax, limit = WEIGHT_LIMIT;
    if (tier == TABLE_DEFAULT)
        for (int k = 0; k < 3; k++)
            t->w[k] = round_q16(fmin(unit * largest(m, x, 3, 1), limit) * m->coefficient[0].g[k]);
    if (tier == TABLE_FINE) {
        t->k1 = round_q16(fmin(unit * largest(m, x, 3, 3), limit));
        t->k2 = round_q16(fmin(unit * largest(m, x, 6, 1), limit));
    }
}

/* Codes of the range of coefficients that draws best: a few large ones may be cut so that all others get finer steps. */
static void encode(table_asset *t, const table_model *m, const table_samples *s, const table_options *o,
                   const double *x)
{
    table_hold hold = hold_of(s, t, 0);
    table_problem p = table_problem_make(m, s, &hold);
    table_linearize(&p, x);
    double best = HUGE_VAL;
    size_t size = (size_t)(t->width * t->height * t->layers) * 4;
    t->rgba = need_memory(size, 1);
    table_asset tried = *t;
    tried.rgba = need_memory(size, 1);
    for (int i = 0; i < RANGES; i++) {
        set_scales(&tried, m, o->tier, x, pow(RANGE_STEP, -i));
        double error = table_round(&tried, &p, x);
        progress_add(o->progress, 1);
        if (error >= best) continue;
        best = error;
        memcpy(t->rgba, tried.rgba, size);
        uint8_t *rgba = t->rgba;
        *t = tried;
        t->rgba = rgba;
    }
    free(tried.rgba);
    table_problem_free(&p);
}

int table_bake(table_asset *out, const brdf *b, const table_options *options, failure *f)
{
    table_options o = with_defaults(options);
    int result = check_options(&o, f);
    if (result) return result;
    if (b->anisotropic)
        return fail(f, FAIL_UNSUPPORTED, "%s: anisotropic: a half-vector table holds isotropic BRDFs", b->name);
    table_asset t = {.width = o.width, .height = o.height, .layers = o.tier == TABLE_FINE ? 2 : 1};
    double e = brdf_exposure(b);
    t.e = isfinite(e) ? round_q16(e) : 1; /* then the samples will tell where b is not finite */
    t.p = round_q16(o.power);
    t.eps = round_q16(o.eps);
    snprintf(t.name, sizeof t.name, "%s", b->name);
    table_samples samples;
    result = table_samples_make(&samples, b, &t, f);
    if (result) return result;
    progress_begin(o.progress, "steps", 1 + DISPLAY_STEPS + RANGES);
    brdf_albedo(b, t.albedo);
    for (int k = 0; k < 3; k++) t.albedo[k] = round_q16(t.albedo[k]);

    table_model model = model_of(o.tier, &t, &samples);
    progress_add(o.progress, 1);
    double *x = fit(&model, &samples, &t, DISPLAY_STEPS);
    clamp_roots(&model, &samples, x);
    progress_add(o.progress, DISPLAY_STEPS);
    encode(&t, &model, &samples, &o, x);
    progress_end(o.progress);
    free(x);
    table_samples_free(&samples);
    *out = t;
    return FAIL_NONE;
}
