/* SPDX-License-Identifier: MIT */
#include "etc2.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "etc1.h"

/*
 * Modes beyond ETC1, big-endian from bit 63; bit 33 is 1. v: bits that make the sum of a differential channel overflow (T:
 * red, H: green, planar: blue) or keep it from that.
 *   T       v 63..61 R1 60..59 v 58 R1 57..56 G1 55..52 B1 51..48 R2 47..44 G2 43..40 B2 39..36 d 35..34 d 32
 *   H       v 63 R1 62..59 G1 58..56 v 55..53 G1 52 B1 51 v 50 B1 49..47 R2 46..43 G2 42..39 B2 38..35 d 34 d 32
 *   planar  v 63 RO 62..57 GO 56 v 55 GO 54..49 BO 48 v 47..45 BO 44..43 v 42 BO 41..39 RH 38..34 RH 32 GH 31..25 BH 24..19
 *           RV 18..13 GV 12..6 BV 5..0
 * T and H: colours of 4 bits a channel and a distance; texel indices as in ETC1. T: C1, C2 + d, C2, C2 - d. H: C1 + d, C1 - d,
 * C2 + d, C2 - d; its distance's last bit says whether C1 >= C2 as a number. Planar: a colour at the origin and one 4 texels
 * to the right and below each, 6 bits a channel, green 7.
 */
static const int distances[8] = {3, 6, 11, 16, 23, 32, 41, 64};

enum { TEXELS = 16, SPLITS = 3, ROUNDS = 3 };

static int clamp(int x, int low, int high)
{
    return x < low ? low : x > high ? high : x;
}

static void store_block(uint64_t bits, uint8_t block[8])
{
    for (int i = 0; i < 8; i++) block[i] = (uint8_t)(bits >> (56 - 8 * i));
}

/* Bits low .. low + count - 1. */
static int field(uint64_t bits, int low, int count)
{
    return (int)(bits >> low & ((1u << count) - 1));
}

static uint64_t put(int value, int low)
{
    return (uint64_t)value << low;
}

/* ---- modes ---------------------------------------------------------------------------------------- */

/* Sum of the differential channel whose base's lowest bit is at low. */
static int channel_sum(uint64_t bits, int low)
{
    int difference = field(bits, low - 3, 3);
    return field(bits, low, 5) + difference - (difference & 4) * 2;
}

static int overflows(int sum)
{
    return sum < 0 || sum > 31;
}

static etc2_mode mode_of(uint64_t bits)
{
    if (!field(bits, 33, 1)) return ETC2_MODE_INDIVIDUAL;
    if (overflows(channel_sum(bits, 59))) return ETC2_MODE_T;
    if (overflows(channel_sum(bits, 51))) return ETC2_MODE_H;
    return overflows(channel_sum(bits, 43)) ? ETC2_MODE_PLANAR : ETC2_MODE_DIFFERENTIAL;
}

etc2_mode etc2_block_mode(const uint8_t block[8])
{
    return mode_of(etc_load_block(block));
}

/* Set the free bits of a channel so that it overflows. Its base's two low bits and its difference's two low bits are data:
   their sum decides on which side. */
static uint64_t make_overflow(uint64_t bits, int low)
{
    int sum = field(bits, low, 2) + field(bits, low - 3, 2);
    return bits | (sum < 4 ? put(1, low - 1) : put(7, low + 2));
}

/* Set the highest bit of a channel's base so that it does not overflow. */
static uint64_t avoid_overflow(uint64_t bits, int low)
{
    return overflows(channel_sum(bits, low)) ? bits | put(1, low + 4) : bits;
}

/* ---- decoding: texels in the order of index bits, 4 x + y ------------------------------------------ */

static void paint(uint8_t out[3], const int colour[3], int add)
{
    for (int c = 0; c < 3; c++) out[c] = (uint8_t)clamp(colour[c] * 17 + add, 0, 255);
}

static void t_paints(const int colour[2][3], int d, uint8_t out[4][3])
{
    paint(out[0], colour[0], 0);
    paint(out[1], colour[1], d);
    paint(out[2], colour[1], 0);
    paint(out[3], colour[1], -d);
}

static void h_paints(const int colour[2][3], int d, uint8_t out[4][3])
{
    paint(out[0], colour[0], d);
    paint(out[1], colour[0], -d);
    paint(out[2], colour[1], d);
    paint(out[3], colour[1], -d);
}

static void decode_paints(uint64_t bits, const uint8_t paints[4][3], uint8_t texel[TEXELS][3])
{
    for (int n = 0; n < TEXELS; n++) memcpy(texel[n], paints[field(bits, 16 + n, 1) << 1 | field(bits, n, 1)], 3);
}

static void decode_t(uint64_t bits, uint8_t texel[TEXELS][3])
{
    const int colour[2][3] = {{field(bits, 59, 2) << 2 | field(bits, 56, 2), field(bits, 52, 4), field(bits, 48, 4)},
                              {field(bits, 44, 4), field(bits, 40, 4), field(bits, 36, 4)}};
    uint8_t paints[4][3];
    t_paints(colour, distances[field(bits, 34, 2) << 1 | field(bits, 32, 1)], paints);
    decode_paints(bits, (const uint8_t(*)[3])paints, texel);
}

static int number(const int colour[3])
{
    return colour[0] << 8 | colour[1] << 4 | colour[2];
}

static void decode_h(uint64_t bits, uint8_t texel[TEXELS][3])
{
    const int colour[2][3] = {{field(bits, 59, 4), field(bits, 56, 3) << 1 | field(bits, 52, 1),
                               field(bits, 51, 1) << 3 | field(bits, 47, 3)},
                              {field(bits, 43, 4), field(bits, 39, 4), field(bits, 35, 4)}};
    int order = number(colour[0]) >= number(colour[1]);
    uint8_t paints[4][3];
    h_paints(colour, distances[field(bits, 34, 1) << 2 | field(bits, 32, 1) << 1 | order], paints);
    decode_paints(bits, (const uint8_t(*)[3])paints, texel);
}

static int expand(int code, int bits)
{
    return bits == 6 ? code << 2 | code >> 4 : code << 1 | code >> 6;
}

/* One channel: codes of the origin, right and below. */
static void planar_channel(const int code[3], int bits, int value[TEXELS])
{
    int o = expand(code[0], bits), h = expand(code[1], bits), v = expand(code[2], bits);
    for (int n = 0; n < TEXELS; n++) value[n] = clamp((n / 4 * (h - o) + n % 4 * (v - o) + 4 * o + 2) >> 2, 0, 255);
}

static const int planar_bits[3] = {6, 7, 6};

static void decode_planar(uint64_t bits, uint8_t texel[TEXELS][3])
{
    const int code[3][3] = {{field(bits, 57, 6), field(bits, 34, 5) << 1 | field(bits, 32, 1), field(bits, 13, 6)},
                            {field(bits, 56, 1) << 6 | field(bits, 49, 6), field(bits, 25, 7), field(bits, 6, 7)},
                            {field(bits, 48, 1) << 5 | field(bits, 43, 2) << 3 | field(bits, 39, 3), field(bits, 19, 6),
                             field(bits, 0, 6)}};
    for (int c = 0; c < 3; c++) {
        int value[TEXELS];
        planar_channel(code[c], planar_bits[c], value);
        for (int n = 0; n < TEXELS; n++) texel[n][c] = (uint8_t)value[n];
    }
}

static void decode_block(const uint8_t block[8], uint8_t texel[TEXELS][3])
{
    uint64_t bits = etc_load_block(block);
    switch (mode_of(bits)) {
    case ETC2_MODE_T:
        decode_t(bits, texel);
        break;
    case ETC2_MODE_H:
        decode_h(bits, texel);
        break;
    case ETC2_MODE_PLANAR:
        decode_planar(bits, texel);
        break;
    default:
        etc1_decode_block(block, texel);
        break;
    }
}

/* ---- planar ---------------------------------------------------------------------------------------- */

static long channel_error(const int wanted[TEXELS], const int code[3], int bits)
{
    int value[TEXELS];
    long error = 0;
    planar_channel(code, bits, value);
    for (int n = 0; n < TEXELS; n++) error += (long)(value[n] - wanted[n]) * (value[n] - wanted[n]);
    return error;
}

/* The plane of least squares, as codes; then the best of its neighbours. */
static long fit_channel(const int wanted[TEXELS], int bits, int code[3])
{
    double mean = 0, right = 0, down = 0;
    for (int n = 0; n < TEXELS; n++) {
        mean += wanted[n] / 16.0;
        right += (n / 4 - 1.5) * wanted[n] / 20; /* sum of (x - 1.5)^2 over 16 texels is 20 */
        down += (n % 4 - 1.5) * wanted[n] / 20;
    }
    double o = mean - 1.5 * right - 1.5 * down, at[3] = {o, o + 4 * right, o + 4 * down};
    int most = (1 << bits) - 1, start[3];
    for (int k = 0; k < 3; k++) start[k] = clamp((int)floor(at[k] * most / 255 + 0.5), 0, most);
    long best = LONG_MAX;
    for (int n = 0; n < 27; n++) {
        int step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}, tried[3];
        for (int k = 0; k < 3; k++) tried[k] = clamp(start[k] + step[k], 0, most);
        long error = channel_error(wanted, tried, bits);
        if (error >= best) continue;
        best = error;
        memcpy(code, tried, sizeof tried);
    }
    return best;
}

static uint64_t planar_block(const int code[3][3])
{
    const int *r = code[0], *g = code[1], *b = code[2];
    uint64_t bits = put(1, 33) | put(r[0], 57) | put(g[0] >> 6, 56) | put(g[0] & 63, 49) | put(b[0] >> 5, 48) |
                    put(b[0] >> 3 & 3, 43) | put(b[0] & 7, 39) | put(r[1] >> 1, 34) | put(r[1] & 1, 32) |
                    put(g[1], 25) | put(b[1], 19) | put(r[2], 13) | put(g[2], 6) | put(b[2], 0);
    return make_overflow(avoid_overflow(avoid_overflow(bits, 59), 51), 43);
}

static long encode_planar(const int texel[TEXELS][3], uint64_t *block)
{
    int code[3][3];
    long error = 0;
    for (int c = 0; c < 3; c++) {
        int wanted[TEXELS];
        for (int n = 0; n < TEXELS; n++) wanted[n] = texel[n][c];
        error += fit_channel(wanted, planar_bits[c], code[c]);
    }
    *block = planar_block((const int(*)[3])code);
    return error;
}

/* ---- T and H --------------------------------------------------------------------------------------- */

typedef struct pair_plan {
    int t; /* 1: T, 0: H */
    int colour[2][3], distance;
    int index[TEXELS];
    long error;
} pair_plan;

/* Best index of each texel; returns the squared error. */
static long choose_indices(const int texel[TEXELS][3], pair_plan *p)
{
    uint8_t paints[4][3];
    if (p->t)
        t_paints((const int(*)[3])p->colour, distances[p->distance], paints);
    else
        h_paints((const int(*)[3])p->colour, distances[p->distance], paints);
    p->error = 0;
    for (int n = 0; n < TEXELS; n++) {
        int best = INT_MAX;
        for (int i = 0; i < 4; i++) {
            int error = 0;
            for (int c = 0; c < 3; c++) error += (paints[i][c] - texel[n][c]) * (paints[i][c] - texel[n][c]);
            if (error >= best) continue;
            best = error;
            p->index[n] = i;
        }
        p->error += best;
    }
    return p->error;
}

/* What index i adds to its colour, and which colour that is. */
static int index_step(const pair_plan *p, int i, int *which)
{
    static const int t_step[4] = {0, 1, 0, -1}, h_step[4] = {1, -1, 1, -1};
    *which = p->t ? i > 0 : i > 1;
    return (p->t ? t_step[i] : h_step[i]) * distances[p->distance];
}

/* Colours of least squares for the indices chosen; a colour without texels stays. */
static void refit_colours(const int texel[TEXELS][3], pair_plan *p)
{
    int sum[2][3] = {{0}}, count[2] = {0, 0};
    for (int n = 0; n < TEXELS; n++) {
        int which, step = index_step(p, p->index[n], &which);
        for (int c = 0; c < 3; c++) sum[which][c] += texel[n][c] - step;
        count[which]++;
    }
    for (int k = 0; k < 2; k++)
        for (int c = 0; c < 3 && count[k]; c++)
            p->colour[k][c] = clamp((int)floor((double)sum[k][c] / count[k] / 17 + 0.5), 0, 15);
}

/* From two colours on: alternate for each distance. */
static void improve_pair(const int texel[TEXELS][3], int t, const int colour[2][3], pair_plan *best)
{
    for (int d = 0; d < 8; d++) {
        pair_plan p = {.t = t, .distance = d};
        memcpy(p.colour, colour, sizeof p.colour);
        long before = LONG_MAX;
        for (int round = 0; round < ROUNDS && choose_indices(texel, &p) < before; round++) {
            before = p.error;
            if (p.error < best->error) *best = p;
            refit_colours(texel, &p);
        }
    }
}

/* Texels in the order of their place along the block's longest direction. */
static void sort_texels(const int texel[TEXELS][3], int order[TEXELS])
{
    double mean[3] = {0, 0, 0}, axis[3] = {1, 1, 1}, at[TEXELS];
    for (int n = 0; n < TEXELS; n++)
        for (int c = 0; c < 3; c++) mean[c] += texel[n][c] / 16.0;
    for (int round = 0; round < 4; round++) { /* power iteration on the covariance */
        double next[3] = {0, 0, 0};
        for (int n = 0; n < TEXELS; n++) {
            double along = 0;
            for (int c = 0; c < 3; c++) along += (texel[n][c] - mean[c]) * axis[c];
            for (int c = 0; c < 3; c++) next[c] += along * (texel[n][c] - mean[c]);
        }
        double length = sqrt(next[0] * next[0] + next[1] * next[1] + next[2] * next[2]);
        if (length < 1e-9) break;
        for (int c = 0; c < 3; c++) axis[c] = next[c] / length;
    }
    for (int n = 0; n < TEXELS; n++) {
        int i = n;
        at[n] = texel[n][0] * axis[0] + texel[n][1] * axis[1] + texel[n][2] * axis[2];
        for (; i > 0 && at[order[i - 1]] > at[n]; i--) order[i] = order[i - 1];
        order[i] = n;
    }
}

/* Mean colours (4 bits) of the first `count` texels in order and of the others; returns the scatter around them. */
static double split_colours(const int texel[TEXELS][3], const int order[TEXELS], int count, int colour[2][3])
{
    double sum[2][3] = {{0}}, square = 0, between = 0;
    for (int n = 0; n < TEXELS; n++)
        for (int c = 0; c < 3; c++) {
            double x = texel[order[n]][c];
            sum[n >= count][c] += x;
            square += x * x;
        }
    for (int c = 0; c < 3; c++) {
        between += sum[0][c] * sum[0][c] / count + sum[1][c] * sum[1][c] / (TEXELS - count);
        colour[0][c] = clamp((int)floor(sum[0][c] / count / 17 + 0.5), 0, 15);
        colour[1][c] = clamp((int)floor(sum[1][c] / (TEXELS - count) / 17 + 0.5), 0, 15);
    }
    return square - between;
}

/* Both modes from the SPLITS splits into two groups with the least scatter. */
static void encode_pair(const int texel[TEXELS][3], pair_plan *best)
{
    int order[TEXELS], done[TEXELS] = {0};
    sort_texels(texel, order);
    for (int i = 0; i < SPLITS; i++) {
        int colour[2][3], count = 0;
        double least = HUGE_VAL;
        for (int n = 1; n < TEXELS; n++) {
            double scatter = split_colours(texel, order, n, colour);
            if (done[n] || scatter >= least) continue;
            least = scatter;
            count = n;
        }
        done[count] = 1;
        split_colours(texel, order, count, colour);
        const int other[2][3] = {{colour[1][0], colour[1][1], colour[1][2]},
                                 {colour[0][0], colour[0][1], colour[0][2]}};
        improve_pair(texel, 1, (const int(*)[3])colour, best);
        improve_pair(texel, 1, other, best);
        improve_pair(texel, 0, (const int(*)[3])colour, best);
    }
}

static uint64_t index_bits(const int index[TEXELS])
{
    uint64_t bits = 0;
    for (int n = 0; n < TEXELS; n++) bits |= put(index[n] >> 1, 16 + n) | put(index[n] & 1, n);
    return bits;
}

static uint64_t t_block(const pair_plan *p)
{
    const int *a = p->colour[0], *b = p->colour[1];
    uint64_t bits = put(1, 33) | put(a[0] >> 2, 59) | put(a[0] & 3, 56) | put(a[1], 52) | put(a[2], 48) |
                    put(b[0], 44) | put(b[1], 40) | put(b[2], 36) | put(p->distance >> 1, 34) |
                    put(p->distance & 1, 32);
    return make_overflow(bits | index_bits(p->index), 59);
}

/* The colours' order carries the distance's last bit. Equal colours can only say 1: nothing is lost by any index then, but
   the distance must be odd, which encode_block sees to by checking what the block decodes to. */
static uint64_t h_block(const pair_plan *p)
{
    int swap = (number(p->colour[0]) >= number(p->colour[1])) != (p->distance & 1), index[TEXELS];
    const int *a = p->colour[swap], *b = p->colour[!swap];
    for (int n = 0; n < TEXELS; n++) index[n] = p->index[n] ^ (swap ? 2 : 0);
    uint64_t bits = put(1, 33) | put(a[0], 59) | put(a[1] >> 1, 56) | put(a[1] & 1, 52) | put(a[2] >> 3, 51) |
                    put(a[2] & 7, 47) | put(b[0], 43) | put(b[1], 39) | put(b[2], 35) | put(p->distance >> 2, 34) |
                    put(p->distance >> 1 & 1, 32);
    return make_overflow(avoid_overflow(bits | index_bits(index), 59), 51);
}

/* ---- a block --------------------------------------------------------------------------------------- */

static long block_error(const uint8_t block[8], const int texel[TEXELS][3])
{
    uint8_t drawn[TEXELS][3];
    long error = 0;
    decode_block(block, drawn);
    for (int n = 0; n < TEXELS; n++)
        for (int c = 0; c < 3; c++) error += (long)(drawn[n][c] - texel[n][c]) * (drawn[n][c] - texel[n][c]);
    return error;
}

/* Keep what of both draws better. */
static void keep_better(uint64_t bits, const int texel[TEXELS][3], uint8_t out[8], long *least)
{
    uint8_t block[8];
    store_block(bits, block);
    long error = block_error(block, texel);
    if (error >= *least) return;
    *least = error;
    memcpy(out, block, sizeof block);
}

static void encode_block(const int texel[TEXELS][3], uint8_t out[8])
{
    etc1_encode_block(texel, out);
    long least = block_error(out, texel);
    uint64_t bits;
    if (least && encode_planar(texel, &bits) < least) keep_better(bits, texel, out, &least);
    if (!least) return;
    pair_plan pair = {.error = LONG_MAX};
    encode_pair(texel, &pair);
    if (pair.error < least) keep_better(pair.t ? t_block(&pair) : h_block(&pair), texel, out, &least);
}

void etc2_encode(const uint8_t *rgb, int width, int height, uint8_t *out)
{
    etc_encode_blocks(rgb, width, height, encode_block, out);
}

void etc2_decode(const uint8_t *blocks, int width, int height, uint8_t *rgb)
{
    etc_decode_blocks(blocks, width, height, decode_block, rgb);
}
