/* SPDX-License-Identifier: MIT */
#include "scene.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "ktx2_write.h"
#include "nacre_asset.h"
#include "palette.h"
#include "png_io.h"
#include "sbrdf_map.h"
#include "table_bake.h"

static const char *const role_names[NACRE_ROLE_COUNT] = {"table", "spheres", "normal",  "mask", "albedo",
                                                         "lobes", "power",   "palette", "index"};

static int ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end), i;

    if (n < m) return 0;
    for (i = 0; i < m; i++)
        if (tolower((unsigned char)text[n - m + i]) != end[i]) return 0;
    return 1;
}

static int open_bytes(scene_material *m, nacre_role role, const char *path, failure *f)
{
    nacre_result r = nacre_image_open(&m->image[role], m->file[role].data, m->file[role].size);

    if (r) return fail(f, FAIL_INVALID, "%s: %s, expected a KTX2 file of nacre's profile", path, nacre_result_text(r));
    if (!asset_key_is(&m->image[role], NACRE_KEY_ROLE, role_names[role])) {
        char found[40];
        ktx2_role(&m->image[role], found, sizeof found);
        return fail(f, FAIL_INVALID, "%s: key %s: found \"%s\", expected \"%s\"", path, NACRE_KEY_ROLE, found,
                    role_names[role]);
    }
    m->material.image[role] = &m->image[role];
    return FAIL_NONE;
}

/* The role a file names itself; -1 if none is known. */
static int role_of(const nacre_image *image)
{
    int i;

    for (i = 0; i < NACRE_ROLE_COUNT; i++)
        if (asset_key_is(image, NACRE_KEY_ROLE, role_names[i])) return i;
    return -1;
}

/* Takes the bytes of a file that is a material by itself; path is for messages. */
static int take_file(scene_material *m, bytes *file, const char *path, failure *f)
{
    nacre_image image;
    nacre_result r = nacre_image_open(&image, file->data, file->size);
    int role = r ? -1 : role_of(&image);
    char found[40];

    if (r) return fail(f, FAIL_INVALID, "%s: %s, expected a KTX2 file of nacre's profile", path, nacre_result_text(r));
    if (role != NACRE_ROLE_TABLE && role != NACRE_ROLE_SPHERES) {
        ktx2_role(&image, found, sizeof found);
        return fail(f, FAIL_INVALID, "%s: key %s: found \"%s\", expected \"table\" or \"spheres\" for a material", path,
                    NACRE_KEY_ROLE, found);
    }
    m->file[role] = *file;
    *file = (bytes){0};
    return open_bytes(m, (nacre_role)role, path, f);
}

static int open_file(scene_material *m, const char *path, failure *f)
{
    bytes file = {0};
    int code = file_read(&file, path, f);

    if (code) return code;
    code = take_file(m, &file, path, f);
    bytes_free(&file);
    return code;
}

/* A PNG becomes a file of its role in memory. */
static int open_png(scene_material *m, nacre_role role, const char *path, failure *f)
{
    ktx2_image k = {.format = NACRE_FORMAT_RGBA8, .faces = 1, .levels = 1};
    image_u8 picture;
    int code = png_read(&picture, path, 4, f);

    if (code) return code;
    if (picture.width > NACRE_MAX_TEXELS || picture.height > NACRE_MAX_TEXELS) {
        code = fail(f, FAIL_UNSUPPORTED, "%s: %dx%d texels, expected at most %d a side", path, picture.width,
                    picture.height, NACRE_MAX_TEXELS);
        image_u8_free(&picture);
        return code;
    }
    k.width = picture.width;
    k.height = picture.height;
    bytes_append(&k.level[0], picture.texel, (size_t)picture.width * (size_t)picture.height * 4);
    ktx2_key_text(&k, NACRE_KEY_ROLE, role_names[role]);
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "linear");
    ktx2_write(&k, &m->file[role]);
    ktx2_free(&k);
    image_u8_free(&picture);
    return open_bytes(m, role, path, f);
}

/* Pictures over the surface, next to the reflectance. */
static int is_map(nacre_role role)
{
    return role == NACRE_ROLE_NORMAL || role == NACRE_ROLE_MASK;
}

/* The parts of a material that varies over the surface. */
static int is_part(nacre_role role)
{
    return role == NACRE_ROLE_ALBEDO || role == NACRE_ROLE_LOBES || role == NACRE_ROLE_POWER ||
           role == NACRE_ROLE_PALETTE || role == NACRE_ROLE_INDEX;
}

static int open_role(scene_material *m, nacre_role role, const char *path, failure *f)
{
    int code;

    if (m->material.image[role]) return fail(f, FAIL_USAGE, "--material: role %s is given twice", role_names[role]);
    if (is_map(role) && ends_with(path, ".png")) return open_png(m, role, path, f);
    code = file_read(&m->file[role], path, f);
    return code ? code : open_bytes(m, role, path, f);
}

/* The double renderer's normal map, from the asset. */
static int decode_normal(scene_material *m, const char *path, failure *f)
{
    const nacre_image *image = m->material.image[NACRE_ROLE_NORMAL];
    int channels = image->format == NACRE_FORMAT_RGBA8 ? 4 : image->format == NACRE_FORMAT_RGB8 ? 3 : 0;
    uint32_t size;
    const uint8_t *texels = nacre_image_texels(image, 0, 0, 0, &size);

    if (!channels || !texels)
        return fail(f, FAIL_UNSUPPORTED, "%s: format %d, expected RGB8 or RGBA8 for role normal", path, image->format);
    m->normal_map = image_u8_make(image->width, image->height, channels);
    memcpy(m->normal_map.texel, texels, size);
    return FAIL_NONE;
}

static int role_named(const char *text, size_t length)
{
    int i;

    for (i = 0; i < NACRE_ROLE_COUNT; i++)
        if (strlen(role_names[i]) == length && !memcmp(role_names[i], text, length)) return i;
    return -1;
}

/* Both of two parts, or neither; *given counts them as one. */
static int check_pair(const scene_material *m, nacre_role one, nacre_role other, int *given, failure *f)
{
    const int first = m->material.image[one] != NULL, second = m->material.image[other] != NULL;

    *given += first || second;
    if (first == second) return FAIL_NONE;
    return fail(f, FAIL_USAGE, "--material: %s=FILE is missing beside %s=FILE", role_names[first ? other : one],
                role_names[first ? one : other]);
}

/* A table, or spheres, or both parts of a material that varies over the surface. */
static int check_roles(const scene_material *m, const char *reflectance, failure *f)
{
    int given = reflectance[0] != 0, code = check_pair(m, NACRE_ROLE_ALBEDO, NACRE_ROLE_LOBES, &given, f);

    if (!code) code = check_pair(m, NACRE_ROLE_PALETTE, NACRE_ROLE_INDEX, &given, f);
    if (code || given == 1) return code;
    return fail(f, FAIL_USAGE,
                "--material: found %s, expected one of table=FILE, spheres=FILE, albedo=FILE with lobes=FILE, or "
                "palette=FILE with index=FILE",
                given ? "several" : "none");
}

/* "role=FILE,role=FILE"; reflectance receives the path of the table or the spheres. */
static int open_roles(scene_material *m, const char *text, char *reflectance, size_t size, failure *f)
{
    while (*text) {
        size_t length = strcspn(text, ","), name = strcspn(text, "=");
        char path[1000];
        int role = name < length ? role_named(text, name) : -1, code;
        if (role < 0 || name + 1 == length)
            return fail(f, FAIL_USAGE,
                        "--material: \"%.*s\", expected table=FILE, spheres=FILE, albedo=FILE, lobes=FILE, power=FILE, "
                        "palette=FILE, index=FILE, normal=FILE or mask=FILE",
                        (int)length, text);
        snprintf(path, sizeof path, "%.*s", (int)(length - name - 1), text + name + 1);
        code = open_role(m, (nacre_role)role, path, f);
        if (!code && role == NACRE_ROLE_NORMAL) code = decode_normal(m, path, f);
        if (code) return code;
        if (!is_map((nacre_role)role) && !is_part((nacre_role)role)) {
            if (reflectance[0]) return fail(f, FAIL_USAGE, "--material: a table and spheres, expected one of them");
            snprintf(reflectance, size, "%s", path);
        }
        text += length + (text[length] == ',');
    }
    return check_roles(m, reflectance, f);
}

static int bake(scene_material *m, const char *name, failure *f)
{
    table_asset table = {0};
    brdf *b;
    int code = brdf_open(&b, name, f);

    if (code) return code;
    code = table_bake(&table, b, &(table_options){0}, f);
    brdf_close(b);
    if (code) return code;
    table_write(&table, &m->file[NACRE_ROLE_TABLE]);
    table_free(&table);
    return open_bytes(m, NACRE_ROLE_TABLE, name, f);
}

static void read_albedo(scene_material *m, nacre_role role)
{
    nacre_q16 albedo[3];
    int i;

    if (!m->material.image[role] || !asset_key_q16(m->material.image[role], NACRE_KEY_ALBEDO, albedo, 3)) return;
    for (i = 0; i < 3; i++) m->albedo[i] = albedo[i] / 65536.0;
    m->has_albedo = 1;
}

/* What follows from the images that are there. */
static void settle(scene_material *m)
{
    m->material.model = m->material.image[NACRE_ROLE_SPHERES]   ? NACRE_MODEL_SPHERES
                        : m->material.image[NACRE_ROLE_LOBES]   ? NACRE_MODEL_SBRDF
                        : m->material.image[NACRE_ROLE_PALETTE] ? NACRE_MODEL_PALETTE
                                                                : NACRE_MODEL_TABLE;
    read_albedo(m, NACRE_ROLE_TABLE);
    read_albedo(m, NACRE_ROLE_SPHERES);
    read_albedo(m, NACRE_ROLE_ALBEDO);
    read_albedo(m, NACRE_ROLE_PALETTE);
}

static int has_roles(const char *text)
{
    size_t name = strcspn(text, "=,:/");

    return text[name] == '=';
}

/* Both maps are checked, whatever draws them: the runtime's result codes don't say what is wrong. */
static int open_sbrdf(scene_material *m, int exact, failure *f)
{
    sbrdf_map map;
    int code = sbrdf_map_read(&map, &m->image[NACRE_ROLE_ALBEDO], "albedo=", &m->image[NACRE_ROLE_LOBES], "lobes=", f);

    if (code) return code;
    if (exact)
        m->reflectance = sbrdf_map_brdf(&map);
    else
        sbrdf_map_free(&map);
    return FAIL_NONE;
}

static int open_palette(scene_material *m, failure *f)
{
    palette p;
    int code = palette_read(&p, &m->image[NACRE_ROLE_PALETTE], "palette=", &m->image[NACRE_ROLE_INDEX], "index=", f);

    if (!code) m->reflectance = palette_brdf(&p);
    return code;
}

static int open_any(scene_material *m, const char *text, int exact, failure *f)
{
    char path[1000] = "";
    int code = FAIL_NONE;

    if (has_roles(text)) {
        code = open_roles(m, text, path, sizeof path, f);
        text = path;
    } else if (ends_with(text, ".ktx2")) {
        code = open_file(m, text, f);
    } else if (!exact) {
        code = bake(m, text, f);
    }
    if (code) return code;
    settle(m);
    if (m->material.model == NACRE_MODEL_SBRDF) return open_sbrdf(m, exact, f);
    if (!exact) return FAIL_NONE;
    return m->material.model == NACRE_MODEL_PALETTE ? open_palette(m, f) : brdf_open(&m->reflectance, text, f);
}

int scene_material_open(scene_material *out, const char *text, int exact, failure *f)
{
    int code;

    *out = (scene_material){0};
    code = open_any(out, text, exact, f);
    if (code) scene_material_close(out);
    return code;
}

int scene_material_take(scene_material *out, bytes *file, const char *name, failure *f)
{
    int code, role;

    *out = (scene_material){0};
    code = take_file(out, file, name, f);
    if (!code) {
        settle(out);
        role = out->material.model == NACRE_MODEL_SPHERES ? NACRE_ROLE_SPHERES : NACRE_ROLE_TABLE;
        code = brdf_open_image(&out->reflectance, &out->image[role], name, f);
    }
    if (code) scene_material_close(out);
    return code;
}

void scene_material_close(scene_material *m)
{
    int i;

    brdf_close(m->reflectance);
    image_u8_free(&m->normal_map);
    for (i = 0; i < NACRE_ROLE_COUNT; i++) bytes_free(&m->file[i]);
    *m = (scene_material){0};
}
