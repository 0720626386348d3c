/* SPDX-License-Identifier: MIT */
/* nacre bake palette: a painting's measured materials as half-vector tables, and a map of which texel is of which. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake_common.h"
#include "nacre_asset.h"
#include "palette.h"

typedef struct request {
    bake_common common;
    const char *source, *size;
    palette_options options;
    char tables_path[1024], index_path[1024];
} request;

static int parse(request *r, int argc, char **argv, failure *f)
{
    int operands;
    const option table[] = {
        BAKE_OPTIONS(r->common),
        {"--size", OPTION_TEXT, &r->size, 0, 0, "WxH", "texels of a table, 4..128 a side (24x21)"},
        {"--blend", OPTION_FLAG, &r->options.blend, 0, 0, NULL,
         "draw the bilinear mean of four texels: 8 fetches a pixel and light in place of 2"},
        {"--no-mips", OPTION_FLAG, &r->options.no_mips, 0, 0, NULL, "one level"},
    };
    int code = options_parse(argc, argv, "nacre bake palette PAINTING.txt -o NAME.ktx2 [options]", table,
                             sizeof table / sizeof *table, &r->source, &operands, 1, 1, f);
    if (code || (code = bake_check(&r->common, "bake palette", r->source, f))) return code;
    if (r->size && (code = parse_size(r->size, "--size", TABLE_MAX_SIDE, &r->options.width, &r->options.height, f)))
        return code;
    if ((code = bake_pair_path(&r->common, "palette", r->tables_path, sizeof r->tables_path, f))) return code;
    return bake_pair_path(&r->common, "index", r->index_path, sizeof r->index_path, f);
}

static json figures_of(const request *r, const palette *p)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "palette", r->tables_path);
    json_text(&j, "index", r->index_path);
    json_int(&j, "tables", p->count);
    json_int(&j, "table_width", p->table[0].width);
    json_int(&j, "table_height", p->table[0].height);
    json_int(&j, "width", p->width);
    json_int(&j, "height", p->height);
    json_int(&j, "levels", p->levels);
    json_bool(&j, "blend", p->blend);
    json_int(&j, "texel_bytes", (long long)palette_texel_bytes(p));
    json_end(&j, '}');
    return j;
}

static int sources_apart(const request *r, const sbrdf_sources *sources, failure *f)
{
    int code = FAIL_NONE;
    for (int i = 0; i < sources->count && !code; i++) {
        code = output_apart(r->tables_path, sources->path[i], f);
        if (!code) code = output_apart(r->index_path, sources->path[i], f);
    }
    return code;
}

int bake_palette(int argc, char **argv, failure *f)
{
    request r = {0};
    sbrdf_sources sources = {0};
    palette p = {0};
    progress meter = {0};
    int code = parse(&r, argc, argv, f);
    meter.quiet = r.common.quiet;
    r.options.progress = &meter;
    if (!code) {
        sbrdf_sources_add(&sources, r.source);
        code = palette_bake(&p, r.source, &r.options, &sources, f);
    }
    if (!code) code = sources_apart(&r, &sources, f);
    if (!code) {
        bytes tables = {0}, index = {0};
        json figures = figures_of(&r, &p);
        palette_write(&p, &tables, &index);
        code = bake_write_pair(&r.common, &sources, &figures, r.tables_path, &tables, r.index_path, &index, f);
    }
    if (!code && bake_prints(&r.common))
        printf("%s, %s: %d tables of %d x %d, map of %d x %d, %d level%s, %zu bytes of texels\n", r.tables_path,
               r.index_path, p.count, p.table[0].width, p.table[0].height, p.width, p.height, p.levels,
               p.levels == 1 ? "" : "s", palette_texel_bytes(&p));
    palette_free(&p);
    sbrdf_sources_free(&sources);
    return code;
}
