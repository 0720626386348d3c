/* SPDX-License-Identifier: MIT */
/* A frame's items: materials and lights into evaluators, vertices onto the screen. */
#include "soft.h"

#include <string.h>

#include "asset.h"

typedef struct preparing {
    nacre_soft *soft;
    nacre_view view; /* with the item's own matrix */
    int64_t low, high;
} preparing;

static int mesh_is_valid(const nacre_mesh *mesh)
{
    uint32_t i;
    int k;

    if (!mesh || !mesh->vertices || !mesh->indices || !mesh->vertex_count || mesh->index_count % 3) return 0;
    for (i = 0; i < mesh->index_count; i++)
        if (mesh->indices[i] >= mesh->vertex_count) return 0;
    for (k = 0; k < 3; k++)
        if (mesh->half_extent[k] < 0) return 0;
    return 1;
}

/* ---- lights ------------------------------------------------------------------------------------------------------------ */

static void *light_memory(const nacre_soft *soft, uint32_t item)
{
    return soft->light_room + (size_t)item * soft->desc.max_lights * soft_light_bytes(&soft->desc);
}

static nacre_result set_tables(const nacre_soft *soft, soft_item *item, uint32_t index, const shade_material *material,
                               const nacre_image *image)
{
    const uint8_t *const texels[2] = {nacre_image_texels(image, 0, 0, 0, NULL),
                                      nacre_image_texels(image, 0, material->fine, 0, NULL)};
    shade_table_eval *const table = light_memory(soft, index);
    uint32_t *columns = (uint32_t *)(void *)(table + soft->desc.max_lights);
    int i;

    if (material->is.table.width > soft->desc.table_columns || (shade_is_fine(material) && !soft->desc.fine))
        return NACRE_ERR_BUDGET;
    item->table = table;
    for (i = 0; i < soft->frame->light_count; i++) {
        if (!shade_table_eval_prepare(&table[item->lights], columns, &soft->frame->light[i], material, texels))
            return NACRE_ERR_UNSUPPORTED;
        columns += SHADE_TABLE_WORDS(material->is.table.width, material->fine);
        item->lights += !table[item->lights].dark;
    }
    item->one_code = item->lights == 1 && item->output == NACRE_OUTPUT_SRGB && shade_table_has_code(table) &&
                     !(item->ambient[0].m | item->ambient[1].m | item->ambient[2].m);
    item->codes_565 = item->one_code && !shade_is_fine(material) && !material->is.table.toe && !soft->desc.dither &&
                      soft->desc.kernels->table_565 && soft->desc.format <= NACRE_SOFT_RGB565_SWAPPED;
    return NACRE_OK;
}

static void set_near_lights(const preparing *p, soft_item *item, void *room)
{
    const shade_frame *const frame = p->soft->frame;
    int i;

    item->near_light = room;
    for (i = 0; i < frame->light_count; i++) {
        shade_persp_light_prepare(&item->near_light[item->lights], &p->view.lights[i], &frame->light[i],
                                  frame->position_shift);
        item->lights += !item->near_light[item->lights].dark;
    }
}

static nacre_result set_near_table(const preparing *p, soft_item *item, uint32_t index, const shade_material *material,
                                   const nacre_image *image)
{
    const uint8_t *const texels[2] = {nacre_image_texels(image, 0, 0, 0, NULL),
                                      nacre_image_texels(image, 0, material->fine, 0, NULL)};

    item->near = light_memory(p->soft, index);
    if (!shade_table_persp_prepare(item->near, &material->is.table, material->fine, material->early, texels))
        return NACRE_ERR_UNSUPPORTED;
    set_near_lights(p, item, item->near + 1);
    return NACRE_OK;
}

/* 0: not to be drawn. */
static unsigned sphere_texel_bytes(const nacre_image *image)
{
    if (image->width != image->height) return 0;
    return image->format == NACRE_FORMAT_RGBA8 ? 4 : image->format == NACRE_FORMAT_RGB8 ? 3 : 0;
}

static nacre_result set_near_spheres(const preparing *p, soft_item *item, uint32_t index,
                                     const shade_material *material, const nacre_image *image)
{
    const unsigned texel_bytes = sphere_texel_bytes(image);

    if (!texel_bytes) return NACRE_ERR_UNSUPPORTED;
    item->near_spheres = light_memory(p->soft, index);
    shade_spheres_persp_prepare(item->near_spheres, &material->is.spheres, nacre_image_texels(image, 0, 0, 0, NULL),
                                image->width, texel_bytes);
    set_near_lights(p, item, item->near_spheres + 1);
    return NACRE_OK;
}

static nacre_result set_spheres(const nacre_soft *soft, soft_item *item, uint32_t index, const shade_material *material,
                                const nacre_image *image)
{
    const unsigned texel_bytes = sphere_texel_bytes(image);
    const uint8_t *layers[NACRE_MAX_LAYERS];
    unsigned i;

    if (!texel_bytes) return NACRE_ERR_UNSUPPORTED;
    item->spheres = light_memory(soft, index);
    for (i = 0; i < image->layers; i++) layers[i] = nacre_image_texels(image, 0, i, 0, NULL);
    for (i = 0; i < soft->frame->light_count; i++) {
        if (!shade_spheres_eval_prepare(&item->spheres[item->lights], &soft->frame->light[i], material, layers,
                                        image->width, texel_bytes))
            return NACRE_ERR_UNSUPPORTED;
        item->lights += !item->spheres[item->lights].dark;
    }
    return NACRE_OK;
}

static nacre_result set_sbrdf(const preparing *p, soft_item *item, uint32_t index, const shade_material *material,
                              const nacre_soft_item *from)
{
    const shade_frame *const frame = p->soft->frame;
    int i;

    item->albedo = from->material->image[NACRE_ROLE_ALBEDO];
    item->lobes = from->material->image[NACRE_ROLE_LOBES];
    item->sbrdf = light_memory(p->soft, index);
    item->sbrdf_light = (shade_sbrdf_eval_light *)(void *)(item->sbrdf + 1);
    shade_sbrdf_eval_prepare(item->sbrdf, &material->is.sbrdf, frame);
    for (i = 0; i < frame->light_count; i++) {
        shade_sbrdf_light_prepare(&item->sbrdf_light[item->lights], &p->view.lights[i], &frame->light[i], frame);
        item->lights += !item->sbrdf_light[item->lights].dark;
    }
    return NACRE_OK;
}

/* Images with the cosine in them are turned per pixel, whatever the camera is. */
static int needs_persp(const nacre_view *view, const shade_material *material)
{
    return shade_needs_persp(view) ||
           (view->light_count && material->model == NACRE_MODEL_SPHERES && material->is.spheres.cosine);
}

static nacre_result set_material(preparing *p, soft_item *item, uint32_t index, const nacre_soft_item *from)
{
    const nacre_soft *const soft = p->soft;
    const nacre_view *const view = &p->view;
    const nacre_image *const *const image = from->material->image;
    shade_material material;
    nacre_result r = shade_material_read(&material, from->material);

    if (r) return r;
    if (view->light_count > soft->desc.max_lights) return NACRE_ERR_BUDGET;
    if (material.model == NACRE_MODEL_PALETTE || (!SHADE_HAS_NEAR && needs_persp(view, &material)))
        return NACRE_ERR_UNSUPPORTED;
    shade_setup(soft->frame, view, from->mesh->centre, &material, SHADE_LINEAR, needs_persp(view, &material), 2);
    memcpy(item->ambient, soft->frame->ambient, sizeof item->ambient);
    item->output = view->output;
    item->persp = SHADE_HAS_NEAR && soft->frame->persp;
    if (SHADE_HAS_NEAR && item->persp && !soft_lens_set(&item->lens, soft, view, soft->frame))
        return NACRE_ERR_UNSUPPORTED;
    if (shade_is_sbrdf(&material)) return set_sbrdf(p, item, index, &material, from);
    if (shade_is_table(&material))
        return SHADE_HAS_NEAR && item->persp ? set_near_table(p, item, index, &material, image[NACRE_ROLE_TABLE])
                                             : set_tables(soft, item, index, &material, image[NACRE_ROLE_TABLE]);
    if (!SHADE_HAS_SPHERES) return NACRE_ERR_UNSUPPORTED;
    return SHADE_HAS_NEAR && item->persp ? set_near_spheres(p, item, index, &material, image[NACRE_ROLE_SPHERES])
                                         : set_spheres(soft, item, index, &material, image[NACRE_ROLE_SPHERES]);
}

static nacre_result set_lit(preparing *p, const nacre_soft_item *from)
{
    int32_t eye[3];

    if (!from->lit->texels || from->lit->size < 8 || from->lit->size > 512) return NACRE_ERR_ARGUMENT;
    shade_eye(&p->view, from->mesh->centre, eye);
    shade_turn_to_z(eye, p->soft->frame->turn_q28);
    return NACRE_OK;
}

/* ---- maps -------------------------------------------------------------------------------------------------------------- */

static nacre_result set_texture(soft_texture *out, const nacre_image *image, unsigned flags)
{
    if (!image) return NACRE_OK;
    out->channels = image->format == NACRE_FORMAT_R8      ? 1
                    : image->format == NACRE_FORMAT_RG8   ? 2
                    : image->format == NACRE_FORMAT_RGB8  ? 3
                    : image->format == NACRE_FORMAT_RGBA8 ? 4
                                                          : 0;
    out->texels = nacre_image_texels(image, 0, 0, 0, NULL);
    out->width = image->width;
    out->height = image->height;
    out->flags = (uint8_t)flags;
    return out->channels && out->texels ? NACRE_OK : NACRE_ERR_UNSUPPORTED;
}

static nacre_result set_maps(const preparing *p, soft_item *item, const nacre_soft_item *from)
{
    const unsigned flags = (from->clamp ? SOFT_CLAMP : 0) | (from->nearest ? SOFT_NEAREST : 0);
    nacre_result r = NACRE_OK;

    if (!SHADE_HAS_MAPS) return from->blend ? NACRE_ERR_UNSUPPORTED : NACRE_OK;
    item->blend = from->blend;
    item->alpha_least = from->alpha_test;
    if (from->blend && !p->soft->desc.blend) return NACRE_ERR_BUDGET;
    if (from->material) {
        r = set_texture(&item->normal_map, from->material->image[NACRE_ROLE_NORMAL], flags);
        if (!r && item->normal_map.texels && item->normal_map.channels < 3) r = NACRE_ERR_UNSUPPORTED;
        if (!r) r = set_texture(&item->mask, from->material->image[NACRE_ROLE_MASK], flags);
    }
    item->texture_flags = (uint8_t)flags;
    item->mapped = item->normal_map.texels || item->mask.texels || item->blend || item->sbrdf;
    return r;
}

/* ---- items ------------------------------------------------------------------------------------------------------------- */

static nacre_result add_item(preparing *p, const nacre_soft_item *from, const nacre_view *view)
{
    nacre_soft *const soft = p->soft;
    const uint32_t index = soft->item_count;
    soft_item *const item = &soft->item[index];
    nacre_result r;

    if (!mesh_is_valid(from->mesh) || (!from->lit && !from->material)) return NACRE_ERR_ARGUMENT;
    if (from->mesh->vertex_count > soft->desc.max_vertices - soft->vertex_count ||
        from->mesh->index_count / 3 > soft->desc.max_triangles - soft->triangle_count)
        return NACRE_ERR_BUDGET;
    memset(item, 0, sizeof *item);
    item->mesh = from->mesh;
    item->lit = from->lit;
    item->cull = from->cull;
    item->first_vertex = soft->vertex_count;
    item->first_triangle = soft->triangle_count;
    item->triangle_count = from->mesh->index_count / 3;
    p->view = *view;
    p->view.object_to_view = from->object_to_view;
    if (from->lit)
        r = set_lit(p, from);
    else
        r = SHADE_HAS_TABLES || SHADE_HAS_SPHERES || SHADE_HAS_SBRDF ? set_material(p, item, index, from)
                                                                     : NACRE_ERR_UNSUPPORTED;
    if (!r) r = set_maps(p, item, from);
    if (r) return r;
    soft_camera_set(&item->camera, from, &p->view, soft->frame->turn_q28, &p->low, &p->high);
    soft->vertex_count += from->mesh->vertex_count;
    soft->triangle_count += item->triangle_count;
    soft->item_count++;
    return NACRE_OK;
}

nacre_result nacre_soft_prepare(nacre_soft *soft, const nacre_soft_item *items, int count, const nacre_view *view)
{
    preparing p;
    nacre_result r = NACRE_OK;
    int i;

    if (!soft || !view || count < 0 || (count && !items) || (view->light_count && !view->lights))
        return NACRE_ERR_ARGUMENT;
    soft->item_count = 0;
    soft->vertex_count = soft->triangle_count = 0;
    p.soft = soft;
    p.low = INT64_MAX;
    p.high = INT64_MIN;
    if (count > soft->desc.max_items) r = NACRE_ERR_BUDGET;
    for (i = 0; i < count && !r; i++) r = add_item(&p, &items[i], view);
    if (r) soft->item_count = 0, soft->triangle_count = 0;
    for (i = 0; i < soft->item_count; i++) {
        soft_item *const item = &soft->item[i];

        soft_camera_depth(soft, &item->camera, p.low, p.high);
        soft_transform(soft, &item->camera, item->mesh, soft->vertex + item->first_vertex);
    }
    soft_sort(soft);
    return r;
}
