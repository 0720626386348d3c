/* SPDX-License-Identifier: MIT */
/* nacre info: what a file holds, in words and numbers, and whether all of it is as it must be. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "brdf.h"
#include "commands.h"
#include "etc1.h"
#include "json.h"
#include "merl.h"
#include "options.h"
#include "palette.h"
#include "rgl.h"
#include "sbrdf_map.h"
#include "sphere_bake.h"
#include "table_bake.h"

/* One file under inspection: words go to text, the same to j. */
typedef struct report {
    const char *path;
    const bytes *file;
    bytes text;
    json *j;
} report;

/* ---- KTX2 assets ---------------------------------------------------------------------------------- */

static const char *format_name(int format)
{
    switch (format) {
    case NACRE_FORMAT_RGB565:
        return "RGB565";
    case NACRE_FORMAT_R8:
        return "R8";
    case NACRE_FORMAT_RG8:
        return "RG8";
    case NACRE_FORMAT_RGB8:
        return "RGB8";
    case NACRE_FORMAT_RGBA8:
        return "RGBA8";
    case NACRE_FORMAT_RGBA16F:
        return "RGBA16F";
    case NACRE_FORMAT_E5BGR9:
        return "E5B9G9R9";
    case NACRE_FORMAT_ETC2_RGB8:
        return "ETC2 RGB8";
    }
    return "?";
}

static const uint8_t identifier[12] = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};

/* A header field the profile limits. */
typedef struct limit {
    int offset;
    const char *name;
    uint32_t low, high;
} limit;

/* Why the runtime refuses the file, as far as the header tells: field, offset, found, expected. */
static int explain(const bytes *file, const char *path, nacre_result result, failure *f)
{
    static const limit limits[] = {
        {20, "pixelWidth", 1, NACRE_MAX_TEXELS},
        {24, "pixelHeight", 1, NACRE_MAX_TEXELS},
        {28, "pixelDepth", 0, 0},
        {32, "layerCount", 0, NACRE_MAX_LAYERS},
        {40, "levelCount", 1, NACRE_MAX_LEVELS},
        {44, "supercompressionScheme", 0, 0},
    };
    const int code = result == NACRE_ERR_UNSUPPORTED ? FAIL_UNSUPPORTED : FAIL_INVALID;
    if (file->size < 80) return fail(f, code, "%s: found %zu bytes, expected a KTX2 header of 80", path, file->size);
    if (memcmp(file->data, identifier, sizeof identifier))
        return fail(f, code, "%s: offset 0: not a KTX2 identifier", path);
    const uint32_t format = asset_u32le(file->data + 12);
    if (!asset_format_find(format))
        return fail(f, code, "%s: offset 12: found vkFormat %" PRIu32 ", expected one of 4 9 16 23 37 97 123 147", path,
                    format);
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        const limit *l = &limits[i];
        const uint32_t value = asset_u32le(file->data + l->offset);
        if (value < l->low || value > l->high)
            return fail(f, code, "%s: offset %d: found %s %" PRIu32 ", expected %" PRIu32 "..%" PRIu32, path, l->offset,
                        l->name, value, l->low, l->high);
    }
    const uint32_t levels = asset_u32le(file->data + 40);
    const uint64_t end = file->size >= 80 + 24 * (uint64_t)levels
                             ? asset_u32le(file->data + 80) + (uint64_t)asset_u32le(file->data + 88)
                             : 80 + 24 * (uint64_t)levels;
    if (end > file->size)
        return fail(f, code, "%s: truncated: found %zu bytes, expected %" PRIu64, path, file->size, end);
    if (result == NACRE_ERR_UNSUPPORTED)
        return fail(f, code, "%s: key %s: expected %d", path, NACRE_KEY_VERSION, NACRE_ASSET_VERSION);
    return fail(f, code,
                "%s: found %zu bytes whose header, level index and keys disagree, expected a file as in "
                "nacre_asset.h",
                path, file->size);
}

typedef enum key_kind { KEY_TEXT, KEY_U32, KEY_BAM, KEY_Q16, KEY_OTHER } key_kind;

static key_kind kind_of(const char *name)
{
    static const struct {
        const char *name;
        key_kind kind;
    } kinds[] = {
        {"KTXorientation", KEY_TEXT}, {"KTXwriter", KEY_TEXT},          {NACRE_KEY_VERSION, KEY_U32},
        {NACRE_KEY_ROLE, KEY_TEXT},   {NACRE_KEY_NAME, KEY_TEXT},       {NACRE_KEY_TRANSFER, KEY_TEXT},
        {NACRE_KEY_ETC1, KEY_U32},    {NACRE_KEY_QUARTERS, KEY_U32},    {NACRE_KEY_ALBEDO, KEY_Q16},
        {NACRE_KEY_TABLE, KEY_Q16},   {NACRE_KEY_LIGHT_POLAR, KEY_BAM}, {NACRE_KEY_COSINE, KEY_U32},
        {NACRE_KEY_SCALE, KEY_Q16},   {NACRE_KEY_DISC, KEY_Q16},        {NACRE_KEY_MOST, KEY_Q16},
        {NACRE_KEY_LOBES, KEY_U32},   {NACRE_KEY_SHAPE, KEY_Q16},       {NACRE_KEY_DIRECTION, KEY_U32},
        {NACRE_KEY_TILES, KEY_U32},   {NACRE_KEY_BLEND, KEY_U32},       {NACRE_KEY_TOE, KEY_U32},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (!strcmp(kinds[i].name, name)) return kinds[i].kind;
    return KEY_OTHER;
}

static double real_of(key_kind kind, uint32_t raw)
{
    if (kind == KEY_BAM) return raw * 360.0 / 65536;
    if (kind == KEY_Q16) return (int32_t)raw / 65536.0;
    return raw;
}

static void report_numbers(report *r, const char *name, key_kind kind, const uint8_t *value, uint32_t size)
{
    json_begin(r->j, name, '[');
    for (uint32_t i = 0; i + 4 <= size; i += 4) {
        const uint32_t raw = asset_u32le(value + i);
        const double real = real_of(kind, raw);
        json_real(r->j, NULL, real);
        bytes_printf(&r->text, " %.7g", real);
        if (kind == KEY_BAM) bytes_printf(&r->text, " deg (%" PRIu32 ")", raw);
        if (kind == KEY_Q16) bytes_printf(&r->text, " (%" PRId32 ")", (int32_t)raw);
    }
    json_end(r->j, ']');
}

/* Text up to its NUL, other bytes than printable ASCII as dots. */
static void printable(const uint8_t *value, uint32_t size, char *out, size_t capacity)
{
    size_t n = 0;
    for (uint32_t i = 0; i < size && value[i] && n + 1 < capacity; i++)
        out[n++] = value[i] >= 32 && value[i] < 127 ? (char)value[i] : '.';
    out[n] = 0;
}

/* nacre_image_open has checked the entries. */
static void report_keys(report *r, const nacre_image *image)
{
    json_begin(r->j, "keys", '{');
    for (uint32_t at = 0; at < image->kv_size;) {
        const uint8_t *entry = image->bytes + image->kv_offset + at;
        const uint32_t length = asset_u32le(entry);
        char name[100], text[300];
        printable(entry + 4, length, name, sizeof name);
        const uint32_t name_size = (uint32_t)strlen((const char *)entry + 4) + 1;
        const uint8_t *value = entry + 4 + name_size;
        const uint32_t size = length - name_size;
        key_kind kind = kind_of(name);
        if (kind != KEY_TEXT && kind != KEY_OTHER && size % 4) kind = KEY_OTHER;
        bytes_printf(&r->text, "  key %-20s", name);
        if (kind == KEY_TEXT) {
            printable(value, size, text, sizeof text);
            bytes_printf(&r->text, " \"%s\"", text);
            json_text(r->j, name, text);
        } else if (kind == KEY_OTHER) {
            bytes_printf(&r->text, " %" PRIu32 " bytes:", size);
            for (uint32_t i = 0; i < size && i < 32; i++) bytes_printf(&r->text, " %02x", value[i]);
            if (size > 32) bytes_printf(&r->text, " ...");
            json_int(r->j, name, size);
        } else {
            report_numbers(r, name, kind, value, size);
        }
        bytes_printf(&r->text, "\n");
        at += 4 + (length + 3) / 4 * 4;
    }
    json_end(r->j, '}');
}

static void report_header(report *r, const nacre_image *image)
{
    const uint32_t dfd = 80 + 24u * image->levels;
    const int transfer = asset_u32le(image->bytes + dfd) >= 16 ? image->bytes[dfd + 14] : 0;
    const char *curve = transfer == 1 ? "linear" : transfer == 2 ? "sRGB" : "other";
    bytes_printf(&r->text,
                 "  KTX2, %s (vkFormat %d), %d x %d, %d layer%s, %d face%s, %d level%s, transfer %s, %" PRIu32
                 " bytes\n",
                 format_name(image->format), image->format, image->width, image->height, image->layers,
                 image->layers == 1 ? "" : "s", image->faces, image->faces == 1 ? "" : "s", image->levels,
                 image->levels == 1 ? "" : "s", curve, image->size);
    json_text(r->j, "container", "KTX2");
    json_text(r->j, "format", format_name(image->format));
    json_int(r->j, "vk_format", image->format);
    json_int(r->j, "width", image->width);
    json_int(r->j, "height", image->height);
    json_int(r->j, "layers", image->layers);
    json_int(r->j, "faces", image->faces);
    json_text(r->j, "transfer", curve);
    json_int(r->j, "file_bytes", image->size);
}

static void report_levels(report *r, const nacre_image *image)
{
    uint64_t total = 0;
    json_begin(r->j, "levels", '[');
    for (unsigned i = 0; i < image->levels; i++) {
        uint32_t part = 0;
        nacre_image_texels(image, i, 0, 0, &part);
        const uint32_t size = part * image->layers * image->faces;
        const int width = image->width >> i ? image->width >> i : 1;
        const int height = image->height >> i ? image->height >> i : 1;
        total += size;
        bytes_printf(&r->text, "  level %u: %d x %d, %" PRIu32 " bytes at %" PRIu32 "\n", i, width, height, size,
                     image->level_offset[i]);
        json_begin(r->j, NULL, '{');
        json_int(r->j, "width", width);
        json_int(r->j, "height", height);
        json_int(r->j, "bytes", size);
        json_int(r->j, "offset", image->level_offset[i]);
        json_end(r->j, '}');
    }
    json_end(r->j, ']');
    json_int(r->j, "texel_bytes", (long long)total);
    bytes_printf(&r->text, "  texels: %" PRIu64 " bytes, all else %" PRIu64 "\n", total, image->size - total);
}

/* Every block of an image that claims to be ETC1. */
static int check_etc1(report *r, const nacre_image *image, failure *f)
{
    uint32_t claim = 0;
    long blocks = 0;
    asset_key_u32(image, NACRE_KEY_ETC1, &claim, 1);
    if (image->format != NACRE_FORMAT_ETC2_RGB8) return FAIL_NONE;
    for (unsigned level = 0; level < image->levels; level++)
        for (unsigned part = 0; part < (unsigned)image->layers * image->faces; part++) {
            uint32_t size = 0;
            const uint8_t *texels = nacre_image_texels(image, level, part / image->faces, part % image->faces, &size);
            for (uint32_t i = 0; i < size; i += 8, blocks++) {
                if (etc1_block_valid(texels + i)) continue;
                if (!claim) {
                    bytes_printf(&r->text, "  check: uses modes of ETC2: needs GLES 3\n");
                    json_bool(r->j, "etc1_only", 0);
                    return FAIL_NONE;
                }
                return fail(f, FAIL_INVALID,
                            "%s: offset %td: found a block in a mode of ETC2, expected ETC1 as key %s says", r->path,
                            texels + i - image->bytes, NACRE_KEY_ETC1);
            }
        }
    bytes_printf(&r->text, "  check: all %ld blocks are ETC1\n", blocks);
    json_bool(r->j, "etc1_only", 1);
    return FAIL_NONE;
}

static void say(report *r, const char *sentence)
{
    bytes_printf(&r->text, "  %s\n", sentence);
    json_text(r->j, "what", sentence);
}

static int report_table(report *r, const nacre_image *image, failure *f)
{
    table_asset t = {0};
    char sentence[600];
    const int code = table_read(&t, image, r->path, f);
    if (code) return code;
    const char *tier = t.layers == 2                ? t.layout == TABLE_TWO_LAYERS_EARLY
                                                          ? "fine tier, early layout (two fetches per light)"
                                                          : "fine tier (two fetches per light)"
                       : t.w[0] || t.w[1] || t.w[2] ? "default tier (one fetch per light, with the phi_d term)"
                                                    : "RGB tier (one fetch per light, without the phi_d term)";
    snprintf(sentence, sizeof sentence, "half-vector table of %s: %s, p = %.4g (for %s output%s)",
             t.name[0] ? t.name : "an unnamed BRDF", tier, t.p, fabs(t.p - 4) < 0.01 ? "square-root" : "sRGB",
             t.toe ? " with the curve's linear toe" : "");
    say(r, sentence);
    bytes_printf(&r->text, "  check: scales, powers and size are in range\n");
    table_free(&t);
    return FAIL_NONE;
}

static int report_spheres(report *r, const nacre_image *image, failure *f)
{
    static const char *const modes[] = {[SPHERE_QUARTER] = "cosine-free, quarters about the half vector",
                                        [SPHERE_COSINE_FREE] = "cosine-free",
                                        [SPHERE_PAPER] = "with the cosine (paper mode)"};
    sphere_asset s = {0};
    char angles[400] = "", sentence[900];
    size_t n = 0;
    const int code = sphere_read(&s, image, r->path, f);
    if (code) return code;
    for (int i = 0; i < s.layers && n < sizeof angles - 16; i++)
        n += (size_t)snprintf(angles + n, sizeof angles - n, "%s%.4g", i ? ", " : "", s.polar[i]);
    snprintf(sentence, sizeof sentence, "sphere images of %s, lit from %s degrees, %s%s",
             s.name[0] ? s.name : "an unnamed BRDF", angles, modes[s.mode],
             s.mode == SPHERE_QUARTER ? ""
             : s.disc < 1             ? ", padded beyond the rim"
                                      : ", not padded");
    say(r, sentence);
    bytes_printf(&r->text, "  check: light angles rise, scales and disc are in range\n");
    sphere_free(&s);
    return FAIL_NONE;
}

static int report_albedo(report *r, const nacre_image *image, failure *f)
{
    double most;
    char sentence[200];
    const int code = sbrdf_check_albedo(image, r->path, &most, f);
    if (code) return code;
    snprintf(sentence, sizeof sentence,
             "diffuse albedo up to %.4g and opacity, for a material that varies over the surface", most);
    say(r, sentence);
    return FAIL_NONE;
}

static int report_lobes(report *r, const nacre_image *image, failure *f)
{
    sbrdf_map m;
    char sentence[300];
    const int code = sbrdf_check_lobes(image, r->path, &m, f);
    if (code) return code;
    int n = snprintf(sentence, sizeof sentence, "%d Lafortune lobe%s a texel%s, pi f_r up to", m.lobes,
                     m.lobes == 1 ? "" : "s", m.has_direction ? " with a direction" : "");
    for (int j = 0; j < m.lobes; j++)
        n += snprintf(sentence + n, sizeof sentence - (size_t)n, "%s %.4g", j ? "," : "", m.most[j]);
    say(r, sentence);
    bytes_printf(&r->text, "  check: lobes, layers and ranges agree\n");
    return FAIL_NONE;
}

static int report_power(report *r, const nacre_image *image, failure *f)
{
    if (image->format != NACRE_FORMAT_R8 && image->format != NACRE_FORMAT_RG8)
        return fail(f, FAIL_INVALID, "%s: found a power table in %s, expected R8 or RG8", r->path,
                    format_name(image->format));
    say(r, image->format == NACRE_FORMAT_R8 ? "x^n in 8 bits" : "x^n in 16 bits");
    return FAIL_NONE;
}

static int report_palette(report *r, const nacre_image *image, failure *f)
{
    uint32_t counts[4];
    char sentence[200];
    const int code = palette_check_tables(image, r->path, counts, f);
    if (code) return code;
    snprintf(sentence, sizeof sentence, "palette of %u half-vector tables of %u x %u, in %u column%s of tiles",
             counts[0], counts[2], counts[3], counts[1], counts[1] == 1 ? "" : "s");
    say(r, sentence);
    bytes_printf(&r->text, "  check: tiles fill the image\n");
    return FAIL_NONE;
}

static int report_index(report *r, const nacre_image *image, failure *f)
{
    int blend, most;
    char sentence[200];
    const int code = palette_check_index(image, r->path, &blend, &most, f);
    if (code) return code;
    snprintf(sentence, sizeof sentence, "which table of a palette a texel is of, up to number %d, %s", most,
             blend ? "blended between four texels" : "nearest texel");
    say(r, sentence);
    return FAIL_NONE;
}

static int report_role(report *r, const nacre_image *image, failure *f)
{
    uint32_t size = 0;
    const uint8_t *role = nacre_image_key(image, NACRE_KEY_ROLE, &size);
    if (asset_key_is(image, NACRE_KEY_ROLE, "table")) return report_table(r, image, f);
    if (asset_key_is(image, NACRE_KEY_ROLE, "spheres")) return report_spheres(r, image, f);
    if (asset_key_is(image, NACRE_KEY_ROLE, "normal")) {
        say(r, "tangent-space normals, usable with any model");
        if (image->format == NACRE_FORMAT_RGB8 || image->format == NACRE_FORMAT_RGBA8) return FAIL_NONE;
        return fail(f, FAIL_INVALID, "%s: found normals in %s, expected RGB8 or RGBA8", r->path,
                    format_name(image->format));
    }
    if (asset_key_is(image, NACRE_KEY_ROLE, "mask")) {
        say(r, "a mask between two lit spheres, and alpha, usable with any model");
        if (image->format == NACRE_FORMAT_R8 || image->format == NACRE_FORMAT_RG8 ||
            image->format == NACRE_FORMAT_RGB8 || image->format == NACRE_FORMAT_RGBA8)
            return FAIL_NONE;
        return fail(f, FAIL_INVALID, "%s: found a mask in %s, expected R8, RG8, RGB8 or RGBA8", r->path,
                    format_name(image->format));
    }
    if (asset_key_is(image, NACRE_KEY_ROLE, "albedo")) return report_albedo(r, image, f);
    if (asset_key_is(image, NACRE_KEY_ROLE, "lobes")) return report_lobes(r, image, f);
    if (asset_key_is(image, NACRE_KEY_ROLE, "power")) return report_power(r, image, f);
    if (asset_key_is(image, NACRE_KEY_ROLE, "palette")) return report_palette(r, image, f);
    if (asset_key_is(image, NACRE_KEY_ROLE, "index")) return report_index(r, image, f);
    if (role) {
        char text[100];
        printable(role, size, text, sizeof text);
        return fail(
            f, FAIL_INVALID,
            "%s: key %s: found \"%s\", expected \"table\", \"spheres\", \"normal\", \"mask\", \"albedo\", \"lobes\", "
            "\"power\", \"palette\" or \"index\"",
            r->path, NACRE_KEY_ROLE, text);
    }
    say(r, image->faces == 6 ? "a cube map without a role" : "an image without a role");
    return FAIL_NONE;
}

static int report_asset(report *r, failure *f)
{
    nacre_image image;
    const nacre_result result = nacre_image_open(&image, r->file->data, r->file->size);
    if (result) return explain(r->file, r->path, result, f);
    report_header(r, &image);
    report_levels(r, &image);
    report_keys(r, &image);
    const int code = report_role(r, &image, f);
    return code ? code : check_etc1(r, &image, f);
}

/* ---- measured files ------------------------------------------------------------------------------- */

static double double_at(const uint8_t *p)
{
    uint64_t bits = asset_u32le(p) | (uint64_t)asset_u32le(p + 4) << 32;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int report_merl(report *r, failure *f)
{
    /* the database's channel scales: Matusik et al. 2003, BRDFRead */
    static const double scale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};
    brdf *b = NULL;
    const int code = merl_open(&b, r->path, f);
    if (code) return code;
    brdf_close(b);
    const uint8_t *data = r->file->data;
    const uint32_t n[3] = {asset_u32le(data), asset_u32le(data + 4), asset_u32le(data + 8)};
    const size_t count = (size_t)n[0] * n[1] * n[2];
    bytes_printf(&r->text,
                 "  MERL table: %" PRIu32 " theta_half x %" PRIu32 " theta_diff x %" PRIu32 " phi_diff, %zu bytes\n",
                 n[0], n[1], n[2], r->file->size);
    json_text(r->j, "container", "MERL");
    json_begin(r->j, "sizes", '[');
    for (int i = 0; i < 3; i++) json_int(r->j, NULL, n[i]);
    json_end(r->j, ']');
    json_begin(r->j, "channels", '[');
    for (size_t c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        size_t invalid = 0;
        for (size_t i = 0; i < count; i++) {
            const double value = double_at(data + 12 + 8 * (c * count + i)) * scale[c];
            if (value < 0) {
                invalid++;
                continue;
            }
            low = fmin(low, value);
            high = fmax(high, value);
        }
        bytes_printf(&r->text, "  %c: f_r %.6g..%.6g 1/sr, %zu of %zu entries hold no measurement\n", "RGB"[c], low,
                     high, invalid, count);
        json_begin(r->j, NULL, '{');
        json_real(r->j, "low", low);
        json_real(r->j, "high", high);
        json_int(r->j, "invalid", (long long)invalid);
        json_end(r->j, '}');
    }
    json_end(r->j, ']');
    return FAIL_NONE;
}

static int type_bytes(int type)
{
    static const int size[12] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
    return type >= 0 && type < 12 ? size[type] : 0;
}

static void report_float_range(report *r, uint64_t offset, uint64_t count)
{
    double low = INFINITY, high = -INFINITY;
    for (uint64_t i = 0; i < count; i++) {
        const uint32_t bits = asset_u32le(r->file->data + offset + 4 * i);
        float value;
        memcpy(&value, &bits, sizeof value);
        low = fmin(low, value);
        high = fmax(high, value);
    }
    if (count) bytes_printf(&r->text, ", %.6g..%.6g", low, high);
    json_real(r->j, "low", low);
    json_real(r->j, "high", high);
}

/* One field of a tensor file at *at: u16 name length, name, u16 dimensions, u8 type, u64 offset, u64 sizes. */
static int report_field(report *r, size_t *at, failure *f)
{
    const bytes *file = r->file;
    char name[100] = "", shape[200] = "";
    size_t n = 0, begin = *at;
    if (file->size - *at < 2) return fail(f, FAIL_INVALID, "%s: offset %zu: truncated field", r->path, begin);
    const size_t name_size = asset_u16le(file->data + *at);
    if (file->size - *at < 2 + name_size + 11)
        return fail(f, FAIL_INVALID, "%s: offset %zu: truncated field", r->path, begin);
    printable(file->data + *at + 2, (uint32_t)name_size, name, sizeof name);
    *at += 2 + name_size;
    const size_t dimensions = asset_u16le(file->data + *at);
    const int type = file->data[*at + 2];
    const uint64_t offset = asset_u32le(file->data + *at + 3) | (uint64_t)asset_u32le(file->data + *at + 7) << 32;
    *at += 11;
    if ((file->size - *at) / 8 < dimensions)
        return fail(f, FAIL_INVALID, "%s: offset %zu: truncated field", r->path, begin);
    uint64_t count = 1;
    for (size_t i = 0; i < dimensions; i++, *at += 8) {
        const uint64_t side = asset_u32le(file->data + *at) | (uint64_t)asset_u32le(file->data + *at + 4) << 32;
        count = side && count > file->size / side ? UINT64_MAX : count * side;
        if (n < sizeof shape - 24)
            n += (size_t)snprintf(shape + n, sizeof shape - n, "%s%" PRIu64, i ? " x " : "", side);
    }
    const uint64_t size = (uint64_t)type_bytes(type);
    if (!size || offset > file->size || count > (file->size - offset) / size)
        return fail(f, FAIL_INVALID,
                    "%s: field %s: found type %d, %s values at %" PRIu64 ", beyond the %zu bytes of the file", r->path,
                    name, type, shape, offset, file->size);
    bytes_printf(&r->text, "  field %-14s %s", name, shape);
    json_begin(r->j, NULL, '{');
    json_text(r->j, "name", name);
    json_text(r->j, "shape", shape);
    if (type == 10) report_float_range(r, offset, count);
    json_end(r->j, '}');
    bytes_printf(&r->text, "\n");
    return FAIL_NONE;
}

static int report_rgl(report *r, failure *f)
{
    const bytes *file = r->file;
    size_t at = 18;
    if (file->size < at)
        return fail(f, FAIL_INVALID, "%s: found %zu bytes, expected a header of 18", r->path, file->size);
    const uint32_t fields = asset_u32le(file->data + 14);
    bytes_printf(&r->text, "  RGL tensor file %d.%d, %" PRIu32 " fields, %zu bytes\n", file->data[12], file->data[13],
                 fields, file->size);
    json_text(r->j, "container", "RGL");
    json_begin(r->j, "fields", '[');
    for (uint32_t i = 0; i < fields; i++) {
        const int code = report_field(r, &at, f);
        if (code) return code;
    }
    json_end(r->j, ']');
    brdf *b = NULL;
    failure why = {0};
    const int code = rgl_open(&b, r->path, &why);
    if (code == FAIL_UNSUPPORTED) {
        say(r, "a BRDF this program does not evaluate");
        bytes_printf(&r->text, "  note: %s\n", why.text);
        return FAIL_NONE;
    }
    if (code) return fail(f, code, "%s", why.text);
    say(r, b->description);
    brdf_close(b);
    return FAIL_NONE;
}

/* ---- the command ------------------------------------------------------------------------------------ */

static int ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text), m = strlen(end);
    return n >= m && !strcmp(text + n - m, end);
}

/* Three sizes, and three planes of doubles that fill the rest. */
static int fits_merl(const bytes *file)
{
    uint64_t count = 1;
    if (file->size < 12) return 0;
    for (int i = 0; i < 3; i++) {
        const uint32_t side = asset_u32le(file->data + 4 * i);
        if (side > 1000) return 0;
        count *= side;
    }
    return count && file->size - 12 == 24 * count;
}

static int report_file(report *r, failure *f)
{
    const bytes *file = r->file;
    if (file->size >= 12 && !memcmp(file->data, identifier, 12)) return report_asset(r, f);
    if (file->size >= 12 && !memcmp(file->data, "tensor_file", 12)) return report_rgl(r, f);
    if (ends_with(r->path, ".binary")) return report_merl(r, f);
    if (ends_with(r->path, ".ktx2")) return report_asset(r, f);
    if (fits_merl(file)) return report_merl(r, f);
    return fail(f, FAIL_INVALID,
                "%s: offset 0: found neither a KTX2 identifier nor a tensor_file nor MERL sizes that fit "
                "%zu bytes",
                r->path, file->size);
}

static int inspect(const char *path, json *j, int quiet, failure *f)
{
    bytes file = {0};
    int code = file_read(&file, path, f);
    if (code) return code;
    report r = {path, &file, {0}, j};
    json_begin(j, NULL, '{');
    json_text(j, "file", path);
    code = report_file(&r, f);
    json_end(j, '}');
    /* what could be read is of use also when a check fails */
    if (r.text.size && !quiet) printf("%s:\n%.*s", path, (int)r.text.size, (const char *)r.text.data);
    bytes_free(&r.text);
    bytes_free(&file);
    return code;
}

static void list_brdfs(json *j, int quiet)
{
    size_t count;
    const char *const *names = brdf_names(&count);
    json_begin(j, "brdfs", '[');
    for (size_t i = 0; i < count; i++) {
        json_text(j, NULL, names[i]);
        if (!quiet) printf("%s\n", names[i]);
    }
    json_end(j, ']');
}

int cmd_info(int argc, char **argv, failure *f)
{
    const char *json_path = NULL, *paths[64];
    int brdfs = 0, count = 0;
    const option table[] = {
        {"--json", OPTION_TEXT, &json_path, 0, 0, "FILE",
         "the same as JSON (- for standard output, instead of the text)"},
        {"--brdfs", OPTION_FLAG, &brdfs, 0, 0, NULL, "list the names of the built-in BRDFs"},
    };
    int code = options_parse(argc, argv, "nacre info FILE... [options]", table, sizeof table / sizeof table[0], paths,
                             &count, 0, 64, f);
    if (code) return code;
    if (!count && !brdfs) return fail(f, FAIL_USAGE, "expected a FILE or --brdfs");
    const int quiet = json_path && !strcmp(json_path, "-"); /* nothing but JSON there */
    json j = {0};
    json_begin(&j, NULL, '{');
    if (brdfs) list_brdfs(&j, quiet);
    json_begin(&j, "files", '[');
    for (int i = 0; i < count && !code; i++) code = inspect(paths[i], &j, quiet, f);
    json_end(&j, ']');
    json_end(&j, '}');
    if (!code && json_path) return json_write(&j, json_path, f);
    bytes_free(&j.out);
    return code;
}
