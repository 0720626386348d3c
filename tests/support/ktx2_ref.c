/* SPDX-License-Identifier: MIT */
#include "ktx2_ref.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Sections in brackets are those of the KTX 2.0 specification. */

typedef struct cursor {
    const uint8_t *bytes;
    size_t size;
    char *why;
    size_t why_size;
} cursor;

__attribute__((format(printf, 2, 3))) static int no(const cursor *c, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(c->why, c->why_size, format, args);
    va_end(args);
    return 0;
}

/* Little-endian number of n bytes; the caller has checked the range. */
static uint64_t number(const uint8_t *p, int n)
{
    uint64_t value = 0;
    for (int i = n - 1; i >= 0; i--) value = value * 256 + p[i];
    return value;
}

/* What the descriptor of a format must say. Channels: letter, first bit, bits; e is the shared exponent. */
typedef struct layout {
    uint32_t vk_format, type_size, block_width, block_bytes, model;
    const char *samples; /* "R0:8 G8:8" in the order of the lowest bit */
    int is_float;
} layout;

static const layout layouts[] = {
    {4, 2, 1, 2, 1, "B0:5 G5:6 R11:5", 0},                     /* VK_FORMAT_R5G6B5_UNORM_PACK16 */
    {9, 1, 1, 1, 1, "R0:8", 0},                                /* VK_FORMAT_R8_UNORM */
    {16, 1, 1, 2, 1, "R0:8 G8:8", 0},                          /* VK_FORMAT_R8G8_UNORM */
    {23, 1, 1, 3, 1, "R0:8 G8:8 B16:8", 0},                    /* VK_FORMAT_R8G8B8_UNORM */
    {37, 1, 1, 4, 1, "R0:8 G8:8 B16:8 A24:8", 0},              /* VK_FORMAT_R8G8B8A8_UNORM */
    {97, 2, 1, 8, 1, "R0:16 G16:16 B32:16 A48:16", 1},         /* VK_FORMAT_R16G16B16A16_SFLOAT */
    {123, 4, 1, 4, 1, "R0:9 r27:5 G9:9 g27:5 B18:9 b27:5", 0}, /* VK_FORMAT_E5B9G9R9_UFLOAT_PACK32 */
    {147, 1, 4, 8, 161, "C0:64", 0},                           /* VK_FORMAT_ETC2_R8G8B8_UNORM_BLOCK */
};

static const layout *layout_of(uint32_t vk_format)
{
    for (size_t i = 0; i < sizeof layouts / sizeof layouts[0]; i++)
        if (layouts[i].vk_format == vk_format) return &layouts[i];
    return NULL;
}

static uint32_t channel_of(char letter)
{
    switch (letter) {
    case 'R':
        return 0;
    case 'G':
        return 1;
    case 'B':
        return 2;
    case 'C':
        return 2; /* KHR_DF_CHANNEL_ETC2_COLOR */
    case 'A':
        return 15;
    case 'r':
        return 0x20; /* with KHR_DF_SAMPLE_DATATYPE_EXPONENT */
    case 'g':
        return 0x21;
    case 'b':
        return 0x22;
    }
    return 99;
}

static int check_sample(const cursor *c, const layout *l, const uint8_t *p, char letter, uint32_t bit, uint32_t bits,
                        int srgb)
{
    uint32_t channel = channel_of(letter), lower = 0, upper = bits == 64 ? 0xFFFFFFFFu : (1u << bits) - 1;
    if (l->is_float) {
        channel |= 0xC0; /* float, signed */
        lower = 0xBF800000u;
        upper = 0x3F800000u;
    }
    if (l->vk_format == 123) { /* limits of the 9-9-9-5 example in the Data Format Specification */
        lower = channel & 0x20 ? 15 : 0;
        upper = channel & 0x20 ? 31 : 8448;
    }
    if (srgb && letter == 'A') channel |= 0x10; /* alpha is linear in sRGB images */
    if (number(p, 2) != bit || p[2] != bits - 1)
        return no(c, "dfd: sample %c: bits %u+%u", letter, (unsigned)number(p, 2), p[2] + 1u);
    if (p[3] != channel) return no(c, "dfd: sample %c: channel 0x%02x, expected 0x%02x", letter, p[3], channel);
    if (number(p + 4, 4)) return no(c, "dfd: sample %c: position is not 0", letter);
    if (number(p + 8, 4) != lower || number(p + 12, 4) != upper)
        return no(c, "dfd: sample %c: limits %llu..%llu", letter, (unsigned long long)number(p + 8, 4),
                  (unsigned long long)number(p + 12, 4));
    return 1;
}

/* [Data Format Descriptor] */
static int check_dfd(const cursor *c, const layout *l, const uint8_t *p, uint64_t size, uint32_t *transfer)
{
    int samples = 1;
    for (const char *s = l->samples; *s; s++) samples += *s == ' ';
    const uint64_t block = 24 + 16 * (uint64_t)samples;
    if (size != 4 + block || number(p, 4) != size)
        return no(c, "dfd: %llu bytes, expected %llu", (unsigned long long)size, (unsigned long long)(4 + block));
    if (number(p + 4, 4)) return no(c, "dfd: vendor or type is not 0");
    if (number(p + 8, 2) != 2 || number(p + 10, 2) != block) return no(c, "dfd: version or block size");
    if (p[12] != l->model) return no(c, "dfd: colour model %u, expected %u", p[12], l->model);
    if (p[13] != 1) return no(c, "dfd: primaries %u, expected 1 (BT.709)", p[13]);
    if (p[14] != 1 && p[14] != 2) return no(c, "dfd: transfer function %u", p[14]);
    if (p[15]) return no(c, "dfd: flags %u, expected 0 (straight alpha)", p[15]);
    for (int i = 0; i < 4; i++)
        if (p[16 + i] != (i < 2 ? l->block_width - 1 : 0)) return no(c, "dfd: block dimension %d is %u", i, p[16 + i]);
    for (int i = 0; i < 8; i++)
        if (p[20 + i] != (i ? 0 : l->block_bytes)) return no(c, "dfd: bytes of plane %d are %u", i, p[20 + i]);
    *transfer = p[14];
    const char *s = l->samples;
    for (int i = 0; i < samples; i++) {
        char letter;
        unsigned bit, bits;
        int used = 0;
        if (sscanf(s, " %c%u:%u%n", &letter, &bit, &bits, &used) != 3) return no(c, "dfd: bad layout text");
        s += used;
        if (!check_sample(c, l, p + 28 + 16 * i, letter, bit, bits, *transfer == 2)) return 0;
    }
    return 1;
}

/* Keys of nacre whose value is a number. */
static int has_number(const char *name)
{
    static const char *const texts[] = {"nacre.role", "nacre.transfer", "nacre.name"};
    if (strncmp(name, "nacre.", 6)) return 0;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (!strcmp(name, texts[i])) return 0;
    return 1;
}

/* [Key/Value Data] */
static int check_keys(ktx2_ref *out, const cursor *c, size_t begin, size_t size)
{
    const char *last = "";
    for (size_t at = begin; at < begin + size;) {
        if (begin + size - at < 4) return no(c, "keys: %zu bytes left", begin + size - at);
        const uint64_t length = number(c->bytes + at, 4);
        if (length < 2 || length > begin + size - at - 4)
            return no(c, "keys: entry of %llu bytes at %zu", (unsigned long long)length, at);
        const char *name = (const char *)c->bytes + at + 4;
        const char *nul = memchr(name, 0, (size_t)length);
        if (!nul || nul == name) return no(c, "keys: no name at %zu", at);
        if (strcmp(last, name) >= 0) return no(c, "keys: \"%s\" after \"%s\"", name, last);
        if (!strncmp(name, "ktx", 3)) return no(c, "keys: \"%s\" is reserved", name);
        if (!strncmp(name, "KTX", 3) && strcmp(name, "KTXorientation") && strcmp(name, "KTXwriter"))
            return no(c, "keys: \"%s\" is reserved or unexpected", name);
        const size_t name_size = (size_t)(nul - name) + 1;
        if (has_number(name) && name_size % 4)
            return no(c, "keys: name \"%s\" and NUL are %zu bytes: the number is not aligned", name, name_size);
        if (out->key_count == 64) return no(c, "keys: more than 64");
        out->key[out->key_count].name = name;
        out->key[out->key_count].value = (const uint8_t *)name + name_size;
        out->key[out->key_count].size = (size_t)length - name_size;
        out->key_count++;
        last = name;
        at += 4 + (size_t)length;
        for (; at % 4; at++) {
            if (at >= begin + size) return no(c, "keys: padding beyond the end");
            if (c->bytes[at]) return no(c, "keys: padding byte %zu is not 0", at);
        }
    }
    size_t value_size;
    const uint8_t *value = ktx2_ref_key(out, "KTXorientation", &value_size);
    if (value && (value_size != 3 || memcmp(value, "rd", 3))) return no(c, "keys: KTXorientation is not \"rd\"");
    return 1;
}

static uint64_t greatest_divisor(uint64_t a, uint64_t b)
{
    return b ? greatest_divisor(b, a % b) : a;
}

/* [Level Index], [mipPadding] */
static int check_levels(ktx2_ref *out, const cursor *c, const layout *l, uint64_t begin)
{
    const uint64_t alignment = l->block_bytes / greatest_divisor(l->block_bytes, 4) * 4;
    const uint64_t images = (uint64_t)(out->layer_count ? out->layer_count : 1) * out->face_count;
    uint64_t at = begin;
    for (int i = (int)out->level_count - 1; i >= 0; i--) {
        const uint8_t *index = c->bytes + 80 + 24 * i;
        const uint64_t offset = number(index, 8), length = number(index + 8, 8);
        const uint64_t w = out->width >> i ? out->width >> i : 1, h = out->height >> i ? out->height >> i : 1;
        const uint64_t across = (w + l->block_width - 1) / l->block_width,
                       down = (h + l->block_width - 1) / l->block_width;
        if (length != across * down * l->block_bytes * images || number(index + 16, 8) != length)
            return no(c, "level %d: %llu bytes", i, (unsigned long long)length);
        if (offset % alignment || offset < at || offset - at >= alignment)
            return no(c, "level %d: offset %llu after %llu", i, (unsigned long long)offset, (unsigned long long)at);
        if (offset > c->size || length > c->size - offset) return no(c, "level %d: beyond the end", i);
        for (; at < offset; at++)
            if (c->bytes[at]) return no(c, "level %d: padding byte %llu is not 0", i, (unsigned long long)at);
        at = offset + length;
        out->level_offset[i] = offset;
        out->level_length[i] = length;
    }
    if (at != c->size) return no(c, "%llu bytes after the last level", (unsigned long long)(c->size - at));
    return 1;
}

int ktx2_ref_read(ktx2_ref *out, const uint8_t *bytes, size_t size, char *why, size_t why_size)
{
    static const uint8_t magic[] = "\xABKTX 20\xBB\r\n\x1A\n";
    const cursor c = {bytes, size, why, why_size};
    memset(out, 0, sizeof *out);
    out->bytes = bytes;
    out->size = size;
    if (size < 80) return no(&c, "%zu bytes, shorter than a header", size);
    if (memcmp(bytes, magic, 12)) return no(&c, "not a KTX2 identifier");
    uint32_t *const field[] = {&out->vk_format, &out->type_size, &out->width, &out->height};
    for (int i = 0; i < 4; i++) *field[i] = (uint32_t)number(bytes + 12 + 4 * i, 4);
    if (number(bytes + 28, 4)) return no(&c, "pixelDepth is not 0");
    out->layer_count = (uint32_t)number(bytes + 32, 4);
    out->face_count = (uint32_t)number(bytes + 36, 4);
    out->level_count = (uint32_t)number(bytes + 40, 4);
    if (number(bytes + 44, 4)) return no(&c, "supercompressed");
    const layout *l = layout_of(out->vk_format);
    if (!l) return no(&c, "format %u", out->vk_format);
    out->block_width = l->block_width;
    out->block_bytes = l->block_bytes;
    if (out->type_size != l->type_size) return no(&c, "typeSize %u, expected %u", out->type_size, l->type_size);
    if (!out->width || !out->height) return no(&c, "size %ux%u", out->width, out->height);
    if (out->face_count != 1 && out->face_count != 6) return no(&c, "faceCount %u", out->face_count);
    if (out->face_count == 6 && out->width != out->height) return no(&c, "cube of %ux%u", out->width, out->height);
    const uint32_t longest = out->width > out->height ? out->width : out->height;
    uint32_t most = 1;
    while (most < 32 && longest >> most) most++;
    if (!out->level_count || out->level_count > most)
        return no(&c, "levelCount %u, at most %u", out->level_count, most);

    const uint64_t dfd = number(bytes + 48, 4), dfd_size = number(bytes + 52, 4);
    const uint64_t kvd = number(bytes + 56, 4), kvd_size = number(bytes + 60, 4);
    if (number(bytes + 64, 8) || number(bytes + 72, 8)) return no(&c, "supercompression data without supercompression");
    if (dfd != 80 + 24 * (uint64_t)out->level_count) return no(&c, "dfdByteOffset %llu", (unsigned long long)dfd);
    if (dfd + dfd_size > size) return no(&c, "dfd: beyond the end");
    if (!check_dfd(&c, l, bytes + dfd, dfd_size, &out->transfer)) return 0;
    if (kvd != (kvd_size ? dfd + dfd_size : 0)) return no(&c, "kvdByteOffset %llu", (unsigned long long)kvd);
    if (kvd + kvd_size > size) return no(&c, "keys: beyond the end");
    if (kvd_size && !check_keys(out, &c, (size_t)kvd, (size_t)kvd_size)) return 0;
    return check_levels(out, &c, l, dfd + dfd_size + kvd_size);
}

const uint8_t *ktx2_ref_part(const ktx2_ref *ref, unsigned level, unsigned layer, unsigned face, size_t *size)
{
    const uint32_t layers = ref->layer_count ? ref->layer_count : 1;
    if (level >= ref->level_count || layer >= layers || face >= ref->face_count) return NULL;
    *size = (size_t)(ref->level_length[level] / layers / ref->face_count);
    return ref->bytes + ref->level_offset[level] + *size * (layer * (size_t)ref->face_count + face);
}

const uint8_t *ktx2_ref_key(const ktx2_ref *ref, const char *name, size_t *size)
{
    for (int i = 0; i < ref->key_count; i++) {
        if (strcmp(ref->key[i].name, name)) continue;
        *size = ref->key[i].size;
        return ref->key[i].value;
    }
    return NULL;
}
