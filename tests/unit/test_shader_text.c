/* SPDX-License-Identifier: MIT */
/* Keys, names and assembled texts. What compilers say of the texts is test_compile's business. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "key.h"

#include <cmocka.h>

static gles_key *keys;
static unsigned count;

static int open_list(void **unused)
{
    (void)unused;
    count = gles_key_list(NULL, 0);
    keys = calloc(count, sizeof *keys);
    return !keys || gles_key_list(keys, count) != count;
}

static int close_list(void **unused)
{
    (void)unused;
    free(keys);
    return 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void names_are_unique_and_keys_canonical(void **unused)
{
    char(*name)[GLES_KEY_NAME_SIZE] = calloc(count, sizeof *name), **sorted = calloc(count, sizeof *sorted);

    (void)unused;
    for (unsigned i = 0; i < count; i++) {
        gles_key same = keys[i];

        gles_key_canonical(&same);
        assert_memory_equal(&same, &keys[i], sizeof same);
        gles_key_name(&keys[i], name[i]);
        assert_true(strlen(name[i]) < GLES_KEY_NAME_SIZE);
        sorted[i] = name[i];
    }
    qsort(sorted, count, sizeof *sorted, by_name);
    for (unsigned i = 1; i < count; i++) assert_string_not_equal(sorted[i - 1], sorted[i]);
    free(name);
    free(sorted);
}

static void names_follow_the_pattern(void **unused)
{
    static const struct {
        gles_key key;
        const char *name;
    } cases[] = {
        {{.model = GLES_KEY_TABLE, .phid = 1, .lights = 1, .power48 = 1}, "table_phid_l1_dist_srgb"},
        {{.model = GLES_KEY_TABLE, .phid = 1, .lights = 1, .power48 = 1, .toe = 1}, "table_phid_l1_dist_srgb_toe"},
        {{.model = GLES_KEY_TABLE, .lights = 1, .output = NACRE_OUTPUT_SQRT}, "table_l1_dist_sqrt"},
        {{.model = GLES_KEY_TABLE, .lights = 2, .output = NACRE_OUTPUT_SQRT, .power48 = 1}, "table_l2_dist_sqrt_p48"},
        {{.model = GLES_KEY_TABLE, .lights = 1, .output = NACRE_OUTPUT_LINEAR}, "table_l1_dist_lin_p4"},
        {{.model = GLES_KEY_FINE, .phid = 1, .lights = 3, .persp = 1, .power48 = 1, .normal_map = 1, .es3 = 1},
         "es3_fine_l3_persp_srgb_nm"},
        {{.model = GLES_KEY_SPHERES, .lights = 1, .output = NACRE_OUTPUT_SQRT}, "spheres_l1_dist_sqrt"},
        {{.model = GLES_KEY_SPHERES, .lights = 8, .persp = 1, .layers = 4, .ambient = 1}, "spheres_l8_persp_srgb_amb"},
        {{.model = GLES_KEY_PAPER, .lights = 1, .persp = 1, .layers = 6}, "paper_l1_persp_srgb_s6"},
        {{.model = GLES_KEY_TABLE, .ambient = 1}, "table_l0_dist_srgb_amb"},
        {{.model = GLES_KEY_TABLE, .pass = GLES_PASS_LAST}, "table_l0_dist_srgb_pass2"},
    };

    (void)unused;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char name[GLES_KEY_NAME_SIZE];

        gles_key_name(&cases[i].key, name);
        assert_string_equal(name, cases[i].name);
    }
}

static char *assemble(const gles_key *key, int fragment)
{
    const char *part[GLES_TEXT_PARTS];
    int length[GLES_TEXT_PARTS];
    char defines[GLES_DEFINES_SIZE];
    size_t size = 0;
    const int parts = gles_text(key, fragment, part, length, defines);

    assert_in_range(parts, 1, GLES_TEXT_PARTS);
    for (int i = 0; i < parts; i++) size += (size_t)length[i];
    char *text = malloc(size + 1), *at = text;
    assert_non_null(text);
    for (int i = 0; i < parts; at += length[i++]) memcpy(at, part[i], (size_t)length[i]);
    *at = 0;
    assert_int_equal(strlen(text), size); /* no NUL inside */
    return text;
}

static void every_key_assembles(void **unused)
{
    (void)unused;
    for (unsigned i = 0; i < count; i++)
        for (int fragment = 0; fragment < 2; fragment++) {
            char *text = assemble(&keys[i], fragment), number[64];

            assert_int_equal(strncmp(text, keys[i].es3 ? "#version 300 es\n" : "#version 100\n", keys[i].es3 ? 16 : 13),
                             0);
            snprintf(number, sizeof number, "#define LIGHTS %d\n", keys[i].lights);
            assert_non_null(strstr(text, number));
            assert_non_null(strstr(text, "void main()"));
            free(text);
        }
}

/* Beside the names, texts of different keys differ: no key is wasted. */
static void texts_differ(void **unused)
{
    char **text = calloc(count, sizeof *text);

    (void)unused;
    for (unsigned i = 0; i < count; i++) text[i] = assemble(&keys[i], 1);
    qsort(text, count, sizeof *text, by_name);
    for (unsigned i = 1; i < count; i++) assert_string_not_equal(text[i - 1], text[i]);
    for (unsigned i = 0; i < count; i++) free(text[i]);
    free(text);
}

static void fits_what_es2_guarantees(void **unused)
{
    (void)unused;
    for (unsigned i = 0; i < count; i++) {
        assert_in_range(gles_key_units(&keys[i]), 0, 8);
        if (keys[i].lights < 2) assert_in_range(gles_key_uniform_vectors(&keys[i]), 0, 16);
    }
}

static void units_follow_each_other(void **unused)
{
    (void)unused;
    for (unsigned i = 0; i < count; i++) {
        const gles_key *k = &keys[i];
        unsigned next = gles_key_units(k) - (k->pass ? 2 : 0) - (k->normal_map ? 1 : 0) - (k->mask ? 1 : 0);

        assert_int_equal(gles_key_unit_normal(k), k->normal_map ? (int)next++ : -1);
        assert_int_equal(gles_key_unit_mask(k), k->mask ? (int)next++ : -1);
        assert_int_equal(gles_key_unit_sum(k), k->pass ? (int)next : -1);
    }
}

static void light_counts_follow_the_device(void **unused)
{
    gles_key key;

    (void)unused;
    memset(&key, 0, sizeof key);
    key.phid = key.power48 = 1;
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_NONE, 16, 8), 5);
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_NONE, 64, 8), 8);
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_SUM, 16, 8), 4);
    key.model = GLES_KEY_SPHERES;
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_NONE, 16, 8), 2);
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_NONE, 64, 8), 4);
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_NONE, 64, 16), 8);
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_SUM, 64, 8), 2);
    key.normal_map = 1;
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_SUM, 64, 8), 2);
    key.persp = 1;
    key.layers = 8;
    assert_int_equal(gles_key_max_lights(&key, GLES_PASS_NONE, 64, 8), 0); /* 8 layers and a normal map: too many */
    assert_int_equal(gles_key_layer_class(2, 8), 4);
    assert_int_equal(gles_key_layer_class(4, 8), 4);
    assert_int_equal(gles_key_layer_class(5, 8), 6);
    assert_int_equal(gles_key_layer_class(7, 7), 6);
    assert_int_equal(gles_key_layer_class(64, 8), 8);
    assert_int_equal(gles_key_layer_class(64, 5), 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_unique_and_keys_canonical),
        cmocka_unit_test(names_follow_the_pattern),
        cmocka_unit_test(every_key_assembles),
        cmocka_unit_test(texts_differ),
        cmocka_unit_test(fits_what_es2_guarantees),
        cmocka_unit_test(units_follow_each_other),
        cmocka_unit_test(light_counts_follow_the_device),
    };
    return cmocka_run_group_tests(tests, open_list, close_list);
}
