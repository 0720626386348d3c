/* SPDX-License-Identifier: MIT */
#include "batch.h"

#include <errno.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "nacre.h"
#include "pool.h"

/* Raised when what is kept of a material changes. */
#define RECORD_FORMAT "nacre batch 1"

const batch_figure batch_figures[BATCH_FIGURES] = {
    [BATCH_BYTES] = {"bytes", "bytes", 1, 0, -1},
    [BATCH_FETCHES] = {"fetches", "fetches", 1, 0, -1},
    [BATCH_POOLED] = {"pooled_psnr_db", "pooled dB", 1, 2, 1},
    [BATCH_WORST] = {"worst_frame_db", "worst frame", 1, 2, 1},
    [BATCH_WORST_DEG] = {"worst_frame_deg", "at deg", 1, 0, 0},
    [BATCH_DIM_POOLED] = {"dim_pooled_psnr_db", "2 stops down", 1, 2, 1},
    [BATCH_DIM_WORST] = {"dim_worst_frame_db", "its worst", 1, 2, 1},
    [BATCH_SSIM] = {"ssim", "SSIM", 1, 4, 1},
    [BATCH_RELATIVE_RMS] = {"relative_rms", "rel. RMS %", .01, 2, -1},
    [BATCH_ALBEDO_ERROR] = {"albedo_error", "albedo %", .01, 2, -1},
};

/* What a run keeps at hand. In a worker, the backend and the last BRDF's reference too: lists often ask for one in several
   sizes. */
typedef struct run {
    const batch_options *options;
    batch *out;
    char program[CONTENT_TEXT]; /* fingerprint of this executable */
    char truth_of[CONTENT_TEXT];
    compare_truth truth;
    compare_device *device; /* NULL: not opened yet */
} run;

/* ---- one material --------------------------------------------------------------------------------- */

/* The BRDF as the asset will know it: its name, and what is in its file. */
static int brdf_content(const manifest_item *item, char out[CONTENT_TEXT], failure *f)
{
    const char *input = bake_input(item->brdf);
    content *c = content_begin();
    content_add_text(c, item->brdf);
    int code = input ? content_add_file(c, input, f) : FAIL_NONE;
    content_end(c, out);
    return code;
}

static void made_of(const run *r, const manifest_item *item, const char *source, char out[CONTENT_TEXT])
{
    content *c = content_begin();
    content_add_text(c, RECORD_FORMAT);
    content_add_text(c, r->program);
    content_add_text(c, compare_backend_names[r->options->backend]);
    content_add_text(c, source);
    content_add_text(c, item->kind);
    for (int i = 2; i < item->argument_count; i++) content_add_text(c, item->argument[i]);
    content_end(c, out);
}

static char *join(const char *directory, const char *name, const char *end)
{
    size_t size = strlen(directory) + strlen(name) + strlen(end) + 2;
    char *path = need_memory(size, 1);
    snprintf(path, size, "%s/%s%s", directory, name, end);
    return path;
}

static int up_to_date(const char *path, const char *record_path, const char *wanted, batch_record *record)
{
    char found[CONTENT_TEXT];
    return batch_record_read(record, record_path) && !strcmp(record->made_of, wanted) &&
           !content_of_file(path, found, NULL) && !strcmp(record->content, found);
}

/* The reference of the BRDF with this content. */
static int need_truth(run *r, const manifest_item *item, const char *source, failure *f)
{
    if (!strcmp(r->truth_of, source)) return FAIL_NONE;
    if (r->truth_of[0]) compare_truth_close(&r->truth);
    r->truth_of[0] = 0;
    int code = compare_truth_open(&r->truth, item->brdf, 0, f);
    if (!code) memcpy(r->truth_of, source, CONTENT_TEXT);
    return code;
}

static int compare(const run *r, const manifest_item *item, const bytes *file, double figure[BATCH_FIGURES], failure *f)
{
    compare_asset asset;
    compare_result c;
    bytes copy = {0};
    bytes_append(&copy, file->data, file->size);
    int code = compare_asset_take(&asset, &copy, item->output, f);
    if (code) {
        bytes_free(&copy);
        return code;
    }
    code = compare_run(&c, NULL, &r->truth, &asset, r->device, f);
    if (!code) {
        figure[BATCH_BYTES] = (double)asset.texture_bytes;
        figure[BATCH_FETCHES] = asset.fetches;
        figure[BATCH_POOLED] = c.full.pooled_psnr_db;
        figure[BATCH_WORST] = c.full.worst_frame_db;
        figure[BATCH_WORST_DEG] = c.full.worst_frame_deg;
        figure[BATCH_DIM_POOLED] = c.dim.pooled_psnr_db;
        figure[BATCH_DIM_WORST] = c.dim.worst_frame_db;
        figure[BATCH_SSIM] = c.ssim;
        figure[BATCH_RELATIVE_RMS] = c.relative_rms;
        figure[BATCH_ALBEDO_ERROR] = c.albedo_error;
    }
    compare_asset_close(&asset);
    return code;
}

/* The asset comes last: a record that is not of the asset beside it asks for a new bake. */
static int write_both(const manifest_item *item, const bytes *file, const char *path, batch_record *record,
                      const char *record_path, failure *f)
{
    content *c = content_begin();
    content_add(c, file->data, file->size);
    content_end(c, record->content);
    int code = batch_record_write(record, item, record_path, f);
    if (code) return code;
    code = output_write(path, file, f);
    if (code) output_discard(record_path);
    return code;
}

static int bake(run *r, const manifest_item *item, const char *source, const char *path, const char *record_path,
                batch_record *record, failure *f)
{
    bake_result baked;
    char now[CONTENT_TEXT];
    int code = output_apart(path, bake_input(item->brdf), f);
    if (!code && !r->device) code = compare_device_open(&r->device, r->options->backend, f);
    if (code || (code = need_truth(r, item, source, f))) return code;
    if ((code = bake_run(&item->request, r->truth.b, path, NULL, &baked, f))) return code;
    if (!(code = compare(r, item, &baked.file, record->figure, f))) code = brdf_content(item, now, f);
    if (!code && strcmp(now, source))
        code = fail(f, FAIL_IO, "%s: changed while it was read, expected a file at rest", item->brdf);
    if (!code) code = write_both(item, &baked.file, path, record, record_path, f);
    bake_free(&baked);
    return code;
}

static int process(run *r, batch_result *out, const char *path, const char *record_path, failure *f)
{
    batch_record record = {{0}, {0}, {0}};
    char source[CONTENT_TEXT], wanted[CONTENT_TEXT];
    int code = brdf_content(out->item, source, f);
    if (code) return code;
    made_of(r, out->item, source, wanted);
    out->status = BATCH_UP_TO_DATE;
    if (!up_to_date(path, record_path, wanted, &record)) {
        out->status = BATCH_BAKED;
        memcpy(record.made_of, wanted, sizeof record.made_of);
        code = bake(r, out->item, source, path, record_path, &record, f);
    }
    memcpy(out->figure, record.figure, sizeof out->figure);
    return code;
}

static void work(int index, void *context)
{
    run *r = context;
    batch_result *out = &r->out->result[index];
    char *path = join(r->options->directory, out->item->output, "");
    char *record_path = join(r->options->directory, out->item->output, ".json");
    failure f = {0};
    int code = process(r, out, path, record_path, &f);
    if (code) {
        out->error = f;
        out->status = BATCH_FAILED;
    }
    free(path);
    free(record_path);
}

static void done(int index, const char *ended, void *context)
{
    run *r = context;
    batch_result *out = &r->out->result[index];
    if (ended) {
        out->status = BATCH_FAILED;
        fail(&out->error, FAIL_INTERNAL, "%s: the process that baked it ended: %s", out->item->brdf, ended);
    }
    if (out->status == BATCH_FAILED) {
        progress_end(r->options->progress); /* it comes back */
        fprintf(stderr, "nacre batch: %s: line %d: %s\n", r->options->name, out->item->line, out->error.text);
    }
    if (out->status == BATCH_UP_TO_DATE)
        progress_drop(r->options->progress, 1);
    else
        progress_add(r->options->progress, 1);
}

/* ---- all of them ---------------------------------------------------------------------------------- */

/* What one process writes another must not read: the result would depend on who comes first. */
static int check_inputs(const manifest *m, const batch_options *o, failure *f)
{
    char *directory = realpath(o->directory, NULL);
    size_t length = directory ? strlen(directory) : 0;
    int code = FAIL_NONE;
    for (int i = 0; i < m->count && directory && !code; i++) {
        const char *input = bake_input(m->item[i].brdf);
        char *path = input ? realpath(input, NULL) : NULL;
        int inside = path && !strncmp(path, directory, length) && path[length] == '/';
        for (int k = 0; k < m->count && inside && !code; k++)
            if (!strcmp(path + length + 1, m->item[k].output))
                code =
                    fail(f, FAIL_INVALID, "%s: line %d, field brdf: found the output of line %d, expected another file",
                         o->name, m->item[i].line, m->item[k].line);
        free(path);
    }
    free(directory);
    return code;
}

/* Every folder on the way to a file. */
static int make_folders(char *path, failure *f)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        if (mkdir(path, 0777) && errno != EEXIST)
            return fail(f, FAIL_IO, "%s: can't make the directory: %s", path, strerror(errno));
        *slash = '/';
    }
    return FAIL_NONE;
}

static int make_all_folders(const manifest *m, const batch_options *o, failure *f)
{
    int code = FAIL_NONE;
    for (int i = 0; i < m->count && !code; i++) {
        char *path = join(o->directory, m->item[i].output, "");
        code = make_folders(path, f);
        free(path);
    }
    return code;
}

int batch_run(batch *out, const manifest *m, const batch_options *o, failure *f)
{
    int code = make_all_folders(m, o, f);
    if (code || (code = check_inputs(m, o, f))) return code;
    batch b = {0};
    run r = {.options = o, .out = &b};
    snprintf(r.program, sizeof r.program, "%d.%d.%d", NACRE_VERSION_MAJOR, NACRE_VERSION_MINOR, NACRE_VERSION_PATCH);
    content_of_file("/proc/self/exe", r.program, NULL); /* where that is to be had */
    b.count = (m->count - o->shard + o->shards) / o->shards;
    b.result = pool_memory((size_t)b.count * sizeof *b.result);
    for (int i = 0; i < b.count; i++) {
        b.result[i].item = &m->item[o->shard - 1 + i * o->shards];
        b.result[i].status = BATCH_FAILED;
        fail(&b.result[i].error, FAIL_INTERNAL, "%s: not reached", b.result[i].item->brdf);
    }
    int jobs = o->jobs < b.count ? o->jobs : b.count > 0 ? b.count : 1;
    int cores = omp_get_num_procs(), threads = cores / jobs > 1 ? cores / jobs : 1;
    pool p = {.jobs = jobs, .threads = threads, .context = &r, .work = work, .done = done};
    progress_begin(o->progress, "materials", b.count);
    b.interrupted = pool_run(&p, b.count);
    progress_end(o->progress);
    *out = b;
    return FAIL_NONE;
}

void batch_free(batch *b)
{
    pool_memory_free(b->result, (size_t)b->count * sizeof *b->result);
    *b = (batch){0};
}
