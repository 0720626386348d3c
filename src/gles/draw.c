/* SPDX-License-Identifier: MIT */
/* Prepare, draw, bind: a view becomes a key, textures and uniforms. */
#include "gles.h"

#include <string.h>

/* ---- the view ------------------------------------------------------------------------------- */

/* 0 when the columns of the 3x3 part lie in a plane. Each column is first brought below 2^20, which changes no sign. */
static int matrix_is_regular(const nacre_mat4 *m)
{
    int64_t c[3][3];
    int i, k;
    for (i = 0; i < 3; i++) {
        int64_t largest = 0;
        for (k = 0; k < 3; k++) {
            c[i][k] = m->m[4 * i + k];
            if ((c[i][k] < 0 ? -c[i][k] : c[i][k]) > largest) largest = c[i][k] < 0 ? -c[i][k] : c[i][k];
        }
        for (; largest >= 1 << 20; largest /= 2)
            for (k = 0; k < 3; k++) c[i][k] /= 2;
    }
    return c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) - c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
               c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]) !=
           0;
}

static int light_is_valid(const nacre_light *light)
{
    if (light->type > NACRE_LIGHT_POINT || light->shadow < 0 || light->shadow > NACRE_Q14_ONE) return 0;
    return light->type == NACRE_LIGHT_POINT || light->direction.x || light->direction.y || light->direction.z;
}

int gles_view_is_valid(const nacre_view *view)
{
    const nacre_q16 *m;
    unsigned i;
    if (!view || view->light_count > NACRE_MAX_LIT_LIGHTS || (view->light_count && !view->lights)) return 0;
    if (view->output > NACRE_OUTPUT_LINEAR || view->distant_viewer > 1 || view->exposure < 0) return 0;
    for (i = 0; i < view->light_count; i++)
        if (!light_is_valid(&view->lights[i])) return 0;
    m = view->object_to_view.m;
    return !m[3] && !m[7] && !m[11] && m[15] == NACRE_Q16_ONE && matrix_is_regular(&view->object_to_view);
}

/* ---- the key -------------------------------------------------------------------------------- */

static int has_ambient(const nacre_view *view)
{
    return view->ambient.r > 0 || view->ambient.g > 0 || view->ambient.b > 0;
}

static void key_model(gles_key *key, const shade_material *material)
{
    const shade_table *t = &material->is.table;
    if (material->model == NACRE_MODEL_SBRDF) {
        key->model = GLES_KEY_SBRDF;
        return;
    }
    if (material->model == NACRE_MODEL_PALETTE) {
        key->model = GLES_KEY_PALETTE;
        key->phid = 1;
        key->blend = material->palette.blend;
        return;
    }
    if (material->model == NACRE_MODEL_SPHERES) {
        const shade_spheres *s = &material->is.spheres;
        key->model = s->cosine ? GLES_KEY_PAPER : s->size ? GLES_KEY_QUARTER : GLES_KEY_SPHERES;
        return;
    }
    key->model = material->early ? GLES_KEY_EARLY : material->fine ? GLES_KEY_FINE : GLES_KEY_TABLE;
    key->phid = (uint8_t)(material->fine || t->w[0] || t->w[1] || t->w[2]);
    key->power48 = t->p > 4 * NACRE_Q16_ONE + NACRE_Q16_ONE / 2; /* 4 or 4.8, see material.c */
    key->toe = t->toe;
}

/* Lobes that a pass takes: with the textures of a sum there is room for two. */
static unsigned pass_lobes(const gles_draw *draw, unsigned pass)
{
    const unsigned lobes = draw->item->material.is.sbrdf.lobes;
    const unsigned left = lobes - draw->first_lobe;
    if (pass != GLES_PASS_SUM) return lobes;
    return left < 2 ? left : 2;
}

int gles_pass_next_lobes(gles_draw *draw)
{
    if (draw->item->material.model != NACRE_MODEL_SBRDF || draw->lit[0]) return 0;
    draw->first_lobe = (uint8_t)(draw->first_lobe + pass_lobes(draw, GLES_PASS_SUM));
    if (draw->first_lobe < draw->item->material.is.sbrdf.lobes) return 1;
    draw->first_lobe = 0;
    return 0;
}

/* By the power table where the device is better at it, or the application wants it, and a unit is left. */
static int uses_power_table(const nacre_gles *gles, const gles_key *key, const shade_sbrdf *sbrdf)
{
    gles_key k = *key;
    if (!sbrdf->power_width || gles->desc.power == NACRE_GLES_POWER_COMPUTED) return 0;
    if (gles->desc.power != NACRE_GLES_POWER_TABLE && !(gles->caps.power_table && sbrdf->power_serves)) return 0;
    k.power = 1;
    k.pass = GLES_PASS_NONE; /* all passes alike */
    k.no_diffuse = 0;
    k.lobes = sbrdf->lobes;
    k.direction = sbrdf->direction;
    if (gles_key_units(&k) > gles->caps.units) return 0;
    k.pass = key->pass;
    if (k.pass && k.lobes > 2) k.lobes = 2;
    return gles_key_units(&k) <= gles->caps.units;
}

static void key_sbrdf(const nacre_gles *gles, gles_key *key, const gles_draw *draw)
{
    const shade_sbrdf *sbrdf = &draw->item->material.is.sbrdf;
    key->lobes = (uint8_t)pass_lobes(draw, key->pass);
    key->direction = sbrdf->direction;
    if (key->pass == GLES_PASS_SUM && draw->first_lobe) {
        key->direction *= 2;
        key->no_diffuse = 1;
    }
    key->power = (uint8_t)uses_power_table(gles, key, sbrdf);
}

void gles_key_of(const nacre_gles *gles, gles_key *key, const gles_draw *draw, unsigned lights, unsigned pass)
{
    const shade_material *material = &draw->item->material;
    memset(key, 0, sizeof *key);
    key_model(key, material);
    if (draw->lit[0]) {
        key->model = GLES_KEY_LIT;
        key->mask = draw->item->image[NACRE_ROLE_MASK] ? draw->lit[1] ? 2 : 1 : 0;
    }
    key->sphere = draw->sphere;
    key->lights = (uint8_t)lights;
    key->pass = (uint8_t)pass;
    key->output = draw->view->output;
    key->normal_map = draw->item->image[NACRE_ROLE_NORMAL] != NULL;
    key->es3 = gles_uses_es3(gles);
    key->persp = lights && shade_needs_persp(draw->view);
    key->ambient = has_ambient(draw->view);
    if (key->model == GLES_KEY_QUARTER)
        key->layers = gles_key_quarter_class(material->is.spheres.layers);
    else if (key->persp && material->model == NACRE_MODEL_SPHERES)
        key->layers =
            gles_key_layer_class(material->is.spheres.layers, gles->caps.units - key->normal_map - (pass ? 2u : 0u));
    if (key->model == GLES_KEY_SBRDF) key_sbrdf(gles, key, draw);
    gles_key_canonical(key);
}

static unsigned most_lights(const nacre_gles *gles, const gles_draw *draw, unsigned pass)
{
    gles_key key;
    gles_key_of(gles, &key, draw, 1, pass);
    return gles_key_max_lights(&key, pass, gles->caps.fragment_vectors, gles->caps.units);
}

nacre_result gles_plan_passes(const nacre_gles *gles, gles_draw *draw, int in_passes)
{
    const unsigned lights = draw->view->light_count;
    draw->sum_lights = 0;
    if (draw->lit[0] || !lights) return NACRE_OK;
    if (!in_passes && lights <= most_lights(gles, draw, GLES_PASS_NONE)) return NACRE_OK;
    draw->sum_lights = (uint8_t)most_lights(gles, draw, GLES_PASS_SUM);
    return draw->sum_lights ? NACRE_OK : NACRE_ERR_UNSUPPORTED;
}

unsigned gles_pass_lights(const gles_draw *draw, unsigned first_light)
{
    unsigned n = draw->sum_lights;
    while (n > draw->view->light_count - first_light) n /= 2; /* 8, 4, 2 or 1 */
    return n;
}

static void describe_vertices(gles_draw *draw)
{
    const gles_item *item = draw->item;
    int i;
    memset(&draw->vertices, 0, sizeof draw->vertices);
    for (i = 0; i < 3; i++) {
        if (item->source == GLES_SOURCE_MESH) {
            draw->vertices.centre[i] = draw->centre[i] = item->is.mesh.centre[i];
            draw->vertices.half_extent[i] = item->is.mesh.half_extent[i];
        } else {
            draw->vertices.half_extent[i] = NACRE_Q16_ONE;
            draw->centre[i] = item->source == GLES_SOURCE_BUFFERS ? item->is.buffers.centre[i] : 0;
        }
    }
    draw->vertices.uv_q11 = item->source == GLES_SOURCE_MESH;
}

static nacre_result begin(nacre_gles *gles, nacre_gles_item id, const nacre_view *view, gles_draw *draw)
{
    if (!gles || !gles_view_is_valid(view)) return NACRE_ERR_ARGUMENT;
    draw->item = gles_item_find(gles, id);
    if (!draw->item || draw->item->source == GLES_SOURCE_LIT) return NACRE_ERR_ARGUMENT;
    if (gles->lost || !gles->resident) return NACRE_ERR_LOST;
    draw->view = view;
    draw->id = id.id;
    draw->query = !gles->desc.host_resets_state;
    draw->form = -1;
    draw->sphere = 0;
    draw->first_lobe = 0;
    gles_lit_of(gles, draw->item, view, draw->lit);
    describe_vertices(draw);
    return gles_plan_passes(gles, draw, 0);
}

/* ---- one pass ------------------------------------------------------------------------------- */

static gl_uint layer_name(const nacre_gles *gles, const gles_item *item, unsigned role, unsigned layer)
{
    return gles->textures[item->first_texture[role] + layer].name;
}

static unsigned sbrdf_textures(const nacre_gles *gles, const gles_draw *draw, const gles_key *key,
                               gl_uint name[GLES_MAX_UNITS])
{
    const gles_item *item = draw->item;
    unsigned n = 0, i;
    if (!key->no_diffuse) name[n++] = layer_name(gles, item, NACRE_ROLE_ALBEDO, 0);
    for (i = 0; i < 2u * key->lobes; i++)
        name[n++] = layer_name(gles, item, NACRE_ROLE_LOBES, 2u * draw->first_lobe + i);
    for (i = 0; i < 2; i++)
        if (gles_key_unit_direction(key, (int)i) >= 0) name[n++] = layer_name(gles, item, NACRE_ROLE_LOBES, 2 * i);
    if (key->power) name[n++] = layer_name(gles, item, NACRE_ROLE_POWER, 0);
    return n;
}

/* The model's own textures, in the order of key.h; returns how many. */
static unsigned model_textures(const nacre_gles *gles, const gles_draw *draw, const gles_key *key, unsigned first_light,
                               gl_uint name[GLES_MAX_UNITS])
{
    const gles_item *item = draw->item;
    const shade_frame *frame = &draw->frame;
    unsigned i;
    if (key->model == GLES_KEY_LIT) {
        for (i = 0; i < (key->mask > 1 ? 2u : 1u); i++) name[i] = draw->lit[i]->texture;
        return i;
    }
    if (key->model == GLES_KEY_SBRDF) return sbrdf_textures(gles, draw, key, name);
    if (key->model == GLES_KEY_PALETTE) {
        name[0] = layer_name(gles, item, NACRE_ROLE_PALETTE, 0);
        name[1] = layer_name(gles, item, NACRE_ROLE_INDEX, 0);
        return 2;
    }
    if (!key->lights) return 0;
    if (item->material.model == NACRE_MODEL_TABLE) {
        const unsigned layers = key->model == GLES_KEY_TABLE ? 1 : 2;
        for (i = 0; i < layers; i++) name[i] = layer_name(gles, item, NACRE_ROLE_TABLE, i);
        return layers;
    }
    if (key->model == GLES_KEY_QUARTER) {
        name[0] = layer_name(gles, item, NACRE_ROLE_SPHERES, 0);
        return 1;
    }
    if (key->persp) {
        for (i = 0; i < key->layers; i++) {
            const unsigned layer = frame->is.spheres.layer[i];
            name[i] = layer_name(gles, item, NACRE_ROLE_SPHERES, layer);
        }
        return key->layers;
    }
    for (i = 0; i < 2u * key->lights; i++)
        name[i] = layer_name(gles, item, NACRE_ROLE_SPHERES, frame->light[first_light + i / 2].is.spheres.layer[i & 1]);
    return 2u * key->lights;
}

static void bind_map(const nacre_gles *gles, const gles_draw *draw, gles_saved *saved, int unit, unsigned role)
{
    if (unit >= 0) gles_texture_bind(gles, saved, (unsigned)unit, layer_name(gles, draw->item, role, 0), draw->query);
}

/* The frame that holds this light, in this form. */
static void set_up_frame(gles_draw *draw, const gles_key *key, unsigned first_light)
{
    const int form = (int)gles_key_form(key);
    const unsigned base = first_light - first_light % NACRE_MAX_LIGHTS;
    nacre_view part = *draw->view;
    if (key->model == GLES_KEY_LIT) {
        shade_turn_to_z(draw->lit[0]->eye_q28, draw->frame.turn_q28);
        draw->frame.position_shift = 0;
        return;
    }
    if (form == draw->form && base == draw->first_light) return;
    part.lights += base;
    part.light_count = (uint16_t)(part.light_count - base);
    shade_setup(&draw->frame, &part, draw->centre, &draw->item->material, (shade_form)form, key->persp,
                key->layers ? key->layers : GLES_MAX_UNITS);
    draw->form = form;
    draw->first_light = base;
}

nacre_result gles_pass_bind(nacre_gles *gles, gles_draw *draw, gles_saved *saved, const gles_key *key,
                            unsigned first_light, gles_program **out)
{
    gl_uint textures[GLES_MAX_UNITS];
    gles_program *program;
    unsigned count, i;
    const nacre_result result = gles_program_use(gles, key, &program);
    if (result) return result;
    set_up_frame(draw, key, first_light);
    first_light %= NACRE_MAX_LIGHTS;
    count = model_textures(gles, draw, key, first_light, textures);
    for (i = 0; i < count; i++) gles_texture_bind(gles, saved, i, textures[i], draw->query);
    bind_map(gles, draw, saved, gles_key_unit_normal(key), NACRE_ROLE_NORMAL);
    bind_map(gles, draw, saved, gles_key_unit_mask(key), NACRE_ROLE_MASK);
    gles_uniforms_set(&gles->gl, &program->at, key, draw->view, &draw->vertices, &draw->frame, first_light,
                      draw->first_lobe);
    *out = program;
    return NACRE_OK;
}

/* ---- vertices ------------------------------------------------------------------------------- */

static unsigned attribute_mask(const gles_item *item)
{
    const unsigned position_normal = 1u << NACRE_GLES_POSITION | 1u << NACRE_GLES_NORMAL;
    const unsigned uv = 1u << NACRE_GLES_UV;
    if (gles_item_needs_tangent(item)) return position_normal | 1u << NACRE_GLES_TANGENT | uv;
    return gles_item_needs_uv(item) ? position_normal | uv : position_normal;
}

/* nacre_vertex, as GL reads it. */
static const nacre_gles_attribute mesh_attributes[NACRE_GLES_ATTRIBUTE_COUNT] = {
    {GLES_SHORT, 3, 1, offsetof(nacre_vertex, position), sizeof(nacre_vertex)},
    {GLES_SHORT, 3, 1, offsetof(nacre_vertex, normal), sizeof(nacre_vertex)},
    {GLES_BYTE, 4, 1, offsetof(nacre_vertex, tangent), sizeof(nacre_vertex)},
    {GLES_SHORT, 2, 0, offsetof(nacre_vertex, uv), sizeof(nacre_vertex)},
};

/* Point the item's attributes at its buffers, in the current vertex array. enabled: the arrays on there, 0: unknown. */
static void point_attributes(const gles_procs *gl, const gles_item *item, unsigned enabled)
{
    const int own = item->source == GLES_SOURCE_MESH;
    const nacre_gles_attribute *a = own ? mesh_attributes : item->is.buffers.attribute;
    const unsigned wanted = attribute_mask(item);
    unsigned i;
    gl->BindBuffer(GLES_ARRAY_BUFFER, own ? item->vertex_buffer : item->is.buffers.vertex_buffer);
    gl->BindBuffer(GLES_ELEMENT_ARRAY_BUFFER, own ? item->index_buffer : item->is.buffers.index_buffer);
    for (i = 0; i < NACRE_GLES_ATTRIBUTE_COUNT; i++) {
        if (wanted >> i & 1)
            gl->VertexAttribPointer(i, a[i].count, a[i].type, a[i].normalized, (gl_sizei)a[i].stride,
                                    (const void *)(uintptr_t)a[i].offset);
        if ((wanted & ~enabled) >> i & 1) gl->EnableVertexAttribArray(i);
        if ((enabled & ~wanted) >> i & 1) gl->DisableVertexAttribArray(i);
    }
}

void gles_bind_vertices(nacre_gles *gles, const gles_draw *draw, gles_saved *saved)
{
    const int same = gles->vertex_array && gles->described == draw->id;
    gles_save_buffers(gles, saved, attribute_mask(draw->item), same, draw->query);
    if (!gles->vertex_array) {
        point_attributes(&gles->gl, draw->item, 0);
        return;
    }
    gles->gl.BindVertexArray(gles->vertex_array);
    if (same) return;
    point_attributes(&gles->gl, draw->item, gles->enabled);
    gles->enabled = (uint8_t)attribute_mask(draw->item);
    /* The caller may delete its buffers and reuse their names, so those are pointed at anew each time. */
    gles->described = draw->item->source == GLES_SOURCE_MESH ? draw->id : 0;
}

void gles_issue(const nacre_gles *gles, const gles_item *item)
{
    const nacre_gles_buffers *b = &item->is.buffers;
    if (item->source == GLES_SOURCE_MESH)
        gles->gl.DrawElements(GLES_TRIANGLES, (gl_sizei)item->is.mesh.index_count, GLES_UNSIGNED_SHORT, NULL);
    else if (b->index_buffer)
        gles->gl.DrawElements(GLES_TRIANGLES, (gl_sizei)b->count, b->index_type,
                              (const void *)(uintptr_t)b->index_offset);
    else
        gles->gl.DrawArrays(GLES_TRIANGLES, (gl_int)b->first, (gl_sizei)b->count);
}

/* ---- public --------------------------------------------------------------------------------- */

nacre_result nacre_gles_draw(nacre_gles *gles, nacre_gles_item id, const nacre_view *view)
{
    gles_draw draw;
    gles_saved saved;
    gles_key key;
    gles_program *program;
    nacre_result result = begin(gles, id, view, &draw);
    if (result) return result;
    if (draw.item->source != GLES_SOURCE_MESH && draw.item->source != GLES_SOURCE_BUFFERS) return NACRE_ERR_ARGUMENT;

    gles_save(gles, &saved, draw.query);
    if (draw.sum_lights) {
        result = gles_draw_passes(gles, &draw, &saved);
    } else {
        gles_key_of(gles, &key, &draw, view->light_count, GLES_PASS_NONE);
        result = gles_pass_bind(gles, &draw, &saved, &key, 0, &program);
        if (!result) {
            gles_bind_vertices(gles, &draw, &saved);
            gles_issue(gles, draw.item);
        }
    }
    if (draw.query)
        gles_put_back(gles, &saved);
    else
        gles_note(gles, &saved);
    return result;
}

nacre_result nacre_gles_bind(nacre_gles *gles, nacre_gles_item id, const nacre_view *view, uint32_t *program)
{
    gles_draw draw;
    gles_key key;
    gles_program *used;
    nacre_result result = begin(gles, id, view, &draw);
    if (result) return result;
    if (draw.sum_lights) return NACRE_ERR_UNSUPPORTED;
    nacre_gles_unbind(gles);
    gles_save(gles, &gles->saved, draw.query);
    gles_key_of(gles, &key, &draw, view->light_count, GLES_PASS_NONE);
    result = gles_pass_bind(gles, &draw, &gles->saved, &key, 0, &used);
    if (!draw.query) gles_note(gles, &gles->saved);
    gles->bound = 1;
    if (result) {
        nacre_gles_unbind(gles);
        return result;
    }
    if (program) *program = used->name;
    return NACRE_OK;
}

nacre_result nacre_gles_unbind(nacre_gles *gles)
{
    if (!gles) return NACRE_ERR_ARGUMENT;
    if (!gles->bound) return NACRE_OK;
    gles->bound = 0;
    if (!gles->desc.host_resets_state && !gles->lost) gles_put_back(gles, &gles->saved);
    return NACRE_OK;
}

nacre_result nacre_gles_prepare(nacre_gles *gles, nacre_gles_item id, const nacre_view *view)
{
    gles_draw draw;
    gles_program *program;
    gles_key key;
    gl_int current = 0;
    unsigned first;
    nacre_result result = begin(gles, id, view, &draw);
    if (result) return result;
    gles->gl.GetIntegerv(GLES_CURRENT_PROGRAM, &current);
    for (first = 0; draw.sum_lights && first < view->light_count && !result; first += gles_pass_lights(&draw, first)) {
        do {
            gles_key_of(gles, &key, &draw, gles_pass_lights(&draw, first), GLES_PASS_SUM);
            result = gles_program_use(gles, &key, &program);
        } while (gles_pass_next_lobes(&draw) && !result);
    }
    gles_key_of(gles, &key, &draw, draw.sum_lights ? 0 : view->light_count,
                draw.sum_lights ? GLES_PASS_LAST : GLES_PASS_NONE);
    if (!result) result = gles_program_use(gles, &key, &program);
    if (!gles->lost) gles->gl.UseProgram((gl_uint)current);
    return result;
}
