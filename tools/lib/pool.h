/* SPDX-License-Identifier: MIT */
/* Independent pieces of work on several processes: one that crashes takes nothing with it but its piece. */
#ifndef POOL_H
#define POOL_H

#include <stddef.h>

enum { POOL_MAX_JOBS = 256 };

typedef struct pool {
    int jobs;    /* processes, 1..POOL_MAX_JOBS */
    int threads; /* OpenMP threads of each; with 1, the caller may have used OpenMP before */
    void *context;
    /* In a worker process, for one index; what it finds goes to memory of pool_memory. */
    void (*work)(int index, void *context);
    /* In the caller's process, once for every index, in the order of completion. ended: NULL, or how the worker ended
       instead of finishing ("signal 11, Segmentation fault"). */
    void (*done)(int index, const char *ended, void *context);
} pool;

/* Zeroed memory that workers and caller share; ends the program with one line when there is none. */
void *pool_memory(size_t size);
void pool_memory_free(void *memory, size_t size);

/* Work on 0..count-1, taken in this order. SIGINT, SIGTERM and SIGHUP end the workers; the signal's number is returned then,
   else 0. Workers also end when the caller's process does, however it ends. */
int pool_run(const pool *p, int count);

#endif
