/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "sbrdf_field.h"
#include "sbrdf_mix.h"

enum { MOST_SIDE = 32 }; /* of what a texel covers, this many rows and columns are looked at, evenly spread */

static sbrdf_field smaller(const sbrdf_field *f, int index)
{
    int width = f->width >> index, height = f->height >> index;
    return sbrdf_field_make(width ? width : 1, height ? height : 1, f->lobes, f->has_direction);
}

/* The texels of a finer field that the texel (x, y) of a level covers. Returns how many. */
static int covered(const sbrdf_field *finer, const sbrdf_field *level, int x, int y, sbrdf_part *parts)
{
    int wide = finer->width / level->width, high = finer->height / level->height, count = 0;
    int step_x = wide > MOST_SIDE ? wide / MOST_SIDE : 1, step_y = high > MOST_SIDE ? high / MOST_SIDE : 1;
    for (int j = step_y / 2; j < high; j += step_y)
        for (int i = step_x / 2; i < wide; i += step_x) {
            size_t at = (size_t)(y * high + j) * (size_t)finer->width + (size_t)(x * wide + i);
            parts[count++].texel = &finer->texel[at];
        }
    for (int i = 0; i < count; i++) parts[i].weight = 1.0 / count;
    return count;
}

static int all_same(const sbrdf_part *parts, int count)
{
    for (int i = 1; i < count; i++)
        if (memcmp(parts[0].texel, parts[i].texel, sizeof *parts[0].texel)) return 0;
    return 1;
}

static void fit_level(const sbrdf_field *level, int index, int anisotropic, progress *meter)
{
    const sbrdf_field *f = &level[index];
#pragma omp parallel
    {
        sbrdf_mixer *mixer = sbrdf_mixer_make(f->lobes, anisotropic);
        sbrdf_part *parts = need_memory((size_t)MOST_SIDE * MOST_SIDE * 4, sizeof *parts), hints[4];
#pragma omp for schedule(dynamic, 4)
        for (long i = 0; i < (long)f->width * f->height; i++) {
            int x = (int)(i % f->width), y = (int)(i / f->width), hint_count, count;
            hint_count = covered(&level[index - 1], f, x, y, hints);
            if (all_same(hints, hint_count)) {
                f->texel[i] = *hints[0].texel;
            } else {
                count = covered(level, f, x, y, parts);
                sbrdf_mix(mixer, parts, count, hints, hint_count, &f->texel[i]);
            }
            progress_add(meter, 1);
        }
        free(parts);
        sbrdf_mixer_free(mixer);
    }
}

void sbrdf_field_levels(const sbrdf_field *f, sbrdf_field *level, int count, progress *p)
{
    int anisotropic = sbrdf_field_is_anisotropic(f);
    double total = 0;
    level[0] = *f;
    for (int i = 1; i < count; i++) {
        level[i] = smaller(f, i);
        total += (double)level[i].width * level[i].height;
    }
    progress_begin(p, "texels of smaller levels", total);
    for (int i = 1; i < count; i++) fit_level(level, i, anisotropic, p);
    progress_end(p);
}

void sbrdf_field_average(const sbrdf_field *f, sbrdf_field *level, int count)
{
    level[0] = *f;
    for (int k = 1; k < count; k++) {
        level[k] = smaller(f, k);
        for (int i = 0; i < level[k].width * level[k].height; i++) {
            sbrdf_part parts[4];
            int n = covered(&level[k - 1], &level[k], i % level[k].width, i / level[k].width, parts);
            sbrdf_mean_parameters(parts, n, &level[k].texel[i]);
        }
    }
}
