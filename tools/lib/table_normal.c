/* SPDX-License-Identifier: MIT */
/* Normal matrix of a table's least squares on a nine-point stencil, smoothing by second differences, block-Jacobi
   conjugate gradients. Everything runs in one fixed order. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "table_parts.h"

#define MAX_N         TABLE_MAX_UNKNOWNS
#define CG_TOLERANCE  1e-5
#define CG_COARSE     1e-3 /* with many unknowns per texel, where the rest is below the codes */
#define CG_ITERATIONS 250

/* call, with n a constant for the compiler: the inner loops are short. */
#define FOR_CONSTANT_N(count, call)                                                                                    \
    switch (count) {                                                                                                   \
    case 3: {                                                                                                          \
        enum { n = 3 };                                                                                                \
        call;                                                                                                          \
        break;                                                                                                         \
    }                                                                                                                  \
    case 4: {                                                                                                          \
        enum { n = 4 };                                                                                                \
        call;                                                                                                          \
        break;                                                                                                         \
    }                                                                                                                  \
    case 7: {                                                                                                          \
        enum { n = 7 };                                                                                                \
        call;                                                                                                          \
        break;                                                                                                         \
    }                                                                                                                  \
    default: {                                                                                                         \
        const int n = (count);                                                                                         \
        call;                                                                                                          \
        break;                                                                                                         \
    }                                                                                                                  \
    }

table_problem table_problem_make(const table_model *m, const table_samples *s, const table_sky *sky,
                                 const table_hold *hold)
{
    int n = table_unknowns(m), texels = m->width * m->height;
    table_problem p = {
        .model = m, .samples = s, .sky = sky, .n = n, .width = m->width, .height = m->height, .texels = texels};
    for (int k = 0; k < n; k++) {
        double times = k < 3 ? 1 : hold->coefficient;
        p.smooth[k] = hold->smooth * times;
        p.ridge[k] = hold->ridge * times;
    }
    p.block = need_memory((size_t)texels * TABLE_STENCIL, (size_t)(n * n) * sizeof(double));
    p.rhs = need_memory((size_t)texels, (size_t)n * sizeof(double));
    p.inverse = need_memory((size_t)texels, (size_t)(n * n) * sizeof(double));
    if (sky) p.pull = need_memory((size_t)(texels * n), TABLE_SKY_TERMS * sizeof(double));
    return p;
}

void table_problem_free(table_problem *p)
{
    free(p->block);
    free(p->rhs);
    free(p->inverse);
    free(p->pull);
}

/* Unknowns at a sample, between its four texels. Inline so that n is a constant where it is called. */
static inline void gather(const table_footprint *at, int width, int n, const double *x, double *value)
{
    int index[4];
    table_corners(at, width, index);
    for (int k = 0; k < n; k++) value[k] = 0;
    for (int c = 0; c < 4; c++)
        for (int k = 0; k < n; k++) value[k] += at->weight[c] * x[index[c] * n + k];
}

void table_drawn_at(const table_problem *p, const table_footprint *at, const double basis[TABLE_BASES], const double *x,
                    double root[3])
{
    double value[MAX_N];
    FOR_CONSTANT_N(p->n, gather(at, p->width, n, x, value));
    for (int k = 0; k < 3; k++) root[k] = value[k];
    for (int j = 0; j < p->model->coefficients; j++) {
        double term = value[3 + j] * basis[p->model->coefficient[j].kind];
        for (int k = 0; k < 3; k++) root[k] += term * p->model->coefficient[j].g[k];
    }
}

void table_drawn(const table_problem *p, const table_sample *s, const double *x, double root[3])
{
    table_drawn_at(p, &s->at, s->basis, x, root);
}

/* A sample's own share: its matrix and vector over the unknowns of a texel. */
static void share(const table_model *m, const table_sample *s, const double slope[3], const double residual[3],
                  double *matrix, double *vector)
{
    int n = table_unknowns(m);
    for (int k = 0; k < 3; k++) {
        double weight = s->weight * slope[k] * slope[k], pull = s->weight * slope[k] * residual[k],
               term[TABLE_MAX_COEFFICIENTS];
        for (int j = 0; j < m->coefficients; j++) term[j] = s->basis[m->coefficient[j].kind] * m->coefficient[j].g[k];
        vector[k] += pull;
        matrix[k * (n + 1)] = weight;
        for (int j = 0; j < m->coefficients; j++) {
            vector[3 + j] += pull * term[j];
            matrix[k * n + 3 + j] = matrix[(3 + j) * n + k] = weight * term[j];
            for (int i = 0; i < m->coefficients; i++) matrix[(3 + i) * n + 3 + j] += weight * term[i] * term[j];
        }
    }
}

static inline void scatter(table_problem *p, const table_sample *s, int n, const double *matrix, const double *vector)
{
    static const int pair[10][3] = {
        {0, 0, TABLE_SELF},  {1, 1, TABLE_SELF}, {2, 2, TABLE_SELF}, {3, 3, TABLE_SELF},      {0, 1, TABLE_RIGHT},
        {2, 3, TABLE_RIGHT}, {0, 2, TABLE_DOWN}, {1, 3, TABLE_DOWN}, {1, 2, TABLE_DOWN_LEFT}, {0, 3, TABLE_DOWN_RIGHT}};
    int index[4];
    table_corners(&s->at, p->width, index);
    for (int i = 0; i < 10; i++) {
        int from = pair[i][0];
        double weight = s->at.weight[from] * s->at.weight[pair[i][1]];
        double *block = p->block + (size_t)(index[from] * TABLE_STENCIL + pair[i][2]) * (size_t)(n * n);
        for (int k = 0; k < n * n; k++) block[k] += weight * matrix[k];
    }
    for (int c = 0; c < 4; c++)
        for (int k = 0; k < n; k++) p->rhs[index[c] * n + k] += s->at.weight[c] * vector[k];
}

void table_accumulate(table_problem *p, const table_sample *s, const double slope[3], const double residual[3])
{
    double matrix[MAX_N * MAX_N] = {0}, vector[MAX_N] = {0};
    share(p->model, s, slope, residual, matrix, vector);
    FOR_CONSTANT_N(p->n, scatter(p, s, n, matrix, vector));
}

/* y += R x for one line of count texels: R = D^T D, D the second difference; step between texels. */
static void second_differences(const table_problem *p, const double *x, double *y, int count, int step)
{
    for (int i = 1; i + 1 < count; i++)
        for (int k = 0; k < p->n; k++) {
            const double *at = x + (size_t)(i * step * p->n + k);
            double *to = y + (size_t)(i * step * p->n + k);
            double d = p->smooth[k] * (at[-step * p->n] - 2 * at[0] + at[step * p->n]);
            to[-step * p->n] += d;
            to[0] -= 2 * d;
            to[step * p->n] += d;
        }
}

void table_add_smoothing(const table_problem *p, const double *x, double *y)
{
    for (int j = 0; j < p->height; j++)
        second_differences(p, x + (size_t)(j * p->width * p->n), y + (size_t)(j * p->width * p->n), p->width, 1);
    for (int i = 0; i < p->width; i++)
        second_differences(p, x + (size_t)(i * p->n), y + (size_t)(i * p->n), p->height, p->width);
}

static inline void add_block(const double *block, int n, const double *x, double *y)
{
    for (int k = 0; k < n; k++) {
        double sum = 0;
        for (int l = 0; l < n; l++) sum += block[k * n + l] * x[l];
        y[k] += sum;
    }
}

/* y += H x. Inline so that n is a constant where it is called. */
static inline void add_blocks(const table_problem *p, int n, const double *x, double *y)
{
    int offset[TABLE_STENCIL] = {0, 1, p->width - 1, p->width, p->width + 1};
    for (int t = 0; t < p->texels; t++) {
        const double *block = p->block + (size_t)(t * TABLE_STENCIL) * (size_t)(n * n);
        add_block(block, n, x + (size_t)(t * n), y + (size_t)(t * n));
        for (int c = TABLE_RIGHT; c < TABLE_STENCIL; c++) {
            int other = t + offset[c];
            if (other >= p->texels) continue; /* such blocks, and those across a line's end, are zero */
            add_block(block + c * n * n, n, x + (size_t)(other * n), y + (size_t)(t * n));
            add_block(block + c * n * n, n, x + (size_t)(t * n), y + (size_t)(other * n));
        }
    }
}

/* y += pull pull^T x */
static void add_pull(const table_problem *p, const double *x, double *y)
{
    double sum[TABLE_SKY_TERMS] = {0};
    for (int i = 0; i < p->texels * p->n; i++)
        for (int k = 0; k < TABLE_SKY_TERMS; k++) sum[k] += p->pull[i * TABLE_SKY_TERMS + k] * x[i];
    for (int i = 0; i < p->texels * p->n; i++) y[i] += table_pulled(p, i, sum);
}

double table_pulled(const table_problem *p, int index, const double sum[TABLE_SKY_TERMS])
{
    const double *pull = p->pull + (size_t)index * TABLE_SKY_TERMS;
    double y = 0;
    for (int k = 0; k < TABLE_SKY_TERMS; k++) y += pull[k] * sum[k];
    return y;
}

void table_apply(const table_problem *p, const double *x, double *y)
{
    for (int t = 0; t < p->texels; t++)
        for (int k = 0; k < p->n; k++) y[t * p->n + k] = p->ridge[k] * x[t * p->n + k];
    FOR_CONSTANT_N(p->n, add_blocks(p, n, x, y));
    table_add_smoothing(p, x, y);
    if (p->sky) add_pull(p, x, y);
}

static void add_column(const double *block, int n, int unknown, double delta, double *y)
{
    for (int k = 0; k < n; k++) y[k] += block[unknown * n + k] * delta;
}

/* One unknown's column of D^T D along a line of count texels; y points at place i, step between places. */
static void add_curve(int i, int count, int step, double delta, double *y)
{
    for (int centre = i - 1; centre <= i + 1; centre++) {
        if (centre < 1 || centre + 1 >= count) continue;
        double d = delta * (centre == i ? -2 : 1);
        y[(centre - 1 - i) * step] += d;
        y[(centre - i) * step] -= 2 * d;
        y[(centre + 1 - i) * step] += d;
    }
}

void table_apply_one(const table_problem *p, int texel, int unknown, double delta, double *y)
{
    int n = p->n, offset[TABLE_STENCIL] = {0, 1, p->width - 1, p->width, p->width + 1};
    for (int c = 0; c < TABLE_STENCIL; c++) {
        size_t size = (size_t)(n * n);
        int after = texel + offset[c], before = texel - offset[c];
        if (after < p->texels)
            add_column(p->block + (size_t)(texel * TABLE_STENCIL + c) * size, n, unknown, delta, y + after * n);
        if (before >= 0 && c != TABLE_SELF)
            add_column(p->block + (size_t)(before * TABLE_STENCIL + c) * size, n, unknown, delta, y + before * n);
    }
    double *at = y + texel * n + unknown, smooth = p->smooth[unknown] * delta;
    add_curve(texel % p->width, p->width, n, smooth, at);
    add_curve(texel / p->width, p->height, n * p->width, smooth, at);
    *at += p->ridge[unknown] * delta;
}

/* Diagonal of D^T D at place i of count. */
static double smoothing_diagonal(int i, int count)
{
    double inner = i >= 1 && i + 1 < count ? 4 : 0;
    return inner + (i >= 2 ? 1 : 0) + (i + 2 < count ? 1 : 0);
}

double table_stiffness(const table_problem *p, int texel, int unknown)
{
    double curve = smoothing_diagonal(texel % p->width, p->width) + smoothing_diagonal(texel / p->width, p->height);
    double own = p->block[(size_t)(texel * TABLE_STENCIL * p->n + unknown) * (size_t)p->n + (size_t)unknown];
    double pull =
        p->sky ? table_pulled(p, texel * p->n + unknown, p->pull + (size_t)(texel * p->n + unknown) * TABLE_SKY_TERMS)
               : 0;
    return own + p->smooth[unknown] * curve + p->ridge[unknown] + pull;
}

/* Inverse of a symmetric positive definite n x n matrix by Gauss-Jordan; rows without any weight give zero. */
static void invert(const double *matrix, int n, double *inverse)
{
    double a[MAX_N * MAX_N];
    memcpy(a, matrix, (size_t)(n * n) * sizeof *a);
    for (int i = 0; i < n * n; i++) inverse[i] = i % (n + 1) == 0;
    for (int i = 0; i < n; i++) {
        double pivot = a[i * n + i] > 1e-300 ? 1 / a[i * n + i] : 0;
        for (int k = 0; k < n; k++) {
            a[i * n + k] *= pivot;
            inverse[i * n + k] *= pivot;
        }
        for (int j = 0; j < n; j++) {
            double times = j == i ? 0 : a[j * n + i];
            for (int k = 0; k < n; k++) {
                a[j * n + k] -= times * a[i * n + k];
                inverse[j * n + k] -= times * inverse[i * n + k];
            }
        }
    }
}

static void precondition(table_problem *p)
{
    int n = p->n;
    for (int t = 0; t < p->texels; t++) {
        double matrix[MAX_N * MAX_N];
        memcpy(matrix, p->block + (size_t)(t * TABLE_STENCIL) * (size_t)(n * n), (size_t)(n * n) * sizeof *matrix);
        for (int k = 0; k < n; k++) matrix[k * n + k] = table_stiffness(p, t, k);
        invert(matrix, n, p->inverse + (size_t)t * (size_t)(n * n));
    }
}

static double dot(const double *a, const double *b, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

static void apply_inverse(const table_problem *p, const double *r, double *z)
{
    int n = p->n;
    memset(z, 0, (size_t)(p->texels * n) * sizeof *z);
    for (int t = 0; t < p->texels; t++)
        add_block(p->inverse + (size_t)t * (size_t)(n * n), n, r + (size_t)(t * n), z + (size_t)(t * n));
}

void table_solve(table_problem *p, const double *x, double *dx)
{
    int count = p->texels * p->n;
    size_t size = (size_t)count;
    double *r = need_memory(4 * size, sizeof *r), *z = r + size, *d = z + size, *q = d + size;
    table_add_smoothing(p, x, q);
    for (int i = 0; i < count; i++) r[i] = p->rhs[i] - q[i];
    precondition(p);
    memset(dx, 0, size * sizeof *dx);
    apply_inverse(p, r, z);
    memcpy(d, z, size * sizeof *d);
    double rz = dot(r, z, count), tolerance = p->n > 4 ? CG_COARSE : CG_TOLERANCE, stop = tolerance * tolerance * rz;
    for (int iteration = 0; iteration < CG_ITERATIONS && rz > stop; iteration++) {
        table_apply(p, d, q);
        double alpha = rz / dot(d, q, count);
        for (int i = 0; i < count; i++) dx[i] += alpha * d[i];
        for (int i = 0; i < count; i++) r[i] -= alpha * q[i];
        apply_inverse(p, r, z);
        double next = dot(r, z, count), beta = next / rz;
        for (int i = 0; i < count; i++) d[i] = z[i] + beta * d[i];
        rz = next;
    }
    free(r);
}
