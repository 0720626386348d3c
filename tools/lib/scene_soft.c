/* SPDX-License-Identifier: MIT */
/* Shots through the CPU renderer: the frame in one piece, rows given to as many threads as OpenMP has. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nacre_soft.h"
#include "scene_numbers.h"

#define BAND_ROWS  16
#define MESH_QUADS 16383 /* with 16-bit indices */

static int check(nacre_result r, const char *what, failure *f)
{
    const int code = r == NACRE_ERR_ASSET         ? FAIL_INVALID
                     : r == NACRE_ERR_UNSUPPORTED ? FAIL_UNSUPPORTED
                                                  : FAIL_INTERNAL;

    return r == NACRE_OK ? FAIL_NONE : fail(f, code, "%s: %s", what, nacre_result_text(r));
}

/* Of the line that says what can't be drawn. */
static const char *subject_of(const nacre_material *material)
{
    return material->model == NACRE_MODEL_PALETTE ? "palettes by the CPU renderer" : "the CPU renderer";
}

const nacre_soft_kernels *scene_soft_kernels(const char *name)
{
    const int best = !strcmp(name, "best");

#if defined(__x86_64__)
    __builtin_cpu_init();
    if ((best || !strcmp(name, "avx2")) && __builtin_cpu_supports("avx2")) return &nacre_soft_avx2;
    if ((best || !strcmp(name, "sse41")) && __builtin_cpu_supports("sse4.1")) return &nacre_soft_sse41;
#elif defined(__ARM_NEON)
    if (best || !strcmp(name, "neon")) return &nacre_soft_neon;
#endif
    return best || !strcmp(name, "portable") ? &nacre_soft_portable : NULL;
}

/* Rows y0..y1-1. */
static nacre_result draw_bands(const nacre_soft *soft, const nacre_soft_desc *desc, int y0, int y1, image_u8 *out)
{
    const size_t scratch_size = nacre_soft_scratch_size(desc), stride = (size_t)desc->width * 4;
    nacre_result result = NACRE_OK;

#pragma omp parallel
    {
        void *scratch = need_memory(1, scratch_size);
        int y;
#pragma omp for schedule(dynamic)
        for (y = y0 / BAND_ROWS * BAND_ROWS; y < y1; y += BAND_ROWS) {
            const int end = y + BAND_ROWS < desc->height ? y + BAND_ROWS : desc->height;
            const nacre_result r =
                nacre_soft_band(soft, y, end, scratch, scratch_size, out->texel + (size_t)y * stride, stride);
            if (r) {
#pragma omp critical
                result = r;
            }
        }
        free(scratch);
    }
    return result;
}

/* Some items on rows y0..y1-1. */
static int draw_items(const scene *s, const nacre_view *view, const nacre_soft_item *items, int count, int y0, int y1,
                      image_u8 *out, failure *f)
{
    nacre_soft_desc desc = {.width = (uint16_t)s->width,
                            .height = (uint16_t)s->height,
                            .format = NACRE_SOFT_RGBA8,
                            .band_rows = BAND_ROWS,
                            .max_items = (uint16_t)count,
                            .max_lights = NACRE_MAX_LIGHTS,
                            .table_columns = 64,
                            .fine = 1,
                            .kernels = scene_soft_kernels("best")};
    nacre_soft *soft;
    void *block;
    int i, code;

    for (i = 0; i < count; i++) {
        desc.max_vertices += items[i].mesh->vertex_count;
        desc.max_triangles += items[i].mesh->index_count / 3;
    }
    block = need_memory(1, nacre_soft_size(&desc));
    code = check(nacre_soft_init(&soft, block, nacre_soft_size(&desc), &desc), "nacre_soft_init", f);
    if (!code) {
        nacre_soft_scissor(soft, 0, y0, s->width, y1);
        code = check(nacre_soft_prepare(soft, items, count, view), subject_of(items[0].material), f);
    }
    if (!code) code = check(draw_bands(soft, &desc, y0, y1, out), "nacre_soft_band", f);
    free(block);
    return code;
}

/* lit: texels NULL: shaded directly. */
static nacre_soft_item item_of(const nacre_mesh *shape, const nacre_material *material, const nacre_soft_lit *lit,
                               const nacre_view *view)
{
    return (nacre_soft_item){.mesh = shape,
                             .material = material,
                             .lit = lit->texels ? lit : NULL,
                             .object_to_view = view->object_to_view,
                             .cull = NACRE_SOFT_CULL_NONE};
}

/* All lights into a picture, where the scene asks for one; pixels take the nearest texel, so 256 by default. The texels are
   the caller's to free. */
static int make_lit(nacre_soft_lit *out, const scene *s, const nacre_view *view, const nacre_material *material,
                    const nacre_q16 centre[3], failure *f)
{
    const nacre_soft_lit_desc desc = {.material = material,
                                      .view = view,
                                      .centre = {centre[0], centre[1], centre[2]},
                                      .size = (uint16_t)(s->lit_size ? s->lit_size : 256),
                                      .format = NACRE_SOFT_RGBA8,
                                      .kernels = scene_soft_kernels("best")};
    const size_t scratch_size = nacre_soft_lit_scratch_size(&desc, desc.size);
    void *texels, *scratch;
    int code;

    *out = (nacre_soft_lit){0};
    if (!s->distant && !s->lit_size) return FAIL_NONE;
    texels = need_memory((size_t)desc.size * desc.size, 4);
    scratch = need_memory(1, scratch_size);
    code = check(nacre_soft_lit_rows(&desc, texels, 0, desc.size, scratch, scratch_size),
                 "a lit sphere of this material on the CPU", f);
    free(scratch);
    *out = (nacre_soft_lit){texels, desc.size};
    return code;
}

static void free_lit(nacre_soft_lit *lit)
{
    free((void *)(uintptr_t)lit->texels);
}

static int draw_mesh(const scene *s, const nacre_view *view, const nacre_material *material, image_u8 *out, failure *f)
{
    nacre_mesh *parts;
    nacre_soft_item items[255];
    nacre_soft_lit lit = {0};
    int count, i, code = mesh_pack(s->shape, &parts, &count, f);

    if (code) return code;
    if (count > 255)
        code = fail(f, FAIL_UNSUPPORTED, "mesh of %d parts: this backend draws 255", count);
    else
        code = make_lit(&lit, s, view, material, parts->centre, f);
    for (i = 0; i < count && i < 255; i++) items[i] = item_of(&parts[i], material, &lit, view);
    if (!code) code = draw_items(s, view, items, count, 0, s->height, out, f);
    free_lit(&lit);
    free(parts);
    return code;
}

/* ---- the exact sphere: a quad per covered pixel, with the one normal of its centre ------------------------------- */

#define QUAD_EXTENT 2.0 /* positions of the quads: within +- this */

static void set_quad(nacre_vertex quad[4], const scene *s, const double clip_to_object[16], int i, int j,
                     const scene_hit *hit)
{
    int corner, k;

    for (corner = 0; corner < 4; corner++) {
        nacre_vertex *v = &quad[corner];
        double clip[4] = {2.0 * (i + (corner & 1)) / s->width - 1, 1 - 2.0 * (j + (corner >> 1)) / s->height,
                          hit->z_ndc, 1};
        double p[4];
        matrix_apply(p, clip_to_object, clip);
        for (k = 0; k < 3; k++) {
            v->position[k] = (int16_t)lrint(32767 * p[k] / p[3] / QUAD_EXTENT);
            v->normal[k] = (int16_t)lrint(32767 * hit->normal[k]);
            v->tangent[k] = (int8_t)lrint(127 * hit->tangent[k]);
        }
        v->tangent[3] = 127;
        v->uv[0] = (int16_t)lrint(2048 * hit->uv[0]);
        v->uv[1] = (int16_t)lrint(2048 * hit->uv[1]);
    }
}

static void make_indices(uint16_t *index)
{
    static const uint16_t corner[6] = {0, 2, 3, 0, 3, 1};
    int i;

    for (i = 0; i < MESH_QUADS * 6; i++) index[i] = (uint16_t)(4 * (i / 6) + corner[i % 6]);
}

/* One mesh's worth of rows from *row on. */
static int fill_quads(const scene *s, const double clip_to_object[16], int *row, nacre_vertex *vertices)
{
    int i, quads = 0;

    for (; *row < s->height && quads + s->width <= MESH_QUADS; ++*row)
        for (i = 0; i < s->width; i++) {
            scene_hit hit;
            if (scene_sphere_hit(s, clip_to_object, i, *row, &hit))
                set_quad(vertices + 4 * quads++, s, clip_to_object, i, *row, &hit);
        }
    return quads;
}

static int draw_sphere(const scene *s, const nacre_view *view, const nacre_material *material, image_u8 *out,
                       failure *f)
{
    nacre_vertex *vertices = need_memory(MESH_QUADS * 4, sizeof *vertices);
    uint16_t *indices = need_memory(MESH_QUADS * 6, sizeof *indices);
    nacre_mesh quads_of = {.vertices = vertices, .indices = indices};
    nacre_soft_lit lit = {0};
    double clip_to_object[16];
    int k, row = 0, code = FAIL_NONE;

    make_indices(indices);
    for (k = 0; k < 3; k++) quads_of.half_extent[k] = (nacre_q16)(QUAD_EXTENT * 65536);
    if (!scene_clip_to_object(s, clip_to_object)) code = fail(f, FAIL_USAGE, "the camera's matrix has no inverse");
    if (!code) code = make_lit(&lit, s, view, material, quads_of.centre, f);
    progress_begin(s->progress, "rows", s->height);
    while (!code && row < s->height) {
        const int first = row, quads = fill_quads(s, clip_to_object, &row, vertices);
        const nacre_soft_item item = item_of(&quads_of, material, &lit, view);

        quads_of.vertex_count = (uint16_t)(4 * quads);
        quads_of.index_count = 6 * (uint32_t)quads;
        if (quads) code = draw_items(s, view, &item, 1, first, row, out, f);
        progress_add(s->progress, row - first);
    }
    progress_end(s->progress);
    free_lit(&lit);
    free(vertices);
    free(indices);
    return code;
}

int scene_draw_soft(const scene *s, const nacre_material *material, image_u8 *out, failure *f)
{
    scene_numbers numbers;
    int code;

    *out = image_u8_make(s->width, s->height, 4);
    memset(out->texel, 0, (size_t)s->width * (size_t)s->height * 4);
    scene_numbers_open(&numbers, s);
    code = s->exact_sphere ? draw_sphere(&numbers.scaled, &numbers.view, material, out, f)
                           : draw_mesh(&numbers.scaled, &numbers.view, material, out, f);
    scene_numbers_close(&numbers);
    if (code) image_u8_free(out);
    return code;
}
