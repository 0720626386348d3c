/* SPDX-License-Identifier: MIT */
/* Work on several processes: every index is worked on once whatever the number of workers, and one that crashes takes only
   its own piece with it. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pool.h"

#include <cmocka.h> /* last: it makes fail a macro */

enum { COUNT = 60 };

typedef struct tally {
    atomic_int worked[COUNT]; /* shared with the workers */
    int told[COUNT];
    char how[COUNT][60];
} tally;

static void work(int index, void *context)
{
    atomic_fetch_add(&((tally *)context)->worked[index], 1);
}

static void done(int index, const char *ended, void *context)
{
    tally *t = context;
    t->told[index]++;
    snprintf(t->how[index], sizeof t->how[index], "%s", ended ? ended : "");
}

static void every_index_once(void **state)
{
    (void)state;
    static const int jobs[] = {1, 2, 7, COUNT, POOL_MAX_JOBS};
    for (size_t i = 0; i < sizeof jobs / sizeof *jobs; i++) {
        tally *t = pool_memory(sizeof *t);
        pool p = {.jobs = jobs[i], .threads = 1, .context = t, .work = work, .done = done};
        assert_int_equal(pool_run(&p, COUNT), 0);
        for (int k = 0; k < COUNT; k++) {
            assert_int_equal(t->worked[k], 1);
            assert_int_equal(t->told[k], 1);
            assert_string_equal(t->how[k], "");
        }
        pool_memory_free(t, sizeof *t);
    }
}

static void nothing_to_do(void **state)
{
    (void)state;
    pool p = {.jobs = 2, .threads = 1, .work = work, .done = done};
    assert_int_equal(pool_run(&p, 0), 0);
}

static void crash_at_every_fifth(int index, void *context)
{
    work(index, context);
    if (index % 5 == 0) raise(SIGKILL);
    if (index % 5 == 1) _exit(70);
    if (index % 5 == 2) _exit(0);
}

static void a_crash_takes_only_its_own_piece(void **state)
{
    (void)state;
    tally *t = pool_memory(sizeof *t);
    pool p = {.jobs = 3, .threads = 1, .context = t, .work = crash_at_every_fifth, .done = done};
    assert_int_equal(pool_run(&p, COUNT), 0);
    static const char *const expected[5] = {"signal 9, Killed", "exit code 70", "exit code 0", "", ""};
    for (int k = 0; k < COUNT; k++) {
        assert_int_equal(t->worked[k], 1);
        assert_int_equal(t->told[k], 1);
        assert_string_equal(t->how[k], expected[k % 5]);
    }
    pool_memory_free(t, sizeof *t);
}

static void wait_or_call(int index, void *context)
{
    work(index, context);
    if (index == 3) kill(getppid(), SIGTERM);
    if (index >= 3) pause();
}

static void a_signal_ends_the_workers(void **state)
{
    (void)state;
    tally *t = pool_memory(sizeof *t);
    pool p = {.jobs = 2, .threads = 1, .context = t, .work = wait_or_call, .done = done};
    assert_int_equal(pool_run(&p, COUNT), SIGTERM);
    for (int k = 0; k < COUNT; k++) assert_true(t->told[k] <= (k < 3)); /* the last ones may not have been heard of */
    assert_int_equal(t->worked[COUNT - 1], 0);
    struct sigaction now;
    sigaction(SIGTERM, NULL, &now);
    assert_true(now.sa_handler == SIG_DFL);
    pool_memory_free(t, sizeof *t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_index_once),
        cmocka_unit_test(nothing_to_do),
        cmocka_unit_test(a_crash_takes_only_its_own_piece),
        cmocka_unit_test(a_signal_ends_the_workers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
