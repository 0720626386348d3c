/* SPDX-License-Identifier: MIT */
/* Names of BRDFs: what opens, what each mistake is answered with, the embedded sets; and what every BRDF offers:
   evaluation with cosine, half-vector coordinates, albedo, exposure. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* before cmocka.h, which defines a macro fail() */
#include "brdf.h"
#include "brdf_kit.h"
#include "models.h"
#include "published.h"

#include <cmocka.h>

static const double pi = 3.14159265358979323846;
static const double normal[3] = {0, 0, 1};

/* The answer is one line with all of words ('|' between them) and the code; nothing is opened. */
static void refused(const char *name, int code, const char *words)
{
    brdf *b = NULL;
    failure f = {0};
    int found = brdf_open(&b, name, &f);
    if (found != code || f.code != code) fail_msg("%s: found code %d (%s), expected %d", name, found, f.text, code);
    assert_null(b);
    assert_null(strchr(f.text, '\n'));
    char list[300], *word, *rest = list;
    snprintf(list, sizeof list, "%s", words);
    while ((word = strsep(&rest, "|"))) {
        if (!strstr(f.text, word)) fail_msg("%s: \"%s\" does not say \"%s\"", name, f.text, word);
    }
}

/* ---- what opens -------------------------------------------------------------------------------------------------------- */

static void every_listed_name_opens(void **state)
{
    (void)state;
    size_t count, of_set[4] = {0, 0, 0, 0};
    const char *const *names = brdf_names(&count);
    assert_int_equal(count, 100 + 86 + 86 + 6);
    for (size_t i = 0; i < count; i++) {
        if (i) assert_true(strcmp(names[i - 1], names[i]) < 0);
        brdf *b = open_name(names[i]);
        assert_string_equal(b->name, names[i]);
        assert_false(b->anisotropic);
        double f_r[3];
        assert_int_equal(b->eval(b, normal, normal, f_r), 1);
        assert_true(f_r[0] > 0 && f_r[1] > 0 && f_r[2] > 0);
        assert_non_null(strstr(b->description, strchr(names[i], ':') + 1));
        for (size_t k = 0; k < 4; k++) {
            size_t length = strlen(published_set(k));
            of_set[k] += strncmp(names[i], published_set(k), length) == 0 && names[i][length] == ':';
        }
        brdf_close(b);
    }
    assert_true(of_set[0] == 100 && of_set[1] == 86 && of_set[2] == 86 && of_set[3] == 6);
    assert_null(published_set(4));
    brdf_close(NULL);
}

static void every_class_is_there(void **state)
{
    (void)state;
    static const char *const classes[] = {"(paint)", "(fabric)", "(plastic)", "(phenolic)", "(metallic-paint)",
                                          "(metal)", "(rubber)", "(wood)",    "(stone)"};
    size_t count;
    const char *const *names = brdf_names(&count);
    for (size_t k = 0; k < sizeof classes / sizeof *classes; k++) {
        int seen = 0;
        for (size_t i = 0; i < count; i++) {
            brdf *b = open_name(names[i]);
            seen += strncmp(names[i], "sgd:", 4) == 0 && strstr(b->description, classes[k]);
            brdf_close(b);
        }
        if (seen < 5) fail_msg("%s: %d materials, expected at least 5", classes[k], seen);
    }
}

static void every_model_opens_with_defaults(void **state)
{
    (void)state;
    size_t count = 0;
    for (; model_name(count); count++) {
        char name[80];
        snprintf(name, sizeof name, "%s:", model_name(count));
        assert_non_null(model_help(count));
        assert_non_null(strstr(model_help(count), name));
        if (strcmp(name, "lafortune:") == 0)
            strcat(name, "kd=.5"); /* without '=' it is the name of a published material */
        brdf_close(open_name(name));
        name[strlen(model_name(count))] = '\0';
        if (strcmp(name, "lafortune") != 0) brdf_close(open_name(name));
    }
    assert_int_equal(count, 6);
    assert_null(model_help(count));
}

static void numbers_and_colours(void **state)
{
    (void)state;
    static const char *const name[] = {"lambert:albedo=.25", "lambert:albedo=0.25/0.25/2.5e-1"};
    for (int i = 0; i < 2; i++) {
        brdf *b = open_name(name[i]);
        double f_r[3];
        b->eval(b, normal, normal, f_r);
        for (int c = 0; c < 3; c++) assert_true(fabs(f_r[c] - 0.25 / pi) < 1e-15);
        brdf_close(b);
    }
    brdf *b = open_name("lambert:albedo=.1/.2/1");
    double f_r[3];
    b->eval(b, normal, normal, f_r);
    assert_true(fabs(f_r[0] * pi - 0.1) < 1e-15 && fabs(f_r[1] * pi - 0.2) < 1e-15 && fabs(f_r[2] * pi - 1) < 1e-15);
    brdf_close(b);
    /* ay follows ax */
    b = open_name("ward:ax=.3");
    assert_false(b->anisotropic);
    brdf_close(b);
    b = open_name("ward:ax=.3,ay=.1");
    assert_true(b->anisotropic);
    brdf_close(b);
}

/* ---- what does not ------------------------------------------------------------------------------------------------------- */

static void unknown_names(void **state)
{
    (void)state;
    refused("sgd:gold-metallic-paimt", 1, "sgd|gold-metallic-paimt|near: gold-metallic-paint");
    refused("sgd:", 1, "found material \"\"|100 names");
    refused("ngan-lafortune:chrom", 1, "86 names|chrome");
    refused("lafortune:skni", 1, "6 names|skin");
    /* no prefix: the sets that have it */
    refused("red-plastic", 1, "found \"red-plastic\"|sgd:red-plastic|ngan-cook-torrance:red-plastic");
    refused("sdg:red-plastic", 1, "near: |sgd:red-plastic");
    refused("nothing-like-it-at-all", 1, "expected FILE.binary|lambert:|ggx:");
    refused("", 1, "found \"\"");
    refused(":", 1, "found \":\"");
    refused("schlick:r=.1", 4, "not supported, expected ggx:");
    char longest[300];
    memset(longest, 'x', sizeof longest);
    memcpy(longest, "lambert:", 8);
    longest[299] = '\0';
    refused(longest, 1, "299 characters|at most 255");
}

static void unknown_parameters(void **state)
{
    (void)state;
    refused("ggx:roughness=.3", 1, "ggx|\"roughness\"|rough, f0, albedo, metal");
    refused("ggx:rough", 1, "without =VALUE");
    refused("ggx:rough=.3,", 1, "found parameter \"\"");
    refused("ggx:,rough=.3", 1, "found parameter \"\"");
    refused("ggx:rough=.3,rough=.4", 1, "rough: found twice");
    refused("ward:a=.3", 1, "kd, ks, ax, ay");
    refused("lafortune:c=1", 1, "kd, cx, cy, cz, n, ks");
    refused("lafortune:n=1", 1, "n before cx");
    char lobes[200] = "lafortune:cx=1";
    for (int i = 0; i < 16; i++) strcat(lobes, ",cx=1");
    refused(lobes, 1, "more than 16 lobes");
}

static void values_out_of_range(void **state)
{
    (void)state;
    static const struct {
        const char *name, *words;
    } cases[] = {
        {"lambert:albedo=1.01", "albedo|\"1.01\"|0..1"},
        {"lambert:albedo=-.01", "\"-.01\"|0..1"},
        {"lambert:albedo=nan", "\"nan\"|0..1"},
        {"lambert:albedo=inf", "\"inf\"|0..1"},
        {"lambert:albedo=1e999", "1e999"},
        {"lambert:albedo=", "\"\""},
        {"lambert:albedo=.5x", "\".5x\""},
        {"lambert:albedo= .5", "\" .5\""},
        {"lambert:albedo=.1/.2", "r/g/b|\".1/.2\""},
        {"lambert:albedo=.1/.2/.3/.4", "\".1/.2/.3/.4\""},
        {"lambert:albedo=.1//.3", "\".1//.3\""},
        {"lambert:albedo=.1/.2/1.3", "\".1/.2/1.3\""},
        {"ggx:rough=0", "rough|0.01..1"},
        {"ggx:rough=.1/.1/.1", "a number within"},
        {"ggx:f0=2", "f0|0..1"},
        {"ggx:metal=1.5", "metal|0..1"},
        {"ward:ax=0", "ax|0.001..2"},
        {"ward:ay=-1", "ay|0.001..2"},
        {"cook-torrance:m=0", "m: |0.001..2"},
        {"cook-torrance:f0=1", "f0|0..0.999"},
        {"blinn-phong:n=-1", "n: |0..1e+06"},
        {"blinn-phong:ks=101", "ks|0..100"},
        {"lafortune:cx=1,n=1e6", "n: |0..100000"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) refused(cases[i].name, 1, cases[i].words);
}

static void files(void **state)
{
    (void)state;
    refused("merl:/nowhere/x", 2, "/nowhere/x: No such file");
    refused("/nowhere/x.binary", 2, "/nowhere/x.binary: No such file");
    refused("/nowhere/x.ktx2", 2, "/nowhere/x.ktx2");
    refused("rgl:/nowhere/x.bsdf", 2, "/nowhere/x.bsdf");
    refused("/nowhere/x.bsdf", 2, "/nowhere/x.bsdf");
    refused("merl:", 1, "merl:FILE");
    char name[] = "/tmp/nacre-names-XXXXXX.ktx2";
    int fd = mkstemps(name, 5);
    assert_int_equal(write(fd, "no asset", 8), 8);
    close(fd);
    refused(name, 3, "found 8 bytes");
    unlink(name);
}

/* ---- embedded sets ---------------------------------------------------------------------------------------------------------- */

static void broken_csv(void **state)
{
    (void)state;
    static const struct {
        const char *csv, *words;
    } cases[] = {
        {"a,metal,1,2,3,4,5,6,7,8\n", "line 1: expected the header"},
        {"# c\nname,class,x\na,metal,1,2,3,4,5,6,7\n", "line 3: wrong number of columns"},
        {"name,class,x\na,metal,1,2,3,4,5,6,7,8,9\n", "line 2: wrong number of columns"},
        {"name,class,x\na,metal,1,2,3,4,5,6,7,x\n", "line 2: found a field that is no finite number"},
        {"name,class,x\na,metal,1,2,3,4,5,6,7,nan\n", "line 2: found a field that is no finite number"},
        {"name,class,x\na,metal,1,2,3,,5,6,7,8\n", "line 2: found an empty field"},
        {"name,class,x\na\n", "line 2: expected a name and a class"},
        {"name,class,x\n,metal,1,2,3,4,5,6,7,8\n", "line 2: expected a name and a class"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        brdf *b = NULL;
        failure f = {0};
        int code = published_parse(&b, "ngan-cook-torrance", "a", cases[i].csv, strlen(cases[i].csv), &f);
        if (code != 70 || b || !strstr(f.text, cases[i].words)) fail_msg("case %zu: code %d, \"%s\"", i, code, f.text);
    }
    /* without the last newline, and with an empty line, it is still good */
    static const char good[] = "# c\n\nname,class,x\na,metal,1,2,3,4,5,6,.5,.25";
    brdf *b = NULL;
    failure f = {0};
    assert_int_equal(published_parse(&b, "ngan-cook-torrance", "a", good, sizeof good - 1, &f), 0);
    double f_r[3], d = 1 / (pi * 0.25 * 0.25);
    b->eval(b, normal, normal, f_r);
    assert_true(fabs(f_r[0] - (1 / pi + 4 * 0.5 * d / pi)) < 1e-12);
    brdf_close(b);
    assert_int_equal(published_parse(&b, "ngan-cook-torrance", "b", good, sizeof good - 1, &f), 1);
    assert_int_equal(published_parse(&b, "no-set", "b", good, sizeof good - 1, &f), 1);
    assert_int_equal(published_open(&b, "no-set", "b", &f), 1);
    assert_int_equal(model_open(&b, "no-model", NULL, &f), 1);
}

/* ---- what every BRDF offers --------------------------------------------------------------------------------------------------- */

static void half_vector_round_trip(void **state)
{
    (void)state;
    for (double h = 0; h < 1.5; h += 0.25) {
        for (double d = 0; d < 1.5; d += 0.25) {
            for (double p = 0; p < 6.2; p += 0.5) {
                double l[3], v[3], sum[3], difference[3], cosine = 0, ll = 0, vv = 0;
                half_to_directions(h, d, p, l, v);
                for (int c = 0; c < 3; c++) {
                    cosine += l[c] * v[c];
                    ll += l[c] * l[c];
                    vv += v[c] * v[c];
                    sum[c] = (l[c] + v[c]) / (2 * cos(d));
                    difference[c] = (l[c] - v[c]) / 2;
                }
                /* unit vectors, 2 d apart, with the half vector at (h, azimuth 0) */
                assert_true(fabs(ll - 1) < 1e-14 && fabs(vv - 1) < 1e-14 && fabs(cosine - cos(2 * d)) < 1e-14);
                assert_true(fabs(sum[0] - sin(h)) < 1e-13 && fabs(sum[1]) < 1e-13 && fabs(sum[2] - cos(h)) < 1e-13);
                /* the difference turned back by h lies at azimuth p */
                double x = difference[0] * cos(h) - difference[2] * sin(h);
                assert_true(fabs(x - sin(d) * cos(p)) < 1e-14 && fabs(difference[1] - sin(d) * sin(p)) < 1e-14);
            }
        }
    }
}

static void cosine_and_horizon(void **state)
{
    (void)state;
    brdf *b = open_name("lambert:albedo=.6");
    double l[3] = {0.6, 0, 0.8}, down[3] = {0, 0.6, -0.8}, level[3] = {0, 1, 0}, out[3];
    assert_int_equal(brdf_eval_cosine(b, l, normal, out), 1);
    assert_true(fabs(out[0] - 0.6 / pi * 0.8) < 1e-15);
    const double *const dark[] = {down, level};
    for (int i = 0; i < 2; i++) {
        out[0] = out[1] = out[2] = 7;
        assert_int_equal(brdf_eval_cosine(b, l, dark[i], out), 1);
        assert_true(out[0] == 0 && out[1] == 0 && out[2] == 0);
        out[0] = 7;
        brdf_eval_cosine(b, dark[i], l, out);
        assert_true(out[0] == 0);
    }
    brdf_close(b);
}

/* A mirror-like lobe keeps nearly everything (f0 = 1), one of f0 = .04 about its Fresnel mean; a lobe of n = 0 and
   Lambert are constants. */
static void albedo(void **state)
{
    (void)state;
    double a[3];
    brdf *b = open_name("ggx:rough=.05,f0=1,albedo=0");
    brdf_albedo(b, a);
    assert_true(a[0] > 0.998 && a[0] < 1.001);
    brdf_close(b);
    /* Schlick's term alone: integral of 2 c (f0 + (1 - f0)(1 - c)^5) = f0 + (1 - f0) / 21 */
    b = open_name("ggx:rough=.1,f0=.04,albedo=0");
    brdf_albedo(b, a);
    assert_true(fabs(a[0] - (0.04 + 0.96 / 21)) < 0.001);
    brdf_close(b);
    b = open_name("lafortune:cx=0,cz=1,n=0,ks=.1");
    brdf_albedo(b, a);
    assert_true(fabs(a[0] - 0.1 * pi) < 1e-12);
    brdf_close(b);
}

static int compare(const void *a, const void *b)
{
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

/* Lambert: .35 / (albedo x median of n.l over the lit pixels), by counting them; then both ends of the clip. */
static void exposure(void **state)
{
    (void)state;
    static double lit[4096];
    size_t count = 0;
    for (int i = 0; i < 4096; i++) {
        double x = (2 * (i % 64) + 1) / 64.0 - 1, y = 1 - (2 * (i / 64) + 1) / 64.0, z2 = 1 - x * x - y * y;
        double n_dot_l = z2 > 0 ? (x + sqrt(z2)) / sqrt(2) : 0;
        if (n_dot_l > 0.05) lit[count++] = n_dot_l;
    }
    qsort(lit, count, sizeof *lit, compare);
    double median = (lit[count / 2] + lit[(count - 1) / 2]) / 2;
    static const struct {
        const char *name;
        double luminance;
    } cases[] = {{"lambert:albedo=.5", 0.5}, {"lambert:albedo=1/0/0", 0.2126}, {"lambert:albedo=0/1/.5", 0.7513}};
    for (int i = 0; i < 3; i++) {
        brdf *b = open_name(cases[i].name);
        assert_true(fabs(brdf_exposure(b) / (0.35 / (cases[i].luminance * median)) - 1) < 1e-12);
        brdf_close(b);
    }
    brdf *b = open_name("lambert:albedo=0");
    assert_true(brdf_exposure(b) == 8);
    brdf_close(b);
    b = open_name("lafortune:cx=0,cz=1,n=0,ks=9");
    assert_true(brdf_exposure(b) == 0.5);
    brdf_close(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_listed_name_opens),
        cmocka_unit_test(every_class_is_there),
        cmocka_unit_test(every_model_opens_with_defaults),
        cmocka_unit_test(numbers_and_colours),
        cmocka_unit_test(unknown_names),
        cmocka_unit_test(unknown_parameters),
        cmocka_unit_test(values_out_of_range),
        cmocka_unit_test(files),
        cmocka_unit_test(broken_csv),
        cmocka_unit_test(half_vector_round_trip),
        cmocka_unit_test(cosine_and_horizon),
        cmocka_unit_test(albedo),
        cmocka_unit_test(exposure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
