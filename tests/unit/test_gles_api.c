/* SPDX-License-Identifier: MIT */
/* The GLES object without a GPU: results, budgets, handles, GL state, on the GL of tests/support/fake_gl. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "brdf_kit.h"
#include "gles_kit.h"
#include "nacre_asset.h"

#include <cmocka.h>

static kit assets;

typedef kit_world world;

static world *open_world(world *w, const fake_gl_options *options, const nacre_gles_desc *desc)
{
    const fake_gl_options es2 = {0};
    fake_gl_start(options ? options : &es2);
    kit_world_make(w, desc);
    assert_int_equal(kit_world_init(w), NACRE_OK);
    return w;
}

/* Shut down: every object is deleted, no GL error is left, the block's surroundings are untouched. */
static void close_world(world *w)
{
    nacre_gles_shutdown(w->gles);
    assert_int_equal(fake_gl_live(), 0);
    assert_int_equal(fake_gl_texture_bytes(), 0);
    assert_int_equal(fake_gl_pending_error(), 0);
    assert_true(kit_world_free(w));
}

static nacre_gles_item add(world *w, kit_model model, int normal)
{
    const nacre_material m = kit_material(&assets, model, normal);
    nacre_gles_item item = {0};
    assert_int_equal(nacre_gles_add(w->gles, &assets.ball, &m, &item), NACRE_OK);
    assert_int_not_equal(item.id, 0);
    return item;
}

/* ---- init ------------------------------------------------------------------------------------ */

static void init_refuses_bad_arguments(void **state)
{
    (void)state;
    static uint64_t block[4000];
    const nacre_gles_desc none = {0}, ok = {.get_proc = fake_gl_proc};
    const fake_gl_options es2 = {0};
    nacre_gles *gles = NULL;
    fake_gl_start(&es2);
    assert_int_equal(nacre_gles_size(NULL), 0);
    assert_int_equal(nacre_gles_size(&none), 0);
    assert_int_equal(nacre_gles_size(&ok) % 4, 0);
    assert_in_range(nacre_gles_size(&ok), 1000, sizeof block);
    assert_int_equal(nacre_gles_init(NULL, block, sizeof block, &ok), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_init(&gles, NULL, sizeof block, &ok), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_init(&gles, (char *)block + 1, sizeof block - 1, &ok), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_init(&gles, block, sizeof block, NULL), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_init(&gles, block, sizeof block, &none), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_init(&gles, block, nacre_gles_size(&ok) - 4, &ok), NACRE_ERR_MEMORY);
    assert_null(gles);
    assert_int_equal(fake_gl_calls(), 0);
}

static void init_needs_every_entry_point(void **state)
{
    (void)state;
    static const char *const names[] = {"glGetError", "glTexImage2D", "glDrawElements", "glGetVertexAttribPointerv"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const fake_gl_options o = {.missing = names[i]};
        world w;
        fake_gl_start(&o);
        kit_world_make(&w, NULL);
        assert_int_equal(kit_world_init(&w), NACRE_ERR_UNSUPPORTED);
        assert_null(w.gles);
        assert_non_null(strstr(w.log, names[i]));
        assert_int_equal(fake_gl_live(), 0);
        workspace_free(&w.block);
    }
}

static void init_reads_versions(void **state)
{
    (void)state;
    static const struct {
        const char *version, *extensions;
        nacre_result result;
    } cases[] = {
        {"OpenGL ES 2.0 Mesa", "", NACRE_OK},
        {"OpenGL ES 3.2", "", NACRE_OK},
        {"OpenGL ES-CM 1.1", "", NACRE_ERR_UNSUPPORTED},
        {"OpenGL ES 1.1", "", NACRE_ERR_UNSUPPORTED},
        {"2.1 Mesa", "GL_ARB_multitexture", NACRE_ERR_UNSUPPORTED},
        {"2.1 Mesa", "GL_ARB_ES2_compatibility_not", NACRE_ERR_UNSUPPORTED},
        {"2.1 Mesa", "GL_ARB_x GL_ARB_ES2_compatibility GL_ARB_y", NACRE_OK},
        {"4.5 (Compatibility Profile) Mesa 22.3.6", "", NACRE_OK},
        {"", "", NACRE_ERR_UNSUPPORTED},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const fake_gl_options o = {.es = 3, .version = cases[i].version, .extensions = cases[i].extensions};
        world w;
        fake_gl_start(&o);
        kit_world_make(&w, NULL);
        assert_int_equal(kit_world_init(&w), cases[i].result);
        nacre_gles_shutdown(w.gles);
        assert_int_equal(fake_gl_live(), 0);
        workspace_free(&w.block);
    }
}

static int stub_calls;

static int stub(void)
{
    return ++stub_calls;
}

/* A loader as EGL allows: it has an answer for every name, and only those of the version and of the context's extensions
   do something. */
static void *generous_proc(void *user, const char *name)
{
    static const char *const beyond_es2[] = {
        "glGetStringi",      "glGenVertexArrays", "glDeleteVertexArrays",
        "glBindVertexArray", "glBindSampler",     "glGetGraphicsResetStatus",
    };
    void *p = fake_gl_proc(user, name);
    for (size_t i = 0; i < sizeof beyond_es2 / sizeof *beyond_es2; i++)
        if (!strcmp(name, beyond_es2[i])) p = NULL;
    return p ? p : (void *)(uintptr_t)stub;
}

static void pointers_prove_nothing(void **state)
{
    (void)state;
    for (int extension = 0; extension < 2; extension++) {
        const fake_gl_options o = {.es = 3,
                                   .version = "OpenGL ES 2.0",
                                   .extensions = extension ? "GL_OES_vertex_array_object" : "GL_OES_texture_float"};
        const nacre_view view = kit_view(1, 0, 0);
        world w;
        fake_gl_start(&o);
        kit_world_make(&w, NULL);
        w.desc.get_proc = generous_proc;
        stub_calls = 0;
        assert_int_equal(kit_world_init(&w), NACRE_OK);
        assert_int_equal(nacre_gles_draw(w.gles, add(&w, KIT_SPHERES, 0), &view), NACRE_OK);
        assert_int_equal(fake_gl_calls_of("GenVertexArrays"), extension);
        assert_int_equal(stub_calls, 0);
        close_world(&w);
    }
}

/* ---- add ------------------------------------------------------------------------------------- */

static void add_refuses_bad_meshes(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_material m = kit_material(&assets, KIT_TABLE, 0);
    nacre_gles_item item = {7};
    nacre_mesh mesh = assets.ball;
    const uint16_t beyond[3] = {0, 1, mesh.vertex_count};
    const long calls = fake_gl_calls();
    assert_int_equal(nacre_gles_add(NULL, &mesh, &m, &item), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_add(w.gles, NULL, &m, &item), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_add(w.gles, &mesh, NULL, &item), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_add(w.gles, &mesh, &m, NULL), NACRE_ERR_ARGUMENT);
    mesh.vertices = NULL;
    assert_int_equal(nacre_gles_add(w.gles, &mesh, &m, &item), NACRE_ERR_ARGUMENT);
    mesh = assets.ball;
    mesh.indices = NULL;
    assert_int_equal(nacre_gles_add(w.gles, &mesh, &m, &item), NACRE_ERR_ARGUMENT);
    mesh = assets.ball;
    mesh.index_count--;
    assert_int_equal(nacre_gles_add(w.gles, &mesh, &m, &item), NACRE_ERR_ARGUMENT);
    mesh.index_count = 0;
    assert_int_equal(nacre_gles_add(w.gles, &mesh, &m, &item), NACRE_ERR_ARGUMENT);
    mesh = assets.ball;
    mesh.half_extent[1] = -1;
    assert_int_equal(nacre_gles_add(w.gles, &mesh, &m, &item), NACRE_ERR_ARGUMENT);
    mesh = assets.ball;
    mesh.indices = beyond;
    mesh.index_count = 3;
    assert_int_equal(nacre_gles_add(w.gles, &mesh, &m, &item), NACRE_ERR_ARGUMENT);
    assert_int_equal(item.id, 7);
    assert_int_equal(fake_gl_calls(), calls);
    close_world(&w);
}

static void add_refuses_bad_materials(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    nacre_gles_item item = {7};
    nacre_material m = kit_material(&assets, KIT_TABLE, 0);
    const long calls = fake_gl_calls();
    m.model = NACRE_MODEL_NONE;
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_ARGUMENT);
    m.model = (nacre_model)99;
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_ARGUMENT);
    m.model = NACRE_MODEL_SPHERES; /* has only a table */
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_ARGUMENT);
    m.image[NACRE_ROLE_SPHERES] = &assets.image[KIT_TABLE]; /* a table in the wrong place */
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_ASSET);
    m = kit_material(&assets, KIT_TABLE, 0);
    m.image[NACRE_ROLE_TABLE] = &assets.image[KIT_SPHERES];
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_ASSET);
    m = kit_material(&assets, KIT_TABLE, 0);
    m.image[NACRE_ROLE_NORMAL] = &assets.image[KIT_RGB565];
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_ASSET);
    assert_int_equal(item.id, 7);
    assert_int_equal(fake_gl_calls(), calls);
    close_world(&w);
}

/* Every byte of the key/value data of a table and of spheres changed: OK or ERR_ASSET, never anything made on failure. */
static void add_survives_changed_keys(void **state)
{
    (void)state;
    static const kit_model models[] = {KIT_TABLE, KIT_SPHERES, KIT_ETC1, KIT_QUARTER};
    for (int i = 0; i < 4; i++) {
        uint8_t *data = assets.file[models[i]];
        nacre_image *image = &assets.image[models[i]];
        for (uint32_t k = 0; k < image->kv_size; k++) {
            world w;
            open_world(&w, &(fake_gl_options){.extensions = "GL_OES_compressed_ETC1_RGB8_texture"}, NULL);
            const nacre_material m = kit_material(&assets, models[i], 0);
            nacre_gles_item item = {0};
            data[image->kv_offset + k] ^= 0x91;
            const nacre_result r = nacre_gles_add(w.gles, &assets.ball, &m, &item);
            assert_true(r == NACRE_OK || r == NACRE_ERR_ASSET || r == NACRE_ERR_UNSUPPORTED);
            assert_int_equal(r == NACRE_OK, item.id != 0);
            if (r) assert_int_equal(fake_gl_live(), 0);
            nacre_gles_remove(w.gles, item);
            data[image->kv_offset + k] ^= 0x91;
            close_world(&w);
        }
    }
}

/* ---- budgets ------------------------------------------------------------------------------------ */

/* Texel bytes of a kit image by arithmetic of the test's own. */
static uint32_t texel_bytes(kit_model model, int levels)
{
    const nacre_image *i = &assets.image[model];
    uint32_t sum = 0;
    for (int l = 0; l < levels; l++) {
        const uint32_t w = i->width >> l ? i->width >> l : 1, h = i->height >> l ? i->height >> l : 1;
        sum += model == KIT_ETC1     ? (w + 3) / 4 * ((h + 3) / 4) * 8
               : model == KIT_RGB565 ? w * h * 2
               : model == KIT_NORMAL ? w * h * 3
                                     : w * h * 4;
    }
    return sum * i->layers;
}

static void texture_bytes_are_what_gl_got(void **state)
{
    (void)state;
    static const struct {
        kit_model model;
        int es2_levels, es3_levels;
    } cases[] = {
        {KIT_TABLE, 1, 1}, {KIT_FINE, 1, 1},   {KIT_SPHERES, 6, 6}, {KIT_PAPER, 8, 8},
        {KIT_ETC1, 5, 5},  {KIT_RGB565, 1, 2}, /* 20 x 12, cut short: ES 2.0 can't filter it with mips */
    };
    for (int es = 2; es <= 3; es++)
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
            for (int normal = 0; normal < 2; normal++) {
                world w;
                open_world(&w, &(fake_gl_options){.es = es, .extensions = "GL_OES_compressed_ETC1_RGB8_texture"}, NULL);
                const int levels = es == 2 ? cases[i].es2_levels : cases[i].es3_levels;
                const uint32_t wanted = texel_bytes(cases[i].model, levels) + (normal ? texel_bytes(KIT_NORMAL, 4) : 0);
                const nacre_gles_item item = add(&w, cases[i].model, normal);
                assert_int_equal(nacre_gles_texture_bytes(w.gles), wanted);
                assert_int_equal(fake_gl_texture_bytes(), wanted);
                assert_int_equal(fake_gl_buffer_bytes(), assets.ball.vertex_count * 24u + assets.ball.index_count * 2u);
                nacre_gles_remove(w.gles, item);
                assert_int_equal(nacre_gles_texture_bytes(w.gles), 0);
                assert_int_equal(fake_gl_texture_bytes(), 0);
                assert_int_equal(fake_gl_buffer_bytes(), 0);
                close_world(&w);
            }
}

static void etc1_needs_its_extension(void **state)
{
    (void)state;
    world w;
    open_world(&w, &(fake_gl_options){.extensions = "GL_OES_compressed_ETC1_RGB8_texture_x"}, NULL);
    const nacre_material m = kit_material(&assets, KIT_ETC1, 0);
    nacre_gles_item item = {7};
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_UNSUPPORTED);
    assert_int_equal(item.id, 7);
    assert_int_equal(fake_gl_live(), 0);
    close_world(&w);
}

/* Quarters are one texture, all images below each other; it must fit the device as a whole. */
static void quarters_are_one_texture(void **state)
{
    (void)state;
    world w;
    open_world(&w, &(fake_gl_options){.max_texture = 128}, &(nacre_gles_desc){.max_textures = 1});
    add(&w, KIT_QUARTER, 0);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), 16 * 16 * 3 * 5);
    assert_int_equal(fake_gl_texture_bytes(), 16 * 16 * 3 * 5);
    close_world(&w);
    open_world(&w, &(fake_gl_options){.max_texture = 64}, NULL);
    const nacre_material m = kit_material(&assets, KIT_QUARTER, 0);
    nacre_gles_item item = {7};
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_UNSUPPORTED);
    assert_int_equal(item.id, 7);
    assert_int_equal(fake_gl_live(), 0);
    close_world(&w);
}

/* Blocks of any ETC2 mode need ES 3; of ETC1 modes alone, ES 2 with its extension takes them too. */
static void etc2_needs_es3(void **state)
{
    (void)state;
    static const char etc1[] = "GL_OES_compressed_ETC1_RGB8_texture";
    static const struct {
        int etc2;
        fake_gl_options gl;
        nacre_result result;
    } cases[] = {{1, {.es = 2, .extensions = etc1}, NACRE_ERR_UNSUPPORTED},
                 {1, {.es = 3}, NACRE_OK},
                 {0, {.es = 2, .extensions = etc1}, NACRE_OK},
                 {0, {.es = 2}, NACRE_ERR_UNSUPPORTED},
                 {0, {.es = 3}, NACRE_OK}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const sphere_options o = {.size = 8, .images = 2, .format = NACRE_FORMAT_ETC2_RGB8, .etc2 = cases[i].etc2};
        nacre_material m = {.model = NACRE_MODEL_SPHERES};
        nacre_gles_item item = {7};
        nacre_image image;
        sphere_asset s = bake_spheres("blinn-phong:", &o);
        bytes file = {0};
        world w;
        sphere_write(&s, &file);
        assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_OK);
        m.image[NACRE_ROLE_SPHERES] = &image;
        open_world(&w, &cases[i].gl, NULL);
        assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), cases[i].result);
        if (cases[i].result) assert_int_equal(item.id, 7);
        if (!cases[i].result) nacre_gles_remove(w.gles, item);
        assert_int_equal(fake_gl_texture_bytes(), 0);
        close_world(&w);
        bytes_free(&file);
        sphere_free(&s);
    }
}

static void small_devices_start_at_a_smaller_level(void **state)
{
    (void)state;
    world w;
    open_world(&w, &(fake_gl_options){.max_texture = 64}, NULL);
    add(&w, KIT_PAPER, 0);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), texel_bytes(KIT_PAPER, 8) - texel_bytes(KIT_PAPER, 1));
    assert_int_equal(fake_gl_texture_bytes(), nacre_gles_texture_bytes(w.gles));
    close_world(&w);
    /* no level fits */
    open_world(&w, &(fake_gl_options){.max_texture = 64}, NULL);
    nacre_material m = kit_material(&assets, KIT_PAPER, 0);
    nacre_image large = assets.image[KIT_PAPER];
    nacre_gles_item item = {7};
    large.levels = 1;
    m.image[NACRE_ROLE_SPHERES] = &large;
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_UNSUPPORTED);
    assert_int_equal(item.id, 7);
    assert_int_equal(fake_gl_live(), 0);
    close_world(&w);
}

static void texture_budget_is_kept(void **state)
{
    (void)state;
    const uint32_t spheres = texel_bytes(KIT_SPHERES, 6), table = texel_bytes(KIT_TABLE, 1);
    world w;
    open_world(&w, NULL, &(nacre_gles_desc){.texture_budget = spheres + table - 1});
    const nacre_material m = kit_material(&assets, KIT_TABLE, 0);
    nacre_gles_item item = {7};
    const nacre_gles_item first = add(&w, KIT_SPHERES, 0);
    const long calls = fake_gl_calls();
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_ERR_BUDGET);
    assert_int_equal(fake_gl_calls(), calls);
    assert_int_equal(item.id, 7);
    nacre_gles_remove(w.gles, first);
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_OK);
    close_world(&w);
    /* exactly enough */
    open_world(&w, NULL, &(nacre_gles_desc){.texture_budget = spheres + table});
    add(&w, KIT_SPHERES, 0);
    add(&w, KIT_TABLE, 0);
    close_world(&w);
}

static void textures_are_shared(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_gles_item a = add(&w, KIT_SPHERES, 1), b = add(&w, KIT_SPHERES, 0), c = add(&w, KIT_TABLE, 1);
    const uint32_t spheres = texel_bytes(KIT_SPHERES, 6), table = texel_bytes(KIT_TABLE, 1),
                   normal = texel_bytes(KIT_NORMAL, 4);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), spheres + table + normal);
    nacre_gles_remove(w.gles, a);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), spheres + table + normal);
    nacre_gles_remove(w.gles, b);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), table + normal);
    nacre_gles_remove(w.gles, c);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), 0);
    assert_int_equal(fake_gl_texture_bytes(), 0);
    close_world(&w);
}

static void max_items_and_textures_are_kept(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, &(nacre_gles_desc){.max_items = 2, .max_textures = 5});
    const nacre_material spheres = kit_material(&assets, KIT_SPHERES, 0), fine = kit_material(&assets, KIT_FINE, 1);
    const nacre_material paper = kit_material(&assets, KIT_PAPER, 0);
    nacre_gles_item a = {0}, b = {0}, c = {7};
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &spheres, &a), NACRE_OK);
    const long calls = fake_gl_calls();
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &fine, &c), NACRE_ERR_BUDGET); /* 4 + 3 textures */
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &paper, &c), NACRE_ERR_BUDGET);
    assert_int_equal(fake_gl_calls(), calls);
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &spheres, &b), NACRE_OK);
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &spheres, &c), NACRE_ERR_BUDGET);
    assert_int_equal(c.id, 7);
    close_world(&w);
}

/* ---- handles ------------------------------------------------------------------------------------- */

static void stale_handles_are_refused(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_view view = kit_view(1, 0, 0);
    const nacre_gles_item a = add(&w, KIT_TABLE, 0);
    uint32_t program = 99;
    nacre_gles_remove(w.gles, a);
    const nacre_gles_item b = add(&w, KIT_TABLE, 0);
    assert_int_not_equal(a.id, b.id);
    const nacre_gles_item bad[] = {a, {0}, {b.id + 1}, {b.id + 256}, {0xFFFFFFFF}, {255}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(nacre_gles_draw(w.gles, bad[i], &view), NACRE_ERR_ARGUMENT);
        assert_int_equal(nacre_gles_prepare(w.gles, bad[i], &view), NACRE_ERR_ARGUMENT);
        assert_int_equal(nacre_gles_bind(w.gles, bad[i], &view, &program), NACRE_ERR_ARGUMENT);
        nacre_gles_remove(w.gles, bad[i]);
    }
    assert_int_equal(program, 99);
    assert_int_equal(nacre_gles_draw(w.gles, b, &view), NACRE_OK);
    close_world(&w);
}

/* ---- views ---------------------------------------------------------------------------------------- */

static void draw_refuses_bad_views(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_gles_item item = add(&w, KIT_TABLE, 0);
    nacre_light lights[9];
    memset(lights, 0, sizeof lights);
    for (int i = 0; i < 9; i++) lights[i].direction.z = NACRE_Q14_ONE;
    const long calls = fake_gl_calls();
    assert_int_equal(nacre_gles_draw(NULL, item, NULL), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_draw(w.gles, item, NULL), NACRE_ERR_ARGUMENT);
#define REFUSED(change)                                                                                                \
    do {                                                                                                               \
        nacre_view view = kit_view(1, 0, 0);                                                                           \
        nacre_light light = view.lights[0];                                                                            \
        view.lights = &light;                                                                                          \
        change;                                                                                                        \
        assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_ERR_ARGUMENT);                                    \
        assert_int_equal(nacre_gles_prepare(w.gles, item, &view), NACRE_ERR_ARGUMENT);                                 \
        assert_int_equal(nacre_gles_bind(w.gles, item, &view, NULL), NACRE_ERR_ARGUMENT);                              \
    } while (0)
    REFUSED((view.lights = lights, view.light_count = NACRE_MAX_LIT_LIGHTS + 1));
    REFUSED(view.lights = NULL);
    REFUSED(view.output = 3);
    REFUSED(view.distant_viewer = 2);
    REFUSED(view.exposure = -1);
    REFUSED(light.type = 2);
    REFUSED(light.shadow = -1);
    REFUSED(light.shadow = NACRE_Q14_ONE + 1);
    REFUSED((light.direction.x = light.direction.y = light.direction.z = 0));
    REFUSED(view.object_to_view.m[3] = 1);
    REFUSED(view.object_to_view.m[15] = 0);
    REFUSED(memset(view.object_to_view.m, 0, 3 * sizeof(nacre_q16)));                         /* a column of zeros */
    REFUSED(memcpy(view.object_to_view.m + 4, view.object_to_view.m, 3 * sizeof(nacre_q16))); /* two alike */
#undef REFUSED
    assert_int_equal(fake_gl_calls(), calls);
    /* extreme scales are none of these */
    nacre_view view = kit_view(1, 0, 0);
    for (int i = 0; i < 12; i++)
        if (i % 4 != 3) view.object_to_view.m[i] = i % 5 ? 0 : i == 0 ? 256 * 65536 : 256;
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
    close_world(&w);
}

/* ---- the caller's buffers -------------------------------------------------------------------------- */

static nacre_gles_buffers float_buffers(uint32_t vertex, uint32_t index)
{
    nacre_gles_buffers b = {.vertex_buffer = vertex, .index_buffer = index, .index_type = 0x1403};
    b.count = assets.ball.index_count;
    b.attribute[NACRE_GLES_POSITION] = (nacre_gles_attribute){0x1406, 3, 0, 0, 48};
    b.attribute[NACRE_GLES_NORMAL] = (nacre_gles_attribute){0x1406, 3, 0, 12, 48};
    b.attribute[NACRE_GLES_TANGENT] = (nacre_gles_attribute){0x1406, 4, 0, 24, 48};
    b.attribute[NACRE_GLES_UV] = (nacre_gles_attribute){0x1406, 2, 0, 40, 48};
    for (int i = 0; i < 3; i++) b.centre[i] = assets.ball.centre[i];
    return b;
}

static void buffers_are_checked(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_material plain = kit_material(&assets, KIT_TABLE, 0), bumpy = kit_material(&assets, KIT_TABLE, 1);
    nacre_gles_item item = {7};
#define REFUSED(material, result, change)                                                                              \
    do {                                                                                                               \
        nacre_gles_buffers b = float_buffers(1, 2);                                                                    \
        change;                                                                                                        \
        assert_int_equal(nacre_gles_add_buffers(w.gles, &b, material, &item), result);                                 \
        assert_int_equal(item.id, 7);                                                                                  \
    } while (0)
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.vertex_buffer = 0);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.count = 0);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.count = 4);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.index_type = 0x1401);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.index_offset = 1);
    REFUSED(&plain, NACRE_ERR_UNSUPPORTED, b.index_type = 0x1405);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.attribute[0].count = 0);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.attribute[0].count = 5);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.attribute[0].type = 0x1234);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.attribute[1].count = 2);
    REFUSED(&plain, NACRE_ERR_ARGUMENT, b.attribute[1].normalized = 2);
    REFUSED(&bumpy, NACRE_ERR_ARGUMENT, b.attribute[2].count = 0);
    REFUSED(&bumpy, NACRE_ERR_ARGUMENT, b.attribute[3].count = 1);
#undef REFUSED
    assert_int_equal(fake_gl_live(), 0);
    nacre_gles_buffers b = float_buffers(1, 2);
    b.attribute[2].count = b.attribute[3].count = 0; /* not needed without a normal map */
    assert_int_equal(nacre_gles_add_buffers(w.gles, &b, &plain, &item), NACRE_OK);
    b.index_type = 0x1405;
    assert_int_equal(nacre_gles_set_buffers(w.gles, item, &b), NACRE_ERR_UNSUPPORTED);
    assert_int_equal(nacre_gles_set_buffers(w.gles, item, NULL), NACRE_ERR_ARGUMENT);
    b.index_type = 0x1403;
    assert_int_equal(nacre_gles_set_buffers(w.gles, item, &b), NACRE_OK);
    assert_int_equal(nacre_gles_set_buffers(w.gles, add(&w, KIT_TABLE, 0), &b), NACRE_ERR_ARGUMENT);
    /* only bound, never drawn */
    const nacre_view view = kit_view(1, 0, 0);
    assert_int_equal(nacre_gles_add_buffers(w.gles, NULL, &plain, &item), NACRE_OK);
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_ERR_ARGUMENT);
    uint32_t program = 0;
    assert_int_equal(nacre_gles_bind(w.gles, item, &view, &program), NACRE_OK);
    assert_int_not_equal(program, 0);
    assert_int_equal(nacre_gles_unbind(w.gles), NACRE_OK);
    assert_int_equal(nacre_gles_unbind(w.gles), NACRE_OK);
    close_world(&w);
}

/* What the header promises that bind holds on the smallest device, and one light more. */
static void bind_holds_four_lights_of_a_table(void **state)
{
    (void)state;
    static const struct {
        kit_model model;
        int lights;
    } cases[] = {{KIT_TABLE, 4}, {KIT_FINE, 4}, {KIT_SPHERES, 2}, {KIT_PAPER, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int perspective = 0; perspective < 2; perspective++) {
            world w;
            open_world(&w, &(fake_gl_options){.fragment_vectors = 16, .texture_units = 8}, NULL);
            const nacre_gles_item item = add(&w, cases[i].model, 1);
            for (int more = 0; more < 2; more++) {
                nacre_view view = kit_view(cases[i].lights + more, 0, perspective);
                view.ambient.g = NACRE_Q16_ONE;
                const nacre_result result = nacre_gles_bind(w.gles, item, &view, NULL);
                if (!more) assert_int_equal(result, NACRE_OK);
                if (more && perspective) assert_int_equal(result, NACRE_ERR_UNSUPPORTED);
                assert_int_equal(nacre_gles_unbind(w.gles), NACRE_OK);
                assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
            }
            close_world(&w);
        }
}

/* ---- GL state -------------------------------------------------------------------------------------- */

static void assert_state_kept(const long *before, int count, const char *what)
{
    long after[FAKE_GL_STATES];
    assert_int_equal(fake_gl_snapshot(after), count);
    for (int i = 0; i < count; i++)
        if (before[i] != after[i]) fail_msg("%s: %s was %ld, is %ld", what, fake_gl_state_name(i), before[i], after[i]);
}

static void every_call_puts_state_back(void **state)
{
    (void)state;
    for (int es = 2; es <= 3; es++)
        for (int normal = 0; normal < 2; normal++)
            for (int model = 0; model < KIT_ETC1; model++)
                for (int lights = 0; lights <= 8; lights += 2) {
                    world w;
                    long before[FAKE_GL_STATES];
                    open_world(&w, &(fake_gl_options){.es = es}, NULL);
                    kit_hostile_state(es);
                    const int host_objects = 6, count = fake_gl_snapshot(before);
                    assert_in_range(count, 60, FAKE_GL_STATES - 1);
                    const nacre_view view = kit_view(lights, lights > 4, 1);
                    const nacre_gles_item item = add(&w, (kit_model)model, normal);
                    assert_state_kept(before, count, "add");
                    assert_int_equal(nacre_gles_prepare(w.gles, item, &view), NACRE_OK);
                    assert_state_kept(before, count, "prepare");
                    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
                    assert_state_kept(before, count, "draw");
                    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
                    assert_state_kept(before, count, "second draw");
                    if (nacre_gles_bind(w.gles, item, &view, NULL) == NACRE_OK) nacre_gles_unbind(w.gles);
                    assert_state_kept(before, count, "bind");
                    nacre_gles_remove(w.gles, item);
                    assert_state_kept(before, count, "remove");
                    assert_int_equal(fake_gl_pending_error(), 0);
                    nacre_gles_shutdown(w.gles);
                    assert_state_kept(before, count, "shutdown");
                    assert_int_equal(fake_gl_live(), host_objects);
                    assert_true(workspace_intact(&w.block));
                    workspace_free(&w.block);
                }
}

static void host_resets_state_asks_nothing(void **state)
{
    (void)state;
    for (int es = 2; es <= 3; es++)
        for (int normal = 0; normal < 2; normal++) {
            world w;
            open_world(&w, &(fake_gl_options){.es = es}, &(nacre_gles_desc){.host_resets_state = 1});
            const nacre_view view = kit_view(1, 0, 0);
            const nacre_gles_item item = add(&w, KIT_FINE, normal);
            nacre_gles_state changed;
            memset(&changed, 0xFF, sizeof changed);
            assert_int_equal(nacre_gles_prepare(w.gles, item, &view), NACRE_OK);
            const long queries = fake_gl_queries();
            assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
            assert_int_equal(nacre_gles_bind(w.gles, item, &view, NULL), NACRE_OK);
            assert_int_equal(fake_gl_queries(), queries);
            nacre_gles_unbind(w.gles);
            assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
            nacre_gles_changed(w.gles, &changed);
            assert_int_equal(changed.program, 1);
            assert_int_equal(changed.texture_units, 2 + normal);
            assert_int_equal(changed.active_texture, 1);
            assert_int_equal(changed.samplers, es == 3);
            assert_int_equal(changed.vertex_array, es == 3);
            assert_int_equal(changed.buffers, es == 2); /* es 3: our vertex array had them already */
            assert_int_equal(changed.attributes, es == 3 ? 0 : normal ? 15 : 3);
            assert_int_equal(fake_gl_queries(), queries);
            close_world(&w);
        }
}

/* What changed() does not list has not changed. */
static void changed_tells_all(void **state)
{
    (void)state;
    for (int es = 2; es <= 3; es++) {
        world w;
        long before[FAKE_GL_STATES], after[FAKE_GL_STATES];
        open_world(&w, &(fake_gl_options){.es = es}, &(nacre_gles_desc){.host_resets_state = 1});
        const nacre_view view = kit_view(2, 0, 0);
        const nacre_gles_item item = add(&w, KIT_SPHERES, 0);
        kit_hostile_state(es);
        const int count = fake_gl_snapshot(before);
        nacre_gles_state c;
        assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
        nacre_gles_changed(w.gles, &c);
        fake_gl_snapshot(after);
        for (int i = 0; i < count; i++) {
            const char *name = fake_gl_state_name(i);
            unsigned what = 0;
            int at = 0, known = 0;
            char kind[32];
            if (before[i] == after[i]) continue;
            if (sscanf(name, "int %x", &what) == 1)
                known = (what == 0x8B8D && c.program) || (what == 0x84E0 && c.active_texture) ||
                        (what == 0x8894 && c.buffers) || (what == 0x8895 && (c.buffers || c.vertex_array));
            else if (sscanf(name, "texture %x %d", &what, &at) == 2)
                known = at < c.texture_units;
            else if (sscanf(name, "attribute%31[ pointer]%x %d", kind, &what, &at) == 3)
                known = c.vertex_array || (c.attributes >> at & 1);
            if (!known) fail_msg("es %d: %s changed unsaid: %ld, %ld", es, name, before[i], after[i]);
        }
        nacre_gles_shutdown(w.gles);
        workspace_free(&w.block);
    }
}

static void sampler_objects_do_not_disturb(void **state)
{
    (void)state;
    world w;
    long before[FAKE_GL_STATES];
    open_world(&w, &(fake_gl_options){.es = 3}, NULL);
    void (*sampler)(uint32_t, uint32_t) = (void (*)(uint32_t, uint32_t))(uintptr_t)fake_gl_proc(NULL, "glBindSampler");
    sampler(0, 5);
    const nacre_view view = kit_view(1, 0, 0);
    const nacre_gles_item item = add(&w, KIT_TABLE, 0);
    const int count = fake_gl_snapshot(before);
    const long bound = fake_gl_calls_of("BindSampler");
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
    assert_int_equal(fake_gl_calls_of("BindSampler") - bound, 2); /* 0 for the draw, and back */
    assert_state_kept(before, count, "draw");
    close_world(&w);
}

/* ---- programs --------------------------------------------------------------------------------------- */

static void programs_are_kept_and_dropped(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, &(nacre_gles_desc){.max_programs = 2});
    const nacre_gles_item item = add(&w, KIT_TABLE, 0);
    const long none = fake_gl_calls_of("LinkProgram");
    nacre_view view[3] = {kit_view(1, 0, 0), kit_view(1, 0, 0), kit_view(1, 0, 0)};
    view[1].output = NACRE_OUTPUT_SQRT;
    view[2].output = NACRE_OUTPUT_LINEAR;
#define LINKS() (fake_gl_calls_of("LinkProgram") - none)
    for (int i = 0; i < 3; i++) assert_int_equal(nacre_gles_draw(w.gles, item, &view[0]), NACRE_OK);
    assert_int_equal(LINKS(), 1);
    view[0].exposure = 3 * NACRE_Q16_ONE; /* numbers need no new program */
    nacre_gles_draw(w.gles, item, &view[0]);
    assert_int_equal(LINKS(), 1);
    nacre_gles_draw(w.gles, item, &view[1]);
    nacre_gles_draw(w.gles, item, &view[0]);
    assert_int_equal(LINKS(), 2);
    nacre_gles_draw(w.gles, item, &view[2]); /* drops 1, which was used longest ago */
    assert_int_equal(LINKS(), 3);
    assert_int_equal(fake_gl_calls_of("DeleteProgram"), 1);
    nacre_gles_draw(w.gles, item, &view[0]);
    assert_int_equal(LINKS(), 3);
    nacre_gles_draw(w.gles, item, &view[1]);
    assert_int_equal(LINKS(), 4);
#undef LINKS
    close_world(&w);
}

static void prepare_leaves_nothing_to_compile(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_gles_item item = add(&w, KIT_SPHERES, 1);
    const nacre_view view = kit_view(3, 1, 1);
    assert_int_equal(nacre_gles_prepare(w.gles, item, &view), NACRE_OK);
    const long links = fake_gl_calls_of("LinkProgram"), found = fake_gl_calls_of("GetUniformLocation");
    assert_in_range(links, 1, 8);
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
    assert_int_equal(fake_gl_calls_of("LinkProgram"), links);
    assert_int_equal(fake_gl_calls_of("GetUniformLocation"), found);
    close_world(&w);
}

/* ---- loss ----------------------------------------------------------------------------------------- */

static void abandon_makes_no_call(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_view view = kit_view(1, 0, 0);
    const nacre_gles_item item = add(&w, KIT_SPHERES, 1);
    const nacre_material m = kit_material(&assets, KIT_TABLE, 0);
    nacre_gles_buffers b = float_buffers(1, 2);
    nacre_gles_item own = {0}, other = {7};
    assert_int_equal(nacre_gles_add_buffers(w.gles, &b, &m, &own), NACRE_OK);
    assert_int_equal(nacre_gles_bind(w.gles, item, &view, NULL), NACRE_OK);
    const uint32_t texels = nacre_gles_texture_bytes(w.gles);
    fake_gl_lose(1);
    const long calls = fake_gl_calls(), queries = fake_gl_queries();
    nacre_gles_abandon(w.gles);
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_ERR_LOST);
    assert_int_equal(nacre_gles_prepare(w.gles, item, &view), NACRE_ERR_LOST);
    assert_int_equal(nacre_gles_bind(w.gles, item, &view, NULL), NACRE_ERR_LOST);
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &other), NACRE_ERR_LOST);
    nacre_gles_unbind(w.gles);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), 0);
    assert_int_equal(fake_gl_calls(), calls);
    assert_int_equal(fake_gl_queries(), queries);
    assert_int_equal(other.id, 7);

    fake_gl_new_context();
    assert_int_equal(nacre_gles_restore(w.gles), NACRE_OK);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), texels);
    assert_int_equal(fake_gl_texture_bytes(), texels);
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
    assert_int_equal(nacre_gles_draw(w.gles, own, &view), NACRE_ERR_ARGUMENT); /* its buffers are gone */
    assert_int_equal(nacre_gles_set_buffers(w.gles, own, &b), NACRE_OK);
    assert_int_equal(nacre_gles_restore(w.gles), NACRE_OK); /* nothing to do */
    nacre_gles_remove(w.gles, item);
    nacre_gles_remove(w.gles, own);
    assert_int_equal(fake_gl_texture_bytes(), 0);
    close_world(&w);
}

static void items_can_go_while_there_is_no_context(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_gles_item a = add(&w, KIT_SPHERES, 0);
    add(&w, KIT_TABLE, 0);
    nacre_gles_abandon(w.gles);
    nacre_gles_remove(w.gles, a);
    fake_gl_new_context();
    assert_int_equal(nacre_gles_restore(w.gles), NACRE_OK);
    assert_int_equal(fake_gl_texture_bytes(), texel_bytes(KIT_TABLE, 1));
    nacre_gles_abandon(w.gles);
    fake_gl_new_context();
    nacre_gles_shutdown(w.gles);
    assert_int_equal(fake_gl_live(), 0);
    workspace_free(&w.block);
}

/* ---- figures -------------------------------------------------------------------------------------- */

static void print_figures(void **state)
{
    (void)state;
    for (int resets = 0; resets < 2; resets++)
        for (int es = 2; es <= 3; es++) {
            world w;
            open_world(&w, &(fake_gl_options){.es = es}, &(nacre_gles_desc){.host_resets_state = (uint8_t)resets});
            const nacre_view view = kit_view(1, 0, 0);
            const nacre_gles_item item = add(&w, KIT_TABLE, 0);
            nacre_gles_draw(w.gles, item, &view);
            nacre_gles_draw(w.gles, item, &view);
            const long calls = fake_gl_calls(), queries = fake_gl_queries();
            nacre_gles_draw(w.gles, item, &view);
            print_message("ES %d, %-18s GL calls per draw of a table, one light: %ld, of them queries: %ld\n", es,
                          resets ? "host_resets_state:" : "default:", fake_gl_calls() - calls,
                          fake_gl_queries() - queries);
            close_world(&w);
        }
    const nacre_gles_desc d = {.get_proc = fake_gl_proc},
                          one = {.get_proc = fake_gl_proc, .max_items = 1, .max_programs = 1, .max_textures = 1};
    print_message("block: %zu bytes by default, %zu for one item, program and texture (pointers of %zu bytes)\n",
                  nacre_gles_size(&d), nacre_gles_size(&one), sizeof(void *));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(init_refuses_bad_arguments),
        cmocka_unit_test(init_needs_every_entry_point),
        cmocka_unit_test(init_reads_versions),
        cmocka_unit_test(pointers_prove_nothing),
        cmocka_unit_test(add_refuses_bad_meshes),
        cmocka_unit_test(add_refuses_bad_materials),
        cmocka_unit_test(add_survives_changed_keys),
        cmocka_unit_test(texture_bytes_are_what_gl_got),
        cmocka_unit_test(etc1_needs_its_extension),
        cmocka_unit_test(quarters_are_one_texture),
        cmocka_unit_test(etc2_needs_es3),
        cmocka_unit_test(small_devices_start_at_a_smaller_level),
        cmocka_unit_test(texture_budget_is_kept),
        cmocka_unit_test(textures_are_shared),
        cmocka_unit_test(max_items_and_textures_are_kept),
        cmocka_unit_test(stale_handles_are_refused),
        cmocka_unit_test(draw_refuses_bad_views),
        cmocka_unit_test(buffers_are_checked),
        cmocka_unit_test(bind_holds_four_lights_of_a_table),
        cmocka_unit_test(every_call_puts_state_back),
        cmocka_unit_test(host_resets_state_asks_nothing),
        cmocka_unit_test(changed_tells_all),
        cmocka_unit_test(sampler_objects_do_not_disturb),
        cmocka_unit_test(programs_are_kept_and_dropped),
        cmocka_unit_test(prepare_leaves_nothing_to_compile),
        cmocka_unit_test(abandon_makes_no_call),
        cmocka_unit_test(items_can_go_while_there_is_no_context),
        cmocka_unit_test(print_figures),
    };
    int failed;
    kit_open(&assets);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    kit_close(&assets);
    return failed;
}
