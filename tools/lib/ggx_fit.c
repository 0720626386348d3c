/* SPDX-License-Identifier: MIT */
#include "ggx_fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "display_fit.h"
#include "models.h"

/* Unknowns: one for the roughness, three for f0, three for the albedo; each any real number, by the square of a sine. */
enum { ROUGH, F0, ALBEDO = F0 + 3, UNKNOWNS = ALBEDO + 3 };
#define LEAST_ROUGH 0.02

static double within(double x, double low, double high)
{
    return low + (high - low) * sin(x) * sin(x);
}

static double unbounded(double value, double low, double high)
{
    return asin(sqrt(fmin(1, fmax(0, (value - low) / (high - low)))));
}

static void parameters(const double *x, int digits, char text[256])
{
    double v[UNKNOWNS];
    for (int i = 0; i < UNKNOWNS; i++) v[i] = within(x[i], i == ROUGH ? LEAST_ROUGH : 0, 1);
    snprintf(text, 256, "rough=%.*g,f0=%.*g/%.*g/%.*g,albedo=%.*g/%.*g/%.*g", digits, v[ROUGH], digits, v[F0], digits,
             v[F0 + 1], digits, v[F0 + 2], digits, v[ALBEDO], digits, v[ALBEDO + 1], digits, v[ALBEDO + 2]);
}

static brdf *open_ggx(const double *x, int digits)
{
    char text[256];
    brdf *b = NULL;
    parameters(x, digits, text);
    if (model_open(&b, "ggx", text, NULL)) return NULL;
    snprintf(b->name, sizeof b->name, "ggx:%.250s", text);
    return b;
}

static brdf *make(const double *x, int count)
{
    (void)count;
    return open_ggx(x, 17);
}

brdf *ggx_fit(const brdf *b, double exposure)
{
    static const double rough[] = {0.12, 0.3, 0.55, 0.8}, f0[] = {0.05, 0.5};
    display_fit fit = display_fit_begin(b, exposure);
    double albedo[3], best[UNKNOWNS], least = HUGE_VAL;
    brdf_albedo(b, albedo);
    for (int i = 0; i < 8; i++) {
        double x[UNKNOWNS] = {unbounded(rough[i % 4], LEAST_ROUGH, 1)};
        for (int c = 0; c < 3; c++) {
            x[F0 + c] = unbounded(fmin(0.98, i < 4 ? f0[0] : f0[1]), 0, 1);
            x[ALBEDO + c] = unbounded(fmin(0.98, fmax(0.005, albedo[c] * (i < 4 ? 1 : 0.3))), 0, 1);
        }
        double error = display_fit_run(&fit, make, x, UNKNOWNS);
        if (!(error < least)) continue;
        least = error;
        memcpy(best, x, sizeof best);
    }
    display_fit_end(&fit);
    return open_ggx(best, 4);
}
