/* SPDX-License-Identifier: MIT */
/* Lit spheres on drivers, where frames against double (test_frames.c) do not reach: spread updates, masks, many passes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "gles_kit.h"
#include "ktx2_write.h"
#include "nacre_asset.h"

#include <cmocka.h> /* last: it makes a macro of fail */

#define GL_DEPTH_TEST 0x0B71

enum { SIZE = 96, LIGHTS = 60, MASK = 16 };

static kit assets;
static gl_headless *context;
static nacre_light lights[LIGHTS];

typedef struct world {
    kit_world w;
    nacre_gles *gles;
    nacre_gles_item item;
    nacre_gles_lit gold, other; /* of two materials */
    nacre_view view;
} world;

/* Many dim lights around the eye. */
static nacre_view many_lights(void)
{
    nacre_view view = kit_view(1, 0, 1);
    for (int i = 0; i < LIGHTS; i++) {
        const double polar = 1.4 * (i + .5) / LIGHTS, azimuth = 2.4 * i;
        lights[i] = view.lights[0];
        lights[i].direction = nacre_dir_from_float((float)(sin(polar) * cos(azimuth)),
                                                   (float)(sin(polar) * sin(azimuth)), (float)cos(polar));
        lights[i].power = nacre_rgb_from_float(0.02f, 0.015f, 0.01f + 0.0004f * (float)i);
    }
    view.lights = lights;
    view.light_count = LIGHTS;
    view.distant_viewer = 1;
    return view;
}

static void open_world(world *w, gl_backend backend, const fake_gl_options *options, const nacre_image *mask)
{
    const nacre_gles_lit none = {0};
    nacre_material gold = kit_material(&assets, KIT_TABLE, 0), other = kit_material(&assets, KIT_SPHERES, 0);
    memset(w, 0, sizeof *w);
    if (!kit_context(&context, backend, SIZE, SIZE)) skip();
    ((void (*)(unsigned))(uintptr_t)gl_headless_proc(NULL, "glEnable"))(GL_DEPTH_TEST);
    fake_gl_start(options);
    kit_world_make(&w->w, NULL);
    assert_int_equal(kit_world_init(&w->w), NACRE_OK);
    w->gles = w->w.gles;
    w->view = many_lights();
    gold.image[NACRE_ROLE_MASK] = mask;
    assert_int_equal(nacre_gles_add(w->gles, &assets.ball, &gold, &w->item), NACRE_OK);
    assert_int_equal(nacre_gles_lit_add(w->gles, &gold, NULL, &w->gold), NACRE_OK);
    assert_int_equal(nacre_gles_lit_add(w->gles, &other, NULL, &w->other), NACRE_OK);
    assert_int_equal(nacre_gles_use_lit(w->gles, w->item, w->gold, none), NACRE_OK);
}

static void close_world(world *w)
{
    nacre_gles_shutdown(w->gles);
    assert_true(kit_world_free(&w->w));
    gl_headless_close(context);
}

static image_u8 picture(world *w)
{
    image_u8 out;
    gl_headless_clear(context, 0, 0, 0, 0);
    assert_int_equal(nacre_gles_draw(w->gles, w->item, &w->view), NACRE_OK);
    gl_headless_read(context, &out);
    return out;
}

static void update(world *w, nacre_gles_lit lit, unsigned budget)
{
    nacre_gles_lit_state state = {0};
    while (!state.current) {
        assert_int_equal(nacre_gles_lit_update(w->gles, lit, assets.ball.centre, &w->view, budget), NACRE_OK);
        nacre_gles_lit_get_state(w->gles, lit, &state);
    }
}

/* A picture made over many calls is the one made at once; and both are what direct shading draws, in passes of its own.
   Bound 4: the picture is read between texels. */
static void spread_is_at_once(gl_backend backend)
{
    const fake_gl_options real = {.real = gl_headless_proc};
    world w;
    int covered;
    open_world(&w, backend, &real, NULL);
    image_u8 direct = picture(&w);
    update(&w, w.gold, 0);
    image_u8 at_once = picture(&w);
    lights[3].shadow = 1;
    update(&w, w.gold, 0);
    lights[3].shadow = 0;
    update(&w, w.gold, 8);
    image_u8 spread = picture(&w);
    assert_int_equal(kit_difference(&at_once, &spread, &covered), 0);
    assert_in_range(covered, SIZE * SIZE / 10, SIZE * SIZE);
    assert_in_range(kit_difference(&direct, &at_once, NULL), 1, 4);
    image_u8_free(&direct);
    image_u8_free(&at_once);
    image_u8_free(&spread);
    close_world(&w);
}

/* 16 uniform vectors: 15 passes of 4 lights instead of 8 of at most 8. Sums are off by 7.6e-6 a pass, 0.4 codes of 255 near
   black after 15. */
static void passes_lose_nothing(gl_backend backend)
{
    const fake_gl_options real = {.real = gl_headless_proc}, few = {.real = gl_headless_proc, .fragment_vectors = 16};
    world w;
    open_world(&w, backend, &real, NULL);
    update(&w, w.gold, 0);
    image_u8 eight = picture(&w);
    close_world(&w);
    open_world(&w, backend, &few, NULL);
    update(&w, w.gold, 0);
    image_u8 four = picture(&w);
    close_world(&w);
    assert_in_range(kit_difference(&eight, &four, NULL), 0, 1);
    image_u8_free(&eight);
    image_u8_free(&four);
}

/* red falls, alpha rises from texel to texel */
static void make_mask(bytes *file, nacre_image *image)
{
    ktx2_image k = {.format = NACRE_FORMAT_RG8, .width = MASK, .height = MASK, .layers = 1, .faces = 1, .levels = 1};
    uint8_t texel[MASK * MASK][2];
    for (int i = 0; i < MASK * MASK; i++) {
        texel[i][0] = (uint8_t)(255 - i);
        texel[i][1] = (uint8_t)(i % MASK * 17);
    }
    bytes_append(&k.level[0], texel, sizeof texel);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "mask");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "linear");
    ktx2_write(&k, file);
    ktx2_free(&k);
    assert_int_equal(nacre_image_open(image, file->data, file->size), NACRE_OK);
}

/* Every pixel lies between those of the two materials alone, by one share for all channels; alpha is the mask's. */
static void masks_mix(gl_backend backend)
{
    const fake_gl_options real = {.real = gl_headless_proc};
    const nacre_gles_lit none = {0};
    bytes file = {0};
    nacre_image mask;
    world w;
    long mixed = 0, alphas[256] = {0}, kinds = 0;
    make_mask(&file, &mask);
    open_world(&w, backend, &real, &mask);
    update(&w, w.gold, 0);
    update(&w, w.other, 0);
    image_u8 a = picture(&w);
    nacre_gles_use_lit(w.gles, w.item, w.other, none);
    image_u8 b = picture(&w);
    nacre_gles_use_lit(w.gles, w.item, w.gold, w.other);
    image_u8 ab = picture(&w);
    for (int i = 0; i < SIZE * SIZE; i++) {
        const uint8_t *x = a.texel + 4 * i, *y = b.texel + 4 * i, *z = ab.texel + 4 * i;
        int widest = 0;
        assert_int_equal(x[3], y[3]);
        assert_int_equal(x[3], z[3]);
        kinds += !alphas[x[3]]++;
        for (int k = 1; k < 3; k++)
            if (abs(y[k] - x[k]) > abs(y[widest] - x[widest])) widest = k;
        if (abs(y[widest] - x[widest]) < 40) continue;
        const double share = (z[widest] - x[widest]) / (double)(y[widest] - x[widest]);
        assert_true(share > -0.05 && share < 1.05);
        for (int k = 0; k < 3; k++) assert_true(fabs(x[k] + share * (y[k] - x[k]) - z[k]) < 2.6);
        mixed++;
    }
    assert_true(mixed > 200);
    assert_true(kinds > 20);
    image_u8_free(&a);
    image_u8_free(&b);
    image_u8_free(&ab);
    close_world(&w);
    bytes_free(&file);
}

#define ON(test, name, backend)                                                                                        \
    static void test##_##name(void **state)                                                                            \
    {                                                                                                                  \
        (void)state;                                                                                                   \
        test(backend);                                                                                                 \
    }
#define ON_ALL(test)                                                                                                   \
    ON(test, egl2, GL_BACKEND_EGL2)                                                                                    \
    ON(test, egl3, GL_BACKEND_EGL3)                                                                                    \
    ON(test, osmesa, GL_BACKEND_OSMESA)
ON_ALL(spread_is_at_once)
ON_ALL(passes_lose_nothing)
ON_ALL(masks_mix)

int main(void)
{
#define TESTS(test) cmocka_unit_test(test##_egl2), cmocka_unit_test(test##_egl3), cmocka_unit_test(test##_osmesa)
    const struct CMUnitTest tests[] = {TESTS(spread_is_at_once), TESTS(passes_lose_nothing), TESTS(masks_mix)};
    int failed;
    kit_open(&assets);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    kit_close(&assets);
    return failed;
}
