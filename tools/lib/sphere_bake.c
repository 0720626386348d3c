/* SPDX-License-Identifier: MIT */
#include "sphere_bake.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "ktx2_write.h"
#include "mip.h"
#include "pixels.h"
#include "quarter_fit.h"
#include "sphere_fit.h"
#include "texel_encode.h"
#include "vec3.h"

/*
 * Image i of the cosine-free mode holds g_i(n) = pi f_r at light polar angle phi_i. In coordinates of the half vector that is
 * f_r(theta_half, phi_diff) at theta_diff = phi_i / 2, so the runtime turns a normal by k = 1/2 of the angle difference and meets
 * the same theta_half and phi_diff. Where the image's own light or eye lies below the horizon there is no such f_r; yet
 * light angles below phi_i ask for it. g_i is extended there: same theta_half and phi_diff, and the largest theta_diff at
 * which the pair is still above the horizon (extend()).
 */

const char *const sphere_mode_names[3] = {"quarter", "cosine-free", "paper"};

static const double pi = 3.14159265358979323846;

/* Smallest n.v: closer to the rim, its value is repeated. Smallest n.l of an extended value: closer to the horizon many
   models have a peak of no consequence (it is multiplied by n.l), which must not spread over the unlit part. */
static const double rim_cosine = 0.01;
static const double extension_cosine = 0.02;

/* Largest pi E f_r a code can say: 6 stops above white. Beyond, peaks cost more in rings around them than they show. */
static const double most_display = 64;

/* Of errors two stops below the metric's exposure, beside those at it. */
static const double stops_weight = 0.25;

typedef struct layer_geometry {
    double light[3], half[3], across[3]; /* light = half cos(phi/2) + across sin(phi/2) */
} layer_geometry;

static layer_geometry geometry_of(double polar_deg)
{
    double phi = polar_deg * (pi / 180);
    layer_geometry g = {{sin(phi), 0, cos(phi)}, {sin(phi / 2), 0, cos(phi / 2)}, {cos(phi / 2), 0, -sin(phi / 2)}};
    return g;
}

/* f_r at normal n for directions of the same space. */
static int eval_at(const brdf *b, const double n[3], const double light[3], const double eye[3], double f_r[3])
{
    int axis = fabs(n[0]) < 0.9 ? 0 : 1;
    double x[3], length = sqrt(1 - n[axis] * n[axis]);
    for (int k = 0; k < 3; k++) x[k] = ((k == axis) - n[axis] * n[k]) / length;
    double y[3] = {n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]};
    double to_light[3] = {dot3(light, x), dot3(light, y), dot3(light, n)};
    double to_eye[3] = {dot3(eye, x), dot3(eye, y), dot3(eye, n)};
    return b->eval(b, to_light, to_eye, f_r);
}

/* f_r for a normal that sees no light: theta_half and phi_diff of the pair stay, theta_diff shrinks until n.l =
   extension_cosine. In the frame of the half vector n = (a, y, c), light = (sin d, 0, cos d), eye = (-sin d, 0, cos d); a < 0
   (c <= 0 can't see both for any d: n is lifted towards the half vector first). */
static int extend(const brdf *b, const layer_geometry *g, const double n[3], double f_r[3])
{
    double in_half[3] = {dot3(n, g->across), n[1], dot3(n, g->half)};
    if (in_half[2] < extension_cosine) {
        double lie = hypot(in_half[0], in_half[1]), to = sqrt(1 - extension_cosine * extension_cosine);
        in_half[0] *= to / lie;
        in_half[1] *= to / lie;
        in_half[2] = extension_cosine;
    }
    /* cos d c + sin d a = rho cos(d + delta) */
    double rho = hypot(in_half[0], in_half[2]), delta = atan2(-in_half[0], in_half[2]);
    double d = acos(fmin(1, extension_cosine / rho)) - delta;
    d = d > 0 ? d : 0;
    const double light[3] = {sin(d), 0, cos(d)}, eye[3] = {-sin(d), 0, cos(d)};
    return eval_at(b, in_half, light, eye, f_r);
}

/* pi f_r (cosine-free) at image point (x, y), the disc being the unit disc; any point of the plane. 0 = no data. */
static int cosine_free_at(const brdf *b, const layer_geometry *g, double x, double y, double out[3])
{
    static const double eye[3] = {0, 0, 1};
    double r = hypot(x, y), most = sqrt(1 - rim_cosine * rim_cosine);
    if (r > most) {
        x *= most / r;
        y *= most / r;
    }
    const double n[3] = {x, y, sqrt(1 - x * x - y * y)};
    double n_dot_l = dot3(n, g->light);
    int known = n_dot_l > 0 ? eval_at(b, n, g->light, eye, out) : extend(b, g, n, out);
    for (int c = 0; c < 3; c++) out[c] = known && isfinite(out[c]) && out[c] > 0 ? pi * out[c] : 0;
    return known;
}

/* min(pi E f_r n.l, 1) (paper) at a point of the disc. */
static void paper_at(const brdf *b, const layer_geometry *g, const double scale[3], double x, double y, double out[3])
{
    static const double eye[3] = {0, 0, 1};
    const double n[3] = {x, y, sqrt(1 - x * x - y * y)};
    double n_dot_l = dot3(n, g->light);
    if (n_dot_l <= 0 || !eval_at(b, n, g->light, eye, out)) {
        out[0] = out[1] = out[2] = 0;
        return;
    }
    for (int c = 0; c < 3; c++) out[c] = fmin(fmax(pi * scale[c] * out[c] * n_dot_l, 0), 1);
}

typedef struct render_job {
    const brdf *b;
    const sphere_asset *asset;
    double exposure;
    int samples; /* a side, of a texel */
    progress *progress;
} render_job;

/* Of the work for an image, what its samples take; the rest is the choice of texels, about the same for each channel. */
static const double render_part = 0.5;

/* Give entries of a square grid without data the mean of their neighbours that have some, ring by ring. */
static void fill_unknown(float *rgb, uint8_t *known, int size)
{
    size_t count = (size_t)size * (size_t)size, left = 0;
    for (size_t i = 0; i < count; i++) left += !known[i];
    if (left == count) return;
    while (left) {
        for (int j = 0; j < size; j++)
            for (int i = 0; i < size; i++) {
                size_t at = (size_t)j * (size_t)size + (size_t)i;
                if (known[at]) continue;
                double sum[3] = {0, 0, 0};
                int found = 0;
                for (int n = 0; n < 9; n++) {
                    int x = i + n % 3 - 1, y = j + n / 3 - 1;
                    if (x < 0 || y < 0 || x >= size || y >= size) continue;
                    size_t from = (size_t)y * (size_t)size + (size_t)x;
                    if (known[from] != 1) continue;
                    for (size_t c = 0; c < 3; c++) sum[c] += (double)rgb[3 * from + c];
                    found++;
                }
                if (!found) continue;
                for (size_t c = 0; c < 3; c++) rgb[3 * at + c] = (float)(sum[c] / found);
                known[at] = 2; /* counts from the next ring on */
                left--;
            }
        for (size_t i = 0; i < count; i++) known[i] = known[i] != 0;
    }
}

/* Point of the unit disc's plane under position (i, j) in texels from the image's top left corner. */
static void image_point(const sphere_asset *a, double i, double j, double point[2])
{
    double scale = 2 / (a->disc * a->size);
    point[0] = (i - a->size / 2.0) * scale;
    point[1] = (a->size / 2.0 - j) * scale;
}

/* The layer's linear values on a grid of job->samples x job->samples points a texel (cosine-free: pi f_r everywhere; paper: pi E f_r
   n.l, 0 outside the disc). */
static void render_layer(const render_job *job, int layer, float *rgb)
{
    const sphere_asset *a = job->asset;
    int samples = job->samples, side = a->size * samples;
    layer_geometry g = geometry_of(a->polar[layer]);
    uint8_t *known = need_memory((size_t)side, (size_t)side);
#pragma omp parallel for schedule(dynamic, 8)
    for (int j = 0; j < side; j++) {
        for (int i = 0; i < side; i++) {
            size_t at = (size_t)j * (size_t)side + (size_t)i;
            double point[2], value[3] = {0, 0, 0};
            image_point(a, (i + 0.5) / samples, (j + 0.5) / samples, point);
            known[at] = 1;
            if (a->mode == SPHERE_COSINE_FREE)
                known[at] = (uint8_t)cosine_free_at(job->b, &g, point[0], point[1], value);
            else if (point[0] * point[0] + point[1] * point[1] < 1)
                paper_at(job->b, &g, a->scale, point[0], point[1], value);
            for (size_t c = 0; c < 3; c++) rgb[3 * at + c] = (float)value[c];
        }
        progress_add(job->progress, render_part / side);
    }
    fill_unknown(rgb, known, side);
    free(known);
}

/* Largest code of a channel; 0 where texels don't stand alone (blocks). */
static int code_levels(int format, int channel)
{
    if (format == NACRE_FORMAT_RGB565) return channel == 1 ? 63 : 31;
    return format == NACRE_FORMAT_RGBA8 || format == NACRE_FORMAT_RGB8 ? 255 : 0;
}

/* ---- choice of scale ------------------------------------------------------------------------ */

enum { DISPLAY_STEPS = 4096 };

/* sRGB code (0..255, not rounded) over the square root of the linear value in 0..1. */
static void display_table(float table[DISPLAY_STEPS + 1])
{
    for (int i = 0; i <= DISPLAY_STEPS; i++) {
        double root = (double)i / DISPLAY_STEPS;
        table[i] = (float)(255 * srgb_encode(root * root));
    }
}

static double display(const float table[DISPLAY_STEPS + 1], double linear)
{
    return linear < 1 ? (double)table[(int)(sqrt(linear) * DISPLAY_STEPS + 0.5)] : 255;
}

typedef struct lit_sample {
    float root, light; /* (pi f_r)^1/4, E n.l */
    float exact[2];    /* displayed: at E, and two stops below */
} lit_sample;

/* Squared error of the displayed samples when codes of so many levels span 0..scale: at the metric's exposure, and, with
   less weight, two stops below it, where more of the highlights' range shows. */
static double scale_cost(const lit_sample *sample, size_t count, double scale, int levels,
                         const float table[DISPLAY_STEPS + 1])
{
    double sum = 0, to_code = levels / sqrt(sqrt(scale));
    for (size_t i = 0; i < count; i++) {
        double code = fmin(floor((double)sample[i].root * to_code + 0.5), levels) / to_code;
        double coded = (double)sample[i].light * code * code * code * code;
        double d = (double)sample[i].exact[0] - display(table, coded);
        double d2 = (double)sample[i].exact[1] - display(table, coded / 4);
        sum += d * d + stops_weight * d2 * d2;
    }
    return sum;
}

/* Scale of one channel: of the values from the largest f_r down, the one with the least cost. A large scale keeps peaks
   that only a dark exposure would show, a small one gives finer steps to everything else. */
static double best_scale(lit_sample *sample, size_t count, double exposure, int levels)
{
    float table[DISPLAY_STEPS + 1], most = 0;
    display_table(table);
    for (size_t i = 0; i < count; i++) {
        double root = (double)sample[i].root, linear = (double)sample[i].light * root * root * root * root;
        sample[i].exact[0] = (float)display(table, linear);
        sample[i].exact[1] = (float)display(table, linear / 4);
        most = fmaxf(most, sample[i].root);
    }
    double root = (double)most, top = fmin(root * root * root * root, most_display / exposure);
    double best = top, best_cost = INFINITY;
    for (int step = 0; step < 128; step++) {
        double scale = top * exp2(-step / 16.0);
        if (step && scale * exposure < 0.5) break;
        double cost = scale_cost(sample, count, scale, levels, table);
        if (cost >= best_cost) continue;
        best_cost = cost;
        best = scale;
    }
    return best;
}

/* Scales of the cosine-free mode, from a coarse grid of lit points of every layer. */
static void choose_scales(const render_job *job, double scale[3])
{
    static const int side = 112;
    const sphere_asset *a = job->asset;
    size_t most = (size_t)(side * side) * (size_t)a->layers, count = 0;
    lit_sample *sample[3];
    for (int c = 0; c < 3; c++) sample[c] = need_memory(most, sizeof **sample);
    for (int layer = 0; layer < a->layers; layer++) {
        layer_geometry g = geometry_of(a->polar[layer]);
        for (int i = 0; i < side * side; i++) {
            double x = (2 * (i % side) + 1.0) / side - 1, y = 1 - (2 * (i / side) + 1.0) / side, value[3];
            double z2 = 1 - x * x - y * y;
            if (z2 <= 0) continue;
            double n_dot_l = x * g.light[0] + sqrt(z2) * g.light[2];
            if (n_dot_l <= 0 || !cosine_free_at(job->b, &g, x, y, value)) continue;
            for (int c = 0; c < 3; c++) {
                sample[c][count].root = (float)sqrt(sqrt(value[c]));
                sample[c][count].light = (float)(job->exposure * n_dot_l);
            }
            count++;
        }
    }
#pragma omp parallel for schedule(static, 1)
    for (int c = 0; c < 3; c++) {
        int levels = code_levels(a->format, c) ? code_levels(a->format, c) : 31;
        scale[c] = best_scale(sample[c], count, job->exposure, levels);
        free(sample[c]);
    }
}

static double stored_q16(double x)
{
    return fmin(fmax(ceil(x * 65536 - 1e-6), 1), 2147483647) / 65536;
}

/* ---- encoding ------------------------------------------------------------------------------- */

static float encode_value(const sphere_asset *a, double linear, int channel)
{
    if (a->mode == SPHERE_PAPER) return (float)srgb_encode(fmin(linear, 1));
    return (float)sqrt(sqrt(fmin(fmax(linear / a->scale[channel], 0), 1)));
}

/* Part of each texel inside the disc. */
static void cover(const render_job *job, float *coverage)
{
    const sphere_asset *a = job->asset;
    int samples = job->samples;
    for (int i = 0; i < a->size * a->size; i++) {
        int inside = 0;
        for (int s = 0; s < samples * samples; s++) {
            double point[2];
            image_point(a, i % a->size + (s % samples + 0.5) / samples, i / a->size + (s / samples + 0.5) / samples,
                        point);
            inside += point[0] * point[0] + point[1] * point[1] < 1;
        }
        coverage[i] = (float)inside / (float)(samples * samples);
    }
}

/* Texels from samples: the mean of the linear values, clamped to what a code can say; of those inside the disc, where
   there are any. */
static void average(const render_job *job, const float *sample, float *rgb)
{
    const sphere_asset *a = job->asset;
    int samples = job->samples, size = a->size, side = size * samples;
    for (int i = 0; i < size * size; i++) {
        double sum[2][3] = {{0}}, most;
        int count[2] = {0, 0};
        for (int s = 0; s < samples * samples; s++) {
            int x = i % size * samples + s % samples, y = i / size * samples + s / samples;
            double point[2];
            image_point(a, (x + 0.5) / samples, (y + 0.5) / samples, point);
            int inside = point[0] * point[0] + point[1] * point[1] < 1;
            count[inside]++;
            for (int c = 0; c < 3; c++) {
                most = a->mode == SPHERE_PAPER ? 1 : a->scale[c];
                sum[inside][c] += fmin((double)sample[3 * ((size_t)y * (size_t)side + (size_t)x) + (size_t)c], most);
            }
        }
        int use = count[1] > 0;
        for (int c = 0; c < 3; c++) rgb[3 * (size_t)i + (size_t)c] = (float)(sum[use][c] / count[use]);
    }
}

/* Weight of an error in a code: the square of the display's slope there, at the metric's exposure and two stops below, the
   display taken as the square root of light code^4. Not 0 where the display is saturated, else the fit would dip below
   saturation between samples; nor in the dark, so that every texel is determined. */
static double error_weight(double light, double code)
{
    if (!(code > 0)) return 0.02;
    double linear = light * code * code * code * code;
    return 0.02 + 4 * (fmin(linear, 1) + stops_weight * fmin(linear / 4, 1)) / (code * code);
}

/* Codes of level 0 (cosine-free): not the codes of averages, but those whose bilinear reconstruction is nearest to the
   samples as displayed. Narrow lobes and the steep rise at the rim gain 3 to 10 dB over averages. Rounding with regard to
   the neighbours gains 2 dB at the coarse steps of RGB565; at 8 bits it makes no difference worth its noise. */
static void fit_codes(const render_job *job, int layer, const float *sample, float *code)
{
    const sphere_asset *a = job->asset;
    layer_geometry g = geometry_of(a->polar[layer]);
    int samples = job->samples, side = a->size * samples;
    size_t count = (size_t)side * (size_t)side;
#pragma omp parallel for schedule(static, 1)
    for (int c = 0; c < 3; c++) {
        float *target = need_memory(count, sizeof *target), *weight = need_memory(count, sizeof *weight);
        for (size_t i = 0; i < count; i++) {
            double point[2], n_dot_l = 0;
            image_point(a, ((double)(i % (size_t)side) + 0.5) / samples, ((double)(i / (size_t)side) + 0.5) / samples,
                        point);
            double z2 = 1 - point[0] * point[0] - point[1] * point[1];
            if (z2 > 0) n_dot_l = point[0] * g.light[0] + sqrt(z2) * g.light[2];
            target[i] = encode_value(a, (double)sample[3 * i + (size_t)c], c);
            weight[i] = (float)error_weight(a->scale[c] * job->exposure * fmax(n_dot_l, 0), (double)target[i]);
        }
        sphere_fit(code + c, 3, target, weight, a->size, samples,
                   a->format == NACRE_FORMAT_RGB565 ? code_levels(a->format, c) : 0);
        free(weight);
        free(target);
        progress_add(job->progress, (1 - render_part) / 3);
    }
}

/* All levels of one layer into their places. rgb, coverage: of level 0; used up. */
static void encode_layer(const render_job *job, sphere_asset *a, int layer, const float *sample, float *rgb,
                         float *coverage)
{
    int size = a->size;
    float *code = need_memory((size_t)size * (size_t)size, 3 * sizeof *code);
    for (int level = 0; level < a->levels; level++) {
        size_t count = (size_t)size * (size_t)size, part = texel_bytes(a->format, size, size);
        for (size_t i = 0; i < 3 * count; i++) code[i] = encode_value(a, (double)rgb[i], (int)(i % 3));
        if (level == 0 && a->mode == SPHERE_COSINE_FREE)
            fit_codes(job, layer, sample, code);
        else if (level == 0)
            progress_add(job->progress, 1 - render_part);
        texel_encode(a->format, a->etc2, code, size, size, a->level[level].data + part * (size_t)layer);
        if (level + 1 < a->levels) mip_halve(rgb, coverage, size, size, 3, rgb, coverage);
        size /= 2;
    }
    free(code);
}

static void make_levels(sphere_asset *a)
{
    for (int level = 0; level < a->levels; level++) {
        size_t size = (size_t)a->layers * texel_bytes(a->format, a->size >> level, a->size >> level);
        a->level[level] = (bytes){need_memory(size, 1), size, size};
    }
}

/* ---- quarters ------------------------------------------------------------------------------- */

static int bake_quarters(sphere_asset *a, const render_job *job, failure *f)
{
    size_t texels = (size_t)a->size * (size_t)a->size, part = texel_bytes(a->format, a->size, a->size);
    quarter_job quarters = {job->b, job->exposure, a->polar, a->layers, a->size, {0}, job->progress};
    float *code = need_memory(texels * (size_t)a->layers, 3 * sizeof *code);
    for (int c = 0; c < 3; c++) quarters.levels[c] = code_levels(a->format, c);
    int result = quarter_fit(code, a->scale, &quarters, f);
    if (!result) make_levels(a);
    for (size_t i = 0; i < (size_t)a->layers && !result; i++)
        texel_encode(a->format, a->etc2, code + 3 * texels * i, a->size, a->size, a->level[0].data + part * i);
    free(code);
    return result;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static int check_options(const sphere_options *o, const brdf *b, failure *f)
{
    if (b->anisotropic)
        return fail(f, FAIL_UNSUPPORTED,
                    "%s: found an anisotropic material, expected an isotropic one: a sphere image holds one azimuth",
                    b->name);
    int quarters = o->mode == SPHERE_QUARTER, most = quarters ? SPHERE_MAX_QUARTER : SPHERE_MAX_SIZE;
    if (o->size && (o->size < SPHERE_MIN_SIZE || o->size > most))
        return fail(f, FAIL_USAGE, "--size: found %d, expected %d..%d", o->size, SPHERE_MIN_SIZE, most);
    if (quarters && o->size % 4 && o->format == NACRE_FORMAT_ETC2_RGB8)
        return fail(f, FAIL_USAGE, "--size: found %d, expected a multiple of 4: blocks may not span two images",
                    o->size);
    if (o->polar_count && o->images) return fail(f, FAIL_USAGE, "--images: given beside --polar, expected one of them");
    if (o->images && (o->images < 1 + quarters || o->images > SPHERE_MAX_LAYERS))
        return fail(f, FAIL_USAGE, "--images: found %d, expected %d..%d", o->images, 1 + quarters, SPHERE_MAX_LAYERS);
    if (o->polar_count < 0 || o->polar_count > SPHERE_MAX_LAYERS || (quarters && o->polar_count == 1))
        return fail(f, FAIL_USAGE, "--polar: found %d angles, expected %d..%d", o->polar_count, 1 + quarters,
                    SPHERE_MAX_LAYERS);
    for (int i = 0; i < o->polar_count; i++) {
        if (!(o->polar[i] >= 0 && o->polar[i] <= 179))
            return fail(f, FAIL_USAGE, "--polar: found %g degrees, expected 0..179", o->polar[i]);
        if (i && !(o->polar[i] >= o->polar[i - 1] + SPHERE_MIN_STEP_DEG))
            return fail(f, FAIL_USAGE, "--polar: found %g after %g degrees, expected rising angles, %g or more apart",
                        o->polar[i], o->polar[i - 1], SPHERE_MIN_STEP_DEG);
    }
    if (o->format && !texel_bytes(o->format, 1, 1))
        return fail(f, FAIL_USAGE, "--format: found vkFormat %d, expected rgba8, rgb8, rgb565, etc1 or etc2",
                    o->format);
    return FAIL_NONE;
}

static double default_polar(const sphere_asset *a, int i)
{
    return a->mode == SPHERE_QUARTER ? quarter_polar(i, a->layers) : 180.0 * i / a->layers;
}

static void apply_options(sphere_asset *a, const sphere_options *o)
{
    static const int sizes[] = {[SPHERE_QUARTER] = 32, [SPHERE_COSINE_FREE] = 256, [SPHERE_PAPER] = 512};
    int quarters = o->mode == SPHERE_QUARTER;
    a->mode = o->mode;
    a->size = o->size ? o->size : sizes[o->mode];
    a->format = o->format ? o->format : quarters ? NACRE_FORMAT_RGB8 : NACRE_FORMAT_RGBA8;
    a->etc2 = o->etc2 && a->format == NACRE_FORMAT_ETC2_RGB8;
    a->levels = o->no_mips || quarters ? 1 : mip_count(a->size, a->size);
    a->layers = o->polar_count ? o->polar_count : o->images ? o->images : quarters ? 6 : 4;
    for (int i = 0; i < a->layers; i++) {
        double bam = floor((o->polar_count ? o->polar[i] : default_polar(a, i)) * (32768 / 180.0) + 0.5);
        a->polar[i] = bam * (180 / 32768.0);
    }
    /* a 32nd of the width on each side: still one texel at the third mip level of 256 */
    int pad = o->no_pad || o->mode != SPHERE_COSINE_FREE ? 0 : (a->size + 31) / 32 > 2 ? (a->size + 31) / 32 : 2;
    a->disc = floor((double)(a->size - 2 * pad) / a->size * 65536 + 0.5) / 65536;
}

int sphere_bake(sphere_asset *out, const brdf *b, const sphere_options *options, failure *f)
{
    static const sphere_options none = {0};
    const sphere_options *o = options ? options : &none;
    int code = check_options(o, b, f);
    if (code) return code;

    sphere_asset a = {0};
    apply_options(&a, o);
    snprintf(a.name, sizeof a.name, "%s", b->name);
    brdf_albedo(b, a.albedo);
    /* the paper's 512 texels a side are fine enough for four samples each */
    render_job job = {b, &a, brdf_exposure(b), a.mode == SPHERE_PAPER ? 2 : 3, o->progress};
    if (a.mode == SPHERE_QUARTER) {
        code = bake_quarters(&a, &job, f);
        if (!code) *out = a;
        return code;
    }

    double scale[3] = {job.exposure, job.exposure, job.exposure};
    if (a.mode == SPHERE_COSINE_FREE) choose_scales(&job, scale);
    for (int c = 0; c < 3; c++) a.scale[c] = stored_q16(scale[c]);
    make_levels(&a);
    size_t texels = (size_t)a.size * (size_t)a.size;
    float *sample = need_memory(texels * (size_t)(job.samples * job.samples), 3 * sizeof *sample);
    float *rgb = need_memory(texels, 3 * sizeof *rgb), *coverage = need_memory(texels, sizeof *coverage);
    progress_begin(job.progress, "images", a.layers);
    for (int i = 0; i < a.layers; i++) {
        render_layer(&job, i, sample);
        average(&job, sample, rgb);
        cover(&job, coverage);
        encode_layer(&job, &a, i, sample, rgb, coverage);
    }
    progress_end(job.progress);
    free(coverage);
    free(rgb);
    free(sample);
    *out = a;
    return FAIL_NONE;
}

void sphere_free(sphere_asset *s)
{
    for (int i = 0; i < 12; i++) bytes_free(&s->level[i]);
    memset(s, 0, sizeof *s);
}

/* ---- files ---------------------------------------------------------------------------------- */

static const char *transfer_of(sphere_mode mode)
{
    return mode == SPHERE_PAPER ? "srgb" : mode == SPHERE_QUARTER ? "root4-lh" : "root4";
}

void sphere_write(const sphere_asset *s, bytes *out)
{
    ktx2_image k = {
        .format = s->format, .width = s->size, .height = s->size, .layers = s->layers, .faces = 1, .levels = s->levels};
    uint32_t polar_bam[SPHERE_MAX_LAYERS], yes = 1, cosine = s->mode == SPHERE_PAPER;
    int quarters = s->mode == SPHERE_QUARTER;
    for (int i = 0; i < s->levels; i++) bytes_append(&k.level[i], s->level[i].data, s->level[i].size);
    for (int i = 0; i < s->layers; i++) polar_bam[i] = (uint32_t)(s->polar[i] * (32768 / 180.0) + 0.5);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "spheres");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, transfer_of(s->mode));
    ktx2_key_text(&k, NACRE_KEY_NAME, s->name);
    if (s->format == NACRE_FORMAT_ETC2_RGB8 && !s->etc2) ktx2_key_u32(&k, NACRE_KEY_ETC1, &yes, 1);
    ktx2_key_u32(&k, NACRE_KEY_LIGHT_POLAR, polar_bam, s->layers);
    ktx2_key_u32(&k, NACRE_KEY_COSINE, &cosine, 1);
    ktx2_key_q16(&k, NACRE_KEY_SCALE, s->scale, 3);
    if (quarters) ktx2_key_u32(&k, NACRE_KEY_QUARTERS, &yes, 1);
    if (!quarters) ktx2_key_q16(&k, NACRE_KEY_DISC, &s->disc, 1);
    ktx2_key_q16(&k, NACRE_KEY_ALBEDO, s->albedo, 3);
    ktx2_write(&k, out);
    ktx2_free(&k);
}

static int read_reals(const nacre_image *image, const char *key, double *out, int count, const char *path, failure *f)
{
    nacre_q16 q16[3];
    if (!asset_key_q16(image, key, q16, (unsigned)count))
        return fail(f, FAIL_INVALID, "%s: key %s: missing or malformed, expected %d q16", path, key, count);
    for (int i = 0; i < count; i++) out[i] = q16[i] / 65536.0;
    return FAIL_NONE;
}

static int read_polar(sphere_asset *a, const nacre_image *image, const char *path, failure *f)
{
    uint32_t bam[SPHERE_MAX_LAYERS];
    if (a->layers > SPHERE_MAX_LAYERS)
        return fail(f, FAIL_UNSUPPORTED, "%s: found %d layers, expected 1..%d", path, a->layers, SPHERE_MAX_LAYERS);
    if (!asset_key_u32(image, NACRE_KEY_LIGHT_POLAR, bam, (unsigned)a->layers))
        return fail(f, FAIL_INVALID, "%s: key %s: missing or malformed, expected one u32 for each of %d layers", path,
                    NACRE_KEY_LIGHT_POLAR, a->layers);
    for (int i = 0; i < a->layers; i++) {
        if (bam[i] >= 32768 || (i && bam[i] <= bam[i - 1]))
            return fail(f, FAIL_INVALID, "%s: key %s: found bam %u in layer %d, expected rising angles below 32768",
                        path, NACRE_KEY_LIGHT_POLAR, (unsigned)bam[i], i);
        a->polar[i] = bam[i] * (180 / 32768.0);
    }
    return FAIL_NONE;
}

static int read_mode(sphere_asset *a, const nacre_image *image, const char *path, failure *f)
{
    uint32_t cosine = 0, quarters = 0, etc1 = 0;
    if (!asset_key_u32(image, NACRE_KEY_COSINE, &cosine, 1) || cosine > 1)
        return fail(f, FAIL_INVALID, "%s: key %s: missing or malformed, expected u32 0 or 1", path, NACRE_KEY_COSINE);
    if (nacre_image_key(image, NACRE_KEY_QUARTERS, NULL) &&
        (!asset_key_u32(image, NACRE_KEY_QUARTERS, &quarters, 1) || quarters > 1))
        return fail(f, FAIL_INVALID, "%s: key %s: malformed, expected u32 0 or 1", path, NACRE_KEY_QUARTERS);
    if (quarters && (cosine || a->layers < 2 || a->levels > 1))
        return fail(f, FAIL_INVALID,
                    "%s: key %s: found with %d images, %d levels and %s = %u, expected 2 or more, 1 and 0", path,
                    NACRE_KEY_QUARTERS, a->layers, a->levels, NACRE_KEY_COSINE, (unsigned)cosine);
    a->mode = cosine ? SPHERE_PAPER : quarters ? SPHERE_QUARTER : SPHERE_COSINE_FREE;
    a->etc2 = a->format == NACRE_FORMAT_ETC2_RGB8 && !(asset_key_u32(image, NACRE_KEY_ETC1, &etc1, 1) && etc1 == 1);
    const char *transfer = transfer_of(a->mode);
    if (!asset_key_is(image, NACRE_KEY_TRANSFER, transfer))
        return fail(f, FAIL_INVALID, "%s: key %s: expected \"%s\" beside %s = %u and %s = %u", path, NACRE_KEY_TRANSFER,
                    transfer, NACRE_KEY_COSINE, (unsigned)cosine, NACRE_KEY_QUARTERS, (unsigned)quarters);
    return FAIL_NONE;
}

static int read_keys(sphere_asset *a, const nacre_image *image, const char *path, failure *f)
{
    int code = read_polar(a, image, path, f);
    if (!code) code = read_mode(a, image, path, f);
    a->disc = 1;
    if (!code) code = read_reals(image, NACRE_KEY_SCALE, a->scale, 3, path, f);
    if (!code && a->mode != SPHERE_QUARTER) code = read_reals(image, NACRE_KEY_DISC, &a->disc, 1, path, f);
    if (!code) code = read_reals(image, NACRE_KEY_ALBEDO, a->albedo, 3, path, f);
    if (code) return code;
    for (int c = 0; c < 3; c++)
        if (a->scale[c] <= 0)
            return fail(f, FAIL_INVALID, "%s: key %s: found %g, expected more than 0", path, NACRE_KEY_SCALE,
                        a->scale[c]);
    if (a->disc < 0.5 || a->disc > 1)
        return fail(f, FAIL_INVALID, "%s: key %s: found %g, expected 0.5..1", path, NACRE_KEY_DISC, a->disc);
    ktx2_name(image, a->name, sizeof a->name);
    return FAIL_NONE;
}

int sphere_read(sphere_asset *out, const nacre_image *image, const char *path, failure *f)
{
    sphere_asset a = {.size = image->width, .layers = image->layers, .levels = image->levels, .format = image->format};
    if (!asset_key_is(image, NACRE_KEY_ROLE, "spheres")) {
        char found[40];
        ktx2_role(image, found, sizeof found);
        return fail(f, FAIL_INVALID, "%s: key %s: found \"%s\", expected \"spheres\"", path, NACRE_KEY_ROLE, found);
    }
    if (!texel_bytes(a.format, 1, 1))
        return fail(f, FAIL_UNSUPPORTED, "%s: found vkFormat %d, expected RGBA8, RGB8, RGB565 or ETC2 RGB8", path,
                    a.format);
    if (image->width != image->height || image->faces != 1)
        return fail(f, FAIL_INVALID, "%s: found %d x %d with %d faces, expected square images with one", path,
                    image->width, image->height, image->faces);
    int code = read_keys(&a, image, path, f);
    if (code) return code;
    for (int level = 0; level < a.levels; level++)
        for (int layer = 0; layer < a.layers; layer++) {
            uint32_t size = 0;
            const uint8_t *texel = nacre_image_texels(image, (unsigned)level, (unsigned)layer, 0, &size);
            bytes_append(&a.level[level], texel, size);
        }
    *out = a;
    return FAIL_NONE;
}
