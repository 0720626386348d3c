/* SPDX-License-Identifier: MIT */
/*
 * The reference renderer. Bands of rows keep memory small: each band is rasterised into what its pixels see (vertices
 * are transformed once), and every covered pixel is then shaded at its centre.
 */
#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "vec3.h"

#define PI        3.14159265358979323846
#define BAND_ROWS 16

/* Grazing normals of a coarse mesh may face away from the eye. The material is then seen at this cosine. */
#define LEAST_COSINE 1e-4

typedef struct vertex { /* of the transformed mesh */
    double clip[4], view[3], normal[3], tangent[3], uv[2], handedness;
} vertex;

typedef struct seen { /* by one pixel */
    double depth;     /* normalised device z; above 1 where nothing is seen */
    double view[3], normal[3], tangent[3], uv[2], handedness;
} seen;

typedef struct frame {
    const scene *s;
    const brdf *b;
    const image_u8 *normal_map;
    double clip_to_object[16], normal_to_view[16]; /* the latter without its last row and column */
    double ambient[3], to_eye[3];
    int one_eye; /* to_eye holds for every pixel */
    vertex *vertices;
} frame;

static void turn3(double out[3], const double m[16], const double v[3])
{
    int row;

    for (row = 0; row < 3; row++) out[row] = m[row] * v[0] + m[4 + row] * v[1] + m[8 + row] * v[2];
}

/* ---- material ------------------------------------------------------------------------------------------------ */

static void local(double out[3], double axes[3][3], const double v[3])
{
    int i;

    for (i = 0; i < 3; i++) out[i] = dot3(axes[i], v);
}

static void frame_of(double axes[3][3], const double normal[3], const double tangent[3])
{
    double along, length;
    int i;

    memcpy(axes[2], normal, sizeof axes[2]);
    along = dot3(tangent, normal);
    for (i = 0; i < 3; i++) axes[0][i] = tangent[i] - along * normal[i];
    length = sqrt(dot3(axes[0], axes[0]));
    if (!(length > 1e-9)) {
        double side[3] = {fabs(normal[0]) < 0.7, fabs(normal[0]) >= 0.7, 0};
        cross3(axes[0], side, normal);
    }
    normalise3(axes[0]);
    cross3(axes[1], axes[2], axes[0]);
}

/* Towards the light, and the irradiance on a surface that faces it. */
static void arriving(const scene_light *light, const double at[3], double to_light[3], double power[3])
{
    double scale = 1 - light->shadow;
    int i;

    for (i = 0; i < 3; i++) to_light[i] = light->point ? light->position[i] - at[i] : light->direction[i];
    if (light->point) scale /= fmax(dot3(to_light, to_light), 1e-12);
    normalise3(to_light);
    for (i = 0; i < 3; i++) power[i] = scale * fmax(light->power[i], 0);
}

/* f_r cos at a place of the surface; 0 where there are no data. */
static int reflects(const brdf *b, const double uv[2], const double to_light[3], const double to_eye[3],
                    double f_cos[3])
{
    int i;

    if (!b->eval_at) return brdf_eval_cosine(b, to_light, to_eye, f_cos);
    b->eval_at(b, uv, to_light, to_eye, f_cos);
    for (i = 0; i < 3; i++) f_cos[i] *= fmax(to_light[2], 0);
    return 1;
}

static void add_light(const frame *r, const double uv[2], double axes[3][3], const double eye[3],
                      const double to_light[3], const double power[3], double radiance[3])
{
    double light[3], f_cos[3];
    int i;

    local(light, axes, to_light);
    if (!reflects(r->b, uv, light, eye, f_cos)) return;
    for (i = 0; i < 3; i++) radiance[i] += f_cos[i] * power[i];
}

static void reflected(const frame *r, const seen *p, const double normal[3], double radiance[3])
{
    double axes[3][3], to_eye[3], eye[3];
    int i, k;

    frame_of(axes, normal, p->tangent);
    for (i = 0; i < 3; i++) to_eye[i] = r->one_eye ? r->to_eye[i] : -p->view[i];
    normalise3(to_eye);
    local(eye, axes, to_eye);
    eye[2] = fmax(eye[2], LEAST_COSINE);
    normalise3(eye);
    memcpy(radiance, r->ambient, 3 * sizeof *radiance);
    for (k = 0; k < r->s->light_count; k++) {
        double to_light[3], power[3];
        arriving(&r->s->light[k], p->view, to_light, power);
        add_light(r, p->uv, axes, eye, to_light, power, radiance);
    }
    for (k = 0; r->s->distant && k < r->s->distant->count; k++) {
        const distant_light *light = &r->s->distant->light[k];
        add_light(r, p->uv, axes, eye, light->direction, light->irradiance, radiance);
    }
}

static double coded(int output, double linear)
{
    double y = fmax(0, fmin(1, linear));

    return output == NACRE_OUTPUT_SRGB ? srgb_encode(y) : output == NACRE_OUTPUT_SQRT ? sqrt(y) : y;
}

/* Bilinear, repeated; row 0 of the picture is v = 1. */
static void look_up(const image_u8 *map, const double uv[2], double out[3])
{
    double x = uv[0] * map->width - 0.5, y = (1 - uv[1]) * map->height - 0.5;
    double fx = x - floor(x), fy = y - floor(y);
    int i, k, c;

    memset(out, 0, 3 * sizeof *out);
    for (k = 0; k < 4; k++) {
        long column = (long)floor(x) + (k & 1), row = (long)floor(y) + (k >> 1);
        double weight = (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
        column = (column % map->width + map->width) % map->width;
        row = (row % map->height + map->height) % map->height;
        i = (int)((row * map->width + column) * map->channels);
        for (c = 0; c < 3; c++) out[c] += weight * (2 * map->texel[i + c] / 255.0 - 1);
    }
}

static void shade(const frame *r, const seen *p, uint8_t *to)
{
    double normal[3], radiance[3], bumped[3], axes[3][3], map[3];
    int i;

    memcpy(normal, p->normal, sizeof normal);
    normalise3(normal);
    if (r->normal_map) {
        frame_of(axes, normal, p->tangent);
        look_up(r->normal_map, p->uv, map);
        for (i = 0; i < 3; i++)
            bumped[i] = map[0] * axes[0][i] + map[1] * p->handedness * axes[1][i] + map[2] * axes[2][i];
        memcpy(normal, bumped, sizeof normal);
        normalise3(normal);
    }
    reflected(r, p, normal, radiance);
    for (i = 0; i < 3; i++) to[i] = unorm8(coded(r->s->output, radiance[i] * r->s->tint[i] * r->s->exposure));
    to[3] = 255;
}

/* ---- geometry ------------------------------------------------------------------------------------------------ */

static void transform(frame *r)
{
    const mesh *m = r->s->shape;
    int i, k;

    r->vertices = need_memory((size_t)m->vertex_count, sizeof *r->vertices);
    for (i = 0; i < m->vertex_count; i++) {
        vertex *v = &r->vertices[i];
        double object[4] = {m->position[i][0], m->position[i][1], m->position[i][2], 1}, view[4];
        double normal[3] = {m->normal[i][0], m->normal[i][1], m->normal[i][2]}, tangent[3] = {0, 0, 0};
        matrix_apply(view, r->s->object_to_view, object);
        matrix_apply(v->clip, r->s->view_to_clip, view);
        memcpy(v->view, view, sizeof v->view);
        turn3(v->normal, r->normal_to_view, normal);
        for (k = 0; k < 3 && m->tangent; k++) tangent[k] = m->tangent[i][k];
        turn3(v->tangent, r->s->object_to_view, tangent);
        v->handedness = m->tangent ? m->tangent[i][3] : 1;
        for (k = 0; k < 2 && m->uv; k++) v->uv[k] = m->uv[i][k];
    }
}

/* out = sum of weight[i] x corner[i], every attribute. */
static void mix(const vertex *const corner[3], const double weight[3], seen *out)
{
    int i, k;

    memset(out, 0, sizeof *out);
    for (i = 0; i < 3; i++) {
        for (k = 0; k < 3; k++) {
            out->view[k] += weight[i] * corner[i]->view[k];
            out->normal[k] += weight[i] * corner[i]->normal[k];
            out->tangent[k] += weight[i] * corner[i]->tangent[k];
        }
        out->uv[0] += weight[i] * corner[i]->uv[0];
        out->uv[1] += weight[i] * corner[i]->uv[1];
        out->handedness += weight[i] * corner[i]->handedness;
    }
    out->handedness = out->handedness < 0 ? -1 : 1;
}

/* Weights of the plane's corners where the pixel centre (x, y), in normalised device coordinates, meets the plane of
   the triangle: the rows of adj(corners' (x, y, w)), so that no corner is divided by a w that may be 0 or less
   (Olano and Greer 1997, "Triangle scan conversion using 2D homogeneous coordinates"). */
static int edges(const vertex *const corner[3], double edge[3][3])
{
    const double *a = corner[0]->clip, *b = corner[1]->clip, *c = corner[2]->clip;
    const double p[3][3] = {{a[0], a[1], a[3]}, {b[0], b[1], b[3]}, {c[0], c[1], c[3]}};
    double determinant;
    int i, k;

    for (i = 0; i < 3; i++) cross3(edge[i], p[(i + 1) % 3], p[(i + 2) % 3]);
    determinant = dot3(p[0], edge[0]);
    if (!(fabs(determinant) > 1e-300)) return 0;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) edge[i][k] /= determinant;
    return 1;
}

/* Pixels in low..high - 1 that the triangle may touch along one axis; all of them when a corner is behind the eye. */
static void reach(const vertex *const corner[3], int axis, double sign, int size, int *low, int *high)
{
    double least = HUGE_VAL, most = -HUGE_VAL;
    int i;

    for (i = 0; i < 3; i++) {
        double w = corner[i]->clip[3], x;
        if (!(w > 1e-12)) return;
        x = (sign * corner[i]->clip[axis] / w + 1) / 2 * size;
        least = fmin(least, x);
        most = fmax(most, x);
    }
    *low = (int)fmax(*low, fmin(floor(least - 0.5), *high));
    *high = (int)fmin(*high, fmax(ceil(most + 0.5), *low));
}

static void rasterise(const frame *r, const vertex *const corner[3], int first_row, int end_row, seen *band)
{
    const scene *s = r->s;
    double edge[3][3];
    int x0 = 0, x1 = s->width, y0 = first_row, y1 = end_row, i, j, k;

    reach(corner, 1, -1, s->height, &y0, &y1);
    if (y0 >= y1) return;
    reach(corner, 0, 1, s->width, &x0, &x1);
    if (x0 >= x1 || !edges(corner, edge)) return;
    for (j = y0; j < y1; j++)
        for (i = x0; i < x1; i++) {
            double at[3] = {(2 * i + 1) / (double)s->width - 1, 1 - (2 * j + 1) / (double)s->height, 1};
            double weight[3], inverse_w, depth = 0;
            seen *to = &band[(size_t)(j - first_row) * (size_t)s->width + (size_t)i];
            for (k = 0; k < 3; k++) weight[k] = dot3(edge[k], at);
            if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0) continue;
            inverse_w = weight[0] + weight[1] + weight[2];
            if (!(inverse_w > 0)) continue;
            for (k = 0; k < 3; k++) depth += weight[k] * corner[k]->clip[2];
            if (!(depth >= -1 && depth < to->depth && depth <= 1)) continue;
            for (k = 0; k < 3; k++) weight[k] /= inverse_w;
            mix(corner, weight, to);
            to->depth = depth;
        }
}

static void draw_mesh(const frame *r, int first_row, int end_row, seen *band)
{
    const mesh *m = r->s->shape;
    int i, k;

    for (i = 0; i + 2 < m->index_count; i += 3) {
        const vertex *corner[3];
        for (k = 0; k < 3; k++) corner[k] = &r->vertices[m->index[i + k]];
        rasterise(r, corner, first_row, end_row, band);
    }
}

static void draw_sphere(const frame *r, int first_row, int end_row, seen *band)
{
    int i, j;

    for (j = first_row; j < end_row; j++)
        for (i = 0; i < r->s->width; i++) {
            seen *to = &band[(size_t)(j - first_row) * (size_t)r->s->width + (size_t)i];
            double object[4] = {0, 0, 0, 1}, view[4];
            scene_hit hit;
            if (!scene_sphere_hit(r->s, r->clip_to_object, i, j, &hit) || fabs(hit.z_ndc) > 1) continue;
            memcpy(object, hit.position, sizeof hit.position);
            matrix_apply(view, r->s->object_to_view, object);
            memcpy(to->view, view, sizeof to->view);
            turn3(to->normal, r->normal_to_view, hit.normal);
            turn3(to->tangent, r->s->object_to_view, hit.tangent);
            memcpy(to->uv, hit.uv, sizeof to->uv);
            to->handedness = 1;
            to->depth = hit.z_ndc;
        }
}

static void draw_band(const frame *r, int first_row, image_u8 *out)
{
    int end_row = first_row + BAND_ROWS < out->height ? first_row + BAND_ROWS : out->height;
    size_t count = (size_t)(end_row - first_row) * (size_t)out->width, i;
    seen *band = need_memory(count, sizeof *band);
    uint8_t *to = out->texel + 4 * (size_t)first_row * (size_t)out->width;

    for (i = 0; i < count; i++) band[i].depth = 2;
    if (r->s->exact_sphere)
        draw_sphere(r, first_row, end_row, band);
    else
        draw_mesh(r, first_row, end_row, band);
    for (i = 0; i < count; i++)
        if (band[i].depth <= 1) shade(r, &band[i], to + 4 * i);
    free(band);
}

/* ---- the shot ------------------------------------------------------------------------------------------------ */

/* Normals go by the inverse transpose. */
static int set_normal_matrix(frame *r)
{
    double inverse[16];
    int row, column;

    if (!matrix_invert(inverse, r->s->object_to_view)) return 0;
    for (row = 0; row < 4; row++)
        for (column = 0; column < 4; column++) r->normal_to_view[4 * column + row] = inverse[4 * row + column];
    return 1;
}

/* The distant viewer looks along -z under an orthographic camera, and at the mesh's centre under a perspective one. */
static void set_eye(frame *r)
{
    const double *p = r->s->view_to_clip;
    int orthographic = p[3] == 0 && p[7] == 0 && p[11] == 0, i;
    float middle[3], half[3];
    double centre[4] = {0, 0, 0, 1}, view[4];

    r->one_eye = orthographic || r->s->distant_viewer;
    r->to_eye[2] = 1;
    if (orthographic || !r->one_eye) return;
    mesh_bounds(r->s->shape, middle, half);
    for (i = 0; i < 3; i++) centre[i] = r->s->exact_sphere ? 0 : middle[i];
    matrix_apply(view, r->s->object_to_view, centre);
    for (i = 0; i < 3; i++) r->to_eye[i] = -view[i];
    normalise3(r->to_eye);
}

static void set_ambient(frame *r, const double albedo[3])
{
    const double *irradiance = r->s->ambient;
    double own[3] = {0, 0, 0};
    int i;

    if (!(irradiance[0] > 0 || irradiance[1] > 0 || irradiance[2] > 0)) return;
    if (!albedo) brdf_albedo(r->b, own);
    for (i = 0; i < 3; i++) r->ambient[i] = (albedo ? albedo[i] : own[i]) * fmax(irradiance[i], 0) / PI;
}

int scene_draw_double(const scene *s, const brdf *b, const double albedo[3], const image_u8 *normal_map, image_u8 *out,
                      failure *f)
{
    frame r = {.s = s, .b = b, .normal_map = normal_map};
    int row;

    if (s->width < 1 || s->height < 1 || s->light_count < 0 || s->light_count > SCENE_MAX_LIGHTS)
        return fail(f, FAIL_INTERNAL, "scene of %dx%d with %d lights", s->width, s->height, s->light_count);
    if (!set_normal_matrix(&r) || !scene_clip_to_object(s, r.clip_to_object))
        return fail(f, FAIL_USAGE, "the camera's matrix has no inverse");
    set_eye(&r);
    set_ambient(&r, albedo);
    if (!s->exact_sphere) transform(&r);
    *out = image_u8_make(s->width, s->height, 4);
    progress_begin(s->progress, "rows", s->height);
#pragma omp parallel for schedule(dynamic)
    for (row = 0; row < s->height; row += BAND_ROWS) {
        draw_band(&r, row, out);
        progress_add(s->progress, fmin(BAND_ROWS, s->height - row));
    }
    progress_end(s->progress);
    free(r.vertices);
    return FAIL_NONE;
}
