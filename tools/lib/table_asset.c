/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "ktx2_write.h"
#include "nacre_asset.h"
#include "table_parts.h"

#define PI      3.14159265358979323846
#define ONE_Q16 65536.0

void table_free(table_asset *t)
{
    free(t->rgba);
    *t = (table_asset){0};
}

/* The numbers of NACRE_KEY_TABLE in their order, with what a reader accepts. */
#define NUMBERS 17
static const struct {
    const char *name;
    double low, high;
} number[NUMBERS] = {{"E", 1 / ONE_Q16, 32767},
                     {"Ymax", 1 / ONE_Q16, 16},
                     {"W.r", -64, 64},
                     {"W.g", -64, 64},
                     {"W.b", -64, 64},
                     {"p", 1, 8},
                     {"eps", 1 / ONE_Q16, 0.5},
                     {"K1", 0, 64},
                     {"K2", 0, 64},
                     {"B", -1, 1},
                     {"D.r", 0, TABLE_MAX_D},
                     {"D.g", 0, TABLE_MAX_D},
                     {"D.b", 0, TABLE_MAX_D},
                     {"V.r", -64, 64},
                     {"V.g", -64, 64},
                     {"V.b", -64, 64},
                     {"K4", 0, 64}};

static void list_numbers(table_asset *t, double *at[NUMBERS])
{
    double *const in_order[NUMBERS] = {&t->e,    &t->ymax, &t->w[0], &t->w[1], &t->w[2], &t->p,
                                       &t->eps,  &t->k1,   &t->k2,   &t->rows, &t->d[0], &t->d[1],
                                       &t->d[2], &t->v[0], &t->v[1], &t->v[2], &t->k4};
    memcpy(at, in_order, sizeof in_order);
}

static int count_numbers(table_layout layout)
{
    return layout == TABLE_ONE_LAYER ? 10 : layout == TABLE_TWO_LAYERS ? 17 : 9;
}

void table_write(const table_asset *t, bytes *out)
{
    table_asset copy = *t;
    double *at[NUMBERS], key[NUMBERS];
    list_numbers(&copy, at);
    for (int i = 0; i < NUMBERS; i++) key[i] = *at[i];
    ktx2_image k = {.format = NACRE_FORMAT_RGBA8, .width = t->width, .height = t->height, .faces = 1, .levels = 1};
    k.layers = t->layers > 1 ? t->layers : 0;
    bytes_append(&k.level[0], t->rgba, (size_t)(t->width * t->height * t->layers) * 4);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "table");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "root");
    ktx2_key_text(&k, NACRE_KEY_NAME, t->name);
    ktx2_key_q16(&k, NACRE_KEY_TABLE, key, count_numbers(t->layout));
    ktx2_key_q16(&k, NACRE_KEY_ALBEDO, t->albedo, 3);
    if (t->toe) ktx2_key_u32(&k, NACRE_KEY_TOE, &(uint32_t){1}, 1);
    ktx2_write(&k, out);
    ktx2_free(&k);
}

/* count q16 numbers of a key; 0 if it is missing or of another size. */
static int read_q16(const nacre_image *image, const char *key, double *value, int count)
{
    uint32_t size;
    const uint8_t *at = nacre_image_key(image, key, &size);
    if (!at || size != 4 * (uint32_t)count) return 0;
    for (int i = 0; i < count; i++, at += 4) {
        uint32_t bits = at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
        value[i] = (double)(int32_t)bits / ONE_Q16;
    }
    return 1;
}

static int check_shape(const nacre_image *image, const char *path, failure *f)
{
    if (!asset_key_is(image, NACRE_KEY_ROLE, "table")) {
        char found[40];
        ktx2_role(image, found, sizeof found);
        return fail(f, FAIL_INVALID, "%s: key %s: found \"%s\", expected \"table\"", path, NACRE_KEY_ROLE, found);
    }
    if (!asset_key_is(image, NACRE_KEY_TRANSFER, "root"))
        return fail(f, FAIL_INVALID, "%s: key %s: expected \"root\"", path, NACRE_KEY_TRANSFER);
    if (image->format != NACRE_FORMAT_RGBA8 || image->levels != 1 || image->faces != 1 || image->layers > 2)
        return fail(
            f, FAIL_INVALID,
            "%s: found format %d, %d layers, %d faces, %d levels, expected a table of format %d (RGBA8), 1 or 2 "
            "layers, 1 face, 1 level",
            path, image->format, image->layers, image->faces, image->levels, NACRE_FORMAT_RGBA8);
    if (image->width < TABLE_MIN_SIDE || image->width > TABLE_MAX_SIDE || image->height < TABLE_MIN_SIDE ||
        image->height > TABLE_MAX_SIDE)
        return fail(f, FAIL_INVALID, "%s: found %d x %d texels, expected %d..%d a side", path, image->width,
                    image->height, TABLE_MIN_SIDE, TABLE_MAX_SIDE);
    return FAIL_NONE;
}

/* Nine numbers: as they were before the row curve was one; B is 0.3 there. */
static int read_numbers(table_asset *t, const nacre_image *image, const char *path, failure *f)
{
    double *at[NUMBERS], key[NUMBERS] = {[9] = 0.3};
    int count = t->layers == 2 ? 17 : 10;
    t->layout = t->layers == 2 ? TABLE_TWO_LAYERS : TABLE_ONE_LAYER;
    if (!read_q16(image, NACRE_KEY_TABLE, key, count)) {
        count = 9;
        if (t->layers == 2) t->layout = TABLE_TWO_LAYERS_EARLY;
        if (!read_q16(image, NACRE_KEY_TABLE, key, count))
            return fail(f, FAIL_INVALID, "%s: key %s: missing or not 9 or %d q16 numbers", path, NACRE_KEY_TABLE,
                        t->layers == 2 ? 17 : 10);
    }
    for (int i = 0; i < count; i++)
        if (!(key[i] >= number[i].low && key[i] <= number[i].high))
            return fail(f, FAIL_INVALID, "%s: key %s: found %s %g, expected %g..%g", path, NACRE_KEY_TABLE,
                        number[i].name, key[i], number[i].low, number[i].high);
    list_numbers(t, at);
    for (int i = 0; i < NUMBERS; i++) *at[i] = key[i];
    return FAIL_NONE;
}

static int read_toe(table_asset *t, const nacre_image *image)
{
    uint32_t toe = 0;
    if (nacre_image_key(image, NACRE_KEY_TOE, NULL) && (!asset_key_u32(image, NACRE_KEY_TOE, &toe, 1) || toe > 1))
        return 0;
    t->toe = (int)toe;
    return 1;
}

int table_read(table_asset *out, const nacre_image *image, const char *path, failure *f)
{
    table_asset t = {.width = image->width, .height = image->height, .layers = image->layers};
    int result = check_shape(image, path, f);
    if (result || (result = read_numbers(&t, image, path, f))) return result;
    read_q16(image, NACRE_KEY_ALBEDO, t.albedo, 3);
    if (!read_toe(&t, image)) return fail(f, FAIL_INVALID, "%s: key %s: expected 0 or 1", path, NACRE_KEY_TOE);
    ktx2_name(image, t.name, sizeof t.name);
    size_t layer = (size_t)(t.width * t.height) * 4;
    t.rgba = need_memory(layer, (size_t)t.layers);
    for (int i = 0; i < t.layers; i++) {
        const uint8_t *texels = nacre_image_texels(image, 0, (unsigned)i, 0, NULL);
        memcpy(t.rgba + (size_t)i * layer, texels, layer);
    }
    *out = t;
    return FAIL_NONE;
}

/* Four channels of a layer at a footprint, 0..1. */
static void fetch(const table_asset *t, int layer, const table_footprint *at, double out[4])
{
    const uint8_t *texel = t->rgba + (size_t)(layer * t->width * t->height) * 4;
    const int offset[4] = {0, 1, t->width, t->width + 1};
    for (int k = 0; k < 4; k++) {
        out[k] = 0;
        for (int c = 0; c < 4; c++) out[k] += at->weight[c] * texel[4 * (at->first + offset[c]) + k] / 255;
    }
}

void table_y(const table_asset *t, const table_point *point, double y[3])
{
    double first[4], second[4] = {0}, basis[TABLE_BASES];
    table_footprint at = table_filter(t, point->t, point->s);
    fetch(t, 0, &at, first);
    if (t->layers == 2) fetch(t, 1, &at, second);
    table_bases(point->a, basis);
    for (int k = 0; k < 3; k++) {
        y[k] = first[k];
        switch (t->layout) {
        case TABLE_ONE_LAYER:
            y[k] += (first[3] - 0.5) * basis[0] * t->w[k];
            break;
        case TABLE_TWO_LAYERS:
            y[k] += first[3] * t->d[k] + ((second[0] - 0.5) * t->w[k] + (second[1] - 0.5) * t->v[k]) * basis[0] +
                    (second[2] - 0.5) * basis[1] * t->k2 + (second[3] - 0.5) * basis[2] * t->k4;
            break;
        case TABLE_TWO_LAYERS_EARLY:
            y[k] += (second[k] - 0.5) * basis[0] * t->k1 + (first[3] - 0.5) * basis[1] * t->k2;
            break;
        }
        y[k] = fmax(y[k], 0);
    }
}

void table_decode(const table_asset *t, const double to_light[3], const double to_eye[3], double radiance[3])
{
    table_point point;
    double y[3];
    radiance[0] = radiance[1] = radiance[2] = 0;
    if (!table_locate(&point, to_light, to_eye)) return;
    table_y(t, &point, y);
    for (int k = 0; k < 3; k++) radiance[k] = pow(t->ymax * y[k], t->p) / point.l_dot_h * to_light[2];
}

typedef struct table_source {
    brdf base;
    table_asset table;
} table_source;

static int eval_cosine(const brdf *b, const double to_light[3], const double to_eye[3], double out[3])
{
    const table_source *source = (const table_source *)b;
    table_decode(&source->table, to_light, to_eye, out);
    for (int k = 0; k < 3; k++) out[k] /= PI * source->table.e;
    return 1;
}

static int eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    eval_cosine(b, to_light, to_eye, f_r);
    for (int k = 0; k < 3 && to_light[2] > 0; k++) f_r[k] /= to_light[2];
    return 1;
}

static void close_source(brdf *b)
{
    table_source *source = (table_source *)b;
    table_free(&source->table);
    free(source);
}

brdf *table_brdf(const table_asset *t)
{
    table_source *source = need_memory(1, sizeof *source);
    size_t size = (size_t)(t->width * t->height * t->layers) * 4;
    source->table = *t;
    source->table.rgba = need_memory(size, 1);
    memcpy(source->table.rgba, t->rgba, size);
    source->base.eval = eval;
    source->base.eval_cosine = eval_cosine;
    source->base.close = close_source;
    snprintf(source->base.name, sizeof source->base.name, "%s", t->name);
    snprintf(source->base.description, sizeof source->base.description, "half-vector table, %d x %d x %d, p = %.4g",
             t->width, t->height, t->layers, t->p);
    return &source->base;
}
