/* SPDX-License-Identifier: MIT */
#include "ssim.h"

#include <math.h>
#include <stdlib.h>

#include "failure.h"

#define SIGMA 1.5
enum { MOMENTS = 5 }; /* means of a, b, a^2, b^2, a b */

static void window_weights(double weight[SSIM_WINDOW])
{
    double sum = 0;
    for (int i = 0; i < SSIM_WINDOW; i++) {
        double x = i - SSIM_WINDOW / 2;
        weight[i] = exp(-x * x / (2 * SIGMA * SIGMA));
        sum += weight[i];
    }
    for (int i = 0; i < SSIM_WINDOW; i++) weight[i] /= sum;
}

/* One row of one channel: the five products. */
static void load_row(const image_u8 *a, const image_u8 *b, int y, int channel, double *row[MOMENTS])
{
    for (int x = 0; x < a->width; x++) {
        size_t at = ((size_t)y * (size_t)a->width + (size_t)x) * (size_t)a->channels + (size_t)channel;
        double p = a->texel[at], q = b->texel[at];
        row[0][x] = p;
        row[1][x] = q;
        row[2][x] = p * p;
        row[3][x] = q * q;
        row[4][x] = p * q;
    }
}

/* out[i] = sum of weight[k] in[i + k step] */
static void blur(const double weight[SSIM_WINDOW], const double *in, size_t step, int count, double *out)
{
    for (int i = 0; i < count; i++) out[i] = 0;
    for (int k = 0; k < SSIM_WINDOW; k++) {
        const double *from = in + (size_t)k * step;
#pragma omp simd
        for (int i = 0; i < count; i++) out[i] += weight[k] * from[i];
    }
}

/* Equation 13 of one window. */
static double similarity(const double moment[MOMENTS])
{
    const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
    double product = moment[0] * moment[1], squares = moment[0] * moment[0] + moment[1] * moment[1];
    double covariance = moment[4] - product, variances = moment[2] + moment[3] - squares;
    return (2 * product + c1) * (2 * covariance + c2) / ((squares + c1) * (variances + c2));
}

static void add_channel(const image_u8 *a, const image_u8 *b, const uint8_t *mask, int channel, double *sum,
                        double *count)
{
    int width = a->width, across = width - SSIM_WINDOW + 1, down = a->height - SSIM_WINDOW + 1;
    size_t plane = (size_t)across * (size_t)a->height;
    double weight[SSIM_WINDOW], *row[MOMENTS], *moment[MOMENTS];
    double *rows = need_memory((size_t)(MOMENTS * width), sizeof *rows);
    double *blurred = need_memory(plane * MOMENTS, sizeof *blurred); /* along x */
    double *line = need_memory((size_t)(MOMENTS * across), sizeof *line);
    window_weights(weight);
    for (int m = 0; m < MOMENTS; m++) {
        row[m] = rows + m * width;
        moment[m] = blurred + (size_t)m * plane;
    }
    for (int y = 0; y < a->height; y++) {
        load_row(a, b, y, channel, row);
        for (int m = 0; m < MOMENTS; m++) blur(weight, row[m], 1, across, moment[m] + (size_t)y * (size_t)across);
    }
    for (int y = 0; y < down; y++) {
        for (int m = 0; m < MOMENTS; m++)
            blur(weight, moment[m] + (size_t)y * (size_t)across, (size_t)across, across, line + m * across);
        const uint8_t *middle = mask ? mask + (size_t)(y + SSIM_WINDOW / 2) * (size_t)width + SSIM_WINDOW / 2 : NULL;
        for (int x = 0; x < across; x++) {
            if (middle && !middle[x]) continue;
            double at[MOMENTS];
            for (int m = 0; m < MOMENTS; m++) at[m] = line[m * across + x];
            *sum += similarity(at);
            *count += 1;
        }
    }
    free(rows);
    free(blurred);
    free(line);
}

double ssim_mean(const image_u8 *a, const image_u8 *b, const uint8_t *mask)
{
    double sum = 0, count = 0;
    for (int c = 0; c < a->channels; c++) add_channel(a, b, mask, c, &sum, &count);
    return count > 0 ? sum / count : 1;
}
