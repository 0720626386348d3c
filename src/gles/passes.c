/* SPDX-License-Identifier: MIT */
/*
 * Draws in passes: lights that one program can't hold are summed in render targets, 16 bits a channel in two RGBA8
 * textures, and the last pass adds, encodes and writes to the caller's framebuffer. ES 2.0 writes one target at a time,
 * so every sum is drawn twice, for its high and for its low bytes. Encoded values are never blended.
 */
#include "gles.h"

#include <string.h>

/* State that the passes change and the last one, or the host, needs back. */
typedef struct host_state {
    gl_int framebuffer, viewport[4], depth_func, depth_mask, color_mask[4];
    gl_float clear_color[4], clear_depth;
    gl_boolean enabled[4];
} host_state;

static const uint16_t switches[4] = {GLES_DEPTH_TEST, GLES_BLEND, GLES_SCISSOR_TEST, GLES_DITHER};

static gl_enum draw_target(const nacre_gles *gles)
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

static void host_save(const nacre_gles *gles, host_state *s)
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
    for (i = 0; i < 4; i++) s->enabled[i] = gl->IsEnabled(switches[i]);
}

static void host_put_back(const nacre_gles *gles, const host_state *s)
{
    const gles_procs *gl = &gles->gl;
    unsigned i;
    gl->BindFramebuffer(draw_target(gles), (gl_uint)s->framebuffer);
    gl->Viewport(s->viewport[0], s->viewport[1], s->viewport[2], s->viewport[3]);
    gl->DepthFunc((gl_enum)s->depth_func);
    gl->DepthMask((gl_boolean)(s->depth_mask != 0));
    gl->ColorMask((gl_boolean)(s->color_mask[0] != 0), (gl_boolean)(s->color_mask[1] != 0),
                  (gl_boolean)(s->color_mask[2] != 0), (gl_boolean)(s->color_mask[3] != 0));
    gl->ClearColor(s->clear_color[0], s->clear_color[1], s->clear_color[2], s->clear_color[3]);
    gl->ClearDepthf(s->clear_depth);
    for (i = 0; i < 4; i++) set_switch(gl, i, s->enabled[i]);
}

/* 1 when depth falls with distance: a reversed projection (the sign of d depth / d z, which is positive then), or a
   reversed depth range. */
static int depth_is_reversed(const gles_procs *gl, const nacre_mat4 *p)
{
    gl_float range[2] = {0, 1};
    gl->GetFloatv(GLES_DEPTH_RANGE, range);
    return ((int64_t)p->m[10] * p->m[15] - (int64_t)p->m[14] * p->m[11] > 0) != (range[0] > range[1]);
}

static void passes_state(const nacre_gles *gles, const gles_draw *draw)
{
    const gles_procs *gl = &gles->gl;
    const int reversed = depth_is_reversed(gl, &draw->view->view_to_clip);
    unsigned i;
    gl->Viewport(0, 0, gles->targets.width, gles->targets.height);
    for (i = 0; i < 4; i++) set_switch(gl, i, i == 0);
    gl->DepthFunc(reversed ? GLES_GREATER : GLES_LESS);
    gl->DepthMask(1);
    gl->ColorMask(1, 1, 1, 1);
    gl->ClearColor(0, 0, 0, 0);
    gl->ClearDepthf(reversed ? 0 : 1);
}

/* ---- targets -------------------------------------------------------------------------------- */

/* Four RGBA8 textures and 16 bits of depth. */
static uint64_t targets_bytes(uint32_t width, uint32_t height)
{
    return (uint64_t)width * height * (4 * 4 + 2);
}

void gles_targets_delete(nacre_gles *gles)
{
    gles_targets *t = &gles->targets;
    int i;
    for (i = 0; i < 4; i++) {
        if (t->framebuffer[i]) gles->gl.DeleteFramebuffers(1, &t->framebuffer[i]);
        if (t->texture[i]) gles->gl.DeleteTextures(1, &t->texture[i]);
    }
    if (t->depth) gles->gl.DeleteRenderbuffers(1, &t->depth);
    gles->texture_bytes -= (uint32_t)targets_bytes(t->width, t->height);
    memset(t, 0, sizeof *t);
}

static nacre_result make_target(nacre_gles *gles, unsigned i, gl_sizei width, gl_sizei height)
{
    const gles_procs *gl = &gles->gl;
    const gl_enum target = draw_target(gles);
    gles_targets *t = &gles->targets;
    gl->GenTextures(1, &t->texture[i]);
    gl->GenFramebuffers(1, &t->framebuffer[i]);
    if (!t->texture[i] || !t->framebuffer[i]) return gles_gl_failed(gles, "light pass target");
    gl->BindTexture(GLES_TEXTURE_2D, t->texture[i]);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_MIN_FILTER, GLES_NEAREST);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_MAG_FILTER, GLES_NEAREST);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_WRAP_S, GLES_CLAMP_TO_EDGE);
    gl->TexParameteri(GLES_TEXTURE_2D, GLES_TEXTURE_WRAP_T, GLES_CLAMP_TO_EDGE);
    gl->TexImage2D(GLES_TEXTURE_2D, 0, GLES_RGBA, width, height, 0, GLES_RGBA, GLES_UNSIGNED_BYTE, NULL);
    gl->BindFramebuffer(target, t->framebuffer[i]);
    gl->FramebufferTexture2D(target, GLES_COLOR_ATTACHMENT0, GLES_TEXTURE_2D, t->texture[i], 0);
    gl->FramebufferRenderbuffer(target, GLES_DEPTH_ATTACHMENT, GLES_RENDERBUFFER, t->depth);
    if (gl->CheckFramebufferStatus(target) != GLES_FRAMEBUFFER_COMPLETE)
        return gles_gl_failed(gles, "light pass target is not complete");
    return NACRE_OK;
}

static nacre_result make_targets(nacre_gles *gles, gl_int width, gl_int height)
{
    const gles_procs *gl = &gles->gl;
    gles_targets *t = &gles->targets;
    gl_int renderbuffer = 0;
    unsigned i;
    nacre_result result = gles_begin(gles);
    if (result) return result;
    gl->GetIntegerv(GLES_RENDERBUFFER_BINDING, &renderbuffer);
    gl->GenRenderbuffers(1, &t->depth);
    if (!t->depth) result = gles_gl_failed(gles, "glGenRenderbuffers");
    gl->BindRenderbuffer(GLES_RENDERBUFFER, t->depth);
    gl->RenderbufferStorage(GLES_RENDERBUFFER, GLES_DEPTH_COMPONENT16, width, height);
    for (i = 0; i < 4 && !result; i++) result = make_target(gles, i, width, height);
    gl->BindRenderbuffer(GLES_RENDERBUFFER, (gl_uint)renderbuffer);
    return result ? result : gles_check(gles, "light pass targets");
}

/* Targets of the viewport's size; framebuffer and texture bindings are changed. */
static nacre_result fit_targets(nacre_gles *gles, gl_int width, gl_int height)
{
    gles_targets *t = &gles->targets;
    gles_upload_state state;
    nacre_result result;
    if (t->width == width && t->height == height) return NACRE_OK;
    if (width <= 0 || height <= 0) return NACRE_ERR_ARGUMENT;
    if (width > gles->caps.max_texture || height > gles->caps.max_texture) return NACRE_ERR_UNSUPPORTED;
    gles_targets_delete(gles);
    if (targets_bytes((uint32_t)width, (uint32_t)height) + gles->texture_bytes > gles->desc.texture_budget)
        return gles_fail(gles, NACRE_ERR_BUDGET, "texture_budget: light pass targets", NULL);
    gles_upload_begin(gles, &state);
    result = make_targets(gles, width, height);
    gles_upload_end(gles, &state);
    if (result && gles->lost) memset(t, 0, sizeof *t);
    if (result) {
        gles_targets_delete(gles);
        return result;
    }
    t->width = (uint16_t)width;
    t->height = (uint16_t)height;
    gles->texture_bytes += (uint32_t)targets_bytes((uint32_t)width, (uint32_t)height);
    return NACRE_OK;
}

/* ---- drawing -------------------------------------------------------------------------------- */

/* One pass that reads sum `from` and, unless it is the last, writes half (0 high, 1 low) of sum 1 - from. */
static nacre_result draw_pass(nacre_gles *gles, gles_draw *draw, gles_saved *saved, const gles_key *key,
                              unsigned first_light, unsigned from)
{
    const gles_procs *gl = &gles->gl;
    const gles_targets *t = &gles->targets;
    const unsigned unit = (unsigned)gles_key_unit_sum(key);
    gl_uint program;
    const nacre_result result = gles_pass_bind(gles, draw, saved, key, first_light, &program);
    if (result) return result;
    gles_texture_bind(gles, saved, unit, t->texture[2 * from], draw->query);
    gles_texture_bind(gles, saved, unit + 1, t->texture[2 * from + 1], draw->query);
    if (key->pass != GLES_PASS_LAST) {
        const unsigned half = key->pass == GLES_PASS_SUM_LOW;
        gl->BindFramebuffer(draw_target(gles), t->framebuffer[2 * (1 - from) + half]);
        gl->Clear(GLES_COLOR_BUFFER_BIT | GLES_DEPTH_BUFFER_BIT);
    }
    gles_issue(gles, draw->item);
    return NACRE_OK;
}

/* Everything but the last pass; *from receives the sum that it reads. */
static nacre_result draw_sums(nacre_gles *gles, gles_draw *draw, gles_saved *saved, unsigned *from)
{
    const gles_procs *gl = &gles->gl;
    const unsigned lights = draw->view->light_count;
    nacre_result result = NACRE_OK;
    gles_key key;
    unsigned first, i;
    *from = 0;
    for (i = 0; i < 2; i++) {
        gl->BindFramebuffer(draw_target(gles), gles->targets.framebuffer[i]);
        gl->Clear(GLES_COLOR_BUFFER_BIT);
    }
    for (first = 0; first < lights && !result; first += gles_pass_lights(draw, first)) {
        const unsigned n = gles_pass_lights(draw, first);
        gles_key_of(gles, &key, draw, n, GLES_PASS_SUM_HIGH);
        result = draw_pass(gles, draw, saved, &key, first, *from);
        if (result) break;
        gles_key_of(gles, &key, draw, n, GLES_PASS_SUM_LOW);
        result = draw_pass(gles, draw, saved, &key, first, *from);
        *from = 1 - *from;
    }
    return result;
}

nacre_result gles_draw_passes(nacre_gles *gles, gles_draw *draw, gles_saved *saved)
{
    host_state host;
    gles_key key;
    unsigned from = 0;
    nacre_result result;
    host_save(gles, &host);
    result = fit_targets(gles, host.viewport[2], host.viewport[3]);
    if (!result) {
        passes_state(gles, draw);
        gles_bind_vertices(gles, draw, saved);
        result = draw_sums(gles, draw, saved, &from);
    }
    host_put_back(gles, &host);
    if (result) return result;
    gles_key_of(gles, &key, draw, 0, GLES_PASS_LAST);
    return draw_pass(gles, draw, saved, &key, 0, from);
}
