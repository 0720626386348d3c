/* SPDX-License-Identifier: MIT */
/*
 * Environment maps: radiance from every direction as one latitude-longitude picture.
 *
 * Orientation. The picture is what an eye at the object's place sees when it looks the way the camera looks (-z of view
 * space): its middle is straight ahead (-z, behind the object), right of it is +x, and both side edges are behind the eye
 * (+z, where the light for the object's front comes from); the top edge is +y, the bottom edge -y. With u in 0..1 from
 * left to right, v in 0..1 from top to bottom, longitude = 2 pi (u - 1/2), latitude = pi (1/2 - v):
 *   direction = (cos(latitude) sin(longitude), sin(latitude), -cos(latitude) cos(longitude)).
 */
#ifndef ENV_MAP_H
#define ENV_MAP_H

#include "failure.h"

#define ENV_MAP_MAX_WIDTH 16384

typedef struct env_map {
    int width, height; /* width = 2 height */
    float *texel;      /* malloc'd; R G B, linear radiance, finite and not negative; rows from the top */
    long negative;     /* texels that had a negative channel, now 0 */
    long not_finite;   /* texels that had a channel of NaN or infinity, now 0 */
} env_map;

/* Read a Radiance picture (#?RADIANCE or #?RGBE; RGB or XYZ; flat, old or new run lengths; EXPOSURE and COLORCORR are
   divided out) or a portable float map (PF, Pf). FAIL_IO: can't be read. FAIL_INVALID: not such a file, cut short, no
   texels, not twice as wide as high. FAIL_UNSUPPORTED: columns stored first, or too large. */
int env_map_open(env_map *out, const char *path, failure *f);
void env_map_free(env_map *map);

/* One line on standard error if the map had radiance that was not there or below 0; nothing otherwise. */
void env_map_warn(const env_map *map, const char *path);

/* Unit vector, view space, towards the point (x, y) of the picture; texel (i, j) has its centre at (i + .5, j + .5). */
void env_map_direction(const env_map *map, double x, double y, double direction[3]);
/* Of each texel of a row: sr. */
double env_map_solid_angle(const env_map *map, int row);

/* Rotate v about +y by so many degrees, as shot turns a mesh: +z moves towards +x. */
void env_turn(double v[3], double degrees);

/* Rec. 709 luminance. */
double env_luminance(const double rgb[3]);

#endif
