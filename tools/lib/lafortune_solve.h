/* SPDX-License-Identifier: MIT */
/*
 * Least-squares fits of Lafortune lobes over a Lambert term to samples of reflectance:
 *
 *   f_r = kd/pi + sum over lobes of ks max(cx lx vx + cy ly vy + cz lz vz, 0)^n
 *
 * (Lafortune et al. 1997, equation 9; McAllister et al. 2002, equations 1 and 2). c and n are shared by the channels, kd
 * and ks are each channel's own, as in McAllister et al. 2002, section 3.1. The scale of c is free, because ks can take
 * it over: here the largest value the sum reaches for two directions above the horizon, max(|cx|, |cy|, cz), is 1, so
 * that ks is the lobe's peak.
 */
#ifndef LAFORTUNE_SOLVE_H
#define LAFORTUNE_SOLVE_H

#include "progress.h"

enum { LAFORTUNE_MAX_LOBES = 3 };

typedef struct lafortune_shared_lobe {
    double c[3], n, ks[3];
} lafortune_shared_lobe;

typedef struct lafortune_shared {
    int lobes; /* 0..LAFORTUNE_MAX_LOBES */
    double kd[3];
    lafortune_shared_lobe lobe[LAFORTUNE_MAX_LOBES];
} lafortune_shared;

/* Scale c so that the largest sum is 1, ks by the inverse to the power n. 0 if no pair of directions lights the lobe. */
int lafortune_normalise(lafortune_shared_lobe *lobe);

void lafortune_shared_eval(const lafortune_shared *p, const double to_light[3], const double to_eye[3], double f_r[3]);

/* Where the values of a fit are known. */
typedef struct lafortune_samples {
    int count;
    double (*product)[3]; /* lx vx, ly vy, lz vz */
    double *weight;       /* a sample's residual is weight x (fit - value) */
} lafortune_samples;

typedef struct lafortune_options {
    int anisotropic; /* 1: cx and cy differ */
    double n_min;    /* (0.25) least exponent */
    double n_max;    /* (1e5) largest exponent, at least 1 */
    int starts;      /* (6) places where a further lobe is tried out, the best of a grid over shape and exponent */
    double
        grazing_max; /* (no limit) how often the value at 75 degrees to the normal a lobe may reach at 90: C is held there */
    double tolerance;   /* (1e-8) of the sum of squares: smaller gains end the search */
    int evaluations;    /* (200) of the residual, at most, from each start */
    progress *progress; /* counts starts; may be NULL */
} lafortune_options;

/* Samples with everything that does not depend on the values. One thread at a time. */
typedef struct lafortune_problem lafortune_problem;
/* Copies the samples. channels: 1..3. */
lafortune_problem *lafortune_problem_make(const lafortune_samples *samples, int channels, int max_lobes,
                                          const lafortune_options *options);
void lafortune_problem_free(lafortune_problem *p);

/* Fit 1..lobes lobes one after the other to f_r, value[sample x channels + channel]; residual[k] (0..lobes, may be NULL)
   receives the relative error with k lobes: sqrt(sum w^2 (fit - value)^2 / sum w^2 value^2) over samples and channels.
   It never rises with k. Channels that are not there repeat the last one. out may hold more. Returns residual[lobes]. */
double lafortune_solve(lafortune_problem *p, const double *value, int lobes, lafortune_shared *out, double *residual);

/* Improve what *inout holds (shapes and exponents are the start; albedos are found). Returns the relative error. */
double lafortune_refine(lafortune_problem *p, const double *value, lafortune_shared *inout);

/* The albedos alone, for the shapes of *inout. Returns the relative error. */
double lafortune_albedos(lafortune_problem *p, const double *value, lafortune_shared *inout);

#endif
