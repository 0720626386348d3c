/* SPDX-License-Identifier: MIT */
/* The drivers that frames are tested on. Mesa reads its settings once, so each runs in a process of its own. */
#ifndef DRIVERS_H
#define DRIVERS_H

#include "gl_headless.h"

typedef struct driver {
    const char *name;
    gl_backend backend;
    const char *environment[4]; /* "NAME=VALUE", before the process starts */
    int half;                   /* mediump is fp16 there, as on small GPUs; else fp32 */
    int size;                   /* of the frames drawn there, pixels a side */
} driver;

extern const driver drivers[];
extern const int driver_count;

/* Start this program again as `PROGRAM --driver INDEX ARGUMENT`, with the driver's environment, and wait. Returns its
   exit code (SKIPPED: the driver is not on this machine), 70 when it was killed. */
#define DRIVER_SKIPPED 77
int driver_run(int index, const char *argument);
/* Index if this process was started so, -1 if not; *argument receives the last one. */
int driver_of_arguments(int argc, char **argv, const char **argument);

/* Remove a directory that tests and their children shared, with the files in it. */
void driver_remove_directory(const char *path);

#endif
