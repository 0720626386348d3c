/* SPDX-License-Identifier: MIT */
/*
 * Built with NACRE_NO_... switches by left_out.sh, with all files of the runtime: what needs a part that was left out
 * answers NACRE_ERR_UNSUPPORTED, and nothing else does. Run from the top of the tree.
 */
#include <stdio.h>

#include "nacre_soft.h"

enum {
#ifdef NACRE_NO_TABLES
    TABLES = 0,
#else
    TABLES = 1,
#endif
#ifdef NACRE_NO_FINE
    FINE = 0,
#else
    FINE = TABLES,
#endif
#ifdef NACRE_NO_SPHERES
    SPHERES = 0,
#else
    SPHERES = 1,
#endif
#ifdef NACRE_NO_MAPS
    MAPS = 0,
#else
    MAPS = 1,
#endif
#ifdef NACRE_NO_SBRDF
    SBRDF = 0,
#else
    SBRDF = MAPS,
#endif
#ifdef NACRE_NO_NEAR
    NEAR_VIEWS = 0
#else
    NEAR_VIEWS = 1
#endif
};

static uint32_t file[2][4096], block[16384];
static nacre_image image[2];

static const nacre_image *opened(int i, const char *path)
{
    FILE *f = fopen(path, "rb");
    const size_t size = f ? fread(file[i], 1, sizeof file[i], f) : 0;
    if (f) fclose(f);
    return nacre_image_open(&image[i], file[i], size) ? NULL : &image[i];
}

/* One triangle of it in a frame of 8 x 8. */
static nacre_result prepared(const nacre_material *material, nacre_light_type type, int blend)
{
    static const nacre_vertex corner[3] = {
        {.normal = {0, 0, 32767}, .tangent = {127, 0, 0, 127}},
        {.normal = {0, 0, 32767}, .tangent = {127, 0, 0, 127}, .position = {32767}},
        {.normal = {0, 0, 32767}, .tangent = {127, 0, 0, 127}, .position = {0, 32767}}};
    static const uint16_t index[3] = {0, 1, 2};
    static const float one[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -3, 1};
    static const float box[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.25f, 0, 0, 0, -1, 1};
    const nacre_mesh mesh = {.vertices = corner,
                             .indices = index,
                             .index_count = 3,
                             .vertex_count = 3,
                             .half_extent = {NACRE_Q16_ONE, NACRE_Q16_ONE, NACRE_Q16_ONE}};
    const nacre_light light = {.type = (uint8_t)type,
                               .direction = nacre_dir_from_float(0, 0.6f, 0.8f),
                               .power = nacre_rgb_from_float(1, 1, 1)};
    const nacre_view view = {.view_to_clip = nacre_mat4_from_float(box),
                             .lights = &light,
                             .light_count = 1,
                             .object_to_view = nacre_mat4_from_float(one),
                             .exposure = NACRE_Q16_ONE};
    const nacre_soft_item item = {
        .mesh = &mesh, .material = material, .blend = (uint8_t)blend, .object_to_view = nacre_mat4_from_float(one)};
    const nacre_soft_desc desc = {
        .width = 8, .height = 8, .max_vertices = 3, .max_triangles = 1, .fine = 1, .blend = 1};
    nacre_soft *soft;
    const nacre_result r = nacre_soft_init(&soft, block, sizeof block, &desc);
    return r ? r : nacre_soft_prepare(soft, &item, 1, &view);
}

/* otherwise: the answer where the part is there. */
static int wrong(const char *what, int there, nacre_result otherwise, nacre_result found)
{
    const nacre_result expected = there ? otherwise : NACRE_ERR_UNSUPPORTED;

    if (found != expected) fprintf(stderr, "left out: %s: answered %d, expected %d\n", what, (int)found, (int)expected);
    return found != expected;
}

int main(void)
{
    nacre_material table = {.model = NACRE_MODEL_TABLE}, fine = table, spheres = {.model = NACRE_MODEL_SPHERES};
    nacre_material sbrdf = {.model = NACRE_MODEL_SBRDF};
    int bad = 0;

    fine.image[NACRE_ROLE_TABLE] = opened(0, "fixtures/asset/v1-table-two.ktx2");
    bad += wrong("a table of two layers", FINE, NACRE_OK, prepared(&fine, NACRE_LIGHT_DIRECTIONAL, 0));
    spheres.image[NACRE_ROLE_SPHERES] = opened(0, "fixtures/asset/v1-spheres.ktx2");
    bad += wrong("spheres", SPHERES, NACRE_OK, prepared(&spheres, NACRE_LIGHT_DIRECTIONAL, 0));
    sbrdf.image[NACRE_ROLE_ALBEDO] = sbrdf.image[NACRE_ROLE_LOBES] = spheres.image[NACRE_ROLE_SPHERES]; /* neither is */
    bad += wrong("maps of lobes", SBRDF, NACRE_ERR_ASSET, prepared(&sbrdf, NACRE_LIGHT_DIRECTIONAL, 0));
    table.image[NACRE_ROLE_TABLE] = opened(0, "fixtures/asset/v1-table-rows.ktx2");
    bad += wrong("a table", TABLES, NACRE_OK, prepared(&table, NACRE_LIGHT_DIRECTIONAL, 0));
    bad += wrong("a point light", TABLES && NEAR_VIEWS, NACRE_OK, prepared(&table, NACRE_LIGHT_POINT, 0));
    bad += wrong("blending", TABLES && MAPS, NACRE_OK, prepared(&table, NACRE_LIGHT_DIRECTIONAL, 128));
    table.image[NACRE_ROLE_NORMAL] = opened(1, "fixtures/asset/v1-normal.ktx2");
    bad += wrong("a normal map", TABLES && MAPS, NACRE_OK, prepared(&table, NACRE_LIGHT_DIRECTIONAL, 0));
    return bad != 0;
}
