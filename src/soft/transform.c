/* SPDX-License-Identifier: MIT */
/* Vertices onto the screen: position, depth, normal. */
#include "soft.h"

#define GUARD       4 /* times the frame: vertices beyond it are clipped, coordinates stay below 2^18 */
#define LEAST_RANGE 4096

enum { FEW = 16 };

/* ---- the camera of an item ------------------------------------------------------------------------------------------ */

static uint64_t size_of(int64_t x)
{
    return x < 0 ? 0 - (uint64_t)x : (uint64_t)x;
}

static int64_t scaled(int64_t x, int shift)
{
    return shift > 0 ? fx_shift(x, shift) : x * ((int64_t)1 << -shift);
}

/* Shift the entries alike so that the largest is below 2^(bits). */
static void level(int64_t *m, int count, int bits)
{
    uint64_t all = 0;
    int i, shift;

    for (i = 0; i < count; i++) all |= size_of(m[i]);
    if (!all) return;
    shift = fx_top_bit(all) + 1 - bits;
    for (i = 0; i < count; i++) m[i] = scaled(m[i], shift);
}

static void set_rows(soft_camera *out, const nacre_view *view, const nacre_mat4 *object, const nacre_mesh *mesh)
{
    const nacre_q16 *const a = view->view_to_clip.m, *const b = object->m;
    int64_t m[16], row[16];
    uint64_t most = 0;
    int i, j, shift;

    for (i = 0; i < 16; i++) { /* m[4 row + column] */
        m[i] = 0;
        for (j = 0; j < 4; j++) m[i] += fx_shift((int64_t)a[4 * j + i / 4] * b[i % 4 * 4 + j], 2);
    }
    level(m, 16, 29);
    for (i = 0; i < 16; i += 4) {
        uint64_t sum;

        row[i + 3] = m[i + 3] * 65536;
        for (j = 0; j < 3; j++) {
            row[i + j] = m[i + j] * mesh->half_extent[j];
            row[i + j] += row[i + j] / 32768; /* 32767 is the extent */
            row[i + 3] += m[i + j] * mesh->centre[j];
        }
        sum = size_of(row[i]) + size_of(row[i + 1]) + size_of(row[i + 2]) + size_of(row[i + 3]);
        if (sum > most) most = sum;
    }
    shift = most ? fx_top_bit(most) - 29 : 0; /* sums stay below 2^30 */
    for (i = 0; i < 16; i++) out->row[i / 4][i % 4] = (int32_t)scaled(row[i], shift);
}

/* turn x m, its Frobenius norm at most 1 in q15. m: below 2^30. */
static void set_turned(int32_t out[3][3], int32_t turn[3][3], const int64_t m[9], int sign)
{
    int64_t turned[9];
    uint64_t sum = 0;
    int i, k;

    for (i = 0; i < 9; i++) {
        turned[i] = 0;
        for (k = 0; k < 3; k++) turned[i] += (int64_t)turn[i / 3][k] * m[3 * k + i % 3];
        turned[i] *= sign;
    }
    level(turned, 9, 15);
    for (i = 0; i < 9; i++) sum += (uint64_t)(turned[i] * turned[i]);
    sum = fx_isqrt(sum) + 1;
    for (i = 0; i < 9; i++) out[i / 3][i % 3] = (int32_t)fx_div(turned[i] * 32767, (int64_t)sum);
}

/* Normals by the inverse transpose of the object's matrix, tangents by itself, both turned to the eye. */
static void set_normals(soft_camera *out, const nacre_mat4 *object, int32_t turn[3][3])
{
    int64_t linear[9], cofactor[9], all = 0;
    int i, j;

    for (i = 0; i < 9; i++) linear[i] = object->m[i % 3 * 4 + i / 3];
    level(linear, 9, 29);
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            const int r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;

            cofactor[3 * i + j] = linear[3 * r + c] * linear[3 * s + d] - linear[3 * r + d] * linear[3 * s + c];
        }
    level(cofactor, 9, 29);
    for (i = 0; i < 3; i++) all += fx_shift(linear[i] * cofactor[i], 2);
    out->mirrored = all < 0;
    set_turned(out->normal, turn, cofactor, all < 0 ? -1 : 1);
    set_turned(out->tangent, turn, linear, 1);
}

static int64_t along(const int32_t r[3], const int16_t p[3], int64_t at)
{
    return (int64_t)r[0] * p[0] + (int64_t)r[1] * p[1] + (int64_t)r[2] * p[2] + at;
}

void soft_clip_position(const soft_camera *camera, const int16_t position[3], int32_t clip[4])
{
    int i;

    for (i = 0; i < 4; i++)
        clip[i] = (int32_t)(along(camera->row[i], position, (int64_t)camera->row[i][3] * 32768) >> 15);
}

/* What the corners of the mesh's box say: range of depth, least w, whether anything needs clipping. */
static void look_at_box(soft_camera *out, int64_t *low, int64_t *high)
{
    int i, k;

    out->inside = 1;
    out->nearest = INT32_MAX;
    for (i = 0; i < 8; i++) {
        const int16_t p[3] = {i & 1 ? 32767 : -32767, i & 2 ? 32767 : -32767, i & 4 ? 32767 : -32767};
        int32_t clip[4];
        int64_t z;

        soft_clip_position(out, p, clip);
        for (k = 0; k < 2; k++)
            if (clip[k] > GUARD * (int64_t)clip[3] || clip[k] < -GUARD * (int64_t)clip[3]) out->inside = 0;
        if (clip[3] <= 0 || clip[2] > clip[3] || clip[2] < -clip[3]) {
            out->inside = 0;
            *low = -((int64_t)1 << 30);
            *high = (int64_t)1 << 30;
        }
        if (clip[3] <= 0) continue;
        if (clip[3] < out->nearest) out->nearest = clip[3];
        z = fx_div(clip[2] * ((int64_t)1 << 30), clip[3]);
        if (z < *low) *low = z;
        if (z > *high) *high = z;
    }
}

void soft_camera_set(soft_camera *out, const nacre_soft_item *item, const nacre_view *view, int32_t turn[3][3],
                     int64_t *low, int64_t *high)
{
    set_rows(out, view, &item->object_to_view, item->mesh);
    set_normals(out, &item->object_to_view, turn);
    look_at_box(out, low, high);
    out->affine = out->inside && !(out->row[3][0] | out->row[3][1] | out->row[3][2]);
    out->half = item->lit && !(item->material && item->material->image[NACRE_ROLE_NORMAL]);
}

/* Viewport and depth into the rows of an affine camera, whose sums are within 4 w, and whose depths are in range. */
static void set_screen(const nacre_soft *soft, soft_camera *camera)
{
    const int32_t half[2] = {soft->desc.width * 8, soft->desc.height * -8}, w = camera->row[3][3];
    int64_t part[3][4];
    int i, k;

    for (i = 0; i < 12; i++) {
        const int64_t clip = camera->row[i / 4][i % 4];

        part[i / 4][i % 4] = i < 8 ? fx_div(clip * half[i / 4] * 8192, w) : fx_div(clip * FX_Q28_ONE * 4, w);
    }
    part[2][3] -= camera->depth_low;
    for (k = 0; k < 4; k++) part[2][k] = fx_shift(part[2][k] * camera->depth_scale, 24);
    for (i = 0; i < 3; i++) {
        for (k = 0; k < 3; k++) camera->screen[i][k] = (int32_t)part[i][k];
        camera->screen_at[i] = part[i][3] * 32768;
        if (i < 2) camera->screen_at[i] += (int64_t)(i ? -half[i] : half[i]) * FX_Q28_ONE + FX_Q28_ONE / 2;
    }
}

void soft_camera_depth(const nacre_soft *soft, soft_camera *out, int64_t low, int64_t high)
{
    if (low < -((int64_t)1 << 30)) low = -((int64_t)1 << 30);
    if (high > (int64_t)1 << 30) high = (int64_t)1 << 30;
    if (high < low + LEAST_RANGE) high = low + LEAST_RANGE;
    out->depth_low = low;
    out->depth_scale = fx_div((int64_t)SOFT_MOST_DEPTH << 24, high - low);
    out->depth_step = fx_div((high - low) * 65536, SOFT_MOST_DEPTH >> 15);
    if (out->affine) set_screen(soft, out);
}

/* ---- vertices -------------------------------------------------------------------------------------------------------- */

static int outside(const int32_t clip[4])
{
    const int64_t w = clip[3], side = GUARD * w;

    return clip[0] > side || clip[0] < -side || clip[1] > side || clip[1] < -side || clip[2] > w || clip[2] < -w ||
           w <= 0;
}

static int32_t held_depth(int64_t depth)
{
    return depth < 0 ? 0 : depth > SOFT_MOST_DEPTH ? SOFT_MOST_DEPTH : (int32_t)depth;
}

void soft_project(const nacre_soft *soft, const soft_camera *camera, const int32_t clip[4], soft_vertex *out)
{
    const int zeros = fx_leading_zeros((uint32_t)clip[3]);
    const int64_t inverse = fx_reciprocal((uint32_t)clip[3] << zeros);
    const int64_t x = clip[0] * inverse >> (34 - zeros), y = clip[1] * inverse >> (34 - zeros); /* q28 */
    const int64_t z = (clip[2] * inverse >> (32 - zeros)) - camera->depth_low;
    const int64_t near = camera->nearest * inverse >> (46 - zeros);

    out->x = (int32_t)((x * (soft->desc.width * 8) + (FX_Q28_ONE / 2)) >> 28) + soft->desc.width * 8;
    out->y = soft->desc.height * 8 - (int32_t)((y * (soft->desc.height * 8) + (FX_Q28_ONE / 2)) >> 28);
    out->z = held_depth(z <= 0 ? 0 : z * camera->depth_scale >> 24);
    out->nearness = (uint16_t)(near > 65535 ? 65535 : near < 1 ? 1 : near);
}

static void project_affine(const soft_camera *camera, const int16_t position[3], soft_vertex *out)
{
    out->x = (int32_t)(along(camera->screen[0], position, camera->screen_at[0]) >> 28);
    out->y = (int32_t)(along(camera->screen[1], position, camera->screen_at[1]) >> 28);
    out->z = held_depth(along(camera->screen[2], position, camera->screen_at[2]) >> 15);
    out->nearness = 65535;
}

/* Half of normal + eye, held within 47.7 degrees of the eye: convex, so that no interpolated one leaves the picture of a
   lit sphere. */
void soft_to_half(int16_t n[3])
{
    const int32_t x = n[0] >> 1, y = n[1] >> 1, z = (n[2] + 16384) >> 1, across = x * x + y * y;

    n[0] = (int16_t)x;
    n[1] = (int16_t)y;
    n[2] = (int16_t)z;
    if (across + z * z > (1 << 28) + (1 << 18)) { /* the unit normal of next to nothing may be 1.39 long */
        n[0] = n[1] = 0;
        n[2] = 16384;
    } else if (z * z < across - (across >> 3)) { /* (z / |xy|)^2 >= 0.875, and 0.91 from here on */
        uint32_t xy = shade_pack_xy(2 * x, 2 * y);
        int16_t none = 0;

        shade_normalise(&xy, &none, 1);
        n[2] = (int16_t)(((shade_x_of(xy) * x + shade_y_of(xy) * y) >> 14) * 31000 >> 15);
    }
}

/* Turned, not yet of unit length. */
static void turn_normal(const soft_camera *camera, const int16_t from[4], uint32_t *xy, int16_t *z)
{
    int32_t n[3];
    int i;

    for (i = 0; i < 3; i++) {
        const int32_t *const m = camera->normal[i];

        n[i] = (m[0] * from[0] >> 16) + (m[1] * from[1] >> 16) + (m[2] * from[2] >> 16);
    }
    *xy = shade_pack_xy(n[0], n[1]);
    *z = (int16_t)n[2];
}

/* A few at a time: kernels like it. */
static void transform_normals(const nacre_soft *soft, const soft_camera *camera, const nacre_vertex *from, int count,
                              soft_vertex *out)
{
    uint32_t xy[FEW];
    int16_t z[FEW];
    int i;

    for (i = 0; i < count; i++) turn_normal(camera, from[i].normal, &xy[i], &z[i]);
    soft->desc.kernels->normalise(xy, z, count);
    for (i = 0; i < count; i++) {
        out[i].normal[0] = (int16_t)shade_x_of(xy[i]);
        out[i].normal[1] = (int16_t)shade_y_of(xy[i]);
        out[i].normal[2] = z[i];
        if (camera->half) soft_to_half(out[i].normal);
    }
}

static void transform_position(const nacre_soft *soft, const soft_camera *camera, const int16_t position[3],
                               soft_vertex *out)
{
    int32_t clip[4];

    if (camera->affine) {
        project_affine(camera, position, out);
        return;
    }
    soft_clip_position(camera, position, clip);
    if (!camera->inside && outside(clip))
        out->z = SOFT_OUTSIDE;
    else
        soft_project(soft, camera, clip, out);
}

void soft_transform(const nacre_soft *soft, const soft_camera *camera, const nacre_mesh *mesh, soft_vertex *out)
{
    const int count = mesh->vertex_count;
    int i;

    for (i = 0; i < count; i += FEW)
        transform_normals(soft, camera, mesh->vertices + i, count - i < FEW ? count - i : FEW, out + i);
    for (i = 0; i < count; i++) transform_position(soft, camera, mesh->vertices[i].position, &out[i]);
}
