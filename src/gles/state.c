/* SPDX-License-Identifier: MIT */
/* The host's GL state: asked for, changed, put back. Values start at 0 because a lost context answers nothing. */
#include "gles.h"

#include <string.h>

static const uint16_t unpack_rows[3] = {GLES_UNPACK_ROW_LENGTH, GLES_UNPACK_SKIP_ROWS, GLES_UNPACK_SKIP_PIXELS};

void gles_upload_begin(const nacre_gles *gles, gles_upload_state *state)
{
    const gles_procs *gl = &gles->gl;
    int i;
    memset(state, 0, sizeof *state);
    state->alignment = 4;
    gl->GetIntegerv(GLES_TEXTURE_BINDING_2D, &state->texture);
    gl->GetIntegerv(GLES_ARRAY_BUFFER_BINDING, &state->array_buffer);
    gl->GetIntegerv(GLES_ELEMENT_ARRAY_BUFFER_BINDING, &state->element_buffer);
    gl->GetIntegerv(GLES_UNPACK_ALIGNMENT, &state->alignment);
    gl->PixelStorei(GLES_UNPACK_ALIGNMENT, 1); /* rows in the file are tight */
    if (!gles->caps.unpack_rows) return;
    for (i = 0; i < 3; i++) {
        gl->GetIntegerv(unpack_rows[i], &state->row[i]);
        if (state->row[i]) gl->PixelStorei(unpack_rows[i], 0);
    }
    gl->GetIntegerv(GLES_PIXEL_UNPACK_BUFFER_BINDING, &state->unpack_buffer);
    if (state->unpack_buffer) gl->BindBuffer(GLES_PIXEL_UNPACK_BUFFER, 0);
}

void gles_upload_end(const nacre_gles *gles, const gles_upload_state *state)
{
    const gles_procs *gl = &gles->gl;
    int i;
    if (gles->lost) return;
    gl->BindTexture(GLES_TEXTURE_2D, (gl_uint)state->texture);
    gl->BindBuffer(GLES_ARRAY_BUFFER, (gl_uint)state->array_buffer);
    gl->BindBuffer(GLES_ELEMENT_ARRAY_BUFFER, (gl_uint)state->element_buffer);
    gl->PixelStorei(GLES_UNPACK_ALIGNMENT, state->alignment);
    if (!gles->caps.unpack_rows) return;
    for (i = 0; i < 3; i++)
        if (state->row[i]) gl->PixelStorei(unpack_rows[i], state->row[i]);
    if (state->unpack_buffer) gl->BindBuffer(GLES_PIXEL_UNPACK_BUFFER, (gl_uint)state->unpack_buffer);
}

void gles_save(const nacre_gles *gles, gles_saved *saved, int query)
{
    memset(saved, 0, sizeof *saved);
    saved->active_texture = GLES_TEXTURE0;
    if (!query) return;
    gles->gl.GetIntegerv(GLES_CURRENT_PROGRAM, &saved->program);
    gles->gl.GetIntegerv(GLES_ACTIVE_TEXTURE, &saved->active_texture);
}

static void save_attribute(const gles_procs *gl, gles_saved *saved, unsigned i)
{
    gl->GetVertexAttribiv(i, GLES_VERTEX_ATTRIB_ARRAY_ENABLED, &saved->attribute[i].enabled);
    gl->GetVertexAttribiv(i, GLES_VERTEX_ATTRIB_ARRAY_SIZE, &saved->attribute[i].size);
    gl->GetVertexAttribiv(i, GLES_VERTEX_ATTRIB_ARRAY_TYPE, &saved->attribute[i].type);
    gl->GetVertexAttribiv(i, GLES_VERTEX_ATTRIB_ARRAY_NORMALIZED, &saved->attribute[i].normalized);
    gl->GetVertexAttribiv(i, GLES_VERTEX_ATTRIB_ARRAY_STRIDE, &saved->attribute[i].stride);
    gl->GetVertexAttribiv(i, GLES_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING, &saved->attribute[i].buffer);
    gl->GetVertexAttribPointerv(i, GLES_VERTEX_ATTRIB_ARRAY_POINTER, &saved->attribute[i].pointer);
}

void gles_save_buffers(const nacre_gles *gles, gles_saved *saved, unsigned attributes, int same, int query)
{
    const gles_procs *gl = &gles->gl;
    unsigned i;
    saved->buffers = !same;
    saved->arrays = gles->vertex_array != 0;
    if (!saved->arrays) saved->attributes = (uint8_t)attributes;
    if (!query) return;
    if (saved->buffers) gl->GetIntegerv(GLES_ARRAY_BUFFER_BINDING, &saved->array_buffer);
    if (saved->arrays) {
        gl->GetIntegerv(GLES_VERTEX_ARRAY_BINDING, &saved->vertex_array);
        return;
    }
    gl->GetIntegerv(GLES_ELEMENT_ARRAY_BUFFER_BINDING, &saved->element_buffer);
    for (i = 0; i < NACRE_GLES_ATTRIBUTE_COUNT; i++)
        if (attributes >> i & 1) save_attribute(gl, saved, i);
}

void gles_texture_bind(const nacre_gles *gles, gles_saved *saved, unsigned unit, gl_uint name, int query)
{
    const gles_procs *gl = &gles->gl;
    gl->ActiveTexture(GLES_TEXTURE0 + unit);
    if (unit >= saved->units) {
        saved->units = (uint8_t)(unit + 1);
        if (query) gl->GetIntegerv(GLES_TEXTURE_BINDING_2D, &saved->texture[unit]);
        if (query && gles->caps.samplers) gl->GetIntegerv(GLES_SAMPLER_BINDING, &saved->sampler[unit]);
        if (gles->caps.samplers && (!query || saved->sampler[unit])) gl->BindSampler(unit, 0);
    }
    gl->BindTexture(GLES_TEXTURE_2D, name);
}

static void put_back_attribute(const gles_procs *gl, const gles_saved *saved, unsigned i)
{
    gl->BindBuffer(GLES_ARRAY_BUFFER, (gl_uint)saved->attribute[i].buffer);
    gl->VertexAttribPointer(i, saved->attribute[i].size, (gl_enum)saved->attribute[i].type,
                            (gl_boolean)saved->attribute[i].normalized, saved->attribute[i].stride,
                            saved->attribute[i].pointer);
    if (!saved->attribute[i].enabled) gl->DisableVertexAttribArray(i);
}

void gles_put_back(const nacre_gles *gles, const gles_saved *saved)
{
    const gles_procs *gl = &gles->gl;
    unsigned i;
    for (i = 0; i < saved->units; i++) {
        gl->ActiveTexture(GLES_TEXTURE0 + i);
        gl->BindTexture(GLES_TEXTURE_2D, (gl_uint)saved->texture[i]);
        if (saved->sampler[i]) gl->BindSampler(i, (gl_uint)saved->sampler[i]);
    }
    gl->ActiveTexture((gl_enum)saved->active_texture);
    gl->UseProgram((gl_uint)saved->program);
    for (i = 0; i < NACRE_GLES_ATTRIBUTE_COUNT; i++)
        if (saved->attributes >> i & 1) put_back_attribute(gl, saved, i);
    if (saved->arrays) gl->BindVertexArray((gl_uint)saved->vertex_array);
    if (!saved->buffers) return;
    if (!saved->arrays) gl->BindBuffer(GLES_ELEMENT_ARRAY_BUFFER, (gl_uint)saved->element_buffer);
    gl->BindBuffer(GLES_ARRAY_BUFFER, (gl_uint)saved->array_buffer);
}

void gles_note(nacre_gles *gles, const gles_saved *saved)
{
    nacre_gles_state *c = &gles->changed;
    c->program = 1;
    c->texture_units = saved->units;
    c->samplers = saved->units && gles->caps.samplers;
    c->active_texture = saved->units != 0;
    c->buffers = saved->buffers;
    c->attributes = saved->attributes;
    c->vertex_array = saved->arrays;
    /* Applications that never heard of vertex arrays live in number 0. */
    if (c->vertex_array) gles->gl.BindVertexArray(0);
}
