/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "mesh.h"
#include "nacre_asset.h"
#include "progress.h"
#include "table_bake.h"

#define GL_DEPTH_TEST 0x0B71

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

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    return values[count / 2];
}

typedef struct row_rounds {
    double cpu_ms[BENCH_MAX_ROUNDS], wall_ms[BENCH_MAX_ROUNDS];
} row_rounds;

int bench_measure(int rows, int rounds, int frames, int (*draw)(void *user, int row, failure *f), void *user,
                  bench_time *time, failure *f)
{
    row_rounds *of = need_memory((size_t)rows, sizeof *of);
    int code = FAIL_NONE;
    progress meter = {0};
    progress_begin(&meter, "rows", (double)(rounds + 1) * rows);
    for (int round = -1; round < rounds && !code; round++)
        for (int row = 0; row < rows && !code; row++) {
            double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), wall = seconds(CLOCK_MONOTONIC);
            for (int frame = 0; frame < frames && !code; frame++) code = draw(user, row, f);
            if (round >= 0) {
                of[row].cpu_ms[round] = (seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) * 1e3 / frames;
                of[row].wall_ms[round] = (seconds(CLOCK_MONOTONIC) - wall) * 1e3 / frames;
            }
            progress_add(&meter, 1);
        }
    progress_end(&meter);
    for (int row = 0; row < rows && !code; row++)
        time[row] = (bench_time){median(of[row].cpu_ms, rounds), median(of[row].wall_ms, rounds)};
    free(of);
    return code;
}

int bench_prints(const bench_settings *settings)
{
    return !settings->json_path || strcmp(settings->json_path, "-");
}

int bench_mesh_open(bench_mesh *m, const char *path, failure *f)
{
    mesh whole;
    int code = mesh_open(&whole, path, f);
    *m = (bench_mesh){0};
    if (code) return code;
    m->triangles = (int)(whole.index_count / 3);
    code = mesh_pack(&whole, &m->parts, &m->part_count, f);
    mesh_free(&whole);
    if (!code && m->part_count > BENCH_MAX_PARTS)
        code = fail(f, FAIL_UNSUPPORTED, "%s: %d parts, at most %d", path, m->part_count, BENCH_MAX_PARTS);
    return code;
}

void bench_mesh_close(bench_mesh *m)
{
    free(m->parts);
    *m = (bench_mesh){0};
}

int bench_bake_table(bytes *file, nacre_image *image, const char *brdf_name, failure *f)
{
    table_asset baked;
    brdf *source;
    int code = brdf_open(&source, brdf_name, f);
    if (code) return code;
    code = table_bake(&baked, source, &(table_options){0}, f);
    brdf_close(source);
    if (code) return code;
    table_write(&baked, file);
    table_free(&baked);
    return bench_check(nacre_image_open(image, file->data, file->size), "a baked table", f);
}

int bench_check(nacre_result r, const char *what, failure *f)
{
    return r ? fail(f, FAIL_UNSUPPORTED, "%s: %s", what, nacre_result_text(r)) : FAIL_NONE;
}

void bench_json_begin(json *j, const gl_headless *gl, int size)
{
    json_begin(j, NULL, '{');
    json_text(j, "renderer", gl_headless_description(gl));
    json_int(j, "size", size);
    json_begin(j, "rows", '[');
}

int bench_json_end(json *j, const char *path, failure *f)
{
    json_end(j, ']');
    json_end(j, '}');
    return json_write(j, path, f);
}

void bench_gl_begin(bench_gl *gl)
{
    void (*enable)(unsigned);
    *(void **)&gl->finish = gl_headless_proc(NULL, "glFinish");
    *(void **)&enable = gl_headless_proc(NULL, "glEnable");
    enable(GL_DEPTH_TEST);
}

void bench_view(nacre_view *view, nacre_light *light, int count, double turn)
{
    static const float object_to_view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -2, 1};
    static const float view_to_clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.5f, 0, 0, 0, -1, 1};
    const float power = 2.0f / (float)count;
    memset(view, 0, sizeof *view);
    memset(light, 0, sizeof *light * (size_t)count);
    for (int i = 0; i < count; i++) {
        double polar = 0.6 + 0.8 * i / fmax(count, 8), azimuth = 2.4 * i + turn;
        light[i].direction = nacre_dir_from_float((float)(sin(polar) * cos(azimuth)),
                                                  (float)(sin(polar) * sin(azimuth)), (float)cos(polar));
        light[i].power = nacre_rgb_from_float(power, power, power);
    }
    view->object_to_view = nacre_mat4_from_float(object_to_view);
    view->view_to_clip = nacre_mat4_from_float(view_to_clip);
    view->lights = light;
    view->light_count = (uint16_t)count;
}
