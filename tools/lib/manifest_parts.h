/* SPDX-License-Identifier: MIT */
/* Inside of the manifest reader: the two notations give fields, manifest.c makes items of them. */
#ifndef MANIFEST_PARTS_H
#define MANIFEST_PARTS_H

#include "manifest.h"

enum { MANIFEST_BRDF, MANIFEST_KIND, MANIFEST_OPTIONS, MANIFEST_OUTPUT, MANIFEST_FIELDS };

/* Index of a field's name; -1 if it is none. */
int manifest_field(const char *name);
extern const char *const manifest_fields[MANIFEST_FIELDS];

/* What a notation has found on the way. */
typedef struct manifest_reader {
    manifest *out;
    const char *path; /* for messages */
    int capacity;
} manifest_reader;

/* Append an item of the fields (NULL or "": not given). */
int manifest_add(manifest_reader *r, int line, const char *const field[MANIFEST_FIELDS], failure *f);

int manifest_csv(manifest_reader *r, const char *text, size_t size, failure *f);
int manifest_json(manifest_reader *r, const char *text, size_t size, failure *f);

#endif
