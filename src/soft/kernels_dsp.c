/* SPDX-License-Identifier: MIT */
/*
 * The inner loops for Cortex-M4, M7, M33 and other small ARM processors with the DSP instructions, written out: what
 * raster.c, span.c and eval_inner.h define, with the same bits. Elsewhere this file is empty.
 *
 * A packed normal is a factor of SMUAD as it is, SMLABB and SMLATT take either half of a register, and look-up words are
 * made for SMLABB: the lower half times the fraction, added to the word. Compilers don't find these, as they see through
 * the halves. Loops end after their last pixel, or before one that needs more: C draws that one.
 */
#include "soft.h"

#if defined(__ARM_FEATURE_DSP) && defined(__thumb2__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__

#include "eval_inner.h"
#include "setup.h"

#define ASSEMBLY __attribute__((naked, noinline))
#pragma GCC diagnostic ignored "-Wunused-parameter"

/* ---- triangles -------------------------------------------------------------------------------------------------------------- */

typedef struct span { /* planes at its first pixel, and their steps: depth, normal x, y, z */
    soft_values value;
    uint32_t step[SOFT_PLANES];
} span;

ASSEMBLY static void fill(const span *s, uint16_t *depth, uint32_t *xy, int16_t *z, const uint16_t *depth_end)
{
    __asm__("push   {r4-r11, lr}           \n"
            "ldr    lr, [sp, #36]          \n" /* depth_end */
            "ldm    r0, {r4-r11}           \n"
            "1:                            \n"
            "ldrh   r0, [r1], #2           \n"
            "lsr    r12, r4, #15           \n"
            "cmp    r12, r0                \n"
            "bhs    2f                     \n"
            "strh   r12, [r1, #-2]         \n"
            "pkhtb  r0, r6, r5, asr #16    \n"
            "str    r0, [r2], #4           \n"
            "lsr    r0, r7, #16            \n"
            "strh   r0, [r3], #2           \n"
            "3:                            \n"
            "add    r4, r8                 \n"
            "add    r5, r9                 \n"
            "add    r6, r10                \n"
            "add    r7, r11                \n"
            "cmp    r1, lr                 \n"
            "bne    1b                     \n"
            "pop    {r4-r11, pc}           \n"
            "2:                            \n" /* behind */
            "add    r2, #4                 \n"
            "add    r3, #2                 \n"
            "b      3b                     \n");
}

static inline void fill_span(const soft_triangle *t, soft_values v, const soft_pixels *to, uint32_t at, int32_t count)
{
    span s;
    int i;

    s.value = v;
    for (i = 0; i < SOFT_PLANES; i++) s.step[i] = t->plane[i].dx;
    fill(&s, to->depth + at, to->xy + at, to->z + at, to->depth + at + count);
}

#include "raster.h"

/* ---- lit spheres ------------------------------------------------------------------------------------------------------------ */

typedef struct sphere {
    const uint16_t *texels;
    const uint16_t *unit; /* shade_lut_unit */
    int32_t scale;        /* 5/8 size, for q14 to q16, x 32 */
    int32_t half;         /* size / 2, q16 */
    int32_t low_half;     /* less the least bit: rounds up what is subtracted */
    int32_t last_row;     /* its first texel */
    int32_t minus_size;
    uint32_t count; /* of texels */
} sphere;

ASSEMBLY static void lit_16(const uint32_t *xy, const int16_t *z, uint16_t *to, const uint16_t *end, const sphere *s)
{
    __asm__("push   {r4-r11, lr}           \n"
            "ldr    r4, [sp, #36]          \n" /* s */
            "sub    sp, #4                 \n"
            "ldr    r5, [r4, #28]          \n"
            "str    r5, [sp]               \n" /* count */
            "ldm    r4, {r6-r12}           \n" /* texels unit scale half low_half last_row minus_size */
            "1:                            \n"
            "ldr    r4, [r0], #4           \n"
            "ldrsh  r5, [r1], #2           \n"
            "smuad  lr, r4, r4             \n"
            "smlabb r5, r5, r5, lr         \n"
            "lsr    r5, r5, #20            \n"
            "ldrh   r5, [r7, r5, lsl #1]   \n"
            "mul    r5, r8, r5             \n" /* length in the upper half */
            "smlatb lr, r5, r4, r9         \n" /* column */
            "smlatt r4, r5, r4, r10        \n"
            "smlatb r4, r4, r12, r11       \n" /* first texel of the row */
            "add    r4, r4, lr, asr #16    \n"
            "ldr    lr, [sp]               \n"
            "cmp    r4, lr                 \n"
            "bhs    2f                     \n"
            "3:                            \n"
            "ldrh   r4, [r6, r4, lsl #1]   \n"
            "strh   r4, [r2], #2           \n"
            "cmp    r2, r3                 \n"
            "bne    1b                     \n"
            "add    sp, #4                 \n"
            "pop    {r4-r11, pc}           \n"
            "2:                            \n"
            "mov    r4, #0                 \n"
            "b      3b                     \n");
}

static void lit(const nacre_soft_lit *from, const uint32_t *xy, const int16_t *z, int count, unsigned bytes, void *to)
{
    const int32_t size = from->size;
    const sphere s = {from->texels,     shade_lut_unit,    size * 80, size * 32768,
                      size * 32768 - 1, (size - 1) * size, -size,     (uint32_t)(size * size)};

    if (bytes == 2 && count > 0)
        lit_16(xy, z, to, (uint16_t *)to + count, &s);
    else
        soft_lit(from, xy, z, count, bytes, to);
}

/* ---- a table and its only light ---------------------------------------------------------------------------------------------- */

typedef struct table {
    const uint32_t *length; /* shade_lut_length from 16 on */
    uint32_t light_xy;
    uint32_t z; /* of the light; of -2 h in the upper half */
    uint32_t half_xy;
    uint32_t log2;             /* address of shade_lut_log2, for 16..31 */
    int32_t scale, from, last; /* u x 256 = log2 x scale + from */
    const uint32_t *columns;
    uint32_t limit;  /* of (n.l - n.v)^2, q15 */
    uint32_t root48; /* address of shade_lut_root48, for node - 8 zeros */
    int32_t gain;    /* q16 */
    uint32_t phi_rg, phi_b_shift;
    int32_t offset;
    int32_t low;          /* what is added to the square of a root: rounding less SHADE_CODE_LOW */
    const uint16_t *grey; /* RGB565 of grey by its code: each channel takes its part */
} table;

/* rgb565 of c c c */
#define GREY(c)    (uint16_t)(((c)*249 + 1014) >> 11 << 11 | ((c)*253 + 505) >> 10 << 5 | ((c)*249 + 1014) >> 11)
#define GREY_4(c)  GREY(c), GREY((c) + 1), GREY((c) + 2), GREY((c) + 3)
#define GREY_16(c) GREY_4(c), GREY_4((c) + 4), GREY_4((c) + 8), GREY_4((c) + 12)
#define GREY_64(c) GREY_16(c), GREY_16((c) + 16), GREY_16((c) + 32), GREY_16((c) + 48)
static const uint16_t grey_565[256] = {GREY_64(0), GREY_64(64), GREY_64(128), GREY_64(192)};

/* Returns where in `to` it stopped. */
ASSEMBLY static uint16_t *table_pixels(const uint32_t *xy, const int16_t *z, uint16_t *to, const table *t,
                                       const uint16_t *end)
{
    __asm__("push   {r4-r11, lr}               \n"
            "ldr    r11, [sp, #36]             \n" /* end */
            "ldrd   r10, r12, [r3, #60]        \n" /* low, grey */
            "1:                                \n"
            "ldr    r4, [r0], #4               \n"
            "ldrsh  r5, [r1], #2               \n"
            "ldrd   r8, r9, [r3]               \n" /* length, light_xy */
            "smuad  r6, r4, r4                 \n" /* the unit normal: r4 x y, r5 z */
            "smlabb r6, r5, r5, r6             \n"
            "sub    r7, r6, #0x4000000         \n"
            "cmp    r7, #0xC000000             \n"
            "bhs    5f                         \n"
            "lsr    r7, r7, #22                \n"
            "2:                                \n"
            "ldr    r7, [r8, r7, lsl #2]       \n"
            "ubfx   r6, r6, #7, #15            \n"
            "mov    lr, #8192                  \n"
            "smlabb r6, r7, r6, r7             \n"
            "smlatb r7, r6, r4, lr             \n"
            "smlatt r8, r6, r4, lr             \n"
            "smlatb r5, r6, r5, lr             \n"
            "asr    r7, r7, #14                \n"
            "asr    r5, r5, #14                \n"
            "pkhbt  r4, r7, r8, lsl #2         \n"
            "ldrd   r6, r7, [r3, #8]           \n" /* z, half_xy */
            "smuad  r8, r4, r9                 \n" /* n.l */
            "smlabb r8, r5, r6, r8             \n"
            "ldr    r9, [r3, #56]              \n" /* offset */
            "cmp    r8, #16384                 \n"
            "blt    6f                         \n"
            "smlad  r9, r4, r7, r9             \n" /* |n - h|^2 + 2 eps */
            "smlabt r9, r5, r6, r9             \n"
            "smlad  r9, r4, r4, r9             \n"
            "smlabb r9, r5, r5, r9             \n"
            "ldrd   r6, r7, [r3, #16]          \n" /* log2, scale */
            "lsr    r9, r9, #7                 \n"
            "clz    r4, r9                     \n"
            "lsl    r9, r9, r4                 \n"
            "lsr    lr, r9, #27                \n"
            "ldr    lr, [r6, lr, lsl #2]       \n"
            "ubfx   r9, r9, #12, #15           \n"
            "smlabb lr, lr, r9, lr             \n"
            "ldrd   r6, r9, [r3, #24]          \n" /* from, last */
            "asr    lr, lr, #19                \n"
            "sub    lr, lr, r4, lsl #12        \n"
            "mla    r7, lr, r7, r6             \n" /* the column */
            "cmp    r7, r9                     \n"
            "bgt    7f                         \n"
            "3:                                \n"
            "ldrd   r6, r4, [r3, #32]          \n" /* columns, limit */
            "ubfx   r9, r7, #8, #15            \n"
            "lsr    r7, r7, #23                \n"
            "add    r6, r6, r7, lsl #4         \n"
            "rsb    r7, r5, r8, asr #14        \n" /* (n.l - n.v)^2 */
            "mul    r7, r7, r7                 \n"
            "lsr    r7, r7, #13                \n"
            "cmp    r7, r4                     \n"
            "bhi    8f                         \n"
            "4:                                \n"
            "ldrd   r4, r5, [r3, #40]          \n" /* root48, gain */
            "asr    r8, r8, #5                 \n" /* r8: 4.8th root of n.l x gain */
            "clz    lr, r8                     \n"
            "lsl    r8, r8, lr                 \n"
            "sub    r4, r4, lr, lsl #5         \n"
            "lsr    lr, r8, #28                \n"
            "ldr    r4, [r4, lr, lsl #2]       \n"
            "ubfx   r8, r8, #13, #15           \n"
            "smlabb r8, r4, r8, r4             \n"
            "bfc    r8, #0, #16                \n"
            "smmulr r8, r8, r5                 \n"
            "ldr    lr, [r6, #12]              \n" /* r7: what phi is multiplied by */
            "smlabb lr, lr, r9, lr             \n"
            "asr    lr, lr, #15                \n"
            "mul    r7, lr, r7                 \n"
            "asr    r7, r7, #13                \n"
            "ldm    r6, {r4, r5, r6}           \n" /* roots */
            "smlabb r4, r4, r9, r4             \n"
            "smlabb r5, r5, r9, r5             \n"
            "smlabb r6, r6, r9, r6             \n"
            "ldrd   r9, lr, [r3, #48]          \n" /* phi_rg, phi_b_shift */
            "smlabb r4, r7, r9, r4             \n"
            "smlabt r5, r7, r9, r5             \n"
            "smlabt r6, r7, lr, r6             \n"
            "usat   r4, #15, r4, asr #15       \n"
            "usat   r5, #15, r5, asr #15       \n"
            "usat   r6, #15, r6, asr #15       \n"
            "mul    r4, r4, r8                 \n" /* codes */
            "mul    r5, r5, r8                 \n"
            "mul    r6, r6, r8                 \n"
            "asr    r4, r4, lr                 \n"
            "asr    r5, r5, lr                 \n"
            "asr    r6, r6, lr                 \n"
            "usat   r4, #15, r4                \n"
            "usat   r5, #15, r5                \n"
            "usat   r6, #15, r6                \n"
            "mla    r4, r4, r4, r10            \n"
            "mla    r5, r5, r5, r10            \n"
            "mla    r6, r6, r6, r10            \n"
            "usat   r4, #8, r4, asr #21        \n"
            "usat   r5, #8, r5, asr #21        \n"
            "usat   r6, #8, r6, asr #21        \n"
            "ldrh   r4, [r12, r4, lsl #1]      \n"
            "ldrh   r5, [r12, r5, lsl #1]      \n"
            "ldrh   r6, [r12, r6, lsl #1]      \n"
            "lsr    r5, r5, #5                 \n"
            "bfi    r4, r6, #0, #5             \n"
            "bfi    r4, r5, #5, #6             \n"
            "9:                                \n"
            "strh   r4, [r2], #2               \n"
            "cmp    r2, r11                    \n"
            "bne    1b                         \n"
            "0:                                \n"
            "mov    r0, r2                     \n"
            "pop    {r4-r11, pc}               \n"
            "5:                                \n" /* shorter than half: not here; longer than 1: the last node */
            "cmp    r6, #0x10000000            \n"
            "blo    0b                         \n"
            "mov    r7, #48                    \n"
            "b      2b                         \n"
            "6:                                \n" /* n.l below the root's first node: not here; or dark */
            "cmp    r8, #0                     \n"
            "bgt    0b                         \n"
            "mov    r4, #0                     \n"
            "b      9b                         \n"
            "7:                                \n"
            "mov    r7, r9                     \n"
            "b      3b                         \n"
            "8:                                \n"
            "mov    r7, r4                     \n"
            "b      4b                         \n");
}

static void table_565(const shade_table_eval *e, const uint32_t *xy, const int16_t *z, int count, uint16_t *to)
{
    const uint16_t *const end = to + count;
    table t;

    if (count <= 0) return;
    t.length = shade_lut_length + 16;
    t.light_xy = e->to_light_xy;
    t.z = shade_pack_xy(e->to_light_z, e->half_z);
    t.half_xy = e->half_xy;
    t.log2 = (uint32_t)(uintptr_t)shade_lut_log2 - 4 * 16; /* by number: C knows no pointer before an array */
    t.scale = e->scale;
    t.from = (int32_t)((uint32_t)e->at_middle * 256u + (uint32_t)(31 * 4096 - e->log_middle) * (uint32_t)e->scale);
    t.last = e->last * 256 + 255;
    t.columns = e->columns;
    t.limit = (uint32_t)(e->limit * e->limit) >> 13;
    t.root48 = (uint32_t)(uintptr_t)shade_lut_root48 + 4 * 168;
    t.gain = 2 * e->gain_code;
    t.phi_rg = shade_pack_xy(e->phi[0], e->phi[1]);
    t.phi_b_shift = shade_pack_xy(e->shift_code, e->phi[2]);
    t.offset = e->offset;
    t.low = (1 << 20) - SHADE_CODE_LOW;
    t.grey = grey_565;
    for (;;) {
        uint16_t *const at = table_pixels(xy, z, to, &t, end);
        uint32_t rgba;

        if (at == end) return;
        xy += at - to;
        z += at - to;
        shade_table_code(e, xy++, z++, 1, &rgba);
        *at = soft_565(rgba);
        to = at + 1;
        if (to == end) return;
    }
}

const nacre_soft_kernels nacre_soft_dsp = {draw, shade_normalise, shade_table_add, shade_table_code, shade_encode,
                                           lit,  table_565};

#endif
