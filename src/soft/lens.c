/* SPDX-License-Identifier: MIT */
/* From pixels and their depth back to positions in view space. */
#include "soft.h"

/* (a x - b) / c for x = the normalised device coordinate of the first pixel and its step a pixel, q30. sign: -1 for y. */
static void set_axis(int64_t *at, int64_t *step, int64_t a, int64_t b, int64_t c, int32_t pixels, int sign)
{
    const int64_t scale = fx_div(a * FX_Q28_ONE * 4, c), offset = fx_div(b * FX_Q28_ONE * 4, c); /* q30 */

    *step = sign * fx_div(2 * scale, pixels);
    *at = -sign * scale + *step / 2 - offset;
}

int soft_lens_set(soft_lens *out, const nacre_soft *soft, const nacre_view *view, const shade_frame *frame)
{
    const nacre_q16 *const m = view->view_to_clip.m;
    const int32_t size[2] = {soft->desc.width, soft->desc.height};
    int i;

    if (m[1] | m[2] | m[3] | m[4] | m[6] | m[7] || !m[0] || !m[5]) return 0;
    for (i = 0; i < 2; i++) {
        const int sign = i ? -1 : 1; /* rows run downwards */

        set_axis(&out->a[i], &out->a_step[i], m[11], m[8 + i], m[5 * i], size[i], sign);
        set_axis(&out->b[i], &out->b_step[i], m[15], m[12 + i], m[5 * i], size[i], sign);
    }
    out->c = m[14];
    out->d = m[15];
    out->e = m[11];
    out->f = m[10];
    out->near = frame->eye[3].m != 0;
    for (i = 0; i < 3; i++) out->eye[i] = fx_real_fixed(frame->eye[i], 14);
    return 1;
}

/* View z, q16. */
static int32_t depth_to_z(const soft_lens *lens, int64_t s_q30)
{
    const int64_t above = ((int64_t)lens->c * FX_Q28_ONE * 4 - s_q30 * lens->d) >> 16; /* q30 */
    const int64_t below = (s_q30 * lens->e - (int64_t)lens->f * FX_Q28_ONE * 4) >> 16;
    const uint64_t size = (uint64_t)(below < 0 ? -below : below);
    const int down = size >> 32 ? fx_top_bit(size) - 31 : 0;
    const int64_t held = above < -((int64_t)1 << 33) ? -((int64_t)1 << 33)
                         : above > (int64_t)1 << 33  ? (int64_t)1 << 33
                                                     : above;
    uint32_t inverse;
    int64_t z;
    int shift;

    if (!size) return 0;
    shade_reciprocal((uint32_t)(size >> down), &inverse, &shift);
    shift += down - 16; /* q16 */
    z = shift > 3 ? (held >> 3) * (int64_t)inverse >> (shift - 3) : 0;
    if (z > INT32_MAX) z = INT32_MAX;
    if (z < -INT32_MAX) z = -INT32_MAX;
    return (int32_t)(below < 0 ? -z : z);
}

static int32_t held(int64_t x)
{
    return (int32_t)(x > INT32_MAX ? INT32_MAX : x < -INT32_MAX ? -INT32_MAX : x);
}

void soft_lens_look(const soft_item *item, int32_t x, int32_t y, const uint16_t *depth, int count,
                    int32_t *const position[3], uint32_t *eye_xy, int16_t *eye_z)
{
    const soft_lens *const lens = &item->lens;
    const int64_t ay = lens->a[1] + y * lens->a_step[1], by = lens->b[1] + y * lens->b_step[1];
    int i;

    for (i = 0; i < count; i++, x++) {
        const int64_t ax = lens->a[0] + x * lens->a_step[0], bx = lens->b[0] + x * lens->b_step[0];
        const int32_t z = depth_to_z(lens, item->camera.depth_low + ((depth[i] * item->camera.depth_step) >> 16));

        position[0][i] = held(((z * (ax >> 2)) >> 28) + (bx >> 14));
        position[1][i] = held(((z * (ay >> 2)) >> 28) + (by >> 14));
        position[2][i] = z;
        if (lens->near) { /* along the ray, whatever z is: (ax, ay, 1) for the eye at the origin, z below 0 */
            const int32_t rx = held(ax >> 2), ry = held(ay >> 2), one = FX_Q28_ONE;
            const uint32_t all = (uint32_t)(rx < 0 ? -rx : rx) | (uint32_t)(ry < 0 ? -ry : ry) | (uint32_t)one;
            const int shift = 19 - fx_leading_zeros(all); /* below 2^13 */

            eye_xy[i] = shade_pack_xy(rx >> shift, ry >> shift);
            eye_z[i] = (int16_t)(one >> shift);
        } else {
            eye_xy[i] = shade_pack_xy(lens->eye[0], lens->eye[1]);
            eye_z[i] = (int16_t)lens->eye[2];
        }
    }
    shade_normalise(eye_xy, eye_z, count);
}
