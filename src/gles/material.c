/* SPDX-License-Identifier: MIT */
/* What the files of a material say, checked and decoded. */
#include "gles.h"

#include <string.h>

#include "nacre_asset.h"

static int32_t read_s32(const uint8_t *p)
{
    return (int32_t)((uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24);
}

/* count numbers of a key; 0 when the file has fewer. */
static int read_numbers(const nacre_image *image, const char *key, int32_t *out, unsigned count)
{
    uint32_t size = 0;
    const uint8_t *v = nacre_image_key(image, key, &size);
    unsigned i;
    if (!v || size < 4 * count) return 0;
    for (i = 0; i < count; i++) out[i] = read_s32(v + 4 * i);
    return 1;
}

/* 1 when the file has no such key, or this text is its value. */
static int says(const nacre_image *image, const char *key, const char *text)
{
    uint32_t size = 0, i;
    const char *v = (const char *)nacre_image_key(image, key, &size);
    if (!v) return 1;
    for (i = 0; i < size && v[i] && v[i] == text[i]; i++) {}
    return i < size ? v[i] == text[i] : !text[i];
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
    if (!says(image, NACRE_KEY_ROLE, "table") || !read_numbers(image, NACRE_KEY_TABLE, v, 9)) return NACRE_ERR_ASSET;
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

static nacre_result read_spheres(shade_material *out, const nacre_image *image)
{
    shade_spheres *s = &out->is.spheres;
    int32_t polar[NACRE_MAX_LAYERS], cosine;
    unsigned i;
    const int colour = image->format == NACRE_FORMAT_RGBA8 || image->format == NACRE_FORMAT_RGB8 ||
                       image->format == NACRE_FORMAT_RGB565 || image->format == NACRE_FORMAT_ETC2_RGB8 ||
                       image->format == NACRE_FORMAT_R8;
    if (!colour || image->layers < 1 || image->layers > NACRE_MAX_LAYERS) return NACRE_ERR_ASSET;
    if (!says(image, NACRE_KEY_ROLE, "spheres") || !read_numbers(image, NACRE_KEY_LIGHT_POLAR, polar, image->layers) ||
        !read_numbers(image, NACRE_KEY_COSINE, &cosine, 1) || !read_numbers(image, NACRE_KEY_SCALE, s->scale, 3))
        return NACRE_ERR_ASSET;
    if (!read_numbers(image, NACRE_KEY_DISC, &s->disc, 1)) s->disc = NACRE_Q16_ONE; /* not padded */
    for (i = 0; i < image->layers; i++) {
        if (polar[i] < 0 || polar[i] >= 32768 || (i && polar[i] <= polar[i - 1])) return NACRE_ERR_ASSET;
        s->polar_bam[i] = (uint16_t)polar[i];
    }
    for (i = 0; i < 3; i++)
        if (s->scale[i] < 0) return NACRE_ERR_ASSET;
    s->layers = (uint8_t)image->layers;
    s->cosine = (uint8_t)cosine;
    if (cosine < 0 || cosine > 1 || s->disc < NACRE_Q16_ONE / 2 || s->disc > NACRE_Q16_ONE) return NACRE_ERR_ASSET;
    return says(image, NACRE_KEY_TRANSFER, cosine ? "srgb" : "root4") ? NACRE_OK : NACRE_ERR_ASSET;
}

static nacre_result check_normal_map(const nacre_image *image)
{
    if (image->faces != 1 || image->layers < 1 || !says(image, NACRE_KEY_ROLE, "normal")) return NACRE_ERR_ASSET;
    return image->format == NACRE_FORMAT_RGB8 || image->format == NACRE_FORMAT_RGBA8 ? NACRE_OK : NACRE_ERR_ASSET;
}

int gles_model_role(nacre_model model)
{
    if (model == NACRE_MODEL_TABLE) return NACRE_ROLE_TABLE;
    return model == NACRE_MODEL_SPHERES ? NACRE_ROLE_SPHERES : -1;
}

nacre_result gles_material_read(shade_material *out, const nacre_material *material)
{
    const int role = material ? gles_model_role(material->model) : -1;
    const nacre_image *image = role < 0 ? NULL : material->image[role];
    nacre_result result;
    if (!image) return NACRE_ERR_ARGUMENT;
    memset(out, 0, sizeof *out);
    out->model = material->model;
    if (image->faces != 1 || !read_numbers(image, NACRE_KEY_ALBEDO, out->albedo, 3)) return NACRE_ERR_ASSET;
    result = role == NACRE_ROLE_TABLE ? read_table(out, image) : read_spheres(out, image);
    if (!result && material->image[NACRE_ROLE_NORMAL]) result = check_normal_map(material->image[NACRE_ROLE_NORMAL]);
    return result;
}
