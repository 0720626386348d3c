/* SPDX-License-Identifier: MIT */
#include "published.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "models.h"
#include "options.h"

extern const unsigned char embedded_sgd_csv[], embedded_ngan_lafortune_csv[], embedded_ngan_cook_torrance_csv[],
    embedded_lafortune_csv[];
extern const unsigned long embedded_sgd_csv_size, embedded_ngan_lafortune_csv_size,
    embedded_ngan_cook_torrance_csv_size, embedded_lafortune_csv_size;

static const double pi = 3.14159265358979323846;

enum { MAX_NUMBERS = 3 + 9 * 16, MAX_LINE = 4096 };

/* One material: numbers in the order of the file's columns after name and class. */
typedef struct row {
    char name[64], class_name[32];
    double number[MAX_NUMBERS];
    int count;
} row;

typedef struct published {
    const char *name, *source;
    const unsigned char *csv;
    const unsigned long *size;
    int least, most, step; /* numbers a row may have: least, least + step, ... most */
    brdf *(*make)(const row *r);
} published;

static brdf *make_sgd(const row *r)
{
    sgd_parameters p = {0};
    double *group[11] = {p.kd, p.ks, p.alpha, p.p, p.f0, p.f1, p.scale, p.lambda, p.c, p.k, p.theta0};
    for (int i = 0; i < 11; i++) memcpy(group[i], r->number + 3 * i, 3 * sizeof(double));
    return sgd_brdf(&p);
}

/* The fits of Ngan et al. were made on the database's stored numbers / 1500, without the factors 1, 1.15 and 1.66 that its
   reader gives to R, G and B: relative to R, their kd is 0.866 (G; 1/1.15 = 0.870) and 0.588 (B; 1/1.66 = 0.602) of the
   kd in the SGD fits of the same materials (medians of the 42 with kd above 0.02). So the factors come in here, and the
   file keeps the published numbers. */
static const double ngan_channel[3] = {1, 1.15, 1.66};

/* Ngan, Durand and Matusik 2005, table of the supplemental: ks (n + 2) / (2 pi max(|cxy|, |cz|)^n) times Lafortune's
   lobe. The power goes into the coefficients: exponents reach 10^4. */
static brdf *make_ngan_lafortune(const row *r)
{
    double largest = fmax(fabs(r->number[6]), fabs(r->number[7])), n = r->number[8];
    double kd[3];
    lafortune_lobe lobe;
    for (int c = 0; c < 3; c++) {
        lobe.cx[c] = lobe.cy[c] = r->number[6] / largest;
        lobe.cz[c] = r->number[7] / largest;
        lobe.n[c] = n;
        lobe.ks[c] = ngan_channel[c] * r->number[3 + c] * (n + 2) / (2 * pi);
        kd[c] = ngan_channel[c] * r->number[c];
    }
    return lafortune_brdf(kd, &lobe, 1);
}

/* Ngan, Durand and Matusik 2005: the lobe of the 1982 paper, divided by pi, with Schlick's Fresnel term. */
static brdf *make_ngan_cook_torrance(const row *r)
{
    cook_torrance_parameters p = {.m = r->number[7], .divisor = pi, .fresnel = FRESNEL_SCHLICK};
    for (int c = 0; c < 3; c++) {
        p.kd[c] = ngan_channel[c] * r->number[c];
        p.ks[c] = ngan_channel[c] * r->number[3 + c];
        p.f0[c] = r->number[6];
    }
    return cook_torrance_brdf(&p);
}

static brdf *make_lafortune(const row *r)
{
    lafortune_lobe lobe[16];
    size_t count = (size_t)(r->count - 3) / 9;
    for (size_t i = 0; i < count; i++) {
        const double *number = r->number + 3 + 9 * i;
        for (int c = 0; c < 3; c++) {
            lobe[i].ks[c] = 1;
            lobe[i].cx[c] = lobe[i].cy[c] = number[c];
            lobe[i].cz[c] = number[3 + c];
            lobe[i].n[c] = number[6 + c];
        }
    }
    return lafortune_brdf(r->number, lobe, count);
}

static const published sets[] = {
    {"sgd", "shifted gamma distribution, fit by Bagher et al. 2012 to measured", embedded_sgd_csv,
     &embedded_sgd_csv_size, 33, 33, 1, make_sgd},
    {"ngan-lafortune", "Lafortune lobe, fit by Ngan et al. 2005 to measured", embedded_ngan_lafortune_csv,
     &embedded_ngan_lafortune_csv_size, 9, 9, 1, make_ngan_lafortune},
    {"ngan-cook-torrance", "Cook-Torrance lobe, fit by Ngan et al. 2005 to measured", embedded_ngan_cook_torrance_csv,
     &embedded_ngan_cook_torrance_csv_size, 8, 8, 1, make_ngan_cook_torrance},
    {"lafortune", "Lafortune lobes, fit to Cornell goniometer measurements of", embedded_lafortune_csv,
     &embedded_lafortune_csv_size, 12, MAX_NUMBERS, 9, make_lafortune},
};
enum { SET_COUNT = sizeof sets / sizeof *sets };

const char *published_set(size_t index)
{
    return index < SET_COUNT ? sets[index].name : NULL;
}

/* ---- CSV --------------------------------------------------------------------------------------------------------------- */

typedef struct reader {
    const published *set;
    const char *at, *end;
    int line, has_header;
} reader;

static int fail_csv(const reader *in, const char *what, failure *f)
{
    return fail(f, FAIL_INTERNAL, "embedded %s.csv: line %d: %s", in->set->name, in->line, what);
}

/* Copy the field at *text into out; moves *text past its comma. 0 if empty or too long. */
static int read_text(char **text, char *out, size_t size)
{
    size_t length = strcspn(*text, ",");
    if (!length || length >= size) return 0;
    memcpy(out, *text, length);
    out[length] = '\0';
    *text += length + ((*text)[length] == ',');
    return 1;
}

static int parse_row(const reader *in, char *line, row *r, failure *f)
{
    if (!read_text(&line, r->name, sizeof r->name) || !read_text(&line, r->class_name, sizeof r->class_name))
        return fail_csv(in, "expected a name and a class", f);
    for (r->count = 0; *line; r->count++) {
        char field[64], *end;
        if (r->count == MAX_NUMBERS || !read_text(&line, field, sizeof field))
            return fail_csv(in, "found an empty field or too many, expected numbers", f);
        r->number[r->count] = strtod(field, &end);
        if (*end || !isfinite(r->number[r->count])) return fail_csv(in, "found a field that is no finite number", f);
    }
    const published *set = in->set;
    if (r->count < set->least || r->count > set->most || (r->count - set->least) % set->step)
        return fail_csv(in, "wrong number of columns", f);
    return 0;
}

/* Next material: 1 read, 0 end of text, -1 failed. */
static int next_row(reader *in, row *r, failure *f)
{
    char line[MAX_LINE];
    while (in->at < in->end) {
        const char *stop = memchr(in->at, '\n', (size_t)(in->end - in->at));
        size_t length = (size_t)((stop ? stop : in->end) - in->at);
        in->line++;
        if (length >= sizeof line || memchr(in->at, '\0', length)) {
            fail_csv(in, "line too long or not text", f);
            return -1;
        }
        memcpy(line, in->at, length);
        line[length] = '\0';
        in->at += length + (stop != NULL);
        if (!*line || *line == '#') continue;
        if (in->has_header) return parse_row(in, line, r, f) ? -1 : 1;
        if (strncmp(line, "name,class,", 11) != 0) {
            fail_csv(in, "expected the header name,class,...", f);
            return -1;
        }
        in->has_header = 1;
    }
    return 0;
}

static reader embedded_reader(const published *set)
{
    const char *text = (const char *)set->csv;
    reader in = {set, text, text + *set->size, 0, 0};
    return in;
}

/* ---- names ------------------------------------------------------------------------------------------------------------- */

static pthread_once_t names_once = PTHREAD_ONCE_INIT;
static const char **names;
static size_t name_count;

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static void list_names(void)
{
    enum { MAX_NAMES = 1024 };
    static const char *list[MAX_NAMES];
    for (size_t i = 0; i < SET_COUNT; i++) {
        reader in = embedded_reader(&sets[i]);
        row r;
        while (name_count < MAX_NAMES && next_row(&in, &r, NULL) > 0) {
            size_t size = strlen(sets[i].name) + strlen(r.name) + 2;
            char *name = need_memory(size, 1); /* kept for the life of the program */
            snprintf(name, size, "%s:%s", sets[i].name, r.name);
            list[name_count++] = name;
        }
    }
    qsort(list, name_count, sizeof *list, compare_names);
    names = list;
}

const char *const *published_names(size_t *count)
{
    pthread_once(&names_once, list_names);
    *count = name_count;
    return names;
}

/* ---- opening ----------------------------------------------------------------------------------------------------------- */

static const published *find_set(const char *name)
{
    for (size_t i = 0; i < SET_COUNT; i++) {
        if (strcmp(name, sets[i].name) == 0) return &sets[i];
    }
    return NULL;
}

static int fail_material(const published *set, const char *material, failure *f)
{
    size_t all, first = 0, count = 0, prefix = strlen(set->name) + 1;
    const char *const *list = published_names(&all);
    const char **of_set = need_memory(all, sizeof *of_set);
    for (; first < all; first++) {
        if (strncmp(list[first], set->name, prefix - 1) == 0 && list[first][prefix - 1] == ':')
            of_set[count++] = list[first] + prefix;
    }
    char near[500] = "";
    nearest_names(material, of_set, count, near, sizeof near);
    free(of_set);
    return fail(f, FAIL_USAGE, "BRDF %s: found material \"%.100s\", expected one of %zu names%s%s", set->name, material,
                count, *near ? "; near: " : " (nacre info --brdfs lists them)", near);
}

static int find_row(reader *in, const char *material, row *r, failure *f)
{
    int got;
    while ((got = next_row(in, r, f)) > 0) {
        if (strcmp(r->name, material) == 0) return 1;
    }
    return got;
}

static int open_row(brdf **out, reader *in, const char *material, failure *f)
{
    row r;
    int found = find_row(in, material, &r, f);
    if (found <= 0) return found < 0 ? FAIL_INTERNAL : fail_material(in->set, material, f);
    *out = in->set->make(&r);
    snprintf((*out)->description, sizeof(*out)->description, "%s %s (%s)", in->set->source, r.name, r.class_name);
    return 0;
}

int published_open(brdf **out, const char *set, const char *material, failure *f)
{
    const published *s = find_set(set);
    if (!s)
        return fail(f, FAIL_USAGE,
                    "BRDF: found set \"%.60s\", expected sgd, ngan-lafortune, ngan-cook-torrance or"
                    " lafortune",
                    set);
    reader in = embedded_reader(s);
    return open_row(out, &in, material, f);
}

int published_parse(brdf **out, const char *set, const char *material, const char *csv, size_t size, failure *f)
{
    const published *s = find_set(set);
    if (!s) return fail(f, FAIL_USAGE, "BRDF: found set \"%.60s\"", set);
    reader in = {s, csv, csv + size, 0, 0};
    return open_row(out, &in, material, f);
}
