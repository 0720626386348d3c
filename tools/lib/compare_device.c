/* SPDX-License-Identifier: MIT */
/* The renderers of `nacre compare`: each draws the metric's frames of an asset. */
#include "compare_device.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const compare_backend_names[COMPARE_BACKENDS] = {"double", "egl2", "egl3", "osmesa", "soft"};

int compare_backend_find(compare_backend *out, const char *name, failure *f)
{
    for (int i = 0; i < COMPARE_BACKENDS; i++) {
        if (strcmp(name, compare_backend_names[i])) continue;
        *out = (compare_backend)i;
        return FAIL_NONE;
    }
    return fail(f, FAIL_USAGE, "--backend %s: unknown, expected double, egl2, egl3, osmesa or soft", name);
}

struct compare_device {
    compare_backend backend;
    scene_gles *gles; /* NULL: not by GL */
    mesh sphere;
    char description[500];
};

int compare_device_is_double(const compare_device *device)
{
    return !device || device->backend == COMPARE_DOUBLE;
}

static int open_gles(compare_device *d, failure *f)
{
    static const gl_backend backends[COMPARE_BACKENDS] = {
        [COMPARE_EGL2] = GL_BACKEND_EGL2, [COMPARE_EGL3] = GL_BACKEND_EGL3, [COMPARE_OSMESA] = GL_BACKEND_OSMESA};
    int code = scene_gles_open(&d->gles, backends[d->backend], METRIC_SIZE, METRIC_SIZE, f);
    if (code) return code;
    snprintf(d->description, sizeof d->description, "%.400s, mediump is %s", scene_gles_description(d->gles),
             scene_gles_mediump_is_half(d->gles) ? "fp16" : "fp32");
    return mesh_open(&d->sphere, "sphere", f);
}

static int open_soft(compare_device *d, failure *f)
{
    snprintf(d->description, sizeof d->description, "nacre_soft, integers on the CPU");
    return mesh_open(&d->sphere, "sphere", f);
}

int compare_device_open(compare_device **out, compare_backend backend, failure *f)
{
    compare_device *d = need_memory(1, sizeof *d);
    int code = FAIL_NONE;
    d->backend = backend;
    if (backend == COMPARE_DOUBLE)
        snprintf(d->description, sizeof d->description, "decoding 8-bit codes in double precision");
    else if (backend == COMPARE_SOFT)
        code = open_soft(d, f);
    else
        code = open_gles(d, f);
    if (code)
        compare_device_close(d);
    else
        *out = d;
    return code;
}

void compare_device_close(compare_device *device)
{
    if (!device) return;
    scene_gles_close(device->gles);
    mesh_free(&device->sphere);
    free(device);
}

const char *compare_device_description(const compare_device *device)
{
    return device->description;
}

/* The metric's camera: the exact sphere fills the frame, the object's axes are the view's. */
static int aim(scene *s, const compare_device *d, double fov_deg, failure *f)
{
    scene_camera camera = {.kind = SCENE_CAMERA_ORTHO};
    scene_begin(s, &d->sphere, METRIC_SIZE, METRIC_SIZE);
    if (fov_deg > 0) {
        camera.kind = SCENE_CAMERA_LOOK;
        camera.fovy_deg = fov_deg;
        camera.eye[2] = 1 / sin(fov_deg / 2 * (3.14159265358979323846 / 180));
    }
    return scene_aim(s, &camera, f);
}

/* RGB of a frame's disc pixels; the rest black. */
static void keep_disc(image_u8 *out, const image_u8 *frame)
{
    *out = image_u8_make(METRIC_SIZE, METRIC_SIZE, 3);
    for (int i = 0; i < METRIC_SIZE * METRIC_SIZE; i++) {
        if (frame->texel[4 * i + 3]) memcpy(out->texel + 3 * i, frame->texel + 4 * i, 3);
    }
}

int compare_device_draw(metric_frames *out, const compare_device *d, const compare_asset *asset, double exposure,
                        double fov_deg, failure *f)
{
    scene s;
    int code = aim(&s, d, fov_deg, f);
    *out = (metric_frames){0};
    for (int i = 0; i < METRIC_FRAMES * METRIC_LIGHTS && !code; i++) {
        int frame = i % METRIC_FRAMES, light = i / METRIC_FRAMES;
        double power = 3.14159265358979323846 * exposure * (light == METRIC_DIM ? exp2(-METRIC_DIM_STOPS) : 1);
        const double rgb[3] = {power, power, power};
        image_u8 drawn;
        s.light_count = 0;
        scene_add_light(&s, METRIC_STEP_DEG * frame, 0, rgb);
        code = d->gles ? scene_gles_draw(d->gles, &s, &asset->material.material, &drawn, f)
                       : scene_draw_soft(&s, &asset->material.material, &drawn, f);
        if (code) break;
        keep_disc(&out->shown[light][frame], &drawn);
        image_u8_free(&drawn);
    }
    if (code) metric_frames_free(out);
    return code;
}
