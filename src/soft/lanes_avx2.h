/* SPDX-License-Identifier: MIT */
/* Eight lanes of 32 bits with AVX2: what kernels.h is written in. */
#ifndef SOFT_LANES_AVX2_H
#define SOFT_LANES_AVX2_H

#include <immintrin.h>

typedef __m256i lanes;
enum { LANES = 8 };

/* Shifts by constants: up, down without and with the sign. One of the first four lanes in all; x in the fourth. */
#define UP(x, n)          _mm256_slli_epi32(x, n)
#define DOWN(x, n)        _mm256_srli_epi32(x, n)
#define DOWN_SIGNED(x, n) _mm256_srai_epi32(x, n)
#define SPREAD(v, lane)   _mm256_broadcastd_epi32(_mm_shuffle_epi32(_mm256_castsi256_si128(v), (lane)*0x55))
#define WITH_FOURTH(v, x) _mm256_castsi128_si256(_mm_insert_epi32(_mm256_castsi256_si128(v), (int32_t)(x), 3))

static inline lanes all(int32_t x)
{
    return _mm256_set1_epi32(x);
}

/* 0 1 2 ... */
static inline lanes ramp(void)
{
    return _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
}

static inline lanes load(const void *p)
{
    return _mm256_loadu_si256((const lanes *)p);
}

static inline void store(void *p, lanes x)
{
    _mm256_storeu_si256((lanes *)p, x);
}

static inline lanes load_16(const int16_t *p)
{
    return _mm256_cvtepi16_epi32(_mm_loadu_si128((const __m128i *)(const void *)p));
}

/* Four numbers of 16 bits, in the first four lanes. */
static inline lanes load_four_16(const int16_t *p)
{
    return _mm256_castsi128_si256(_mm_cvtepi16_epi32(_mm_loadl_epi64((const __m128i *)(const void *)p)));
}

static inline lanes load_u16(const uint16_t *p)
{
    return _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)p));
}

/* The lower halves. */
static inline void store_16(void *p, lanes x)
{
    const lanes order = _mm256_setr_epi8(0, 1, 4, 5, 8, 9, 12, 13, -1, -1, -1, -1, -1, -1, -1, -1, 0, 1, 4, 5, 8, 9, 12,
                                         13, -1, -1, -1, -1, -1, -1, -1, -1);
    const lanes narrow = _mm256_permute4x64_epi64(_mm256_shuffle_epi8(x, order), 0x08);

    _mm_storeu_si128((__m128i *)p, _mm256_castsi256_si128(narrow));
}

/* The byte x where a lane is -1, what is there where it is 0. */
static inline void store_bytes_where(lanes where, uint8_t *p, uint8_t x)
{
    const __m128i half = _mm_packs_epi32(_mm256_castsi256_si128(where), _mm256_extracti128_si256(where, 1));
    const __m128i old = _mm_loadl_epi64((const __m128i *)(const void *)p);

    _mm_storel_epi64((__m128i *)(void *)p, _mm_blendv_epi8(old, _mm_set1_epi8((char)x), _mm_packs_epi16(half, half)));
}

static inline lanes plus(lanes a, lanes b)
{
    return _mm256_add_epi32(a, b);
}

static inline lanes minus(lanes a, lanes b)
{
    return _mm256_sub_epi32(a, b);
}

static inline lanes times(lanes a, lanes b)
{
    return _mm256_mullo_epi32(a, b);
}

/* Signed products of lower halves and of upper halves, added. */
static inline lanes product(lanes a, lanes b)
{
    return _mm256_madd_epi16(a, b);
}

/* (x factor) >> shift in 64 bits, |.| < 2^62 before the shift: the lower words, and the upper ones. */
static inline lanes times_wide(lanes x, int32_t factor, int shift, lanes *upper)
{
    const lanes f = all(factor), bias = _mm256_set1_epi64x((int64_t)1 << 62);
    const __m128i by = _mm_cvtsi32_si128(shift);
    const lanes less = _mm256_srl_epi64(bias, by); /* there is no signed shift */
    const lanes even = _mm256_sub_epi64(_mm256_srl_epi64(_mm256_add_epi64(_mm256_mul_epi32(x, f), bias), by), less);
    const lanes odd = _mm256_sub_epi64(
        _mm256_srl_epi64(_mm256_add_epi64(_mm256_mul_epi32(_mm256_srli_epi64(x, 32), f), bias), by), less);

    *upper = _mm256_blend_epi32(_mm256_srli_epi64(even, 32), odd, 0xAA);
    return _mm256_blend_epi32(even, _mm256_slli_epi64(odd, 32), 0xAA);
}

static inline lanes both(lanes a, lanes b)
{
    return _mm256_and_si256(a, b);
}

static inline lanes either(lanes a, lanes b)
{
    return _mm256_or_si256(a, b);
}

/* a and not b. */
static inline lanes without(lanes a, lanes b)
{
    return _mm256_andnot_si256(b, a);
}

static inline lanes down_by(lanes x, int n)
{
    return _mm256_srl_epi32(x, _mm_cvtsi32_si128(n));
}

static inline lanes least(lanes a, lanes b)
{
    return _mm256_min_epi32(a, b);
}

static inline lanes most(lanes a, lanes b)
{
    return _mm256_max_epi32(a, b);
}

static inline lanes least_unsigned(lanes a, lanes b)
{
    return _mm256_min_epu32(a, b);
}

static inline lanes most_unsigned(lanes a, lanes b)
{
    return _mm256_max_epu32(a, b);
}

static inline lanes size_of(lanes x)
{
    return _mm256_abs_epi32(x);
}

/* -1 where a > b, else 0. */
static inline lanes above(lanes a, lanes b)
{
    return _mm256_cmpgt_epi32(a, b);
}

static inline lanes same(lanes a, lanes b)
{
    return _mm256_cmpeq_epi32(a, b);
}

/* a where a lane is -1, b where it is 0. */
static inline lanes choose(lanes where, lanes a, lanes b)
{
    return _mm256_blendv_epi8(b, a, where);
}

/* Some lane is not 0; lanes are 0 or -1. */
static inline int any(lanes x)
{
    return _mm256_movemask_epi8(x) != 0;
}

/* Lower halves of one, upper halves of the other. */
static inline lanes halves(lanes lower, lanes upper)
{
    return _mm256_blend_epi16(lower, upper, 0xAA);
}

/* On both halves of the lanes: (a b + 2^14) >> 15. */
static inline lanes times_q15(lanes a, lanes b)
{
    return _mm256_mulhrs_epi16(a, b);
}

static inline lanes all_halves(int16_t x)
{
    return _mm256_set1_epi16(x);
}

static inline lanes plus_halves(lanes a, lanes b)
{
    return _mm256_add_epi16(a, b);
}

static inline lanes twice_halves(lanes x)
{
    return _mm256_adds_epi16(x, x);
}

/* Bits of x as a float, 0 <= x < 2^24. */
static inline lanes float_bits(lanes x)
{
    return _mm256_castps_si256(_mm256_cvtepi32_ps(x));
}

static inline lanes look_up(const uint32_t *table, lanes at)
{
    return _mm256_i32gather_epi32((const int *)table, at, 4);
}

/* A table of sixteen words, and the word at the place's lower four bits. */
typedef struct sixteen {
    lanes low, high;
} sixteen;

static inline sixteen sixteen_of(const uint32_t *table)
{
    sixteen t;

    t.low = load(table);
    t.high = load(table + 8);
    return t;
}

static inline lanes sixteen_at(const sixteen *t, lanes at)
{
    const lanes low = _mm256_permutevar8x32_epi32(t->low, at), high = _mm256_permutevar8x32_epi32(t->high, at);

    return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(low), _mm256_castsi256_ps(high),
                                                _mm256_castsi256_ps(_mm256_slli_epi32(at, 28))));
}

/* Four words from each lane's place on, as four lanes of words. */
static inline void look_up_4(const uint32_t *table, lanes at, lanes w[4])
{
    uint32_t place[8];
    lanes r[4], s[4];
    int i;

    store(place, at);
    for (i = 0; i < 4; i++)
        r[i] = _mm256_inserti128_si256(
            _mm256_castsi128_si256(_mm_loadu_si128((const __m128i *)(const void *)(table + place[i]))),
            _mm_loadu_si128((const __m128i *)(const void *)(table + place[i + 4])), 1);
    s[0] = _mm256_unpacklo_epi32(r[0], r[1]);
    s[1] = _mm256_unpackhi_epi32(r[0], r[1]);
    s[2] = _mm256_unpacklo_epi32(r[2], r[3]);
    s[3] = _mm256_unpackhi_epi32(r[2], r[3]);
    w[0] = _mm256_unpacklo_epi64(s[0], s[2]);
    w[1] = _mm256_unpackhi_epi64(s[0], s[2]);
    w[2] = _mm256_unpacklo_epi64(s[1], s[3]);
    w[3] = _mm256_unpackhi_epi64(s[1], s[3]);
}

#endif
