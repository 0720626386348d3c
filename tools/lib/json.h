/* SPDX-License-Identifier: MIT */
/* JSON out, no tree: begin/end and values in order; commas and escaping are kept right. Keys are NULL inside arrays. */
#ifndef JSON_H
#define JSON_H

#include "output.h"

typedef struct json {
    bytes out;
    int depth;
    unsigned char has_items[16];
} json;

void json_begin(json *j, const char *key, char bracket); /* '{' or '[' */
void json_end(json *j, char bracket);                    /* '}' or ']' */
void json_text(json *j, const char *key, const char *value);
void json_real(json *j, const char *key, double value); /* shortest that reads back; not finite: null */
void json_int(json *j, const char *key, long long value);
void json_bool(json *j, const char *key, int value);
/* Write to path ("-": stdout) and free. */
int json_write(json *j, const char *path, failure *f);

#endif
