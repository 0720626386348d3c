/* SPDX-License-Identifier: MIT */
/* Measured BRDFs in the tensor files of the RGL material database (Dupuy and Jakob 2018). */
#ifndef RGL_H
#define RGL_H

#include "brdf.h"

/* Open an isotropic .bsdf file of the RGB kind. FAIL_IO: not readable. FAIL_INVALID: not what the format says.
   FAIL_UNSUPPORTED: anisotropic or spectral. */
int rgl_open(brdf **out, const char *path, failure *f);

#endif
