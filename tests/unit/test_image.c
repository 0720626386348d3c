/* SPDX-License-Identifier: MIT */
/* The runtime's reader: what it says about good files, compared with the independent reader, and which result each kind
   of bad file gets. Truncations and changed bytes are in tests/fault/test_truncate.c. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset.h"
#include "asset_cases.h"
#include "ktx2_ref.h"
#include "workspace.h"

#include <cmocka.h> /* last: it makes fail a macro */

static void write_case(const asset_case *c, bytes *file)
{
    ktx2_image k;
    asset_case_make(c, &k);
    ktx2_write(&k, file);
    ktx2_free(&k);
}

static const asset_case *find_case(const char *name)
{
    for (int i = 0; i < asset_case_count; i++)
        if (!strcmp(asset_cases[i].name, name)) return &asset_cases[i];
    fail_msg("no case %s", name);
    return NULL;
}

static void expect_same_view(const nacre_image *image, const ktx2_ref *ref)
{
    assert_int_equal(image->width, ref->width);
    assert_int_equal(image->height, ref->height);
    assert_int_equal(image->layers, ref->layer_count ? ref->layer_count : 1);
    assert_int_equal(image->faces, ref->face_count);
    assert_int_equal(image->levels, ref->level_count);
    assert_int_equal(image->format, ref->vk_format);
    for (unsigned level = 0; level < image->levels; level++)
        for (unsigned layer = 0; layer < image->layers; layer++)
            for (unsigned face = 0; face < image->faces; face++) {
                uint32_t size = 0;
                size_t expected = 0;
                const uint8_t *texels = nacre_image_texels(image, level, layer, face, &size);
                assert_ptr_equal(texels, ktx2_ref_part(ref, level, layer, face, &expected));
                assert_int_equal(size, expected);
            }
    for (int i = 0; i < ref->key_count; i++) {
        uint32_t size = 0;
        assert_ptr_equal(nacre_image_key(image, ref->key[i].name, &size), ref->key[i].value);
        assert_int_equal(size, ref->key[i].size);
    }
}

/* At every alignment of the bytes, in a block that ends at a faulting page. */
static void frozen_files_open_at_any_alignment(void **state)
{
    (void)state;
    const char *const *paths;
    const int count = asset_fixtures(&paths);
    assert_true(count >= asset_case_count);
    for (int i = 0; i < count; i++) {
        bytes file = {0};
        failure f = {0};
        char why[200];
        if (file_read(&file, paths[i], &f)) fail_msg("%s", f.text);
        for (size_t shift = 0; shift < 8; shift++) {
            workspace w;
            ktx2_ref ref;
            nacre_image image;
            workspace_make(&w, file.size + shift, WORKSPACE_FAULT_AFTER);
            uint8_t *at = w.data; /* the block ends at a page, so its size decides where it begins */
            memcpy(at, file.data, file.size);
            workspace_protect(&w);
            assert_int_equal(nacre_image_open(&image, at, file.size), NACRE_OK);
            if (!ktx2_ref_read(&ref, at, file.size, why, sizeof why)) fail_msg("%s: %s", paths[i], why);
            expect_same_view(&image, &ref);
            workspace_free(&w);
        }
        bytes_free(&file);
    }
}

static void parts_that_are_not_there(void **state)
{
    (void)state;
    bytes file = {0};
    nacre_image image;
    write_case(find_case("spheres"), &file);
    assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_OK);
    uint32_t size = 77;
    assert_null(nacre_image_texels(&image, 4, 0, 0, &size));
    assert_null(nacre_image_texels(&image, 0, 4, 0, &size));
    assert_null(nacre_image_texels(&image, 0, 0, 1, &size));
    assert_null(nacre_image_texels(&image, UINT32_MAX, 0, 0, &size));
    assert_null(nacre_image_texels(NULL, 0, 0, 0, &size));
    assert_null(nacre_image_key(&image, "nacre.rol", &size));
    assert_null(nacre_image_key(&image, "nacre.role2", &size));
    assert_null(nacre_image_key(&image, "", &size));
    assert_null(nacre_image_key(&image, NULL, &size));
    assert_null(nacre_image_key(NULL, NACRE_KEY_ROLE, &size));
    assert_int_equal(size, 77);
    assert_non_null(nacre_image_texels(&image, 3, 3, 0, NULL));
    assert_non_null(nacre_image_key(&image, NACRE_KEY_ROLE, NULL));
    const nacre_image zero = {0};
    assert_null(nacre_image_texels(&zero, 0, 0, 0, NULL));
    assert_null(nacre_image_key(&zero, NACRE_KEY_ROLE, NULL));
    bytes_free(&file);
}

static void keys_as_numbers(void **state)
{
    (void)state;
    bytes file = {0};
    nacre_image image;
    write_case(find_case("spheres-rgb565"), &file);
    assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_OK);
    nacre_q16 scale[4] = {7, 7, 7, 7};
    uint32_t polar[4];
    assert_true(asset_key_q16(&image, NACRE_KEY_SCALE, scale, 3));
    assert_int_equal(scale[0], 2 * 65536);
    assert_int_equal(scale[1], 81920);
    assert_int_equal(scale[2], 32768);
    assert_int_equal(scale[3], 7);
    assert_true(asset_key_u32(&image, NACRE_KEY_LIGHT_POLAR, polar, 4));
    for (uint32_t i = 0; i < 4; i++) assert_int_equal(polar[i], i * 8192);
    assert_false(asset_key_q16(&image, NACRE_KEY_SCALE, scale, 4));
    assert_false(asset_key_q16(&image, NACRE_KEY_SCALE, scale, 2));
    assert_false(asset_key_u32(&image, NACRE_KEY_TABLE, polar, 1));
    assert_int_equal(scale[0], 2 * 65536);
    assert_true(asset_key_is(&image, NACRE_KEY_ROLE, "spheres"));
    assert_false(asset_key_is(&image, NACRE_KEY_ROLE, "sphere"));
    assert_false(asset_key_is(&image, NACRE_KEY_ROLE, "spheres2"));
    assert_false(asset_key_is(&image, NACRE_KEY_ROLE, ""));
    assert_false(asset_key_is(&image, NACRE_KEY_TABLE, "spheres"));
    bytes_free(&file);
    write_case(find_case("table"), &file);
    assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_OK);
    nacre_q16 table[9];
    assert_true(asset_key_q16(&image, NACRE_KEY_TABLE, table, 9));
    assert_int_equal(table[4], -32768); /* W.b = -0.5 */
    bytes_free(&file);
}

/* A text without its NUL, and an empty value. */
static void texts_without_their_end(void **state)
{
    (void)state;
    ktx2_image k = {.format = NACRE_FORMAT_R8, .width = 1, .height = 1, .faces = 1, .levels = 1};
    bytes file = {0};
    nacre_image image;
    bytes_append(&k.level[0], "x", 1);
    k.key_count = 3;
    strcpy(k.key[0].name, "open");
    bytes_append(&k.key[0].value, "abc", 3);
    strcpy(k.key[1].name, "void");
    strcpy(k.key[2].name, "more");
    bytes_append(&k.key[2].value, "abc\0d", 5);
    ktx2_write(&k, &file);
    assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_OK);
    uint32_t size = 7;
    assert_non_null(nacre_image_key(&image, "void", &size));
    assert_int_equal(size, 0);
    assert_non_null(nacre_image_key(&image, "open", &size));
    assert_int_equal(size, 3);
    assert_false(asset_key_is(&image, "open", "abc"));
    assert_false(asset_key_is(&image, "more", "abc"));
    assert_false(asset_key_is(&image, "void", ""));
    ktx2_free(&k);
    bytes_free(&file);
}

static void put_u32(bytes *file, size_t offset, uint32_t value)
{
    for (int i = 0; i < 4; i++) file->data[offset + (size_t)i] = (uint8_t)(value >> 8 * i);
}

/* One field of the header or of the index (offset in the file) set to a value, and the result it must give. */
static void fields_outside_the_profile(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t offset;
        uint32_t value;
        int result;
    } rows[] = {
        {"spheres", 0, 0x58544BAA, NACRE_ERR_ASSET}, /* identifier */
        {"spheres", 4, 0xBB313120, NACRE_ERR_ASSET}, /* KTX 11 */
        {"spheres", 8, 0x0A1A0A0A, NACRE_ERR_ASSET}, /* CR LF damaged in transfer */
        {"spheres", 12, 0, NACRE_ERR_UNSUPPORTED},   /* vkFormat undefined */
        {"spheres", 12, 43, NACRE_ERR_UNSUPPORTED},  /* RGBA8 sRGB */
        {"spheres", 12, 37 + 256, NACRE_ERR_UNSUPPORTED},
        {"spheres", 12, NACRE_FORMAT_RGB8, NACRE_ERR_ASSET}, /* another size of texel */
        {"spheres", 16, 4, NACRE_ERR_ASSET},                 /* typeSize */
        {"spheres", 20, 0, NACRE_ERR_UNSUPPORTED},           /* pixelWidth */
        {"spheres", 20, 4097, NACRE_ERR_UNSUPPORTED},
        {"spheres", 20, 0x80000008, NACRE_ERR_UNSUPPORTED},
        {"spheres", 20, 4096, NACRE_ERR_ASSET},
        {"spheres", 24, 0, NACRE_ERR_UNSUPPORTED}, /* pixelHeight: 1D textures */
        {"spheres", 24, 4097, NACRE_ERR_UNSUPPORTED},
        {"spheres", 28, 1, NACRE_ERR_UNSUPPORTED}, /* pixelDepth */
        {"spheres", 32, 65, NACRE_ERR_UNSUPPORTED},
        {"spheres", 32, 64, NACRE_ERR_ASSET},
        {"spheres", 32, 0, NACRE_ERR_ASSET},
        {"spheres", 36, 0, NACRE_ERR_ASSET},
        {"spheres", 36, 2, NACRE_ERR_ASSET},
        {"spheres", 36, 6, NACRE_ERR_ASSET},
        {"spheres", 40, 0, NACRE_ERR_UNSUPPORTED}, /* "make the mips yourself" */
        {"spheres", 40, 13, NACRE_ERR_UNSUPPORTED},
        {"spheres", 40, 5, NACRE_ERR_ASSET}, /* 8 texels have 4 levels */
        {"spheres", 40, 3, NACRE_ERR_ASSET},
        {"spheres", 44, 2, NACRE_ERR_UNSUPPORTED}, /* Zstandard */
        {"spheres", 48, 0, NACRE_ERR_ASSET},
        {"spheres", 52, 0, NACRE_ERR_ASSET},
        {"spheres", 52, 0xFFFFFFF0, NACRE_ERR_ASSET},
        {"spheres", 56, 0, NACRE_ERR_ASSET},
        {"spheres", 60, 0, NACRE_ERR_ASSET},
        {"spheres", 60, 0xFFFFFFF0, NACRE_ERR_ASSET},
        {"spheres", 64, 8, NACRE_ERR_ASSET}, /* supercompression data */
        {"spheres", 68, 8, NACRE_ERR_ASSET},
        {"spheres", 72, 8, NACRE_ERR_ASSET},
        {"spheres", 76, 8, NACRE_ERR_ASSET},
        {"spheres", 80, 0, NACRE_ERR_ASSET}, /* level 0: offset, upper words, lengths */
        {"spheres", 80, 0xFFFFFFFC, NACRE_ERR_ASSET},
        {"spheres", 84, 1, NACRE_ERR_ASSET},
        {"spheres", 88, 4, NACRE_ERR_ASSET},
        {"spheres", 92, 1, NACRE_ERR_ASSET},
        {"spheres", 96, 4, NACRE_ERR_ASSET},
        {"spheres", 100, 1, NACRE_ERR_ASSET},
        {"cube-rgb8", 20, 5, NACRE_ERR_ASSET}, /* not square */
        {"cube-rgb8", 36, 1, NACRE_ERR_ASSET},
        {"normal", 152, 0, NACRE_ERR_ASSET}, /* the descriptor's own size, at 80 + 3 x 24 */
        {"normal", 156, 9, NACRE_OK},        /* its inside is for other readers */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        bytes file = {0};
        write_case(find_case(rows[i].name), &file);
        put_u32(&file, rows[i].offset, rows[i].value);
        nacre_image image, kept;
        memset(&image, 0x3C, sizeof image);
        kept = image;
        const nacre_result result = nacre_image_open(&image, file.data, file.size);
        if ((int)result != rows[i].result)
            fail_msg("%s: %u at offset %zu: %d, expected %d", rows[i].name, rows[i].value, rows[i].offset, result,
                     rows[i].result);
        if (result) assert_memory_equal(&image, &kept, sizeof image);
        bytes_free(&file);
    }
}

static void arguments(void **state)
{
    (void)state;
    bytes file = {0};
    nacre_image image;
    write_case(find_case("grey"), &file);
    assert_int_equal(nacre_image_open(NULL, file.data, file.size), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_image_open(&image, NULL, file.size), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_image_open(&image, file.data, 0), NACRE_ERR_ASSET);
    if (sizeof(size_t) > 4) /* refused by its size: nothing behind the file is read */
        assert_int_equal(nacre_image_open(&image, file.data, (size_t)NACRE_MAX_FILE_BYTES + 1), NACRE_ERR_UNSUPPORTED);
    bytes_free(&file);
}

static void a_byte_behind_the_last_level(void **state)
{
    (void)state;
    bytes file = {0};
    nacre_image image;
    write_case(find_case("table"), &file);
    bytes_append(&file, "", 1);
    assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_ERR_ASSET);
    bytes_free(&file);
}

/* Key/value entries that a reader could run away with; the region of "grey" is at 148 and 80 bytes long. */
static void broken_keys(void **state)
{
    (void)state;
    static const struct {
        size_t offset; /* from the region */
        uint32_t value;
        int result;
    } rows[] = {
        {0, 0, NACRE_ERR_ASSET},          {0, 1, NACRE_ERR_ASSET},          {0, 77, NACRE_ERR_ASSET},
        {0, 0xFFFFFFFF, NACRE_ERR_ASSET}, {0, 0xFFFFFFFD, NACRE_ERR_ASSET}, {4, 0, NACRE_ERR_ASSET}, /* no name */
        {76, 2, NACRE_ERR_UNSUPPORTED}, /* nacre.asset_version 2 */
        {52, 23, NACRE_ERR_ASSET},      /* ... of 3 bytes */
        {52, 20, NACRE_ERR_ASSET},      /* ... of none */
        {52, 19, NACRE_ERR_ASSET},      /* name without NUL */
        {52, 25, NACRE_ERR_ASSET},      /* beyond the region */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        bytes file = {0};
        nacre_image image;
        write_case(find_case("grey"), &file);
        assert_int_equal(file.size, 229);
        put_u32(&file, 148 + rows[i].offset, rows[i].value);
        const nacre_result result = nacre_image_open(&image, file.data, file.size);
        if ((int)result != rows[i].result)
            fail_msg("%u at %zu: %d, expected %d", rows[i].value, rows[i].offset, result, rows[i].result);
        bytes_free(&file);
    }
}

static nacre_result open_grey_with(const void *patch, size_t at, size_t size)
{
    bytes file = {0};
    nacre_image image;
    write_case(find_case("grey"), &file);
    memcpy(file.data + at, patch, size);
    const nacre_result result = nacre_image_open(&image, file.data, file.size);
    bytes_free(&file);
    return result;
}

/* Lengths that wrap to 0 when padded, before an entry that fills the rest; and a last name that never ends. */
static void keys_that_look_well(void **state)
{
    (void)state;
    static const uint8_t wraps[] = {0xFD, 0xFF, 0xFF, 0xFF, 72, 0, 0, 0}, fits[] = {72 + 4, 0, 0, 0, 72, 0, 0, 0};
    static const char endless[] = "an endless name with it.";
    assert_int_equal(open_grey_with(fits, 148, sizeof fits), NACRE_OK);
    assert_int_equal(open_grey_with(wraps, 148, sizeof wraps), NACRE_ERR_ASSET);
    assert_int_equal(open_grey_with(endless, 148 + 56, 24), NACRE_ERR_ASSET);
}

/* Files that are consistent but for one thing the profile forbids. */
static void consistent_but_wrong(void **state)
{
    (void)state;
    static const struct {
        int width, height, faces, levels;
        int result;
    } rows[] = {
        {2, 2, 6, 2, NACRE_OK},        {2, 1, 6, 1, NACRE_ERR_ASSET}, /* faces that are not square */
        {1, 1, 1, 2, NACRE_ERR_ASSET}, {4, 2, 1, 4, NACRE_ERR_ASSET}, /* more levels than halvings */
        {4, 2, 1, 3, NACRE_OK},        {1, 9, 1, 4, NACRE_OK},
        {1, 9, 1, 5, NACRE_ERR_ASSET}, {1, 1, 2, 1, NACRE_ERR_ASSET},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        ktx2_image k = {.format = NACRE_FORMAT_R8,
                        .width = rows[i].width,
                        .height = rows[i].height,
                        .faces = rows[i].faces,
                        .levels = rows[i].levels};
        bytes file = {0};
        nacre_image image;
        for (int level = 0; level < k.levels; level++) {
            const int w = k.width >> level, h = k.height >> level;
            for (int n = (w ? w : 1) * (h ? h : 1) * k.faces; n > 0; n--) bytes_append(&k.level[level], "", 1);
        }
        ktx2_write(&k, &file);
        const nacre_result result = nacre_image_open(&image, file.data, file.size);
        if ((int)result != rows[i].result)
            fail_msg("%d x %d, %d faces, %d levels: %d, expected %d", k.width, k.height, k.faces, k.levels, result,
                     rows[i].result);
        ktx2_free(&k);
        bytes_free(&file);
    }
}

/* A descriptor of each size in a file of one level without keys; only multiples of 4 from 4 on can be one. */
static void sizes_of_the_descriptor(void **state)
{
    (void)state;
    for (uint32_t size = 0; size <= 60; size++) {
        bytes file = {0};
        nacre_image image;
        write_case(find_case("grey"), &file);
        bytes bare = {0};
        bytes_append(&bare, file.data, 104);
        while (bare.size < 104 + 64) bytes_append(&bare, "", 1);
        const uint32_t level = (104 + size + 3) / 4 * 4;
        put_u32(&bare, 20, 64 + 104 - level); /* one row of as many texels as are left */
        put_u32(&bare, 88, 64 + 104 - level);
        put_u32(&bare, 96, 64 + 104 - level);
        put_u32(&bare, 52, size);
        put_u32(&bare, 56, 0);
        put_u32(&bare, 60, 0);
        put_u32(&bare, 80, level);
        put_u32(&bare, 104, size);
        assert_int_equal(nacre_image_open(&image, bare.data, bare.size),
                         size >= 4 && size % 4 == 0 ? NACRE_OK : NACRE_ERR_ASSET);
        bytes_free(&file);
        bytes_free(&bare);
    }
}

/* KTX2 files of others have other keys, or none: kvdByteOffset is 0 then. */
static void a_file_without_keys(void **state)
{
    (void)state;
    bytes file = {0}, bare = {0};
    nacre_image image;
    ktx2_ref ref;
    char why[200];
    write_case(find_case("grey"), &file);
    bytes_append(&bare, file.data, 148);
    bytes_append(&bare, file.data + 228, 1);
    put_u32(&bare, 56, 0);
    put_u32(&bare, 60, 0);
    put_u32(&bare, 80, 148);
    if (!ktx2_ref_read(&ref, bare.data, bare.size, why, sizeof why)) fail_msg("%s", why);
    assert_int_equal(nacre_image_open(&image, bare.data, bare.size), NACRE_OK);
    assert_null(nacre_image_key(&image, NACRE_KEY_VERSION, NULL));
    expect_same_view(&image, &ref);
    bytes_free(&file);
    bytes_free(&bare);
}

/* The product of the largest sides, layers, faces and texels is 2^35 and more: it must not wrap into a small file. */
static void sizes_beyond_32_bits(void **state)
{
    (void)state;
    static const struct {
        uint32_t format, type, side, layers, faces, length;
    } rows[] = {
        {NACRE_FORMAT_RGBA16F, 2, 4096, 32, 1, 0},       /* 2^32 bytes = 0 */
        {NACRE_FORMAT_RGBA8, 1, 4096, 64, 1, 0},         /* 2^32 */
        {NACRE_FORMAT_RGBA16F, 2, 4096, 64, 6, 0},       /* 6 x 2^33 */
        {NACRE_FORMAT_RGB8, 1, 4096, 15, 6, 0x0E000000}, /* 90 x 3 x 2^24 = 2^32 + 0x0E000000 */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        bytes file = {0};
        nacre_image image;
        write_case(find_case("grey"), &file);
        put_u32(&file, 12, rows[i].format);
        put_u32(&file, 16, rows[i].type);
        put_u32(&file, 20, rows[i].side);
        put_u32(&file, 24, rows[i].side);
        put_u32(&file, 32, rows[i].layers);
        put_u32(&file, 36, rows[i].faces);
        put_u32(&file, 88, rows[i].length);
        put_u32(&file, 96, rows[i].length);
        put_u32(&file, 80, rows[i].format == NACRE_FORMAT_RGBA16F ? 232 : 228);
        for (size_t size = 228; size <= 232; size++)
            assert_int_equal(nacre_image_open(&image, file.data, size < file.size ? size : file.size), NACRE_ERR_ASSET);
        bytes_free(&file);
    }
}

static void texts_and_version(void **state)
{
    (void)state;
    for (int i = -8; i < 2; i++) assert_true(strlen(nacre_result_text((nacre_result)i)) > 3);
    assert_string_not_equal(nacre_result_text(NACRE_ERR_ASSET), nacre_result_text(NACRE_ERR_UNSUPPORTED));
    assert_int_equal(nacre_version(), NACRE_VERSION);
}

/* 76 bytes with 32-bit pointers; with 64-bit ones 4 more for the pointer, and 80 in all. */
static void size_of_the_view(void **state)
{
    (void)state;
    assert_int_equal(sizeof(nacre_image), sizeof(void *) == 4 ? 76 : 80);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frozen_files_open_at_any_alignment),
        cmocka_unit_test(parts_that_are_not_there),
        cmocka_unit_test(keys_as_numbers),
        cmocka_unit_test(texts_without_their_end),
        cmocka_unit_test(fields_outside_the_profile),
        cmocka_unit_test(arguments),
        cmocka_unit_test(a_byte_behind_the_last_level),
        cmocka_unit_test(broken_keys),
        cmocka_unit_test(keys_that_look_well),
        cmocka_unit_test(consistent_but_wrong),
        cmocka_unit_test(sizes_of_the_descriptor),
        cmocka_unit_test(a_file_without_keys),
        cmocka_unit_test(sizes_beyond_32_bits),
        cmocka_unit_test(texts_and_version),
        cmocka_unit_test(size_of_the_view),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
