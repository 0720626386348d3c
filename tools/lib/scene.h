/* SPDX-License-Identifier: MIT */
/* One shot: a mesh, a material, lights and a camera, and its two renderers: GLES through the runtime, and double. */
#ifndef SCENE_H
#define SCENE_H

#include "brdf.h"
#include "gl_headless.h"
#include "mesh.h"

#define SCENE_MAX_LIGHTS 8

typedef struct scene_light {
    int point;
    double direction[3]; /* view space, unit, towards the light */
    double position[3];  /* view space */
    double power[3];     /* irradiance, or radiant intensity */
    double shadow;       /* 0..1 blocked */
} scene_light;

typedef struct scene {
    const mesh *shape;
    int exact_sphere;            /* shape is the built-in sphere: exact normals at every covered pixel */
    double object_to_view[16], view_to_clip[16]; /* column-major */
    scene_light light[SCENE_MAX_LIGHTS];
    int light_count;
    double exposure, ambient[3], tint[3];
    int output;                  /* nacre_output */
    int distant_viewer;
    int width, height;
} scene;

/* Reference: per pixel centre in double, RGBA, straight alpha (255 where covered), background 0. normal_map may be
   NULL (tangent-space, RGB). */
int scene_draw_double(const scene *s, const brdf *b, const image_u8 *normal_map, image_u8 *out, failure *f);
/* The same through nacre_gles on the given backend. */
int scene_draw_gles(const scene *s, const nacre_material *material, gl_backend backend, image_u8 *out, failure *f);

#endif
