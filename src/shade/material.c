/* SPDX-License-Identifier: MIT */
/* What the files of a material say, checked and decoded. */
#include "shade.h"

#include <string.h>

#include "asset.h"

/* 1 when the file has no such key, or this text is its value. */
static int says(const nacre_image *image, const char *key, const char *text)
{
    return !nacre_image_key(image, key, NULL) || asset_key_is(image, key, text);
}

static int is_near(int32_t q16, int32_t wanted_q16)
{
    return q16 > wanted_q16 - 256 && q16 < wanted_q16 + 256;
}

/* The numbers of NACRE_KEY_TABLE; those a layout does not have stay as they are. 0: none of its counts. */
static int table_numbers(int32_t v[17], shade_material *out, const nacre_image *image)
{
    out->fine = SHADE_HAS_FINE && image->layers == 2;
    if (asset_key_q16(image, NACRE_KEY_TABLE, v, out->fine ? 17 : 10)) return 1;
    out->early = out->fine;
    return asset_key_q16(image, NACRE_KEY_TABLE, v, 9);
}

static int in_range(const int32_t *v, int count, int32_t low, int32_t high)
{
    int i;

    for (i = 0; i < count; i++)
        if (v[i] < low || v[i] > high) return 0;
    return 1;
}

/* Into *t, all but the size; 0: out of range. */
static int take_numbers(shade_table *t, const int32_t v[17])
{
    int i;

    t->e = v[0];
    t->ymax = v[1];
    for (i = 0; i < 3; i++) t->w[i] = v[2 + i];
    t->p = v[5];
    t->eps = v[6];
    t->k1 = v[7];
    t->k2 = v[8];
    t->rows = v[9];
    for (i = 0; i < 3; i++) {
        t->d[i] = v[10 + i];
        t->v[i] = v[13 + i];
    }
    t->k4 = v[16];
    return t->e > 0 && t->ymax > 0 && t->eps > 0 && t->eps <= NACRE_Q16_ONE &&
           in_range(&t->rows, 1, -NACRE_Q16_ONE, NACRE_Q16_ONE) && in_range(t->d, 3, 0, 13 * NACRE_Q16_ONE / 2) &&
           in_range(t->v, 3, -64 * NACRE_Q16_ONE, 64 * NACRE_Q16_ONE) && in_range(&t->k4, 1, 0, 64 * NACRE_Q16_ONE);
}

static nacre_result read_table(shade_material *out, const nacre_image *image)
{
    shade_table *t = &out->is.table;
    int32_t v[17] = {0};
    uint32_t toe;
    v[9] = 19661; /* 0.3 */
    if (image->format != NACRE_FORMAT_RGBA8 || image->layers > 2 || image->width < 2 || image->height < 2)
        return NACRE_ERR_ASSET;
    if (!SHADE_HAS_FINE && image->layers > 1) return NACRE_ERR_UNSUPPORTED;
    if (!says(image, NACRE_KEY_ROLE, "table") || !table_numbers(v, out, image) || !take_numbers(t, v))
        return NACRE_ERR_ASSET;
    if (!asset_key_u32(image, NACRE_KEY_TOE, &toe, 1)) toe = 0;
    if (toe > 1) return NACRE_ERR_ASSET;
    t->toe = (uint8_t)toe;
    t->width = t->image_width = image->width;
    t->height = t->image_height = image->height;
    return is_near(t->p, 4 * NACRE_Q16_ONE) || is_near(t->p, 314573) ? NACRE_OK : NACRE_ERR_ASSET; /* 4 or 4.8 */
}

/* Every code of every level names a table. */
static int codes_are_below(const nacre_image *image, unsigned count)
{
    unsigned level;
    uint32_t size, i;

    for (level = 0; level < image->levels; level++) {
        const uint8_t *const texels = nacre_image_texels(image, level, 0, 0, &size);

        for (i = 0; i < size; i++)
            if (texels[i] >= count) return 0;
    }
    return 1;
}

static nacre_result read_index(shade_palette *p, const nacre_image *image)
{
    uint32_t blend;

    if (image->faces != 1 || image->layers != 1 || image->format != NACRE_FORMAT_R8 ||
        !asset_key_is(image, NACRE_KEY_ROLE, "index"))
        return NACRE_ERR_ASSET;
    if (!asset_key_u32(image, NACRE_KEY_BLEND, &blend, 1)) blend = 0;
    p->blend = (uint8_t)blend;
    p->width = image->width;
    p->height = image->height;
    return blend <= 1 && codes_are_below(image, p->count) ? NACRE_OK : NACRE_ERR_ASSET;
}

static nacre_result read_palette(shade_material *out, const nacre_material *material)
{
    const nacre_image *const image = material->image[NACRE_ROLE_PALETTE];
    shade_table *const t = &out->is.table;
    shade_palette *const p = &out->palette;
    uint32_t tiles[4];
    int32_t v[17] = {0};
    int i;

    if (image->format != NACRE_FORMAT_RGBA8 || image->layers != 1 || image->levels != 1 ||
        !asset_key_is(image, NACRE_KEY_ROLE, "palette") || !says(image, NACRE_KEY_TRANSFER, "root") ||
        !asset_key_q16(image, NACRE_KEY_TABLE, v, 10) || !asset_key_u32(image, NACRE_KEY_TILES, tiles, 4))
        return NACRE_ERR_ASSET;
    if (!take_numbers(t, v) || !is_near(t->p, 4 * NACRE_Q16_ONE)) return NACRE_ERR_ASSET;
    if (tiles[0] < 1 || tiles[0] > NACRE_MAX_PALETTE || tiles[1] < 1 || tiles[1] > 16 || (tiles[1] & (tiles[1] - 1)))
        return NACRE_ERR_ASSET;
    for (i = 2; i < 4; i++)
        if (tiles[i] < 4 || tiles[i] > 128) return NACRE_ERR_ASSET;
    p->count = (uint16_t)tiles[0];
    p->columns = (uint8_t)tiles[1];
    p->rows = (uint16_t)((tiles[0] + tiles[1] - 1) / tiles[1]);
    t->width = (uint16_t)tiles[2];
    t->height = (uint16_t)tiles[3];
    t->image_width = image->width;
    t->image_height = image->height;
    t->image_guard = 1;
    if (image->width != p->columns * (t->width + 2u) || image->height != p->rows * (t->height + 4u))
        return NACRE_ERR_ASSET;
    for (i = 0; i < 3; i++) out->albedo[i] = NACRE_Q16_ONE;
    return read_index(p, material->image[NACRE_ROLE_INDEX]);
}

int shade_is_quartered(const nacre_image *image)
{
    uint32_t yes;
    return asset_key_u32(image, NACRE_KEY_QUARTERS, &yes, 1) && yes;
}

/* What differs from whole spheres. */
static nacre_result read_quarters(shade_spheres *s, const nacre_image *image)
{
    uint32_t yes;
    if (!asset_key_u32(image, NACRE_KEY_QUARTERS, &yes, 1) || yes != 1 || s->cosine || s->layers < 2 ||
        s->layers > SHADE_MAX_QUARTERS || image->width != image->height || image->width < 2 || image->levels != 1)
        return NACRE_ERR_ASSET;
    if (image->format == NACRE_FORMAT_ETC2_RGB8 && image->width % 4) return NACRE_ERR_ASSET; /* a block in two images */
    s->size = image->width;
    return says(image, NACRE_KEY_TRANSFER, "root4-lh") ? NACRE_OK : NACRE_ERR_ASSET;
}

static nacre_result read_spheres(shade_material *out, const nacre_image *image)
{
    shade_spheres *s = &out->is.spheres;
    uint32_t polar[NACRE_MAX_LAYERS], cosine;
    unsigned i;
    const int colour = image->format == NACRE_FORMAT_RGBA8 || image->format == NACRE_FORMAT_RGB8 ||
                       image->format == NACRE_FORMAT_RGB565 || image->format == NACRE_FORMAT_ETC2_RGB8 ||
                       image->format == NACRE_FORMAT_R8;
    if (!colour || image->layers < 1 || image->layers > NACRE_MAX_LAYERS) return NACRE_ERR_ASSET;
    if (!says(image, NACRE_KEY_ROLE, "spheres") || !asset_key_u32(image, NACRE_KEY_LIGHT_POLAR, polar, image->layers) ||
        !asset_key_u32(image, NACRE_KEY_COSINE, &cosine, 1) || !asset_key_q16(image, NACRE_KEY_SCALE, s->scale, 3))
        return NACRE_ERR_ASSET;
    if (!asset_key_q16(image, NACRE_KEY_DISC, &s->disc, 1)) s->disc = NACRE_Q16_ONE; /* not padded */
    for (i = 0; i < image->layers; i++) {
        if (polar[i] >= FX_BAM_HALF || (i && polar[i] <= polar[i - 1])) return NACRE_ERR_ASSET;
        s->polar_bam[i] = (uint16_t)polar[i];
    }
    for (i = 0; i < 3; i++)
        if (s->scale[i] <= 0) return NACRE_ERR_ASSET;
    s->layers = (uint8_t)image->layers;
    s->cosine = (uint8_t)cosine;
    if (shade_is_quartered(image)) return read_quarters(s, image);
    if (cosine > 1 || s->disc < NACRE_Q16_ONE / 2 || s->disc > NACRE_Q16_ONE) return NACRE_ERR_ASSET;
    return says(image, NACRE_KEY_TRANSFER, cosine ? "srgb" : "root4") ? NACRE_OK : NACRE_ERR_ASSET;
}

static int is_map(const nacre_image *image, const char *role)
{
    return image->faces == 1 && image->format == NACRE_FORMAT_RGBA8 && asset_key_is(image, NACRE_KEY_ROLE, role) &&
           says(image, NACRE_KEY_TRANSFER, "linear");
}

/* Mean diffuse albedo over the smallest level, at most 64 x 64 of its texels. */
static void mean_albedo(const nacre_image *image, nacre_q16 most, nacre_q16 out[3])
{
    const unsigned level = image->levels - 1u;
    const unsigned width = image->width >> level ? image->width >> level : 1;
    const unsigned height = image->height >> level ? image->height >> level : 1;
    const unsigned columns = width < 64 ? width : 64, rows = height < 64 ? height : 64, count = columns * rows;
    const uint8_t *const texels = nacre_image_texels(image, level, 0, 0, NULL);
    uint32_t sum[3] = {0, 0, 0};
    unsigned i, k;

    for (i = 0; i < count; i++) {
        const uint8_t *const t =
            texels + 4 * ((size_t)(i / columns * height / rows) * width + i % columns * width / columns);

        for (k = 0; k < 3; k++) sum[k] += t[k];
    }
    for (k = 0; k < 3; k++) out[k] = (nacre_q16)((uint64_t)most * sum[k] / (255 * count));
}

static nacre_result read_lobes(shade_sbrdf *s, const nacre_image *image)
{
    uint32_t lobes, direction;
    unsigned j;

    if (!is_map(image, "lobes") || !asset_key_u32(image, NACRE_KEY_LOBES, &lobes, 1)) return NACRE_ERR_ASSET;
    if (lobes < 1 || lobes > NACRE_MAX_LOBES) return NACRE_ERR_ASSET;
    if (!asset_key_q16(image, NACRE_KEY_MOST, s->most, lobes) ||
        !asset_key_q16(image, NACRE_KEY_SHAPE, s->shape_most, lobes))
        return NACRE_ERR_ASSET;
    if (!asset_key_u32(image, NACRE_KEY_DIRECTION, &direction, 1)) direction = 0;
    if (direction > 1 || image->layers != (direction && lobes == 1 ? 3 : 2 * lobes)) return NACRE_ERR_ASSET;
    for (j = 0; j < lobes; j++)
        if (s->most[j] <= 0 || s->shape_most[j] < NACRE_Q16_ONE || s->shape_most[j] > 2 * NACRE_Q16_ONE)
            return NACRE_ERR_ASSET;
    s->lobes = (uint8_t)lobes;
    s->direction = (uint8_t)direction;
    return NACRE_OK;
}

/* Every exponent of the first lobe, where that is not black, is 3 or more. */
static int exponents_reach_3(const nacre_image *lobes)
{
    enum { CODE_OF_3 = 28 }; /* 255 sqrt(3 / 255), upwards */
    unsigned level;
    uint32_t size, i;

    for (level = 0; level < lobes->levels; level++) {
        const uint8_t *const albedo = nacre_image_texels(lobes, level, 0, 0, &size);
        const uint8_t *const shape = nacre_image_texels(lobes, level, 1, 0, &size);

        for (i = 0; i < size; i += 4)
            if (shape[i + 3] < CODE_OF_3 && (albedo[i] | albedo[i + 1] | albedo[i + 2])) return 0;
    }
    return 1;
}

static nacre_result read_sbrdf(shade_material *out, const nacre_material *material)
{
    const nacre_image *const albedo = material->image[NACRE_ROLE_ALBEDO], *const lobes =
                                                                              material->image[NACRE_ROLE_LOBES];
    const nacre_image *const power = material->image[NACRE_ROLE_POWER];
    shade_sbrdf *const s = &out->is.sbrdf;
    nacre_q16 mean[3];
    int i;

    if (!is_map(albedo, "albedo") || albedo->layers != 1 || !asset_key_q16(albedo, NACRE_KEY_MOST, &s->albedo_most, 1))
        return NACRE_ERR_ASSET;
    if (s->albedo_most <= 0 || albedo->width != lobes->width || albedo->height != lobes->height ||
        albedo->levels != lobes->levels || read_lobes(s, lobes))
        return NACRE_ERR_ASSET;
    mean_albedo(albedo, s->albedo_most, mean);
    for (i = 0; i < 3; i++) out->albedo[i] = out->albedo[i] > mean[i] ? out->albedo[i] - mean[i] : 0;
    if (!power) return NACRE_OK;
    s->power_width = power->width;
    s->power_serves = SHADE_HAS_GLES && s->lobes == 1 && exponents_reach_3(lobes);
    return power->faces == 1 && power->layers == 1 && power->format == NACRE_FORMAT_R8 && power->width > 1 &&
                   asset_key_is(power, NACRE_KEY_ROLE, "power") && asset_key_is(power, NACRE_KEY_TRANSFER, "root")
               ? NACRE_OK
               : NACRE_ERR_ASSET;
}

static nacre_result check_normal_map(const nacre_image *image)
{
    if (image->faces != 1 || image->layers < 1 || !says(image, NACRE_KEY_ROLE, "normal")) return NACRE_ERR_ASSET;
    return image->format == NACRE_FORMAT_RGB8 || image->format == NACRE_FORMAT_RGBA8 ? NACRE_OK : NACRE_ERR_ASSET;
}

static nacre_result check_mask(const nacre_image *image)
{
    if (image->faces != 1 || image->layers < 1 || !says(image, NACRE_KEY_ROLE, "mask")) return NACRE_ERR_ASSET;
    return image->format == NACRE_FORMAT_R8 || image->format == NACRE_FORMAT_RG8 ||
                   image->format == NACRE_FORMAT_RGB8 || image->format == NACRE_FORMAT_RGBA8
               ? NACRE_OK
               : NACRE_ERR_ASSET;
}

int shade_model_role(nacre_model model)
{
    if (model == NACRE_MODEL_TABLE) return NACRE_ROLE_TABLE;
    if (model == NACRE_MODEL_SBRDF) return NACRE_ROLE_LOBES;
    if (model == NACRE_MODEL_PALETTE) return NACRE_ROLE_PALETTE;
    return model == NACRE_MODEL_SPHERES ? NACRE_ROLE_SPHERES : -1;
}

int shade_role_has_uv(int role)
{
    return role == NACRE_ROLE_NORMAL || role == NACRE_ROLE_MASK || role == NACRE_ROLE_ALBEDO ||
           role == NACRE_ROLE_LOBES || role == NACRE_ROLE_INDEX;
}

int shade_model_takes(nacre_model model, int role)
{
    if (role == NACRE_ROLE_NORMAL || role == NACRE_ROLE_MASK || role == shade_model_role(model)) return 1;
    if (model == NACRE_MODEL_PALETTE) return role == NACRE_ROLE_INDEX;
    return model == NACRE_MODEL_SBRDF && (role == NACRE_ROLE_ALBEDO || role == NACRE_ROLE_POWER);
}

/* 0: left out of this build. */
static int has_model(const nacre_material *material)
{
    if (!SHADE_HAS_MAPS && (material->image[NACRE_ROLE_NORMAL] || material->image[NACRE_ROLE_MASK])) return 0;
    switch (material->model) {
    case NACRE_MODEL_TABLE:
        return SHADE_HAS_TABLES;
    case NACRE_MODEL_SPHERES:
        return SHADE_HAS_SPHERES;
    case NACRE_MODEL_SBRDF:
        return SHADE_HAS_SBRDF;
    default:
        return SHADE_HAS_GLES;
    }
}

nacre_result shade_material_read(shade_material *out, const nacre_material *material)
{
    const int role = material ? shade_model_role(material->model) : -1;
    const nacre_image *image = role < 0 ? NULL : material->image[role];
    nacre_result result;
    if (!image) return NACRE_ERR_ARGUMENT;
    memset(out, 0, sizeof *out);
    out->model = material->model;
    if (!has_model(material)) return NACRE_ERR_UNSUPPORTED;
    if (SHADE_HAS_SBRDF && role == NACRE_ROLE_LOBES) image = material->image[NACRE_ROLE_ALBEDO]; /* has the key */
    if (!image || (role == NACRE_ROLE_PALETTE && !material->image[NACRE_ROLE_INDEX])) return NACRE_ERR_ARGUMENT;
    if (image->faces != 1 || !asset_key_q16(image, NACRE_KEY_ALBEDO, out->albedo, 3)) return NACRE_ERR_ASSET;
    if (SHADE_HAS_GLES && role == NACRE_ROLE_PALETTE)
        result = read_palette(out, material);
    else if (shade_is_table(out))
        result = read_table(out, image);
    else if (shade_is_sbrdf(out))
        result = read_sbrdf(out, material);
    else
        result = SHADE_HAS_SPHERES ? read_spheres(out, image) : NACRE_ERR_UNSUPPORTED;
    if (!SHADE_HAS_MAPS) return result;
    if (!result && material->image[NACRE_ROLE_NORMAL]) result = check_normal_map(material->image[NACRE_ROLE_NORMAL]);
    if (!result && material->image[NACRE_ROLE_MASK]) result = check_mask(material->image[NACRE_ROLE_MASK]);
    return result;
}
