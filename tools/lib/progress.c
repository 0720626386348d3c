/* SPDX-License-Identifier: MIT */
#include "progress.h"

#include <math.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static const double first_seconds = 1;  /* shorter work needs no line */
static const double again_seconds = .2; /* a line that changes faster can't be read */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void show(const progress *p, double seconds)
{
    double rate = p->done / seconds;
    const char *prefix = rate >= 1e6 ? "M" : rate >= 1e3 ? "k" : "";
    double shown_rate = rate >= 1e6 ? rate / 1e6 : rate >= 1e3 ? rate / 1e3 : rate;
    fprintf(stderr, "\r%.0f %% of %.0f %s, %.3g%s %s/s, %.0f s left\033[K", floor(100 * p->done / p->total), p->total,
            p->unit, shown_rate, prefix, p->unit, ceil(fmax(p->total - p->done, 0) / rate));
    fflush(stderr);
}

void progress_begin(progress *p, const char *unit, double total)
{
    if (!p) return;
    p->terminal = !p->quiet && isatty(STDERR_FILENO);
    p->visible = 0;
    p->unit = unit;
    p->total = total;
    p->done = 0;
    p->started = now();
    p->shown = p->started + first_seconds - again_seconds;
}

void progress_add(progress *p, double units)
{
    if (!p || !p->terminal) return;
#pragma omp critical(progress)
    {
        double seconds = now();
        p->done += units;
        if (seconds - p->shown >= again_seconds && p->done > 0) {
            show(p, seconds - p->started);
            p->shown = seconds;
            p->visible = 1;
        }
    }
}

void progress_drop(progress *p, double units)
{
    if (!p) return;
#pragma omp critical(progress)
    p->total -= units;
}

void progress_end(progress *p)
{
    if (!p || !p->visible) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
    p->visible = 0;
}
