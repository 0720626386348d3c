/* SPDX-License-Identifier: MIT */
#include "workspace.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { GUARD = 0x5A, FILL = 0xA5 };

static void out_of_memory(size_t size)
{
    fprintf(stderr, "workspace: no memory for %zu bytes\n", size);
    abort();
}

void workspace_make(workspace *w, size_t size, workspace_edge edge)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    /* at least 64 guard bytes on the side that does not fault */
    const size_t inner = (size + 64 + page - 1) / page * page;

    w->size = size;
    w->map_size = inner + page;
    w->map = mmap(NULL, w->map_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (w->map == MAP_FAILED) out_of_memory(size);
    memset(w->map, GUARD, w->map_size);
    uint8_t *fault = edge == WORKSPACE_FAULT_AFTER ? w->map + inner : w->map;
    w->data = edge == WORKSPACE_FAULT_AFTER ? fault - size : fault + page;
    memset(w->data, FILL, size);
    if (mprotect(fault, page, PROT_NONE)) out_of_memory(size);
}

/* The accessible pages: everything but the faulting one, which touches the block. */
static void accessible(const workspace *w, uint8_t **begin, uint8_t **end)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const int fault_before = w->data == w->map + page;

    *begin = fault_before ? w->data : w->map;
    *end = fault_before ? w->map + w->map_size : w->data + w->size;
}

int workspace_intact(const workspace *w)
{
    uint8_t *begin, *end;

    accessible(w, &begin, &end);
    for (const uint8_t *p = begin; p < end; p++) {
        if (p == w->data) p += w->size;
        if (p < end && *p != GUARD) return 0;
    }
    return 1;
}

void workspace_protect(workspace *w)
{
    uint8_t *begin, *end;
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);

    accessible(w, &begin, &end);
    end = w->map + ((size_t)(end - w->map) + page - 1) / page * page;
    if (mprotect(begin, (size_t)(end - begin), PROT_READ)) out_of_memory(w->size);
}

void workspace_free(workspace *w)
{
    munmap(w->map, w->map_size);
    memset(w, 0, sizeof *w);
}
