/* SPDX-License-Identifier: MIT */
/* nacre bench: milliseconds of CPU and wall time per frame, through the runtime, on this machine's drivers. Rows are
   interleaved round by round, so that a machine whose speed drifts slows all of them alike; medians are printed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "commands.h"
#include "gl_headless.h"
#include "json.h"
#include "mesh.h"
#include "nacre_asset.h"
#include "nacre_gles.h"
#include "options.h"
#include "progress.h"
#include "sphere_bake.h"
#include "table_bake.h"

enum { MAX_ROWS = 32, MAX_ROUNDS = 101 };

typedef struct bench_row {
    const char *model;
    int lights;
    nacre_gles_item item[16];
    double cpu_ms[MAX_ROUNDS], wall_ms[MAX_ROUNDS];
} bench_row;

typedef struct bench {
    gl_headless *gl;
    nacre_gles *gles;
    void *block;
    void (*finish)(void);
    nacre_mesh *parts;
    int part_count;
    nacre_image image[3];
    bytes file[3];
    bench_row row[MAX_ROWS];
    int row_count;
} bench;

static double seconds(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(const double *values, int count)
{
    double sorted[MAX_ROUNDS];
    memcpy(sorted, values, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, compare_doubles);
    return sorted[count / 2];
}

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
    if (b->part_count > 16) return fail(f, FAIL_UNSUPPORTED, "the mesh needs %d parts, at most 16", b->part_count);
    for (int model = 0; model < 3; model++) {
        nacre_material material = {.model = model == 2 ? NACRE_MODEL_SPHERES : NACRE_MODEL_TABLE};
        material.image[model == 2 ? NACRE_ROLE_SPHERES : NACRE_ROLE_TABLE] = &b->image[model];
        nacre_gles_item item[16] = {{0}};
        for (int p = 0; p < b->part_count; p++) {
            nacre_result r = nacre_gles_add(b->gles, &b->parts[p], &material, &item[p]);
            if (r) return fail(f, FAIL_UNSUPPORTED, "%s: %s", names[model], nacre_result_text(r));
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

static void make_view(nacre_view *view, nacre_light *light, int count)
{
    static const float object_to_view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -2, 1};
    static const float view_to_clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.5f, 0, 0, 0, -1, 1}; /* orthographic */
    memset(view, 0, sizeof *view);
    memset(light, 0, sizeof *light * 8);
    for (int i = 0; i < count; i++) {
        double polar = 0.6 + 0.1 * i, azimuth = 2.4 * i;
        light[i].direction = nacre_dir_from_float((float)(sin(polar) * cos(azimuth)),
                                                  (float)(sin(polar) * sin(azimuth)), (float)cos(polar));
        light[i].power = nacre_rgb_from_float(2.0f / (float)count, 2.0f / (float)count, 2.0f / (float)count);
    }
    view->object_to_view = nacre_mat4_from_float(object_to_view);
    view->view_to_clip = nacre_mat4_from_float(view_to_clip);
    view->lights = light;
    view->light_count = (uint8_t)count;
}

static int draw_row(bench *b, const bench_row *row, failure *f)
{
    nacre_light light[8];
    nacre_view view;
    make_view(&view, light, row->lights);
    gl_headless_clear(b->gl, 0, 0, 0, 0);
    for (int p = 0; p < b->part_count; p++) {
        nacre_result r = nacre_gles_draw(b->gles, row->item[p], &view);
        if (r) return fail(f, FAIL_UNSUPPORTED, "%s, %d lights: %s", row->model, row->lights, nacre_result_text(r));
    }
    b->finish();
    return FAIL_NONE;
}

/* One row's frames; times are kept from round 0 on. */
static int time_row(bench *b, bench_row *row, int round, int frames, failure *f)
{
    double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), wall = seconds(CLOCK_MONOTONIC);
    for (int frame = 0; frame < frames; frame++) {
        int code = draw_row(b, row, f);
        if (code) return code;
    }
    if (round < 0) return FAIL_NONE;
    row->cpu_ms[round] = (seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) * 1e3 / frames;
    row->wall_ms[round] = (seconds(CLOCK_MONOTONIC) - wall) * 1e3 / frames;
    return FAIL_NONE;
}

static int time_rows(bench *b, int rounds, int frames, failure *f)
{
    int code = FAIL_NONE;
    progress meter = {0};
    progress_begin(&meter, "rows", (double)(rounds + 1) * b->row_count);
    for (int round = -1; round < rounds && !code; round++) { /* round -1 warms up: compiles, uploads */
        for (int i = 0; i < b->row_count && !code; i++) {
            code = time_row(b, &b->row[i], round, frames, f);
            progress_add(&meter, 1);
        }
    }
    progress_end(&meter);
    return code;
}

static int open_bench(bench *b, gl_backend backend, int size, const char *mesh_name, const char *brdf_name, failure *f)
{
    mesh m;
    int code = mesh_open(&m, mesh_name, f);
    if (code) return code;
    code = mesh_pack(&m, &b->parts, &b->part_count, f);
    mesh_free(&m);
    if (code || (code = bake_images(b, brdf_name, f))) return code;
    if ((code = gl_headless_open(&b->gl, backend, size, size, f))) return code;
    *(void **)&b->finish = gl_headless_proc(NULL, "glFinish");
    void (*enable)(unsigned);
    *(void **)&enable = gl_headless_proc(NULL, "glEnable");
    enable(0x0B71); /* GL_DEPTH_TEST */

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
    free(b->parts);
}

static void print_rows(const bench *b, int rounds, int size, const char *mesh_name)
{
    printf("%s\n%s, %d x %d, one directional light at a time to eight, sRGB, medians of %d rounds\n",
           gl_headless_description(b->gl), mesh_name, size, size, rounds);
    printf("%-8s %6s %9s %9s\n", "model", "lights", "cpu ms", "wall ms");
    for (int i = 0; i < b->row_count; i++)
        printf("%-8s %6d %9.3f %9.3f\n", b->row[i].model, b->row[i].lights, median(b->row[i].cpu_ms, rounds),
               median(b->row[i].wall_ms, rounds));
}

static int write_json(const bench *b, int rounds, int size, const char *mesh_name, const char *path, failure *f)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "renderer", gl_headless_description(b->gl));
    json_text(&j, "mesh", mesh_name);
    json_int(&j, "size", size);
    json_begin(&j, "rows", '[');
    for (int i = 0; i < b->row_count; i++) {
        json_begin(&j, NULL, '{');
        json_text(&j, "model", b->row[i].model);
        json_int(&j, "lights", b->row[i].lights);
        json_real(&j, "cpu_ms", median(b->row[i].cpu_ms, rounds));
        json_real(&j, "wall_ms", median(b->row[i].wall_ms, rounds));
        json_end(&j, '}');
    }
    json_end(&j, ']');
    json_end(&j, '}');
    return json_write(&j, path, f);
}

int cmd_bench(int argc, char **argv, failure *f)
{
    const char *mesh_name = "teapot", *brdf_name = "sgd:gold-metallic-paint", *json_path = NULL, *backend_name = "egl2";
    const char *operand[1];
    int size = 512, rounds = 5, frames = 10, operands;
    const option table[] = {
        {"--mesh", OPTION_TEXT, &mesh_name, 0, 0, "MESH", "what to draw (teapot)"},
        {"--material", OPTION_TEXT, &brdf_name, 0, 0, "BRDF", "what to bake and draw (sgd:gold-metallic-paint)"},
        {"--backend", OPTION_TEXT, &backend_name, 0, 0, "NAME", "egl2 (default), egl3 or osmesa"},
        {"--size", OPTION_INT, &size, 16, 4096, "N", "pixels a side (512)"},
        {"--rounds", OPTION_INT, &rounds, 1, MAX_ROUNDS, "N", "medians of so many (5)"},
        {"--frames", OPTION_INT, &frames, 1, 1000, "N", "frames a round (10)"},
        {"--json", OPTION_TEXT, &json_path, 0, 0, "FILE", "the figures as JSON (- for standard output)"},
    };
    int code = options_parse(argc, argv, "nacre bench [options]", table, sizeof table / sizeof table[0], operand,
                             &operands, 0, 0, f);
    if (code) return code;
    static const char *const backends[GL_BACKEND_COUNT] = {"egl2", "egl3", "osmesa"};
    int backend = 0;
    while (backend < GL_BACKEND_COUNT && strcmp(backends[backend], backend_name)) backend++;
    if (backend == GL_BACKEND_COUNT)
        return fail(f, FAIL_USAGE, "--backend %s: expected egl2, egl3 or osmesa", backend_name);

    static bench b;
    code = open_bench(&b, (gl_backend)backend, size, mesh_name, brdf_name, f);
    if (!code) code = add_rows(&b, f);
    if (!code) code = time_rows(&b, rounds, frames, f);
    if (!code && !(json_path && !strcmp(json_path, "-"))) print_rows(&b, rounds, size, mesh_name);
    if (!code && json_path) code = write_json(&b, rounds, size, mesh_name, json_path, f);
    close_bench(&b);
    return code;
}
