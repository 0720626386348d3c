/* SPDX-License-Identifier: MIT */
#include "models.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "options.h"
#include "vec3.h"

static const double pi = 3.14159265358979323846;

static double square(double x)
{
    return x * x;
}

/* Unit half vector h; returns cos(theta_diff) = l.h, or 0 if a direction is not above the horizon. */
static double half_vector(const double l[3], const double v[3], double h[3])
{
    if (!(l[2] > 0 && v[2] > 0)) return 0;
    for (int c = 0; c < 3; c++) h[c] = l[c] + v[c];
    double length = sqrt(dot3(h, h)); /* = 2 l.h for unit l and v */
    for (int c = 0; c < 3; c++) h[c] /= length;
    return length < 2 ? length / 2 : 1;
}

static int no_light(double f_r[3])
{
    f_r[0] = f_r[1] = f_r[2] = 0;
    return 1;
}

static void free_brdf(brdf *b)
{
    free(b);
}

/* Schlick 1994, equation 15. */
static double schlick_fresnel(double f0, double cosine)
{
    double x = 1 - cosine, x2 = x * x;
    return f0 + (1 - f0) * x2 * x2 * x;
}

/* Unpolarised Fresnel reflectance of a lossless dielectric with reflectance f0 at normal incidence, as written by Cook
   and Torrance 1982, section "The Fresnel term". */
static double dielectric_fresnel(double f0, double cosine)
{
    double root = sqrt(f0), index = (1 + root) / (1 - root);
    double g = sqrt(index * index + cosine * cosine - 1);
    double sum = g + cosine, difference = g - cosine;
    return 0.5 * square(difference / sum) * (1 + square((cosine * sum - 1) / (cosine * difference + 1)));
}

/* tan^2 of the angle to the normal, from the vector itself: 1 / z^2 - 1 has no digits left for narrow lobes. */
static double tangent_squared(const double h[3])
{
    return (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2]);
}

/* Trowbridge and Reitz 1975; Walter et al. 2007, equation 33, with t = tan^2 of the polar angle. */
static double ggx_of_tangent(double t, double alpha)
{
    double a2 = alpha * alpha;
    return a2 * square((1 + t) / (a2 + t)) / pi;
}

/* Beckmann and Spizzichino 1963; Walter et al. 2007, equation 25: normalised like the above. */
static double beckmann_of_tangent(double t, double m)
{
    return exp(-t / (m * m)) * square((1 + t) / m) / pi;
}

double ggx_distribution(double n_dot_h, double alpha)
{
    return n_dot_h > 0 ? ggx_of_tangent(1 / square(n_dot_h) - 1, alpha) : 0;
}

double beckmann_distribution(double n_dot_h, double m)
{
    return n_dot_h > 0 ? beckmann_of_tangent(1 / square(n_dot_h) - 1, m) : 0;
}

/* ---- models given by named numbers --------------------------------------------------------------------------------- */

enum { MAX_PARAMETERS = 6 };

typedef struct parameter {
    const char *name;
    int is_rgb; /* may be r/g/b */
    double low, high, initial;
    const char *help;
} parameter;

typedef struct simple_model {
    const char *name, *what;
    int (*eval)(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3]);
    parameter parameters[MAX_PARAMETERS]; /* up to the first without a name */
} simple_model;

typedef struct simple_brdf {
    brdf base;
    double value[MAX_PARAMETERS][3];
} simple_brdf;

/* Lambert 1760: f_r = albedo / pi. */
enum { LAMBERT_ALBEDO };

static int lambert_eval(const brdf *b, const double l[3], const double v[3], double f_r[3])
{
    const simple_brdf *s = (const simple_brdf *)b;
    if (!(l[2] > 0 && v[2] > 0)) return no_light(f_r);
    for (int c = 0; c < 3; c++) f_r[c] = s->value[LAMBERT_ALBEDO][c] / pi;
    return 1;
}

/* Blinn 1977, section "Torrance-Sparrow"'s D1: ks (n.h)^n, here divided by its own integral under normal incidence,
   8 pi (2^(-n/2) + n) / ((n + 2)(n + 4)), so that ks is the specular albedo there. */
enum { BLINN_KD, BLINN_KS, BLINN_N };

static int blinn_phong_eval(const brdf *b, const double l[3], const double v[3], double f_r[3])
{
    const simple_brdf *s = (const simple_brdf *)b;
    double h[3];
    if (half_vector(l, v, h) <= 0) return no_light(f_r);
    double n = s->value[BLINN_N][0];
    double lobe = (n + 2) * (n + 4) / (8 * pi * (exp2(-n / 2) + n)) * exp(-0.5 * n * log1p(tangent_squared(h)));
    for (int c = 0; c < 3; c++) f_r[c] = s->value[BLINN_KD][c] / pi + s->value[BLINN_KS][c] * lobe;
    return 1;
}

/* Ward 1992, equation 5a: kd/pi + ks exp(-tan^2(delta) (cos^2/ax^2 + sin^2/ay^2)) / (4 pi ax ay sqrt(cos cos)). */
enum { WARD_KD, WARD_KS, WARD_AX, WARD_AY };

static int ward_eval(const brdf *b, const double l[3], const double v[3], double f_r[3])
{
    const simple_brdf *s = (const simple_brdf *)b;
    double h[3];
    if (half_vector(l, v, h) <= 0) return no_light(f_r);
    double ax = s->value[WARD_AX][0], ay = s->value[WARD_AY][0];
    double exponent = (square(h[0] / ax) + square(h[1] / ay)) / square(h[2]);
    double lobe = exp(-exponent) / (4 * pi * ax * ay * sqrt(l[2] * v[2]));
    for (int c = 0; c < 3; c++) f_r[c] = s->value[WARD_KD][c] / pi + s->value[WARD_KS][c] * lobe;
    return 1;
}

/* Walter et al. 2007, equation 20, with the distribution of its equation 33, Smith's shadowing with correlated heights
   (Heitz 2014, equation 99) and Schlick's Fresnel term. alpha = rough^2 (Burley 2012, section 5.4). What the interface
   does not reflect reaches the diffuse part: albedo (1 - metal)(1 - F)/pi; metals reflect f0 = albedo. */
enum { GGX_ROUGH, GGX_F0, GGX_ALBEDO, GGX_METAL };

static int ggx_eval(const brdf *b, const double l[3], const double v[3], double f_r[3])
{
    const simple_brdf *s = (const simple_brdf *)b;
    double h[3], cosine = half_vector(l, v, h);
    if (cosine <= 0) return no_light(f_r);
    double alpha = square(s->value[GGX_ROUGH][0]), a2 = alpha * alpha, metal = s->value[GGX_METAL][0];
    double root_l = sqrt(a2 + (1 - a2) * square(l[2])), root_v = sqrt(a2 + (1 - a2) * square(v[2]));
    /* G / (4 n.l n.v) */
    double visibility = 0.5 / (v[2] * root_l + l[2] * root_v);
    double lobe = ggx_of_tangent(tangent_squared(h), alpha) * visibility;
    for (int c = 0; c < 3; c++) {
        double albedo = s->value[GGX_ALBEDO][c];
        double fresnel = schlick_fresnel(s->value[GGX_F0][c] * (1 - metal) + albedo * metal, cosine);
        f_r[c] = fresnel * lobe + (1 - fresnel) * (1 - metal) * albedo / pi;
    }
    return 1;
}

#define KD                                                                                                             \
    {                                                                                                                  \
        "kd", 1, 0, 1, 0, "diffuse albedo"                                                                             \
    }
#define KS                                                                                                             \
    {                                                                                                                  \
        "ks", 1, 0, 100, 0.5, "specular scale"                                                                         \
    }
static const simple_model simple_models[] = {
    {"lambert", "Lambert", lambert_eval, {{"albedo", 1, 0, 1, 0.5, "diffuse albedo"}}},
    {"blinn-phong",
     "Blinn-Phong, normalised",
     blinn_phong_eval,
     {KD, KS, {"n", 0, 0, 1e6, 50, "exponent of the half vector's cosine"}}},
    {"ward",
     "Ward 1992",
     ward_eval,
     {KD,
      KS,
      {"ax", 0, 1e-3, 2, 0.2, "slope along the tangent, and across if ay is not given"},
      {"ay", 0, 1e-3, 2, NAN, "slope across"}}},
    {"ggx",
     "GGX + Smith + Schlick",
     ggx_eval,
     {{"rough", 0, 0.01, 1, 0.5, "perceptual roughness, alpha = rough^2"},
      {"f0", 1, 0, 1, 0.04, "reflectance at normal incidence"},
      {"albedo", 1, 0, 1, 0.5, "diffuse albedo; of a metal, its reflectance"},
      {"metal", 0, 0, 1, 0, "part that is metal"}}},
};
#undef KD
#undef KS

/* ---- Lafortune ------------------------------------------------------------------------------------------------------ */

typedef struct lafortune {
    brdf base;
    double kd[3];
    size_t count;
    lafortune_lobe lobe[];
} lafortune;

/* Lafortune et al. 1997, equation 9: kd/pi + sum of (cx lx vx + cy ly vy + cz lz vz)^n, the sum clamped at 0. */
static int lafortune_eval(const brdf *b, const double l[3], const double v[3], double f_r[3])
{
    const lafortune *m = (const lafortune *)b;
    if (!(l[2] > 0 && v[2] > 0)) return no_light(f_r);
    double x = l[0] * v[0], y = l[1] * v[1], z = l[2] * v[2];
    for (int c = 0; c < 3; c++) {
        f_r[c] = m->kd[c] / pi;
        for (size_t i = 0; i < m->count; i++) {
            const lafortune_lobe *lobe = &m->lobe[i];
            double cosine = lobe->cx[c] * x + lobe->cy[c] * y + lobe->cz[c] * z;
            if (cosine > 0) f_r[c] += lobe->ks[c] * pow(cosine, lobe->n[c]);
        }
    }
    return 1;
}

brdf *lafortune_brdf(const double kd[3], const lafortune_lobe *lobes, size_t count)
{
    lafortune *m = need_memory(1, sizeof *m + count * sizeof *lobes);
    m->base.eval = lafortune_eval;
    m->base.close = free_brdf;
    memcpy(m->kd, kd, sizeof m->kd);
    m->count = count;
    if (count) memcpy(m->lobe, lobes, count * sizeof *lobes);
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) m->base.anisotropic |= lobes[i].cx[c] != lobes[i].cy[c];
    }
    return &m->base;
}

/* ---- Cook-Torrance -------------------------------------------------------------------------------------------------- */

typedef struct cook_torrance {
    brdf base;
    cook_torrance_parameters p;
} cook_torrance;

/* Cook and Torrance 1982, equations 4 (F D G / (n.l n.v)), 5 (Beckmann) and the V-groove shadowing G before them. The
   paper divides by pi; with D normalised to projected area 1 the divisor that follows from energy is 4. */
static int cook_torrance_eval(const brdf *b, const double l[3], const double v[3], double f_r[3])
{
    const cook_torrance_parameters *p = &((const cook_torrance *)b)->p;
    double h[3], cosine = half_vector(l, v, h);
    if (cosine <= 0) return no_light(f_r);
    double shadowing = fmin(1, 2 * h[2] * fmin(l[2], v[2]) / cosine);
    double lobe = beckmann_of_tangent(tangent_squared(h), p->m) * shadowing / (p->divisor * l[2] * v[2]);
    for (int c = 0; c < 3; c++) {
        double fresnel =
            p->fresnel == FRESNEL_SCHLICK ? schlick_fresnel(p->f0[c], cosine) : dielectric_fresnel(p->f0[c], cosine);
        f_r[c] = p->kd[c] / pi + p->ks[c] * fresnel * lobe;
    }
    return 1;
}

brdf *cook_torrance_brdf(const cook_torrance_parameters *p)
{
    cook_torrance *m = need_memory(1, sizeof *m);
    m->base.eval = cook_torrance_eval;
    m->base.close = free_brdf;
    m->p = *p;
    return &m->base;
}

/* ---- shifted gamma distribution ------------------------------------------------------------------------------------- */

typedef struct sgd {
    brdf base;
    sgd_parameters p;
} sgd;

/* Shadowing of one direction at polar angle theta: 1 + lambda (1 - exp(c max(theta - theta0, 0)^k)), an approximation
   fitted to the distribution's own (equation 10). It may dip below 0 right at the horizon. */
static double sgd_shadowing(const sgd_parameters *p, int c, double theta)
{
    double beyond = theta - p->theta0[c];
    if (beyond <= 0) return 1;
    double g = 1 - p->lambda[c] * expm1(p->c[c] * pow(beyond, p->k[c]));
    return g > 0 ? (g < 1 ? g : 1) : 0;
}

/* Bagher, Soler and Holzschuch 2012, equations 2 (kd/pi + ks D F G / (pi n.l n.v)), 9 (D: the shifted gamma
   distribution of tan^2) and the Fresnel term of section 4 (f0 - f1 cos + (1 - f0)(1 - cos)^5). */
static int sgd_eval(const brdf *b, const double l[3], const double v[3], double f_r[3])
{
    const sgd_parameters *p = &((const sgd *)b)->p;
    double h[3], cosine = half_vector(l, v, h);
    if (cosine <= 0) return no_light(f_r);
    double t = tangent_squared(h), theta_l = atan2(sqrt(l[0] * l[0] + l[1] * l[1]), l[2]);
    double theta_v = atan2(sqrt(v[0] * v[0] + v[1] * v[1]), v[2]);
    for (int c = 0; c < 3; c++) {
        double x = p->alpha[c] + t / p->alpha[c];
        double distribution = p->scale[c] * exp(-x) * pow(x, -p->p[c]) * square(1 + t) / pi;
        double fresnel = schlick_fresnel(p->f0[c], cosine) - p->f1[c] * cosine;
        double shadowing = sgd_shadowing(p, c, theta_l) * sgd_shadowing(p, c, theta_v);
        double lobe = distribution * fmax(fresnel, 0) * shadowing / (pi * l[2] * v[2]);
        f_r[c] = p->kd[c] / pi + p->ks[c] * lobe;
    }
    return 1;
}

brdf *sgd_brdf(const sgd_parameters *p)
{
    sgd *m = need_memory(1, sizeof *m);
    m->base.eval = sgd_eval;
    m->base.close = free_brdf;
    m->p = *p;
    return &m->base;
}

/* ---- parameters ------------------------------------------------------------------------------------------------------ */

static const parameter cook_torrance_list[] = {
    {"kd", 1, 0, 1, 0, "diffuse albedo"},
    {"ks", 1, 0, 100, 1, "specular scale"},
    {"f0", 1, 0, 0.999, 0.04, "reflectance at normal incidence"},
    {"m", 0, 1e-3, 2, 0.2, "Beckmann slope"},
};
enum { CT_KD, CT_KS, CT_F0, CT_M, CT_COUNT };

/* cx starts a lobe; what follows belongs to it. */
static const parameter lafortune_list[] = {
    {"kd", 1, 0, 1, 0, "diffuse albedo"},
    {"cx", 1, -100, 100, -1, "starts a lobe: coefficient of x, and of y if cy is not given"},
    {"cy", 1, -100, 100, NAN, "coefficient of y"},
    {"cz", 1, -100, 100, 1, "coefficient of z"},
    {"n", 1, 0, 1e5, 20, "exponent"},
    {"ks", 1, 0, 1e60, 1, "scale"}, /* lobes that grow towards grazing angles: large where the sum never is 1 */
};
enum { LAF_KD, LAF_CX, LAF_CY, LAF_CZ, LAF_N, LAF_KS, LAF_COUNT, MAX_LOBES = 16 };

static size_t parameter_count(const parameter *list, size_t most)
{
    size_t n = 0;
    while (n < most && list[n].name) n++;
    return n;
}

/* The number at *text, up to a '/', ',' or the end; moves *text there. Returns 0 if there is none. */
static int read_number(const char **text, double *value)
{
    char *end;
    if (!**text || strchr(" \t,/", **text)) return 0;
    *value = strtod(*text, &end);
    if (end == *text || !isfinite(*value) || (*end && *end != '/' && *end != ',')) return 0;
    *text = end;
    return 1;
}

static int fail_value(const char *model, const parameter *p, const char *text, failure *f)
{
    return fail(f, FAIL_USAGE, "BRDF %s: parameter %s: found \"%.*s\", expected %s within %g..%g (%s)", model, p->name,
                (int)(strcspn(text, ",") < 60 ? strcspn(text, ",") : 60), text,
                p->is_rgb ? "a number or r/g/b, each" : "a number", p->low, p->high, p->help);
}

/* "v" or "r/g/b" at *text into value; moves *text to the ',' or the end. */
static int read_value(const char *model, const parameter *p, const char **text, double value[3], failure *f)
{
    const char *start = *text;
    int count = 0;
    do {
        if (count) (*text)++;
        if (count == 3 || !read_number(text, &value[count])) return fail_value(model, p, start, f);
        if (!(value[count] >= p->low && value[count] <= p->high)) return fail_value(model, p, start, f);
        count++;
    } while (**text == '/');
    if (count == 2 || (count == 3 && !p->is_rgb)) return fail_value(model, p, start, f);
    if (count == 1) value[1] = value[2] = value[0];
    return 0;
}

static int fail_parameter(const char *model, const parameter *list, size_t count, const char *text, failure *f)
{
    char known[200] = "";
    for (size_t i = 0; i < count; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", list[i].name);
    size_t length = strcspn(text, "=,");
    return fail(f, FAIL_USAGE, "BRDF %s: found parameter \"%.*s\"%s, expected %s", model,
                (int)(length < 60 ? length : 60), text, text[length] == '=' ? "" : " without =VALUE", known);
}

/* The parameter NAME= at *text; moves *text past the '='. NULL: recorded in f. */
static const parameter *read_name(const char *model, const parameter *list, size_t count, const char **text, failure *f)
{
    size_t length = strcspn(*text, "=,");
    for (size_t i = 0; i < count && (*text)[length] == '='; i++) {
        if (strlen(list[i].name) == length && memcmp(list[i].name, *text, length) == 0) {
            *text += length + 1;
            return &list[i];
        }
    }
    fail_parameter(model, list, count, *text, f);
    return NULL;
}

static void set_initial(const parameter *list, size_t count, double (*value)[3])
{
    for (size_t i = 0; i < count; i++) value[i][0] = value[i][1] = value[i][2] = list[i].initial;
}

/* All of "name=value,...", each parameter at most once. */
static int read_parameters(const char *model, const parameter *list, size_t count, const char *text, double (*value)[3],
                           failure *f)
{
    unsigned seen = 0;
    set_initial(list, count, value);
    while (*text) {
        const parameter *p = read_name(model, list, count, &text, f);
        if (!p) return FAIL_USAGE;
        size_t i = (size_t)(p - list);
        if (seen >> i & 1)
            return fail(f, FAIL_USAGE, "BRDF %s: parameter %s: found twice, expected once", model, p->name);
        seen |= 1U << i;
        int code = read_value(model, p, &text, value[i], f);
        if (code) return code;
        if (*text == ',' && !*++text) return fail_parameter(model, list, count, text, f);
    }
    return 0;
}

static int open_simple(brdf **out, const simple_model *model, const char *text, failure *f)
{
    simple_brdf *s = need_memory(1, sizeof *s);
    size_t count = parameter_count(model->parameters, MAX_PARAMETERS);
    int code = read_parameters(model->name, model->parameters, count, text, s->value, f);
    if (code) {
        free(s);
        return code;
    }
    if (model->eval == ward_eval) {
        if (isnan(s->value[WARD_AY][0])) memcpy(s->value[WARD_AY], s->value[WARD_AX], sizeof s->value[WARD_AX]);
        s->base.anisotropic = s->value[WARD_AX][0] != s->value[WARD_AY][0];
    }
    s->base.eval = model->eval;
    s->base.close = free_brdf;
    snprintf(s->base.description, sizeof s->base.description, "%s model, %s", model->what, *text ? text : "defaults");
    *out = &s->base;
    return 0;
}

static int open_cook_torrance(brdf **out, const char *text, failure *f)
{
    double value[CT_COUNT][3];
    int code = read_parameters("cook-torrance", cook_torrance_list, CT_COUNT, text, value, f);
    if (code) return code;
    cook_torrance_parameters p = {.m = value[CT_M][0], .divisor = 4, .fresnel = FRESNEL_DIELECTRIC};
    memcpy(p.kd, value[CT_KD], sizeof p.kd);
    memcpy(p.ks, value[CT_KS], sizeof p.ks);
    memcpy(p.f0, value[CT_F0], sizeof p.f0);
    *out = cook_torrance_brdf(&p);
    snprintf((*out)->description, sizeof(*out)->description, "Cook-Torrance model with Beckmann's distribution, %s",
             *text ? text : "defaults");
    return 0;
}

static double *lobe_field(lafortune_lobe *lobe, size_t parameter_index)
{
    switch (parameter_index) {
    case LAF_CX:
        return lobe->cx;
    case LAF_CY:
        return lobe->cy;
    case LAF_CZ:
        return lobe->cz;
    case LAF_N:
        return lobe->n;
    default:
        return lobe->ks;
    }
}

static void start_lobe(lafortune_lobe *lobe)
{
    for (size_t i = LAF_CX; i < LAF_COUNT; i++) {
        for (int c = 0; c < 3; c++) lobe_field(lobe, i)[c] = lafortune_list[i].initial;
    }
}

static int read_lobes(const char *text, double kd[3], lafortune_lobe *lobes, size_t *count, failure *f)
{
    *count = 0;
    while (*text) {
        const parameter *p = read_name("lafortune", lafortune_list, LAF_COUNT, &text, f);
        if (!p) return FAIL_USAGE;
        size_t i = (size_t)(p - lafortune_list);
        if (i == LAF_CX && *count == MAX_LOBES)
            return fail(f, FAIL_USAGE, "BRDF lafortune: found more than %d lobes (cx), expected at most that",
                        MAX_LOBES);
        if (i == LAF_CX) start_lobe(&lobes[(*count)++]);
        if (i > LAF_CX && !*count)
            return fail(f, FAIL_USAGE, "BRDF lafortune: found parameter %s before cx, expected cx to start a lobe",
                        p->name);
        int code = read_value("lafortune", p, &text, i == LAF_KD ? kd : lobe_field(&lobes[*count - 1], i), f);
        if (code) return code;
        if (*text == ',' && !*++text) return fail_parameter("lafortune", lafortune_list, LAF_COUNT, text, f);
    }
    return 0;
}

static int open_lafortune(brdf **out, const char *text, failure *f)
{
    double kd[3] = {0, 0, 0};
    lafortune_lobe lobes[MAX_LOBES];
    size_t count;
    int code = read_lobes(text, kd, lobes, &count, f);
    if (code) return code;
    for (size_t i = 0; i < count; i++) {
        if (isnan(lobes[i].cy[0])) memcpy(lobes[i].cy, lobes[i].cx, sizeof lobes[i].cx);
    }
    *out = lafortune_brdf(kd, lobes, count);
    snprintf((*out)->description, sizeof(*out)->description, "Lafortune model with %zu lobes, %.200s", count, text);
    return 0;
}

/* ---- registry ---------------------------------------------------------------------------------------------------------- */

enum { SIMPLE_COUNT = sizeof simple_models / sizeof *simple_models };

const char *model_name(size_t index)
{
    static const char *const others[] = {"cook-torrance", "lafortune"};
    if (index < SIMPLE_COUNT) return simple_models[index].name;
    return index < SIMPLE_COUNT + 2 ? others[index - SIMPLE_COUNT] : NULL;
}

const char *model_help(size_t index)
{
    static const char *const help[] = {
        "lambert:albedo=.5  (albedo 0..1)",
        "blinn-phong:kd=0,ks=.5,n=50  (kd 0..1, ks 0..100 albedo at normal incidence, half-vector exponent n 0..1e6)",
        "ward:kd=0,ks=.5,ax=.2,ay=.2  (kd 0..1, ks 0..100, slopes ax, ay .001..2; ay = ax if not given)",
        "ggx:rough=.5,f0=.04,albedo=.5,metal=0  (rough .01..1, alpha = rough^2; f0, albedo, metal 0..1)",
        "cook-torrance:kd=0,ks=1,f0=.04,m=.2  (kd 0..1, ks 0..100, f0 0..0.999, Beckmann slope m .001..2)",
        "lafortune:kd=0,cx=-1,cy=-1,cz=1,n=20,ks=1,cx=...  (each cx starts a lobe; up to 16)",
    };
    return index < sizeof help / sizeof *help ? help[index] : NULL;
}

int model_open(brdf **out, const char *model, const char *parameters, failure *f)
{
    const char *text = parameters ? parameters : "";
    for (size_t i = 0; i < SIMPLE_COUNT; i++) {
        if (strcmp(model, simple_models[i].name) == 0) return open_simple(out, &simple_models[i], text, f);
    }
    if (strcmp(model, "cook-torrance") == 0) return open_cook_torrance(out, text, f);
    if (strcmp(model, "lafortune") == 0) return open_lafortune(out, text, f);
    return fail(f, FAIL_USAGE,
                "BRDF: found model \"%.60s\", expected lambert, blinn-phong, ward, ggx, cook-torrance or"
                " lafortune",
                model);
}
