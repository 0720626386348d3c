/* SPDX-License-Identifier: MIT */
#include "palette_case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 256, W = 24, H = 21, ACROSS = 16, DOWN = 8 };

const double palette_case_albedo[3] = {(179 / 255.0) * (179 / 255.0), (128 / 255.0) * (128 / 255.0),
                                       (51 / 255.0) * (51 / 255.0)};

/* A highlight of its own width and colour over a ground of its own; towards grazing lights it grows. Codes of 40 and more
   keep y above 0 whatever the phi_d term does. */
static void fill(table_asset *t, int index)
{
    const double width = 0.12 + 0.3 * (index % 7) / 6, hue = 0.7 * index;
    t->rgba = need_memory(W * H, 4);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            uint8_t *to = t->rgba + 4 * (y * W + x);
            const double u = (double)x / (W - 1), v = (double)y / (H - 1);
            const double peak = (90 + 40 * v) * exp(-pow(u / width, 2));
            for (int c = 0; c < 3; c++) to[c] = (uint8_t)(70 + 30 * sin(hue + c) + 10 * v + peak);
            to[3] = (uint8_t)(128 + 60 * sin(3 * u + v + hue));
        }
}

void palette_case_make(palette *out, int blend)
{
    const table_asset common = {.width = W,
                                .height = H,
                                .layers = 1,
                                .layout = TABLE_ONE_LAYER,
                                .e = 0.75,
                                .ymax = 1.5,
                                .w = {0.5, 0.375, 0.25},
                                .p = 4,
                                .eps = 1 / 256.0,
                                .rows = 0.25};
    *out = (palette){.count = COUNT, .width = ACROSS, .height = DOWN, .levels = 1, .blend = blend};
    out->table = need_memory(COUNT, sizeof *out->table);
    out->code[0] = need_memory(ACROSS, DOWN);
    for (int i = 0; i < COUNT; i++) {
        out->table[i] = common;
        memcpy(out->table[i].albedo, palette_case_albedo, sizeof palette_case_albedo);
        fill(&out->table[i], i);
    }
    /* 37 and 101 have no divisor in common with 256: codes near and far, in every row of tiles */
    for (int i = 0; i < ACROSS * DOWN; i++) out->code[0][i] = (uint8_t)(37 * i + 101);
    snprintf(out->name, sizeof out->name, "made up");
}
