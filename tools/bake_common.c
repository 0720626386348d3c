/* SPDX-License-Identifier: MIT */
#include "bake_common.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "bake.h"

int bake_prints(const bake_common *c)
{
    return !c->quiet && !(c->json && !strcmp(c->json, "-"));
}

int bake_check(const bake_common *c, const char *kind, const char *input, failure *f)
{
    if (!c->output) return fail(f, FAIL_USAGE, "%s: -o FILE is missing", kind);
    if (c->threads) omp_set_num_threads(c->threads);
    return output_apart(c->output, input ? bake_input(input) : NULL, f);
}

int bake_write_side_outputs(const bake_common *c, const char *const *inputs, size_t count, json *figures, failure *f)
{
    int code = FAIL_NONE;
    if (c->depfile) code = output_depfile(c->depfile, c->output, inputs, count, f);
    if (code || !c->json) return code;
    code = json_write(figures, c->json, f);
    if (code && c->depfile) output_discard(c->depfile);
    return code;
}

void bake_discard_side_outputs(const bake_common *c)
{
    if (c->depfile) output_discard(c->depfile);
    if (c->json) output_discard(c->json);
}

int bake_write_outputs(const bake_common *c, const bytes *file, const char *input, json *figures, failure *f)
{
    const char *inputs[1] = {input ? bake_input(input) : NULL};
    int code = bake_write_side_outputs(c, inputs, inputs[0] != NULL, figures, f);
    bytes_free(&figures->out);
    if (code) return code;
    code = output_write(c->output, file, f);
    if (code) bake_discard_side_outputs(c);
    return code;
}

int bake_pair_path(const bake_common *c, const char *part, char *out, size_t size, failure *f)
{
    const char *path = c->output, *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    const char *end = dot && dot > slash && (!strcmp(dot, ".ktx2") || !strcmp(dot, ".c")) ? dot : path + strlen(path);
    int length = (int)(end - path);
    if (length > 1000) return fail(f, FAIL_USAGE, "-o: found a name of %d characters, expected at most 1000", length);
    snprintf(out, size, "%.*s-%s%s", length, path, part, *end ? end : ".ktx2");
    return FAIL_NONE;
}

int bake_write_pair(const bake_common *c, const sbrdf_sources *sources, json *figures, const char *first_path,
                    bytes *first, const char *second_path, bytes *second, failure *f)
{
    bake_common common = *c;
    common.output = first_path;
    int code = bake_write_side_outputs(&common, (const char *const *)sources->path, (size_t)sources->count, figures, f);
    bytes_free(&figures->out);
    if (!code) {
        code = output_write(first_path, first, f);
        if (!code && (code = output_write(second_path, second, f))) output_discard(first_path);
        if (code) bake_discard_side_outputs(&common);
    }
    bytes_free(first);
    bytes_free(second);
    return code;
}
