/* SPDX-License-Identifier: MIT */
/* The object in its block, and its items: a mesh or the caller's buffers, with a material. */
#include "gles.h"

#include <string.h>

#include "nacre_asset.h"

static int desc_fill(nacre_gles_desc *out, const nacre_gles_desc *desc)
{
    if (!desc || !desc->get_proc) return 0;
    *out = *desc;
    if (!out->texture_budget) out->texture_budget = UINT32_MAX;
    if (!out->max_items) out->max_items = 16;
    if (!out->max_programs) out->max_programs = 8;
    if (!out->max_textures) out->max_textures = 48;
    return 1;
}

static size_t round_up(size_t size)
{
    const size_t unit = sizeof(union {
        void *p;
        uint64_t u;
    });
    return (size + unit - 1) & ~(unit - 1);
}

static size_t object_size(const nacre_gles_desc *d)
{
    return round_up(sizeof(nacre_gles)) + round_up(d->max_programs * sizeof(gles_program)) +
           round_up(d->max_items * sizeof(gles_item)) + round_up(d->max_textures * sizeof(gles_texture));
}

size_t nacre_gles_size(const nacre_gles_desc *desc)
{
    nacre_gles_desc d;
    if (!desc_fill(&d, desc)) return 0;
    return object_size(&d) + round_up(1) - 4; /* room to align a block that is aligned to 4 */
}

nacre_result nacre_gles_init(nacre_gles **out, void *block, size_t size, const nacre_gles_desc *desc)
{
    nacre_gles_desc d;
    nacre_gles *gles;
    uint8_t *at;
    nacre_result result;
    if (!out || !block || (uintptr_t)block % 4 || !desc_fill(&d, desc)) return NACRE_ERR_ARGUMENT;
    if (size < nacre_gles_size(desc)) return NACRE_ERR_MEMORY;
    at = (uint8_t *)block + (round_up((uintptr_t)block) - (uintptr_t)block);
    memset(at, 0, object_size(&d));
    gles = (nacre_gles *)(void *)at;
    at += round_up(sizeof *gles);
    gles->programs = (gles_program *)(void *)at;
    at += round_up(d.max_programs * sizeof(gles_program));
    gles->items = (gles_item *)(void *)at;
    at += round_up(d.max_items * sizeof(gles_item));
    gles->textures = (gles_texture *)(void *)at;
    gles->desc = d;
    result = gles_start(gles);
    if (result) return result;
    *out = gles;
    return NACRE_OK;
}

/* ---- ids: generation << 8 | slot + 1 ------------------------------------------------------------ */

static uint32_t item_id(const nacre_gles *gles, const gles_item *item)
{
    return item->generation << 8 | (uint32_t)(item - gles->items + 1);
}

gles_item *gles_item_find(nacre_gles *gles, nacre_gles_item id)
{
    const uint32_t slot = (id.id & 255) - 1;
    gles_item *item;
    if (slot >= gles->desc.max_items) return NULL; /* also for slot 0 - 1 */
    item = &gles->items[slot];
    return item->source != GLES_SOURCE_FREE && item->generation == id.id >> 8 ? item : NULL;
}

int gles_item_needs_tangent(const gles_item *item)
{
    return item->image[NACRE_ROLE_NORMAL] != NULL || item->image[NACRE_ROLE_LOBES] != NULL;
}

int gles_item_needs_uv(const gles_item *item)
{
    return gles_item_needs_tangent(item) || item->image[NACRE_ROLE_MASK] != NULL ||
           item->image[NACRE_ROLE_INDEX] != NULL;
}

static gles_item *free_item(nacre_gles *gles)
{
    unsigned i;
    for (i = 0; i < gles->desc.max_items; i++)
        if (gles->items[i].source == GLES_SOURCE_FREE) return &gles->items[i];
    return NULL;
}

static void item_free(gles_item *item)
{
    const uint32_t generation = item->generation;
    memset(item, 0, sizeof *item);
    item->generation = (generation + 1) & 0xFFFFFF;
}

/* ---- textures of an item ---------------------------------------------------------------------- */

/* The layers of image that are there already, else a free run of records: filled in, users 0. NULL: no room. */
static gles_texture *reserve(nacre_gles *gles, const nacre_image *image, unsigned role)
{
    gles_texture *t = gles->textures, *run = NULL;
    const unsigned count = gles_texture_count(image, role);
    unsigned i, length = 0;
    for (i = 0; i < gles->desc.max_textures; i++)
        if (t[i].image == image && t[i].role == role && !t[i].layer) return &t[i];
    for (i = 0; i < gles->desc.max_textures && length < count; i++) {
        length = t[i].image ? 0 : length + 1;
        if (length == count) run = &t[i + 1 - length];
    }
    for (i = 0; run && i < length; i++) {
        memset(&run[i], 0, sizeof run[i]);
        run[i].image = image;
        run[i].layer = (uint8_t)i;
        run[i].role = (uint8_t)role;
    }
    return run;
}

/* Roles whose images an item samples. */
static int role_used(const gles_item *item, unsigned role)
{
    return item->image[role] != NULL;
}

static void release_textures(nacre_gles *gles, gles_item *item)
{
    unsigned role, i;
    for (role = 0; role < NACRE_ROLE_COUNT; role++) {
        gles_texture *t = &gles->textures[item->first_texture[role]];
        const unsigned layers = role_used(item, role) ? gles_texture_count(item->image[role], role) : 0;
        uint32_t bytes = 0;
        if (!layers || --t->users) continue;
        gles_texture_cost(&gles->caps, t->image, role, &bytes);
        if (t->name && gles->resident) gles->texture_bytes -= bytes;
        for (i = 0; i < layers; i++) {
            if (t[i].name && gles->resident && !gles->lost) gles->gl.DeleteTextures(1, &t[i].name);
            memset(&t[i], 0, sizeof t[i]);
        }
    }
}

/* Take records for all images, check the budget, make nothing. On failure nothing is taken. */
static nacre_result claim_textures(nacre_gles *gles, gles_item *item, uint32_t *new_bytes)
{
    unsigned role;
    uint64_t sum = 0;
    nacre_result result = NACRE_OK;
    for (role = 0; role < NACRE_ROLE_COUNT && !result; role++) {
        const nacre_image *image = item->image[role];
        gles_texture *t;
        uint32_t bytes = 0;
        if (!image) continue;
        result = gles_texture_cost(&gles->caps, image, role, &bytes);
        if (result) gles_fail(gles, result, "texture format or size: not on this device", NULL);
        t = result ? NULL : reserve(gles, image, role);
        if (!result && !t) result = gles_fail(gles, NACRE_ERR_BUDGET, "max_textures", NULL);
        if (result) {
            for (; role < NACRE_ROLE_COUNT; role++) item->image[role] = NULL; /* not taken */
            break;
        }
        if (!t->users++) sum += bytes;
        item->first_texture[role] = (uint16_t)(t - gles->textures);
    }
    if (!result && sum + gles->texture_bytes > gles->desc.texture_budget)
        result = gles_fail(gles, NACRE_ERR_BUDGET, "texture_budget", NULL);
    if (result) release_textures(gles, item);
    *new_bytes = (uint32_t)sum;
    return result;
}

static nacre_result upload_claimed(nacre_gles *gles, const gles_item *item)
{
    unsigned role, i;
    for (role = 0; role < NACRE_ROLE_COUNT; role++) {
        gles_texture *t = &gles->textures[item->first_texture[role]];
        if (!role_used(item, role) || t->name) continue;
        for (i = 0; i < gles_texture_count(item->image[role], role); i++) {
            const nacre_result result = gles_texture_upload(gles, &t[i]);
            if (result) return result;
        }
    }
    return NACRE_OK;
}

/* Delete what an unfinished add made. Textures that other items use were complete before. */
static void undo(nacre_gles *gles, gles_item *item, uint32_t bytes_before)
{
    if (!gles->lost) gles_mesh_delete(gles, item);
    release_textures(gles, item);
    gles->texture_bytes = bytes_before;
}

/* ---- add ------------------------------------------------------------------------------------- */

static int mesh_is_valid(const nacre_mesh *m)
{
    uint32_t i;
    if (!m || !m->vertices || !m->indices || !m->vertex_count || !m->index_count || m->index_count % 3) return 0;
    for (i = 0; i < 3; i++)
        if (m->half_extent[i] < 0) return 0;
    for (i = 0; i < m->index_count; i++)
        if (m->indices[i] >= m->vertex_count) return 0;
    return 1;
}

static int type_is_known(uint32_t type)
{
    static const uint16_t types[] = {GLES_BYTE,  GLES_UNSIGNED_BYTE, GLES_SHORT,      GLES_UNSIGNED_SHORT,
                                     GLES_FLOAT, GLES_FIXED,         GLES_HALF_FLOAT, GLES_HALF_FLOAT_OES};
    unsigned i;
    for (i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i] == type) return 1;
    return 0;
}

static int attribute_is_valid(const nacre_gles_attribute *a, unsigned smallest)
{
    if (!a->count) return !smallest;
    return a->count >= smallest && a->count <= 4 && a->normalized <= 1 && a->stride <= INT32_MAX &&
           type_is_known(a->type);
}

static nacre_result check_buffers(const nacre_gles *gles, const nacre_gles_buffers *b, int tangent, int uv)
{
    const uint8_t smallest[NACRE_GLES_ATTRIBUTE_COUNT] = {2, 3, tangent ? 4 : 0, uv ? 2 : 0};
    unsigned i;
    if (!b->vertex_buffer || !b->count || b->count % 3 || b->count > INT32_MAX || b->first > INT32_MAX)
        return NACRE_ERR_ARGUMENT;
    for (i = 0; i < NACRE_GLES_ATTRIBUTE_COUNT; i++)
        if (!attribute_is_valid(&b->attribute[i], smallest[i])) return NACRE_ERR_ARGUMENT;
    if (!b->index_buffer) return NACRE_OK;
    if (b->index_type == GLES_UNSIGNED_INT && !(b->index_offset & 3))
        return gles->caps.index_uint ? NACRE_OK : NACRE_ERR_UNSUPPORTED;
    return b->index_type == GLES_UNSIGNED_SHORT && !(b->index_offset & 1) ? NACRE_OK : NACRE_ERR_ARGUMENT;
}

/* Fill a free slot's material and images; nothing of GL. */
static nacre_result open_item(nacre_gles *gles, const nacre_material *material, gles_item **out)
{
    shade_material decoded;
    const nacre_result result = shade_material_read(&decoded, material);
    gles_item *item;
    unsigned role;
    if (result) return result;
    if (gles->lost || !gles->resident) return NACRE_ERR_LOST;
    item = free_item(gles);
    if (!item) return gles_fail(gles, NACRE_ERR_BUDGET, "max_items", NULL);
    item->material = decoded;
    for (role = 0; role < NACRE_ROLE_COUNT; role++)
        if (shade_model_takes(material->model, (int)role)) item->image[role] = material->image[role];
    *out = item;
    return NACRE_OK;
}

/* Textures and mesh buffers of an opened item; source is set on success. */
static nacre_result make_item(nacre_gles *gles, gles_item *item, gles_source source, nacre_gles_item *out)
{
    const uint32_t bytes_before = gles->texture_bytes;
    gles_upload_state state;
    uint32_t bytes;
    nacre_result result = claim_textures(gles, item, &bytes);
    if (!result) {
        result = gles_begin(gles);
        gles_upload_begin(gles, &state);
        if (!result) result = upload_claimed(gles, item);
        if (!result && source == GLES_SOURCE_MESH) result = gles_mesh_upload(gles, item);
        gles_upload_end(gles, &state);
        if (!result) result = gles_check(gles, "add");
        gles->texture_bytes += bytes;
        if (result) undo(gles, item, bytes_before);
    }
    if (result) {
        item_free(item);
        return result;
    }
    item->source = (uint8_t)source;
    out->id = item_id(gles, item);
    return NACRE_OK;
}

nacre_result nacre_gles_add(nacre_gles *gles, const nacre_mesh *mesh, const nacre_material *material,
                            nacre_gles_item *out)
{
    gles_item *item;
    nacre_result result;
    if (!gles || !out || !mesh_is_valid(mesh)) return NACRE_ERR_ARGUMENT;
    result = open_item(gles, material, &item);
    if (result) return result;
    item->is.mesh = *mesh;
    return make_item(gles, item, GLES_SOURCE_MESH, out);
}

nacre_result nacre_gles_add_buffers(nacre_gles *gles, const nacre_gles_buffers *buffers, const nacre_material *material,
                                    nacre_gles_item *out)
{
    gles_item *item;
    nacre_result result;
    int tangent, uv;
    if (!gles || !out || !material) return NACRE_ERR_ARGUMENT;
    tangent = material->model == NACRE_MODEL_SBRDF || material->image[NACRE_ROLE_NORMAL];
    uv = tangent || material->model == NACRE_MODEL_PALETTE || material->image[NACRE_ROLE_MASK];
    result = buffers ? check_buffers(gles, buffers, tangent, uv) : NACRE_OK;
    if (!result) result = open_item(gles, material, &item);
    if (result) return result;
    if (buffers) item->is.buffers = *buffers;
    return make_item(gles, item, buffers ? GLES_SOURCE_BUFFERS : GLES_SOURCE_BOUND, out);
}

nacre_result nacre_gles_set_buffers(nacre_gles *gles, nacre_gles_item id, const nacre_gles_buffers *buffers)
{
    gles_item *item = gles ? gles_item_find(gles, id) : NULL;
    nacre_result result;
    if (!item || !buffers || item->source == GLES_SOURCE_MESH || item->source == GLES_SOURCE_LIT)
        return NACRE_ERR_ARGUMENT;
    result = check_buffers(gles, buffers, gles_item_needs_tangent(item), gles_item_needs_uv(item));
    if (result) return result;
    item->is.buffers = *buffers;
    item->source = GLES_SOURCE_BUFFERS;
    return NACRE_OK;
}

void nacre_gles_remove(nacre_gles *gles, nacre_gles_item id)
{
    gles_item *item = gles ? gles_item_find(gles, id) : NULL;
    if (!item) return;
    if (gles->described == id.id) gles->described = 0;
    if (gles->resident && !gles->lost) gles_mesh_delete(gles, item);
    if (gles->resident && !gles->lost && item->source == GLES_SOURCE_LIT) gles_lit_delete(gles, &item->is.lit);
    release_textures(gles, item);
    item_free(item);
}

uint32_t nacre_gles_texture_bytes(const nacre_gles *gles)
{
    return gles ? gles->texture_bytes : 0;
}

void nacre_gles_changed(const nacre_gles *gles, nacre_gles_state *out)
{
    if (gles && out) *out = gles->changed;
}
