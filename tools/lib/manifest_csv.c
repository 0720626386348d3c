/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "manifest_parts.h"

typedef struct csv {
    const char *at, *end, *line_start, *path;
    int line;
} csv;

static int column(const csv *c, const char *at)
{
    return (int)(at - c->line_start) + 1;
}

static int at_line_end(const csv *c)
{
    return c->at == c->end || *c->at == '\n' || (*c->at == '\r' && (c->at + 1 == c->end || c->at[1] == '\n'));
}

static void next_line(csv *c)
{
    if (c->at < c->end && *c->at == '\r') c->at++;
    if (c->at < c->end) c->at++;
    c->line_start = c->at;
    c->line++;
}

static int is_blank(char c)
{
    return c == ' ' || c == '\t';
}

/* A quoted field, from its quote to past the closing one; "" stands for a quote. */
static int read_quoted(csv *c, bytes *out, failure *f)
{
    const char *begin = c->at;
    int line = c->line, first = column(c, begin);
    for (c->at++; c->at < c->end; c->at++) {
        if (*c->at == '"') {
            if (c->at + 1 == c->end || c->at[1] != '"') break;
            c->at++;
        } else if (*c->at == '\n') {
            c->line++;
            c->line_start = c->at + 1;
        }
        bytes_append(out, c->at, 1);
    }
    if (c->at == c->end)
        return fail(f, FAIL_INVALID, "%s: line %d, column %d: found a quote that never closes, expected \"...\"",
                    c->path, line, first);
    c->at++;
    while (c->at < c->end && is_blank(*c->at)) c->at++;
    if (at_line_end(c) || *c->at == ',') return FAIL_NONE;
    return fail(f, FAIL_INVALID, "%s: line %d, column %d: found '%c' after a closing quote, expected a comma", c->path,
                c->line, column(c, c->at), *c->at);
}

static void read_plain(csv *c, bytes *out)
{
    const char *begin = c->at;
    while (!at_line_end(c) && *c->at != ',') c->at++;
    const char *end = c->at;
    while (end > begin && is_blank(end[-1])) end--;
    bytes_append(out, begin, (size_t)(end - begin));
}

/* One record; fields end in NUL, one after the other in *out; count receives how many. At least one field. */
static int read_record(csv *c, bytes *out, int *count, failure *f)
{
    out->size = 0;
    for (*count = 1;; ++*count) {
        while (c->at < c->end && is_blank(*c->at)) c->at++;
        int code = FAIL_NONE;
        if (c->at < c->end && *c->at == '"')
            code = read_quoted(c, out, f);
        else
            read_plain(c, out);
        if (code) return code;
        bytes_append(out, "", 1);
        if (at_line_end(c)) break;
        c->at++; /* the comma */
    }
    next_line(c);
    return FAIL_NONE;
}

/* Columns from a first line that names them, among them brdf; 0 if it is no such line. */
static int read_header(const bytes *record, int count, int field_of[MANIFEST_FIELDS])
{
    const char *name = (const char *)record->data;
    int has_brdf = 0;
    for (int i = 0; i < count; i++, name += strlen(name) + 1) {
        if (i < MANIFEST_FIELDS) field_of[i] = manifest_field(name);
        has_brdf |= !strcmp(name, "brdf");
    }
    return has_brdf;
}

static int check_header(const csv *c, int line, const bytes *record, int count, failure *f)
{
    const char *name = (const char *)record->data;
    int seen[MANIFEST_FIELDS] = {0};
    for (int i = 0; i < count; i++, name += strlen(name) + 1) {
        int field = manifest_field(name);
        if (field < 0)
            return fail(f, FAIL_INVALID, "%s: line %d: found a column \"%.40s\", expected brdf, kind, options, output",
                        c->path, line, name);
        if (seen[field]++)
            return fail(f, FAIL_INVALID, "%s: line %d: found the column %s twice, expected it once", c->path, line,
                        name);
    }
    return FAIL_NONE;
}

static int add_record(manifest_reader *r, int line, const bytes *record, int count, const int *field_of, int columns,
                      failure *f)
{
    const char *field[MANIFEST_FIELDS] = {NULL}, *value = (const char *)record->data;
    if (count > columns)
        return fail(f, FAIL_INVALID,
                    "%s: line %d: found %d fields, expected at most %d (quote a field that has commas in it)", r->path,
                    line, count, columns);
    for (int i = 0; i < count; i++, value += strlen(value) + 1) field[field_of[i]] = value;
    return manifest_add(r, line, field, f);
}

int manifest_csv(manifest_reader *r, const char *text, size_t size, failure *f)
{
    csv c = {text, text + size, text, r->path, 1};
    int field_of[MANIFEST_FIELDS] = {0, 1, 2, 3}, columns = MANIFEST_FIELDS, first = 1, code = FAIL_NONE;
    bytes record = {0};
    while (c.at < c.end && !code) {
        while (c.at < c.end && is_blank(*c.at)) c.at++;
        int line = c.line, count;
        if (at_line_end(&c) || *c.at == '#') {
            while (!at_line_end(&c)) c.at++;
            next_line(&c);
            continue;
        }
        if ((code = read_record(&c, &record, &count, f))) break;
        int header = first && read_header(&record, count, field_of);
        if (header)
            code = check_header(&c, line, &record, columns = count, f);
        else {
            if (first)
                for (int i = 0; i < MANIFEST_FIELDS; i++) field_of[i] = i;
            code = add_record(r, line, &record, count, field_of, columns, f);
        }
        first = 0;
    }
    bytes_free(&record);
    return code;
}
