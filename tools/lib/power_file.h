/* SPDX-License-Identifier: MIT */
/* Files of role "power" (nacre_asset.h): the table of x^n that the runtime makes for itself, as a file. */
#ifndef POWER_FILE_H
#define POWER_FILE_H

#include "output.h"

typedef struct power_file {
    int width, height; /* 2..4096 */
} power_file;

void power_file_write(const power_file *p, bytes *out);

/* What a GPU filters from it at x and n (at the exponent's exact row coordinate). */
double power_file_sample(const power_file *p, double x, double n);
/* Largest error of x^n for x in 0.5..1. */
double power_file_error(const power_file *p, double n);
/* Largest error of its root, what a display shows, for x in 0..1. */
double power_file_root_error(const power_file *p, double n);

#endif
