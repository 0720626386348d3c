/* SPDX-License-Identifier: MIT */
/* Lists of bakes: both notations give the same items, and every mistake is told by its line, with what was found and what
   was expected. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "manifest.h"

#include <cmocka.h> /* last: it makes fail a macro */

static manifest parse(const char *text)
{
    manifest m = {0};
    failure f = {0};
    if (manifest_parse(&m, text, strlen(text), "list", &f)) fail_msg("%s", f.text);
    return m;
}

static void check_item(const manifest_item *item, int line, const char *brdf_name, const char *kind,
                       const char *options, const char *output)
{
    assert_int_equal(item->line, line);
    assert_string_equal(item->brdf, brdf_name);
    assert_string_equal(item->kind, kind);
    assert_string_equal(item->options, options);
    assert_string_equal(item->output, output);
    assert_string_equal(item->request.brdf, brdf_name);
    assert_string_equal(item->request.kind->name, kind);
}

static void a_list_of_names_is_csv(void **state)
{
    (void)state;
    manifest m = parse("sgd:brass\n/data/gold.binary\n");
    assert_int_equal(m.count, 2);
    check_item(&m.item[0], 1, "sgd:brass", "table", "", "sgd-brass-table.ktx2");
    check_item(&m.item[1], 2, "/data/gold.binary", "table", "", "gold-table.ktx2");
    manifest_free(&m);
}

static void csv_columns_in_the_usual_order(void **state)
{
    (void)state;
    manifest m = parse("\xef\xbb\xbf# all of it\r\n\r\n gold.binary , table , --tier fine \r\n"
                       "\"ggx:rough=.3,f0=.04\",spheres,--size 64,metals/rough.ktx2\r\n"
                       "  # \"not, a quote\nmerl:a/b.c.dat,,--size=16x8\n"
                       "\"odd \"\"name\"\",\",spheres,--no-pad --polar 0,odd.ktx2");
    assert_int_equal(m.count, 4);
    check_item(&m.item[0], 3, "gold.binary", "table", "--tier fine", "gold-table-fine.ktx2");
    assert_int_equal(m.item[0].request.table.tier, TABLE_FINE);
    check_item(&m.item[1], 4, "ggx:rough=.3,f0=.04", "spheres", "--size 64", "metals/rough.ktx2");
    assert_int_equal(m.item[1].request.spheres.size, 64);
    check_item(&m.item[2], 6, "merl:a/b.c.dat", "table", "--size=16x8", "b.c-table-16x8.ktx2");
    assert_int_equal(m.item[2].request.table.width, 16);
    assert_int_equal(m.item[2].request.table.height, 8);
    check_item(&m.item[3], 7, "odd \"name\",", "spheres", "--no-pad --polar 0", "odd.ktx2");
    assert_int_equal(m.item[3].request.spheres.no_pad, 1);
    manifest_free(&m);
}

static void csv_columns_named_by_a_first_line(void **state)
{
    (void)state;
    manifest m = parse("output,options,brdf\nb.ktx2,--tier rgb,sgd:brass\n,,sgd:brass\n");
    assert_int_equal(m.count, 2);
    check_item(&m.item[0], 2, "sgd:brass", "table", "--tier rgb", "b.ktx2");
    check_item(&m.item[1], 3, "sgd:brass", "table", "", "sgd-brass-table.ktx2");
    manifest_free(&m);
}

static void quoted_fields_may_hold_lines(void **state)
{
    (void)state;
    manifest m = parse("sgd:brass,table,\"--tier fine\n--size 8x8\"\nsgd:nickel\n");
    check_item(&m.item[0], 1, "sgd:brass", "table", "--tier fine\n--size 8x8", "sgd-brass-table-fine-8x8.ktx2");
    assert_int_equal(m.item[0].request.table.width, 8);
    assert_int_equal(m.item[1].line, 3);
    manifest_free(&m);
}

static void json_lines_say_the_same(void **state)
{
    (void)state;
    manifest m =
        parse("\n# first\n{\"brdf\": \"gold.binary\", \"options\": \"--tier fine\"}\n"
              "{\"kind\": \"spheres\", \"brdf\": \"ggx:rough=.3,f0=.04\", \"output\": \"a.ktx2\", "
              "\"options\": {\"size\": 64, \"no-pad\": true, \"format\": \"etc1\"}} \r\n"
              "{\"brdf\": \"sgd:brass\", \"options\": {\"power\": 4.8, \"tier\": \"rgb\", \"size\": \"8x9\"}}\n"
              "{\"brdf\": \"sgd:brass\", \"kind\": \"spheres\", \"options\": {\"no-pad\": false}}\n");
    assert_int_equal(m.count, 4);
    check_item(&m.item[0], 3, "gold.binary", "table", "--tier fine", "gold-table-fine.ktx2");
    check_item(&m.item[1], 4, "ggx:rough=.3,f0=.04", "spheres", "--size 64 --no-pad --format etc1", "a.ktx2");
    assert_int_equal(m.item[1].request.spheres.no_pad, 1);
    check_item(&m.item[2], 5, "sgd:brass", "table", "--power 4.8 --tier rgb --size 8x9",
               "sgd-brass-table-4.8-rgb-8x9.ktx2");
    check_item(&m.item[3], 6, "sgd:brass", "spheres", "", "sgd-brass-spheres.ktx2");
    assert_int_equal(m.item[3].request.spheres.no_pad, 0);
    manifest_free(&m);
}

static void output_names_are_portable(void **state)
{
    (void)state;
    manifest m =
        parse("\"ggx:rough=.3,albedo=.5/.2/.1\"\nrgl:x y/caf\xc3\xa9.bsdf,spheres,\"--polar 0,60 --no-pad\"\n");
    assert_string_equal(m.item[0].output, "ggx-rough=.3-albedo=.5-.2-.1-table.ktx2");
    assert_string_equal(m.item[1].output, "caf---spheres-0-60-no-pad.ktx2");
    manifest_free(&m);
}

static void mistakes_are_told_by_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says[3];
    } list[] = {
        {"", {"list: ", "no material"}},
        {"# nothing\n\n", {"no material"}},
        {"brdf,kind\n", {"no material"}},
        {"sgd:a,tabel", {"line 1, field kind", "\"tabel\"", "table, spheres"}},
        {"sgd:a\n\nggx:rough=.3,f0=.04\n", {"line 3, field kind", "\"f0=.04\"", "quoted"}},
        {"sgd:a,table,--tier best", {"line 1, field options", "--tier best", "default, fine"}},
        {"sgd:a,table,--size 24x999", {"line 1, field options", "--size", "128"}},
        {"sgd:a,table,--sise 24x21", {"line 1, field options", "--sise", "--size"}},
        {"sgd:a,table,--mode paper", {"line 1, field options", "--mode"}},
        {"sgd:a,table,fine", {"line 1, field options", "fine", "too many"}},
        {"sgd:a,table,--size", {"line 1, field options", "--size", "expected"}},
        {"sgd:a,table,--help", {"line 1, field options", "--help"}},
        {"sgd:a,table,-h", {"line 1, field options", "-h"}},
        {"sgd:a,table,-o x.ktx2", {"line 1, field options", "-o"}},
        {"sgd:a,table,--threads 2", {"line 1, field options", "--threads"}},
        {"sgd:a\n,table", {"line 2, field brdf", "\"\"", "name of a BRDF"}},
        {"-x.binary", {"line 1, field brdf", "\"-x.binary\""}},
        {"a,table,,b.ktx2,more", {"line 1", "5 fields", "at most 4"}},
        {"brdf,kind\na,table,--tier fine", {"line 2", "3 fields", "at most 2"}},
        {"brdf,colour\na,b", {"line 1", "\"colour\"", "brdf, kind, options, output"}},
        {"brdf,kind,brdf\na,table,b", {"line 1", "brdf twice"}},
        {"sgd:a\n  \"sgd:b\nsgd:c", {"line 2, column 3", "quote that never closes"}},
        {"\"sgd:a\"b", {"line 1, column 8", "'b'", "comma"}},
        {"sgd:a,,,x.png", {"line 1, field output", "\"x.png\"", ".ktx2"}},
        {"sgd:a,,,.ktx2", {"line 1, field output", ".ktx2"}},
        {"sgd:a,,,/x.ktx2", {"line 1, field output", "below the output directory"}},
        {"sgd:a,,,../x.ktx2", {"line 1, field output", "below the output directory"}},
        {"sgd:a,,,a/../x.ktx2", {"line 1, field output", "below the output directory"}},
        {"sgd:a,,,./x.ktx2", {"line 1, field output", "below the output directory"}},
        {"sgd:a,,,a//x.ktx2", {"line 1, field output", "below the output directory"}},
        {"sgd:a,,,\"a\nb.ktx2\"", {"line 1, field output", "printable"}},
        {"sgd:a\nsgd:b\nsgd:a,table", {"line 3, field output", "sgd-a-table.ktx2", "line 1's"}},
        {"a/x.binary\nsgd:b,,,q.ktx2\nb/x.binary\nsgd:c,,,q.ktx2", {"line 3, field output", "line 1's"}},
        {"[{\"brdf\": \"a\"}]", {"array", "one object a line"}},
        {"{\"brdf\": \"sgd:a\"\n}", {"line 1, column 16", "one JSON object"}},
        {"{\"brdf\": \"sgd:a\"} {}", {"line 1, column 19", "\"{}\"", "one JSON object"}},
        {"{\"brdf\": \"sgd:a\"}\nsgd:b", {"line 2, column 1", "\"sgd:b\"", "one JSON object"}},
        {"{\"brdf\": \"sgd:a\"}\n7", {"line 2", "a number", "an object"}},
        {"{\"brdf\": 7}", {"line 1, field brdf", "a number", "a text"}},
        {"{\"brdf\": \"a\", \"kind\": null}", {"line 1, field kind", "null", "a text"}},
        {"{\"brdf\": \"a\", \"options\": [\"--tier\"]}", {"line 1, field options", "an array", "a text or an object"}},
        {"{\"brdf\": \"a\", \"options\": {\"tier\": null}}", {"line 1, field options", "null", "\"tier\""}},
        {"{\"brdf\": \"a\", \"options\": {\"tire\": \"fine\"}}", {"line 1, field options", "--tire", "--tier"}},
        {"{\"brdf\": \"a\", \"bytes\": 7}", {"line 1", "\"bytes\"", "brdf, kind, options, output"}},
        {"{\"brdf\": \"a\", \"brdf\": \"b\"}", {"line 1", "brdf twice"}},
        {"# list\n\n[\n", {"array"}},
        {"{\"kind\": \"table\"}", {"line 1, field brdf"}},
        {"{}", {"line 1, field brdf"}},
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        manifest m = {0};
        failure f = {0};
        int code = manifest_parse(&m, list[i].text, strlen(list[i].text), "list", &f);
        int told = code == FAIL_INVALID && !m.item && !strncmp(f.text, "list: ", 6) && !strchr(f.text, '\n');
        for (int k = 0; k < 3 && list[i].says[k]; k++) told = told && strstr(f.text, list[i].says[k]);
        if (!told) fail_msg("%s\n  gave %d: %s", list[i].text, code, f.text);
    }
}

static void zero_bytes_and_long_names_are_refused(void **state)
{
    (void)state;
    manifest m = {0};
    failure f = {0};
    assert_int_equal(manifest_parse(&m, "sgd:a\0b", 7, "list", &f), FAIL_INVALID);
    assert_non_null(strstr(f.text, "offset 5"));
    char text[400];
    memset(text, 'x', sizeof text);
    memcpy(text, "sgd:", 4);
    text[sizeof text - 1] = 0;
    assert_int_equal(manifest_parse(&m, text, strlen(text), "list", &f), FAIL_INVALID);
    assert_non_null(strstr(f.text, "200 characters"));
}

/* Every beginning of a good list is either a list or one line of complaint. */
static void truncations_do_no_harm(void **state)
{
    (void)state;
    static const char *const whole[] = {
        "brdf,kind,options,output\n\"ggx:rough=.3,f0=.04\",spheres,\"--polar 0,60\",\"a "
        "\"\"b\"\".ktx2\"\r\nsgd:brass\n",
        "{\"brdf\": \"ggx:rough=.3\", \"kind\": \"spheres\", \"options\": {\"size\": 64, \"no-pad\": true}}\n# x\n",
    };
    for (int i = 0; i < 2; i++)
        for (size_t size = 0; size <= strlen(whole[i]); size++) {
            manifest m = {0};
            failure f = {0};
            char *exact = malloc(size ? size : 1); /* so that a sanitizer sees a read past the end */
            memcpy(exact, whole[i], size);
            int code = manifest_parse(&m, exact, size, "list", &f);
            assert_true(code ? code == FAIL_INVALID && f.text[0] && !m.item : m.count > 0);
            manifest_free(&m);
            free(exact);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_of_names_is_csv),
        cmocka_unit_test(csv_columns_in_the_usual_order),
        cmocka_unit_test(csv_columns_named_by_a_first_line),
        cmocka_unit_test(quoted_fields_may_hold_lines),
        cmocka_unit_test(json_lines_say_the_same),
        cmocka_unit_test(output_names_are_portable),
        cmocka_unit_test(mistakes_are_told_by_line),
        cmocka_unit_test(zero_bytes_and_long_names_are_refused),
        cmocka_unit_test(truncations_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
