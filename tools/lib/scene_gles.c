/* SPDX-License-Identifier: MIT */
/*
 * Shots through the runtime, as an application would make them: a context, a block of memory, meshes and materials
 * added, drawn, removed.
 */
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gl_probe.h"
#include "nacre_gles.h"
#include "scene_numbers.h"

/* The few GL values used here; the entry points come from the context like the runtime's own. */
#define GL_ARRAY_BUFFER         0x8892u
#define GL_ELEMENT_ARRAY_BUFFER 0x8893u
#define GL_STREAM_DRAW          0x88E0u
#define GL_STATIC_DRAW          0x88E4u
#define GL_DEPTH_TEST           0x0B71u
#define GL_FLOAT                0x1406u
#define GL_UNSIGNED_SHORT       0x1403u
#define GL_MAX_VIEWPORT_DIMS    0x0D3Au

typedef struct gl_procs {
    void (*gen_buffers)(int count, unsigned *names);
    void (*delete_buffers)(int count, const unsigned *names);
    void (*bind_buffer)(unsigned target, unsigned name);
    void (*buffer_data)(unsigned target, ptrdiff_t size, const void *data, unsigned usage);
    void (*enable)(unsigned capability);
    void (*viewport)(int x, int y, int width, int height);
    void (*get_integers)(unsigned name, int *out);
} gl_procs;

struct scene_gles {
    gl_headless *context;
    nacre_gles *gles;
    void *block;
    gl_procs gl;
    nacre_gles_lit lit; /* of the shot under way; id 0: direct shading */
    int width, height;
    char log[600]; /* the runtime's last message, one line */
};

/* Quads of one draw: with 16-bit indices, as every device has them. */
#define BATCH_QUADS 16383

typedef struct sphere_vertex {
    float position[3], normal[3], tangent[4], uv[2];
} sphere_vertex;

static void keep_log(void *user, nacre_result code, const char *message)
{
    scene_gles *g = user;
    size_t i;

    (void)code;
    snprintf(g->log, sizeof g->log, ": %.500s", message);
    for (i = 0; g->log[i]; i++)
        if (g->log[i] == '\n' || g->log[i] == '\r') g->log[i] = ' ';
}

static int check(scene_gles *g, nacre_result r, const char *what, failure *f)
{
    int code = r == NACRE_ERR_ASSET         ? FAIL_INVALID
               : r == NACRE_ERR_UNSUPPORTED ? FAIL_UNSUPPORTED
               : r == NACRE_ERR_GL          ? FAIL_UNSUPPORTED
                                            : FAIL_INTERNAL;

    if (r == NACRE_OK) return FAIL_NONE;
    return fail(f, code, "%s: %s%s", what, nacre_result_text(r), g->log);
}

static void load(void *function, const char *name)
{
    void *p = gl_headless_proc(NULL, name);

    memcpy(function, &p, sizeof p);
}

int scene_gles_open(scene_gles **out, gl_backend backend, int width, int height, failure *f)
{
    return scene_gles_open_power(out, backend, NACRE_GLES_POWER_AUTO, width, height, f);
}

int scene_gles_open_power(scene_gles **out, gl_backend backend, int power, int width, int height, failure *f)
{
    scene_gles *g = need_memory(1, sizeof *g);
    nacre_gles_desc desc = {.get_proc = gl_headless_proc, .log = keep_log, .user = g, .max_items = 64};
    int code = gl_headless_open(&g->context, backend, width, height, f), largest[2] = {0, 0};

    if (code) {
        free(g);
        return code;
    }
    desc.prefer_es2 = backend == GL_BACKEND_EGL2;
    desc.power = (uint8_t)power;
    g->width = width;
    g->height = height;
    load(&g->gl.gen_buffers, "glGenBuffers");
    load(&g->gl.delete_buffers, "glDeleteBuffers");
    load(&g->gl.bind_buffer, "glBindBuffer");
    load(&g->gl.buffer_data, "glBufferData");
    load(&g->gl.enable, "glEnable");
    load(&g->gl.viewport, "glViewport");
    load(&g->gl.get_integers, "glGetIntegerv");
    g->gl.get_integers(GL_MAX_VIEWPORT_DIMS, largest);
    if (width > largest[0] || height > largest[1])
        code = fail(f, FAIL_UNSUPPORTED, "frame of %dx%d: this device draws at most %dx%d", width, height, largest[0],
                    largest[1]);
    if (!code) {
        g->block = need_memory(1, nacre_gles_size(&desc));
        code = check(g, nacre_gles_init(&g->gles, g->block, nacre_gles_size(&desc), &desc), "nacre_gles_init", f);
    }
    if (code) {
        scene_gles_close(g);
        return code;
    }
    g->gl.enable(GL_DEPTH_TEST);
    g->gl.viewport(0, 0, width, height);
    *out = g;
    return FAIL_NONE;
}

void scene_gles_close(scene_gles *g)
{
    if (!g) return;
    if (g->gles) nacre_gles_shutdown(g->gles);
    gl_headless_close(g->context);
    free(g->block);
    free(g);
}

int scene_gles_mediump_is_half(scene_gles *g)
{
    return gl_probe_mediump(g->context) == 0;
}

const char *scene_gles_description(const scene_gles *g)
{
    return gl_headless_description(g->context);
}

/* ---- the lit sphere of a shot ------------------------------------------------------------------------------------ */

static int lit_begin(scene_gles *g, const scene *s, const nacre_material *material, failure *f)
{
    const nacre_gles_lit_desc desc = {.size = (uint16_t)s->lit_size};

    g->lit.id = 0;
    if (!s->distant && !s->lit_size) return FAIL_NONE;
    return check(g, nacre_gles_lit_add(g->gles, material, &desc, &g->lit), "nacre_gles_lit_add", f);
}

/* Bring it up to date for a mesh with this centre, and draw the item by it. */
static int lit_use(scene_gles *g, nacre_gles_item item, const nacre_q16 centre[3], const nacre_view *view, failure *f)
{
    const nacre_gles_lit none = {0};
    int code;

    if (!g->lit.id) return FAIL_NONE;
    code = check(g, nacre_gles_lit_update(g->gles, g->lit, centre, view, 0), "nacre_gles_lit_update", f);
    return code ? code : check(g, nacre_gles_use_lit(g->gles, item, g->lit, none), "nacre_gles_use_lit", f);
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

static int draw_part(scene_gles *g, const nacre_mesh *part, const nacre_material *material, const nacre_view *view,
                     failure *f)
{
    nacre_gles_item item;
    int code = check(g, nacre_gles_add(g->gles, part, material, &item), "nacre_gles_add", f);

    if (code) return code;
    code = lit_use(g, item, part->centre, view, f);
    if (!code) code = check(g, nacre_gles_draw(g->gles, item, view), "nacre_gles_draw", f);
    nacre_gles_remove(g->gles, item);
    return code;
}

static int draw_mesh(scene_gles *g, const scene *s, const nacre_material *material, const nacre_view *view, failure *f)
{
    nacre_mesh *parts;
    int count, i, code = mesh_pack(s->shape, &parts, &count, f);

    if (code) return code;
    for (i = 0; i < count && !code; i++) code = draw_part(g, &parts[i], material, view, f);
    free(parts);
    return code;
}

/* ---- the exact sphere: a quad per covered pixel, with the one normal of its centre ------------------------------- */

static void set_quad(sphere_vertex quad[4], const scene *s, const double clip_to_object[16], int i, int j,
                     const scene_hit *hit)
{
    int corner, k;

    for (corner = 0; corner < 4; corner++) {
        sphere_vertex *v = &quad[corner];
        double clip[4] = {2.0 * (i + (corner & 1)) / s->width - 1, 1 - 2.0 * (j + (corner >> 1)) / s->height,
                          hit->z_ndc, 1};
        double p[4];
        matrix_apply(p, clip_to_object, clip);
        for (k = 0; k < 3; k++) {
            v->position[k] = (float)(p[k] / p[3]);
            v->normal[k] = (float)hit->normal[k];
            v->tangent[k] = (float)hit->tangent[k];
        }
        v->tangent[3] = 1;
        v->uv[0] = (float)hit->uv[0];
        v->uv[1] = (float)hit->uv[1];
    }
}

static nacre_gles_buffers describe(unsigned vertices, unsigned indices)
{
    nacre_gles_buffers b = {.vertex_buffer = vertices, .index_buffer = indices, .index_type = GL_UNSIGNED_SHORT};
    const uint32_t stride = sizeof(sphere_vertex);

    b.attribute[NACRE_GLES_POSITION] =
        (nacre_gles_attribute){GL_FLOAT, 3, 0, offsetof(sphere_vertex, position), stride};
    b.attribute[NACRE_GLES_NORMAL] = (nacre_gles_attribute){GL_FLOAT, 3, 0, offsetof(sphere_vertex, normal), stride};
    b.attribute[NACRE_GLES_TANGENT] = (nacre_gles_attribute){GL_FLOAT, 4, 0, offsetof(sphere_vertex, tangent), stride};
    b.attribute[NACRE_GLES_UV] = (nacre_gles_attribute){GL_FLOAT, 2, 0, offsetof(sphere_vertex, uv), stride};
    return b;
}

static void upload_quad_indices(const gl_procs *gl, unsigned name)
{
    static const uint16_t corner[6] = {0, 2, 3, 0, 3, 1};
    uint16_t *index = need_memory(BATCH_QUADS * 6, sizeof *index);
    int i;

    for (i = 0; i < BATCH_QUADS * 6; i++) index[i] = (uint16_t)(4 * (i / 6) + corner[i % 6]);
    gl->bind_buffer(GL_ELEMENT_ARRAY_BUFFER, name);
    gl->buffer_data(GL_ELEMENT_ARRAY_BUFFER, BATCH_QUADS * 6 * (ptrdiff_t)sizeof *index, index, GL_STATIC_DRAW);
    gl->bind_buffer(GL_ELEMENT_ARRAY_BUFFER, 0);
    free(index);
}

static int draw_batch(scene_gles *g, nacre_gles_item item, nacre_gles_buffers *buffers, const sphere_vertex *vertices,
                      int quads, const nacre_view *view, failure *f)
{
    int code;

    if (!quads) return FAIL_NONE;
    g->gl.bind_buffer(GL_ARRAY_BUFFER, buffers->vertex_buffer);
    g->gl.buffer_data(GL_ARRAY_BUFFER, (ptrdiff_t)sizeof *vertices * 4 * quads, vertices, GL_STREAM_DRAW);
    g->gl.bind_buffer(GL_ARRAY_BUFFER, 0);
    buffers->count = 6 * (uint32_t)quads;
    code = check(g, nacre_gles_set_buffers(g->gles, item, buffers), "nacre_gles_set_buffers", f);
    return code ? code : check(g, nacre_gles_draw(g->gles, item, view), "nacre_gles_draw", f);
}

static int draw_quads(scene_gles *g, const scene *s, nacre_gles_item item, nacre_gles_buffers *buffers,
                      const nacre_view *view, failure *f)
{
    sphere_vertex *vertices = need_memory(BATCH_QUADS * 4, sizeof *vertices);
    double clip_to_object[16];
    int i, quads = 0, code = FAIL_NONE, pixels = s->width * s->height;

    if (!scene_clip_to_object(s, clip_to_object)) code = fail(f, FAIL_USAGE, "the camera's matrix has no inverse");
    progress_begin(s->progress, "rows", s->height);
    for (i = 0; i < pixels && !code; i++) {
        scene_hit hit;
        if (i % s->width == 0) progress_add(s->progress, 1);
        if (!scene_sphere_hit(s, clip_to_object, i % s->width, i / s->width, &hit)) continue;
        set_quad(vertices + 4 * quads, s, clip_to_object, i % s->width, i / s->width, &hit);
        if (++quads < BATCH_QUADS) continue;
        code = draw_batch(g, item, buffers, vertices, quads, view, f);
        quads = 0;
    }
    if (!code) code = draw_batch(g, item, buffers, vertices, quads, view, f);
    progress_end(s->progress);
    free(vertices);
    return code;
}

static int draw_sphere(scene_gles *g, const scene *s, const nacre_material *material, const nacre_view *view,
                       failure *f)
{
    nacre_gles_buffers buffers;
    nacre_gles_item item;
    unsigned name[2];
    int code;

    g->gl.gen_buffers(2, name);
    buffers = describe(name[0], name[1]);
    upload_quad_indices(&g->gl, name[1]);
    buffers.count = 6; /* each batch gives its own */
    code = check(g, nacre_gles_add_buffers(g->gles, &buffers, material, &item), "nacre_gles_add_buffers", f);
    if (!code) {
        code = lit_use(g, item, NULL, view, f);
        if (!code) code = draw_quads(g, s, item, &buffers, view, f);
        nacre_gles_remove(g->gles, item);
    }
    g->gl.delete_buffers(2, name);
    return code;
}

/* ---- the shot ---------------------------------------------------------------------------------------------------- */

int scene_gles_draw(scene_gles *g, const scene *s, const nacre_material *material, image_u8 *out, failure *f)
{
    scene_numbers numbers;
    int code;

    if (s->width != g->width || s->height != g->height)
        return fail(f, FAIL_INTERNAL, "scene of %dx%d in a context of %dx%d", s->width, s->height, g->width, g->height);
    g->log[0] = 0;
    scene_numbers_open(&numbers, s);
    gl_headless_clear(g->context, 0, 0, 0, 0);
    code = lit_begin(g, s, material, f);
    if (!code)
        code = s->exact_sphere ? draw_sphere(g, &numbers.scaled, material, &numbers.view, f)
                               : draw_mesh(g, &numbers.scaled, material, &numbers.view, f);
    nacre_gles_lit_remove(g->gles, g->lit);
    scene_numbers_close(&numbers);
    if (!code) gl_headless_read(g->context, out);
    return code;
}

int scene_draw_gles(const scene *s, const nacre_material *material, gl_backend backend, image_u8 *out, failure *f)
{
    scene_gles *g;
    int code = scene_gles_open(&g, backend, s->width, s->height, f);

    if (code) return code;
    code = scene_gles_draw(g, s, material, out, f);
    scene_gles_close(g);
    return code;
}
