/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "ktx2_write.h"
#include "nacre_asset.h"
#include "palette.h"
#include "table_parts.h"

#define PI 3.14159265358979323846

void palette_free(palette *p)
{
    for (int i = 0; i < p->count && p->table; i++) table_free(&p->table[i]);
    free(p->table);
    for (int i = 0; i < NACRE_MAX_LEVELS; i++) free(p->code[i]);
    *p = (palette){0};
}

int palette_columns(int count, int w, int h)
{
    enum { MOST_SIDE = 2048, MOST_COLUMNS = 16 }; /* what every ES 2.0 device of the baseline holds */
    int columns = 1;
    while (columns * columns * 4 < count) columns *= 2;
    while ((count + columns - 1) / columns * (h + 4) > MOST_SIDE && columns < MOST_COLUMNS) columns *= 2;
    return (count + columns - 1) / columns * (h + 4) <= MOST_SIDE && columns * (w + 2) <= MOST_SIDE ? columns : 0;
}

static int level_side(int side, int level)
{
    return side >> level ? side >> level : 1;
}

static size_t level_size(const palette *p, int level)
{
    return (size_t)level_side(p->width, level) * (size_t)level_side(p->height, level);
}

/* ---- tiles ------------------------------------------------------------------------------------------- */

typedef struct tiling {
    int columns, rows, w, h; /* of tiles; of a table */
    int width, height;       /* of the image */
} tiling;

static tiling tiling_of(int count, int columns, int w, int h)
{
    const int rows = (count + columns - 1) / columns;
    return (tiling){columns, rows, w, h, columns * (w + 2), rows * (h + 4)};
}

static tiling tiling_for(const palette *p)
{
    const int w = p->table[0].width, h = p->table[0].height;
    return tiling_of(p->count, palette_columns(p->count, w, h), w, h);
}

/* Texel (x, y) of a table's tile. */
static uint8_t *tile_texel(const tiling *t, uint8_t *image, int table, int x, int y)
{
    const int column = table % t->columns * (t->w + 2) + x, row = table / t->columns * (t->h + 4) + y;
    return image + 4 * ((size_t)row * (size_t)t->width + (size_t)column);
}

static int held(int i, int count)
{
    return i < 0 ? 0 : i >= count ? count - 1 : i;
}

static void put_tile(const tiling *t, uint8_t *image, int index, const table_asset *table)
{
    for (int y = 0; y < t->h + 4; y++)
        for (int x = 0; x < t->w + 2; x++) {
            uint8_t *to = tile_texel(t, image, index, x, y);
            if (y < t->h + 2) {
                memcpy(to, table->rgba + 4 * (held(y - 1, t->h) * t->w + held(x - 1, t->w)), 4);
                continue;
            }
            for (int k = 0; k < 3; k++) to[k] = unorm8(sqrt(fmax(table->albedo[k], 0)));
            to[3] = 255;
        }
}

static void take_tile(const tiling *t, uint8_t *image, int index, table_asset *table)
{
    const uint8_t *albedo = tile_texel(t, image, index, t->w / 2, t->h + 2);
    table->rgba = need_memory((size_t)(t->w * t->h), 4);
    for (int y = 0; y < t->h; y++)
        memcpy(table->rgba + 4 * y * t->w, tile_texel(t, image, index, 1, y + 1), 4 * (size_t)t->w);
    for (int k = 0; k < 3; k++) table->albedo[k] = pow(albedo[k] / 255.0, 2);
}

/* ---- files ------------------------------------------------------------------------------------------- */

size_t palette_texel_bytes(const palette *p)
{
    const tiling t = tiling_for(p);
    size_t sum = 4 * (size_t)t.width * (size_t)t.height;
    for (int i = 0; i < p->levels; i++) sum += level_size(p, i);
    return sum;
}

void palette_write(const palette *p, bytes *tables, bytes *index)
{
    const table_asset *first = &p->table[0];
    const tiling t = tiling_for(p);
    const size_t size = 4 * (size_t)t.width * (size_t)t.height;
    const double key[10] = {first->e, first->ymax, first->w[0], first->w[1], first->w[2],
                            first->p, first->eps,  0,           0,           first->rows};
    const uint32_t tiles[4] = {(uint32_t)p->count, (uint32_t)t.columns, (uint32_t)t.w, (uint32_t)t.h};
    const uint32_t blend = (uint32_t)p->blend;
    uint8_t *image = need_memory(size, 1);
    memset(image, 0, size);
    for (int i = 0; i < p->count; i++) put_tile(&t, image, i, &p->table[i]);

    ktx2_image k = {.format = NACRE_FORMAT_RGBA8, .width = t.width, .height = t.height, .faces = 1, .levels = 1};
    bytes_append(&k.level[0], image, size);
    free(image);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "palette");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "root");
    ktx2_key_text(&k, NACRE_KEY_NAME, p->name);
    ktx2_key_q16(&k, NACRE_KEY_TABLE, key, 10);
    ktx2_key_u32(&k, NACRE_KEY_TILES, tiles, 4);
    ktx2_key_q16(&k, NACRE_KEY_ALBEDO, p->white_sky, 3);
    ktx2_write(&k, tables);
    ktx2_free(&k);

    ktx2_image map = {
        .format = NACRE_FORMAT_R8, .width = p->width, .height = p->height, .faces = 1, .levels = p->levels};
    for (int i = 0; i < p->levels; i++) bytes_append(&map.level[i], p->code[i], level_size(p, i));
    ktx2_key_text(&map, NACRE_KEY_ROLE, "index");
    ktx2_key_text(&map, NACRE_KEY_NAME, p->name);
    ktx2_key_u32(&map, NACRE_KEY_BLEND, &blend, 1);
    ktx2_write(&map, index);
    ktx2_free(&map);
}

static int check_role(const nacre_image *image, const char *path, const char *role, failure *f)
{
    char found[40];
    if (asset_key_is(image, NACRE_KEY_ROLE, role)) return FAIL_NONE;
    ktx2_role(image, found, sizeof found);
    return fail(f, FAIL_INVALID, "%s: key %s: found \"%s\", expected \"%s\"", path, NACRE_KEY_ROLE, found, role);
}

int palette_check_tables(const nacre_image *image, const char *path, uint32_t counts[4], failure *f)
{
    const int code = check_role(image, path, "palette", f);
    if (code) return code;
    if (image->format != NACRE_FORMAT_RGBA8 || image->layers != 1 || image->levels != 1 || image->faces != 1)
        return fail(f, FAIL_INVALID,
                    "%s: found format %d, %d layers, %d faces, %d levels, expected format %d (RGBA8) and one of each",
                    path, image->format, image->layers, image->faces, image->levels, NACRE_FORMAT_RGBA8);
    if (!asset_key_u32(image, NACRE_KEY_TILES, counts, 4))
        return fail(f, FAIL_INVALID, "%s: key %s: missing or not 4 numbers", path, NACRE_KEY_TILES);
    if (counts[0] < 1 || counts[0] > NACRE_MAX_PALETTE)
        return fail(f, FAIL_INVALID, "%s: key %s: found %u tables, expected 1..%d", path, NACRE_KEY_TILES, counts[0],
                    NACRE_MAX_PALETTE);
    if (counts[1] < 1 || counts[1] > 16 || (counts[1] & (counts[1] - 1)))
        return fail(f, FAIL_INVALID, "%s: key %s: found %u columns, expected 1, 2, 4, 8 or 16", path, NACRE_KEY_TILES,
                    counts[1]);
    for (int i = 2; i < 4; i++)
        if (counts[i] < TABLE_MIN_SIDE || counts[i] > TABLE_MAX_SIDE)
            return fail(f, FAIL_INVALID, "%s: key %s: found %u texels, expected %d..%d a side", path, NACRE_KEY_TILES,
                        counts[i], TABLE_MIN_SIDE, TABLE_MAX_SIDE);
    const tiling t = tiling_of((int)counts[0], (int)counts[1], (int)counts[2], (int)counts[3]);
    if (image->width == t.width && image->height == t.height) return FAIL_NONE;
    return fail(f, FAIL_INVALID, "%s: found %d x %d texels, expected %d x %d for the tiles of key %s", path,
                image->width, image->height, t.width, t.height, NACRE_KEY_TILES);
}

int palette_check_index(const nacre_image *image, const char *path, int *blend, int *most, failure *f)
{
    const int code = check_role(image, path, "index", f);
    uint32_t found = 0;
    if (code) return code;
    if (image->format != NACRE_FORMAT_R8 || image->layers != 1 || image->faces != 1)
        return fail(f, FAIL_INVALID,
                    "%s: found format %d, %d layers, %d faces, expected format %d (R8) and one of each", path,
                    image->format, image->layers, image->faces, NACRE_FORMAT_R8);
    if (nacre_image_key(image, NACRE_KEY_BLEND, NULL) &&
        (!asset_key_u32(image, NACRE_KEY_BLEND, &found, 1) || found > 1))
        return fail(f, FAIL_INVALID, "%s: key %s: expected 0 or 1", path, NACRE_KEY_BLEND);
    *blend = (int)found;
    *most = 0;
    for (unsigned i = 0; i < image->levels; i++) {
        uint32_t size;
        const uint8_t *texels = nacre_image_texels(image, i, 0, 0, &size);
        for (uint32_t k = 0; k < size; k++) *most = texels[k] > *most ? texels[k] : *most;
    }
    return FAIL_NONE;
}

/* The common numbers, into a table that has no texels yet. */
static int read_numbers(table_asset *t, const nacre_image *image, const char *path, failure *f)
{
    int32_t q16[10];
    if (!asset_key_q16(image, NACRE_KEY_TABLE, q16, 10))
        return fail(f, FAIL_INVALID, "%s: key %s: missing or not 10 q16 numbers", path, NACRE_KEY_TABLE);
    double *const to[10] = {&t->e, &t->ymax, &t->w[0], &t->w[1], &t->w[2], &t->p, &t->eps, &t->k1, &t->k2, &t->rows};
    for (int i = 0; i < 10; i++) *to[i] = q16[i] / 65536.0;
    if (t->e > 0 && t->ymax > 0 && fabs(t->p - 4) < 1e-3 && t->eps > 0 && t->eps <= 1 && fabs(t->rows) <= 1)
        return FAIL_NONE;
    return fail(f, FAIL_INVALID, "%s: key %s: E %g, Ymax %g, p %g, eps %g or B %g is out of range", path,
                NACRE_KEY_TABLE, t->e, t->ymax, t->p, t->eps, t->rows);
}

int palette_read(palette *out, const nacre_image *tables, const char *tables_path, const nacre_image *index,
                 const char *index_path, failure *f)
{
    uint32_t counts[4], size;
    int blend, most;
    table_asset common = {.layers = 1, .layout = TABLE_ONE_LAYER};
    int code = palette_check_tables(tables, tables_path, counts, f);
    if (!code) code = read_numbers(&common, tables, tables_path, f);
    if (!code) code = palette_check_index(index, index_path, &blend, &most, f);
    if (!code && most >= (int)counts[0])
        code = fail(f, FAIL_INVALID, "%s: found code %d, expected less than the %u tables of %s", index_path, most,
                    counts[0], tables_path);
    if (code) return code;
    const tiling t = tiling_of((int)counts[0], (int)counts[1], (int)counts[2], (int)counts[3]);
    palette p = {.count = (int)counts[0],
                 .width = index->width,
                 .height = index->height,
                 .levels = index->levels,
                 .blend = blend};
    uint8_t *image = need_memory(4 * (size_t)t.width, (size_t)t.height);
    memcpy(image, nacre_image_texels(tables, 0, 0, 0, NULL), 4 * (size_t)t.width * (size_t)t.height);
    p.table = need_memory((size_t)p.count, sizeof *p.table);
    common.width = t.w;
    common.height = t.h;
    for (int i = 0; i < p.count; i++) {
        p.table[i] = common;
        take_tile(&t, image, i, &p.table[i]);
    }
    free(image);
    for (int i = 0; i < p.levels; i++) {
        const uint8_t *texels = nacre_image_texels(index, (unsigned)i, 0, 0, &size);
        p.code[i] = need_memory(size, 1);
        memcpy(p.code[i], texels, size);
    }
    int32_t albedo[3] = {0};
    asset_key_q16(tables, NACRE_KEY_ALBEDO, albedo, 3);
    for (int k = 0; k < 3; k++) p.white_sky[k] = albedo[k] / 65536.0;
    ktx2_name(tables, p.name, sizeof p.name);
    *out = p;
    return FAIL_NONE;
}

/* ---- as a BRDF ---------------------------------------------------------------------------------------- */

typedef struct palette_source {
    brdf base;
    palette p;
    double share[NACRE_MAX_PALETTE]; /* of the map */
} palette_source;

static int repeated(double i, int count)
{
    const double j = fmod(floor(i), count);
    return (int)(j < 0 ? j + count : j);
}

static const table_asset *table_at(const palette *p, double x, double y)
{
    return &p->table[p->code[0][(size_t)repeated(y, p->height) * (size_t)p->width + (size_t)repeated(x, p->width)]];
}

static void add_y(const table_asset *t, const table_point *point, double weight, double y[3])
{
    double own[3];
    if (!(weight > 0)) return;
    table_y(t, point, own);
    for (int k = 0; k < 3; k++) y[k] += weight * own[k];
}

static void eval_at(const brdf *b, const double uv[2], const double to_light[3], const double to_eye[3], double f_r[3])
{
    const palette *p = &((const palette_source *)b)->p;
    const table_asset *any = &p->table[0];
    double x = uv[0] * p->width, y = (1 - uv[1]) * p->height, root[3] = {0};
    table_point point;
    f_r[0] = f_r[1] = f_r[2] = 0;
    if (!table_locate(&point, to_light, to_eye)) return;
    if (p->blend) {
        const double left = floor(x - 0.5), top = floor(y - 0.5), right = x - 0.5 - left, down = y - 0.5 - top;
        for (int i = 0; i < 4; i++)
            add_y(table_at(p, left + (i & 1), top + (i >> 1)), &point,
                  (i & 1 ? right : 1 - right) * (i >> 1 ? down : 1 - down), root);
    } else {
        add_y(table_at(p, x, y), &point, 1, root);
    }
    for (int k = 0; k < 3; k++) f_r[k] = pow(any->ymax * root[k], any->p) / (point.l_dot_h * PI * any->e);
}

static int eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    const palette_source *s = (const palette_source *)b;
    f_r[0] = f_r[1] = f_r[2] = 0;
    for (int i = 0; i < s->p.count; i++) {
        double radiance[3];
        if (!(s->share[i] > 0)) continue;
        table_decode(&s->p.table[i], to_light, to_eye, radiance);
        for (int k = 0; k < 3 && to_light[2] > 0; k++)
            f_r[k] += s->share[i] * radiance[k] / (PI * s->p.table[i].e * to_light[2]);
    }
    return 1;
}

static void close_source(brdf *b)
{
    palette_free(&((palette_source *)b)->p);
    free(b);
}

brdf *palette_brdf(palette *p)
{
    palette_source *s = need_memory(1, sizeof *s);
    memset(s, 0, sizeof *s);
    s->p = *p;
    *p = (palette){0};
    for (size_t i = 0; i < level_size(&s->p, 0); i++) s->share[s->p.code[0][i]] += 1.0 / (double)level_size(&s->p, 0);
    s->base.eval = eval;
    s->base.eval_at = eval_at;
    s->base.close = close_source;
    snprintf(s->base.name, sizeof s->base.name, "%s", s->p.name);
    snprintf(s->base.description, sizeof s->base.description, "palette of %d half-vector tables, map of %d x %d%s",
             s->p.count, s->p.width, s->p.height, s->p.blend ? ", blended" : "");
    return &s->base;
}
