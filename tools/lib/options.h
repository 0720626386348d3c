/* SPDX-License-Identifier: MIT */
/* Command lines: one table per subcommand gives parsing, ranges and --help alike. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <stddef.h>

#include "failure.h"

typedef enum option_kind {
    OPTION_FLAG, /* --x           int *     becomes 1 */
    OPTION_TEXT, /* --x VALUE     const char ** (borrowed from argv) */
    OPTION_INT,  /* --x N         int *     within low..high */
    OPTION_REAL, /* --x R         double *  within low..high, finite */
    OPTION_TEXTS /* --x VALUE ... option_texts *: may be repeated */
} option_kind;

typedef struct option_texts {
    const char *item[64];
    int count;
} option_texts;

typedef struct option {
    const char *name; /* with its dashes: "--size" or "-o" */
    option_kind kind;
    void *value;
    double low, high;            /* OPTION_INT, OPTION_REAL */
    const char *argument, *help; /* "WxH", "what it does (default)" */
} option;

/* Parse argv[1..]; operands (not options; "-" and what follows "--" too) go to operand[0..*count-1].
   low_count..high_count operands are accepted; usage is the line shown by --help, which prints the table and
   what follows that line in usage, and ends the program with 0. An unknown option names the nearest known one. */
int options_parse(int argc, char **argv, const char *usage, const option *table, size_t table_count,
                  const char **operand, int *count, int low_count, int high_count, failure *f);

/* "1,2.5,3": up to most finite numbers; *count receives how many. what names the option in the error. */
int parse_reals(const char *text, const char *what, double *out, int least, int most, int *count, failure *f);
/* "WxH" with 1..limit each; a single "N" means NxN. */
int parse_size(const char *text, const char *what, int limit, int *width, int *height, failure *f);

/* Candidates of names[] nearest to word (edit distance), "a, b, c"; empty if none is near. */
void nearest_names(const char *word, const char *const *names, size_t count, char *out, size_t size);

#endif
