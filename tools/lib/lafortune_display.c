/* SPDX-License-Identifier: MIT */
#include "lafortune_display.h"

#include <math.h>
#include <string.h>

#include "display_fit.h"
#include "lafortune_fit.h"

#define PI 3.14159265358979323846

/* Unknowns, any real numbers: roots of kd; per lobe logarithms of the three ks, cx = cy, cz, and the logarithm of n. */
enum { KD, LOBES = KD + 3, KS = 0, CX = KS + 3, CZ, LOG_N, PER_LOBE };
enum { MAX_UNKNOWNS = LOBES + LAFORTUNE_MAX_LOBES * PER_LOBE, STARTS = 3 };
#define LEAST_KS 1e-6
#define MOST_N   1e5

static double clamp(double x, double low, double high)
{
    return fmin(high, fmax(low, x));
}

static lafortune_fit to_fit(const double *x, int count)
{
    lafortune_fit fit = {.lobes = (count - LOBES) / PER_LOBE};
    for (int c = 0; c < 3; c++) fit.kd[c] = x[KD + c] * x[KD + c];
    for (int i = 0; i < fit.lobes; i++) {
        const double *at = x + LOBES + i * PER_LOBE;
        lafortune_lobe *lobe = &fit.lobe[i];
        for (int c = 0; c < 3; c++) {
            lobe->ks[c] = exp(clamp(at[KS + c], -50, 50));
            lobe->cx[c] = lobe->cy[c] = at[CX];
            lobe->cz[c] = at[CZ];
            lobe->n[c] = clamp(exp(clamp(at[LOG_N], -50, 50)), 0, MOST_N);
        }
    }
    return fit;
}

static void from_fit(const lafortune_fit *fit, double *x)
{
    for (int c = 0; c < 3; c++) x[KD + c] = sqrt(fmax(fit->kd[c], 0));
    for (int i = 0; i < fit->lobes; i++) {
        double *at = x + LOBES + i * PER_LOBE;
        const lafortune_lobe *lobe = &fit->lobe[i];
        for (int c = 0; c < 3; c++) at[KS + c] = log(fmax(lobe->ks[c], LEAST_KS));
        at[CX] = lobe->cx[0];
        at[CZ] = lobe->cz[0];
        at[LOG_N] = log(fmax(lobe->n[0], 1e-3));
    }
}

static brdf *make(const double *x, int count)
{
    lafortune_fit fit = to_fit(x, count);
    return lafortune_fit_open(&fit);
}

/* Start 0: least squares of f_r n.l. The others: mirror lobes, wide ones first, that show as a third of white. */
static void start(double *x, int which, const brdf *b, double exposure, int lobes)
{
    static const double exponent[STARTS - 1][LAFORTUNE_MAX_LOBES] = {{20, 3, 150}, {100, 8, 1000}};
    lafortune_fit fit = {0};
    double albedo[3];
    if (which == 0 && lafortune_fit_brdf(&fit, b, &(lafortune_fit_options){.lobes = lobes}, NULL) == 0) {
        from_fit(&fit, x);
        return;
    }
    brdf_albedo(b, albedo);
    fit = (lafortune_fit){.lobes = lobes, .kd = {albedo[0] / 2, albedo[1] / 2, albedo[2] / 2}};
    for (int i = 0; i < lobes; i++)
        for (int c = 0; c < 3; c++) {
            lafortune_lobe *lobe = &fit.lobe[i];
            lobe->cx[c] = lobe->cy[c] = -1;
            lobe->cz[c] = 1;
            lobe->n[c] = exponent[which ? which - 1 : 0][i];
            lobe->ks[c] = 1 / (3 * PI * exposure);
        }
    from_fit(&fit, x);
}

brdf *lafortune_display_fit(const brdf *b, double exposure, int lobes, char *name, size_t size)
{
    int count = LOBES + lobes * PER_LOBE;
    display_fit samples = display_fit_begin(b, exposure);
    double best[MAX_UNKNOWNS] = {0}, least = HUGE_VAL;
    for (int i = 0; i < STARTS; i++) {
        double x[MAX_UNKNOWNS];
        start(x, i, b, exposure, lobes);
        double error = display_fit_run(&samples, make, x, count);
        if (!(error < least)) continue;
        least = error;
        memcpy(best, x, sizeof best);
    }
    display_fit_end(&samples);
    lafortune_fit fit = to_fit(best, count);
    lafortune_fit_name(&fit, name, size);
    return lafortune_fit_open(&fit);
}
