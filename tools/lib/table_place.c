/* SPDX-License-Identifier: MIT */
/* Where columns and rows go: eps and the row curve that suit a BRDF, by small fits on few samples. */
#include <math.h>
#include <stdlib.h>

#include "table_parts.h"

#define STEP 4 /* every fourth sample is enough to tell places apart */

/* Error of frames 2 stops down, and of the worst frame, beside the mean over frames. */
#define DIM_SHARE   0.5
#define WORST_SHARE 0.2

/* The usual place stays if others are hardly better on these samples. */
#define GAIN 0.93

/* Larger tables are judged by what one of this size does. */
#define MOST_COLUMNS 24
#define MOST_ROWS    21

/* Candidates beside the usual 2^-8 and 0.3: eps = 2^-bits, row curve. 2^-12 is the least that the CPU renderer takes, and
   that fp16 draws well even where it has no numbers below 2^-14 (they cost 0.25 dB then, of 53). */
static const int eps_bits[] = {4, 6, 10, 12};
static const double row_curve[] = {-0.8, -0.5, -0.2, 0.1, 0.6, 0.9};
#define EPS_COUNT (int)(sizeof eps_bits / sizeof *eps_bits)
#define ROW_COUNT (int)(sizeof row_curve / sizeof *row_curve)

/* Squared display error of a sample, full and 2 stops down. */
static double squared_error(const table_sample *s, const table_model *m, const double root[3])
{
    table_sample dim = *s;
    double sum = 0, slope;
    dim.factor24 *= TABLE_DIM24;
    for (int k = 0; k < 3; k++) {
        double full = fmin(1, s->display[k]) - fmin(1, table_show(s, m->power, root[k], &slope));
        double low = fmin(1, table_show(&dim, m->power, s->root[k], &slope)) -
                     fmin(1, table_show(&dim, m->power, root[k], &slope));
        sum += full * full + DIM_SHARE * low * low;
    }
    return sum / 3;
}

/* Unlit pixels have no samples and no error: frame 0, which is lit all over, says how many pixels a frame has. */
static double judge(const table_model *m, const table_samples *s, const double *x)
{
    table_hold none = {0, 0, 0};
    table_problem p = table_problem_make(m, s, NULL, &none);
    double sum[TABLE_FRAMES] = {0}, pixels = 0, mean = 0, worst = 0;
    for (size_t i = 0; i < s->count; i++) {
        const table_sample *sample = &s->sample[i];
        double root[3];
        if (sample->frame < 0) continue;
        table_drawn(&p, sample, x, root);
        sum[sample->frame] += squared_error(sample, m, root);
        pixels += sample->frame == 0;
    }
    for (int i = 0; i < TABLE_FRAMES; i++) {
        mean += sum[i] / TABLE_FRAMES;
        worst = fmax(worst, sum[i]);
    }
    table_problem_free(&p);
    return (mean + WORST_SHARE * worst) / fmax(1, pixels);
}

static double try_place(const table_model *m, table_samples *s, const table_asset *t)
{
    table_hold hold = table_hold_of(s, t, TABLE_RIDGE_CLOSED);
    table_samples_place(s, t);
    double *x = table_start(m, s), error;
    table_solve_closed(m, s, &hold, x);
    table_solve_display(m, s, NULL, &hold, 1, x);
    error = judge(m, s, x);
    free(x);
    return error;
}

void table_choose_place(table_asset *t, const table_samples *s, int choose_eps)
{
    table_samples few = table_samples_thin(s, STEP);
    table_asset tried = *t;
    tried.width = t->width < MOST_COLUMNS ? t->width : MOST_COLUMNS;
    tried.height = t->height < MOST_ROWS ? t->height : MOST_ROWS;
    table_model m = {.width = tried.width,
                     .height = tried.height,
                     .power = t->p,
                     .coefficients = 1,
                     .coefficient = {{.kind = 0, .g = {1, 1, 1}}}};
    double best = GAIN * try_place(&m, &few, &tried);
    for (int i = 0; i < EPS_COUNT && choose_eps; i++) {
        tried.eps = ldexp(1, -eps_bits[i]);
        double error = try_place(&m, &few, &tried);
        if (error >= best) continue;
        best = error;
        t->eps = tried.eps;
    }
    tried.eps = t->eps;
    for (int i = 0; i < ROW_COUNT; i++) {
        tried.rows = round(row_curve[i] * 65536) / 65536;
        double error = try_place(&m, &few, &tried);
        if (error >= best) continue;
        best = error;
        t->rows = tried.rows;
    }
    table_samples_free(&few);
}
