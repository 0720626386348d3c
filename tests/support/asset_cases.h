/* SPDX-License-Identifier: MIT */
/* Small assets of every format and shape of the profile, made without a baker: fixtures/asset holds them frozen. */
#ifndef ASSET_CASES_H
#define ASSET_CASES_H

#include "ktx2_write.h"

typedef struct asset_case {
    const char *name; /* of the file in fixtures/asset, without v1- and .ktx2 */
    int format, width, height, layers, faces, levels, srgb;
    const char *role; /* NULL: a plain image without keys of ours */
} asset_case;

extern const asset_case asset_cases[];
extern const int asset_case_count;

/* The image of a case; texels and numbers come from its name. Free with ktx2_free. */
void asset_case_make(const asset_case *c, ktx2_image *out);

/* "fixtures/asset" or $NACRE_FIXTURES/asset, and its *.ktx2 files, sorted; returns their number. Static. */
const char *asset_fixture_directory(void);
int asset_fixtures(const char *const **paths);

#endif
