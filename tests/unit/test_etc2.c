/* SPDX-License-Identifier: MIT */
/* ETC2: a real driver's decoder as oracle for every mode, closed forms, and quality against ETC1. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* before cmocka.h, which defines a macro fail() */
#include "brdf_kit.h"
#include "etc1.h"
#include "etc2.h"
#include "gl_headless.h"
#include "metric.h"
#include "pixels.h"

#include <cmocka.h>

enum { SIDE = 512, SIZE = SIDE * SIDE / 2 };

static uint32_t random_next(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    return *state ^= *state << 5;
}

static double psnr(const uint8_t *a, const uint8_t *b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum > 0 ? 10 * log10(255 * 255 * (double)count / sum) : 99;
}

/* A sphere of a BRDF as the metric displays it. */
static image_u8 ball(const char *name, int size)
{
    brdf *b = open_name(name);
    image_u8 out;
    metric_frame(b, 45, brdf_exposure(b), size, &out);
    brdf_close(b);
    return out;
}

/* ---- the driver ---------------------------------------------------------------------------------------------------- */

static void *entry(const char *name)
{
    void *p = gl_headless_proc(NULL, name);
    if (!p) fail_msg("no entry point %s", name);
    return p;
}

enum {
    GL_TEXTURE_2D = 0x0DE1,
    GL_RGB = 0x1907,
    GL_UNSIGNED_BYTE = 0x1401,
    GL_RGB8_ETC2 = 0x9274,
    GL_PACK_ALIGNMENT = 0x0D05,
    GL_TEXTURE_ENV = 0x2300,
    GL_TEXTURE_ENV_MODE = 0x2200,
    GL_REPLACE = 0x1E01,
    GL_MAG_FILTER = 0x2800,
    GL_MIN_FILTER = 0x2801,
    GL_NEAREST = 0x2600,
    GL_QUADS = 7
};

/* Draw the blocks as a texture over the whole target, texel on pixel, and read them back; rows from the top. */
static void driver_decode(const uint8_t *blocks, uint8_t *rgb)
{
    static const float corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    unsigned name = 0;
    void (*gen)(int, unsigned *), (*bind)(unsigned, unsigned), (*store)(unsigned, int), (*enable)(unsigned);
    void (*upload)(unsigned, int, unsigned, int, int, int, int, const void *);
    void (*parameter)(unsigned, unsigned, int), (*environment)(unsigned, unsigned, int);
    void (*begin)(unsigned), (*end)(void), (*place)(float, float), (*vertex)(float, float);
    void (*read)(int, int, int, int, unsigned, unsigned, void *);
    unsigned (*error)(void);
    *(void **)&gen = entry("glGenTextures");
    *(void **)&bind = entry("glBindTexture");
    *(void **)&store = entry("glPixelStorei");
    *(void **)&enable = entry("glEnable");
    *(void **)&upload = entry("glCompressedTexImage2D");
    *(void **)&parameter = entry("glTexParameteri");
    *(void **)&environment = entry("glTexEnvi");
    *(void **)&begin = entry("glBegin");
    *(void **)&end = entry("glEnd");
    *(void **)&place = entry("glTexCoord2f");
    *(void **)&vertex = entry("glVertex2f");
    *(void **)&read = entry("glReadPixels");
    *(void **)&error = entry("glGetError");
    gen(1, &name);
    bind(GL_TEXTURE_2D, name);
    upload(GL_TEXTURE_2D, 0, GL_RGB8_ETC2, SIDE, SIDE, 0, SIZE, blocks);
    parameter(GL_TEXTURE_2D, GL_MIN_FILTER, GL_NEAREST);
    parameter(GL_TEXTURE_2D, GL_MAG_FILTER, GL_NEAREST);
    environment(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
    enable(GL_TEXTURE_2D);
    begin(GL_QUADS);
    for (int i = 0; i < 4; i++) {
        place(corner[i][0] / 2 + 0.5F, corner[i][1] / 2 + 0.5F);
        vertex(corner[i][0], corner[i][1]);
    }
    end();
    store(GL_PACK_ALIGNMENT, 1);
    /* row 0 of the texture is at v = 0, the lowest row of the target, which is read first */
    read(0, 0, SIDE, SIDE, GL_RGB, GL_UNSIGNED_BYTE, rgb);
    assert_int_equal(error(), 0);
}

/* 16,384 random blocks, of which every mode gets its share, then our own: bit by bit as the driver decodes them. */
static void agrees_with_driver(void **state)
{
    (void)state;
    static uint8_t blocks[SIZE], ours[SIDE * SIDE * 3], theirs[SIDE * SIDE * 3];
    uint32_t seed = 2463534242u;
    int count[5] = {0};
    gl_headless *gl;
    if (gl_headless_open(&gl, GL_BACKEND_OSMESA, SIDE, SIDE, NULL)) {
        print_message("*** SKIPPED: no OSMesa here (apt-get install libosmesa6-dev) ***\n");
        skip();
    }
    for (size_t i = 0; i < SIZE; i++) blocks[i] = (uint8_t)(random_next(&seed) >> 11);
    for (size_t i = 0; i < SIZE; i += 8) count[etc2_block_mode(blocks + i)]++;
    print_message("random blocks by mode: %d individual, %d differential, %d T, %d H, %d planar\n", count[0], count[1],
                  count[2], count[3], count[4]);
    for (int i = 0; i < 5; i++) assert_true(count[i] > 400);
    for (int pass = 0; pass < 2; pass++) {
        etc2_decode(blocks, SIDE, SIDE, ours);
        driver_decode(blocks, theirs);
        assert_memory_equal(ours, theirs, sizeof ours);
        image_u8 image = ball("sgd:specular-violet-phenolic", SIDE);
        etc2_encode(image.texel, SIDE, SIDE, blocks);
        image_u8_free(&image);
    }
    gl_headless_close(gl);
}

/* ---- closed forms -------------------------------------------------------------------------------------------------- */

/* Blocks that planar describes nearly, and H and T exactly. */
static void modes_by_hand(void **state)
{
    (void)state;
    uint8_t rgb[48], block[8], back[48];
    /* planar: from 0 to 4 texels on, red rises by 64, green falls by 64, blue stays. 6 and 7 bits expand to within 2 */
    for (int n = 0; n < 16; n++) {
        rgb[3 * n] = (uint8_t)(40 + 16 * (n % 4));
        rgb[3 * n + 1] = (uint8_t)(200 - 16 * (n / 4));
        rgb[3 * n + 2] = 77;
    }
    etc2_encode(rgb, 4, 4, block);
    etc2_decode(block, 4, 4, back);
    assert_int_equal(etc2_block_mode(block), ETC2_MODE_PLANAR);
    for (int i = 0; i < 48; i++) assert_in_range(abs(rgb[i] - back[i]), 0, 3);

    /* H: two far colours of 4 bits, each +-16, mixed texel by texel, so that no half is of one colour */
    const int pair[2][3] = {{2 * 17, 12 * 17, 4 * 17}, {11 * 17, 3 * 17, 9 * 17}};
    for (int n = 0; n < 16; n++)
        for (int c = 0; c < 3; c++) rgb[3 * n + c] = (uint8_t)(pair[(n ^ n >> 2) & 1][c] + (n & 2 ? 16 : -16));
    etc2_encode(rgb, 4, 4, block);
    etc2_decode(block, 4, 4, back);
    assert_int_equal(etc2_block_mode(block), ETC2_MODE_H);
    assert_memory_equal(rgb, back, sizeof rgb);

    /* T: one colour alone, another with +23, 0, -23 */
    static const int step[4] = {0, 23, 0, -23};
    for (int n = 0; n < 16; n++)
        for (int c = 0; c < 3; c++) {
            int lone = (n * 5 + n / 4) % 4 == 0;
            rgb[3 * n + c] = (uint8_t)(pair[!lone][c] + (lone ? 0 : step[(n * 5 + n / 4) % 4]));
        }
    etc2_encode(rgb, 4, 4, block);
    etc2_decode(block, 4, 4, back);
    assert_int_equal(etc2_block_mode(block), ETC2_MODE_T);
    assert_memory_equal(rgb, back, sizeof rgb);
}

/* Two equal colours can only say an odd distance; no block may come out worse than ETC1's, whatever the texels. */
static void never_worse_than_etc1(void **state)
{
    (void)state;
    uint32_t seed = 99;
    for (int i = 0; i < 400; i++) {
        uint8_t rgb[48], one[8], two[8], back[2][48];
        int low = random_next(&seed) & 127, range = 1 + (int)(random_next(&seed) & 127);
        for (int k = 0; k < 48; k++) rgb[k] = (uint8_t)(low + (int)(random_next(&seed) >> 8) % range);
        etc1_encode(rgb, 4, 4, one);
        etc2_encode(rgb, 4, 4, two);
        etc2_decode(one, 4, 4, back[0]); /* ETC1 blocks mean the same here */
        etc2_decode(two, 4, 4, back[1]);
        assert_true(psnr(rgb, back[1], 48) >= psnr(rgb, back[0], 48));
    }
}

/* ---- quality ------------------------------------------------------------------------------------------------------- */

/* Public encoders reach 39.4 to 41.4 dB (ETC1) and 42.0 to 47.6 dB (ETC2) on spheres of 256 x 256. */
static void quality(void **state)
{
    (void)state;
    static const char *const names[] = {"sgd:gold-metallic-paint", "sgd:yellow-plastic", "ngan-lafortune:pink-felt"};
    enum { BALL = 256 };
    uint8_t *blocks = need_memory(BALL * BALL / 2, 1), *back = need_memory(BALL * BALL, 3);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        image_u8 image = ball(names[i], BALL);
        etc1_encode(image.texel, BALL, BALL, blocks);
        etc1_decode(blocks, BALL, BALL, back);
        double one = psnr(image.texel, back, (size_t)3 * BALL * BALL);
        etc2_encode(image.texel, BALL, BALL, blocks);
        etc2_decode(blocks, BALL, BALL, back);
        double two = psnr(image.texel, back, (size_t)3 * BALL * BALL);
        print_message("%-28s ETC1 %.2f dB, ETC2 %.2f dB\n", names[i], one, two);
        assert_true(one >= 39.4);
        assert_true(two >= 42.0 && two > one + 1);
        image_u8_free(&image);
    }
    free(back);
    free(blocks);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_driver),
        cmocka_unit_test(modes_by_hand),
        cmocka_unit_test(never_worse_than_etc1),
        cmocka_unit_test(quality),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
