/* SPDX-License-Identifier: MIT */
#include "lafortune_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pixels.h"

static double squares_of(const lafortune_pairs *p, int channel, int from, int to)
{
    double sum = 0;
    for (int i = from; i < to; i++) {
        double value = p->samples.weight[i] * p->value[3 * (size_t)i + (size_t)channel];
        sum += value * value;
    }
    return sum;
}

/* Every view counts the same: at grazing angles f_r cos is so large that the others would not be seen. */
static void level_views(lafortune_pairs *p)
{
    for (int k = 0, from = 0; k < p->views; from = p->view_end[k++]) {
        double squares = 0;
        for (int c = 0; c < 3; c++) squares += squares_of(p, c, from, p->view_end[k]);
        for (int i = from; i < p->view_end[k]; i++) p->samples.weight[i] *= squares > 0 ? 1 / sqrt(squares) : 0;
    }
}

/* Values where b has them; pairs without data count for nothing. */
static int evaluate(const brdf *b, lafortune_pairs *p, failure *f)
{
    int finite = 1, lit = 0;
#pragma omp parallel for schedule(static) reduction(&& : finite) reduction(|| : lit)
    for (int i = 0; i < p->samples.count; i++) {
        double *value = p->value + 3 * (size_t)i;
        if (!b->eval(b, p->direction[i], p->direction[i] + 3, value)) p->samples.weight[i] = 0;
        for (int c = 0; c < 3; c++) {
            finite = finite && isfinite(value[c]);
            lit = lit || value[c] * p->samples.weight[i] > 0;
        }
    }
    if (!finite) return fail(f, FAIL_INVALID, "%s: found a value that is not finite, expected numbers", b->name);
    if (!lit) return fail(f, FAIL_INVALID, "%s: found no reflectance above 0, expected some to fit", b->name);
    return 0;
}

static void take_channel(lafortune_fit *out, const lafortune_shared *s, int from, int to)
{
    for (int c = from; c < to; c++) {
        out->kd[c] = s->kd[c];
        for (int i = 0; i < s->lobes; i++) {
            lafortune_lobe *lobe = &out->lobe[i];
            lobe->ks[c] = s->lobe[i].ks[c];
            lobe->cx[c] = s->lobe[i].c[0];
            lobe->cy[c] = s->lobe[i].c[1];
            lobe->cz[c] = s->lobe[i].c[2];
            lobe->n[c] = s->lobe[i].n;
        }
    }
}

static int is_grey(const lafortune_pairs *p)
{
    for (int i = 0; i < p->samples.count; i++) {
        const double *value = p->value + 3 * (size_t)i;
        if (value[0] != value[1] || value[0] != value[2]) return 0;
    }
    return 1;
}

/* One channel's values alone; the caller frees them. */
static double *channel_values(const lafortune_pairs *p, int c)
{
    double *value = need_memory((size_t)p->samples.count, sizeof *value);
    for (int i = 0; i < p->samples.count; i++) value[i] = p->value[3 * (size_t)i + (size_t)c];
    return value;
}

/* Channels that are all the same are fitted as one, in a third of the time. */
static void fit_shared(lafortune_fit *out, const lafortune_pairs *p, const lafortune_options *options)
{
    lafortune_shared s;
    double *grey = is_grey(p) ? channel_values(p, 0) : NULL;
    lafortune_problem *problem = lafortune_problem_make(&p->samples, grey ? 1 : 3, out->lobes, options);
    lafortune_solve(problem, grey ? grey : p->value, out->lobes, &s, out->residual);
    lafortune_problem_free(problem);
    free(grey);
    take_channel(out, &s, 0, 3);
}

static void fit_channels(lafortune_fit *out, const lafortune_pairs *p, const lafortune_options *options)
{
    double squares[3], error[3][LAFORTUNE_MAX_LOBES + 1], total = 0;
    lafortune_shared s[3];
#pragma omp parallel for schedule(dynamic)
    for (int c = 0; c < 3; c++) {
        double *value = channel_values(p, c);
        lafortune_problem *problem = lafortune_problem_make(&p->samples, 1, out->lobes, options);
        lafortune_solve(problem, value, out->lobes, &s[c], error[c]);
        lafortune_problem_free(problem);
        free(value);
    }
    for (int c = 0; c < 3; c++) {
        squares[c] = squares_of(p, c, 0, p->samples.count);
        total += squares[c];
        take_channel(out, &s[c], c, c + 1);
    }
    for (int k = 0; k <= out->lobes; k++) {
        double sum = 0;
        for (int c = 0; c < 3; c++) sum += squares[c] * error[c][k] * error[c][k];
        out->residual[k] = sqrt(sum / total);
    }
}

/* ---- what is seen ------------------------------------------------------------------------------------ */

/* How much of a difference of radiance shows: slope of the display curve between two radiances, two stops beyond white. */
static double display_slope(double a, double b)
{
    enum { WHITE = 4 };
    if (fabs(a - b) < 1e-4) b = a + 1e-4;
    return fabs((srgb_encode(fmin(fmax(a, 0), WHITE)) - srgb_encode(fmin(fmax(b, 0), WHITE))) / (a - b));
}

/* Weights so that squared residuals are about those of display codes, for a fit near the last one (NULL: near the truth). */
static void weigh_display(lafortune_pairs *p, const double *plain, double exposure, const lafortune_shared *last)
{
    static const double pi = 3.14159265358979323846;
    for (int i = 0; i < p->samples.count; i++) {
        const double *value = p->value + 3 * (size_t)i;
        double scale = pi * exposure * p->direction[i][2], squares = 0, f_r[3];
        if (last) lafortune_shared_eval(last, p->direction[i], p->direction[i] + 3, f_r);
        for (int c = 0; c < 3; c++) {
            double slope = display_slope(scale * value[c], scale * (last ? f_r[c] : value[c]));
            squares += slope * slope / 3;
        }
        p->samples.weight[i] = plain[i] * sqrt(squares + 1e-6); /* what is beyond white still counts a little */
    }
}

/* Squared difference of display codes over the pairs, at the exposure and two stops down. */
static double display_error(const lafortune_pairs *p, const double *plain, double exposure, const lafortune_shared *fit)
{
    static const double pi = 3.14159265358979323846;
    double sum = 0;
    for (int i = 0; i < p->samples.count; i++) {
        double f_r[3], w = plain[i] / p->direction[i][2]; /* solid angles alone */
        lafortune_shared_eval(fit, p->direction[i], p->direction[i] + 3, f_r);
        for (int k = 0; k < 6; k++) {
            double scale = pi * exposure * p->direction[i][2] / (k < 3 ? 1 : 4);
            double off =
                srgb_encode(fmin(scale * f_r[k % 3], 1)) - srgb_encode(fmin(scale * p->value[3 * i + k % 3], 1));
            sum += w * w * off * off;
        }
    }
    return sum;
}

/* From the fit to radiance, and from one to what is seen near the truth: rounds of weights and fits, the best kept. */
static void fit_display(lafortune_fit *out, lafortune_pairs *p, const brdf *b, const lafortune_options *options)
{
    enum { ROUNDS = 3 };
    size_t size = (size_t)p->samples.count * sizeof(double);
    double exposure = brdf_exposure(b), *plain = need_memory(size, 1), least = HUGE_VAL;
    lafortune_shared best = {0}, s;
    memcpy(plain, p->samples.weight, size);
    for (int start = 0; start < 2; start++)
        for (int round = 0; round < ROUNDS; round++) {
            if (start == 0 && round == 0)
                level_views(p);
            else
                weigh_display(p, plain, exposure, round ? &s : NULL);
            lafortune_problem *problem = lafortune_problem_make(&p->samples, 3, out->lobes, options);
            if (round)
                lafortune_refine(problem, p->value, &s);
            else
                lafortune_solve(problem, p->value, out->lobes, &s, NULL);
            lafortune_problem_free(problem);
            double error = display_error(p, plain, exposure, &s);
            if (error < least) {
                least = error;
                best = s;
            }
        }
    memcpy(p->samples.weight, plain, size);
    free(plain);
    take_channel(out, &best, 0, 3);
}

/* How many starts the solver may take: for every lobe 6 from its grid, and each earlier one split. */
static double starts_for(int lobes)
{
    return 6 * lobes + lobes * (lobes - 1) / 2;
}

/* Relative error over the pairs, whose views are level. */
static double error_over(const lafortune_pairs *p, const brdf *other)
{
    double squares = 0, total = 0;
    for (int i = 0; i < p->samples.count; i++) {
        double value[3];
        other->eval(other, p->direction[i], p->direction[i] + 3, value);
        for (int c = 0; c < 3; c++) {
            double truth = p->samples.weight[i] * p->value[3 * (size_t)i + (size_t)c];
            double difference = p->samples.weight[i] * value[c] - truth;
            squares += difference * difference;
            total += truth * truth;
        }
    }
    return sqrt(squares / total);
}

static double error_of_fit(const lafortune_fit *fit, const lafortune_pairs *p)
{
    brdf *drawn = lafortune_fit_open(fit);
    double error = error_over(p, drawn);
    brdf_close(drawn);
    return error;
}

int lafortune_fit_brdf(lafortune_fit *out, const brdf *b, const lafortune_fit_options *options, failure *f)
{
    lafortune_options solver = {.anisotropic = b->anisotropic,
                                .n_min = options->n_min,
                                .n_max = options->n_max,
                                .grazing_max = options->grazing_max,
                                .progress = options->progress};
    lafortune_pairs p = lafortune_pairs_make(LAFORTUNE_FINE, b->anisotropic);
    memset(out, 0, sizeof *out);
    out->lobes = options->lobes ? options->lobes : LAFORTUNE_MAX_LOBES;
    out->per_channel = options->per_channel && !options->display;
    out->display = options->display;
    out->anisotropic = b->anisotropic;
    snprintf(out->name, sizeof out->name, "%s", b->name);
    int code = evaluate(b, &p, f);
    if (!code) {
        progress_begin(options->progress, "starts", (options->per_channel ? 3 : 1) * starts_for(out->lobes));
        if (options->display) fit_display(out, &p, b, &solver);
        level_views(&p);
        if (!options->display && options->per_channel) fit_channels(out, &p, &solver);
        if (!options->display && !options->per_channel) fit_shared(out, &p, &solver);
        progress_end(options->progress);
    }
    if (!code && options->display) out->residual[out->lobes] = error_of_fit(out, &p);
    lafortune_pairs_free(&p);
    return code;
}

brdf *lafortune_fit_open(const lafortune_fit *fit)
{
    brdf *b = lafortune_brdf(fit->kd, fit->lobe, (size_t)fit->lobes);
    snprintf(b->name, sizeof b->name, "fit of %.240s", fit->name);
    snprintf(b->description, sizeof b->description, "Lafortune model, %d lobe%s fitted to %.200s", fit->lobes,
             fit->lobes == 1 ? "" : "s", fit->name);
    return b;
}

int lafortune_fit_error(const brdf *b, const brdf *other, double *error, failure *f)
{
    lafortune_pairs p = lafortune_pairs_make(LAFORTUNE_FINE, b->anisotropic || other->anisotropic);
    int code = evaluate(b, &p, f);
    if (!code) {
        level_views(&p);
        *error = error_over(&p, other);
    }
    lafortune_pairs_free(&p);
    return code;
}

/* ---- texts ---------------------------------------------------------------------------------------------------------- */

static void append(char *text, size_t size, const char *name, const double value[3])
{
    size_t used = strlen(text);
    if (value[0] == value[1] && value[1] == value[2])
        snprintf(text + used, size - used, "%s%s=%.6g", used > 10 ? "," : "", name, value[0]);
    else
        snprintf(text + used, size - used, "%s%s=%.6g/%.6g/%.6g", used > 10 ? "," : "", name, value[0], value[1],
                 value[2]);
}

void lafortune_fit_name(const lafortune_fit *fit, char *text, size_t size)
{
    snprintf(text, size, "lafortune:");
    append(text, size, "kd", fit->kd);
    for (int i = 0; i < fit->lobes; i++) {
        const lafortune_lobe *lobe = &fit->lobe[i];
        append(text, size, "cx", lobe->cx);
        if (fit->anisotropic) append(text, size, "cy", lobe->cy);
        append(text, size, "cz", lobe->cz);
        append(text, size, "n", lobe->n);
        append(text, size, "ks", lobe->ks);
    }
}

static void json_rgb(json *j, const char *key, const double value[3])
{
    json_begin(j, key, '[');
    for (int c = 0; c < 3; c++) json_real(j, NULL, value[c]);
    json_end(j, ']');
}

void lafortune_fit_json(const lafortune_fit *fit, json *j)
{
    json_text(j, "brdf", fit->name);
    json_text(j, "model", "lafortune");
    json_int(j, "lobes", fit->lobes);
    json_bool(j, "shared", !fit->per_channel);
    json_real(j, "residual", fit->residual[fit->lobes]);
    json_bool(j, "display", fit->display);
    if (!fit->display) {
        json_begin(j, "residual_by_lobes", '[');
        for (int k = 0; k <= fit->lobes; k++) json_real(j, NULL, fit->residual[k]);
        json_end(j, ']');
    }
    json_rgb(j, "kd", fit->kd);
    json_begin(j, "lobe", '[');
    for (int i = 0; i < fit->lobes; i++) {
        const lafortune_lobe *lobe = &fit->lobe[i];
        json_begin(j, NULL, '{');
        json_rgb(j, "ks", lobe->ks);
        json_rgb(j, "cx", lobe->cx);
        json_rgb(j, "cy", lobe->cy);
        json_rgb(j, "cz", lobe->cz);
        json_rgb(j, "n", lobe->n);
        json_end(j, '}');
    }
    json_end(j, ']');
}
