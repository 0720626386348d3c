/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "table_parts.h"

#define STEP     4   /* every such sample */
#define MOST     0.2 /* dB that a table may lose to the curve without its toe, */
#define MOST_DIM 1.0 /* and 2 stops down */

/* Two frames of 8-bit codes differ by this anyway (mean square). */
static const double rounding = 2.0 / 12 / (255.0 * 255);

/* sRGB, clamped to 0..1, of radiance^(1/2.4); toe: 0 leaves the linear toe out, as the cheapest shaders do. */
static double shown(double radiance24, int toe)
{
    if (toe && radiance24 <= TABLE_TOE_END) return 12.92 * pow(radiance24, 2.4);
    return fmin(fmax(1.055 * radiance24 - 0.055, 0), 1);
}

static double decibels_lost(const table_asset *t, const table_samples *s, double light24)
{
    double square[2] = {0, 0};
    size_t count = 0;
    for (size_t i = 0; i < s->count; i += STEP) {
        const table_sample *at = &s->sample[i];
        if (at->frame < 0) continue;
        const table_point point = {.t = at->t, .s = at->s, .a = at->basis[1]};
        double y[3];
        table_y(t, &point, y);
        for (int k = 0; k < 3; k++) {
            const double scale = light24 * at->factor24, truth = shown(scale * pow(at->root[k], t->p / 2.4), 1);
            const double drawn = scale * pow(t->ymax * y[k], t->p / 2.4);
            for (int toe = 0; toe < 2; toe++) square[toe] += pow(shown(drawn, toe) - truth, 2);
            count++;
        }
    }
    const double least = rounding * (double)count;
    return 10 * log10((square[0] + least) / (square[1] + least));
}

int table_wants_toe(const table_asset *t, const table_samples *s)
{
    return decibels_lost(t, s, 1) > MOST || decibels_lost(t, s, TABLE_DIM24) > MOST_DIM;
}
