/* SPDX-License-Identifier: MIT */
#include "light_bake.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "vec3.h"

#define PI 3.14159265358979323846

/* Maps are cut along the borders of at most so many cells a row: 0.7 degrees. Inside them every texel counts. */
enum { MOST_COLUMNS = 512, MOST_ROUNDS = 40 };

typedef struct moments {
    double y, vector[3]; /* by luminance: sum of irradiance, and x direction */
} moments;

typedef struct cell {
    moments m;
    double channel[3]; /* irradiance R G B */
} cell;

typedef struct grid {
    int width, height;
    cell *cells;
    moments *sum; /* (width + 1) x (height + 1): all cells above and left */
} grid;

typedef struct part { /* cells x0..x1-1, y0..y1-1 */
    int x0, y0, x1, y1;
    double priority; /* what is cut next: the largest */
    int cut_axis, cut_at;
} part;

/* ---- measuring --------------------------------------------------------------------------------------------------- */

/* Integrals of the unit vector over texel (i, row), exact: the solid angle x the mean direction. */
static void texel_vector(const env_map *map, int i, int row, double out[3])
{
    const double step = PI / map->height, top = PI / 2 - row * step, bottom = top - step;
    const double ring = ((top - bottom) + (sin(2 * top) - sin(2 * bottom)) / 2) / 2; /* integral of cos^2 latitude */
    const double left = 2 * PI * ((double)i / map->width - 0.5), right = left + 2 * PI / map->width;

    out[0] = ring * (cos(left) - cos(right));
    out[1] = (sin(top) * sin(top) - sin(bottom) * sin(bottom)) / 2 * (right - left);
    out[2] = -ring * (sin(right) - sin(left));
}

void light_measure(light_figures *out, const env_map *map, double scale)
{
    int i, j, c, k;

    *out = (light_figures){0};
    for (j = 0; j < map->height; j++)
        for (i = 0; i < map->width; i++) {
            const float *texel = map->texel + 3 * ((size_t)j * (size_t)map->width + (size_t)i);
            double v[3];
            texel_vector(map, i, j, v);
            for (c = 0; c < 3; c++) {
                const double radiance = scale * texel[c];
                out->total[c] += radiance * env_map_solid_angle(map, j);
                for (k = 0; k < 3; k++) out->vector[c][k] += radiance * v[k];
                out->most = fmax(out->most, radiance);
            }
        }
}

static void add_moments(moments *to, const moments *m, double sign)
{
    int k;

    to->y += sign * m->y;
    for (k = 0; k < 3; k++) to->vector[k] += sign * m->vector[k];
}

static void add_texel(cell *to, const env_map *map, int i, int j, double scale)
{
    const float *texel = map->texel + 3 * ((size_t)j * (size_t)map->width + (size_t)i);
    const double radiance[3] = {scale * texel[0], scale * texel[1], scale * texel[2]};
    const double luminance = env_luminance(radiance);
    const double solid_angle = env_map_solid_angle(map, j);
    double v[3];
    int k;

    texel_vector(map, i, j, v);
    to->m.y += luminance * solid_angle;
    for (k = 0; k < 3; k++) {
        to->m.vector[k] += luminance * v[k];
        to->channel[k] += radiance[k] * solid_angle;
    }
}

static grid make_grid(const env_map *map, double scale)
{
    const int block = (map->width + MOST_COLUMNS - 1) / MOST_COLUMNS;
    grid g = {.width = (map->width + block - 1) / block, .height = (map->height + block - 1) / block};
    const size_t count = (size_t)g.width * (size_t)g.height, pitch = (size_t)g.width + 1;
    int i, j;

    g.cells = need_memory(count, sizeof *g.cells);
    g.sum = need_memory(pitch * ((size_t)g.height + 1), sizeof *g.sum);
    memset(g.cells, 0, count * sizeof *g.cells);
    memset(g.sum, 0, pitch * ((size_t)g.height + 1) * sizeof *g.sum);
    for (j = 0; j < map->height; j++)
        for (i = 0; i < map->width; i++) add_texel(&g.cells[j / block * g.width + i / block], map, i, j, scale);
    for (j = 0; j < g.height; j++)
        for (i = 0; i < g.width; i++) {
            moments *to = &g.sum[(size_t)(j + 1) * pitch + (size_t)i + 1];
            *to = g.cells[j * g.width + i].m;
            add_moments(to, to - 1, 1);
            add_moments(to, to - pitch, 1);
            add_moments(to, to - pitch - 1, -1);
        }
    return g;
}

static moments inside(const grid *g, int x0, int y0, int x1, int y1)
{
    const size_t pitch = (size_t)g->width + 1;
    moments m = g->sum[(size_t)y1 * pitch + (size_t)x1];

    add_moments(&m, &g->sum[(size_t)y0 * pitch + (size_t)x1], -1);
    add_moments(&m, &g->sum[(size_t)y1 * pitch + (size_t)x0], -1);
    add_moments(&m, &g->sum[(size_t)y0 * pitch + (size_t)x0], 1);
    return m;
}

/* Sum of irradiance x squared distance from the mean: y - |vector|^2 / y, as directions have length 1. */
static double spread(const moments *m)
{
    return m->y > 0 ? fmax(0, m->y - dot3(m->vector, m->vector) / m->y) : 0;
}

/* ---- cutting ----------------------------------------------------------------------------------------------------- */

static moments half_of(const grid *g, const part *p, int axis, int at, int second)
{
    return axis ? inside(g, p->x0, second ? at : p->y0, p->x1, second ? p->y1 : at)
                : inside(g, second ? at : p->x0, p->y0, second ? p->x1 : at, p->y1);
}

/* Where the spread of both halves together is least. */
static void plan_variance_cut(const grid *g, part *p)
{
    const moments all = inside(g, p->x0, p->y0, p->x1, p->y1);
    double least = HUGE_VAL;
    int axis, at;

    p->cut_at = -1;
    p->priority = spread(&all);
    for (axis = 0; axis < 2; axis++)
        for (at = (axis ? p->y0 : p->x0) + 1; at < (axis ? p->y1 : p->x1); at++) {
            const moments a = half_of(g, p, axis, at, 0), b = half_of(g, p, axis, at, 1);
            const double both = spread(&a) + spread(&b);
            if (both >= least || !(a.y > 0 && b.y > 0)) continue;
            least = both;
            p->cut_axis = axis;
            p->cut_at = at;
        }
}

/* The longer side, as the part is seen on the sphere, into halves of equal energy. */
static void plan_median_cut(const grid *g, part *p)
{
    const moments all = inside(g, p->x0, p->y0, p->x1, p->y1);
    const double latitude = PI * ((p->y0 + p->y1) / 2.0 / g->height - 0.5);
    double least = HUGE_VAL;
    int axis = p->y1 - p->y0 > (p->x1 - p->x0) * cos(latitude), at, turn;

    p->cut_at = -1;
    p->priority = all.y;
    for (turn = 0; turn < 2 && p->cut_at < 0; turn++, axis = !axis)
        for (at = (axis ? p->y0 : p->x0) + 1; at < (axis ? p->y1 : p->x1); at++) {
            const moments a = half_of(g, p, axis, at, 0);
            const double off = fabs(a.y - all.y / 2);
            if (off >= least || !(a.y > 0 && all.y - a.y > 0)) continue;
            least = off;
            p->cut_axis = axis;
            p->cut_at = at;
        }
}

static void plan(const grid *g, part *p, light_method method)
{
    if (method == LIGHT_MEDIAN_CUT)
        plan_median_cut(g, p);
    else
        plan_variance_cut(g, p);
    if (p->cut_at < 0) p->priority = -1;
}

static int cut_into_parts(const grid *g, part *parts, int count, light_method method)
{
    int made = 1, i;

    parts[0] = (part){0, 0, g->width, g->height, 0, 0, 0};
    plan(g, &parts[0], method);
    while (made < count) {
        part *next = parts, *other = &parts[made];
        for (i = 1; i < made; i++)
            if (parts[i].priority > next->priority) next = &parts[i];
        if (next->priority < 0) break;
        *other = *next;
        if (next->cut_axis)
            next->y1 = other->y0 = next->cut_at;
        else
            next->x1 = other->x0 = next->cut_at;
        plan(g, next, method);
        plan(g, other, method);
        made++;
    }
    return made;
}

/* ---- Lloyd's iteration: cells go to the nearest light, lights to the mean of their cells ---------------------------- */

/* Directions move to their parts' means. */
static void to_means(const grid *g, const int *owner, double (*direction)[3], int count)
{
    const int cells = g->width * g->height;
    double(*mean)[3] = need_memory((size_t)count, sizeof *mean);
    int i, k;

    memset(mean, 0, (size_t)count * sizeof *mean);
    for (i = 0; i < cells; i++)
        for (k = 0; k < 3; k++) mean[owner[i]][k] += g->cells[i].m.vector[k];
    for (i = 0; i < count; i++)
        if (normalise3(mean[i]) > 0) memcpy(direction[i], mean[i], sizeof mean[i]);
    free(mean);
}

/* Returns how many cells have changed their light. */
static int to_nearest(const grid *g, int *owner, double (*direction)[3], int count)
{
    const int cells = g->width * g->height;
    int changed = 0, i;

#pragma omp parallel for schedule(dynamic, 64) reduction(+ : changed)
    for (i = 0; i < cells; i++) {
        const double *v = g->cells[i].m.vector;
        int best = owner[i], n;
        double nearest = dot3(v, direction[best]);
        if (!(g->cells[i].m.y > 0)) continue;
        for (n = 0; n < count; n++) {
            const double along = dot3(v, direction[n]);
            if (along > nearest) {
                nearest = along;
                best = n;
            }
        }
        changed += best != owner[i];
        owner[i] = best;
    }
    return changed;
}

static void relax(const grid *g, int *owner, double (*direction)[3], int count, progress *meter)
{
    int round;

    progress_begin(meter, "rounds", MOST_ROUNDS);
    for (round = 0; round < MOST_ROUNDS; round++) {
        if (!to_nearest(g, owner, direction, count)) break;
        to_means(g, owner, direction, count);
        progress_add(meter, 1);
    }
    progress_end(meter);
}

/* ---- lights ------------------------------------------------------------------------------------------------------ */

/* What is to be conserved, per channel: sums of irradiance, and of irradiance x direction. */
enum { TERMS = 4 };

static void terms(const double direction[3], double out[TERMS])
{
    out[0] = 1;
    memcpy(out + 1, direction, 3 * sizeof *direction);
}

/* Solve a x = b of n unknowns by elimination, a symmetric and not negative; 0 if it is as good as singular. */
static int solve(double a[TERMS][TERMS], double b[TERMS], int n)
{
    const double size = a[0][0];
    int i, j, k;

    for (i = 0; i < n; i++) {
        if (!(a[i][i] > 1e-7 * size)) return 0;
        for (j = i + 1; j < n; j++) {
            const double factor = a[j][i] / a[i][i];
            for (k = i; k < n; k++) a[j][k] -= factor * a[i][k];
            b[j] -= factor * b[i];
        }
    }
    for (i = n - 1; i >= 0; i--) {
        for (k = i + 1; k < n; k++) b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    return 1;
}

/* The least relative change of one channel's irradiances (in the mean square, weighted by irradiance) after which their
   sums x the first n terms are as wanted. 0, and no change, where there is none or a light would change by more than
   half. */
static int correct_channel(light_set *set, int channel, const double wanted[TERMS], int n)
{
    double a[TERMS][TERMS] = {{0}}, t[TERMS], term[TERMS];
    double *factor = need_memory((size_t)set->count, sizeof *factor), most = 0;
    int i, j, k, valid;

    memcpy(t, wanted, sizeof t);
    for (k = 0; k < set->count; k++) {
        const double irradiance = set->light[k].irradiance[channel];
        terms(set->light[k].direction, term);
        for (i = 0; i < n; i++) {
            t[i] -= irradiance * term[i];
            for (j = 0; j < n; j++) a[i][j] += irradiance * term[i] * term[j];
        }
    }
    valid = solve(a, t, n);
    for (k = 0; k < set->count && valid; k++) {
        terms(set->light[k].direction, term);
        for (factor[k] = 1, i = 0; i < n; i++) factor[k] += t[i] * term[i];
        most = fmax(most, fabs(factor[k] - 1));
    }
    valid = valid && most <= 0.5;
    for (k = 0; k < set->count && valid; k++) set->light[k].irradiance[channel] *= factor[k];
    free(factor);
    return valid;
}

static void correct(light_set *set, const light_figures *map)
{
    int c;

    for (c = 0; c < 3; c++) {
        double wanted[TERMS];
        wanted[0] = map->total[c];
        memcpy(wanted + 1, map->vector[c], sizeof map->vector[c]);
        if (!correct_channel(set, c, wanted, TERMS)) correct_channel(set, c, wanted, 1);
    }
}

static int compare_lights(const void *a, const void *b)
{
    const double x = env_luminance(((const distant_light *)a)->irradiance);
    const double y = env_luminance(((const distant_light *)b)->irradiance);

    return (x < y) - (x > y);
}

static void make_lights(light_set *out, const grid *g, const int *owner, double (*direction)[3], int count)
{
    const int cells = g->width * g->height;
    double(*irradiance)[3] = need_memory((size_t)count, sizeof *irradiance);
    int i, c, k;

    memset(irradiance, 0, (size_t)count * sizeof *irradiance);
    to_means(g, owner, direction, count);
    for (i = 0; i < cells; i++)
        for (c = 0; c < 3; c++) irradiance[owner[i]][c] += g->cells[i].channel[c];
    for (i = 0; i < count; i++) {
        distant_light light;
        for (k = 0; k < 3; k++) {
            light.direction[k] = direction[i][k];
            light.irradiance[k] = fmax(0, irradiance[i][k]);
        }
        if (env_luminance(light.irradiance) > 0) light_set_add(out, &light);
    }
    free(irradiance);
}

static void bake_grid(light_set *out, const grid *g, const light_options *o, int count)
{
    part *parts = need_memory((size_t)count, sizeof *parts);
    double(*direction)[3] = need_memory((size_t)count, sizeof *direction);
    int *owner = need_memory((size_t)g->width * (size_t)g->height, sizeof *owner);
    int made = cut_into_parts(g, parts, count, o->method), i, x, y;

    for (i = 0; i < made; i++) {
        const part *p = &parts[i];
        direction[i][0] = direction[i][1] = 0;
        direction[i][2] = 1;
        for (y = p->y0; y < p->y1; y++)
            for (x = p->x0; x < p->x1; x++) owner[y * g->width + x] = i;
    }
    to_means(g, owner, direction, made);
    if (o->method == LIGHT_RELAXED) relax(g, owner, direction, made, o->progress);
    make_lights(out, g, owner, direction, made);
    free(owner);
    free(direction);
    free(parts);
}

static int check_range(const light_set *set, const char *path, failure *f)
{
    double most = 0;
    int i, c;

    for (i = 0; i < set->count; i++)
        for (c = 0; c < 3; c++) most = fmax(most, set->light[i].irradiance[c]);
    if (most <= LIGHT_MAX_IRRADIANCE) return FAIL_NONE;
    return fail(f, FAIL_UNSUPPORTED, "%s: a light of irradiance %.6g, expected at most %d: try --scale %.1g", path,
                most, LIGHT_MAX_IRRADIANCE, LIGHT_MAX_IRRADIANCE / most / 2);
}

int light_bake(light_set *out, light_figures *figures, const env_map *map, const char *path, const light_options *o,
               failure *f)
{
    const int count = o->count ? o->count : 64;
    const double scale = o->scale > 0 ? o->scale : 1;
    light_figures measured;
    light_set set = {0};
    grid g;
    int code;

    if (count < 1 || count > LIGHT_SET_MAX)
        return fail(f, FAIL_USAGE, "%s: %d lights, expected 1..%d", path, count, LIGHT_SET_MAX);
    light_measure(&measured, map, scale);
    if (!(measured.total[0] + measured.total[1] + measured.total[2] > 0))
        return fail(f, FAIL_INVALID, "%s: all %dx%d texels are black, expected some light", path, map->width,
                    map->height);
    g = make_grid(map, scale);
    bake_grid(&set, &g, o, count);
    free(g.cells);
    free(g.sum);
    correct(&set, &measured);
    qsort(set.light, (size_t)set.count, sizeof *set.light, compare_lights);
    code = check_range(&set, path, f);
    if (code) {
        light_set_free(&set);
        return code;
    }
    *out = set;
    if (figures) *figures = measured;
    return FAIL_NONE;
}
