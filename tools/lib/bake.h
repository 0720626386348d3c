/* SPDX-License-Identifier: MIT */
/* What a BRDF can be baked to: one row per kind has its name, options and bake. Every command that bakes goes through
   here, so that a kind or an option added here is everywhere. */
#ifndef BAKE_H
#define BAKE_H

#include "brdf.h"
#include "json.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "sphere_bake.h"
#include "table_bake.h"

/* One bake as asked for: BRDF, kind, and the kind's options. Texts are borrowed from the command line. */
typedef struct bake_kind bake_kind;
typedef struct bake_request {
    const bake_kind *kind;
    const char *brdf;
    const char *size, *tier, *polar, *mode, *format; /* as given; NULL: not given */
    table_options table;                             /* what they mean */
    sphere_options spheres;
} bake_request;

typedef struct bake_result {
    bytes file;      /* a KTX2 file */
    json figures;    /* one JSON object about it */
    char shape[160]; /* the same for people: "24 x 21 x 1, 2016 bytes of texels" */
} bake_result;

struct bake_kind {
    const char *name, *help;
    size_t (*options)(bake_request *r, option *row); /* fills at most BAKE_MAX_OPTIONS rows; returns how many */
    int (*check)(bake_request *r, failure *f);       /* from texts to what they mean */
    int (*run)(const bake_request *r, const brdf *b, progress *p, bake_result *out, failure *f);
};
enum { BAKE_MAX_OPTIONS = 16 };

/* All kinds, in the order of help texts. Static. */
const bake_kind *bake_kinds(size_t *count);
const bake_kind *bake_find(const char *name); /* NULL: there is no such kind */
void bake_kind_names(char *out, size_t size); /* "table, spheres", for messages */

/* Read `KIND BRDF options...` (argv[0] is the kind's name, which must exist); common rows are the caller's own options.
   FAIL_USAGE as options_parse and the kind say. --help prints both and ends the program. */
int bake_parse(bake_request *out, int argc, char **argv, const option *common, size_t common_count, failure *f);

/* Bake b. path is what the figures call the file; nothing is written. p may be NULL. The result depends on the request
   and b alone. Failures as the kind's bake says; *out is untouched then. Free with bake_free. */
int bake_run(const bake_request *r, const brdf *b, const char *path, progress *p, bake_result *out, failure *f);
void bake_free(bake_result *r);

/* The file a BRDF's name stands for: what follows "merl:" or "rgl:", or the name itself if such a file exists; else NULL. */
const char *bake_input(const char *name);

#endif
