/* SPDX-License-Identifier: MIT */
/* Textures straight from the borrowed file bytes, and mesh buffers. */
#include "gles.h"

#include "asset.h"

/* How the levels of one image reach GL. */
typedef struct upload_plan {
    gl_enum format, type; /* type 0: compressed, format is the internal format */
    gl_int min_filter, mag_filter, wrap;
    uint8_t first, end; /* levels of the file: first .. end - 1 */
    unsigned stacked;   /* layers in one texture, one below the other; 1: each has its own */
} upload_plan;

typedef struct format_row {
    uint8_t nacre_format;
    uint16_t format, type;
} format_row;

/* Unsized formats: the only ones ES 2.0 has, and ES 3 and desktop GL take them too. */
static const format_row formats[] = {
    {NACRE_FORMAT_RGB565, GLES_RGB, GLES_UNSIGNED_SHORT_5_6_5},
    {NACRE_FORMAT_R8, GLES_LUMINANCE, GLES_UNSIGNED_BYTE},
    {NACRE_FORMAT_RG8, GLES_LUMINANCE_ALPHA, GLES_UNSIGNED_BYTE}, /* sampled as .ra */
    {NACRE_FORMAT_RGB8, GLES_RGB, GLES_UNSIGNED_BYTE},
    {NACRE_FORMAT_RGBA8, GLES_RGBA, GLES_UNSIGNED_BYTE},
};

static int is_power_of_two(unsigned x)
{
    return (x & (x - 1)) == 0;
}

static unsigned level_side(unsigned side, unsigned level)
{
    return side >> level ? side >> level : 1;
}

static int file_is_etc1(const nacre_image *image)
{
    uint32_t only;
    return asset_key_u32(image, NACRE_KEY_ETC1, &only, 1) && only == 1;
}

static nacre_result choose_format(const gles_caps *caps, const nacre_image *image, upload_plan *plan)
{
    unsigned i;
    if (image->format == NACRE_FORMAT_ETC2_RGB8) {
        plan->format = file_is_etc1(image) ? caps->etc1 : caps->etc2;
        plan->type = 0;
        return plan->format ? NACRE_OK : NACRE_ERR_UNSUPPORTED;
    }
    for (i = 0; i < sizeof formats / sizeof *formats; i++) {
        if (formats[i].nacre_format != image->format) continue;
        plan->format = formats[i].format;
        plan->type = formats[i].type;
        return NACRE_OK;
    }
    return NACRE_ERR_UNSUPPORTED;
}

static int is_stacked(const nacre_image *image, unsigned role)
{
    return role == NACRE_ROLE_SPHERES && shade_is_quartered(image);
}

unsigned gles_texture_count(const nacre_image *image, unsigned role)
{
    return is_stacked(image, role) ? 1 : image->layers;
}

static nacre_result make_plan(const gles_caps *caps, const nacre_image *image, unsigned role, upload_plan *plan)
{
    const unsigned stacked = is_stacked(image, role) ? image->layers : 1, height = image->height * stacked;
    const int pot = is_power_of_two(image->width) && is_power_of_two(height);
    nacre_result result = choose_format(caps, image, plan);
    unsigned longest, full;
    if (result) return result;

    /* A device that can't hold level 0 starts at the first level it can. */
    plan->stacked = stacked;
    plan->first = 0;
    while (plan->first < image->levels && (level_side(image->width, plan->first) > caps->max_texture ||
                                           level_side(height, plan->first) > caps->max_texture))
        plan->first++;
    if (plan->first == image->levels) return NACRE_ERR_UNSUPPORTED;
    plan->end = role == NACRE_ROLE_TABLE || role == NACRE_ROLE_POWER || role == NACRE_ROLE_PALETTE
                    ? (uint8_t)(plan->first + 1)
                    : image->levels;

    /* ES 2.0 knows no last level and no mips of odd sizes: there a chain is complete or not used at all. */
    longest = image->width > height ? image->width : height;
    for (full = 1; longest > 1; longest >>= 1) full++;
    if ((plan->end < full && !caps->level_limit) || (!pot && !caps->npot)) plan->end = (uint8_t)(plan->first + 1);

    plan->mag_filter = GLES_LINEAR;
    plan->min_filter = plan->end - plan->first > 1 ? GLES_LINEAR_MIPMAP_LINEAR : GLES_LINEAR;
    if (role == NACRE_ROLE_INDEX) { /* numbers have no mean */
        plan->mag_filter = GLES_NEAREST;
        plan->min_filter = plan->end - plan->first > 1 ? GLES_NEAREST_MIPMAP_NEAREST : GLES_NEAREST;
    }
    plan->wrap = shade_role_has_uv((int)role) && (pot || caps->npot) ? GLES_REPEAT : GLES_CLAMP_TO_EDGE;
    return NACRE_OK;
}

/* Bytes of one layer as planned. */
static uint32_t plan_bytes(const nacre_image *image, const upload_plan *plan)
{
    uint32_t sum = 0, size;
    unsigned level;
    for (level = plan->first; level < plan->end; level++)
        if (nacre_image_texels(image, level, 0, 0, &size)) sum += size;
    return sum;
}

nacre_result gles_texture_cost(const gles_caps *caps, const nacre_image *image, unsigned role, uint32_t *bytes)
{
    upload_plan plan;
    nacre_result result = make_plan(caps, image, role, &plan);
    if (result) return result;
    *bytes = plan_bytes(image, &plan) * image->layers;
    return NACRE_OK;
}

static void upload_level(const gles_procs *gl, const nacre_image *image, const upload_plan *plan, unsigned level,
                         unsigned layer)
{
    uint32_t size = 0;
    const uint8_t *texels = nacre_image_texels(image, level, layer, 0, &size);
    const gl_sizei w = (gl_sizei)level_side(image->width, level),
                   h = (gl_sizei)level_side(image->height, level) * (gl_sizei)plan->stacked;
    const gl_int at = (gl_int)(level - plan->first);
    if (plan->type)
        gl->TexImage2D(GLES_TEXTURE_2D, at, (gl_int)plan->format, w, h, 0, plan->format, plan->type, texels);
    else
        gl->CompressedTexImage2D(GLES_TEXTURE_2D, at, plan->format, w, h, 0, (gl_sizei)(size * plan->stacked), texels);
}

nacre_result gles_texture_upload(nacre_gles *gles, gles_texture *texture)
{
    const gles_procs *gl = &gles->gl;
    upload_plan plan;
    unsigned level;
    nacre_result result = make_plan(&gles->caps, texture->image, texture->role, &plan);
    if (result) return result;
    texture->name = 0;
    gl->GenTextures(1, &texture->name);
    if (!texture->name) return gles_gl_failed(gles, "glGenTextures");
    gl->BindTexture(GLES_TEXTURE_2D, texture->name);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_MIN_FILTER, plan.min_filter);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_MAG_FILTER, plan.mag_filter);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_WRAP_S, plan.wrap);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_WRAP_T, plan.wrap);
    if (gles->caps.level_limit) gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_MAX_LEVEL, plan.end - plan.first - 1);
    for (level = plan.first; level < plan.end; level++) upload_level(gl, texture->image, &plan, level, texture->layer);
    return gles_check(gles, "texture upload");
}

nacre_result gles_mesh_upload(nacre_gles *gles, gles_item *item)
{
    const gles_procs *gl = &gles->gl;
    const nacre_mesh *mesh = &item->is.mesh;
    gl->GenBuffers(1, &item->vertex_buffer);
    if (!item->vertex_buffer) return gles_gl_failed(gles, "glGenBuffers");
    gl->GenBuffers(1, &item->index_buffer);
    if (!item->index_buffer) return gles_gl_failed(gles, "glGenBuffers");
    gl->BindBuffer(GLES_ARRAY_BUFFER, item->vertex_buffer);
    gl->BufferData(GLES_ARRAY_BUFFER, (gl_sizeiptr)(mesh->vertex_count * sizeof *mesh->vertices), mesh->vertices,
                   GLES_STATIC_DRAW);
    gl->BindBuffer(GLES_ELEMENT_ARRAY_BUFFER, item->index_buffer);
    gl->BufferData(GLES_ELEMENT_ARRAY_BUFFER, (gl_sizeiptr)(mesh->index_count * sizeof *mesh->indices), mesh->indices,
                   GLES_STATIC_DRAW);
    return gles_check(gles, "mesh upload");
}

void gles_mesh_delete(nacre_gles *gles, gles_item *item)
{
    if (item->vertex_buffer) gles->gl.DeleteBuffers(1, &item->vertex_buffer);
    if (item->index_buffer) gles->gl.DeleteBuffers(1, &item->index_buffer);
    item->vertex_buffer = item->index_buffer = 0;
}
