/* SPDX-License-Identifier: MIT */
/*
 * Draws in passes: lights that one program can't hold are summed in render targets, 16 bits a channel in two RGBA8
 * textures, and the last pass adds, encodes and writes to the caller's framebuffer. ES 2.0 writes one target at a time:
 * there every sum is drawn twice, for its high and for its low bytes. Encoded values are never blended.
 */
#include "gles.h"

#include <string.h>

/* The first are for meshes too, all for pictures. */
static const uint16_t switches[] = {GLES_DEPTH_TEST, GLES_BLEND,     GLES_SCISSOR_TEST,
                                    GLES_DITHER,     GLES_CULL_FACE, GLES_RASTERIZER_DISCARD};
enum { MESH_SWITCHES = 4, SWITCHES = 6 };

gl_enum gles_draw_target(const nacre_gles *gles)
{
    return gles->caps.two_framebuffers ? GLES_DRAW_FRAMEBUFFER : GLES_FRAMEBUFFER;
}

static void set_switch(const gles_procs *gl, unsigned i, int on)
{
    if (on)
        gl->Enable(switches[i]);
    else
        gl->Disable(switches[i]);
}

/* Only ES 3 knows the last one. */
static unsigned picture_switches(const nacre_gles *gles)
{
    return gles->caps.es3 ? SWITCHES : SWITCHES - 1;
}

void gles_host_save(const nacre_gles *gles, gles_host_state *s, int picture)
{
    const gles_procs *gl = &gles->gl;
    unsigned i;
    memset(s, 0, sizeof *s);
    gl->GetIntegerv(GLES_FRAMEBUFFER_BINDING, &s->framebuffer);
    gl->GetIntegerv(GLES_VIEWPORT, s->viewport);
    gl->GetIntegerv(GLES_DEPTH_FUNC, &s->depth_func);
    gl->GetIntegerv(GLES_DEPTH_WRITEMASK, &s->depth_mask);
    gl->GetIntegerv(GLES_COLOR_WRITEMASK, s->color_mask);
    gl->GetFloatv(GLES_COLOR_CLEAR_VALUE, s->clear_color);
    gl->GetFloatv(GLES_DEPTH_CLEAR_VALUE, &s->clear_depth);
    s->switches = (uint8_t)(picture ? picture_switches(gles) : MESH_SWITCHES);
    for (i = 0; i < s->switches; i++) s->enabled[i] = gl->IsEnabled(switches[i]);
}

void gles_host_put_back(const nacre_gles *gles, const gles_host_state *s)
{
    const gles_procs *gl = &gles->gl;
    unsigned i;
    gl->BindFramebuffer(gles_draw_target(gles), (gl_uint)s->framebuffer);
    gl->Viewport(s->viewport[0], s->viewport[1], s->viewport[2], s->viewport[3]);
    gl->DepthFunc((gl_enum)s->depth_func);
    gl->DepthMask((gl_boolean)(s->depth_mask != 0));
    gl->ColorMask((gl_boolean)(s->color_mask[0] != 0), (gl_boolean)(s->color_mask[1] != 0),
                  (gl_boolean)(s->color_mask[2] != 0), (gl_boolean)(s->color_mask[3] != 0));
    gl->ClearColor(s->clear_color[0], s->clear_color[1], s->clear_color[2], s->clear_color[3]);
    gl->ClearDepthf(s->clear_depth);
    for (i = 0; i < s->switches; i++) set_switch(gl, i, s->enabled[i]);
}

/* 1 when depth falls with distance: a reversed projection (the sign of d depth / d z, which is positive then), or a
   reversed depth range. */
static int depth_is_reversed(const gles_procs *gl, const nacre_mat4 *p)
{
    gl_float range[2] = {0, 1};
    gl->GetFloatv(GLES_DEPTH_RANGE, range);
    return ((int64_t)p->m[10] * p->m[15] - (int64_t)p->m[14] * p->m[11] > 0) != (range[0] > range[1]);
}

static void open_masks(const gles_procs *gl, gl_float depth)
{
    gl->DepthMask(1);
    gl->ColorMask(1, 1, 1, 1);
    gl->ClearColor(0, 0, 0, 0);
    gl->ClearDepthf(depth);
}

static void passes_state(const nacre_gles *gles, const gles_draw *draw)
{
    const gles_procs *gl = &gles->gl;
    const int reversed = depth_is_reversed(gl, &draw->view->view_to_clip);
    unsigned i;
    gl->Viewport(0, 0, gles->targets.sum[0].width, gles->targets.sum[0].height);
    for (i = 0; i < MESH_SWITCHES; i++) set_switch(gl, i, i == 0);
    gl->DepthFunc(reversed ? GLES_GREATER : GLES_LESS);
    open_masks(gl, reversed ? 0 : 1);
}

void gles_picture_state(const nacre_gles *gles, gl_int size)
{
    unsigned i;
    gles->gl.Viewport(0, 0, size, size);
    for (i = 0; i < picture_switches(gles); i++) set_switch(&gles->gl, i, 0);
    open_masks(&gles->gl, 1);
}

/* ---- targets -------------------------------------------------------------------------------- */

/* Two RGBA8 textures. */
static uint64_t sum_bytes(uint32_t width, uint32_t height)
{
    return (uint64_t)width * height * 8;
}

static uint64_t depth_bytes(uint32_t width, uint32_t height)
{
    return (uint64_t)width * height * 2;
}

nacre_result gles_target_make(nacre_gles *gles, gl_uint *texture, gl_uint *framebuffer, gl_int width, gl_int height,
                              int rgb565, gl_int filter, gl_uint depth)
{
    const gles_procs *gl = &gles->gl;
    const gl_enum target = gles_draw_target(gles), format = rgb565 ? GLES_RGB : GLES_RGBA;
    gl->GenTextures(1, texture);
    gl->GenFramebuffers(1, framebuffer);
    if (!*texture || !*framebuffer) return gles_gl_failed(gles, "render target");
    gl->BindTexture(GLES_TEXTURE_2D, *texture);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_MIN_FILTER, filter);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_MAG_FILTER, filter);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_WRAP_S, GLES_CLAMP_TO_EDGE);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_WRAP_T, GLES_CLAMP_TO_EDGE);
    gl->TexImage2D(GLES_TEXTURE_2D, 0, (gl_int)format, width, height, 0, format,
                   rgb565 ? GLES_UNSIGNED_SHORT_5_6_5 : GLES_UNSIGNED_BYTE, NULL);
    gl->BindFramebuffer(target, *framebuffer);
    gl->FramebufferTexture2D(target, GLES_COLOR_ATTACHMENT0, GLES_TEXTURE_2D, *texture, 0);
    if (depth) gl->FramebufferRenderbuffer(target, GLES_DEPTH_ATTACHMENT, GLES_RENDERBUFFER, depth);
    if (gl->CheckFramebufferStatus(target) == GLES_FRAMEBUFFER_COMPLETE) return NACRE_OK;
    return gles_gl_failed(gles, "render target is not complete");
}

void gles_sum_delete(nacre_gles *gles, gles_sum *sum)
{
    int i;
    for (i = 0; i < 2; i++) {
        if (sum->framebuffer[i]) gles->gl.DeleteFramebuffers(1, &sum->framebuffer[i]);
        if (sum->texture[i]) gles->gl.DeleteTextures(1, &sum->texture[i]);
    }
    gles->texture_bytes -= (uint32_t)sum_bytes(sum->width, sum->height);
    memset(sum, 0, sizeof *sum);
}

/* Let one draw write both bytes. */
static nacre_result join_bytes(nacre_gles *gles, const gles_sum *sum)
{
    static const gl_enum both[2] = {GLES_COLOR_ATTACHMENT0, GLES_COLOR_ATTACHMENT1};
    const gles_procs *gl = &gles->gl;
    const gl_enum target = gles_draw_target(gles);
    gl->BindFramebuffer(target, sum->framebuffer[0]);
    gl->FramebufferTexture2D(target, GLES_COLOR_ATTACHMENT1, GLES_TEXTURE_2D, sum->texture[1], 0);
    gl->DrawBuffers(2, both);
    if (gl->CheckFramebufferStatus(target) == GLES_FRAMEBUFFER_COMPLETE) return NACRE_OK;
    return gles_gl_failed(gles, "render target of two textures is not complete");
}

nacre_result gles_sum_make(nacre_gles *gles, gles_sum *sum, gl_int width, gl_int height, gl_uint depth)
{
    nacre_result result = NACRE_OK;
    unsigned i;
    for (i = 0; i < 2 && !result; i++)
        result = gles_target_make(gles, &sum->texture[i], &sum->framebuffer[i], width, height, 0, GLES_NEAREST, depth);
    if (!result && gles_uses_es3(gles)) result = join_bytes(gles, sum);
    if (result && gles->lost) memset(sum, 0, sizeof *sum);
    if (result) {
        gles_sum_delete(gles, sum);
        return result;
    }
    sum->width = (uint16_t)width;
    sum->height = (uint16_t)height;
    gles->texture_bytes += (uint32_t)sum_bytes(sum->width, sum->height);
    return NACRE_OK;
}

void gles_sum_clear(nacre_gles *gles, const gles_sum *sum)
{
    unsigned i;
    for (i = 0; i < 2; i++) {
        gles->gl.BindFramebuffer(gles_draw_target(gles), sum->framebuffer[i]);
        gles->gl.Clear(GLES_COLOR_BUFFER_BIT);
    }
}

void gles_targets_delete(nacre_gles *gles)
{
    gles_targets *t = &gles->targets;
    gles_sum_delete(gles, &t->sum[0]);
    gles_sum_delete(gles, &t->sum[1]);
    if (!t->depth) return;
    gles->gl.DeleteRenderbuffers(1, &t->depth);
    gles->texture_bytes -= t->depth_bytes;
    t->depth = t->depth_bytes = 0;
}

static nacre_result make_depth(nacre_gles *gles, gl_int width, gl_int height)
{
    const gles_procs *gl = &gles->gl;
    gl_int renderbuffer = 0;
    gl->GetIntegerv(GLES_RENDERBUFFER_BINDING, &renderbuffer);
    gl->GenRenderbuffers(1, &gles->targets.depth);
    if (!gles->targets.depth) return gles_gl_failed(gles, "glGenRenderbuffers");
    gl->BindRenderbuffer(GLES_RENDERBUFFER, gles->targets.depth);
    gl->RenderbufferStorage(GLES_RENDERBUFFER, GLES_DEPTH_COMPONENT16, width, height);
    gl->BindRenderbuffer(GLES_RENDERBUFFER, (gl_uint)renderbuffer);
    gles->targets.depth_bytes = (uint32_t)depth_bytes((uint32_t)width, (uint32_t)height);
    gles->texture_bytes += gles->targets.depth_bytes;
    return NACRE_OK;
}

static nacre_result make_targets(nacre_gles *gles, gl_int width, gl_int height)
{
    gles_targets *t = &gles->targets;
    unsigned i;
    nacre_result result = gles_begin(gles);
    if (!result) result = make_depth(gles, width, height);
    for (i = 0; i < 2 && !result; i++) result = gles_sum_make(gles, &t->sum[i], width, height, t->depth);
    return result ? result : gles_check(gles, "light pass targets");
}

/* Targets of the viewport's size; framebuffer and texture bindings are changed. */
static nacre_result fit_targets(nacre_gles *gles, gl_int width, gl_int height)
{
    gles_targets *t = &gles->targets;
    gles_upload_state state;
    nacre_result result;
    if (t->sum[1].width == width && t->sum[1].height == height) return NACRE_OK;
    if (width <= 0 || height <= 0) return NACRE_ERR_ARGUMENT;
    if (width > gles->caps.max_texture || height > gles->caps.max_texture) return NACRE_ERR_UNSUPPORTED;
    gles_targets_delete(gles);
    if (2 * sum_bytes((uint32_t)width, (uint32_t)height) + depth_bytes((uint32_t)width, (uint32_t)height) +
            gles->texture_bytes >
        gles->desc.texture_budget)
        return gles_fail(gles, NACRE_ERR_BUDGET, "texture_budget: light pass targets", NULL);
    gles_upload_begin(gles, &state);
    result = make_targets(gles, width, height);
    gles_upload_end(gles, &state);
    if (result && gles->lost) memset(t, 0, sizeof *t);
    if (result) gles_targets_delete(gles);
    return result;
}

/* ---- drawing -------------------------------------------------------------------------------- */

static void bind_sum(const nacre_gles *gles, const gles_draw *draw, gles_saved *saved, const gles_key *key,
                     const gles_sum *sum)
{
    const unsigned unit = (unsigned)gles_key_unit_sum(key);
    gles_texture_bind(gles, saved, unit, sum->texture[0], draw->query);
    gles_texture_bind(gles, saved, unit + 1, sum->texture[1], draw->query);
}

nacre_result gles_sum_pass(nacre_gles *gles, gles_draw *draw, gles_saved *saved, const gles_sum sum[2],
                           unsigned first_light, unsigned from)
{
    const gles_procs *gl = &gles->gl;
    gles_program *program;
    gles_key key;
    nacre_result result;
    unsigned byte;
    gles_key_of(gles, &key, draw, gles_pass_lights(draw, first_light), GLES_PASS_SUM);
    result = gles_pass_bind(gles, draw, saved, &key, first_light, &program);
    if (result) return result;
    bind_sum(gles, draw, saved, &key, &sum[from]);
    for (byte = 0; byte < (key.es3 ? 1u : 2u); byte++) {
        if (!key.es3) gles_uniforms_set_byte(gl, &program->at, byte);
        gl->BindFramebuffer(gles_draw_target(gles), sum[1 - from].framebuffer[byte]);
        gl->Clear(GLES_COLOR_BUFFER_BIT | GLES_DEPTH_BUFFER_BIT);
        gles_issue(gles, draw->item);
    }
    return NACRE_OK;
}

nacre_result gles_last_pass(nacre_gles *gles, gles_draw *draw, gles_saved *saved, const gles_sum *sum)
{
    gles_program *program;
    gles_key key;
    nacre_result result;
    gles_key_of(gles, &key, draw, 0, GLES_PASS_LAST);
    result = gles_pass_bind(gles, draw, saved, &key, 0, &program);
    if (result) return result;
    bind_sum(gles, draw, saved, &key, sum);
    gles_issue(gles, draw->item);
    return NACRE_OK;
}

/* Everything but the last pass; *from receives the sum that it reads. */
static nacre_result draw_sums(nacre_gles *gles, gles_draw *draw, gles_saved *saved, unsigned *from)
{
    const gles_sum *const sum = gles->targets.sum;
    const unsigned lights = draw->view->light_count;
    nacre_result result = NACRE_OK;
    unsigned first;
    *from = 0;
    gles_sum_clear(gles, &sum[0]);
    for (first = 0; first < lights && !result; first += gles_pass_lights(draw, first)) {
        do {
            result = gles_sum_pass(gles, draw, saved, sum, first, *from);
            *from = 1 - *from;
        } while (gles_pass_next_lobes(draw) && !result);
    }
    return result;
}

nacre_result gles_draw_passes(nacre_gles *gles, gles_draw *draw, gles_saved *saved)
{
    gles_host_state host;
    unsigned from = 0;
    nacre_result result;
    gles_host_save(gles, &host, 0);
    result = fit_targets(gles, host.viewport[2], host.viewport[3]);
    if (!result) {
        passes_state(gles, draw);
        gles_bind_vertices(gles, draw, saved);
        result = draw_sums(gles, draw, saved, &from);
    }
    gles_host_put_back(gles, &host);
    return result ? result : gles_last_pass(gles, draw, saved, &gles->targets.sum[from]);
}
