/* SPDX-License-Identifier: MIT */
#include "baselines.h"

#include <stdio.h>
#include <string.h>

#include "ggx_fit.h"
#include "lafortune_display.h"
#include "sphere_bake.h"

/* A MatCap that follows a light: one sphere image in paper mode, where light and cosine are in the picture, and normals
   turned by k times the angle between the picture's light and the frame's. k = 1 turns the picture with the light,
   1/2 keeps its highlight in place; the light's angle in the picture and k are the best of these. */
static brdf *best_matcap(const compare_truth *truth)
{
    static const double polar_deg[] = {30, 45, 60}, k[] = {0.5, 0.75, 1};
    brdf *best = NULL;
    double most = -1;
    for (int i = 0; i < 3; i++) {
        sphere_options o = {.polar = {polar_deg[i]}, .polar_count = 1, .size = 256, .mode = SPHERE_PAPER, .no_mips = 1};
        sphere_asset image;
        if (sphere_bake(&image, truth->b, &o, NULL)) continue;
        for (int j = 0; j < 3; j++) {
            brdf *b = sphere_brdf(&image, &(sphere_decode_options){.k = k[j]});
            metric_frames frames;
            metric_result r;
            metric_draw(&frames, b, truth->exposure, truth->fov_deg);
            metric_score(&r, &truth->frames, &frames, METRIC_FULL);
            metric_frames_free(&frames);
            brdf *worse = r.pooled_psnr_db > most ? best : b;
            if (worse == best) {
                best = b;
                most = r.pooled_psnr_db;
                snprintf(b->description, sizeof b->description, "picture lit at %g degrees, normals turned by %g",
                         polar_deg[i], k[j]);
            }
            brdf_close(worse);
        }
        sphere_free(&image);
    }
    return best;
}

void baseline_make(compare_asset *out, baseline which, const compare_truth *truth)
{
    static const char *const lafortune[] = {"Lafortune, 1 lobe", "Lafortune, 2 lobes", "Lafortune, 3 lobes"};
    int lobes = (int)which - BASELINE_LAFORTUNE_1 + 1;
    char name[sizeof out->description] = "";
    if (which == BASELINE_GGX) {
        brdf *b = ggx_fit(truth->b, truth->exposure);
        snprintf(name, sizeof name, "%s", b->name);
        compare_asset_of_brdf(out, b, "GGX + Lambert");
    } else if (which == BASELINE_MATCAP) {
        compare_asset_of_brdf(out, best_matcap(truth), "one MatCap, turned");
    } else {
        brdf *b = lafortune_display_fit(truth->b, truth->exposure, lobes, name, sizeof name);
        compare_asset_of_brdf(out, b, lafortune[lobes - 1]);
    }
    if (*name) memcpy(out->description, name, sizeof name); /* opens it again */
}
