/* SPDX-License-Identifier: MIT */
#include "shade.h"

#define LOG2_1055_Q16 5062         /* log2(1.055) */
#define LH_LEAST_Q28  5905580      /* .022: keeps 1 / l.h of lights behind the object finite */
#define LV_LEAST_Q28  -268167021   /* -.999: beyond it the half vector is undefined */
#define LIMIT_LINEAR  (11 * 65536) /* log2 of 2,048: eight lights stay below 16,384 */
#define LIMIT_ROOT    (7 * 65536)

/* ---- vectors and matrices ------------------------------------------------------------------------ */

static int is_perspective(const nacre_view *view)
{
    const nacre_q16 *m = view->view_to_clip.m;

    return m[3] || m[7] || m[11] || m[15] != NACRE_Q16_ONE;
}

int shade_needs_persp(const nacre_view *view)
{
    int i;

    for (i = 0; i < view->light_count; i++)
        if (view->lights[i].type == NACRE_LIGHT_POINT) return 1;
    return view->light_count && is_perspective(view) && !view->distant_viewer;
}

/* object_to_view x point, q16. */
static void to_view(const nacre_mat4 *m, const nacre_q16 point[3], int64_t out[3])
{
    int i;

    for (i = 0; i < 3; i++)
        out[i] = m->m[12 + i] + fx_shift((int64_t)m->m[i] * point[0] / 4 + (int64_t)m->m[4 + i] * point[1] / 4 +
                                             (int64_t)m->m[8 + i] * point[2] / 4,
                                         14);
}

/* Length of a q16 vector, |v| < 2^40. */
static fx_real length(const int64_t v[3])
{
    uint64_t largest = 0, sum = 0;
    int shift, i;

    for (i = 0; i < 3; i++) largest |= (uint64_t)(v[i] < 0 ? -v[i] : v[i]);
    if (!largest) return fx_real_make(0, 0);
    shift = fx_top_bit(largest) - 29;
    for (i = 0; i < 3; i++) {
        const int64_t x = shift > 0 ? fx_shift(v[i], shift) : v[i] * ((int64_t)1 << -shift);
        sum += (uint64_t)(x * x);
    }
    return fx_real_make(fx_isqrt(sum), shift - 16);
}

void shade_turn_to_z(const int32_t v[3], int32_t row[][3])
{
    const int64_t a = v[0], b = v[1], c = v[2], d = FX_Q28_ONE + c;
    int i;

    for (i = 0; i < 3; i++) row[2][i] = v[i];
    if (d < FX_Q28_ONE / 1024) { /* behind the eye: never drawn, but finite */
        const int32_t flip[3][3] = {{FX_Q28_ONE, 0, 0}, {0, -FX_Q28_ONE, 0}, {0, 0, -FX_Q28_ONE}};

        for (i = 0; i < 9; i++) row[i / 3][i % 3] = flip[i / 3][i % 3];
        return;
    }
    row[0][0] = (int32_t)(FX_Q28_ONE - fx_div(a * a, d));
    row[0][1] = row[1][0] = (int32_t)-fx_div(a * b, d);
    row[1][1] = (int32_t)(FX_Q28_ONE - fx_div(b * b, d));
    row[0][2] = (int32_t)-a;
    row[1][2] = (int32_t)-b;
}

/* ---- how much light ------------------------------------------------------------------------------ */

static const nacre_q16 *part(const nacre_rgb *rgb, int channel)
{
    return channel == 0 ? &rgb->r : channel == 1 ? &rgb->g : &rgb->b;
}

/* log2 of tint x exposure; 0 when either is not positive. */
static int view_log2(const nacre_view *view, int channel, int64_t *out)
{
    const nacre_q16 exposure = view->exposure ? view->exposure : NACRE_Q16_ONE;
    const int plain = !(view->tint.r | view->tint.g | view->tint.b);
    const nacre_q16 tint = plain ? NACRE_Q16_ONE : *part(&view->tint, channel);

    *out = (int64_t)fx_log2_q16(exposure) + fx_log2_q16(tint);
    return exposure > 0 && tint > 0;
}

static int light_log2(const nacre_light *light, int channel, int64_t *out)
{
    const nacre_q16 power = *part(&light->power, channel);
    const int32_t open = light->shadow <= 0 ? NACRE_Q14_ONE : NACRE_Q14_ONE - light->shadow;

    *out = (int64_t)fx_log2_q16(power) + fx_log2_q16(open > 0 ? 4 * open : 0);
    return power > 0 && open > 0;
}

/* 2^log2 as the program wants it, kept inside what fp16 can multiply with. */
static fx_real shaped(int64_t log2_q16, shade_form form, const shade_material *material)
{
    if (!SHADE_HAS_GLES || form == SHADE_LINEAR) return fx_real_exp2(log2_q16 < LIMIT_LINEAR ? log2_q16 : LIMIT_LINEAR);
    if (form == SHADE_ROOT) {
        log2_q16 = fx_shift(log2_q16, 1);
    } else {
        log2_q16 = fx_div(log2_q16 * 5, 12);
        if (material->model == NACRE_MODEL_TABLE) log2_q16 += LOG2_1055_Q16;
    }
    return fx_real_exp2(log2_q16 < LIMIT_ROOT ? log2_q16 : LIMIT_ROOT);
}

static int32_t model_log2(const shade_material *material, int channel)
{
    if (shade_is_table(material)) return shade_table_log2(&material->is.table);
    if (shade_is_sbrdf(material)) return shade_sbrdf_log2(&material->is.sbrdf);
    return SHADE_HAS_SPHERES ? shade_spheres_log2(&material->is.spheres, channel) : 0;
}

/* ---- one light ----------------------------------------------------------------------------------- */

/* 1: directions per pixel. */
static int is_near(const shade_frame *frame)
{
    return SHADE_HAS_NEAR && frame->persp;
}

static int is_point(const nacre_light *light)
{
    return SHADE_HAS_NEAR && light->type == NACRE_LIGHT_POINT;
}

typedef struct placed_light { /* a light as seen from the centre of the mesh */
    int32_t direction_q28[3]; /* view space */
    int valid;
    fx_real distance; /* point lights; 1 for others */
} placed_light;

static placed_light place(const nacre_light *light, const int64_t centre[3])
{
    placed_light out = {{0, 0, FX_Q28_ONE}, 0, {0, 0}};
    int64_t v[3];
    int i;

    out.distance = fx_real_make(1, 0);
    if (!is_point(light)) {
        v[0] = light->direction.x;
        v[1] = light->direction.y;
        v[2] = light->direction.z;
        out.valid = fx_normalize_q28(v, out.direction_q28);
        return out;
    }
    for (i = 0; i < 3; i++) v[i] = light->position[i] - centre[i];
    if (fx_normalize_q28(v, out.direction_q28)) out.distance = length(v);
    out.valid = 1;
    return out;
}

/* Whose values hold f_r l.h. */
static int over_l_dot_h(const shade_material *material)
{
    return shade_is_table(material) || shade_is_quarter(material);
}

static int lifted(const shade_material *material, shade_form form)
{
    return SHADE_HAS_GLES && material->model == NACRE_MODEL_TABLE && form == SHADE_SRGB;
}

/* r = xyz - w P, with w P = view position / distance. */
static void set_position(shade_light *out, const nacre_light *light, const placed_light *place, int position_shift)
{
    const fx_real inverse = fx_real_exp2(-(int64_t)fx_real_log2_q16(place->distance));
    int i;

    for (i = 0; i < 3; i++)
        out->position[i] = is_point(light) ? fx_real_mul(fx_real_make(light->position[i], -16), inverse)
                                           : fx_real_make(place->direction_q28[i], -28);
    out->position[3] = fx_real_make(0, 0);
    if (is_point(light)) {
        out->position[3] = inverse;
        out->position[3].e -= position_shift;
    }
}

static int64_t largest3(const nacre_q16 v[3])
{
    int64_t most = 0;
    int i;

    for (i = 0; i < 3; i++) {
        const int64_t size = v[i] < 0 ? -(int64_t)v[i] : v[i];

        if (size > most) most = size;
    }
    return most;
}

/* log2 of how much a table's value can exceed 1 on the unlit side, where nothing was fitted and the phi_d terms run free:
   |y| <= 1 + D + a^2 (W + V) / 2 + a^2 K1 / 2 + |a| K2 / 2 + a^4 K4 / 2, where the shader keeps |a| <= 2 sin cos. */
static int64_t unlit_log2(const shade_material *material, const shade_table_setup *setup)
{
    const shade_table *const table = &material->is.table;
    const int64_t half = fx_shift((int64_t)setup->sin_q28 * setup->cos_q28, 40), square = half * half >> 16;
    const int64_t phi = 2 * square * (largest3(table->w) + largest3(table->v) + table->k1) + half * table->k2 +
                        8 * (square * square >> 16) * table->k4;

    return fx_log2_u64((uint64_t)(65536 + largest3(table->d) + phi / 65536)) - 16 * 65536;
}

/* The floor of 2^-14 under n.l is to light the unlit side by at most 2^-10: 1 code of 255. */
static int least_lift(const int64_t log2_q16[3], const shade_material *material, const shade_table_setup *setup)
{
    int64_t most = log2_q16[0];
    int i;

    for (i = 1; i < 3; i++) most = log2_q16[i] > most ? log2_q16[i] : most;
    most += fx_shift(unlit_log2(material, setup) * material->is.table.p, 16);
    most = (most + 65535) / 65536 - 4;
    return most < 0 ? 0 : most > SHADE_LIFT_MOST ? SHADE_LIFT_MOST : (int)most;
}

static void set_factors(shade_light *out, const nacre_view *view, const nacre_light *light, const placed_light *place,
                        int64_t more_log2, int persp, const shade_material *material, shade_form form)
{
    const int64_t fall = -2 * (int64_t)fx_real_log2_q16(place->distance);
    int64_t sum[3] = {0, 0, 0};
    int i, lit[3], lift = 0;

    for (i = 0; i < 3; i++) {
        int64_t seen, sent;

        lit[i] = view_log2(view, i, &seen) && light_log2(light, i, &sent);
        if (lit[i]) sum[i] = seen + sent + fall + more_log2 + model_log2(material, i);
    }
    if (lifted(material, form)) lift = persp ? SHADE_LIFT_PERSP : least_lift(sum, material, &out->is.table);
    if (!persp) out->lift = lift;
    for (i = 0; i < 3; i++) {
        if (!lit[i]) continue;
        out->linear[i] = shaped(sum[i], SHADE_LINEAR, material);
        if (SHADE_HAS_GLES) out->factor[i] = shaped(sum[i] - lift * 65536, form, material);
        if (shade_is_quarter(material) && !persp)
            out->is.quarter.root4[i] = fx_real_exp2(fx_shift(sum[i] < 2 * LIMIT_ROOT ? sum[i] : 2 * LIMIT_ROOT, 2));
    }
}

/* Where |r| is 1: the centre of the mesh, or for a light so near to it that the factor there would be beyond its limit,
   as far away as keeps it. */
static void keep_distance(placed_light *place, const nacre_view *view, const nacre_light *light, int64_t more_log2,
                          const shade_material *material)
{
    const int64_t fall = -2 * (int64_t)fx_real_log2_q16(place->distance);
    int64_t excess = 0;
    int i;

    for (i = 0; i < 3; i++) {
        int64_t seen, sent;

        if (!view_log2(view, i, &seen) || !light_log2(light, i, &sent)) continue;
        seen += sent + fall + more_log2 + model_log2(material, i) - LIMIT_LINEAR;
        if (seen > excess) excess = seen;
    }
    place->distance.e += (int)((excess + 2 * 65536 - 1) / (2 * 65536));
}

static void incoming(shade_incoming *out, const int32_t direction[3], int32_t turn[3][3])
{
    int i;

    for (i = 0; i < 3; i++) out->to_light_q28[i] = fx_dot_q28(turn[i], direction);
    if (out->to_light_q28[2] > FX_Q28_ONE) out->to_light_q28[2] = FX_Q28_ONE;
    if (out->to_light_q28[2] < -FX_Q28_ONE) out->to_light_q28[2] = -FX_Q28_ONE;
    out->lost = out->to_light_q28[2] < LV_LEAST_Q28;
    /* (l.h)^2 = (1 + l.v) / 2 */
    out->l_dot_h_q28 = (int32_t)fx_isqrt((uint64_t)((int64_t)FX_Q28_ONE + out->to_light_q28[2]) << 27);
    if (out->l_dot_h_q28 < LH_LEAST_Q28) out->l_dot_h_q28 = LH_LEAST_Q28;
}

/* turn x first, in place. */
static void turn_after(int32_t (*turn)[3], int32_t (*first)[3])
{
    int i, j, k;

    for (i = 0; i < 3; i++) {
        const int32_t row[3] = {turn[i][0], turn[i][1], turn[i][2]};

        for (j = 0; j < 3; j++) {
            int64_t sum = 0;

            for (k = 0; k < 3; k++) sum += (int64_t)row[k] * first[k][j];
            turn[i][j] = (int32_t)fx_shift(sum, 28);
        }
    }
}

static void set_light(shade_frame *frame, int index, const nacre_view *view, const int64_t centre[3],
                      const shade_material *material, shade_form form)
{
    static const nacre_light none; /* no power, no direction */
    const int given = index < view->light_count;
    const nacre_light *light = given ? &view->lights[index] : &none;
    placed_light place_of = place(light, centre);
    shade_light *out = &frame->light[index];
    shade_incoming in;
    int64_t more = 0;
    int i;

    for (i = 0; i < 3; i++) out->factor[i] = out->linear[i] = fx_real_make(0, 0);
    out->lift = 0;
    if (given && is_near(frame) && is_point(light))
        keep_distance(&place_of, view, light, over_l_dot_h(material) ? 65536 : 0, material);
    if (SHADE_HAS_GLES || SHADE_HAS_NEAR) set_position(out, light, &place_of, frame->position_shift);
    if (is_near(frame) && lifted(material, form)) /* 1 / |r|^2 is the shader's fall-off: it lifts n.l along with it */
        for (i = 0; i < 4; i++) out->position[i].e -= SHADE_LIFT_PERSP / 2;
    incoming(&in, place_of.direction_q28, frame->turn_q28);
    if (shade_is_table(material)) {
        shade_table_light(&out->is.table, &in, &material->is.table);
        if (SHADE_HAS_GLES) turn_after(out->is.table.own_turn_q28, frame->turn_q28);
    } else if (shade_is_quarter(material)) {
        shade_quarter_light(&out->is.quarter, &in, &material->is.spheres);
        turn_after(out->is.quarter.own_turn_q28, frame->turn_q28);
    } else if (shade_is_sbrdf(material)) {
        shade_sbrdf_light(&out->is.sbrdf, &in);
        in.lost = 0; /* there is no half vector */
    } else if (SHADE_HAS_SPHERES) {
        shade_spheres_light(&out->is.spheres, &in, &material->is.spheres);
    }
    /* 1 / l.h; per pixel the shader multiplies by 1 / (2 l.h) */
    if (over_l_dot_h(material)) more = is_near(frame) ? 65536 : 28 * 65536 - fx_log2_u64((uint64_t)in.l_dot_h_q28);
    if (given && place_of.valid && (is_near(frame) || !in.lost))
        set_factors(out, view, light, &place_of, more, is_near(frame), material, form);
}

/* ---- the frame ----------------------------------------------------------------------------------- */

static fx_real ambient_of(const nacre_view *view, int channel, nacre_q16 albedo, const shade_material *material)
{
    const nacre_q16 ambient = *part(&view->ambient, channel);
    int64_t sum;

    if (!view_log2(view, channel, &sum) || ambient <= 0 || albedo <= 0) return fx_real_make(0, 0);
    return shaped(sum + fx_log2_q16(ambient) + fx_log2_q16(albedo) - SHADE_LOG2_PI_Q16, SHADE_LINEAR, material);
}

static void set_ambient(shade_frame *out, const nacre_view *view, const shade_material *material)
{
    int i;

    for (i = 0; i < 3; i++) {
        out->ambient[i] = ambient_of(view, i, material->albedo[i], material);
        if (shade_is_sbrdf(material))
            out->is.sbrdf.ambient[i] = ambient_of(view, i, material->is.sbrdf.albedo_most, material);
    }
}

/* Direction to the eye from the centre, and positions scaled so that the centre is 1 to 2 away from the eye. */
static void set_camera(shade_frame *out, const nacre_view *view, const int64_t centre[3])
{
    const int64_t to_eye[3] = {-centre[0], -centre[1], -centre[2]};
    int32_t direction[3] = {0, 0, FX_Q28_ONE};
    int i;

    for (i = 0; i < 9; i++) out->turn_q28[i / 3][i % 3] = i % 4 ? 0 : FX_Q28_ONE;
    for (i = 0; i < 4; i++) out->eye[i] = fx_real_make(0, 0);
    out->position_shift = 0;
    if (fx_normalize_q28(to_eye, direction) && (SHADE_HAS_NEAR || SHADE_HAS_GLES))
        out->position_shift = -(fx_real_log2_q16(length(centre)) >> 16);
    if (!is_perspective(view)) {
        out->eye[2] = fx_real_make(1, 0);
        return;
    }
    if (!is_near(out)) shade_turn_to_z(direction, out->turn_q28);
    if (view->distant_viewer)
        for (i = 0; i < 3; i++) out->eye[i] = fx_real_make(direction[i], -28);
    else
        out->eye[3] = fx_real_make(1, 0);
}

void shade_eye(const nacre_view *view, const nacre_q16 centre[3], int32_t out_q28[3])
{
    int64_t to_eye[3];
    int i;

    out_q28[0] = out_q28[1] = 0;
    out_q28[2] = FX_Q28_ONE;
    if (!is_perspective(view)) return;
    to_view(&view->object_to_view, centre, to_eye);
    for (i = 0; i < 3; i++) to_eye[i] = -to_eye[i];
    fx_normalize_q28(to_eye, out_q28);
}

void shade_setup(shade_frame *out, const nacre_view *view, const nacre_q16 centre[3], const shade_material *material,
                 shade_form form, int persp, int units)
{
    int64_t centre_view[3];
    int i;

    to_view(&view->object_to_view, centre, centre_view);
    out->light_count = (uint8_t)(view->light_count < NACRE_MAX_LIGHTS ? view->light_count : NACRE_MAX_LIGHTS);
    out->persp = persp != 0;
    set_camera(out, view, centre_view);
    set_ambient(out, view, material);
    out->palette = material->palette;
    if (!SHADE_HAS_GLES)
        ; /* only shaders need more */
    else if (shade_is_table(material))
        shade_table_prepare(&out->is.table, &material->is.table, material->early);
    else if (shade_is_quarter(material))
        shade_quarter_prepare(&out->is.quarter, &material->is.spheres);
    else if (shade_is_sbrdf(material))
        shade_sbrdf_prepare(&out->is.sbrdf, &material->is.sbrdf);
    else if (SHADE_HAS_SPHERES)
        shade_spheres_prepare(&out->is.spheres, &material->is.spheres, units);
    for (i = 0; i < NACRE_MAX_LIGHTS; i++) set_light(out, i, view, centre_view, material, form);
}
