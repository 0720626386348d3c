/* SPDX-License-Identifier: MIT */
#include "etc1.h"

#include <limits.h>
#include <string.h>

/*
 * A block, big-endian from bit 63:
 *   individual (bit 33 = 0)    R1 63..60 R2 59..56  G1 55..52 G2 51..48  B1 47..44 B2 43..40
 *   differential (bit 33 = 1)  R1 63..59 dR 58..56  G1 55..51 dG 50..48  B1 47..43 dB 42..40   (d: -4..3)
 *   table of half 1: 39..37, of half 2: 36..34; flip: 32 (0: halves 2 x 4 side by side; 1: 4 x 2, one above the other)
 *   texel (x, y): bits 16 + 4x + y (high) and 4x + y (low) of its index: 0 +small, 1 +large, 2 -small, 3 -large
 */
static const int modifier[8][4] = {{2, 8, -2, -8},     {5, 17, -5, -17},   {9, 29, -9, -29},     {13, 42, -13, -42},
                                   {18, 60, -18, -60}, {24, 80, -24, -80}, {33, 106, -33, -106}, {47, 183, -47, -183}};

enum { HALF = 8, KEPT = 6 };

/* One way to write a half: base colour code, table, squared error. */
typedef struct choice {
    int base[3], table;
    long error;
} choice;

static int clamp(int x, int low, int high)
{
    return x < low ? low : x > high ? high : x;
}

static int expand(int code, int bits)
{
    return bits == 4 ? code * 17 : code << 3 | code >> 2;
}

/* Code of `bits` bits that expands nearest to value. */
static int nearest_code(int value, int bits)
{
    int most = (1 << bits) - 1;
    return clamp((value * most + 127) / 255, 0, most);
}

/* Which texels (x, y) belong to a half, in the order of the index bits. */
static void half_texels(int flip, int half, int at[HALF])
{
    int n = 0;
    for (int x = 0; x < 4; x++)
        for (int y = 0; y < 4; y++)
            if ((flip ? y / 2 : x / 2) == half) at[n++] = 4 * x + y;
}

/* Best index of each texel for an expanded base colour; returns the squared error, LONG_MAX once above limit. */
static long half_error(const int texel[HALF][3], const int colour[3], int table, long limit, int index[HALF])
{
    long total = 0;
    for (int n = 0; n < HALF; n++) {
        int best = INT_MAX;
        for (int m = 0; m < 4; m++) {
            int error = 0;
            for (int c = 0; c < 3; c++) {
                int d = clamp(colour[c] + modifier[table][m], 0, 255) - texel[n][c];
                error += d * d;
            }
            if (error < best) {
                best = error;
                index[n] = m;
            }
        }
        total += best;
        if (total >= limit) return LONG_MAX;
    }
    return total;
}

/* Keep the KEPT best different choices, best first. */
static void keep(choice list[KEPT], int *count, const choice *c)
{
    int at = *count;
    for (int i = 0; i < *count; i++)
        if (list[i].table == c->table && !memcmp(list[i].base, c->base, sizeof c->base)) return;
    if (at == KEPT) {
        if (list[KEPT - 1].error <= c->error) return;
        at = KEPT - 1;
    } else {
        ++*count;
    }
    for (; at > 0 && list[at - 1].error > c->error; at--) list[at] = list[at - 1];
    list[at] = *c;
}

static long try_base(const int texel[HALF][3], const int base[3], int bits, int table, choice list[KEPT], int *count,
                     int index[HALF])
{
    int colour[3];
    choice c = {{base[0], base[1], base[2]}, table, 0};
    for (int k = 0; k < 3; k++) colour[k] = expand(base[k], bits);
    c.error = half_error(texel, colour, table, *count == KEPT ? list[KEPT - 1].error : LONG_MAX, index);
    if (c.error < LONG_MAX) keep(list, count, &c);
    return c.error;
}

/* For each table: from the mean colour, alternate between the best indices and the least-squares base for them; then
   look around the best ones. */
static void half_choices(const int texel[HALF][3], int bits, choice list[KEPT], int *count)
{
    int mean[3] = {0, 0, 0}, most = (1 << bits) - 1;
    for (int n = 0; n < HALF; n++)
        for (int c = 0; c < 3; c++) mean[c] += texel[n][c];
    *count = 0;
    for (int table = 0; table < 8; table++) {
        int base[3], index[HALF];
        for (int c = 0; c < 3; c++) base[c] = nearest_code((mean[c] + HALF / 2) / HALF, bits);
        for (int round = 0; round < 3; round++) {
            if (try_base(texel, base, bits, table, list, count, index) == LONG_MAX) break;
            int next[3];
            for (int c = 0; c < 3; c++) {
                int sum = 0;
                for (int n = 0; n < HALF; n++) sum += texel[n][c] - modifier[table][index[n]];
                next[c] = nearest_code(clamp((sum + HALF / 2) / HALF, 0, 255), bits);
            }
            if (!memcmp(next, base, sizeof base)) break;
            memcpy(base, next, sizeof base);
        }
    }
    for (int start = 0; start < 2 && start < *count && list[start].error > 0; start++) {
        choice around = list[start];
        for (int n = 0; n < 27; n++) {
            int base[3], index[HALF], step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            for (int c = 0; c < 3; c++) base[c] = clamp(around.base[c] + step[c], 0, most);
            try_base(texel, base, bits, around.table, list, count, index);
        }
    }
}

static int difference_fits(const choice *a, const choice *b)
{
    for (int c = 0; c < 3; c++) {
        int d = b->base[c] - a->base[c];
        if (d < -4 || d > 3) return 0;
    }
    return 1;
}

typedef struct plan {
    int flip, differential;
    choice half[2];
    long error;
} plan;

static void consider(plan *best, int flip, int differential, const choice *a, const choice *b)
{
    if (a->error + b->error >= best->error) return;
    *best = (plan){flip, differential, {*a, *b}, a->error + b->error};
}

/* No pair of the lists fits: pull the second base to where the difference can be written. */
static void consider_pulled(plan *best, int flip, const int second[HALF][3], const choice *a, const choice *b)
{
    int base[3], index[HALF], count = 0;
    choice list[KEPT];
    for (int c = 0; c < 3; c++) base[c] = clamp(clamp(b->base[c], a->base[c] - 4, a->base[c] + 3), 0, 31);
    for (int table = 0; table < 8; table++) try_base(second, base, 5, table, list, &count, index);
    consider(best, flip, 1, a, &list[0]);
}

static void write_block(const plan *p, const int texel[16][3], uint8_t out[8])
{
    uint64_t block = (uint64_t)p->differential << 33 | (uint64_t)p->flip << 32;
    for (int c = 0; c < 3; c++) {
        int a = p->half[0].base[c], b = p->half[1].base[c];
        int code = p->differential ? a << 3 | ((b - a) & 7) : a << 4 | b;
        block |= (uint64_t)code << (56 - 8 * c);
    }
    block |= (uint64_t)p->half[0].table << 37 | (uint64_t)p->half[1].table << 34;
    for (int half = 0; half < 2; half++) {
        int at[HALF], part[HALF][3], colour[3], index[HALF];
        half_texels(p->flip, half, at);
        for (int n = 0; n < HALF; n++) memcpy(part[n], texel[at[n]], sizeof part[n]);
        for (int c = 0; c < 3; c++) colour[c] = expand(p->half[half].base[c], p->differential ? 5 : 4);
        half_error(part, colour, p->half[half].table, LONG_MAX, index);
        for (int n = 0; n < HALF; n++)
            block |= (uint64_t)(index[n] >> 1) << (16 + at[n]) | (uint64_t)(index[n] & 1) << at[n];
    }
    for (int i = 0; i < 8; i++) out[i] = (uint8_t)(block >> (56 - 8 * i));
}

void etc1_encode_block(const int texel[16][3], uint8_t out[8])
{
    plan best = {.error = LONG_MAX};
    for (int flip = 0; flip < 2; flip++) {
        int part[2][HALF][3];
        for (int half = 0; half < 2; half++) {
            int at[HALF];
            half_texels(flip, half, at);
            for (int n = 0; n < HALF; n++) memcpy(part[half][n], texel[at[n]], sizeof part[half][n]);
        }
        choice fine[2][KEPT], coarse[2][KEPT];
        int fine_count[2], coarse_count[2], found = 0;
        for (int half = 0; half < 2; half++) half_choices(part[half], 5, fine[half], &fine_count[half]);
        for (int i = 0; i < fine_count[0]; i++)
            for (int j = 0; j < fine_count[1]; j++)
                if (difference_fits(&fine[0][i], &fine[1][j])) {
                    consider(&best, flip, 1, &fine[0][i], &fine[1][j]);
                    found = 1;
                }
        if (!found) consider_pulled(&best, flip, part[1], &fine[0][0], &fine[1][0]);
        if (found && difference_fits(&fine[0][0], &fine[1][0])) continue; /* five bits did all they can */
        for (int half = 0; half < 2; half++) half_choices(part[half], 4, coarse[half], &coarse_count[half]);
        consider(&best, flip, 0, &coarse[0][0], &coarse[1][0]);
    }
    write_block(&best, texel, out);
}

size_t etc1_size(int width, int height)
{
    return (size_t)((width + 3) / 4) * (size_t)((height + 3) / 4) * 8;
}

void etc_encode_blocks(const uint8_t *rgb, int width, int height,
                       void (*encode)(const int texel[16][3], uint8_t out[8]), uint8_t *out)
{
    for (int j = 0; j < height; j += 4)
        for (int i = 0; i < width; i += 4, out += 8) {
            int texel[16][3];
            for (int n = 0; n < 16; n++) {
                int x = clamp(i + n / 4, 0, width - 1), y = clamp(j + n % 4, 0, height - 1);
                for (int c = 0; c < 3; c++) texel[n][c] = rgb[3 * ((size_t)y * (size_t)width + (size_t)x) + (size_t)c];
            }
            encode((const int(*)[3])texel, out);
        }
}

void etc1_encode(const uint8_t *rgb, int width, int height, uint8_t *out)
{
    etc_encode_blocks(rgb, width, height, etc1_encode_block, out);
}

uint64_t etc_load_block(const uint8_t block[8])
{
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++) bits = bits << 8 | block[i];
    return bits;
}

/* Base colour codes of both halves; differential ones unclamped. */
static int block_bases(uint64_t bits, int base[2][3])
{
    int differential = (int)(bits >> 33 & 1);
    for (int c = 0; c < 3; c++) {
        int code = (int)(bits >> (56 - 8 * c) & 255);
        base[0][c] = differential ? code >> 3 : code >> 4;
        base[1][c] = differential ? base[0][c] + (code & 7) - (code & 4) * 2 : code & 15;
    }
    return differential;
}

int etc1_block_valid(const uint8_t block[8])
{
    int base[2][3];
    if (!block_bases(etc_load_block(block), base)) return 1;
    for (int c = 0; c < 3; c++)
        if (base[1][c] < 0 || base[1][c] > 31) return 0;
    return 1;
}

void etc1_decode_block(const uint8_t block[8], uint8_t texel[16][3])
{
    uint64_t bits = etc_load_block(block);
    int base[2][3], differential = block_bases(bits, base), flip = (int)(bits >> 32 & 1);
    for (int n = 0; n < 16; n++) {
        int half = flip ? (n % 4) / 2 : n / 8;
        int index = (int)((bits >> (16 + n) & 1) << 1 | (bits >> n & 1));
        int add = modifier[bits >> (half ? 34 : 37) & 7][index];
        for (int c = 0; c < 3; c++)
            texel[n][c] = (uint8_t)clamp(expand(base[half][c] & 31, differential ? 5 : 4) + add, 0, 255);
    }
}

void etc_decode_blocks(const uint8_t *blocks, int width, int height,
                       void (*decode)(const uint8_t block[8], uint8_t texel[16][3]), uint8_t *rgb)
{
    for (int j = 0; j < height; j += 4)
        for (int i = 0; i < width; i += 4, blocks += 8) {
            uint8_t texel[16][3];
            decode(blocks, texel);
            for (int n = 0; n < 16; n++) {
                int x = i + n / 4, y = j + n % 4;
                if (x < width && y < height) memcpy(rgb + 3 * ((size_t)y * (size_t)width + (size_t)x), texel[n], 3);
            }
        }
}

void etc1_decode(const uint8_t *blocks, int width, int height, uint8_t *rgb)
{
    etc_decode_blocks(blocks, width, height, etc1_decode_block, rgb);
}
