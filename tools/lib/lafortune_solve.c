/* SPDX-License-Identifier: MIT */
/* Variable projection: kd and ks are linear and found in closed form (non-negative) inside every step; cminpack's
   Levenberg-Marquardt moves shapes and exponents, with Kaufman's (1975) form of the Jacobian. */
#include "lafortune_solve.h"

#include <cminpack-1/cminpack.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "failure.h"

static const double pi = 3.14159265358979323846;

enum {
    MAX_COLUMNS = LAFORTUNE_MAX_LOBES + 1, /* Lambert and lobes */
    MAX_PER_LOBE = 3,                      /* polar angle of c, its azimuth if anisotropic, log n */
    MAX_UNKNOWNS = LAFORTUNE_MAX_LOBES * MAX_PER_LOBE
};

/* A lobe as the solver moves it: c along (-sqrt2 sin polar cos azimuth, -sqrt2 sin polar sin azimuth, cos polar);
   isotropic at azimuth 45 degrees, the mirror direction at polar 45 degrees. */
typedef struct shape {
    double polar, azimuth, log_n;
} shape;

/* Where new lobes are tried: towards the mirror direction, off it to either side, retroreflecting, along the normal,
   and across (cz < 0). */
static const double polar_degrees[] = {-70, -45, 0, 25, 38, 45, 51, 58, 70, 105};
static const double azimuth_degrees[] = {45, 20, 70, 135};
static const double exponents[] = {1, 3, 10, 30, 100, 300, 1000, 3000, 10000};
#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))
enum { POLARS = COUNT(polar_degrees), EXPONENTS = COUNT(exponents), MAX_CANDIDATES = POLARS * EXPONENTS * 4 };

struct lafortune_problem {
    int count, channels, per_lobe, max_lobes;
    lafortune_options options;
    double (*product)[3], *weight;
    double *wanted; /* [channel][sample], weighted */
    double *column; /* [Lambert, lobes][sample], weighted */
    double *slope;  /* [unknown][sample]: derivative of the unknown's column */
    double *jacobian, *residual, *work;
    shape *candidate;
    double *candidate_column; /* [candidate][sample] */
    int candidates, candidate_exponents, candidate_azimuths;
    /* of the last evaluation */
    int lobes;
    double gram[MAX_COLUMNS][MAX_COLUMNS];
    double coefficient[3][MAX_COLUMNS];
    double wanted_squared;
};

/* ---- shapes --------------------------------------------------------------------------------------------------------- */

static double largest_sum(const double c[3])
{
    return fmax(fmax(fabs(c[0]), fabs(c[1])), c[2]);
}

int lafortune_normalise(lafortune_shared_lobe *lobe)
{
    double largest = largest_sum(lobe->c);
    if (!(largest > 0)) return 0;
    for (int i = 0; i < 3; i++) {
        lobe->c[i] /= largest;
        lobe->ks[i] *= pow(largest, lobe->n);
    }
    return 1;
}

static void shape_to_c(const shape *s, double c[3])
{
    c[0] = -sqrt(2) * sin(s->polar) * cos(s->azimuth);
    c[1] = s->azimuth == pi / 4 ? c[0] : -sqrt(2) * sin(s->polar) * sin(s->azimuth);
    c[2] = cos(s->polar);
}

static shape shape_of(const lafortune_shared_lobe *lobe)
{
    shape s = {0, pi / 4, log(fmax(lobe->n, 1e-3))};
    double across = hypot(lobe->c[0], lobe->c[1]) / sqrt(2);
    if (lobe->c[0] == lobe->c[1]) { /* the sign is in the polar angle */
        s.polar = atan2(-lobe->c[0], lobe->c[2]);
    } else {
        s.polar = atan2(across, lobe->c[2]);
        s.azimuth = atan2(-lobe->c[1], -lobe->c[0]);
    }
    return s;
}

/* A lobe that grows towards the horizon has its peak where nothing is sampled. With the largest part across being 1, the sum
   in the mirror direction is 1 - (1 - cz) cos^2 of the polar angle. */
static void hold_back(const lafortune_problem *p, shape *s)
{
    static const double cosine_squared = 0.0669873; /* of 75 degrees */
    if (!(p->options.grazing_max > 1)) return;
    double n = fmin(fmax(exp(s->log_n), p->options.n_min), p->options.n_max);
    double least = fmax(1 - (1 - pow(p->options.grazing_max, -1 / n)) / cosine_squared, -1); /* |C| up to 1 */
    double across = sqrt(2) * fmax(fabs(cos(s->azimuth)), fabs(sin(s->azimuth))), sine = sin(s->polar);
    if (cos(s->polar) >= least * across * fabs(sine)) return;
    s->polar = atan2(sine < 0 ? -1 : 1, least * across);
}

static double exponent_of(const lafortune_problem *p, const shape *s)
{
    return fmin(fmax(exp(s->log_n), p->options.n_min), p->options.n_max);
}

/* The lobe's column, and the derivatives by its unknowns if slope is not NULL. The scale of c does not matter (the
   albedo takes it over), so its own derivative is left out. */
static void lobe_column(const lafortune_problem *p, const shape *s, double *column, double *slope)
{
    double c[3], n = exponent_of(p, s);
    shape_to_c(s, c);
    double scale = 1 / fmax(largest_sum(c), 1e-9);
    double by_polar[3] = {-sqrt(2) * cos(s->polar) * cos(s->azimuth), -sqrt(2) * cos(s->polar) * sin(s->azimuth),
                          -sin(s->polar)};
    double by_azimuth[2] = {-c[1], c[0]};
    int inside = exp(s->log_n) > p->options.n_min && exp(s->log_n) < p->options.n_max;
    double highest = 0;
    for (int i = 0; i < p->count; i++) {
        const double *q = p->product[i];
        double sum = scale * (c[0] * q[0] + c[1] * q[1] + c[2] * q[2]);
        double logarithm = sum > 1e-300 ? log(sum) : 0;
        highest = fmax(highest, sum);
        column[i] = sum > 1e-300 ? p->weight[i] * exp(n * logarithm) : 0;
        if (!slope) continue;
        double by_sum = sum > 1e-300 ? scale * n * column[i] / sum : 0;
        slope[i] = by_sum * (by_polar[0] * q[0] + by_polar[1] * q[1] + by_polar[2] * q[2]);
        slope[p->count + i] = inside ? n * logarithm * column[i] : 0;
        if (p->per_lobe == 3) slope[2 * p->count + i] = by_sum * (by_azimuth[0] * q[0] + by_azimuth[1] * q[1]);
    }
    /* a sharp lobe between all samples could be of any strength: it is not to be had */
    if (p->options.grazing_max > 1 && pow(fmin(highest, 1), n) * 2 * p->options.grazing_max < 1)
        memset(column, 0, (size_t)p->count * sizeof *column);
}

static double dot(const double *a, const double *b, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

/* ---- albedos -------------------------------------------------------------------------------------------------------- */

/* Solve gram x = right over the columns of mask by Cholesky. 0 if they hardly differ from each other. */
static int solve_subset(double gram[MAX_COLUMNS][MAX_COLUMNS], const double *right, unsigned mask, double *x)
{
    int index[MAX_COLUMNS] = {0}, n = 0;
    double l[MAX_COLUMNS][MAX_COLUMNS], y[MAX_COLUMNS];
    for (int i = 0; i < MAX_COLUMNS; i++)
        if (mask >> i & 1) index[n++] = i;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = gram[index[i]][index[j]];
            for (int k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 1e-11 * gram[index[i]][index[i]])) return 0;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
        y[i] = right[index[i]];
        for (int k = 0; k < i; k++) y[i] -= l[i][k] * y[k];
        y[i] /= l[i][i];
    }
    memset(x, 0, MAX_COLUMNS * sizeof *x);
    for (int i = n - 1; i >= 0; i--) {
        double sum = y[i];
        for (int k = i + 1; k < n; k++) sum -= l[k][i] * x[index[k]];
        x[index[i]] = sum / l[i][i];
    }
    return 1;
}

/* Non-negative least squares over at most four columns: the best of all subsets, or the whole set if that is feasible.
   Returns by how much the sum of squares falls. */
static double solve_albedos(double gram[MAX_COLUMNS][MAX_COLUMNS], const double *right, int columns, double *x)
{
    double best = 0;
    memset(x, 0, MAX_COLUMNS * sizeof *x);
    for (unsigned mask = (1u << columns) - 1; mask; mask--) {
        double trial[MAX_COLUMNS], gain = 0;
        int feasible = solve_subset(gram, right, mask, trial);
        for (int i = 0; i < columns && feasible; i++) {
            feasible = trial[i] >= 0;
            gain += trial[i] * right[i];
        }
        if (!feasible) continue;
        if (gain > best) {
            best = gain;
            memcpy(x, trial, sizeof trial);
        }
        if (mask == (1u << columns) - 1) break;
    }
    return best;
}

/* Gram matrix and albedos of the first columns; returns the sum of squared residuals. */
static double project(lafortune_problem *p, int columns)
{
    double left = p->wanted_squared;
    for (int i = 0; i < columns; i++) {
        for (int j = 0; j <= i; j++)
            p->gram[i][j] = p->gram[j][i] =
                dot(p->column + (size_t)i * p->count, p->column + (size_t)j * p->count, p->count);
    }
    for (int c = 0; c < p->channels; c++) {
        double right[MAX_COLUMNS];
        for (int i = 0; i < columns; i++)
            right[i] = dot(p->column + (size_t)i * p->count, p->wanted + (size_t)c * p->count, p->count);
        left -= solve_albedos(p->gram, right, columns, p->coefficient[c]);
    }
    return fmax(left, 0);
}

/* ---- steps ---------------------------------------------------------------------------------------------------------- */

static void read_shapes(const lafortune_problem *p, const double *x, shape *s)
{
    for (int i = 0; i < p->lobes; i++, x += p->per_lobe) {
        s[i].polar = x[0];
        s[i].log_n = x[1];
        s[i].azimuth = p->per_lobe == 3 ? x[2] : pi / 4;
    }
}

static void fill_columns(lafortune_problem *p, const double *x, int with_slopes)
{
    shape s[LAFORTUNE_MAX_LOBES];
    read_shapes(p, x, s);
    for (int i = 0; i < p->lobes; i++)
        lobe_column(p, &s[i], p->column + (size_t)(i + 1) * p->count,
                    with_slopes ? p->slope + (size_t)i * p->per_lobe * p->count : NULL);
}

static void fill_residual(const lafortune_problem *p, double *residual)
{
    for (int c = 0; c < p->channels; c++) {
        double *r = residual + (size_t)c * p->count;
        const double *wanted = p->wanted + (size_t)c * p->count;
        for (int i = 0; i < p->count; i++) r[i] = -wanted[i];
        for (int k = 0; k <= p->lobes; k++) {
            double a = p->coefficient[c][k];
            const double *column = p->column + (size_t)k * p->count;
            if (a > 0)
                for (int i = 0; i < p->count; i++) r[i] += a * column[i];
        }
    }
}

/* Kaufman's Jacobian of the projected residual: albedo x the part of a column's derivative that the channel's lit
   columns can't take up. */
static void fill_jacobian(lafortune_problem *p, double *jacobian, int rows)
{
    for (int u = 0; u < p->lobes * p->per_lobe; u++) {
        const double *slope = p->slope + (size_t)u * p->count;
        double right[MAX_COLUMNS];
        for (int k = 0; k <= p->lobes; k++) right[k] = dot(p->column + (size_t)k * p->count, slope, p->count);
        for (int c = 0; c < p->channels; c++) {
            double *out = jacobian + (size_t)u * rows + (size_t)c * p->count;
            double a = p->coefficient[c][1 + u / p->per_lobe], taken[MAX_COLUMNS];
            unsigned lit = 0;
            for (int k = 0; k <= p->lobes; k++) lit |= (unsigned)(p->coefficient[c][k] > 0) << k;
            if (!(a > 0) || !solve_subset(p->gram, right, lit, taken)) {
                memset(out, 0, (size_t)p->count * sizeof *out);
                continue;
            }
            for (int i = 0; i < p->count; i++) out[i] = a * slope[i];
            for (int k = 0; k <= p->lobes; k++) {
                const double *column = p->column + (size_t)k * p->count;
                double part = a * taken[k];
                if (taken[k] != 0)
                    for (int i = 0; i < p->count; i++) out[i] -= part * column[i];
            }
        }
    }
}

static int residual_or_jacobian(void *problem, int rows, int unknowns, const double *x, double *residual,
                                double *jacobian, int leading, int flag)
{
    lafortune_problem *p = problem;
    (void)unknowns;
    (void)leading;
    fill_columns(p, x, flag == 2);
    project(p, p->lobes + 1);
    if (flag == 1) fill_residual(p, residual);
    if (flag == 2) fill_jacobian(p, jacobian, rows);
    return 0;
}

/* Move the shapes to the nearest least error; returns the sum of squares, albedos in coefficient. */
static double descend(lafortune_problem *p, shape *s, int lobes)
{
    double x[MAX_UNKNOWNS], scale[MAX_UNKNOWNS], qtf[MAX_UNKNOWNS], wa[3][MAX_UNKNOWNS];
    int pivot[MAX_UNKNOWNS], evaluations, jacobians, rows = p->channels * p->count;
    int unknowns = lobes * p->per_lobe;
    p->lobes = lobes;
    for (int i = 0; i < lobes; i++) {
        double *at = x + i * p->per_lobe;
        at[0] = s[i].polar;
        at[1] = s[i].log_n;
        if (p->per_lobe == 3) at[2] = s[i].azimuth;
    }
    for (int i = 0; i < unknowns; i++) scale[i] = 1;
    if (rows >= unknowns)
        lmder(residual_or_jacobian, p, rows, unknowns, x, p->residual, p->jacobian, rows, p->options.tolerance, 1e-7, 0,
              p->options.evaluations, scale, 2, 1, 0, &evaluations, &jacobians, pivot, qtf, wa[0], wa[1], wa[2],
              p->work);
    read_shapes(p, x, s);
    for (int i = 0; i < lobes; i++) {
        hold_back(p, &s[i]);
        lobe_column(p, &s[i], p->column + (size_t)(i + 1) * p->count, NULL);
    }
    return project(p, lobes + 1);
}

/* ---- starts --------------------------------------------------------------------------------------------------------- */

static double *candidate_column(const lafortune_problem *p, int i)
{
    return p->candidate_column + (size_t)i * p->count;
}

static void make_candidates(lafortune_problem *p)
{
    int azimuths = p->options.anisotropic ? COUNT(azimuth_degrees) : 1, exponent_count = 1;
    while (exponent_count < EXPONENTS && exponents[exponent_count] <= p->options.n_max) exponent_count++;
    p->candidates = azimuths * POLARS * exponent_count;
    p->candidate_exponents = exponent_count;
    p->candidate = need_memory((size_t)p->candidates, sizeof *p->candidate);
    p->candidate_column = need_memory((size_t)p->candidates * (size_t)p->count, sizeof(double));
    for (int i = 0; i < p->candidates; i++) {
        shape *s = &p->candidate[i];
        double azimuth = azimuth_degrees[i / exponent_count / POLARS];
        s->polar = polar_degrees[i / exponent_count % POLARS] * (pi / 180);
        s->azimuth = azimuth == 45 ? pi / 4 : azimuth * (pi / 180);
        s->log_n = log(exponents[i % exponent_count]);
        hold_back(p, s);
        lobe_column(p, s, candidate_column(p, i), NULL);
    }
}

/* Squared error with each candidate added to the columns there are. */
static void try_candidates(lafortune_problem *p, int columns, double *error)
{
    double right[3][MAX_COLUMNS], albedo[MAX_COLUMNS];
    project(p, columns);
    for (int c = 0; c < p->channels; c++)
        for (int k = 0; k < columns; k++)
            right[c][k] = dot(p->column + (size_t)k * p->count, p->wanted + (size_t)c * p->count, p->count);
    for (int i = 0; i < p->candidates; i++) {
        const double *column = candidate_column(p, i);
        for (int k = 0; k < columns; k++)
            p->gram[k][columns] = p->gram[columns][k] = dot(p->column + (size_t)k * p->count, column, p->count);
        p->gram[columns][columns] = dot(column, column, p->count);
        error[i] = p->wanted_squared;
        for (int c = 0; c < p->channels; c++) {
            right[c][columns] = dot(column, p->wanted + (size_t)c * p->count, p->count);
            error[i] -= solve_albedos(p->gram, right[c], columns + 1, albedo);
        }
    }
}

/* No neighbour in exponent or polar angle is better. */
static int is_local_best(const lafortune_problem *p, const double *error, int i)
{
    int stride = p->candidate_exponents, exponent = i % stride, polar = i / stride % POLARS;
    return !(exponent > 0 && error[i - 1] < error[i]) && !(exponent + 1 < stride && error[i + 1] < error[i]) &&
           !(polar > 0 && error[i - stride] < error[i]) && !(polar + 1 < POLARS && error[i + stride] < error[i]);
}

/* The best of the grid's local minima, best first; returns how many. */
static int pick_starts(const lafortune_problem *p, const double *error, int *start)
{
    int count = 0;
    for (int i = 0; i < p->candidates; i++) {
        if (!is_local_best(p, error, i)) continue;
        int at = count;
        while (at > 0 && error[start[at - 1]] > error[i]) at--;
        if (at == p->options.starts) continue;
        if (count < p->options.starts) count++;
        memmove(start + at + 1, start + at, (size_t)(count - 1 - at) * sizeof *start);
        start[at] = i;
    }
    return count;
}

/* The best of what a trial reached. */
typedef struct best_fit {
    double error;
    shape s[LAFORTUNE_MAX_LOBES];
} best_fit;

static void try_shapes(lafortune_problem *p, const shape *s, int lobes, best_fit *best)
{
    shape trial[LAFORTUNE_MAX_LOBES];
    memcpy(trial, s, (size_t)lobes * sizeof *trial);
    double error = descend(p, trial, lobes);
    progress_add(p->options.progress, 1);
    if (!(error < best->error)) return;
    best->error = error;
    memcpy(best->s, trial, sizeof trial);
}

/* From lobes - 1 to lobes: best->s holds the smaller fit and, as a lobe without albedo leaves it as it is, is also where
   the search begins. A further lobe comes from the grid; or one lobe is split into a wider and a narrower one. */
static void add_lobe(lafortune_problem *p, int lobes, best_fit *best)
{
    double *error = need_memory((size_t)p->candidates, sizeof *error);
    int *start = need_memory((size_t)p->options.starts + 1, sizeof *start);
    shape s[LAFORTUNE_MAX_LOBES] = {{0, 0, 0}};
    memcpy(s, best->s, (size_t)(lobes - 1) * sizeof *s);
    p->lobes = lobes - 1;
    for (int i = 0; i < lobes - 1; i++) lobe_column(p, &s[i], p->column + (size_t)(i + 1) * p->count, NULL);
    try_candidates(p, lobes, error);
    int starts = pick_starts(p, error, start);
    if (starts) best->s[lobes - 1] = p->candidate[start[0]];
    for (int i = 0; i < starts; i++) {
        s[lobes - 1] = p->candidate[start[i]];
        try_shapes(p, s, lobes, best);
    }
    for (int i = 0; i < lobes - 1 && p->options.starts > 1; i++) {
        shape split[LAFORTUNE_MAX_LOBES];
        memcpy(split, s, sizeof split);
        split[lobes - 1] = s[i];
        split[lobes - 1].log_n += log(3);
        split[i].log_n -= log(3);
        try_shapes(p, split, lobes, best);
    }
    free(error);
    free(start);
}

/* ---- problems ------------------------------------------------------------------------------------------------------- */

lafortune_problem *lafortune_problem_make(const lafortune_samples *samples, int channels, int max_lobes,
                                          const lafortune_options *options)
{
    lafortune_problem *p = need_memory(1, sizeof *p);
    memset(p, 0, sizeof *p);
    p->options = *options;
    if (!(p->options.n_min > 0)) p->options.n_min = 0.25;
    if (!(p->options.n_max > 0)) p->options.n_max = 1e5;
    if (!(p->options.tolerance > 0)) p->options.tolerance = 1e-8;
    if (!p->options.starts) p->options.starts = 6;
    if (!p->options.evaluations) p->options.evaluations = 200;
    p->count = samples->count;
    p->channels = channels;
    p->max_lobes = max_lobes;
    p->per_lobe = options->anisotropic ? 3 : 2;
    size_t count = (size_t)p->count, unknowns = (size_t)(max_lobes * p->per_lobe), rows = count * (size_t)channels;
    p->product = need_memory(count, sizeof *p->product);
    p->weight = need_memory(count, sizeof *p->weight);
    memcpy(p->product, samples->product, count * sizeof *p->product);
    memcpy(p->weight, samples->weight, count * sizeof *p->weight);
    p->wanted = need_memory(rows, sizeof(double));
    p->column = need_memory(count * (size_t)(max_lobes + 1), sizeof(double));
    p->slope = need_memory(count * unknowns, sizeof(double));
    p->jacobian = need_memory(rows * unknowns, sizeof(double));
    p->residual = need_memory(rows, sizeof(double));
    p->work = need_memory(rows, sizeof(double));
    memcpy(p->column, p->weight, count * sizeof(double));
    for (size_t i = 0; i < count; i++) p->column[i] /= pi;
    make_candidates(p);
    return p;
}

void lafortune_problem_free(lafortune_problem *p)
{
    if (!p) return;
    double *owned[] = {p->weight,   p->wanted,   p->column, p->slope,
                       p->jacobian, p->residual, p->work,   p->candidate_column};
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++) free(owned[i]);
    free(p->product);
    free(p->candidate);
    free(p);
}

static void set_values(lafortune_problem *p, const double *value)
{
    for (int c = 0; c < p->channels; c++)
        for (int i = 0; i < p->count; i++)
            p->wanted[(size_t)c * p->count + i] = p->weight[i] * value[(size_t)i * p->channels + c];
    p->wanted_squared = dot(p->wanted, p->wanted, p->channels * p->count);
}

static double relative(const lafortune_problem *p, double squares)
{
    return p->wanted_squared > 0 ? sqrt(fmax(squares, 0) / p->wanted_squared) : 0;
}

/* The exact sum of squares: what project() returns is a difference, and has no digits left for good fits. */
static double residual_squares(lafortune_problem *p)
{
    fill_residual(p, p->residual);
    return dot(p->residual, p->residual, p->channels * p->count);
}

/* Shapes and albedos of the last evaluation into out; its relative error. */
static double take_fit(lafortune_problem *p, const shape *s, int lobes, lafortune_shared *out)
{
    p->lobes = lobes;
    for (int i = 0; i < lobes; i++) lobe_column(p, &s[i], p->column + (size_t)(i + 1) * p->count, NULL);
    project(p, lobes + 1);
    memset(out, 0, sizeof *out);
    out->lobes = lobes;
    for (int c = 0; c < 3; c++) out->kd[c] = p->coefficient[c < p->channels ? c : p->channels - 1][0];
    for (int i = 0; i < lobes; i++) {
        lafortune_shared_lobe *lobe = &out->lobe[i];
        shape_to_c(&s[i], lobe->c);
        double largest = fmax(largest_sum(lobe->c), 1e-9);
        for (int k = 0; k < 3; k++) lobe->c[k] = lobe->c[k] / largest + 0.0; /* no -0 */
        lobe->n = exponent_of(p, &s[i]);
        for (int c = 0; c < 3; c++) lobe->ks[c] = p->coefficient[c < p->channels ? c : p->channels - 1][i + 1];
    }
    return relative(p, residual_squares(p));
}

double lafortune_solve(lafortune_problem *p, const double *value, int lobes, lafortune_shared *out, double *residual)
{
    best_fit best = {.error = HUGE_VAL};
    set_values(p, value);
    double error = take_fit(p, best.s, 0, out);
    if (residual) residual[0] = error;
    for (int k = 1; k <= lobes; k++) {
        add_lobe(p, k, &best);
        error = take_fit(p, best.s, k, out);
        if (residual) residual[k] = error;
    }
    return error;
}

double lafortune_refine(lafortune_problem *p, const double *value, lafortune_shared *inout)
{
    shape s[LAFORTUNE_MAX_LOBES];
    set_values(p, value);
    for (int i = 0; i < inout->lobes; i++) s[i] = shape_of(&inout->lobe[i]);
    if (inout->lobes) descend(p, s, inout->lobes);
    return take_fit(p, s, inout->lobes, inout);
}

double lafortune_albedos(lafortune_problem *p, const double *value, lafortune_shared *inout)
{
    shape s[LAFORTUNE_MAX_LOBES];
    set_values(p, value);
    for (int i = 0; i < inout->lobes; i++) s[i] = shape_of(&inout->lobe[i]);
    return take_fit(p, s, inout->lobes, inout);
}

/* ---- evaluation ----------------------------------------------------------------------------------------------------- */

void lafortune_shared_eval(const lafortune_shared *p, const double to_light[3], const double to_eye[3], double f_r[3])
{
    int seen = to_light[2] > 0 && to_eye[2] > 0;
    for (int c = 0; c < 3; c++) f_r[c] = seen ? p->kd[c] / pi : 0;
    for (int i = 0; i < p->lobes && seen; i++) {
        const lafortune_shared_lobe *lobe = &p->lobe[i];
        double sum = 0;
        for (int k = 0; k < 3; k++) sum += lobe->c[k] * to_light[k] * to_eye[k];
        if (!(sum > 0)) continue;
        double height = pow(sum, lobe->n);
        for (int c = 0; c < 3; c++) f_r[c] += lobe->ks[c] * height;
    }
}
