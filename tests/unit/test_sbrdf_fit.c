/* SPDX-License-Identifier: MIT */
/* Materials that vary over the surface, on the way to their codes: mixtures, smaller levels, choice of codes, stacks. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lafortune_fit.h"
#include "pfm_io.h"
#include "png_io.h"
#include "sbrdf_demo.h"
#include "sbrdf_field.h"
#include "sbrdf_mix.h"
#include "sbrdf_stack.h"
#include "sbrdf_view.h"
#include "shell.h"

#include <cmocka.h> /* last: it makes fail a macro */

static const double pi = 3.14159265358979323846;

static uint32_t state_of_random = 1;

static double random_unit(void)
{
    state_of_random = state_of_random * 1664525u + 1013904223u;
    return state_of_random / 4294967296.0;
}

/* Uniform over the hemisphere, polar angle at most so much. */
static void random_direction(double most_degrees, double out[3])
{
    double z = 1 - (1 - cos(most_degrees * pi / 180)) * random_unit(), turn = 2 * pi * random_unit();
    out[0] = sqrt(1 - z * z) * cos(turn);
    out[1] = sqrt(1 - z * z) * sin(turn);
    out[2] = z;
}

static sbrdf_texel one_lobe(double kd, double cx, double cy, double cz, double n, double ks)
{
    sbrdf_texel t = {.alpha = 1, .direction = {1, 0}};
    t.brdf.lobes = 1;
    t.brdf.lobe[0] = (lafortune_shared_lobe){{cx, cy, cz}, n, {ks, 0.8 * ks, 0.5 * ks}};
    for (int c = 0; c < 3; c++) t.brdf.kd[c] = kd * (1 - 0.2 * c);
    return t;
}

/* Relative L2 distance of two texels over random pairs of directions: not those that fits use. */
static double distance(const sbrdf_part *parts, int count, const sbrdf_texel *other)
{
    double off = 0, own = 0;
    state_of_random = 77;
    for (int i = 0; i < 20000; i++) {
        double l[3], v[3], a[3], mean[3] = {0, 0, 0}, b[3];
        random_direction(89, v);
        random_direction(89, l);
        if (i % 2) { /* half of them near the mirror direction, where lobes are */
            double turned[3] = {-v[0] + 0.15 * (random_unit() - 0.5), -v[1] + 0.15 * (random_unit() - 0.5), v[2]};
            double length = sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2]);
            for (int k = 0; k < 3; k++) l[k] = turned[k] / length;
        }
        for (int k = 0; k < count; k++) {
            sbrdf_texel_eval(parts[k].texel, l, v, a);
            for (int c = 0; c < 3; c++) mean[c] += parts[k].weight * a[c];
        }
        sbrdf_texel_eval(other, l, v, b);
        for (int c = 0; c < 3; c++) {
            double w = l[2] * v[2];
            off += w * w * (mean[c] - b[c]) * (mean[c] - b[c]);
            own += w * w * mean[c] * mean[c];
        }
    }
    return sqrt(off / own);
}

/* ---- mixtures ------------------------------------------------------------------------------------------------------ */

/* The mean of lobes of one shape is a lobe of that shape, whatever the strengths: it must come out exactly. */
static void equal_shapes_mix_exactly(void **state)
{
    (void)state;
    sbrdf_texel a = one_lobe(0.1, -1, -1, 0.95, 60, 3), b = one_lobe(0.5, -1, -1, 0.95, 60, 0.2), out;
    sbrdf_part parts[2] = {{&a, 0.25}, {&b, 0.75}};
    sbrdf_mixer *m = sbrdf_mixer_make(1, 0);
    sbrdf_mix(m, parts, 2, parts, 2, &out);
    assert_true(fabs(out.brdf.kd[0] - 0.4) < 1e-4);
    assert_true(fabs(out.brdf.lobe[0].n - 60) < 0.05);
    assert_true(fabs(out.brdf.lobe[0].ks[0] - (0.25 * 3 + 0.75 * 0.2)) < 1e-3);
    sbrdf_mixer_free(m);
}

/* Two lobes in one texel hold a sharp and a wide lobe both; one lobe comes nearer than the parameters' mean does. */
static void unequal_shapes_mix_well(void **state)
{
    (void)state;
    sbrdf_texel a = one_lobe(0.1, -1, -1, 1, 120, 6), b = one_lobe(0.4, -1, -1, 1, 8, 0.3), out, mean;
    sbrdf_part parts[2] = {{&a, 0.5}, {&b, 0.5}};
    sbrdf_mixer *m = sbrdf_mixer_make(1, 0);
    sbrdf_mix(m, parts, 2, parts, 2, &out);
    sbrdf_mean_parameters(parts, 2, &mean);
    print_message("one lobe for two: %.1f %% off, the parameters' mean %.1f %%\n", 100 * distance(parts, 2, &out),
                  100 * distance(parts, 2, &mean));
    assert_true(distance(parts, 2, &out) < 0.2);
    assert_true(distance(parts, 2, &out) < 0.5 * distance(parts, 2, &mean));
    sbrdf_mixer_free(m);

    a.brdf.lobes = b.brdf.lobes = 2;
    a.brdf.lobe[1] = b.brdf.lobe[1] = (lafortune_shared_lobe){{-1, -1, 1}, 1, {0, 0, 0}};
    m = sbrdf_mixer_make(2, 0);
    sbrdf_mix(m, parts, 2, parts, 2, &out);
    print_message("two lobes: %.2f %%\n", 100 * distance(parts, 2, &out));
    assert_true(distance(parts, 2, &out) < 0.01);
    sbrdf_mixer_free(m);
}

/* Anisotropic texels of two directions: equal ones keep theirs (an axis: the opposite one is the same), and a mean of
   directions that are near stays between them. */
static void directions_mix_as_axes(void **state)
{
    (void)state;
    sbrdf_texel a = one_lobe(0.1, -1, -0.9, 0.95, 40, 2), b = a, out;
    sbrdf_part parts[2] = {{&a, 0.5}, {&b, 0.5}};
    sbrdf_mixer *m = sbrdf_mixer_make(1, 1);
    a.direction[0] = cos(0.5);
    a.direction[1] = sin(0.5);
    b.direction[0] = -cos(0.5);
    b.direction[1] = -sin(0.5);
    sbrdf_mix(m, parts, 2, parts, 2, &out);
    assert_true(fabs(out.direction[0] * sin(0.5) - out.direction[1] * cos(0.5)) < 1e-9);
    assert_true(distance(parts, 2, &out) < 1e-3);
    b.direction[0] = cos(0.7);
    b.direction[1] = sin(0.7);
    sbrdf_mix(m, parts, 2, parts, 2, &out);
    assert_true(fabs(atan2(out.direction[1], out.direction[0]) - 0.6) < 1e-9);
    sbrdf_mixer_free(m);
}

/* ---- levels -------------------------------------------------------------------------------------------------------- */

/* A chequered sheet of gold and matt: its last level against the mean over both. */
static void levels_reflect_like_what_they_cover(void **state)
{
    (void)state;
    sbrdf_texel kinds[2] = {one_lobe(0.02, -1, -1, 0.97, 40, 1.5), one_lobe(0.5, -1, -1, 0.8, 3, 0.02)};
    sbrdf_part parts[2] = {{&kinds[0], 0.5}, {&kinds[1], 0.5}};
    sbrdf_field f = sbrdf_field_make(8, 8, 1, 0), level[4], average[4];
    for (int i = 0; i < 64; i++) f.texel[i] = kinds[(i + i / 8) % 2];
    sbrdf_field_levels(&f, level, 4, NULL);
    sbrdf_field_average(&f, average, 4);
    assert_int_equal(level[3].width, 1);
    print_message("1 x 1 of a chequered sheet: %.1f %% off, by means of parameters %.1f %%\n",
                  100 * distance(parts, 2, &level[3].texel[0]), 100 * distance(parts, 2, &average[3].texel[0]));
    assert_true(distance(parts, 2, &level[3].texel[0]) < 0.06);
    assert_true(distance(parts, 2, &average[3].texel[0]) > 0.2);
    for (int k = 1; k < 4; k++) {
        sbrdf_field_free(&level[k]);
        sbrdf_field_free(&average[k]);
    }
    sbrdf_field_free(&f);
}

/* A sheet seen so small that a pixel covers 4 x 4 to 16 x 16 texels: refitted levels are at least 8 dB nearer to
   supersampling than means of codes. */
static void small_pictures_look_right(void **state)
{
    (void)state;
    enum { SIDE = 128 };
    sbrdf_texel kinds[2] = {one_lobe(0.02, -1, -1, 0.97, 40, 1.5), one_lobe(0.3, -1, -1, 0.8, 3, 0.02)};
    sbrdf_field f = sbrdf_field_make(SIDE, SIDE, 1, 0), level[8];
    sbrdf_map map;
    sbrdf_quantised report;
    sbrdf_view view[SBRDF_VIEWS];
    image_u8 sheet;
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE, y = i / SIDE;
        f.texel[i] = kinds[sin(0.9 * x) + cos(0.7 * y + 0.1 * x) > 0.3];
    }
    sbrdf_field_levels(&f, level, 8, NULL);
    sbrdf_quantise(level, 8, "spots", &map, &report);
    sbrdf_view_levels(&map, view, &sheet);
    for (int i = 0; i < SBRDF_VIEWS; i++) {
        print_message("1/%d: %.1f dB by its level, %.1f dB by means of codes\n", view[i].factor, view[i].level_psnr,
                      view[i].average_psnr);
        assert_int_equal(view[i].factor, 4 << i);
        assert_true(view[i].level_psnr > view[i].average_psnr + 8);
    }
    assert_int_equal(sheet.width, 3 * SIDE);
    image_u8_free(&sheet);
    sbrdf_map_free(&map);
    for (int k = 1; k < 8; k++) sbrdf_field_free(&level[k]);
    sbrdf_field_free(&f);
}

/* ---- codes --------------------------------------------------------------------------------------------------------- */

static double coded_error(const sbrdf_field *f, sbrdf_quantised *report, sbrdf_map *map)
{
    sbrdf_quantise(f, 1, "test", map, report);
    return sbrdf_map_error(map, f, 0);
}

/* Sharp and wide lobes side by side, albedos 1000 : 1 apart: the wide ones keep codes by giving magnitude away. */
static void magnitude_is_moved_where_it_serves(void **state)
{
    (void)state;
    sbrdf_field f = sbrdf_field_make(16, 16, 1, 0);
    sbrdf_quantised report;
    sbrdf_map map;
    for (int i = 0; i < 256; i++)
        f.texel[i] = i % 2 ? one_lobe(0.02, -1, -1, 1, 200, 30) : one_lobe(0.01, -1, -1, 0.9, 4 + i / 64.0, 0.05);
    double error = coded_error(&f, &report, &map);
    print_message("error of the 8 bits: %.2f %%, %.2f %% with C at full scale\n", 100 * report.error_chosen,
                  100 * report.error_plain);
    assert_true(fabs(error - report.error_chosen) < 1e-9); /* the map is what was measured: all 256 texels are */
    assert_true(report.error_chosen < 0.25 * report.error_plain);
    assert_true(report.error_chosen < 0.02);
    sbrdf_map_free(&map);
    sbrdf_field_free(&f);
}

/* A lobe that grows towards grazing angles, as Fresnel's reflection does: dot products above 1 as given. Its codes must
   follow it there. The sum of the codes' parts never exceeds 1 by more than half a code. */
static void grazing_peaks_keep_their_headroom(void **state)
{
    (void)state;
    sbrdf_field f = sbrdf_field_make(1, 1, 1, 0);
    sbrdf_clamped clamped;
    sbrdf_quantised report;
    sbrdf_map map;
    sbrdf_texel given = one_lobe(0.2, -1.0326, -1.0326, 0.7, 64, 1), coded;
    failure fail_text = {0};
    f.texel[0] = given;
    assert_int_equal(sbrdf_field_settle(&f, 1, &clamped, "test", &fail_text), 0);
    assert_int_equal(clamped.shapes + clamped.exponents + clamped.albedos, 0);
    sbrdf_part before = {&given, 1};
    assert_true(distance(&before, 1, &f.texel[0]) < 1e-9);
    coded_error(&f, &report, &map);
    sbrdf_map_texel(&map, 0, 0, 0, &coded);
    for (double degrees = 70; degrees < 89; degrees += 4) {
        double s = sin(degrees * pi / 180), c = cos(degrees * pi / 180), l[3] = {s, 0, c}, v[3] = {-s, 0, c}, a[3],
               b[3];
        sbrdf_texel_eval(&given, l, v, a);
        sbrdf_texel_eval(&coded, l, v, b);
        assert_true(fabs(b[0] - a[0]) < 0.1 * a[0]);
        if (degrees > 80) assert_true(a[0] > 4); /* above 1 by far */
    }
    const double *parts = coded.brdf.lobe[0].c;
    assert_true(fmax(fmax(fabs(parts[0]), fabs(parts[1])), parts[2]) <= 1 + 0.5 / 127);
    sbrdf_map_free(&map);
    sbrdf_field_free(&f);
}

static void what_does_not_fit_is_counted(void **state)
{
    (void)state;
    sbrdf_field f = sbrdf_field_make(4, 1, 1, 0);
    sbrdf_clamped clamped;
    failure text = {0};
    f.texel[0] = one_lobe(0.2, -1, -1, 1, 300, 1);
    f.texel[1] = one_lobe(0.2, -1, -1, -2.7, 11, 1);
    f.texel[2] = one_lobe(-0.2, -1, -1, 1, 30, 1);
    f.texel[3] = one_lobe(0.2, 0, 0, -1, 30, 1); /* never lit: no lobe at all */
    assert_int_equal(sbrdf_field_settle(&f, 1, &clamped, "test", &text), 0);
    assert_int_equal(clamped.exponents, 1);
    assert_int_equal(clamped.shapes, 1);
    assert_int_equal(clamped.albedos, 1);
    assert_true(f.texel[3].brdf.lobe[0].ks[0] == 0);
    f.texel[1] = one_lobe(0.2, -1, -1, -1.9, 11, 1);
    assert_int_equal(sbrdf_field_settle(&f, 2, &clamped, "test", &text), 0);
    assert_int_equal(clamped.shapes, 0);
    f.texel[2].brdf.lobe[0].c[1] = NAN;
    assert_int_equal(sbrdf_field_settle(&f, 1, &clamped, "test", &text), FAIL_INVALID);
    assert_non_null(strstr(text.text, "test: texel (2, 0)"));
    sbrdf_field_free(&f);
}

/* Cx = Cy stays so in the codes, and turning light and eye together then changes nothing. */
static void isotropic_texels_stay_isotropic(void **state)
{
    (void)state;
    sbrdf_field f = sbrdf_field_make(8, 8, 1, 0);
    sbrdf_quantised report;
    sbrdf_map map;
    state_of_random = 5;
    for (int i = 0; i < 64; i++)
        f.texel[i] = one_lobe(0.3 * random_unit(), -1, -1, 0.5 + 0.5 * random_unit(), 1 + 200 * random_unit(), 2);
    coded_error(&f, &report, &map);
    for (int i = 0; i < 64; i++) {
        const uint8_t *shape = map.lobe[0] + 4 * 64 + 4 * i;
        sbrdf_texel t;
        double l[3], v[3], a[3], b[3], turn = 6.28 * random_unit();
        assert_int_equal(shape[0], shape[1]);
        sbrdf_map_texel(&map, 0, i % 8, i / 8, &t);
        random_direction(85, l);
        random_direction(85, v);
        double l2[3] = {l[0] * cos(turn) - l[1] * sin(turn), l[0] * sin(turn) + l[1] * cos(turn), l[2]};
        double v2[3] = {v[0] * cos(turn) - v[1] * sin(turn), v[0] * sin(turn) + v[1] * cos(turn), v[2]};
        sbrdf_texel_eval(&t, l, v, a);
        sbrdf_texel_eval(&t, l2, v2, b);
        for (int c = 0; c < 3; c++) assert_true(fabs(a[c] - b[c]) <= 1e-9 * (a[c] + 1e-6));
    }
    sbrdf_map_free(&map);
    sbrdf_field_free(&f);
}

/* ---- energy and reciprocity of fits -------------------------------------------------------------------------------- */

/* Part of the light from l that leaves again, R G B. */
static void albedo_towards(const brdf *b, double polar, double out[3])
{
    double l[3] = {sin(polar), 0, cos(polar)};
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < 200; i++)
        for (int j = 0; j < 200; j++) { /* half vectors, dense where lobes are */
            double u = (i + 0.5) / 200, theta = pi / 2 * u * u * u, turn = 2 * pi * (j + 0.5) / 200, f[3], v[3];
            double h[3] = {sin(theta) * cos(turn), sin(theta) * sin(turn), cos(theta)};
            double lh = l[0] * h[0] + l[1] * h[1] + l[2] * h[2];
            for (int k = 0; k < 3; k++) v[k] = 2 * lh * h[k] - l[k];
            if (!(lh > 0 && v[2] > 0)) continue;
            b->eval(b, l, v, f);
            double solid = 4 * lh * sin(theta) * pi / 2 * 3 * u * u / 200 * 2 * pi / 200;
            for (int c = 0; c < 3; c++) out[c] += f[c] * v[2] * solid;
        }
}

/* Fits of materials that keep energy keep it too within 3 %, up to 75 degrees, where they are fitted; and are reciprocal. */
static void fits_keep_energy_and_are_reciprocal(void **state)
{
    (void)state;
    static const char *const names[] = {"ggx:rough=.3,f0=1,albedo=0", "ggx:rough=.6,f0=.04,albedo=.9",
                                        "ggx:rough=.9,f0=1,albedo=1", "ward:kd=.3,ks=.3,ax=.15,ay=.4",
                                        "lambert:albedo=.95"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        brdf *b = NULL;
        lafortune_fit fit;
        failure text = {0};
        const lafortune_fit_options options = {.lobes = 3, .n_min = 1, .n_max = 255, .grazing_max = SBRDF_GRAZING_MAX};
        if (brdf_open(&b, names[k], &text) || lafortune_fit_brdf(&fit, b, &options, &text)) fail_msg("%s", text.text);
        brdf *drawn = lafortune_fit_open(&fit);
        double most = 0;
        for (int degrees = 0; degrees <= 75; degrees += 15) {
            double ours[3];
            albedo_towards(drawn, degrees * pi / 180, ours);
            for (int c = 0; c < 3; c++) most = fmax(most, ours[c]);
        }
        print_message("%s: largest albedo of the fit %.3f\n", names[k], most);
        assert_true(most <= 1.03);
        for (int i = 0; i < 200; i++) {
            double l[3], v[3], there[3], back[3];
            random_direction(89, l);
            random_direction(89, v);
            drawn->eval(drawn, l, v, there);
            drawn->eval(drawn, v, l, back);
            for (int c = 0; c < 3; c++) assert_true(fabs(there[c] - back[c]) <= 1e-12 * there[c]);
        }
        brdf_close(drawn);
        brdf_close(b);
    }
}

/* ---- stacks -------------------------------------------------------------------------------------------------------- */

enum { STACK_SIDE = 12, STACK_IMAGES = 60 };

static sbrdf_field stack_truth(int lobes)
{
    sbrdf_field f = sbrdf_field_make(STACK_SIDE, STACK_SIDE, lobes, 0);
    for (int i = 0; i < STACK_SIDE * STACK_SIDE; i++) {
        double x = i % STACK_SIDE / (double)STACK_SIDE, y = i / STACK_SIDE / (double)STACK_SIDE;
        f.texel[i] = one_lobe(0.1 + 0.4 * x, -1, -1, 0.9 + 0.1 * y, 15 + 40 * y, 0.5 + x);
        f.texel[i].brdf.lobes = lobes;
        f.texel[i].brdf.lobe[1] = (lafortune_shared_lobe){{-1, -1, 0.6}, 2 + x, {0.05, 0.04, 0.06}};
    }
    return f;
}

/* Pictures under random lights and views, most of them near the mirror direction. codes: 8 bits of sRGB. */
static void write_stack(const sbrdf_field *f, int codes)
{
    char text[16384] = "# a test\nstack\n";
    failure failed = {0};
    state_of_random = 3;
    for (int k = 0; k < STACK_IMAGES; k++) {
        char name[32];
        double l[3], v[3], f_r[3];
        random_direction(75, l);
        random_direction(70, v);
        if (k % 3) {
            v[0] = -l[0] + 0.5 * (random_unit() - 0.5);
            v[1] = -l[1] + 0.5 * (random_unit() - 0.5);
            v[2] = l[2];
            double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            for (int c = 0; c < 3; c++) v[c] /= length;
        }
        image_f32 picture = image_f32_make(f->width, f->height, 3);
        image_u8 coded = image_u8_make(f->width, f->height, 3);
        for (int i = 0; i < f->width * f->height; i++) {
            sbrdf_texel_eval(&f->texel[i], l, v, f_r);
            for (int c = 0; c < 3; c++) {
                picture.texel[3 * i + c] = (float)(pi * f_r[c] * l[2]);
                coded.texel[3 * i + c] = unorm8(srgb_encode(pi * f_r[c] * l[2]));
            }
        }
        snprintf(name, sizeof name, "s%d.%s", k, codes ? "png" : "pfm");
        assert_int_equal(
            codes ? png_write(shell_path(name), &coded, &failed) : pfm_write(shell_path(name), &picture, &failed), 0);
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "image %s %.9g %.9g %.9g %.9g %.9g %.9g\n", name, l[0], l[1], l[2],
                 v[0], v[1], v[2]);
        image_f32_free(&picture);
        image_u8_free(&coded);
    }
    shell_write("stack.txt", text, strlen(text));
}

static sbrdf_field fit_stack(int lobes, sbrdf_stack_report *report)
{
    sbrdf_field f;
    sbrdf_sources sources = {0};
    failure text = {0};
    assert_true(sbrdf_is_stack(shell_path("stack.txt")));
    if (sbrdf_stack_fit(&f, shell_path("stack.txt"), lobes, 0, &sources, report, NULL, &text))
        fail_msg("%s", text.text);
    assert_int_equal(sources.count, STACK_IMAGES);
    sbrdf_sources_free(&sources);
    return f;
}

static double worst_texel(const sbrdf_field *found, const sbrdf_field *truth)
{
    double worst = 0;
    for (int i = 0; i < truth->width * truth->height; i += 5) {
        sbrdf_part part = {&truth->texel[i], 1};
        worst = fmax(worst, distance(&part, 1, &found->texel[i]));
    }
    return worst;
}

/* Floats without noise: the parameters that were put in. 8 bits of sRGB, highlights overexposed: near them. */
static void stacks_give_the_texels_back(void **state)
{
    (void)state;
    for (int lobes = 1; lobes <= 2; lobes++) {
        sbrdf_field truth = stack_truth(lobes);
        sbrdf_stack_report report;
        write_stack(&truth, 0);
        sbrdf_field found = fit_stack(lobes, &report);
        double floats = worst_texel(&found, &truth);
        sbrdf_field_free(&found);
        write_stack(&truth, 1);
        found = fit_stack(lobes, &report);
        print_message(
            "%d lobe%s: worst texel %.3f %% off from floats, %.1f %% from 8 bits with overexposed highlights\n", lobes,
            lobes == 1 ? "" : "s", 100 * floats, 100 * worst_texel(&found, &truth));
        assert_true(floats < (lobes == 1 ? 0.002 : 0.05));
        assert_true(worst_texel(&found, &truth) < 0.2);
        assert_int_equal(report.underlit, 0);
        sbrdf_field_free(&found);
        sbrdf_field_free(&truth);
    }
}

/* ---- the demo's materials ------------------------------------------------------------------------------------------ */

/* Every painting of the demo is written, read and mixed; same bytes each time. */
static void demo_paintings_are_whole(void **state)
{
    (void)state;
    for (int i = 0; i < SBRDF_DEMO_COUNT; i++) {
        char name[64];
        failure text = {0};
        if (sbrdf_demo_write(i, shell_path("."), &text)) fail_msg("%s", text.text);
        snprintf(name, sizeof name, "%s.txt", sbrdf_demo_name(i));
        assert_true(shell_exists(name));
    }
    char *first = shell_read("wallpaper-gold.png"), *text = shell_read("composite.txt");
    assert_non_null(strstr(text, "paint m11 composite-m11.png"));
    assert_int_equal(shell_run("mv wallpaper-gold.png before.png").code, 0);
    failure failed = {0};
    assert_int_equal(sbrdf_demo_write(0, shell_path("."), &failed), 0);
    assert_int_equal(shell_run("cmp wallpaper-gold.png before.png").code, 0);
    free(first);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_shapes_mix_exactly),
        cmocka_unit_test(unequal_shapes_mix_well),
        cmocka_unit_test(directions_mix_as_axes),
        cmocka_unit_test(levels_reflect_like_what_they_cover),
        cmocka_unit_test(small_pictures_look_right),
        cmocka_unit_test(magnitude_is_moved_where_it_serves),
        cmocka_unit_test(grazing_peaks_keep_their_headroom),
        cmocka_unit_test(what_does_not_fit_is_counted),
        cmocka_unit_test(isotropic_texels_stay_isotropic),
        cmocka_unit_test(fits_keep_energy_and_are_reciprocal),
        cmocka_unit_test(stacks_give_the_texels_back),
        cmocka_unit_test(demo_paintings_are_whole),
    };
    return cmocka_run_group_tests(tests, shell_begin, shell_end);
}
