/* SPDX-License-Identifier: MIT */
/* power_table: the tables of src/shade/power.c on standard output. `make power-table` runs it. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>

static void print(const char *name, double (*value)(int))
{
    printf("\nconst uint32_t %s[257] = {", name);
    for (int i = 0; i <= 256; i++) printf("%s%.0f%s", i % 10 ? " " : "\n    ", round(value(i)), i < 256 ? "," : "};\n");
}

static double logarithm(int i)
{
    return 16777216 * log2(1 + i / 256.0);
}

static double root(int i)
{
    return 2147483648.0 * exp2(-i / 256.0);
}

int main(void)
{
    printf(
        "/* SPDX-License-Identifier: MIT */\n"
        "/* Made by tools/gen/power_table.c (make power-table). Entry i of the first is 2^24 log2(1 + i/256), of the\n"
        "   second 2^31 2^(-i/256). */\n"
        "#include \"shade.h\"\n"
        "/* clang-format off */\n");
    print("shade_log2_table", logarithm);
    print("shade_exp2_table", root);
    return ferror(stdout) || fflush(stdout) ? 1 : 0;
}
