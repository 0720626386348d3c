/* SPDX-License-Identifier: MIT */
/* What the tables of `nacre bench` share: settings, and times of rows that are measured side by side. A table is one
   file, bench_NAME.c, with one function, listed in cmd_bench.c. */
#ifndef BENCH_H
#define BENCH_H

#include "failure.h"
#include "gl_headless.h"
#include "json.h"
#include "nacre.h"

#define BENCH_MAX_ROUNDS 101

typedef struct bench_settings { /* from the command line */
    const char *mesh;           /* NULL: not given */
    const char *material;       /* NULL: not given */
    const char *json_path;      /* NULL: none; "-": standard output, print nothing else */
    gl_backend backend;
    int size;           /* pixels a side */
    int rounds, frames; /* 0: not given */
    int budget;         /* lights a frame of spread updates */
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

/* For tables of the GLES backend: glFinish, and a depth test for the frames of an open context. */
typedef struct bench_gl {
    void (*finish)(void);
} bench_gl;
void bench_gl_begin(bench_gl *gl);

/* The view of GLES tables: an orthographic camera on a mesh of radius 1, directional lights around the eye that together
   give 2 of irradiance, all turned by so much about the eye. light receives `count`, and is what the view points to. */
void bench_view(nacre_view *view, nacre_light *light, int count, double turn);

#endif
