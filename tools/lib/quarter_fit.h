/* SPDX-License-Identifier: MIT */
/*
 * Quartered sphere images: coordinates, and the fit of all images of a file together.
 *
 * With l, v the directions to light and eye, h half-way between them and d the direction of l - v, the normal's parts x =
 * n.d and y = n.(h x d) fix theta_half and phi_diff; the angle between l and v is 2 theta_diff. An isotropic, reciprocal
 * and mirror-symmetric BRDF does not change with the signs of x and y. Image i holds the quarter x, y >= 0 at light polar
 * angle polar[i]; columns and rows run over log2(8 x + 1) / log2 9 and the same of y. Between images roots are blended
 * linearly in s = sqrt(1 - l.h).
 */
#ifndef QUARTER_FIT_H
#define QUARTER_FIT_H

#include "brdf.h"
#include "progress.h"

/* Place along one axis, 0..1 between the centres of the first and the last texel; x in -1..1. */
double quarter_place(double x);
double quarter_unplace(double place);

/* s of a light polar angle in degrees. */
double quarter_step(double polar_deg);

/* Image below s and the weight (0..1) of the next one; at or beyond the last image: layers - 2 and 1. */
int quarter_pair(const double *polar_deg, int layers, double s, double *weight);

/* Light polar angle (degrees) of image i of count that is used unless the user gives others: equal steps of 0.7 s + 0.3 s^2
   up to 165 degrees. */
double quarter_polar(int i, int count);

typedef struct quarter_job {
    const brdf *b;
    double exposure; /* of the common metric */
    const double *polar_deg;
    int layers, size; /* size: texels a side, 2 or more; layers: 2 or more */
    int levels[3];    /* codes are k / levels of R, G, B; 0: not rounded */
    progress *progress;
} quarter_job;

/* Codes 0..1 of all images, layers x size x size x RGB, and scale[c]: pi f_r l.h = scale code^4, a q16 above 0. Weighted
   least squares over sphere frames under lights from every angle, as displayed; codes are rounded so that the errors of
   neighbours cancel. FAIL_INVALID: b is not finite somewhere, or holds no data. */
int quarter_fit(float *code, double scale[3], const quarter_job *job, failure *f);

#endif
