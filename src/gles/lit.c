/* SPDX-License-Identifier: MIT */
/*
 * Lit spheres: a small picture of a sphere in one material under one set of lights, in display codes, by the same
 * programs that draw meshes directly. The picture's x and y are those of the bisector of normal and eye (an equal-area map
 * of the directions, Lambert 1772), as far as PICTURE_HALF.
 */
#include "gles.h"

#include <string.h>

#define PICTURE_HALF   SHADE_LIT_HALF_Q16 /* lit.frag has its inverse */
#define SIZE_DEFAULT   128
#define SIZE_LEAST     16
#define SIZE_MOST      512
#define VIEW_TOLERANCE 64 /* bam */
#define PICTURE_MIXED  1  /* gles_lit.shown of a picture whose inputs changed while it was made */

static gles_item *find_lit(nacre_gles *gles, nacre_gles_lit id)
{
    const nacre_gles_item as_item = {id.id};
    gles_item *const item = gles_item_find(gles, as_item);
    return item && item->source == GLES_SOURCE_LIT ? item : NULL;
}

static uint32_t picture_bytes(const gles_lit *lit)
{
    return (uint32_t)lit->size * lit->size * (lit->rgb565 ? 2 : 4);
}

/* ---- GL objects ----------------------------------------------------------------------------- */

static nacre_result make_triangle(nacre_gles *gles)
{
    /* x, y and two bytes that keep vertices on 4-byte boundaries */
    static const int8_t corner[3][4] = {{-1, -1, 0, 0}, {3, -1, 0, 0}, {-1, 3, 0, 0}};
    const gles_procs *gl = &gles->gl;
    if (gles->lit_triangle) return NACRE_OK;
    gl->GenBuffers(1, &gles->lit_triangle);
    if (!gles->lit_triangle) return gles_gl_failed(gles, "glGenBuffers");
    gl->BindBuffer(GLES_ARRAY_BUFFER, gles->lit_triangle);
    gl->BufferData(GLES_ARRAY_BUFFER, sizeof corner, corner, GLES_STATIC_DRAW);
    return NACRE_OK;
}

static void delete_picture(nacre_gles *gles, gles_lit *lit)
{
    if (lit->texture) gles->texture_bytes -= picture_bytes(lit);
    if (lit->framebuffer && !gles->lost) gles->gl.DeleteFramebuffers(1, &lit->framebuffer);
    if (lit->texture && !gles->lost) gles->gl.DeleteTextures(1, &lit->texture);
    lit->texture = lit->framebuffer = 0;
}

static nacre_result make_picture(nacre_gles *gles, gles_lit *lit)
{
    nacre_result result;
    if (lit->texture) return NACRE_OK;
    if ((uint64_t)picture_bytes(lit) + gles->texture_bytes > gles->desc.texture_budget)
        return gles_fail(gles, NACRE_ERR_BUDGET, "texture_budget: lit sphere", NULL);
    result =
        gles_target_make(gles, &lit->texture, &lit->framebuffer, lit->size, lit->size, lit->rgb565, GLES_LINEAR, 0);
    if (lit->texture) gles->texture_bytes += picture_bytes(lit);
    return result; /* delete_picture undoes what was made */
}

/* A sum of the picture's size, for passes. */
static nacre_result make_sum(nacre_gles *gles, gles_sum *sum, unsigned size)
{
    if (sum->width == size) return NACRE_OK;
    gles_sum_delete(gles, sum);
    if ((uint64_t)size * size * 8 + gles->texture_bytes > gles->desc.texture_budget)
        return gles_fail(gles, NACRE_ERR_BUDGET, "texture_budget: light pass targets of a lit sphere", NULL);
    return gles_sum_make(gles, sum, (gl_int)size, (gl_int)size, 0);
}

static nacre_result make_missing(nacre_gles *gles, gles_lit *lit, int in_passes)
{
    nacre_result result = make_triangle(gles);
    if (!result) result = make_picture(gles, lit);
    if (!result && in_passes) result = make_sum(gles, &gles->lit_sum[0], lit->size);
    if (!result && in_passes) result = make_sum(gles, &gles->lit_sum[1], lit->size);
    return result ? result : gles_check(gles, "lit sphere");
}

static void delete_triangle(nacre_gles *gles)
{
    if (gles->lit_triangle && !gles->lost) gles->gl.DeleteBuffers(1, &gles->lit_triangle);
    gles->lit_triangle = 0;
}

/* What an update needs and has not; reads errors only if there is anything to make. On failure nothing new is left. */
static nacre_result make_objects(nacre_gles *gles, gles_lit *lit, int in_passes)
{
    const int sums = in_passes && (gles->lit_sum[0].width != lit->size || gles->lit_sum[1].width != lit->size);
    const int picture = !lit->texture, triangle = !gles->lit_triangle;
    gl_int framebuffer = 0;
    gles_upload_state state;
    nacre_result result;
    int i;
    if (!picture && !triangle && !sums) return NACRE_OK;
    result = gles_begin(gles);
    if (result) return result;
    gles->gl.GetIntegerv(GLES_FRAMEBUFFER_BINDING, &framebuffer);
    gles_upload_begin(gles, &state);
    result = make_missing(gles, lit, in_passes);
    gles_upload_end(gles, &state);
    if (!gles->lost) gles->gl.BindFramebuffer(gles_draw_target(gles), (gl_uint)framebuffer);
    if (!result) return NACRE_OK;
    if (picture) delete_picture(gles, lit);
    if (triangle) delete_triangle(gles);
    for (i = 0; i < 2 && sums && !gles->lost; i++) gles_sum_delete(gles, &gles->lit_sum[i]);
    return result;
}

void gles_lit_abandon(gles_lit *lit)
{
    memset(&lit->sum, 0, sizeof lit->sum);
    lit->texture = lit->framebuffer = 0;
    lit->shown = lit->begun = 0;
    lit->under_way = 0;
}

void gles_lit_delete(nacre_gles *gles, gles_lit *lit)
{
    delete_picture(gles, lit);
    gles_sum_delete(gles, &lit->sum);
    gles_lit_abandon(lit);
}

/* ---- what changed --------------------------------------------------------------------------- */

/* FNV-1a, word by word (Fowler, Noll, Vo). */
static uint64_t hash_word(uint64_t hash, int32_t word)
{
    return (hash ^ (uint32_t)word) * 1099511628211u;
}

static uint64_t hash_rgb(uint64_t hash, const nacre_rgb *c)
{
    return hash_word(hash_word(hash_word(hash, c->r), c->g), c->b);
}

/* All that a picture depends on but material and view direction; above PICTURE_MIXED. */
static uint64_t hash_view(const nacre_view *view)
{
    uint64_t hash = 14695981039346656037u;
    unsigned i;
    hash = hash_word(hash_word(hash_word(hash, view->exposure), view->output), view->light_count);
    hash = hash_rgb(hash_rgb(hash, &view->ambient), &view->tint);
    for (i = 0; i < view->light_count; i++) {
        const nacre_light *const light = &view->lights[i];
        hash = hash_word(hash, light->shadow);
        hash = hash_word(hash_word(hash_word(hash, light->direction.x), light->direction.y), light->direction.z);
        hash = hash_rgb(hash, &light->power);
    }
    return hash > PICTURE_MIXED ? hash : PICTURE_MIXED + 1;
}

/* 1 when the angle between the unit vectors is below the tolerance: the chord, 2 sin(angle / 2), is compared. */
static int is_near(const int32_t a_q28[3], const int32_t b_q28[3], uint16_t tolerance)
{
    const int64_t chord = 2 * (int64_t)fx_sin_q28((uint32_t)tolerance << 15);
    int64_t sum = 0;
    int i;
    for (i = 0; i < 3; i++) {
        const int64_t d = (int64_t)a_q28[i] - b_q28[i];
        sum += d * d;
    }
    return sum <= chord * chord;
}

static int is_current(const gles_lit *lit, uint64_t wanted, const int32_t eye_q28[3])
{
    return lit->shown == wanted && is_near(lit->eye_q28, eye_q28, lit->view_tolerance);
}

/* ---- an update ------------------------------------------------------------------------------ */

/* The picture as a draw: the lit sphere's material on one triangle, seen along its own view direction. */
typedef struct picture {
    gles_draw draw;
    gles_item item;
    nacre_view view;
    gles_saved saved;
} picture;

/* A view of the same lights that looks at the origin along the sphere's axis, from 4,096 units away so that the
   direction stays exact in q16; normals go from the sphere's frame to view space. */
static void set_view(nacre_view *out, const nacre_view *view, const int32_t eye_q28[3])
{
    int32_t turn[3][3];
    int i, j;
    *out = *view;
    out->distant_viewer = 1;
    shade_turn_to_z(eye_q28, turn);
    memset(&out->object_to_view, 0, sizeof out->object_to_view);
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) out->object_to_view.m[4 * i + j] = (nacre_q16)fx_shift(turn[i][j], 12);
        out->object_to_view.m[12 + i] = -eye_q28[i];
    }
    out->object_to_view.m[15] = NACRE_Q16_ONE;
}

static void set_item(gles_item *out, const nacre_gles *gles, const gles_item *lit)
{
    nacre_gles_buffers *const b = &out->is.buffers;
    *out = *lit;
    out->source = GLES_SOURCE_BUFFERS;
    memset(b, 0, sizeof *b);
    b->vertex_buffer = gles->lit_triangle;
    b->count = 3;
    b->attribute[NACRE_GLES_POSITION].type = GLES_BYTE;
    b->attribute[NACRE_GLES_POSITION].count = 2;
    b->attribute[NACRE_GLES_POSITION].stride = 4;
    b->attribute[NACRE_GLES_NORMAL] = b->attribute[NACRE_GLES_POSITION]; /* not read */
}

static void set_picture(picture *p, nacre_gles *gles, const gles_item *lit, const nacre_view *view)
{
    memset(p, 0, sizeof *p);
    set_view(&p->view, view, lit->is.lit.next_eye_q28);
    set_item(&p->item, gles, lit);
    p->draw.view = &p->view;
    p->draw.item = &p->item;
    p->draw.sphere = 1;
    p->draw.query = !gles->desc.host_resets_state;
    p->draw.id = UINT32_MAX;
    p->draw.form = -1;
    p->draw.vertices.half_extent[0] = PICTURE_HALF;
}

static void begin_update(gles_lit *lit, uint64_t wanted, const int32_t eye_q28[3], const nacre_view *view)
{
    memcpy(lit->next_eye_q28, eye_q28, sizeof lit->next_eye_q28);
    lit->begun = wanted;
    lit->next_output = view->output;
    lit->lights_done = 0;
    lit->mixed = 0;
    lit->under_way = 1;
}

static void finish_update(gles_lit *lit)
{
    memcpy(lit->eye_q28, lit->next_eye_q28, sizeof lit->eye_q28);
    lit->shown = lit->mixed ? PICTURE_MIXED : lit->begun;
    lit->output = lit->next_output;
    lit->under_way = 0;
    lit->pictures++;
}

/* Whole picture in one pass. */
static nacre_result draw_at_once(nacre_gles *gles, picture *p)
{
    gles_program *program;
    gles_key key;
    nacre_result result;
    gles_key_of(gles, &key, &p->draw, p->view.light_count, GLES_PASS_NONE);
    result = gles_pass_bind(gles, &p->draw, &p->saved, &key, 0, &program);
    if (!result) gles_issue(gles, &p->item);
    return result;
}

static void swap_sums(gles_sum *a, gles_sum *b)
{
    const gles_sum t = *a;
    *a = *b;
    *b = t;
}

/* So many lights more; draws the picture after the last one. lit->sum keeps the sum between calls. */
static nacre_result draw_in_passes(nacre_gles *gles, picture *p, gles_lit *lit, unsigned budget)
{
    gles_sum *const sum = gles->lit_sum;
    const unsigned count = p->view.light_count;
    unsigned from = 0, done = 0;
    nacre_result result = NACRE_OK;
    if (lit->lights_done)
        swap_sums(&sum[0], &lit->sum);
    else
        gles_sum_clear(gles, &sum[0]);
    while (lit->lights_done < count && (!budget || done < budget) && !result) {
        const unsigned n = gles_pass_lights(&p->draw, lit->lights_done);
        result = gles_sum_pass(gles, &p->draw, &p->saved, sum, lit->lights_done, from);
        from = 1 - from;
        done += n;
        lit->lights_done = (uint16_t)(lit->lights_done + n);
    }
    if (!result && lit->lights_done >= count) {
        gles->gl.BindFramebuffer(gles_draw_target(gles), lit->framebuffer);
        return gles_last_pass(gles, &p->draw, &p->saved, &sum[from]);
    }
    swap_sums(&sum[from], &lit->sum);
    return result;
}

/* State around an update, and the update. */
static nacre_result draw_picture(nacre_gles *gles, picture *p, gles_lit *lit, unsigned budget)
{
    gles_host_state host;
    nacre_result result;
    gles_save(gles, &p->saved, p->draw.query);
    gles_host_save(gles, &host, 1);
    gles_picture_state(gles, lit->size);
    gles->gl.BindFramebuffer(gles_draw_target(gles), lit->framebuffer);
    gles_bind_vertices(gles, &p->draw, &p->saved);
    result = p->draw.sum_lights ? draw_in_passes(gles, p, lit, budget) : draw_at_once(gles, p);
    if (!gles->lost) {
        gles_host_put_back(gles, &host);
        if (p->draw.query)
            gles_put_back(gles, &p->saved);
        else
            gles_note(gles, &p->saved);
    }
    return result ? result : gles_check(gles, "lit sphere");
}

/* One call's part of an update. */
static nacre_result update(nacre_gles *gles, gles_item *item, const nacre_view *view, unsigned budget)
{
    gles_lit *const lit = &item->is.lit;
    const int spread = budget && budget < view->light_count;
    picture p;
    nacre_result result;
    set_picture(&p, gles, item, view);
    result = gles_plan_passes(gles, &p.draw, spread || lit->lights_done);
    if (!result) result = make_objects(gles, lit, p.draw.sum_lights != 0);
    if (result) return result;
    p.item.is.buffers.vertex_buffer = gles->lit_triangle;
    result = draw_picture(gles, &p, lit, budget);
    if (!result && (!p.draw.sum_lights || lit->lights_done >= view->light_count)) finish_update(lit);
    return result;
}

nacre_result nacre_gles_lit_update(nacre_gles *gles, nacre_gles_lit id, const nacre_q16 centre[3],
                                   const nacre_view *view, unsigned budget)
{
    static const nacre_q16 origin[3] = {0, 0, 0};
    gles_item *const item = gles ? find_lit(gles, id) : NULL;
    int32_t eye_q28[3];
    gles_lit *lit;
    uint64_t wanted;
    unsigned i;
    nacre_result result;
    if (!item || !gles_view_is_valid(view)) return NACRE_ERR_ARGUMENT;
    for (i = 0; i < view->light_count; i++)
        if (view->lights[i].type == NACRE_LIGHT_POINT) return NACRE_ERR_UNSUPPORTED;
    if (gles->lost || !gles->resident) return NACRE_ERR_LOST;
    lit = &item->is.lit;
    wanted = hash_view(view);
    shade_eye(view, centre ? centre : origin, eye_q28);
    if (!lit->under_way && is_current(lit, wanted, eye_q28)) return NACRE_OK;
    if (!lit->under_way || !budget || lit->next_output != view->output || lit->lights_done >= view->light_count)
        begin_update(lit, wanted, eye_q28, view);
    if (lit->begun != wanted) lit->mixed = 1;
    result = update(gles, item, view, budget);
    lit->failed = result != NACRE_OK;
    if (result) {
        lit->shown = 0;
        lit->under_way = 0;
        lit->lights_done = 0;
    }
    return result;
}

/* ---- adding, removing, asking ---------------------------------------------------------------- */

static int desc_fill(nacre_gles_lit_desc *out, const nacre_gles_lit_desc *desc)
{
    static const nacre_gles_lit_desc zero;
    *out = desc ? *desc : zero;
    if (!out->size) out->size = SIZE_DEFAULT;
    if (!out->view_tolerance) out->view_tolerance = VIEW_TOLERANCE;
    return out->size >= SIZE_LEAST && out->size <= SIZE_MOST && out->rgb565 <= 1 &&
           out->view_tolerance < FX_BAM_HALF / 2;
}

nacre_result nacre_gles_lit_add(nacre_gles *gles, const nacre_material *material, const nacre_gles_lit_desc *desc,
                                nacre_gles_lit *out)
{
    nacre_gles_lit_desc d;
    nacre_material plain;
    nacre_gles_item as_item;
    gles_item *item;
    gles_lit *lit;
    nacre_result result;
    if (!gles || !material || !out || !desc_fill(&d, desc)) return NACRE_ERR_ARGUMENT;
    if (material->model == NACRE_MODEL_SBRDF || material->model == NACRE_MODEL_PALETTE)
        return NACRE_ERR_UNSUPPORTED; /* a sphere is of one material */
    plain = *material;
    plain.image[NACRE_ROLE_NORMAL] = plain.image[NACRE_ROLE_MASK] = NULL;
    result = nacre_gles_add_buffers(gles, NULL, &plain, &as_item);
    if (result) return result;
    item = gles_item_find(gles, as_item);
    item->source = GLES_SOURCE_LIT;
    lit = &item->is.lit;
    memset(lit, 0, sizeof *lit);
    lit->size = d.size;
    lit->rgb565 = d.rgb565;
    lit->view_tolerance = d.view_tolerance;
    result = make_objects(gles, lit, 0);
    if (result) {
        nacre_gles_remove(gles, as_item);
        return result;
    }
    out->id = as_item.id;
    return NACRE_OK;
}

void nacre_gles_lit_remove(nacre_gles *gles, nacre_gles_lit lit)
{
    const nacre_gles_item as_item = {lit.id};
    if (gles && find_lit(gles, lit)) nacre_gles_remove(gles, as_item);
}

void nacre_gles_lit_get_state(const nacre_gles *gles, nacre_gles_lit id, nacre_gles_lit_state *out)
{
    /* gles_item_find changes nothing */
    const gles_item *const item = gles ? find_lit((nacre_gles *)(uintptr_t)gles, id) : NULL;
    if (!out) return;
    memset(out, 0, sizeof *out);
    if (!item) return;
    out->ready = item->is.lit.shown != 0;
    out->current = out->ready && !item->is.lit.under_way && !item->is.lit.failed && item->is.lit.shown != PICTURE_MIXED;
    out->lights_done = item->is.lit.under_way ? item->is.lit.lights_done : 0;
    out->pictures = item->is.lit.pictures;
}

nacre_result nacre_gles_use_lit(nacre_gles *gles, nacre_gles_item id, nacre_gles_lit first, nacre_gles_lit second)
{
    gles_item *const item = gles ? gles_item_find(gles, id) : NULL;
    if (!item || item->source == GLES_SOURCE_LIT) return NACRE_ERR_ARGUMENT;
    if ((first.id && !find_lit(gles, first)) || (second.id && !find_lit(gles, second))) return NACRE_ERR_ARGUMENT;
    item->use[0] = first;
    item->use[1] = second;
    return NACRE_OK;
}

/* ---- drawing -------------------------------------------------------------------------------- */

int gles_lit_of(nacre_gles *gles, const gles_item *item, const nacre_view *view, const gles_lit *out[2])
{
    int i;
    out[0] = out[1] = NULL;
    for (i = 0; i < 2; i++) {
        const gles_item *const lit = find_lit(gles, item->use[i]);
        if (!lit || !lit->is.lit.shown || lit->is.lit.output != view->output) break;
        out[i] = &lit->is.lit;
    }
    return i;
}
