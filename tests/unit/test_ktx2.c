/* SPDX-License-Identifier: MIT */
/* What the writer writes, as readers that share no code with it see it. `test_ktx2 --write DIR` makes the fixtures. */
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
#include "ktx2_ref.h"
#include "nacre.h"
#include "nacre_asset.h"

#include <cmocka.h> /* last: it makes fail a macro */

static void write_case(const asset_case *c, bytes *file)
{
    ktx2_image k;
    asset_case_make(c, &k);
    ktx2_write(&k, file);
    ktx2_free(&k);
}

static void expect_valid(ktx2_ref *ref, const bytes *file, const char *name)
{
    char why[200] = "";
    if (!ktx2_ref_read(ref, file->data, file->size, why, sizeof why)) fail_msg("%s: %s", name, why);
}

/* Header, texels and keys arrive as they were given. */
static void expect_same(const asset_case *c, const bytes *file)
{
    ktx2_image k;
    ktx2_ref ref;
    asset_case_make(c, &k);
    expect_valid(&ref, file, c->name);
    assert_int_equal(ref.vk_format, c->format);
    assert_int_equal(ref.width, c->width);
    assert_int_equal(ref.height, c->height);
    assert_int_equal(ref.layer_count, c->layers);
    assert_int_equal(ref.face_count, c->faces);
    assert_int_equal(ref.level_count, c->levels);
    assert_int_equal(ref.transfer, c->srgb ? 2 : 1);
    for (int i = 0; i < c->levels; i++) {
        assert_int_equal(ref.level_length[i], k.level[i].size);
        assert_memory_equal(file->data + ref.level_offset[i], k.level[i].data, k.level[i].size);
    }
    for (int i = 0; i < k.key_count; i++) {
        size_t size = 0;
        const uint8_t *value = ktx2_ref_key(&ref, k.key[i].name, &size);
        assert_non_null(value);
        assert_int_equal(size, k.key[i].value.size);
        assert_memory_equal(value, k.key[i].value.data, size);
    }
    assert_int_equal(ref.key_count, k.key_count + 3);
    ktx2_free(&k);
}

static void every_case_arrives(void **state)
{
    (void)state;
    for (int i = 0; i < asset_case_count; i++) {
        bytes file = {0};
        write_case(&asset_cases[i], &file);
        expect_same(&asset_cases[i], &file);
        bytes_free(&file);
    }
}

/* Files of an asset version open for ever; while the writer is at the version that wrote them, it writes them again. */
static void frozen_files_are_written_again(void **state)
{
    (void)state;
    for (int i = 0; i < asset_case_count; i++) {
        char path[1200];
        bytes frozen = {0}, today = {0};
        failure f = {0};
        snprintf(path, sizeof path, "%s/v1-%s.ktx2", asset_fixture_directory(), asset_cases[i].name);
        if (file_read(&frozen, path, &f)) fail_msg("%s", f.text);
        expect_same(&asset_cases[i], &frozen);
        write_case(&asset_cases[i], &today);
        if (NACRE_ASSET_VERSION == 1 && NACRE_VERSION == 0x000100) {
            assert_int_equal(today.size, frozen.size);
            assert_memory_equal(today.data, frozen.data, today.size);
        }
        bytes_free(&frozen);
        bytes_free(&today);
    }
}

static void keys_every_file_has(void **state)
{
    (void)state;
    bytes file = {0};
    ktx2_ref ref;
    size_t size = 0;
    write_case(&asset_cases[0], &file);
    expect_valid(&ref, &file, asset_cases[0].name);
    assert_string_equal(ktx2_ref_key(&ref, "KTXorientation", &size), "rd");
    const uint8_t *writer = ktx2_ref_key(&ref, "KTXwriter", &size);
    assert_memory_equal(writer, "nacre 0.1.0", size);
    const uint8_t *version = ktx2_ref_key(&ref, NACRE_KEY_VERSION, &size);
    assert_int_equal(size, 4);
    assert_memory_equal(version, "\1\0\0\0", 4);
    bytes_free(&file);
}

/* Equal images give equal bytes, whatever order the keys came in. */
static void key_order_does_not_matter(void **state)
{
    (void)state;
    bytes first = {0}, second = {0};
    for (int turn = 0; turn < 2; turn++) {
        ktx2_image k = {.format = NACRE_FORMAT_R8, .width = 1, .height = 1, .faces = 1, .levels = 1};
        bytes_append(&k.level[0], "x", 1);
        const char *const names[] = {"nacre.role", "nacre.name", "nacre.transfer", "Zebra", "other"};
        for (int i = 0; i < 5; i++) {
            const char *name = names[turn ? 4 - i : i];
            ktx2_key_text(&k, name, name);
        }
        ktx2_write(&k, turn ? &second : &first);
        ktx2_free(&k);
    }
    assert_int_equal(first.size, second.size);
    assert_memory_equal(first.data, second.data, first.size);
    ktx2_ref ref;
    expect_valid(&ref, &first, "keys");
    bytes_free(&first);
    bytes_free(&second);
}

/* Nearest, saturating, -1/65536 resolved. */
static void q16_values(void **state)
{
    (void)state;
    const double value[] = {1, -1, 0.5 / 65536 + 1.0 / 131072 / 4, 1e9, -1e9, -1.0 / 65536};
    const uint32_t expected[] = {65536, 0xFFFF0000u, 1, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu};
    ktx2_image k = {0};
    ktx2_key_q16(&k, "abc", value, 6);
    for (int i = 0; i < 6; i++) {
        const uint8_t *p = k.key[0].value.data + 4 * i;
        assert_int_equal(p[0] | p[1] << 8 | p[2] << 16 | (uint32_t)p[3] << 24, expected[i]);
    }
    ktx2_free(&k);
}

/* Names of keys that hold numbers: 4n - 1 characters. */
static void number_keys_are_aligned(void **state)
{
    (void)state;
    const char *const names[] = {NACRE_KEY_VERSION,     NACRE_KEY_ETC1,   NACRE_KEY_ALBEDO, NACRE_KEY_TABLE,
                                 NACRE_KEY_LIGHT_POLAR, NACRE_KEY_COSINE, NACRE_KEY_SCALE,  NACRE_KEY_DISC};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) assert_int_equal(strlen(names[i]) % 4, 3);
}

/* The strict reader refuses what it should: a test of the test. Each row breaks the cube file (RGB8, 3 levels) once. */
static void reference_reader_is_strict(void **state)
{
    (void)state;
    bytes file = {0};
    ktx2_ref ref;
    char why[200];
    write_case(&asset_cases[6], &file);
    expect_valid(&ref, &file, "cube-rgb8");
    const size_t dfd = 80 + 24 * 3;
    const size_t kvd = dfd + 4 + 24 + 16 * 3;
    const struct {
        size_t offset;
        uint8_t value;
    } rows[] = {
        {0, 0},        {16, 2},
        {20, 5},       {36, 5},
        {40, 4},       {48, 1},
        {52, 1},       {56, 1},
        {64, 1},       {80, 1},
        {88, 1},       {96, 1},
        {dfd, 1},      {dfd + 12, 3},
        {dfd + 14, 9}, {dfd + 20, 4},
        {dfd + 28, 1}, {dfd + 30, 8},
        {dfd + 31, 1}, {dfd + 40, 254},
        {kvd, 200},    {kvd + 4, 'z'},
        {kvd + 4, 0},  {kvd + 19, 'l'},
        {kvd + 22, 1}, {ref.level_offset[2] - 1, 1},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const uint8_t kept = file.data[rows[i].offset];
        assert_int_not_equal(kept, rows[i].value);
        file.data[rows[i].offset] = rows[i].value;
        if (ktx2_ref_read(&ref, file.data, file.size, why, sizeof why))
            fail_msg("byte %zu = %u passed", rows[i].offset, rows[i].value);
        file.data[rows[i].offset] = kept;
    }
    for (size_t size = 0; size < file.size; size++) assert_false(ktx2_ref_read(&ref, file.data, size, why, sizeof why));
    bytes_free(&file);
}

/* The tree's build directory: this program is BUILD/CONFIG/tests/unit/test_ktx2. */
static void build_directory(char *out, size_t size)
{
    ssize_t n = readlink("/proc/self/exe", out, size - 1);
    assert_true(n > 0);
    out[n] = 0;
    for (int i = 0; i < 4 && strrchr(out, '/'); i++) *strrchr(out, '/') = 0;
}

/* npm's ktx-parse reads every file and writes the same bytes. It gets a copy: it reads past a Buffer's view. */
static void ktx_parse_writes_the_same_bytes(void **state)
{
    (void)state;
    static const char program[] =
        "import { read, write } from 'ktx-parse'; import { readFileSync, readdirSync } from 'fs';"
        "const dir = process.argv[2]; let bad = 0, count = 0;"
        "for (const name of readdirSync(dir)) { if (!name.endsWith('.ktx2')) continue;"
        "  const bytes = new Uint8Array(readFileSync(dir + '/' + name));"
        "  const image = read(bytes); const again = write(image, { keepWriter: true });"
        "  const same = Buffer.compare(Buffer.from(bytes), Buffer.from(again)) === 0; count++;"
        "  if (!same) { bad++; console.log(name + ': ktx-parse writes other bytes'); } }"
        "console.log(count + ' files through ktx-parse'); process.exit(bad || !count ? 1 : 0);";
    char build[4096], path[4200], command[12000];
    build_directory(build, sizeof build);
    const char *packages = getenv("NACRE_NPM");
    snprintf(path, sizeof path, "%s/npm", build);
    if (!packages) packages = path;
    snprintf(command, sizeof command, "command -v node >/dev/null && [ -d '%s/node_modules/ktx-parse' ]", packages);
    if (system(command)) {
        print_message("SKIPPED: no node, or no ktx-parse in %s/node_modules (make deps fetches it): the files were "
                      "checked by tests/support/ktx2_ref.c alone\n",
                      packages);
        skip();
    }
    /* node looks for the package from the script's directory upwards */
    snprintf(command, sizeof command, "%s/roundtrip-%ld.mjs", packages, (long)getpid());
    bytes text = {0};
    failure f = {0};
    bytes_append(&text, program, sizeof program - 1);
    if (output_write_raw(command, &text, &f)) fail_msg("%s", f.text);
    bytes_free(&text);
    char run[12100];
    snprintf(run, sizeof run, "node '%s' '%s'", command, asset_fixture_directory());
    const int status = system(run);
    unlink(command);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static int write_fixtures(const char *directory)
{
    for (int i = 0; i < asset_case_count; i++) {
        char path[1200];
        bytes file = {0};
        failure f = {0};
        snprintf(path, sizeof path, "%s/v1-%s.ktx2", directory, asset_cases[i].name);
        write_case(&asset_cases[i], &file);
        if (output_write_raw(path, &file, &f)) {
            fprintf(stderr, "%s\n", f.text);
            return f.code;
        }
        printf("%s: %zu bytes\n", path, file.size);
        bytes_free(&file);
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 3 && !strcmp(argv[1], "--write")) return write_fixtures(argv[2]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_case_arrives),
        cmocka_unit_test(frozen_files_are_written_again),
        cmocka_unit_test(keys_every_file_has),
        cmocka_unit_test(key_order_does_not_matter),
        cmocka_unit_test(q16_values),
        cmocka_unit_test(number_keys_are_aligned),
        cmocka_unit_test(reference_reader_is_strict),
        cmocka_unit_test(ktx_parse_writes_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
