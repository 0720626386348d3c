/* SPDX-License-Identifier: MIT */
/* How close an asset is to the BRDF it stands for: frames of both, and the figures of `nacre compare`.
 *
 *   compare_truth truth;                                     the costly half: once a BRDF
 *   if ((code = compare_truth_open(&truth, "gold.binary", 0, f))) return code;
 *   compare_asset asset;
 *   if (!(code = compare_asset_open(&asset, "gold.ktx2", f))) {
 *       compare_result r;
 *       code = compare_run(&r, NULL, &truth, &asset, NULL, f);     NULL, NULL: no frames wanted, drawn in double
 *       compare_asset_close(&asset);
 *   }
 *   compare_truth_close(&truth);
 */
#ifndef COMPARE_H
#define COMPARE_H

#include "metric.h"
#include "scene.h"

/* Views whose hemispherical albedo is compared: 0, 15, .. 75 degrees from the normal. */
#define COMPARE_VIEWS    6
#define COMPARE_VIEW_DEG 15.0

/* The reference of a BRDF. Read-only once open: threads may share it. */
typedef struct compare_truth {
    brdf *b; /* owned */
    double exposure, fov_deg;
    metric_frames frames;
    double albedo[COMPARE_VIEWS][3];
} compare_truth;

/* name: as brdf_open takes it. fov_deg: 0 for the metric's own view, or the vertical field of view, up to 120 degrees, of a
   near eye that the sphere fills. Failures: as brdf_open. */
int compare_truth_open(compare_truth *out, const char *name, double fov_deg, failure *f);
/* The same of an open BRDF, which it owns from then on. */
void compare_truth_take(compare_truth *out, brdf *b, double fov_deg);
void compare_truth_close(compare_truth *truth);

/* What is compared. Points into itself: it must stay where it is until closed. */
typedef struct compare_asset {
    char name[1024]; /* as given */
    scene_material material;
    brdf *reflectance;       /* its decoding in double; borrowed from material */
    long long texture_bytes; /* of texels, all levels and layers, without normal maps; 0 for a BRDF by name */
    int fetches;             /* of textures, per pixel and light; 0 for a BRDF by name */
    char description[256];   /* a line for people */
} compare_asset;

/* text: FILE.ktx2, role=FILE,... as scene_material_open takes it, or a BRDF's name, which draws in double only. */
int compare_asset_open(compare_asset *out, const char *text, failure *f);
/* An asset in memory: the bytes of its file, taken (and *file emptied) on success. */
int compare_asset_take(compare_asset *out, bytes *file, const char *name, failure *f);
/* A BRDF that is no file (a fit); owned from then on. */
void compare_asset_of_brdf(compare_asset *out, brdf *b, const char *name);
void compare_asset_close(compare_asset *asset);

typedef enum compare_backend {
    COMPARE_DOUBLE, /* the file's 8-bit codes, filtered and decoded in double */
    COMPARE_EGL2,   /* nacre_gles's shaders on OpenGL ES 2.0 .. */
    COMPARE_EGL3,   /* .. ES 3.0 .. */
    COMPARE_OSMESA, /* .. and OSMesa */
    COMPARE_SOFT,   /* the fixed-point CPU renderer */
    COMPARE_BACKENDS
} compare_backend;

extern const char *const compare_backend_names[COMPARE_BACKENDS];
int compare_backend_find(compare_backend *out, const char *name, failure *f); /* FAIL_USAGE: there is no such one */

/* A renderer kept open for many assets; NULL stands for double. One device, one thread. */
typedef struct compare_device compare_device;
/* FAIL_UNSUPPORTED, with the reason, where this machine or this build has it not. */
int compare_device_open(compare_device **out, compare_backend backend, failure *f);
void compare_device_close(compare_device *device);
/* Renderer and precision in one line: "double", "Mesa / llvmpipe ... / OpenGL ES 3.1, mediump is fp16". */
const char *compare_device_description(const compare_device *device);

typedef struct compare_result {
    metric_result full, dim; /* as defined; light 2 stops down */
    double ssim;             /* mean over all frames of METRIC_FULL, windows about disc pixels (ssim.h) */
    double relative_rms;     /* of linear radiance (metric_relative_rms), of the decoding in double whatever draws */
    double albedo_error; /* largest over views 0..75 degrees of |asset - truth| / truth, luminance (Rec. 709) of the */
    double albedo_error_deg; /* hemispherical albedo; at this view; of the decoding in double, too */
    double albedo[COMPARE_VIEWS][3];
} compare_result;

/* Draw the asset and compare. frames (may be NULL) receives what was drawn: free with metric_frames_free.
   FAIL_UNSUPPORTED: this device can't draw this asset. */
int compare_run(compare_result *out, metric_frames *frames, const compare_truth *truth, const compare_asset *asset,
                compare_device *device, failure *f);

#endif
