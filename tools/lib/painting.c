/* SPDX-License-Identifier: MIT */
#include "painting.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "png_io.h"

static const double pi = 3.14159265358979323846;

enum { MAX_LOBES = 3, MAX_WORDS = 12, MAX_SIDE = 4096 };

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

/* While the text is read. */
typedef struct reader {
    painting *p;
    int line;
    sbrdf_sources *sources;
    failure *f;
} reader;

static int fail_text(const painting *p, int line, failure *f, const char *format, va_list args)
{
    char text[700];
    vsnprintf(text, sizeof text, format, args);
    return fail(f, FAIL_INVALID, "%s: line %d: %s", p->path, line, text);
}

int painting_fail(const painting *p, int line, failure *f, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int code = fail_text(p, line, f, format, args);
    va_end(args);
    return code;
}

static int fail_line(const reader *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
static int fail_line(const reader *r, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int code = fail_text(r->p, r->line, r->f, format, args);
    va_end(args);
    return code;
}

/* ---- pictures --------------------------------------------------------------------------------------- */

/* name beside the text's own file */
static void beside(const painting *p, const char *name, char *out, size_t size)
{
    const char *slash = strrchr(p->path, '/');
    int length = slash && name[0] != '/' ? (int)(slash - p->path + 1) : 0;
    snprintf(out, size, "%.*s%s", length, p->path, name);
}

static int read_picture(reader *r, const char *name, int channels, image_u8 *out)
{
    painting *p = r->p;
    char path[1024];
    beside(p, name, path, sizeof path);
    if (out->texel) return fail_line(r, "%s: found a second picture for the same", name);
    int code = png_read(out, path, channels, r->f);
    if (code) return code;
    sbrdf_sources_add(r->sources, path);
    if (out->width == p->width && out->height == p->height) return FAIL_NONE;
    return fail_line(r, "%s: found %d x %d texels, expected %d x %d", name, out->width, out->height, p->width,
                     p->height);
}

/* ---- statements -------------------------------------------------------------------------------------- */

static int whole_number(const char *text, int low, int high)
{
    char *end;
    long value = strtol(text, &end, 10);
    return *text && !*end && value >= low && value <= high ? (int)value : -1;
}

static int do_size(reader *r, char **word, int count)
{
    painting *p = r->p;
    if (p->width) return fail_line(r, "size: found twice");
    if (count == 3) {
        p->width = whole_number(word[1], 1, MAX_SIDE);
        p->height = whole_number(word[2], 1, MAX_SIDE);
    }
    if (p->width > 0 && p->height > 0) return FAIL_NONE;
    return fail_line(r, "size: expected WIDTH HEIGHT, each 1..%d", MAX_SIDE);
}

static int do_lobes(reader *r, char **word, int count)
{
    painting *p = r->p;
    if (p->material_count) return fail_line(r, "lobes: found after a material, expected before");
    p->lobes = count == 2 ? whole_number(word[1], 1, MAX_LOBES) : -1;
    return p->lobes > 0 ? FAIL_NONE
                        : fail_line(r, "lobes: found %s, expected 1, 2 or 3", count > 1 ? word[1] : "nothing");
}

static int find_material(const painting *p, const char *name)
{
    for (int i = 0; i < p->material_count; i++)
        if (!strcmp(p->material[i].name, name)) return i;
    return -1;
}

static int do_material(reader *r, char **word, int count)
{
    painting *p = r->p;
    if (count != 3) return fail_line(r, "material: expected NAME BRDF");
    if (find_material(p, word[1]) >= 0) return fail_line(r, "material %s: found twice", word[1]);
    if (p->material_count == PAINTING_MATERIALS)
        return fail_line(r, "material: found more than %d", PAINTING_MATERIALS);
    painting_material *m = &p->material[p->material_count];
    if (strlen(word[1]) >= sizeof m->name || strlen(word[2]) >= sizeof m->brdf)
        return fail_line(r, "material %.20s...: found a name of more than %zu or a BRDF of more than %zu characters",
                         word[1], sizeof m->name - 1, sizeof m->brdf - 1);
    if (!p->lobes) p->lobes = 1;
    strcpy(m->name, word[1]);
    strcpy(m->brdf, word[2]);
    m->line = r->line;
    p->material_count++;
    return FAIL_NONE;
}

static int do_word(reader *r, painting_coat *c, const char *word)
{
    char *end;
    if (!strncmp(word, "tint=", 5)) return read_picture(r, word + 5, 3, &c->tint);
    if (!strncmp(word, "shine=", 6)) return read_picture(r, word + 6, 3, &c->shine);
    if (!strncmp(word, "direction=", 10)) return read_picture(r, word + 10, 3, &c->direction);
    if (strncmp(word, "turn=", 5))
        return fail_line(r, "%s: expected tint=FILE, shine=FILE, turn=DEGREES or direction=FILE", word);
    double degrees = strtod(word + 5, &end);
    if (!word[5] || *end || !isfinite(degrees)) return fail_line(r, "%s: expected degrees", word);
    c->turn[0] = cos(degrees * pi / 180);
    c->turn[1] = sin(degrees * pi / 180);
    return FAIL_NONE;
}

static int do_coat(reader *r, char **word, int count)
{
    painting *p = r->p;
    int has_mask = !strcmp(word[0], "paint"), first = has_mask ? 3 : 2, code = FAIL_NONE;
    if (count < first) return fail_line(r, "%s: expected %s", word[0], has_mask ? "NAME MASK.png" : "NAME");
    if (!p->width) return fail_line(r, "%s: found before size", word[0]);
    int index = find_material(p, word[1]);
    if (index < 0) return fail_line(r, "%s %s: no such material above", word[0], word[1]);
    if (has_mask && !p->coat_count) return fail_line(r, "paint: found before a fill, expected something to paint on");
    if (p->coat_count == PAINTING_COATS) return fail_line(r, "found more than %d fills and paints", PAINTING_COATS);
    painting_coat *c = &p->coat[p->coat_count++];
    c->material = index;
    c->line = r->line;
    c->turn[0] = 1;
    if (has_mask) code = read_picture(r, word[2], 1, &c->mask);
    for (int i = first; i < count && !code; i++) code = do_word(r, c, word[i]);
    return code;
}

static int do_opacity(reader *r, char **word, int count)
{
    painting *p = r->p;
    if (count != 2) return fail_line(r, "opacity: expected MASK.png");
    if (!p->width) return fail_line(r, "opacity: found before size");
    return read_picture(r, word[1], 1, &p->opacity);
}

static int do_index(reader *r, char **word, int count)
{
    painting *p = r->p;
    if (count != 2) return fail_line(r, "index: expected PICTURE.png");
    if (!p->width) return fail_line(r, "index: found before size");
    return read_picture(r, word[1], 1, &p->index);
}

static int do_line(reader *r, char *line)
{
    static const struct {
        const char *name;
        int (*run)(reader *r, char **word, int count);
    } statements[] = {{"size", do_size},  {"lobes", do_lobes},     {"material", do_material}, {"fill", do_coat},
                      {"paint", do_coat}, {"opacity", do_opacity}, {"index", do_index}};
    char *word[MAX_WORDS], *rest = NULL;
    int count = 0;
    line[strcspn(line, "#")] = 0;
    for (char *w = strtok_r(line, " \t\r", &rest); w && count < MAX_WORDS; w = strtok_r(NULL, " \t\r", &rest))
        word[count++] = w;
    if (!count) return FAIL_NONE;
    for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
        if (!strcmp(word[0], statements[i].name)) return statements[i].run(r, word, count);
    return fail_line(r, "%s: expected size, lobes, material, fill, paint, opacity or index", word[0]);
}

static int read_text(reader *r)
{
    painting *p = r->p;
    bytes file = {0};
    int code = file_read(&file, p->path, r->f);
    if (code) return code;
    bytes_append(&file, "", 1);
    char *rest = (char *)file.data;
    while (rest && !code) {
        char *end = strchr(rest, '\n'), *next = end ? end + 1 : NULL;
        if (end) *end = 0;
        r->line++;
        code = do_line(r, rest);
        rest = next;
    }
    bytes_free(&file);
    if (!code && !p->coat_count && !p->index.texel)
        code = fail(r->f, FAIL_INVALID, "%s: found no fill, expected one", p->path);
    return code;
}

int painting_open(painting *out, const char *path, sbrdf_sources *sources, failure *f)
{
    reader r = {out, 0, sources, f};
    memset(out, 0, sizeof *out);
    out->path = path;
    return read_text(&r);
}

void painting_close(painting *p)
{
    for (int k = 0; k < p->coat_count; k++) {
        image_u8_free(&p->coat[k].mask);
        image_u8_free(&p->coat[k].tint);
        image_u8_free(&p->coat[k].shine);
        image_u8_free(&p->coat[k].direction);
    }
    image_u8_free(&p->opacity);
    image_u8_free(&p->index);
}

int painting_visible(const painting *p, long texel, int coat[PAINTING_COATS], double weight[PAINTING_COATS])
{
    double left = 1;
    int count = 0;
    for (int k = p->coat_count - 1; k >= 0 && left > 0; k--) {
        double shows = p->coat[k].mask.texel ? p->coat[k].mask.texel[texel] / 255.0 : 1;
        if (!(shows > 0)) continue;
        coat[count] = k;
        weight[count++] = left * shows;
        left *= 1 - shows;
    }
    return count;
}
