/* SPDX-License-Identifier: MIT */
/* The light that a table reflects in all: directional albedos as terms of its least squares. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "table_parts.h"

#define PI 3.14159265358979323846

/* Midpoint rule over half vectors, to one side of the plane of incidence: theta_half = 90 degrees x u^4, as in
   brdf_view_albedo. */
#define HALF     96
#define AZIMUTH  16
#define STEP_DEG 7.5

static double luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; /* Rec. 709 */
}

/* One point of a view, its share of the white sky in *sky, and the BRDF there. 0: no data, or below the horizon. */
static int point_of(table_sky_point *out, const brdf *b, int view, int index, double *sky, double f_cos[3])
{
    double polar = STEP_DEG * view * (PI / 180), to_eye[3] = {sin(polar), 0, cos(polar)}, to_light[3];
    double u = (index / AZIMUTH + 0.5) / HALF, theta = PI / 2 * u * u * u * u;
    double phi = PI * (index % AZIMUTH + 0.5) / AZIMUTH;
    double h[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
    double v_dot_h = to_eye[0] * h[0] + to_eye[2] * h[2];
    table_point at;
    for (int c = 0; c < 3; c++) to_light[c] = 2 * v_dot_h * h[c] - to_eye[c];
    if (v_dot_h <= 0 || !table_locate(&at, to_light, to_eye) || !brdf_eval_cosine(b, to_light, to_eye, f_cos)) return 0;
    *sky = v_dot_h * sin(theta) * u * u * u * to_light[2];
    for (int c = 0; c < 3; c++) f_cos[c] /= to_light[2];
    out->view = view;
    out->t = at.t;
    out->s = at.s;
    table_bases(at.a, out->basis);
    out->weight = *sky / at.l_dot_h;
    return 1;
}

/* The points of a view; their weights add up to its albedo, if it is given to them. */
static void add_view(table_sky *sky, const brdf *b, const table_asset *t, int view)
{
    size_t first = sky->count;
    double total = 0, *albedo = sky->albedo[view];
    for (int i = 0; i < HALF * AZIMUTH; i++) {
        table_sky_point *point = &sky->point[sky->count];
        double f_r[3], share;
        if (!point_of(point, b, view, i, &share, f_r)) continue;
        sky->count++;
        total += share;
        for (int c = 0; c < 3; c++) {
            double value = PI * fmax(f_r[c], 0),
                   rooted = fmin(t->e * value * (1 - point->s * point->s), TABLE_MAX_ROOTED_TWO);
            albedo[c] += value * share;
            sky->most[c] = fmax(sky->most[c], pow(rooted, 1 / t->p));
        }
    }
    for (int c = 0; c < 3 && total > 0; c++) albedo[c] /= total;
    for (size_t i = first; i < sky->count; i++) sky->point[i].weight /= total * t->e;
}

table_sky table_sky_make(const brdf *b, const table_asset *t, double weight)
{
    table_sky sky = {.point = need_memory((size_t)TABLE_SKY_VIEWS * HALF * AZIMUTH, sizeof *sky.point)};
    for (int view = 0; view < TABLE_SKY_VIEWS; view++) {
        add_view(&sky, b, t, view);
        double bright = luminance(sky.albedo[view]);
        sky.scale[view] = bright > 0 ? sqrt(weight) / bright : 0;
    }
    table_sky_place(&sky, t);
    return sky;
}

void table_sky_place(table_sky *sky, const table_asset *t)
{
    for (size_t i = 0; i < sky->count; i++) sky->point[i].at = table_filter(t, sky->point[i].t, sky->point[i].s);
}

void table_sky_free(table_sky *sky)
{
    free(sky->point);
    *sky = (table_sky){0};
}

void table_sky_residuals(const table_problem *p, const double *x, double *pull, double residual[TABLE_SKY_TERMS])
{
    const table_sky *sky = p->sky;
    const table_model *m = p->model;
    double power = m->power;
    for (int k = 0; k < TABLE_SKY_TERMS; k++) residual[k] = sky->scale[k / 3] * sky->albedo[k / 3][k % 3];
    if (pull) memset(pull, 0, (size_t)(p->texels * p->n) * TABLE_SKY_TERMS * sizeof *pull);
    for (size_t i = 0; i < sky->count; i++) {
        const table_sky_point *point = &sky->point[i];
        double root[3];
        int texel[4];
        table_drawn_at(p, &point->at, point->basis, x, root);
        table_corners(&point->at, p->width, texel);
        for (int c = 0; c < 3; c++) {
            if (root[c] <= 0) continue;
            int term = 3 * point->view + c;
            double value = sky->scale[point->view] * point->weight * pow(root[c], power);
            double slope = power * value / root[c];
            residual[term] -= value;
            for (int k = 0; k < 4 && pull; k++) {
                double *to = pull + (size_t)(texel[k] * p->n) * TABLE_SKY_TERMS + term,
                       part = slope * point->at.weight[k];
                to[c * TABLE_SKY_TERMS] += part;
                for (int j = 0; j < m->coefficients; j++)
                    to[(3 + j) * TABLE_SKY_TERMS] +=
                        part * point->basis[m->coefficient[j].kind] * m->coefficient[j].g[c];
            }
        }
    }
}
