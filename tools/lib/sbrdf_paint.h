/* SPDX-License-Identifier: MIT */
/* A painting (painting.h) as a map of Lafortune BRDFs: its materials are fitted to what is seen of them. */
#ifndef SBRDF_PAINT_H
#define SBRDF_PAINT_H

#include "painting.h"
#include "sbrdf_field.h"

/* FAIL_INVALID names the text's line. *sources receives the pictures (also when it fails; free it). */
/* lobes: of every texel, 0: as the text says. */
int sbrdf_paint_lobes(sbrdf_field *out, const char *path, int lobes, sbrdf_sources *sources, progress *p, failure *f);
int sbrdf_paint(sbrdf_field *out, const char *path, sbrdf_sources *sources, progress *p, failure *f);

#endif
