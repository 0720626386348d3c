/* SPDX-License-Identifier: MIT */
#include "failure.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* File names and option values may hold control characters. */
static void keep_one_line(char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text < 0x20 || *text == 0x7f) *text = '?';
}

int fail(failure *f, int code, const char *format, ...)
{
    if (f) {
        va_list args;
        va_start(args, format);
        vsnprintf(f->text, sizeof f->text, format, args);
        va_end(args);
        keep_one_line(f->text);
        f->code = code;
    }
    return code;
}

void *need_memory(size_t count, size_t size)
{
    void *p = calloc(count ? count : 1, size ? size : 1);
    if (!p) {
        fprintf(stderr, "nacre: out of memory: %zu x %zu bytes\n", count, size);
        exit(FAIL_INTERNAL);
    }
    return p;
}
