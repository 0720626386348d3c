/* SPDX-License-Identifier: MIT */
/* Texture memory and context blocks against fixtures/budget/memory.csv; growth fails with both figures printed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "fake_gl.h"
#include "gles_kit.h"
#include "nacre_asset.h"
#include "nacre_gles.h"
#include "sbrdf_map.h"

#include <cmocka.h> /* last: it makes a macro of fail */

#define BUDGET "fixtures/budget/memory.csv"

static long budget_of(const char *what)
{
    FILE *file = fopen(BUDGET, "r");
    char line[300], name[64];
    long budget = -1, found;

    if (!file) fail_msg(BUDGET ": can't read; run from the top of the tree");
    while (budget < 0 && fgets(line, sizeof line, file))
        if (sscanf(line, "%63[^,],%ld", name, &found) == 2 && !strcmp(name, what)) budget = found;
    fclose(file);
    if (budget < 0) fail_msg("%s: no row in " BUDGET, what);
    return budget;
}

static void hold(const char *what, const char *where, size_t used)
{
    const long budget = budget_of(what);

    print_message("%-14s %-6s %8zu of %8ld bytes\n", what, where, used, budget);
    if ((long)used > budget) fail_msg("%s on %s: %zu bytes, budget %ld", what, where, used, budget);
}

/* Every model's default bake, added on one real driver through the recorder: GL must have got what nacre says. */
static void count_textures(gl_backend backend, const char *where)
{
    static const struct {
        case_model model;
        const char *what;
    } rows[] = {{CASE_TABLE, "table"},     {CASE_TABLE_P4, "table-p4"},         {CASE_TABLE_RGB, "table-rgb"},
                {CASE_FINE, "fine"},       {CASE_SPHERES, "spheres"},           {CASE_PAPER, "paper"},
                {CASE_QUARTER, "quarter"}, {CASE_QUARTER_ETC1, "quarter-etc1"}, {CASE_PALETTE, "palette-256"}};
    gl_headless *gl;
    kit k;
    size_t i;

    if (!kit_context(&gl, backend, 16, 16)) {
        print_message("SKIPPED: %s: no such context on this machine\n", where);
        skip();
    }
    kit_open(&k);
    for (i = 0; i < sizeof rows / sizeof *rows; i++) {
        case_asset asset;
        kit_world w;
        nacre_gles_item item;

        case_asset_open(&asset, rows[i].model, "sgd:gold-metallic-paint", 0, NULL);
        fake_gl_start(&(fake_gl_options){.real = gl_headless_proc});
        kit_world_make(&w, NULL);
        assert_int_equal(kit_world_init(&w), NACRE_OK);
        assert_int_equal(nacre_gles_add(w.gles, &k.ball, &asset.material, &item), NACRE_OK);
        assert_int_equal(nacre_gles_texture_bytes(w.gles), fake_gl_texture_bytes());
        hold(rows[i].what, where, fake_gl_texture_bytes());
        nacre_gles_shutdown(w.gles);
        assert_int_equal(fake_gl_texture_bytes(), 0);
        assert_true(kit_world_free(&w));
        case_asset_close(&asset);
    }
    kit_close(&k);
    gl_headless_close(gl);
}

/* Maps of 256 x 256 with all their levels: 4 bytes x 4/3 a texel of the diffuse albedo and of two layers a lobe. */
static void count_maps(gl_backend backend, const char *where)
{
    static const char *const what[] = {"sbrdf-1-lobe", "sbrdf-2-lobes", "sbrdf-3-lobes"};
    gl_headless *gl;
    kit k;

    if (!kit_context(&gl, backend, 16, 16)) {
        print_message("SKIPPED: %s: no such context on this machine\n", where);
        skip();
    }
    kit_open(&k);
    for (int lobes = 1; lobes <= NACRE_MAX_LOBES; lobes++) {
        bytes file[2] = {{0}};
        nacre_image image[2];
        nacre_material material = {.model = NACRE_MODEL_SBRDF};
        sbrdf_map map;
        kit_world w;
        nacre_gles_item item;

        sbrdf_map_make(&map, 256, 256, lobes, 0, 0);
        sbrdf_map_write(&map, &file[0], &file[1]);
        sbrdf_map_free(&map);
        for (int i = 0; i < 2; i++) assert_int_equal(nacre_image_open(&image[i], file[i].data, file[i].size), NACRE_OK);
        material.image[NACRE_ROLE_ALBEDO] = &image[0];
        material.image[NACRE_ROLE_LOBES] = &image[1];
        fake_gl_start(&(fake_gl_options){.real = gl_headless_proc});
        kit_world_make(&w, NULL);
        assert_int_equal(kit_world_init(&w), NACRE_OK);
        assert_int_equal(nacre_gles_add(w.gles, &k.ball, &material, &item), NACRE_OK);
        assert_int_equal(nacre_gles_texture_bytes(w.gles), fake_gl_texture_bytes());
        hold(what[lobes - 1], where, fake_gl_texture_bytes());
        nacre_gles_shutdown(w.gles);
        assert_int_equal(fake_gl_texture_bytes(), 0);
        assert_true(kit_world_free(&w));
        for (int i = 0; i < 2; i++) bytes_free(&file[i]);
    }
    kit_close(&k);
    gl_headless_close(gl);
}

static void maps_on_egl2(void **state)
{
    (void)state;
    count_maps(GL_BACKEND_EGL2, "egl2");
}

static void maps_on_egl3(void **state)
{
    (void)state;
    count_maps(GL_BACKEND_EGL3, "egl3");
}

static void textures_on_egl2(void **state)
{
    (void)state;
    count_textures(GL_BACKEND_EGL2, "egl2");
}

static void textures_on_egl3(void **state)
{
    (void)state;
    count_textures(GL_BACKEND_EGL3, "egl3");
}

static void textures_on_osmesa(void **state)
{
    (void)state;
    count_textures(GL_BACKEND_OSMESA, "osmesa");
}

static void blocks(void **state)
{
    const nacre_gles_desc usual = {.get_proc = fake_gl_proc};
    const nacre_gles_desc small = {.get_proc = fake_gl_proc, .max_items = 1, .max_programs = 1, .max_textures = 1};

    (void)state;
    if (sizeof(void *) != 8) skip();
    hold("block-default", "-", nacre_gles_size(&usual));
    hold("block-smallest", "-", nacre_gles_size(&small));
    hold("image", "-", sizeof(nacre_image));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(textures_on_egl2), cmocka_unit_test(textures_on_egl3), cmocka_unit_test(textures_on_osmesa),
        cmocka_unit_test(maps_on_egl2),     cmocka_unit_test(maps_on_egl3),     cmocka_unit_test(blocks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
