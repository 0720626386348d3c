/* SPDX-License-Identifier: MIT */
/* Bake and compare every material of a manifest, on several processes, leaving out what is up to date. */
#ifndef BATCH_H
#define BATCH_H

#include "compare.h"
#include "content.h"
#include "manifest.h"

/* What is known of a baked material; compare.h defines the figures. */
enum {
    BATCH_BYTES,
    BATCH_FETCHES,
    BATCH_POOLED,
    BATCH_WORST,
    BATCH_WORST_DEG,
    BATCH_DIM_POOLED,
    BATCH_DIM_WORST,
    BATCH_SSIM,
    BATCH_RELATIVE_RMS,
    BATCH_ALBEDO_ERROR,
    BATCH_FIGURES
};

typedef struct batch_figure {
    const char *key;     /* in JSON and CSV: "pooled_psnr_db" */
    const char *heading; /* in the table */
    double unit;         /* the table shows value / unit ... */
    int decimals;        /* ... with so many decimals */
    int better;          /* 1: larger is better, -1: smaller, 0: neither (no mean, no worst) */
} batch_figure;

extern const batch_figure batch_figures[BATCH_FIGURES];

typedef enum batch_status { BATCH_BAKED, BATCH_UP_TO_DATE, BATCH_FAILED } batch_status;

typedef struct batch_result {
    const manifest_item *item;
    batch_status status;
    failure error; /* of a failed one */
    double figure[BATCH_FIGURES];
} batch_result;

typedef struct batch_options {
    const char *directory;   /* of all outputs; made if it is not there */
    compare_backend backend; /* draws the assets for comparison */
    int jobs;                /* processes, 1..256; results do not depend on it */
    int shard, shards;       /* 1..shards: only every shards-th item, from the shard-th on */
    progress *progress;      /* told of materials; may be NULL */
    const char *name;        /* of the manifest, for messages */
} batch_options;

typedef struct batch {
    batch_result *result; /* in the manifest's order */
    int count;
    int interrupted; /* by this signal; what was not reached is BATCH_FAILED */
} batch;

/* Every material gives OUTPUT and OUTPUT.json: its figures and the fingerprints of what it was made of (this program, the backend, kind,
   options, the BRDF's name and its file's content) and of OUTPUT. A material whose fingerprints are all still right is up to
   date. Each file appears whole or not at all. A material that fails is told to standard error in one line; its files stay as
   they were.
   FAIL_IO: the directory can't be made. FAIL_INVALID: a BRDF is one of the outputs. Free with batch_free. m must stay. */
int batch_run(batch *out, const manifest *m, const batch_options *options, failure *f);
void batch_free(batch *b);

/* ---- batch_record.c: OUTPUT.json ------------------------------------------------------------------------------ */

typedef struct batch_record {
    char made_of[CONTENT_TEXT], content[CONTENT_TEXT];
    double figure[BATCH_FIGURES];
} batch_record;

int batch_record_write(const batch_record *r, const manifest_item *item, const char *path, failure *f);
/* 0: there is none, or nothing usable. */
int batch_record_read(batch_record *out, const char *path);

#endif
