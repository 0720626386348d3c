/* SPDX-License-Identifier: MIT */
/* nacre bake palette: a painting's measured materials as half-vector tables, and a map of which texel is of which. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake_common.h"
#include "nacre_asset.h"
#include "palette_view.h"
#include "png_io.h"

typedef struct request {
    bake_common common;
    const char *source, *size, *preview;
    palette_options options;
    char tables_path[1024], index_path[1024];
    palette_score score[PALETTE_WAYS];
} request;

static int parse(request *r, int argc, char **argv, failure *f)
{
    int operands;
    const option table[] = {
        BAKE_OPTIONS(r->common),
        {"--size", OPTION_TEXT, &r->size, 0, 0, "WxH", "texels of a table, 4..128 a side (24x21)"},
        {"--blend", OPTION_FLAG, &r->options.blend, 0, 0, NULL,
         "draw the bilinear mean of four texels: 8 fetches a pixel and light in place of 2"},
        {"--preview", OPTION_TEXT, &r->preview, 0, 0, "FILE.png",
         "lit spheres of the BRDFs themselves, of the palette and of Lafortune maps; and their dB"},
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
    json_begin(&j, "views", '[');
    for (int i = 0; i < PALETTE_WAYS && r->preview; i++) {
        json_begin(&j, NULL, '{');
        json_text(&j, "way", palette_way_names[i]);
        json_real(&j, "inside_db", r->score[i].inside_db);
        json_real(&j, "pooled_db", r->score[i].pooled_db);
        json_real(&j, "worst_db", r->score[i].worst_db);
        json_end(&j, '}');
    }
    json_end(&j, ']');
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

static int make_preview(request *r, const palette *p, progress *meter, failure *f)
{
    image_u8 sheet;
    if (!r->preview) return FAIL_NONE;
    int code = palette_view(p, r->source, r->score, &sheet, meter, f);
    if (code) return code;
    code = png_write(r->preview, &sheet, f);
    image_u8_free(&sheet);
    return code;
}

static void print_result(const request *r, const palette *p)
{
    printf("%s, %s: %d tables of %d x %d, map of %d x %d, %d level%s, %zu bytes of texels\n", r->tables_path,
           r->index_path, p->count, p->table[0].width, p->table[0].height, p->width, p->height, p->levels,
           p->levels == 1 ? "" : "s", palette_texel_bytes(p));
    for (int i = 0; i < PALETTE_WAYS && r->preview; i++)
        if (r->score[i].pooled_db > 0)
            printf("%s: %s%s: %.1f dB, with the edges between materials %.1f dB, worst light %.1f dB\n", r->preview,
                   i < 2 ? "palette, " : "Lafortune, ", palette_way_names[i], r->score[i].inside_db,
                   r->score[i].pooled_db, r->score[i].worst_db);
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
    if (!code) code = make_preview(&r, &p, &meter, f);
    if (!code) {
        bytes tables = {0}, index = {0};
        json figures = figures_of(&r, &p);
        palette_write(&p, &tables, &index);
        code = bake_write_pair(&r.common, &sources, &figures, r.tables_path, &tables, r.index_path, &index, f);
    }
    if (!code && bake_prints(&r.common)) print_result(&r, &p);
    palette_free(&p);
    sbrdf_sources_free(&sources);
    return code;
}
