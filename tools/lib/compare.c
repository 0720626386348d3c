/* SPDX-License-Identifier: MIT */
#include "compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "compare_device.h"
#include "ssim.h"

/* ---- the reference -------------------------------------------------------------------------------------------------- */

static void view_albedos(const brdf *b, const brdf *where, double albedo[COMPARE_VIEWS][3])
{
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < COMPARE_VIEWS; i++) brdf_view_albedo(b, where, COMPARE_VIEW_DEG * i, albedo[i]);
}

void compare_truth_take(compare_truth *out, brdf *b, double fov_deg)
{
    *out = (compare_truth){.b = b, .exposure = brdf_exposure(b), .fov_deg = fov_deg};
    metric_draw(&out->frames, b, out->exposure, fov_deg);
    view_albedos(b, NULL, out->albedo);
}

int compare_truth_open(compare_truth *out, const char *name, double fov_deg, failure *f)
{
    brdf *b;
    int code = brdf_open(&b, name, f);
    if (!code) compare_truth_take(out, b, fov_deg);
    return code;
}

void compare_truth_close(compare_truth *truth)
{
    brdf_close(truth->b);
    metric_frames_free(&truth->frames);
    *truth = (compare_truth){0};
}

/* ---- what is compared ----------------------------------------------------------------------------------------------- */

static long long image_bytes(const nacre_image *image)
{
    long long sum = 0;
    for (unsigned level = 0; level < image->levels; level++) {
        uint32_t size = 0;
        nacre_image_texels(image, level, 0, 0, &size);
        sum += (long long)size * image->layers * image->faces;
    }
    return sum;
}

/* A table is fetched from each layer; of spheres the two images whose light angles are nearest. */
static int light_fetches(const nacre_material *m)
{
    const nacre_image *image = m->image[m->model == NACRE_MODEL_SPHERES ? NACRE_ROLE_SPHERES : NACRE_ROLE_TABLE];
    return image->layers < 2 ? image->layers : 2;
}

static void describe(compare_asset *a, const char *name)
{
    snprintf(a->name, sizeof a->name, "%s", name);
    a->reflectance = a->material.reflectance;
    snprintf(a->description, sizeof a->description, "%s", a->reflectance->description);
    for (int role = 0; role < NACRE_ROLE_COUNT; role++) {
        if (role != NACRE_ROLE_NORMAL && a->material.material.image[role])
            a->texture_bytes += image_bytes(a->material.material.image[role]);
    }
    if (a->texture_bytes) a->fetches = light_fetches(&a->material.material);
}

int compare_asset_open(compare_asset *out, const char *text, failure *f)
{
    *out = (compare_asset){0};
    int code = scene_material_open(&out->material, text, 1, f);
    if (!code) describe(out, text);
    return code;
}

int compare_asset_take(compare_asset *out, bytes *file, const char *name, failure *f)
{
    *out = (compare_asset){0};
    int code = scene_material_take(&out->material, file, name, f);
    if (!code) describe(out, name);
    return code;
}

void compare_asset_of_brdf(compare_asset *out, brdf *b, const char *name)
{
    *out = (compare_asset){0};
    out->material.reflectance = b;
    describe(out, name);
}

void compare_asset_close(compare_asset *asset)
{
    scene_material_close(&asset->material);
    *asset = (compare_asset){0};
}

/* ---- figures -------------------------------------------------------------------------------------------------------- */

static double mean_ssim(const metric_frames *a, const metric_frames *b)
{
    uint8_t disc[METRIC_SIZE * METRIC_SIZE];
    double frame[METRIC_FRAMES], sum = 0, normal[3];
    for (int i = 0; i < METRIC_SIZE * METRIC_SIZE; i++)
        disc[i] = (uint8_t)metric_normal(i % METRIC_SIZE, i / METRIC_SIZE, METRIC_SIZE, normal);
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < METRIC_FRAMES; k++)
        frame[k] = ssim_mean(&a->shown[METRIC_FULL][k], &b->shown[METRIC_FULL][k], disc);
    for (int k = 0; k < METRIC_FRAMES; k++) sum += frame[k];
    return sum / METRIC_FRAMES;
}

static double luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; /* Rec. 709 */
}

static void score_albedo(compare_result *out, const compare_truth *truth, const brdf *b)
{
    view_albedos(b, truth->b, out->albedo);
    out->albedo_error = -1;
    for (int i = 0; i < COMPARE_VIEWS; i++) {
        double expected = luminance(truth->albedo[i]), difference = fabs(luminance(out->albedo[i]) - expected);
        double error = difference > 0 ? difference / expected : 0;
        if (error <= out->albedo_error) continue;
        out->albedo_error = error;
        out->albedo_error_deg = COMPARE_VIEW_DEG * i;
    }
}

int compare_run(compare_result *out, metric_frames *frames, const compare_truth *truth, const compare_asset *asset,
                compare_device *device, failure *f)
{
    int exact = compare_device_is_double(device), code = FAIL_NONE;
    metric_frames decoded = {0}, shown = {0}, *drawn = exact ? &decoded : &shown, *other = exact ? &shown : &decoded;
    if (!exact && !asset->texture_bytes)
        return fail(f, FAIL_UNSUPPORTED, "%s: a BRDF draws in double only, expected FILE.ktx2", asset->name);
    if (!exact) code = compare_device_draw(&shown, device, asset, truth->exposure, truth->fov_deg, f);
    if (code) return code;
    metric_draw(&decoded, asset->reflectance, truth->exposure, truth->fov_deg);
    *out = (compare_result){.relative_rms = metric_relative_rms(&truth->frames, &decoded)};
    metric_score(&out->full, &truth->frames, drawn, METRIC_FULL);
    metric_score(&out->dim, &truth->frames, drawn, METRIC_DIM);
    out->ssim = mean_ssim(&truth->frames, drawn);
    score_albedo(out, truth, asset->reflectance);
    metric_frames_free(other);
    if (frames)
        *frames = *drawn;
    else
        metric_frames_free(drawn);
    return FAIL_NONE;
}
