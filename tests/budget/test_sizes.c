/* SPDX-License-Identifier: MIT */
/* Sizes are promises: what `make sizes` measures must not exceed fixtures/budget/sizes.csv. Both files have the rows
   target,room,text,data,bss,stack ("-" = not measured). Growth is a decision: change the budget in a commit that says
   what the bytes buy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MEASURED "build/sizes.csv"
#define BUDGET   "fixtures/budget/sizes.csv"

enum { COLUMNS = 4, MAX_ROWS = 64 };
static const char *const column_name[COLUMNS] = {"text", "data", "bss", "stack"};

typedef struct row {
    char target[24], room[24];
    long value[COLUMNS]; /* -1: not measured */
} row;

static int read_rows(const char *path, row *rows)
{
    FILE *file = fopen(path, "r");
    if (!file) fail_msg("%s: can't read (run from the top of the tree after `make sizes`)", path);
    char line[200];
    int count = 0;
    while (fgets(line, sizeof line, file)) {
        char cell[COLUMNS][16];
        row *r = &rows[count];
        if (line[0] == '#' || !strncmp(line, "target,", 7)) continue;
        assert_int_equal(sscanf(line, "%23[^,],%23[^,],%15[^,],%15[^,],%15[^,],%15[^,\n]", r->target, r->room, cell[0],
                                cell[1], cell[2], cell[3]),
                         6);
        for (int i = 0; i < COLUMNS; i++) r->value[i] = strcmp(cell[i], "-") ? atol(cell[i]) : -1;
        assert_true(++count < MAX_ROWS);
    }
    fclose(file);
    return count;
}

static const row *find_row(const row *rows, int count, const row *like)
{
    for (int i = 0; i < count; i++)
        if (!strcmp(rows[i].target, like->target) && !strcmp(rows[i].room, like->room)) return &rows[i];
    return NULL;
}

static void every_room_stays_within_its_budget(void **state)
{
    (void)state;
    row measured[MAX_ROWS], budget[MAX_ROWS];
    int measured_count = read_rows(MEASURED, measured), budget_count = read_rows(BUDGET, budget), bad = 0;
    assert_true(measured_count > 0);
    for (int i = 0; i < measured_count; i++) {
        const row *m = &measured[i], *b = find_row(budget, budget_count, m);
        if (!b) {
            print_error("%s %s: no budget in " BUDGET "\n", m->target, m->room);
            bad++;
            continue;
        }
        for (int c = 0; c < COLUMNS; c++) {
            if (m->value[c] < 0 || b->value[c] < 0) continue;
            print_message("%-10s %-12s %-5s %6ld of %6ld\n", m->target, m->room, column_name[c], m->value[c],
                          b->value[c]);
            if (m->value[c] <= b->value[c]) continue;
            print_error("%s %s: %s grew to %ld bytes, budget %ld\n", m->target, m->room, column_name[c], m->value[c],
                        b->value[c]);
            bad++;
        }
    }
    for (int i = 0; i < budget_count; i++) {
        if (find_row(measured, measured_count, &budget[i])) continue;
        print_error("%s %s: in the budget but not measured\n", budget[i].target, budget[i].room);
        bad++;
    }
    assert_int_equal(bad, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_room_stays_within_its_budget)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
