/* SPDX-License-Identifier: MIT */
/*
 * Each frame is compressed by libpng as a picture of its own. The first one's chunks are taken as they are, with acTL and
 * fcTL put before its IDAT; of the others only the IDAT data is taken, as fdAT. A frame after the first holds the least
 * rectangle outside which it equals the one before.
 */
#include "apng.h"

#include <stdlib.h>
#include <string.h>

#include "png_io.h"

typedef struct rectangle {
    int x, y, width, height;
} rectangle;

typedef struct animation {
    bytes out;
    uint32_t sequence; /* numbers fcTL and fdAT chunks */
    int per_second;
} animation;

static void put_u32(uint8_t *to, uint32_t x)
{
    for (int i = 0; i < 4; i++) to[i] = (uint8_t)(x >> (24 - 8 * i));
}

static uint32_t get_u32(const uint8_t *from)
{
    return (uint32_t)from[0] << 24 | (uint32_t)from[1] << 16 | (uint32_t)from[2] << 8 | from[3];
}

/* CRC-32 of the PNG specification, annex D: polynomial 0xEDB88320, bits reversed. */
static uint32_t crc(uint32_t c, const uint8_t *data, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        c ^= data[i];
        for (int bit = 0; bit < 8; bit++) c = c & 1 ? 0xEDB88320u ^ c >> 1 : c >> 1;
    }
    return c;
}

/* length, name, head and data together, CRC */
static void put_chunk(bytes *out, const char *name, const uint8_t *head, size_t head_size, const uint8_t *data,
                      size_t size)
{
    uint8_t word[4];
    uint32_t c = crc(0xFFFFFFFFu, (const uint8_t *)name, 4);

    c = crc(crc(c, head, head_size), data, size);
    put_u32(word, (uint32_t)(head_size + size));
    bytes_append(out, word, 4);
    bytes_append(out, name, 4);
    bytes_append(out, head, head_size);
    bytes_append(out, data, size);
    put_u32(word, ~c);
    bytes_append(out, word, 4);
}

static void put_frame_control(animation *a, const rectangle *r)
{
    uint8_t data[26] = {0};

    put_u32(data, a->sequence++);
    put_u32(data + 4, (uint32_t)r->width);
    put_u32(data + 8, (uint32_t)r->height);
    put_u32(data + 12, (uint32_t)r->x);
    put_u32(data + 16, (uint32_t)r->y);
    data[21] = 1; /* a delay of 1 / per_second */
    data[23] = (uint8_t)a->per_second;
    /* dispose: none; blend: source */
    put_chunk(&a->out, "fcTL", NULL, 0, data, sizeof data);
}

static void put_count(animation *a, int count)
{
    uint8_t data[8] = {0}; /* plays: 0, for ever */

    put_u32(data, (uint32_t)count);
    put_chunk(&a->out, "acTL", NULL, 0, data, sizeof data);
}

/* The picture's chunks into the animation: all but IEND for the first, IDAT as fdAT for others. */
static void take_chunks(animation *a, const bytes *png, const rectangle *r, int index, int count)
{
    int begun = 0;

    for (size_t at = 8; at + 12 <= png->size; at += 12 + get_u32(png->data + at)) {
        const uint8_t *chunk = png->data + at, *data = chunk + 8;
        const size_t size = get_u32(chunk);
        const int is_data = !memcmp(chunk + 4, "IDAT", 4);
        uint8_t number[4];
        if (is_data && !begun) {
            begun = 1;
            if (!index) put_count(a, count);
            put_frame_control(a, r);
        }
        if (!index && memcmp(chunk + 4, "IEND", 4)) {
            bytes_append(&a->out, chunk, 12 + size);
        } else if (is_data) {
            put_u32(number, a->sequence++);
            put_chunk(&a->out, "fdAT", number, sizeof number, data, size);
        }
    }
}

static const uint8_t *texel_at(const image_u8 *image, int x, int y)
{
    return image->texel + ((size_t)y * (size_t)image->width + (size_t)x) * (size_t)image->channels;
}

/* Never empty: two equal frames differ in the first texel. */
static rectangle changed(const image_u8 *before, const image_u8 *now)
{
    rectangle r = {0, 0, 1, 1};
    int x0 = now->width, y0 = now->height, x1 = 0, y1 = 0;

    for (int y = 0; y < now->height; y++)
        for (int x = 0; x < now->width; x++) {
            if (!memcmp(texel_at(before, x, y), texel_at(now, x, y), (size_t)now->channels)) continue;
            if (x < x0) x0 = x;
            if (y < y0) y0 = y;
            if (x + 1 > x1) x1 = x + 1;
            if (y + 1 > y1) y1 = y + 1;
        }
    if (x0 < x1) r = (rectangle){x0, y0, x1 - x0, y1 - y0};
    return r;
}

static image_u8 cut_out(const image_u8 *from, const rectangle *r)
{
    image_u8 out = image_u8_make(r->width, r->height, from->channels);
    const size_t pitch = (size_t)r->width * (size_t)from->channels;

    for (int y = 0; y < r->height; y++) memcpy(out.texel + (size_t)y * pitch, texel_at(from, r->x, r->y + y), pitch);
    return out;
}

static int put_frame(animation *a, const image_u8 *frames, int index, int count, const char *path, failure *f)
{
    const image_u8 *now = &frames[index];
    rectangle r = {0, 0, now->width, now->height};
    bytes png = {0};

    if (index) r = changed(&frames[index - 1], now);
    image_u8 part = cut_out(now, &r);
    int code = png_encode(&png, &part, path, f);
    if (!code) take_chunks(a, &png, &r, index, count);
    image_u8_free(&part);
    bytes_free(&png);
    return code;
}

int apng_write(const char *path, const image_u8 *frames, int count, int per_second, failure *f)
{
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    animation a = {.per_second = per_second};
    int code = FAIL_NONE;

    if (count < 1 || per_second < 1 || per_second > 255)
        return fail(f, FAIL_INTERNAL, "%s: %d frames, %d a second", path, count, per_second);
    for (int i = 1; i < count; i++)
        if (frames[i].width != frames->width || frames[i].height != frames->height ||
            frames[i].channels != frames->channels)
            return fail(f, FAIL_INTERNAL, "%s: frame %d has another size than the first", path, i);
    bytes_append(&a.out, signature, sizeof signature);
    for (int i = 0; i < count && !code; i++) code = put_frame(&a, frames, i, count, path, f);
    put_chunk(&a.out, "IEND", NULL, 0, NULL, 0);
    if (!code) code = output_write_raw(path, &a.out, f);
    bytes_free(&a.out);
    return code;
}
