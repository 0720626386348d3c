/* SPDX-License-Identifier: MIT */
/*
 * The context is lost at every GL call of a session in turn. Whoever notices says NACRE_ERR_LOST; after that no call of
 * nacre reaches GL until the application has abandoned, made a new context and restored; then the picture is the same.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "gles_kit.h"

#include <cmocka.h>

#define SIZE 32

static kit assets;

typedef struct session {
    fake_gl_options gl;
    kit_model model;
    int normal, lights;
    int lit; /* 1: by a lit sphere, updated 4 lights a call */
} session;

typedef struct run {
    kit_world w;
    nacre_gles_item item;
    nacre_gles_lit lit;
    nacre_view view;
} run;

static nacre_result add_item(run *r, const session *s)
{
    const nacre_material m = kit_material(&assets, s->model, s->normal);
    return nacre_gles_add(r->w.gles, &assets.ball, &m, &r->item);
}

static nacre_result add_lit(run *r, const session *s)
{
    const nacre_material m = kit_material(&assets, s->model, 0);
    const nacre_gles_lit none = {0};
    const nacre_result result =
        r->lit.id ? NACRE_OK : nacre_gles_lit_add(r->w.gles, &m, &(nacre_gles_lit_desc){.size = 16}, &r->lit);
    return result ? result : nacre_gles_use_lit(r->w.gles, r->item, r->lit, none);
}

static nacre_result update_lit(run *r)
{
    nacre_gles_lit_state state = {0};
    nacre_result result = NACRE_OK;
    while (!result && !state.current) {
        result = nacre_gles_lit_update(r->w.gles, r->lit, NULL, &r->view, 4);
        nacre_gles_lit_get_state(r->w.gles, r->lit, &state);
        if (result) assert_int_equal(state.ready, 0);
    }
    return result;
}

/* Steps of a session; the first result that is not OK. */
static nacre_result all_steps(run *r, const session *s)
{
    nacre_result result = NACRE_OK;
    if (!r->w.gles) result = kit_world_init(&r->w);
    if (!result && !r->item.id) result = add_item(r, s);
    if (!result && s->lit) result = add_lit(r, s);
    if (!result && s->lit) result = update_lit(r);
    if (!result) result = nacre_gles_prepare(r->w.gles, r->item, &r->view);
    if (!result) result = nacre_gles_draw(r->w.gles, r->item, &r->view);
    if (!result) result = nacre_gles_bind(r->w.gles, r->item, &r->view, NULL);
    if (result == NACRE_ERR_UNSUPPORTED) result = NACRE_OK; /* in passes */
    if (!result) result = nacre_gles_unbind(r->w.gles);
    return result;
}

/* Nothing reaches GL any more: not from a known loss, not after abandon. */
static void assert_silent(run *r, const session *s, int known)
{
    const nacre_material m = kit_material(&assets, s->model, s->normal);
    nacre_gles_item other = {0};
    const long calls = fake_gl_calls();
    if (!known) nacre_gles_abandon(r->w.gles);
    assert_int_equal(nacre_gles_add(r->w.gles, &assets.ball, &m, &other), NACRE_ERR_LOST);
    assert_int_equal(other.id, 0);
    if (r->item.id) {
        assert_int_equal(nacre_gles_draw(r->w.gles, r->item, &r->view), NACRE_ERR_LOST);
        assert_int_equal(nacre_gles_prepare(r->w.gles, r->item, &r->view), NACRE_ERR_LOST);
    }
    if (r->lit.id) assert_int_equal(nacre_gles_lit_update(r->w.gles, r->lit, NULL, &r->view, 0), NACRE_ERR_LOST);
    nacre_gles_unbind(r->w.gles);
    if (known) assert_int_equal(nacre_gles_restore(r->w.gles), NACRE_ERR_LOST); /* abandon comes first */
    if (known) nacre_gles_abandon(r->w.gles);
    assert_int_equal(nacre_gles_texture_bytes(r->w.gles), 0);
    assert_int_equal(fake_gl_calls(), calls);
}

static void begin_run(run *r, const session *s)
{
    fake_gl_start(&s->gl);
    memset(r, 0, sizeof *r);
    kit_world_make(&r->w, NULL);
    r->view = kit_view(s->lights, 0, 1);
}

/* Until the loss at call n; abandons. Returns 1 when there was such a call. */
static int until_lost(run *r, const session *s, long n)
{
    begin_run(r, s);
    fake_gl_lose(n);
    const nacre_result result = all_steps(r, s);
    const int reached = fake_gl_calls() >= n;
    if (result && result != NACRE_ERR_LOST) fail_msg("call %ld: said %d\n%s", n, (int)result, r->w.log);
    if (result && !reached) fail_msg("call %ld: lost before it was", n);
    if (r->w.gles) assert_silent(r, s, result != NACRE_OK);
    return reached;
}

static void end_run(run *r)
{
    nacre_gles_shutdown(r->w.gles);
    assert_int_equal(fake_gl_live(), 0);
    assert_true(kit_world_free(&r->w));
}

/* ---- without a GPU ------------------------------------------------------------------------------- */

static void lose_all(const session *s, const char *what)
{
    long n = 1;
    for (int more = 1; more; n++) {
        run r;
        more = until_lost(&r, s, n);
        fake_gl_new_context();
        if (r.w.gles && nacre_gles_restore(r.w.gles) != NACRE_OK) fail_msg("call %ld: restore\n%s", n, r.w.log);
        if (all_steps(&r, s)) fail_msg("call %ld: after restore\n%s", n, r.w.log);
        assert_int_equal(fake_gl_pending_error(), 0);
        assert_int_equal(fake_gl_texture_bytes(), nacre_gles_texture_bytes(r.w.gles));
        end_run(&r);
    }
    print_message("%s: lost at each of %ld calls\n", what, n - 2);
    assert_in_range(n, 100, 100000);
}

static void at_every_call_es2(void **state)
{
    (void)state;
    lose_all(&(session){.model = KIT_SPHERES, .normal = 1, .lights = 1}, "ES 2.0");
    lose_all(&(session){.gl = {.reset_status = 1, .extensions = "GL_KHR_robustness"}, .model = KIT_FINE, .lights = 1},
             "ES 2.0 with a reset status");
}

static void at_every_call_es3(void **state)
{
    (void)state;
    lose_all(&(session){.gl = {.es = 3}, .model = KIT_TABLE, .normal = 1, .lights = 2}, "ES 3.0");
    lose_all(&(session){.gl = {.es = 3}, .model = KIT_EARLY, .lights = 2}, "ES 3.0, fine table of an early file");
}

static void at_every_call_of_passes(void **state)
{
    (void)state;
    lose_all(&(session){.model = KIT_SPHERES, .lights = 7}, "ES 2.0, 7 lights in passes");
}

static void at_every_call_of_maps(void **state)
{
    (void)state;
    lose_all(&(session){.model = KIT_SBRDF, .normal = 1, .lights = 1}, "ES 2.0, maps of lobes");
    lose_all(&(session){.gl = {.es = 3}, .model = KIT_SBRDF, .lights = 2}, "ES 3.0, maps of lobes");
    lose_all(&(session){.model = KIT_SBRDF, .lights = 7}, "ES 2.0, maps of lobes, 7 lights in passes");
}

static void at_every_call_of_palettes(void **state)
{
    (void)state;
    lose_all(&(session){.model = KIT_PALETTE, .normal = 1, .lights = 1}, "ES 2.0, palette");
    lose_all(&(session){.gl = {.es = 3}, .model = KIT_BLEND, .lights = 2}, "ES 3.0, blended palette");
    lose_all(&(session){.model = KIT_BLEND, .lights = 7}, "ES 2.0, blended palette, 7 lights in passes");
}

static void at_every_call_of_updates(void **state)
{
    (void)state;
    lose_all(&(session){.model = KIT_TABLE, .lights = 7, .lit = 1}, "ES 2.0, lit sphere, 7 lights spread");
    lose_all(&(session){.gl = {.es = 3}, .model = KIT_SPHERES, .lights = 8, .lit = 1}, "ES 3.0, lit sphere");
}

/* Losing the context again while restoring. */
static void while_restoring(void **state)
{
    (void)state;
    const session s = {.gl = {.es = 3}, .model = KIT_SPHERES, .normal = 1, .lights = 1};
    for (long n = 1;; n++) {
        run r;
        begin_run(&r, &s);
        assert_int_equal(all_steps(&r, &s), NACRE_OK);
        nacre_gles_abandon(r.w.gles);
        fake_gl_new_context();
        const long before = fake_gl_calls();
        fake_gl_lose(n);
        const nacre_result result = nacre_gles_restore(r.w.gles);
        const int reached = fake_gl_calls() - before >= n;
        assert_true(result == NACRE_ERR_LOST || !reached);
        if (!result) fake_gl_lose(0);
        assert_int_equal(nacre_gles_draw(r.w.gles, r.item, &r.view), result ? NACRE_ERR_LOST : NACRE_OK);
        if (result) {
            fake_gl_new_context();
            assert_int_equal(nacre_gles_restore(r.w.gles), NACRE_OK);
            assert_int_equal(nacre_gles_draw(r.w.gles, r.item, &r.view), NACRE_OK);
        }
        end_run(&r);
        if (!reached) break;
    }
}

/* ---- on drivers, with pictures ------------------------------------------------------------------------ */

static gl_headless *context;

static image_u8 picture(run *r)
{
    image_u8 out;
    gl_headless_clear(context, 0, 0, 0, 0);
    const nacre_result result = nacre_gles_draw(r->w.gles, r->item, &r->view);
    if (result) fail_msg("draw said %d\n%s", (int)result, r->w.log);
    gl_headless_read(context, &out);
    return out;
}

/* A loss at every so-many-th call: each costs a context and a program. */
static void picture_returns(const session *given, int every, gl_backend backend, const char *what)
{
    const session s = *given;
    run r;
    int covered;
    long n = 1;
    if (!kit_context(&context, backend, SIZE, SIZE)) {
        print_message("%s: not on this machine\n", what);
        skip();
    }
    begin_run(&r, &s);
    assert_int_equal(all_steps(&r, &s), NACRE_OK);
    image_u8 first = picture(&r);
    end_run(&r);
    for (int more = 1; more; n += every) {
        more = until_lost(&r, &s, n);
        gl_headless_close(context);
        assert_true(kit_context(&context, backend, SIZE, SIZE));
        fake_gl_new_context();
        if (r.w.gles) assert_int_equal(nacre_gles_restore(r.w.gles), NACRE_OK);
        if (all_steps(&r, &s)) fail_msg("%s, call %ld: after restore\n%s", what, n, r.w.log);
        image_u8 again = picture(&r);
        const int d = kit_difference(&first, &again, &covered);
        if (d) fail_msg("%s, call %ld: the picture differs by %d", what, n, d);
        assert_in_range(covered, SIZE * SIZE / 10, SIZE * SIZE);
        image_u8_free(&again);
        end_run(&r);
    }
    print_message("%s: the same picture after a loss at every %d. of %ld calls\n", what, every, n);
    image_u8_free(&first);
    gl_headless_close(context);
}

static void pictures_return(gl_backend backend, const char *what)
{
    picture_returns(&(session){.gl = {.real = gl_headless_proc}, .model = KIT_TABLE, .lights = 5, .lit = 1}, 3, backend,
                    what);
    picture_returns(&(session){.gl = {.real = gl_headless_proc}, .model = KIT_SBRDF, .normal = 1, .lights = 2}, 9,
                    backend, what);
    picture_returns(&(session){.gl = {.real = gl_headless_proc}, .model = KIT_BLEND, .lights = 2}, 9, backend, what);
}

static void pictures_return_egl2(void **state)
{
    (void)state;
    pictures_return(GL_BACKEND_EGL2, "EGL GLES 2");
}

static void pictures_return_egl3(void **state)
{
    (void)state;
    pictures_return(GL_BACKEND_EGL3, "EGL GLES 3");
}

static void pictures_return_osmesa(void **state)
{
    (void)state;
    pictures_return(GL_BACKEND_OSMESA, "OSMesa");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(at_every_call_es2),         cmocka_unit_test(at_every_call_es3),
        cmocka_unit_test(at_every_call_of_passes),   cmocka_unit_test(at_every_call_of_maps),
        cmocka_unit_test(at_every_call_of_palettes), cmocka_unit_test(at_every_call_of_updates),
        cmocka_unit_test(while_restoring),           cmocka_unit_test(pictures_return_egl2),
        cmocka_unit_test(pictures_return_egl3),      cmocka_unit_test(pictures_return_osmesa),
    };
    int failed;
    kit_open(&assets);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    kit_close(&assets);
    return failed;
}
