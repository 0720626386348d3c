/* SPDX-License-Identifier: MIT */
/*
 * Small GPUs compute fragments in fp16. Every material, drawn so and in fp32 from the same file by the same driver:
 * at most 4 codes apart on 99.9 % of the covered pixels, frame by frame.
 * NACRE_LONG=1: all embedded parameter sets, not only the measured ones' SGD fits.
 */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cases.h"
#include "drivers.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { SIZE = 96, FRAME_BYTES = SIZE * SIZE * 4, FP32 = 0, FP16 = 4, MOST = 400 };

/* In the order drawn; the metric's exposure goes with each. */
static const frame_case views[] = {
    {.name = "30", .lights = 1, .polar_deg = 30},
    {.name = "75", .lights = 1, .polar_deg = 75},
    {.name = "120", .lights = 1, .polar_deg = 120},
    {.name = "4 lights", .lights = 4},
    {.name = "perspective", .lights = 1, .camera = CASE_PERSPECTIVE},
};
enum { VIEWS = sizeof views / sizeof *views };

/* Half width of the half vector's lobe under 0.4 degrees, highlight under 1: GGX at alpha = rough^2 = 0.01. */
static const char *const narrow[] = {"ggx:rough=.1,f0=.04", "ggx:rough=.1,f0=.9", "blinn-phong:kd=.1,ks=.05,n=30000"};

static char kept[] = "/tmp/nacre-fp16-XXXXXX";
static const char *material[MOST];
static int material_count;

static void list_materials(void)
{
    size_t count, i;
    const char *const *names = brdf_names(&count);

    for (i = 0; i < count && material_count < MOST - 3; i++)
        if (getenv("NACRE_LONG") || !strncmp(names[i], "sgd:", 4)) material[material_count++] = names[i];
    for (i = 0; i < sizeof narrow / sizeof *narrow; i++) material[material_count++] = narrow[i];
}

/* ---- a child: draw everything ------------------------------------------------------------------------------------ */

static void frames_path(char *path, size_t size, const char *directory, int driver_index)
{
    snprintf(path, size, "%s/frames-%d", directory, driver_index);
}

static int draw_material(scene_gles *g, const mesh *sphere, int index, const char *directory, bytes *frames)
{
    case_asset asset;
    failure f = {0};
    int i, code = 0;

    case_asset_open(&asset, CASE_TABLE, material[index], 0, directory);
    for (i = 0; i < VIEWS && !code; i++) {
        scene s;
        image_u8 frame;
        case_scene(&s, &views[i], sphere, SIZE, SIZE);
        s.exposure = brdf_exposure(asset.decoded);
        code = scene_gles_draw(g, &s, &asset.material, &frame, &f);
        if (code) {
            printf("%s: %s\n", material[index], f.text);
        } else {
            bytes_append(frames, frame.texel, FRAME_BYTES);
            image_u8_free(&frame);
        }
    }
    case_asset_close(&asset);
    return code;
}

static int draw_all(int driver_index, const char *directory)
{
    const driver *d = &drivers[driver_index];
    bytes frames = {0};
    gl_headless *gl;
    scene_gles *g;
    failure f = {0};
    char path[300];
    mesh sphere;
    int i, found, code = 0;

    list_materials();
    if (gl_headless_open(&gl, d->backend, 16, 16, &f)) {
        printf("SKIPPED: %s: %s\n", d->name, f.text);
        return DRIVER_SKIPPED;
    }
    found = driver_mediump_probe(gl);
    gl_headless_close(gl);
    if (found != (d->half ? 0 : 128)) {
        printf("SKIPPED: %s: mediump fract(4096.5) = %d / 255, expected %d: no half floats on this machine\n", d->name,
               found, d->half ? 0 : 128);
        return DRIVER_SKIPPED;
    }
    if (scene_gles_open(&g, d->backend, SIZE, SIZE, &f) || mesh_open(&sphere, "sphere", &f)) {
        printf("%s: %s\n", d->name, f.text);
        return 1;
    }
    for (i = 0; i < material_count && !code; i++) code = draw_material(g, &sphere, i, directory, &frames);
    frames_path(path, sizeof path, directory, driver_index);
    if (!code) code = output_write_raw(path, &frames, &f);
    bytes_free(&frames);
    mesh_free(&sphere);
    scene_gles_close(g);
    return code;
}

/* ---- the parent -------------------------------------------------------------------------------------------------- */

static image_u8 frame_of(const bytes *frames, int index)
{
    image_u8 view = {SIZE, SIZE, 4, frames->data + (size_t)index * FRAME_BYTES};

    return view;
}

static void half_floats_are_enough(void **state)
{
    const compare_bound bound = {-4, 4, 0.001, 0};
    bytes full = {0}, half = {0};
    char path[300];
    failure f = {0};
    int i, k, code, failed = 0;

    (void)state;
    for (k = 0; k < 2; k++) {
        int which = k ? FP16 : FP32;
        code = driver_run(which, kept);
        if (code == DRIVER_SKIPPED) skip();
        assert_int_equal(code, 0);
        frames_path(path, sizeof path, kept, which);
        assert_int_equal(file_read(k ? &half : &full, path, &f), 0);
    }
    assert_int_equal(full.size, (size_t)material_count * VIEWS * FRAME_BYTES);
    assert_int_equal(half.size, full.size);
    for (i = 0; i < material_count; i++)
        for (k = 0; k < VIEWS; k++) {
            image_u8 a = frame_of(&half, i * VIEWS + k), b = frame_of(&full, i * VIEWS + k);
            char name[200];
            snprintf(name, sizeof name, "fp16 %s, %s", material[i], views[k].name);
            failed += !compare_frames(name, &a, &b, 0, &bound, NULL);
        }
    bytes_free(&full);
    bytes_free(&half);
    assert_int_equal(failed, 0);
}

static int bake_all(void **state)
{
    int i;

    (void)state;
    if (!mkdtemp(kept)) return -1;
    list_materials();
#pragma omp parallel for schedule(dynamic)
    for (i = 0; i < material_count; i++) {
        case_asset asset;
        case_asset_open(&asset, CASE_TABLE, material[i], 0, kept);
        case_asset_close(&asset);
    }
    return 0;
}

static int remove_all(void **state)
{
    DIR *d = opendir(kept);
    struct dirent *e;

    (void)state;
    while (d && (e = readdir(d))) {
        char path[600];
        snprintf(path, sizeof path, "%s/%s", kept, e->d_name);
        if (e->d_name[0] != '.') unlink(path);
    }
    if (d) closedir(d);
    rmdir(kept);
    return 0;
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(half_floats_are_enough)};
    const char *directory;
    int index = driver_of_arguments(argc, argv, &directory);

    if (index >= 0) return draw_all(index, directory);
    return cmocka_run_group_tests(tests, bake_all, remove_all);
}
