/* SPDX-License-Identifier: MIT */
/* Measured isotropic tables in the layout of the MERL BRDF database (Matusik et al. 2003). */
#ifndef MERL_H
#define MERL_H

#include "brdf.h"

/* Largest table: the database's own size. */
enum { MERL_THETA_HALF = 90, MERL_THETA_DIFF = 90, MERL_PHI_DIFF = 180 };

/* Open a table of any size up to the largest. FAIL_IO: not readable. FAIL_INVALID: sizes out of range, file longer or
   shorter than they say, or an entry that is not finite (the message has the offset). */
int merl_open(brdf **out, const char *path, failure *f);

/* Write b as a table: its value at every bin centre, -1 where a direction is below the horizon or b has no data. */
int merl_write(const char *path, const brdf *b, int theta_half_count, int theta_diff_count, int phi_diff_count,
               failure *f);

#endif
