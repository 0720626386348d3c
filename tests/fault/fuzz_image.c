/* SPDX-License-Identifier: MIT */
/* The runtime's reader on arbitrary bytes. With -DNACRE_LIBFUZZER: a libFuzzer target. Without: a program that replays
   the files given, or, without any, damages the files in fixtures/asset in NACRE_FUZZ_ROUNDS (200000) ways that depend on
   nothing else. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"

static const char *const key_names[] = {
    "KTXorientation", NACRE_KEY_VERSION,     NACRE_KEY_ROLE,
    NACRE_KEY_TABLE,  NACRE_KEY_LIGHT_POLAR, NACRE_KEY_SCALE,
    NACRE_KEY_DISC,   NACRE_KEY_NAME,        "",
};

static volatile uint32_t sink;

static void demand(int condition, const char *what)
{
    if (condition) return;
    fprintf(stderr, "fuzz_image: %s\n", what);
    abort();
}

static void read_all(const nacre_image *image, const uint8_t *part, uint32_t size)
{
    uint32_t sum = 0;
    demand(part >= image->bytes && size <= image->size && (size_t)(part - image->bytes) <= image->size - size,
           "a part lies outside the file");
    for (uint32_t i = 0; i < size; i++) sum += part[i];
    sink = sink + sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    nacre_image image;
    nacre_q16 number[9];
    uint32_t part;
    if (nacre_image_open(&image, data, size)) return 0;
    demand(image.width >= 1 && image.width <= NACRE_MAX_TEXELS && image.height >= 1 && image.height <= NACRE_MAX_TEXELS,
           "size outside the profile");
    demand(image.layers >= 1 && image.layers <= NACRE_MAX_LAYERS && (image.faces == 1 || image.faces == 6),
           "parts outside the profile");
    demand(image.levels >= 1 && image.levels <= NACRE_MAX_LEVELS && asset_format_find(image.format),
           "levels or format outside the profile");
    for (unsigned level = 0; level < image.levels; level++)
        for (unsigned layer = 0; layer < image.layers; layer++)
            for (unsigned face = 0; face < image.faces; face++) {
                const uint8_t *texels = nacre_image_texels(&image, level, layer, face, &part);
                demand(texels != NULL, "a part is missing");
                read_all(&image, texels, part);
            }
    for (size_t i = 0; i < sizeof key_names / sizeof key_names[0]; i++) {
        const uint8_t *value = nacre_image_key(&image, key_names[i], &part);
        if (value) read_all(&image, value, part);
    }
    asset_key_q16(&image, NACRE_KEY_TABLE, number, 9);
    sink = sink + (uint32_t)asset_key_is(&image, NACRE_KEY_ROLE, "table");
    return 0;
}

#ifndef NACRE_LIBFUZZER
#include <glob.h>

static uint32_t state = 1;

static uint32_t next(void)
{
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state;
}

/* The file in a block of its own size, for the address sanitizer. */
static uint8_t *load(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END)) {
        perror(path);
        exit(2);
    }
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *data = malloc(*size ? *size : 1);
    demand(data && fread(data, 1, *size, file) == *size, "can't read a file");
    fclose(file);
    return data;
}

static void damage(uint8_t *data, size_t size)
{
    static const uint32_t words[] = {0, 1, 3, 6, 64, 4096, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFFC};
    const unsigned count = 1 + next() % 4;
    for (unsigned i = 0; i < count; i++) {
        const size_t at = next() % (next() % 4 ? 200 : size);
        if (at + 4 > size) continue;
        const uint32_t word = next() % 2 ? words[next() % 10] : asset_u32le(data + at) + next() % 9 - 4;
        for (int k = 0; k < 4; k++) data[at + (size_t)k] = (uint8_t)(word >> 8 * k);
    }
}

static void damage_all(long rounds)
{
    glob_t found;
    if (glob("fixtures/asset/*.ktx2", 0, NULL, &found)) {
        fprintf(stderr, "fuzz_image: no fixtures/asset/*.ktx2 here\n");
        exit(2);
    }
    for (long i = 0; i < rounds; i += 1000) {
        size_t size;
        uint8_t *data = load(found.gl_pathv[(size_t)(i / 1000) % found.gl_pathc], &size);
        uint8_t *copy = malloc(size);
        demand(copy != NULL, "out of memory");
        for (int k = 0; k < 1000; k++) {
            memcpy(copy, data, size);
            damage(copy, size);
            LLVMFuzzerTestOneInput(copy, size);
        }
        free(copy);
        free(data);
    }
    globfree(&found);
    printf("%ld damaged files\n", rounds);
}

int main(int argc, char **argv)
{
    const char *rounds = getenv("NACRE_FUZZ_ROUNDS");
    for (int i = 1; i < argc; i++) {
        size_t size;
        uint8_t *data = load(argv[i], &size);
        LLVMFuzzerTestOneInput(data, size);
        free(data);
    }
    if (argc < 2) damage_all(rounds ? atol(rounds) : 200000);
    return 0;
}
#endif
