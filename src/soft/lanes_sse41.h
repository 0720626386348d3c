/* SPDX-License-Identifier: MIT */
/* Four lanes of 32 bits with SSE4.1: what kernels.h is written in. Comments stand in lanes_avx2.h. */
#ifndef SOFT_LANES_SSE41_H
#define SOFT_LANES_SSE41_H

#include <smmintrin.h>
#include <string.h>

typedef __m128i lanes;
enum { LANES = 4 };

#define UP(x, n)          _mm_slli_epi32(x, n)
#define DOWN(x, n)        _mm_srli_epi32(x, n)
#define DOWN_SIGNED(x, n) _mm_srai_epi32(x, n)
#define SPREAD(v, lane)   _mm_shuffle_epi32(v, (lane)*0x55)
#define WITH_FOURTH(v, x) _mm_insert_epi32(v, (int32_t)(x), 3)

static inline lanes all(int32_t x)
{
    return _mm_set1_epi32(x);
}

static inline lanes ramp(void)
{
    return _mm_setr_epi32(0, 1, 2, 3);
}

static inline lanes load(const void *p)
{
    return _mm_loadu_si128((const lanes *)p);
}

static inline void store(void *p, lanes x)
{
    _mm_storeu_si128((lanes *)p, x);
}

static inline lanes load_16(const int16_t *p)
{
    return _mm_cvtepi16_epi32(_mm_loadl_epi64((const lanes *)(const void *)p));
}

static inline lanes load_four_16(const int16_t *p)
{
    return load_16(p);
}

static inline lanes load_u16(const uint16_t *p)
{
    return _mm_cvtepu16_epi32(_mm_loadl_epi64((const lanes *)(const void *)p));
}

static inline void store_16(void *p, lanes x)
{
    const lanes order = _mm_setr_epi8(0, 1, 4, 5, 8, 9, 12, 13, -1, -1, -1, -1, -1, -1, -1, -1);

    _mm_storel_epi64((lanes *)p, _mm_shuffle_epi8(x, order));
}

static inline void store_bytes_where(lanes where, uint8_t *p, uint8_t x)
{
    const lanes half = _mm_packs_epi32(where, where);
    const uint32_t mask = (uint32_t)_mm_cvtsi128_si32(_mm_packs_epi16(half, half));
    uint32_t old;

    memcpy(&old, p, 4);
    old = (old & ~mask) | (x * 0x01010101u & mask);
    memcpy(p, &old, 4);
}

static inline lanes plus(lanes a, lanes b)
{
    return _mm_add_epi32(a, b);
}

static inline lanes minus(lanes a, lanes b)
{
    return _mm_sub_epi32(a, b);
}

static inline lanes times(lanes a, lanes b)
{
    return _mm_mullo_epi32(a, b);
}

static inline lanes product(lanes a, lanes b)
{
    return _mm_madd_epi16(a, b);
}

static inline lanes times_wide(lanes x, int32_t factor, int shift, lanes *upper)
{
    const lanes f = all(factor), bias = _mm_set1_epi64x((int64_t)1 << 62), by = _mm_cvtsi32_si128(shift);
    const lanes less = _mm_srl_epi64(bias, by);
    const lanes even = _mm_sub_epi64(_mm_srl_epi64(_mm_add_epi64(_mm_mul_epi32(x, f), bias), by), less);
    const lanes odd =
        _mm_sub_epi64(_mm_srl_epi64(_mm_add_epi64(_mm_mul_epi32(_mm_srli_epi64(x, 32), f), bias), by), less);

    *upper = _mm_blend_epi16(_mm_srli_epi64(even, 32), odd, 0xCC);
    return _mm_blend_epi16(even, _mm_slli_epi64(odd, 32), 0xCC);
}

static inline lanes both(lanes a, lanes b)
{
    return _mm_and_si128(a, b);
}

static inline lanes either(lanes a, lanes b)
{
    return _mm_or_si128(a, b);
}

static inline lanes without(lanes a, lanes b)
{
    return _mm_andnot_si128(b, a);
}

static inline lanes down_by(lanes x, int n)
{
    return _mm_srl_epi32(x, _mm_cvtsi32_si128(n));
}

static inline lanes least(lanes a, lanes b)
{
    return _mm_min_epi32(a, b);
}

static inline lanes most(lanes a, lanes b)
{
    return _mm_max_epi32(a, b);
}

static inline lanes least_unsigned(lanes a, lanes b)
{
    return _mm_min_epu32(a, b);
}

static inline lanes most_unsigned(lanes a, lanes b)
{
    return _mm_max_epu32(a, b);
}

static inline lanes size_of(lanes x)
{
    return _mm_abs_epi32(x);
}

static inline lanes above(lanes a, lanes b)
{
    return _mm_cmpgt_epi32(a, b);
}

static inline lanes same(lanes a, lanes b)
{
    return _mm_cmpeq_epi32(a, b);
}

static inline lanes choose(lanes where, lanes a, lanes b)
{
    return _mm_blendv_epi8(b, a, where);
}

static inline int any(lanes x)
{
    return _mm_movemask_epi8(x) != 0;
}

static inline lanes halves(lanes lower, lanes upper)
{
    return _mm_blend_epi16(lower, upper, 0xAA);
}

static inline lanes times_q15(lanes a, lanes b)
{
    return _mm_mulhrs_epi16(a, b);
}

static inline lanes all_halves(int16_t x)
{
    return _mm_set1_epi16(x);
}

static inline lanes plus_halves(lanes a, lanes b)
{
    return _mm_add_epi16(a, b);
}

static inline lanes twice_halves(lanes x)
{
    return _mm_adds_epi16(x, x);
}

static inline lanes float_bits(lanes x)
{
    return _mm_castps_si128(_mm_cvtepi32_ps(x));
}

static inline lanes look_up(const uint32_t *table, lanes at)
{
    return _mm_setr_epi32((int)table[_mm_cvtsi128_si32(at)], (int)table[_mm_extract_epi32(at, 1)],
                          (int)table[_mm_extract_epi32(at, 2)], (int)table[_mm_extract_epi32(at, 3)]);
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
    const lanes r0 = load(table + _mm_cvtsi128_si32(at)), r1 = load(table + _mm_extract_epi32(at, 1)),
                r2 = load(table + _mm_extract_epi32(at, 2)), r3 = load(table + _mm_extract_epi32(at, 3));
    const lanes low_01 = _mm_unpacklo_epi32(r0, r1), high_01 = _mm_unpackhi_epi32(r0, r1),
                low_23 = _mm_unpacklo_epi32(r2, r3), high_23 = _mm_unpackhi_epi32(r2, r3);

    w[0] = _mm_unpacklo_epi64(low_01, low_23);
    w[1] = _mm_unpackhi_epi64(low_01, low_23);
    w[2] = _mm_unpacklo_epi64(high_01, high_23);
    w[3] = _mm_unpackhi_epi64(high_01, high_23);
}

#endif
