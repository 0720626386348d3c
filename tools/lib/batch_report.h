/* SPDX-License-Identifier: MIT */
/* What a batch has found: a table for people, JSON, CSV. Materials of one kind and the same options form a group, with the
   mean of every figure and the worst. None of the three depends on the number of jobs. */
#ifndef BATCH_REPORT_H
#define BATCH_REPORT_H

#include <stdio.h>

#include "batch.h"

typedef struct batch_counts {
    int baked, up_to_date, failed;
} batch_counts;

batch_counts batch_count(const batch *b);

/* One group after the other, in the order of their first materials. */
void batch_print(const batch *b, FILE *out);
/* {"materials": [...], "groups": [...], "baked": n, "up_to_date": n, "failed": n} */
json batch_json(const batch *b);
/* A line a material; a failed one's figures are empty. */
int batch_csv(const batch *b, const char *path, failure *f);

#endif
