/* SPDX-License-Identifier: MIT */
#include "shot_lights.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light_bake.h"

static int check_power(const char *name, const char *text, const double power[3], failure *f)
{
    int i;

    for (i = 0; i < 3; i++)
        if (power[i] < 0 || power[i] > LIGHT_MAX_IRRADIANCE)
            return fail(f, FAIL_USAGE, "%s %s: r,g,b of %g, expected 0..%d", name, text, power[i],
                        LIGHT_MAX_IRRADIANCE);
    return FAIL_NONE;
}

/* Directional lights beyond what a scene holds go to the set. */
static int parse_light(shot_lights *l, scene *s, int to_set, const char *text, failure *f)
{
    double v[5] = {0, 0, 1, 1, 1};
    int count, code = parse_reals(text, "--light", v, 2, 5, &count, f);

    if (code) return code;
    if (count != 2 && count != 5)
        return fail(f, FAIL_USAGE, "--light %s: %d numbers, expected polar,azimuth or polar,azimuth,r,g,b", text,
                    count);
    if (v[0] < 0 || v[0] > 180) return fail(f, FAIL_USAGE, "--light %s: polar angle %g, expected 0..180", text, v[0]);
    if (fabs(v[1]) > 3600) return fail(f, FAIL_USAGE, "--light %s: azimuth %g, expected -3600..3600", text, v[1]);
    if (to_set) {
        distant_light light = {.irradiance = {v[2], v[3], v[4]}};
        light_direction(v[0], v[1], light.direction);
        light_set_add(&l->set, &light);
    } else {
        scene_add_light(s, v[0], v[1], v + 2);
    }
    return check_power("--light", text, v + 2, f);
}

static int parse_point(scene *s, const char *text, failure *f)
{
    double v[6] = {0, 0, 0, 1, 1, 1};
    int count, code = parse_reals(text, "--point", v, 3, 6, &count, f);

    if (code) return code;
    if (count != 3 && count != 6)
        return fail(f, FAIL_USAGE, "--point %s: %d numbers, expected x,y,z or x,y,z,r,g,b", text, count);
    scene_add_point(s, v, v + 3);
    return check_power("--point", text, v + 3, f);
}

/* 0: every texel. */
static int parse_count(const shot_lights *l, int exact, int *count, failure *f)
{
    char *end;
    long n;

    *count = 64;
    if (!l->count) return FAIL_NONE;
    if (!l->env.count) return fail(f, FAIL_USAGE, "--count %s: expected --env MAP with it", l->count);
    if (!strcmp(l->count, "all")) {
        *count = 0;
        return exact ? FAIL_NONE : fail(f, FAIL_USAGE, "--count all: expected --backend double with it");
    }
    n = strtol(l->count, &end, 10);
    if (end == l->count || *end || n < 1 || n > LIGHT_SET_MAX)
        return fail(f, FAIL_USAGE, "--count %s: expected a whole number 1..%d, or all", l->count, LIGHT_SET_MAX);
    *count = (int)n;
    return FAIL_NONE;
}

int shot_lights_parse(shot_lights *l, scene *s, int exact, failure *f)
{
    const int many = l->light.count + l->point.count > SCENE_MAX_LIGHTS;
    const int to_set = many || l->files.count || l->env.count || s->lit_size;
    int i, count, code = parse_count(l, exact, &count, f);

    if (code) return code;
    if (l->env.count > 1) return fail(f, FAIL_USAGE, "--env: given %d times, expected once", l->env.count);
    if (l->point.count > SCENE_MAX_LIGHTS)
        return fail(f, FAIL_USAGE, "--point: %d lights, expected at most %d", l->point.count, SCENE_MAX_LIGHTS);
    if (!exact && l->point.count && to_set)
        return fail(f, FAIL_USAGE,
                    "--point with --env, --lights-file, --lit or more than %d lights: a lit sphere takes directional "
                    "lights only, expected --backend double",
                    SCENE_MAX_LIGHTS);
    for (i = 0; i < l->light.count && !code; i++) code = parse_light(l, s, to_set, l->light.item[i], f);
    for (i = 0; i < l->point.count && !code; i++) code = parse_point(s, l->point.item[i], f);
    return code;
}

int shot_lights_apart(const shot_lights *l, const char *output, failure *f)
{
    int i, code = FAIL_NONE;

    for (i = 0; i < l->files.count && !code; i++) code = output_apart(output, l->files.item[i], f);
    for (i = 0; i < l->env.count && !code; i++) code = output_apart(output, l->env.item[i], f);
    return code;
}

static int add_all(light_set *to, const light_set *from, const char *path, failure *f)
{
    int i;

    if (to->count + from->count > LIGHT_SET_MAX)
        return fail(f, FAIL_USAGE, "%s: %d lights in all, expected at most %d", path, to->count + from->count,
                    LIGHT_SET_MAX);
    for (i = 0; i < from->count; i++) light_set_add(to, &from->light[i]);
    return FAIL_NONE;
}

/* Every texel that is not black. */
static int add_texels(light_set *to, const env_map *map, const char *path, failure *f)
{
    const int before = to->count;
    int i, j, c;

    for (j = 0; j < map->height; j++)
        for (i = 0; i < map->width; i++) {
            const float *texel = map->texel + 3 * ((size_t)j * (size_t)map->width + (size_t)i);
            distant_light light;
            if (!(texel[0] > 0 || texel[1] > 0 || texel[2] > 0)) continue;
            env_map_direction(map, i + 0.5, j + 0.5, light.direction);
            for (c = 0; c < 3; c++) light.irradiance[c] = texel[c] * env_map_solid_angle(map, j);
            light_set_add(to, &light);
        }
    if (to->count > before) return FAIL_NONE;
    return fail(f, FAIL_INVALID, "%s: all %dx%d texels are black, expected some light", path, map->width, map->height);
}

static int open_env(shot_lights *l, const char *path, failure *f)
{
    light_options o = {.count = l->count ? atoi(l->count) : 0};
    light_set set = {0};
    env_map map;
    int code = env_map_open(&map, path, f);

    if (code) return code;
    if (!l->quiet) env_map_warn(&map, path);
    if (l->count && !strcmp(l->count, "all")) {
        code = add_texels(&l->set, &map, path, f);
    } else {
        code = light_bake(&set, NULL, &map, path, &o, f);
        if (!code) code = add_all(&l->set, &set, path, f);
        light_set_free(&set);
    }
    env_map_free(&map);
    return code;
}

int shot_lights_open(shot_lights *l, scene *s, failure *f)
{
    int i, code = FAIL_NONE;

    for (i = 0; i < l->files.count && !code; i++) {
        light_set set;
        if ((code = light_set_read(&set, l->files.item[i], f))) return code;
        code = add_all(&l->set, &set, l->files.item[i], f);
        light_set_free(&set);
    }
    if (!code && l->env.count) code = open_env(l, l->env.item[0], f);
    s->distant = l->set.count ? &l->set : NULL;
    shot_lights_turn(l, s, l->turn_deg);
    return code;
}

void shot_lights_turn(shot_lights *l, scene *s, double degrees)
{
    int i;

    light_set_turn(&l->set, degrees);
    for (i = 0; i < s->light_count; i++)
        if (!s->light[i].point) env_turn(s->light[i].direction, degrees);
}

void shot_lights_close(shot_lights *l)
{
    light_set_free(&l->set);
}
