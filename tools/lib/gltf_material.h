/* SPDX-License-Identifier: MIT */
/* The metallic-roughness material of a glTF file (glTF 2.0, section 3.9 and appendix B), as texels. */
#ifndef GLTF_MATERIAL_H
#define GLTF_MATERIAL_H

#include "sbrdf_paint.h"

typedef struct gltf_report {
    double mean_error,
        worst_error;     /* relative L2 of f cos of the fits, against GGX with F0 = .04, over the texels' kinds */
    long kinds;          /* of texels: roughness, metal and lightness in steps */
    image_u8 normal_map; /* RGBA codes, malloc'd; texel NULL: the material has none. Free with image_u8_free */
    double normal_scale; /* of its x and y */
} gltf_report;

/* The material of that name (NULL: the first that a mesh uses) of a .gltf or .glb: base colour, metallic and roughness, as factors and pictures (PNG, JPEG, files
   or embedded; of one size, or factors alone: one texel), fitted with so many lobes. Lobes start from the mirror direction
   and n = .70 / alpha^2, alpha = roughness^2. FAIL_INVALID: no such material, or pictures of different sizes (normals may have their own). */
int gltf_material_read(sbrdf_field *out, const char *path, const char *name, int lobes, sbrdf_sources *sources,
                       gltf_report *report, progress *p, failure *f);

#endif
