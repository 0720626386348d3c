/* SPDX-License-Identifier: MIT */
#include "sbrdf_paint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lafortune_fit.h"
#include "sbrdf_mix.h"

typedef struct sbrdf_painter {
    painting p;
    sbrdf_texel fitted[PAINTING_MATERIALS];
} sbrdf_painter;

/* ---- materials --------------------------------------------------------------------------------------- */

static void take_fit(const lafortune_fit *fit, int lobes, sbrdf_texel *out)
{
    memset(out, 0, sizeof *out);
    out->alpha = out->direction[0] = 1;
    out->brdf.lobes = lobes;
    memcpy(out->brdf.kd, fit->kd, sizeof out->brdf.kd);
    for (int j = 0; j < lobes; j++) {
        const lafortune_lobe *from = &fit->lobe[j];
        out->brdf.lobe[j] = (lafortune_shared_lobe){
            {from->cx[0], from->cy[0], from->cz[0]}, from->n[0], {from->ks[0], from->ks[1], from->ks[2]}};
    }
    sbrdf_sort_lobes(out);
}

static int fit_material(const painting *p, int index, sbrdf_texel *out, failure *f)
{
    brdf *b;
    lafortune_fit fit;
    int code = brdf_open(&b, p->material[index].brdf, f);
    if (code) return code;
    const lafortune_fit_options options = {.lobes = p->lobes,
                                           .display = 1,
                                           .n_min = SBRDF_EXPONENT_LEAST,
                                           .n_max = SBRDF_EXPONENT_MOST,
                                           .grazing_max = SBRDF_GRAZING_MAX};
    code = lafortune_fit_brdf(&fit, b, &options, f);
    brdf_close(b);
    if (!code) take_fit(&fit, p->lobes, out);
    return code;
}

/* ---- painting ---------------------------------------------------------------------------------------- */

static double srgb_of(const image_u8 *picture, long i, int channel)
{
    return picture->texel ? srgb_decode(picture->texel[3 * i + channel] / 255.0) : 1;
}

/* The coat's material at a texel. */
static void coated(const sbrdf_painter *t, const painting_coat *c, long i, sbrdf_texel *out)
{
    *out = t->fitted[c->material];
    memcpy(out->direction, c->turn, sizeof out->direction);
    for (int k = 0; k < 3; k++) {
        out->brdf.kd[k] *= srgb_of(&c->tint, i, k);
        for (int j = 0; j < out->brdf.lobes; j++) out->brdf.lobe[j].ks[k] *= srgb_of(&c->shine, i, k);
    }
    if (!c->direction.texel) return;
    double x = sbrdf_shape_value(c->direction.texel[3 * i], 1), y = sbrdf_shape_value(c->direction.texel[3 * i + 1], 1);
    double length = hypot(x, y);
    if (!(length > 0)) return;
    out->direction[0] = (x * c->turn[0] - y * c->turn[1]) / length;
    out->direction[1] = (y * c->turn[0] + x * c->turn[1]) / length;
}

static void paint_texel(const sbrdf_painter *t, sbrdf_mixer *mixer, long i, sbrdf_texel *out)
{
    sbrdf_part parts[PAINTING_COATS];
    sbrdf_texel texel[PAINTING_COATS];
    int coat[PAINTING_COATS];
    double weight[PAINTING_COATS];
    int count = painting_visible(&t->p, i, coat, weight);
    for (int k = 0; k < count; k++) {
        coated(t, &t->p.coat[coat[k]], i, &texel[k]);
        parts[k] = (sbrdf_part){&texel[k], weight[k]};
    }
    if (count == 1)
        *out = texel[0];
    else
        sbrdf_mix(mixer, parts, count, parts, count, out);
    if (t->p.opacity.texel) out->alpha = t->p.opacity.texel[i] / 255.0;
}

static int has_direction(const painting *p)
{
    for (int k = 0; k < p->coat_count; k++)
        if (p->coat[k].direction.texel || p->coat[k].turn[1] != 0) return 1;
    return 0;
}

static void paint_field(const sbrdf_painter *t, sbrdf_field *out, progress *meter)
{
    const painting *p = &t->p;
    int anisotropic = 0;
    *out = sbrdf_field_make(p->width, p->height, p->lobes, has_direction(p));
    for (int k = 0; k < p->material_count; k++)
        for (int j = 0; j < p->lobes; j++)
            anisotropic |= t->fitted[k].brdf.lobe[j].c[0] != t->fitted[k].brdf.lobe[j].c[1];
    progress_begin(meter, "rows", p->height);
#pragma omp parallel
    {
        sbrdf_mixer *mixer = sbrdf_mixer_make(p->lobes, anisotropic);
#pragma omp for schedule(dynamic, 1)
        for (int y = 0; y < p->height; y++) {
            for (int x = 0; x < p->width; x++) {
                long i = (long)y * p->width + x;
                paint_texel(t, mixer, i, &out->texel[i]);
            }
            progress_add(meter, 1);
        }
        sbrdf_mixer_free(mixer);
    }
    progress_end(meter);
}

int sbrdf_paint_lobes(sbrdf_field *out, const char *path, int lobes, sbrdf_sources *sources, progress *meter,
                      failure *f)
{
    sbrdf_painter *t = need_memory(1, sizeof *t);
    int code = painting_open(&t->p, path, sources, f);
    if (lobes) t->p.lobes = lobes;
    if (!code && t->p.index.texel)
        code = fail(f, FAIL_UNSUPPORTED, "%s: index: found in a painting for Lafortune maps, expected fill and paint",
                    path);
    for (int i = 0; i < t->p.material_count && !code; i++) code = fit_material(&t->p, i, &t->fitted[i], f);
    if (!code) paint_field(t, out, meter);
    painting_close(&t->p);
    free(t);
    return code;
}

int sbrdf_paint(sbrdf_field *out, const char *path, sbrdf_sources *sources, progress *meter, failure *f)
{
    return sbrdf_paint_lobes(out, path, 0, sources, meter, f);
}
