/* SPDX-License-Identifier: MIT */
/* The progress line: on a terminal and after a second, never in a pipe. Standard error is a pseudo-terminal here. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "progress.h"

static void pause_ms(long ms)
{
    struct timespec t = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&t, NULL);
}

/* One of four units done when so many milliseconds have passed. */
static void work(int quiet, long ms)
{
    progress p = {.quiet = quiet};
    progress_begin(&p, "images", 4);
    pause_ms(ms);
    progress_add(&p, 1);
    progress_end(&p);
}

/* What work() writes to standard error when that is the descriptor `to`, as read from `from`. */
static void capture(int to, int from, int quiet, long ms, char *text, size_t size)
{
    int kept = dup(STDERR_FILENO);
    assert_true(kept >= 0);
    assert_true(dup2(to, STDERR_FILENO) >= 0);
    work(quiet, ms);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    close(kept);
    assert_true(fcntl(from, F_SETFL, O_NONBLOCK) >= 0);
    ssize_t got = read(from, text, size - 1);
    text[got > 0 ? got : 0] = 0;
}

static void on_terminal(int quiet, long ms, char *text, size_t size)
{
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    if (master < 0 || grantpt(master) || unlockpt(master)) {
        print_message("SKIPPED: this machine has no pseudo-terminals (is /dev/pts mounted?)\n");
        skip();
    }
    int slave = open(ptsname(master), O_RDWR | O_NOCTTY);
    assert_true(slave >= 0);
    capture(slave, master, quiet, ms, text, size);
    close(slave);
    close(master);
}

static void a_terminal_shows_part_rate_and_time_left(void **state)
{
    (void)state;
    char text[400];
    int percent = 0, left = 0;
    double rate = 0;
    on_terminal(0, 1100, text, sizeof text);
    /* a quarter in 1.1 s or, on a busy machine, a little more */
    assert_int_equal(sscanf(text, "\r%d %% of 4 images, %lf images/s, %d s left", &percent, &rate, &left), 3);
    assert_int_equal(percent, 25);
    assert_true(rate > 0.2 && rate <= 0.91);
    assert_in_range(left, 4, 15);
    assert_string_equal(text + strlen(text) - 4, "\r\033[K"); /* wiped at the end */
}

/* Two of six need no work: the rate is that of the others. */
static void dropped_units_count_in_neither(void **state)
{
    (void)state;
    progress p = {.quiet = 1};
    progress_begin(&p, "images", 6);
    progress_drop(&p, 2);
    progress_add(&p, 1);
    assert_true(p.total == 4);
    progress_end(&p);
}

static void nothing_is_shown_in_the_first_second(void **state)
{
    (void)state;
    char text[400];
    on_terminal(0, 0, text, sizeof text);
    assert_string_equal(text, "");
}

static void quiet_shows_nothing(void **state)
{
    (void)state;
    char text[400];
    on_terminal(1, 1100, text, sizeof text);
    assert_string_equal(text, "");
}

static void a_pipe_gets_nothing(void **state)
{
    (void)state;
    char text[400];
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    capture(ends[1], ends[0], 0, 1100, text, sizeof text);
    assert_string_equal(text, "");
    close(ends[0]);
    close(ends[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_terminal_shows_part_rate_and_time_left),
        cmocka_unit_test(dropped_units_count_in_neither),
        cmocka_unit_test(nothing_is_shown_in_the_first_second),
        cmocka_unit_test(quiet_shows_nothing),
        cmocka_unit_test(a_pipe_gets_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
