/* SPDX-License-Identifier: MIT */
/* The example's scene: data made by make_scene.c, and the view. */
#ifndef SCENE_EXAMPLE_H
#define SCENE_EXAMPLE_H

#include "nacre.h"

enum { EXAMPLE_WIDTH = 320, EXAMPLE_HEIGHT = 240, EXAMPLE_LIT = 64, EXAMPLE_LIGHTS = 3 };

extern const unsigned char example_table[];
extern const unsigned example_table_size;
extern const nacre_mesh example_mesh;
extern const uint16_t example_lit[EXAMPLE_LIT * EXAMPLE_LIT]; /* RGB565 */

/* Orthographic, the teapot turned by 25 and 20 degrees; the first lights of three. */
static inline void example_view(nacre_view *view, nacre_light lights[EXAMPLE_LIGHTS], int light_count)
{
    static const nacre_q16 object[16] = {59396,  -9486,  26028, 0, 0, 61584, 22415,   0,
                                         -27697, -20315, 55818, 0, 0, 0,     -131072, 65536};
    static const nacre_q16 clip[16] = {49152, 0, 0, 0, 0, 65536, 0, 0, 0, 0, -32768, 0, 0, 0, -65536, 65536};
    static const nacre_light light[EXAMPLE_LIGHTS] = {
        {0, 0, {7200, 6040, 13420}, {0, 0, 0}, {144179, 144179, 144179}},
        {0, 0, {-14467, -5266, 5604}, {0, 0, 0}, {58982, 72090, 91750}},
        {0, 0, {7698, -13333, -5604}, {0, 0, 0}, {98304, 78643, 58982}},
    };
    nacre_view v = {0};
    int i;

    for (i = 0; i < 16; i++) {
        v.object_to_view.m[i] = object[i];
        v.view_to_clip.m[i] = clip[i];
    }
    for (i = 0; i < light_count; i++) lights[i] = light[i];
    v.lights = lights;
    v.light_count = (uint8_t)light_count;
    *view = v;
}

#endif
