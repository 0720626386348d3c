/* SPDX-License-Identifier: MIT */
/* What the tables of `nacre bench` share: settings, and times of rows that are measured side by side. A table is one
   file, bench_NAME.c, with one function, listed in cmd_bench.c. */
#ifndef BENCH_H
#define BENCH_H

#include "failure.h"
#include "gl_headless.h"
#include "json.h"
#include "nacre.h"

#define BENCH_MAX_ROUNDS  101
#define BENCH_MAX_THREADS 64
#define BENCH_MAX_PARTS   16

typedef struct bench_settings { /* from the command line */
    const char *mesh;           /* NULL: not given */
    const char *material;       /* NULL: not given */
    const char *json_path;      /* NULL: none; "-": standard output, print nothing else */
    gl_backend backend;
    int size;           /* pixels a side */
    int rounds, frames; /* 0: not given */
    int budget;         /* lights a frame of spread updates */
    int threads;        /* of the CPU renderer */
} bench_settings;

/* A table: measure, print, and write the JSON. Returns an exit code (failure.h). */
typedef int bench_table(const bench_settings *settings, failure *f);
bench_table bench_models, bench_paper000, bench_paper002, bench_cpu;

/* Milliseconds a frame: medians over the rounds. */
typedef struct bench_time {
    double cpu_ms; /* of all threads of this process */
    double wall_ms;
} bench_time;

/* Measure `rows` rows: draw(user, row) is one whole frame, finished before it returns. Round by round every row is drawn
   `frames` times, so that a machine whose speed drifts slows all of them alike; a first round is not counted (compiles,
   uploads). rounds: 1..BENCH_MAX_ROUNDS. time receives one entry a row. */
int bench_measure(int rows, int rounds, int frames, int (*draw)(void *user, int row, failure *f), void *user,
                  bench_time *time, failure *f);

/* 1 unless JSON goes to standard output. */
int bench_prints(const bench_settings *settings);

/* A mesh, cut into parts that one draw each can take. */
typedef struct bench_mesh {
    nacre_mesh *parts; /* BENCH_MAX_PARTS at most */
    int part_count, triangles;
} bench_mesh;

/* path: a file or a built-in name. Close what was opened; closing zeros is allowed. */
int bench_mesh_open(bench_mesh *m, const char *path, failure *f);
void bench_mesh_close(bench_mesh *m);

/* A default table of a BRDF, baked in memory and opened; image borrows file, which bytes_free() frees. */
int bench_bake_table(bytes *file, nacre_image *image, const char *brdf_name, failure *f);

/* An answer of the runtime as an exit code, with one line that says what was asked for. */
int bench_check(nacre_result r, const char *what, failure *f);

/* The head of a table's JSON, up to the opened "rows"; end closes and writes it. */
void bench_json_begin(json *j, const gl_headless *gl, int size);
int bench_json_end(json *j, const char *path, failure *f);

/* For tables of the GLES backend: glFinish, and a depth test for the frames of an open context. */
typedef struct bench_gl {
    void (*finish)(void);
} bench_gl;
void bench_gl_begin(bench_gl *gl);

/* The view of GLES tables: an orthographic camera on a mesh of radius 1, directional lights around the eye that together
   give 2 of irradiance, all turned by so much about the eye. light receives `count`, and is what the view points to. */
void bench_view(nacre_view *view, nacre_light *light, int count, double turn);

#endif
