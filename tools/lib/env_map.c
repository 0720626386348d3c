/* SPDX-License-Identifier: MIT */
#include "env_map.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"
#include "pfm_io.h"

#define PI 3.14159265358979323846

typedef struct reader {
    const char *path;
    bytes file;
    size_t at;
    double scale[3]; /* what stored values are multiplied by */
    int is_xyz, flip_x, flip_y;
} reader;

void env_map_free(env_map *map)
{
    free(map->texel);
    *map = (env_map){0};
}

void env_map_warn(const env_map *map, const char *path)
{
    if (map->negative || map->not_finite)
        fprintf(stderr, "nacre: warning: %s: %ld texels of negative radiance and %ld of NaN or infinity counted as 0\n",
                path, map->negative, map->not_finite);
}

/* ---- geometry ---------------------------------------------------------------------------------------------------- */

void env_map_direction(const env_map *map, double x, double y, double direction[3])
{
    const double longitude = 2 * PI * (x / map->width - 0.5), latitude = PI * (0.5 - y / map->height);

    direction[0] = cos(latitude) * sin(longitude);
    direction[1] = sin(latitude);
    direction[2] = -cos(latitude) * cos(longitude);
}

double env_map_solid_angle(const env_map *map, int row)
{
    const double step = PI / map->height;

    return 2 * PI / map->width * (sin(PI / 2 - row * step) - sin(PI / 2 - (row + 1) * step));
}

void env_turn(double v[3], double degrees)
{
    const double c = cos(degrees * (PI / 180)), s = sin(degrees * (PI / 180)), x = v[0], z = v[2];

    v[0] = c * x + s * z;
    v[2] = c * z - s * x;
}

double env_luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/* ---- lines of text ----------------------------------------------------------------------------------------------- */

/* The next line without its end, at most size - 1 characters of it; 0 at the end of the file. */
static int next_line(reader *r, char *line, size_t size)
{
    size_t length = 0;

    while (r->at < r->file.size && r->file.data[r->at] != '\n') {
        const char c = (char)r->file.data[r->at++];
        if (length + 1 < size && c != '\r') line[length++] = c;
    }
    line[length] = 0;
    if (r->at == r->file.size) return 0;
    r->at++;
    return 1;
}

static int cut_short(const reader *r, const char *within, failure *f)
{
    return fail(f, FAIL_INVALID, "%s: offset %zu: the file ends in the %s", r->path, r->file.size, within);
}

/* Only what a person would type of a line that a file holds. */
static const char *printable(char *line)
{
    for (char *c = line; *c; c++)
        if (!isprint((unsigned char)*c)) *c = '?';
    line[strlen(line) < 40 ? strlen(line) : 40] = 0;
    return line;
}

static int check_size(const reader *r, long width, long height, failure *f)
{
    if (width < 1 || height < 1)
        return fail(f, FAIL_INVALID, "%s: found a map of %ldx%ld texels, expected some", r->path, width, height);
    if (height > width || width != 2 * height)
        return fail(f, FAIL_INVALID,
                    "%s: found %ldx%ld texels, expected a latitude-longitude map, twice as wide as high", r->path,
                    width, height);
    if (width > ENV_MAP_MAX_WIDTH)
        return fail(f, FAIL_UNSUPPORTED, "%s: found %ldx%ld texels, expected a width of at most %d", r->path, width,
                    height, ENV_MAP_MAX_WIDTH);
    return FAIL_NONE;
}

/* ---- texels ------------------------------------------------------------------------------------------------------ */

/* CIE XYZ with white (1,1,1), as Radiance files hold it, to linear Rec. 709 with white (1,1,1). */
static void xyz_to_rgb(double v[3])
{
    /* IEC 61966-2-1, white D65 = (.9505, 1, 1.0890) */
    const double x = v[0] * 0.9505, y = v[1], z = v[2] * 1.0890;

    v[0] = 3.2406 * x - 1.5372 * y - 0.4986 * z;
    v[1] = -0.9689 * x + 1.8758 * y + 0.0415 * z;
    v[2] = 0.0557 * x - 0.2040 * y + 1.0570 * z;
}

static void store(env_map *map, const reader *r, int column, int row, const double value[3])
{
    const int x = r->flip_x ? map->width - 1 - column : column, y = r->flip_y ? map->height - 1 - row : row;
    float *to = map->texel + 3 * ((size_t)y * (size_t)map->width + (size_t)x);
    double v[3];
    int i, negative = 0, not_finite = 0;

    for (i = 0; i < 3; i++) v[i] = value[i] * r->scale[i];
    if (r->is_xyz) xyz_to_rgb(v);
    for (i = 0; i < 3; i++) {
        if (!isfinite((float)v[i])) {
            not_finite = 1;
            v[i] = 0;
        } else if (v[i] < 0) {
            negative = 1;
            v[i] = 0;
        }
        to[i] = (float)v[i];
    }
    map->negative += negative;
    map->not_finite += not_finite;
}

static void make_texels(env_map *map, long width, long height)
{
    map->width = (int)width;
    map->height = (int)height;
    map->texel = need_memory((size_t)width * (size_t)height * 3, sizeof *map->texel);
}

/* ---- Radiance: Ward 1991, "Real pixels", and the format's description in ray/src/common/color.c ------------------- */

static int header_line(reader *r, char *line, failure *f)
{
    double v[3];
    int i;

    if (!strncmp(line, "FORMAT=", 7)) {
        r->is_xyz = !strcmp(line + 7, "32-bit_rle_xyze");
        if (!r->is_xyz && strcmp(line + 7, "32-bit_rle_rgbe"))
            return fail(f, FAIL_INVALID, "%s: found '%s', expected FORMAT=32-bit_rle_rgbe or xyze", r->path,
                        printable(line));
    } else if (!strncmp(line, "EXPOSURE=", 9) || !strncmp(line, "COLORCORR=", 10)) {
        const int all = line[0] == 'E';
        const int found = sscanf(strchr(line, '=') + 1, "%lf %lf %lf", &v[0], &v[1], &v[2]);
        if (all && found >= 1) v[1] = v[2] = v[0];
        if (found < (all ? 1 : 3) || !(v[0] > 0 && v[1] > 0 && v[2] > 0 && isfinite(v[0] + v[1] + v[2])))
            return fail(f, FAIL_INVALID, "%s: found '%s', expected %s above 0", r->path, printable(line),
                        all ? "a number" : "three numbers");
        for (i = 0; i < 3; i++) r->scale[i] /= v[i]; /* the lines accumulate */
    }
    return FAIL_NONE;
}

static int resolution_line(reader *r, char *line, long *width, long *height, failure *f)
{
    char y[3], x[3], end;

    if (sscanf(line, "%2s %ld %2s %ld%c", y, height, x, width, &end) != 4 || (y[0] != '-' && y[0] != '+') ||
        (x[0] != '-' && x[0] != '+') || (y[1] != 'Y' && y[1] != 'X') || (x[1] != 'Y' && x[1] != 'X') || x[1] == y[1])
        return fail(f, FAIL_INVALID, "%s: found '%s', expected a size like -Y 256 +X 512", r->path, printable(line));
    if (y[1] != 'Y')
        return fail(f, FAIL_UNSUPPORTED, "%s: found '%s': columns are stored first, expected rows (-Y 256 +X 512)",
                    r->path, printable(line));
    r->flip_y = y[0] == '+';
    r->flip_x = x[0] == '-';
    return FAIL_NONE;
}

/* One row in the newer run-length code: four planes, each of runs (128 + length, byte) and literals (length, bytes). */
static int planes(reader *r, uint8_t *row, int width, failure *f)
{
    int plane, x, i;

    r->at += 4;
    for (plane = 0; plane < 4; plane++)
        for (x = 0; x < width;) {
            const uint8_t *from = r->file.data + r->at;
            const size_t left = r->file.size - r->at;
            const int code = left ? from[0] : 0, is_run = code > 128, length = is_run ? code - 128 : code;
            const size_t used = 1 + (size_t)(is_run ? 1 : length);
            if (left < used || !left) return cut_short(r, "texels", f);
            if (!length || length > width - x)
                return fail(f, FAIL_INVALID, "%s: offset %zu: found a run of %d texels, expected 1..%d", r->path, r->at,
                            length, width - x);
            for (i = 0; i < length; i++) row[4 * (x + i) + plane] = from[is_run ? 1 : 1 + i];
            x += length;
            r->at += used;
        }
    return FAIL_NONE;
}

/* One row of single texels; (1,1,1,n) repeats the last one n times, and again 256 n times if another follows. */
static int texels(reader *r, uint8_t *row, int width, failure *f)
{
    int x = 0, shift = 0;

    while (x < width) {
        const uint8_t *from = r->file.data + r->at;
        if (r->file.size - r->at < 4) return cut_short(r, "texels", f);
        if (from[0] == 1 && from[1] == 1 && from[2] == 1) {
            long length = shift > 16 ? width + 1L : (long)from[3] << shift;
            if (!x || length > width - x)
                return fail(f, FAIL_INVALID, "%s: offset %zu: found a run of %ld texels, expected at most %d after one",
                            r->path, r->at, length, x ? width - x : 0);
            for (; length > 0; length--, x++) memcpy(row + 4 * x, row + 4 * (x - 1), 4);
            shift += 8;
        } else {
            memcpy(row + 4 * x++, from, 4);
            shift = 0;
        }
        r->at += 4;
    }
    return FAIL_NONE;
}

static int radiance_rows(reader *r, env_map *map, failure *f)
{
    uint8_t *row = need_memory((size_t)map->width, 4);
    int code = FAIL_NONE, i, j;

    for (j = 0; j < map->height && !code; j++) {
        const uint8_t *from = r->file.data + r->at;
        const int planar = map->width >= 8 && map->width < 32768 && r->file.size - r->at >= 4 && from[0] == 2 &&
                           from[1] == 2 && from[2] < 128;
        if (planar && (from[2] << 8 | from[3]) != map->width)
            code = fail(f, FAIL_INVALID, "%s: offset %zu: found a row of %d texels, expected %d", r->path, r->at,
                        from[2] << 8 | from[3], map->width);
        else
            code = planar ? planes(r, row, map->width, f) : texels(r, row, map->width, f);
        for (i = 0; i < map->width && !code; i++) {
            const uint8_t *t = row + 4 * i;
            const double unit = t[3] ? ldexp(1, t[3] - 136) : 0;
            const double value[3] = {t[0] * unit, t[1] * unit, t[2] * unit};
            store(map, r, i, j, value);
        }
    }
    free(row);
    return code;
}

static int read_radiance(reader *r, env_map *map, failure *f)
{
    char line[256];
    long width = 0, height = 0;
    int code;

    do {
        if (!next_line(r, line, sizeof line)) return cut_short(r, "header", f);
        if ((code = header_line(r, line, f))) return code;
    } while (line[0]);
    if (!next_line(r, line, sizeof line)) return cut_short(r, "header", f);
    if ((code = resolution_line(r, line, &width, &height, f)) || (code = check_size(r, width, height, f))) return code;
    make_texels(map, width, height);
    return radiance_rows(r, map, f);
}

/* ---- portable float map ------------------------------------------------------------------------------------------ */

static int read_pfm(reader *r, env_map *map, failure *f)
{
    image_f32 picture;
    int code = pfm_read(&picture, r->path, f), i, j, k;

    if (code) return code;
    code = check_size(r, picture.width, picture.height, f);
    if (!code) make_texels(map, picture.width, picture.height);
    for (j = 0; j < picture.height && !code; j++)
        for (i = 0; i < picture.width; i++) {
            const float *texel = picture.texel + (size_t)(j * picture.width + i) * (size_t)picture.channels;
            double value[3];
            for (k = 0; k < 3; k++) value[k] = texel[picture.channels == 3 ? k : 0];
            store(map, r, i, j, value);
        }
    image_f32_free(&picture);
    return code;
}

/* ---- either ------------------------------------------------------------------------------------------------------ */

int env_map_open(env_map *out, const char *path, failure *f)
{
    reader r = {.path = path, .scale = {1, 1, 1}};
    env_map map = {0};
    char line[100];
    int code = file_read(&r.file, path, f);

    if (code) return code;
    next_line(&r, line, sizeof line);
    if (!r.file.size)
        code =
            fail(f, FAIL_INVALID, "%s: the file is empty, expected an environment map (Radiance .hdr or .pfm)", path);
    else if (!strcmp(line, "#?RADIANCE") || !strcmp(line, "#?RGBE"))
        code = read_radiance(&r, &map, f);
    else if (!strcmp(line, "PF") || !strcmp(line, "Pf"))
        code = read_pfm(&r, &map, f);
    else
        code = fail(f, FAIL_INVALID, "%s: found '%s', expected #?RADIANCE, #?RGBE, PF or Pf", path, printable(line));
    bytes_free(&r.file);
    if (code) {
        env_map_free(&map);
        return code;
    }
    *out = map;
    return FAIL_NONE;
}
