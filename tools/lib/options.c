/* SPDX-License-Identifier: MIT */
#include "options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_help(const char *usage, const option *table, size_t count)
{
    const char *notes = strchr(usage, '\n');
    printf("usage: %.*s\n", (int)strcspn(usage, "\n"), usage);
    for (size_t i = 0; i < count; i++) {
        char left[64];
        snprintf(left, sizeof left, "%s %s", table[i].name, table[i].argument ? table[i].argument : "");
        printf("  %-28s %s\n", left, table[i].help ? table[i].help : "");
    }
    if (notes) printf("%s", notes);
}

static int edit_distance(const char *a, const char *b)
{
    int row[65], n = (int)strlen(b), m = (int)strlen(a);
    if (n > 64 || m > 64) return 99;
    for (int j = 0; j <= n; j++) row[j] = j;
    for (int i = 1; i <= m; i++) {
        int diagonal = row[0];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int above = row[j], cost = diagonal + (a[i - 1] != b[j - 1]);
            if (above + 1 < cost) cost = above + 1;
            if (row[j - 1] + 1 < cost) cost = row[j - 1] + 1;
            diagonal = above;
            row[j] = cost;
        }
    }
    return row[n];
}

/* How unlike: edit distance, but a name that contains the word (or the other way round) is near. */
static int name_distance(const char *word, const char *name)
{
    int distance = edit_distance(word, name);
    if (strlen(word) > 2 && (strstr(name, word) || strstr(word, name)) && distance > 2) distance = 2;
    return distance;
}

void nearest_names(const char *word, const char *const *names, size_t count, char *out, size_t size)
{
    int limit = (int)strlen(word) / 3 + 1;
    size_t used = 0;
    int listed = 0;
    if (size) out[0] = 0;
    for (int distance = 0; distance <= limit && listed < 5; distance++) {
        for (size_t i = 0; i < count && listed < 5; i++) {
            if (name_distance(word, names[i]) != distance) continue;
            int n = snprintf(out + used, size - used, "%s%s", listed ? ", " : "", names[i]);
            if (n < 0 || (size_t)n >= size - used) return;
            used += (size_t)n;
            listed++;
        }
    }
}

static int unknown_option(const char *given, const option *table, size_t count, failure *f)
{
    const char *names[64];
    size_t n = count < 64 ? count : 64;
    for (size_t i = 0; i < n; i++) names[i] = table[i].name;
    char near[256];
    nearest_names(given, names, n, near, sizeof near);
    return near[0] ? fail(f, FAIL_USAGE, "%s: unknown option; near: %s", given, near)
                   : fail(f, FAIL_USAGE, "%s: unknown option (--help lists them)", given);
}

static int store_value(const option *o, const char *text, failure *f)
{
    char *end;
    if (o->kind != OPTION_FLAG && !*text)
        return fail(f, FAIL_USAGE, "%s: found an empty value, expected %s", o->name,
                    o->argument ? o->argument : "VALUE");
    errno = 0;
    switch (o->kind) {
    case OPTION_FLAG:
        *(int *)o->value = 1;
        return FAIL_NONE;
    case OPTION_TEXT:
        *(const char **)o->value = text;
        return FAIL_NONE;
    case OPTION_TEXTS: {
        option_texts *list = o->value;
        const int most = (int)(sizeof list->item / sizeof list->item[0]);
        if (list->count == most) return fail(f, FAIL_USAGE, "%s: more than %d times", o->name, most);
        list->item[list->count++] = text;
        return FAIL_NONE;
    }
    case OPTION_INT: {
        long value = strtol(text, &end, 10);
        if (end == text || *end || errno || value < o->low || value > o->high)
            return fail(f, FAIL_USAGE, "%s %s: expected a whole number %.0f..%.0f", o->name, text, o->low, o->high);
        *(int *)o->value = (int)value;
        return FAIL_NONE;
    }
    case OPTION_REAL: {
        double value = strtod(text, &end);
        if (end == text || *end || !isfinite(value) || value < o->low || value > o->high)
            return fail(f, FAIL_USAGE, "%s %s: expected a number %g..%g", o->name, text, o->low, o->high);
        *(double *)o->value = value;
        return FAIL_NONE;
    }
    }
    return fail(f, FAIL_INTERNAL, "%s: option of unknown kind", o->name);
}

static const option *find_option(const char *word, size_t length, const option *table, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strlen(table[i].name) == length && !memcmp(table[i].name, word, length)) return &table[i];
    return NULL;
}

/* One option at argv[*i], as "--x VALUE" or "--x=VALUE". */
static int parse_option(int argc, char **argv, int *i, const option *table, size_t count, failure *f)
{
    const char *word = argv[*i], *equals = strchr(word, '=');
    size_t length = equals && word[1] == '-' ? (size_t)(equals - word) : strlen(word);
    const option *o = find_option(word, length, table, count);
    if (!o) return unknown_option(word, table, count, f);
    const char *value = word[length] ? word + length + 1 : NULL;
    if (o->kind == OPTION_FLAG) {
        if (value) return fail(f, FAIL_USAGE, "%s: takes no value, found '%s'", o->name, value);
    } else if (!value) {
        if (*i + 1 >= argc)
            return fail(f, FAIL_USAGE, "%s: expected a value: %s", o->name, o->argument ? o->argument : "VALUE");
        value = argv[++*i];
    }
    return store_value(o, value, f);
}

int options_parse(int argc, char **argv, const char *usage, const option *table, size_t table_count,
                  const char **operand, int *count, int low_count, int high_count, failure *f)
{
    int operands = 0, only_operands = 0, line = (int)strcspn(usage, "\n");
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        if (!only_operands && !strcmp(word, "--")) {
            only_operands = 1;
        } else if (!only_operands && word[0] == '-' && word[1]) {
            if (!strcmp(word, "--help") || !strcmp(word, "-h")) {
                print_help(usage, table, table_count);
                exit(0);
            }
            int code = parse_option(argc, argv, &i, table, table_count, f);
            if (code) return code;
        } else {
            if (!*word) return fail(f, FAIL_USAGE, "%s: found an empty argument; usage: %.*s", argv[0], line, usage);
            if (operands == high_count)
                return fail(f, FAIL_USAGE, "%s: one argument too many; usage: %.*s", word, line, usage);
            operand[operands++] = word;
        }
    }
    if (operands < low_count)
        return fail(f, FAIL_USAGE, "%s: an argument is missing; usage: %.*s", argv[0], line, usage);
    *count = operands;
    return FAIL_NONE;
}

int parse_reals(const char *text, const char *what, double *out, int least, int most, int *count, failure *f)
{
    const char *at = text;
    int n = 0;
    for (;;) {
        char *end;
        double value = strtod(at, &end);
        if (end == at || !isfinite(value) || (*end && *end != ','))
            return fail(f, FAIL_USAGE, "%s %s: expected numbers separated by commas, found '%.20s'", what, text, at);
        if (n == most) return fail(f, FAIL_USAGE, "%s %s: expected at most %d numbers", what, text, most);
        out[n++] = value;
        if (!*end) break;
        at = end + 1;
    }
    if (n < least) return fail(f, FAIL_USAGE, "%s %s: expected at least %d numbers, found %d", what, text, least, n);
    *count = n;
    return FAIL_NONE;
}

int parse_size(const char *text, const char *what, int limit, int *width, int *height, failure *f)
{
    char *end;
    errno = 0;
    long w = strtol(text, &end, 10), h = w;
    int bad = end == text;
    if (!bad && *end == 'x') {
        const char *second = end + 1;
        h = strtol(second, &end, 10);
        bad = end == second;
    }
    if (bad || *end || errno || w < 1 || h < 1 || w > limit || h > limit)
        return fail(f, FAIL_USAGE, "%s %s: expected WxH, each 1..%d", what, text, limit);
    *width = (int)w;
    *height = (int)h;
    return FAIL_NONE;
}
