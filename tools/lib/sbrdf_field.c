/* SPDX-License-Identifier: MIT */
#include "sbrdf_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nacre_asset.h"
#include "sbrdf_mix.h"

static const double pi = 3.14159265358979323846;

sbrdf_field sbrdf_field_make(int width, int height, int lobes, int has_direction)
{
    sbrdf_field f = {width, height, lobes, has_direction, NULL};
    size_t count = (size_t)width * (size_t)height;
    f.texel = need_memory(count, sizeof *f.texel);
    memset(f.texel, 0, count * sizeof *f.texel);
    for (size_t i = 0; i < count; i++) {
        sbrdf_texel *t = &f.texel[i];
        t->alpha = t->direction[0] = 1;
        t->brdf.lobes = lobes;
        for (int c = 0; c < 3; c++) t->brdf.kd[c] = 1;
        for (int j = 0; j < lobes; j++) t->brdf.lobe[j] = (lafortune_shared_lobe){{-1, -1, 1}, 1, {0, 0, 0}};
    }
    return f;
}

void sbrdf_field_free(sbrdf_field *f)
{
    free(f->texel);
    *f = (sbrdf_field){0};
}

int sbrdf_field_is_anisotropic(const sbrdf_field *f)
{
    for (size_t i = 0; i < (size_t)f->width * (size_t)f->height; i++)
        for (int j = 0; j < f->lobes; j++)
            if (f->texel[i].brdf.lobe[j].c[0] != f->texel[i].brdf.lobe[j].c[1]) return 1;
    return 0;
}

/* ---- settling ---------------------------------------------------------------------------------------- */

static int is_finite(const sbrdf_texel *t)
{
    double sum = t->alpha + t->direction[0] + t->direction[1];
    for (int c = 0; c < 3; c++) sum += t->brdf.kd[c];
    for (int j = 0; j < t->brdf.lobes; j++) {
        const lafortune_shared_lobe *lobe = &t->brdf.lobe[j];
        for (int c = 0; c < 3; c++) sum += lobe->c[c] + lobe->ks[c];
        sum += lobe->n;
    }
    return isfinite(sum);
}

/* Returns 1 if x had to be moved. */
static int clamp(double *x, double low, double high)
{
    double y = fmin(fmax(*x, low), high);
    int moved = y != *x;
    *x = y;
    return moved;
}

static void settle_lobe(lafortune_shared_lobe *lobe, double limit, sbrdf_clamped *clamped)
{
    int moved = 0;
    clamped->exponents += clamp(&lobe->n, 0, NACRE_EXPONENT_MOST);
    if (!lafortune_normalise(lobe)) { /* no pair of directions lights it */
        *lobe = (lafortune_shared_lobe){{-1, -1, 1}, 1, {0, 0, 0}};
        return;
    }
    for (int c = 0; c < 3; c++) moved |= clamp(&lobe->c[c], -limit, limit);
    clamped->shapes += moved;
}

static void settle_texel(sbrdf_texel *t, double limit, sbrdf_clamped *clamped)
{
    int moved = clamp(&t->alpha, 0, 1);
    double length = hypot(t->direction[0], t->direction[1]);
    for (int k = 0; k < 2; k++) t->direction[k] = length > 0 ? t->direction[k] / length : k == 0;
    for (int c = 0; c < 3; c++) moved |= clamp(&t->brdf.kd[c], 0, 32767);
    for (int j = 0; j < t->brdf.lobes; j++) {
        settle_lobe(&t->brdf.lobe[j], limit, clamped);
        for (int c = 0; c < 3; c++) moved |= clamp(&t->brdf.lobe[j].ks[c], 0, 32767 / pi);
    }
    clamped->albedos += moved;
    sbrdf_sort_lobes(t);
}

int sbrdf_field_settle(sbrdf_field *f, double limit, sbrdf_clamped *clamped, const char *name, failure *fail_)
{
    memset(clamped, 0, sizeof *clamped);
    for (size_t i = 0; i < (size_t)f->width * (size_t)f->height; i++) {
        if (!is_finite(&f->texel[i]))
            return fail(fail_, FAIL_INVALID, "%s: texel (%d, %d): found a value that is not finite, expected numbers",
                        name, (int)(i % (size_t)f->width), (int)(i / (size_t)f->width));
        settle_texel(&f->texel[i], limit, clamped);
    }
    return FAIL_NONE;
}
