/* SPDX-License-Identifier: MIT */
#include "sbrdf_paint.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lafortune_fit.h"
#include "options.h"
#include "png_io.h"
#include "sbrdf_mix.h"

static const double pi = 3.14159265358979323846;

enum { MAX_MATERIALS = 64, MAX_COATS = 64, MAX_WORDS = 12, MAX_SIDE = 4096 };

typedef struct material {
    char name[64];
    sbrdf_texel texel;
} material;

/* One fill or paint. */
typedef struct coat {
    int material;
    image_u8 mask, tint, shine, direction; /* texel NULL: none */
    double turn[2];
} coat;

typedef struct painting {
    const char *path;
    int line, width, height, lobes;
    material material[MAX_MATERIALS];
    int material_count;
    coat coat[MAX_COATS];
    int coat_count;
    image_u8 opacity;
    sbrdf_sources *sources;
    failure *f;
} painting;

void sbrdf_sources_add(sbrdf_sources *s, const char *path)
{
    char **grown = realloc(s->path, (size_t)(s->count + 1) * sizeof *grown);
    char *copy = need_memory(strlen(path) + 1, 1);
    if (!grown) abort();
    strcpy(copy, path);
    s->path = grown;
    s->path[s->count++] = copy;
}

void sbrdf_sources_free(sbrdf_sources *s)
{
    for (int i = 0; i < s->count; i++) free(s->path[i]);
    free(s->path);
    *s = (sbrdf_sources){0};
}

static int fail_line(const painting *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
static int fail_line(const painting *p, const char *format, ...)
{
    char text[700];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return fail(p->f, FAIL_INVALID, "%s: line %d: %s", p->path, p->line, text);
}

/* ---- pictures --------------------------------------------------------------------------------------- */

/* name beside the text's own file */
static void beside(const painting *p, const char *name, char *out, size_t size)
{
    const char *slash = strrchr(p->path, '/');
    int length = slash && name[0] != '/' ? (int)(slash - p->path + 1) : 0;
    snprintf(out, size, "%.*s%s", length, p->path, name);
}

static int read_picture(painting *p, const char *name, int channels, image_u8 *out)
{
    char path[1024];
    beside(p, name, path, sizeof path);
    if (out->texel) return fail_line(p, "%s: found a second picture for the same", name);
    int code = png_read(out, path, channels, p->f);
    if (code) return code;
    sbrdf_sources_add(p->sources, path);
    if (out->width == p->width && out->height == p->height) return FAIL_NONE;
    return fail_line(p, "%s: found %d x %d texels, expected %d x %d", name, out->width, out->height, p->width,
                     p->height);
}

/* ---- statements -------------------------------------------------------------------------------------- */

static int whole_number(const char *text, int low, int high)
{
    char *end;
    long value = strtol(text, &end, 10);
    return *text && !*end && value >= low && value <= high ? (int)value : -1;
}

static int do_size(painting *p, char **word, int count)
{
    if (p->width) return fail_line(p, "size: found twice");
    if (count == 3) {
        p->width = whole_number(word[1], 1, MAX_SIDE);
        p->height = whole_number(word[2], 1, MAX_SIDE);
    }
    if (p->width > 0 && p->height > 0) return FAIL_NONE;
    return fail_line(p, "size: expected WIDTH HEIGHT, each 1..%d", MAX_SIDE);
}

static int do_lobes(painting *p, char **word, int count)
{
    if (p->material_count) return fail_line(p, "lobes: found after a material, expected before");
    p->lobes = count == 2 ? whole_number(word[1], 1, LAFORTUNE_MAX_LOBES) : -1;
    return p->lobes > 0 ? FAIL_NONE
                        : fail_line(p, "lobes: found %s, expected 1, 2 or 3", count > 1 ? word[1] : "nothing");
}

static int find_material(const painting *p, const char *name)
{
    for (int i = 0; i < p->material_count; i++)
        if (!strcmp(p->material[i].name, name)) return i;
    return -1;
}

static void take_fit(const lafortune_fit *fit, int lobes, sbrdf_texel *out)
{
    memset(out, 0, sizeof *out);
    out->alpha = out->direction[0] = 1;
    out->brdf.lobes = lobes;
    memcpy(out->brdf.kd, fit->kd, sizeof out->brdf.kd);
    for (int j = 0; j < lobes; j++) {
        const lafortune_lobe *from = &fit->lobe[j];
        out->brdf.lobe[j] = (lafortune_shared_lobe){
            {from->cx[0], from->cy[0], from->cz[0]}, from->n[0], {from->ks[0], from->ks[1], from->ks[2]}};
    }
    sbrdf_sort_lobes(out);
}

static int do_material(painting *p, char **word, int count)
{
    brdf *b;
    lafortune_fit fit;
    if (count != 3) return fail_line(p, "material: expected NAME BRDF");
    if (find_material(p, word[1]) >= 0) return fail_line(p, "material %s: found twice", word[1]);
    if (p->material_count == MAX_MATERIALS) return fail_line(p, "material: found more than %d", MAX_MATERIALS);
    if (!p->lobes) p->lobes = 1;
    int code = brdf_open(&b, word[2], p->f);
    if (code) return code;
    const lafortune_fit_options options = {.lobes = p->lobes,
                                           .display = 1,
                                           .n_min = SBRDF_EXPONENT_LEAST,
                                           .n_max = SBRDF_EXPONENT_MOST,
                                           .grazing_max = SBRDF_GRAZING_MAX};
    code = lafortune_fit_brdf(&fit, b, &options, p->f);
    brdf_close(b);
    if (code) return code;
    material *m = &p->material[p->material_count++];
    snprintf(m->name, sizeof m->name, "%s", word[1]);
    take_fit(&fit, p->lobes, &m->texel);
    return FAIL_NONE;
}

static int do_word(painting *p, coat *c, const char *word)
{
    char *end;
    if (!strncmp(word, "tint=", 5)) return read_picture(p, word + 5, 3, &c->tint);
    if (!strncmp(word, "shine=", 6)) return read_picture(p, word + 6, 3, &c->shine);
    if (!strncmp(word, "direction=", 10)) return read_picture(p, word + 10, 3, &c->direction);
    if (strncmp(word, "turn=", 5))
        return fail_line(p, "%s: expected tint=FILE, shine=FILE, turn=DEGREES or direction=FILE", word);
    double degrees = strtod(word + 5, &end);
    if (!word[5] || *end || !isfinite(degrees)) return fail_line(p, "%s: expected degrees", word);
    c->turn[0] = cos(degrees * pi / 180);
    c->turn[1] = sin(degrees * pi / 180);
    return FAIL_NONE;
}

static int do_coat(painting *p, char **word, int count)
{
    int has_mask = !strcmp(word[0], "paint"), first = has_mask ? 3 : 2, code = FAIL_NONE;
    if (count < first) return fail_line(p, "%s: expected %s", word[0], has_mask ? "NAME MASK.png" : "NAME");
    if (!p->width) return fail_line(p, "%s: found before size", word[0]);
    int index = find_material(p, word[1]);
    if (index < 0) return fail_line(p, "%s %s: no such material above", word[0], word[1]);
    if (has_mask && !p->coat_count) return fail_line(p, "paint: found before a fill, expected something to paint on");
    if (p->coat_count == MAX_COATS) return fail_line(p, "found more than %d fills and paints", MAX_COATS);
    coat *c = &p->coat[p->coat_count++];
    c->material = index;
    c->turn[0] = 1;
    if (has_mask) code = read_picture(p, word[2], 1, &c->mask);
    for (int i = first; i < count && !code; i++) code = do_word(p, c, word[i]);
    return code;
}

static int do_opacity(painting *p, char **word, int count)
{
    if (count != 2) return fail_line(p, "opacity: expected MASK.png");
    if (!p->width) return fail_line(p, "opacity: found before size");
    return read_picture(p, word[1], 1, &p->opacity);
}

static int do_line(painting *p, char *line)
{
    static const struct {
        const char *name;
        int (*run)(painting *p, char **word, int count);
    } statements[] = {{"size", do_size}, {"lobes", do_lobes}, {"material", do_material},
                      {"fill", do_coat}, {"paint", do_coat},  {"opacity", do_opacity}};
    char *word[MAX_WORDS], *rest = NULL;
    int count = 0;
    line[strcspn(line, "#")] = 0;
    for (char *w = strtok_r(line, " \t\r", &rest); w && count < MAX_WORDS; w = strtok_r(NULL, " \t\r", &rest))
        word[count++] = w;
    if (!count) return FAIL_NONE;
    for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
        if (!strcmp(word[0], statements[i].name)) return statements[i].run(p, word, count);
    return fail_line(p, "%s: expected size, lobes, material, fill, paint or opacity", word[0]);
}

static int read_text(painting *p)
{
    bytes file = {0};
    int code = file_read(&file, p->path, p->f);
    if (code) return code;
    bytes_append(&file, "", 1);
    char *rest = (char *)file.data;
    while (rest && !code) {
        char *end = strchr(rest, '\n'), *next = end ? end + 1 : NULL;
        if (end) *end = 0;
        p->line++;
        code = do_line(p, rest);
        rest = next;
    }
    bytes_free(&file);
    if (!code && !p->coat_count) code = fail(p->f, FAIL_INVALID, "%s: found no fill, expected one", p->path);
    return code;
}

/* ---- painting ---------------------------------------------------------------------------------------- */

static double srgb_of(const image_u8 *picture, long i, int channel)
{
    return picture->texel ? srgb_decode(picture->texel[3 * i + channel] / 255.0) : 1;
}

/* The coat's material at a texel. */
static void coated(const painting *p, const coat *c, long i, sbrdf_texel *out)
{
    *out = p->material[c->material].texel;
    memcpy(out->direction, c->turn, sizeof out->direction);
    for (int k = 0; k < 3; k++) {
        out->brdf.kd[k] *= srgb_of(&c->tint, i, k);
        for (int j = 0; j < out->brdf.lobes; j++) out->brdf.lobe[j].ks[k] *= srgb_of(&c->shine, i, k);
    }
    if (!c->direction.texel) return;
    double x = sbrdf_shape_value(c->direction.texel[3 * i], 1), y = sbrdf_shape_value(c->direction.texel[3 * i + 1], 1);
    double length = hypot(x, y);
    if (!(length > 0)) return;
    out->direction[0] = (x * c->turn[0] - y * c->turn[1]) / length;
    out->direction[1] = (y * c->turn[0] + x * c->turn[1]) / length;
}

/* From the top coat down to one that hides the rest: what shows of each. Returns how many. */
static int visible(const painting *p, long i, sbrdf_part *parts, sbrdf_texel *texel)
{
    double left = 1;
    int count = 0;
    for (int k = p->coat_count - 1; k >= 0 && left > 0; k--) {
        const coat *c = &p->coat[k];
        double shows = c->mask.texel ? c->mask.texel[i] / 255.0 : 1;
        if (!(shows > 0)) continue;
        coated(p, c, i, &texel[count]);
        parts[count].texel = &texel[count];
        parts[count++].weight = left * shows;
        left *= 1 - shows;
    }
    return count;
}

static void paint_texel(const painting *p, sbrdf_mixer *mixer, long i, sbrdf_texel *out)
{
    sbrdf_part parts[MAX_COATS];
    sbrdf_texel texel[MAX_COATS];
    int count = visible(p, i, parts, texel);
    if (count == 1)
        *out = texel[0];
    else
        sbrdf_mix(mixer, parts, count, parts, count, out);
    if (p->opacity.texel) out->alpha = p->opacity.texel[i] / 255.0;
}

static int has_direction(const painting *p)
{
    for (int k = 0; k < p->coat_count; k++)
        if (p->coat[k].direction.texel || p->coat[k].turn[1] != 0) return 1;
    return 0;
}

static void paint_field(const painting *p, sbrdf_field *out, progress *meter)
{
    int anisotropic = 0;
    *out = sbrdf_field_make(p->width, p->height, p->lobes, has_direction(p));
    for (int k = 0; k < p->material_count; k++)
        for (int j = 0; j < p->lobes; j++)
            anisotropic |= p->material[k].texel.brdf.lobe[j].c[0] != p->material[k].texel.brdf.lobe[j].c[1];
    progress_begin(meter, "rows", p->height);
#pragma omp parallel
    {
        sbrdf_mixer *mixer = sbrdf_mixer_make(p->lobes, anisotropic);
#pragma omp for schedule(dynamic, 1)
        for (int y = 0; y < p->height; y++) {
            for (int x = 0; x < p->width; x++) {
                long i = (long)y * p->width + x;
                paint_texel(p, mixer, i, &out->texel[i]);
            }
            progress_add(meter, 1);
        }
        sbrdf_mixer_free(mixer);
    }
    progress_end(meter);
}

static void close_painting(painting *p)
{
    for (int k = 0; k < p->coat_count; k++) {
        image_u8_free(&p->coat[k].mask);
        image_u8_free(&p->coat[k].tint);
        image_u8_free(&p->coat[k].shine);
        image_u8_free(&p->coat[k].direction);
    }
    image_u8_free(&p->opacity);
    free(p);
}

int sbrdf_paint(sbrdf_field *out, const char *path, sbrdf_sources *sources, progress *meter, failure *f)
{
    painting *p = need_memory(1, sizeof *p);
    memset(p, 0, sizeof *p);
    p->path = path;
    p->sources = sources;
    p->f = f;
    int code = read_text(p);
    if (!code) paint_field(p, out, meter);
    close_painting(p);
    return code;
}
