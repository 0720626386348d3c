/* SPDX-License-Identifier: MIT */
/* From numbers to codes. ks x^n does not change when C grows by a factor and ks falls by its n-th power (McAllister et al.
   2002, section 4: the factor e): with C at full scale a wide lobe beside a sharp one would have an albedo of a few codes,
   with C smaller it has more. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nacre_asset.h"
#include "sbrdf_field.h"

static const double pi = 3.14159265358979323846;

enum { LEAST_STEPS = 24 }; /* of the largest part of C: below, its direction is too coarse */

/* How low x^n may be where it is largest; 1: C stays at full scale. Below 1/64, the 8 bits of a table
   of roots hold too little. */
static const double heights[] = {1, 1 / 4.0, 1 / 16.0, 1 / 64.0};
enum { HEIGHTS = sizeof heights / sizeof *heights };

/* The codes of one lobe. */
typedef struct lobe_codes {
    uint8_t albedo[3], shape[3], exponent;
} lobe_codes;

typedef struct scales {
    double most, shape_most, least_height;
} scales;

static void decode_lobe(const lobe_codes *codes, const scales *s, lafortune_shared_lobe *out)
{
    for (int c = 0; c < 3; c++) {
        out->c[c] = sbrdf_shape_value(codes->shape[c], s->shape_most);
        out->ks[c] = sbrdf_albedo_value(codes->albedo[c], s->most) / pi;
    }
    out->n = sbrdf_exponent_value(codes->exponent);
}

static double largest_part(const double c[3])
{
    return fmax(fmax(fabs(c[0]), fabs(c[1])), c[2]);
}

static void code_shape(const lafortune_shared_lobe *lobe, double scale, const scales *s, lobe_codes *out)
{
    for (int c = 0; c < 3; c++) out->shape[c] = (uint8_t)sbrdf_shape_code(scale * lobe->c[c], s->shape_most);
    out->exponent = (uint8_t)sbrdf_exponent_code(lobe->n);
}

/* Expected squared relative error of a lobe coded with C scaled so, but for its albedo: C's direction is off, n times as
   strong in the power (where a part's product is about .4; albedo takes up some of it); and a table holds the root of x^n in 8 bits. */
static double shape_error(const lafortune_shared_lobe *lobe, double height, const scales *s, const lobe_codes *codes)
{
    double n = sbrdf_exponent_value(codes->exponent), c[3], bend = 0;
    for (int k = 0; k < 3; k++) c[k] = sbrdf_shape_value(codes->shape[k], s->shape_most);
    double largest = largest_part(c), wanted = largest_part(lobe->c), table = 2 / (255 * sqrt(height));
    for (int k = 0; k < 3; k++) {
        double off = c[k] / largest - lobe->c[k] / wanted;
        bend += off * off;
    }
    return 0.1 * n * n * bend + table * table / 12;
}

/* The same of rounding the albedo's codes; infinite if they can't hold it. */
static double albedo_error(const lafortune_shared_lobe *lobe, double height, const scales *s)
{
    double squares = 0;
    for (int k = 0; k < 3; k++) {
        double code = 255 * pi * lobe->ks[k] / height / s->most;
        if (code > 255.5) return HUGE_VAL;
        squares += code * code;
    }
    return 0.25 / fmax(squares, 1e-12);
}

/* The scale of C that serves best. with_albedo 0: as if the albedo had all the codes it may want. */
static double best_scale(const lafortune_shared_lobe *lobe, const scales *s, int with_albedo, lobe_codes *best)
{
    double least = HUGE_VAL, chosen = 1;
    code_shape(lobe, 1, s, best);
    for (int steps = (int)(NACRE_CODE_STEPS / s->shape_most); steps >= LEAST_STEPS; steps--) {
        lobe_codes trial;
        double scale = steps * s->shape_most / NACRE_CODE_STEPS, height = pow(scale, lobe->n);
        if (height < s->least_height) break;
        code_shape(lobe, scale, s, &trial);
        double error = shape_error(lobe, height, s, &trial) + (with_albedo ? albedo_error(lobe, height, s) : 0);
        if (!(error < least * (1 - 1e-9))) continue;
        least = error;
        chosen = scale;
        *best = trial;
    }
    return chosen;
}

/* Least squares: how much stronger the coded shape must be lit to be like the wanted one. */
static double albedo_factor(const lafortune_shared_lobe *wanted, const lafortune_shared_lobe *coded,
                            const lafortune_pairs *p)
{
    double both = 0, own = 0;
    for (int i = 0; i < p->samples.count; i++) {
        const double *q = p->samples.product[i];
        double a = wanted->c[0] * q[0] + wanted->c[1] * q[1] + wanted->c[2] * q[2];
        double b = coded->c[0] * q[0] + coded->c[1] * q[1] + coded->c[2] * q[2];
        if (!(b > 0)) continue;
        double w = p->samples.weight[i], y = w * pow(b, coded->n);
        own += y * y;
        if (a > 0) both += y * w * pow(a, wanted->n);
    }
    return own > 0 && both > 0 ? both / own : 0;
}

static void code_albedo(const lafortune_shared_lobe *lobe, const scales *s, const lafortune_pairs *p, lobe_codes *codes)
{
    lafortune_shared_lobe coded;
    decode_lobe(codes, s, &coded);
    double factor = albedo_factor(lobe, &coded, p);
    for (int c = 0; c < 3; c++) codes->albedo[c] = (uint8_t)sbrdf_albedo_code(pi * lobe->ks[c] * factor, s->most);
}

static lobe_codes code_lobe(const lafortune_shared_lobe *lobe, const scales *s, const lafortune_pairs *p)
{
    lobe_codes codes;
    best_scale(lobe, s, 1, &codes);
    code_albedo(lobe, s, p, &codes);
    return codes;
}

/* ---- maps -------------------------------------------------------------------------------------------- */

static int is_lit(const lafortune_shared_lobe *lobe)
{
    return lobe->ks[0] > 0 || lobe->ks[1] > 0 || lobe->ks[2] > 0;
}

/* What the lobe albedos of one lobe go up to when C is as small as serves it. */
static double largest_albedo(const sbrdf_field *level, int count, int j, const scales *s)
{
    double most = 0;
    for (int k = 0; k < count; k++) {
        long texels = (long)level[k].width * level[k].height;
#pragma omp parallel for schedule(static) reduction(max : most)
        for (long i = 0; i < texels; i++) {
            const lafortune_shared_lobe *lobe = &level[k].texel[i].brdf.lobe[j];
            lobe_codes codes;
            double height = is_lit(lobe) ? pow(best_scale(lobe, s, 0, &codes), lobe->n) : 1;
            for (int c = 0; c < 3; c++) most = fmax(most, pi * lobe->ks[c] / height);
        }
    }
    return most;
}

/* A q16 holds it, rounded up so that nothing is beyond code 255. */
static double settled(double most, double limit)
{
    return most > 0 ? fmin(ceil(most * 65536) / 65536, limit) : 1;
}

static size_t texels_of(const sbrdf_field *f)
{
    return (size_t)f->width * (size_t)f->height;
}

/* Ranges that every code of every level fits into. */
static void find_scales(const sbrdf_field *level, int count, double least_height, sbrdf_map *m)
{
    double albedo = 0;
    for (int k = 0; k < count; k++)
        for (size_t i = 0; i < texels_of(&level[k]); i++)
            for (int c = 0; c < 3; c++) albedo = fmax(albedo, level[k].texel[i].brdf.kd[c]);
    m->albedo_most = settled(albedo, 32767);
    for (int j = 0; j < m->lobes; j++) {
        scales s = {1, 1, least_height};
        for (int k = 0; k < count; k++)
            for (size_t i = 0; i < texels_of(&level[k]); i++) {
                const lafortune_shared_lobe *lobe = &level[k].texel[i].brdf.lobe[j];
                for (int c = 0; c < 3 && is_lit(lobe); c++) s.shape_most = fmax(s.shape_most, fabs(lobe->c[c]));
            }
        m->shape_most[j] = s.shape_most = settled(s.shape_most, 2);
        m->most[j] = settled(largest_albedo(level, count, j, &s), 32767);
    }
}

static void put_lobe(sbrdf_map *m, int level, int lobe, size_t texel, const lobe_codes *codes)
{
    size_t layer = 4 * (size_t)sbrdf_level_width(m, level) * (size_t)sbrdf_level_height(m, level);
    uint8_t *albedo = m->lobe[level] + (size_t)(2 * lobe) * layer + 4 * texel, *shape = albedo + layer;
    memcpy(albedo, codes->albedo, 3);
    memcpy(shape, codes->shape, 3);
    shape[3] = codes->exponent;
}

static void put_rest(sbrdf_map *m, int level, size_t texel, const sbrdf_texel *t)
{
    size_t layer = 4 * (size_t)sbrdf_level_width(m, level) * (size_t)sbrdf_level_height(m, level);
    uint8_t *albedo = m->albedo[level] + 4 * texel, *first = m->lobe[level] + 4 * texel + 3;
    for (int c = 0; c < 3; c++) albedo[c] = (uint8_t)sbrdf_albedo_code(t->brdf.kd[c], m->albedo_most);
    albedo[3] = (uint8_t)sbrdf_albedo_code(t->alpha, 1);
    for (int k = 0; k < m->layers; k += 2)
        first[(size_t)k * layer] = m->has_direction && k < 4 ? (uint8_t)sbrdf_shape_code(t->direction[k / 2], 1) : 255;
}

/* Black lobes take the shape of the texel before them, so that filtering does not bend their neighbours. */
static void fill_black(sbrdf_map *m, int level, const sbrdf_field *f)
{
    size_t count = (size_t)f->width * (size_t)f->height;
    for (int j = 0; j < m->lobes; j++) {
        uint8_t *shape = m->lobe[level] + (size_t)(2 * j + 1) * 4 * count;
        size_t known = count;
        for (size_t pass = 0; pass < 2 * count; pass++) {
            size_t i = pass % count;
            if (is_lit(&f->texel[i].brdf.lobe[j]))
                known = i;
            else if (known < count)
                memcpy(shape + 4 * i, shape + 4 * known, 4);
            if (pass >= count && known >= count) break;
        }
    }
}

static scales scales_of(const sbrdf_map *m, int lobe, double least_height)
{
    return (scales){m->most[lobe], m->shape_most[lobe], least_height};
}

static void code_level(const sbrdf_field *f, int level, double least_height, const lafortune_pairs *p, sbrdf_map *m)
{
    long count = (long)f->width * f->height;
#pragma omp parallel for schedule(dynamic, 64)
    for (long i = 0; i < count; i++) {
        const sbrdf_texel *t = &f->texel[i];
        for (int j = 0; j < m->lobes; j++) {
            scales s = scales_of(m, j, least_height);
            lobe_codes codes = code_lobe(&t->brdf.lobe[j], &s, p);
            put_lobe(m, level, j, (size_t)i, &codes);
        }
        put_rest(m, level, (size_t)i, t);
    }
    fill_black(m, level, f);
}

/* ---- errors ------------------------------------------------------------------------------------------ */

/* A texel as its codes would give it back. */
static void coded_texel(const sbrdf_texel *t, const sbrdf_map *m, double least_height, const lafortune_pairs *p,
                        sbrdf_texel *out)
{
    *out = *t;
    for (int c = 0; c < 3; c++)
        out->brdf.kd[c] = sbrdf_albedo_value(sbrdf_albedo_code(t->brdf.kd[c], m->albedo_most), m->albedo_most);
    for (int j = 0; j < m->lobes; j++) {
        scales s = scales_of(m, j, least_height);
        lobe_codes codes = code_lobe(&t->brdf.lobe[j], &s, p);
        decode_lobe(&codes, &s, &out->brdf.lobe[j]);
    }
}

/* Squared relative error of one coded texel; -1 for black ones. */
static double texel_error(const sbrdf_texel *wanted, const sbrdf_texel *coded, const lafortune_pairs *p)
{
    double own = 0, off = 0;
    for (int k = 0; k < p->samples.count; k++) {
        double a[3], b[3], w = p->samples.weight[k];
        sbrdf_texel_eval(wanted, p->direction[k], p->direction[k] + 3, a);
        sbrdf_texel_eval(coded, p->direction[k], p->direction[k] + 3, b);
        for (int c = 0; c < 3; c++) {
            own += w * w * a[c] * a[c];
            off += w * w * (a[c] - b[c]) * (a[c] - b[c]);
        }
    }
    return own > 0 ? off / own : -1;
}

/* Root of the mean of texel_error over at most so many texels of a level, evenly spread. level -1: by the codes that
   least_height would give, else by the map's own. */
static double field_error(const sbrdf_field *f, int level, const sbrdf_map *m, double least_height,
                          const lafortune_pairs *p, int most)
{
    long texels = (long)f->width * f->height, step = texels / most + 1, count = (texels + step - 1) / step;
    double *error = need_memory((size_t)count, sizeof *error), sum = 0, seen = 0;
#pragma omp parallel for schedule(dynamic, 16)
    for (long k = 0; k < count; k++) {
        sbrdf_texel coded;
        long i = k * step;
        if (level >= 0)
            sbrdf_map_texel(m, level, (int)(i % f->width), (int)(i / f->width), &coded);
        else
            coded_texel(&f->texel[i], m, least_height, p, &coded);
        error[k] = texel_error(&f->texel[i], &coded, p);
    }
    for (long k = 0; k < count; k++) { /* in order: the same for any number of threads */
        if (error[k] < 0) continue;
        sum += error[k];
        seen++;
    }
    free(error);
    return seen > 0 ? sqrt(sum / seen) : 0;
}

double sbrdf_map_error(const sbrdf_map *m, const sbrdf_field *level, int index)
{
    lafortune_pairs p = lafortune_pairs_make(LAFORTUNE_COARSE, sbrdf_field_is_anisotropic(level));
    double error = field_error(level, index, m, 0, &p, 2048);
    lafortune_pairs_free(&p);
    return error;
}

void sbrdf_quantise(const sbrdf_field *level, int count, const char *name, sbrdf_map *out, sbrdf_quantised *report)
{
    lafortune_pairs p = lafortune_pairs_make(LAFORTUNE_COARSE, sbrdf_field_is_anisotropic(level));
    double least = HUGE_VAL;
    int best = 0;
    sbrdf_map_make(out, level->width, level->height, level->lobes, level->has_direction, count);
    for (size_t i = 0; name[i] && i + 1 < sizeof out->name; i++) out->name[i] = name[i];
    for (int k = 0; k < HEIGHTS; k++) {
        find_scales(level, count, heights[k], out);
        double error = field_error(level, -1, out, heights[k], &p, 1024);
        if (!k) report->error_plain = error;
        if (!(error < least)) continue;
        least = error;
        best = k;
    }
    find_scales(level, count, heights[best], out);
    for (int i = 0; i < count; i++) code_level(&level[i], i, heights[best], &p, out);
    report->error_chosen = least;
    lafortune_pairs_free(&p);
}
