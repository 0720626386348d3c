/* SPDX-License-Identifier: MIT */
#include "lafortune_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    level_views(p);
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

/* How many starts the solver may take: for every lobe 6 from its grid, and each earlier one split. */
static double starts_for(int lobes)
{
    return 6 * lobes + lobes * (lobes - 1) / 2;
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
    out->per_channel = options->per_channel;
    out->anisotropic = b->anisotropic;
    snprintf(out->name, sizeof out->name, "%s", b->name);
    int code = evaluate(b, &p, f);
    if (!code) {
        progress_begin(options->progress, "starts", (options->per_channel ? 3 : 1) * starts_for(out->lobes));
        if (options->per_channel)
            fit_channels(out, &p, &solver);
        else
            fit_shared(out, &p, &solver);
        progress_end(options->progress);
    }
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
    double squares = 0, total = 0;
    for (int i = 0; i < p.samples.count && !code; i++) {
        double value[3];
        other->eval(other, p.direction[i], p.direction[i] + 3, value);
        for (int c = 0; c < 3; c++) {
            double truth = p.samples.weight[i] * p.value[3 * (size_t)i + (size_t)c];
            double difference = p.samples.weight[i] * value[c] - truth;
            squares += difference * difference;
            total += truth * truth;
        }
    }
    *error = sqrt(squares / total);
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
    json_begin(j, "residual_by_lobes", '[');
    for (int k = 0; k <= fit->lobes; k++) json_real(j, NULL, fit->residual[k]);
    json_end(j, ']');
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
