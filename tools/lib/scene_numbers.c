/* SPDX-License-Identifier: MIT */
#include "scene_numbers.h"

#include <math.h>
#include <stdlib.h>

static nacre_q16 q16(double x)
{
    double y = x * 65536;

    return y >= INT32_MAX ? INT32_MAX : y <= INT32_MIN ? INT32_MIN : (nacre_q16)lrint(y);
}

static nacre_rgb rgb(const double x[3])
{
    nacre_rgb out = {q16(x[0]), q16(x[1]), q16(x[2])};

    return out;
}

static nacre_mat4 mat4(const double m[16])
{
    nacre_mat4 out;
    int i;

    for (i = 0; i < 16; i++) out.m[i] = q16(m[i]);
    return out;
}

static void set_light(nacre_light *out, const scene_light *light)
{
    int i;

    *out = (nacre_light){.type = light->point ? NACRE_LIGHT_POINT : NACRE_LIGHT_DIRECTIONAL};
    out->direction.x = (nacre_q14)lrint(light->direction[0] * 16384);
    out->direction.y = (nacre_q14)lrint(light->direction[1] * 16384);
    out->direction.z = (nacre_q14)lrint(light->direction[2] * 16384);
    for (i = 0; i < 3; i++) out->position[i] = q16(light->position[i]);
    out->power = rgb(light->power);
    out->shadow = (nacre_q14)lrint(light->shadow * 16384);
}

static void set_distant(nacre_light *out, const distant_light *from)
{
    scene_light light = {0};
    int i;

    for (i = 0; i < 3; i++) {
        light.direction[i] = from->direction[i];
        light.power[i] = from->irradiance[i];
    }
    set_light(out, &light);
}

/* lights: room for all of both kinds. */
static void set_view(nacre_view *view, nacre_light *lights, const scene *s)
{
    const int distant = s->distant ? s->distant->count : 0;
    int i;

    *view = (nacre_view){
        .lights = lights, .light_count = (uint16_t)(s->light_count + distant), .output = (uint8_t)s->output};
    view->object_to_view = mat4(s->object_to_view);
    view->view_to_clip = mat4(s->view_to_clip);
    view->distant_viewer = s->distant_viewer != 0;
    view->exposure = q16(s->exposure);
    view->ambient = rgb(s->ambient);
    view->tint = rgb(s->tint);
    /* 0 means 1 to the runtime; the smallest number stands for none. */
    if (!view->exposure) view->exposure = 1;
    if (!view->tint.r && !view->tint.g && !view->tint.b) view->tint.r = view->tint.g = view->tint.b = 1;
    for (i = 0; i < s->light_count; i++) set_light(&lights[i], &s->light[i]);
    for (i = 0; i < distant; i++) set_distant(&lights[s->light_count + i], &s->distant->light[i]);
}

/* The runtime's q16 numbers are exact to 1.5e-5: a mesh of millimetres, or of kilometres, is drawn scaled to about
   one unit, its camera and point lights with it. The picture is the same. */
static double unit_scale(const mesh *m)
{
    float centre[3], half[3];
    double largest = 0;
    int i;

    mesh_bounds(m, centre, half);
    for (i = 0; i < 3; i++) largest = fmax(largest, fmax(half[i], fabs(centre[i]) / 16));
    return largest > 0 && (largest < 0.5 || largest > 16) ? 1 / largest : 1;
}

static void scale_view(scene *s, double k)
{
    double *p = s->view_to_clip;
    int i, c, perspective = p[3] != 0 || p[7] != 0 || p[11] != 0;

    for (i = 12; i < 15; i++) s->object_to_view[i] *= k;
    /* P diag(1/k) gives the same clip coordinates; a perspective one may then be multiplied by k as a whole. */
    for (i = 0; i < 12 && !perspective; i++) p[i] /= k;
    for (i = 12; i < 16 && perspective; i++) p[i] *= k;
    for (i = 0; i < s->light_count; i++) {
        if (!s->light[i].point) continue;
        for (c = 0; c < 3; c++) {
            s->light[i].position[c] *= k;
            s->light[i].power[c] *= k * k;
        }
    }
}

void scene_numbers_open(scene_numbers *out, const scene *s)
{
    const double k = s->exact_sphere ? 1 : unit_scale(s->shape);
    int i, c;

    out->scaled = *s;
    out->shape = *s->shape;
    out->position = NULL;
    if (k != 1) {
        out->position = need_memory((size_t)out->shape.vertex_count, sizeof *out->position);
        for (i = 0; i < out->shape.vertex_count; i++)
            for (c = 0; c < 3; c++) out->position[i][c] = (float)(out->shape.position[i][c] * k);
        out->shape.position = out->position;
        out->scaled.shape = &out->shape;
        scale_view(&out->scaled, k);
    }
    out->lights = need_memory((size_t)(s->light_count + (s->distant ? s->distant->count : 0)), sizeof *out->lights);
    set_view(&out->view, out->lights, &out->scaled);
}

void scene_numbers_close(scene_numbers *n)
{
    free(n->position);
    free(n->lights);
}
