/* SPDX-License-Identifier: MIT */
/* Parameter maps as pictures: PNG with the codes of nacre_asset.h, or portable float maps with the numbers themselves. */
#ifndef SBRDF_MAPS_H
#define SBRDF_MAPS_H

#include "sbrdf_field.h"

typedef struct sbrdf_map_files {
    const char *albedo; /* RGB, or RGBA with opacity (PNG) */
    struct {
        const char *albedo;   /* RGB, of pi f_r */
        const char *shape;    /* Cx Cy Cz; PNG: n in alpha unless exponent is given */
        const char *exponent; /* one channel, n; NULL: in the shape's alpha */
    } lobe[LAFORTUNE_MAX_LOBES];
    int lobes;
    const char *direction; /* of anisotropy, x in R and y in G; may be NULL */
    double lobe_most;      /* lobe albedo of a PNG's code 255 */
    double shape_most;     /* C of a PNG's code 255 */
    int srgb;              /* albedo PNGs hold sRGB codes, not linear ones */
} sbrdf_map_files;

/* FAIL_INVALID: sizes that differ, or an exponent that is nowhere. */
int sbrdf_maps_read(sbrdf_field *out, const sbrdf_map_files *files, failure *f);

#endif
