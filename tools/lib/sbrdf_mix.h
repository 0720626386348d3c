/* SPDX-License-Identifier: MIT */
/* Means of texels: reflectance is sampled, averaged and fitted again (McAllister et al. 2002, section 7), for exponents and
   C stand inside a power and have no useful mean. */
#ifndef SBRDF_MIX_H
#define SBRDF_MIX_H

#include "lafortune_pairs.h"
#include "sbrdf_map.h"

/* A texel and how much of the mean it is. */
typedef struct sbrdf_part {
    const sbrdf_texel *texel;
    double weight;
} sbrdf_part;

/* One thread at a time. */
typedef struct sbrdf_mixer sbrdf_mixer;
sbrdf_mixer *sbrdf_mixer_make(int lobes, int anisotropic);
void sbrdf_mixer_free(sbrdf_mixer *m);

/* The mean of parts (their weights add up to 1; opacity weighs too), as one texel. The search starts from hints, which
   come as near as they can to the same mean (the parts themselves if they are few). */
void sbrdf_mix(sbrdf_mixer *m, const sbrdf_part *parts, int count, const sbrdf_part *hints, int hint_count,
               sbrdf_texel *out);

/* Means of the parameters, exponents in their square root: what filtering codes amounts to. */
void sbrdf_mean_parameters(const sbrdf_part *parts, int count, sbrdf_texel *out);

/* Sharper lobes first, black ones last. */
void sbrdf_sort_lobes(sbrdf_texel *t);

#endif
