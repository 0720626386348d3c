/* SPDX-License-Identifier: MIT */
/* What most engines would draw instead of a measurement: one GGX lobe and a Lambert part. */
#ifndef GGX_FIT_H
#define GGX_FIT_H

#include "brdf.h"

/* The isotropic "ggx:" model (one roughness, f0 and albedo of three channels) that comes nearest to b in the common
   metric's frames. Several starts; the best. Its name, "ggx:rough=...,f0=...,albedo=...", opens it again. */
brdf *ggx_fit(const brdf *b, double exposure);

#endif
