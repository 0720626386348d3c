/* SPDX-License-Identifier: MIT */
/* Pairs of directions at which BRDFs are compared and fitted. */
#ifndef LAFORTUNE_PAIRS_H
#define LAFORTUNE_PAIRS_H

#include "lafortune_solve.h"

enum { LAFORTUNE_MAX_VIEWS = 72 };

/* weight: sqrt(solid angle of the light) x n.l. Samples of one view follow each other. */
typedef struct lafortune_pairs {
    lafortune_samples samples;
    int views, view_end[LAFORTUNE_MAX_VIEWS];
    double (*direction)[6]; /* to_light, to_eye */
    double *value;          /* 3 a sample, the caller's */
} lafortune_pairs;

typedef enum lafortune_density {
    LAFORTUNE_FINE,  /* one material: views of 0..75 degrees by 5 (anisotropic: by 15, 12 azimuths) */
    LAFORTUNE_COARSE /* one texel of many: 0..75 by 25 (anisotropic: by 30 to 60, 4 azimuths); weights also x n.v */
} lafortune_density;

lafortune_pairs lafortune_pairs_make(lafortune_density density, int anisotropic);
void lafortune_pairs_free(lafortune_pairs *p);

#endif
