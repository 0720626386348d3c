/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nacre_asset.h"
#include "pixels.h"
#include "quarter_fit.h"
#include "sphere_bake.h"
#include "texel_encode.h"
#include "vec3.h"

static const double pi = 3.14159265358979323846;
static const double least_l_dot_v = -0.999; /* the runtime's: beyond it the half vector is undefined */

typedef struct spheres {
    brdf base;
    int size, layers;
    sphere_mode mode;
    double polar[SPHERE_MAX_LAYERS]; /* radians */
    double scale[3], disc, k, shrink;
    double polar_deg[SPHERE_MAX_LAYERS];
    float *code; /* layers x size x size x RGB, 0..1, as a GPU reads them */
} spheres;

/* Bilinear, clamped to the edge, at image point (x, y) of the unit disc. */
static void fetch(const spheres *s, int layer, double x, double y, double out[3])
{
    double at[2] = {(0.5 + x * s->disc / 2) * s->size - 0.5, (0.5 - y * s->disc / 2) * s->size - 0.5}, part[2];
    int low[2], high[2], last = s->size - 1;
    for (int k = 0; k < 2; k++) {
        double whole = floor(at[k]);
        part[k] = at[k] - whole;
        low[k] = (int)fmin(fmax(whole, 0), last);
        high[k] = (int)fmin(fmax(whole + 1, 0), last);
    }
    const float *image = s->code + 3 * (size_t)layer * (size_t)s->size * (size_t)s->size;
    const float *row0 = image + 3 * (size_t)low[1] * (size_t)s->size,
                *row1 = image + 3 * (size_t)high[1] * (size_t)s->size;
    for (int c = 0; c < 3; c++) {
        double top = (double)row0[3 * low[0] + c] * (1 - part[0]) + (double)row0[3 * high[0] + c] * part[0];
        double bottom = (double)row1[3 * low[0] + c] * (1 - part[0]) + (double)row1[3 * high[0] + c] * part[0];
        out[c] = top * (1 - part[1]) + bottom * part[1];
    }
}

/* Codes of a layer where R_y(angle) turns n to (Mihalik & Durikovic 2015, eq. 2; x' = x c + z s, z' = -x s + z c). A normal
   turned past the rim stays at the rim; eq. 2 as printed drops z and folds it back. */
static void fetch_turned(const spheres *s, int layer, const double n[3], double angle, double out[3])
{
    double x = n[0] * cos(angle) + n[2] * sin(angle), z = n[2] * cos(angle) - n[0] * sin(angle), y = n[1];
    if (z < 0) {
        double length = hypot(x, y);
        x = length > 0 ? x / length : 1;
        y = length > 0 ? y / length : 0;
    }
    fetch(s, layer, x * s->shrink, y * s->shrink, out);
}

/* k of eq. 3: 1/2 + sin(alpha_h)/2, alpha_h between the half vector and (nx, 0, nz) normalised; at ny = +-1 that has no
   direction, and none is needed: R_y leaves n alone. */
static double rotation_coefficient(const double n[3], double phi)
{
    double length = sqrt(fmax(1 - n[1] * n[1], 0));
    if (length < 1e-9) return 0.5;
    double sine = fabs(sin(phi / 2) * n[2] - cos(phi / 2) * n[0]) / length;
    return 0.5 + fmin(sine, 1) / 2;
}

/* Light and eye in line: any azimuth would do. The runtime takes that of the view's +x, and where metric_local made the frame
   its x is the tangent nearest to that: across the eye, it is the view's own. */
static void azimuth_zero(const double eye[3], double x[3])
{
    double length = hypot(eye[0], eye[2]);
    x[0] = eye[2] / length;
    x[1] = 0;
    x[2] = -eye[0] / length;
}

/* The normal in the frame of the images (eye +z, light in y = 0 with x >= 0), and the light's polar angle. */
static double to_image_frame(const double light[3], const double eye[3], double n[3])
{
    double cosine = light[0] * eye[0] + light[1] * eye[1] + light[2] * eye[2], x[3], sine = 0;
    for (int k = 0; k < 3; k++) {
        x[k] = light[k] - cosine * eye[k];
        sine += x[k] * x[k];
    }
    sine = sqrt(sine);
    if (sine < 1e-12) {
        azimuth_zero(eye, x);
        sine = 0;
    } else {
        for (int k = 0; k < 3; k++) x[k] /= sine;
    }
    n[0] = x[2];
    n[1] = eye[0] * x[1] - eye[1] * x[0]; /* z of eye cross x */
    n[2] = eye[2];
    return atan2(sine, cosine);
}

/* Blended codes for a pair of directions above the horizon. */
static void look_up(const spheres *s, const double light[3], const double eye[3], double code[3])
{
    double n[3], second[3], phi = to_image_frame(light, eye, n);
    int last = s->layers - 1, paper = s->mode == SPHERE_PAPER;
    if (phi <= s->polar[0] || phi >= s->polar[last]) {
        /* beyond the angles that are there: the nearest image alone, with a fixed k (paper: 3/4, section 3) */
        int lone = phi <= s->polar[0] ? 0 : last;
        double k = s->k != 0 ? s->k : paper ? 0.75 : 0.5;
        fetch_turned(s, lone, n, k * (s->polar[lone] - phi), code);
        return;
    }
    int i = 0;
    while (phi >= s->polar[i + 1]) i++;
    double t = (phi - s->polar[i]) / (s->polar[i + 1] - s->polar[i]); /* eq. 1 */
    double k = s->k != 0 ? s->k : paper ? rotation_coefficient(n, phi) : 0.5;
    fetch_turned(s, i, n, k * (s->polar[i] - phi), code);
    fetch_turned(s, i + 1, n, k * (s->polar[i + 1] - phi), second);
    for (int c = 0; c < 3; c++) code[c] = code[c] * (1 - t) + second[c] * t; /* eq. 4, on encoded values */
}

/* Bilinear, end-aligned, at a place of the quarter (0..1 each). */
static void fetch_quarter(const spheres *s, int layer, double u, double v, double out[3])
{
    double x = fmin(u, 1) * (s->size - 1), y = fmin(v, 1) * (s->size - 1);
    int i = (int)fmin(x, s->size - 2), j = (int)fmin(y, s->size - 2);
    const float *at = s->code + 3 * (((size_t)layer * (size_t)s->size + (size_t)j) * (size_t)s->size + (size_t)i);
    for (int c = 0; c < 3; c++, at++) {
        double top = (double)at[0] * (1 - (x - i)) + (double)at[3] * (x - i);
        double bottom = (double)at[3 * s->size] * (1 - (x - i)) + (double)at[3 * s->size + 3] * (x - i);
        out[c] = top * (1 - (y - j)) + bottom * (y - j);
    }
}

/* Quarters: f_r. Light opposite to the eye: there is no half vector, and no light comes back. */
static int quarters_eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    const spheres *s = (const spheres *)b;
    double h[3], d[3], across[3], near_code[3], far_code[3], weight;
    f_r[0] = f_r[1] = f_r[2] = 0;
    if (!(to_light[2] > 0) || !(to_eye[2] > 0)) return 0;
    for (int k = 0; k < 3; k++) {
        h[k] = to_light[k] + to_eye[k];
        d[k] = to_light[k] - to_eye[k];
    }
    double l_dot_h = normalise3(h) / 2;
    if (2 * l_dot_h * l_dot_h - 1 < least_l_dot_v) return 1;
    if (normalise3(d) < 1e-9) azimuth_zero(h, d);
    cross3(across, h, d);
    int layer = quarter_pair(s->polar_deg, s->layers, sqrt(fmax(1 - l_dot_h, 0)), &weight);
    double u = quarter_place(d[2]), v = quarter_place(across[2]);
    fetch_quarter(s, layer, u, v, near_code);
    fetch_quarter(s, layer + 1, u, v, far_code);
    for (int c = 0; c < 3; c++) {
        double code = near_code[c] * (1 - weight) + far_code[c] * weight;
        f_r[c] = s->scale[c] * code * code * code * code / (pi * l_dot_h);
    }
    return 1;
}

static int spheres_eval_cosine(const brdf *b, const double to_light[3], const double to_eye[3], double out[3])
{
    const spheres *s = (const spheres *)b;
    out[0] = out[1] = out[2] = 0;
    if (!(to_eye[2] > 0)) return 0;
    /* In paper mode the cosine lies in the images and is turned with them: some light passes the terminator. */
    if (!(to_light[2] > 0) && s->mode != SPHERE_PAPER) return 0;
    double code[3];
    look_up(s, to_light, to_eye, code);
    for (int c = 0; c < 3; c++) {
        if (s->mode == SPHERE_PAPER)
            out[c] = srgb_decode(code[c]) / (pi * s->scale[c]);
        else
            out[c] = s->scale[c] * code[c] * code[c] * code[c] * code[c] / pi * to_light[2];
    }
    return 1;
}

static int spheres_eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    f_r[0] = f_r[1] = f_r[2] = 0;
    if (!(to_light[2] > 0)) return 0;
    int known = spheres_eval_cosine(b, to_light, to_eye, f_r);
    for (int c = 0; c < 3 && known; c++) f_r[c] /= to_light[2];
    return known;
}

static void spheres_close(brdf *b)
{
    free(((spheres *)b)->code);
    free(b);
}

static const char *format_name(int format)
{
    return format == NACRE_FORMAT_RGBA8    ? "rgba8"
           : format == NACRE_FORMAT_RGB8   ? "rgb8"
           : format == NACRE_FORMAT_RGB565 ? "rgb565"
                                           : "etc";
}

static const char *const mode_names[] = {[SPHERE_QUARTER] = "quarters about the half vector, cosine-free",
                                         [SPHERE_COSINE_FREE] = "cosine-free",
                                         [SPHERE_PAPER] = "cosine in the images (paper)"};

brdf *sphere_brdf(const sphere_asset *a, const sphere_decode_options *options)
{
    spheres *s = need_memory(1, sizeof *s);
    int paper = a->mode == SPHERE_PAPER;
    s->base.eval = a->mode == SPHERE_QUARTER ? quarters_eval : spheres_eval;
    s->base.eval_cosine = a->mode == SPHERE_QUARTER ? NULL : spheres_eval_cosine;
    s->base.lit_past_terminator = paper;
    s->base.close = spheres_close;
    snprintf(s->base.name, sizeof s->base.name, "%s", a->name);
    snprintf(s->base.description, sizeof s->base.description, "%d sphere images, %d x %d %s, %s", a->layers, a->size,
             a->size, format_name(a->format), mode_names[a->mode]);
    s->size = a->size;
    s->layers = a->layers;
    s->mode = a->mode;
    s->disc = a->disc;
    s->k = options ? options->k : 0;
    s->shrink = options && options->shrink > 0 ? options->shrink : paper ? 0.995 : 1; /* 0.995: section 4 */
    for (int c = 0; c < 3; c++) s->scale[c] = a->scale[c];
    size_t texels = (size_t)a->size * (size_t)a->size, part = texel_bytes(a->format, a->size, a->size);
    s->code = need_memory(texels * (size_t)a->layers, 3 * sizeof *s->code);
    for (int i = 0; i < a->layers; i++) {
        s->polar_deg[i] = a->polar[i];
        s->polar[i] = a->polar[i] * (pi / 180);
        texel_decode(a->format, a->level[0].data + part * (size_t)i, a->size, a->size,
                     s->code + 3 * texels * (size_t)i);
    }
    return &s->base;
}
