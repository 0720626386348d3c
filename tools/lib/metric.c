/* SPDX-License-Identifier: MIT */
#include "metric.h"

#include <math.h>
#include <stdlib.h>

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

int metric_pixel(int i, int j, int size, double fov_deg, double normal[3], double to_eye[3])
{
    to_eye[0] = to_eye[1] = 0;
    to_eye[2] = 1;
    if (!(fov_deg > 0)) return metric_normal(i, j, size, normal);
    double half = fov_deg / 2 * (PI / 180), slope = tan(half), distance = 1 / sin(half);
    double ray[3] = {((2.0 * i + 1) / size - 1) * slope, (1 - (2.0 * j + 1) / size) * slope, -1};
    normalise3(ray);
    double along = -distance * ray[2], missed = distance * distance - along * along;
    if (missed >= 1) return 0;
    along -= sqrt(1 - missed);
    for (int k = 0; k < 3; k++) {
        normal[k] = along * ray[k] + (k == 2) * distance;
        to_eye[k] = -ray[k];
    }
    normalise3(normal);
    return 1;
}

static void direction_of(double phi_deg, double light[3])
{
    double phi = phi_deg * (PI / 180);
    light[0] = sin(phi);
    light[1] = 0;
    light[2] = cos(phi);
}

/* Axes of the frame of a normal. */
static void local_axes(const double normal[3], double axes[3][3])
{
    int axis = fabs(normal[0]) < 1 - 1e-9 ? 0 : 1;
    for (int k = 0; k < 3; k++) {
        axes[0][k] = (k == axis) - normal[axis] * normal[k];
        axes[2][k] = normal[k];
    }
    normalise3(axes[0]);
    cross3(axes[1], axes[2], axes[0]);
}

static void turn(double axes[3][3], const double v[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = dot3(v, axes[k]);
}

void metric_local(const double normal[3], double phi_deg, double to_light[3], double to_eye[3])
{
    static const double eye[3] = {0, 0, 1};
    double axes[3][3], light[3];
    local_axes(normal, axes);
    direction_of(phi_deg, light);
    turn(axes, light, to_light);
    turn(axes, eye, to_eye);
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

void metric_frames_free(metric_frames *frames)
{
    for (int k = 0; k < METRIC_FRAMES; k++) {
        for (int light = 0; light < METRIC_LIGHTS; light++) image_u8_free(&frames->shown[light][k]);
        image_f32_free(&frames->linear[k]);
    }
}

/* What a pixel of every frame has in common. */
typedef struct pixel {
    size_t at; /* of its first channel */
    double axes[3][3], to_eye[3];
} pixel;

static pixel *disc_pixels(double fov_deg, int *count)
{
    pixel *disc = need_memory(METRIC_SIZE * METRIC_SIZE, sizeof *disc);
    *count = 0;
    for (int at = 0; at < METRIC_SIZE * METRIC_SIZE; at++) {
        double normal[3], eye[3];
        pixel *p = &disc[*count];
        if (!metric_pixel(at % METRIC_SIZE, at / METRIC_SIZE, METRIC_SIZE, fov_deg, normal, eye)) continue;
        p->at = 3 * (size_t)at;
        local_axes(normal, p->axes);
        turn(p->axes, eye, p->to_eye);
        ++*count;
    }
    return disc;
}

static void draw_one(metric_frames *out, int frame, const brdf *b, double exposure, pixel *disc, int count)
{
    double light[3];
    direction_of(METRIC_STEP_DEG * frame, light);
    for (int k = 0; k < METRIC_LIGHTS; k++) out->shown[k][frame] = image_u8_make(METRIC_SIZE, METRIC_SIZE, 3);
    out->linear[frame] = image_f32_make(METRIC_SIZE, METRIC_SIZE, 3);
    for (pixel *p = disc; p < disc + count; p++) {
        double to_light[3], f_cos[3];
        turn(p->axes, light, to_light);
        brdf_eval_cosine(b, to_light, p->to_eye, f_cos);
        for (size_t c = 0; c < 3; c++) {
            double radiance = PI * exposure * f_cos[c];
            out->linear[frame].texel[p->at + c] = (float)radiance;
            out->shown[METRIC_FULL][frame].texel[p->at + c] = unorm8(srgb_encode(radiance));
            out->shown[METRIC_DIM][frame].texel[p->at + c] = unorm8(srgb_encode(radiance * exp2(-METRIC_DIM_STOPS)));
        }
    }
}

void metric_draw(metric_frames *out, const brdf *b, double exposure, double fov_deg)
{
    int count;
    pixel *disc = disc_pixels(fov_deg, &count);
    *out = (metric_frames){0};
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < METRIC_FRAMES; k++) draw_one(out, k, b, exposure, disc, count);
    free(disc);
}

void metric_score(metric_result *out, const metric_frames *truth, const metric_frames *other, int light)
{
    double mse[METRIC_FRAMES], sum = 0;
    int worst = 0;
    for (int k = 0; k < METRIC_FRAMES; k++) {
        mse[k] = metric_mse(&truth->shown[light][k], &other->shown[light][k]);
        sum += mse[k];
        out->frame_db[k] = metric_psnr(mse[k]);
        if (mse[k] > mse[worst]) worst = k;
    }
    out->pooled_psnr_db = metric_psnr(sum / METRIC_FRAMES);
    out->worst_frame_db = out->frame_db[worst];
    out->worst_frame_deg = METRIC_STEP_DEG * worst;
}

double metric_relative_rms(const metric_frames *truth, const metric_frames *other)
{
    double error = 0, total = 0;
    for (int k = 0; k < METRIC_FRAMES; k++)
        for (int i = 0; i < METRIC_SIZE * METRIC_SIZE * 3; i++) { /* both are 0 outside the disc */
            double t = (double)truth->linear[k].texel[i], d = (double)other->linear[k].texel[i] - t;
            error += d * d;
            total += t * t;
        }
    return error > 0 ? sqrt(error / total) : 0;
}

void metric_compare(const brdf *truth, const brdf *approximation, double stops, metric_result *out)
{
    double scale = brdf_exposure(truth) * exp2(-stops);
    metric_frames a, b;
    metric_draw(&a, truth, scale, 0);
    metric_draw(&b, approximation, scale, 0);
    metric_score(out, &a, &b, METRIC_FULL);
    metric_frames_free(&a);
    metric_frames_free(&b);
}
