/* SPDX-License-Identifier: MIT */
/* PNG in and out, against stb_image and stb_image_write, which share no code with libpng. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Before cmocka.h, which makes fail() a macro. */
#include "png_io.h"

#include <cmocka.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include "stb_image.h"
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include "stb_image_write.h"

static char path[64];

static int make_path(void **state)
{
    (void)state;
    strcpy(path, "/tmp/nacre_png.XXXXXX");
    int fd = mkstemp(path);
    return fd < 0 ? -1 : close(fd);
}

static int remove_path(void **state)
{
    (void)state;
    return unlink(path);
}

/* Every code, noise and smooth parts; the same on every run. */
static image_u8 make_picture(int width, int height, int channels)
{
    image_u8 image = image_u8_make(width, height, channels);
    uint32_t seed = 1;
    for (int i = 0; i < width * height * channels; i++) {
        seed = seed * 1664525 + 1013904223;
        image.texel[i] = (uint8_t)(i / channels / width % 2 ? seed >> 24 : (uint32_t)i);
    }
    return image;
}

static void write_picture(const image_u8 *image)
{
    failure f = {0};
    if (png_write(path, image, &f)) fail_msg("%s", f.text);
}

static image_u8 read_picture(int channels)
{
    image_u8 image;
    failure f = {0};
    if (png_read(&image, path, channels, &f)) fail_msg("%s", f.text);
    return image;
}

static bytes read_bytes(void)
{
    bytes b = {0};
    failure f = {0};
    if (file_read(&b, path, &f)) fail_msg("%s", f.text);
    return b;
}

static void write_bytes(const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void assert_same(const image_u8 *image, int width, int height, int channels, const uint8_t *texel)
{
    assert_int_equal(image->width, width);
    assert_int_equal(image->height, height);
    assert_int_equal(image->channels, channels);
    assert_memory_equal(image->texel, texel, (size_t)width * (size_t)height * (size_t)channels);
}

static const int sizes[][2] = {{1, 1}, {3, 7}, {67, 33}, {256, 64}};

static void written_pictures_are_what_stb_reads(void **state)
{
    (void)state;
    for (int channels = 1; channels <= 4; channels++) {
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            image_u8 image = make_picture(sizes[i][0], sizes[i][1], channels);
            write_picture(&image);
            int width = 0, height = 0, found = 0;
            uint8_t *texel = stbi_load(path, &width, &height, &found, 0);
            assert_non_null(texel);
            assert_int_equal(found, channels);
            assert_same(&image, width, height, found, texel);
            stbi_image_free(texel);
            image_u8 again = read_picture(channels);
            assert_same(&image, again.width, again.height, again.channels, again.texel);
            image_u8_free(&again);
            image_u8_free(&image);
        }
    }
}

static void pictures_of_stb_are_read(void **state)
{
    (void)state;
    for (int channels = 1; channels <= 4; channels++) {
        image_u8 image = make_picture(67, 33, channels);
        assert_int_equal(stbi_write_png(path, 67, 33, channels, image.texel, 67 * channels), 1);
        image_u8 read = read_picture(channels);
        assert_same(&image, read.width, read.height, read.channels, read.texel);
        image_u8_free(&read);
        image_u8_free(&image);
    }
}

static void channels_are_converted(void **state)
{
    (void)state;
    static uint8_t grey[2] = {10, 200}, color[4] = {255, 128, 0, 77};
    static const uint8_t from_grey[5][4] = {{0}, {10}, {10, 200}, {10, 10, 10}, {10, 10, 10, 200}};
    /* luma of BT.709: 0.2126 x 255 + 0.7152 x 128 = 145.8 */
    static const uint8_t from_color[5][4] = {{0}, {146}, {146, 77}, {255, 128, 0}, {255, 128, 0, 77}};
    const image_u8 two = {1, 1, 2, grey}, four = {1, 1, 4, color}, three = {1, 1, 3, color};
    for (int channels = 1; channels <= 4; channels++) {
        write_picture(&two);
        image_u8 image = read_picture(channels);
        assert_same(&image, 1, 1, channels, from_grey[channels]);
        image_u8_free(&image);
        write_picture(&four);
        image = read_picture(channels);
        assert_same(&image, 1, 1, channels, from_color[channels]);
        image_u8_free(&image);
    }
    write_picture(&three);
    image_u8 image = read_picture(4);
    assert_int_equal(image.texel[3], 255);
    image_u8_free(&image);
}

/* 2 x 2 pictures made by hand with Python's zlib: a palette with a transparent entry, 1 bit grey, 16 bit grey. */
static void small_and_large_depths_are_read(void **state)
{
    (void)state;
    static const uint8_t palette[] = {
        137, 80, 78,  71,  13,  10,  26,  10,  0,  0,   0,   13,  73, 72, 68,  82,  0,   0,   0,  2,   0,
        0,   0,  2,   2,   3,   0,   0,   0,   15, 216, 229, 183, 0,  0,  0,   9,   80,  76,  84, 69,  255,
        0,   0,  0,   255, 0,   0,   0,   255, 45, 74,  205, 138, 0,  0,  0,   3,   116, 82,  78, 83,  255,
        255, 64, 161, 22,  76,  209, 0,   0,   0,  12,  73,  68,  65, 84, 120, 218, 99,  16,  96, 104, 0,
        0,   0,  180, 0,   145, 62,  247, 11,  31, 0,   0,   0,   0,  73, 69,  78,  68,  174, 66, 96,  130};
    static const uint8_t one_bit[] = {
        137, 80, 78, 71, 13,  10, 26,  10,  0,   0,   0,   13, 73, 72, 68, 82, 0,  0,  0,   2,   0,  0,   0,
        2,   1,  0,  0,  0,   0,  90,  205, 48,  137, 0,   0,  0,  12, 73, 68, 65, 84, 120, 218, 99, 104, 96,
        112, 0,  0,  1,  196, 0,  193, 166, 155, 230, 186, 0,  0,  0,  0,  73, 69, 78, 68,  174, 66, 96,  130};
    static const uint8_t sixteen[] = {
        137, 80, 78, 71, 13, 10,  26,  10,  0,  0, 0,   13,  73, 72, 68, 82, 0,   0,   0,  2,  0,   0,   0,   2,   16,
        0,   0,  0,  0,  7,  77,  142, 187, 0,  0, 0,   17,  73, 68, 65, 84, 120, 218, 99, 96, 96,  248, 255, 159, 161,
        1,   72, 2,  0,  15, 252, 3,   126, 87, 4, 251, 117, 0,  0,  0,  0,  73,  69,  78, 68, 174, 66,  96,  130};
    static const uint8_t palette_texels[] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 64, 255, 0, 0, 255};
    write_bytes(palette, sizeof palette);
    image_u8 image = read_picture(4);
    assert_same(&image, 2, 2, 4, palette_texels);
    image_u8_free(&image);
    write_bytes(one_bit, sizeof one_bit);
    image = read_picture(1);
    assert_same(&image, 2, 2, 1, (const uint8_t[]){255, 0, 0, 255});
    image_u8_free(&image);
    write_bytes(sixteen, sizeof sixteen);
    image = read_picture(1);
    /* nearest of code / 257 for 0, 65535, 0x8000 (127.5 at 0x7fff.8), 0x00ff (0.99) */
    assert_same(&image, 2, 2, 1, (const uint8_t[]){0, 255, 128, 1});
    image_u8_free(&image);
}

static uint32_t u32_big(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* The same picture gives the same bytes: IHDR, sRGB (perceptual), IDAT..., IEND, and no time, text or gamma. */
static void bytes_are_deterministic(void **state)
{
    (void)state;
    image_u8 image = make_picture(256, 64, 4);
    write_picture(&image);
    bytes a = read_bytes();
    write_picture(&image);
    bytes b = read_bytes();
    assert_int_equal(a.size, b.size);
    assert_memory_equal(a.data, b.data, a.size);
    assert_memory_equal(a.data + 8 + 4, "IHDR", 4);
    assert_memory_equal(a.data + 33, "\0\0\0\1sRGB\0", 9);
    size_t at = 46;
    while (at + 12 <= a.size && !memcmp(a.data + at + 4, "IDAT", 4)) at += 12 + u32_big(a.data + at);
    assert_memory_equal(a.data + at, "\0\0\0\0IEND", 8);
    assert_int_equal(at + 12, a.size);
    bytes_free(&a);
    bytes_free(&b);
    image_u8_free(&image);
}

static void assert_read_fails(const char *name, int code, const char *word)
{
    image_u8 image = {5, 6, 7, NULL};
    failure f = {0};
    int got = png_read(&image, name, 3, &f);
    if (got != code || f.code != code || !strstr(f.text, name) || !strstr(f.text, word) || strchr(f.text, '\n'))
        fail_msg("found code %d \"%s\", expected code %d and %s", got, f.text, code, word);
    assert_true(image.width == 5 && image.height == 6 && image.channels == 7 && !image.texel);
}

static void every_truncation_fails(void **state)
{
    (void)state;
    image_u8 image = make_picture(9, 5, 3);
    write_picture(&image);
    bytes whole = read_bytes();
    assert_read_fails("/nonexistent/a.png", FAIL_IO, strerror(ENOENT));
    for (size_t size = 0; size < whole.size; size++) {
        write_bytes(whole.data, size);
        assert_read_fails(path, FAIL_INVALID, size < 8 ? "signature" : "ends too early");
    }
    bytes_free(&whole);
    image_u8_free(&image);
}

/* A changed byte is found by a chunk's check sum (or is in a chunk that need not be understood: then the texels are
   as they were). */
static void every_changed_byte_is_harmless(void **state)
{
    (void)state;
    image_u8 image = make_picture(9, 5, 3);
    write_picture(&image);
    bytes whole = read_bytes();
    int refused = 0;
    for (size_t at = 0; at < whole.size; at++) {
        whole.data[at] ^= 0x55;
        write_bytes(whole.data, whole.size);
        image_u8 read = {0};
        failure f = {0};
        int code = png_read(&read, path, 3, &f);
        if (code) {
            refused++;
            assert_int_equal(code, FAIL_INVALID);
            assert_null(strchr(f.text, '\n'));
        } else {
            assert_same(&image, read.width, read.height, read.channels, read.texel);
            image_u8_free(&read);
        }
        whole.data[at] ^= 0x55;
    }
    assert_true(refused >= (int)whole.size - 13); /* all but the 13 bytes of sRGB */
    bytes_free(&whole);
    image_u8_free(&image);
}

/* A header that promises 65,537 x 1: refused before memory is asked for. */
static void huge_pictures_are_refused(void **state)
{
    (void)state;
    static const uint8_t wide[] = {137, 80,  78,  71, 13, 10, 26, 10,  0,   0,  0,  13,  73,  72,  68,  82, 0,
                                   1,   0,   1,   0,  0,  0,  1,  8,   0,   0,  0,  0,   161, 219, 215, 58, 0,
                                   0,   0,   9,   73, 68, 65, 84, 120, 218, 99, 0,  0,   0,   1,   0,   1,  177,
                                   13,  182, 147, 0,  0,  0,  0,  73,  69,  78, 68, 174, 66,  96,  130};
    static const uint8_t large[] = {137, 80,  78,  71, 13, 10, 26, 10,  0,   0,  0,  13,  73, 72,  68,  82, 0,
                                    1,   0,   0,   0,  1,  0,  0,  8,   0,   0,  0,  0,   73, 239, 111, 63, 0,
                                    0,   0,   9,   73, 68, 65, 84, 120, 218, 99, 0,  0,   0,  1,   0,   1,  177,
                                    13,  182, 147, 0,  0,  0,  0,  73,  69,  78, 68, 174, 66, 96,  130};
    write_bytes(wide, sizeof wide);
    assert_read_fails(path, FAIL_INVALID, "broken PNG");
    write_bytes(large, sizeof large);
    assert_read_fails(path, FAIL_INVALID, "more than 2^28 texels");
}

static void what_is_not_written(void **state)
{
    (void)state;
    uint8_t texel[5] = {0};
    failure f = {0};
    const image_u8 five = {1, 1, 5, texel}, empty = {0, 1, 1, texel}, good = {1, 1, 1, texel};
    assert_int_equal(png_write(path, &five, &f), FAIL_INTERNAL);
    assert_non_null(strstr(f.text, "5 channels"));
    assert_int_equal(png_write(path, &empty, &f), FAIL_INTERNAL);
    assert_int_equal(png_write("/nonexistent/a.png", &good, &f), FAIL_IO);
    assert_non_null(strstr(f.text, "/nonexistent/a.png"));
    image_u8 image;
    assert_int_equal(png_read(&image, path, 0, &f), FAIL_INTERNAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(written_pictures_are_what_stb_reads),
        cmocka_unit_test(pictures_of_stb_are_read),
        cmocka_unit_test(channels_are_converted),
        cmocka_unit_test(small_and_large_depths_are_read),
        cmocka_unit_test(bytes_are_deterministic),
        cmocka_unit_test(every_truncation_fails),
        cmocka_unit_test(every_changed_byte_is_harmless),
        cmocka_unit_test(huge_pictures_are_refused),
        cmocka_unit_test(what_is_not_written),
    };
    return cmocka_run_group_tests(tests, make_path, remove_path);
}
