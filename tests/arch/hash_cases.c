/* SPDX-License-Identifier: MIT */
/* hash_cases IN [KERNELS]: draw what dump_cases wrote, one FNV-1a hash a frame and format. C99 and the runtime alone, so
   that it builds for any machine: the output must be the same on all. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nacre_soft.h"

static FILE *in;

static uint32_t word(void)
{
    uint8_t b[4];

    if (fread(b, 1, 4, in) != 4) exit(2);
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static int32_t number(void)
{
    return (int32_t)word();
}

static nacre_rgb rgb(void)
{
    nacre_rgb c;

    c.r = number();
    c.g = number();
    c.b = number();
    return c;
}

static const nacre_image *file_of(nacre_image *image)
{
    const uint32_t size = word();
    uint8_t *bytes;

    if (!size) return NULL;
    bytes = malloc(size + 4);
    if (!bytes || fread(bytes, 1, (size + 3) / 4 * 4, in) != (size + 3) / 4 * 4) exit(2);
    if (nacre_image_open(image, bytes, size)) exit(3);
    return image;
}

static void get_view(nacre_view *v, nacre_light *lights)
{
    int i, k;

    memset(v, 0, sizeof *v);
    for (i = 0; i < 16; i++) v->object_to_view.m[i] = number();
    for (i = 0; i < 16; i++) v->view_to_clip.m[i] = number();
    v->output = (uint8_t)word();
    v->distant_viewer = (uint8_t)word();
    v->exposure = number();
    v->ambient = rgb();
    v->tint = rgb();
    v->light_count = (uint16_t)word();
    v->lights = lights;
    for (i = 0; i < v->light_count; i++) {
        memset(&lights[i], 0, sizeof lights[i]);
        lights[i].type = (uint8_t)word();
        lights[i].shadow = (nacre_q14)number();
        lights[i].direction.x = (nacre_q14)number();
        lights[i].direction.y = (nacre_q14)number();
        lights[i].direction.z = (nacre_q14)number();
        for (k = 0; k < 3; k++) lights[i].position[k] = number();
        lights[i].power = rgb();
    }
}

static void get_mesh(nacre_mesh *m)
{
    nacre_vertex *v;
    uint16_t *index;
    uint32_t i;
    int k;

    m->vertex_count = (uint16_t)word();
    m->index_count = word();
    for (k = 0; k < 3; k++) m->centre[k] = number();
    for (k = 0; k < 3; k++) m->half_extent[k] = number();
    v = malloc(m->vertex_count * sizeof *v);
    index = malloc(m->index_count * sizeof *index);
    if (!v || !index) exit(2);
    for (i = 0; i < m->vertex_count; i++) {
        for (k = 0; k < 4; k++) v[i].position[k] = (int16_t)number();
        for (k = 0; k < 4; k++) v[i].normal[k] = (int16_t)number();
        for (k = 0; k < 4; k++) v[i].tangent[k] = (int8_t)number();
        for (k = 0; k < 2; k++) v[i].uv[k] = (int16_t)number();
    }
    for (i = 0; i < m->index_count; i++) index[i] = (uint16_t)word();
    m->vertices = v;
    m->indices = index;
}

/* Native words of a pixel in the byte order of the others. */
static uint32_t hash_of(const uint8_t *pixels, size_t size, unsigned format)
{
    const uint16_t one = 1;
    const int turn = format <= NACRE_SOFT_RGB565_SWAPPED && *(const uint8_t *)&one == 0;
    uint32_t hash = 2166136261u;
    size_t i;

    for (i = 0; i < size; i++) hash = (hash ^ pixels[turn ? i ^ 1 : i]) * 16777619u;
    return hash;
}

static int draw(const nacre_soft_item *item, const nacre_view *view, unsigned format, const nacre_soft_kernels *kernels)
{
    nacre_soft_desc desc;
    nacre_soft *soft;
    void *block, *scratch;
    uint8_t *pixels;
    size_t size;
    int r;

    memset(&desc, 0, sizeof desc);
    desc.width = desc.height = 96;
    desc.format = (uint8_t)format;
    desc.dither = format == NACRE_SOFT_RGB565;
    desc.max_lights = 8;
    desc.table_columns = 64;
    desc.fine = 1;
    desc.max_vertices = item->mesh->vertex_count;
    desc.max_triangles = item->mesh->index_count / 3;
    desc.kernels = kernels;
    block = malloc(nacre_soft_size(&desc));
    scratch = malloc(nacre_soft_scratch_size(&desc));
    size = 96 * 96 * (format == NACRE_SOFT_RGBA8 ? 4u : format == NACRE_SOFT_GRAY8 ? 1u : 2u);
    pixels = malloc(size);
    r = nacre_soft_init(&soft, block, nacre_soft_size(&desc), &desc);
    if (!r) r = nacre_soft_prepare(soft, item, 1, view);
    if (!r) r = nacre_soft_frame(soft, scratch, nacre_soft_scratch_size(&desc), pixels, size / 96);
    if (r)
        printf("%d ", r);
    else
        printf("%08lx ", (unsigned long)hash_of(pixels, size, format));
    free(block);
    free(scratch);
    free(pixels);
    return r;
}

int main(int argc, char **argv)
{
    const nacre_soft_kernels *kernels = &nacre_soft_portable;
    nacre_image image[5];
    nacre_light lights[8];

    in = argc > 1 ? fopen(argv[1], "rb") : NULL;
    if (!in) return 1;
#if defined(__AVX2__)
    if (argc > 2 && !strcmp(argv[2], "avx2")) kernels = &nacre_soft_avx2;
#endif
#if defined(__SSE4_1__)
    if (argc > 2 && !strcmp(argv[2], "sse41")) kernels = &nacre_soft_sse41;
#endif
#if defined(__ARM_NEON)
    if (argc > 2 && !strcmp(argv[2], "neon")) kernels = &nacre_soft_neon;
#endif
#if defined(__ARM_FEATURE_DSP) && defined(__thumb2__)
    if (argc > 2 && !strcmp(argv[2], "dsp")) kernels = &nacre_soft_dsp;
#endif
    if (argc > 2 && strcmp(argv[2], "portable") && kernels == &nacre_soft_portable) return 1;
    while (word()) {
        nacre_material material;
        nacre_soft_item item;
        nacre_mesh mesh;
        nacre_view view;
        unsigned format;

        memset(&material, 0, sizeof material);
        memset(&item, 0, sizeof item);
        get_view(&view, lights);
        material.model = (nacre_model)word();
        material.image[NACRE_ROLE_TABLE] = file_of(&image[0]);
        material.image[NACRE_ROLE_SPHERES] = file_of(&image[1]);
        material.image[NACRE_ROLE_NORMAL] = file_of(&image[2]);
        material.image[NACRE_ROLE_ALBEDO] = file_of(&image[3]);
        material.image[NACRE_ROLE_LOBES] = file_of(&image[4]);
        get_mesh(&mesh);
        item.mesh = &mesh;
        item.material = &material;
        item.object_to_view = view.object_to_view;
        item.cull = NACRE_SOFT_CULL_NONE;
        for (format = 0; format < 4; format++) draw(&item, &view, format, kernels);
        printf("\n");
        fflush(stdout);
    }
    return 0;
}
