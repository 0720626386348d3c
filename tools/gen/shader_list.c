/* SPDX-License-Identifier: MIT */
/* shader_list DIR: every shader text that the runtime can assemble, as DIR/NAME.frag with DIR/NAME.vert beside. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "key.h"

static int write_text(const char *directory, const gles_key *key, int fragment)
{
    const char *part[GLES_TEXT_PARTS];
    int length[GLES_TEXT_PARTS];
    char defines[GLES_DEFINES_SIZE], name[GLES_KEY_NAME_SIZE], path[4096];

    gles_key_name(key, name);
    snprintf(path, sizeof path, "%s/%s.%s", directory, name, fragment ? "frag" : "vert");
    FILE *file = fopen(path, "wb");
    int ok = file != NULL;
    const int parts = gles_text(key, fragment, part, length, defines);
    for (int i = 0; ok && i < parts; i++) ok = fwrite(part[i], 1, (size_t)length[i], file) == (size_t)length[i];
    if (file && fclose(file)) ok = 0;
    if (!ok) fprintf(stderr, "shader_list: can't write %s\n", path);
    return ok;
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: shader_list DIR\n");
        return 1;
    }
    const unsigned count = gles_key_list(NULL, 0);
    gles_key *key = calloc(count, sizeof *key);
    if (!key) return 70;
    gles_key_list(key, count);
    int ok = 1;
    for (unsigned i = 0; ok && i < count; i++) ok = write_text(argv[1], &key[i], 0) && write_text(argv[1], &key[i], 1);
    free(key);
    if (ok) printf("%u shader programs in %s\n", count, argv[1]);
    return ok ? 0 : 2;
}
