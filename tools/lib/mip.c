/* SPDX-License-Identifier: MIT */
#include "mip.h"

static int is_power_of_two(int x)
{
    return x > 0 && (x & (x - 1)) == 0;
}

int mip_count(int width, int height)
{
    if (!is_power_of_two(width) || !is_power_of_two(height)) return 1;
    int longer = width > height ? width : height, count = 1;
    while (longer > 1) longer /= 2, count++;
    return count;
}

void mip_halve(const float *texel, const float *coverage, int width, int height, int channels, float *out,
               float *out_coverage)
{
    int step_x = width > 1 ? 2 : 1, step_y = height > 1 ? 2 : 1;
    int out_width = width / step_x, out_height = height / step_y, count = step_x * step_y;
    for (int j = 0; j < out_height; j++)
        for (int i = 0; i < out_width; i++) {
            size_t at[4];
            double weight[4], total = 0;
            for (int n = 0; n < count; n++) {
                at[n] = (size_t)(j * step_y + n / step_x) * (size_t)width + (size_t)(i * step_x + n % step_x);
                weight[n] = coverage ? (double)coverage[at[n]] : 1;
                total += weight[n];
            }
            size_t to = (size_t)j * (size_t)out_width + (size_t)i;
            for (int c = 0; c < channels; c++) {
                double sum = 0;
                for (int n = 0; n < count; n++) {
                    double value = (double)texel[at[n] * (size_t)channels + (size_t)c];
                    sum += value * (total > 0 ? weight[n] / total : 1.0 / count);
                }
                out[to * (size_t)channels + (size_t)c] = (float)sum;
            }
            if (out_coverage) out_coverage[to] = (float)(total / count);
        }
}
