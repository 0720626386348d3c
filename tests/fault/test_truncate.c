/* SPDX-License-Identifier: MIT */
/* Every truncation and every single-byte change of every file in fixtures/asset: each is refused with the view left
   alone, or gives a view all of whose texels and keys can be read. The bytes lie between guards (workspace.h), so that
   one byte read too far faults. */
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

static const char *const key_names[] = {
    "KTXorientation",
    "KTXwriter",
    NACRE_KEY_VERSION,
    NACRE_KEY_ROLE,
    NACRE_KEY_TRANSFER,
    NACRE_KEY_NAME,
    NACRE_KEY_ETC1,
    NACRE_KEY_ALBEDO,
    NACRE_KEY_TABLE,
    NACRE_KEY_LIGHT_POLAR,
    NACRE_KEY_COSINE,
    NACRE_KEY_SCALE,
    NACRE_KEY_DISC,
    "",
    "no such key, longer than any that a file here has",
};

/* Files of up to DATA_POSITIONS bytes have every byte of their texels changed too, larger ones a sample. The sanitizers,
   which are slow, see a sample of all, and read every 16th byte and the last: the guards find the rest. */
#ifdef __SANITIZE_ADDRESS__
enum { DATA_POSITIONS = 256, READ_STEP = 16 };
#else
enum { DATA_POSITIONS = 16384, READ_STEP = 1 };
#endif

static volatile uint32_t sink; /* keeps the reads */

static void read_all(const nacre_image *image, const uint8_t *part, uint32_t size)
{
    uint32_t sum = 0;
    assert_true(part >= image->bytes && size <= image->size && part - image->bytes <= image->size - size);
    for (uint32_t i = 0; i < size; i += READ_STEP) sum += part[i];
    sink = sink + sum + (size ? part[size - 1] : 0);
}

/* Read all of a view: parts must lie inside the file and must not overlap. */
static void walk(const nacre_image *image)
{
    uint64_t total = 0;
    for (unsigned level = 0; level < image->levels; level++)
        for (unsigned layer = 0; layer < image->layers; layer++)
            for (unsigned face = 0; face < image->faces; face++) {
                uint32_t size = 0;
                const uint8_t *texels = nacre_image_texels(image, level, layer, face, &size);
                assert_non_null(texels);
                assert_true(size > 0);
                read_all(image, texels, size);
                total += size;
            }
    assert_true(total + 80 + 24u * image->levels + image->kv_size <= image->size);
    for (size_t i = 0; i < sizeof key_names / sizeof key_names[0]; i++) {
        uint32_t size = 0;
        const uint8_t *value = nacre_image_key(image, key_names[i], &size);
        if (value) read_all(image, value, size);
    }
}

static nacre_result open_and_walk(const uint8_t *data, size_t size)
{
    nacre_image image, kept;
    memset(&image, 0x3C, sizeof image);
    kept = image;
    const nacre_result result = nacre_image_open(&image, data, size);
    if (result) {
        assert_true(result == NACRE_ERR_ASSET || result == NACRE_ERR_UNSUPPORTED);
        assert_memory_equal(&image, &kept, sizeof image);
    } else {
        walk(&image);
    }
    return result;
}

static void load(bytes *file, const char *path)
{
    failure f = {0};
    if (file_read(file, path, &f)) fail_msg("%s", f.text);
}

static void every_truncation(void **state)
{
    (void)state;
    const char *const *paths;
    const int count = asset_fixtures(&paths);
    long refused = 0;
    assert_true(count > 0);
    for (int i = 0; i < count; i++) {
        bytes file = {0};
        load(&file, paths[i]);
        assert_int_equal(open_and_walk(file.data, file.size), NACRE_OK);
        /* one block that ends at a faulting page; each length is laid against it */
        workspace w;
        workspace_make(&w, file.size, WORKSPACE_FAULT_AFTER);
        const size_t step = file.size > 65536 ? file.size / 8192 : 1;
        for (size_t size = 0; size < file.size; size += size < 4096 || file.size - size < 4096 ? 1 : step) {
            uint8_t *at = w.data + w.size - size;
            memcpy(at, file.data, size);
            if (open_and_walk(at, size) != NACRE_ERR_ASSET) fail_msg("%s: opens when cut to %zu bytes", paths[i], size);
            refused++;
        }
        assert_true(workspace_intact(&w));
        workspace_free(&w);
        bytes_free(&file);
    }
    print_message("%ld truncations of %d files refused\n", refused, count);
}

/* Where the level data begin. */
static size_t meta_size(const nacre_image *image)
{
    return image->level_offset[image->levels - 1];
}

/* The strict independent reader and ours must agree. What it accepts, ours reads the same way, unless it lies outside the
   profile or its nacre.asset_version is no number; what ours accepts, it accepts too if only header, level index or
   the descriptor's size have changed (the rest of the descriptor, and padding, ours does not look at). */
static void compare_with_reference(const uint8_t *data, size_t size, nacre_result result, int header_changed)
{
    ktx2_ref ref;
    nacre_image image;
    char why[200] = "";
    size_t version_size = 4;
    if (!ktx2_ref_read(&ref, data, size, why, sizeof why)) {
        if (!result && header_changed) fail_msg("opens, though: %s", why);
        return;
    }
    ktx2_ref_key(&ref, NACRE_KEY_VERSION, &version_size);
    if (result == NACRE_ERR_UNSUPPORTED || (result == NACRE_ERR_ASSET && version_size != 4)) return;
    assert_int_equal(result, NACRE_OK);
    assert_int_equal(nacre_image_open(&image, data, size), NACRE_OK);
    assert_int_equal(image.width, ref.width);
    assert_int_equal(image.height, ref.height);
    assert_int_equal(image.layers, ref.layer_count ? ref.layer_count : 1);
    assert_int_equal(image.faces, ref.face_count);
    assert_int_equal(image.levels, ref.level_count);
    for (unsigned i = 0; i < image.levels; i++) assert_int_equal(image.level_offset[i], ref.level_offset[i]);
}

typedef struct change_count {
    long refused, accepted;
} change_count;

static void change_bytes(const char *path, workspace_edge edge, change_count *n)
{
    bytes file = {0};
    nacre_image image;
    workspace w;
    load(&file, path);
    workspace_make(&w, file.size, edge);
    memcpy(w.data, file.data, file.size);
    assert_int_equal(nacre_image_open(&image, w.data, w.size), NACRE_OK);
    const size_t meta = meta_size(&image);
    for (size_t at = 0; at < file.size; at += at < meta ? 1 : 1 + file.size / DATA_POSITIONS) {
        const uint8_t kept = w.data[at];
        for (unsigned change = 1; change < 256; change++) {
            w.data[at] = (uint8_t)(kept ^ change);
            if (at >= meta) { /* texels mean nothing to the reader: any change opens */
                assert_int_equal(nacre_image_open(&image, w.data, w.size), NACRE_OK);
                n->accepted++;
                continue;
            }
            const nacre_result result = open_and_walk(w.data, w.size);
            compare_with_reference(w.data, w.size, result, at < 80 + 24u * image.levels + 4);
            result ? n->refused++ : n->accepted++;
        }
        w.data[at] = kept;
    }
    assert_true(workspace_intact(&w));
    workspace_free(&w);
    bytes_free(&file);
}

static void every_changed_byte(void **state)
{
    (void)state;
    const char *const *paths;
    const int count = asset_fixtures(&paths);
    change_count n = {0, 0};
    assert_true(count > 0);
    for (int i = 0; i < count; i++) change_bytes(paths[i], WORKSPACE_FAULT_AFTER, &n);
    print_message("%ld changed bytes refused, %ld read in full\n", n.refused, n.accepted);
}

/* The same from the other side: reads before the file fault. Lengths that wrap would go there. */
static void every_changed_byte_from_below(void **state)
{
    (void)state;
    change_count n = {0, 0};
    char path[1200];
    snprintf(path, sizeof path, "%s/v1-spheres-etc1.ktx2", asset_fixture_directory());
    change_bytes(path, WORKSPACE_FAULT_BEFORE, &n);
    assert_true(n.refused > 0 && n.accepted > 0);
}

/* Words of the header and the index replaced by awkward numbers, two at a time. */
static void awkward_words_in_pairs(void **state)
{
    (void)state;
    static const uint32_t words[] = {0, 1, 3, 6, 64, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFC, 0xFFFFFFFF};
    enum { WORDS = sizeof words / sizeof words[0] };
    bytes file = {0};
    workspace w;
    char path[1200];
    long accepted = 0;
    snprintf(path, sizeof path, "%s/v1-cube-rgb8.ktx2", asset_fixture_directory());
    load(&file, path);
    workspace_make(&w, file.size, WORKSPACE_FAULT_AFTER);
    const size_t fields = (80 + 3 * 24) / 4;
    for (size_t a = 3; a < fields; a++)
        for (size_t b = a + 1; b < fields; b++)
            for (unsigned i = 0; i < WORDS * WORDS; i++) {
                memcpy(w.data, file.data, file.size);
                memcpy(w.data + 4 * a, &words[i / WORDS], 4);
                memcpy(w.data + 4 * b, &words[i % WORDS], 4);
                accepted += open_and_walk(w.data, w.size) == NACRE_OK;
            }
    assert_true(workspace_intact(&w));
    workspace_free(&w);
    bytes_free(&file);
    print_message("%ld pairs left the file as it was\n", accepted);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_truncation),
        cmocka_unit_test(every_changed_byte),
        cmocka_unit_test(every_changed_byte_from_below),
        cmocka_unit_test(awkward_words_in_pairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
