/* SPDX-License-Identifier: MIT */
/* Files in and out: whole files at once, written to a temporary file beside the target and renamed. */
#ifndef OUTPUT_H
#define OUTPUT_H

#include <stddef.h>
#include <stdint.h>

#include "failure.h"

typedef struct bytes { /* malloc'd, owned by whoever holds it */
    uint8_t *data;
    size_t size, capacity;
} bytes;

void bytes_append(bytes *b, const void *data, size_t size);
void bytes_append_u32(bytes *b, uint32_t value); /* little-endian */
void bytes_printf(bytes *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
void bytes_free(bytes *b);

int file_read(bytes *out, const char *path, failure *f);

/* Write b to path (temporary file + fsync + rename: a failure leaves the old file and no partial one).
   A path ending in .c gets a C array instead: `const unsigned char NAME[]` and `const unsigned long NAME_size`,
   8-byte aligned, NAME from the file's name with other characters than [A-Za-z0-9] as _. */
int output_write(const char *path, const bytes *b, failure *f);
/* The same without the .c rule, for texts and pictures. */
int output_write_raw(const char *path, const bytes *b, failure *f);

/* C name of what is in a file: "out/my-gold.c" gives my_gold. */
void output_identifier(const char *path, char *out, size_t size);

/* FAIL_USAGE if path is the same regular file as input (which may be NULL, or no file at all): an output must not replace
   what it is made of. */
int output_apart(const char *path, const char *input, failure *f);
/* Remove an output again, for want of another that belongs to it. Devices and pipes stay. */
void output_discard(const char *path);

/* Make fragment `target: inputs...`, names escaped for make. */
int output_depfile(const char *path, const char *target, const char *const *inputs, size_t count, failure *f);

#endif
