/* SPDX-License-Identifier: MIT */
#include "asset_cases.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nacre_asset.h"

const asset_case asset_cases[] = {
    {"table", NACRE_FORMAT_RGBA8, 24, 21, 0, 1, 1, 0, "table"},
    {"table-fine", NACRE_FORMAT_RGBA8, 8, 5, 2, 1, 1, 0, "table"},
    {"spheres", NACRE_FORMAT_RGBA8, 8, 8, 4, 1, 4, 0, "spheres"},
    {"spheres-etc1", NACRE_FORMAT_ETC2_RGB8, 8, 8, 5, 1, 4, 0, "spheres"},
    {"spheres-rgb565", NACRE_FORMAT_RGB565, 16, 16, 4, 1, 5, 1, "spheres"},
    {"normal", NACRE_FORMAT_RGB8, 5, 3, 0, 1, 3, 0, "normal"},
    {"cube-rgb8", NACRE_FORMAT_RGB8, 4, 4, 0, 6, 3, 0, NULL},
    {"cubes-rgba8", NACRE_FORMAT_RGBA8, 4, 4, 2, 6, 2, 1, NULL},
    {"grey", NACRE_FORMAT_R8, 1, 1, 0, 1, 1, 0, NULL},
    {"pairs", NACRE_FORMAT_RG8, 7, 2, 3, 1, 2, 0, NULL},
    {"half", NACRE_FORMAT_RGBA16F, 4, 4, 1, 1, 3, 0, NULL},
    {"shared", NACRE_FORMAT_E5BGR9, 6, 6, 0, 6, 3, 0, NULL},
    {"quarters", NACRE_FORMAT_RGB8, 5, 5, 3, 1, 1, 0, "spheres"},
    {"quarters-etc2", NACRE_FORMAT_ETC2_RGB8, 8, 8, 2, 1, 1, 0, "spheres"},
    {"table-rows", NACRE_FORMAT_RGBA8, 7, 6, 0, 1, 1, 0, "table"},
    {"table-two", NACRE_FORMAT_RGBA8, 6, 7, 2, 1, 1, 0, "table"},
    {"palette", NACRE_FORMAT_RGBA8, 12, 16, 0, 1, 1, 0, "palette"},
    {"index", NACRE_FORMAT_R8, 8, 4, 0, 1, 4, 0, "index"},
};
const int asset_case_count = sizeof asset_cases / sizeof asset_cases[0];

/* xorshift, seeded by the name */
static uint32_t next(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

/* Bytes of one layer and face, counted here and not by the code under test. */
static size_t part_bytes(const asset_case *c, int level)
{
    int w = c->width >> level, h = c->height >> level;
    if (w < 1) w = 1;
    if (h < 1) h = 1;
    switch (c->format) {
    case NACRE_FORMAT_R8:
        return (size_t)(w * h);
    case NACRE_FORMAT_RG8:
    case NACRE_FORMAT_RGB565:
        return (size_t)(2 * w * h);
    case NACRE_FORMAT_RGB8:
        return (size_t)(3 * w * h);
    case NACRE_FORMAT_RGBA16F:
        return (size_t)(8 * w * h);
    case NACRE_FORMAT_ETC2_RGB8:
        return (size_t)(8 * ((w + 3) / 4) * ((h + 3) / 4));
    default:
        return (size_t)(4 * w * h);
    }
}

static int is_quarters(const asset_case *c)
{
    return !strncmp(c->name, "quarters", 8);
}

static void fill_level(const asset_case *c, int level, bytes *out, uint32_t *state)
{
    const size_t size = part_bytes(c, level) * (size_t)((c->layers ? c->layers : 1) * c->faces);
    const int etc1 = c->format == NACRE_FORMAT_ETC2_RGB8 && !is_quarters(c); /* the others in any mode */
    for (size_t i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(next(state) >> 11);
        if (c->role && !strcmp(c->role, "index")) byte %= 3;
        if (c->format == NACRE_FORMAT_RGBA16F && i % 2) byte &= 0x3F; /* finite halves, below 2 */
        if (etc1 && i % 8 < 3) byte &= 0xF8 | 3;                      /* 5-bit colours, steps of 0..3 ... */
        if (etc1 && i % 8 < 3) byte &= 0xE7;                          /* ... that can't leave 0..31 */
        bytes_append(out, &byte, 1);
    }
}

static void add_keys(const asset_case *c, ktx2_image *k)
{
    ktx2_key_text(k, NACRE_KEY_ROLE, c->role);
    ktx2_key_text(k, NACRE_KEY_NAME, c->name);
    if (!strcmp(c->role, "table")) {
        const double fine = c->layers == 2;
        const int early = strcmp(c->name, "table-rows") && strcmp(c->name, "table-two");
        const double table[17] = {
            1.5, 0.875, 1, 0.75, -0.5,  4.8,  1.0 / 256, early ? 0.5 * fine : 0, 0.25 * fine, -0.5,
            1.5, 1.25,  1, 0.5,  -0.75, 0.25, 2};
        ktx2_key_text(k, NACRE_KEY_TRANSFER, "root");
        ktx2_key_q16(k, NACRE_KEY_TABLE, table, early ? 9 : c->layers == 2 ? 17 : 10);
    }
    if (!strcmp(c->role, "palette")) { /* three tables of 4 x 4 in two columns */
        const double table[10] = {1.5, 0.875, 1, 0.75, -0.5, 4, 1.0 / 256, 0, 0, -0.5};
        const uint32_t tiles[4] = {3, 2, 4, 4};
        ktx2_key_text(k, NACRE_KEY_TRANSFER, "root");
        ktx2_key_q16(k, NACRE_KEY_TABLE, table, 10);
        ktx2_key_u32(k, NACRE_KEY_TILES, tiles, 4);
    }
    if (!strcmp(c->role, "index")) {
        const uint32_t blend = 1;
        ktx2_key_u32(k, NACRE_KEY_BLEND, &blend, 1);
    }
    if (!strcmp(c->role, "spheres")) {
        const double scale[3] = {2, 1.25, 0.5}, disc = 0.9375;
        const uint32_t cosine = (uint32_t)c->srgb, one = 1;
        uint32_t polar[8];
        for (int i = 0; i < c->layers; i++) polar[i] = (uint32_t)(i * (c->layers > 4 ? 6144 : 8192));
        ktx2_key_text(k, NACRE_KEY_TRANSFER, c->srgb ? "srgb" : is_quarters(c) ? "root4-lh" : "root4");
        ktx2_key_u32(k, NACRE_KEY_LIGHT_POLAR, polar, c->layers);
        ktx2_key_u32(k, NACRE_KEY_COSINE, &cosine, 1);
        ktx2_key_q16(k, NACRE_KEY_SCALE, scale, 3);
        if (is_quarters(c))
            ktx2_key_u32(k, NACRE_KEY_QUARTERS, &one, 1);
        else
            ktx2_key_q16(k, NACRE_KEY_DISC, &disc, 1);
        if (c->format == NACRE_FORMAT_ETC2_RGB8 && !is_quarters(c)) ktx2_key_u32(k, NACRE_KEY_ETC1, &one, 1);
    }
    if (!strcmp(c->role, "normal")) {
        ktx2_key_text(k, NACRE_KEY_TRANSFER, "linear");
    } else {
        const double albedo[3] = {0.25, 0.5, 1.0 / 3};
        ktx2_key_q16(k, NACRE_KEY_ALBEDO, albedo, 3);
    }
}

void asset_case_make(const asset_case *c, ktx2_image *out)
{
    uint32_t state = 2166136261u;
    for (const char *s = c->name; *s; s++) state = (state ^ (uint8_t)*s) * 16777619u;
    memset(out, 0, sizeof *out);
    out->format = c->format;
    out->width = c->width;
    out->height = c->height;
    out->layers = c->layers;
    out->faces = c->faces;
    out->levels = c->levels;
    out->srgb = c->srgb;
    for (int i = 0; i < c->levels; i++) fill_level(c, i, &out->level[i], &state);
    if (c->role) add_keys(c, out);
}

const char *asset_fixture_directory(void)
{
    static char path[1000];
    const char *top = getenv("NACRE_FIXTURES");
    snprintf(path, sizeof path, "%s/asset", top ? top : "fixtures");
    return path;
}

int asset_fixtures(const char *const **paths)
{
    static glob_t found;
    char pattern[1100];
    snprintf(pattern, sizeof pattern, "%s/*.ktx2", asset_fixture_directory());
    *paths = NULL;
    if (found.gl_pathc) globfree(&found);
    if (glob(pattern, 0, NULL, &found)) return 0;
    *paths = (const char *const *)found.gl_pathv;
    return (int)found.gl_pathc;
}
