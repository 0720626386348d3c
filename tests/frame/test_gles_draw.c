/* SPDX-License-Identifier: MIT */
/*
 * Frames of the GLES object on real drivers: ways of drawing that must give the same picture (passes, the caller's
 * buffers, the caller's draw loop, older shader texts), and GL state before and after. What the pictures must look like
 * is test_frames.c's subject.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gles_kit.h"

#include <cmocka.h>

#define SIZE 64

static kit assets;

static const struct {
    gl_backend backend;
    const char *name;
} drivers_here[] = {{GL_BACKEND_EGL2, "EGL GLES 2"}, {GL_BACKEND_EGL3, "EGL GLES 3"}, {GL_BACKEND_OSMESA, "OSMesa"}};
#define DRIVERS 3

static gl_headless *context;

static void *proc(const char *name)
{
    return fake_gl_proc(NULL, name);
}

static void gl_enable(unsigned cap)
{
    void (*enable)(unsigned) = (void (*)(unsigned))(uintptr_t)gl_headless_proc(NULL, "glEnable");
    enable(cap);
}

/* A context of driver i with depth test on, seen through fake_gl; 0 when there is none. */
static int open_driver(int i, const fake_gl_options *limits)
{
    fake_gl_options o = {0};
    if (!kit_context(&context, drivers_here[i].backend, SIZE, SIZE)) {
        print_message("%s: not on this machine\n", drivers_here[i].name);
        return 0;
    }
    if (limits) o = *limits;
    o.real = gl_headless_proc;
    fake_gl_start(&o);
    gl_enable(0x0B71);
    return 1;
}

static unsigned gl_error(void)
{
    unsigned (*get)(void) = (unsigned (*)(void))(uintptr_t)gl_headless_proc(NULL, "glGetError");
    return get();
}

static image_u8 draw(kit_world *w, nacre_gles_item item, const nacre_view *view)
{
    image_u8 out;
    gl_headless_clear(context, 0, 0, 0, 0);
    const nacre_result r = nacre_gles_draw(w->gles, item, view);
    if (r) fail_msg("draw said %d\n%s", (int)r, w->log);
    assert_int_equal(gl_error(), 0);
    gl_headless_read(context, &out);
    return out;
}

static void begin(kit_world *w, const nacre_gles_desc *desc)
{
    kit_world_make(w, desc);
    const nacre_result r = kit_world_init(w);
    if (r) fail_msg("init said %d\n%s", (int)r, w->log);
}

static void end(kit_world *w)
{
    nacre_gles_shutdown(w->gles);
    assert_int_equal(fake_gl_live(), 0);
    assert_true(kit_world_free(w));
}

static nacre_gles_item add(kit_world *w, kit_model model, int normal)
{
    const nacre_material m = kit_material(&assets, model, normal);
    nacre_gles_item item = {0};
    const nacre_result r = nacre_gles_add(w->gles, &assets.ball, &m, &item);
    if (r) fail_msg("add said %d\n%s", (int)r, w->log);
    return item;
}

/* Same picture within `bound` codes, and something in it. */
static void assert_alike(const image_u8 *a, const image_u8 *b, int bound, const char *what)
{
    int covered;
    long sum = 0;
    const int d = kit_difference(a, b, &covered);
    for (int i = 0; i < SIZE * SIZE; i++) sum += a->texel[4 * i] + a->texel[4 * i + 1] + a->texel[4 * i + 2];
    if (covered < SIZE * SIZE / 10 || sum / 3 < 8L * covered)
        fail_msg("%s: an empty picture: %d pixels, sum %ld", what, covered, sum);
    if (d > bound) fail_msg("%s: differs by %d of 255, %d allowed", what, d, bound);
}

/* ---- passes ------------------------------------------------------------------------------------- */

static const char *model_name(int m)
{
    static const char *const names[] = {"table", "fine", "spheres", "paper", "etc1", "rgb565"};
    return names[m];
}

/* 16 uniform vectors against as many as lets the driver take all lights in one pass. Bound 2: sums are kept to 16 bits, which
   is below 1/4 code beyond code 3, both ways round once, and texts for one pass may use another polynomial. Without mips:
   their level at a silhouette pixel hangs on values outside the triangle, which drivers don't repeat from program to
   program. Under a distant viewer 8 units allow 4 lights of spheres in one pass, and ES 2.0 texts hold 6 of a fine table. */
static void passes_equal_one_pass(void **state)
{
    (void)state;
    uint8_t levels[KIT_MODELS];
    int in_passes = 0, opened = 0;
    for (int i = 0; i < KIT_MODELS; i++) {
        levels[i] = assets.image[i].levels;
        assets.image[i].levels = 1;
    }
    for (int d = 0; d < DRIVERS; d++)
        for (int model = d ? d : KIT_TABLE; model <= (d ? d : KIT_PAPER); model++)
            for (int variant = model; variant < 4; variant += 4) {
                char what[100];
                kit_world w;
                /* Directions per pixel: ES 2.0 texts hold so few lights of these that one pass can't be had. */
                const int normal = variant == 1, perspective = d > 0, points = normal && perspective ? 2 : 0;
                const int spheres = model == KIT_SPHERES || model == KIT_PAPER;
                const int lights = spheres ? (perspective ? 6 : 4) : model == KIT_FINE ? 6 : 7;
                nacre_view view = kit_view(lights, points, perspective);
                image_u8 one, many;
                view.ambient = nacre_rgb_from_float(0.3f, 0.2f, 0.1f);
                view.output = (uint8_t)(variant == 1   ? NACRE_OUTPUT_SQRT
                                        : variant == 3 ? NACRE_OUTPUT_LINEAR
                                                       : NACRE_OUTPUT_SRGB);
                snprintf(what, sizeof what, "%s, %s, variant %d", drivers_here[d].name, model_name(model), variant);

                if (!open_driver(d, &(fake_gl_options){.fragment_vectors = 1024})) break;
                begin(&w, NULL);
                one = draw(&w, add(&w, (kit_model)model, normal), &view);
                const int draws = fake_gl_draws();
                end(&w);
                gl_headless_close(context);

                if (!open_driver(d, &(fake_gl_options){.fragment_vectors = 16})) break;
                begin(&w, NULL);
                const nacre_gles_item item = add(&w, (kit_model)model, normal);
                const uint32_t bytes = nacre_gles_texture_bytes(w.gles);
                many = draw(&w, item, &view);
                assert_alike(&one, &many, 2, what);
                if (fake_gl_draws() > 1) /* 18 bytes a pixel of targets */
                    assert_int_equal(nacre_gles_texture_bytes(w.gles), bytes + 18 * SIZE * SIZE);
                assert_int_equal(fake_gl_texture_bytes(), nacre_gles_texture_bytes(w.gles));
                if (!normal || !spheres) assert_int_equal(draws, 1);
                in_passes += fake_gl_draws() > 1;
                opened |= 1 << d;
                if (d == 0)
                    print_message("%s: %d lights, %d draws at 1024 uniform vectors, %d at 16\n", what, view.light_count,
                                  draws, fake_gl_draws());
                image_u8_free(&one);
                image_u8_free(&many);
                end(&w);
                gl_headless_close(context);
            }
    for (int i = 0; i < KIT_MODELS; i++) assets.image[i].levels = levels[i];
    assert_true(in_passes >= (opened & 1 ? 4 : 0) + (opened >> 1 & 1) + (opened >> 2 & 1));
}

/* The same of eight lights on maps of three lobes: passes of four lights, first with two lobes, then with the third. GLSL ES
   1.00 has no program of eight. */
static void lobes_in_passes(void **state)
{
    (void)state;
    const uint8_t levels = assets.image[KIT_SBRDF].levels;
    int compared = 0, opened = 0;
    assets.image[KIT_SBRDF].levels = assets.image[KIT_LOBES].levels = 1;
    for (int d = 0; d < DRIVERS; d++)
        for (int power = NACRE_GLES_POWER_COMPUTED; power <= NACRE_GLES_POWER_TABLE; power++)
            for (int perspective = 0; perspective < 2; perspective++) {
                image_u8 picture[2];
                char what[100];
                int i, draws[2];
                nacre_view view = kit_view(8, perspective, perspective);
                view.ambient = nacre_rgb_from_float(0.1f, 0.2f, 0.3f);
                snprintf(what, sizeof what, "%s, power %d, perspective %d", drivers_here[d].name, power, perspective);
                for (i = 0; i < 2; i++) {
                    kit_world w;
                    if (!open_driver(d, &(fake_gl_options){.fragment_vectors = i ? 16 : 1024})) break;
                    begin(&w, &(nacre_gles_desc){.power = (uint8_t)power});
                    picture[i] = draw(&w, add(&w, KIT_SBRDF, 0), &view);
                    draws[i] = fake_gl_draws();
                    end(&w);
                    gl_headless_close(context);
                }
                if (!i) continue;
                assert_alike(&picture[0], &picture[1], 2, what);
                assert_true(draws[1] > 1);
                compared += draws[0] == 1;
                opened++;
                for (i = 0; i < 2; i++) image_u8_free(&picture[i]);
            }
    assets.image[KIT_SBRDF].levels = assets.image[KIT_LOBES].levels = levels;
    print_message("%d of %d pairs: one program against passes\n", compared, opened);
    assert_true(!opened || compared >= 4);
}

/* Depth that falls with distance by glDepthRange: the passes' own depth test must turn round too. */
static void passes_know_reversed_depth(void **state)
{
    (void)state;
    for (int d = 0; d < DRIVERS; d++) {
        const nacre_view view = kit_view(7, 0, 0);
        image_u8 picture[2];
        int passes = 0;
        for (; passes < 2; passes++) {
            kit_world w;
            if (!open_driver(d, &(fake_gl_options){.fragment_vectors = passes ? 16 : 1024})) break;
            void (*range)(float, float) = (void (*)(float, float))(uintptr_t)gl_headless_proc(NULL, "glDepthRangef");
            void (*func)(unsigned) = (void (*)(unsigned))(uintptr_t)gl_headless_proc(NULL, "glDepthFunc");
            void (*clear)(float) = (void (*)(float))(uintptr_t)gl_headless_proc(NULL, "glClearDepthf");
            range(1, 0);
            func(0x0204); /* GL_GREATER */
            clear(0);
            begin(&w, NULL);
            picture[passes] = draw(&w, add(&w, KIT_TABLE, 0), &view);
            assert_int_equal(fake_gl_draws() > 1, passes);
            end(&w);
            gl_headless_close(context);
        }
        if (!passes) continue;
        assert_alike(&picture[0], &picture[1], 2, drivers_here[d].name);
        image_u8_free(&picture[0]);
        image_u8_free(&picture[1]);
    }
}

/* Passes that can't be: no room for targets, and a draw loop of the application's own. */
static void passes_have_their_limits(void **state)
{
    (void)state;
    if (!open_driver(0, &(fake_gl_options){.fragment_vectors = 16})) skip();
    kit_world w;
    const nacre_view view = kit_view(8, 0, 0), small = kit_view(1, 0, 0);
    uint32_t program = 77;
    begin(&w, &(nacre_gles_desc){.texture_budget = 40000});
    const nacre_gles_item item = add(&w, KIT_SPHERES, 0);
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_ERR_BUDGET);
    assert_int_equal(nacre_gles_draw(w.gles, item, &small), NACRE_OK);
    assert_int_equal(nacre_gles_bind(w.gles, item, &view, &program), NACRE_ERR_UNSUPPORTED);
    assert_int_equal(program, 77);
    end(&w);
    gl_headless_close(context);
}

/* ---- the caller's buffers and draw loop ------------------------------------------------------------ */

typedef struct host_mesh {
    uint32_t vertex, index;
    nacre_gles_buffers buffers;
} host_mesh;

static host_mesh upload_floats(void)
{
    void (*gen)(int, uint32_t *) = (void (*)(int, uint32_t *))(uintptr_t)gl_headless_proc(NULL, "glGenBuffers");
    void (*bind)(unsigned, uint32_t) = (void (*)(unsigned, uint32_t))(uintptr_t)gl_headless_proc(NULL, "glBindBuffer");
    void (*data)(unsigned, ptrdiff_t, const void *, unsigned) =
        (void (*)(unsigned, ptrdiff_t, const void *, unsigned))(uintptr_t)gl_headless_proc(NULL, "glBufferData");
    host_mesh m;
    memset(&m, 0, sizeof m);
    gen(1, &m.vertex);
    gen(1, &m.index);
    bind(0x8892, m.vertex);
    data(0x8892, assets.ball.vertex_count * 48, assets.floats, 0x88E4);
    bind(0x8893, m.index);
    data(0x8893, assets.ball.index_count * 2, assets.ball.indices, 0x88E4);
    bind(0x8892, 0);
    bind(0x8893, 0);
    m.buffers.vertex_buffer = m.vertex;
    m.buffers.index_buffer = m.index;
    m.buffers.index_type = 0x1403;
    m.buffers.count = assets.ball.index_count;
    m.buffers.attribute[0] = (nacre_gles_attribute){0x1406, 3, 0, 0, 48};
    m.buffers.attribute[1] = (nacre_gles_attribute){0x1406, 3, 0, 12, 48};
    m.buffers.attribute[2] = (nacre_gles_attribute){0x1406, 4, 0, 24, 48};
    m.buffers.attribute[3] = (nacre_gles_attribute){0x1406, 2, 0, 40, 48};
    memcpy(m.buffers.centre, assets.ball.centre, sizeof m.buffers.centre);
    return m;
}

static void draw_myself(const host_mesh *m)
{
    void (*bind)(unsigned, uint32_t) = (void (*)(unsigned, uint32_t))(uintptr_t)gl_headless_proc(NULL, "glBindBuffer");
    void (*pointer)(unsigned, int, unsigned, uint8_t, int, const void *) = (void (*)(
        unsigned, int, unsigned, uint8_t, int, const void *))(uintptr_t)gl_headless_proc(NULL, "glVertexAttribPointer");
    void (*enable)(unsigned) = (void (*)(unsigned))(uintptr_t)gl_headless_proc(NULL, "glEnableVertexAttribArray");
    void (*elements)(unsigned, int, unsigned, const void *) =
        (void (*)(unsigned, int, unsigned, const void *))(uintptr_t)gl_headless_proc(NULL, "glDrawElements");
    bind(0x8892, m->vertex);
    bind(0x8893, m->index);
    for (unsigned i = 0; i < 4; i++) {
        const nacre_gles_attribute *a = &m->buffers.attribute[i];
        pointer(i, a->count, a->type, a->normalized, (int)a->stride, (const void *)(uintptr_t)a->offset);
        enable(i);
    }
    elements(4, (int)m->buffers.count, 0x1403, NULL);
}

/* The same mesh packed, as floats in the caller's buffers, and in the caller's own draw call. Bound 1: packed positions are
   scaled by the shader, so the last bit of a coordinate may differ. */
static void callers_buffers_equal_mesh(void **state)
{
    (void)state;
    for (int d = 0; d < DRIVERS; d++)
        for (int model = 0; model <= KIT_RGB565; model += 1 + (d > 0)) {
            char what[100];
            kit_world w;
            if (!open_driver(d, NULL)) break;
            const int normal = model & 1;
            const nacre_view view = kit_view(model == KIT_PAPER ? 1 : 1 + model % 2, model == KIT_PAPER, model > 1);
            const nacre_material material = kit_material(&assets, (kit_model)model, normal);
            begin(&w, NULL);
            const host_mesh mesh = upload_floats();
            nacre_gles_item theirs = {0}, bound = {0};
            uint32_t program = 0;
            const nacre_result added = nacre_gles_add_buffers(w.gles, &mesh.buffers, &material, &theirs);
            if (added == NACRE_ERR_UNSUPPORTED && model == KIT_ETC1) { /* bare ES 2.0 has no compressed textures */
                end(&w);
                gl_headless_close(context);
                continue;
            }
            assert_int_equal(added, NACRE_OK);
            assert_int_equal(nacre_gles_add_buffers(w.gles, NULL, &material, &bound), NACRE_OK);
            snprintf(what, sizeof what, "%s, %s: buffers", drivers_here[d].name, model_name(model));
            image_u8 ours = draw(&w, add(&w, (kit_model)model, normal), &view), buffers = draw(&w, theirs, &view), own;
            assert_alike(&ours, &buffers, 1, what);

            gl_headless_clear(context, 0, 0, 0, 0);
            assert_int_equal(nacre_gles_bind(w.gles, theirs, &view, &program), NACRE_OK);
            assert_int_not_equal(program, 0);
            draw_myself(&mesh);
            assert_int_equal(nacre_gles_unbind(w.gles), NACRE_OK);
            assert_int_equal(gl_error(), 0);
            gl_headless_read(context, &own);
            assert_alike(&buffers, &own, 0, "the caller's draw call");
            image_u8_free(&ours);
            image_u8_free(&buffers);
            image_u8_free(&own);
            end(&w);
            gl_headless_close(context);
        }
}

/* Indices beyond 65,535, with first bytes to skip: the ball's vertices come after so many empty ones. */
static host_mesh upload_wide(void)
{
    enum { EMPTY = 66000, SKIPPED = 2 };
    void (*bind)(unsigned, uint32_t) = (void (*)(unsigned, uint32_t))(uintptr_t)gl_headless_proc(NULL, "glBindBuffer");
    void (*data)(unsigned, ptrdiff_t, const void *, unsigned) =
        (void (*)(unsigned, ptrdiff_t, const void *, unsigned))(uintptr_t)gl_headless_proc(NULL, "glBufferData");
    const size_t vertices = EMPTY + (size_t)assets.ball.vertex_count, indices = SKIPPED + assets.ball.index_count;
    float *vertex = calloc(vertices, 48);
    uint32_t *index = calloc(indices, sizeof *index);
    host_mesh m = upload_floats();
    assert_non_null(vertex);
    assert_non_null(index);
    memcpy(vertex + 12 * EMPTY, assets.floats, (size_t)assets.ball.vertex_count * 48);
    for (uint32_t i = 0; i < assets.ball.index_count; i++) index[SKIPPED + i] = EMPTY + assets.ball.indices[i];
    bind(0x8892, m.vertex);
    data(0x8892, (ptrdiff_t)(vertices * 48), vertex, 0x88E4);
    bind(0x8893, m.index);
    data(0x8893, (ptrdiff_t)(indices * sizeof *index), index, 0x88E4);
    bind(0x8892, 0);
    bind(0x8893, 0);
    m.buffers.index_type = 0x1405;
    m.buffers.index_offset = SKIPPED * sizeof *index;
    free(vertex);
    free(index);
    return m;
}

static void wide_indices_equal_short_ones(void **state)
{
    (void)state;
    int drawn = 0;
    for (int d = 0; d < DRIVERS; d++) {
        kit_world w;
        if (!open_driver(d, NULL)) continue;
        const nacre_view view = kit_view(2, 0, 1);
        const nacre_material material = kit_material(&assets, KIT_TABLE, 1);
        begin(&w, NULL);
        const host_mesh narrow = upload_floats(), wide = upload_wide();
        nacre_gles_item a = {0}, b = {0};
        assert_int_equal(nacre_gles_add_buffers(w.gles, &narrow.buffers, &material, &a), NACRE_OK);
        const nacre_result added = nacre_gles_add_buffers(w.gles, &wide.buffers, &material, &b);
        if (added == NACRE_ERR_UNSUPPORTED) {
            print_message("%s: no 32-bit indices\n", drivers_here[d].name);
            assert_int_equal(d, 0); /* ES 3.0 and desktop GL have them */
        } else {
            assert_int_equal(added, NACRE_OK);
            image_u8 expected = draw(&w, a, &view), found = draw(&w, b, &view);
            assert_alike(&expected, &found, 0, "32-bit indices");
            image_u8_free(&expected);
            image_u8_free(&found);
            drawn++;
        }
        end(&w);
        gl_headless_close(context);
    }
    print_message("32-bit indices drawn on %d drivers\n", drawn);
}

/* ---- other roads to the same picture --------------------------------------------------------------- */

/* Bound 0 where the same program runs, 1 between the two shader languages and with or without vertex arrays. */
static void options_do_not_show(void **state)
{
    (void)state;
    static const nacre_gles_desc descs[] = {
        {.host_resets_state = 1}, {.prefer_es2 = 1}, {.max_programs = 1}, {.max_items = 255}};
    for (int d = 0; d < DRIVERS; d++)
        for (int model = KIT_TABLE; model <= KIT_SPHERES; model += KIT_SPHERES - KIT_TABLE) {
            const nacre_view view = kit_view(2, 0, 1);
            kit_world w;
            image_u8 plain, other;
            if (!open_driver(d, NULL)) break;
            begin(&w, NULL);
            plain = draw(&w, add(&w, (kit_model)model, 0), &view);
            end(&w);
            for (size_t i = 0; i < sizeof descs / sizeof *descs; i++) {
                begin(&w, &descs[i]);
                other = draw(&w, add(&w, (kit_model)model, 0), &view);
                assert_alike(&plain, &other, i == 1, "desc");
                image_u8_free(&other);
                end(&w);
            }
            fake_gl_start(&(fake_gl_options){.real = gl_headless_proc, .no_optional = 1});
            begin(&w, NULL);
            other = draw(&w, add(&w, (kit_model)model, 0), &view);
            assert_alike(&plain, &other, 0, "without vertex arrays");
            image_u8_free(&other);
            end(&w);
            image_u8_free(&plain);
            gl_headless_close(context);
        }
}

/* ---- state -------------------------------------------------------------------------------------------- */

static void make_state_odd(void)
{
    void (*gen_textures)(int, uint32_t *) = (void (*)(int, uint32_t *))(uintptr_t)proc("glGenTextures");
    void (*active)(unsigned) = (void (*)(unsigned))(uintptr_t)proc("glActiveTexture");
    void (*bind_texture)(unsigned, uint32_t) = (void (*)(unsigned, uint32_t))(uintptr_t)proc("glBindTexture");
    void (*store)(unsigned, int) = (void (*)(unsigned, int))(uintptr_t)proc("glPixelStorei");
    void (*viewport)(int, int, int, int) = (void (*)(int, int, int, int))(uintptr_t)proc("glViewport");
    void (*clear_color)(float, float, float, float) =
        (void (*)(float, float, float, float))(uintptr_t)proc("glClearColor");
    void (*clear_depth)(float) = (void (*)(float))(uintptr_t)proc("glClearDepthf");
    void (*depth_func)(unsigned) = (void (*)(unsigned))(uintptr_t)proc("glDepthFunc");
    void (*pointer)(unsigned, int, unsigned, uint8_t, int, const void *) =
        (void (*)(unsigned, int, unsigned, uint8_t, int, const void *))(uintptr_t)proc("glVertexAttribPointer");
    void (*bind_buffer)(unsigned, uint32_t) = (void (*)(unsigned, uint32_t))(uintptr_t)proc("glBindBuffer");
    static uint32_t texture[8];
    const host_mesh mesh = upload_floats();
    gen_textures(8, texture);
    for (unsigned u = 0; u < 8; u++) {
        active(0x84C0 + u);
        bind_texture(0x0DE1, texture[u]);
    }
    active(0x84C0 + 6);
    bind_buffer(0x8892, mesh.vertex);
    pointer(0, 3, 0x1406, 0, 48, (const void *)24);
    pointer(1, 2, 0x1402, 1, 48, (const void *)4);
    bind_buffer(0x8893, mesh.index);
    store(0x0CF5, 2);
    viewport(3, 5, 40, 44);
    clear_color(0.25f, 0.5f, 0.75f, 1);
    clear_depth(0.5f);
    depth_func(0x0203); /* GL_LEQUAL */
    gl_enable(0x0BE2);
    gl_enable(0x0C11);
}

static void state_is_put_back(void **state)
{
    (void)state;
    for (int d = 0; d < DRIVERS; d++)
        for (int lean = 0; lean < 2; lean++) /* without vertex arrays too */
            for (int lights = 1; lights <= 7; lights += 6) {
                long before[FAKE_GL_STATES], after[FAKE_GL_STATES];
                kit_world w;
                if (!open_driver(d, &(fake_gl_options){.fragment_vectors = 16, .no_optional = lean})) break;
                make_state_odd();
                const int count = fake_gl_snapshot(before);
                begin(&w, NULL);
                const nacre_gles_item item = add(&w, KIT_FINE, 1);
                const nacre_view view = kit_view(lights, lights > 1, 1);
                for (int i = 0; i < 2; i++) assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
                assert_int_equal(fake_gl_draws() > 2, lights == 7); /* in passes */
                if (nacre_gles_bind(w.gles, item, &view, NULL) == NACRE_OK) nacre_gles_unbind(w.gles);
                assert_int_equal(gl_error(), 0);
                nacre_gles_shutdown(w.gles);
                assert_int_equal(fake_gl_snapshot(after), count);
                for (int i = 0; i < count; i++)
                    if (before[i] != after[i])
                        fail_msg("%s, %d lights: %s was %ld, is %ld", drivers_here[d].name, lights,
                                 fake_gl_state_name(i), before[i], after[i]);
                assert_true(kit_world_free(&w));
                gl_headless_close(context);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_equal_one_pass),      cmocka_unit_test(lobes_in_passes),
        cmocka_unit_test(passes_know_reversed_depth), cmocka_unit_test(passes_have_their_limits),
        cmocka_unit_test(callers_buffers_equal_mesh), cmocka_unit_test(wide_indices_equal_short_ones),
        cmocka_unit_test(options_do_not_show),        cmocka_unit_test(state_is_put_back),
    };
    int failed;
    kit_open(&assets);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    kit_close(&assets);
    return failed;
}
