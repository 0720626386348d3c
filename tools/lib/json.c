/* SPDX-License-Identifier: MIT */
#include "json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void append_quoted(bytes *out, const char *text)
{
    bytes_append(out, "\"", 1);
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            bytes_printf(out, "\\%c", c);
        else if (c < 0x20)
            bytes_printf(out, "\\u%04x", c);
        else
            bytes_append(out, text, 1);
    }
    bytes_append(out, "\"", 1);
}

static void begin_item(json *j, const char *key)
{
    if (j->depth) {
        bytes_printf(&j->out, "%s\n%*s", j->has_items[j->depth] ? "," : "", 2 * j->depth, "");
        j->has_items[j->depth] = 1;
    }
    if (key) {
        append_quoted(&j->out, key);
        bytes_append(&j->out, ": ", 2);
    }
}

void json_begin(json *j, const char *key, char bracket)
{
    begin_item(j, key);
    bytes_append(&j->out, &bracket, 1);
    j->has_items[++j->depth] = 0;
}

void json_end(json *j, char bracket)
{
    j->depth--;
    if (j->has_items[j->depth + 1]) bytes_printf(&j->out, "\n%*s", 2 * j->depth, "");
    bytes_append(&j->out, &bracket, 1);
    if (!j->depth) bytes_append(&j->out, "\n", 1);
}

void json_text(json *j, const char *key, const char *value)
{
    begin_item(j, key);
    append_quoted(&j->out, value);
}

void json_real(json *j, const char *key, double value)
{
    begin_item(j, key);
    if (!isfinite(value)) {
        bytes_printf(&j->out, "null");
        return;
    }
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    bytes_printf(&j->out, "%s", text);
}

void json_int(json *j, const char *key, long long value)
{
    begin_item(j, key);
    bytes_printf(&j->out, "%lld", value);
}

void json_bool(json *j, const char *key, int value)
{
    begin_item(j, key);
    bytes_printf(&j->out, value ? "true" : "false");
}

int json_write(json *j, const char *path, failure *f)
{
    int code = FAIL_NONE;
    if (path[0] == '-' && !path[1]) {
        if (fwrite(j->out.data, 1, j->out.size, stdout) != j->out.size || fflush(stdout))
            code = fail(f, FAIL_IO, "stdout: can't write %zu bytes", j->out.size);
    } else {
        code = output_write_raw(path, &j->out, f);
    }
    bytes_free(&j->out);
    return code;
}
