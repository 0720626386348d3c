/* SPDX-License-Identifier: MIT */
/* nacre bench from outside: every table runs, and its JSON has the rows that its users count on. Times themselves are not
   judged: they belong to the machine. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "shell.h"

#include <cmocka.h>

typedef struct expected {
    const char *table, *options;
    const char *texts[4], *numbers[4]; /* what each row holds; numbers are above zero */
    int rows;                          /* 0: any number from one on */
} expected;

static void check_row(const expected *e, const cJSON *row)
{
    for (int i = 0; i < 4 && e->texts[i]; i++) {
        const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, e->texts[i]));
        if (!text || !*text) fail_msg("%s: a row without the text %s", e->table, e->texts[i]);
    }
    for (int i = 0; i < 4 && e->numbers[i]; i++) {
        const cJSON *number = cJSON_GetObjectItemCaseSensitive(row, e->numbers[i]);
        if (!cJSON_IsNumber(number) || number->valuedouble <= 0)
            fail_msg("%s: a row without a number %s above zero", e->table, e->numbers[i]);
    }
}

static void tables_run(void **state)
{
    static const expected list[] = {
        /* three models under 1, 2, 4 and 8 lights */
        {"models", "", {"model", "mesh"}, {"lights", "cpu_ms", "wall_ms"}, 12},
        /* 1 to 3 lights by 1 to 3 lobes, as in the paper's tables 1 and 2 */
        {"paper000", "", {NULL}, {"frames_per_second", "ratio", "published_ratio", "draws"}, 9},
        /* direct 1, 2, 4, 8; lit those and 64, at rest and moving; 64 with a budget */
        {"paper002", "--mesh teapot", {"mesh", "path"}, {"lights", "frame_ms"}, 15},
        {"cpu", "", {"renderer", "path", "model", "mesh"}, {"lights", "cpu_ms"}, 0},
    };
    (void)state;
    for (size_t t = 0; t < sizeof list / sizeof *list; t++) {
        const expected *e = &list[t];
        const shell_outcome o = shell_run("nacre bench --table %s %s --size 16 --rounds 1 --frames 1 --json %s.json",
                                          e->table, e->options, e->table);
        char name[32];
        int rows = 0;
        if (o.code == 4) { /* no driver here: the frame tests say so loudly */
            print_message("SKIPPED: bench --table %s: %s", e->table, o.text);
            continue;
        }
        if (o.code) fail_msg("%s gave %d: %s", e->table, o.code, o.text);
        snprintf(name, sizeof name, "%s.json", e->table);
        char *text = shell_read(name);
        cJSON *root = cJSON_Parse(text), *row;
        assert_non_null(root);
        assert_int_equal(cJSON_GetObjectItemCaseSensitive(root, "size")->valueint, 16);
        cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(root, "rows"))
        {
            check_row(e, row);
            rows++;
        }
        if (e->rows ? rows != e->rows : rows < 1) fail_msg("%s: %d rows, expected %d", e->table, rows, e->rows);
        cJSON_Delete(root);
        free(text);
    }
}

static void mistakes(void **state)
{
    static const shell_mistake list[] = {
        {"nacre bench --table nowhere", 1, "nowhere"},  {"nacre bench --backend soft", 1, "egl2"},
        {"nacre bench --rounds 0", 1, "--rounds"},      {"nacre bench --table paper000 --mesh none.obj", 2, "none.obj"},
        {"nacre bench --material sgd:none", 1, "none"},
    };
    (void)state;
    CHECK(list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(tables_run), cmocka_unit_test(mistakes)};
    return cmocka_run_group_tests(tests, shell_begin, shell_end);
}
