/* SPDX-License-Identifier: MIT */
/*
 * Analytic reflectance models in double precision, f_r in 1/sr, for unit directions in the local frame (normal +z,
 * tangent +x). Colours are R G B. Every model is zero at or below the horizon of either direction.
 */
#ifndef MODELS_H
#define MODELS_H

#include "brdf.h"

typedef struct lafortune_lobe { /* ks (cx lx vx + cy ly vy + cz lz vz)^n, the sum clamped at 0 */
    double ks[3], cx[3], cy[3], cz[3], n[3];
} lafortune_lobe;

typedef struct sgd_parameters {              /* Bagher, Soler, Holzschuch 2012; per channel */
    double kd[3], ks[3];                     /* diffuse and specular scale */
    double alpha[3], p[3];                   /* width and exponent of the shifted gamma distribution */
    double f0[3], f1[3];                     /* Fresnel term: f0 + (1 - f0)(1 - cos)^5 - f1 cos */
    double scale[3];                         /* normalises the distribution (the fits' K_ap) */
    double lambda[3], c[3], k[3], theta0[3]; /* shadowing; theta0 in radians */
} sgd_parameters;

typedef enum fresnel_kind { FRESNEL_DIELECTRIC, FRESNEL_SCHLICK } fresnel_kind;

typedef struct cook_torrance_parameters {
    double kd[3], ks[3];  /* kd is divided by pi in f_r */
    double f0[3], m;      /* reflectance at normal incidence; Beckmann slope */
    double divisor;       /* 4: energy-correct; pi: as printed in the 1982 paper */
    fresnel_kind fresnel; /* exact for the index of refraction that gives f0, or Schlick's polynomial */
} cook_torrance_parameters;

/* Each makes a BRDF (free with brdf_close) and fills eval and close; name and description are the caller's. */
brdf *lafortune_brdf(const double kd[3], const lafortune_lobe *lobes, size_t count);
brdf *sgd_brdf(const sgd_parameters *p);
brdf *cook_torrance_brdf(const cook_torrance_parameters *p);

/* Parse "albedo=.5" and the like for model ("lambert", "blinn-phong", "ward", "lafortune", "cook-torrance", "ggx") and
   make it. NULL parameters mean none: the defaults. FAIL_USAGE names the parameter, its value and what is expected. */
int model_open(brdf **out, const char *model, const char *parameters, failure *f);

/* Names of the models, and a line of help with parameters, ranges and defaults for each; NULL past the end. */
const char *model_name(size_t index);
const char *model_help(size_t index);

/* Normal distributions (1/sr of microfacet normals): Trowbridge-Reitz (GGX) and Beckmann. */
double ggx_distribution(double n_dot_h, double alpha);
double beckmann_distribution(double n_dot_h, double m);

#endif
