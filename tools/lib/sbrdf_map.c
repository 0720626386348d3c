/* SPDX-License-Identifier: MIT */
#include "sbrdf_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "ktx2_write.h"
#include "mip.h"
#include "nacre_asset.h"

static const double pi = 3.14159265358979323846;

/* ---- one texel ------------------------------------------------------------------------------------ */

void sbrdf_texel_eval(const sbrdf_texel *t, const double to_light[3], const double to_eye[3], double f_r[3])
{
    double x = t->direction[0], y = t->direction[1];
    double l[3] = {x * to_light[0] + y * to_light[1], x * to_light[1] - y * to_light[0], to_light[2]};
    double v[3] = {x * to_eye[0] + y * to_eye[1], x * to_eye[1] - y * to_eye[0], to_eye[2]};
    lafortune_shared_eval(&t->brdf, l, v, f_r);
}

/* ---- codes ---------------------------------------------------------------------------------------- */

static int nearest_code(double code)
{
    return code > 0 ? code < 255 ? (int)floor(code + 0.5) : 255 : 0; /* NaN: 0 */
}

double sbrdf_shape_value(double code, double most)
{
    return most * (code - NACRE_CODE_ZERO) / NACRE_CODE_STEPS;
}

int sbrdf_shape_code(double value, double most)
{
    return nearest_code(value / most * NACRE_CODE_STEPS + NACRE_CODE_ZERO);
}

double sbrdf_exponent_value(double code)
{
    return NACRE_EXPONENT_MOST * (code / 255) * (code / 255);
}

int sbrdf_exponent_code(double n)
{
    return nearest_code(255 * sqrt(fmax(n, 0) / NACRE_EXPONENT_MOST));
}

double sbrdf_albedo_value(double code, double most)
{
    return most * code / 255;
}

int sbrdf_albedo_code(double value, double most)
{
    return nearest_code(255 * value / most);
}

/* ---- maps ----------------------------------------------------------------------------------------- */

static int halved(int side, int level)
{
    return side >> level ? side >> level : 1;
}

int sbrdf_level_width(const sbrdf_map *m, int level)
{
    return halved(m->width, level);
}

int sbrdf_level_height(const sbrdf_map *m, int level)
{
    return halved(m->height, level);
}

static size_t level_texels(const sbrdf_map *m, int level)
{
    return (size_t)halved(m->width, level) * (size_t)halved(m->height, level);
}

void sbrdf_map_make(sbrdf_map *m, int width, int height, int lobes, int has_direction, int levels)
{
    memset(m, 0, sizeof *m);
    m->width = width;
    m->height = height;
    m->lobes = lobes;
    m->has_direction = has_direction;
    m->layers = has_direction && lobes == 1 ? 3 : 2 * lobes;
    m->levels = levels ? levels : mip_count(width, height);
    m->albedo_most = 1;
    for (int j = 0; j < LAFORTUNE_MAX_LOBES; j++) m->most[j] = m->shape_most[j] = 1;
    for (int i = 0; i < m->levels; i++) {
        size_t size = 4 * level_texels(m, i);
        m->albedo[i] = need_memory(size, 1);
        m->lobe[i] = need_memory(size, (size_t)m->layers);
        memset(m->albedo[i], 0, size);
        memset(m->lobe[i], 0, size * (size_t)m->layers);
    }
}

void sbrdf_map_free(sbrdf_map *m)
{
    for (int i = 0; i < SBRDF_MAX_LEVELS; i++) {
        free(m->albedo[i]);
        free(m->lobe[i]);
    }
    *m = (sbrdf_map){0};
}

/* Codes of a texel, possibly filtered: albedo, then the layers. */
typedef struct codes {
    double rgba[1 + 2 * LAFORTUNE_MAX_LOBES][4];
} codes;

static void add_codes(const sbrdf_map *m, int level, int x, int y, double weight, codes *sum)
{
    size_t at = 4 * ((size_t)y * (size_t)halved(m->width, level) + (size_t)x), layer = 4 * level_texels(m, level);
    for (int c = 0; c < 4; c++) {
        sum->rgba[0][c] += weight * m->albedo[level][at + (size_t)c];
        for (int k = 0; k < m->layers; k++)
            sum->rgba[1 + k][c] += weight * m->lobe[level][(size_t)k * layer + at + (size_t)c];
    }
}

static void decode(const sbrdf_map *m, const codes *from, sbrdf_texel *out)
{
    memset(out, 0, sizeof *out);
    out->brdf.lobes = m->lobes;
    out->alpha = from->rgba[0][3] / 255;
    out->direction[0] = 1;
    for (int c = 0; c < 3; c++) out->brdf.kd[c] = sbrdf_albedo_value(from->rgba[0][c], m->albedo_most);
    for (int j = 0; j < m->lobes; j++) {
        const double *albedo = from->rgba[1 + 2 * j], *shape = from->rgba[2 + 2 * j];
        lafortune_shared_lobe *lobe = &out->brdf.lobe[j];
        for (int c = 0; c < 3; c++) {
            lobe->ks[c] = sbrdf_albedo_value(albedo[c], m->most[j]) / pi;
            lobe->c[c] = sbrdf_shape_value(shape[c], m->shape_most[j]);
        }
        lobe->n = sbrdf_exponent_value(shape[3]);
    }
    if (!m->has_direction) return;
    double x = sbrdf_shape_value(from->rgba[1][3], 1), y = sbrdf_shape_value(from->rgba[3][3], 1), length = hypot(x, y);
    out->direction[0] = length > 0 ? x / length : 1;
    out->direction[1] = length > 0 ? y / length : 0;
}

void sbrdf_map_texel(const sbrdf_map *m, int level, int x, int y, sbrdf_texel *out)
{
    codes sum = {{{0}}};
    add_codes(m, level, x, y, 1, &sum);
    decode(m, &sum, out);
}

void sbrdf_map_mean_codes(const sbrdf_map *m, int x, int y, int side, sbrdf_texel *out)
{
    codes sum = {{{0}}};
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) add_codes(m, 0, x + i, y + j, 1.0 / ((double)side * side), &sum);
    decode(m, &sum, out);
}

static int repeated(double i, int count)
{
    double j = fmod(i, count);
    return (int)(j < 0 ? j + count : j);
}

/* GL_LINEAR within a level, GL_REPEAT. */
static void add_level(const sbrdf_map *m, int level, double u, double v, double weight, codes *sum)
{
    int width = halved(m->width, level), height = halved(m->height, level);
    double x = u * width - 0.5, y = (1 - v) * height - 0.5, a = x - floor(x), b = y - floor(y);
    for (int corner = 0; corner < 4; corner++) {
        double part = (corner & 1 ? a : 1 - a) * (corner >> 1 ? b : 1 - b);
        if (part > 0)
            add_codes(m, level, repeated(floor(x) + (corner & 1), width), repeated(floor(y) + (corner >> 1), height),
                      weight * part, sum);
    }
}

void sbrdf_map_sample(const sbrdf_map *m, double u, double v, double lod, sbrdf_texel *out)
{
    codes sum = {{{0}}};
    double at = fmin(fmax(lod, 0), m->levels - 1);
    int level = (int)floor(at);
    add_level(m, level, u, v, 1 - (at - level), &sum);
    if (at > level) add_level(m, level + 1, u, v, at - level, &sum);
    decode(m, &sum, out);
}

/* ---- as a BRDF --------------------------------------------------------------------------------------- */

typedef struct map_source {
    brdf base;
    sbrdf_map map;
    sbrdf_texel mean;
} map_source;

static void eval_at(const brdf *b, const double uv[2], const double to_light[3], const double to_eye[3], double f_r[3])
{
    sbrdf_texel t;
    sbrdf_map_sample(&((const map_source *)b)->map, uv[0], uv[1], 0, &t);
    sbrdf_texel_eval(&t, to_light, to_eye, f_r);
}

static int eval_mean(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    sbrdf_texel_eval(&((const map_source *)b)->mean, to_light, to_eye, f_r);
    return 1;
}

static void close_map(brdf *b)
{
    sbrdf_map_free(&((map_source *)b)->map);
    free(b);
}

brdf *sbrdf_map_brdf(sbrdf_map *m)
{
    map_source *s = need_memory(1, sizeof *s);
    memset(s, 0, sizeof *s);
    s->map = *m;
    *m = (sbrdf_map){0};
    sbrdf_map_texel(&s->map, s->map.levels - 1, 0, 0, &s->mean);
    s->base.eval = eval_mean;
    s->base.eval_at = eval_at;
    s->base.close = close_map;
    s->base.anisotropic = 1;
    snprintf(s->base.name, sizeof s->base.name, "%s", s->map.name);
    snprintf(s->base.description, sizeof s->base.description, "%d Lafortune lobe%s a texel, %d x %d", s->map.lobes,
             s->map.lobes == 1 ? "" : "s", s->map.width, s->map.height);
    return &s->base;
}

/* ---- files ---------------------------------------------------------------------------------------- */

static ktx2_image image_of(const sbrdf_map *m, uint8_t *const *level, int layers)
{
    ktx2_image k = {.format = NACRE_FORMAT_RGBA8, .width = m->width, .height = m->height, .faces = 1};
    k.layers = layers > 1 ? layers : 0;
    k.levels = m->levels;
    for (int i = 0; i < m->levels; i++) bytes_append(&k.level[i], level[i], 4 * level_texels(m, i) * (size_t)layers);
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "linear");
    if (m->name[0]) ktx2_key_text(&k, NACRE_KEY_NAME, m->name);
    return k;
}

void sbrdf_map_write(const sbrdf_map *m, bytes *albedo, bytes *lobes)
{
    const uint32_t count = (uint32_t)m->lobes, has_direction = (uint32_t)m->has_direction;
    ktx2_image k = image_of(m, m->albedo, 1);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "albedo");
    ktx2_key_q16(&k, NACRE_KEY_MOST, &m->albedo_most, 1);
    ktx2_key_q16(&k, NACRE_KEY_ALBEDO, m->white_sky, 3);
    ktx2_write(&k, albedo);
    ktx2_free(&k);
    k = image_of(m, m->lobe, m->layers);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "lobes");
    ktx2_key_u32(&k, NACRE_KEY_LOBES, &count, 1);
    ktx2_key_u32(&k, NACRE_KEY_DIRECTION, &has_direction, 1);
    ktx2_key_q16(&k, NACRE_KEY_MOST, m->most, m->lobes);
    ktx2_key_q16(&k, NACRE_KEY_SHAPE, m->shape_most, m->lobes);
    ktx2_write(&k, lobes);
    ktx2_free(&k);
}

static int check_role(const nacre_image *image, const char *role, const char *path, failure *f)
{
    if (!asset_key_is(image, NACRE_KEY_ROLE, role)) {
        char found[40];
        ktx2_role(image, found, sizeof found);
        return fail(f, FAIL_INVALID, "%s: key %s: found \"%s\", expected \"%s\"", path, NACRE_KEY_ROLE, found, role);
    }
    if (!asset_key_is(image, NACRE_KEY_TRANSFER, "linear"))
        return fail(f, FAIL_INVALID, "%s: key %s: expected \"linear\"", path, NACRE_KEY_TRANSFER);
    if (image->format != NACRE_FORMAT_RGBA8 || image->faces != 1)
        return fail(f, FAIL_INVALID, "%s: found format %d, %d faces, expected format %d (RGBA8), 1 face", path,
                    image->format, image->faces, NACRE_FORMAT_RGBA8);
    return FAIL_NONE;
}

/* count q16 numbers of a key, each in low..high. */
static int read_numbers(const nacre_image *image, const char *path, const char *key, double *out, int count, double low,
                        double high, failure *f)
{
    nacre_q16 value[LAFORTUNE_MAX_LOBES];
    if (!asset_key_q16(image, key, value, (unsigned)count))
        return fail(f, FAIL_INVALID, "%s: key %s: missing or not %d q16 number%s", path, key, count,
                    count == 1 ? "" : "s");
    for (int i = 0; i < count; i++) {
        out[i] = value[i] / 65536.0;
        if (!(out[i] >= low && out[i] <= high))
            return fail(f, FAIL_INVALID, "%s: key %s: found %g, expected %g..%g", path, key, out[i], low, high);
    }
    return FAIL_NONE;
}

int sbrdf_check_albedo(const nacre_image *image, const char *path, double *most, failure *f)
{
    double value;
    int code = check_role(image, "albedo", path, f);
    if (!code && image->layers != 1)
        code = fail(f, FAIL_INVALID, "%s: found %d layers, expected 1", path, image->layers);
    if (!code) code = read_numbers(image, path, NACRE_KEY_MOST, &value, 1, 1 / 65536.0, 32768, f);
    if (!code && most) *most = value;
    return code;
}

int sbrdf_check_lobes(const nacre_image *image, const char *path, sbrdf_map *keys, failure *f)
{
    sbrdf_map m = {0};
    uint32_t lobes, direction = 0;
    int code = check_role(image, "lobes", path, f);
    if (code) return code;
    if (!asset_key_u32(image, NACRE_KEY_LOBES, &lobes, 1) || lobes < 1 || lobes > NACRE_MAX_LOBES)
        return fail(f, FAIL_INVALID, "%s: key %s: expected 1..%d", path, NACRE_KEY_LOBES, NACRE_MAX_LOBES);
    if (nacre_image_key(image, NACRE_KEY_DIRECTION, NULL) &&
        (!asset_key_u32(image, NACRE_KEY_DIRECTION, &direction, 1) || direction > 1))
        return fail(f, FAIL_INVALID, "%s: key %s: expected 0 or 1", path, NACRE_KEY_DIRECTION);
    m.lobes = (int)lobes;
    m.has_direction = (int)direction;
    m.layers = direction && lobes == 1 ? 3 : 2 * m.lobes;
    if (image->layers != m.layers)
        return fail(f, FAIL_INVALID, "%s: found %d layers, expected %d for %d lobe%s%s", path, image->layers, m.layers,
                    m.lobes, m.lobes == 1 ? "" : "s", direction ? " with a direction" : "");
    code = read_numbers(image, path, NACRE_KEY_MOST, m.most, m.lobes, 1 / 65536.0, 32768, f);
    if (!code) code = read_numbers(image, path, NACRE_KEY_SHAPE, m.shape_most, m.lobes, 1, 2, f);
    if (!code && keys) *keys = m;
    return code;
}

int sbrdf_map_read(sbrdf_map *out, const nacre_image *albedo, const char *albedo_path, const nacre_image *lobes,
                   const char *lobes_path, failure *f)
{
    sbrdf_map keys;
    double albedo_most;
    nacre_q16 white_sky[3] = {0, 0, 0};
    int code = sbrdf_check_albedo(albedo, albedo_path, &albedo_most, f);
    if (code || (code = sbrdf_check_lobes(lobes, lobes_path, &keys, f))) return code;
    if (albedo->width != lobes->width || albedo->height != lobes->height || albedo->levels != lobes->levels)
        return fail(f, FAIL_INVALID, "%s: found %d x %d texels, %d levels, expected %d x %d, %d levels as in %s",
                    lobes_path, lobes->width, lobes->height, lobes->levels, albedo->width, albedo->height,
                    albedo->levels, albedo_path);
    sbrdf_map_make(out, albedo->width, albedo->height, keys.lobes, keys.has_direction, albedo->levels);
    out->albedo_most = albedo_most;
    memcpy(out->most, keys.most, sizeof out->most);
    memcpy(out->shape_most, keys.shape_most, sizeof out->shape_most);
    asset_key_q16(albedo, NACRE_KEY_ALBEDO, white_sky, 3);
    for (int c = 0; c < 3; c++) out->white_sky[c] = white_sky[c] / 65536.0;
    ktx2_name(albedo, out->name, sizeof out->name);
    for (int i = 0; i < out->levels; i++) {
        size_t size = 4 * level_texels(out, i);
        memcpy(out->albedo[i], nacre_image_texels(albedo, (unsigned)i, 0, 0, NULL), size);
        for (int k = 0; k < out->layers; k++)
            memcpy(out->lobe[i] + (size_t)k * size, nacre_image_texels(lobes, (unsigned)i, (unsigned)k, 0, NULL), size);
    }
    return FAIL_NONE;
}
