/* SPDX-License-Identifier: MIT */
/* nacre shot: a mesh in a material, under lights, to a PNG. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "options.h"
#include "png_io.h"
#include "scene.h"
#include "shot_lights.h"
#include "turntable.h"

enum { BACKEND_SOFT = GL_BACKEND_COUNT, BACKEND_DOUBLE, BACKEND_COUNT };
static const char *const backend_names[BACKEND_COUNT] = {"egl2", "egl3", "osmesa", "soft", "double"};
static const char *const output_names[] = {"srgb", "sqrt", "linear"}; /* in the order of nacre_output */

typedef struct shot {
    const char *output_path;
    int backend, samples;
    option_texts mesh, material, size, camera, turn, backend_name, output, exposure, ambient, tint, turning;
    int ortho, threads, lit_size;
    shot_lights lights;
    turntable table; /* frames 0: one picture */
    int turn_lights; /* the turntable's: 0: the mesh turns */
    double yaw_deg;
    scene_gles *gles; /* NULL: the reference renderer draws */
    progress meter;
    mesh shape;
    scene_material material_open;
    scene s;
} shot;

/* The only text of an option that may be given once; NULL if it was not given. */
static int single(const option_texts *texts, const char *name, const char **out, failure *f)
{
    *out = texts->count ? texts->item[0] : NULL;
    if (texts->count > 1) return fail(f, FAIL_USAGE, "%s: given %d times, expected once", name, texts->count);
    return FAIL_NONE;
}

/* A word out of a list. */
static int choose(const option_texts *texts, const char *name, const char *const *words, int count, int *out,
                  failure *f)
{
    const char *text;
    char list[100] = ""; /* the longest list has 26 characters */
    int i, code = single(texts, name, &text, f);

    if (code || !text) return code;
    for (i = 0; i < count; i++)
        if (!strcmp(text, words[i])) {
            *out = i;
            return FAIL_NONE;
        }
    for (i = 0; i < count; i++) {
        strcat(list, i ? i == count - 1 ? " or " : ", " : "");
        strcat(list, words[i]);
    }
    return fail(f, FAIL_USAGE, "%s %s: unknown, expected %s", name, text, list);
}

/* Three numbers that are not negative. */
static int parse_rgb(const option_texts *texts, const char *name, double out[3], failure *f)
{
    const char *text;
    int i, count, code = single(texts, name, &text, f);

    if (code || !text) return code;
    code = parse_reals(text, name, out, 3, 3, &count, f);
    for (i = 0; i < 3 && !code; i++)
        if (out[i] < 0) code = fail(f, FAIL_USAGE, "%s %s: %g, expected 0 or more", name, text, out[i]);
    return code;
}

static int parse_lights(shot *t, failure *f)
{
    const shot_lights *l = &t->lights;

    if (!(l->light.count || l->point.count || l->files.count || l->env.count || t->ambient.count))
        return fail(f, FAIL_USAGE,
                    "no light: expected --light polar,azimuth, --point x,y,z, --env MAP.hdr or "
                    "--lights-file FILE");
    return shot_lights_parse(&t->lights, &t->s, t->backend == BACKEND_DOUBLE, f);
}

static int parse_turntable(shot *t, failure *f)
{
    const char *text;
    int code = single(&t->turning, "--turning", &text, f);

    if (code) return code;
    if (!t->table.frames) {
        if (text) return fail(f, FAIL_USAGE, "--turning %s: expected --turntable N with it", text);
        return FAIL_NONE;
    }
    if (text && strcmp(text, "mesh") && strcmp(text, "lights"))
        return fail(f, FAIL_USAGE, "--turning %s: unknown, expected mesh or lights", text);
    t->turn_lights = text && !strcmp(text, "lights");
    if (t->turn_lights && t->lights.point.count)
        return fail(f, FAIL_USAGE, "--turning lights with --point: expected directional lights only");
    t->table.path = t->output_path;
    return turntable_check(&t->table, f);
}

static int parse_camera(shot *t, failure *f)
{
    scene_camera camera = {0};
    const char *text, *turned;
    double v[7] = {0}, angle[2] = {0, 0};
    int i, count, code;

    if ((code = single(&t->camera, "--camera", &text, f)) || (code = single(&t->turn, "--turn", &turned, f)))
        return code;
    if (turned && (code = parse_reals(turned, "--turn", angle, 1, 2, &count, f))) return code;
    camera.yaw_deg = angle[0];
    camera.pitch_deg = angle[1];
    if (t->ortho) {
        if (text) return fail(f, FAIL_USAGE, "--camera and --ortho: expected one of them");
        camera.kind = SCENE_CAMERA_ORTHO;
    } else if (text) {
        if ((code = parse_reals(text, "--camera", v, 6, 7, &count, f))) return code;
        for (i = 0; i < 3; i++) {
            camera.eye[i] = v[i];
            camera.target[i] = v[3 + i];
        }
        if (count == 7 && !(v[6] >= 1 && v[6] <= 170))
            return fail(f, FAIL_USAGE, "--camera %s: fovy %g, expected 1..170 degrees", text, v[6]);
        camera.fovy_deg = v[6];
        camera.kind = SCENE_CAMERA_LOOK;
    }
    t->yaw_deg = camera.yaw_deg;
    return t->table.frames ? scene_aim_turntable(&t->s, &camera, f) : scene_aim(&t->s, &camera, f);
}

static int parse_numbers(shot *t, failure *f)
{
    const char *text;
    int count, code = single(&t->exposure, "--exposure", &text, f);

    if (code) return code;
    if (text) {
        code = parse_reals(text, "--exposure", &t->s.exposure, 1, 1, &count, f);
        if (code) return code;
        if (!(t->s.exposure > 0 && t->s.exposure <= 32767))
            return fail(f, FAIL_USAGE, "--exposure %s: expected above 0, at most 32767", text);
    }
    if ((code = parse_rgb(&t->ambient, "--ambient", t->s.ambient, f))) return code;
    return parse_rgb(&t->tint, "--tint", t->s.tint, f);
}

static int parse_frame(shot *t, int *width, int *height, failure *f)
{
    const char *text;
    int code = single(&t->size, "--size", &text, f);

    *width = *height = 512;
    if (code) return code;
    if (text && (code = parse_size(text, "--size", SCENE_MAX_SIZE, width, height, f))) return code;
    if (*width * t->samples > GL_HEADLESS_MAX_SIZE || *height * t->samples > GL_HEADLESS_MAX_SIZE)
        return fail(f, FAIL_USAGE, "--size %dx%d --samples %d: %dx%d in all, expected at most %d a side", *width,
                    *height, t->samples, *width * t->samples, *height * t->samples, GL_HEADLESS_MAX_SIZE);
    return FAIL_NONE;
}

/* All of the command line that needs no file is looked at before any file is. */
static int set_up(shot *t, failure *f)
{
    const char *mesh_name, *material;
    int width, height, code;

    t->backend = GL_BACKEND_EGL2;
    if (!t->output_path) return fail(f, FAIL_USAGE, "-o FILE.png is missing");
    if ((code = single(&t->mesh, "--mesh", &mesh_name, f)) || (code = single(&t->material, "--material", &material, f)))
        return code;
    if (!mesh_name) return fail(f, FAIL_USAGE, "--mesh is missing: sphere, teapot, plane, torus or a file");
    if (!material) return fail(f, FAIL_USAGE, "--material is missing: a .ktx2 file or a BRDF's name");
    if ((code = output_apart(t->output_path, mesh_name, f)) || (code = output_apart(t->output_path, material, f)) ||
        (code = shot_lights_apart(&t->lights, t->output_path, f)) || (code = parse_frame(t, &width, &height, f)))
        return code;
    scene_begin(&t->s, NULL, width * t->samples, height * t->samples);
    t->s.lit_size = t->lit_size;
    t->lights.quiet = t->meter.quiet;
    if ((code = choose(&t->backend_name, "--backend", backend_names, BACKEND_COUNT, &t->backend, f)) ||
        (code = choose(&t->output, "--output", output_names, 3, &t->s.output, f)) || (code = parse_lights(t, f)) ||
        (code = parse_turntable(t, f)) || (code = parse_numbers(t, f)))
        return code;
    if ((code = mesh_open(&t->shape, mesh_name, f))) return code;
    t->s.shape = &t->shape;
    t->s.progress = &t->meter;
    t->s.exact_sphere = !strcmp(mesh_name, "sphere");
    if ((code = parse_camera(t, f))) return code;
    return scene_material_open(&t->material_open, material, t->backend == BACKEND_DOUBLE, f);
}

static int draw(shot *t, image_u8 *picture, failure *f)
{
    const scene_material *m = &t->material_open;
    image_u8 frame = {0};
    int code;

    if (t->gles)
        code = scene_gles_draw(t->gles, &t->s, &m->material, &frame, f);
    else if (t->backend == BACKEND_SOFT)
        code = scene_draw_soft(&t->s, &m->material, &frame, f);
    else
        code = scene_draw_double(&t->s, m->reflectance, m->has_albedo ? m->albedo : NULL,
                                 m->normal_map.texel ? &m->normal_map : NULL, &frame, f);
    if (!code) scene_average(&frame, t->samples, t->s.output, picture);
    image_u8_free(&frame);
    return code;
}

static int draw_one(shot *t, failure *f)
{
    image_u8 picture = {0};
    int code = draw(t, &picture, f);

    if (!code) code = png_write(t->output_path, &picture, f);
    image_u8_free(&picture);
    return code;
}

/* Frame k has turned by k / frames of a turn: the mesh, or all lights. */
static int draw_turn(shot *t, failure *f)
{
    const double step = 360.0 / t->table.frames;
    const scene still = t->s;
    int k, code = FAIL_NONE;

    t->s.progress = NULL;
    progress_begin(&t->meter, "frames", t->table.frames);
    for (k = 0; k < t->table.frames && !code; k++) {
        image_u8 picture = {0};
        memcpy(t->s.object_to_view, still.object_to_view, sizeof still.object_to_view);
        scene_turn(&t->s, t->yaw_deg + (t->turn_lights ? 0 : k * step));
        if (t->turn_lights && k) shot_lights_turn(&t->lights, &t->s, step);
        code = draw(t, &picture, f);
        if (!code) code = turntable_add(&t->table, k, &picture, f);
        image_u8_free(&picture);
        progress_add(&t->meter, 1);
    }
    progress_end(&t->meter);
    turntable_free(&t->table);
    return code;
}

static int draw_all(shot *t, failure *f)
{
    int code = shot_lights_open(&t->lights, &t->s, f);

    if (!code && t->backend < GL_BACKEND_COUNT)
        code = scene_gles_open(&t->gles, (gl_backend)t->backend, t->s.width, t->s.height, f);
    if (code) return code;
    code = t->table.frames ? draw_turn(t, f) : draw_one(t, f);
    scene_gles_close(t->gles);
    return code;
}

int cmd_shot(int argc, char **argv, failure *f)
{
    shot t = {.samples = 1, .table.per_second = 20};
    const option table[] = {
        {"--mesh", OPTION_TEXTS, &t.mesh, 0, 0, "MESH",
         "sphere, teapot, plane, torus, or an OBJ, glTF, GLB, PLY or STL file"},
        {"--material", OPTION_TEXTS, &t.material, 0, 0, "MATERIAL",
         "FILE.ktx2, a BRDF's name (nacre info --brdfs), or role=FILE,... with roles table, spheres, normal, mask, "
         "albedo, lobes, power, palette, index"},
        SHOT_LIGHT_OPTIONS(t.lights),
        {"--camera", OPTION_TEXTS, &t.camera, 0, 0, "EX,EY,EZ,TX,TY,TZ[,FOVY]",
         "perspective from eye to target (the whole mesh from +z), vertical field of view in degrees (30)"},
        {"--ortho", OPTION_FLAG, &t.ortho, 0, 0, NULL, "orthographic from +z; the sphere fills the frame"},
        {"--turn", OPTION_TEXTS, &t.turn, 0, 0, "YAW[,PITCH]", "turn the mesh about +y, then about +x, degrees (0,0)"},
        {"--exposure", OPTION_TEXTS, &t.exposure, 0, 0, "E", "multiplies radiance before encoding (1)"},
        {"--ambient", OPTION_TEXTS, &t.ambient, 0, 0, "R,G,B", "irradiance from everywhere (0,0,0)"},
        {"--tint", OPTION_TEXTS, &t.tint, 0, 0, "R,G,B", "multiplies reflected radiance (1,1,1)"},
        {"--output", OPTION_TEXTS, &t.output, 0, 0, "CURVE", "srgb, sqrt or linear codes (srgb)"},
        {"--distant", OPTION_FLAG, &t.s.distant_viewer, 0, 0, NULL, "one view direction for the whole mesh"},
        {"--lit", OPTION_INT, &t.lit_size, 16, 512, "N",
         "by a lit sphere of N x N texels: all directional lights for one fetch per pixel, one view direction for the "
         "whole mesh (with --env, --lights-file or more than 8 lights 128, soft 256; else direct)"},
        {"--turntable", OPTION_INT, &t.table.frames, 1, TURNTABLE_MAX_FRAMES, "N", "N frames of a whole turn, see -o"},
        {"--turning", OPTION_TEXTS, &t.turning, 0, 0, "WHAT",
         "what the turntable turns about +y: mesh or lights (mesh)"},
        {"--fps", OPTION_INT, &t.table.per_second, 1, 60, "N", "frames a second of an animated PNG (20)"},
        {"--size", OPTION_TEXTS, &t.size, 0, 0, "WxH", "pixels, 1..4096 a side (512x512)"},
        {"--samples", OPTION_INT, &t.samples, 1, 8, "N", "anti-aliasing: mean of N x N per pixel, in linear light (1)"},
        {"--backend", OPTION_TEXTS, &t.backend_name, 0, 0, "NAME",
         "egl2, egl3, osmesa (OpenGL), soft (this CPU, in integers), or double: the reference, which evaluates a BRDF "
         "exactly (egl2)"},
        {"--threads", OPTION_INT, &t.threads, 1, 256, "N", "(all cores) the picture does not depend on it"},
        {"--quiet", OPTION_FLAG, &t.meter.quiet, 0, 0, NULL, "no progress line"},
        {"-o", OPTION_TEXT, &t.output_path, 0, 0, "FILE.png",
         "the picture: RGBA, straight alpha, transparent background; with --turntable frame_%03d.png for a file per "
         "frame, numbered from 0, or F.png for an animated PNG"},
    };
    const char *operand[1];
    int count = 0, distant;
    int code =
        options_parse(argc, argv, "nacre shot --mesh MESH --material MATERIAL --light POLAR,AZIMUTH ... -o FILE.png",
                      table, sizeof table / sizeof *table, operand, &count, 0, 0, f);

    if (code) return code;
    if (t.threads) omp_set_num_threads(t.threads);
    distant = t.s.distant_viewer;
    code = set_up(&t, f);
    t.s.distant_viewer = distant;
    if (!code) code = draw_all(&t, f);
    shot_lights_close(&t.lights);
    scene_material_close(&t.material_open);
    mesh_free(&t.shape);
    return code;
}
