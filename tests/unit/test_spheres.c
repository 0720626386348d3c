/* SPDX-License-Identifier: MIT */
/* Sphere images: closed forms, a decoding of our own from the bytes, accuracy at the stored angles, files, errors. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* before cmocka.h, which defines a macro fail() */
#include "asset.h"
#include "brdf_kit.h"
#include "etc1.h"
#include "ktx2_write.h"
#include "metric.h"
#include "sphere_bake.h"

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* ---- Lambert: everything is known ----------------------------------------------------------- */

/* f_r = albedo / pi for any pair: no image, angle or rotation matters. The scale is the value itself, so codes are 255; q16
   rounding of a scale of 0.5 is 2^-17 / 0.5. */
static void lambert_without_cosine(void **state)
{
    (void)state;
    sphere_asset s = bake_spheres("lambert:albedo=.5", &(sphere_options){.mode = SPHERE_COSINE_FREE});
    assert_int_equal(s.size, 256);
    assert_int_equal(s.layers, 4);
    assert_int_equal(s.levels, 9);
    assert_float_equal(s.disc, 15.0 / 16, 0);
    /* constant images have constant mips */
    for (int level = 0; level < s.levels; level++) {
        assert_int_equal(s.level[level].size, 4 * 4 * (256 >> level) * (256 >> level));
        for (size_t i = 0; i < s.level[level].size; i++) assert_int_equal(s.level[level].data[i], 255);
    }
    brdf *d = sphere_brdf(&s, NULL);
    uint32_t seed = 7;
    for (int i = 0; i < 2000; i++) {
        double l[3], v[3], f[3], fc[3];
        random_direction(&seed, l);
        random_direction(&seed, v);
        d->eval(d, l, v, f);
        brdf_eval_cosine(d, l, v, fc);
        for (int c = 0; c < 3; c++) {
            assert_float_equal(f[c], 0.5 / pi, 2e-5);
            assert_float_equal(fc[c], 0.5 / pi * l[2], 2e-5);
        }
    }
    brdf_close(d);
    sphere_free(&s);
}

/* At a stored light angle the paper's sphere is the cosine. Codes: half a step of rounding and the bilinear error of a
   512 image away from rim and terminator: 1 code. */
static void lambert_with_cosine(void **state)
{
    (void)state;
    sphere_options o = {.mode = SPHERE_PAPER};
    sphere_decode_options whole = {.shrink = 1};
    sphere_asset s = bake_spheres("lambert:albedo=1", &o);
    assert_int_equal(s.size, 512);
    assert_float_equal(s.disc, 1, 0);
    brdf *d = sphere_brdf(&s, &whole);
    uint32_t seed = 9;
    int used = 0;
    for (int i = 0; i < 8000; i++) {
        double n[3], polar = 45 * (i % 4) * pi / 180, light[3] = {sin(polar), 0, cos(polar)}, out[3];
        random_direction(&seed, n);
        if (dot(n, light) < 0.05 || n[2] < 0.2) continue;
        /* into the surface's frame: x along light - n (n.l) */
        double nl = dot(n, light), nv = n[2], lv = light[2], sl = sqrt(1 - nl * nl), sv = sqrt(1 - nv * nv);
        if (sl < 1e-3 || sv < 1e-3) continue;
        double cosine = fmax(-1, fmin(1, (lv - nl * nv) / (sl * sv)));
        double l[3] = {sl, 0, nl}, v[3] = {sv * cosine, sv * sqrt(1 - cosine * cosine), nv};
        brdf_eval_cosine(d, l, v, out);
        for (int c = 0; c < 3; c++) {
            double linear = pi * s.scale[c] * out[c], exact = fmin(s.scale[c] * nl, 1);
            assert_float_equal(255 * srgb_encode(linear), 255 * srgb_encode(exact), 1);
        }
        used++;
    }
    assert_true(used > 2000);
    brdf_close(d);
    sphere_free(&s);
}

/* ---- a second decoder, in world coordinates ------------------------------------------------- */

static void texel_codes(const sphere_asset *s, int layer, int i, int j, double code[3])
{
    i = i < 0 ? 0 : i >= s->size ? s->size - 1 : i;
    j = j < 0 ? 0 : j >= s->size ? s->size - 1 : j;
    const uint8_t *p =
        s->level[0].data + 4 * (((size_t)layer * (size_t)s->size + (size_t)j) * (size_t)s->size + (size_t)i);
    for (int c = 0; c < 3; c++) code[c] = p[c] / 255.0;
}

/* Codes seen by the normal +z turned by angle about the axis eye x light (Rodrigues' formula). */
static void reference_fetch(const sphere_asset *s, int layer, const double light[3], const double eye[3], double angle,
                            double shrink, double out[3])
{
    const double n[3] = {0, 0, 1};
    double axis[3], side[3], turned[3], axis_n[3];
    cross(eye, light, axis);
    double length = sqrt(dot(axis, axis));
    for (int k = 0; k < 3; k++) axis[k] /= length;
    cross(axis, eye, side); /* +x of the images */
    cross(axis, n, axis_n);
    for (int k = 0; k < 3; k++)
        turned[k] = n[k] * cos(angle) + axis_n[k] * sin(angle) + axis[k] * dot(axis, n) * (1 - cos(angle));
    double x = dot(turned, side), y = dot(turned, axis);
    if (dot(turned, eye) < 0) {
        double r = sqrt(x * x + y * y);
        x /= r;
        y /= r;
    }
    double u = s->size * (1 + s->disc * shrink * x) / 2 - 0.5, v = s->size * (1 - s->disc * shrink * y) / 2 - 0.5;
    int i = (int)floor(u), j = (int)floor(v);
    for (int c = 0; c < 3; c++) out[c] = 0;
    for (int t = 0; t < 4; t++) {
        double code[3], weight = (t & 1 ? u - i : 1 - (u - i)) * (t & 2 ? v - j : 1 - (v - j));
        texel_codes(s, layer, i + (t & 1), j + t / 2, code);
        for (int c = 0; c < 3; c++) out[c] += weight * code[c];
    }
}

/* k of eq. 3 with acos and atan2 as printed. */
static double reference_k(const double light[3], const double eye[3])
{
    double axis[3], h[3], flat[3], n[3] = {0, 0, 1};
    cross(eye, light, axis);
    double length = sqrt(dot(axis, axis));
    for (int k = 0; k < 3; k++) axis[k] /= length, h[k] = light[k] + eye[k];
    for (int k = 0; k < 3; k++) flat[k] = n[k] - axis[k] * dot(axis, n);
    return 0.5 + sin(acos(fmax(-1, fmin(1, dot(h, flat) / sqrt(dot(h, h) * dot(flat, flat)))))) / 2;
}

static void reference_eval_cosine(const sphere_asset *s, const double light[3], const double eye[3], double out[3])
{
    double phi = acos(dot(light, eye)), code[2][3], t = 0, first_k, shrink = s->mode == SPHERE_PAPER ? 0.995 : 1;
    int i = 0, last = s->layers - 1;
    while (i < last && phi * 180 / pi >= s->polar[i + 1]) i++;
    int lone = i == last || phi * 180 / pi < s->polar[0];
    if (s->mode == SPHERE_PAPER)
        first_k = lone ? 0.75 : reference_k(light, eye);
    else
        first_k = 0.5;
    if (!lone) t = (phi * 180 / pi - s->polar[i]) / (s->polar[i + 1] - s->polar[i]);
    for (int n = 0; n < (lone ? 1 : 2); n++)
        reference_fetch(s, i + n, light, eye, first_k * (s->polar[i + n] * pi / 180 - phi), shrink, code[n]);
    for (int c = 0; c < 3; c++) {
        double y = lone ? code[0][c] : code[0][c] + (code[1][c] - code[0][c]) * t;
        out[c] =
            s->mode == SPHERE_PAPER ? srgb_decode(y) / (pi * s->scale[c]) : s->scale[c] * pow(y, 4) / pi * light[2];
    }
}

/* Any pair of directions, both modes, also with a first angle above 0: the same sampling written differently agrees to
   rounding. Random pairs meet every case: blend, tail, head, rim (counted). */
static void agrees_with_second_decoder(void **state)
{
    (void)state;
    const sphere_options cases[] = {
        {.size = 64, .mode = SPHERE_COSINE_FREE},
        {.size = 64, .mode = SPHERE_PAPER},
        {.size = 40, .mode = SPHERE_COSINE_FREE, .polar = {30, 75, 110}, .polar_count = 3, .no_pad = 1},
        {.size = 40, .polar = {30, 75, 110}, .polar_count = 3, .mode = SPHERE_PAPER},
        {.size = 32, .mode = SPHERE_COSINE_FREE, .polar = {60}, .polar_count = 1}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sphere_asset s = bake_spheres("ggx:rough=.4,f0=.5", &cases[k]);
        brdf *d = sphere_brdf(&s, NULL);
        uint32_t seed = 3;
        for (int i = 0; i < 20000; i++) {
            double l[3], v[3], found[3], expected[3];
            random_direction(&seed, l);
            random_direction(&seed, v);
            if (dot(l, v) > 1 - 1e-6) continue; /* no plane through both */
            brdf_eval_cosine(d, l, v, found);
            reference_eval_cosine(&s, l, v, expected);
            /* acos loses half the digits near 0 and 180 degrees */
            for (int c = 0; c < 3; c++) {
                if (fabs(found[c] - expected[c]) > 1e-6 * (1 + expected[c]))
                    fail_msg("case %zu pair %d channel %d: found %g, expected %g", k, i, c, found[c], expected[c]);
            }
        }
        brdf_close(d);
        sphere_free(&s);
    }
}

/* Where eq. 3 or the frame has no direction: light = eye, light opposite, normal along the axis (ny = +-1), grazing. */
static void guards(void **state)
{
    (void)state;
    for (int mode = 0; mode < 2; mode++) {
        sphere_options o = {.size = 32, .mode = mode ? SPHERE_PAPER : SPHERE_COSINE_FREE};
        sphere_asset s = bake_spheres("ggx:rough=.3,f0=.5", &o);
        brdf *d = sphere_brdf(&s, NULL);
        const double pairs[][2][3] = {
            {{0, 0, 1}, {0, 0, 1}},          {{0.6, 0, 0.8}, {0.6, 0, 0.8}}, {{1, 0, 1e-9}, {0, 1, 1e-9}}, /* ny = 1 */
            {{0, 1, 1e-9}, {1, 0, 1e-9}},                                                                  /* ny = -1 */
            {{1, 0, 1e-12}, {-1, 0, 1e-12}}, {{1, 0, 1e-9}, {1, 0, 1e-9}},   {{0, 0, 1}, {1, 0, 1e-300}}};
        for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
            double out[3], near_out[3], l[3], v[3];
            assert_int_equal(d->eval_cosine(d, pairs[i][0], pairs[i][1], out), 1);
            for (int k = 0; k < 3; k++) {
                l[k] = pairs[i][0][k] + 1e-7 * (k + 1);
                v[k] = pairs[i][1][k];
            }
            d->eval_cosine(d, l, v, near_out);
            for (int c = 0; c < 3; c++) {
                assert_true(isfinite(out[c]) && out[c] >= 0);
                /* no jump beside the guard, but where the light's azimuth really decides (in line and grazing);
                   light = eye may come out at any azimuth, where a 32-texel image is 1 % from round */
                if (i < 2 || i == 6) assert_float_equal(out[c], near_out[c], 0.01 * out[c] + 1e-3);
            }
        }
        const double up[3] = {0, 0, 1}, below[3] = {0.6, 0, -0.8};
        double out[3] = {1, 1, 1};
        brdf_eval_cosine(d, up, below, out);
        assert_float_equal(out[0], 0, 0);
        brdf_eval_cosine(d, below, up, out);
        assert_float_equal(out[0], 0, 0);
        brdf_close(d);
        sphere_free(&s);
    }
}

/* ---- accuracy ------------------------------------------------------------------------------- */

static double frame_mse(const brdf *truth, const brdf *d, double phi_deg, double exposure)
{
    image_u8 a, b;
    metric_frame(truth, phi_deg, exposure, METRIC_SIZE, &a);
    metric_frame(d, phi_deg, exposure, METRIC_SIZE, &b);
    double mse = metric_mse(&a, &b);
    image_u8_free(&a);
    image_u8_free(&b);
    return mse;
}

static double stored_psnr(const brdf *truth, const sphere_asset *s)
{
    brdf *d = sphere_brdf(s, NULL);
    double sum = 0, exposure = brdf_exposure(truth);
    for (int i = 0; i < s->layers; i++) sum += frame_mse(truth, d, s->polar[i], exposure);
    brdf_close(d);
    return metric_psnr(sum / s->layers);
}

/* The promise of the format: 51 dB at the stored angles. Two roundings to 8 bits alone leave 55.9 dB (1/12 + 1/12 code^2);
   the texels' own steps and the bilinear filter take the rest. The narrow GGX lobes are 3 and 0.7 degrees wide (half of it), below the
   texels of the disc's middle (0.5 degrees). */
static void stored_angles(void **state)
{
    (void)state;
    static const char *const names[] = {"lambert:albedo=.7",           "ggx:rough=.2,f0=.04", "ggx:rough=.1,f0=.9",
                                        "ngan-cook-torrance:hematite", "lafortune:felt",      "sgd:chrome",
                                        "ngan-cook-torrance:hematite"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        brdf *b = open_name(names[i]);
        sphere_asset s = bake_spheres(names[i], &(sphere_options){.mode = SPHERE_COSINE_FREE});
        double db = stored_psnr(b, &s);
        print_message("%-32s %.2f dB at the stored angles\n", names[i], db);
        assert_true(db >= 51);
        sphere_free(&s);
        brdf_close(b);
    }
}

/* Half-way between stored angles the sign of the rotation decides: turned the other way a highlight is doubled. */
static void rotation_sign(void **state)
{
    (void)state;
    sphere_options o = {.size = 128, .mode = SPHERE_COSINE_FREE};
    brdf *b = open_name("ggx:rough=.3,f0=.5");
    sphere_asset s = bake_spheres("ggx:rough=.3,f0=.5", &o);
    sphere_decode_options other = {.k = -0.5}, naive = {.k = 1};
    brdf *right = sphere_brdf(&s, NULL), *wrong = sphere_brdf(&s, &other), *whole = sphere_brdf(&s, &naive);
    double exposure = brdf_exposure(b), mse[3] = {0};
    for (int i = 0; i < 3; i++) {
        double phi = 22.5 + 45 * i;
        mse[0] += frame_mse(b, right, phi, exposure) / 3;
        mse[1] += frame_mse(b, wrong, phi, exposure) / 3;
        mse[2] += frame_mse(b, whole, phi, exposure) / 3;
    }
    print_message("k = 1/2 %.1f dB, k = -1/2 %.1f dB, k = 1 %.1f dB\n", metric_psnr(mse[0]), metric_psnr(mse[1]),
                  metric_psnr(mse[2]));
    assert_true(metric_psnr(mse[0]) > metric_psnr(mse[1]) + 10);
    /* what the unlit part holds counts here: 36.8 with theta_half and phi_diff kept, 35.6 from the nearest lit texels */
    assert_true(metric_psnr(mse[0]) >= 36.3);
    assert_true(metric_psnr(mse[0]) > metric_psnr(mse[2]) + 5);
    brdf_close(right);
    brdf_close(wrong);
    brdf_close(whole);
    sphere_free(&s);
    brdf_close(b);
}

/* ---- images --------------------------------------------------------------------------------- */

/* With the light at 90 degrees the paper's left half is black and the right lit; corners are black. The padded image repeats
   its rim, and mirrors top to bottom. */
static void layout(void **state)
{
    (void)state;
    double code[3], rim[3];
    sphere_options o = {.size = 128, .mode = SPHERE_PAPER};
    sphere_asset paper = bake_spheres("ggx:rough=.5,f0=.3", &o), padded;
    for (int layer = 0; layer < 4; layer++)
        for (int corner = 0; corner < 4; corner++) {
            texel_codes(&paper, layer, corner & 1 ? 127 : 0, corner & 2 ? 127 : 0, code);
            assert_float_equal(code[0] + code[1] + code[2], 0, 0);
        }
    texel_codes(&paper, 2, 30, 64, code);
    assert_float_equal(code[0], 0, 0);
    texel_codes(&paper, 2, 110, 64, code);
    assert_true(code[0] > 0.3);

    o.mode = SPHERE_COSINE_FREE;
    padded = bake_spheres("ggx:rough=.5,f0=.3", &o);
    assert_float_equal(padded.disc, 120.0 / 128, 0);
    for (int layer = 0; layer < 4; layer++) {
        for (int azimuth = 0; azimuth < 360; azimuth += 45) {
            double x = cos(azimuth * pi / 180), y = sin(azimuth * pi / 180);
            texel_codes(&padded, layer, (int)floor(64 + 61.5 * x), (int)floor(64 - 61.5 * y), rim);
            texel_codes(&padded, layer, (int)floor(64 + 63.4 * x), (int)floor(64 - 63.4 * y), code);
            /* one texel of azimuth apart at most */
            for (int c = 0; c < 3; c++) assert_float_equal(rim[c], code[c], 0.04);
        }
        for (int j = 0; j < 64; j++)
            for (int i = 0; i < 128; i++) {
                texel_codes(&padded, layer, i, j, code);
                texel_codes(&padded, layer, i, 127 - j, rim);
                assert_float_equal(code[1], rim[1], 1.001 / 255);
            }
    }
    sphere_free(&paper);
    sphere_free(&padded);
}

static void other_formats(void **state)
{
    (void)state;
    const int formats[2] = {NACRE_FORMAT_RGB565, NACRE_FORMAT_ETC2_RGB8};
    const size_t level0[2] = {128 * 128 * 2, 128 * 128 / 2}, level6[2] = {2 * 2 * 2, 8};
    brdf *b = open_name("ggx:rough=.4,f0=.3");
    for (int i = 0; i < 2; i++) {
        sphere_options o = {.size = 128, .mode = SPHERE_COSINE_FREE, .format = formats[i]};
        sphere_asset s = bake_spheres("ggx:rough=.4,f0=.3", &o);
        assert_int_equal(s.levels, 8);
        assert_int_equal(s.level[0].size, 4 * level0[i]);
        assert_int_equal(s.level[6].size, 4 * level6[i]);
        if (i == 1)
            for (int level = 0; level < s.levels; level++)
                for (size_t k = 0; k < s.level[level].size; k += 8)
                    assert_true(etc1_block_valid(s.level[level].data + k));
        double db = stored_psnr(b, &s);
        print_message("%s: %.2f dB at the stored angles\n", i ? "etc1" : "rgb565", db);
        /* steps of 8 codes of 255: 18 dB under rgba8's 54 */
        assert_true(db >= 36);
        sphere_free(&s);
    }
    brdf_close(b);
}

/* ---- files ---------------------------------------------------------------------------------- */

static void round_trip(void **state)
{
    (void)state;
    const sphere_options cases[] = {
        {.size = 32, .mode = SPHERE_COSINE_FREE},
        {.size = 32, .mode = SPHERE_PAPER, .polar = {0, 30, 60, 90, 120, 150}, .polar_count = 6},
        {.size = 24, .mode = SPHERE_COSINE_FREE, .format = NACRE_FORMAT_RGB565},
        {.size = 64, .mode = SPHERE_COSINE_FREE, .format = NACRE_FORMAT_ETC2_RGB8, .no_pad = 1},
        {.size = 16, .mode = SPHERE_COSINE_FREE, .no_mips = 1, .polar = {10.3}, .polar_count = 1},
        {.size = 16},
        {.size = 12, .format = NACRE_FORMAT_ETC2_RGB8, .images = 3},
        {.size = 8, .format = NACRE_FORMAT_ETC2_RGB8, .etc2 = 1, .images = 2},
        {.size = 9, .format = NACRE_FORMAT_RGBA8, .polar = {10, 99.5}, .polar_count = 2},
        {.size = 11, .format = NACRE_FORMAT_RGB565, .images = 16}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sphere_asset s = bake_spheres("ggx:rough=.4,f0=.3", &cases[k]), back;
        bytes file = {0}, again = {0};
        nacre_image image;
        failure f = {0};
        sphere_write(&s, &file);
        assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_OK);
        if (sphere_read(&back, &image, "file", &f)) fail_msg("%s", f.text);
        assert_int_equal(back.size, s.size);
        assert_int_equal(back.layers, s.layers);
        assert_int_equal(back.levels, s.levels);
        assert_int_equal(back.format, s.format);
        assert_int_equal(back.mode, s.mode);
        assert_string_equal(back.name, "ggx:rough=.4,f0=.3");
        for (int i = 0; i < s.layers; i++) assert_float_equal(back.polar[i], s.polar[i], 1e-12);
        for (int c = 0; c < 3; c++) {
            assert_float_equal(back.scale[c], s.scale[c], 0);
            assert_float_equal(back.albedo[c], s.albedo[c], 1.0 / 65536);
        }
        assert_float_equal(back.disc, s.disc, 0);
        for (int i = 0; i < s.levels; i++) {
            assert_int_equal(back.level[i].size, s.level[i].size);
            assert_memory_equal(back.level[i].data, s.level[i].data, s.level[i].size);
        }
        const char *transfer = s.mode == SPHERE_PAPER ? "srgb" : s.mode == SPHERE_QUARTER ? "root4-lh" : "root4";
        assert_int_equal(asset_key_is(&image, NACRE_KEY_TRANSFER, transfer), 1);
        uint32_t etc1 = 0;
        assert_int_equal(asset_key_u32(&image, NACRE_KEY_ETC1, &etc1, 1),
                         s.format == NACRE_FORMAT_ETC2_RGB8 && !cases[k].etc2);
        assert_int_equal(back.etc2, cases[k].etc2);
        sphere_write(&back, &again);
        assert_int_equal(again.size, file.size);
        assert_memory_equal(again.data, file.data, file.size);
        bytes_free(&file);
        bytes_free(&again);
        sphere_free(&s);
        sphere_free(&back);
    }
}

static void deterministic(void **state)
{
    (void)state;
    assert_spheres_need_no_threads("sgd:chrome", &(sphere_options){.size = 64, .mode = SPHERE_COSINE_FREE});
}

/* ---- errors --------------------------------------------------------------------------------- */

static void refused(const sphere_options *o, int anisotropic, int code, const char *word)
{
    brdf *b = open_name("lambert:albedo=.5");
    b->anisotropic = anisotropic;
    sphere_asset s = {.size = -7};
    failure f = {0};
    int found = sphere_bake(&s, b, o, &f);
    if (found != code || f.code != code) fail_msg("found code %d (%s), expected %d", found, f.text, code);
    if (!strstr(f.text, word)) fail_msg("\"%s\" does not say \"%s\"", f.text, word);
    assert_null(strchr(f.text, '\n'));
    assert_int_equal(s.size, -7);
    brdf_close(b);
}

static void options_are_checked(void **state)
{
    (void)state;
    refused(&(sphere_options){0}, 1, FAIL_UNSUPPORTED, "anisotropic");
    refused(&(sphere_options){.size = 7}, 0, FAIL_USAGE, "--size: found 7, expected 8..128");
    refused(&(sphere_options){.size = 2049}, 0, FAIL_USAGE, "--size: found 2049, expected 8..128");
    refused(&(sphere_options){.size = 2049, .mode = SPHERE_PAPER}, 0, FAIL_USAGE,
            "--size: found 2049, expected 8..2048");
    refused(&(sphere_options){.size = 30, .format = NACRE_FORMAT_ETC2_RGB8}, 0, FAIL_USAGE, "multiple of 4");
    refused(&(sphere_options){.images = 1}, 0, FAIL_USAGE, "--images: found 1, expected 2..16");
    refused(&(sphere_options){.images = 17, .mode = SPHERE_PAPER}, 0, FAIL_USAGE, "--images: found 17, expected 1..16");
    refused(&(sphere_options){.images = 3, .polar = {0, 90}, .polar_count = 2}, 0, FAIL_USAGE, "beside --polar");
    refused(&(sphere_options){.polar_count = 1}, 0, FAIL_USAGE, "--polar: found 1 angles, expected 2..16");
    refused(&(sphere_options){.polar_count = 17}, 0, FAIL_USAGE, "--polar: found 17 angles");
    refused(&(sphere_options){.polar_count = 2, .polar = {0, 179.5}}, 0, FAIL_USAGE, "--polar: found 179.5");
    refused(&(sphere_options){.polar_count = 2, .polar = {-1}}, 0, FAIL_USAGE, "--polar: found -1");
    refused(&(sphere_options){.polar_count = 2, .polar = {NAN}}, 0, FAIL_USAGE, "--polar");
    refused(&(sphere_options){.polar_count = 2, .polar = {45, 45}}, 0, FAIL_USAGE, "--polar: found 45 after 45");
    refused(&(sphere_options){.polar_count = 2, .polar = {45, 30}}, 0, FAIL_USAGE, "rising");
    refused(&(sphere_options){.format = NACRE_FORMAT_R8}, 0, FAIL_USAGE, "--format");
}

/* Files that are valid KTX2, but whose keys are not those of sphere images. */
static void keys_are_checked(void **state)
{
    (void)state;
    static const struct {
        const char *key, *text;
        int count; /* of q16 or u32 values below; 0: text */
        uint32_t value[3];
        const char *word;
    } cases[] = {
        {NACRE_KEY_ROLE, "table", 0, {0}, NACRE_KEY_ROLE},
        {NACRE_KEY_TRANSFER, "srgb", 0, {0}, NACRE_KEY_TRANSFER},
        {NACRE_KEY_LIGHT_POLAR, NULL, 1, {0}, NACRE_KEY_LIGHT_POLAR},
        {NACRE_KEY_LIGHT_POLAR, NULL, 2, {100, 100}, "rising"},
        {NACRE_KEY_LIGHT_POLAR, NULL, 2, {0, 32768}, "32768"},
        {NACRE_KEY_COSINE, NULL, 1, {2}, NACRE_KEY_COSINE},
        {NACRE_KEY_SCALE, NULL, 2, {1, 1}, NACRE_KEY_SCALE},
        {NACRE_KEY_SCALE, NULL, 3, {1, 0, 1}, NACRE_KEY_SCALE},
        {NACRE_KEY_SCALE, NULL, 3, {1, 1, 0x80000000u}, NACRE_KEY_SCALE},
        {NACRE_KEY_DISC, NULL, 1, {32767}, NACRE_KEY_DISC},
        {NACRE_KEY_DISC, NULL, 1, {65537}, NACRE_KEY_DISC},
        {NACRE_KEY_ALBEDO, NULL, 1, {0}, NACRE_KEY_ALBEDO},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ktx2_image image = {
            .format = NACRE_FORMAT_RGBA8, .width = 8, .height = 8, .layers = 2, .faces = 1, .levels = 1};
        const uint8_t zero[512] = {0};
        const uint32_t polar[2] = {0, 16384}, cosine = 0;
        const double one[3] = {1, 1, 1};
        bytes_append(&image.level[0], zero, sizeof zero);
        const char *key = cases[k].key;
        if (strcmp(key, NACRE_KEY_ROLE)) ktx2_key_text(&image, NACRE_KEY_ROLE, "spheres");
        if (strcmp(key, NACRE_KEY_TRANSFER)) ktx2_key_text(&image, NACRE_KEY_TRANSFER, "root4");
        if (strcmp(key, NACRE_KEY_LIGHT_POLAR)) ktx2_key_u32(&image, NACRE_KEY_LIGHT_POLAR, polar, 2);
        if (strcmp(key, NACRE_KEY_COSINE)) ktx2_key_u32(&image, NACRE_KEY_COSINE, &cosine, 1);
        if (strcmp(key, NACRE_KEY_SCALE)) ktx2_key_q16(&image, NACRE_KEY_SCALE, one, 3);
        if (strcmp(key, NACRE_KEY_DISC)) ktx2_key_q16(&image, NACRE_KEY_DISC, one, 1);
        if (strcmp(key, NACRE_KEY_ALBEDO)) ktx2_key_q16(&image, NACRE_KEY_ALBEDO, one, 3);
        if (cases[k].text)
            ktx2_key_text(&image, key, cases[k].text);
        else
            ktx2_key_u32(&image, key, cases[k].value, cases[k].count);
        bytes file = {0};
        nacre_image view;
        sphere_asset s = {.size = -7};
        failure f = {0};
        ktx2_write(&image, &file);
        ktx2_free(&image);
        assert_int_equal(nacre_image_open(&view, file.data, file.size), NACRE_OK);
        assert_int_equal(sphere_read(&s, &view, "bad.ktx2", &f), FAIL_INVALID);
        if (!strstr(f.text, cases[k].word) || strncmp(f.text, "bad.ktx2: ", 10))
            fail_msg("case %zu: \"%s\" does not say \"%s\"", k, f.text, cases[k].word);
        assert_int_equal(s.size, -7);
        bytes_free(&file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lambert_without_cosine),
        cmocka_unit_test(lambert_with_cosine),
        cmocka_unit_test(agrees_with_second_decoder),
        cmocka_unit_test(guards),
        cmocka_unit_test(stored_angles),
        cmocka_unit_test(rotation_sign),
        cmocka_unit_test(layout),
        cmocka_unit_test(other_formats),
        cmocka_unit_test(round_trip),
        cmocka_unit_test(deterministic),
        cmocka_unit_test(options_are_checked),
        cmocka_unit_test(keys_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
