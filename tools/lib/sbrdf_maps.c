/* SPDX-License-Identifier: MIT */
#include "sbrdf_maps.h"

#include <math.h>
#include <string.h>

#include "pfm_io.h"

static const double pi = 3.14159265358979323846;

/* One picture while it is taken over. */
typedef struct picture {
    const char *path;
    image_f32 image;
    int is_float;
} picture;

static int check_finite(const picture *p, failure *f)
{
    const image_f32 *m = &p->image;
    size_t row = (size_t)m->width * (size_t)m->channels;
    for (size_t i = 0; i < row * (size_t)m->height; i++)
        if (!isfinite(m->texel[i]))
            return fail(f, FAIL_INVALID, "%s: texel (%d, %d): found a value that is not finite, expected numbers",
                        p->path, (int)(i % row / (size_t)m->channels), (int)(i / row));
    return FAIL_NONE;
}

static int open_picture(picture *p, const char *path, int channels, const sbrdf_field *field, const char *first,
                        failure *f)
{
    p->path = path;
    int code = float_map_read(&p->image, path, channels, &p->is_float, f);
    if (code) return code;
    if (field->texel && (p->image.width != field->width || p->image.height != field->height))
        code = fail(f, FAIL_INVALID, "%s: found %d x %d texels, expected %d x %d as in %s", path, p->image.width,
                    p->image.height, field->width, field->height, first);
    if (!code) code = check_finite(p, f);
    if (code) image_f32_free(&p->image);
    return code;
}

static double at(const picture *p, size_t texel, int channel)
{
    int have = p->image.channels;
    return p->image.texel[texel * (size_t)have + (size_t)(channel < have ? channel : have - 1)];
}

/* Of a float, itself; of a PNG's code, the albedo it stands for. */
static double albedo_at(const picture *p, size_t texel, int channel, double most, int srgb)
{
    double value = at(p, texel, channel);
    if (p->is_float) return value;
    return srgb ? most * srgb_decode(value / 255) : sbrdf_albedo_value(value, most);
}

static size_t count_of(const sbrdf_field *field)
{
    return (size_t)field->width * (size_t)field->height;
}

static int read_albedo(sbrdf_field *out, const sbrdf_map_files *files, failure *f)
{
    picture p;
    int code = open_picture(&p, files->albedo, 4, out, files->albedo, f);
    if (code) return code;
    *out = sbrdf_field_make(p.image.width, p.image.height, files->lobes, files->direction != NULL);
    for (size_t i = 0; i < count_of(out); i++) {
        for (int c = 0; c < 3; c++) out->texel[i].brdf.kd[c] = albedo_at(&p, i, c, 1, files->srgb);
        if (!p.is_float) out->texel[i].alpha = at(&p, i, 3) / 255;
    }
    image_f32_free(&p.image);
    return FAIL_NONE;
}

static int read_lobe_albedo(sbrdf_field *out, const sbrdf_map_files *files, int j, failure *f)
{
    picture p;
    int code = open_picture(&p, files->lobe[j].albedo, 3, out, files->albedo, f);
    if (code) return code;
    for (size_t i = 0; i < count_of(out); i++)
        for (int c = 0; c < 3; c++)
            out->texel[i].brdf.lobe[j].ks[c] = albedo_at(&p, i, c, files->lobe_most, files->srgb) / pi;
    image_f32_free(&p.image);
    return FAIL_NONE;
}

static int read_shape(sbrdf_field *out, const sbrdf_map_files *files, int j, failure *f)
{
    picture p;
    int code = open_picture(&p, files->lobe[j].shape, 4, out, files->albedo, f);
    if (code) return code;
    if (p.is_float && !files->lobe[j].exponent)
        code = fail(f, FAIL_INVALID, "%s: found no exponents in a float map, expected a third file for them", p.path);
    for (size_t i = 0; i < count_of(out) && !code; i++) {
        lafortune_shared_lobe *lobe = &out->texel[i].brdf.lobe[j];
        for (int c = 0; c < 3; c++)
            lobe->c[c] = p.is_float ? at(&p, i, c) : sbrdf_shape_value(at(&p, i, c), files->shape_most);
        if (!p.is_float) lobe->n = sbrdf_exponent_value(at(&p, i, 3));
    }
    image_f32_free(&p.image);
    return code;
}

static int read_exponent(sbrdf_field *out, const sbrdf_map_files *files, int j, failure *f)
{
    picture p;
    if (!files->lobe[j].exponent) return FAIL_NONE;
    int code = open_picture(&p, files->lobe[j].exponent, 1, out, files->albedo, f);
    if (code) return code;
    for (size_t i = 0; i < count_of(out); i++)
        out->texel[i].brdf.lobe[j].n = p.is_float ? at(&p, i, 0) : sbrdf_exponent_value(at(&p, i, 0));
    image_f32_free(&p.image);
    return FAIL_NONE;
}

static int read_direction(sbrdf_field *out, const sbrdf_map_files *files, failure *f)
{
    picture p;
    if (!files->direction) return FAIL_NONE;
    int code = open_picture(&p, files->direction, 3, out, files->albedo, f);
    if (code) return code;
    for (size_t i = 0; i < count_of(out); i++)
        for (int k = 0; k < 2; k++)
            out->texel[i].direction[k] = p.is_float ? at(&p, i, k) : sbrdf_shape_value(at(&p, i, k), 1);
    image_f32_free(&p.image);
    return FAIL_NONE;
}

int sbrdf_maps_read(sbrdf_field *out, const sbrdf_map_files *files, failure *f)
{
    *out = (sbrdf_field){0};
    int code = read_albedo(out, files, f);
    for (int j = 0; j < files->lobes && !code; j++) {
        code = read_lobe_albedo(out, files, j, f);
        if (!code) code = read_shape(out, files, j, f);
        if (!code) code = read_exponent(out, files, j, f);
    }
    if (!code) code = read_direction(out, files, f);
    if (code) sbrdf_field_free(out);
    return code;
}
