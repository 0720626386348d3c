/* SPDX-License-Identifier: MIT */
#include "sbrdf_stack.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pfm_io.h"
#include "png_io.h"
#include "vec3.h"

static const double pi = 3.14159265358979323846;

enum { LEAST_IMAGES = 8, MOST_IMAGES = 4096 };

typedef struct shot {
    image_f32 linear; /* either this or codes has texels */
    image_u8 codes;
    double light[3], eye[3];
} shot;

typedef struct stack {
    const char *path;
    int line, width, height, count;
    shot *shot;
    sbrdf_sources *sources;
    failure *f;
} stack;

/* ---- reading ------------------------------------------------------------------------------------------ */

int sbrdf_is_stack(const char *path)
{
    char line[256] = "", word[16] = "";
    FILE *file = fopen(path, "r");
    if (!file) return 0;
    while (fgets(line, sizeof line, file) && (sscanf(line, " %15s", word) != 1 || word[0] == '#')) word[0] = 0;
    fclose(file);
    return !strcmp(word, "stack");
}

static int fail_line(const stack *s, const char *what)
{
    return fail(s->f, FAIL_INVALID, "%s: line %d: %s", s->path, s->line, what);
}

static int read_picture(stack *s, shot *to, const char *name)
{
    char path[1400], text[700];
    const char *slash = strrchr(s->path, '/');
    size_t length = strlen(name);
    int code, width, height;
    snprintf(path, sizeof path, "%.*s%s", slash && name[0] != '/' ? (int)(slash - s->path + 1) : 0, s->path, name);
    if (length > 4 && !strcmp(name + length - 4, ".pfm"))
        code = pfm_read(&to->linear, path, s->f);
    else
        code = png_read(&to->codes, path, 3, s->f);
    if (code) return code;
    sbrdf_sources_add(s->sources, path);
    width = to->linear.texel ? to->linear.width : to->codes.width;
    height = to->linear.texel ? to->linear.height : to->codes.height;
    if (!s->width) {
        s->width = width;
        s->height = height;
    }
    if (width == s->width && height == s->height) return FAIL_NONE;
    snprintf(text, sizeof text, "%.400s: found %d x %d texels, expected %d x %d as in the first picture", name, width,
             height, s->width, s->height);
    return fail_line(s, text);
}

static int read_image(stack *s, const char *line)
{
    char name[1024];
    double l[3], v[3];
    int used = 0;
    if (sscanf(line, " image %1023s %lf %lf %lf %lf %lf %lf %n", name, &l[0], &l[1], &l[2], &v[0], &v[1], &v[2],
               &used) != 7 ||
        line[used])
        return fail_line(s, "expected image FILE LX LY LZ VX VY VZ");
    if (!(normalise3(l) > 0 && normalise3(v) > 0) || !isfinite(dot3(l, v)))
        return fail_line(s, "found a direction without length or end, expected vectors");
    if (!(l[2] > 0 && v[2] > 0)) return fail_line(s, "found a direction below the sample, expected z above 0");
    if (s->count == MOST_IMAGES) return fail_line(s, "found more than 4096 images");
    shot *to = &s->shot[s->count++];
    memcpy(to->light, l, sizeof l);
    memcpy(to->eye, v, sizeof v);
    return read_picture(s, to, name);
}

static int read_line(stack *s, char *line, int *begun)
{
    line[strcspn(line, "#\r")] = 0;
    line += strspn(line, " \t");
    if (!*line) return FAIL_NONE;
    if (!*begun) {
        *begun = 1;
        return FAIL_NONE; /* the statement stack: sbrdf_is_stack has seen it */
    }
    return read_image(s, line);
}

static int read_text(stack *s)
{
    bytes file = {0};
    int code = file_read(&file, s->path, s->f), begun = 0;
    if (code) return code;
    bytes_append(&file, "", 1);
    for (char *line = (char *)file.data, *next; line && !code; line = next) {
        char *end = strchr(line, '\n');
        next = end ? end + 1 : NULL;
        if (end) *end = 0;
        s->line++;
        code = read_line(s, line, &begun);
    }
    bytes_free(&file);
    if (!code && s->count < LEAST_IMAGES)
        code = fail(s->f, FAIL_INVALID, "%s: found %d images, expected at least %d", s->path, s->count, LEAST_IMAGES);
    return code;
}

/* ---- fitting ------------------------------------------------------------------------------------------ */

/* Of one thread: the pictures' directions are those of every texel, so that almost everything is prepared once. */
typedef struct worker {
    lafortune_problem *whole; /* all pictures */
    lafortune_samples samples;
    double *value;  /* 3 a picture: f_r */
    double *weight; /* of whole: n.l, 0 where this texel's value is left out */
    int left_out;
} worker;

/* f_r of a texel in every picture. */
static void gather(const stack *s, worker *w, long texel)
{
    w->left_out = 0;
    for (int k = 0; k < s->count; k++) {
        const shot *from = &s->shot[k];
        int good = 1;
        for (int c = 0; c < 3; c++) {
            double value;
            if (from->linear.texel) {
                int channels = from->linear.channels;
                value = from->linear.texel[texel * channels + (c < channels ? c : channels - 1)];
                good = good && isfinite(value);
            } else {
                int code = from->codes.texel[3 * texel + c];
                value = srgb_decode(code / 255.0);
                good = good && code < 255;
            }
            w->value[3 * k + c] = value / (pi * from->light[2]);
        }
        w->weight[k] = good ? from->light[2] : 0;
        for (int c = 0; c < 3 && !good; c++) w->value[3 * k + c] = 0;
        w->left_out += !good;
    }
}

typedef struct fitting {
    const stack *s;
    int lobes;
    const lafortune_options *options;
} fitting;

static void worker_make(worker *w, const fitting *job)
{
    size_t count = (size_t)job->s->count;
    w->samples =
        (lafortune_samples){(int)count, need_memory(count, sizeof(double[3])), need_memory(count, sizeof(double))};
    w->value = need_memory(count, sizeof(double[3]));
    w->weight = need_memory(count, sizeof(double));
    for (size_t k = 0; k < count; k++) {
        const shot *from = &job->s->shot[k];
        for (int c = 0; c < 3; c++) w->samples.product[k][c] = from->light[c] * from->eye[c];
        w->samples.weight[k] = from->light[2];
    }
    w->whole = lafortune_problem_make(&w->samples, 3, job->lobes, job->options);
}

static void worker_free(worker *w)
{
    lafortune_problem_free(w->whole);
    free(w->samples.product);
    free(w->samples.weight);
    free(w->value);
    free(w->weight);
}

/* A texel that lacks values needs a problem of its own. */
static double fit_some(const fitting *job, worker *w, lafortune_shared *out)
{
    lafortune_samples some = {w->samples.count, w->samples.product, w->weight};
    lafortune_problem *own = lafortune_problem_make(&some, 3, job->lobes, job->options);
    double error = lafortune_solve(own, w->value, job->lobes, out, NULL);
    lafortune_problem_free(own);
    return error;
}

static double lit_squares(const worker *w)
{
    double sum = 0;
    for (int k = 0; k < w->samples.count; k++)
        for (int c = 0; c < 3; c++) sum += w->weight[k] * w->weight[k] * w->value[3 * k + c] * w->value[3 * k + c];
    return sum;
}

/* Start from the texel before, whose material is most often the same; search the grid where that will not do. */
static double fit_texel(const fitting *job, worker *w, const lafortune_shared *before, double before_error,
                        lafortune_shared *out)
{
    if (w->left_out) return fit_some(job, w, out);
    if (before) {
        *out = *before;
        double error = lafortune_refine(w->whole, w->value, out);
        if (error <= 1.05 * before_error + 0.002) return error;
    }
    return lafortune_solve(w->whole, w->value, job->lobes, out, NULL);
}

typedef struct row_sums {
    double off, own;
    long underlit;
} row_sums;

static void fit_row(const fitting *job, worker *w, int y, sbrdf_field *out, row_sums *sums)
{
    const lafortune_shared *before = NULL;
    double before_error = 0;
    for (int x = 0; x < out->width; x++) {
        long i = (long)y * out->width + x;
        sbrdf_texel *t = &out->texel[i];
        gather(job->s, w, i);
        double own = lit_squares(w);
        if (w->samples.count - w->left_out < LEAST_IMAGES || !(own > 0)) {
            memset(t->brdf.kd, 0, sizeof t->brdf.kd);
            sums->underlit++;
            continue;
        }
        double error = fit_texel(job, w, before, before_error, &t->brdf);
        sums->off += error * error * own;
        sums->own += own;
        if (!w->left_out) {
            before = &t->brdf;
            before_error = error;
        }
    }
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void fit_all(const fitting *job, sbrdf_field *out, sbrdf_stack_report *report, progress *meter)
{
    row_sums *sums = need_memory((size_t)out->height, sizeof *sums), total = {0, 0, 0};
    memset(sums, 0, (size_t)out->height * sizeof *sums);
    report->seconds = now();
    progress_begin(meter, "texels", (double)out->width * out->height);
#pragma omp parallel
    {
        worker w;
        worker_make(&w, job);
#pragma omp for schedule(dynamic, 1)
        for (int y = 0; y < out->height; y++) {
            fit_row(job, &w, y, out, &sums[y]);
            progress_add(meter, out->width);
        }
        worker_free(&w);
    }
    progress_end(meter);
    report->seconds = now() - report->seconds;
    for (int y = 0; y < out->height; y++) { /* in order: the same for any number of threads */
        total.off += sums[y].off;
        total.own += sums[y].own;
        total.underlit += sums[y].underlit;
    }
    report->error = total.own > 0 ? sqrt(total.off / total.own) : 0;
    report->underlit = total.underlit;
    free(sums);
}

int sbrdf_stack_fit(sbrdf_field *out, const char *path, int lobes, int anisotropic, sbrdf_sources *sources,
                    sbrdf_stack_report *report, progress *meter, failure *f)
{
    const lafortune_options options = {.anisotropic = anisotropic,
                                       .n_min = SBRDF_EXPONENT_LEAST,
                                       .n_max = SBRDF_EXPONENT_MOST,
                                       .grazing_max = SBRDF_GRAZING_MAX,
                                       .tolerance = 1e-5,
                                       .starts = 2,
                                       .evaluations = 40};
    stack s = {.path = path, .sources = sources, .f = f};
    s.shot = need_memory(MOST_IMAGES, sizeof *s.shot);
    memset(s.shot, 0, MOST_IMAGES * sizeof *s.shot);
    int code = read_text(&s);
    if (!code) {
        const fitting job = {&s, lobes, &options};
        *out = sbrdf_field_make(s.width, s.height, lobes, 0);
        report->images = s.count;
        fit_all(&job, out, report, meter);
    }
    for (int k = 0; k < s.count; k++) {
        image_f32_free(&s.shot[k].linear);
        image_u8_free(&s.shot[k].codes);
    }
    free(s.shot);
    return code;
}
