/* SPDX-License-Identifier: MIT */
/* RGL tensor files: files written here, whose value is known in closed form, from a model, or from another renderer; and
   every truncation and every change of a byte. */
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
#include "output.h"
#include "rgl.h"

#include <cmocka.h>

static const double pi = 3.14159265358979323846;
static char path[] = "/tmp/nacre-rgl-XXXXXX.bsdf";

static int set_up(void **state)
{
    (void)state;
    int fd = mkstemps(path, 5);
    return fd < 0 ? -1 : close(fd);
}

static int tear_down(void **state)
{
    (void)state;
    return unlink(path);
}

/* ---- writer ------------------------------------------------------------------------------------------------------------ */

enum { FIELDS = 8, U8 = 1, FLOAT = 10 };

typedef struct tensor {
    const char *name;
    int type, dimensions, side[5];
    void *data; /* uint8_t or float, malloc'd */
} tensor;

/* description jacobian theta_i phi_i ndf sigma vndf rgb */
typedef struct material {
    tensor t[FIELDS];
} material;
enum { DESCRIPTION, JACOBIAN, THETA, PHI, NDF, SIGMA, VNDF, RGB };

static size_t elements(const tensor *t)
{
    size_t n = 1;
    for (int i = 0; i < t->dimensions; i++) n *= (size_t)t->side[i];
    return n;
}

static material make(int thetas, int ndf, int sigma, int vndf_height, int vndf_width, int rgb)
{
    material m = {{{"description", U8, 1, {4}, NULL},
                   {"jacobian", U8, 1, {1}, NULL},
                   {"theta_i", FLOAT, 1, {thetas}, NULL},
                   {"phi_i", FLOAT, 1, {1}, NULL},
                   {"ndf", FLOAT, 2, {ndf, ndf + 1}, NULL},
                   {"sigma", FLOAT, 2, {3, sigma}, NULL},
                   {"vndf", FLOAT, 4, {1, thetas, vndf_height, vndf_width}, NULL},
                   {"rgb", FLOAT, 5, {1, thetas, 3, rgb, rgb}, NULL}}};
    for (int i = 0; i < FIELDS; i++) m.t[i].data = calloc(elements(&m.t[i]), 4);
    memcpy(m.t[DESCRIPTION].data, "made", 4);
    *(uint8_t *)m.t[JACOBIAN].data = 1;
    return m;
}

static void drop(material *m)
{
    for (int i = 0; i < FIELDS; i++) free(m->t[i].data);
}

static float *values(material *m, int field)
{
    return m->t[field].data;
}

static void put(bytes *out, uint64_t value, int size)
{
    for (int i = 0; i < size; i++) {
        uint8_t b = (uint8_t)(value >> 8 * i);
        bytes_append(out, &b, 1);
    }
}

/* The file's bytes; hosts of the tests are little-endian. skip leaves a field out (-1: none). */
static bytes encode(const material *m, int skip)
{
    bytes out = {0};
    size_t at = 18;
    for (int i = 0; i < FIELDS; i++) at += i == skip ? 0 : strlen(m->t[i].name) + 13 + 8 * (size_t)m->t[i].dimensions;
    bytes_append(&out, "tensor_file\0\1\0", 14);
    put(&out, skip < 0 ? FIELDS : FIELDS - 1, 4);
    for (int i = 0; i < FIELDS; i++) {
        const tensor *t = &m->t[i];
        if (i == skip) continue;
        put(&out, strlen(t->name), 2);
        bytes_append(&out, t->name, strlen(t->name));
        put(&out, (uint64_t)t->dimensions, 2);
        put(&out, (uint64_t)t->type, 1);
        put(&out, at, 8);
        for (int k = 0; k < t->dimensions; k++) put(&out, (uint64_t)t->side[k], 8);
        at += elements(t) * (t->type == U8 ? 1 : 4);
    }
    for (int i = 0; i < FIELDS; i++) {
        if (i != skip) bytes_append(&out, m->t[i].data, elements(&m->t[i]) * (m->t[i].type == U8 ? 1 : 4));
    }
    return out;
}

static void write_bytes(const uint8_t *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static brdf *open_material(const material *m)
{
    bytes file = encode(m, -1);
    write_bytes(file.data, file.size);
    bytes_free(&file);
    brdf *b = NULL;
    failure f = {0};
    if (brdf_open(&b, path, &f)) fail_msg("%s", f.text);
    return b;
}

static void polar(double theta, double azimuth, double d[3])
{
    d[0] = sin(theta) * cos(azimuth);
    d[1] = sin(theta) * sin(azimuth);
    d[2] = cos(theta);
}

/* ---- another renderer --------------------------------------------------------------------------------------------------- */

static uint32_t random_state;

static void fill_random(float *out, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        random_state = random_state * 1664525U + 1013904223U;
        out[i] = (float)(0.2 + (random_state >> 8) / 16777216.0);
    }
}

/* 4 x (5 x 6, 3 x 4, 6 x 5, 5 x 5) random numbers; sigma doesn't depend on the azimuth. */
static material random_material(void)
{
    material m = make(4, 5, 4, 6, 5, 5);
    static const float theta[4] = {0, 0.4F, 0.8F, 1.5F};
    random_state = 1;
    memcpy(values(&m, THETA), theta, sizeof theta);
    fill_random(values(&m, NDF), 30);
    fill_random(values(&m, SIGMA), 4);
    memcpy(values(&m, SIGMA) + 4, values(&m, SIGMA), 16);
    memcpy(values(&m, SIGMA) + 8, values(&m, SIGMA), 16);
    fill_random(values(&m, VNDF), 120);
    fill_random(values(&m, RGB), 300);
    return m;
}

/* f_r n.light for light and eye at these polar and azimuth angles, as found by Mitsuba 3.9.1 (BSDF `measured`, variant
   scalar_spectral) for the same numbers as spectra at 450, 550 and 650 nm. */
static const struct {
    int light_polar, light_azimuth, eye_polar, eye_azimuth;
    double value[3];
} mitsuba[] = {
    {57, 109, 1, 110, {0.2329197, 0.2547989, 0.2640593}},   {40, 5, 54, -78, {0.1645745, 0.1688018, 0.1859675}},
    {84, -161, 23, -42, {0.2830527, 0.2862378, 0.3250248}}, {49, -33, 11, -164, {0.2354116, 0.2368016, 0.211838}},
    {0, -163, 12, 179, {0.2506039, 0.2935483, 0.3703358}},  {16, 54, 64, -96, {0.1330003, 0.1415527, 0.1608979}},
    {24, -24, 22, 170, {0.3435832, 0.2929606, 0.3344067}},  {15, 143, 68, 123, {0.2064388, 0.1947598, 0.1967467}},
    {9, -39, 54, -3, {0.2206047, 0.2707393, 0.2011562}},    {57, 63, 57, -159, {0.2147032, 0.2431995, 0.1266105}},
    {82, 20, 77, -83, {0.1103751, 0.1192199, 0.1060613}},   {31, 136, 16, -157, {0.2319871, 0.2565466, 0.2301654}},
    {32, 64, 10, 133, {0.2375032, 0.2186713, 0.21443}},     {29, -99, 46, 142, {0.09314191, 0.1647228, 0.0821183}},
    {76, 133, 26, -174, {0.3965012, 0.3943391, 0.3777617}}, {66, 74, 66, -180, {0.1995983, 0.1854077, 0.1519027}},
};

/* 2e-5: Mitsuba computes in single precision (3,000 other pairs: median 9e-7, largest 1e-5 to 2e-4). */
static void agrees_with_mitsuba(void **state)
{
    (void)state;
    material m = random_material();
    brdf *b = open_material(&m);
    for (size_t i = 0; i < sizeof mitsuba / sizeof *mitsuba; i++) {
        double l[3], v[3], out[3], f_r[3];
        polar(mitsuba[i].light_polar * pi / 180, mitsuba[i].light_azimuth * pi / 180, l);
        polar(mitsuba[i].eye_polar * pi / 180, mitsuba[i].eye_azimuth * pi / 180, v);
        assert_int_equal(brdf_eval_cosine(b, l, v, out), 1);
        assert_int_equal(b->eval(b, l, v, f_r), 1);
        for (int c = 0; c < 3; c++) {
            if (fabs(out[c] / mitsuba[i].value[c] - 1) > 2e-5)
                fail_msg("pair %zu: found %.7g, expected %.7g", i, out[c], mitsuba[i].value[c]);
            assert_true(fabs(f_r[c] * l[2] / out[c] - 1) < 1e-12);
        }
    }
    brdf_close(b);
    drop(&m);
}

/* ---- closed form ---------------------------------------------------------------------------------------------------------- */

/* Functions that the tables' interpolation reproduces exactly: density (1 + a x)(1 + b y) with another a in each of the
   two slices, ndf 1 + ux, sigma 2 + ux, rgb (c + 1)(1 + s + 2 t + s t). The warp then has a closed form: per slice, with
   r = 1 / ((1 + a/2)(1 + b/2)), the row at y integrates to r (1 + b y)(1 + a/2) and up to x to r (1 + b y)(x + a x^2/2). */
static void closed_form(void **state)
{
    (void)state;
    enum { N = 9 };
    material m = make(2, N, N, N, N, N);
    static const double a[2] = {0.5, 3}, slope = 1.5;
    values(&m, THETA)[1] = 1;
    for (int y = 0; y < N; y++) {
        for (int x = 0; x < N; x++) {
            double ux = x / (N - 1.0), uy = y / (N - 1.0);
            for (int s = 0; s < 2; s++) {
                values(&m, VNDF)[(s * N + y) * N + x] = (float)((1 + a[s] * ux) * (1 + slope * uy));
                for (int c = 0; c < 3; c++)
                    values(&m, RGB)[((3 * s + c) * N + y) * N + x] = (float)((c + 1) * (1 + ux + 2 * uy + ux * uy));
            }
        }
    }
    for (int i = 0; i < N * (N + 1); i++) values(&m, NDF)[i] = (float)(1 + i % (N + 1) / (double)N);
    for (int i = 0; i < 3 * N; i++) values(&m, SIGMA)[i] = (float)(2 + i % N / (N - 1.0));
    brdf *b = open_material(&m);
    for (int i = 0; i < 300; i++) {
        double theta_l = 1.3 * (i % 13) / 12, theta_v = 0.95 * (i % 7 + 0.5) / 7, l[3], v[3], h[3], length = 0;
        polar(theta_l, 0.37 * i, l);
        polar(theta_v, 0.61 * i, v);
        for (int c = 0; c < 3; c++) h[c] = l[c] + v[c];
        for (int c = 0; c < 3; c++) length += h[c] * h[c];
        double turn = (atan2(h[1], h[0]) - atan2(v[1], v[0])) / (2 * pi) + 0.5, w = theta_v;
        double ux = sqrt(acos(h[2] / sqrt(length)) * 2 / pi), uy = turn - floor(turn), whole = 0, part = 0, above = 0;
        for (int s = 0; s < 2; s++) {
            double weight = (s ? w : 1 - w) / ((1 + a[s] / 2) * (1 + slope / 2));
            whole += weight * (1 + slope * uy) * (1 + a[s] / 2);
            part += weight * (1 + slope * uy) * (ux + a[s] * ux * ux / 2);
            above += weight * (uy + slope * uy * uy / 2) * (1 + a[s] / 2);
        }
        double x = part / whole, y = above, out[3];
        assert_int_equal(brdf_eval_cosine(b, l, v, out), 1);
        for (int c = 0; c < 3; c++) {
            double expected = (c + 1) * (1 + x + 2 * y + x * y) * (1 + ux) / (4 * (2 + sqrt(theta_v * 2 / pi)));
            if (fabs(out[c] / expected - 1) > 1e-6) /* floats in the file: 6e-8 each */
                fail_msg("pair %d: found %.9g, expected %.9g", i, out[c], expected);
        }
    }
    brdf_close(b);
    drop(&m);
}

/* ---- a model ---------------------------------------------------------------------------------------------------------------- */

/* A file made from a model: uniform warp, ndf = sigma = 1, rgb = 4 f_r n.light at each sample's half vector. Samples whose
   light is below the horizon repeat the value 0. */
static material from_model(const brdf *model, int thetas, int size)
{
    material m = make(thetas, 2, 2, 2, 2, size);
    for (int i = 0; i < 6; i++) values(&m, NDF)[i] = values(&m, SIGMA)[i] = 1;
    for (int i = 0; i < 4 * thetas; i++) values(&m, VNDF)[i] = 1;
    for (int t = 0; t < thetas; t++) {
        double theta = 1.2 * t / (thetas - 1), v[3];
        values(&m, THETA)[t] = (float)theta;
        polar((double)(float)theta, 0, v);
        for (int i = 0; i < size * size; i++) {
            double ux = i % size / (size - 1.0), uy = i / size / (size - 1.0), h[3], l[3], f[3];
            polar(ux * ux * pi / 2, (2 * uy - 1) * pi, h);
            double v_dot_h = v[0] * h[0] + v[1] * h[1] + v[2] * h[2];
            for (int c = 0; c < 3; c++) l[c] = 2 * v_dot_h * h[c] - v[c];
            brdf_eval_cosine(model, l, v, f);
            for (int c = 0; c < 3; c++) values(&m, RGB)[(t * 3 + c) * size * size + i] = (float)(4 * f[c]);
        }
    }
    return m;
}

/* Largest difference of f_r n.light from the model, relative to its largest, for eyes at (step + offset) of the file's
   angles and half vectors at offset between samples (0: on them). */
static double model_error(const brdf *model, const brdf *file, int thetas, int size, double offset)
{
    double worst = 0, most = 0;
    for (int t = 0; t + 1 < thetas; t++) {
        double theta = 1.2 * (t + offset) / (thetas - 1), v[3];
        polar(theta, 1, v);
        for (int i = 0; i < (size - 1) * (size - 1); i++) {
            double ux = (i % (size - 1) + offset) / (size - 1), uy = (i / (size - 1) + offset) / (size - 1), h[3], l[3];
            double found[3], expected[3];
            polar(ux * ux * pi / 2, 1 + (2 * uy - 1) * pi, h);
            double v_dot_h = v[0] * h[0] + v[1] * h[1] + v[2] * h[2];
            for (int c = 0; c < 3; c++) l[c] = 2 * v_dot_h * h[c] - v[c];
            if (l[2] < 0.15 || v_dot_h <= 0) /* the horizon cuts cells */
                continue;
            brdf_eval_cosine(model, l, v, expected);
            brdf_eval_cosine(file, l, v, found);
            worst = fmax(worst, fabs(found[1] - expected[1]));
            most = fmax(most, expected[1]);
        }
    }
    return worst / most;
}

/* On the samples the file is the model (1e-5: floats, and angles rounded to them); between them the error of linear
   interpolation, which falls fourfold when the step is halved. */
static void model_round_trip(void **state)
{
    (void)state;
    brdf *model = NULL;
    assert_int_equal(brdf_open(&model, "ggx:rough=.7,f0=.2,albedo=.3", NULL), 0);
    double between[2];
    for (int i = 0; i < 2; i++) {
        int thetas = 9 + 8 * i, size = 25 + 24 * i;
        material m = from_model(model, thetas, size);
        brdf *file = open_material(&m);
        double at = model_error(model, file, thetas, size, 0);
        between[i] = model_error(model, file, thetas, size, 0.5);
        print_message("%d x %d x %d: on samples %.1e, between %.1e\n", thetas, size, size, at, between[i]);
        assert_true(at < 1e-5);
        brdf_close(file);
        drop(&m);
    }
    assert_true(between[0] < 0.07 && between[1] < between[0] / 3);
    brdf_close(model);
}

/* ---- bad files ---------------------------------------------------------------------------------------------------------------- */

static void refused(const material *m, int skip, int code, const char *words)
{
    bytes file = encode(m, skip);
    write_bytes(file.data, file.size);
    bytes_free(&file);
    brdf *b = NULL;
    failure f = {0};
    int found = rgl_open(&b, path, &f);
    if (found != code || b || !strstr(f.text, words) || !strstr(f.text, path))
        fail_msg("found code %d, \"%s\", expected %d, \"%s\"", found, f.text, code, words);
}

static void wrong_fields(void **state)
{
    (void)state;
    material m = random_material();
    static const int needed[] = {JACOBIAN, THETA, PHI, NDF, SIGMA, VNDF, RGB};
    for (int i = 0; i < 7; i++) {
        char words[60];
        snprintf(words, sizeof words, "found no field \"%s\"", m.t[needed[i]].name);
        refused(&m, needed[i], 3, words);
    }
    m.t[RGB].name = "spectra";
    refused(&m, -1, 4, "spectral file");
    m.t[RGB].name = "rgb";
    *(uint8_t *)m.t[JACOBIAN].data = 0;
    refused(&m, -1, 4, "jacobian");
    *(uint8_t *)m.t[JACOBIAN].data = 1;
    values(&m, THETA)[2] = 0.4F;
    refused(&m, -1, 3, "expected rising angles");
    values(&m, THETA)[2] = 0.8F;
    values(&m, NDF)[7] = NAN;
    refused(&m, -1, 3, "field \"ndf\": found nan");
    values(&m, NDF)[7] = 1;
    values(&m, VNDF)[119] = -1;
    refused(&m, -1, 3, "field \"vndf\": found -1, expected a finite number from 0");
    memset(values(&m, VNDF) + 60, 0, 60 * sizeof(float));
    refused(&m, -1, 3, "slice 2: found zeros only");
    drop(&m);

    m = random_material();
    m.t[NDF].type = 5; /* uint32: as long as float */
    refused(&m, -1, 3, "field \"ndf\": found type 5");
    m.t[NDF].type = FLOAT;
    m.t[RGB].side[2] = 1;
    m.t[RGB].side[1] = 12;
    refused(&m, -1, 3, "field \"rgb\": found size 12 of dimension 1, expected 4");
    drop(&m);
}

static void anisotropic_is_refused(void **state)
{
    (void)state;
    material m = random_material();
    free(m.t[PHI].data);
    m.t[PHI].side[0] = 3;
    m.t[PHI].data = calloc(3, 4);
    values(&m, PHI)[1] = 1;
    values(&m, PHI)[2] = 2;
    refused(&m, -1, 4, "anisotropic");
    drop(&m);
}

/* Every truncation is refused; every byte of the list of fields with one of three bits flipped, and bytes after it
   set to 255, opens or is refused, and what opens evaluates to finite numbers (run under ASan too). */
static void truncated_and_changed(void **state)
{
    (void)state;
    material m = random_material();
    bytes file = encode(&m, -1);
    size_t list = file.size - (4 + 1 + 4 * (4 + 1 + 30 + 12 + 120 + 300));
    for (size_t size = 0; size < file.size; size += size < list + 16 ? 1 : 61) {
        brdf *b = NULL;
        write_bytes(file.data, size);
        assert_int_equal(rgl_open(&b, path, NULL), 3);
        assert_null(b);
    }
    int opened = 0;
    for (size_t i = 0; i < file.size; i += i < list ? 1 : 7) {
        for (int bit = 0; bit < (i < list ? 8 : 1); bit += 3) {
            uint8_t kept = file.data[i];
            file.data[i] = i < list ? kept ^ (uint8_t)(1U << bit) : 255;
            write_bytes(file.data, file.size);
            brdf *b = NULL;
            int code = rgl_open(&b, path, NULL);
            assert_true(code == 0 || code == 3 || code == 4);
            if (!code) {
                double l[3], v[3], out[3];
                polar(0.7, 1, l);
                polar(0.5, 3, v);
                brdf_eval_cosine(b, l, v, out);
                for (int c = 0; c < 3; c++) assert_true(isfinite(out[c]) && out[c] >= 0);
                opened++;
            }
            brdf_close(b);
            file.data[i] = kept;
        }
    }
    assert_true(opened > 0);
    bytes_free(&file);
    drop(&m);
}

static void not_a_tensor_file(void **state)
{
    (void)state;
    brdf *b = NULL;
    failure f = {0};
    write_bytes((const uint8_t *)"tensor_file\0\2\0\1\0\0\0", 18);
    assert_int_equal(rgl_open(&b, path, &f), 4);
    assert_non_null(strstr(f.text, "version 2.0"));
    write_bytes((const uint8_t *)"tensor_file\0\1\0\0\0\0\0", 18);
    assert_int_equal(rgl_open(&b, path, &f), 3);
    write_bytes((const uint8_t *)"Tensor_file\0\1\0\1\0\0\0", 18);
    assert_int_equal(rgl_open(&b, path, &f), 3);
    assert_non_null(strstr(f.text, "offset 0"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_mitsuba),    cmocka_unit_test(closed_form),
        cmocka_unit_test(model_round_trip),       cmocka_unit_test(wrong_fields),
        cmocka_unit_test(anisotropic_is_refused), cmocka_unit_test(truncated_and_changed),
        cmocka_unit_test(not_a_tensor_file),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
