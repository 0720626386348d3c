/* SPDX-License-Identifier: MIT */
/* A block of exactly so many bytes between guards: one side ends at a page that faults on any access, the other at
   bytes whose change is noticed. Tests run the code twice, once with each side. */
#ifndef WORKSPACE_H
#define WORKSPACE_H

#include <stddef.h>
#include <stdint.h>

typedef enum workspace_edge {
    WORKSPACE_FAULT_AFTER, /* the byte behind the block faults */
    WORKSPACE_FAULT_BEFORE /* the byte before the block faults */
} workspace_edge;

typedef struct workspace {
    uint8_t *data;
    size_t size;
    uint8_t *map;
    size_t map_size;
} workspace;

/* Filled with 0xA5. Ends the program if memory is out. FAULT_AFTER gives data any alignment, FAULT_BEFORE a page's. */
void workspace_make(workspace *w, size_t size, workspace_edge edge);
/* 1 if no guard byte has changed. */
int workspace_intact(const workspace *w);
/* From now on a write to the block faults too. */
void workspace_protect(workspace *w);
void workspace_free(workspace *w);

#endif
