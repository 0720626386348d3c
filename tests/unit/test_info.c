/* SPDX-License-Identifier: MIT */
/* nacre info on good and on subtly broken files: what it prints, and its exit code. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "asset_cases.h"
#include "nacre_asset.h"

#include <cmocka.h> /* last: it makes fail a macro */

static char tool[4096], place[] = "/tmp/nacre-info-XXXXXX";

/* $NACRE_TOOL, or the program beside this test: BUILD/CONFIG/nacre. */
static int find_tool(void **state)
{
    (void)state;
    const char *named = getenv("NACRE_TOOL");
    if (named) {
        snprintf(tool, sizeof tool, "%s", named);
    } else {
        ssize_t n = readlink("/proc/self/exe", tool, sizeof tool - 8);
        if (n <= 0) return -1;
        tool[n] = 0;
        for (int i = 0; i < 3 && strrchr(tool, '/'); i++) *strrchr(tool, '/') = 0;
        strcat(tool, "/nacre");
    }
    return mkdtemp(place) ? 0 : -1;
}

static int remove_place(void **state)
{
    (void)state;
    char command[100];
    snprintf(command, sizeof command, "rm -r %s", place);
    return system(command) ? -1 : 0;
}

/* Standard output and error of `nacre info ARGUMENTS`; returns the exit code. */
static int run(const char *arguments, char *out, size_t size)
{
    char command[6000];
    snprintf(command, sizeof command, "'%s' info %s 2>&1", tool, arguments);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    size_t n = fread(out, 1, size - 1, pipe);
    out[n] = 0;
    while (fgetc(pipe) != EOF) {}
    const int status = pclose(pipe);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void expect(const char *arguments, int code, const char *const *texts)
{
    static char out[60000];
    const int found = run(arguments, out, sizeof out);
    if (found != code) fail_msg("%s: exit code %d, expected %d:\n%s", arguments, found, code, out);
    for (; *texts; texts++)
        if (!strstr(out, *texts)) fail_msg("%s: no \"%s\" in:\n%s", arguments, *texts, out);
}

#define TEXTS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void frozen_files(void **state)
{
    (void)state;
    const char *const *paths;
    char out[20000];
    const int count = asset_fixtures(&paths);
    assert_true(count > 0);
    for (int i = 0; i < count; i++)
        if (run(paths[i], out, sizeof out)) fail_msg("%s: %s", paths[i], out);
    expect("fixtures/asset/v1-table.ktx2", 0,
           TEXTS("RGBA8 (vkFormat 37), 24 x 21", "2016 bytes at 432", "0.875 (57344)", "-0.5 (-32768)",
                 "half-vector table of table: default tier", "for sRGB output"));
    expect("fixtures/asset/v1-table-fine.ktx2", 0, TEXTS("fine tier, early layout"));
    expect("fixtures/asset/v1-table-two.ktx2", 0, TEXTS("fine tier (two fetches per light)"));
    expect("fixtures/asset/v1-spheres-etc1.ktx2", 0,
           TEXTS("67.5 deg (12288)", "lit from 0, 33.75, 67.5, 101.2, 135 degrees, cosine-free",
                 "all 35 blocks are ETC1"));
    expect("fixtures/asset/v1-spheres-rgb565.ktx2", 0, TEXTS("paper mode", "transfer sRGB"));
}

static void json_instead_of_text(void **state)
{
    (void)state;
    static char out[20000];
    assert_int_equal(run("fixtures/asset/v1-table.ktx2 --json -", out, sizeof out), 0);
    assert_true(out[0] == '{');
    assert_non_null(strstr(out, "\"texel_bytes\": 2016"));
    assert_non_null(strstr(out, "\"nacre.role\": \"table\""));
}

static void brdf_names(void **state)
{
    (void)state;
    expect("--brdfs", 0, TEXTS("sgd:gold-metallic-paint\n", "lafortune:clay\n", "ngan-cook-torrance:"));
}

static void usage(void **state)
{
    (void)state;
    expect("", 1, TEXTS("expected a FILE"));
    expect("--jsom x", 1, TEXTS("--json"));
    expect("no-such-file", 2, TEXTS("no-such-file"));
}

/* A case, changed before it is written. */
static void write_changed(const asset_case *c, void (*change)(ktx2_image *), char *path, size_t path_size)
{
    ktx2_image k;
    bytes file = {0};
    failure f = {0};
    asset_case_make(c, &k);
    change(&k);
    ktx2_write(&k, &file);
    snprintf(path, path_size, "%s/changed.ktx2", place);
    if (output_write_raw(path, &file, &f)) fail_msg("%s", f.text);
    ktx2_free(&k);
    bytes_free(&file);
}

static const asset_case *named(const char *name)
{
    for (int i = 0; i < asset_case_count; i++)
        if (!strcmp(asset_cases[i].name, name)) return &asset_cases[i];
    fail_msg("no case %s", name);
    return NULL;
}

/* Differential mode with a base colour of 31 and a step of 3: overflows, which ETC2 reads as another mode. */
static void break_block(ktx2_image *k)
{
    uint8_t *block = k->level[1].data + 8;
    block[0] = 31 << 3 | 3;
    block[3] |= 2;
}

static void set_q16(ktx2_image *k, const char *name, int i, double value)
{
    for (int n = 0; n < k->key_count; n++) {
        if (strcmp(k->key[n].name, name)) continue;
        const uint32_t raw = (uint32_t)(int32_t)(value * 65536);
        for (int b = 0; b < 4; b++) k->key[n].value.data[4 * i + b] = (uint8_t)(raw >> 8 * b);
    }
}

static void break_power(ktx2_image *k)
{
    set_q16(k, NACRE_KEY_TABLE, 5, 100);
}

static void break_disc(ktx2_image *k)
{
    set_q16(k, NACRE_KEY_DISC, 0, 1.5);
}

static void break_role(ktx2_image *k)
{
    for (int n = 0; n < k->key_count; n++)
        if (!strcmp(k->key[n].name, NACRE_KEY_ROLE)) k->key[n].value.data[0] = 'T';
}

static void add_toe(ktx2_image *k)
{
    ktx2_key_u32(k, NACRE_KEY_TOE, &(uint32_t){1}, 1);
}

static void tables_that_keep_the_toe(void **state)
{
    (void)state;
    char path[200];
    write_changed(named("table"), add_toe, path, sizeof path);
    expect(path, 0, TEXTS("nacre.keeps_toe      1\n", "for sRGB output with the curve's linear toe"));
}

static void broken_assets(void **state)
{
    (void)state;
    char path[200];
    write_changed(named("spheres-etc1"), break_block, path, sizeof path);
    expect(path, 3, TEXTS("offset 640: found a block in a mode of ETC2", "level 3"));
    write_changed(named("table"), break_power, path, sizeof path);
    expect(path, 3, TEXTS(NACRE_KEY_TABLE, "100"));
    write_changed(named("spheres"), break_disc, path, sizeof path);
    expect(path, 3, TEXTS(NACRE_KEY_DISC));
    write_changed(named("table"), break_role, path, sizeof path);
    expect(path, 3, TEXTS(NACRE_KEY_ROLE, "Table"));
}

static void write_bytes(const char *name, const void *data, size_t size, char *path, size_t path_size)
{
    bytes file = {0};
    failure f = {0};
    bytes_append(&file, data, size);
    snprintf(path, path_size, "%s/%s", place, name);
    if (output_write_raw(path, &file, &f)) fail_msg("%s", f.text);
    bytes_free(&file);
}

static void damaged_and_foreign_files(void **state)
{
    (void)state;
    char path[200];
    bytes file = {0};
    failure f = {0};
    if (file_read(&file, "fixtures/asset/v1-spheres.ktx2", &f)) fail_msg("%s", f.text);
    write_bytes("cut.ktx2", file.data, 700, path, sizeof path);
    expect(path, 3, TEXTS("found 700 bytes, expected 1928"));
    write_bytes("short.ktx2", file.data, 40, path, sizeof path);
    expect(path, 3, TEXTS("found 40 bytes"));
    file.data[12] = 43;
    write_bytes("format.ktx2", file.data, file.size, path, sizeof path);
    expect(path, 4, TEXTS("offset 12: found vkFormat 43"));
    file.data[12] = 37;
    file.data[44] = 2;
    write_bytes("zstd.ktx2", file.data, file.size, path, sizeof path);
    expect(path, 4, TEXTS("offset 44: found supercompressionScheme 2, expected 0..0"));
    write_bytes("empty", "", 0, path, sizeof path);
    expect(path, 3, TEXTS("offset 0"));
    bytes_free(&file);
}

/* 2 x 3 x 4 bins; red 1500 x bin, one entry without a measurement. */
static void a_small_merl_table(void **state)
{
    (void)state;
    char path[200];
    bytes file = {0};
    for (uint32_t i = 2; i <= 4; i++) bytes_append_u32(&file, i);
    for (int i = 0; i < 3 * 24; i++) {
        const double value = i == 5 ? -1 : 1500.0 * (i % 24);
        bytes_append(&file, &value, sizeof value); /* test hosts are little-endian */
    }
    write_bytes("small.binary", file.data, file.size, path, sizeof path);
    expect(path, 0,
           TEXTS("2 theta_half x 3 theta_diff x 4 phi_diff", "R: f_r 0..23 1/sr, 1 of 24",
                 "G: f_r 0..26.45 1/sr, 0 of 24"));
    write_bytes("cut.binary", file.data, file.size - 8, path, sizeof path);
    expect(path, 3, TEXTS("cut.binary"));
    bytes_free(&file);
}

/* A tensor file: one field "rgb" of 2 x 2 floats; then cut. Not a BRDF, which is said too. */
static void a_tensor_file(void **state)
{
    (void)state;
    char path[200];
    bytes file = {0};
    const float values[4] = {0.5f, 1, 2, -3};
    bytes_append(&file, "tensor_file\0\1\0", 14);
    bytes_append_u32(&file, 1);
    bytes_append(&file, "\3\0rgb\2\0\12", 8);
    const uint32_t numbers[] = {18 + 8 + 24, 0, 2, 0, 2, 0}; /* offset and two sizes, 64 bits each */
    for (int i = 0; i < 6; i++) bytes_append_u32(&file, numbers[i]);
    bytes_append(&file, values, sizeof values);
    write_bytes("small.bsdf", file.data, file.size, path, sizeof path);
    static char out[5000];
    const int code = run(path, out, sizeof out);
    assert_true(code == 0 || code == 3);
    assert_non_null(strstr(out, "1 fields"));
    assert_non_null(strstr(out, "2 x 2, -3..2"));
    for (size_t size = 12; size < file.size; size++) {
        write_bytes("cut.bsdf", file.data, size, path, sizeof path);
        assert_int_equal(run(path, out, sizeof out), 3);
        assert_non_null(strstr(out, "cut.bsdf"));
    }
    bytes_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frozen_files),
        cmocka_unit_test(json_instead_of_text),
        cmocka_unit_test(brdf_names),
        cmocka_unit_test(usage),
        cmocka_unit_test(tables_that_keep_the_toe),
        cmocka_unit_test(broken_assets),
        cmocka_unit_test(damaged_and_foreign_files),
        cmocka_unit_test(a_small_merl_table),
        cmocka_unit_test(a_tensor_file),
    };
    return cmocka_run_group_tests(tests, find_tool, remove_place);
}
