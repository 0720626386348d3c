/* SPDX-License-Identifier: MIT */
/* Lists of bakes: CSV or JSON lines; a BRDF, its kind, options and output file each. */
#ifndef MANIFEST_H
#define MANIFEST_H

#include <stddef.h>

#include "bake.h"

/*
 * CSV (RFC 4180, with blank lines and lines that begin with # left out): columns brdf, kind, options, output in this order, or
 * as a first line with the word brdf names them. A field with a comma in it is quoted.
 *     sgd:gold-metallic-paint
 *     gold.binary,table,--tier fine
 *     "ggx:rough=.3,f0=.04",spheres,--size 128,rough.ktx2
 * JSON lines (a first character { tells): objects of the same names. options is a text, or an object; true is a flag.
 *     {"brdf": "gold.binary", "options": {"tier": "fine", "size": "32x21"}}
 * Only brdf must be there. kind is table if not given, output a name made of the others: gold-table-fine.ktx2.
 */
typedef struct manifest_item {
    int line; /* where it begins, from 1 */
    char *brdf, *kind, *options, *output;
    bake_request request; /* of these; borrows them */
    char **argument;      /* KIND BRDF options..., NULL at the end */
    int argument_count;
} manifest_item;

typedef struct manifest {
    manifest_item *item;
    int count;
} manifest;

/* Read a list ("-": standard input). FAIL_IO: not readable. FAIL_INVALID: not such a list; the message has line, column or
   field, what was found and what expected: a kind or an option that does not exist, an output twice or outside the
   directory, no line at all. Whether BRDFs can be opened is not looked at. Free with manifest_free. */
int manifest_read(manifest *out, const char *path, failure *f);

/* The same from memory; path is for messages. */
int manifest_parse(manifest *out, const char *text, size_t size, const char *path, failure *f);
void manifest_free(manifest *m);

#endif
