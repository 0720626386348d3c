/* SPDX-License-Identifier: MIT */
/* nacre bake sbrdf: materials that vary over the surface, from parameter maps, a painting's text, a glTF material or a
   measured stack of images. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bake_common.h"
#include "brdf.h"
#include "gltf_material.h"
#include "mip.h"
#include "models.h"
#include "normal_file.h"
#include "png_io.h"
#include "sbrdf_field.h"
#include "sbrdf_maps.h"
#include "sbrdf_stack.h"
#include "sbrdf_view.h"

typedef struct request {
    bake_common common;
    const char *preview, *material;
    const char *source; /* text, glTF or stack; NULL: maps */
    sbrdf_map_files maps;
    option_texts lobe; /* as given: ALBEDO,SHAPE[,EXPONENT] */
    double range;
    int lobes, anisotropic, strict, no_mips;
    char albedo_path[1024], lobes_path[1024], normal_path[1024];
    char *split; /* the texts of lobe, cut at commas */
} request;

static int warn(const request *r, failure *f, const char *format, ...) __attribute__((format(printf, 3, 4)));
static int warn(const request *r, failure *f, const char *format, ...)
{
    char text[500];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (r->strict) return fail(f, FAIL_INVALID, "%s (--strict)", text);
    if (!r->common.quiet) fprintf(stderr, "nacre bake: warning: %s\n", text);
    return FAIL_NONE;
}

/* ---- what is asked for ------------------------------------------------------------------------------- */

static int take_lobe(request *r, int j, char *text, failure *f)
{
    char *rest = NULL;
    r->maps.lobe[j].albedo = strtok_r(text, ",", &rest);
    r->maps.lobe[j].shape = strtok_r(NULL, ",", &rest);
    r->maps.lobe[j].exponent = strtok_r(NULL, ",", &rest);
    if (r->maps.lobe[j].shape && !strtok_r(NULL, ",", &rest)) return FAIL_NONE;
    return fail(f, FAIL_USAGE, "--lobe %s: expected ALBEDO,SHAPE or ALBEDO,SHAPE,EXPONENT", r->lobe.item[j]);
}

static int check_maps(request *r, failure *f)
{
    if (!r->maps.albedo) return fail(f, FAIL_USAGE, "bake sbrdf: no input: expected a file, or --albedo and --lobe");
    if (r->lobe.count < 1 || r->lobe.count > LAFORTUNE_MAX_LOBES)
        return fail(f, FAIL_USAGE, "--lobe: found %d, expected 1 to %d lobes", r->lobe.count, LAFORTUNE_MAX_LOBES);
    size_t size = 0;
    for (int j = 0; j < r->lobe.count; j++) size += strlen(r->lobe.item[j]) + 1;
    r->split = need_memory(size, 1);
    char *at = r->split;
    for (int j = 0; j < r->lobe.count; j++) {
        strcpy(at, r->lobe.item[j]);
        int code = take_lobe(r, j, at, f);
        if (code) return code;
        at += strlen(r->lobe.item[j]) + 1;
    }
    r->maps.lobes = r->lobe.count;
    r->maps.shape_most = r->range;
    return FAIL_NONE;
}

static int parse(request *r, int argc, char **argv, failure *f)
{
    int operands;
    const option table[] = {
        BAKE_OPTIONS(r->common),
        {"--albedo", OPTION_TEXT, &r->maps.albedo, 0, 0, "FILE", "maps: diffuse albedo, PNG (alpha: opacity) or PFM"},
        {"--lobe", OPTION_TEXTS, &r->lobe, 0, 0, "A,S[,N]",
         "maps: albedo, Cx Cy Cz (PNG: n in alpha) and exponent of a lobe; 1 to 3 times"},
        {"--direction", OPTION_TEXT, &r->maps.direction, 0, 0, "FILE", "maps: direction of anisotropy in R and G"},
        {"--lobe-max", OPTION_REAL, &r->maps.lobe_most, 1e-4, 32767, "R", "maps: lobe albedo (pi f_r) of code 255 (1)"},
        {"--srgb", OPTION_FLAG, &r->maps.srgb, 0, 0, NULL, "maps: albedo PNGs hold sRGB codes (linear ones)"},
        {"--range", OPTION_REAL, &r->range, 1, 2, "R",
         "C on -R..R, 1 or 2, in PNGs read and at most in the output (1)"},
        {"--lobes", OPTION_INT, &r->lobes, 1, LAFORTUNE_MAX_LOBES, "N", "glTF, stack: lobes a texel (1)"},
        {"--material", OPTION_TEXT, &r->material, 0, 0, "NAME", "glTF: the material (the first that a mesh uses)"},
        {"--anisotropic", OPTION_FLAG, &r->anisotropic, 0, 0, NULL, "stack: Cx and Cy of their own"},
        {"--preview", OPTION_TEXT, &r->preview, 0, 0, "FILE.png",
         "a lit sheet from afar: supersampled, by the smaller levels, by means of codes; and their dB"},
        {"--no-mips", OPTION_FLAG, &r->no_mips, 0, 0, NULL, "one level"},
        {"--strict", OPTION_FLAG, &r->strict, 0, 0, NULL, "refuse what would be clamped or left out"},
    };
    int code = options_parse(argc, argv, "nacre bake sbrdf [FILE] -o NAME.ktx2 [options]", table,
                             sizeof table / sizeof *table, &r->source, &operands, 0, 1, f);
    if (!operands) r->source = NULL;
    if (code || (code = bake_check(&r->common, "bake sbrdf", r->source, f))) return code;
    if (r->range != 1 && r->range != 2) return fail(f, FAIL_USAGE, "--range %g: expected 1 or 2", r->range);
    if ((code = bake_pair_path(&r->common, "albedo", r->albedo_path, sizeof r->albedo_path, f))) return code;
    if ((code = bake_pair_path(&r->common, "lobes", r->lobes_path, sizeof r->lobes_path, f))) return code;
    if ((code = bake_pair_path(&r->common, "normal", r->normal_path, sizeof r->normal_path, f))) return code;
    return r->source ? FAIL_NONE : check_maps(r, f);
}

/* ---- reading ----------------------------------------------------------------------------------------- */

static void list_maps(const sbrdf_map_files *maps, sbrdf_sources *sources)
{
    sbrdf_sources_add(sources, maps->albedo);
    for (int j = 0; j < maps->lobes; j++) {
        sbrdf_sources_add(sources, maps->lobe[j].albedo);
        sbrdf_sources_add(sources, maps->lobe[j].shape);
        if (maps->lobe[j].exponent) sbrdf_sources_add(sources, maps->lobe[j].exponent);
    }
    if (maps->direction) sbrdf_sources_add(sources, maps->direction);
}

static int ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n > m && !strcasecmp(text + n - m, end);
}

/* How the field came to be, for the report. */
typedef struct origin {
    enum { FROM_MAPS, FROM_PAINTING, FROM_GLTF, FROM_STACK } kind;
    gltf_report gltf;
    sbrdf_stack_report stack;
} origin;

static int read_gltf(const request *r, sbrdf_field *field, sbrdf_sources *sources, progress *meter, origin *from,
                     failure *f)
{
    from->kind = FROM_GLTF;
    return gltf_material_read(field, r->source, r->material, r->lobes, sources, &from->gltf, meter, f);
}

static int read_stack(const request *r, sbrdf_field *field, sbrdf_sources *sources, progress *meter, origin *from,
                      failure *f)
{
    int code = sbrdf_stack_fit(field, r->source, r->lobes, r->anisotropic, sources, &from->stack, meter, f);
    from->kind = FROM_STACK;
    if (code || !from->stack.underlit) return code;
    return warn(r, f, "%s: %ld texels with fewer than 8 values, left black", r->source, from->stack.underlit);
}

static int read_field(const request *r, sbrdf_field *field, sbrdf_sources *sources, progress *meter, origin *from,
                      failure *f)
{
    from->kind = FROM_MAPS;
    if (!r->source) {
        list_maps(&r->maps, sources);
        return sbrdf_maps_read(field, &r->maps, f);
    }
    sbrdf_sources_add(sources, r->source);
    if (ends_with(r->source, ".gltf") || ends_with(r->source, ".glb"))
        return read_gltf(r, field, sources, meter, from, f);
    if (sbrdf_is_stack(r->source)) return read_stack(r, field, sources, meter, from, f);
    from->kind = FROM_PAINTING;
    return sbrdf_paint(field, r->source, sources, meter, f);
}

static int report_clamped(const request *r, const sbrdf_clamped *c, const char *name, failure *f)
{
    const char *lobes = r->source ? name : "--lobe"; /* of maps the counts are those of all lobes */
    int code = FAIL_NONE;
    if (c->exponents) code = warn(r, f, "%s: %ld exponents outside 0..255, clamped", lobes, c->exponents);
    if (!code && c->shapes)
        code = warn(r, f, "%s: %ld shapes with |C| above %g of the largest sum, clamped%s", lobes, c->shapes, r->range,
                    r->range < 2 ? " (--range 2 holds more)" : "");
    if (!code && c->albedos)
        code =
            warn(r, f, "%s: %ld albedos outside 0..32767, clamped", r->source ? name : "--albedo, --lobe", c->albedos);
    return code;
}

static int level_count(const request *r, const sbrdf_field *field, const char *name, int *count, failure *f)
{
    *count = r->no_mips ? 1 : mip_count(field->width, field->height);
    if (r->no_mips || *count > 1 || (field->width == 1 && field->height == 1)) return FAIL_NONE;
    return warn(r, f, "%s: %d x %d texels are no powers of two, no smaller levels (GLES 2 needs them to be)", name,
                field->width, field->height);
}

/* ---- baking ------------------------------------------------------------------------------------------ */

typedef struct result {
    sbrdf_map map;
    sbrdf_quantised report;
    sbrdf_clamped clamped;
    origin from;
    sbrdf_view view[SBRDF_VIEWS];
} result;

/* Albedo under light from everywhere of the smallest level's texel, which stands for all. */
static void find_white_sky(const sbrdf_texel *t, double out[3])
{
    lafortune_lobe lobe[LAFORTUNE_MAX_LOBES];
    for (int j = 0; j < t->brdf.lobes; j++)
        for (int c = 0; c < 3; c++) {
            const lafortune_shared_lobe *from = &t->brdf.lobe[j];
            lobe[j].cx[c] = from->c[0];
            lobe[j].cy[c] = from->c[1];
            lobe[j].cz[c] = from->c[2];
            lobe[j].n[c] = from->n;
            lobe[j].ks[c] = from->ks[c];
        }
    brdf *b = lafortune_brdf(t->brdf.kd, lobe, (size_t)t->brdf.lobes);
    brdf_albedo(b, out);
    brdf_close(b);
}

static int bake_field(const request *r, sbrdf_field *field, const char *name, progress *meter, result *out, failure *f)
{
    sbrdf_field level[SBRDF_MAX_LEVELS];
    int count, code = sbrdf_field_settle(field, r->range, &out->clamped, name, f);
    if (!code) code = report_clamped(r, &out->clamped, name, f);
    if (!code) code = level_count(r, field, name, &count, f);
    if (code) return code;
    sbrdf_field_levels(field, level, count, meter);
    sbrdf_quantise(level, count, name, &out->map, &out->report);
    find_white_sky(&level[count - 1].texel[0], out->map.white_sky);
    for (int i = 1; i < count; i++) sbrdf_field_free(&level[i]);
    return FAIL_NONE;
}

static size_t texel_bytes(const sbrdf_map *m)
{
    size_t texels = 0;
    for (int i = 0; i < m->levels; i++) texels += (size_t)sbrdf_level_width(m, i) * (size_t)sbrdf_level_height(m, i);
    return 4 * texels * (size_t)(1 + m->layers);
}

static void json_views(json *j, const sbrdf_view *view)
{
    json_begin(j, "views", '[');
    for (int i = 0; i < SBRDF_VIEWS; i++) {
        if (!view[i].factor) continue;
        json_begin(j, NULL, '{');
        json_int(j, "factor", view[i].factor);
        json_real(j, "level_db", view[i].level_psnr);
        json_real(j, "code_means_db", view[i].average_psnr);
        json_end(j, '}');
    }
    json_end(j, ']');
}

static json figures_of(const request *r, const result *out)
{
    const sbrdf_map *m = &out->map;
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "albedo", r->albedo_path);
    json_text(&j, "lobes_file", r->lobes_path);
    json_int(&j, "width", m->width);
    json_int(&j, "height", m->height);
    json_int(&j, "lobes", m->lobes);
    json_int(&j, "levels", m->levels);
    json_bool(&j, "direction", m->has_direction);
    json_int(&j, "texel_bytes", (long long)texel_bytes(m));
    json_real(&j, "error_plain", out->report.error_plain);
    json_real(&j, "error", out->report.error_chosen);
    json_int(&j, "clamped_exponents", out->clamped.exponents);
    json_int(&j, "clamped_shapes", out->clamped.shapes);
    json_int(&j, "clamped_albedos", out->clamped.albedos);
    if (out->from.kind == FROM_GLTF) {
        if (out->from.gltf.normal_map.texel) json_text(&j, "normal", r->normal_path);
        json_int(&j, "kinds", out->from.gltf.kinds);
        json_real(&j, "fit_error", out->from.gltf.mean_error);
        json_real(&j, "fit_error_worst", out->from.gltf.worst_error);
    }
    if (out->from.kind == FROM_STACK) {
        json_int(&j, "images", out->from.stack.images);
        json_real(&j, "fit_error", out->from.stack.error);
        json_real(&j, "fit_seconds", out->from.stack.seconds);
        json_int(&j, "underlit", out->from.stack.underlit);
    }
    if (r->preview) json_views(&j, out->view);
    json_end(&j, '}');
    return j;
}

/* A glTF material's normal map, beside the others. */
static int write_normals(const request *r, const result *out, failure *f)
{
    bytes file = {0};
    if (!out->from.gltf.normal_map.texel) return FAIL_NONE;
    normal_file_write(&out->from.gltf.normal_map, out->from.gltf.normal_scale, r->no_mips, r->source, &file);
    int code = output_write(r->normal_path, &file, f);
    bytes_free(&file);
    return code;
}

static int write_all(const request *r, const result *out, const sbrdf_sources *sources, failure *f)
{
    bytes albedo = {0}, lobes = {0};
    int code = write_normals(r, out, f);
    if (code) return code;
    json figures = figures_of(r, out);
    sbrdf_map_write(&out->map, &albedo, &lobes);
    code = bake_write_pair(&r->common, sources, &figures, r->albedo_path, &albedo, r->lobes_path, &lobes, f);
    if (code && out->from.gltf.normal_map.texel) output_discard(r->normal_path);
    return code;
}

static void print_result(const request *r, const result *out)
{
    const sbrdf_map *m = &out->map;
    printf("%s, %s: %d x %d, %d lobe%s, %d level%s, %zu bytes of texels; error of the 8 bits %.2f %% "
           "(%.2f %% without moving magnitude between albedo and C)\n",
           r->albedo_path, r->lobes_path, m->width, m->height, m->lobes, m->lobes == 1 ? "" : "s", m->levels,
           m->levels == 1 ? "" : "s", texel_bytes(m), 100 * out->report.error_chosen, 100 * out->report.error_plain);
}

static int make_preview(const request *r, result *out, failure *f)
{
    image_u8 sheet;
    if (!r->preview) return FAIL_NONE;
    sbrdf_view_levels(&out->map, out->view, &sheet);
    image_u8 labelled = sbrdf_view_label(&sheet, out->view);
    int code = png_write(r->preview, &labelled, f);
    image_u8_free(&labelled);
    image_u8_free(&sheet);
    return code;
}

static void print_views(const request *r, const result *out)
{
    for (int i = 0; i < SBRDF_VIEWS && r->preview; i++)
        if (out->view[i].factor)
            printf("%s: 1/%d of the size: %.1f dB by its level, %.1f dB by means of codes\n", r->preview,
                   out->view[i].factor, out->view[i].level_psnr, out->view[i].average_psnr);
}

static void print_origin(const request *r, const result *out)
{
    const gltf_report *gltf = &out->from.gltf;
    const sbrdf_stack_report *stack = &out->from.stack;
    if (out->from.kind == FROM_GLTF)
        printf("%s: relative error of f_r cos against GGX %.1f %%, worst %.1f %%, over %ld kinds of texels\n",
               r->source, 100 * gltf->mean_error, 100 * gltf->worst_error, gltf->kinds);
    if (gltf->normal_map.texel)
        printf("%s: normals of %d x %d\n", r->normal_path, gltf->normal_map.width, gltf->normal_map.height);
    if (out->from.kind == FROM_STACK)
        printf("%s: %d images, relative error %.2f %%, %.0f texels a second\n", r->source, stack->images,
               100 * stack->error, out->map.width * out->map.height / fmax(stack->seconds, 1e-9));
}

static int sources_apart(const request *r, const sbrdf_sources *sources, failure *f)
{
    int code = FAIL_NONE;
    for (int i = 0; i < sources->count && !code; i++) {
        code = output_apart(r->albedo_path, sources->path[i], f);
        if (!code) code = output_apart(r->lobes_path, sources->path[i], f);
        if (!code) code = output_apart(r->normal_path, sources->path[i], f);
    }
    return code;
}

int bake_sbrdf(int argc, char **argv, failure *f)
{
    request r = {.maps = {.lobe_most = 1}, .range = 1, .lobes = 1};
    sbrdf_sources sources = {0};
    sbrdf_field field = {0};
    result out = {0};
    progress meter = {0};
    int code = parse(&r, argc, argv, f);
    meter.quiet = r.common.quiet;
    const char *name = r.source ? r.source : r.maps.albedo;
    if (!code) code = read_field(&r, &field, &sources, &meter, &out.from, f);
    if (!code) code = sources_apart(&r, &sources, f);
    if (!code) code = bake_field(&r, &field, name, &meter, &out, f);
    if (!code) code = make_preview(&r, &out, f);
    if (!code) code = write_all(&r, &out, &sources, f);
    if (!code && bake_prints(&r.common)) {
        print_origin(&r, &out);
        print_result(&r, &out);
        print_views(&r, &out);
    }
    sbrdf_field_free(&field);
    sbrdf_map_free(&out.map);
    image_u8_free(&out.from.gltf.normal_map);
    sbrdf_sources_free(&sources);
    free(r.split);
    return code;
}
