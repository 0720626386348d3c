/* SPDX-License-Identifier: MIT */
#include "display_fit.h"

#include <cminpack-1/cminpack.h>
#include <math.h>
#include <stdlib.h>

#include "metric.h"
#include "vec3.h"

#define PI 3.14159265358979323846

/* Pixels of the upper half of the metric's sphere (isotropic materials look the same below), every 10 degrees of light: all of
   them about the highlight, which may be few pixels wide, and the middle one of 3 x 3 elsewhere. */
enum { SIZE = METRIC_SIZE, LIGHTS = 18 };
#define HIGHLIGHT 0.99 /* n.h above it: within 8 degrees of the mirror direction's normal */

static void show(double exposure, const brdf *b, const display_sample *s, double shown[3])
{
    double f_cos[3];
    brdf_eval_cosine(b, s->to_light, s->to_eye, f_cos);
    for (int c = 0; c < 3; c++) shown[c] = srgb_encode(fmin(1, PI * exposure * f_cos[c]));
}

display_fit display_fit_begin(const brdf *b, double exposure)
{
    display_fit fit = {.exposure = exposure, .sample = need_memory(SIZE * SIZE / 2 * LIGHTS, sizeof *fit.sample)};
    for (int i = 0; i < SIZE * SIZE / 2 * LIGHTS; i++) {
        display_sample *s = &fit.sample[fit.count];
        double normal[3];
        if (!metric_normal(i % SIZE, i / SIZE % (SIZE / 2), SIZE, normal)) continue;
        metric_local(normal, 10.0 * (i / (SIZE * SIZE / 2)), s->to_light, s->to_eye);
        if (s->to_light[2] <= 0) continue;
        double n_dot_h = (s->to_light[2] + s->to_eye[2]) / sqrt(2 + 2 * dot3(s->to_light, s->to_eye));
        int is_highlight = n_dot_h > HIGHLIGHT, is_middle = i % SIZE % 3 == 1 && i / SIZE % (SIZE / 2) % 3 == 1;
        if (!is_highlight && !is_middle) continue;
        s->weight = is_highlight ? 1.0 / 3 : 1;
        show(exposure, b, s, s->shown);
        fit.count++;
    }
    return fit;
}

void display_fit_end(display_fit *fit)
{
    free(fit->sample);
    *fit = (display_fit){0};
}

typedef struct problem {
    const display_fit *fit;
    display_model *make;
} problem;

/* cminpack's residuals; a negative answer stops it. */
static int residuals(void *user, int m, int n, const double *x, double *out, int flag)
{
    const problem *p = user;
    (void)m;
    (void)flag;
    brdf *b = p->make(x, n);
    if (!b) return -1;
    for (int i = 0; i < p->fit->count; i++) {
        double shown[3];
        show(p->fit->exposure, b, &p->fit->sample[i], shown);
        for (int c = 0; c < 3; c++) out[3 * i + c] = p->fit->sample[i].weight * (shown[c] - p->fit->sample[i].shown[c]);
    }
    brdf_close(b);
    return 0;
}

double display_fit_run(const display_fit *fit, display_model *make, double *x, int count)
{
    int m = 3 * fit->count, evaluations = 0;
    problem p = {fit, make};
    double *residual = need_memory((size_t)m, sizeof *residual), *scale = need_memory((size_t)count, sizeof *scale);
    double *jacobian = need_memory((size_t)(m * count), sizeof *jacobian);
    double *work = need_memory((size_t)(m + 4 * count), sizeof *work), sum = 0;
    int *pivot = need_memory((size_t)count, sizeof *pivot);
    lmdif(residuals, &p, m, count, x, residual, 1e-5, 1e-5, 0, 40 * (count + 1), 1e-10, scale, 1, 10, 0, &evaluations,
          jacobian, m, pivot, work, work + count, work + 2 * count, work + 3 * count, work + 4 * count);
    residuals(&p, m, count, x, residual, 0);
    for (int i = 0; i < m; i++) sum += residual[i] * residual[i];
    free(residual);
    free(scale);
    free(jacobian);
    free(work);
    free(pivot);
    return sum / m;
}
