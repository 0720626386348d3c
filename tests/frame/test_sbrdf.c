/* SPDX-License-Identifier: MIT */
/*
 * Materials that vary over the surface, on every driver, against the double evaluation of the same 8-bit parameters: one to
 * three lobes, x^n computed and by the table, directional and point lights, near and distant viewers, normal maps,
 * directions of anisotropy, opacity, ambient light, filtered maps; eight lights, which GLSL ES 1.00 draws in passes.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "drivers.h"
#include "nacre_gles.h"
#include "power_file.h"
#include "sbrdf_map.h"

#include <cmocka.h> /* last: it makes a macro of fail */

/* fp32: what is asked of highp, of every pixel inside. The display curve is 1.2 codes off at most, the table 1.5 at n = 255.
   fp16: x is off by up to 2^-11, x^255 by 12 %: reached is 5. Both with texels filtered in floats. */
static const compare_bound fp32 = {-3, 3, 0, 0.01}, fp16 = {-6, 6, 0, 0.01};
static const compare_bound turned = {-1, 1, 0, 0}, turned_fp16 = {-2, 2, 0, 0};
static const double most_mean = 0.5;
/* The CPU renderer: rounding down in every step, and 1 / n.l of that where square roots are steep. Normal maps: one step of
   a normal's 14 bits in a highlight of n = 255. */
static const compare_bound integers = {-2, 2, 0, 0.01};

static uint32_t state;
static double uniform(double low, double high)
{
    state = state * 1664525u + 1013904223u;
    return low + (high - low) * (state >> 8) / 16777216.0;
}

/* One texel: forward lobes, off-specular ones, a retroreflective one, anisotropic ones. */
static void paint(sbrdf_map *m, unsigned seed, int lobes, int direction)
{
    static const double exponents[] = {3, 6, 12, 40, 120, 255}; /* the table is for 3 and more */
    state = 77 + 1000 * seed;
    sbrdf_map_make(m, 1, 1, lobes, direction, 1);
    m->albedo_most = uniform(0.3, 1);
    for (int c = 0; c < 4; c++) m->albedo[0][c] = (uint8_t)(c < 3 ? uniform(0, 200) : 255);
    for (int j = 0; j < lobes; j++) {
        uint8_t *albedo = m->lobe[0] + 8 * j, *shape = albedo + 4;
        const double cx = uniform(0.7, 1), cy = j == 1 ? uniform(0.3, 0.9) : cx, back = j == 2 ? 1 : -1;
        m->most[j] = uniform(0.5, 2);
        m->shape_most[j] = j == 1 ? 1.5 : 1;
        for (int c = 0; c < 3; c++) albedo[c] = (uint8_t)uniform(20, 255);
        albedo[3] = 255;
        shape[0] = (uint8_t)sbrdf_shape_code(back * cx, m->shape_most[j]);
        shape[1] = (uint8_t)sbrdf_shape_code(back * cy, m->shape_most[j]);
        shape[2] = (uint8_t)sbrdf_shape_code(uniform(0.8, 1), m->shape_most[j]);
        shape[3] = (uint8_t)sbrdf_exponent_code(exponents[(seed + 2 * (unsigned)j) % 6]);
    }
    if (!direction) return;
    m->lobe[0][3] = (uint8_t)sbrdf_shape_code(0.8, 1);
    m->lobe[0][8 + 3] = (uint8_t)sbrdf_shape_code(-0.6, 1);
}

/* side x side texels, each one of four in no order, so that what is filtered differs much. One level: smaller ones would
   hang on derivatives, which drivers need not agree about. */
static void paint_all(sbrdf_map *m, unsigned seed, int lobes, int direction, int side)
{
    sbrdf_map kind[4];

    for (unsigned i = 0; i < 4; i++) paint(&kind[i], seed + i, lobes, direction);
    sbrdf_map_make(m, side, side, lobes, direction, 1);
    m->albedo_most = kind[0].albedo_most;
    memcpy(m->most, kind[0].most, sizeof m->most);
    memcpy(m->shape_most, kind[0].shape_most, sizeof m->shape_most);
    for (int i = 0; i < side * side; i++) {
        const sbrdf_map *const k = &kind[i ? (int)uniform(0, 4) : 0];

        memcpy(m->albedo[0] + 4 * i, k->albedo[0], 4);
        for (int layer = 0; layer < m->layers; layer++)
            memcpy(m->lobe[0] + 4 * (layer * side * side + i), k->lobe[0] + 4 * layer, 4);
    }
    for (int i = 0; i < 4; i++) sbrdf_map_free(&kind[i]);
}

typedef struct material {
    bytes file[3];
    nacre_image image[3];
    nacre_material runtime;
    brdf *exact;
} material;

static void material_open(material *out, sbrdf_map *m)
{
    const power_file power = {256, 256};
    memset(out, 0, sizeof *out);
    sbrdf_map_write(m, &out->file[0], &out->file[1]);
    power_file_write(&power, &out->file[2]);
    for (int i = 0; i < 3; i++)
        if (nacre_image_open(&out->image[i], out->file[i].data, out->file[i].size)) exit(1);
    out->runtime.model = NACRE_MODEL_SBRDF;
    out->runtime.image[NACRE_ROLE_ALBEDO] = &out->image[0];
    out->runtime.image[NACRE_ROLE_LOBES] = &out->image[1];
    out->runtime.image[NACRE_ROLE_POWER] = &out->image[2];
    out->exact = sbrdf_map_brdf(m);
}

static void material_close(material *m)
{
    brdf_close(m->exact);
    for (int i = 0; i < 3; i++) bytes_free(&m->file[i]);
}

static const struct {
    frame_case frame;
    int direction;
    int opacity; /* code; 0: 255 */
    int side;    /* texels of the maps */
} cases[] = {
    {{.name = "directional", .lights = 1, .exposure = 1}, 0, 0, 1},
    {{.name = "square root", .lights = 1, .exposure = 1, .output = NACRE_OUTPUT_SQRT}, 1, 0, 1},
    {{.name = "two points, near viewer", .camera = CASE_PERSPECTIVE, .lights = 1, .points = 2, .exposure = 0.7},
     0,
     0,
     1},
    {{.name = "eight", .lights = 8, .exposure = 0.5}, 1, 0, 1},
    {{.name = "normal map", .lights = 2, .normal_map = 1, .exposure = 1}, 1, 0, 1},
    {{.name = "transparent, ambient", .lights = 1, .ambient = 0.8, .exposure = 1}, 0, 128, 1},
    {{.name = "filtered", .lights = 1, .exposure = 1}, 0, 0, 16},
};
enum { CASES = sizeof cases / sizeof *cases, SEEDS = 6 };

typedef struct run {
    const char *name;
    int size, half;
    scene_gles *g; /* NULL: the CPU renderer */
    mesh sphere;
    case_asset bumpy; /* for its normal map */
    const char *power;
    int failed;
} run;

/* Every covered pixel has this alpha: then it is made opaque, as the double frame is. */
static int take_opacity(image_u8 *frame, int opacity, const char *name)
{
    for (int i = 0; i < frame->width * frame->height; i++) {
        uint8_t *const alpha = &frame->texel[4 * i + 3];

        if (*alpha != 0 && *alpha != opacity) {
            printf("%s: alpha %d, expected %d\n", name, *alpha, opacity);
            return 0;
        }
        if (*alpha) *alpha = 255;
    }
    return 1;
}

static void draw_case(run *r, int index, int lobes, unsigned seed)
{
    const frame_case *c = &cases[index].frame;
    const compare_bound *const bound = r->g ? (r->half ? &fp16 : &fp32) : &integers;
    char name[120];
    sbrdf_map map;
    material m;
    scene s;
    image_u8 actual, expected;
    compare_result result;
    failure f = {0};
    double diffuse[3];

    paint_all(&map, seed, lobes, cases[index].direction, cases[index].side);
    if (cases[index].opacity) map.albedo[0][3] = (uint8_t)cases[index].opacity;
    /* the maps have no white-sky albedo of their lobes, so that ambient light sees the diffuse one alone */
    for (int k = 0; k < 3; k++) diffuse[k] = sbrdf_albedo_value(map.albedo[0][k], map.albedo_most);
    material_open(&m, &map);
    if (c->normal_map) m.runtime.image[NACRE_ROLE_NORMAL] = &r->bumpy.normal_image;
    case_scene(&s, c, &r->sphere, r->size, r->size);
    if ((r->g ? scene_gles_draw(r->g, &s, &m.runtime, &actual, &f) : scene_draw_soft(&s, &m.runtime, &actual, &f)) ||
        scene_draw_double(&s, m.exact, diffuse, c->normal_map ? &r->bumpy.normal_map : NULL, &expected, &f)) {
        printf("%s\n", f.text);
        exit(1);
    }
    snprintf(name, sizeof name, "sbrdf %s, %s, %s, %d lobes, seed %u", r->name, c->name, r->power, lobes, seed);
    if (cases[index].opacity) r->failed += !take_opacity(&actual, cases[index].opacity, name);
    r->failed += !compare_frames(name, &actual, &expected, 1, bound, &result);
    if (result.mean > most_mean) {
        printf("%s: mean %.3f\n", name, result.mean);
        r->failed++;
    }
    image_u8_free(&actual);
    image_u8_free(&expected);
    material_close(&m);
}

/* A lobe with Cx = Cy is isotropic: its picture does not hang on the direction of anisotropy. */
static void turn_isotropic(run *r, unsigned seed)
{
    image_u8 picture[2];
    char name[120];

    for (int direction = 0; direction < 2; direction++) {
        sbrdf_map map;
        material m;
        scene s;
        failure f = {0};

        paint(&map, seed, 1, direction);
        material_open(&m, &map);
        case_scene(&s, &cases[0].frame, &r->sphere, r->size, r->size);
        if (r->g ? scene_gles_draw(r->g, &s, &m.runtime, &picture[direction], &f)
                 : scene_draw_soft(&s, &m.runtime, &picture[direction], &f)) {
            printf("%s\n", f.text);
            exit(1);
        }
        material_close(&m);
    }
    snprintf(name, sizeof name, "sbrdf %s, Cx = Cy turned, %s, seed %u", r->name, r->power, seed);
    r->failed += !compare_frames(name, &picture[0], &picture[1], 1, r->half ? &turned_fp16 : &turned, NULL);
    for (int i = 0; i < 2; i++) image_u8_free(&picture[i]);
}

static void run_begin(run *r, const char *name, int size)
{
    failure f = {0};

    *r = (run){.name = name, .size = size};
    case_asset_open(&r->bumpy, CASE_TABLE, "lambert:albedo=.5", 1, NULL);
    if (mesh_open(&r->sphere, "sphere", &f)) exit(1);
}

static void run_end(run *r)
{
    mesh_free(&r->sphere);
    case_asset_close(&r->bumpy);
}

static void draw_cases(run *r)
{
    for (int i = 0; i < CASES; i++)
        for (int lobes = 1; lobes <= 3; lobes++)
            for (unsigned seed = 0; seed < (i ? 2 : SEEDS); seed++) draw_case(r, i, lobes, seed + (unsigned)i);
    for (unsigned seed = 0; seed < SEEDS; seed++) turn_isotropic(r, seed);
}

static int run_driver(int index)
{
    static const char *const names[] = {"auto", "pow", "table"};
    const driver *const d = &drivers[index];
    failure f = {0};
    run r;

    run_begin(&r, d->name, d->size);
    r.half = d->half;
    for (int power = NACRE_GLES_POWER_COMPUTED; power <= NACRE_GLES_POWER_TABLE; power++) {
        if (scene_gles_open_power(&r.g, d->backend, power, d->size, d->size, &f)) {
            printf("SKIPPED: driver %s: %s\n", d->name, f.text);
            return DRIVER_SKIPPED;
        }
        r.power = names[power];
        draw_cases(&r);
        scene_gles_close(r.g);
    }
    run_end(&r);
    return r.failed ? 1 : 0;
}

/* The CPU renderer: powers by tables of logarithms. */
static void test_soft(void **state_)
{
    run r;

    (void)state_;
    run_begin(&r, "soft", 160);
    r.power = "logarithms";
    draw_cases(&r);
    run_end(&r);
    assert_int_equal(r.failed, 0);
}

static void test_driver(void **state_)
{
    const int code = driver_run((int)(intptr_t)*state_, "sbrdf");

    if (code == DRIVER_SKIPPED) skip();
    assert_int_equal(code, 0);
}

int main(int argc, char **argv)
{
    struct CMUnitTest tests[8] = {cmocka_unit_test(test_soft)};
    const char *argument;
    const int index = driver_of_arguments(argc, argv, &argument);

    if (index >= 0) return run_driver(index);
    /* llvmpipe: filter in floats, as GPUs do, instead of to 8 bits */
    if (setenv("GALLIVM_PERF", "no_aos_sampling", 1)) return 70;
    for (int i = 0; i < driver_count; i++)
        tests[1 + i] = (struct CMUnitTest){drivers[i].name, test_driver, NULL, NULL, (void *)(intptr_t)i};
    return _cmocka_run_group_tests("sbrdf", tests, 1 + (size_t)driver_count, NULL, NULL);
}
