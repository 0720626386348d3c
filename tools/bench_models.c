/* SPDX-License-Identifier: MIT */
/* The models, shaded directly: milliseconds of CPU and wall time a frame, through the runtime, on this machine's drivers. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "nacre_asset.h"
#include "nacre_gles.h"
#include "sphere_bake.h"
#include "table_bake.h"

enum { MAX_ROWS = 32 };

typedef struct bench_row {
    const char *model;
    int lights;
    nacre_gles_item item[BENCH_MAX_PARTS];
} bench_row;

typedef struct bench {
    gl_headless *gl;
    nacre_gles *gles;
    void *block;
    bench_gl device;
    bench_mesh mesh;
    nacre_image image[3];
    bytes file[3];
    bench_row row[MAX_ROWS];
    bench_time time[MAX_ROWS];
    int row_count;
} bench;

/* Table, fine table and spheres of one BRDF, baked in memory. */
static int bake_images(bench *b, const char *name, failure *f)
{
    brdf *source;
    int code = brdf_open(&source, name, f);
    if (code) return code;
    for (int i = 0; i < 2 && !code; i++) {
        table_options options = {.tier = i ? TABLE_FINE : TABLE_DEFAULT};
        table_asset t;
        if ((code = table_bake(&t, source, &options, f))) break;
        table_write(&t, &b->file[i]);
        table_free(&t);
    }
    sphere_options options = {0};
    sphere_asset s;
    if (!code && !(code = sphere_bake(&s, source, &options, f))) {
        sphere_write(&s, &b->file[2]);
        sphere_free(&s);
    }
    brdf_close(source);
    for (int i = 0; i < 3 && !code; i++)
        if (nacre_image_open(&b->image[i], b->file[i].data, b->file[i].size))
            code = fail(f, FAIL_INTERNAL, "a baked file is refused by the runtime");
    return code;
}

static int add_rows(bench *b, failure *f)
{
    static const char *const names[3] = {"table", "fine", "spheres"};
    static const int lights[] = {1, 2, 4, 8};
    for (int model = 0; model < 3; model++) {
        nacre_material material = {.model = model == 2 ? NACRE_MODEL_SPHERES : NACRE_MODEL_TABLE};
        material.image[model == 2 ? NACRE_ROLE_SPHERES : NACRE_ROLE_TABLE] = &b->image[model];
        nacre_gles_item item[BENCH_MAX_PARTS] = {{0}};
        for (int p = 0; p < b->mesh.part_count; p++) {
            int code = bench_check(nacre_gles_add(b->gles, &b->mesh.parts[p], &material, &item[p]), names[model], f);
            if (code) return code;
        }
        for (int i = 0; i < 4; i++) {
            bench_row *row = &b->row[b->row_count++];
            row->model = names[model];
            row->lights = lights[i];
            memcpy(row->item, item, sizeof item);
        }
    }
    return FAIL_NONE;
}

static int draw_row(void *user, int index, failure *f)
{
    bench *b = user;
    const bench_row *row = &b->row[index];
    nacre_light light[8];
    nacre_view view;
    bench_view(&view, light, row->lights, 0);
    gl_headless_clear(b->gl, 0, 0, 0, 0);
    for (int p = 0; p < b->mesh.part_count; p++) {
        nacre_result r = nacre_gles_draw(b->gles, row->item[p], &view);
        if (r) return fail(f, FAIL_UNSUPPORTED, "%s, %d lights: %s", row->model, row->lights, nacre_result_text(r));
    }
    b->device.finish();
    return FAIL_NONE;
}

static int open_bench(bench *b, gl_backend backend, int size, const char *mesh_name, const char *brdf_name, failure *f)
{
    int code = bench_mesh_open(&b->mesh, mesh_name, f);
    if (code || (code = bake_images(b, brdf_name, f))) return code;
    if ((code = gl_headless_open(&b->gl, backend, size, size, f))) return code;
    bench_gl_begin(&b->device);

    nacre_gles_desc desc = {.get_proc = gl_headless_proc, .max_items = 64, .max_programs = 16};
    size_t block_size = nacre_gles_size(&desc);
    b->block = need_memory(1, block_size);
    nacre_result r = nacre_gles_init(&b->gles, b->block, block_size, &desc);
    return r ? fail(f, FAIL_UNSUPPORTED, "the GLES backend can't start: %s", nacre_result_text(r)) : FAIL_NONE;
}

static void close_bench(bench *b)
{
    if (b->gles) nacre_gles_shutdown(b->gles);
    if (b->gl) gl_headless_close(b->gl);
    for (int i = 0; i < 3; i++) bytes_free(&b->file[i]);
    free(b->block);
    bench_mesh_close(&b->mesh);
}

static void print_rows(const bench *b, int rounds, int size, const char *mesh_name)
{
    printf("%s\n%s, %d x %d, one directional light at a time to eight, sRGB, medians of %d rounds\n",
           gl_headless_description(b->gl), mesh_name, size, size, rounds);
    printf("%-8s %6s %9s %9s\n", "model", "lights", "cpu ms", "wall ms");
    for (int i = 0; i < b->row_count; i++)
        printf("%-8s %6d %9.3f %9.3f\n", b->row[i].model, b->row[i].lights, b->time[i].cpu_ms, b->time[i].wall_ms);
}

static int write_json(const bench *b, int size, const char *mesh_name, const char *path, failure *f)
{
    json j = {0};
    bench_json_begin(&j, b->gl, size);
    for (int i = 0; i < b->row_count; i++) {
        json_begin(&j, NULL, '{');
        json_text(&j, "mesh", mesh_name);
        json_text(&j, "model", b->row[i].model);
        json_int(&j, "lights", b->row[i].lights);
        json_real(&j, "cpu_ms", b->time[i].cpu_ms);
        json_real(&j, "wall_ms", b->time[i].wall_ms);
        json_end(&j, '}');
    }
    return bench_json_end(&j, path, f);
}

int bench_models(const bench_settings *s, failure *f)
{
    const char *mesh_name = s->mesh ? s->mesh : "teapot";
    const char *brdf_name = s->material ? s->material : "sgd:gold-metallic-paint";
    int rounds = s->rounds ? s->rounds : 5, frames = s->frames ? s->frames : 10;
    static bench b;
    int code = open_bench(&b, s->backend, s->size, mesh_name, brdf_name, f);
    if (!code) code = add_rows(&b, f);
    if (!code) code = bench_measure(b.row_count, rounds, frames, draw_row, &b, b.time, f);
    if (!code && bench_prints(s)) print_rows(&b, rounds, s->size, mesh_name);
    if (!code && s->json_path) code = write_json(&b, s->size, mesh_name, s->json_path, f);
    close_bench(&b);
    return code;
}
