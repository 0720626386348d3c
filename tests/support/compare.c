/* SPDX-License-Identifier: MIT */
#include "compare.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "png_io.h"

static const uint8_t *texel(const image_u8 *p, int x, int y)
{
    return p->texel + (size_t)p->channels * ((size_t)y * (size_t)p->width + (size_t)x);
}

static int covered(const image_u8 *p, int x, int y)
{
    return x >= 0 && y >= 0 && x < p->width && y < p->height && texel(p, x, y)[3] == 255;
}

static int taken(const image_u8 *a, const image_u8 *b, int x, int y, int interior)
{
    int i;

    if (!interior) return covered(a, x, y) && covered(b, x, y);
    for (i = 0; i < 9; i++)
        if (!covered(a, x + i % 3 - 1, y + i / 3 - 1) || !covered(b, x + i % 3 - 1, y + i / 3 - 1)) return 0;
    return 1;
}

static void compare_texel(const uint8_t *a, const uint8_t *b, const compare_bound *bound, compare_result *r)
{
    int c, outside = 0;

    for (c = 0; c < 3; c++) {
        int difference = a[c] - b[c];
        r->least = difference < r->least ? difference : r->least;
        r->most = difference > r->most ? difference : r->most;
        r->mean += abs(difference);
        outside |= difference < bound->low || difference > bound->high;
    }
    r->pixels++;
    r->beyond += outside;
}

static void write_picture(const char *name, const char *kind, const image_u8 *p)
{
    char path[400], *c;
    failure f;

    mkdir("build", 0777);
    mkdir("build/frames", 0777);
    snprintf(path, sizeof path, "build/frames/%s.%s.png", name, kind);
    for (c = path + strlen("build/frames/"); *c; c++)
        if (*c == ' ' || *c == '/' || *c == ',') *c = '_';
    if (png_write(path, p, &f))
        printf("    %s\n", f.text);
    else
        printf("    see %s\n", path);
}

static void write_pictures(const char *name, const image_u8 *actual, const image_u8 *expected)
{
    image_u8 difference = image_u8_make(actual->width, actual->height, 3);
    int x, y, c;

    for (y = 0; y < actual->height; y++)
        for (x = 0; x < actual->width; x++)
            for (c = 0; c < 3; c++) {
                double d = texel(actual, x, y)[c] - texel(expected, x, y)[c];
                difference.texel[3 * ((size_t)y * (size_t)actual->width + (size_t)x) + (size_t)c] =
                    unorm8((128 + 8 * d) / 255);
            }
    write_picture(name, "actual", actual);
    write_picture(name, "expected", expected);
    write_picture(name, "difference", &difference);
    image_u8_free(&difference);
}

int compare_frames(const char *name, const image_u8 *actual, const image_u8 *expected, int interior,
                   const compare_bound *bound, compare_result *result)
{
    compare_result r = {0};
    int x, y, ok = 1;

    if (actual->width != expected->width || actual->height != expected->height) {
        printf("%s: %dx%d, expected %dx%d\n", name, actual->width, actual->height, expected->width, expected->height);
        return 0;
    }
    for (y = 0; y < actual->height; y++)
        for (x = 0; x < actual->width; x++) {
            r.uncovered += texel(actual, x, y)[3] != texel(expected, x, y)[3];
            if (taken(actual, expected, x, y, interior))
                compare_texel(texel(actual, x, y), texel(expected, x, y), bound, &r);
        }
    if (r.pixels) r.mean /= 3.0 * (double)r.pixels;
    ok = r.pixels > 0 && (double)r.beyond <= bound->beyond * (double)r.pixels &&
         (double)r.uncovered <= bound->coverage * actual->width * actual->height;
    printf("%-58s %6ld px  %+d..%+d  mean %.3f  beyond %+d..%+d: %ld (%.2f %% allowed)  alpha: %ld%s\n", name, r.pixels,
           r.least, r.most, r.mean, bound->low, bound->high, r.beyond, 100 * bound->beyond, r.uncovered,
           ok ? "" : "   FAILED");
    if (!ok) write_pictures(name, actual, expected);
    if (result) *result = r;
    return ok;
}
