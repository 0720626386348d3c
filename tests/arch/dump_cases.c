/* SPDX-License-Identifier: MIT */
/* dump_cases OUT: the case table's scenes, which hash_cases.c draws, as little-endian 32-bit words. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "scene_numbers.h"

static FILE *out;

static void word(uint32_t x)
{
    const uint8_t b[4] = {(uint8_t)x, (uint8_t)(x >> 8), (uint8_t)(x >> 16), (uint8_t)(x >> 24)};

    fwrite(b, 1, 4, out);
}

static void words(const int32_t *x, int count)
{
    int i;

    for (i = 0; i < count; i++) word((uint32_t)x[i]);
}

static void rgb(nacre_rgb c)
{
    word((uint32_t)c.r);
    word((uint32_t)c.g);
    word((uint32_t)c.b);
}

static void file_of(const nacre_image *image)
{
    static const uint8_t zero[4];

    word(image ? image->size : 0);
    if (!image) return;
    fwrite(image->bytes, 1, image->size, out);
    fwrite(zero, 1, (4 - image->size % 4) % 4, out);
}

static void put_view(const nacre_view *v)
{
    int i;

    words(v->object_to_view.m, 16);
    words(v->view_to_clip.m, 16);
    word(v->output);
    word(v->distant_viewer);
    word((uint32_t)v->exposure);
    rgb(v->ambient);
    rgb(v->tint);
    word(v->light_count);
    for (i = 0; i < v->light_count; i++) {
        const nacre_light *l = &v->lights[i];
        word(l->type);
        word((uint32_t)l->shadow);
        word((uint32_t)l->direction.x);
        word((uint32_t)l->direction.y);
        word((uint32_t)l->direction.z);
        words(l->position, 3);
        rgb(l->power);
    }
}

static void put_mesh(const nacre_mesh *m)
{
    uint32_t i;
    int k;

    word(m->vertex_count);
    word(m->index_count);
    words(m->centre, 3);
    words(m->half_extent, 3);
    for (i = 0; i < m->vertex_count; i++) {
        const nacre_vertex *v = &m->vertices[i];
        for (k = 0; k < 4; k++) word((uint32_t)v->position[k]);
        for (k = 0; k < 4; k++) word((uint32_t)v->normal[k]);
        for (k = 0; k < 4; k++) word((uint32_t)v->tangent[k]);
        for (k = 0; k < 2; k++) word((uint32_t)v->uv[k]);
    }
    for (i = 0; i < m->index_count; i++) word(m->indices[i]);
}

static int put_case(const frame_case *c)
{
    scene_numbers numbers;
    case_asset asset;
    nacre_mesh *parts;
    failure f = {0};
    scene s;
    mesh shape;
    int count;

    if (c->lit || c->model == CASE_PALETTE || c->model == CASE_PALETTE_BLEND)
        return 0; /* palettes: not drawn on the CPU */
    if (mesh_open(&shape, c->mesh ? c->mesh : "sphere", &f)) exit(1);
    case_asset_open(&asset, c->model, c->brdf, c->normal_map, NULL);
    case_scene(&s, c, &shape, 96, 96);
    s.exact_sphere = 0;
    scene_numbers_open(&numbers, &s);
    if (mesh_pack(numbers.scaled.shape, &parts, &count, &f) || count != 1) exit(1);
    word(1);
    put_view(&numbers.view);
    word((uint32_t)asset.material.model);
    file_of(asset.material.image[NACRE_ROLE_TABLE]);
    file_of(asset.material.image[NACRE_ROLE_SPHERES]);
    file_of(asset.material.image[NACRE_ROLE_NORMAL]);
    file_of(asset.material.image[NACRE_ROLE_ALBEDO]);
    file_of(asset.material.image[NACRE_ROLE_LOBES]);
    put_mesh(&parts[0]);
    free(parts);
    scene_numbers_close(&numbers);
    case_asset_close(&asset);
    mesh_free(&shape);
    return 1;
}

int main(int argc, char **argv)
{
    int i, count = 0;

    out = argc == 2 ? fopen(argv[1], "wb") : NULL;
    if (!out) return 1;
    for (i = 0; i < frame_case_count; i++) count += put_case(&frame_cases[i]);
    word(0);
    printf("%d cases\n", count);
    return fclose(out) != 0;
}
