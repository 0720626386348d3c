/* SPDX-License-Identifier: MIT */
#include "lafortune_display.h"

#include <math.h>
#include <string.h>

#include "display_fit.h"
#include "lafortune_fit.h"

#define PI 3.14159265358979323846

/* Unknowns, any real numbers: roots of kd; per lobe logarithms of the three ks, cx = cy, cz, and the logarithm of n. */
enum { KD, LOBES = KD + 3, KS = 0, CX = KS + 3, CZ, LOG_N, PER_LOBE };
enum { MAX_UNKNOWNS = LOBES + LAFORTUNE_MAX_LOBES * PER_LOBE, STARTS = 5 };
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

static void add_lobe(lafortune_fit *fit, double exponent, double peak)
{
    lafortune_lobe *lobe = &fit->lobe[fit->lobes++];
    for (int c = 0; c < 3; c++) {
        lobe->cx[c] = lobe->cy[c] = -1;
        lobe->cz[c] = 1;
        lobe->n[c] = exponent;
        lobe->ks[c] = peak;
    }
}

/* Where the search for so many lobes begins. 0: least squares of f_r n.l. 1, 2: mirror lobes that show as a third of
   white. 3, 4: the best with one lobe less (before; NULL: there is none) and a faint further lobe, wide or narrow.
   Returns 0 where there is no such start. */
static int start(double *x, int which, const brdf *b, double exposure, int lobes, const lafortune_fit *before)
{
    static const double exponent[2][LAFORTUNE_MAX_LOBES] = {{20, 3, 150}, {100, 8, 1000}}, further[2] = {5, 150};
    double white = 1 / (PI * exposure), albedo[3];
    lafortune_fit fit = {0};
    if (which == 0) {
        if (lafortune_fit_brdf(&fit, b, &(lafortune_fit_options){.lobes = lobes}, NULL)) return 0;
    } else if (which <= 2) {
        brdf_albedo(b, albedo);
        for (int c = 0; c < 3; c++) fit.kd[c] = albedo[c] / 2;
        for (int i = 0; i < lobes; i++) add_lobe(&fit, exponent[which - 1][i], white / 3);
    } else {
        if (!before) return 0;
        fit = *before;
        add_lobe(&fit, further[which - 3], white / 100);
    }
    from_fit(&fit, x);
    return 1;
}

/* The best from all starts. */
static lafortune_fit best_fit(const display_fit *samples, const brdf *b, int lobes, const lafortune_fit *before)
{
    int count = LOBES + lobes * PER_LOBE;
    double best[MAX_UNKNOWNS] = {0}, least = HUGE_VAL;
    for (int i = 0; i < STARTS; i++) {
        double x[MAX_UNKNOWNS];
        if (!start(x, i, b, samples->exposure, lobes, before)) continue;
        double error = display_fit_run(samples, make, x, count);
        if (!(error < least)) continue;
        least = error;
        memcpy(best, x, sizeof best);
    }
    return to_fit(best, count);
}

brdf *lafortune_display_fit(const brdf *b, double exposure, int lobes, char *name, size_t size)
{
    display_fit samples = display_fit_begin(b, exposure);
    lafortune_fit fit = best_fit(&samples, b, 1, NULL);
    for (int k = 2; k <= lobes; k++) {
        lafortune_fit before = fit;
        fit = best_fit(&samples, b, k, &before);
    }
    display_fit_end(&samples);
    lafortune_fit_name(&fit, name, size);
    return lafortune_fit_open(&fit);
}
