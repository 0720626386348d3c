/* SPDX-License-Identifier: MIT */
#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "vec3.h"

#define DEGREE (3.14159265358979323846 / 180)

void matrix_identity(double m[16])
{
    int i;

    for (i = 0; i < 16; i++) m[i] = i % 5 == 0;
}

void matrix_multiply(double out[16], const double a[16], const double b[16])
{
    int row, column;

    for (column = 0; column < 4; column++)
        for (row = 0; row < 4; row++)
            out[4 * column + row] = a[row] * b[4 * column] + a[4 + row] * b[4 * column + 1] +
                                    a[8 + row] * b[4 * column + 2] + a[12 + row] * b[4 * column + 3];
}

void matrix_apply(double out[4], const double m[16], const double v[4])
{
    int row;

    for (row = 0; row < 4; row++) out[row] = m[row] * v[0] + m[4 + row] * v[1] + m[8 + row] * v[2] + m[12 + row] * v[3];
}

/* Gauss-Jordan with the largest pivot of each column. */
int matrix_invert(double out[16], const double m[16])
{
    double a[4][8];
    int row, column, k;

    for (row = 0; row < 4; row++)
        for (column = 0; column < 4; column++) {
            a[row][column] = m[4 * column + row];
            a[row][4 + column] = row == column;
        }
    for (column = 0; column < 4; column++) {
        int pivot = column;
        for (row = column + 1; row < 4; row++)
            if (fabs(a[row][column]) > fabs(a[pivot][column])) pivot = row;
        if (!(fabs(a[pivot][column]) > 1e-300)) return 0;
        for (k = 0; k < 8; k++) {
            double t = a[column][k];
            a[column][k] = a[pivot][k];
            a[pivot][k] = t;
        }
        for (k = 7; k >= 0; k--) a[column][k] /= a[column][column];
        for (row = 0; row < 4; row++) {
            double factor = a[row][column];
            for (k = 0; k < 8 && row != column; k++) a[row][k] -= factor * a[column][k];
        }
    }
    for (row = 0; row < 4; row++)
        for (column = 0; column < 4; column++) out[4 * column + row] = a[row][4 + column];
    return 1;
}

void scene_begin(scene *s, const mesh *shape, int width, int height)
{
    *s = (scene){.shape = shape, .exposure = 1, .tint = {1, 1, 1}, .width = width, .height = height};
    s->exact_sphere = shape && !strcmp(shape->name, "sphere");
    matrix_identity(s->object_to_view);
    matrix_identity(s->view_to_clip);
}

static scene_light *next_light(scene *s, const double power[3])
{
    scene_light *light = &s->light[s->light_count++];
    int i;

    *light = (scene_light){0};
    for (i = 0; i < 3; i++) light->power[i] = power ? power[i] : 1;
    return light;
}

void scene_add_light(scene *s, double polar_deg, double azimuth_deg, const double power[3])
{
    light_direction(polar_deg, azimuth_deg, next_light(s, power)->direction);
}

void scene_add_point(scene *s, const double position[3], const double power[3])
{
    scene_light *light = next_light(s, power);

    light->point = 1;
    memcpy(light->position, position, sizeof light->position);
}

/* Rows of the rotation that takes world axes to those of a camera at the tip of back, looking along -back. */
static void camera_axes(double axes[3][3], const double back[3])
{
    double up[3] = {0, 1, 0};

    memcpy(axes[2], back, sizeof axes[2]);
    normalise3(axes[2]);
    if (fabs(axes[2][1]) > 0.9999) {
        up[1] = 0;
        up[2] = axes[2][1] > 0 ? -1 : 1;
    }
    cross3(axes[0], up, axes[2]);
    normalise3(axes[0]);
    cross3(axes[1], axes[2], axes[0]);
}

/* Rotation, then such a move that the point target (before rotation) comes to lie at (0, 0, -distance). */
static void place(double m[16], double axes[3][3], const double target[3], double distance)
{
    int row, column;

    matrix_identity(m);
    for (row = 0; row < 3; row++) {
        for (column = 0; column < 3; column++) m[4 * column + row] = axes[row][column];
        m[12 + row] = -dot3(axes[row], target) - (row == 2 ? distance : 0);
    }
}

/* +y by yaw, then +x by pitch, about the given centre. */
static void turn(double m[16], const scene_camera *camera, const double centre[3])
{
    double cy = cos(camera->yaw_deg * DEGREE), sy = sin(camera->yaw_deg * DEGREE);
    double cp = cos(camera->pitch_deg * DEGREE), sp = sin(camera->pitch_deg * DEGREE);
    const double rotation[9] = {cy, 0, sy, sp * sy, cp, -sp * cy, -cp * sy, sp, cp * cy}; /* by rows */
    int row, column;

    matrix_identity(m);
    for (row = 0; row < 3; row++) {
        for (column = 0; column < 3; column++) m[4 * column + row] = rotation[3 * row + column];
        m[12 + row] = centre[row] - dot3(&rotation[3 * row], centre);
    }
}

static void mesh_centre(const scene *s, double centre[3])
{
    float middle[3], half[3];
    int i;

    mesh_bounds(s->shape, middle, half);
    for (i = 0; i < 3; i++) centre[i] = s->exact_sphere ? 0 : middle[i];
}

void scene_turn(scene *s, double yaw_deg)
{
    const scene_camera camera = {.yaw_deg = yaw_deg};
    double centre[3], turned[16], before[16];

    mesh_centre(s, centre);
    turn(turned, &camera, centre);
    memcpy(before, s->object_to_view, sizeof before);
    matrix_multiply(s->object_to_view, before, turned);
}

typedef struct extent { /* of the mesh in view space, the camera still at its centre */
    double low[3], high[3];
    double distance; /* from which the perspective frame holds every vertex */
} extent;

static extent measure(const scene *s, const double to_view[16], double tan_x, double tan_y)
{
    extent e = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, -HUGE_VAL};
    int i, k;

    for (i = 0; i < s->shape->vertex_count; i++) {
        const float *p = s->shape->position[i];
        double v[4] = {p[0], p[1], p[2], 1}, q[4];
        matrix_apply(q, to_view, v);
        for (k = 0; k < 3; k++) {
            e.low[k] = fmin(e.low[k], q[k]);
            e.high[k] = fmax(e.high[k], q[k]);
        }
        e.distance = fmax(e.distance, q[2] + fmax(fabs(q[0]) / tan_x, fabs(q[1]) / tan_y));
    }
    return e;
}

/* Move the mesh across so that its outline, seen from so far, lies evenly about the axis. */
static void middle_to_axis(scene *s, double distance)
{
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    int i, k;

    for (i = 0; i < s->shape->vertex_count; i++) {
        const float *p = s->shape->position[i];
        double v[4] = {p[0], p[1], p[2], 1}, q[4], depth;
        matrix_apply(q, s->object_to_view, v);
        depth = isfinite(distance) ? (distance - q[2]) / distance : 1;
        for (k = 0; k < 2; k++) {
            low[k] = fmin(low[k], q[k] / depth);
            high[k] = fmax(high[k], q[k] / depth);
        }
    }
    for (k = 0; k < 2; k++) s->object_to_view[12 + k] -= (low[k] + high[k]) / 2;
}

static void perspective(double m[16], double tan_x, double tan_y, double near, double far)
{
    memset(m, 0, 16 * sizeof *m);
    m[0] = 1 / tan_x;
    m[5] = 1 / tan_y;
    m[10] = -(far + near) / (far - near);
    m[11] = -1;
    m[14] = -2 * far * near / (far - near);
}

static void orthographic(double m[16], double half_width, double half_height, double near, double far)
{
    matrix_identity(m);
    m[0] = 1 / half_width;
    m[5] = 1 / half_height;
    m[10] = -2 / (far - near);
    m[14] = -(far + near) / (far - near);
}

static void aim_perspective(scene *s, double distance, const extent *e, double tan_x, double tan_y, double radius)
{
    double near = fmax((distance - e->high[2]) * 0.8, radius * 0.02);
    double far = fmax((distance - e->low[2]) * 1.2, near * 4);

    perspective(s->view_to_clip, tan_x, tan_y, near, far);
}

static void aim_ortho(scene *s, const extent *e, double margin, double radius)
{
    double x = 1, y = 1, aspect = (double)s->width / s->height;

    if (!s->exact_sphere || margin > 0) {
        double used = 1 - 2 * margin;
        y = fmax(fmax(fabs(e->low[1]), fabs(e->high[1])), fmax(fabs(e->low[0]), fabs(e->high[0])) / aspect) / used;
        x = y * aspect;
    }
    orthographic(s->view_to_clip, x, y, radius * 0.5, radius * 3.5);
}

int scene_aim(scene *s, const scene_camera *camera, failure *f)
{
    double fovy = camera->fovy_deg > 0 ? camera->fovy_deg : 30;
    double margin = camera->margin > 0 ? camera->margin : 0.04;
    double tan_y = tan(fovy / 2 * DEGREE), tan_x = tan_y * s->width / s->height;
    double back[3] = {0, 0, 1}, axes[3][3], turned[16], view[16], centre[3], radius;
    float middle[3], half[3];
    extent e;
    int i;

    mesh_bounds(s->shape, middle, half);
    mesh_centre(s, centre);
    radius = s->exact_sphere ? 1 : sqrt((double)half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    if (!(radius > 0)) return fail(f, FAIL_INVALID, "%s: all vertices coincide, expected a mesh", s->shape->name);
    turn(turned, camera, centre);
    if (camera->kind == SCENE_CAMERA_LOOK) {
        double distance;
        for (i = 0; i < 3; i++) back[i] = camera->eye[i] - camera->target[i];
        distance = normalise3(back);
        if (!(distance > 0)) return fail(f, FAIL_USAGE, "--camera: eye and target coincide");
        camera_axes(axes, back);
        place(view, axes, camera->eye, 0);
        matrix_multiply(s->object_to_view, view, turned);
        e = measure(s, s->object_to_view, tan_x, tan_y);
        aim_perspective(s, 0, &e, tan_x, tan_y, radius);
        return FAIL_NONE;
    }
    camera_axes(axes, back);
    place(view, axes, centre, 0);
    matrix_multiply(s->object_to_view, view, turned);
    e = measure(s, s->object_to_view, tan_x * (1 - 2 * margin), tan_y * (1 - 2 * margin));
    /* What is seen lies about the middle of its own outline, not of the object's bounds; the near side looks larger. */
    for (i = 0; i < 8 && !s->exact_sphere; i++) {
        middle_to_axis(s, camera->kind == SCENE_CAMERA_ORTHO ? HUGE_VAL : e.distance);
        e = measure(s, s->object_to_view, tan_x * (1 - 2 * margin), tan_y * (1 - 2 * margin));
    }
    if (camera->kind == SCENE_CAMERA_ORTHO) {
        s->object_to_view[14] -= 2 * radius;
        aim_ortho(s, &e, s->exact_sphere ? camera->margin : margin, radius);
    } else {
        s->object_to_view[14] -= e.distance;
        aim_perspective(s, e.distance, &e, tan_x, tan_y, radius);
    }
    return FAIL_NONE;
}

/* What the mesh's vertices pass through in a whole turn about its centre, by steps. */
static mesh swept(const mesh *shape, const double centre[3])
{
    enum { STEPS = 24 };
    mesh out = {.vertex_count = STEPS * shape->vertex_count};
    int step, i, k;

    out.position = need_memory((size_t)out.vertex_count, sizeof *out.position);
    memcpy(out.name, shape->name, sizeof out.name);
    for (step = 0; step < STEPS; step++) {
        const scene_camera camera = {.yaw_deg = 360.0 * step / STEPS};
        double m[16];
        turn(m, &camera, centre);
        for (i = 0; i < shape->vertex_count; i++) {
            const float *p = shape->position[i];
            const double v[4] = {p[0], p[1], p[2], 1};
            double q[4];
            matrix_apply(q, m, v);
            for (k = 0; k < 3; k++) out.position[step * shape->vertex_count + i][k] = (float)q[k];
        }
    }
    return out;
}

int scene_aim_turntable(scene *s, const scene_camera *camera, failure *f)
{
    scene_camera still = *camera;
    const mesh *const shape = s->shape;
    double centre[3];
    mesh all;
    int code;

    still.yaw_deg = 0;
    if (s->exact_sphere) return scene_aim(s, &still, f);
    mesh_centre(s, centre);
    all = swept(shape, centre);
    s->shape = &all;
    code = scene_aim(s, &still, f);
    s->shape = shape;
    free(all.position);
    return code;
}

int scene_clip_to_object(const scene *s, double out[16])
{
    double to_clip[16];

    matrix_multiply(to_clip, s->view_to_clip, s->object_to_view);
    return matrix_invert(out, to_clip);
}

static void unproject(double out[3], const double clip_to_object[16], double x, double y, double z)
{
    double clip[4] = {x, y, z, 1}, p[4];
    int i;

    matrix_apply(p, clip_to_object, clip);
    for (i = 0; i < 3; i++) out[i] = p[i] / p[3];
}

static void sphere_frame(scene_hit *hit)
{
    const double *n = hit->normal;
    double ring = hypot(n[0], n[2]);

    hit->uv[0] = atan2(n[0], n[2]) / (360 * DEGREE);
    hit->uv[0] += hit->uv[0] < 0;
    hit->uv[1] = 0.5 + asin(fmax(-1, fmin(1, n[1]))) / (180 * DEGREE);
    hit->tangent[0] = ring > 0 ? n[2] / ring : 1;
    hit->tangent[1] = 0;
    hit->tangent[2] = ring > 0 ? -n[0] / ring : 0;
}

int scene_sphere_hit(const scene *s, const double clip_to_object[16], int i, int j, scene_hit *hit)
{
    double x = (2 * i + 1) / (double)s->width - 1, y = 1 - (2 * j + 1) / (double)s->height;
    double start[3], direction[3], along, missed, object[4], view[4], clip[4], point[4];
    int k;

    unproject(start, clip_to_object, x, y, -1);
    unproject(direction, clip_to_object, x, y, 1);
    for (k = 0; k < 3; k++) direction[k] -= start[k];
    if (!(normalise3(direction) > 0)) return 0;
    /* The ray's point nearest to the centre, then back by half the chord. */
    along = -dot3(start, direction);
    for (k = 0; k < 3; k++) point[k] = start[k] + along * direction[k];
    missed = dot3(point, point);
    if (missed > 1) return 0;
    along -= sqrt(1 - missed);
    if (along < 0) return 0;
    for (k = 0; k < 3; k++) hit->position[k] = hit->normal[k] = start[k] + along * direction[k];
    normalise3(hit->normal);
    sphere_frame(hit);
    memcpy(object, hit->position, sizeof hit->position);
    object[3] = 1;
    matrix_apply(view, s->object_to_view, object);
    matrix_apply(clip, s->view_to_clip, view);
    hit->z_ndc = clip[2] / clip[3];
    return 1;
}

static double decode(int output, int code)
{
    double y = code / 255.0;

    return output == NACRE_OUTPUT_SRGB ? srgb_decode(y) : output == NACRE_OUTPUT_SQRT ? y * y : y;
}

static double encode(int output, double linear)
{
    return output == NACRE_OUTPUT_SRGB ? srgb_encode(linear) : output == NACRE_OUTPUT_SQRT ? sqrt(linear) : linear;
}

void scene_average(const image_u8 *frame, int n, int output, image_u8 *out)
{
    double linear[256];
    int i, j, x, y, c;

    for (i = 0; i < 256; i++) linear[i] = decode(output, i);
    *out = image_u8_make(frame->width / n, frame->height / n, 4);
    for (j = 0; j < out->height; j++)
        for (i = 0; i < out->width; i++) {
            uint8_t *to = out->texel + 4 * ((size_t)j * (size_t)out->width + (size_t)i);
            double sum[3] = {0, 0, 0}, alpha = 0;
            for (y = j * n; y < (j + 1) * n; y++)
                for (x = i * n; x < (i + 1) * n; x++) {
                    const uint8_t *from = frame->texel + 4 * ((size_t)y * (size_t)frame->width + (size_t)x);
                    for (c = 0; c < 3; c++) sum[c] += linear[from[c]] * from[3] / 255;
                    alpha += from[3] / 255.0;
                }
            for (c = 0; c < 3 && alpha > 0; c++) to[c] = unorm8(encode(output, sum[c] / alpha));
            to[3] = unorm8(alpha / (n * n));
        }
}
