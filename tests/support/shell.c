/* SPDX-License-Identifier: MIT */
#include "shell.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char directory[] = "/tmp/nacre-tool-XXXXXX";
static char tool[4096];

int shell_begin(void **state)
{
    const char *named = getenv("NACRE_TOOL") ? getenv("NACRE_TOOL") : "build/release/nacre";

    (void)state;
    if (!realpath(named, tool)) {
        print_error("%s: not there; set NACRE_TOOL\n", named);
        return 1;
    }
    return mkdtemp(directory) ? 0 : 1;
}

int shell_end(void **state)
{
    char command[64];

    (void)state;
    snprintf(command, sizeof command, "rm -rf %s", directory);
    return system(command);
}

shell_outcome shell_run(const char *format, ...)
{
    char arguments[1500], command[6000];
    shell_outcome o = {0};
    FILE *pipe;
    size_t got;
    int status;
    va_list args;

    va_start(args, format);
    vsnprintf(arguments, sizeof arguments, format, args);
    va_end(args);
    snprintf(command, sizeof command, "cd %s && tool='%s' && nacre() { \"$tool\" \"$@\"; } && { %s; } 2>&1 >/dev/null",
             directory, tool, arguments);
    pipe = popen(command, "r");
    assert_non_null(pipe);
    got = fread(o.text, 1, sizeof o.text - 1, pipe);
    o.text[got] = 0;
    for (const char *c = o.text; *c; c++) o.lines += *c == '\n';
    status = pclose(pipe);
    o.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return o;
}

const char *shell_path(const char *name)
{
    static char path[4][300];
    static int next;
    char *out = path[next++ % 4];

    snprintf(out, sizeof path[0], "%s/%s", directory, name);
    return out;
}

static FILE *open_in_directory(const char *name, const char *mode)
{
    return fopen(shell_path(name), mode);
}

int shell_exists(const char *name)
{
    return access(shell_path(name), F_OK) == 0;
}

int shell_files(void)
{
    char command[256];
    int count = -1;
    FILE *pipe;

    snprintf(command, sizeof command, "ls -A %s | wc -l", directory);
    pipe = popen(command, "r");
    assert_int_equal(fscanf(pipe, "%d", &count), 1);
    pclose(pipe);
    return count;
}

void shell_write(const char *name, const void *data, size_t size)
{
    FILE *file = open_in_directory(name, "wb");

    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
}

char *shell_read(const char *name)
{
    FILE *file = open_in_directory(name, "rb");
    size_t size = 0, got;
    char *text = malloc(1);

    assert_non_null(file);
    assert_non_null(text);
    do {
        char *more = realloc(text, size + 65536 + 1);
        assert_non_null(more);
        text = more;
        got = fread(text + size, 1, 65536, file);
        size += got;
    } while (got);
    text[size] = 0;
    fclose(file);
    return text;
}

void shell_check(const shell_mistake *list, size_t count)
{
    int bad = 0, files = shell_files();

    for (size_t i = 0; i < count; i++) {
        shell_outcome o = shell_run("%s", list[i].command);
        int left = shell_files();
        if (o.code == list[i].code && o.lines == 1 && strstr(o.text, list[i].says) && left == files) continue;
        print_error(
            "%s\n  exit %d (expected %d), %d lines (expected 1), %d files more (expected 0), expected '%s' in:\n%s\n",
            list[i].command, o.code, list[i].code, o.lines, left - files, list[i].says, o.text);
        files = left;
        bad++;
    }
    assert_int_equal(bad, 0);
}
