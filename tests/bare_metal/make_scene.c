/* SPDX-License-Identifier: MIT */
/* make_scene OUT.c: the teapot of 992 triangles, a table and a lit sphere as arrays for the bare-metal example. */
#include <stdio.h>
#include <stdlib.h>

#include "lit_sphere.h"
#include "mesh.h"
#include "mesh_inner.h"
#include "scene.h"
#include "scene_example.h"
#include "table_bake.h"

static void need(int code, const failure *f)
{
    if (!code) return;
    fprintf(stderr, "%s\n", f->text);
    exit(1);
}

static void write_bytes(FILE *out, const char *name, const uint8_t *data, size_t size)
{
    size_t i;

    fprintf(out, "const unsigned char %s[%zu] = {", name, size);
    for (i = 0; i < size; i++) fprintf(out, "%u,", data[i]);
    fprintf(out, "};\nconst unsigned %s_size = %zu;\n", name, size);
}

static void write_mesh(FILE *out, const nacre_mesh *m)
{
    uint32_t i;
    int k;

    fprintf(out, "static const nacre_vertex vertices[] = {");
    for (i = 0; i < m->vertex_count; i++) {
        const nacre_vertex *v = &m->vertices[i];
        fprintf(out, "{{%d,%d,%d,0},{%d,%d,%d,0},{%d,%d,%d,%d},{%d,%d}},", v->position[0], v->position[1],
                v->position[2], v->normal[0], v->normal[1], v->normal[2], v->tangent[0], v->tangent[1], v->tangent[2],
                v->tangent[3], v->uv[0], v->uv[1]);
    }
    fprintf(out, "};\nstatic const uint16_t indices[] = {");
    for (i = 0; i < m->index_count; i++) fprintf(out, "%u,", m->indices[i]);
    fprintf(out, "};\nconst nacre_mesh example_mesh = {vertices, indices, %u, %u, {%d,%d,%d}, {", m->index_count,
            m->vertex_count, m->centre[0], m->centre[1], m->centre[2]);
    for (k = 0; k < 3; k++) fprintf(out, "%d,", m->half_extent[k]);
    fprintf(out, "}};\n");
}

/* The same view as the example's, so its lights are on the sphere. */
static void write_lit(FILE *out, const nacre_image *table, const nacre_mesh *m)
{
    static uint8_t scratch[1 << 20];
    const uint8_t *const layers[2] = {nacre_image_texels(table, 0, 0, 0, NULL), NULL};
    nacre_material material = {.model = NACRE_MODEL_TABLE, .image = {table}};
    const shade_lit_kernels kernels = {shade_table_add, shade_encode};
    shade_material decoded;
    nacre_view view;
    nacre_light lights[EXAMPLE_LIGHTS];
    shade_lit lit = {.view = &view, .material = &decoded, .layers = layers, .size = EXAMPLE_LIT, .kernels = &kernels};
    const uint32_t *codes;
    unsigned i;

    example_view(&view, lights, 3);
    for (i = 0; i < 3; i++) lit.centre[i] = m->centre[i];
    if (shade_material_read(&decoded, &material) || shade_lit_scratch(&lit, EXAMPLE_LIT) > sizeof scratch) exit(1);
    codes = shade_lit_rows(&lit, 0, EXAMPLE_LIT, scratch);
    fprintf(out, "const uint16_t example_lit[%d] = {", EXAMPLE_LIT * EXAMPLE_LIT);
    for (i = 0; i < EXAMPLE_LIT * EXAMPLE_LIT; i++)
        fprintf(out, "%u,", (codes[i] & 248) << 8 | (codes[i] >> 5 & 0x7E0) | (codes[i] >> 19 & 31));
    fprintf(out, "};\n");
}

int main(int argc, char **argv)
{
    failure f = {0};
    table_asset t = {0};
    bytes file = {0};
    nacre_image image;
    nacre_mesh *parts;
    mesh m;
    brdf *b;
    int count;
    FILE *out = argc == 2 ? fopen(argv[1], "w") : NULL;

    if (!out) return 1;
    mesh_teapot(&m, 4);
    need(mesh_pack(&m, &parts, &count, &f), &f);
    need(brdf_open(&b, "sgd:gold-metallic-paint", &f), &f);
    need(table_bake(&t, b, &(table_options){0}, &f), &f);
    t.toe = 0; /* the display form is what is counted */
    table_write(&t, &file);
    fprintf(out, "#include \"scene_example.h\"\n");
    write_bytes(out, "example_table", file.data, file.size);
    write_mesh(out, &parts[0]);
    if (nacre_image_open(&image, file.data, file.size)) return 1;
    write_lit(out, &image, &parts[0]);
    brdf_close(b);
    table_free(&t);
    bytes_free(&file);
    mesh_free(&m);
    free(parts);
    return fclose(out) != 0;
}
