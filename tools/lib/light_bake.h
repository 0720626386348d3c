/* SPDX-License-Identifier: MIT */
/*
 * An environment map as N directional lights: the map is cut into N parts, each becomes the light that does the same.
 *
 * A part's light has the direction of the part's mean by luminance, and per channel the part's whole irradiance: the
 * integral of radiance over its solid angle. A last correction of the irradiances, the least one in the mean square, makes
 * both sums over the lights equal to the map's integrals, channel by channel: irradiance (the flux), and irradiance x
 * direction (the vector irradiance, Gershun 1939). So the first two bands of spherical harmonics, the larger part of what
 * a matt surface shows, are exact. Where few lights can't do both, the flux alone is kept.
 */
#ifndef LIGHT_BAKE_H
#define LIGHT_BAKE_H

#include "env_map.h"
#include "light_set.h"
#include "progress.h"

typedef enum light_method {
    LIGHT_RELAXED, /* (default) variance cut, then Lloyd's iteration on the sphere: Kollig and Keller 2003, "Efficient
                           illumination by high dynamic range images", section 3 */
    LIGHT_VARIANCE_CUT, /* Viriyothai and Debevec 2009, "Variance minimization light probe sampling" */
    LIGHT_MEDIAN_CUT    /* Debevec 2005, "A median cut algorithm for light probe sampling" */
} light_method;

typedef struct light_options {
    light_method method;
    int count;          /* 1..LIGHT_SET_MAX (64) */
    double scale;       /* multiplies radiance, > 0 (1) */
    progress *progress; /* may be NULL */
} light_options;

typedef struct light_figures { /* of the map as it was read, x scale; view space */
    double total[3];           /* integral of radiance over all directions */
    double vector[3][3];       /* [channel]: integral of radiance x direction */
    double most;               /* largest radiance of a channel */
} light_figures;

void light_measure(light_figures *out, const env_map *map, double scale);

/* Lights in falling order of luminance; fewer than asked for when the map has fewer texels that are not black. *figures
   may be NULL. FAIL_INVALID: a black map (name it by path); FAIL_UNSUPPORTED: a light beyond LIGHT_MAX_IRRADIANCE. The
   result does not depend on the number of threads. */
int light_bake(light_set *out, light_figures *figures, const env_map *map, const char *path, const light_options *o,
               failure *f);

#endif
