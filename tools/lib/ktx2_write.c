/* SPDX-License-Identifier: MIT */
#include "ktx2_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "nacre_asset.h"

/* Numbers of the Khronos Data Format Specification 1.4, basic descriptor block. */
enum {
    MODEL_RGBSDA = 1,
    MODEL_ETC2 = 161,
    PRIMARIES_BT709 = 1,
    TRANSFER_LINEAR = 1,
    TRANSFER_SRGB = 2,
    CHANNEL_RED = 0,
    CHANNEL_GREEN = 1,
    CHANNEL_BLUE = 2,
    CHANNEL_ETC2_COLOR = 2,
    CHANNEL_ALPHA = 15,
    QUALIFIER_LINEAR = 0x10,   /* the transfer function does not apply */
    QUALIFIER_EXPONENT = 0x20, /* exponent of the sample before */
    QUALIFIER_SIGNED = 0x40,
    QUALIFIER_FLOAT = 0x80,
    MAX_SAMPLES = 6
};

typedef struct sample {
    uint8_t channel; /* with qualifiers */
    uint8_t bit_offset, bit_length;
    uint32_t lower, upper;
} sample;

typedef struct descriptor {
    int format, model, sample_count;
    sample samples[MAX_SAMPLES];
} descriptor;

#define HALF(channel, offset)                                                                                          \
    {                                                                                                                  \
        (channel) | QUALIFIER_FLOAT | QUALIFIER_SIGNED, offset, 16, 0xBF800000u, 0x3F800000u                           \
    }
/* The Data Format Specification's limits for 9-9-9-5; 15 is the exponent's bias. */
#define SHARED(channel, offset)                                                                                        \
    {(channel), offset, 9, 0, 8448},                                                                                   \
    {                                                                                                                  \
        (channel) | QUALIFIER_EXPONENT, 27, 5, 15, 31                                                                  \
    }

static const descriptor descriptors[] = {
    {NACRE_FORMAT_RGB565,
     MODEL_RGBSDA,
     3,
     {{CHANNEL_BLUE, 0, 5, 0, 31}, {CHANNEL_GREEN, 5, 6, 0, 63}, {CHANNEL_RED, 11, 5, 0, 31}}},
    {NACRE_FORMAT_R8, MODEL_RGBSDA, 1, {{CHANNEL_RED, 0, 8, 0, 255}}},
    {NACRE_FORMAT_RG8, MODEL_RGBSDA, 2, {{CHANNEL_RED, 0, 8, 0, 255}, {CHANNEL_GREEN, 8, 8, 0, 255}}},
    {NACRE_FORMAT_RGB8,
     MODEL_RGBSDA,
     3,
     {{CHANNEL_RED, 0, 8, 0, 255}, {CHANNEL_GREEN, 8, 8, 0, 255}, {CHANNEL_BLUE, 16, 8, 0, 255}}},
    {NACRE_FORMAT_RGBA8,
     MODEL_RGBSDA,
     4,
     {{CHANNEL_RED, 0, 8, 0, 255},
      {CHANNEL_GREEN, 8, 8, 0, 255},
      {CHANNEL_BLUE, 16, 8, 0, 255},
      {CHANNEL_ALPHA, 24, 8, 0, 255}}},
    {NACRE_FORMAT_RGBA16F,
     MODEL_RGBSDA,
     4,
     {HALF(CHANNEL_RED, 0), HALF(CHANNEL_GREEN, 16), HALF(CHANNEL_BLUE, 32), HALF(CHANNEL_ALPHA, 48)}},
    {NACRE_FORMAT_E5BGR9,
     MODEL_RGBSDA,
     6,
     {SHARED(CHANNEL_RED, 0), SHARED(CHANNEL_GREEN, 9), SHARED(CHANNEL_BLUE, 18)}},
    {NACRE_FORMAT_ETC2_RGB8, MODEL_ETC2, 1, {{CHANNEL_ETC2_COLOR, 0, 64, 0, 0xFFFFFFFFu}}},
};

/* A caller's mistake: the baker handed over an image no file can hold. */
static void broken(const char *what, long long found, long long expected)
{
    fprintf(stderr, "nacre: internal error: ktx2_write: %s: found %lld, expected %lld\n", what, found, expected);
    exit(FAIL_INTERNAL);
}

static void append_u64(bytes *b, uint64_t value)
{
    bytes_append_u32(b, (uint32_t)value);
    bytes_append_u32(b, (uint32_t)(value >> 32));
}

static void append_zeros(bytes *b, size_t count)
{
    while (count--) bytes_append(b, "", 1);
}

static void append_descriptor(bytes *b, const descriptor *d, const asset_format *format, int srgb)
{
    const uint32_t block_size = 24 + 16 * (uint32_t)d->sample_count;
    const uint32_t transfer = srgb ? TRANSFER_SRGB : TRANSFER_LINEAR;
    bytes_append_u32(b, 4 + block_size);
    bytes_append_u32(b, 0);                    /* vendor Khronos, basic descriptor */
    bytes_append_u32(b, 2 | block_size << 16); /* version 1.3 and later */
    bytes_append_u32(b, (uint32_t)d->model | PRIMARIES_BT709 << 8 | transfer << 16);
    bytes_append_u32(b, format->block_shift ? 3 | 3 << 8 : 0); /* block dimensions less 1 */
    bytes_append_u32(b, format->block_bytes);                  /* plane 0 */
    bytes_append_u32(b, 0);
    for (int i = 0; i < d->sample_count; i++) {
        const sample *s = &d->samples[i];
        uint32_t channel = s->channel;
        if (srgb && channel == CHANNEL_ALPHA) channel |= QUALIFIER_LINEAR;
        bytes_append_u32(b, s->bit_offset | (uint32_t)(s->bit_length - 1) << 16 | channel << 24);
        bytes_append_u32(b, 0); /* sample position */
        bytes_append_u32(b, s->lower);
        bytes_append_u32(b, s->upper);
    }
}

static void append_key(bytes *b, const char *name, const void *value, size_t size)
{
    const size_t length = strlen(name) + 1 + size;
    bytes_append_u32(b, (uint32_t)length);
    bytes_append(b, name, strlen(name) + 1);
    bytes_append(b, value, size);
    append_zeros(b, (4 - length % 4) % 4);
}

typedef struct key_ref {
    const char *name;
    const void *value;
    size_t size;
} key_ref;

static int compare_keys(const void *a, const void *b)
{
    /* strcmp compares as unsigned char, and UTF-8 sorts as its code points */
    return strcmp(((const key_ref *)a)->name, ((const key_ref *)b)->name);
}

static void append_keys(bytes *b, const ktx2_image *k)
{
    static const uint8_t version[4] = {NACRE_ASSET_VERSION, 0, 0, 0};
    static const char orientation[] = "rd";
    char writer[32];
    snprintf(writer, sizeof writer, "nacre %d.%d.%d", NACRE_VERSION_MAJOR, NACRE_VERSION_MINOR, NACRE_VERSION_PATCH);

    key_ref refs[KTX2_MAX_KEYS + 3] = {
        {"KTXorientation", orientation, sizeof orientation},
        {"KTXwriter", writer, strlen(writer) + 1},
        {NACRE_KEY_VERSION, version, sizeof version},
    };
    size_t count = 3;
    for (int i = 0; i < k->key_count; i++)
        refs[count++] = (key_ref){k->key[i].name, k->key[i].value.data, k->key[i].value.size};
    qsort(refs, count, sizeof refs[0], compare_keys);
    for (size_t i = 0; i < count; i++) {
        if (i && !strcmp(refs[i - 1].name, refs[i].name)) broken(refs[i].name, 2, 1);
        append_key(b, refs[i].name, refs[i].value, refs[i].size);
    }
}

/* Room for one more key. */
static bytes *add_key(ktx2_image *k, const char *name)
{
    if (k->key_count >= KTX2_MAX_KEYS) broken("number of keys", k->key_count + 1, KTX2_MAX_KEYS);
    if (strlen(name) >= sizeof k->key[0].name) broken(name, (long long)strlen(name), sizeof k->key[0].name - 1);
    snprintf(k->key[k->key_count].name, sizeof k->key[0].name, "%s", name);
    return &k->key[k->key_count++].value;
}

/* Where a value starts with a number, KTX2 wants the name and its NUL to be a multiple of the number's size. */
static bytes *add_number_key(ktx2_image *k, const char *name)
{
    if ((strlen(name) + 1) % 4) broken(name, (long long)strlen(name) + 1, ((long long)strlen(name) + 4) / 4 * 4);
    return add_key(k, name);
}

void ktx2_key_text(ktx2_image *k, const char *name, const char *value)
{
    bytes_append(add_key(k, name), value, strlen(value) + 1);
}

void ktx2_key_u32(ktx2_image *k, const char *name, const uint32_t *value, int count)
{
    bytes *b = add_number_key(k, name);
    for (int i = 0; i < count; i++) bytes_append_u32(b, value[i]);
}

void ktx2_key_q16(ktx2_image *k, const char *name, const double *value, int count)
{
    bytes *b = add_number_key(k, name);
    for (int i = 0; i < count; i++) {
        double q = nearbyint(value[i] * 65536.0);
        if (!(q >= INT32_MIN)) q = q == q ? INT32_MIN : 0;
        if (q > INT32_MAX) q = INT32_MAX;
        bytes_append_u32(b, (uint32_t)(int32_t)q);
    }
}

static uint64_t align_up(uint64_t offset, uint64_t step)
{
    return (offset + step - 1) / step * step;
}

void ktx2_write(const ktx2_image *k, bytes *out)
{
    const asset_format *format = asset_format_find((uint32_t)k->format);
    const descriptor *d = descriptors;
    while (d < descriptors + sizeof descriptors / sizeof descriptors[0] && d->format != k->format) d++;
    if (!format || d == descriptors + sizeof descriptors / sizeof descriptors[0]) broken("format", k->format, 37);
    if (k->levels < 1 || k->levels > NACRE_MAX_LEVELS) broken("levels", k->levels, NACRE_MAX_LEVELS);
    const int parts = (k->layers ? k->layers : 1) * k->faces;
    for (int i = 0; i < k->levels; i++) {
        const size_t part = asset_part_bytes(format, (uint32_t)k->width, (uint32_t)k->height, (unsigned)i);
        if (k->level[i].size != part * (size_t)parts)
            broken("bytes of a level", (long long)k->level[i].size, (long long)(part * (size_t)parts));
    }

    bytes dfd = {0}, kv = {0};
    append_descriptor(&dfd, d, format, k->srgb);
    append_keys(&kv, k);

    const uint64_t dfd_offset = 80 + 24 * (uint64_t)k->levels, kv_offset = dfd_offset + dfd.size;
    const uint64_t step = format->block_bytes % 4 == 0 ? format->block_bytes
                          : format->block_bytes == 3   ? 12
                                                       : 4; /* lcm(block bytes, 4) */
    uint64_t offset[NACRE_MAX_LEVELS], end = kv_offset + kv.size;
    for (int i = k->levels - 1; i >= 0; i--) {
        offset[i] = align_up(end, step);
        end = offset[i] + k->level[i].size;
    }

    static const uint8_t identifier[12] = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
    const size_t start = out->size;
    bytes_append(out, identifier, sizeof identifier);
    const int head[] = {k->format, format->type_bytes, k->width, k->height, 0, k->layers, k->faces, k->levels, 0};
    for (size_t i = 0; i < sizeof head / sizeof head[0]; i++) bytes_append_u32(out, (uint32_t)head[i]);
    bytes_append_u32(out, (uint32_t)dfd_offset);
    bytes_append_u32(out, (uint32_t)dfd.size);
    bytes_append_u32(out, (uint32_t)kv_offset);
    bytes_append_u32(out, (uint32_t)kv.size);
    append_u64(out, 0); /* no supercompression data */
    append_u64(out, 0);
    for (int i = 0; i < k->levels; i++) {
        append_u64(out, offset[i]);
        append_u64(out, k->level[i].size);
        append_u64(out, k->level[i].size);
    }
    bytes_append(out, dfd.data, dfd.size);
    bytes_append(out, kv.data, kv.size);
    for (int i = k->levels - 1; i >= 0; i--) {
        append_zeros(out, offset[i] - (out->size - start));
        bytes_append(out, k->level[i].data, k->level[i].size);
    }
    bytes_free(&dfd);
    bytes_free(&kv);
}

void ktx2_free(ktx2_image *k)
{
    for (int i = 0; i < NACRE_MAX_LEVELS; i++) bytes_free(&k->level[i]);
    for (int i = 0; i < k->key_count; i++) bytes_free(&k->key[i].value);
    memset(k, 0, sizeof *k);
}

static void read_text(const nacre_image *image, const char *key, char *out, size_t size)
{
    uint32_t length = 0;
    const uint8_t *value = nacre_image_key(image, key, &length);
    snprintf(out, size, "%.*s", value ? (int)length : 0, value ? (const char *)value : "");
}

void ktx2_role(const nacre_image *image, char *out, size_t size)
{
    read_text(image, NACRE_KEY_ROLE, out, size);
}

void ktx2_name(const nacre_image *image, char *out, size_t size)
{
    read_text(image, NACRE_KEY_NAME, out, size);
}
