/* SPDX-License-Identifier: MIT */
/* Many directional lights: every backend's lit sphere against the double renderer, which sums the same lights at every
   pixel with the same file. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "light_bake.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { SIZE = 128 };

/* A window, a lamp and a floor. */
static light_set room_lights(int count)
{
    env_map map = {.width = 128, .height = 64};
    light_options o = {.count = count};
    light_set set;
    failure f = {0};
    int i, c;

    map.texel = malloc(sizeof *map.texel * 3 * 128 * 64);
    for (i = 0; i < 128 * 64; i++) {
        const double u = (i % 128 + 0.5) / 128, v = ((i >> 7) + 0.5) / 64;
        const int window = u > 0.1 && u < 0.2 && v > 0.25 && v < 0.5, lamp = hypot(2 * (u - 0.9), v - 0.3) < 0.04;
        for (c = 0; c < 3; c++)
            map.texel[3 * i + c] = (float)(lamp ? 60 - 15 * c : window ? 6 + 2 * c : v > 0.5 ? 0.5 - 0.1 * c : 0.3);
    }
    if (light_bake(&set, NULL, &map, "room", &o, &f)) fail_msg("%s", f.text);
    env_map_free(&map);
    return set;
}

typedef struct lights_case {
    const char *name, *brdf, *mesh;
    case_model model;
    int lights, lit_size, perspective;
} lights_case;

static const lights_case list[] = {
    {"one light", "sgd:gold-paint", "sphere", CASE_TABLE, 1, 256, 0},
    {"64 lights", "sgd:gold-metallic-paint", "sphere", CASE_TABLE, 64, 0, 0},
    {"64 lights, fine table", "sgd:gold-metallic-paint", "sphere", CASE_FINE, 64, 0, 0},
    {"64 lights, spheres", "sgd:gold-paint", "sphere", CASE_SPHERES, 64, 0, 0},
    {"300 lights, matt", "sgd:red-fabric", "sphere", CASE_TABLE, 300, 0, 0},
    {"64 lights, teapot in perspective", "sgd:gold-paint", "teapot", CASE_TABLE, 64, 256, 1},
};

/* Off by more than 3 codes in at most 4 pixels of 1,000: those of highlights between texels of the picture. The CPU renderer
   takes the nearest texel. A pixel of an outline may show the part behind it. */
static const compare_bound bound_gles = {-3, 3, 0.004, 0.002}, bound_cpu = {-4, 4, 0.01, 0.002};

static void set_scene(scene *s, const lights_case *c, const mesh *shape, const light_set *set)
{
    const scene_camera camera = {.kind = c->perspective ? SCENE_CAMERA_FIT : SCENE_CAMERA_ORTHO, .pitch_deg = 15};
    failure f = {0};

    scene_begin(s, shape, SIZE, SIZE);
    s->distant = set;
    s->lit_size = c->lit_size;
    s->distant_viewer = c->perspective;
    s->exposure = 0.8;
    assert_int_equal(scene_aim(s, &camera, &f), 0);
}

enum { CPU = GL_BACKEND_COUNT, BACKENDS };
static const char *const names[BACKENDS] = {"egl2", "egl3", "osmesa", "soft"};
static int has[BACKENDS];

static int find_drivers(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < CPU; i++) {
        scene_gles *g;
        failure f = {0};
        has[i] = !scene_gles_open(&g, (gl_backend)i, 16, 16, &f);
        if (has[i])
            scene_gles_close(g);
        else
            print_message("SKIPPED: %s: %s\n", names[i], f.text);
    }
    has[CPU] = 1;
    return 0;
}

static int check_backend(const lights_case *c, int backend, const scene *s, const nacre_material *material,
                         const image_u8 *expected)
{
    char name[200];
    image_u8 actual;
    failure f = {0};
    int ok, code = backend == CPU ? scene_draw_soft(s, material, &actual, &f)
                                  : scene_draw_gles(s, material, (gl_backend)backend, &actual, &f);

    if (code) fail_msg("%s: %s: %s", names[backend], c->name, f.text);
    snprintf(name, sizeof name, "lights %s: %s", names[backend], c->name);
    ok = compare_frames(name, &actual, expected, strcmp(c->mesh, "sphere") != 0,
                        backend == CPU ? &bound_cpu : &bound_gles, NULL);
    image_u8_free(&actual);
    return ok;
}

static int run_case(const lights_case *c)
{
    light_set set = room_lights(c->lights);
    case_asset asset;
    image_u8 expected;
    mesh shape;
    scene s;
    failure f = {0};
    int i, failed = 0;

    assert_int_equal(mesh_open(&shape, c->mesh, &f), 0);
    case_asset_open(&asset, c->model, c->brdf, 0, NULL);
    set_scene(&s, c, &shape, &set);
    if (scene_draw_double(&s, asset.decoded, asset.albedo, NULL, &expected, &f)) fail_msg("%s", f.text);
    for (i = 0; i < BACKENDS; i++) failed += has[i] && !check_backend(c, i, &s, &asset.material, &expected);
    image_u8_free(&expected);
    case_asset_close(&asset);
    mesh_free(&shape);
    light_set_free(&set);
    return failed;
}

static void one_fetch_is_worth_the_sum_of_all_lights(void **state)
{
    int failed = 0;
    size_t i;

    (void)state;
    for (i = 0; i < sizeof list / sizeof *list; i++) failed += run_case(&list[i]);
    assert_int_equal(failed, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_fetch_is_worth_the_sum_of_all_lights)};

    return cmocka_run_group_tests(tests, find_drivers, NULL);
}
