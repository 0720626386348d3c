/* SPDX-License-Identifier: MIT */
/* What a user would ship without nacre's representations, each made as good as it gets. */
#ifndef BASELINES_H
#define BASELINES_H

#include "compare.h"

typedef enum baseline {
    BASELINE_GGX,         /* GGX + Lambert (ggx_fit.h) */
    BASELINE_LAFORTUNE_1, /* Lafortune lobes over a Lambert part (lafortune_display.h) */
    BASELINE_LAFORTUNE_2,
    BASELINE_LAFORTUNE_3,
    BASELINE_MATCAP, /* one picture of the lit sphere, turned with the light */
    BASELINE_COUNT
} baseline;

/* Fit it to the truth. Takes seconds of one core. */
void baseline_make(compare_asset *out, baseline which, const compare_truth *truth);

#endif
