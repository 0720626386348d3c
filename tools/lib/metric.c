/* SPDX-License-Identifier: MIT */
#include "metric.h"

#include <math.h>

#include "vec3.h"

#define PI 3.14159265358979323846

int metric_normal(int i, int j, int size, double normal[3])
{
    double x = (2.0 * i + 1) / size - 1;
    double y = 1 - (2.0 * j + 1) / size;
    double z2 = 1 - x * x - y * y;
    if (z2 <= 0) return 0;
    normal[0] = x;
    normal[1] = y;
    normal[2] = sqrt(z2);
    return 1;
}

void metric_local(const double normal[3], double phi_deg, double to_light[3], double to_eye[3])
{
    double phi = phi_deg * (PI / 180);
    double light[3] = {sin(phi), 0, cos(phi)};
    double x[3] = {0, 0, 0};
    int axis = fabs(normal[0]) < 1 - 1e-9 ? 0 : 1;
    for (int k = 0; k < 3; k++) x[k] = (k == axis) - normal[axis] * normal[k];
    normalise3(x);
    double y[3] = {normal[1] * x[2] - normal[2] * x[1], normal[2] * x[0] - normal[0] * x[2],
                   normal[0] * x[1] - normal[1] * x[0]};
    to_light[0] = dot3(light, x);
    to_light[1] = dot3(light, y);
    to_light[2] = dot3(light, normal);
    to_eye[0] = x[2];
    to_eye[1] = y[2];
    to_eye[2] = normal[2];
}

void metric_frame(const brdf *b, double phi_deg, double scale, int size, image_u8 *out)
{
    *out = image_u8_make(size, size, 3);
    for (int j = 0; j < size; j++)
        for (int i = 0; i < size; i++) {
            double normal[3], to_light[3], to_eye[3], radiance[3];
            if (!metric_normal(i, j, size, normal)) continue;
            metric_local(normal, phi_deg, to_light, to_eye);
            brdf_eval_cosine(b, to_light, to_eye, radiance);
            uint8_t *texel = out->texel + 3 * ((size_t)j * (size_t)size + (size_t)i);
            for (int k = 0; k < 3; k++) texel[k] = unorm8(srgb_encode(PI * scale * radiance[k]));
        }
}

double metric_mse(const image_u8 *a, const image_u8 *b)
{
    double sum = 0, count = 0, normal[3];
    int size = a->width;
    for (int j = 0; j < size; j++)
        for (int i = 0; i < size; i++) {
            if (!metric_normal(i, j, size, normal)) continue;
            size_t at = 3 * ((size_t)j * (size_t)size + (size_t)i);
            for (size_t k = at; k < at + 3; k++) {
                double d = (double)a->texel[k] - (double)b->texel[k];
                sum += d * d;
            }
            count += 3;
        }
    return count > 0 ? sum / count : 0;
}

double metric_psnr(double mse)
{
    return mse > 0 ? fmin(99, 10 * log10(255.0 * 255.0 / mse)) : 99;
}

void metric_compare(const brdf *truth, const brdf *approximation, double stops, metric_result *out)
{
    double scale = brdf_exposure(truth) * exp2(-stops);
    double mse[METRIC_FRAMES], sum = 0;
    /* Frames are independent and summed in order afterwards: the figure does not depend on the threads. */
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < METRIC_FRAMES; k++) {
        image_u8 a, b;
        metric_frame(truth, METRIC_STEP_DEG * k, scale, METRIC_SIZE, &a);
        metric_frame(approximation, METRIC_STEP_DEG * k, scale, METRIC_SIZE, &b);
        mse[k] = metric_mse(&a, &b);
        image_u8_free(&a);
        image_u8_free(&b);
    }
    int worst = 0;
    for (int k = 0; k < METRIC_FRAMES; k++) {
        sum += mse[k];
        out->frame_db[k] = metric_psnr(mse[k]);
        if (mse[k] > mse[worst]) worst = k;
    }
    out->pooled_psnr_db = metric_psnr(sum / METRIC_FRAMES);
    out->worst_frame_db = out->frame_db[worst];
    out->worst_frame_deg = METRIC_STEP_DEG * worst;
}
