/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "table_parts.h"

#define DISPLAY_STEPS 3
#define ALBEDO        1e-3 /* weight of relative errors of albedos, in parts of samples */
#define RIDGE         1e-3 /* of table_solve_display; TABLE_RIDGE_CLOSED is that of the other */
#define VECTOR_STEP   4    /* of the samples that weight vectors are found with */
#define RANGES        4
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
    if (o->eps != 0 && !(o->eps >= 1 / ONE_Q16 && o->eps <= 0.5))
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
    return o;
}

static double *fit(const table_model *m, const table_samples *s, const table_sky *sky, const table_asset *t, int steps)
{
    table_hold closed = table_hold_of(s, t, TABLE_RIDGE_CLOSED), display = table_hold_of(s, t, RIDGE);
    double *x = table_start(m, s);
    table_solve_closed(m, s, &closed, x);
    table_solve_display(m, s, sky, &display, steps, x);
    return x;
}

static void add_coefficient(table_model *m, int kind, const double g[3])
{
    m->coefficient[m->coefficients].kind = kind;
    memcpy(m->coefficient[m->coefficients++].g, g, 3 * sizeof *g);
}

static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, grey[3] = {1, 1, 1};

/* One coefficient, along a given W. */
static table_model model_along(const table_asset *t, const double w[3])
{
    table_model m = {.width = t->width, .height = t->height, .power = t->p};
    double most = fmax(fabs(w[0]), fmax(fabs(w[1]), fabs(w[2])));
    const double g[3] = {w[0] / most, w[1] / most, w[2] / most};
    add_coefficient(&m, 0, g);
    return m;
}

/* The model of a tier. Its weight vectors come from a fit with one coefficient of a^2 per channel. */
static table_model model_of(table_tier tier, const table_asset *t, const table_samples *s)
{
    table_model out = {.width = t->width, .height = t->height, .power = t->p}, m = out;
    int vectors = tier == TABLE_FINE ? 2 : 1;
    double w[2][3];
    if (tier == TABLE_RGB) return out;
    for (int k = 0; k < 3; k++) add_coefficient(&m, 0, axis[k]);
    for (int k = 1; k < TABLE_BASES && tier == TABLE_FINE; k++) add_coefficient(&m, k, grey);
    table_samples few = table_samples_thin(s, VECTOR_STEP);
    s = &few;
    table_hold closed = table_hold_of(s, t, TABLE_RIDGE_CLOSED);
    double *x = table_start(&m, s);
    table_solve_closed(&m, s, &closed, x);
    table_solve_display(&m, s, NULL, &closed, 1, x);
    table_weight_vectors(&m, s, x, vectors, w);
    table_samples_free(&few);
    free(x);
    for (int j = 0; j < vectors; j++) add_coefficient(&out, 0, w[j]);
    for (int k = 1; k < TABLE_BASES && tier == TABLE_FINE; k++) add_coefficient(&out, k, grey);
    return out;
}

/* Base roots that no sample asks for (out in the smoothed margins) come back into the material's own range. */
static void clamp_roots(const table_model *m, const table_samples *s, const table_sky *sky, double *x)
{
    double low[3] = {1e9, 1e9, 1e9}, high[3] = {0, 0, 0};
    for (size_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], s->sample[i].root[k]);
            high[k] = fmax(high[k], s->sample[i].root[k]);
        }
    for (int k = 0; k < 3 && sky; k++) high[k] = fmax(high[k], sky->most[k]);
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

static double range_q16(const table_model *m, const double *x, int unknown, double unit)
{
    return fmin(unit * largest(m, x, unknown, 1), WEIGHT_LIMIT);
}

/* The coefficients' ranges as they are stored, shrunk by the factor given. */
static void set_ranges(table_asset *t, const table_model *m, const double *x, double factor)
{
    double unit = 2 * factor / t->ymax;
    double *const vector[2] = {t->w, t->v}, *const scalar[2] = {&t->k2, &t->k4};
    for (int j = 0; j < m->coefficients; j++) {
        double range = range_q16(m, x, 3 + j, unit);
        if (j < 2)
            for (int k = 0; k < 3; k++) vector[j][k] = round_q16(range * m->coefficient[j].g[k]);
        else
            *scalar[j - 2] = round_q16(range);
    }
}

/* Ymax, and D so that RGB + A D reaches the largest root of each channel in the middle of RGB's range. share: Ymax over the
   largest root. */
static void set_base(table_asset *t, const table_model *m, const double *x, double share)
{
    double most = largest(m, x, 0, 3), ymax = t->layers == 2 ? share * most : most;
    t->ymax = most > 0 ? fmax(ceil(ymax * ONE_Q16), 1) / ONE_Q16 : 1;
    for (int k = 0; k < 3 && t->layers == 2; k++)
        t->d[k] = round_q16(fmin(fmax(largest(m, x, k, 1) / t->ymax - 0.5, 0.1), TABLE_MAX_D));
}

static void keep(table_asset *best, const table_asset *tried)
{
    uint8_t *rgba = best->rgba;
    memcpy(rgba, tried->rgba, (size_t)(tried->width * tried->height * tried->layers) * 4);
    *best = *tried;
    best->rgba = rgba;
}

/* Two layers: Ymax in parts of the largest root. Less means finer codes of RGB, but where the channels are far apart the
   brightest one's A D exceeds what the darkest one holds. */
static const double base_share[] = {0.45, 0.7, 1};
#define SHARES (int)(sizeof base_share / sizeof *base_share)

/* Codes of the ranges that draw best: a few large values may be cut so that all others get finer steps. */
static void encode(table_asset *t, const table_model *m, const table_samples *s, const table_sky *sky,
                   const table_options *o, const double *x)
{
    table_hold hold = table_hold_of(s, t, 0);
    table_problem p = table_problem_make(m, s, sky, &hold);
    table_linearize(&p, x);
    double best = HUGE_VAL;
    int share = 0;
    size_t size = (size_t)(t->width * t->height * t->layers) * 4;
    t->rgba = need_memory(size, 1);
    table_asset tried = *t;
    tried.rgba = need_memory(size, 1);
    for (int i = 0; i < SHARES + RANGES - 1; i++) {
        int range = i < SHARES ? 0 : i - SHARES + 1;
        if (o->shared && o->shared->ymax > 0) { /* nothing to choose */
            tried.ymax = o->shared->ymax;
            memcpy(tried.w, o->shared->w, sizeof tried.w);
            table_round(&tried, &p, x);
            keep(t, &tried);
            break;
        }
        if (i > 0 && i < SHARES && t->layers == 1) continue;
        set_base(&tried, m, x, base_share[i < SHARES ? i : share]);
        set_ranges(&tried, m, x, pow(RANGE_STEP, -range));
        double error = table_round(&tried, &p, x);
        if (range > 0 || i == 0) progress_add(o->progress, 1);
        if (error >= best) continue;
        best = error;
        if (i < SHARES) share = i;
        keep(t, &tried);
    }
    free(tried.rgba);
    table_problem_free(&p);
}

/* Albedos count where a peak is too high and narrow for display errors to keep its energy, and only in two layers: one has no
   codes to spare for such heights. */
static int count_albedo(table_sky *sky, const brdf *b, const table_asset *t, const table_samples *s)
{
    if (t->layers < 2) return 0;
    *sky = table_sky_make(b, t, ALBEDO * (double)s->count);
    return fmax(fmax(sky->most[0], sky->most[1]), sky->most[2]) > pow(TABLE_MAX_ROOTED, 1 / t->p);
}

int table_bake(table_asset *out, const brdf *b, const table_options *options, failure *f)
{
    table_options o = with_defaults(options);
    int result = check_options(&o, f);
    if (result) return result;
    if (b->anisotropic)
        return fail(f, FAIL_UNSUPPORTED, "%s: anisotropic: a half-vector table holds isotropic BRDFs", b->name);
    table_asset t = {.width = o.width, .height = o.height, .layers = o.tier == TABLE_FINE ? 2 : 1};
    t.layout = t.layers == 2 ? TABLE_TWO_LAYERS : TABLE_ONE_LAYER;
    t.rows = round_q16(o.shared && o.shared->has_rows ? o.shared->rows : 0.3);
    const table_shared none = {0}, *shared = o.shared ? o.shared : &none;
    double eps = shared->eps > 0 ? shared->eps : o.eps > 0 ? o.eps : 1 / 256.0;
    double e = shared->e > 0 ? shared->e : brdf_exposure(b);
    t.e = isfinite(e) ? round_q16(e) : 1; /* then the samples will tell where b is not finite */
    t.p = round_q16(o.power);
    t.eps = round_q16(eps);
    snprintf(t.name, sizeof t.name, "%s", b->name);
    table_samples samples;
    result = table_samples_make(&samples, b, &t, f);
    if (result) return result;
    if (!shared->has_rows) table_choose_place(&t, &samples, o.eps == 0 && shared->eps == 0);
    table_samples_place(&samples, &t);
    table_sky sky = {0};
    const table_sky *counted = count_albedo(&sky, b, &t, &samples) ? &sky : NULL;
    if (counted) result = table_samples_regrid(&samples, b, &t, f);
    if (result) {
        table_sky_free(&sky);
        table_samples_free(&samples);
        return result;
    }
    progress_begin(o.progress, "steps", 1 + DISPLAY_STEPS + RANGES);
    brdf_albedo(b, t.albedo);
    for (int k = 0; k < 3; k++) t.albedo[k] = round_q16(t.albedo[k]);

    int along = shared->w[0] != 0 || shared->w[1] != 0 || shared->w[2] != 0;
    table_model model = along ? model_along(&t, shared->w) : model_of(o.tier, &t, &samples);
    progress_add(o.progress, 1);
    double *x = fit(&model, &samples, counted, &t, DISPLAY_STEPS);
    clamp_roots(&model, &samples, counted, x);
    progress_add(o.progress, DISPLAY_STEPS);
    encode(&t, &model, &samples, counted, &o, x);
    t.toe = o.power == 4.8 && table_wants_toe(&t, &samples);
    table_sky_free(&sky);
    progress_end(o.progress);
    free(x);
    table_samples_free(&samples);
    *out = t;
    return FAIL_NONE;
}
