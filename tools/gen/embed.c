/* SPDX-License-Identifier: MIT */
/* embed FILE: the file as a C array on standard output: `const unsigned char embedded_NAME[]` and
   `const unsigned long embedded_NAME_size`, NAME from the file's base name with other characters than letters and
   digits as _. Byte arrays, because C99 promises no more than 4,095 characters in a string literal. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (!file) {
        fprintf(stderr, "embed: can't read %s\n", argc == 2 ? argv[1] : "(usage: embed FILE)");
        return 1;
    }
    const char *base = strrchr(argv[1], '/') ? strrchr(argv[1], '/') + 1 : argv[1];
    char name[256];
    size_t length = 0;
    for (; base[length] && length + 1 < sizeof name; length++)
        name[length] = isalnum((unsigned char)base[length]) ? base[length] : '_';
    name[length] = 0;

    printf("extern const unsigned char embedded_%s[];\nextern const unsigned long embedded_%s_size;\n", name, name);
    printf("const unsigned char embedded_%s[] = {", name);
    unsigned long size = 0;
    for (int c = getc(file); c != EOF; c = getc(file)) printf("%s%d,", size++ % 24 ? "" : "\n", c);
    printf("%s\n};\nconst unsigned long embedded_%s_size = %luul;\n", size ? "" : "0", name, size);
    fclose(file);
    return ferror(stdout) || fflush(stdout) ? 1 : 0;
}
