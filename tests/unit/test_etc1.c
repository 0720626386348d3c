/* SPDX-License-Identifier: MIT */
/* ETC1: blocks written out by hand, Debian's etc1tool as independent decoder and as a bar for the encoder's quality. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* before cmocka.h, which defines a macro fail() */
#include "etc1.h"
#include "output.h"
#include "pixels.h"
#include "png_io.h"

#include <cmocka.h>

static char directory[] = "/tmp/test_etc1.XXXXXX";
static int have_tool;

static uint32_t random_next(uint32_t *state)
{
    return *state = *state * 1664525u + 1013904223u;
}

static double psnr(const image_u8 *a, const image_u8 *b)
{
    size_t count = (size_t)a->width * (size_t)a->height * 3;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double d = (double)a->texel[i] - (double)b->texel[i];
        sum += d * d;
    }
    return sum > 0 ? 10 * log10(255 * 255 * (double)count / sum) : 99;
}

/* A lit ball with a small highlight and a slight tint, as sphere images are. */
static image_u8 ball(int width, int height)
{
    image_u8 image = image_u8_make(width, height, 3);
    for (int j = 0; j < height; j++)
        for (int i = 0; i < width; i++) {
            double x = (2.0 * i + 1) / width - 1, y = (2.0 * j + 1) / height - 1, r2 = x * x + y * y;
            double z = r2 < 1 ? sqrt(1 - r2) : 0, cosine = fmax(0.6 * x + 0.8 * z, 0);
            double peak = exp(-40 * ((x - 0.3) * (x - 0.3) + y * y));
            const double tint[3] = {0.8, 0.5, 0.3};
            for (int c = 0; c < 3; c++)
                image.texel[3 * (j * width + i) + c] = unorm8(sqrt(sqrt(0.6 * tint[c] * cosine + 0.4 * peak)));
        }
    return image;
}

static image_u8 coded(const image_u8 *image)
{
    uint8_t *blocks = need_memory(etc1_size(image->width, image->height), 1);
    image_u8 out = image_u8_make(image->width, image->height, 3);
    etc1_encode(image->texel, image->width, image->height, blocks);
    for (size_t i = 0; i < etc1_size(image->width, image->height); i += 8) assert_true(etc1_block_valid(blocks + i));
    etc1_decode(blocks, image->width, image->height, out.texel);
    free(blocks);
    return out;
}

static void block_by_hand(const uint8_t block[8], const int expected[4][4][3]) /* [y][x] */
{
    uint8_t rgb[48];
    etc1_decode(block, 4, 4, rgb);
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 4; x++)
            for (int c = 0; c < 3; c++)
                if (rgb[3 * (4 * y + x) + c] != expected[y][x][c])
                    fail_msg("texel (%d, %d) channel %d: found %d, expected %d", x, y, c, rgb[3 * (4 * y + x) + c],
                             expected[y][x][c]);
}

/* Texels are numbered down the columns; index = 2 high bit + low bit: +small, +large, -small, -large. */
static void individual_by_hand(void **state)
{
    (void)state;
    /* left half: (8, 4, 0) of 15, table 0 (2, 8); right half: (15, 0, 1), table 7 (47, 183); not flipped.
       Column 0 has indices 0 1 2 3 from the top, column 3 has 3 2 1 0, others 0. */
    const uint8_t block[8] = {0x8F, 0x40, 0x01, 0 << 5 | 7 << 2, 0x30, 0x0C, 0x50, 0x0A};
    int expected[4][4][3];
    static const int left[4] = {2, 8, -2, -8}, right[4] = {47, 183, -47, -183};
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 4; x++) {
            int index = x == 0 ? y : x == 3 ? 3 - y : 0, add = x < 2 ? left[index] : right[index];
            const int base[2][3] = {{136, 68, 0}, {255, 0, 17}};
            for (int c = 0; c < 3; c++) {
                int v = base[x / 2][c] + add;
                expected[y][x][c] = v < 0 ? 0 : v > 255 ? 255 : v;
            }
        }
    block_by_hand(block, (const int(*)[4][3])expected);
}

static void differential_by_hand(void **state)
{
    (void)state;
    /* top half: (16, 31, 0) of 31, table 2 (9, 29); bottom: differences (-4, -1, +3), table 5 (24, 80); flipped; all 3 */
    const uint8_t block[8] = {16 << 3 | 4, 31 << 3 | 7, 0 << 3 | 3, 2 << 5 | 5 << 2 | 3, 0xFF, 0xFF, 0xFF, 0xFF};
    int expected[4][4][3];
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 4; x++) {
            /* 5 bits to 8: v << 3 | v >> 2 */
            const int base[2][3] = {{132, 255, 0}, {99, 247, 24}}, add[2] = {-29, -80};
            for (int c = 0; c < 3; c++)
                expected[y][x][c] = base[y / 2][c] + add[y / 2] < 0 ? 0 : base[y / 2][c] + add[y / 2];
        }
    block_by_hand(block, (const int(*)[4][3])expected);
    assert_true(etc1_block_valid(block));
    const uint8_t overflow[8] = {31 << 3 | 1, 0, 0, 2}, underflow[8] = {0, 0, 3 << 3 | 4, 2},
                  no_difference[8] = {0, 0, 4};
    assert_false(etc1_block_valid(overflow));
    assert_false(etc1_block_valid(underflow));
    assert_true(etc1_block_valid(no_difference));
}

static void plain_colours(void **state)
{
    (void)state;
    /* a grey k needs base + modifier = k: bases are 8 apart (5 bits), modifiers +-2 reach every third step: error <= 2;
       any colour: channels are bound to one modifier, so <= 4 each (half a step of 8) */
    for (int k = 0; k < 256; k++)
        for (int tinted = 0; tinted < 2; tinted++) {
            uint8_t rgb[48], block[8], back[48];
            for (int i = 0; i < 48; i++) rgb[i] = (uint8_t)(tinted ? (k * (i % 3 * 37 + 1)) & 255 : k);
            etc1_encode(rgb, 4, 4, block);
            etc1_decode(block, 4, 4, back);
            for (int i = 0; i < 48; i++) assert_in_range(abs(rgb[i] - back[i]), 0, tinted ? 5 : 2);
        }
}

static void quality(void **state)
{
    (void)state;
    image_u8 image = ball(128, 128), back = coded(&image);
    double db = psnr(&image, &back);
    print_message("ball 128 x 128: %.2f dB\n", db);
    assert_true(db >= 38);
    image_u8_free(&image);
    image_u8_free(&back);
}

/* Partial blocks: what lies beyond the edge must not cost quality, nor be written. */
static void odd_sizes(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {2, 2}, {5, 7}, {9, 3}};
    for (int i = 0; i < 4; i++) {
        int width = sizes[i][0], height = sizes[i][1];
        assert_int_equal(etc1_size(width, height), ((width + 3) / 4) * ((height + 3) / 4) * 8);
        image_u8 image = image_u8_make(width, height, 3);
        memset(image.texel, 200, (size_t)(width * height * 3));
        image_u8 back = coded(&image);
        for (int k = 0; k < width * height * 3; k++) assert_in_range(back.texel[k], 198, 202);
        image_u8_free(&image);
        image_u8_free(&back);
    }
}

static void deterministic(void **state)
{
    (void)state;
    image_u8 image = ball(32, 32);
    uint8_t a[512], b[512];
    etc1_encode(image.texel, 32, 32, a);
    etc1_encode(image.texel, 32, 32, b);
    assert_memory_equal(a, b, sizeof a);
    image_u8_free(&image);
}

static void run(const char *command)
{
    int status = system(command);
    if (status == -1 || !WIFEXITED(status) || WEXITSTATUS(status)) fail_msg("%s: status %d", command, status);
}

static image_u8 tool_decode(const uint8_t *blocks, int width, int height)
{
    const uint8_t header[16] = {'P',
                                'K',
                                'M',
                                ' ',
                                '1',
                                '0',
                                0,
                                0,
                                (uint8_t)(width >> 8),
                                (uint8_t)width,
                                (uint8_t)(height >> 8),
                                (uint8_t)height,
                                (uint8_t)(width >> 8),
                                (uint8_t)width,
                                (uint8_t)(height >> 8),
                                (uint8_t)height};
    char path[64], command[200];
    bytes pkm = {0};
    image_u8 out;
    bytes_append(&pkm, header, sizeof header);
    bytes_append(&pkm, blocks, etc1_size(width, height));
    snprintf(path, sizeof path, "%s/a.pkm", directory);
    assert_int_equal(output_write_raw(path, &pkm, NULL), 0);
    bytes_free(&pkm);
    snprintf(command, sizeof command, "etc1tool --decode %s/a.pkm -o %s/a.png >%s/log 2>&1", directory, directory,
             directory);
    run(command);
    snprintf(path, sizeof path, "%s/a.png", directory);
    assert_int_equal(png_read(&out, path, 3, NULL), 0);
    return out;
}

static int tool_missing(void)
{
    if (!have_tool) print_message("*** SKIPPED: no etc1tool here (apt-get install etc1tool) ***\n");
    return !have_tool;
}

/* Every valid block decodes as etc1tool decodes it: 4,096 random ones, then our own. */
static void agrees_with_etc1tool(void **state)
{
    (void)state;
    if (tool_missing()) skip();
    enum { SIDE = 256 };
    size_t size = etc1_size(SIDE, SIDE);
    uint8_t *blocks = need_memory(size, 1);
    uint32_t seed = 1;
    for (size_t i = 0; i < size; i += 8) {
        do
            for (size_t k = 0; k < 8; k++) blocks[i + k] = (uint8_t)(random_next(&seed) >> 24);
        while (!etc1_block_valid(blocks + i));
    }
    for (int pass = 0; pass < 2; pass++) {
        image_u8 ours = image_u8_make(SIDE, SIDE, 3);
        etc1_decode(blocks, SIDE, SIDE, ours.texel);
        image_u8 theirs = tool_decode(blocks, SIDE, SIDE);
        assert_int_equal(theirs.width, SIDE);
        assert_int_equal(theirs.height, SIDE);
        assert_memory_equal(ours.texel, theirs.texel, (size_t)SIDE * SIDE * 3);
        image_u8_free(&ours);
        image_u8_free(&theirs);
        image_u8 image = ball(SIDE, SIDE);
        etc1_encode(image.texel, SIDE, SIDE, blocks);
        image_u8_free(&image);
    }
    free(blocks);
}

static void no_worse_than_etc1tool(void **state)
{
    (void)state;
    if (tool_missing()) skip();
    image_u8 image = ball(128, 128), ours = coded(&image);
    char path[64], command[200];
    snprintf(path, sizeof path, "%s/b.png", directory);
    assert_int_equal(png_write(path, &image, NULL), 0);
    snprintf(command, sizeof command, "etc1tool --encode %s/b.png -o %s/b.pkm >%s/log 2>&1", directory, directory,
             directory);
    run(command);
    snprintf(path, sizeof path, "%s/b.pkm", directory);
    bytes pkm;
    assert_int_equal(file_read(&pkm, path, NULL), 0);
    assert_int_equal(pkm.size, 16 + etc1_size(128, 128));
    image_u8 theirs = image_u8_make(128, 128, 3);
    etc1_decode(pkm.data + 16, 128, 128, theirs.texel);
    print_message("ours %.2f dB, etc1tool %.2f dB\n", psnr(&image, &ours), psnr(&image, &theirs));
    assert_true(psnr(&image, &ours) >= psnr(&image, &theirs));
    bytes_free(&pkm);
    image_u8_free(&image);
    image_u8_free(&ours);
    image_u8_free(&theirs);
}

static int set_up(void **state)
{
    (void)state;
    have_tool = system("command -v etc1tool >/dev/null 2>&1") == 0;
    return mkdtemp(directory) ? 0 : -1;
}

static int tear_down(void **state)
{
    static const char *const made[] = {"a.pkm", "a.png", "b.png", "b.pkm", "log"};
    (void)state;
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) {
        char path[64];
        snprintf(path, sizeof path, "%s/%s", directory, made[i]);
        unlink(path);
    }
    return rmdir(directory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(individual_by_hand),
        cmocka_unit_test(differential_by_hand),
        cmocka_unit_test(plain_colours),
        cmocka_unit_test(quality),
        cmocka_unit_test(odd_sizes),
        cmocka_unit_test(deterministic),
        cmocka_unit_test(agrees_with_etc1tool),
        cmocka_unit_test(no_worse_than_etc1tool),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
