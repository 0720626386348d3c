/* SPDX-License-Identifier: MIT */
/* Table I of Mihalik and Durikovic 2015, made again: teapot and bunny under more and more directional lights, shaded
   directly and by lit spheres, these with lights at rest, all moving, and moving with updates spread over frames. CPU time
   of one thread. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "nacre_gles.h"

enum { MAX_MESHES = 2, MAX_ROWS = MAX_MESHES * 16, MAX_LIGHTS = 64 };

typedef struct shape {
    const char *name;
    bench_mesh mesh;
    nacre_gles_item item[BENCH_MAX_PARTS];
} shape;

typedef struct row {
    const shape *of;
    int moving, lights, budget;
    nacre_gles_lit lit; /* id 0: direct */
    int frame;          /* lights turn with it */
    bench_time whole, update;
} row;

typedef struct job { /* what is timed: a frame, or its update alone */
    row *of;
    int update_only;
} job;

typedef struct table {
    gl_headless *gl;
    nacre_gles *gles;
    void *block;
    bench_gl device;
    nacre_image image;
    bytes file;
    shape shape[MAX_MESHES];
    int shape_count;
    row row[MAX_ROWS];
    int row_count;
    job job[2 * MAX_ROWS];
    bench_time time[2 * MAX_ROWS];
    int job_count;
} table;

/* ---- rows ---------------------------------------------------------------------------------------- */

static int add_shape(table *t, const char *path, const char *name, failure *f)
{
    const nacre_material material = {.model = NACRE_MODEL_TABLE, .image[NACRE_ROLE_TABLE] = &t->image};
    shape *s = &t->shape[t->shape_count];
    int code = bench_mesh_open(&s->mesh, path, f);
    t->shape_count++;
    s->name = name;
    for (int i = 0; i < s->mesh.part_count && !code; i++)
        code = bench_check(nacre_gles_add(t->gles, &s->mesh.parts[i], &material, &s->item[i]), name, f);
    return code;
}

static int add_row(table *t, const shape *s, int lit, int moving, int lights, int budget, failure *f)
{
    const nacre_material material = {.model = NACRE_MODEL_TABLE, .image[NACRE_ROLE_TABLE] = &t->image};
    row *r = &t->row[t->row_count++];
    *r = (row){.of = s, .moving = moving, .lights = lights, .budget = budget};
    t->job[t->job_count++] = (job){r, 0};
    if (moving) t->job[t->job_count++] = (job){r, 1};
    return lit ? bench_check(nacre_gles_lit_add(t->gles, &material, NULL, &r->lit), "lit sphere", f) : FAIL_NONE;
}

static int add_rows(table *t, const shape *s, int budget, failure *f)
{
    static const int lights[] = {1, 2, 4, 8, MAX_LIGHTS};
    int code = FAIL_NONE;
    for (int i = 0; i < 4 && !code; i++) code = add_row(t, s, 0, 0, lights[i], 0, f);
    for (int moving = 0; moving < 2; moving++)
        for (int i = 0; i < 5 && !code; i++) code = add_row(t, s, 1, moving, lights[i], 0, f);
    return code ? code : add_row(t, s, 1, 1, MAX_LIGHTS, budget, f);
}

/* ---- frames -------------------------------------------------------------------------------------- */

static int run_job(void *user, int index, failure *f)
{
    table *t = user;
    row *r = t->job[index].of;
    nacre_light light[MAX_LIGHTS];
    nacre_view view;
    const nacre_gles_lit none = {0};
    int code = FAIL_NONE;
    bench_view(&view, light, r->lights, r->moving ? 0.01 * r->frame++ : 0);
    if (r->lit.id)
        code = bench_check(nacre_gles_lit_update(t->gles, r->lit, NULL, &view, (unsigned)r->budget), "update", f);
    if (!t->job[index].update_only) {
        gl_headless_clear(t->gl, 0, 0, 0, 0);
        for (int i = 0; i < r->of->mesh.part_count && !code; i++) {
            nacre_gles_use_lit(t->gles, r->of->item[i], r->lit, none);
            code = bench_check(nacre_gles_draw(t->gles, r->of->item[i], &view), "draw", f);
        }
    }
    t->device.finish();
    return code;
}

static void take_times(table *t)
{
    for (int i = 0; i < t->job_count; i++) {
        row *r = t->job[i].of;
        *(t->job[i].update_only ? &r->update : &r->whole) = t->time[i];
    }
}

/* ---- the table ----------------------------------------------------------------------------------- */

static int open_table(table *t, const bench_settings *s, const char *brdf_name, failure *f)
{
    int code = bench_bake_table(&t->file, &t->image, brdf_name, f);
    if (code) return code;
    setenv("LP_NUM_THREADS", "0", 0); /* Mesa's rasteriser in this thread */
    if ((code = gl_headless_open(&t->gl, s->backend, s->size, s->size, f))) return code;
    bench_gl_begin(&t->device);
    const nacre_gles_desc desc = {.get_proc = gl_headless_proc, .max_items = 64, .max_programs = 32};
    t->block = need_memory(1, nacre_gles_size(&desc));
    return bench_check(nacre_gles_init(&t->gles, t->block, nacre_gles_size(&desc), &desc), "the GLES backend", f);
}

/* The given mesh, or the paper's two. */
static int add_shapes(table *t, const char *given, failure *f)
{
    static const char bunny[] = "fixtures/in/bunny.obj";
    if (given) return add_shape(t, given, given, f);
    int code = add_shape(t, "teapot", "teapot", f);
    if (code) return code;
    if (!access(bunny, R_OK)) return add_shape(t, bunny, "bunny", f);
    fprintf(stderr, "nacre bench: %s: not here, the bunny is left out (run from the top of the source tree)\n", bunny);
    return FAIL_NONE;
}

static void close_table(table *t)
{
    if (t->gles) nacre_gles_shutdown(t->gles);
    if (t->gl) gl_headless_close(t->gl);
    for (int i = 0; i < t->shape_count; i++) bench_mesh_close(&t->shape[i].mesh);
    bytes_free(&t->file);
    free(t->block);
}

static void print_table(const table *t, int size, int rounds)
{
    printf("%s\n%d x %d, one thread, CPU ms, medians of %d rounds; a frame holds its update\n",
           gl_headless_description(t->gl), size, size, rounds);
    printf("%-8s %-7s %-7s %6s %7s %9s %9s %9s %8s\n", "mesh", "path", "lights", "count", "budget", "frame ms",
           "update ms", "draw ms", "frames/s");
    for (int i = 0; i < t->row_count; i++) {
        const row *r = &t->row[i];
        char budget[16] = "";
        if (r->budget) snprintf(budget, sizeof budget, "%d", r->budget);
        printf("%-8s %-7s %-7s %6d %7s %9.3f %9.3f %9.3f %8.1f\n", r->of->name, r->lit.id ? "lit" : "direct",
               r->moving ? "moving" : "still", r->lights, budget, r->whole.cpu_ms, r->update.cpu_ms,
               r->whole.cpu_ms - r->update.cpu_ms, 1e3 / r->whole.cpu_ms);
    }
}

static int write_json(const table *t, int size, const char *path, failure *f)
{
    json j = {0};
    bench_json_begin(&j, t->gl, size);
    for (int i = 0; i < t->row_count; i++) {
        const row *r = &t->row[i];
        json_begin(&j, NULL, '{');
        json_text(&j, "mesh", r->of->name);
        json_text(&j, "path", r->lit.id ? "lit" : "direct");
        json_bool(&j, "moving", r->moving);
        json_int(&j, "lights", r->lights);
        json_int(&j, "budget", r->budget);
        json_real(&j, "frame_ms", r->whole.cpu_ms);
        json_real(&j, "update_ms", r->update.cpu_ms);
        json_end(&j, '}');
    }
    return bench_json_end(&j, path, f);
}

int bench_paper002(const bench_settings *s, failure *f)
{
    const char *brdf_name = s->material ? s->material : "sgd:gold-metallic-paint";
    const int rounds = s->rounds ? s->rounds : 7, frames = s->frames ? s->frames : 16;
    static table t;
    int code = open_table(&t, s, brdf_name, f);
    if (!code) code = add_shapes(&t, s->mesh, f);
    for (int i = 0; i < t.shape_count && !code; i++) code = add_rows(&t, &t.shape[i], s->budget, f);
    if (!code) code = bench_measure(t.job_count, rounds, frames, run_job, &t, t.time, f);
    if (!code) take_times(&t);
    if (!code && bench_prints(s)) print_table(&t, s->size, rounds);
    if (!code && s->json_path) code = write_json(&t, s->size, s->json_path, f);
    close_table(&t);
    return code;
}
