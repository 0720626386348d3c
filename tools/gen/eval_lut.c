/* SPDX-License-Identifier: MIT */
/* Writes src/shade/eval_lut.c: the look-up tables of the per-pixel evaluators. Entries and their use: src/shade/eval_inner.h.
     cc tools/gen/eval_lut.c -lm -o eval_lut && ./eval_lut | clang-format >src/shade/eval_lut.c */
#include <math.h>
#include <stdint.h>
#include <stdio.h>

static double log2_of(double x)
{
    return log2(x) * 32768; /* x in 1..2 */
}

static double root48_of(double x)
{
    return pow(x, 1 / 4.8) * 32767; /* of 2^23: 1.0 */
}

static double srgb_of(double x)
{
    const double y = fmin(x, 1);

    return 128 * 255 * (y <= 0.0031308 ? 12.92 * y : 1.055 * pow(y, 1 / 2.4) - 0.055);
}

static double inverse_root_of(double x)
{
    return fmin(32768 / sqrt(x), 32767); /* x in 1..4 */
}

static double length_of(double x)
{
    return x < 15.5 ? 0 : 16384 * sqrt(64 / x);
}

/* One word: value at the node, and in the lower half twice the way to the next node. Values are moved by half the
   largest error of a chord towards the curve, so that the error has both signs. */
static void entry(double (*f)(double), double from, double to)
{
    const double middle = 0.5 * (f(0.5 * (from + to)) - 0.5 * (f(from) + f(to)));
    const double a = fmin(f(from) + middle, 32767), b = fmin(f(to) + middle, 32767);
    const int32_t base = (int32_t)lrint(a), way = (int32_t)lrint(2 * (b - base));

    printf("0x%08x, ", (unsigned)((uint32_t)base << 16 | ((uint32_t)way & 65535)));
}

static void table(const char *name, const char *comment, double (*f)(double), int low, int octaves, int per_octave,
                  int more, double one)
{
    const int count = octaves * per_octave + more;
    int i;

    printf("\n/* %s */\nconst uint32_t %s[%d] = {", comment, name, count);
    for (i = 0; i < count; i++) {
        const double octave = ldexp(1, low + i / per_octave), step = octave / per_octave;
        const double from = octave + step * (i % per_octave);

        entry(f, from / one, (from + step) / one);
    }
    printf("};\n");
}

/* For unit vectors that must not come out too long. */
static void unit_table(void)
{
    int i;

    printf(
        "\n/* 2^11 / sqrt of (i + 1/2) / 256, below 1/4 of (i + 1) / 256 */\nconst uint16_t shade_lut_unit[257] = {");
    for (i = 0; i < 257; i++) printf("%ld, ", lrint(2048 / sqrt((i + (i < 64 ? 1 : 0.5)) / 256)));
    printf("};\n");
}

int main(void)
{
    printf("/* SPDX-License-Identifier: MIT */\n/* Written by tools/gen/eval_lut.c. */\n#include \"eval_inner.h\"\n");
    table("shade_lut_log2", "log2 of 1..2", log2_of, 0, 1, 16, 0, 1);
    table("shade_lut_root48", "4.8th root of 2^-14..1.5", root48_of, 9, 14, 8, 5, ldexp(1, 23));
    table("shade_lut_srgb", "sRGB code x 128 of 2^-13..1", srgb_of, 3, 13, 8, 1, 65536);
    table("shade_lut_inverse_root", "1 / sqrt of 1..4", inverse_root_of, 0, 2, 16, 0, 1);
    {
        int i;

        printf("\n/* 2^14 / sqrt(x / 64) */\nconst uint32_t shade_lut_length[65] = {");
        for (i = 0; i < 65; i++) entry(length_of, i < 16 ? 15 : i, i < 16 ? 15 : i + 1);
        printf("};\n");
    }
    unit_table();
    return 0;
}
