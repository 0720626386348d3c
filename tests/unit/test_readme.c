/* SPDX-License-Identifier: MIT */
/* README.md is for users: its program compiles without a warning against the public headers and links with the
   library, and every `make` target and `nacre` subcommand that it names exists. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static char *read_readme(void)
{
    FILE *file = fopen("README.md", "rb");
    if (!file) fail_msg("README.md: not found; run from the top of the tree");
    char *text = calloc(1, 1 << 20);
    size_t got = fread(text, 1, (1 << 20) - 1, file);
    assert_true(got > 0);
    fclose(file);
    return text;
}

static void the_smallest_program_compiles_and_links(void **state)
{
    (void)state;
    static const char build[] =
        "f=$(mktemp -d) && cat >$f/p.c && printf 'int main(void) { return 0; }\\n' >$f/m.c && "
        "cc -std=c99 -Wall -Wextra -pedantic -Werror -Iinclude -o $f/p $f/p.c $f/m.c build/release/libnacre.a; "
        "s=$?; rm -r $f; exit $s";
    char *text = read_readme(), *begin = strstr(text, "```c\n"), *end = begin ? strstr(begin + 5, "```") : NULL;
    assert_non_null(end);
    FILE *pipe = popen(build, "w");
    assert_non_null(pipe);
    fwrite(begin + 5, 1, (size_t)(end - begin - 5), pipe);
    assert_int_equal(pclose(pipe), 0);
    free(text);
}

/* Every line that starts with word (a newline, four spaces, a program, a space) names a target or subcommand next. */
static int check_commands(const char *text, const char *word, const char *command)
{
    int checked = 0;
    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) {
        char name[64], line[256];
        if (sscanf(at + strlen(word), "%63[a-z-]", name) != 1) continue;
        snprintf(line, sizeof line, command, name);
        if (system(line)) fail_msg("README.md names '%s%s', which fails: %s", word + 5, name, line);
        checked++;
    }
    return checked;
}

static void every_command_named_exists(void **state)
{
    (void)state;
    char *text = read_readme();
    assert_true(check_commands(text, "\n    make ", "grep -q '^## %s: ' Makefile") >= 3);
    assert_true(check_commands(text, "\n    nacre ", "build/release/nacre %s --help >/dev/null") >= 5);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_smallest_program_compiles_and_links),
        cmocka_unit_test(every_command_named_exists),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
