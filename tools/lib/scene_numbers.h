/* SPDX-License-Identifier: MIT */
/* A scene in the runtime's numbers, for its backends. */
#ifndef SCENE_NUMBERS_H
#define SCENE_NUMBERS_H

#include "scene.h"

typedef struct scene_numbers { /* points into itself: leave it where it is */
    scene scaled;              /* to about one unit, where q16 is exact enough: the picture is the same */
    mesh shape;
    float (*position)[3];
    nacre_view view;
    nacre_light *lights; /* the scene's, then those of its set */
} scene_numbers;

void scene_numbers_open(scene_numbers *out, const scene *s);
void scene_numbers_close(scene_numbers *n);

#endif
