/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "metric.h"
#include "table_parts.h"

#define PI 3.14159265358979323846

/* Sphere frames: size, and light polar angles (degrees): coarse up to 150, finer where grazing light moves fast. */
#define SPHERE_SIZE   60
#define COARSE_FIRST  1.25
#define COARSE_STEP   2.5
#define COARSE_FRAMES 60
#define FINE_FIRST    150.7
#define FINE_STEP     1.7
#define FINE_FRAMES   18

/* A light at the eye uses the first row alone, which no other frame does: half a frame of its own. */
#define EYE_WEIGHT 0.5

/* A sparse grid over the table, so that texels no frame reaches follow the material where it has values. */
#define GRID_U      48
#define GRID_THETA  28
#define GRID_PHI    5
#define GRID_WEIGHT 0.5

int table_locate(table_point *out, const double to_light[3], const double to_eye[3])
{
    double h[3], squared = 0, l_dot_v = 0;
    if (to_light[2] <= 0 || to_eye[2] <= 0) return 0;
    for (int k = 0; k < 3; k++) {
        h[k] = to_light[k] + to_eye[k];
        squared += h[k] * h[k];
        l_dot_v += to_light[k] * to_eye[k];
    }
    if (l_dot_v < TABLE_MIN_L_DOT_V) return 0;
    double length = sqrt(squared);
    for (int k = 0; k < 3; k++) h[k] /= length;
    out->t = (h[0] * h[0] + h[1] * h[1] + (1 - h[2]) * (1 - h[2])) / 2;
    out->s = sqrt(fmax(0, 1 - length / 2));
    out->a = to_light[2] - to_eye[2];
    out->l_dot_h = length / 2;
    return 1;
}

static int cell(double x, int last, double *fraction)
{
    x = fmin(fmax(x, 0), 1) * last;
    int i = (int)x;
    if (i > last - 1) i = last - 1;
    *fraction = x - i;
    return i;
}

table_footprint table_filter(const table_asset *t, double one_less_n_dot_h, double s)
{
    double u = log2(one_less_n_dot_h / t->eps + 1) / log2(1 / t->eps + 1), v = s + t->rows * (s * s - s), x, y;
    int i = cell(u, t->width - 1, &x), j = cell(v, t->height - 1, &y);
    table_footprint at = {j * t->width + i, {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}};
    return at;
}

/* sqrt(1 - l.h) of a row, by Newton's method on its curve. */
static double row_to_s(const table_asset *t, double v)
{
    double s = v;
    for (int i = 0; i < 8; i++) s -= (s + t->rows * (s * s - s) - v) / fmax(1 + t->rows * (2 * s - 1), 0.05);
    return fmin(fmax(s, 0), 1);
}

/* |a| = 2 sin sin |cos phi_d| of theta_h and theta_d, and at most 2 cos cos where both directions are above the horizon. */
double table_reach(const table_asset *t, int column, int row)
{
    double reach[2];
    for (int side = 0; side < 2; side++) {
        double u = fmin(fmax((column + (side ? 1.0 : -1.0)) / (t->width - 1), 0), 1);
        double v = fmin(fmax((row + (side ? 1.0 : -1.0)) / (t->height - 1), 0), 1);
        double s = row_to_s(t, v), half = 1 - t->eps * (exp2(u * log2(1 / t->eps + 1)) - 1), difference = 1 - s * s;
        reach[side] =
            side ? 2 * sqrt(fmax(0, 1 - half * half) * fmax(0, 1 - difference * difference)) : 2 * half * difference;
    }
    return fmin(fmin(reach[0], reach[1]), 1);
}

void table_bases(double a, double basis[TABLE_BASES])
{
    basis[0] = a * a;
    basis[1] = fabs(a);
    basis[2] = basis[0] * basis[0];
}

/* root^(p/2.4); the default p = 4.8, stored as the nearest 2^-16, is taken as what it stands for. */
static double root24(double root, double power)
{
    double exponent = power / 2.4;
    return fabs(exponent - 2) < 1e-5 ? root * root : pow(root, exponent);
}

double table_show(const table_sample *s, double power, double root, double *slope)
{
    if (root <= 0) {
        *slope = 0;
        return 0;
    }
    double radiance24 = s->factor24 * root24(root, power);
    if (radiance24 > 1) {
        *slope = 0.06 * power / root;
        return 1 + 0.06 * 2.4 * log(radiance24);
    }
    if (radiance24 <= TABLE_TOE_END) {
        double radiance = pow(radiance24, 2.4);
        *slope = 12.92 * radiance * power / root;
        return 12.92 * radiance;
    }
    *slope = 1.055 * radiance24 * power / (2.4 * root);
    return 1.055 * radiance24 - 0.055;
}

static int not_finite(const double to_light[3], const double to_eye[3], const brdf *b, failure *f)
{
    double degree = 180 / PI;
    double azimuth = atan2(to_eye[1], to_eye[0]) - atan2(to_light[1], to_light[0]);
    return fail(
        f, FAIL_INVALID,
        "%s: not a finite number at light polar %.3f, eye polar %.3f, azimuth between them %.3f degrees, expected "
        "f_r in 1/sr",
        b->name, degree * acos(fmin(1, to_light[2])), degree * acos(fmin(1, to_eye[2])),
        fabs(degree * remainder(azimuth, 2 * PI)));
}

/* Append the sample of one pair of directions; nothing where the table or b defines nothing. */
static int add(table_samples *s, const brdf *b, const table_asset *t, const double to_light[3], const double to_eye[3],
               int frame, double weight, failure *f)
{
    const double most = t->layers == 2 ? TABLE_MAX_ROOTED_TWO : TABLE_MAX_ROOTED;
    table_point point;
    double f_r[3];
    if (!table_locate(&point, to_light, to_eye)) return FAIL_NONE;
    if (!b->eval(b, to_light, to_eye, f_r)) return FAIL_NONE;
    table_sample *out = &s->sample[s->count];
    out->at = table_filter(t, point.t, point.s);
    out->t = point.t;
    out->s = point.s;
    table_bases(point.a, out->basis);
    out->factor24 = pow(to_light[2] / point.l_dot_h, 1 / 2.4);
    out->frame = frame;
    out->weight = weight;
    for (int k = 0; k < 3; k++) {
        if (!isfinite(f_r[k])) return not_finite(to_light, to_eye, b, f);
        double rooted = fmin(fmax(PI * t->e * f_r[k] * point.l_dot_h, 0), most);
        out->root[k] = pow(rooted, 1 / t->p);
        out->display[k] = table_show(out, t->p, out->root[k], &out->slope[k]);
    }
    s->count++;
    return FAIL_NONE;
}

static int add_frame(table_samples *s, const brdf *b, const table_asset *t, int frame, double phi_deg, double weight,
                     failure *f)
{
    for (int j = 0; j < SPHERE_SIZE / 2; j++) /* the lower half mirrors the upper */
        for (int i = 0; i < SPHERE_SIZE; i++) {
            double normal[3], to_light[3], to_eye[3];
            if (!metric_normal(i, j, SPHERE_SIZE, normal)) continue;
            metric_local(normal, phi_deg, to_light, to_eye);
            int code = add(s, b, t, to_light, to_eye, frame, weight, f);
            if (code) return code;
        }
    return FAIL_NONE;
}

static int add_grid(table_samples *s, const brdf *b, const table_asset *t, failure *f)
{
    double span = log2(1 / t->eps + 1);
    for (int i = 0; i < GRID_U; i++)
        for (int j = 0; j < GRID_THETA; j++)
            for (int k = 0; k < GRID_PHI; k++) {
                double to_light[3], to_eye[3];
                double cosine = 1 - t->eps * (exp2(span * (i + 0.5) / GRID_U) - 1);
                half_to_directions(acos(fmin(fmax(cosine, 0), 1)), PI / 2 * (j + 0.5) / GRID_THETA,
                                   PI / 2 * k / (GRID_PHI - 1), to_light, to_eye);
                int code = add(s, b, t, to_light, to_eye, -1, GRID_WEIGHT, f);
                if (code) return code;
            }
    return FAIL_NONE;
}

int table_samples_make(table_samples *out, const brdf *b, const table_asset *t, failure *f)
{
    size_t most =
        (size_t)(SPHERE_SIZE * SPHERE_SIZE / 2) * (1 + COARSE_FRAMES + FINE_FRAMES) + GRID_U * GRID_THETA * GRID_PHI;
    table_samples s = {.sample = need_memory(most, sizeof *s.sample)};
    int code = add_frame(&s, b, t, 0, 0, EYE_WEIGHT, f);
    for (int k = 0; k < COARSE_FRAMES && !code; k++)
        code = add_frame(&s, b, t, 1 + k, COARSE_FIRST + COARSE_STEP * k, 1, f);
    for (int k = 0; k < FINE_FRAMES && !code; k++)
        code = add_frame(&s, b, t, 1 + COARSE_FRAMES + k, FINE_FIRST + FINE_STEP * k, 1, f);
    s.frames = s.count;
    if (!code) code = add_grid(&s, b, t, f);
    if (!code && !s.count)
        code =
            fail(f, FAIL_INVALID, "%s: no data for any pair of directions above the horizon, expected some", b->name);
    if (code) {
        table_samples_free(&s);
        return code;
    }
    *out = s;
    return FAIL_NONE;
}

void table_samples_place(table_samples *s, const table_asset *t)
{
    for (size_t i = 0; i < s->count; i++) s->sample[i].at = table_filter(t, s->sample[i].t, s->sample[i].s);
}

int table_samples_regrid(table_samples *s, const brdf *b, const table_asset *t, failure *f)
{
    s->count = s->frames;
    table_samples_place(s, t);
    return add_grid(s, b, t, f);
}

table_samples table_samples_thin(const table_samples *s, int step)
{
    table_samples out = {.sample = need_memory(s->count / (size_t)step + 1, sizeof *out.sample)};
    for (size_t i = 0; i < s->count; i += (size_t)step) out.sample[out.count++] = s->sample[i];
    return out;
}

void table_samples_free(table_samples *s)
{
    free(s->sample);
    *s = (table_samples){0};
}
