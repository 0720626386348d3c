/* SPDX-License-Identifier: MIT */
/* The lights of a shot: given one by one, in files, or as an environment. */
#ifndef SHOT_LIGHTS_H
#define SHOT_LIGHTS_H

#include "env_map.h"
#include "options.h"
#include "scene.h"

typedef struct shot_lights {
    option_texts light, point, files, env; /* as given */
    const char *count;                     /* of --env: a number or "all" */
    double turn_deg;
    int quiet;
    light_set set; /* more directional lights than fit into a scene, lights of files and of the environment */
} shot_lights;

#define SHOT_LIGHT_OPTIONS(l)                                                                                          \
    {"--light",                                                                                                        \
     OPTION_TEXTS,                                                                                                     \
     &(l).light,                                                                                                       \
     0,                                                                                                                \
     0,                                                                                                                \
     "POLAR,AZIMUTH[,R,G,B]",                                                                                          \
     "directional light in view space, degrees: polar from +z towards the eye, azimuth from +x to +y; "                \
     "irradiance on a surface that faces it (1,1,1); may be repeated"},                                                \
        {"--point",                                                                                                    \
         OPTION_TEXTS,                                                                                                 \
         &(l).point,                                                                                                   \
         0,                                                                                                            \
         0,                                                                                                            \
         "X,Y,Z[,R,G,B]",                                                                                              \
         "point light in view space; radiant intensity (1,1,1); may be repeated"},                                     \
        {"--lights-file",                                                                                              \
         OPTION_TEXTS,                                                                                                 \
         &(l).files,                                                                                                   \
         0,                                                                                                            \
         0,                                                                                                            \
         "FILE",                                                                                                       \
         "directional lights, a line each: polar,azimuth,r,g,b (nacre bake lights writes such files)"},                \
        {"--env",                                                                                                      \
         OPTION_TEXTS,                                                                                                 \
         &(l).env,                                                                                                     \
         0,                                                                                                            \
         0,                                                                                                            \
         "MAP",                                                                                                        \
         "environment: a latitude-longitude .hdr or .pfm as directional lights; its middle is straight ahead (-z), "   \
         "its side edges are on the eye's side (+z)"},                                                                 \
        {"--count",                                                                                                    \
         OPTION_TEXT,                                                                                                  \
         &(l).count,                                                                                                   \
         0,                                                                                                            \
         0,                                                                                                            \
         "N",                                                                                                          \
         "so many lights for --env (64); with --backend double also all: one per texel, the exact integral"},          \
    {                                                                                                                  \
        "--turn-lights", OPTION_REAL, &(l).turn_deg, -3600, 3600, "DEG",                                               \
            "turn all directional lights about +y: from +z (the eye) towards +x (0)"                                   \
    }

/* What needs no file: check and add --light and --point. exact: the reference renderer draws. */
int shot_lights_parse(shot_lights *l, scene *s, int exact, failure *f);
/* FAIL_USAGE if one of the files is the output. */
int shot_lights_apart(const shot_lights *l, const char *output, failure *f);
/* Read the files; s then has every light, s->distant pointing into l. */
int shot_lights_open(shot_lights *l, scene *s, failure *f);
/* Turn all directional lights of s, which l belongs to, about +y. */
void shot_lights_turn(shot_lights *l, scene *s, double degrees);
void shot_lights_close(shot_lights *l);

#endif
