/* SPDX-License-Identifier: MIT */
/* One shot: a mesh, a material, lights and a camera, and its two renderers: GLES through the runtime, and double. */
#ifndef SCENE_H
#define SCENE_H

#include "brdf.h"
#include "gl_headless.h"
#include "light_set.h"
#include "mesh.h"
#include "nacre.h"
#include "progress.h"

#define SCENE_MAX_LIGHTS NACRE_MAX_LIGHTS
#define SCENE_MAX_SIZE   4096

typedef struct scene_light {
    int point;
    double direction[3]; /* view space, unit, towards the light */
    double position[3];  /* view space */
    double power[3];     /* irradiance, or radiant intensity */
    double shadow;       /* 0..1 blocked */
} scene_light;

typedef struct scene {
    const mesh *shape;
    int exact_sphere; /* shape is the built-in unit sphere: exact normals at every covered pixel */
    double object_to_view[16], view_to_clip[16]; /* column-major */
    scene_light light[SCENE_MAX_LIGHTS];
    int light_count;
    const light_set *distant; /* more directional lights, any number; NULL: none. Borrowed */
    int lit_size;             /* texels a side of the lit sphere; 0: where needed, 128 (soft: 256) */
    double exposure, ambient[3], tint[3];
    int output; /* nacre_output */
    int distant_viewer;
    int width, height;
    progress *progress; /* told of rows by the slow renderers; may be NULL */
} scene;

/* ---- scene_build.c: lights, cameras, the exact sphere, anti-aliasing ------------------------------------------ */

/* No lights, exposure 1, no ambient, tint 1, sRGB, identity matrices. */
void scene_begin(scene *s, const mesh *shape, int width, int height);

/* Towards the light: polar from +z towards the eye, azimuth from +x to +y, degrees; power NULL means 1,1,1. */
void scene_add_light(scene *s, double polar_deg, double azimuth_deg, const double power[3]);
void scene_add_point(scene *s, const double position[3], const double power[3]);

typedef enum scene_camera_kind {
    SCENE_CAMERA_FIT,  /* perspective, as near as the whole mesh allows */
    SCENE_CAMERA_LOOK, /* perspective, from eye to target */
    SCENE_CAMERA_ORTHO /* along -z of the turned mesh; the exact sphere fills the frame */
} scene_camera_kind;

typedef struct scene_camera { /* zero means default */
    scene_camera_kind kind;
    double eye[3], target[3];
    double fovy_deg;  /* 1..170 (30) */
    double yaw_deg;   /* turns the mesh about +y before all else ... */
    double pitch_deg; /* ... and then its front down, towards the eye above it */
    double margin;    /* fit and ortho: part of the frame left free at each side, 0..0.9 (0.04; exact ortho sphere 0) */
} scene_camera;

/* Set both matrices of s from its shape and size. FAIL_USAGE: eye and target coincide. */
int scene_aim(scene *s, const scene_camera *camera, failure *f);

/* The same for a mesh that turns about +y in front of a camera that stays: default framing holds it at every yaw. s shows
   yaw 0; the camera's is left to scene_turn. */
int scene_aim_turntable(scene *s, const scene_camera *camera, failure *f);
/* Turn the mesh of an aimed scene about +y through its centre, before all else. */
void scene_turn(scene *s, double yaw_deg);

/* What a pixel sees of the exact sphere. */
typedef struct scene_hit {
    double position[3], normal[3]; /* object space */
    double tangent[3], uv[2];      /* along rising u; u = 0 at +z, v = 0 at -y */
    double z_ndc;                  /* depth in normalised device coordinates */
} scene_hit;

/* Inverse of view_to_clip x object_to_view. Returns 0 if there is none. */
int scene_clip_to_object(const scene *s, double out[16]);
/* The unit sphere through the centre of pixel (i, j); 0 where it is missed. */
int scene_sphere_hit(const scene *s, const double clip_to_object[16], int i, int j, scene_hit *hit);

/* Means of n x n blocks, taken in linear light with coverage as alpha; frame holds codes of the given output. */
void scene_average(const image_u8 *frame, int n, int output, image_u8 *out);

void matrix_identity(double m[16]);
void matrix_multiply(double out[16], const double a[16], const double b[16]); /* a b; out may be neither */
void matrix_apply(double out[4], const double m[16], const double v[4]);
int matrix_invert(double out[16], const double m[16]); /* 0: singular */

/* ---- scene_double.c ------------------------------------------------------------------------------------------ */

/* Reference: per pixel centre in double, RGBA, straight alpha (255 where covered), background 0. normal_map may be
   NULL (tangent-space, RGB, +y up). albedo (may be NULL: from b) is what ambient light meets. */
int scene_draw_double(const scene *s, const brdf *b, const double albedo[3], const image_u8 *normal_map, image_u8 *out,
                      failure *f);

/* ---- scene_gles.c -------------------------------------------------------------------------------------------- */

/* The same through nacre_gles on the given backend. */
int scene_draw_gles(const scene *s, const nacre_material *material, gl_backend backend, image_u8 *out, failure *f);

/* One context for many shots of one size. */
typedef struct scene_gles scene_gles;
int scene_gles_open(scene_gles **out, gl_backend backend, int width, int height, failure *f);
/* The same with x^n of varying materials by nacre_gles_power. */
int scene_gles_open_power(scene_gles **out, gl_backend backend, int power, int width, int height, failure *f);
int scene_gles_draw(scene_gles *g, const scene *s, const nacre_material *material, image_u8 *out, failure *f);
const char *scene_gles_description(const scene_gles *g);
int scene_gles_mediump_is_half(scene_gles *g); /* fp16, as on small GPUs; draws a probe */
void scene_gles_close(scene_gles *g);

/* ---- scene_soft.c -------------------------------------------------------------------------------------------- */

/* The same by nacre_soft, on all threads. FAIL_UNSUPPORTED: a material or light that it can't draw. */
int scene_draw_soft(const scene *s, const nacre_material *material, image_u8 *out, failure *f);

/* Inner loops by name: portable, sse41, avx2, neon, best (what this CPU has); NULL: none of that name here. */
struct nacre_soft_kernels;
const struct nacre_soft_kernels *scene_soft_kernels(const char *name);

/* ---- scene_material.c ---------------------------------------------------------------------------------------- */

/* A material by name, for either renderer. */
typedef struct scene_material {
    nacre_material material; /* for nacre_gles */
    brdf *reflectance;       /* for double */
    image_u8 normal_map;     /* for double; texel NULL without one */
    double albedo[3];        /* of the asset, where has_albedo */
    int has_albedo;
    nacre_image image[NACRE_ROLE_COUNT];
    bytes file[NACRE_ROLE_COUNT];
} scene_material;

/* text: FILE.ktx2, a BRDF name, or role=FILE,role=FILE (roles table, spheres, albedo with lobes, normal, mask; the
   last two take a PNG too).
   exact 0 opens assets (a BRDF is baked in memory to the default table); 1 opens for double: the BRDF itself, or a
   file's decoding. *out points into itself: it must stay where it is until scene_material_close. */
int scene_material_open(scene_material *out, const char *text, int exact, failure *f);
/* The same from the bytes of a table's or spheres' file, for both renderers. *file is taken where they are opened, and
   emptied; name is for messages. */
int scene_material_take(scene_material *out, bytes *file, const char *name, failure *f);
void scene_material_close(scene_material *m);

#endif
