/* SPDX-License-Identifier: MIT */
/* BRDFs and sphere images by name, and random numbers and directions that are the same everywhere. What can't be opened or
   baked fails the test with the reason. */
#ifndef BRDF_KIT_H
#define BRDF_KIT_H

#include <stdint.h>

#include "brdf.h"
#include "sphere_bake.h"

brdf *open_name(const char *name);                                          /* brdf_close() */
sphere_asset bake_spheres(const char *name, const sphere_options *options); /* sphere_free() */

/* The same file is written whatever the number of threads. */
void assert_spheres_need_no_threads(const char *name, const sphere_options *options);

double random_unit(uint32_t *state); /* in [0, 1), 24 bits */
/* Unit vector above the horizon (z >= 0), uniform over the hemisphere. */
void random_direction(uint32_t *state, double d[3]);

#endif
