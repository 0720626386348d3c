/* SPDX-License-Identifier: MIT */
/* Models fitted to a BRDF by what the common metric sees: display values on a lit sphere, seen head-on, under lights from
   the eye to behind it. Levenberg-Marquardt (cminpack). */
#ifndef DISPLAY_FIT_H
#define DISPLAY_FIT_H

#include "brdf.h"

typedef struct display_sample {
    double to_light[3], to_eye[3];
    double shown[3]; /* sRGB of clamped pi E f_r n.l */
    double weight;   /* root of the area it stands for */
} display_sample;

typedef struct display_fit {
    double exposure;
    display_sample *sample; /* malloc'd */
    int count;
} display_fit;

/* Samples of b under exposure E (brdf_exposure). */
display_fit display_fit_begin(const brdf *b, double exposure);
void display_fit_end(display_fit *fit);

/* The model for unbounded parameters x[0..count-1]; NULL if there is none. */
typedef brdf *display_model(const double *x, int count);

/* Improve x until the mean squared error is least nearby; returns that error, in display values squared. */
double display_fit_run(const display_fit *fit, display_model *make, double *x, int count);

#endif
