/* SPDX-License-Identifier: MIT */
/* Published parameter sets of measured materials, embedded from fixtures/in/<set>.csv. */
#ifndef PUBLISHED_H
#define PUBLISHED_H

#include "brdf.h"

/* Name of a set: "sgd", "ngan-lafortune", "ngan-cook-torrance", "lafortune"; NULL past the end. */
const char *published_set(size_t index);

/* Names "SET:MATERIAL" of every set in one sorted array; static, made at the first call. */
const char *const *published_names(size_t *count);

/* Make the BRDF SET:MATERIAL. FAIL_USAGE lists the near names; FAIL_INTERNAL: the embedded text is not what it must be.
   Fills the description. */
int published_open(brdf **out, const char *set, const char *material, failure *f);

/* The same from a given CSV text (for tests); set decides the columns. */
int published_parse(brdf **out, const char *set, const char *material, const char *csv, size_t size, failure *f);

#endif
