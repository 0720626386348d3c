/* SPDX-License-Identifier: MIT */
/*
 * J. Dupuy and W. Jakob, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering", 2018.
 *
 * Container: "tensor_file\0", version 1.0 in two bytes, u32 number of fields; per field: u16 length and name, u16
 * number of dimensions, u8 type (1 = u8, 10 = float32), u64 offset of the data, u64 size of each dimension. Little-endian.
 *
 * Evaluation (sections 3 and 5), with i the eye's direction, m the half vector and o the light's:
 *   f_r n.o = rgb(s; i) D(m) / (4 sigma(i)),  s = the point of the unit square that the warp of the visible normals takes
 *   to m: the inverse of sampling the piecewise bilinear density vndf(.; i). Tables lie over u = (sqrt(theta 2/pi),
 *   phi/2pi + 1/2), theta along rows; theta_i runs over the slices, which are interpolated linearly.
 * In isotropic files phi of m counts from phi of i.
 */
#include "rgl.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

static const double pi = 3.14159265358979323846;

enum { TYPE_U8 = 1, TYPE_FLOAT = 10, MAX_FIELDS = 64, MAX_DIMENSIONS = 5, MAX_SIDE = 4096 };

/* ---- container --------------------------------------------------------------------------------------------------------- */

typedef struct field {
    char name[32];
    int type, dimensions;
    size_t side[MAX_DIMENSIONS], offset, count; /* count: elements */
} field;

typedef struct tensor_file {
    const char *path;
    const uint8_t *data;
    size_t size, at;
    int count;
    field fields[MAX_FIELDS];
} tensor_file;

static int fail_at(const tensor_file *t, size_t offset, const char *what, failure *f)
{
    return fail(f, FAIL_INVALID, "%s: offset %zu: %s", t->path, offset, what);
}

/* Little-endian number of 1..8 bytes; 0 past the end, which the caller has excluded. */
static uint64_t take(tensor_file *t, int size)
{
    uint64_t value = 0;
    for (int i = 0; i < size; i++) value |= (uint64_t)t->data[t->at++] << 8 * i;
    return value;
}

static int has(const tensor_file *t, size_t size)
{
    return t->size - t->at >= size;
}

/* Bytes of one element; 0 for a type that does not exist. */
static size_t type_size(int type)
{
    static const size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
    return type >= 1 && type <= 11 ? sizes[type] : 0;
}

static int read_shape(tensor_file *t, field *to, failure *f)
{
    size_t start = t->at;
    to->count = 1;
    for (int i = 0; i < to->dimensions; i++) {
        uint64_t side = take(t, 8);
        if (side < 1 || side > t->size || to->count > t->size / side)
            return fail_at(t, start, "found a tensor larger than the file, or empty", f);
        to->side[i] = (size_t)side;
        to->count *= (size_t)side;
    }
    if (to->offset > t->size || to->count > (t->size - to->offset) / type_size(to->type))
        return fail_at(t, start, "found a tensor that reaches beyond the end of the file", f);
    return 0;
}

static int read_field(tensor_file *t, field *to, failure *f)
{
    size_t start = t->at;
    if (!has(t, 2)) return fail_at(t, start, "the file ends within its list of fields", f);
    size_t length = (size_t)take(t, 2);
    if (length < 1 || length >= sizeof to->name)
        return fail_at(t, start, "found a field's name of no or too many letters, expected 1..31", f);
    if (!has(t, length + 11)) return fail_at(t, start, "the file ends within its list of fields", f);
    memcpy(to->name, t->data + t->at, length);
    to->name[length] = '\0';
    t->at += length;
    to->dimensions = (int)take(t, 2);
    to->type = (int)take(t, 1);
    uint64_t offset = take(t, 8);
    if (to->dimensions < 1 || to->dimensions > MAX_DIMENSIONS)
        return fail_at(t, start, "found a tensor of too many dimensions, expected 1..5", f);
    if (!type_size(to->type)) return fail_at(t, start, "found an unknown element type, expected 1..11", f);
    if (!has(t, 8 * (size_t)to->dimensions)) return fail_at(t, start, "the file ends within its list of fields", f);
    to->offset = offset < t->size ? (size_t)offset : t->size;
    return read_shape(t, to, f);
}

static int read_fields(tensor_file *t, failure *f)
{
    if (t->size < 18 || memcmp(t->data, "tensor_file\0", 12) != 0)
        return fail_at(t, 0, "found no tensor file, expected \"tensor_file\"", f);
    if (t->data[12] != 1 || t->data[13] != 0)
        return fail(f, FAIL_UNSUPPORTED, "%s: offset 12: found version %d.%d, expected 1.0", t->path, t->data[12],
                    t->data[13]);
    t->at = 14;
    uint64_t count = take(t, 4);
    if (count < 1 || count > MAX_FIELDS) return fail_at(t, 14, "found no or too many fields, expected 1..64", f);
    for (t->count = 0; t->count < (int)count; t->count++) {
        int code = read_field(t, &t->fields[t->count], f);
        if (code) return code;
    }
    return 0;
}

static const field *find_field(const tensor_file *t, const char *name)
{
    for (int i = 0; i < t->count; i++) {
        if (strcmp(t->fields[i].name, name) == 0) return &t->fields[i];
    }
    return NULL;
}

/* The field of that name, type and number of dimensions; NULL: recorded in f. */
static const field *need_field(const tensor_file *t, const char *name, int type, int dimensions, failure *f)
{
    const field *found = find_field(t, name);
    if (!found) {
        fail(f, FAIL_INVALID, "%s: found no field \"%s\"", t->path, name);
    } else if (found->type != type || found->dimensions != dimensions) {
        fail(f, FAIL_INVALID, "%s: field \"%s\": found type %d, %d dimensions, expected type %d, %d dimensions",
             t->path, name, found->type, found->dimensions, type, dimensions);
        found = NULL;
    }
    return found;
}

/* Element i of a float field. */
static float element(const tensor_file *t, const field *from, size_t i)
{
    const uint8_t *p = t->data + from->offset + 4 * i;
    uint32_t bits = p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* All elements of a float field, finite, at least low; NULL: recorded in f. */
static float *load(const tensor_file *t, const field *from, double low, failure *f)
{
    float *out = need_memory(from->count, sizeof *out);
    for (size_t i = 0; i < from->count; i++) {
        out[i] = element(t, from, i);
        if (!(isfinite(out[i]) && out[i] >= low)) {
            fail(f, FAIL_INVALID, "%s: offset %zu: field \"%s\": found %g, expected a finite number from %g", t->path,
                 from->offset + 4 * i, from->name, (double)out[i], low);
            free(out);
            return NULL;
        }
    }
    return out;
}

/* ---- tables ------------------------------------------------------------------------------------------------------------ */

/* Slices of height x width samples; the first and last of each axis lie at 0 and 1. */
typedef struct grid {
    size_t width, height;
    float *value;
} grid;

/* Where a point lies between four samples. */
typedef struct cell {
    size_t x, y;
    double fx, fy;
} cell;

static cell locate(const grid *g, double x, double y)
{
    double sx = fmin(fmax(x, 0), 1) * (double)(g->width - 1), sy = fmin(fmax(y, 0), 1) * (double)(g->height - 1);
    cell c = {(size_t)sx, (size_t)sy, 0, 0};
    c.x = c.x < g->width - 2 ? c.x : g->width - 2;
    c.y = c.y < g->height - 2 ? c.y : g->height - 2;
    c.fx = sx - (double)c.x;
    c.fy = sy - (double)c.y;
    return c;
}

static double bilinear(const grid *g, size_t slice, cell at)
{
    const float *v = g->value + (slice * g->height + at.y) * g->width + at.x;
    double low = (1 - at.fx) * (double)v[0] + at.fx * (double)v[1];
    double high = (1 - at.fx) * (double)v[g->width] + at.fx * (double)v[g->width + 1];
    return (1 - at.fy) * low + at.fy * high;
}

/* Slices of the incident direction: up to two of phi times two of theta, with weights. */
typedef struct slices {
    size_t index[4];
    double weight[4];
} slices;

typedef struct rgl {
    brdf base;
    size_t phi_count, theta_count;
    float *phi_i, *theta_i;
    grid ndf, sigma, vndf, rgb; /* rgb: slice = direction x 3 + channel */
    double *along;              /* integral of vndf along each row up to each sample, of a slice with integral 1 */
    double *across;             /* integral of whole rows up to each row */
} rgl;

static void find_interval(const float *node, size_t count, double value, size_t index[2], double *weight)
{
    size_t i = 0;
    while (i + 2 < count && (double)node[i + 1] <= value) i++;
    size_t next = i + 1 < count ? i + 1 : i;
    double span = (double)node[next] - (double)node[i];
    *weight = span > 0 ? fmin(fmax((value - (double)node[i]) / span, 0), 1) : 0;
    index[0] = i;
    index[1] = next;
}

static slices find_slices(const rgl *m, double phi, double theta)
{
    size_t p[2], t[2];
    double wp, wt;
    find_interval(m->phi_i, m->phi_count, phi, p, &wp);
    find_interval(m->theta_i, m->theta_count, theta, t, &wt);
    slices s;
    for (int i = 0; i < 4; i++) {
        s.index[i] = p[i >> 1] * m->theta_count + t[i & 1];
        s.weight[i] = (i >> 1 ? wp : 1 - wp) * (i & 1 ? wt : 1 - wt);
    }
    return s;
}

/* Integrals of the bilinear density, and the density scaled to integral 1, slice by slice. */
static int make_warp(rgl *m, const tensor_file *t, failure *f)
{
    size_t width = m->vndf.width, height = m->vndf.height, count = m->phi_count * m->theta_count;
    m->along = need_memory(count * width * height, sizeof *m->along);
    m->across = need_memory(count * height, sizeof *m->across);
    for (size_t s = 0; s < count; s++) {
        float *v = m->vndf.value + s * width * height;
        double *along = m->along + s * width * height, *across = m->across + s * height;
        for (size_t y = 0; y < height; y++) {
            for (size_t x = 1; x < width; x++)
                along[y * width + x] =
                    along[y * width + x - 1] + 0.5 * ((double)v[y * width + x - 1] + (double)v[y * width + x]);
            if (y) across[y] = across[y - 1] + 0.5 * (along[y * width - 1] + along[(y + 1) * width - 1]);
        }
        double total = across[height - 1];
        if (!(total > 0)) return fail(f, FAIL_INVALID, "%s: field \"vndf\": slice %zu: found zeros only", t->path, s);
        for (size_t i = 0; i < width * height; i++) {
            v[i] = (float)((double)v[i] / total);
            along[i] /= total;
        }
        for (size_t y = 0; y < height; y++) across[y] /= total;
    }
    return 0;
}

/* The warp's inverse: from u of the half vector to the unit square, uniform in both. */
static void invert_warp(const rgl *m, const slices *s, double ux, double uy, double *x, double *y)
{
    cell at = locate(&m->vndf, ux, uy);
    size_t width = m->vndf.width, height = m->vndf.height;
    double left = 0, right = 0, below = 0, row[2] = {0, 0}, above = 0;
    for (int i = 0; i < 4; i++) {
        const float *v = m->vndf.value + (s->index[i] * height + at.y) * width + at.x;
        const double *along = m->along + (s->index[i] * height + at.y) * width;
        double w = s->weight[i];
        left += w * ((1 - at.fy) * (double)v[0] + at.fy * (double)v[width]);
        right += w * ((1 - at.fy) * (double)v[1] + at.fy * (double)v[width + 1]);
        below += w * ((1 - at.fy) * along[at.x] + at.fy * along[width + at.x]);
        row[0] += w * along[width - 1];
        row[1] += w * along[2 * width - 1];
        above += w * m->across[s->index[i] * height + at.y];
    }
    double whole = (1 - at.fy) * row[0] + at.fy * row[1];
    *x = whole > 0 ? (below + at.fx * (left + 0.5 * at.fx * (right - left))) / whole : 0;
    *y = above + at.fy * (row[0] + 0.5 * at.fy * (row[1] - row[0]));
}

/* ---- evaluation ---------------------------------------------------------------------------------------------------------- */

static double polar_angle(const double d[3])
{
    return atan2(sqrt(d[0] * d[0] + d[1] * d[1]), d[2]);
}

static int rgl_eval_cosine(const brdf *b, const double to_light[3], const double to_eye[3], double out[3])
{
    const rgl *m = (const rgl *)b;
    out[0] = out[1] = out[2] = 0;
    if (!(to_light[2] > 0 && to_eye[2] > 0)) return 0;
    double half[3] = {to_light[0] + to_eye[0], to_light[1] + to_eye[1], to_light[2] + to_eye[2]};
    double theta_i = polar_angle(to_eye), phi_i = atan2(to_eye[1], to_eye[0]);
    double turn = (atan2(half[1], half[0]) - phi_i) / (2 * pi) + 0.5;
    double ux = sqrt(polar_angle(half) * (2 / pi)), uy = turn - floor(turn);
    slices s = find_slices(m, phi_i, theta_i);
    double x, y;
    invert_warp(m, &s, ux, uy, &x, &y);
    double sigma = bilinear(&m->sigma, 0, locate(&m->sigma, sqrt(theta_i * (2 / pi)), phi_i / (2 * pi) + 0.5));
    if (!(sigma > 0)) return 0;
    double scale = bilinear(&m->ndf, 0, locate(&m->ndf, ux, uy)) / (4 * sigma);
    cell at = locate(&m->rgb, x, y);
    for (size_t c = 0; c < 3; c++) {
        double value = 0;
        for (int i = 0; i < 4; i++) value += s.weight[i] * bilinear(&m->rgb, 3 * s.index[i] + c, at);
        out[c] = fmax(value * scale, 0);
    }
    return 1;
}

static int rgl_eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    int valid = rgl_eval_cosine(b, to_light, to_eye, f_r);
    for (int c = 0; valid && c < 3; c++) f_r[c] /= to_light[2];
    return valid;
}

static void rgl_close(brdf *b)
{
    rgl *m = (rgl *)b;
    free(m->phi_i);
    free(m->theta_i);
    free(m->ndf.value);
    free(m->sigma.value);
    free(m->vndf.value);
    free(m->rgb.value);
    free(m->along);
    free(m->across);
    free(m);
}

/* ---- opening ------------------------------------------------------------------------------------------------------------- */

/* A rising list of angles. */
static float *load_angles(const tensor_file *t, const char *name, size_t *count, failure *f)
{
    const field *from = need_field(t, name, TYPE_FLOAT, 1, f);
    float *out = from ? load(t, from, -7, f) : NULL;
    for (size_t i = 1; out && i < from->count; i++) {
        if (!(out[i] > out[i - 1])) {
            fail(f, FAIL_INVALID, "%s: offset %zu: field \"%s\": found %g after %g, expected rising angles", t->path,
                 from->offset + 4 * i, name, (double)out[i], (double)out[i - 1]);
            free(out);
            out = NULL;
        }
    }
    *count = out ? from->count : 0;
    return out;
}

/* A field's last two dimensions as a grid; those before must be lead[0..dimensions - 3]. */
static int load_grid(grid *g, const tensor_file *t, const char *name, const size_t *lead, int lead_count, double low,
                     failure *f)
{
    const field *from = need_field(t, name, TYPE_FLOAT, lead_count + 2, f);
    if (!from) return FAIL_INVALID;
    for (int i = 0; i < lead_count; i++) {
        if (from->side[i] != lead[i])
            return fail(f, FAIL_INVALID, "%s: field \"%s\": found size %zu of dimension %d, expected %zu", t->path,
                        name, from->side[i], i, lead[i]);
    }
    g->height = from->side[lead_count];
    g->width = from->side[lead_count + 1];
    if (g->width < 2 || g->height < 2 || g->width > MAX_SIDE || g->height > MAX_SIDE)
        return fail(f, FAIL_INVALID, "%s: field \"%s\": found %zu x %zu samples, expected 2..4096 each", t->path, name,
                    g->height, g->width);
    g->value = load(t, from, low, f);
    return g->value ? 0 : FAIL_INVALID;
}

static int load_all(rgl *m, const tensor_file *t, failure *f)
{
    m->phi_i = load_angles(t, "phi_i", &m->phi_count, f);
    m->theta_i = m->phi_i ? load_angles(t, "theta_i", &m->theta_count, f) : NULL;
    if (!m->theta_i) return FAIL_INVALID;
    if (m->phi_count > 2)
        return fail(f, FAIL_UNSUPPORTED,
                    "%s: field \"phi_i\": found %zu azimuths: an anisotropic material, expected 1 or 2", t->path,
                    m->phi_count);
    if (!find_field(t, "rgb") && find_field(t, "spectra"))
        return fail(f, FAIL_UNSUPPORTED, "%s: found a spectral file, expected one with a field \"rgb\"", t->path);
    const field *jacobian = need_field(t, "jacobian", TYPE_U8, 1, f);
    if (!jacobian) return FAIL_INVALID;
    if (t->data[jacobian->offset] != 1)
        return fail(f, FAIL_UNSUPPORTED, "%s: offset %zu: field \"jacobian\": found %d, expected 1", t->path,
                    jacobian->offset, t->data[jacobian->offset]);
    size_t lead[3] = {m->phi_count, m->theta_count, 3};
    int code = load_grid(&m->ndf, t, "ndf", lead, 0, 0, f);
    if (!code) code = load_grid(&m->sigma, t, "sigma", lead, 0, 0, f);
    if (!code) code = load_grid(&m->vndf, t, "vndf", lead, 2, 0, f);
    if (!code) code = load_grid(&m->rgb, t, "rgb", lead, 3, -1e30, f);
    return code ? code : make_warp(m, t, f);
}

static void describe(rgl *m, const tensor_file *t)
{
    const field *text = find_field(t, "description");
    int length = text && text->type == TYPE_U8 && text->count < 100 ? (int)text->count : 0;
    snprintf(m->base.description, sizeof m->base.description,
             "measured, RGL adaptive parameterization, %zu x %zu x %zu: "
             "%.*s",
             m->theta_count, m->rgb.height, m->rgb.width, length, text ? (const char *)t->data + text->offset : "");
    for (char *c = m->base.description; *c; c++) *c = *c < ' ' || *c > '~' ? ' ' : *c;
}

int rgl_open(brdf **out, const char *path, failure *f)
{
    bytes file = {0};
    int code = file_read(&file, path, f);
    if (code) return code;
    tensor_file *t = need_memory(1, sizeof *t);
    t->path = path;
    t->data = file.data;
    t->size = file.size;
    code = read_fields(t, f);
    rgl *m = need_memory(1, sizeof *m);
    m->base.eval = rgl_eval;
    m->base.eval_cosine = rgl_eval_cosine;
    m->base.close = rgl_close;
    if (!code) code = load_all(m, t, f);
    if (code) {
        rgl_close(&m->base);
    } else {
        describe(m, t);
        *out = &m->base;
    }
    free(t);
    bytes_free(&file);
    return code;
}
