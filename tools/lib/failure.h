/* SPDX-License-Identifier: MIT */
/* One-line errors and the program's exit codes. */
#ifndef FAILURE_H
#define FAILURE_H

#include <stddef.h>

/* Exit codes of `nacre` and results of every tools/lib function that can fail (0 = success). */
enum {
    FAIL_NONE = 0,
    FAIL_USAGE = 1,       /* command line: option, value, range */
    FAIL_IO = 2,          /* a file can't be opened, read, written */
    FAIL_INVALID = 3,     /* a file's content is not what it must be */
    FAIL_UNSUPPORTED = 4, /* valid, but not here: format, device, model */
    FAIL_DIFFERENCE = 5,  /* a compared figure is beyond the given limit */
    FAIL_INTERNAL = 70    /* out of memory, a broken invariant */
};

typedef struct failure {
    int code;
    char text[1000]; /* one line: file, offset or option, found, expected */
} failure;

/* Record the failure (f may be NULL) and return code. */
int fail(failure *f, int code, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* malloc that ends the program with FAIL_INTERNAL and one line when memory is out; size 0 gives a valid pointer. */
void *need_memory(size_t count, size_t size);

#endif
