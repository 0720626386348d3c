/* SPDX-License-Identifier: MIT */
/* Lafortune lobes as good as they get in the common metric: the least-squares fit of lafortune_fit.h and a few other starts,
   each refined in display values. */
#ifndef LAFORTUNE_DISPLAY_H
#define LAFORTUNE_DISPLAY_H

#include "brdf.h"

/* 1..3 lobes over a Lambert part, isotropic, shapes shared by the channels. name receives "lafortune:kd=...", which
   opens it again. */
brdf *lafortune_display_fit(const brdf *b, double exposure, int lobes, char *name, size_t size);

#endif
