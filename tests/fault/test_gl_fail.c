/* SPDX-License-Identifier: MIT */
/*
 * Every GL call of a session fails once, each in a run of its own. The call that sees it must say NACRE_ERR_GL, leave no
 * object, no state and no half-made item, and do its work when it is asked again.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "gles_kit.h"

#include <cmocka.h>

static kit assets;

/* What a run does. */
typedef struct session {
    fake_gl_options gl;
    nacre_gles_desc desc;
    kit_model model;
    int normal, lights, points, perspective, prepare;
    int lit;    /* 1: by a lit sphere */
    int budget; /* of its updates */
} session;

/* The state of a run: each step may be repeated. */
typedef struct run {
    kit_world w;
    nacre_gles_item item;
    nacre_gles_lit lit;
    nacre_view view;
    int orphans; /* what abandon left, because there is no new context here */
} run;

typedef nacre_result (*step)(run *r, const session *s);

static nacre_result step_init(run *r, const session *s)
{
    (void)s;
    return kit_world_init(&r->w);
}

static nacre_result step_add(run *r, const session *s)
{
    const nacre_material m = kit_material(&assets, s->model, s->normal);
    return nacre_gles_add(r->w.gles, &assets.ball, &m, &r->item);
}

static nacre_result step_lit_add(run *r, const session *s)
{
    const nacre_material m = kit_material(&assets, s->model, 0);
    const nacre_gles_lit none = {0};
    nacre_result result;
    if (!s->lit) return NACRE_OK;
    result = nacre_gles_lit_add(r->w.gles, &m, &(nacre_gles_lit_desc){.size = 16}, &r->lit);
    return result ? result : nacre_gles_use_lit(r->w.gles, r->item, r->lit, none);
}

/* Until the picture is there. */
static nacre_result step_update(run *r, const session *s)
{
    nacre_gles_lit_state state = {0};
    nacre_result result = NACRE_OK;
    while (s->lit && !result && !state.current) {
        result = nacre_gles_lit_update(r->w.gles, r->lit, NULL, &r->view, (unsigned)s->budget);
        nacre_gles_lit_get_state(r->w.gles, r->lit, &state);
    }
    return result;
}

static nacre_result step_prepare(run *r, const session *s)
{
    return s->prepare ? nacre_gles_prepare(r->w.gles, r->item, &r->view) : NACRE_OK;
}

static nacre_result step_draw(run *r, const session *s)
{
    (void)s;
    return nacre_gles_draw(r->w.gles, r->item, &r->view);
}

static nacre_result step_bind(run *r, const session *s)
{
    (void)s;
    const nacre_result result = nacre_gles_bind(r->w.gles, r->item, &r->view, NULL);
    nacre_gles_unbind(r->w.gles);
    return result == NACRE_ERR_UNSUPPORTED ? NACRE_OK : result; /* more than one pass */
}

static nacre_result step_restore(run *r, const session *s)
{
    (void)s;
    r->orphans = fake_gl_live();
    nacre_gles_abandon(r->w.gles);
    return nacre_gles_restore(r->w.gles);
}

static nacre_result step_update_again(run *r, const session *s)
{
    return step_update(r, s);
}

static nacre_result step_draw_again(run *r, const session *s)
{
    return step_draw(r, s);
}

static const struct {
    const char *name;
    step run;
    int may_pass; /* a failed uniform or draw call is GL's own affair: drawing asks no errors, compiling drops them */
    int keeps;    /* programs and targets stay, so more objects may live than before */
} steps[] = {
    {"init", step_init, 0, 0},
    {"add", step_add, 0, 0},
    {"lit add", step_lit_add, 0, 0},
    {"update", step_update, 1, 1},
    {"prepare", step_prepare, 0, 1},
    {"draw", step_draw, 1, 1},
    {"bind", step_bind, 1, 1},
    {"restore", step_restore, 0, 0},
    {"update again", step_update_again, 1, 1},
    {"draw again", step_draw_again, 1, 1},
};

static void assert_same_state(const long *before, int count, long n, const char *where)
{
    long after[FAKE_GL_STATES];
    assert_int_equal(fake_gl_snapshot(after), count);
    for (int i = 0; i < count; i++)
        if (before[i] != after[i])
            fail_msg("call %ld (%s), %s: %s was %ld, is %ld", n, fake_gl_failed_name(), where, fake_gl_state_name(i),
                     before[i], after[i]);
}

/* All steps with the n-th call failing; 1 when there was such a call. */
static int run_session(const session *s, long n)
{
    run r;
    long before[FAKE_GL_STATES];
    int seen = 0;
    fake_gl_start(&s->gl);
    memset(&r, 0, sizeof r);
    kit_world_make(&r.w, &s->desc);
    r.view = kit_view(s->lights, s->points, s->perspective);
    r.view.ambient = nacre_rgb_from_float(0.1f, 0.1f, 0.1f);
    r.item.id = r.lit.id = 0;
    const int count = fake_gl_snapshot(before);
    fake_gl_fail(n);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        const int live = fake_gl_live();
        nacre_result result = steps[i].run(&r, s);
        const int hit = fake_gl_failed() && !seen;
        if (hit) {
            seen = 1;
            const char *name = fake_gl_failed_name();
            if (result != NACRE_ERR_GL && !(steps[i].may_pass && result == NACRE_OK))
                fail_msg("call %ld (%s) failed in %s, which said %d\n%s", n, name, steps[i].name, (int)result, r.w.log);
            if (result && !steps[i].keeps && fake_gl_live() != live)
                fail_msg("call %ld (%s), %s: %d objects left", n, name, steps[i].name, fake_gl_live() - live);
            if (result && steps[i].run == step_init) assert_null(r.w.gles);
            if (result && steps[i].run == step_add) assert_int_equal(r.item.id, 0);
            if (result && steps[i].run == step_lit_add) assert_int_equal(r.lit.id, 0);
            assert_same_state(before, count, n, steps[i].name);
            if (result) result = steps[i].run(&r, s);
        }
        if (result)
            fail_msg("call %ld (%s): %s said %d\n%s", n, fake_gl_failed_name(), steps[i].name, (int)result, r.w.log);
        assert_same_state(before, count, n, steps[i].name);
        if (!r.orphans && fake_gl_texture_bytes() != nacre_gles_texture_bytes(r.w.gles))
            fail_msg("call %ld (%s): %s: %u bytes of textures, said to be %u", n, fake_gl_failed_name(), steps[i].name,
                     (unsigned)fake_gl_texture_bytes(), (unsigned)nacre_gles_texture_bytes(r.w.gles));
    }
    nacre_gles_shutdown(r.w.gles);
    assert_int_equal(fake_gl_live(), r.orphans);
    assert_same_state(before, count, n, "shutdown");
    assert_true(kit_world_free(&r.w));
    return fake_gl_calls() >= n;
}

static void run_all(const session *s, const char *what)
{
    long n = 0, failed = 0;
    run_session(s, 0); /* nothing fails */
    do {
        n++;
        failed += fake_gl_failed();
    } while (run_session(s, n));
    print_message("%s: %ld calls, %ld of them can fail\n", what, n - 1, failed);
    assert_in_range(failed, 30, n);
}

static void on_fake_es2(void **state)
{
    (void)state;
    run_all(&(session){.model = KIT_SPHERES, .normal = 1, .lights = 1, .prepare = 1}, "ES 2.0, spheres, 1 light");
}

static void on_fake_es2_unprepared(void **state)
{
    (void)state;
    run_all(&(session){.model = KIT_FINE, .lights = 2, .points = 1, .perspective = 1}, "ES 2.0, fine table, 2 lights");
    run_all(&(session){.model = KIT_EARLY, .lights = 1}, "ES 2.0, fine table of an early file");
}

static void on_fake_es3(void **state)
{
    (void)state;
    run_all(&(session){.gl = {.es = 3}, .model = KIT_TABLE, .normal = 1, .lights = 1, .prepare = 1}, "ES 3.0, table");
}

static void passes_on_fake(void **state)
{
    (void)state;
    run_all(&(session){.model = KIT_SPHERES, .lights = 7, .desc = {.max_programs = 12}, .prepare = 1},
            "ES 2.0, 7 lights in passes");
    run_all(&(session){.gl = {.es = 3}, .model = KIT_SPHERES, .lights = 8, .desc = {.max_programs = 2}},
            "ES 3.0, 8 lights in passes, 2 programs");
}

static void maps_on_fake(void **state)
{
    (void)state;
    run_all(&(session){.model = KIT_SBRDF, .lights = 1, .desc = {.power = NACRE_GLES_POWER_TABLE}, .prepare = 1},
            "ES 2.0, maps of lobes");
    run_all(&(session){.gl = {.es = 3}, .model = KIT_SBRDF, .normal = 1, .lights = 2, .points = 1, .perspective = 1},
            "ES 3.0, maps of lobes and normals, 2 lights");
    run_all(&(session){.model = KIT_SBRDF, .lights = 7, .desc = {.power = NACRE_GLES_POWER_TABLE, .max_programs = 3}},
            "ES 2.0, maps of lobes, 7 lights in passes");
}

static void palettes_on_fake(void **state)
{
    (void)state;
    run_all(&(session){.model = KIT_PALETTE, .normal = 1, .lights = 1, .prepare = 1}, "ES 2.0, palette");
    run_all(&(session){.gl = {.es = 3}, .model = KIT_BLEND, .lights = 2, .points = 1, .perspective = 1},
            "ES 3.0, blended palette, 2 lights");
    run_all(&(session){.model = KIT_BLEND, .lights = 7, .desc = {.max_programs = 3}},
            "ES 2.0, blended palette, 7 lights in passes");
}

static void lit_on_fake(void **state)
{
    (void)state;
    run_all(&(session){.model = KIT_TABLE, .lights = 2, .lit = 1}, "ES 2.0, lit sphere, 2 lights");
    run_all(&(session){.model = KIT_SPHERES, .lights = 7, .perspective = 1, .lit = 1, .budget = 2},
            "ES 2.0, lit sphere, 7 lights in passes, spread");
    run_all(&(session){.gl = {.es = 3}, .model = KIT_SPHERES, .lights = 8, .lit = 1, .desc = {.max_programs = 2}},
            "ES 3.0, lit sphere, 8 lights in passes, 2 programs");
}

/* The same around drivers, where a skipped call has consequences. */
static void on_driver(gl_backend backend, const char *what)
{
    gl_headless *context;
    if (!kit_context(&context, backend, 16, 16)) {
        print_message("%s: not on this machine\n", what);
        skip();
    }
    run_all(&(session){.gl = {.real = gl_headless_proc}, .model = KIT_TABLE, .lights = 1, .prepare = 1}, what);
    run_all(&(session){.gl = {.real = gl_headless_proc}, .model = KIT_SPHERES, .lights = 7, .lit = 1}, what);
    run_all(&(session){.gl = {.real = gl_headless_proc}, .model = KIT_SBRDF, .lights = 1}, what);
    run_all(&(session){.gl = {.real = gl_headless_proc}, .model = KIT_BLEND, .lights = 1}, what);
    gl_headless_close(context);
}

static void on_egl2(void **state)
{
    (void)state;
    on_driver(GL_BACKEND_EGL2, "EGL, GLES 2");
}

static void on_osmesa(void **state)
{
    (void)state;
    on_driver(GL_BACKEND_OSMESA, "OSMesa");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_fake_es2),  cmocka_unit_test(on_fake_es2_unprepared),
        cmocka_unit_test(on_fake_es3),  cmocka_unit_test(passes_on_fake),
        cmocka_unit_test(maps_on_fake), cmocka_unit_test(palettes_on_fake),
        cmocka_unit_test(lit_on_fake),  cmocka_unit_test(on_egl2),
        cmocka_unit_test(on_osmesa),
    };
    int failed;
    kit_open(&assets);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    kit_close(&assets);
    return failed;
}
