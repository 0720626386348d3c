/* SPDX-License-Identifier: MIT */
/* nacre batch: bake and compare a list of materials. */
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "batch.h"
#include "batch_report.h"
#include "commands.h"
#include "options.h"
#include "pool.h"

static const char usage[] =
    "nacre batch MANIFEST -o DIR [options]\n"
    "MANIFEST (- for standard input) is CSV or JSON lines. CSV has the columns brdf, kind, options, output in this "
    "order, or\n"
    "as its first line names them; # begins a comment; a field with commas is quoted. JSON has objects of the same "
    "names;\n"
    "options may be an object. Only brdf must be there: kind is table if not given, output a name made of the others.\n"
    "\n"
    "    sgd:gold-metallic-paint\n"
    "    gold.binary,table,--tier fine\n"
    "    \"ggx:rough=.3,f0=.04\",spheres,--size 128,rough.ktx2\n"
    "    {\"brdf\": \"gold.binary\", \"options\": {\"tier\": \"fine\", \"size\": \"32x21\"}}\n"
    "\n"
    "DIR/OUTPUT.json keeps each material's figures and of what it was made: this program, the options, the BRDF's "
    "content.\n"
    "Where nothing of it has changed the material is up to date and not baked again, whatever the files' times are. "
    "Results\n"
    "do not depend on --jobs. Several runs may write to one DIR; a run without --shard afterwards finds all up to date "
    "and\n"
    "prints the whole table.\n"
    "\n"
    "    nacre info --brdfs | grep ^sgd: | nacre batch - -o out            every built-in SGD fit\n"
    "    ls /data/merl/*.binary | nacre batch - -o out --csv merl.csv      a folder of measured tables\n"
    "    parallel nacre batch list.csv -o out --jobs 1 --quiet --shard {}/8 ::: $(seq 8)\n"
    "    sbatch --array=1-8 --wrap 'nacre batch list.csv -o out --quiet --shard $SLURM_ARRAY_TASK_ID/8'\n"
    "\n"
    "exit codes: as of nacre; that of the list's first material that failed, when the others are done\n";

typedef struct batch_command {
    const char *manifest, *json, *csv, *shard, *backend;
    double fail_below;
    int quiet;
    batch_options options;
} batch_command;

static int parse_shard(const char *text, batch_options *o, failure *f)
{
    char rest;
    if (sscanf(text, "%9d/%9d%c", &o->shard, &o->shards, &rest) == 2 && o->shard >= 1 && o->shard <= o->shards)
        return FAIL_NONE;
    return fail(f, FAIL_USAGE, "--shard %s: expected I/N with I in 1..N (for a Slurm array: --array=1-N)", text);
}

static int parse(batch_command *c, int argc, char **argv, failure *f)
{
    int operands;
    const option table[] = {
        {"-o", OPTION_TEXT, &c->options.directory, 0, 0, "DIR", "directory of the outputs; made if it is not there"},
        {"--jobs", OPTION_INT, &c->options.jobs, 1, POOL_MAX_JOBS, "N", "(all cores) so many materials at a time"},
        {"--shard", OPTION_TEXT, &c->shard, 0, 0, "I/N", "only the I-th of every N materials, I in 1..N"},
        {"--backend", OPTION_TEXT, &c->backend, 0, 0, "NAME",
         "what draws for comparison: double (default), egl2, egl3, osmesa or soft"},
        {"--json", OPTION_TEXT, &c->json, 0, 0, "FILE", "results as JSON (- for standard output)"},
        {"--csv", OPTION_TEXT, &c->csv, 0, 0, "FILE", "results as CSV, a line a material"},
        {"--fail-below", OPTION_REAL, &c->fail_below, 0, 99, "DB", "exit code 5 if a material's pooled PSNR is less"},
        {"--quiet", OPTION_FLAG, &c->quiet, 0, 0, NULL, "print nothing but errors"},
    };
    int code = options_parse(argc, argv, usage, table, sizeof table / sizeof *table, &c->manifest, &operands, 1, 1, f);
    if (!code && c->shard) code = parse_shard(c->shard, &c->options, f);
    if (!code && c->backend) code = compare_backend_find(&c->options.backend, c->backend, f);
    if (!code && !c->options.directory) code = fail(f, FAIL_USAGE, "-o DIR is missing");
    if (!code && c->json) code = output_apart(c->json, c->manifest, f);
    if (!code && c->csv) code = output_apart(c->csv, c->manifest, f);
    return code;
}

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void print_result(const batch_command *c, const batch *b, double seconds)
{
    batch_counts n = batch_count(b);
    if (c->quiet || (c->json && !strcmp(c->json, "-"))) return;
    batch_print(b, stdout);
    printf("%d baked, %d up to date, %d failed; %.1f s\n", n.baked, n.up_to_date, n.failed, seconds);
}

/* The exit code that the results ask for. The failed ones have been told already. */
static int verdict(const batch_command *c, const batch *b, failure *f)
{
    int below = 0, worst = -1;
    for (int i = 0; i < b->count; i++) {
        if (b->result[i].status == BATCH_FAILED) return b->result[i].error.code;
        double pooled = b->result[i].figure[BATCH_POOLED];
        if (pooled >= c->fail_below) continue;
        below++;
        if (worst < 0 || pooled < b->result[worst].figure[BATCH_POOLED]) worst = i;
    }
    if (!below) return FAIL_NONE;
    return fail(f, FAIL_DIFFERENCE, "%s: found %.2f dB, expected at least %g (%d of %d materials are below)",
                b->result[worst].item->output, b->result[worst].figure[BATCH_POOLED], c->fail_below, below, b->count);
}

/* As if the signal had not been caught, for who called. */
static void pass_on(int number, const batch_command *c)
{
    fprintf(stderr, "nacre batch: %s: stopped by signal %d; the same command goes on where it was\n", c->manifest,
            number);
    signal(number, SIG_DFL);
    raise(number);
}

int cmd_batch(int argc, char **argv, failure *f)
{
    progress meter = {0};
    batch_command c = {.options = {.jobs = omp_get_num_procs(), .shard = 1, .shards = 1, .progress = &meter}};
    manifest m;
    batch b;
    double begun = seconds_now();
    int code = parse(&c, argc, argv, f);
    if (code || (code = manifest_read(&m, c.manifest, f))) return code;
    meter.quiet = c.quiet;
    c.options.name = c.manifest;
    if (!(code = batch_run(&b, &m, &c.options, f))) {
        if (b.interrupted) pass_on(b.interrupted, &c);
        print_result(&c, &b, seconds_now() - begun);
        if (c.csv) code = batch_csv(&b, c.csv, f);
        if (!code && c.json) {
            json figures = batch_json(&b);
            code = json_write(&figures, c.json, f);
        }
        if (!code) code = verdict(&c, &b, f);
        batch_free(&b);
    }
    manifest_free(&m);
    return code;
}
