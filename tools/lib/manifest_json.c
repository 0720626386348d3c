/* SPDX-License-Identifier: MIT */
#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "manifest_parts.h"

static const char *type_name(const cJSON *value)
{
    return cJSON_IsObject(value)   ? "an object"
           : cJSON_IsArray(value)  ? "an array"
           : cJSON_IsString(value) ? "a text"
           : cJSON_IsNumber(value) ? "a number"
           : cJSON_IsTrue(value)   ? "true"
           : cJSON_IsFalse(value)  ? "false"
                                   : "null";
}

/* {"tier": "fine", "no-pad": true} as "--tier fine --no-pad". */
static int options_text(const manifest_reader *r, int line, const cJSON *options, bytes *out, failure *f)
{
    const cJSON *value;
    cJSON_ArrayForEach(value, options)
    {
        if (cJSON_IsFalse(value)) continue;
        bytes_printf(out, "%s--%s", out->size ? " " : "", value->string);
        if (cJSON_IsTrue(value)) continue;
        if (!cJSON_IsString(value) && !cJSON_IsNumber(value))
            return fail(f, FAIL_INVALID,
                        "%s: line %d, field options: found %s for \"%.40s\", expected a text, a number or true",
                        r->path, line, type_name(value), value->string);
        if (cJSON_IsNumber(value))
            bytes_printf(out, " %.15g", value->valuedouble);
        else
            bytes_printf(out, " %s", value->valuestring);
    }
    bytes_append(out, "", 1);
    return FAIL_NONE;
}

static int read_object(manifest_reader *r, int line, const cJSON *object, bytes *options, failure *f)
{
    const char *field[MANIFEST_FIELDS] = {NULL};
    const cJSON *value;
    cJSON_ArrayForEach(value, object)
    {
        int index = manifest_field(value->string);
        if (index < 0)
            return fail(f, FAIL_INVALID, "%s: line %d: found a field \"%.40s\", expected brdf, kind, options, output",
                        r->path, line, value->string);
        if (field[index])
            return fail(f, FAIL_INVALID, "%s: line %d: found the field %s twice, expected it once", r->path, line,
                        value->string);
        if (index == MANIFEST_OPTIONS && cJSON_IsObject(value)) {
            int code = options_text(r, line, value, options, f);
            if (code) return code;
            field[index] = (const char *)options->data;
        } else if (cJSON_IsString(value)) {
            field[index] = value->valuestring;
        } else {
            return fail(f, FAIL_INVALID, "%s: line %d, field %s: found %s, expected a text%s", r->path, line,
                        value->string, type_name(value), index == MANIFEST_OPTIONS ? " or an object" : "");
        }
    }
    return manifest_add(r, line, field, f);
}

static int read_line(manifest_reader *r, int line, const char *text, const char *stop, failure *f)
{
    const char *end = text;
    cJSON *object = cJSON_ParseWithLengthOpts(text, (size_t)(stop - text), &end, 0);
    while (object && end < stop && strchr(" \t\r", *end)) end++;
    bytes options = {0};
    int code;
    if (!object || end < stop)
        code = fail(f, FAIL_INVALID, "%s: line %d, column %d: found \"%.*s\", expected one JSON object on the line",
                    r->path, line, (int)(end - text) + 1, (int)(stop - end < 20 ? stop - end : 20), end);
    else if (!cJSON_IsObject(object))
        code = fail(f, FAIL_INVALID, "%s: line %d: found %s, expected an object", r->path, line, type_name(object));
    else
        code = read_object(r, line, object, &options, f);
    bytes_free(&options);
    cJSON_Delete(object);
    return code;
}

int manifest_json(manifest_reader *r, const char *text, size_t size, failure *f)
{
    const char *end = text + size;
    int code = FAIL_NONE;
    for (int line = 1; text < end && !code; line++) {
        const char *stop = memchr(text, '\n', (size_t)(end - text));
        if (!stop) stop = end;
        const char *at = text;
        while (at < stop && strchr(" \t\r", *at)) at++;
        if (at < stop && *at != '#') code = read_line(r, line, text, stop, f);
        text = stop + 1;
    }
    return code;
}
