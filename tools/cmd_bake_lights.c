/* SPDX-License-Identifier: MIT */
/* nacre bake lights: an environment map as directional lights. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake_common.h"
#include "env_map.h"
#include "light_bake.h"

/* In the order of light_method. */
static const char *const method_names[] = {"relaxed", "variance-cut", "median-cut"};
enum { METHOD_COUNT = sizeof method_names / sizeof *method_names };

static int parse_method(const char *text, light_method *method, failure *f)
{
    for (int i = 0; i < METHOD_COUNT; i++) {
        if (strcmp(text, method_names[i])) continue;
        *method = (light_method)i;
        return FAIL_NONE;
    }
    return fail(f, FAIL_USAGE, "--method %s: expected relaxed, variance-cut or median-cut", text);
}

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');

    return slash ? slash + 1 : path;
}

static void write_csv(const light_set *set, const char *input, const light_options *o, double turn, bytes *out)
{
    char made[400];
    const char *const comments[] = {
        made,
        "polar,azimuth,r,g,b. Degrees in view space: polar from +z towards the eye, azimuth from +x (right) to +y "
        "(up).",
        "The map's middle is straight ahead (-z), right of it +x, its side edges +z, its top +y.",
        "r,g,b: irradiance on a surface that faces the light. A white matt surface reflects irradiance / pi."};

    snprintf(made, sizeof made, "%.200s: %d lights (%s), radiance x %g, turned by %g degrees", file_name(input),
             set->count, method_names[o->method], o->scale, turn);
    for (char *c = made; *c; c++)
        if ((unsigned char)*c < ' ') *c = '?';
    light_set_text(set, comments, 4, out);
}

static int ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), tail = strlen(end);

    return length > tail && !strcmp(text + length - tail, end);
}

static json figures_of(const light_set *set, const light_figures *map, const char *path, const char *method)
{
    json j = {0};

    json_begin(&j, NULL, '{');
    json_text(&j, "file", path);
    json_text(&j, "method", method);
    json_int(&j, "lights", set->count);
    json_begin(&j, "irradiance_sum", '[');
    for (int c = 0; c < 3; c++) {
        double sum = 0;
        for (int i = 0; i < set->count; i++) sum += set->light[i].irradiance[c];
        json_real(&j, NULL, sum);
    }
    json_end(&j, ']');
    json_begin(&j, "radiance_integral", '[');
    for (int c = 0; c < 3; c++) json_real(&j, NULL, map->total[c]);
    json_end(&j, ']');
    json_real(&j, "largest_radiance", map->most);
    json_end(&j, '}');
    return j;
}

/* As bake_write_outputs, but a .c is a text made here and no array of bytes. */
static int write_outputs(const bake_common *c, const bytes *file, const char *input, json *figures, failure *f)
{
    int code = bake_write_side_outputs(c, &input, 1, figures, f);

    bytes_free(&figures->out);
    if (code) return code;
    code = output_write_raw(c->output, file, f);
    if (code) bake_discard_side_outputs(c);
    return code;
}

static int bake(const bake_common *c, const char *input, const light_options *o, double turn, failure *f)
{
    light_figures figures;
    light_set set;
    env_map map;
    bytes file = {0};
    int code = env_map_open(&map, input, f);

    if (code) return code;
    if (!c->quiet) env_map_warn(&map, input);
    code = light_bake(&set, &figures, &map, input, o, f);
    env_map_free(&map);
    if (code) return code;
    light_set_turn(&set, turn);
    if (ends_with(c->output, ".c"))
        light_set_source(&set, c->output, &file);
    else
        write_csv(&set, input, o, turn, &file);
    json j = figures_of(&set, &figures, c->output, method_names[o->method]);
    code = write_outputs(c, &file, input, &j, f);
    if (!code && bake_prints(c))
        printf("%s: %d lights, irradiance %.4g, %.4g, %.4g in all\n", c->output, set.count, figures.total[0],
               figures.total[1], figures.total[2]);
    bytes_free(&file);
    light_set_free(&set);
    return code;
}

int bake_lights(int argc, char **argv, failure *f)
{
    bake_common c = {0};
    progress meter = {0};
    light_options o = {.count = 64, .scale = 1, .progress = &meter};
    const char *method = method_names[0], *input = NULL;
    double turn = 0;
    const option table[] = {
        {"--count", OPTION_INT, &o.count, 1, LIGHT_SET_MAX, "N", "so many lights (64)"},
        {"--method", OPTION_TEXT, &method, 0, 0, "METHOD",
         "relaxed (default): variance cut, then Lloyd's iteration (Kollig & Keller 2003); variance-cut (Viriyothai & "
         "Debevec 2009); median-cut (Debevec 2005)"},
        {"--turn", OPTION_REAL, &turn, -3600, 3600, "DEG",
         "turn the lights about +y: from +z (the eye) towards +x (0)"},
        {"--scale", OPTION_REAL, &o.scale, 1e-9, 1e9, "S", "multiplies radiance (1)"},
        {"-o", OPTION_TEXT, &c.output, 0, 0, "FILE",
         "F.csv: a light per line, polar,azimuth,r,g,b (degrees as for shot --light; irradiance on a surface that "
         "faces "
         "the light, of which a white matt one reflects 1/pi); or F.c: an array of nacre_light"},
        {"--depfile", OPTION_TEXT, &c.depfile, 0, 0, "FILE", "write a make fragment: output and what it is made of"},
        {"--json", OPTION_TEXT, &c.json, 0, 0, "FILE", "the figures printed, as JSON (- for standard output)"},
        {"--threads", OPTION_INT, &c.threads, 1, 256, "N", "(all cores) the lights do not depend on it"},
        {"--quiet", OPTION_FLAG, &c.quiet, 0, 0, NULL, "print nothing but errors"},
    };
    int operands;
    int code =
        options_parse(argc, argv,
                      "nacre bake lights MAP.hdr --count N -o F.csv [options]\n"
                      "  MAP: latitude-longitude radiance, twice as wide as high, Radiance .hdr or .pfm. Its middle "
                      "lies straight ahead\n"
                      "  (-z, behind the object), right of the middle is +x, its side edges are +z (the eye's side), "
                      "its top is +y.",
                      table, sizeof table / sizeof *table, &input, &operands, 1, 1, f);

    if (code || (code = bake_check(&c, "bake lights", input, f)) || (code = parse_method(method, &o.method, f)))
        return code;
    meter.quiet = c.quiet;
    return bake(&c, input, &o, turn, f);
}
