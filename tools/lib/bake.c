/* SPDX-License-Identifier: MIT */
#include "bake.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "nacre_asset.h"

/* Index of text among count names; -1 if it is none of them. */
static int index_of(const char *text, const char *const *names, int count)
{
    for (int i = 0; i < count; i++)
        if (!strcmp(text, names[i])) return i;
    return -1;
}

/* ---- table -------------------------------------------------------------------------------------- */

static size_t table_rows(bake_request *r, option *row)
{
    const option rows[] = {
        {"--size", OPTION_TEXT, &r->size, 0, 0, "WxH", "texels, 4..128 (24x21; fine 32x21)"},
        {"--tier", OPTION_TEXT, &r->tier, 0, 0, "TIER", "default (one fetch), fine (two), rgb (no phi_d term)"},
        {"--power", OPTION_REAL, &r->table.power, 4, 4.8, "P",
         "4.8 (default, for sRGB output) or 4 (for square-root output)"},
    };
    memcpy(row, rows, sizeof rows);
    return sizeof rows / sizeof *rows;
}

static int table_check(bake_request *r, failure *f)
{
    static const char *const tiers[] = {"default", "fine", "rgb"};
    if (r->tier) {
        int tier = index_of(r->tier, tiers, 3);
        if (tier < 0) return fail(f, FAIL_USAGE, "--tier %s: expected default, fine or rgb", r->tier);
        r->table.tier = (table_tier)tier;
    }
    if (r->size) {
        int code = parse_size(r->size, "--size", TABLE_MAX_SIDE, &r->table.width, &r->table.height, f);
        if (code) return code;
        if (r->table.width < TABLE_MIN_SIDE || r->table.height < TABLE_MIN_SIDE)
            return fail(f, FAIL_USAGE, "--size %s: expected WxH, each %d..%d", r->size, TABLE_MIN_SIDE, TABLE_MAX_SIDE);
    }
    if (r->table.power != 0 && r->table.power != 4 && r->table.power != 4.8)
        return fail(f, FAIL_USAGE, "--power %g: expected 4.8 or 4", r->table.power);
    return FAIL_NONE;
}

static void table_figures(json *j, const table_asset *t, size_t texel_bytes, size_t file_bytes)
{
    json_text(j, "brdf", t->name);
    json_int(j, "width", t->width);
    json_int(j, "height", t->height);
    json_int(j, "layers", t->layers);
    json_int(j, "texel_bytes", (long long)texel_bytes);
    json_int(j, "file_bytes", (long long)file_bytes);
    json_real(j, "power", t->p);
    json_real(j, "exposure", t->e);
    json_begin(j, "albedo", '[');
    for (int i = 0; i < 3; i++) json_real(j, NULL, t->albedo[i]);
    json_end(j, ']');
}

static int table_run(const bake_request *r, const brdf *b, progress *p, bake_result *out, failure *f)
{
    table_options options = r->table;
    table_asset t;
    options.progress = p;
    int code = table_bake(&t, b, &options, f);
    if (code) return code;
    size_t texel_bytes = (size_t)(t.width * t.height * t.layers) * 4;
    table_write(&t, &out->file);
    table_figures(&out->figures, &t, texel_bytes, out->file.size);
    snprintf(out->shape, sizeof out->shape, "%d x %d x %d, %zu bytes of texels", t.width, t.height, t.layers,
             texel_bytes);
    table_free(&t);
    return FAIL_NONE;
}

/* ---- spheres ------------------------------------------------------------------------------------ */

static size_t sphere_rows(bake_request *r, option *row)
{
    const option rows[] = {
        {"--mode", OPTION_TEXT, &r->mode, 0, 0, "MODE",
         "quarter (default): quarters about the half vector, without the cosine; cosine-free: whole spheres without "
         "it; paper: Mihalik & Durikovic 2015 exactly"},
        {"--images", OPTION_INT, &r->spheres.images, 1, SPHERE_MAX_LAYERS, "N",
         "how many (quarter 6, cosine-free and paper 4), at well-spread light angles"},
        {"--polar", OPTION_TEXT, &r->polar, 0, 0, "A,B,...", "their light polar angles in degrees, rising, instead"},
        {"--size", OPTION_INT, &r->spheres.size, SPHERE_MIN_SIZE, SPHERE_MAX_SIZE, "N",
         "texels a side (quarter 32, at most 128; cosine-free 256; paper 512)"},
        {"--format", OPTION_TEXT, &r->format, 0, 0, "FORMAT",
         "rgba8, rgb8 (quarter's default), rgb565, etc1, or etc2: GLES 3 only"},
        {"--no-pad", OPTION_FLAG, &r->spheres.no_pad, 0, 0, NULL, "let the sphere touch the image's edge"},
    };
    memcpy(row, rows, sizeof rows);
    return sizeof rows / sizeof *rows;
}

static int sphere_check(bake_request *r, failure *f)
{
    static const char *const formats[] = {"rgba8", "rgb8", "rgb565", "etc1", "etc2"};
    static const int format_code[] = {NACRE_FORMAT_RGBA8, NACRE_FORMAT_RGB8, NACRE_FORMAT_RGB565,
                                      NACRE_FORMAT_ETC2_RGB8, NACRE_FORMAT_ETC2_RGB8};
    if (r->polar) {
        int code = parse_reals(r->polar, "--polar", r->spheres.polar, 1, 64, &r->spheres.polar_count, f);
        if (code) return code;
    }
    int mode = r->mode ? index_of(r->mode, sphere_mode_names, 3) : 0;
    if (mode < 0) return fail(f, FAIL_USAGE, "--mode %s: expected quarter, cosine-free or paper", r->mode);
    r->spheres.mode = (sphere_mode)mode;
    if (!r->format) return FAIL_NONE;
    int format = index_of(r->format, formats, 5);
    if (format < 0) return fail(f, FAIL_USAGE, "--format %s: expected rgba8, rgb8, rgb565, etc1 or etc2", r->format);
    r->spheres.format = format_code[format];
    r->spheres.etc2 = format == 4;
    return FAIL_NONE;
}

static void sphere_figures(json *j, const sphere_asset *s, size_t texel_bytes, size_t file_bytes)
{
    json_text(j, "brdf", s->name);
    json_text(j, "mode", sphere_mode_names[s->mode]);
    json_int(j, "size", s->size);
    json_int(j, "levels", s->levels);
    json_begin(j, "polar", '[');
    for (int i = 0; i < s->layers; i++) json_real(j, NULL, s->polar[i]);
    json_end(j, ']');
    json_int(j, "texel_bytes", (long long)texel_bytes);
    json_int(j, "file_bytes", (long long)file_bytes);
}

static int sphere_run(const bake_request *r, const brdf *b, progress *p, bake_result *out, failure *f)
{
    sphere_options options = r->spheres;
    sphere_asset s;
    options.progress = p;
    int code = sphere_bake(&s, b, &options, f);
    if (code) return code;
    size_t texel_bytes = 0;
    for (int i = 0; i < s.levels; i++) texel_bytes += s.level[i].size;
    sphere_write(&s, &out->file);
    sphere_figures(&out->figures, &s, texel_bytes, out->file.size);
    snprintf(out->shape, sizeof out->shape, "%d images of %d x %d, %d level%s, %zu bytes of texels", s.layers, s.size,
             s.size, s.levels, s.levels == 1 ? "" : "s", texel_bytes);
    sphere_free(&s);
    return FAIL_NONE;
}

/* ---- all kinds ---------------------------------------------------------------------------------- */

static const bake_kind kinds[] = {
    {"table", "half-vector table: a few kilobytes, one or two fetches per light", table_rows, table_check, table_run},
    {"spheres", "sphere images (Mihalik & Durikovic 2015): quarters, whole ones, or as published", sphere_rows,
     sphere_check, sphere_run},
};
enum { KIND_COUNT = sizeof kinds / sizeof *kinds };

const bake_kind *bake_kinds(size_t *count)
{
    *count = KIND_COUNT;
    return kinds;
}

const bake_kind *bake_find(const char *name)
{
    for (int i = 0; i < KIND_COUNT; i++)
        if (!strcmp(name, kinds[i].name)) return &kinds[i];
    return NULL;
}

void bake_kind_names(char *out, size_t size)
{
    size_t used = 0;
    for (int i = 0; i < KIND_COUNT && used < size; i++)
        used += (size_t)snprintf(out + used, size - used, "%s%s", i ? ", " : "", kinds[i].name);
}

int bake_parse(bake_request *out, int argc, char **argv, const option *common, size_t common_count, failure *f)
{
    bake_request r = {.kind = bake_find(argv[0])};
    option rows[BAKE_MAX_OPTIONS + 16];
    char usage[160];
    int operands;
    size_t count = r.kind->options(&r, rows);
    if (common_count) memcpy(rows + count, common, common_count * sizeof *rows);
    snprintf(usage, sizeof usage, "nacre bake %s BRDF -o F.ktx2 [options]", r.kind->name);
    int code = options_parse(argc, argv, usage, rows, count + common_count, &r.brdf, &operands, 1, 1, f);
    if (code || (code = r.kind->check(&r, f))) return code;
    *out = r;
    return FAIL_NONE;
}

int bake_run(const bake_request *r, const brdf *b, const char *path, progress *p, bake_result *out, failure *f)
{
    bake_result result = {0};
    json_begin(&result.figures, NULL, '{');
    json_text(&result.figures, "file", path);
    int code = r->kind->run(r, b, p, &result, f);
    if (code) {
        bake_free(&result);
        return code;
    }
    json_end(&result.figures, '}');
    *out = result;
    return FAIL_NONE;
}

void bake_free(bake_result *r)
{
    bytes_free(&r->file);
    bytes_free(&r->figures.out);
}

const char *bake_input(const char *name)
{
    struct stat status;
    if (!strncmp(name, "merl:", 5)) return name + 5;
    if (!strncmp(name, "rgl:", 4)) return name + 4;
    return stat(name, &status) == 0 ? name : NULL;
}
