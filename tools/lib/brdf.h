/* SPDX-License-Identifier: MIT */
/* Reflectance in double precision: measured tables, analytic models and decoded nacre assets behind one interface. */
#ifndef BRDF_H
#define BRDF_H

#include <stddef.h>

#include "failure.h"

typedef struct brdf brdf;
struct brdf {
    /* f_r in 1/sr, R G B, for unit vectors in the local frame (normal +z, tangent +x), both with z > 0.
       Returns 1, or 0 where the source holds no data (f_r is 0 then). Thread-safe. */
    int (*eval)(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3]);
    /* f_r x max(to_light z, 0), for sources that store that product (NULL: eval x cosine). */
    int (*eval_cosine)(const brdf *b, const double to_light[3], const double to_eye[3], double out[3]);
    /* Materials that vary over the surface: f_r at texture coordinates u, v (v = 0 is a picture's last row). NULL for all
       others; eval then has the mean over the surface. */
    void (*eval_at)(const brdf *b, const double uv[2], const double to_light[3], const double to_eye[3], double f_r[3]);
    int lit_past_terminator; /* eval_cosine also answers for to_light z <= 0: pictures that hold the cosine and are turned */
    void (*close)(brdf *b); /* frees b itself too */
    char name[256];         /* as given: "merl:gold.binary", "ggx:rough=.3" */
    char description[256];  /* a line for people: model, parameters, source */
    int anisotropic;        /* f_r depends on the azimuth of the pair */
};

/* Open by name: merl:FILE or FILE.binary, rgl:FILE or FILE.bsdf, asset FILE.ktx2 (its decoding in double), sgd:NAME,
   ngan-lafortune:NAME, ngan-cook-torrance:NAME, lafortune:NAME, lambert:albedo=.5, blinn-phong:..., ward:..., ggx:...,
   cook-torrance:..., schlick:... (not yet). An unknown name or parameter lists the near ones. A value is one number or
   r/g/b; parameters not given have defaults. ggx: rough is the perceptual roughness, alpha = rough^2; lines of help for
   every model: model_help in models.h. FAIL_USAGE: unknown name, parameter, value out of range; FAIL_IO, FAIL_INVALID,
   FAIL_UNSUPPORTED: as the file's reader says. */
int brdf_open(brdf **out, const char *name, failure *f);
void brdf_close(brdf *b); /* NULL is fine */

/* The decoding in double of an opened asset; path is for messages. Takes a copy. FAIL_UNSUPPORTED: of another role. */
struct nacre_image;
int brdf_open_image(brdf **out, const struct nacre_image *image, const char *path, failure *f);

/* Names of the embedded parameter sets, "sgd:gold-metallic-paint", sorted; count in *count. Static. */
const char *const *brdf_names(size_t *count);

/* f_r x max(n.l, 0) through eval_cosine or eval; 0 at or below the horizon of either direction (of to_light: unless
   lit_past_terminator). */
int brdf_eval_cosine(const brdf *b, const double to_light[3], const double to_eye[3], double out[3]);

/* Directions of Rusinkiewicz coordinates in radians: half vector at theta_half (azimuth 0), difference vector at
   (theta_diff, phi_diff) about it. */
void half_to_directions(double theta_half, double theta_diff, double phi_diff, double to_light[3], double to_eye[3]);

/* Hemispherical (white-sky) albedo, R G B: the mean over cosine-weighted to_light and to_eye of pi f_r, each channel. */
void brdf_albedo(const brdf *b, double albedo[3]);

/* Directional-hemispherical albedo, R G B: the part of the light from direction at view_polar (degrees from the normal,
   0..89) that b reflects, which by reciprocity is what an eye there sees under a white sky: the integral of f_r n.l over
   to_light. Pairs for which where (NULL: b itself) has no data count in neither b nor the whole. */
void brdf_view_albedo(const brdf *b, const brdf *where, double view_polar_deg, double albedo[3]);

/* Light scale of the common metric: clip(0.35 / median lit luminance at light polar 45 degrees, 0.5, 8). */
double brdf_exposure(const brdf *b);

#endif
