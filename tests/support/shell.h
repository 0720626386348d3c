/* SPDX-License-Identifier: MIT */
/* The program from outside: command lines run in a directory of their own, by the shell. */
#ifndef SHELL_H
#define SHELL_H

#include <stddef.h>

typedef struct shell_outcome {
    int code;
    int lines;       /* of standard error */
    char text[2000]; /* standard error */
} shell_outcome;

/* Group set-up and tear-down of a cmocka program: the directory, and $NACRE_TOOL (build/release/nacre). */
int shell_begin(void **state);
int shell_end(void **state);

/* Run commands in the directory; `nacre` in them is the program, "$tool" its path. Standard output is dropped. */
shell_outcome shell_run(const char *format, ...) __attribute__((format(printf, 1, 2)));

int shell_exists(const char *name);
int shell_files(void); /* in the directory */
/* For what runs in the test itself. Good until the fourth call after. */
const char *shell_path(const char *name);
void shell_write(const char *name, const void *data, size_t size);
/* A file whole, with a NUL behind it; malloc'd. */
char *shell_read(const char *name);

/* Command lines that must fail with one line that says so, and leave no file behind. */
typedef struct shell_mistake {
    const char *command;
    int code;
    const char *says; /* must appear in the line */
} shell_mistake;
void shell_check(const shell_mistake *list, size_t count);
#define CHECK(list) shell_check(list, sizeof(list) / sizeof(list)[0])

#endif
