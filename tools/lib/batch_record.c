/* SPDX-License-Identifier: MIT */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "batch.h"

int batch_record_write(const batch_record *r, const manifest_item *item, const char *path, failure *f)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "file", item->output);
    json_text(&j, "brdf", item->brdf);
    json_text(&j, "kind", item->kind);
    json_text(&j, "options", item->options);
    json_text(&j, "made_of", r->made_of);
    json_text(&j, "content", r->content);
    for (int i = 0; i < BATCH_FIGURES; i++) json_real(&j, batch_figures[i].key, r->figure[i]);
    json_end(&j, '}');
    return json_write(&j, path, f);
}

static int read_text(const cJSON *object, const char *name, char out[CONTENT_TEXT])
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
    if (!text || strlen(text) != CONTENT_TEXT - 1) return 0;
    memcpy(out, text, CONTENT_TEXT);
    return 1;
}

static int read_object(batch_record *out, const cJSON *object)
{
    if (!read_text(object, "made_of", out->made_of) || !read_text(object, "content", out->content)) return 0;
    for (int i = 0; i < BATCH_FIGURES; i++) {
        const cJSON *value = cJSON_GetObjectItemCaseSensitive(object, batch_figures[i].key);
        if (!cJSON_IsNumber(value) && !cJSON_IsNull(value)) return 0;
        out->figure[i] = cJSON_IsNull(value) ? (double)NAN : value->valuedouble;
    }
    return 1;
}

int batch_record_read(batch_record *out, const char *path)
{
    bytes text = {0};
    if (access(path, F_OK) || file_read(&text, path, NULL)) return 0;
    cJSON *object = cJSON_ParseWithLength((const char *)text.data, text.size);
    int usable = object && read_object(out, object);
    cJSON_Delete(object);
    bytes_free(&text);
    return usable;
}
