/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "progress.h"

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
