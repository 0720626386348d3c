/* SPDX-License-Identifier: MIT */
/* MERL tables: layout, scales and interpolation against files written here entry by entry; models written and read back;
   every way a file can be wrong. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* before cmocka.h, which defines a macro fail() */
#include "brdf.h"
#include "merl.h"

#include <cmocka.h>

static const double pi = 3.14159265358979323846;
static char directory[] = "/tmp/nacre-merl-XXXXXX";
static char path[64];

static int set_up(void **state)
{
    (void)state;
    if (!mkdtemp(directory)) return -1;
    snprintf(path, sizeof path, "%s/t.binary", directory);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(directory);
}

/* ---- files written by hand ------------------------------------------------------------------------------------------- */

/* A table in the tests' own memory, stored values as in the file: plane, theta_half, theta_diff, phi_diff. */
typedef struct grid {
    int half, diff, phi;
    double *value;
} grid;

static grid grid_make(int half, int diff, int phi, double fill)
{
    grid g = {half, diff, phi, malloc((size_t)half * (size_t)diff * (size_t)phi * 3 * sizeof(double))};
    for (int i = 0; i < half * diff * phi * 3; i++) g.value[i] = fill;
    return g;
}

static double *grid_at(grid *g, int plane, int half, int diff, int phi)
{
    return &g->value[((plane * g->half + half) * g->diff + diff) * g->phi + phi];
}

/* x86 and ARM hosts: int32 and float64 are already little-endian in memory. */
static void grid_write(const grid *g, long cut)
{
    int32_t head[3] = {g->half, g->diff, g->phi};
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(head, 1, 12, file), 12);
    size_t count = (size_t)g->half * (size_t)g->diff * (size_t)g->phi * 3;
    assert_int_equal(fwrite(g->value, 8, count, file), count);
    assert_int_equal(fclose(file), 0);
    if (cut) assert_int_equal(truncate(path, 12 + 8 * (long)count + cut), 0);
}

static brdf *open_grid(const grid *g)
{
    brdf *b = NULL;
    failure f = {0};
    grid_write(g, 0);
    if (merl_open(&b, path, &f)) fail_msg("%s", f.text);
    return b;
}

/* Look up at bin coordinates: (0, 0, 0) is the centre of the first bin. */
static int look_up(const brdf *b, const grid *g, double half, double diff, double phi, double f_r[3])
{
    double l[3], v[3], warped = (half + 0.5) / g->half;
    half_to_directions(warped * warped * pi / 2, (diff + 0.5) / g->diff * pi / 2, (phi + 0.5) / g->phi * pi, l, v);
    return b->eval(b, l, v, f_r);
}

/* A float keeps 24 bits (6e-8 relative); the angles add rounding of the same order. */
static void assert_close(double found, double expected)
{
    if (!(fabs(found - expected) <= 1e-6 * fabs(expected) + 1e-12))
        fail_msg("found %.12g, expected %.12g", found, expected);
}

/* ---- look-up ----------------------------------------------------------------------------------------------------------- */

static void channel_scales(void **state)
{
    (void)state;
    grid g = grid_make(3, 4, 5, 1500);
    brdf *b = open_grid(&g);
    double f_r[3];
    assert_int_equal(look_up(b, &g, 0.3, 1.2, 2.7, f_r), 1);
    assert_close(f_r[0], 1.0);
    assert_close(f_r[1], 1.15);
    assert_close(f_r[2], 1.66);
    brdf_close(b);
    free(g.value);
}

/* Every entry its own number: at the bins' centres the look-up returns it, so axes, order, warp and planes are right. */
static void entries_at_bin_centres(void **state)
{
    (void)state;
    grid g = grid_make(9, 9, 18, 0);
    for (int i = 0; i < 9 * 9 * 18 * 3; i++) g.value[i] = 1500.0 * (1 + i);
    brdf *b = open_grid(&g);
    int seen = 0;
    for (int i = 0; i < 9 * 9 * 18; i++) {
        int half = i / 162, diff = i / 18 % 9, phi = i % 18;
        double f_r[3];
        if (!look_up(b, &g, half, diff, phi, f_r)) /* below the horizon */
            continue;
        /* 1e-5: neighbours differ by up to 162 (1 + i), and rounding puts a little of them in */
        assert_true(fabs(f_r[0] / (1 + i) - 1) < 1e-5);
        assert_true(fabs(f_r[1] / 1.15 / (1 + i + 1458) - 1) < 1e-5);
        assert_true(fabs(f_r[2] / 1.66 / (1 + i + 2916) - 1) < 1e-5);
        seen++;
    }
    assert_true(seen > 700);
    brdf_close(b);
    free(g.value);
}

/* A table linear in its (warped) coordinates is reproduced exactly between centres; beyond the last centre of the
   polar angles it stays constant. */
static void trilinear_between_centres(void **state)
{
    (void)state;
    grid g = grid_make(6, 5, 8, 0);
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < 6 * 5 * 8; i++)
            *grid_at(&g, c, i / 40, i / 8 % 5, i % 8) = 1500 * (10 + 3 * (i / 40) + 2 * (i / 8 % 5) + (i % 8));
    }
    brdf *b = open_grid(&g);
    double f_r[3];
    assert_int_equal(look_up(b, &g, 1.25, 2.5, 4.125, f_r), 1);
    assert_close(f_r[0], 10 + 3 * 1.25 + 2 * 2.5 + 4.125);
    assert_int_equal(look_up(b, &g, -0.4, -0.4, 3, f_r), 1);
    assert_close(f_r[0], 10 + 3);
    assert_int_equal(look_up(b, &g, 0, 4.4, 3, f_r), 1);
    assert_close(f_r[0], 10 + 2 * 4 + 3);
    brdf_close(b);
    free(g.value);
}

/* phi_diff has a period of 180 degrees (reciprocity): the last and the first bin are neighbours. */
static void phi_wraps(void **state)
{
    (void)state;
    grid g = grid_make(4, 4, 6, 1500);
    for (int i = 0; i < 16; i++) *grid_at(&g, 0, i / 4, i % 4, 5) = 4500;
    brdf *b = open_grid(&g);
    double f_r[3];
    assert_int_equal(look_up(b, &g, 0, 1, -0.5, f_r), 1);
    assert_close(f_r[0], 2);
    assert_int_equal(look_up(b, &g, 0, 1, 5.75, f_r), 1);
    assert_close(f_r[0], 1.5);
    assert_int_equal(look_up(b, &g, 0, 1, 11, f_r), 1); /* bin 5, seen from the other side */
    assert_close(f_r[0], 3);
    assert_int_equal(look_up(b, &g, 0, 1, -7, f_r), 1);
    assert_close(f_r[0], 3);
    brdf_close(b);
    free(g.value);
}

static void reciprocal(void **state)
{
    (void)state;
    grid g = grid_make(7, 8, 9, 0);
    for (int i = 0; i < 7 * 8 * 9 * 3; i++) g.value[i] = 100 + (i * 7919) % 1000;
    brdf *b = open_grid(&g);
    srand(3);
    for (int i = 0; i < 1000; i++) {
        double d[6], forth[3], back[3];
        for (int k = 0; k < 6; k++) d[k] = rand() / (double)RAND_MAX * (k % 3 == 2 ? 1 : 2) - (k % 3 == 2 ? 0 : 1);
        for (int k = 0; k < 6; k += 3) {
            double length = sqrt(d[k] * d[k] + d[k + 1] * d[k + 1] + d[k + 2] * d[k + 2]);
            for (int c = 0; c < 3; c++) d[k + c] /= length;
        }
        b->eval(b, d, d + 3, forth);
        b->eval(b, d + 3, d, back);
        for (int c = 0; c < 3; c++) assert_close(forth[c], back[c]);
    }
    brdf_close(b);
    free(g.value);
}

/* ---- entries without data ---------------------------------------------------------------------------------------------- */

static void invalid_entries_lend_no_value(void **state)
{
    (void)state;
    grid g = grid_make(4, 4, 6, 1500);
    *grid_at(&g, 0, 1, 1, 2) = 3000;
    /* one channel without data takes the entry out, however large the others */
    *grid_at(&g, 1, 1, 1, 3) = -1;
    *grid_at(&g, 0, 1, 1, 3) = 1e9;
    brdf *b = open_grid(&g);
    double f_r[3];
    /* a quarter of the way to the neighbour without data: all weight goes to the valid one */
    assert_int_equal(look_up(b, &g, 1, 1, 2.25, f_r), 1);
    assert_close(f_r[0], 2);
    /* and with another axis between: 1/2 x 3/4 of the peak against 1/2 x (3/4 + 1/4) of the flat ones */
    assert_int_equal(look_up(b, &g, 1.5, 1, 2.25, f_r), 1);
    assert_close(f_r[0], (2 * 0.375 + 1 * 0.5) / 0.875);
    brdf_close(b);

    /* all corners without data: no data, and black */
    for (int i = 0; i < 4 * 4 * 6 * 3; i++) g.value[i] = -0.001;
    b = open_grid(&g);
    f_r[0] = f_r[1] = f_r[2] = 7;
    assert_int_equal(look_up(b, &g, 1, 1, 2, f_r), 0);
    assert_true(f_r[0] == 0 && f_r[1] == 0 && f_r[2] == 0);
    brdf_close(b);
    free(g.value);
}

static void below_the_horizon(void **state)
{
    (void)state;
    grid g = grid_make(2, 2, 2, 1500);
    brdf *b = open_grid(&g);
    static const double up[3] = {0, 0, 1}, level[3] = {1, 0, 0}, down[3] = {0.6, 0, -0.8};
    double f_r[3] = {7, 7, 7};
    assert_int_equal(b->eval(b, up, down, f_r), 0);
    assert_true(f_r[0] == 0);
    assert_int_equal(b->eval(b, level, up, f_r), 0);
    assert_int_equal(b->eval(b, up, up, f_r), 1);
    brdf_close(b);
    free(g.value);
}

/* ---- models written and read back --------------------------------------------------------------------------------------- */

static double model_at(const brdf *b, const double coordinate[3], const int count[3])
{
    double l[3], v[3], f_r[3], warped = (coordinate[0] + 0.5) / count[0];
    half_to_directions(warped * warped * pi / 2, (coordinate[1] + 0.5) / count[1] * pi / 2,
                       (coordinate[2] + 0.5) / count[2] * pi, l, v);
    return l[2] > 0 && v[2] > 0 && b->eval(b, l, v, f_r) ? f_r[1] : NAN;
}

/* Linear interpolation between samples one step apart is off by at most max |f''| / 8 per axis; f'' here is the model's
   own second difference over half steps around the point (x 4), the largest of the cell's 27 points. The factor 1.5 is
   for what lies between them. */
static double interpolation_bound(const brdf *b, const double x[3], const int count[3])
{
    double bound = 0;
    for (int axis = 0; axis < 3; axis++) {
        double largest = 0;
        for (int k = 0; k < 27; k++) {
            double y[3] = {floor(x[0]) + k % 3 * 0.5, floor(x[1]) + k / 3 % 3 * 0.5, floor(x[2]) + k / 9 * 0.5};
            double middle = model_at(b, y, count);
            y[axis] += 0.5;
            double next = model_at(b, y, count);
            y[axis] -= 1;
            double second = 4 * fabs(next - 2 * middle + model_at(b, y, count));
            largest = second > largest ? second : largest; /* NaN: below the horizon, leave out */
        }
        bound += largest / 8;
    }
    return 1.5 * bound;
}

/* Every random point whose cell has data all round is within the bound. Returns the largest error relative to the largest
   value for theta_half and theta_diff up to 45 degrees. */
static double read_back(const char *name, const int count[3])
{
    brdf *model = NULL, *table = NULL;
    failure f = {0};
    assert_int_equal(brdf_open(&model, name, &f), 0);
    assert_int_equal(merl_write(path, model, count[0], count[1], count[2], &f), 0);
    if (brdf_open(&table, path, &f)) fail_msg("%s", f.text);
    double worst = 0, most = 0;
    int used = 0;
    srand(5);
    for (int i = 0; i < 4000; i++) {
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = 0.5 + rand() / (double)RAND_MAX * (count[k] - 2);
        double expected = model_at(model, x, count), found = model_at(table, x, count), bound;
        double above[3] = {x[0] + 1.5, x[1] + 1.5, -0.5}; /* worst case: the azimuth that points down */
        if (isnan(expected) || isnan(model_at(model, above, count))) continue;
        bound = interpolation_bound(model, x, count);
        if (!(fabs(found - expected) <= bound + 1e-6 * expected))
            fail_msg("%s %dx%dx%d at %g %g %g: found %g, expected %g within %g", name, count[0], count[1], count[2],
                     x[0], x[1], x[2], found, expected, bound);
        used++;
        if (x[0] > 0.7 * count[0] || x[1] > 0.5 * count[1])
            continue; /* beyond 45 degrees f_r grows without bound in some models */
        worst = fmax(worst, fabs(found - expected));
        most = fmax(most, expected);
    }
    assert_true(used > 500);
    brdf_close(model);
    brdf_close(table);
    return worst / most;
}

/* The bound above is by cell; the figures below say that it is not idle: a tenth of the step gives about a hundredth of
   the error (quadratic), for a lobe that several bins cover. */
static void models_read_back(void **state)
{
    (void)state;
    static const int small[3] = {9, 9, 18}, full[3] = {90, 90, 180};
    static const char *const name[] = {"ggx:rough=.6,f0=.1", "ward:kd=.2,ks=.3,ax=.3", "lafortune:cx=-1,n=8,kd=.1"};
    for (int i = 0; i < 3; i++) {
        double coarse = read_back(name[i], small), fine = read_back(name[i], full);
        print_message("%-26s largest error / largest value: 9x9x18 %.2e, 90x90x180 %.2e\n", name[i], coarse, fine);
        assert_true(coarse < 0.1 && fine < 2e-3 && fine < coarse / 20);
    }
    assert_true(read_back("lambert:albedo=.5", small) < 1e-6);
}

/* Chrome's lobe falls by a power of theta_half from the first bins on: linear interpolation is off by 6 % of the
   peak there, at the one place where the bound allows it. */
static void narrow_lobe_read_back(void **state)
{
    (void)state;
    static const int full[3] = {90, 90, 180};
    double worst = read_back("sgd:chrome", full);
    print_message("sgd:chrome largest error / largest value: 90x90x180 %.2e\n", worst);
    assert_true(worst < 0.2);
}

/* ---- time ---------------------------------------------------------------------------------------------------------------- */

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* 33 MB in under 0.2 s, from the page cache; the best of 5, so that other work on the machine doesn't count. */
static void opens_fast(void **state)
{
    (void)state;
    grid g = grid_make(90, 90, 180, 700);
    grid_write(&g, 0);
    free(g.value);
    double best = 1e9;
    for (int i = 0; i < 5; i++) {
        brdf *b = NULL;
        double start = seconds();
        assert_int_equal(merl_open(&b, path, NULL), 0);
        best = fmin(best, seconds() - start);
        brdf_close(b);
    }
    print_message("90x90x180 opened in %.3f s\n", best);
#if !defined(__SANITIZE_ADDRESS__)
    assert_true(best < 0.2);
#endif
}

/* ---- wrong files ----------------------------------------------------------------------------------------------------------- */

static void refused(int code, const char *words)
{
    failure f = {0};
    brdf *untouched = NULL;
    int found = merl_open(&untouched, path, &f);
    if (found != code || f.code != code) fail_msg("found code %d (%s), expected %d", found, f.text, code);
    assert_null(untouched);
    assert_non_null(strstr(f.text, path));
    assert_null(strchr(f.text, '\n'));
    if (!strstr(f.text, words)) fail_msg("\"%s\" does not say \"%s\"", f.text, words);
}

static void wrong_header(void **state)
{
    (void)state;
    static const struct {
        int count[3];
        const char *words;
    } cases[] = {
        {{0, 90, 180}, "offset 0: found theta_half count 0, expected 1..90"},
        {{91, 90, 180}, "offset 0: found theta_half count 91, expected 1..90"},
        {{90, -1, 180}, "offset 4: found theta_diff count -1, expected 1..90"},
        {{90, 2147483647, 180}, "offset 4: found theta_diff count 2147483647"},
        {{90, 90, 181}, "offset 8: found phi_diff count 181, expected 1..180"},
        {{90, 90, INT32_MIN}, "offset 8: found phi_diff count -2147483648"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int32_t head[3] = {cases[i].count[0], cases[i].count[1], cases[i].count[2]};
        FILE *file = fopen(path, "wb");
        assert_int_equal(fwrite(head, 1, 12, file), 12);
        fclose(file);
        refused(3, cases[i].words);
    }
}

static void wrong_size(void **state)
{
    (void)state;
    grid g = grid_make(2, 3, 4, 1);
    static const long cut[] = {-1, 1, -8, 8, -576};
    for (int i = 0; i < 5; i++) {
        grid_write(&g, cut[i]);
        refused(3, "expected 588 for a table of 2 x 3 x 4");
    }
    for (long size = 0; size < 12; size++) {
        grid_write(&g, size - 588);
        refused(3, "expected a MERL header");
    }
    free(g.value);
}

static void not_finite(void **state)
{
    (void)state;
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e31};
    for (int i = 0; i < 4; i++) {
        grid g = grid_make(2, 3, 4, 1);
        *grid_at(&g, 1, 1, 2, 3) = bad[i]; /* the last entry of the second plane: 12 + 47 x 8 */
        grid_write(&g, 0);
        refused(3, "offset 388: found");
        free(g.value);
    }
}

static void unreadable(void **state)
{
    (void)state;
    unlink(path);
    refused(2, strerror(ENOENT));
    mkdir(path, 0700);
    refused(2, "no regular file");
    rmdir(path);
    mkfifo(path, 0600);
    refused(2, "no regular file");
    unlink(path);
}

static void write_refuses_sizes(void **state)
{
    (void)state;
    brdf *b = NULL;
    failure f;
    assert_int_equal(brdf_open(&b, "lambert:", &f), 0);
    assert_int_equal(merl_write(path, b, 0, 1, 1, &f), 1);
    assert_int_equal(merl_write(path, b, 1, 91, 1, &f), 1);
    assert_int_equal(merl_write(path, b, 1, 1, 181, &f), 1);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(merl_write("/nowhere/at/all.binary", b, 1, 1, 1, &f), 2);
    brdf_close(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(channel_scales),
        cmocka_unit_test(entries_at_bin_centres),
        cmocka_unit_test(trilinear_between_centres),
        cmocka_unit_test(phi_wraps),
        cmocka_unit_test(reciprocal),
        cmocka_unit_test(invalid_entries_lend_no_value),
        cmocka_unit_test(below_the_horizon),
        cmocka_unit_test(models_read_back),
        cmocka_unit_test(narrow_lobe_read_back),
        cmocka_unit_test(opens_fast),
        cmocka_unit_test(wrong_header),
        cmocka_unit_test(wrong_size),
        cmocka_unit_test(not_finite),
        cmocka_unit_test(unreadable),
        cmocka_unit_test(write_refuses_sizes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
