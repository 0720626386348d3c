/* SPDX-License-Identifier: MIT */
/* A full palette made without a baker: 256 smooth tables, no two alike, and a map of 16 x 8 texels that has them all over. */
#ifndef PALETTE_CASE_H
#define PALETTE_CASE_H

#include "palette.h"

/* Albedo of every table, as it comes back from its codes. */
extern const double palette_case_albedo[3];

/* Free with palette_free. */
void palette_case_make(palette *out, int blend);

#endif
