/* SPDX-License-Identifier: MIT */
/* Pictures of lit spheres on the CPU: texel by texel against the double decoding of the same file, summed over all lights;
   the same bits however the rows are portioned; formats; mistakes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "lit_sphere.h"
#include "metric.h"
#include "nacre_soft.h"
#include "vec3.h"
#include "workspace.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { SIZE = 64, MOST_LIGHTS = 1024 };

/* The normal of a place, from the definition: its bisector with +z has these x and y. 0: beyond all normals, or so near
   to the one straight behind that the place's own rounding shows. */
static int place_normal(int size, int i, int j, double n[3])
{
    const double half = 52429 / 65536.0; /* 0.8 in q16 */
    const double h[2] = {(2.0 * i + 1 - size) / size * half, (size - 2.0 * j - 1) / size * half};
    const double square = h[0] * h[0] + h[1] * h[1], hz = sqrt(1 - square);

    if (square >= 0.98) return 0;
    n[0] = 2 * hz * h[0];
    n[1] = 2 * hz * h[1];
    n[2] = 2 * hz * hz - 1;
    return 1;
}

static void normals_are_those_of_the_bisector_map(void **state)
{
    static const int sizes[] = {8, 9, 33, 64, 128, 255, 256, 512};
    double worst = 0;
    size_t s;

    (void)state;
    for (s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        uint32_t xy[512];
        int16_t z[512];
        int i, j;

        for (j = 0; j < sizes[s]; j++) {
            shade_lit_normals((unsigned)sizes[s], (unsigned)j, xy, z);
            for (i = 0; i < sizes[s]; i++) {
                double n[3];

                if (!place_normal(sizes[s], i, j, n)) continue;
                worst = fmax(worst, fabs((int16_t)(xy[i] & 65535) - 16384 * n[0]));
                worst = fmax(worst, fabs(((int32_t)xy[i] >> 16) - 16384 * n[1]));
                worst = fmax(worst, fabs(z[i] - 16384 * n[2]));
            }
        }
    }
    print_message("normals: worst %.3f of 2^-14\n", worst);
    assert_true(worst < 0.55); /* rounding alone makes 0.5, that of the place 0.04 more */
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static nacre_light lights[MOST_LIGHTS];

/* Spread evenly over a sphere, warm to cold, all of them together about as bright as one of 3. */
static void make_lights(int count)
{
    int i;

    for (i = 0; i < count; i++) {
        const double z = 1 - (2 * i + 1.0) / count * 0.9, turn = 2.399963 * i, r = sqrt(1 - z * z);
        const double power = 6.0 / count * (1 + 0.9 * sin(5.0 * i)), warm = 0.7 + 0.3 * cos(3.0 * i);

        memset(&lights[i], 0, sizeof lights[i]);
        lights[i].direction = nacre_dir_from_float((float)(r * cos(turn)), (float)(r * sin(turn)), (float)z);
        lights[i].power = nacre_rgb_from_float((float)power, (float)(power * 0.8), (float)(power * warm));
    }
}

static nacre_view make_view(int count)
{
    nacre_view view = {.lights = lights, .light_count = (uint16_t)count, .exposure = 81920};
    int i;

    for (i = 0; i < 16; i += 5) view.object_to_view.m[i] = view.view_to_clip.m[i] = NACRE_Q16_ONE;
    view.ambient = nacre_rgb_from_float(0.02f, 0.03f, 0.04f);
    return view;
}

static void draw(const nacre_soft_lit_desc *desc, unsigned rows, void *texels)
{
    const size_t size = nacre_soft_lit_scratch_size(desc, rows);
    uint32_t *scratch = malloc(size);

    assert_true(size > 0);
    assert_int_equal(nacre_soft_lit_rows(desc, texels, 0, desc->size, scratch, size), NACRE_OK);
    free(scratch);
}

/* Towards the light in the turned frame is the same here: the camera is orthographic. */
static void exact_sum(const case_asset *a, const nacre_view *view, const double n[3], double out[3])
{
    static const double ambient[3] = {0.02, 0.03, 0.04};
    double axes[3][3], side[3] = {fabs(n[0]) < 0.7, fabs(n[0]) >= 0.7, 0}, eye[3];
    int i, k;

    memcpy(axes[2], n, sizeof axes[2]);
    cross3(axes[0], side, n);
    normalise3(axes[0]);
    cross3(axes[1], axes[2], axes[0]);
    for (i = 0; i < 3; i++) eye[i] = axes[i][2];
    for (k = 0; k < 3; k++) out[k] = ambient[k] * a->albedo[k] / 3.14159265358979323846;
    for (i = 0; i < view->light_count; i++) {
        double l[3] = {lights[i].direction.x, lights[i].direction.y, lights[i].direction.z}, local[3], f[3];
        const double power[3] = {lights[i].power.r, lights[i].power.g, lights[i].power.b};

        normalise3(l);
        for (k = 0; k < 3; k++) local[k] = dot3(axes[k], l);
        brdf_eval_cosine(a->decoded, local, eye, f);
        for (k = 0; k < 3; k++) out[k] += f[k] * power[k] / 65536;
    }
    for (k = 0; k < 3; k++) out[k] *= view->exposure / 65536.0;
}

typedef struct errors {
    double mean, worst; /* codes, before the truth is rounded */
    long count, off;    /* off: differs from the rounded truth by more than 1 */
} errors;

static errors measure(const case_asset *a, int count)
{
    static uint8_t picture[SIZE * SIZE * 4];
    nacre_view view = make_view(count);
    const nacre_soft_lit_desc desc = {
        .material = &a->material, .view = &view, .size = SIZE, .format = NACRE_SOFT_RGBA8};
    errors e = {0};
    int i, k;

    make_lights(count);
    draw(&desc, 8, picture);
    for (i = 0; i < SIZE * SIZE; i++) {
        double n[3], truth[3];

        if (!place_normal(SIZE, i % SIZE, i / SIZE, n) || n[2] < 0.02) continue;
        exact_sum(a, &view, n, truth);
        for (k = 0; k < 3; k++) {
            const double wanted = 255 * srgb_encode(fmin(1, truth[k])), off = fabs(picture[4 * i + k] - wanted);

            e.mean += off;
            e.worst = fmax(e.worst, off);
            e.off += fabs(picture[4 * i + k] - floor(wanted + 0.5)) > 1;
            e.count++;
        }
    }
    e.mean /= (double)e.count;
    return e;
}

/* Rounding to codes alone is 0.25 in the mean; what one light adds is cut to 2^-16, or 2^-20 for a dim one. Beyond 1 code:
   never of tables; of spheres, where two images are blended past the rim. */
static void pictures_are_the_sum_of_all_lights(void **state)
{
    static const struct {
        case_model model;
        const char *brdf;
        double mean, worst, off;
    } cases[] = {
        {CASE_TABLE, "sgd:gold-metallic-paint", 0.58, 1.3, 0}, {CASE_TABLE, "sgd:red-fabric", 0.58, 1.3, 0},
        {CASE_TABLE, "sgd:yellow-phenolic", 0.58, 1.3, 0},     {CASE_TABLE_P4, "sgd:gold-paint", 0.58, 1.3, 0},
        {CASE_FINE, "sgd:gold-metallic-paint", 0.58, 1.3, 0},  {CASE_SPHERES, "sgd:gold-paint", 0.35, 3.2, 0.005},
    };
    static const int counts[] = {1, 8, 64, 1024};
    int bad = 0;
    size_t c, i;

    (void)state;
    for (c = 0; c < sizeof cases / sizeof *cases; c++) {
        case_asset a;

        case_asset_open(&a, cases[c].model, cases[c].brdf, 0, NULL);
        for (i = 0; i < sizeof counts / sizeof *counts; i++) {
            const errors e = measure(&a, counts[i]);

            print_message("%-26s model %d, %4d lights: mean %.3f, worst %.2f codes, beyond 1: %ld of %ld\n",
                          cases[c].brdf, cases[c].model, counts[i], e.mean, e.worst, e.off, e.count);
            bad += e.mean > cases[c].mean || e.worst > cases[c].worst || e.off > cases[c].off * e.count;
        }
        case_asset_close(&a);
    }
    assert_int_equal(bad, 0);
}

static void portions_do_not_change_a_bit(void **state)
{
    static uint8_t whole[SIZE * SIZE * 4], part[SIZE * SIZE * 4];
    nacre_view view = make_view(20);
    nacre_soft_lit_desc desc = {.view = &view, .size = SIZE, .format = NACRE_SOFT_RGBA8};
    uint32_t *scratch;
    case_asset a;
    unsigned y;

    (void)state;
    make_lights(20);
    case_asset_open(&a, CASE_TABLE, "sgd:gold-paint", 0, NULL);
    desc.material = &a.material;
    draw(&desc, SIZE, whole);
    draw(&desc, 5, part);
    assert_memory_equal(whole, part, sizeof whole);
    memset(part, 0, sizeof part);
    scratch = malloc(nacre_soft_lit_scratch_size(&desc, 1));
    for (y = SIZE; y-- > 0;) /* row by row, from the bottom, as over many frames */
        assert_int_equal(nacre_soft_lit_rows(&desc, part, y, y + 1, scratch, nacre_soft_lit_scratch_size(&desc, 1)), 0);
    assert_memory_equal(whole, part, sizeof whole);
    free(scratch);
    case_asset_close(&a);
}

static void formats_hold_the_same_codes(void **state)
{
    static uint8_t rgba[SIZE * SIZE * 4], gray[SIZE * SIZE];
    static uint16_t native[SIZE * SIZE], swapped[SIZE * SIZE];
    nacre_view view = make_view(3);
    nacre_soft_lit_desc desc = {.view = &view, .size = SIZE, .format = NACRE_SOFT_RGBA8};
    case_asset a;
    int i;

    (void)state;
    make_lights(3);
    case_asset_open(&a, CASE_TABLE, "sgd:gold-paint", 0, NULL);
    desc.material = &a.material;
    draw(&desc, 8, rgba);
    desc.format = NACRE_SOFT_RGB565;
    draw(&desc, 8, native);
    desc.format = NACRE_SOFT_RGB565_SWAPPED;
    draw(&desc, 8, swapped);
    desc.format = NACRE_SOFT_GRAY8;
    draw(&desc, 8, gray);
    for (i = 0; i < SIZE * SIZE; i++) {
        const uint8_t *c = &rgba[4 * i];
        const double luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];

        assert_int_equal(c[3], 255);
        assert_true(fabs((native[i] >> 11) - c[0] * 31 / 255.0) <= 0.51);
        assert_true(fabs((native[i] >> 5 & 63) - c[1] * 63 / 255.0) <= 0.51);
        assert_true(fabs((native[i] & 31) - c[2] * 31 / 255.0) <= 0.51);
        assert_int_equal(swapped[i], (uint16_t)(native[i] >> 8 | native[i] << 8));
        assert_true(fabs(gray[i] - luminance) <= 1.01);
    }
    case_asset_close(&a);
}

/* A camera that looks at the object from the side: the picture is that of lights turned the other way. */
static void the_view_direction_turns_the_lights(void **state)
{
    static uint8_t turned[SIZE * SIZE * 4], straight[SIZE * SIZE * 4];
    nacre_view view = make_view(1);
    nacre_soft_lit_desc desc = {.view = &view, .size = SIZE, .format = NACRE_SOFT_RGBA8};
    case_asset a;
    int i, worst = 0;

    (void)state;
    memset(lights, 0, sizeof *lights);
    lights[0].power = nacre_rgb_from_float(3, 3, 3);
    case_asset_open(&a, CASE_TABLE, "sgd:gold-paint", 0, NULL);
    desc.material = &a.material;
    /* perspective; the object is 45 degrees to the right, so that the eye is at (-1, 0, 1) of it */
    view.view_to_clip.m[11] = -NACRE_Q16_ONE;
    view.view_to_clip.m[15] = 0;
    view.object_to_view.m[12] = 4 * NACRE_Q16_ONE;
    view.object_to_view.m[14] = -4 * NACRE_Q16_ONE;
    lights[0].direction = nacre_dir_from_float(0, 0, 1); /* 45 degrees to the right of that eye */
    draw(&desc, 8, turned);
    view = make_view(1);
    lights[0].direction = nacre_dir_from_float(0.70710678f, 0, 0.70710678f);
    draw(&desc, 8, straight);
    for (i = 0; i < SIZE * SIZE * 4; i++)
        worst = abs(turned[i] - straight[i]) > worst ? abs(turned[i] - straight[i]) : worst;
    assert_in_range(worst, 0, 1);
    case_asset_close(&a);
}

static void mistakes_are_refused_and_memory_is_kept_to(void **state)
{
    static uint8_t picture[SIZE * SIZE * 4];
    nacre_view view = make_view(2);
    nacre_soft_lit_desc desc = {.view = &view, .size = SIZE, .format = NACRE_SOFT_RGBA8}, bad;
    case_asset a, varying;
    size_t size;
    workspace room, pixels;

    (void)state;
    make_lights(2);
    case_asset_open(&a, CASE_TABLE, "sgd:gold-paint", 0, NULL);
    case_asset_open(&varying, CASE_SBRDF, NULL, 0, NULL);
    desc.material = &a.material;
    size = nacre_soft_lit_scratch_size(&desc, 1);
    workspace_make(&room, size, WORKSPACE_FAULT_BEFORE);
    workspace_make(&pixels, sizeof picture, WORKSPACE_FAULT_BEFORE);
    assert_int_equal(nacre_soft_lit_rows(&desc, pixels.data, 0, SIZE, room.data, size), NACRE_OK);
    assert_true(workspace_intact(&room));
    assert_true(workspace_intact(&pixels));

    assert_int_equal(nacre_soft_lit_rows(&desc, picture, 0, SIZE, room.data, size - 1), NACRE_ERR_MEMORY);
    assert_int_equal(nacre_soft_lit_rows(&desc, picture, 3, 3, room.data, 0), NACRE_OK);
    assert_int_equal(nacre_soft_lit_rows(&desc, picture, 4, 3, room.data, size), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_soft_lit_rows(&desc, picture, 0, SIZE + 1, room.data, size), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_soft_lit_rows(&desc, NULL, 0, 1, room.data, size), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_soft_lit_rows(NULL, picture, 0, 1, room.data, size), NACRE_ERR_ARGUMENT);
    bad = desc;
    bad.size = 7;
    assert_int_equal(nacre_soft_lit_rows(&bad, picture, 0, 1, room.data, size), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_soft_lit_scratch_size(&bad, 1), 0);
    bad = desc;
    bad.format = 4;
    assert_int_equal(nacre_soft_lit_rows(&bad, picture, 0, 1, room.data, size), NACRE_ERR_ARGUMENT);
    view.light_count = MOST_LIGHTS + 1;
    assert_int_equal(nacre_soft_lit_rows(&desc, picture, 0, 1, room.data, size), NACRE_ERR_ARGUMENT);
    view = make_view(2);
    lights[1].type = NACRE_LIGHT_POINT;
    assert_int_equal(nacre_soft_lit_rows(&desc, picture, 0, 1, room.data, size), NACRE_ERR_UNSUPPORTED);
    lights[1].type = NACRE_LIGHT_DIRECTIONAL;
    bad = desc;
    bad.material = &varying.material;
    assert_int_equal(nacre_soft_lit_rows(&bad, picture, 0, 1, room.data, size), NACRE_ERR_UNSUPPORTED);
    assert_true(workspace_intact(&room));
    workspace_free(&room);
    workspace_free(&pixels);
    case_asset_close(&a);
    case_asset_close(&varying);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_are_those_of_the_bisector_map),
        cmocka_unit_test(pictures_are_the_sum_of_all_lights),
        cmocka_unit_test(portions_do_not_change_a_bit),
        cmocka_unit_test(formats_hold_the_same_codes),
        cmocka_unit_test(the_view_direction_turns_the_lights),
        cmocka_unit_test(mistakes_are_refused_and_memory_is_kept_to),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
