/* SPDX-License-Identifier: MIT */
/* Work in a process of its own, for loaders that broken files make abort, crash or never end. */
#ifndef APART_H
#define APART_H

#include <stddef.h>

#include "failure.h"

/* Run job in a child, which writes to fd whatever the parent needs and returns 0; anything it prints is lost. *out receives
   the descriptor, at its beginning; close it. file: what is read (it gets 10 s and 1 s per MB); what: "mesh", for messages.
   FAIL_INVALID: the child crashed or took too long. FAIL_INTERNAL: no child, or it returned something else than 0. */
int apart_run(int (*job)(int fd, const char *file), const char *file, const char *what, int *out, failure *f);

/* All of data to fd, or from it; 0, or -1. */
int apart_write(int fd, const void *data, size_t size);
int apart_read(int fd, void *data, size_t size);

#endif
