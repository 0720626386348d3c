/* SPDX-License-Identifier: MIT */
/* From a painting to a palette: tables baked to common numbers, and the map's levels. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mip.h"
#include "models.h"
#include "nacre_asset.h"
#include "palette.h"

static const double pi = 3.14159265358979323846;

/* ---- the map ------------------------------------------------------------------------------------------ */

static int check_coats(const painting *p, failure *f)
{
    if (p->opacity.texel)
        return fail(f, FAIL_UNSUPPORTED, "%s: opacity: a palette has none, expected fill and paint alone", p->path);
    if (p->index.texel && p->coat_count)
        return painting_fail(p, p->coat[0].line, f, "found fill or paint beside index, expected one of them");
    for (int k = 0; k < p->coat_count; k++) {
        const painting_coat *c = &p->coat[k];
        const char *word = c->tint.texel        ? "tint"
                           : c->shine.texel     ? "shine"
                           : c->direction.texel ? "direction"
                           : c->turn[1] != 0    ? "turn"
                                                : NULL;
        if (word)
            return fail(
                f, FAIL_UNSUPPORTED,
                "%s: line %d: %s=: the tables of a palette are whole and isotropic, expected a material of its own "
                "for each shade",
                p->path, c->line, word);
    }
    return FAIL_NONE;
}

/* The material of which most shows at a texel. */
static int material_at(const painting *p, long i)
{
    int coat[PAINTING_COATS];
    double weight[PAINTING_COATS], share[PAINTING_MATERIALS] = {0};
    const int count = painting_visible(p, i, coat, weight);
    int most = p->coat[coat[0]].material;
    for (int k = 0; k < count; k++) share[p->coat[coat[k]].material] += weight[k];
    for (int m = 0; m < p->material_count; m++)
        if (share[m] > share[most]) most = m;
    return most;
}

static int paint_codes(const painting *p, uint8_t *code, failure *f)
{
    const long count = (long)p->width * p->height;
    for (long i = 0; i < count; i++) {
        const int found = p->index.texel ? p->index.texel[i] : material_at(p, i);
        if (found >= p->material_count)
            return fail(f, FAIL_INVALID,
                        "%s: index: texel (%ld, %ld): found code %d, expected less than the %d materials", p->path,
                        i % p->width, i / p->width, found, p->material_count);
        code[i] = (uint8_t)found;
    }
    return FAIL_NONE;
}

/* ---- smaller levels ------------------------------------------------------------------------------------ */

/* What a table shows: pi E f_r cos under lights and eyes all around. */
enum { LIGHTS = 5, EYES = 4, TURNS = 4, SHOWN = 3 * LIGHTS * EYES * TURNS };
typedef struct look {
    float radiance[SHOWN];
} look;

static void direction(double polar, double azimuth, double out[3])
{
    out[0] = sin(polar) * cos(azimuth);
    out[1] = sin(polar) * sin(azimuth);
    out[2] = cos(polar);
}

static void look_at(const table_asset *t, look *out)
{
    float *to = out->radiance;
    for (int i = 0; i < LIGHTS; i++)
        for (int j = 0; j < EYES; j++)
            for (int k = 0; k < TURNS; k++, to += 3) {
                double light[3], eye[3], radiance[3];
                direction((i + 0.5) / LIGHTS * 80 / 180 * pi, (k + 0.5) / TURNS * pi, light);
                direction((j + 0.5) / EYES * 75 / 180 * pi, 0, eye);
                table_decode(t, light, eye, radiance);
                for (int c = 0; c < 3; c++) to[c] = (float)radiance[c];
            }
}

static double shown(double radiance)
{
    return srgb_encode(fmin(fmax(radiance, 0), 1));
}

/* The table that comes nearest to a mean. */
static int nearest_look(const look *looks, int count, const double *mean)
{
    double best = HUGE_VAL;
    int found = 0;
    for (int m = 0; m < count; m++) {
        double error = 0;
        for (int i = 0; i < SHOWN && error < best; i++) error += pow(shown(looks[m].radiance[i]) - shown(mean[i]), 2);
        if (error < best) {
            best = error;
            found = m;
        }
    }
    return found;
}

/* One texel of a smaller level, from the codes it covers. */
static int mean_code(const palette *p, const look *looks, int level, int x, int y)
{
    const int across = p->width >> level ? 1 << level : p->width, down = p->height >> level ? 1 << level : p->height;
    double share[NACRE_MAX_PALETTE] = {0}, mean[SHOWN] = {0};
    int last = 0;
    for (int j = 0; j < down; j++)
        for (int i = 0; i < across; i++) {
            last = p->code[0][(size_t)(y * down + j) * (size_t)p->width + (size_t)(x * across + i)];
            share[last] += 1.0 / (across * down);
        }
    if (share[last] > 1 - 1e-9) return last;
    for (int m = 0; m < p->count; m++)
        for (int i = 0; i < SHOWN && share[m] > 0; i++) mean[i] += share[m] * looks[m].radiance[i];
    return nearest_look(looks, p->count, mean);
}

static void make_levels(palette *p)
{
    look *looks = need_memory((size_t)p->count, sizeof *looks);
    for (int m = 0; m < p->count; m++) look_at(&p->table[m], &looks[m]);
    for (int level = 1; level < p->levels; level++) {
        const int width = p->width >> level ? p->width >> level : 1,
                  height = p->height >> level ? p->height >> level : 1;
        p->code[level] = need_memory((size_t)width, (size_t)height);
#pragma omp parallel for schedule(dynamic)
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) p->code[level][y * width + x] = (uint8_t)mean_code(p, looks, level, x, y);
    }
    free(looks);
}

/* ---- tables -------------------------------------------------------------------------------------------- */

/* Bake all materials with these numbers in common. */
static int bake_tables(palette *p, const painting *text, const palette_options *o, const table_shared *shared,
                       failure *f)
{
    const table_options options = {.width = o->width, .height = o->height, .power = 4, .shared = shared};
    failure *each = need_memory((size_t)p->count, sizeof *each);
    int code = FAIL_NONE;
    memset(each, 0, (size_t)p->count * sizeof *each);
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < p->count; i++) {
        brdf *b;
        table_asset t;
        if (brdf_open(&b, text->material[i].brdf, &each[i])) continue;
        if (!table_bake(&t, b, &options, &each[i])) {
            table_free(&p->table[i]);
            p->table[i] = t;
        }
        brdf_close(b);
        progress_add(o->progress, 1);
    }
    for (int i = 0; i < p->count && !code; i++)
        if (each[i].code) code = fail(f, each[i].code, "%s", each[i].text);
    free(each);
    return code;
}

/* E in the middle, by the logarithm, of what the materials ask for, each by its part of the map. */
static int common_exposure(const palette *p, const painting *text, const double *share, double *e, failure *f)
{
    double sum = 0, weight = 0;
    for (int i = 0; i < p->count; i++) {
        brdf *b;
        const int code = brdf_open(&b, text->material[i].brdf, f);
        if (code) return code;
        const double own = brdf_exposure(b);
        brdf_close(b);
        if (!isfinite(own)) continue; /* the bake will say where it is not */
        sum += (share[i] + 1e-3) * log(own);
        weight += share[i] + 1e-3;
    }
    *e = round(exp(weight > 0 ? sum / weight : 0) * 65536) / 65536;
    return FAIL_NONE;
}

/* Numbers that suit all tables, from those that each chose: the finest eps, the middle of the row curves, the highest root,
   and of the phi_d coefficients the mean direction and the widest range. */
static table_shared common_numbers(const palette *p, double e)
{
    table_shared s = {.e = e, .eps = 1, .has_rows = 1};
    double along[3] = {0}, range = 0, longest = 0;
    for (int i = 0; i < p->count; i++) {
        const table_asset *t = &p->table[i];
        s.eps = fmin(s.eps, t->eps);
        s.rows += t->rows / p->count;
        s.ymax = fmax(s.ymax, t->ymax);
        for (int k = 0; k < 3; k++) {
            along[k] += t->ymax * t->w[k];
            range = fmax(range, t->ymax * fabs(t->w[k]));
        }
    }
    for (int k = 0; k < 3; k++) longest = fmax(longest, fabs(along[k]));
    for (int k = 0; k < 3; k++)
        s.w[k] = longest > 0 ? round(along[k] / longest * fmin(range / s.ymax, 16) * 65536) / 65536 : 0;
    return s;
}

static int bake_all(palette *p, const painting *text, const palette_options *o, failure *f)
{
    double share[NACRE_MAX_PALETTE] = {0}, e = 1;
    const size_t texels = (size_t)p->width * (size_t)p->height;
    for (size_t i = 0; i < texels; i++) share[p->code[0][i]] += 1.0 / (double)texels;
    int code = common_exposure(p, text, share, &e, f);
    if (code) return code;
    progress_begin(o->progress, "tables", 2 * p->count);
    const table_shared first = {.e = e};
    code = bake_tables(p, text, o, &first, f);
    if (!code) {
        const table_shared numbers = common_numbers(p, e);
        code = bake_tables(p, text, o, &numbers, f);
    }
    progress_end(o->progress);
    for (int i = 0; i < p->count && !code; i++)
        for (int k = 0; k < 3; k++) p->white_sky[k] += share[i] * p->table[i].albedo[k];
    return code;
}

static int make(palette *out, const painting *text, const palette_options *o, failure *f)
{
    palette p = {.count = text->material_count, .width = text->width, .height = text->height, .blend = o->blend};
    int code = check_coats(text, f);
    if (code) return code;
    if (!p.count) return fail(f, FAIL_INVALID, "%s: found no material, expected 1..%d", text->path, NACRE_MAX_PALETTE);
    const int w = o->width ? o->width : 24, h = o->height ? o->height : 21;
    if (!palette_columns(p.count, w, h))
        return fail(f, FAIL_USAGE, "--size %dx%d: %d such tables need more than the 2048 texels a side that GPUs hold",
                    w, h, p.count);
    snprintf(p.name, sizeof p.name, "%s", text->path);
    p.levels = o->no_mips ? 1 : mip_count(p.width, p.height);
    p.code[0] = need_memory((size_t)p.width, (size_t)p.height);
    p.table = need_memory((size_t)p.count, sizeof *p.table);
    memset(p.table, 0, (size_t)p.count * sizeof *p.table);
    code = paint_codes(text, p.code[0], f);
    if (!code) code = bake_all(&p, text, o, f);
    if (code) {
        palette_free(&p);
        return code;
    }
    make_levels(&p);
    *out = p;
    return FAIL_NONE;
}

int palette_bake(palette *out, const char *path, const palette_options *options, sbrdf_sources *sources, failure *f)
{
    painting *text = need_memory(1, sizeof *text);
    int code = painting_open(text, path, sources, f);
    if (!code) code = make(out, text, options, f);
    painting_close(text);
    free(text);
    return code;
}
