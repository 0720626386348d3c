/* SPDX-License-Identifier: MIT */
/* Codes of spatially varying materials, the power table, and the files of both. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ktx2_write.h"
#include "nacre_asset.h"
#include "power_file.h"
#include "sbrdf_map.h"
#include "shade.h"

#include <cmocka.h> /* last: it makes fail a macro */

static const double pi = 3.14159265358979323846;

/* ---- codes --------------------------------------------------------------------------------------------------------- */

static void every_code_comes_back(void **state)
{
    (void)state;
    static const double most[] = {1, 2, 1.37};
    for (int code = 0; code < 256; code++) {
        assert_int_equal(sbrdf_exponent_code(sbrdf_exponent_value(code)), code);
        for (int i = 0; i < 3; i++) {
            assert_int_equal(sbrdf_shape_code(sbrdf_shape_value(code, most[i]), most[i]), code);
            assert_int_equal(sbrdf_albedo_code(sbrdf_albedo_value(code, most[i]), most[i]), code);
        }
    }
}

static void ends_are_exact_and_saturate(void **state)
{
    (void)state;
    assert_true(sbrdf_shape_value(128, 1) == 0);
    assert_true(sbrdf_shape_value(255, 1) == 1);
    assert_true(sbrdf_shape_value(1, 2) == -2);
    assert_true(sbrdf_exponent_value(255) == 255);
    assert_int_equal(sbrdf_exponent_code(1e9), 255);
    assert_int_equal(sbrdf_exponent_code(-1), 0);
    assert_int_equal(sbrdf_shape_code(-9, 1), 0);
    assert_int_equal(sbrdf_shape_code(9, 1), 255);
    assert_int_equal(sbrdf_albedo_code(NAN, 1), 0);
}

/* The useful direction of McAllister et al.'s remap: n = 1, 2, 3, 5, 10, 20 keep two digits. */
static void small_exponents_stay_apart(void **state)
{
    (void)state;
    static const double n[] = {1, 2, 3, 5, 10, 20}, back[] = {1.00, 2.07, 3.07, 5.08, 9.80, 19.77};
    for (int i = 0; i < 6; i++) assert_true(fabs(sbrdf_exponent_value(sbrdf_exponent_code(n[i])) - back[i]) < 0.005);
}

/* ---- powers -------------------------------------------------------------------------------------------------------- */

static void tables_hold_what_they_say(void **state)
{
    (void)state;
    for (int i = 0; i <= 256; i++) {
        assert_true(fabs(shade_log2_table[i] - 16777216 * log2(1 + i / 256.0)) <= 0.5);
        assert_true(fabs(shade_exp2_table[i] - 2147483648.0 * exp2(-i / 256.0)) <= 0.5);
    }
}

/* shade.h promises 2^-17 + 1.5e-4 of the value: two interpolations, of log2 (2.8e-6, x 255 ln 2) and of 2^x. */
static void fixed_powers_are_near(void **state)
{
    (void)state;
    for (uint32_t code = 0; code < 256; code++) {
        int32_t n = shade_exponent_q16(code);
        assert_true(fabs(n / 65536.0 - code * code / 255.0) <= 1.5 / 65536.0);
        for (int i = 0; i <= 4096; i++) {
            int32_t x = i < 4096 ? (int32_t)(268435456 * pow(i / 4096.0, 0.3)) : 268435456;
            double exact = x > 0 ? pow(x / 268435456.0, n / 65536.0) : 0;
            double off = fabs(shade_power_q16(x, n) / 65536.0 - exact);
            if (off > 1.01 / 131072 + 1.5e-4 * exact)
                fail_msg("x %.9g n %.9g: off by %.3g of %.9g", x / 268435456.0, n / 65536.0, off, exact);
        }
    }
    assert_int_equal(shade_power_q16(-5, 65536), 0);
    assert_int_equal(shade_power_q16(INT32_MAX, 255 * 65536), 65536);
}

/* Linear filtering of 256 x 256: .002 at n = 50, .025 at n = 255 for x in 0.5..1 is what sampled texels of x^n reach. Roots
   keep to that, and are off by half a code of what displays show and the chords' error. */
static void filtered_powers_are_near(void **state)
{
    (void)state;
    power_file p = {256, 256};
    print_message("x^n: %.4f at n = 50, %.4f at n = 255; roots %.4f, %.4f\n", power_file_error(&p, 50),
                  power_file_error(&p, 255), power_file_root_error(&p, 50), power_file_root_error(&p, 255));
    assert_true(power_file_error(&p, 50) <= 0.002);
    assert_true(power_file_error(&p, 255) <= 0.025);
    assert_true(power_file_root_error(&p, 50) <= 0.0005 + 0.5 / 255);
    assert_true(power_file_root_error(&p, 255) <= 0.005 + 0.5 / 255);
    assert_true(power_file_sample(&p, 1, 255) == 1);
}

/* ---- maps ---------------------------------------------------------------------------------------------------------- */

static sbrdf_map random_map(int width, int height, int lobes, int has_direction)
{
    sbrdf_map m;
    uint32_t random = 7;
    sbrdf_map_make(&m, width, height, lobes, has_direction, 0);
    for (int i = 0; i < m.levels; i++) {
        size_t size = 4 * (size_t)sbrdf_level_width(&m, i) * (size_t)sbrdf_level_height(&m, i);
        for (size_t k = 0; k < size; k++) m.albedo[i][k] = (uint8_t)((random = random * 1664525 + 1013904223) >> 24);
        for (size_t k = 0; k < size * (size_t)m.layers; k++)
            m.lobe[i][k] = (uint8_t)((random = random * 1664525 + 1013904223) >> 24);
    }
    m.albedo_most = 0.75;
    for (int j = 0; j < lobes; j++) {
        m.most[j] = 2.5 * (j + 1);
        m.shape_most[j] = 1 + 0.5 * j;
    }
    m.white_sky[1] = 0.25;
    snprintf(m.name, sizeof m.name, "noise");
    return m;
}

typedef struct pair {
    bytes file[2];
    nacre_image image[2];
} pair;

static void write_pair(const sbrdf_map *m, pair *p)
{
    memset(p, 0, sizeof *p);
    sbrdf_map_write(m, &p->file[0], &p->file[1]);
    for (int i = 0; i < 2; i++) assert_int_equal(nacre_image_open(&p->image[i], p->file[i].data, p->file[i].size), 0);
}

static void free_pair(pair *p)
{
    bytes_free(&p->file[0]);
    bytes_free(&p->file[1]);
}

static void files_come_back(void **state)
{
    (void)state;
    for (int lobes = 1; lobes <= 3; lobes++)
        for (int direction = 0; direction < 2; direction++) {
            sbrdf_map m = random_map(8, 4, lobes, direction), back;
            pair p;
            failure f = {0};
            write_pair(&m, &p);
            assert_int_equal(p.image[1].layers, direction && lobes == 1 ? 3 : 2 * lobes);
            if (sbrdf_map_read(&back, &p.image[0], "a", &p.image[1], "l", &f)) fail_msg("%s", f.text);
            assert_int_equal(back.levels, 4);
            for (int i = 0; i < m.levels; i++) {
                size_t size = 4 * (size_t)sbrdf_level_width(&m, i) * (size_t)sbrdf_level_height(&m, i);
                assert_memory_equal(m.albedo[i], back.albedo[i], size);
                assert_memory_equal(m.lobe[i], back.lobe[i], size * (size_t)m.layers);
            }
            assert_true(back.most[lobes - 1] == m.most[lobes - 1] &&
                        back.shape_most[lobes - 1] == m.shape_most[lobes - 1]);
            assert_true(back.albedo_most == 0.75 && back.white_sky[1] == 0.25);
            assert_string_equal(back.name, "noise");
            sbrdf_map_free(&m);
            sbrdf_map_free(&back);
            free_pair(&p);
        }
}

/* The formula of nacre_asset.h, from the bytes, for one texel and pair of directions. */
static void texel_is_what_the_profile_says(void **state)
{
    (void)state;
    sbrdf_map m = random_map(4, 4, 2, 1);
    const int x = 2, y = 1, at = 4 * (y * 4 + x), layer = 4 * 16;
    const uint8_t *lobe = m.lobe[0] + at;
    double dx = (lobe[3] - 128) / 127.0, dy = (lobe[2 * layer + 3] - 128) / 127.0, length = sqrt(dx * dx + dy * dy);
    double l[3] = {0.48, 0.6, 0.64}, v[3] = {-0.6, 0.48, 0.64}, f_r[3];
    dx /= length;
    dy /= length;
    double across_l[3] = {dx * l[0] + dy * l[1], -dy * l[0] + dx * l[1], l[2]};
    double across_v[3] = {dx * v[0] + dy * v[1], -dy * v[0] + dx * v[1], v[2]};
    sbrdf_texel t;
    sbrdf_map_texel(&m, 0, x, y, &t);
    sbrdf_texel_eval(&t, l, v, f_r);
    for (int c = 0; c < 3; c++) {
        double expected = 0.75 * m.albedo[0][at + c] / 255;
        for (int j = 0; j < 2; j++) {
            const uint8_t *albedo = lobe + 2 * j * layer, *shape = albedo + layer;
            double sum = 0, n = 255 * (shape[3] / 255.0) * (shape[3] / 255.0);
            for (int k = 0; k < 3; k++) sum += m.shape_most[j] * (shape[k] - 128) / 127.0 * across_l[k] * across_v[k];
            if (sum > 0) expected += m.most[j] * albedo[c] / 255 * pow(sum, n);
        }
        assert_true(fabs(pi * f_r[c] - expected) < 1e-12 * (1 + expected));
    }
    assert_true(fabs(t.alpha - m.albedo[0][at + 3] / 255.0) < 1e-15);
    sbrdf_map_free(&m);
}

static void sampling_filters_codes(void **state)
{
    (void)state;
    sbrdf_map m = random_map(4, 4, 1, 0);
    sbrdf_texel a, b, t, wrapped;
    sbrdf_map_texel(&m, 0, 1, 2, &a);
    sbrdf_map_texel(&m, 0, 2, 2, &b);
    sbrdf_map_sample(&m, 1.5 / 4, 1 - 2.5 / 4, 0, &t);
    assert_memory_equal(&a, &t, sizeof t);
    sbrdf_map_sample(&m, 2.0 / 4, 1 - 2.5 / 4, 0, &t);
    assert_true(fabs(t.brdf.kd[1] - (a.brdf.kd[1] + b.brdf.kd[1]) / 2) < 1e-12);
    assert_true(fabs(sqrt(t.brdf.lobe[0].n) - (sqrt(a.brdf.lobe[0].n) + sqrt(b.brdf.lobe[0].n)) / 2) < 1e-12);
    sbrdf_map_sample(&m, 2.0 / 4 - 3, 5 - 2.5 / 4, 0, &wrapped);
    assert_true(fabs(t.brdf.kd[0] - wrapped.brdf.kd[0]) < 1e-12);
    sbrdf_map_texel(&m, 1, 0, 0, &a); /* lod 1.5 at a centre of level 1, whose level 2 has one texel */
    sbrdf_map_texel(&m, 2, 0, 0, &b);
    sbrdf_map_sample(&m, 0.25, 0.75, 1.5, &t);
    assert_true(fabs(t.brdf.lobe[0].ks[2] - (a.brdf.lobe[0].ks[2] + b.brdf.lobe[0].ks[2]) / 2) < 1e-12);
    sbrdf_map_free(&m);
}

static void expect_refused(const pair *p, const char *says)
{
    sbrdf_map back;
    failure f = {0};
    assert_int_equal(sbrdf_map_read(&back, &p->image[0], "a.ktx2", &p->image[1], "l.ktx2", &f), FAIL_INVALID);
    if (!strstr(f.text, says)) fail_msg("found '%s', expected '%s' in it", f.text, says);
}

/* Change the value of a q16 or u32 key in place. */
static void poke(pair *p, int file, const char *key, unsigned index, uint32_t value)
{
    uint32_t size;
    const uint8_t *at = nacre_image_key(&p->image[file], key, &size);
    assert_non_null(at);
    assert_true(size > 4 * index);
    uint8_t *to = p->file[file].data + (at - p->file[file].data) + 4 * index;
    for (int i = 0; i < 4; i++) to[i] = (uint8_t)(value >> 8 * i);
}

static void wrong_files_are_refused(void **state)
{
    (void)state;
    static const struct {
        int file;
        const char *key;
        unsigned index;
        uint32_t value;
        const char *says;
    } change[] = {
        {0, NACRE_KEY_MOST, 0, 0, "a.ktx2: key nacre.max_value: found 0"},
        {1, NACRE_KEY_MOST, 1, (uint32_t)-65536, "l.ktx2: key nacre.max_value: found -1"},
        {1, NACRE_KEY_SHAPE, 0, 65535, "key nacre.shape_max: found 0.99"},
        {1, NACRE_KEY_SHAPE, 1, 3 * 65536, "key nacre.shape_max: found 3, expected 1..2"},
        {1, NACRE_KEY_LOBES, 0, 0, "key nacre.lobes: expected 1..3"},
        {1, NACRE_KEY_LOBES, 0, 4, "key nacre.lobes: expected 1..3"},
        {1, NACRE_KEY_LOBES, 0, 3, "found 4 layers, expected 6 for 3 lobes"},
        {1, NACRE_KEY_DIRECTION, 0, 2, "key nacre.direction: expected 0 or 1"},
    };
    sbrdf_map m = random_map(4, 4, 2, 0), other = random_map(8, 4, 2, 0);
    pair p, wide;
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        write_pair(&m, &p);
        poke(&p, change[i].file, change[i].key, change[i].index, change[i].value);
        expect_refused(&p, change[i].says);
        free_pair(&p);
    }
    write_pair(&m, &p);
    write_pair(&other, &wide);
    expect_refused(&(pair){.image = {p.image[0], wide.image[1]}},
                   "l.ktx2: found 8 x 4 texels, 4 levels, expected 4 x 4");
    expect_refused(&(pair){.image = {p.image[1], p.image[0]}},
                   "a.ktx2: key nacre.role: found \"lobes\", expected \"albedo\"");
    free_pair(&p);
    free_pair(&wide);
    sbrdf_map_free(&m);
    sbrdf_map_free(&other);
}

/* Below n = 3, code 28, the table's first columns are too wide: it is taken by itself only where no such lobe shows. */
static void tables_serve_exponents_of_3_and_more(void **state)
{
    static const struct {
        int lobes, code, black, serves;
    } list[] = {{1, 28, 0, 1}, {1, 255, 0, 1}, {1, 27, 0, 0}, {1, 0, 0, 0}, {1, 27, 1, 1}, {2, 200, 0, 0}};
    const power_file table = {64, 32};
    bytes file = {0};
    nacre_image power;
    (void)state;
    power_file_write(&table, &file);
    assert_int_equal(nacre_image_open(&power, file.data, file.size), 0);
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        sbrdf_map m = random_map(8, 4, list[i].lobes, 0);
        nacre_material material = {.model = NACRE_MODEL_SBRDF};
        shade_material read;
        pair p;
        for (int level = 0; level < m.levels; level++) {
            const int texels = sbrdf_level_width(&m, level) * sbrdf_level_height(&m, level);
            for (int k = 0; k < texels; k++) m.lobe[level][4 * (texels + k) + 3] = 200;
        }
        /* one texel of the second level */
        m.lobe[1][4 * (4 * 2 + 5) + 3] = (uint8_t)list[i].code;
        for (int k = 0; k < 3; k++) m.lobe[1][4 * 5 + k] = list[i].black ? 0 : 1;
        write_pair(&m, &p);
        material.image[NACRE_ROLE_ALBEDO] = &p.image[0];
        material.image[NACRE_ROLE_LOBES] = &p.image[1];
        assert_int_equal(shade_material_read(&read, &material), 0);
        assert_int_equal(read.is.sbrdf.power_serves, 0); /* no table */
        material.image[NACRE_ROLE_POWER] = &power;
        assert_int_equal(shade_material_read(&read, &material), 0);
        assert_int_equal(read.is.sbrdf.power_serves, list[i].serves);
        free_pair(&p);
        sbrdf_map_free(&m);
    }
    bytes_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_comes_back),
        cmocka_unit_test(ends_are_exact_and_saturate),
        cmocka_unit_test(small_exponents_stay_apart),
        cmocka_unit_test(tables_hold_what_they_say),
        cmocka_unit_test(fixed_powers_are_near),
        cmocka_unit_test(filtered_powers_are_near),
        cmocka_unit_test(tables_serve_exponents_of_3_and_more),
        cmocka_unit_test(files_come_back),
        cmocka_unit_test(texel_is_what_the_profile_says),
        cmocka_unit_test(sampling_filters_codes),
        cmocka_unit_test(wrong_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
