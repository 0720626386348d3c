/* SPDX-License-Identifier: MIT */
#include "quarter_fit.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "vec3.h"

static const double pi = 3.14159265358979323846;

/* ---- coordinates ---------------------------------------------------------------------------------- */

double quarter_place(double x)
{
    return log2(8 * fmin(fabs(x), 1) + 1) / log2(9);
}

double quarter_unplace(double place)
{
    return (exp2(place * log2(9)) - 1) / 8;
}

/* l.h = cos(polar / 2) */
double quarter_step(double polar_deg)
{
    return sqrt(2) * sin(polar_deg * pi / 720);
}

int quarter_pair(const double *polar_deg, int layers, double s, double *weight)
{
    int i = 0;
    while (i < layers - 2 && s >= quarter_step(polar_deg[i + 1])) i++;
    double low = quarter_step(polar_deg[i]), high = quarter_step(polar_deg[i + 1]);
    *weight = fmin(fmax((s - low) / (high - low), 0), 1);
    return i;
}

double quarter_polar(int i, int count)
{
    double last = quarter_step(165), v = (0.7 * last + 0.3 * last * last) * i / (count - 1);
    double s = (sqrt(0.49 + 1.2 * v) - 0.7) / 0.6;
    return 720 / pi * asin(s / sqrt(2));
}

/* ---- samples -------------------------------------------------------------------------------------- */

/*
 * A quadrature over the frames of a sphere: for each light angle and each of SUB x SUB places within each texel the pair of
 * directions, weighted by the part of the disc that the place covers. Every texel then has samples, however narrow a peak.
 */
enum { SUB = 2, FINE_SIZE = 64 /* above: one place a texel */, CORNERS = 8 };

/* Light angles (degrees): the eye's own, then steps that suffice to see every image and what lies between. */
static const struct {
    double first, step;
    int count;
    double weight;
} lights[] = {{0, 0, 1, 1}, {1.25, 3.75, 40, 1.5}, {150.7, 2.2, 14, 1.3}};

/* A disc of 80 texels across has so many: weights are then in pixels. */
static const double disc_pixels = 5000;
/* Of a pair that no frame shows much of: what lies at the rim, or the peak's own texels. */
static const double least_weight = 0.002;
static const double least_cosine = 1e-4;
/* Largest pi E f_r l.h kept: 6 stops above white. */
static const double most_kept = 64;

typedef struct sample {
    int first;            /* texel of the lower image */
    float part_x, part_y; /* of the next column and row */
    float part_image;     /* of the next image */
    float weight, light;  /* light: n.l / l.h */
    float root[3], display[3];
} sample;

typedef struct fit {
    const quarter_job *job;
    sample *samples;
    size_t count, room;
    int texels; /* of all images */
} fit;

/* sRGB, above 1 continued by 1 + 0.06 ln so that highlights keep some weight; its slope by the radiance. */
static double display(double radiance, double *slope)
{
    if (radiance <= 0.0031308) {
        *slope = 12.92;
        return 12.92 * fmax(radiance, 0);
    }
    if (radiance > 1) {
        *slope = 0.06 / radiance;
        return 1 + 0.06 * log(radiance);
    }
    double power = pow(radiance, 1 / 2.4);
    *slope = 1.055 * power / (2.4 * radiance);
    return 1.055 * power - 0.055;
}

/* Texel below a place, and how far it is to the next one. */
static int cell(double place, int size, float *part)
{
    double at = place * (size - 1);
    int i = (int)at;
    if (i > size - 2) i = size - 2;
    *part = (float)(at - i);
    return i;
}

/* The direction a of the half vector's frame in the frame of the normal n. */
static void to_normal_frame(const double n[3], const double a[3], double out[3])
{
    int axis = fabs(n[0]) < 0.9 ? 0 : 1;
    double x[3], y[3], length = sqrt(1 - n[axis] * n[axis]);
    for (int k = 0; k < 3; k++) x[k] = ((k == axis) - n[axis] * n[k]) / length;
    cross3(y, n, x);
    out[0] = dot3(a, x);
    out[1] = dot3(a, y);
    out[2] = dot3(a, n);
}

static sample *next_sample(fit *s)
{
    if (s->count == s->room) {
        size_t room = s->room ? 2 * s->room : 1 << 18;
        sample *more = need_memory(room, sizeof *more);
        if (s->count) memcpy(more, s->samples, s->count * sizeof *more);
        free(s->samples);
        s->samples = more;
        s->room = room;
    }
    return &s->samples[s->count++];
}

/* Append the sample of a normal (in the frame of d, h x d and h) under a light at polar phi; nothing where it is not both lit
   and seen, or b holds no data. */
static int add_sample(fit *s, const double n[3], double phi_deg, double weight, failure *f)
{
    const quarter_job *job = s->job;
    double half = phi_deg * pi / 360;
    const double light[3] = {sin(half), 0, cos(half)}, eye[3] = {-sin(half), 0, cos(half)};
    double to_light[3], to_eye[3], f_r[3];
    to_normal_frame(n, light, to_light);
    to_normal_frame(n, eye, to_eye);
    if (to_light[2] < least_cosine || to_eye[2] < least_cosine || !job->b->eval(job->b, to_light, to_eye, f_r))
        return FAIL_NONE;
    sample *out = next_sample(s);
    double part;
    int x = cell(quarter_place(n[0]), job->size, &out->part_x), y = cell(quarter_place(n[1]), job->size, &out->part_y);
    int image = quarter_pair(job->polar_deg, job->layers, quarter_step(phi_deg), &part);
    out->first = (image * job->size + y) * job->size + x;
    out->part_image = (float)part;
    out->weight = (float)(weight * to_eye[2] + least_weight);
    out->light = (float)(to_light[2] / light[2]);
    for (int c = 0; c < 3; c++) {
        if (!isfinite(f_r[c]))
            return fail(f, FAIL_INVALID, "%s: not a finite number at light polar %.3f, eye polar %.3f degrees",
                        job->b->name, acos(to_light[2]) * 180 / pi, acos(to_eye[2]) * 180 / pi);
        double kept = fmin(fmax(pi * job->exposure * f_r[c] * light[2], 0), most_kept), slope;
        out->root[c] = (float)sqrt(sqrt(kept));
        out->display[c] = (float)display(kept * (double)out->light, &slope);
    }
    return FAIL_NONE;
}

/* All lights at one place of the quarter; area: of the disc around the half vector, in pixels. */
static int add_place(fit *s, double x, double y, double area, failure *f)
{
    double z = sqrt(1 - x * x - y * y);
    for (size_t group = 0; group < sizeof lights / sizeof *lights; group++)
        for (int i = 0; i < lights[group].count; i++)
            for (int side = -1; side <= 1; side += 2) {
                const double n[3] = {side * x, y, z};
                double phi = lights[group].first + i * lights[group].step;
                /* on the sphere dx dy / z; as the eye sees it times n.v, in add_sample */
                int code = add_sample(s, n, phi, lights[group].weight * area / z, f);
                if (code) return code;
            }
    return FAIL_NONE;
}

static int gather(fit *s, failure *f)
{
    int sub = s->job->size > FINE_SIZE ? 1 : SUB, side = s->job->size * sub;
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            double u = (i + 0.5) / side, v = (j + 0.5) / side, x = quarter_unplace(u), y = quarter_unplace(v);
            if (x * x + y * y >= 1) continue;
            /* dx/du = ln 9 (x + 1/8) */
            double area = disc_pixels * log(9) * (x + 0.125) * log(9) * (y + 0.125) / ((double)side * side);
            int code = add_place(s, x, y, area, f);
            if (code) return code;
        }
    if (!s->count)
        return fail(f, FAIL_INVALID, "%s: no data for any pair of directions above the horizon, expected some",
                    s->job->b->name);
    return FAIL_NONE;
}

/* ---- least squares, one channel ------------------------------------------------------------------- */

/*
 * Unknowns are roots x of pi E f_r l.h. First the closed form on roots weighted by the display's slope, then Gauss-Newton
 * steps on display values. A texel shares samples with its 26 neighbours only. Second differences within an image and first
 * ones between images hold texels that no sample reaches.
 */
enum { STENCIL = 27, SELF = 13, STEPS = 3, ROUNDS = 150, SWEEPS = 3, SCALES = 8 };
static const double smooth_image = 1e-4, smooth_between = 1e-5; /* per sample and texel */
static const double ridge_first = 1e-7, ridge_step = 1e-4;
static const double slope_floor = 0.01, slope_least = 0.02, slope_most = 3, step_most = 0.5;
static const double scale_step = 0.0625; /* octaves of the root */

typedef struct equations {
    const fit *s;
    float *matrix;           /* STENCIL a texel: neighbour (n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1) in x, y, image */
    double *right, *scratch; /* scratch: 4 a texel */
    double smooth, between;
} equations;

static int neighbour(const fit *s, int n)
{
    int size = s->job->size;
    return ((n / 9 - 1) * size + n / 3 % 3 - 1) * size + n % 3 - 1;
}

/* y += weight D^T D x for second differences along a line of texels. */
static void add_curve(double weight, const double *x, double *y, int count, int step)
{
    for (int i = 0; i + 2 < count; i++, x += step, y += step) {
        double d = weight * (x[0] - 2 * x[step] + x[2 * step]);
        y[0] += d;
        y[step] -= 2 * d;
        y[2 * step] += d;
    }
}

static void add_smoothing(const equations *e, const double *x, double *y)
{
    int size = e->s->job->size, image = size * size;
    for (int line = 0; line < e->s->job->layers * size; line++) {
        int corner = line / size * image + line % size;
        add_curve(e->smooth, x + line * size, y + line * size, size, 1);
        add_curve(e->smooth, x + corner, y + corner, size, size);
    }
    for (int i = 0; i + image < e->s->texels; i++) {
        double d = e->between * (x[i] - x[i + image]);
        y[i] += d;
        y[i + image] -= d;
    }
}

/* Row of the matrix times x. A neighbour that would lie outside has weight 0; the guard keeps the read inside. */
static double row_product(const equations *e, const double *x, int i)
{
    const float *row = e->matrix + (size_t)STENCIL * (size_t)i;
    double sum = 0;
    for (int n = 0; n < STENCIL; n++)
        if (row[n] != 0) sum += (double)row[n] * x[i + neighbour(e->s, n)];
    return sum;
}

static void apply(const equations *e, const double *x, double *y)
{
    for (int i = 0; i < e->s->texels; i++) y[i] = row_product(e, x, i);
    add_smoothing(e, x, y);
}

static void corners_of(const fit *s, const sample *at, int texel[CORNERS], double weight[CORNERS])
{
    int size = s->job->size;
    for (int n = 0; n < CORNERS; n++) {
        double x = n & 1 ? at->part_x : 1 - at->part_x, y = n & 2 ? at->part_y : 1 - at->part_y;
        texel[n] = at->first + (n & 1) + (n >> 1 & 1) * size + (n >> 2) * size * size;
        weight[n] = x * y * (n & 4 ? at->part_image : 1 - at->part_image);
    }
}

static void accumulate(equations *e, const sample *at, const int texel[CORNERS], const double weight[CORNERS],
                       double slope, double residual)
{
    for (int m = 0; m < CORNERS; m++) {
        if (weight[m] == 0) continue;
        double scaled = (double)at->weight * slope * weight[m];
        float *row = e->matrix + (size_t)STENCIL * (size_t)texel[m];
        e->right[texel[m]] += scaled * residual;
        for (int n = 0; n < CORNERS; n++) {
            int to = 9 * ((n >> 2) - (m >> 2) + 1) + 3 * ((n >> 1 & 1) - (m >> 1 & 1) + 1) + (n & 1) - (m & 1) + 1;
            row[to] += (float)(scaled * slope * weight[n]);
        }
    }
}

/* Matrix and right side: of the closed form (first), or of a step from x. */
static void assemble(equations *e, const double *x, int channel, int first)
{
    const fit *s = e->s;
    memset(e->matrix, 0, (size_t)s->texels * STENCIL * sizeof *e->matrix);
    memset(e->right, 0, (size_t)s->texels * sizeof *e->right);
    for (size_t i = 0; i < s->count; i++) {
        const sample *at = &s->samples[i];
        int texel[CORNERS];
        double weight[CORNERS], drawn = 0, slope, root = at->root[channel], light = at->light;
        corners_of(s, at, texel, weight);
        if (first) {
            display(light * root * root * root * root, &slope);
            slope = fmax(slope_floor, slope * light * 4 * root * root * root);
            accumulate(e, at, texel, weight, slope, slope * root);
            continue;
        }
        for (int n = 0; n < CORNERS; n++) drawn += weight[n] * x[texel[n]];
        root = fmax(drawn, 1e-3);
        double shown = display(light * root * root * root * root, &slope);
        slope = fmin(fmax(slope * light * 4 * root * root * root, slope_least), slope_most);
        accumulate(e, at, texel, weight, slope, (double)at->display[channel] - shown);
    }
}

static double product(const double *a, const double *b, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

static double diagonal(const equations *e, int i)
{
    return (double)e->matrix[(size_t)STENCIL * (size_t)i + SELF] + 6 * e->smooth + 2 * e->between;
}

/* Jacobi-preconditioned conjugate gradients from 0; uses up the right side. */
static void solve(equations *e, double *x)
{
    int count = e->s->texels;
    double *r = e->right, *z = e->scratch, *d = z + count, *q = d + count;
    memset(x, 0, (size_t)count * sizeof *x);
    for (int i = 0; i < count; i++) d[i] = z[i] = r[i] / diagonal(e, i);
    double rz = product(r, z, count), stop = 1e-10 * rz;
    for (int round = 0; round < ROUNDS && rz > stop; round++) {
        apply(e, d, q);
        double length = rz / product(d, q, count);
        for (int i = 0; i < count; i++) {
            x[i] += length * d[i];
            r[i] -= length * q[i];
            z[i] = r[i] / diagonal(e, i);
        }
        double next = product(r, z, count);
        for (int i = 0; i < count; i++) d[i] = z[i] + next / rz * d[i];
        rz = next;
    }
}

static void solve_channel(equations *e, double *x, int channel)
{
    int count = e->s->texels;
    double unit = (double)e->s->count / count, most = sqrt(sqrt(most_kept));
    double *change = e->scratch + 3 * count;
    e->smooth = smooth_image * unit;
    e->between = smooth_between * unit;
    for (int step = 0; step <= STEPS; step++) {
        assemble(e, x, channel, step == 0);
        for (int i = 0; i < count; i++)
            e->matrix[(size_t)STENCIL * (size_t)i + SELF] += (float)((step ? ridge_step : ridge_first) * unit);
        if (step) {
            memset(change, 0, (size_t)count * sizeof *change);
            add_smoothing(e, x, change);
            for (int i = 0; i < count; i++) e->right[i] -= change[i];
        }
        solve(e, change);
        for (int i = 0; i < count; i++)
            x[i] = fmin(fmax(x[i] + (step ? fmin(fmax(change[i], -step_most), step_most) : change[i]), 0), most);
        progress_add(e->s->job->progress, 1);
    }
    assemble(e, x, channel, 0); /* the error around the result, for rounding */
}

/* ---- codes ---------------------------------------------------------------------------------------- */

/* Codes k / levels x span nearest to x in the sense of the matrix: texel by texel the step with the least error, given the
   neighbours'. deviation: receives code - x. Returns the error. */
static double round_codes(const equations *e, const double *x, double span, int levels, double *deviation)
{
    int count = e->s->texels;
    for (int i = 0; i < count; i++)
        deviation[i] = fmin(floor(x[i] / span * levels + 0.5), levels) * span / levels - x[i];
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int i = 0; i < count; i++) {
            double own = (double)e->matrix[(size_t)STENCIL * (size_t)i + SELF];
            if (!(own > 0)) continue;
            double wanted = x[i] + deviation[i] - row_product(e, deviation, i) / own;
            deviation[i] = floor(fmin(fmax(wanted / span, 0), 1) * levels + 0.5) * span / levels - x[i];
        }
    double error = 0;
    for (int i = 0; i < count; i++) error += deviation[i] * row_product(e, deviation, i);
    return error;
}

/* Largest root a code can say: small ones give finer steps, but cut peaks. */
static double best_span(const equations *e, const double *x, int levels, double *deviation)
{
    double most = 0, best = 0, least = HUGE_VAL;
    for (int i = 0; i < e->s->texels; i++) most = fmax(most, x[i]);
    for (int i = 0; i < SCALES; i++) {
        double span = most * exp2(-i * scale_step), error = round_codes(e, x, span, levels, deviation);
        if (error >= least) continue;
        least = error;
        best = span;
    }
    return best;
}

/* A q16 above 0, not below x. */
static double stored_q16(double x)
{
    return fmin(fmax(ceil(x * 65536 - 1e-6), 1), 2147483647) / 65536;
}

static void fit_channel(const fit *s, int channel, float *code, double *scale)
{
    const quarter_job *job = s->job;
    size_t count = (size_t)s->texels;
    equations e = {s,
                   need_memory(count, STENCIL * sizeof *e.matrix),
                   need_memory(count, sizeof *e.right),
                   need_memory(count, 4 * sizeof *e.scratch),
                   0,
                   0};
    double *x = need_memory(count, sizeof *x), *deviation = need_memory(count, sizeof *deviation);
    int levels = job->levels[channel], steps = levels ? levels : 255;
    solve_channel(&e, x, channel);
    double span = best_span(&e, x, steps, deviation);
    *scale = stored_q16(span * span * span * span / job->exposure);
    span = sqrt(sqrt(*scale * job->exposure));
    if (levels) round_codes(&e, x, span, levels, deviation);
    for (size_t i = 0; i < count; i++)
        code[3 * i + (size_t)channel] = (float)fmin((x[i] + (levels ? deviation[i] : 0)) / span, 1);
    progress_add(job->progress, 1);
    free(deviation);
    free(x);
    free(e.scratch);
    free(e.right);
    free(e.matrix);
}

int quarter_fit(float *code, double scale[3], const quarter_job *job, failure *f)
{
    fit s = {.job = job, .texels = job->layers * job->size * job->size};
    int result = gather(&s, f);
    progress_begin(job->progress, "steps", 3 * (STEPS + 2));
    if (!result) {
#pragma omp parallel for schedule(static, 1)
        for (int c = 0; c < 3; c++) fit_channel(&s, c, code, &scale[c]);
    }
    progress_end(job->progress);
    free(s.samples);
    return result;
}
