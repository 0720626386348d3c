/* SPDX-License-Identifier: MIT */
/*
 * Lafortune lobes fitted to any BRDF.
 *
 * The error is the relative L2 distance of f_r cos: for each view the integral over lights of (fit - f_r)^2 cos^2 divided
 * by that of f_r^2 cos^2, cos = n.l, over the channels together; then the root of the mean over views: polar angles
 * 0..75 degrees by 5 (anisotropic materials: by 15, at 12 azimuths each).
 */
#ifndef LAFORTUNE_FIT_H
#define LAFORTUNE_FIT_H

#include "json.h"
#include "lafortune_pairs.h"
#include "models.h"
#include "progress.h"

typedef struct lafortune_fit_options {
    int lobes;          /* (3) 1..3 */
    int per_channel;    /* 0: c and n shared by R G B (McAllister et al. 2002); 1: each channel on its own */
    double n_min;       /* (0.25) least exponent */
    double n_max;       /* (1e5) largest exponent; 255 for maps of 8 bits */
    double grazing_max; /* as in lafortune_options */
    int display; /* 1: errors weigh as they are seen, in sRGB codes at the metric's exposure (shared c and n only) */
    progress *progress;
} lafortune_fit_options;

typedef struct lafortune_fit {
    int lobes, per_channel, display, anisotropic;
    double kd[3];
    lafortune_lobe lobe[LAFORTUNE_MAX_LOBES];
    double
        residual[LAFORTUNE_MAX_LOBES + 1]; /* relative error with 0..lobes lobes; never rises. display: [lobes] alone */
    char name[256];                        /* of the BRDF that was fitted */
} lafortune_fit;

/* FAIL_INVALID: the BRDF is nowhere above 0, or is not finite somewhere. */
int lafortune_fit_brdf(lafortune_fit *out, const brdf *b, const lafortune_fit_options *options, failure *f);

/* The fit as a BRDF: model_open's "lafortune" with the same parameters. Free with brdf_close. */
brdf *lafortune_fit_open(const lafortune_fit *fit);
/* "lafortune:kd=...,cx=..." which brdf_open takes, into text. */
void lafortune_fit_name(const lafortune_fit *fit, char *text, size_t size);
/* Relative error of any BRDF against b, by the samples that fits of b use. */
int lafortune_fit_error(const brdf *b, const brdf *other, double *error, failure *f);

/* Members of the open JSON object: brdf, lobes, residuals, parameters. */
void lafortune_fit_json(const lafortune_fit *fit, json *j);

#endif
