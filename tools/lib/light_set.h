/* SPDX-License-Identifier: MIT */
/*
 * Sets of directional lights of any number, and their files.
 *
 * A light file is text: one light a line, five numbers separated by commas,
 *   polar,azimuth,r,g,b
 * polar and azimuth in degrees in view space, as for `nacre shot --light`: polar from +z towards the eye (0..180), azimuth
 * from +x (right) to +y (up); r,g,b the irradiance on a surface that faces the light (0..32767). A white Lambertian
 * surface (albedo 1) that faces a light of irradiance pi has radiance 1: f_r = 1/pi, and nothing else is divided by pi.
 * Empty lines and lines that begin with # are skipped.
 */
#ifndef LIGHT_SET_H
#define LIGHT_SET_H

#include "failure.h"
#include "nacre.h"
#include "output.h"

#define LIGHT_SET_MAX        NACRE_MAX_LIT_LIGHTS
#define LIGHT_MAX_IRRADIANCE 32767 /* what the runtime's q16 holds */

typedef struct distant_light {
    double direction[3];  /* unit, view space, towards the light */
    double irradiance[3]; /* R G B, on a surface that faces it */
} distant_light;

typedef struct light_set {
    distant_light *light; /* malloc'd */
    int count;
} light_set;

void light_set_add(light_set *set, const distant_light *light);
void light_set_free(light_set *set);

/* Degrees of a direction, and back. */
void light_angles(const double direction[3], double *polar_deg, double *azimuth_deg);
void light_direction(double polar_deg, double azimuth_deg, double direction[3]);
/* Turn every light about +y, as env_turn. */
void light_set_turn(light_set *set, double degrees);

/* FAIL_INVALID names the line: not five numbers, out of range, more than LIGHT_SET_MAX lights, or none. */
int light_set_read(light_set *out, const char *path, failure *f);
/* The file's text: comment lines (each without its "# ", may be NULL) and the lights, exact to 1e-7 of a degree and 9
   digits. */
void light_set_text(const light_set *set, const char *const *comments, int comment_count, bytes *out);

/* The same as C source: an array of nacre_light named after the file, and its length. */
void light_set_source(const light_set *set, const char *path, bytes *out);

#endif
