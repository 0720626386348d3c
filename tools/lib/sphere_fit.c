/* SPDX-License-Identifier: MIT */
#include "sphere_fit.h"

#include <math.h>
#include <stdlib.h>

#include "failure.h"

/*
 * With y the texels and B the bilinear weights of the samples: minimise sum w (B y - target)^2, that is
 * (B^T W B) y = B^T W target. Each texel shares samples with its 8 neighbours only, so a row of the matrix is a 3 x 3 stencil.
 * Jacobi-preconditioned conjugate gradients; the matrix is that of a bilinear spline fit, whose condition number does not
 * grow with the size.
 */
enum { ROUNDS = 14, SWEEPS = 3 };

typedef struct tap {
    int low, high;
    float part; /* of high */
} tap;

/* Neighbours of sample I along one axis, clamped to the edge as the texture unit does. */
static tap tap_of(int sample, int samples, int size)
{
    double at = (sample + 0.5) / samples - 0.5;
    double whole = floor(at);
    int low = (int)whole;
    tap t = {low < 0 ? 0 : low, low + 1 < size ? low + 1 : size - 1, (float)(at - whole)};
    return t;
}

typedef struct normal_equations {
    int size;
    float *stencil; /* 9 a texel: neighbour (n % 3 - 1, n / 3 - 1) */
    double *right;
} normal_equations;

static void assemble(normal_equations *e, const float *target, const float *weight, int samples)
{
    int size = e->size, side = size * samples;
    tap *taps = need_memory((size_t)side, sizeof *taps);
    for (int i = 0; i < side; i++) taps[i] = tap_of(i, samples, size);
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            tap a = taps[i], b = taps[j];
            float w = weight[(size_t)j * (size_t)side + (size_t)i];
            float value = target[(size_t)j * (size_t)side + (size_t)i];
            int x[4] = {a.low, a.high, a.low, a.high}, y[4] = {b.low, b.low, b.high, b.high};
            float part[4] = {(1 - a.part) * (1 - b.part), a.part * (1 - b.part), (1 - a.part) * b.part,
                             a.part * b.part};
            for (int n = 0; n < 4; n++) {
                if (part[n] == 0) continue;
                size_t at = (size_t)y[n] * (size_t)size + (size_t)x[n];
                e->right[at] += (double)(w * part[n] * value);
                for (int m = 0; m < 4; m++)
                    e->stencil[9 * at + (size_t)(3 * (y[m] - y[n] + 1) + x[m] - x[n] + 1)] += w * part[n] * part[m];
            }
        }
    free(taps);
}

/* Row (i, j) of the matrix times v. */
static double row_product(const normal_equations *e, const double *v, int i, int j)
{
    int size = e->size;
    size_t at = (size_t)j * (size_t)size + (size_t)i;
    const float *row = e->stencil + 9 * at + 4;
    double sum = 0;
    int up = j > 0 ? -1 : 0, down = j + 1 < size ? 1 : 0, left = i > 0 ? -1 : 0, right = i + 1 < size ? 1 : 0;
    for (int y = up; y <= down; y++)
        for (int x = left; x <= right; x++) sum += (double)row[3 * y + x] * v[(ptrdiff_t)at + (ptrdiff_t)y * size + x];
    return sum;
}

static void apply(const normal_equations *e, const double *v, double *out)
{
    for (int j = 0; j < e->size; j++)
        for (int i = 0; i < e->size; i++) out[(size_t)j * (size_t)e->size + (size_t)i] = row_product(e, v, i, j);
}

static double product(const double *a, const double *b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

static void solve(const normal_equations *e, double *y)
{
    size_t count = (size_t)e->size * (size_t)e->size;
    double *residual = e->right, *scaled = need_memory(3 * count, sizeof *scaled);
    double *step = scaled + count, *image = step + count;
    apply(e, y, image);
    for (size_t i = 0; i < count; i++) {
        residual[i] -= image[i];
        step[i] = scaled[i] = residual[i] / (double)e->stencil[9 * i + 4];
    }
    double rho = product(residual, scaled, count), first = rho;
    for (int round = 0; round < ROUNDS && rho > 1e-9 * first; round++) {
        apply(e, step, image);
        double length = rho / product(step, image, count), next;
        for (size_t i = 0; i < count; i++) {
            y[i] += length * step[i];
            residual[i] -= length * image[i];
            scaled[i] = residual[i] / (double)e->stencil[9 * i + 4];
        }
        next = product(residual, scaled, count);
        for (size_t i = 0; i < count; i++) step[i] = scaled[i] + next / rho * step[i];
        rho = next;
    }
    free(scaled);
}

/* Round to k / levels so that the reconstruction, not each texel, stays near: the quadratic form grows by d^T A d for
   deviations d, and texel by texel the step with the smallest growth is taken, given the neighbours'. Errors of neighbours
   come to cancel, as in error diffusion, but without a direction. */
static void round_codes(const normal_equations *e, double *y, int levels)
{
    int size = e->size;
    size_t count = (size_t)size * (size_t)size;
    double *deviation = need_memory(count, sizeof *deviation);
    for (size_t i = 0; i < count; i++) {
        double code = floor(fmin(fmax(y[i], 0), 1) * levels + 0.5) / levels;
        deviation[i] = code - y[i];
    }
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int j = 0; j < size; j++)
            for (int i = 0; i < size; i++) {
                size_t at = (size_t)j * (size_t)size + (size_t)i;
                double wanted =
                    y[at] + deviation[at] - row_product(e, deviation, i, j) / (double)e->stencil[9 * at + 4];
                double code = floor(fmin(fmax(wanted, 0), 1) * levels + 0.5) / levels;
                deviation[at] = code - y[at];
            }
    for (size_t i = 0; i < count; i++) y[i] += deviation[i];
    free(deviation);
}

void sphere_fit(float *texel, size_t stride, const float *target, const float *weight, int size, int samples,
                int levels)
{
    size_t count = (size_t)size * (size_t)size;
    normal_equations e = {size, need_memory(count, 9 * sizeof *e.stencil), need_memory(count, sizeof *e.right)};
    double *y = need_memory(count, sizeof *y);
    assemble(&e, target, weight, samples);
    for (size_t i = 0; i < count; i++) y[i] = (double)texel[stride * i];
    solve(&e, y);
    if (levels) round_codes(&e, y, levels);
    for (size_t i = 0; i < count; i++) texel[stride * i] = (float)y[i];
    free(y);
    free(e.right);
    free(e.stencil);
}
