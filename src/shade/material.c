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

static nacre_result read_table(shade_material *out, const nacre_image *image)
{
    shade_table *t = &out->is.table;
    int32_t v[9];
    int i;
    if (image->format != NACRE_FORMAT_RGBA8 || image->layers > 2 || image->width < 2 || image->height < 2)
        return NACRE_ERR_ASSET;
    if (!says(image, NACRE_KEY_ROLE, "table") || !asset_key_q16(image, NACRE_KEY_TABLE, v, 9)) return NACRE_ERR_ASSET;
    t->e = v[0];
    t->ymax = v[1];
    for (i = 0; i < 3; i++) t->w[i] = v[2 + i];
    t->p = v[5];
    t->eps = v[6];
    t->k1 = v[7];
    t->k2 = v[8];
    t->width = image->width;
    t->height = image->height;
    out->fine = image->layers == 2;
    if (t->e <= 0 || t->ymax <= 0 || t->eps <= 0 || t->eps > NACRE_Q16_ONE) return NACRE_ERR_ASSET;
    return is_near(t->p, 4 * NACRE_Q16_ONE) || is_near(t->p, 314573) ? NACRE_OK : NACRE_ERR_ASSET; /* 4 or 4.8 */
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
    return model == NACRE_MODEL_SPHERES ? NACRE_ROLE_SPHERES : -1;
}

nacre_result shade_material_read(shade_material *out, const nacre_material *material)
{
    const int role = material ? shade_model_role(material->model) : -1;
    const nacre_image *image = role < 0 ? NULL : material->image[role];
    nacre_result result;
    if (!image) return NACRE_ERR_ARGUMENT;
    memset(out, 0, sizeof *out);
    out->model = material->model;
    if (image->faces != 1 || !asset_key_q16(image, NACRE_KEY_ALBEDO, out->albedo, 3)) return NACRE_ERR_ASSET;
    result = role == NACRE_ROLE_TABLE ? read_table(out, image) : read_spheres(out, image);
    if (!result && material->image[NACRE_ROLE_NORMAL]) result = check_normal_map(material->image[NACRE_ROLE_NORMAL]);
    if (!result && material->image[NACRE_ROLE_MASK]) result = check_mask(material->image[NACRE_ROLE_MASK]);
    return result;
}
