/* SPDX-License-Identifier: MIT */
/* Animated PNGs, taken apart chunk by chunk: each frame, put together as a picture of its own, is what stb_image, which
   shares no code with libpng, must decode to what went in. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* before cmocka.h, which defines a macro fail() */
#include "apng.h"
#include "png_io.h"

#include <cmocka.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include "stb_image.h"

enum { WIDTH = 37, HEIGHT = 21, FRAMES = 7 };

static char path[64];

static int make_path(void **state)
{
    (void)state;
    strcpy(path, "/tmp/nacre-apng-XXXXXX");
    int fd = mkstemp(path);
    return fd < 0 || close(fd);
}

static int remove_path(void **state)
{
    (void)state;
    return unlink(path);
}

/* A ball that moves over a pattern that stays; frames 3 and 4 are equal. */
static image_u8 make_frame(int index, int channels)
{
    image_u8 out = image_u8_make(WIDTH, HEIGHT, channels);
    const int at = index == 4 ? 3 : index;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const int dx = x - 5 - 4 * at, dy = y - 10, inside = dx * dx + dy * dy < 20;
            for (int c = 0; c < channels; c++)
                out.texel[(y * WIDTH + x) * channels + c] = (uint8_t)(inside ? 40 * c + 13 * dx : x * y + 50 * c);
        }
    return out;
}

static uint32_t u32(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* By long division, bit by bit from the highest power: another way than the writer's. */
static uint32_t crc(const uint8_t *data, size_t size)
{
    uint32_t rest = 0;
    for (size_t i = 0; i < 8 * size + 32; i++) {
        uint32_t bit = i < 8 * size ? data[i / 8] >> (i % 8) & 1u : 0, out = rest >> 31;
        if (i < 32) bit ^= 1; /* the first 32 bits and the result are inverted */
        rest = rest << 1 | bit;
        if (out) rest ^= 0x04C11DB7u;
    }
    uint32_t turned = 0;
    for (int i = 0; i < 32; i++) turned |= (rest >> i & 1u) << (31 - i);
    return ~turned;
}

static void append_chunk(bytes *out, const char *name, const uint8_t *data, size_t size)
{
    const uint8_t length[4] = {(uint8_t)(size >> 24), (uint8_t)(size >> 16), (uint8_t)(size >> 8), (uint8_t)size};
    const uint8_t sum[4] = {0}; /* stb does not look at it */
    bytes_append(out, length, 4);
    bytes_append(out, name, 4);
    bytes_append(out, data, size);
    bytes_append(out, sum, 4);
}

typedef struct player { /* what a viewer keeps */
    bytes data;         /* compressed, of the frame under way */
    uint8_t control[26], header[13];
    uint8_t canvas[WIDTH * HEIGHT * 4];
    int channels, shown, sequence;
    image_u8 *truth;
} player;

static void show(player *p)
{
    bytes png = {0};
    uint8_t header[13];
    int width, height, channels;
    if (!p->data.size) return;
    memcpy(header, p->header, 13);
    memcpy(header, p->control + 4, 8);
    bytes_append(&png, "\x89PNG\r\n\x1a\n", 8);
    append_chunk(&png, "IHDR", header, 13);
    append_chunk(&png, "IDAT", p->data.data, p->data.size);
    append_chunk(&png, "IEND", NULL, 0);
    uint8_t *texels = stbi_load_from_memory(png.data, (int)png.size, &width, &height, &channels, 0);
    assert_non_null(texels);
    assert_int_equal(channels, p->channels);
    assert_int_equal(width, u32(p->control + 4));
    assert_int_equal(height, u32(p->control + 8));
    const int x = (int)u32(p->control + 12), y = (int)u32(p->control + 16);
    assert_true(x >= 0 && x + width <= WIDTH && y >= 0 && y + height <= HEIGHT);
    for (int row = 0; row < height; row++)
        memcpy(p->canvas + ((y + row) * WIDTH + x) * channels, texels + row * width * channels,
               (size_t)(width * channels));
    assert_memory_equal(p->canvas, p->truth[p->shown].texel, (size_t)(WIDTH * HEIGHT * channels));
    p->shown++;
    stbi_image_free(texels);
    bytes_free(&png);
    p->data.size = 0;
}

static void take_chunk(player *p, const char *name, const uint8_t *data, size_t size)
{
    if (!strcmp(name, "IHDR")) memcpy(p->header, data, 13);
    if (!strcmp(name, "acTL")) {
        assert_int_equal(p->shown + (int)p->data.size, 0); /* before IDAT */
        assert_int_equal(u32(data), FRAMES);
        assert_int_equal(u32(data + 4), 0);
    }
    if (!strcmp(name, "fcTL") || !strcmp(name, "fdAT")) assert_int_equal(u32(data), p->sequence++);
    if (!strcmp(name, "fcTL")) {
        show(p);
        assert_int_equal(size, 26);
        memcpy(p->control, data, 26);
        assert_int_equal(data[20] << 8 | data[21], 1);
        assert_int_equal(data[22] << 8 | data[23], 25);
        assert_int_equal(data[24] | data[25], 0);
    }
    if (!strcmp(name, "IDAT")) bytes_append(&p->data, data, size);
    if (!strcmp(name, "fdAT")) bytes_append(&p->data, data + 4, size - 4);
    if (!strcmp(name, "IEND")) show(p);
}

static void frames_come_out_as_they_went_in(void **state)
{
    (void)state;
    for (int channels = 1; channels <= 4; channels++) {
        image_u8 frames[FRAMES];
        bytes file;
        failure f = {0};
        player p = {.channels = channels, .truth = frames};
        for (int i = 0; i < FRAMES; i++) frames[i] = make_frame(i, channels);
        if (apng_write(path, frames, FRAMES, 25, &f) || file_read(&file, path, &f)) fail_msg("%s", f.text);
        assert_memory_equal(file.data, "\x89PNG\r\n\x1a\n", 8);
        size_t at = 8;
        while (at < file.size) {
            char name[5] = {0};
            assert_true(file.size - at >= 12);
            const size_t size = u32(file.data + at);
            assert_true(file.size - at >= 12 + size);
            memcpy(name, file.data + at + 4, 4);
            assert_int_equal(crc(file.data + at + 4, size + 4), u32(file.data + at + 8 + size));
            take_chunk(&p, name, file.data + at + 8, size);
            at += 12 + size;
        }
        assert_int_equal(p.shown, FRAMES);
        bytes_free(&p.data);
        bytes_free(&file);
        for (int i = 0; i < FRAMES; i++) image_u8_free(&frames[i]);
    }
}

static void a_program_without_animation_shows_the_first_frame(void **state)
{
    (void)state;
    image_u8 frames[2] = {make_frame(0, 4), make_frame(1, 4)}, read;
    failure f = {0};
    if (apng_write(path, frames, 2, 10, &f) || png_read(&read, path, 4, &f)) fail_msg("%s", f.text);
    assert_memory_equal(read.texel, frames[0].texel, WIDTH * HEIGHT * 4);
    image_u8_free(&read);
    for (int i = 0; i < 2; i++) image_u8_free(&frames[i]);
}

static void mistakes_are_refused(void **state)
{
    (void)state;
    image_u8 frames[2] = {make_frame(0, 3), make_frame(1, 4)};
    assert_int_equal(apng_write(path, frames, 0, 10, NULL), FAIL_INTERNAL);
    assert_int_equal(apng_write(path, frames, 1, 0, NULL), FAIL_INTERNAL);
    assert_int_equal(apng_write(path, frames, 2, 10, NULL), FAIL_INTERNAL);
    assert_int_equal(apng_write("/nonexistent/a.png", frames, 1, 10, NULL), FAIL_IO);
    for (int i = 0; i < 2; i++) image_u8_free(&frames[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_out_as_they_went_in),
        cmocka_unit_test(a_program_without_animation_shows_the_first_frame),
        cmocka_unit_test(mistakes_are_refused),
    };
    return cmocka_run_group_tests(tests, make_path, remove_path);
}
