/* SPDX-License-Identifier: MIT */
#include "light_set.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "env_map.h"

#define DEGREE (3.14159265358979323846 / 180)

void light_set_add(light_set *set, const distant_light *light)
{
    /* room doubles whenever the count is a power of two */
    if (!(set->count & (set->count - 1))) {
        distant_light *more = need_memory(set->count ? 2 * (size_t)set->count : 1, sizeof *more);
        if (set->count) memcpy(more, set->light, (size_t)set->count * sizeof *more);
        free(set->light);
        set->light = more;
    }
    set->light[set->count++] = *light;
}

void light_set_free(light_set *set)
{
    free(set->light);
    *set = (light_set){0};
}

void light_angles(const double d[3], double *polar_deg, double *azimuth_deg)
{
    *polar_deg = atan2(hypot(d[0], d[1]), d[2]) / DEGREE;
    *azimuth_deg = atan2(d[1], d[0]) / DEGREE;
}

void light_direction(double polar_deg, double azimuth_deg, double d[3])
{
    d[0] = sin(polar_deg * DEGREE) * cos(azimuth_deg * DEGREE);
    d[1] = sin(polar_deg * DEGREE) * sin(azimuth_deg * DEGREE);
    d[2] = cos(polar_deg * DEGREE);
}

void light_set_turn(light_set *set, double degrees)
{
    for (int i = 0; i < set->count; i++) env_turn(set->light[i].direction, degrees);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

/* Five numbers and commas, blanks around them allowed; 0 if the line is anything else. */
static int five_numbers(const char *line, double v[5])
{
    for (int i = 0; i < 5; i++) {
        char *end;
        v[i] = strtod(line, &end);
        if (end == line || !isfinite(v[i])) return 0;
        while (*end == ' ' || *end == '\t') end++;
        if (*end != (i < 4 ? ',' : 0)) return 0;
        line = end + 1;
    }
    return 1;
}

static int parse_light(light_set *set, const char *path, int number, const char *line, failure *f)
{
    distant_light light;
    double v[5];

    if (!five_numbers(line, v))
        return fail(f, FAIL_INVALID, "%s: line %d: found '%.40s', expected polar,azimuth,r,g,b", path, number, line);
    if (v[0] < 0 || v[0] > 180)
        return fail(f, FAIL_INVALID, "%s: line %d: polar angle %g, expected 0..180 degrees", path, number, v[0]);
    if (fabs(v[1]) > 3600)
        return fail(f, FAIL_INVALID, "%s: line %d: azimuth %g, expected -3600..3600 degrees", path, number, v[1]);
    for (int i = 0; i < 3; i++) {
        if (v[2 + i] < 0 || v[2 + i] > LIGHT_MAX_IRRADIANCE)
            return fail(f, FAIL_INVALID, "%s: line %d: irradiance %g, expected 0..%d", path, number, v[2 + i],
                        LIGHT_MAX_IRRADIANCE);
        light.irradiance[i] = v[2 + i];
    }
    if (set->count == LIGHT_SET_MAX)
        return fail(f, FAIL_INVALID, "%s: line %d: more than %d lights", path, number, LIGHT_SET_MAX);
    light_direction(v[0], v[1], light.direction);
    light_set_add(set, &light);
    return FAIL_NONE;
}

/* Cut blanks at both ends; what no text holds becomes '?', so that an error stays one line. */
static char *trim(char *line)
{
    char *end = line + strlen(line);

    while (isspace((unsigned char)*line)) line++;
    while (end > line && isspace((unsigned char)end[-1])) *--end = 0;
    for (char *c = line; *c; c++)
        if (!isprint((unsigned char)*c) && *c != '\t') *c = '?';
    return line;
}

int light_set_read(light_set *out, const char *path, failure *f)
{
    bytes file = {0};
    light_set set = {0};
    int number = 0, code = file_read(&file, path, f);

    if (code) return code;
    bytes_append(&file, "", 1);
    for (char *line = (char *)file.data, *next; line && !code; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        line = trim(line);
        number++;
        if (line[0] && line[0] != '#') code = parse_light(&set, path, number, line, f);
    }
    if (!code && strlen((char *)file.data) == 0 && file.size == 1)
        code = fail(f, FAIL_INVALID, "%s: the file is empty, expected lines of polar,azimuth,r,g,b", path);
    else if (!code && !set.count)
        code = fail(f, FAIL_INVALID, "%s: found no light in %d lines, expected polar,azimuth,r,g,b", path, number);
    bytes_free(&file);
    if (code) {
        light_set_free(&set);
        return code;
    }
    *out = set;
    return FAIL_NONE;
}

void light_set_text(const light_set *set, const char *const *comments, int comment_count, bytes *out)
{
    for (int i = 0; i < comment_count; i++) bytes_printf(out, "# %s\n", comments[i]);
    for (int i = 0; i < set->count; i++) {
        const distant_light *light = &set->light[i];
        double polar, azimuth;
        light_angles(light->direction, &polar, &azimuth);
        bytes_printf(out, "%.7f,%.7f,%.9g,%.9g,%.9g\n", polar, azimuth, light->irradiance[0], light->irradiance[1],
                     light->irradiance[2]);
    }
}

void light_set_source(const light_set *set, const char *path, bytes *out)
{
    char name[256];

    output_identifier(path, name, sizeof name);
    bytes_printf(out,
                 "/* Written by nacre. %d directional lights: irradiance (q16) and view-space direction (q14). */\n"
                 "#include \"nacre.h\"\n\nextern const nacre_light %s[];\nextern const unsigned %s_count;\n"
                 "const unsigned %s_count = %d;\nconst nacre_light %s[%d] = {\n",
                 set->count, name, name, name, set->count, name, set->count);
    for (int i = 0; i < set->count; i++) {
        const distant_light *l = &set->light[i];
        bytes_printf(out, "    {NACRE_LIGHT_DIRECTIONAL, 0, {%ld, %ld, %ld}, {0, 0, 0}, {%ld, %ld, %ld}},\n",
                     lrint(l->direction[0] * NACRE_Q14_ONE), lrint(l->direction[1] * NACRE_Q14_ONE),
                     lrint(l->direction[2] * NACRE_Q14_ONE), lrint(l->irradiance[0] * NACRE_Q16_ONE),
                     lrint(l->irradiance[1] * NACRE_Q16_ONE), lrint(l->irradiance[2] * NACRE_Q16_ONE));
    }
    bytes_printf(out, "};\n");
}
