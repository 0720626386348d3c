/* SPDX-License-Identifier: MIT */
#include "uniforms.h"

#include "nacre_gles.h"

#define MOST_VECTORS 10

typedef struct vectors { /* what one glUniform4fv sets */
    gl_float v[MOST_VECTORS][4];
} vectors;

/* ---- integers into floats ------------------------------------------------------------------------ */

/* x 2^e; both within float's range. */
static gl_float real(int64_t x, int e)
{
    gl_float f = (gl_float)x;

    if (!x) return 0.0f;
    for (; e >= 16; e -= 16) f *= 65536.0f;
    for (; e <= -16; e += 16) f *= 1.0f / 65536.0f;
    for (; e > 0; e--) f *= 2.0f;
    for (; e < 0; e++) f *= 0.5f;
    return f;
}

static gl_float from_real(fx_real x)
{
    return real(x.m, x.e);
}

static gl_float from_q28(int32_t x)
{
    return (gl_float)x * (1.0f / 268435456.0f);
}

static gl_float from_q16(nacre_q16 x)
{
    return (gl_float)x * (1.0f / 65536.0f);
}

static void put_q28(gl_float *out, const int32_t *x, int count)
{
    int i;

    for (i = 0; i < count; i++) out[i] = from_q28(x[i]);
}

static void put_real(gl_float *out, const fx_real *x, int count)
{
    int i;

    for (i = 0; i < count; i++) out[i] = from_real(x[i]);
}

/* ---- locations ----------------------------------------------------------------------------------- */

const char *gles_attribute_name(unsigned location)
{
    static const char *const name[NACRE_GLES_ATTRIBUTE_COUNT] = {"a_position", "a_normal", "a_tangent", "a_uv"};

    return location < NACRE_GLES_ATTRIBUTE_COUNT ? name[location] : 0;
}

static void set_sampler(const gles_procs *gl, gl_uint program, const char *name, int unit)
{
    const gl_int at = unit < 0 ? -1 : gl->GetUniformLocation(program, name);

    if (at >= 0) gl->Uniform1i(at, unit);
}

void gles_uniforms_locate(const gles_procs *gl, gl_uint program, const gles_key *key, gles_uniforms *out)
{
    char map[] = "u_map[0]";
    const int sum = gles_key_unit_sum(key);
    int i;

#define GLES_U(name) out->name = gl->GetUniformLocation(program, "u_" #name);
    GLES_UNIFORMS(GLES_U)
#undef GLES_U
    for (i = 0; i < SHADE_MAX_UNITS; i++) {
        map[6] = (char)('0' + i);
        set_sampler(gl, program, map, i);
    }
    set_sampler(gl, program, "u_normal_map", gles_key_unit_normal(key));
    set_sampler(gl, program, "u_mask", gles_key_unit_mask(key));
    set_sampler(gl, program, "u_sum_high", sum);
    set_sampler(gl, program, "u_sum_low", sum < 0 ? sum : sum + 1);
}

/* ---- the vertex stage ---------------------------------------------------------------------------- */

typedef int64_t matrix3[3][3]; /* [row][column] */

/* Shift all entries alike so that the largest has its top bit at 29. */
static void level(matrix3 m)
{
    uint64_t all = 0;
    int i, shift;

    for (i = 0; i < 9; i++) all |= (uint64_t)(m[i / 3][i % 3] < 0 ? -m[i / 3][i % 3] : m[i / 3][i % 3]);
    if (!all) return;
    shift = fx_top_bit(all) - 29;
    for (i = 0; i < 9; i++) {
        int64_t *const x = &m[i / 3][i % 3];

        *x = shift > 0 ? fx_shift(*x, shift) : *x * ((int64_t)1 << -shift);
    }
}

/* The cofactors: the inverse transpose times the determinant. Returns the determinant's sign. */
static int cofactors(matrix3 m, matrix3 out)
{
    int64_t determinant = 0;
    int i, j;

    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            const int r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;

            out[i][j] = m[r][c] * m[s][d] - m[r][d] * m[s][c];
        }
    level(out);
    for (i = 0; i < 3; i++) determinant += fx_shift(m[0][i] * out[0][i], 2);
    return determinant < 0 ? -1 : 1;
}

static void set_turned(const gles_procs *gl, gl_int at, const int32_t turn_q28[][3], matrix3 m, int sign)
{
    gl_float out[9]; /* column-major */
    int i, j;

    if (at < 0) return;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            const int32_t *const t = turn_q28[i];

            out[3 * j + i] = real(sign * (t[0] * m[0][j] + t[1] * m[1][j] + t[2] * m[2][j]), -58);
        }
    gl->UniformMatrix3fv(at, 1, 0, out);
}

static void set_matrices(const gles_procs *gl, const gles_uniforms *at, const nacre_view *view,
                         const gles_vertex_map *vertices, const int32_t turn_q28[][3], int position_shift)
{
    const nacre_q16 *const a = view->view_to_clip.m, *const b = view->object_to_view.m;
    gl_float clip[16], object[16], extent[4], centre[4], uv[4];
    matrix3 linear, normal;
    int i, j, sign;

    for (i = 0; i < 16; i++) {
        int64_t sum = 0; /* q30: four products of q16 fit */

        for (j = 0; j < 4; j++) sum += fx_shift((int64_t)a[4 * j + i % 4] * b[i / 4 * 4 + j], 2);
        clip[i] = real(sum, -30);
        object[i] = real(b[i], position_shift - 16);
    }
    gl->UniformMatrix4fv(at->clip, 1, 0, clip);
    if (at->view >= 0) gl->UniformMatrix4fv(at->view, 1, 0, object);

    for (i = 0; i < 9; i++) linear[i / 3][i % 3] = b[i % 3 * 4 + i / 3];
    level(linear);
    sign = cofactors(linear, normal);
    set_turned(gl, at->normal, turn_q28, normal, sign);
    set_turned(gl, at->tangent, turn_q28, linear, 1);

    for (i = 0; i < 3; i++) {
        extent[i] = from_q16(vertices->half_extent[i]);
        centre[i] = from_q16(vertices->centre[i]);
    }
    extent[3] = (gl_float)sign;
    centre[3] = 0.0f;
    gl->Uniform4fv(at->extent, 1, extent);
    gl->Uniform4fv(at->centre, 1, centre);
    uv[0] = vertices->uv_q11 ? 1.0f / 2048.0f : 1.0f;
    uv[1] = -uv[0];
    uv[2] = 0.0f;
    uv[3] = 1.0f;
    if (at->uv >= 0) gl->Uniform4fv(at->uv, 1, uv);
}

/* ---- the fragment stage -------------------------------------------------------------------------- */

static void set(const gles_procs *gl, gl_int at, const vectors *value, unsigned count)
{
    if (at >= 0) gl->Uniform4fv(at, (gl_sizei)count, value->v[0]);
}

/* Light index of the frame, or one without power beyond its end. */
static const shade_light *light_of(const shade_frame *frame, unsigned index)
{
    return &frame->light[index < NACRE_MAX_LIGHTS ? index : NACRE_MAX_LIGHTS - 1];
}

/* Factors of the lights; the fourth parts (row, weight, ...) are filled in by the models. */
static void put_factors(vectors *out, const gles_key *key, const shade_frame *frame, unsigned first, gl_float scale)
{
    unsigned i, j;

    for (i = 0; i < key->lights; i++)
        for (j = 0; j < 3; j++)
            out->v[i][j] =
                first + i < NACRE_MAX_LIGHTS ? from_real(light_of(frame, first + i)->factor[j]) * scale : 0.0f;
}

static void put_q16(gl_float *out, const nacre_q16 x[3])
{
    int i;

    for (i = 0; i < 3; i++) out[i] = from_q16(x[i]);
}

/* Coefficients of the phi_d terms from out[0] on: W, or K1 and K2; fine: D, W and K2, V and K4. across: what the shader's
   slope has to be multiplied by to be n.l - n.v. Returns how many vectors. */
static int put_phi(gl_float (*out)[4], const shade_table_draw *draw, const gles_key *key, gl_float across)
{
    const gl_float square = across * across;
    const int fine = key->model == GLES_KEY_FINE;
    gl_float *const w = out[fine ? 1 : 0];
    int i;

    put_q16(w, draw->phi_q16);
    for (i = 0; i < 3; i++) w[i] *= key->model == GLES_KEY_EARLY && i ? across : square;
    if (!fine) return key->phid;
    put_q16(out[0], draw->d_q16);
    w[3] = from_q16(draw->k2_q16) * across;
    put_q16(out[2], draw->v_q16);
    for (i = 0; i < 3; i++) out[2][i] *= square;
    out[2][3] = from_q16(draw->k4_q16) * square * square;
    return 3;
}

static void set_table_persp(const gles_procs *gl, const gles_uniforms *at, const gles_key *key,
                            const shade_frame *frame)
{
    const shade_table_draw *const draw = &frame->is.table;
    vectors model = {{{0}}};
    int count;

    model.v[0][0] = from_real(draw->scale);
    model.v[0][1] = from_real(draw->bias);
    model.v[0][2] = from_real(draw->two_eps);
    put_q28(model.v[1], draw->row_q28, 3);
    count = put_phi(model.v + 2, draw, key, 1.0f);
    set(gl, at->model, &model, (unsigned)(2 + count));
}

/* The only light, in its own frame (shade.h). The shader has n.x = (n.l - n.v) / (l.x - v.x); returns l.x - v.x. */
static gl_float put_own_frame(gl_float *half, gl_float *light, const shade_light *of)
{
    const shade_table_setup *const s = &of->is.table;
    const gl_float lift = (gl_float)(1 << of->lift);

    half[0] = from_q28(s->cos_q28); /* the most that |n.x| can be where lit and seen */
    half[1] = light[1] = 0.0f;
    half[2] = 1.0f;
    light[0] = from_q28(s->sin_q28) * lift;
    light[2] = from_q28(s->cos_q28) * lift;
    return 2.0f * from_q28(s->sin_q28);
}

static void set_table_dist(const gles_procs *gl, const gles_uniforms *at, const gles_key *key, const shade_frame *frame,
                           unsigned first, vectors *factor)
{
    const shade_table_draw *const draw = &frame->is.table;
    vectors half = {{{0}}}, light = half, model = half;
    gl_float across = 1.0f;
    unsigned i;
    int count;

    for (i = 0; i < key->lights; i++) {
        const shade_table_setup *const s = &light_of(frame, first + i)->is.table;

        put_q28(half.v[i], s->half_q28, 3);
        half.v[i][3] = from_real(draw->root_two_eps);
        put_q28(light.v[i], s->to_light_q28, 3);
        light.v[i][3] = from_real(draw->scale);
        factor->v[i][3] = from_q28(s->row_q28);
    }
    if (key->lights == 1) across = put_own_frame(half.v[0], light.v[0], light_of(frame, first));
    count = put_phi(model.v, draw, key, across);
    model.v[0][3] = from_real(draw->bias);
    set(gl, at->half, &half, key->lights);
    set(gl, at->light, &light, key->lights);
    set(gl, at->model, &model, count > 1 ? (unsigned)count : 1);
}

static void set_spheres_persp(const gles_procs *gl, const gles_uniforms *at, const gles_key *key,
                              const shade_frame *frame, vectors *factor)
{
    const shade_spheres_draw *const draw = &frame->is.spheres;
    const int paper = key->model == GLES_KEY_PAPER;
    vectors model = {{{0}}};
    unsigned i;

    for (i = 0; i < key->layers; i++) {
        const unsigned group = i / 4 * 5;

        model.v[group][i % 4] = from_q28(paper ? draw->polar_q28[i] : draw->cos_q28[i]);
        model.v[group + 1][i % 4] = from_q28(draw->sin_q28[i]);
        model.v[group + 2][i % 4] = from_q28(draw->rim_q28[i]);
        model.v[group + 3][i % 4] = from_real(draw->ramp[i][0]);
        model.v[group + 4][i % 4] = from_real(draw->ramp[i][1]);
    }
    if (paper) model.v[1][0] = from_q28(draw->polar_q28[draw->count - 1]);
    for (i = 0; i < key->lights; i++) factor->v[i][3] = from_q28(draw->half_disc_q28);
    set(gl, at->model, &model, key->layers > 4 ? 10 : 5);
}

static void set_spheres_dist(const gles_procs *gl, const gles_uniforms *at, const gles_key *key,
                             const shade_frame *frame, unsigned first, vectors *factor)
{
    vectors x1 = {{{0}}}, x2 = x1, y = x1, rim = x1, light = x1;
    unsigned i;

    for (i = 0; i < key->lights; i++) {
        const shade_spheres_setup *const s = &light_of(frame, first + i)->is.spheres;

        put_q28(x1.v[i], s->x_q28[0], 3);
        put_q28(x2.v[i], s->x_q28[1], 3);
        put_q28(y.v[i], s->y_q28, 3);
        put_q28(rim.v[i], s->rim_q28, 3);
        put_q28(light.v[i], s->to_light_q28, 3);
        factor->v[i][3] = from_q28(s->weight_q28);
    }
    set(gl, at->x1, &x1, key->lights);
    set(gl, at->x2, &x2, key->lights);
    set(gl, at->y, &y, key->lights);
    set(gl, at->rim, &rim, key->lights);
    set(gl, at->light, &light, key->lights);
}

/* The only light, in its own frame: where u and v are in either image. */
static void set_quarter_alone(const gles_procs *gl, const gles_uniforms *at, const shade_quarter_setup *s,
                              const shade_quarter_draw *draw)
{
    vectors scale = {{{0}}}, place = scale;
    unsigned i;

    for (i = 0; i < 4; i++) {
        scale.v[0][i] = from_q28(draw->scale_q28[i & 1]);
        place.v[0][i] = from_q28(draw->bias_q28[i & 1]);
        if (i & 1) place.v[0][i] += from_q28(draw->step_q28) * (gl_float)(s->layer + (i >> 1));
    }
    set(gl, at->scale, &scale, 1);
    set(gl, at->place, &place, 1);
}

/* root: fourth root of what all factors are scaled by. */
static void set_quarter_dist(const gles_procs *gl, const gles_uniforms *at, const gles_key *key,
                             const shade_frame *frame, unsigned first, gl_float root)
{
    const shade_quarter_draw *const draw = &frame->is.quarter;
    const int alone = key->lights == 1;
    vectors x = {{{0}}}, y = x, light = x, near = x, far = x;
    unsigned i, j;

    for (i = 0; i < key->lights; i++) {
        const shade_light *const of = light_of(frame, first + i);
        const shade_quarter_setup *const s = &of->is.quarter;
        const gl_float weight = from_q28(s->weight_q28);

        for (j = 0; j < 3 && first + i < NACRE_MAX_LIGHTS; j++) {
            near.v[i][j] = from_real(s->root4[j]) * root * (1.0f - weight);
            far.v[i][j] = from_real(s->root4[j]) * root * weight;
        }
        put_q28(x.v[i], s->x_q28, 3);
        put_q28(y.v[i], s->y_q28, 3);
        put_q28(light.v[i], s->to_light_q28, 3);
        x.v[i][3] = from_q28(draw->bias_q28[0]);
        y.v[i][3] = from_q28(draw->bias_q28[1]) + from_q28(draw->step_q28) * (gl_float)s->layer;
    }
    light.v[0][3] = from_q28(draw->scale_q28[0]);
    near.v[0][3] = from_q28(alone ? light_of(frame, first)->is.quarter.sin_q28 : draw->scale_q28[1]);
    far.v[0][3] = from_q28(alone ? light_of(frame, first)->is.quarter.cos_q28 : draw->step_q28);
    set(gl, at->near, &near, key->lights);
    set(gl, at->far, &far, key->lights);
    if (alone) {
        set_quarter_alone(gl, at, &light_of(frame, first)->is.quarter, draw);
        return;
    }
    set(gl, at->x, &x, key->lights);
    set(gl, at->y, &y, key->lights);
    set(gl, at->light, &light, key->lights);
}

static void set_quarter_persp(const gles_procs *gl, const gles_uniforms *at, const gles_key *key,
                              const shade_frame *frame)
{
    const shade_quarter_draw *const draw = &frame->is.quarter;
    vectors model = {{{0}}};
    unsigned i;

    put_q28(model.v[0], draw->scale_q28, 2);
    put_q28(model.v[0] + 2, draw->bias_q28, 2);
    model.v[1][0] = from_q28(draw->step_q28);
    for (i = 0; i < 4u * key->layers; i++) {
        model.v[2 + i / 4 * 2][i % 4] = from_real(draw->ramp[i][0]);
        model.v[3 + i / 4 * 2][i % 4] = from_real(draw->ramp[i][1]);
    }
    set(gl, at->model, &model, 2 + 2u * key->layers);
}

static void set_paper_dist(const gles_procs *gl, const gles_uniforms *at, const gles_key *key, const shade_frame *frame,
                           unsigned first, vectors *factor)
{
    vectors azimuth = {{{0}}}, turn[3] = {{{{0}}}}, bound = azimuth;
    unsigned i;
    int j;

    for (i = 0; i < key->lights; i++) {
        const shade_light *const light = light_of(frame, first + i);
        const shade_spheres_setup *const s = &light->is.spheres;

        put_q28(azimuth.v[i], s->azimuth_q28, 2);
        put_q28(azimuth.v[i] + 2, s->half_q28, 2);
        for (j = 0; j < 3; j++) put_q28(turn[j].v[i], s->turn_q28[j], 4);
        put_real(bound.v[i], light->linear, 3);
        bound.v[i][3] = from_q28(frame->is.spheres.half_disc_q28);
        factor->v[i][3] = from_q28(s->weight_q28);
    }
    set(gl, at->azimuth, &azimuth, key->lights);
    set(gl, at->turn0, &turn[0], key->lights);
    set(gl, at->turn1, &turn[1], key->lights);
    set(gl, at->turn2, &turn[2], key->lights);
    set(gl, at->bound, &bound, key->lights);
}

static void set_positions(const gles_procs *gl, const gles_uniforms *at, const gles_key *key, const shade_frame *frame,
                          unsigned first)
{
    vectors light = {{{0}}}, eye = light;
    unsigned i;

    for (i = 0; i < key->lights; i++) put_real(light.v[i], light_of(frame, first + i)->position, 4);
    put_real(eye.v[0], frame->eye, 4);
    set(gl, at->light, &light, key->lights);
    set(gl, at->eye, &eye, 1);
}

/* Where the palette's tiles are, and the texels of the index map. */
static void set_tiles(const gles_procs *gl, const gles_uniforms *at, const shade_palette *palette,
                      const int32_t corner_q28[2])
{
    vectors tiles = {{{0}}};

    tiles.v[0][0] = 1.0f / palette->columns;
    tiles.v[0][1] = 1.0f / palette->rows;
    put_q28(tiles.v[0] + 2, corner_q28, 2);
    tiles.v[1][0] = palette->width;
    tiles.v[1][1] = palette->height;
    tiles.v[1][2] = 1.0f / palette->width;
    tiles.v[1][3] = 1.0f / palette->height;
    set(gl, at->tiles, &tiles, 1u + palette->blend);
}

/* Where normals are turned to: the only light's own frame, for the models that have one. */
static const int32_t (*vertex_turn(const gles_key *key, const shade_frame *frame, unsigned first))[3]
{
    const shade_light *const light = light_of(frame, first);

    if (key->persp || key->lights != 1) return frame->turn_q28;
    if (gles_key_is_table(key)) return light->is.table.own_turn_q28;
    return key->model == GLES_KEY_QUARTER ? light->is.quarter.own_turn_q28 : frame->turn_q28;
}

static void set_sbrdf(const gles_procs *gl, const gles_uniforms *at, const gles_key *key, const shade_frame *frame,
                      unsigned first, unsigned first_lobe)
{
    const shade_sbrdf_draw *const draw = &frame->is.sbrdf;
    vectors light = {{{0}}}, model = light;
    unsigned i;

    for (i = 0; i < key->lobes; i++) {
        const unsigned j = first_lobe + i;

        model.v[i][0] = from_real(key->power ? draw->column_scale[j] : draw->log2_scale[j]);
        model.v[i][1] =
            key->power ? from_real(fx_real_exp2(draw->log2_weight_q16[j])) : from_q16(draw->log2_weight_q16[j]);
    }
    set(gl, at->model, &model, key->lobes);
    if (key->persp) return;
    for (i = 0; i < key->lights; i++) put_q28(light.v[i], light_of(frame, first + i)->is.sbrdf.to_light_q28, 3);
    set(gl, at->light, &light, key->lights);
}

void gles_uniforms_set(const gles_procs *gl, const gles_uniforms *at, const gles_key *key, const nacre_view *view,
                       const gles_vertex_map *vertices, const shade_frame *frame, unsigned first_light,
                       unsigned first_lobe)
{
    /* sums of passes for linear output are held x 1/16 */
    const gl_float scale = key->pass && view->output == NACRE_OUTPUT_LINEAR ? 1.0f / 16.0f : 1.0f;
    const int table = gles_key_is_table(key);
    const int sbrdf = key->model == GLES_KEY_SBRDF;
    vectors factor = {{{0}}}, ambient = {{{0}}};
    const int quarter = key->model == GLES_KEY_QUARTER;
    int i;

    set_matrices(gl, at, view, vertices, vertex_turn(key, frame, first_light), frame->position_shift);
    if (key->model == GLES_KEY_LIT) return;
    for (i = 0; i < 3; i++) ambient.v[0][i] = from_real(frame->ambient[i]) * scale;
    for (i = 0; i < 3 && sbrdf; i++) ambient.v[1][i] = from_real(frame->is.sbrdf.ambient[i]) * scale;
    set(gl, at->ambient, &ambient, sbrdf ? 2 : 1);
    if (key->model == GLES_KEY_PALETTE) set_tiles(gl, at, &frame->palette, frame->is.table.tile_q28);
    if (!key->lights) return;
    put_factors(&factor, key, frame, first_light, scale);
    if (key->persp) set_positions(gl, at, key, frame, first_light);
    if (sbrdf)
        set_sbrdf(gl, at, key, frame, first_light, first_lobe);
    else if (table && key->persp)
        set_table_persp(gl, at, key, frame);
    else if (table)
        set_table_dist(gl, at, key, frame, first_light, &factor);
    else if (quarter && key->persp)
        set_quarter_persp(gl, at, key, frame);
    else if (quarter)
        set_quarter_dist(gl, at, key, frame, first_light, scale < 1.0f ? 0.5f : 1.0f);
    else if (key->persp)
        set_spheres_persp(gl, at, key, frame, &factor);
    else if (key->model == GLES_KEY_PAPER)
        set_paper_dist(gl, at, key, frame, first_light, &factor);
    else
        set_spheres_dist(gl, at, key, frame, first_light, &factor);
    set(gl, at->factor, &factor, key->lights);
}

void gles_uniforms_set_byte(const gles_procs *gl, const gles_uniforms *at, unsigned byte)
{
    vectors value = {{{0}}};

    value.v[0][byte] = 1.0f;
    set(gl, at->byte, &value, 1);
}
