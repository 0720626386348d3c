/* SPDX-License-Identifier: MIT */
/* Fingerprints of content (XXH3, 128 bits): equal ones mean equal bytes for all but an attacker. */
#ifndef CONTENT_H
#define CONTENT_H

#include <stddef.h>

#include "failure.h"

typedef struct content content; /* of all that was added, in order */

#define CONTENT_TEXT 33 /* 32 hexadecimal digits and a NUL */

content *content_begin(void);
void content_add(content *c, const void *data, size_t size);
void content_add_text(content *c, const char *text); /* with its NUL: "ab", "c" differs from "a", "bc" */
int content_add_file(content *c, const char *path,
                     failure *f);                     /* its bytes. FAIL_IO: no regular file, or not readable */
void content_end(content *c, char out[CONTENT_TEXT]); /* frees c; out may be NULL */

/* The fingerprint of one file. */
int content_of_file(const char *path, char out[CONTENT_TEXT], failure *f);

#endif
