/* SPDX-License-Identifier: MIT */
#include "manifest.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "manifest_parts.h"

enum { NAME_MOST = 200 }; /* of an output: leaves room for what is put beside it */

const char *const manifest_fields[MANIFEST_FIELDS] = {"brdf", "kind", "options", "output"};

int manifest_field(const char *name)
{
    for (int i = 0; i < MANIFEST_FIELDS; i++)
        if (!strcmp(name, manifest_fields[i])) return i;
    return -1;
}

static char *copy_text(const char *text)
{
    size_t size = strlen(text) + 1;
    return memcpy(need_memory(size, 1), text, size);
}

/* ---- names ---------------------------------------------------------------------------------------- */

static int ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n > m && !strcmp(text + n - m, end);
}

/* What is used of a BRDF's name in a file's: a file's name without folder and ending, else the whole. */
static void append_stem(bytes *out, const char *name)
{
    int prefixed = !strncmp(name, "merl:", 5) || !strncmp(name, "rgl:", 4);
    size_t length = strlen(name);
    if (prefixed || ends_with(name, ".binary") || ends_with(name, ".bsdf") || ends_with(name, ".ktx2")) {
        if (prefixed) name = strchr(name, ':') + 1;
        if (strrchr(name, '/')) name = strrchr(name, '/') + 1;
        const char *dot = strrchr(name, '.');
        length = dot > name ? (size_t)(dot - name) : strlen(name);
    }
    bytes_append(out, name, length);
}

/* BRDF-KIND-VALUES.ktx2, every character but letters, digits and ._=+- as -; flags by their names. */
static char *make_output(const manifest_item *item)
{
    bytes name = {0};
    append_stem(&name, item->brdf);
    bytes_printf(&name, "-%s", item->kind);
    for (int i = 2; i < item->argument_count; i++) {
        const char *word = item->argument[i], *equals = strchr(word, '='), *next = item->argument[i + 1];
        if (word[0] != '-')
            bytes_printf(&name, "-%s", word);
        else if (equals)
            bytes_printf(&name, "-%s", equals + 1);
        else if (!next || next[0] == '-')
            bytes_printf(&name, "-%s", word + strspn(word, "-"));
    }
    for (size_t i = 0; i < name.size; i++)
        if (!isalnum(name.data[i]) && !strchr("._=+-", name.data[i])) name.data[i] = '-';
    bytes_append(&name, ".ktx2", 6);
    return (char *)name.data;
}

/* A relative path of plain names, so that the same file always has the same text. */
static int check_output(const manifest_reader *r, const manifest_item *item, failure *f)
{
    const char *name = item->output, *wrong = NULL;
    if (!ends_with(name, ".ktx2")) wrong = "expected a file name that ends in .ktx2";
    for (const char *at = name; *at; at++)
        if (iscntrl((unsigned char)*at)) wrong = "expected printable characters";
    if (strlen(name) > NAME_MOST) wrong = "expected at most 200 characters";
    for (const char *at = name; !wrong && at; at = strchr(at, '/') ? strchr(at, '/') + 1 : NULL) {
        size_t length = strcspn(at, "/");
        if (!length || (length == 1 && at[0] == '.') || (length == 2 && at[0] == '.' && at[1] == '.'))
            wrong = "expected a plain path below the output directory";
    }
    if (!wrong) return FAIL_NONE;
    return fail(f, FAIL_INVALID, "%s: line %d, field output: found \"%.220s\", %s", r->path, item->line, name, wrong);
}

/* ---- items ---------------------------------------------------------------------------------------- */

static int check_kind(const manifest_reader *r, const manifest_item *item, failure *f)
{
    char names[100];
    if (bake_find(item->kind)) return FAIL_NONE;
    bake_kind_names(names, sizeof names);
    return fail(f, FAIL_INVALID,
                "%s: line %d, field kind: found \"%.60s\", expected one of: %s (a BRDF that has commas is quoted)",
                r->path, item->line, item->kind, names);
}

/* KIND BRDF and the words of options. The words are kept in one block behind the pointers. */
static void split_options(manifest_item *item)
{
    size_t length = strlen(item->options);
    char **argument = need_memory(1, (length / 2 + 4) * sizeof *argument + length + 1);
    char *words = (char *)(argument + length / 2 + 4);
    int count = 0;
    memcpy(words, item->options, length + 1);
    argument[count++] = item->kind;
    argument[count++] = item->brdf;
    for (char *state, *word = strtok_r(words, " \t\r\n", &state); word; word = strtok_r(NULL, " \t\r\n", &state))
        argument[count++] = word;
    argument[count] = NULL;
    item->argument = argument;
    item->argument_count = count;
}

static int read_options(const manifest_reader *r, manifest_item *item, failure *f)
{
    failure why = {0};
    for (int i = 2; i < item->argument_count; i++)
        if (!strcmp(item->argument[i], "--help") || !strcmp(item->argument[i], "-h"))
            return fail(f, FAIL_INVALID, "%s: line %d, field options: found %s, expected options of nacre bake %s",
                        r->path, item->line, item->argument[i], item->kind);
    if (!bake_parse(&item->request, item->argument_count, item->argument, NULL, 0, &why)) return FAIL_NONE;
    return fail(f, FAIL_INVALID, "%s: line %d, field options: %s", r->path, item->line, why.text);
}

static void free_item(manifest_item *item)
{
    free(item->brdf);
    free(item->kind);
    free(item->options);
    free(item->output);
    free(item->argument);
}

static const char *given(const char *text, const char *otherwise)
{
    return text && *text ? text : otherwise;
}

int manifest_add(manifest_reader *r, int line, const char *const field[MANIFEST_FIELDS], failure *f)
{
    manifest_item item = {.line = line};
    const char *name = given(field[MANIFEST_BRDF], "");
    if (!*name || *name == '-')
        return fail(f, FAIL_INVALID, "%s: line %d, field brdf: found \"%.60s\", expected the name of a BRDF", r->path,
                    line, name);
    item.brdf = copy_text(name);
    item.kind = copy_text(given(field[MANIFEST_KIND], "table"));
    item.options = copy_text(given(field[MANIFEST_OPTIONS], ""));
    split_options(&item);
    int code = check_kind(r, &item, f);
    if (!code) code = read_options(r, &item, f);
    if (!code) {
        const char *output = given(field[MANIFEST_OUTPUT], NULL);
        item.output = output ? copy_text(output) : make_output(&item);
        code = check_output(r, &item, f);
    }
    if (code) {
        free_item(&item);
        return code;
    }
    if (r->out->count == r->capacity) {
        r->capacity = r->capacity ? 2 * r->capacity : 64;
        manifest_item *more = need_memory((size_t)r->capacity, sizeof *more);
        if (r->out->count) memcpy(more, r->out->item, (size_t)r->out->count * sizeof *more);
        free(r->out->item);
        r->out->item = more;
    }
    r->out->item[r->out->count++] = item;
    return FAIL_NONE;
}

static int by_output(const void *a, const void *b)
{
    const manifest_item *const *x = a, *const *y = b;
    int order = strcmp((*x)->output, (*y)->output);
    return order ? order : (*x)->line - (*y)->line;
}

static int check_outputs_differ(const manifest_reader *r, failure *f)
{
    int count = r->out->count;
    const manifest_item **sorted = need_memory((size_t)count, sizeof *sorted), *first = NULL, *again = NULL;
    for (int i = 0; i < count; i++) sorted[i] = &r->out->item[i];
    qsort(sorted, (size_t)count, sizeof *sorted, by_output);
    for (int i = 1; i < count; i++) {
        if (strcmp(sorted[i - 1]->output, sorted[i]->output) || (again && again->line < sorted[i]->line)) continue;
        first = sorted[i - 1];
        again = sorted[i];
    }
    free(sorted);
    if (!again) return FAIL_NONE;
    return fail(f, FAIL_INVALID,
                "%s: line %d, field output: found \"%.200s\", which is line %d's too, expected another name", r->path,
                again->line, again->output, first->line);
}

/* ---- files ---------------------------------------------------------------------------------------- */

/* Neither blank nor in a comment; 0: none. It tells which notation it is. */
static char first_character(const char *text, size_t size)
{
    int comment = 0;
    for (size_t i = 0; i < size; i++) {
        comment = text[i] == '#' || (comment && text[i] != '\n');
        if (!comment && !isspace((unsigned char)text[i])) return text[i];
    }
    return 0;
}

int manifest_parse(manifest *out, const char *text, size_t size, const char *path, failure *f)
{
    manifest m = {0};
    manifest_reader r = {&m, path, 0};
    const char *nul = memchr(text, 0, size);
    if (nul)
        return fail(f, FAIL_INVALID, "%s: offset %zu: found a zero byte, expected text", path, (size_t)(nul - text));
    if (size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3)) { /* byte order mark */
        text += 3;
        size -= 3;
    }
    char first = first_character(text, size);
    int code = FAIL_NONE;
    if (first == '[')
        code = fail(f, FAIL_INVALID, "%s: found a JSON array, expected JSON lines: one object a line", path);
    else if (first == '{')
        code = manifest_json(&r, text, size, f);
    else
        code = manifest_csv(&r, text, size, f);
    if (!code && !m.count) code = fail(f, FAIL_INVALID, "%s: found no material, expected a line for each", path);
    if (!code) code = check_outputs_differ(&r, f);
    if (code) {
        manifest_free(&m);
        return code;
    }
    *out = m;
    return FAIL_NONE;
}

int manifest_read(manifest *out, const char *path, failure *f)
{
    bytes text = {0};
    const char *name = strcmp(path, "-") ? path : "standard input";
    int code = file_read(&text, strcmp(path, "-") ? path : "/dev/stdin", f);
    if (!code) code = manifest_parse(out, (const char *)text.data, text.size, name, f);
    bytes_free(&text);
    return code;
}

void manifest_free(manifest *m)
{
    for (int i = 0; i < m->count; i++) free_item(&m->item[i]);
    free(m->item);
    *m = (manifest){0};
}
