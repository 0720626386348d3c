/* SPDX-License-Identifier: MIT */
#include "sbrdf_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "metric.h"
#include "sheet.h"
#include "vec3.h"

/* The sheet is -1..1 in x and y at z = 0. */
static const double lamp[3] = {-0.35, 0.9, 0.9}, eye[3] = {0.25, -1.3, 1.2};

enum { SUPERSAMPLED, LEVEL, CODES, KINDS };

typedef struct sheet_view {
    const sbrdf_map *m;
    int level, side; /* of the texels a pixel covers */
    int width, height;
    double *radiance[KINDS];
} sheet_view;

/* pi x radiance under the lamp of a texel's BRDF at (x, y), in texels of level 0. */
static void lit(const sbrdf_map *m, const sbrdf_texel *t, double x, double y, double out[3])
{
    double at[3] = {2 * x / m->width - 1, 1 - 2 * y / m->height, 0}, to_light[3], to_eye[3];
    for (int k = 0; k < 3; k++) {
        to_light[k] = lamp[k] - at[k];
        to_eye[k] = eye[k] - at[k];
    }
    double distance = normalise3(to_light);
    normalise3(to_eye);
    sbrdf_texel_eval(t, to_light, to_eye, out);
    for (int c = 0; c < 3; c++) out[c] *= to_light[2] / (distance * distance);
}

/* The mean of all texels' radiance, each at its place. */
static void supersample(const sheet_view *v, int x, int y, double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (int j = 0; j < v->side; j++)
        for (int i = 0; i < v->side; i++) {
            sbrdf_texel t;
            double one[3];
            sbrdf_map_texel(v->m, 0, v->side * x + i, v->side * y + j, &t);
            lit(v->m, &t, v->side * x + i + 0.5, v->side * y + j + 0.5, one);
            for (int c = 0; c < 3; c++) out[c] += one[c] / (v->side * v->side);
        }
}

static void shade(sheet_view *v)
{
#pragma omp parallel for schedule(dynamic, 1)
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < v->width; x++) {
            size_t at = 3 * ((size_t)y * (size_t)v->width + (size_t)x);
            double middle_x = v->side * (x + 0.5), middle_y = v->side * (y + 0.5);
            sbrdf_texel t;
            supersample(v, x, y, v->radiance[SUPERSAMPLED] + at);
            sbrdf_map_texel(v->m, v->level, x, y, &t);
            lit(v->m, &t, middle_x, middle_y, v->radiance[LEVEL] + at);
            sbrdf_map_mean_codes(v->m, v->side * x, v->side * y, v->side, &t);
            lit(v->m, &t, middle_x, middle_y, v->radiance[CODES] + at);
        }
}

/* Display codes with the supersampled mean at a third of white, and how far two pictures are apart. */
static double exposure(const sheet_view *v)
{
    size_t count = 3 * (size_t)v->width * (size_t)v->height;
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += v->radiance[SUPERSAMPLED][i];
    return sum > 0 ? 0.33 * (double)count / sum : 1;
}

static int coded(const sheet_view *v, int kind, size_t i, double scale)
{
    return unorm8(srgb_encode(scale * v->radiance[kind][i]));
}

static double psnr(const sheet_view *v, int kind, double scale)
{
    size_t count = 3 * (size_t)v->width * (size_t)v->height;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double d = coded(v, SUPERSAMPLED, i, scale) - coded(v, kind, i, scale);
        sum += d * d;
    }
    return metric_psnr(sum / (double)count);
}

static void draw(const sheet_view *v, int row, double scale, image_u8 *pictures)
{
    int width = v->width * v->side, height = v->height * v->side;
    for (int kind = 0; kind < KINDS; kind++)
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                size_t from = 3 * ((size_t)(y / v->side) * (size_t)v->width + (size_t)(x / v->side));
                size_t to = 3 * ((size_t)(row * height + y) * (size_t)pictures->width + (size_t)(kind * width + x));
                for (size_t c = 0; c < 3; c++) pictures->texel[to + c] = (uint8_t)coded(v, kind, from + c, scale);
            }
}

void sbrdf_view_levels(const sbrdf_map *m, sbrdf_view view[SBRDF_VIEWS], image_u8 *pictures)
{
    if (pictures) {
        *pictures = image_u8_make(KINDS * m->width, SBRDF_VIEWS * m->height, 3);
        memset(pictures->texel, 0, (size_t)pictures->width * (size_t)pictures->height * 3);
    }
    for (int i = 0; i < SBRDF_VIEWS; i++) {
        sheet_view v = {.m = m, .level = 2 + i, .side = 4 << i};
        view[i] = (sbrdf_view){0, 0, 0};
        if (v.level >= m->levels || m->width < v.side || m->height < v.side) continue;
        v.width = m->width / v.side;
        v.height = m->height / v.side;
        for (int k = 0; k < KINDS; k++)
            v.radiance[k] = need_memory((size_t)v.width * (size_t)v.height, sizeof(double[3]));
        shade(&v);
        double scale = exposure(&v);
        view[i] = (sbrdf_view){v.side, psnr(&v, LEVEL, scale), psnr(&v, CODES, scale)};
        if (pictures) draw(&v, i, scale, pictures);
        for (int k = 0; k < KINDS; k++) free(v.radiance[k]);
    }
}

/* One picture of the bare sheet, opaque. */
static image_u8 cut(const image_u8 *pictures, int column, int row)
{
    image_u8 out = image_u8_make(pictures->width / KINDS, pictures->height / SBRDF_VIEWS, 4);
    for (int y = 0; y < out.height; y++)
        for (int x = 0; x < out.width; x++) {
            size_t from =
                3 * ((size_t)(row * out.height + y) * (size_t)pictures->width + (size_t)(column * out.width + x));
            uint8_t *to = out.texel + 4 * ((size_t)y * (size_t)out.width + (size_t)x);
            memcpy(to, pictures->texel + from, 3);
            to[3] = 255;
        }
    return out;
}

image_u8 sbrdf_view_label(const image_u8 *pictures, const sbrdf_view view[SBRDF_VIEWS])
{
    static const char *const heads[KINDS] = {"supersampled", "its level", "means of codes"};
    const int least = 176; /* pixels that the widest name needs */
    const sheet_layout layout = {.title = "From afar: levels that were fitted, and means of codes",
                                 .columns = KINDS,
                                 .rows = SBRDF_VIEWS,
                                 .cell_width = pictures->width / KINDS > least ? pictures->width / KINDS : least,
                                 .cell_height = pictures->height / SBRDF_VIEWS,
                                 .row_label_width = 120,
                                 .has_captions = 1,
                                 .has_heads = 1};
    sheet labelled = sheet_begin(&layout);
    for (int k = 0; k < KINDS; k++) sheet_head(&labelled, k, heads[k]);
    for (int i = 0; i < SBRDF_VIEWS; i++) {
        char text[32];
        if (!view[i].factor) continue;
        snprintf(text, sizeof text, "1/%d of\nthe size", view[i].factor);
        sheet_row_label(&labelled, i, text);
        for (int k = 0; k < KINDS; k++) {
            image_u8 picture = cut(pictures, k, i);
            sheet_place(&labelled, k, i, &picture);
            image_u8_free(&picture);
        }
        snprintf(text, sizeof text, "%.1f dB", view[i].level_psnr);
        sheet_caption(&labelled, LEVEL, i, text);
        snprintf(text, sizeof text, "%.1f dB", view[i].average_psnr);
        sheet_caption(&labelled, CODES, i, text);
    }
    return labelled.picture;
}
