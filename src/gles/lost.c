/* SPDX-License-Identifier: MIT */
/* Results, messages, and the loss of the context. */
#include "gles.h"

#include <string.h>

nacre_result gles_fail(nacre_gles *gles, nacre_result result, const char *text, const char *detail)
{
    char message[160];
    unsigned n = 0;
    if (!gles->desc.log) return result;
    while (*text && n < sizeof message - 1) message[n++] = *text++;
    while (detail && *detail && n < sizeof message - 1) message[n++] = *detail++;
    message[n] = 0;
    gles->desc.log(gles->desc.user, result, message);
    return result;
}

static nacre_result note_lost(nacre_gles *gles)
{
    gles->lost = 1;
    return NACRE_ERR_LOST;
}

/* Error flags that GL may hold at once: one per distributed part. A lost context may answer for ever. */
#define MAX_ERROR_FLAGS 16

nacre_result gles_begin(nacre_gles *gles)
{
    int i;
    for (i = 0; i < MAX_ERROR_FLAGS; i++) {
        const gl_enum e = gles->gl.GetError();
        if (e == GLES_CONTEXT_LOST) return note_lost(gles);
        if (!e) break;
    }
    if (gles->gl.GetGraphicsResetStatus && gles->gl.GetGraphicsResetStatus()) return note_lost(gles);
    return NACRE_OK;
}

/* "0x0505" */
static void hex16(char *out, unsigned x)
{
    int i;
    out[0] = '0';
    out[1] = 'x';
    for (i = 0; i < 4; i++) out[2 + i] = "0123456789ABCDEF"[x >> (12 - 4 * i) & 15];
    out[6] = 0;
}

static nacre_result check(nacre_gles *gles, const char *what, nacre_result quiet)
{
    char text[32] = ": GL error ";
    gl_enum first = 0;
    int i;
    for (i = 0; i < MAX_ERROR_FLAGS; i++) {
        const gl_enum e = gles->gl.GetError();
        if (e == GLES_CONTEXT_LOST) return note_lost(gles);
        if (!e) break;
        if (!first) first = e;
    }
    if (gles->gl.GetGraphicsResetStatus && gles->gl.GetGraphicsResetStatus()) return note_lost(gles);
    if (!first && !quiet) return NACRE_OK;
    hex16(text + 11, first);
    return gles_fail(gles, NACRE_ERR_GL, what, text);
}

nacre_result gles_check(nacre_gles *gles, const char *what)
{
    return check(gles, what, NACRE_OK);
}

nacre_result gles_gl_failed(nacre_gles *gles, const char *what)
{
    return check(gles, what, NACRE_ERR_GL);
}

void nacre_gles_abandon(nacre_gles *gles)
{
    unsigned i;
    if (!gles) return;
    for (i = 0; i < gles->desc.max_programs; i++) gles->programs[i].name = 0;
    for (i = 0; i < gles->desc.max_textures; i++) gles->textures[i].name = 0;
    for (i = 0; i < gles->desc.max_items; i++) {
        gles_item *item = &gles->items[i];
        item->vertex_buffer = item->index_buffer = 0;
        if (item->source == GLES_SOURCE_BUFFERS) item->source = GLES_SOURCE_LOST;
        if (item->source == GLES_SOURCE_LIT) gles_lit_abandon(&item->is.lit);
    }
    memset(&gles->targets, 0, sizeof gles->targets);
    memset(gles->lit_sum, 0, sizeof gles->lit_sum);
    gles->lit_triangle = 0;
    gles->texture_bytes = 0;
    gles->vertex_array = 0;
    gles->described = 0;
    gles->enabled = 0;
    gles->resident = 0;
    gles->lost = 0;
    gles->bound = 0;
}

/* Upload every texture and mesh again; on failure what was made stays for the caller to delete. */
static nacre_result upload_all(nacre_gles *gles)
{
    nacre_result result = NACRE_OK;
    unsigned i;
    for (i = 0; i < gles->desc.max_textures && !result; i++)
        if (gles->textures[i].image) result = gles_texture_upload(gles, &gles->textures[i]);
    for (i = 0; i < gles->desc.max_items && !result; i++)
        if (gles->items[i].source == GLES_SOURCE_MESH) result = gles_mesh_upload(gles, &gles->items[i]);
    return result;
}

/* Bytes of all textures on this context, which may be another device than the one that was lost. */
static nacre_result total_cost(nacre_gles *gles, uint32_t *bytes)
{
    uint64_t sum = 0;
    unsigned i;
    for (i = 0; i < gles->desc.max_textures; i++) {
        const gles_texture *t = &gles->textures[i];
        uint32_t one = 0;
        nacre_result result;
        if (!t->image || t->layer) continue;
        result = gles_texture_cost(&gles->caps, t->image, t->role, &one);
        if (result) return gles_fail(gles, result, "texture format or size: not on this device", NULL);
        sum += one;
    }
    if (sum > gles->desc.texture_budget) return gles_fail(gles, NACRE_ERR_BUDGET, "texture_budget", NULL);
    *bytes = (uint32_t)sum;
    return NACRE_OK;
}

nacre_result gles_start(nacre_gles *gles)
{
    nacre_result result = gles_procs_load(gles);
    gles_upload_state saved;
    uint32_t bytes = 0;
    if (!result) result = gles_begin(gles);
    if (!result) result = gles_caps_read(&gles->caps, &gles->gl);
    if (result == NACRE_ERR_UNSUPPORTED) gles_fail(gles, result, "no OpenGL ES 2.0", NULL);
    if (!result) result = total_cost(gles, &bytes);
    if (result) {
        gles->lost = 0; /* as after abandon */
        return result;
    }
    gles->resident = 1;
    gles_upload_begin(gles, &saved);
    if (gles->caps.vertex_arrays) {
        gles->gl.GenVertexArrays(1, &gles->vertex_array);
        if (!gles->vertex_array) result = gles_gl_failed(gles, "glGenVertexArrays");
    }
    if (!result) result = upload_all(gles);
    gles_upload_end(gles, &saved);
    if (!result) result = gles_check(gles, "start");
    gles->texture_bytes = bytes;
    if (result) {
        gles_delete_all(gles);
        nacre_gles_abandon(gles);
    }
    return result;
}

nacre_result nacre_gles_restore(nacre_gles *gles)
{
    if (!gles) return NACRE_ERR_ARGUMENT;
    if (gles->resident && !gles->lost) return NACRE_OK;
    if (gles->resident) return NACRE_ERR_LOST; /* abandon comes first */
    return gles_start(gles);
}

void gles_delete_all(nacre_gles *gles)
{
    unsigned i;
    if (!gles->resident || gles->lost) return;
    /* A program of ours may still be current; deleted, it would be until the host's next glUseProgram. */
    if (gles->desc.host_resets_state) gles->gl.UseProgram(0);
    for (i = 0; i < gles->desc.max_programs; i++) gles_program_delete(gles, &gles->programs[i]);
    for (i = 0; i < gles->desc.max_textures; i++)
        if (gles->textures[i].name) gles->gl.DeleteTextures(1, &gles->textures[i].name);
    for (i = 0; i < gles->desc.max_items; i++) {
        gles_mesh_delete(gles, &gles->items[i]);
        if (gles->items[i].source == GLES_SOURCE_LIT) gles_lit_delete(gles, &gles->items[i].is.lit);
    }
    gles_targets_delete(gles);
    for (i = 0; i < 2; i++) gles_sum_delete(gles, &gles->lit_sum[i]);
    if (gles->lit_triangle) gles->gl.DeleteBuffers(1, &gles->lit_triangle);
    if (gles->vertex_array) gles->gl.DeleteVertexArrays(1, &gles->vertex_array);
}

void nacre_gles_shutdown(nacre_gles *gles)
{
    if (!gles) return;
    gles_delete_all(gles);
    nacre_gles_abandon(gles);
}
