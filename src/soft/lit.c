/* SPDX-License-Identifier: MIT */
/* Pictures of lit spheres, in the frame's format. */
#include "soft.h"

#include "asset.h"
#include "lit_sphere.h"

typedef struct source { /* what shade needs of a material */
    shade_material material;
    shade_lit_kernels kernels;
    const uint8_t *layer[NACRE_MAX_LAYERS];
    shade_lit lit;
} source;

static int desc_is_valid(const nacre_soft_lit_desc *desc)
{
    return desc && desc->material && desc->view && desc->format <= NACRE_SOFT_RGBA8 && desc->size >= SHADE_LIT_LEAST &&
           desc->size <= SHADE_LIT_MOST && desc->view->light_count <= NACRE_MAX_LIT_LIGHTS &&
           (desc->view->lights || !desc->view->light_count);
}

static nacre_result open_source(source *out, const nacre_soft_lit_desc *desc)
{
    const nacre_soft_kernels *const kernels = desc->kernels ? desc->kernels : &nacre_soft_portable;
    const nacre_image *image;
    nacre_material plain = *desc->material;
    nacre_result r;
    int i;

    plain.image[NACRE_ROLE_NORMAL] = plain.image[NACRE_ROLE_MASK] = NULL;
    r = shade_material_read(&out->material, &plain);
    if (r) return r;
    if (shade_is_sbrdf(&out->material) || plain.model == NACRE_MODEL_PALETTE)
        return NACRE_ERR_UNSUPPORTED; /* a sphere is of one material */
    image = plain.image[shade_model_role(plain.model)];
    if (image->format != NACRE_FORMAT_RGBA8 && image->format != NACRE_FORMAT_RGB8) return NACRE_ERR_UNSUPPORTED;
    if (SHADE_HAS_SPHERES && plain.model == NACRE_MODEL_SPHERES && image->width != image->height)
        return NACRE_ERR_UNSUPPORTED;
    for (i = 0; i < image->layers; i++) out->layer[i] = nacre_image_texels(image, 0, (unsigned)i, 0, NULL);
    out->kernels.table_add = kernels->table_add;
    out->kernels.encode = kernels->encode;
    out->lit.view = desc->view;
    for (i = 0; i < 3; i++) out->lit.centre[i] = desc->centre[i];
    out->lit.material = &out->material;
    out->lit.layers = out->layer;
    out->lit.sphere_size = image->width;
    out->lit.sphere_texel_bytes = image->format == NACRE_FORMAT_RGB8 ? 3 : 4;
    out->lit.size = desc->size;
    out->lit.kernels = &out->kernels;
    return NACRE_OK;
}

static int has_points(const nacre_view *view)
{
    int i;

    for (i = 0; i < view->light_count; i++)
        if (view->lights[i].type == NACRE_LIGHT_POINT) return 1;
    return 0;
}

size_t nacre_soft_lit_scratch_size(const nacre_soft_lit_desc *desc, unsigned rows)
{
    source s;

    if (!desc_is_valid(desc) || !rows || rows > desc->size || open_source(&s, desc)) return 0;
    return shade_lit_scratch(&s.lit, rows);
}

static nacre_result draw_rows(const source *s, const nacre_soft_lit_desc *desc, unsigned y0, unsigned rows,
                              void *scratch, uint8_t *texels)
{
    nacre_soft_desc store = {0};
    const uint32_t *const codes = shade_lit_rows(&s->lit, y0, rows, scratch);

    if (!codes) return NACRE_ERR_UNSUPPORTED;
    store.format = desc->format;
    soft_store(&store, 0, (int32_t)y0, codes, (int)(rows * desc->size),
               texels + y0 * desc->size * soft_pixel_bytes(desc->format));
    return NACRE_OK;
}

nacre_result nacre_soft_lit_rows(const nacre_soft_lit_desc *desc, void *texels, unsigned y0, unsigned y1, void *scratch,
                                 size_t scratch_size)
{
    source s;
    uint32_t head, row;
    unsigned at_once = 0;
    nacre_result r;

    if (!desc_is_valid(desc) || !texels || !scratch || y0 > y1 || y1 > desc->size) return NACRE_ERR_ARGUMENT;
    if (has_points(desc->view)) return NACRE_ERR_UNSUPPORTED;
    r = open_source(&s, desc);
    if (r) return r;
    head = shade_lit_scratch(&s.lit, 0);
    row = shade_lit_scratch(&s.lit, 1) - head;
    while (at_once < y1 - y0 && scratch_size >= head + (size_t)(at_once + 1) * row) at_once++;
    if (!at_once && y0 < y1) return NACRE_ERR_MEMORY;
    for (; y0 < y1 && !r; y0 += at_once) {
        if (at_once > y1 - y0) at_once = y1 - y0;
        r = draw_rows(&s, desc, y0, at_once, scratch, texels);
    }
    return r;
}
