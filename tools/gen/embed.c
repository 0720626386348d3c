/* SPDX-License-Identifier: MIT */
/* embed [--shader] FILE: the file as a C array on standard output: `const unsigned char embedded_NAME[]` and
   `const unsigned long embedded_NAME_size`, NAME from the file's base name with other characters than letters and
   digits as _. Byte arrays, because C99 promises no more than 4,095 characters in a string literal. --shader leaves out
   what no compiler of GLSL needs: comments, indentation and empty lines are a third of the texts, in flash. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

static unsigned long size; /* bytes put out */

static void put(int c)
{
    printf("%s%d,", size++ % 24 ? "" : "\n", c);
}

/* The next character that is not in a comment; a comment is a space, as in C. */
static int next_outside_comments(FILE *file)
{
    int c = getc(file), last;
    if (c != '/') return c;
    const int kind = getc(file);
    if (kind == '/') {
        while ((c = getc(file)) != '\n' && c != EOF) continue;
        return c;
    }
    if (kind != '*') {
        ungetc(kind, file);
        return c;
    }
    for (last = 0; (c = getc(file)) != EOF && !(last == '*' && c == '/'); last = c) continue;
    return c == EOF ? EOF : ' ';
}

/* Spaces are kept back until something follows them on their line. */
static void put_shader(FILE *file)
{
    int spaces = 0, line_is_empty = 1;
    for (int c = next_outside_comments(file); c != EOF; c = next_outside_comments(file)) {
        if (c == ' ' || c == '\t') {
            spaces = 1;
            continue;
        }
        if (c != '\n' && spaces && !line_is_empty) put(' ');
        if (c != '\n' || !line_is_empty) put(c);
        spaces = 0;
        line_is_empty = c == '\n';
    }
}

static void put_file(FILE *file)
{
    for (int c = getc(file); c != EOF; c = getc(file)) put(c);
}

int main(int argc, char **argv)
{
    const int shader = argc == 3 && !strcmp(argv[1], "--shader");
    const char *path = argc == 2 + shader ? argv[1 + shader] : NULL;
    FILE *file = path ? fopen(path, "rb") : NULL;
    if (!file) {
        fprintf(stderr, "embed: can't read %s\n", path ? path : "(usage: embed [--shader] FILE)");
        return 1;
    }
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    char name[256];
    size_t length = 0;
    for (; base[length] && length + 1 < sizeof name; length++)
        name[length] = isalnum((unsigned char)base[length]) ? base[length] : '_';
    name[length] = 0;

    printf("extern const unsigned char embedded_%s[];\nextern const unsigned long embedded_%s_size;\n", name, name);
    printf("const unsigned char embedded_%s[] = {", name);
    if (shader)
        put_shader(file);
    else
        put_file(file);
    printf("%s\n};\nconst unsigned long embedded_%s_size = %luul;\n", size ? "" : "0", name, size);
    fclose(file);
    return ferror(stdout) || fflush(stdout) ? 1 : 0;
}
