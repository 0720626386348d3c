/* SPDX-License-Identifier: MIT */
/* How far long work has come: a line on the terminal of standard error, rewritten in place, with rate and time left.
   It appears when the work has lasted a second; where standard error is no terminal nothing is ever written. */
#ifndef PROGRESS_H
#define PROGRESS_H

typedef struct progress { /* zero, but for quiet */
    int quiet;            /* 1: no line, whatever standard error is */
    int terminal, visible;
    const char *unit;
    double total, done;    /* in units */
    double started, shown; /* seconds of the monotonic clock */
} progress;

/* The worker says what it counts ("images"; kept, not copied) and how many there are (> 0), reports from any thread
   what is done, and ends: the line is wiped. p may be NULL in all of them. */
void progress_begin(progress *p, const char *unit, double total);
void progress_add(progress *p, double units);
void progress_drop(progress *p, double units); /* so many need no work: the total shrinks, the rate stays */
void progress_end(progress *p);

#endif
