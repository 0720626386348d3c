/* SPDX-License-Identifier: MIT */
/* Four lanes of 32 bits with NEON, of ARMv7 and of ARMv8: what kernels.h is written in. Comments stand in lanes_avx2.h. */
#ifndef SOFT_LANES_NEON_H
#define SOFT_LANES_NEON_H

#include <arm_neon.h>
#include <string.h>

typedef int32x4_t lanes;
enum { LANES = 4 };

#define BITS(x)           vreinterpretq_u32_s32(x)
#define SIGNED(x)         vreinterpretq_s32_u32(x)
#define HALVES(x)         vreinterpretq_s16_s32(x)
#define WORDS(x)          vreinterpretq_s32_s16(x)
#define UP(x, n)          vshlq_n_s32(x, n)
#define DOWN(x, n)        SIGNED(vshrq_n_u32(BITS(x), n))
#define DOWN_SIGNED(x, n) vshrq_n_s32(x, n)
#define SPREAD(v, lane)   vdupq_n_s32(vgetq_lane_s32(v, lane))
#define WITH_FOURTH(v, x) vsetq_lane_s32((int32_t)(x), v, 3)

static inline lanes all(int32_t x)
{
    return vdupq_n_s32(x);
}

static inline lanes load(const void *p)
{
    return vld1q_s32((const int32_t *)p);
}

static inline void store(void *p, lanes x)
{
    vst1q_s32((int32_t *)p, x);
}

static inline lanes ramp(void)
{
    static const int32_t steps[4] = {0, 1, 2, 3};

    return load(steps);
}

static inline lanes load_16(const int16_t *p)
{
    return vmovl_s16(vld1_s16(p));
}

static inline lanes load_four_16(const int16_t *p)
{
    return load_16(p);
}

static inline lanes load_u16(const uint16_t *p)
{
    return SIGNED(vmovl_u16(vld1_u16(p)));
}

static inline void store_16(void *p, lanes x)
{
    vst1_s16((int16_t *)p, vmovn_s32(x));
}

static inline void store_bytes_where(lanes where, uint8_t *p, uint8_t x)
{
    const int16x4_t half = vmovn_s32(where);
    const uint32_t mask = vget_lane_u32(vreinterpret_u32_s8(vmovn_s16(vcombine_s16(half, half))), 0);
    uint32_t old;

    memcpy(&old, p, 4);
    old = (old & ~mask) | (x * 0x01010101u & mask);
    memcpy(p, &old, 4);
}

static inline lanes plus(lanes a, lanes b)
{
    return vaddq_s32(a, b);
}

static inline lanes minus(lanes a, lanes b)
{
    return vsubq_s32(a, b);
}

static inline lanes times(lanes a, lanes b)
{
    return vmulq_s32(a, b);
}

static inline lanes product(lanes a, lanes b)
{
    const lanes low = vmull_s16(vget_low_s16(HALVES(a)), vget_low_s16(HALVES(b)));
    const lanes high = vmull_s16(vget_high_s16(HALVES(a)), vget_high_s16(HALVES(b)));

    return vcombine_s32(vpadd_s32(vget_low_s32(low), vget_high_s32(low)),
                        vpadd_s32(vget_low_s32(high), vget_high_s32(high)));
}

static inline lanes times_wide(lanes x, int32_t factor, int shift, lanes *upper)
{
    const int64x2_t by = vdupq_n_s64(-shift);
    const int64x2_t low = vshlq_s64(vmull_n_s32(vget_low_s32(x), factor), by);
    const int64x2_t high = vshlq_s64(vmull_n_s32(vget_high_s32(x), factor), by);

    *upper = vcombine_s32(vshrn_n_s64(low, 32), vshrn_n_s64(high, 32));
    return vcombine_s32(vmovn_s64(low), vmovn_s64(high));
}

static inline lanes both(lanes a, lanes b)
{
    return vandq_s32(a, b);
}

static inline lanes either(lanes a, lanes b)
{
    return vorrq_s32(a, b);
}

static inline lanes without(lanes a, lanes b)
{
    return vbicq_s32(a, b);
}

static inline lanes down_by(lanes x, int n)
{
    return SIGNED(vshlq_u32(BITS(x), vdupq_n_s32(-n)));
}

static inline lanes least(lanes a, lanes b)
{
    return vminq_s32(a, b);
}

static inline lanes most(lanes a, lanes b)
{
    return vmaxq_s32(a, b);
}

static inline lanes least_unsigned(lanes a, lanes b)
{
    return SIGNED(vminq_u32(BITS(a), BITS(b)));
}

static inline lanes most_unsigned(lanes a, lanes b)
{
    return SIGNED(vmaxq_u32(BITS(a), BITS(b)));
}

static inline lanes size_of(lanes x)
{
    return vabsq_s32(x);
}

static inline lanes above(lanes a, lanes b)
{
    return SIGNED(vcgtq_s32(a, b));
}

static inline lanes same(lanes a, lanes b)
{
    return SIGNED(vceqq_s32(a, b));
}

static inline lanes choose(lanes where, lanes a, lanes b)
{
    return vbslq_s32(BITS(where), a, b);
}

static inline int any(lanes x)
{
    const int32x2_t some = vorr_s32(vget_low_s32(x), vget_high_s32(x));

    return (vget_lane_s32(some, 0) | vget_lane_s32(some, 1)) != 0;
}

static inline lanes halves(lanes lower, lanes upper)
{
    return vbslq_s32(vdupq_n_u32(65535), lower, upper);
}

static inline lanes times_q15(lanes a, lanes b)
{
    return WORDS(vqrdmulhq_s16(HALVES(a), HALVES(b)));
}

static inline lanes all_halves(int16_t x)
{
    return WORDS(vdupq_n_s16(x));
}

static inline lanes plus_halves(lanes a, lanes b)
{
    return WORDS(vaddq_s16(HALVES(a), HALVES(b)));
}

static inline lanes twice_halves(lanes x)
{
    return WORDS(vqaddq_s16(HALVES(x), HALVES(x)));
}

static inline lanes float_bits(lanes x)
{
    return vreinterpretq_s32_f32(vcvtq_f32_s32(x));
}

static inline lanes look_up(const uint32_t *table, lanes at)
{
    const int32_t *const words = (const int32_t *)(const void *)table;
    lanes out = vld1q_dup_s32(words + vgetq_lane_s32(at, 0));

    out = vld1q_lane_s32(words + vgetq_lane_s32(at, 1), out, 1);
    out = vld1q_lane_s32(words + vgetq_lane_s32(at, 2), out, 2);
    return vld1q_lane_s32(words + vgetq_lane_s32(at, 3), out, 3);
}

typedef struct sixteen {
    const uint32_t *table;
} sixteen;

static inline sixteen sixteen_of(const uint32_t *table)
{
    sixteen t;

    t.table = table;
    return t;
}

static inline lanes sixteen_at(const sixteen *t, lanes at)
{
    return look_up(t->table, both(at, all(15)));
}

static inline void look_up_4(const uint32_t *table, lanes at, lanes w[4])
{
    const int32x4x2_t even = vtrnq_s32(load(table + vgetq_lane_s32(at, 0)), load(table + vgetq_lane_s32(at, 1)));
    const int32x4x2_t odd = vtrnq_s32(load(table + vgetq_lane_s32(at, 2)), load(table + vgetq_lane_s32(at, 3)));

    w[0] = vcombine_s32(vget_low_s32(even.val[0]), vget_low_s32(odd.val[0]));
    w[1] = vcombine_s32(vget_low_s32(even.val[1]), vget_low_s32(odd.val[1]));
    w[2] = vcombine_s32(vget_high_s32(even.val[0]), vget_high_s32(odd.val[0]));
    w[3] = vcombine_s32(vget_high_s32(even.val[1]), vget_high_s32(odd.val[1]));
}

#endif
