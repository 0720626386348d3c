/* SPDX-License-Identifier: MIT */
/* Lit spheres without a GPU: results, budgets, what makes an update, GL state, falling back to direct shading. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "gles_kit.h"

#include <cmocka.h> /* last: it makes a macro of fail */

enum { MANY = 20 };

static kit assets;
static nacre_light lights[NACRE_MAX_LIT_LIGHTS + 1];

/* Directional lights, no two alike. */
static nacre_view many_lights(int count, int perspective)
{
    nacre_view view = kit_view(1, 0, perspective);
    for (int i = 0; i < count; i++) {
        lights[i] = view.lights[0];
        lights[i].direction.x = (nacre_q14)(100 * i);
        lights[i].power.g = 65536 + 7 * i;
    }
    view.lights = lights;
    view.light_count = (uint16_t)count;
    return view;
}

typedef struct world {
    kit_world w;
    nacre_gles *gles;
    nacre_gles_item item;
    nacre_gles_lit lit;
} world;

/* An object, an item, a lit sphere of its material, used by it. */
static void open_world(world *w, const fake_gl_options *options, const nacre_gles_desc *desc)
{
    const fake_gl_options es2 = {0};
    const nacre_material m = kit_material(&assets, KIT_TABLE, 0);
    const nacre_gles_lit_desc small = {.size = 64};
    const nacre_gles_lit none = {0};
    memset(w, 0, sizeof *w);
    fake_gl_start(options ? options : &es2);
    kit_world_make(&w->w, desc);
    assert_int_equal(kit_world_init(&w->w), NACRE_OK);
    w->gles = w->w.gles;
    assert_int_equal(nacre_gles_add(w->gles, &assets.ball, &m, &w->item), NACRE_OK);
    assert_int_equal(nacre_gles_lit_add(w->gles, &m, &small, &w->lit), NACRE_OK);
    assert_int_equal(nacre_gles_use_lit(w->gles, w->item, w->lit, none), NACRE_OK);
}

static void close_world(world *w)
{
    assert_int_equal(fake_gl_texture_bytes(), nacre_gles_texture_bytes(w->gles));
    nacre_gles_shutdown(w->gles);
    assert_int_equal(fake_gl_live(), 0);
    assert_int_equal(fake_gl_texture_bytes(), 0);
    assert_int_equal(fake_gl_pending_error(), 0);
    assert_true(kit_world_free(&w->w));
}

static nacre_gles_lit_state state_of(const world *w)
{
    nacre_gles_lit_state s;
    memset(&s, 0xFF, sizeof s);
    nacre_gles_lit_get_state(w->gles, w->lit, &s);
    return s;
}

/* The program that draws the item: tells lit from direct. */
static uint32_t program_of(world *w, const nacre_view *view)
{
    uint32_t program = 0;
    assert_int_equal(nacre_gles_bind(w->gles, w->item, view, &program), NACRE_OK);
    assert_int_equal(nacre_gles_unbind(w->gles), NACRE_OK);
    return program;
}

/* ---- adding ---------------------------------------------------------------------------------- */

static void add_checks_and_counts(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, &(nacre_gles_desc){.max_items = 4});
    const nacre_material m = kit_material(&assets, KIT_TABLE, 1), nothing = {0};
    nacre_gles_lit lit = {0};
    const uint16_t wrong[] = {1, 15, 513, 65535};
    assert_int_equal(nacre_gles_lit_add(NULL, &m, NULL, &lit), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_add(w.gles, NULL, NULL, &lit), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, NULL, NULL), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_add(w.gles, &nothing, NULL, &lit), NACRE_ERR_ARGUMENT);
    for (int i = 0; i < 4; i++)
        assert_int_equal(nacre_gles_lit_add(w.gles, &m, &(nacre_gles_lit_desc){.size = wrong[i]}, &lit),
                         NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, &(nacre_gles_lit_desc){.rgb565 = 2}, &lit), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, &(nacre_gles_lit_desc){.view_tolerance = 16384}, &lit),
                     NACRE_ERR_ARGUMENT);
    assert_int_equal(lit.id, 0);

    uint32_t before = nacre_gles_texture_bytes(w.gles);
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, NULL, &lit), NACRE_OK);
    assert_int_equal(nacre_gles_texture_bytes(w.gles) - before, 128 * 128 * 4); /* table shared, no normal map */
    before = nacre_gles_texture_bytes(w.gles);
    nacre_gles_lit half;
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, &(nacre_gles_lit_desc){.size = 96, .rgb565 = 1}, &half), NACRE_OK);
    assert_int_equal(nacre_gles_texture_bytes(w.gles) - before, 96 * 96 * 2);
    assert_int_equal(fake_gl_texture_bytes(), nacre_gles_texture_bytes(w.gles));
    nacre_gles_lit fifth = {0};
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, NULL, &fifth), NACRE_ERR_BUDGET); /* max_items */
    assert_int_equal(fifth.id, 0);
    nacre_gles_lit_remove(w.gles, half);
    nacre_gles_lit_remove(w.gles, half);
    nacre_gles_lit_remove(w.gles, (nacre_gles_lit){12345});
    assert_int_equal(nacre_gles_texture_bytes(w.gles), before);
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, NULL, &fifth), NACRE_OK);
    close_world(&w);
}

static void ids_are_of_one_kind(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    const nacre_view view = kit_view(1, 0, 0);
    const nacre_gles_item as_item = {w.lit.id};
    const nacre_gles_lit as_lit = {w.item.id}, none = {0};
    assert_int_equal(nacre_gles_draw(w.gles, as_item, &view), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_bind(w.gles, as_item, &view, NULL), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_prepare(w.gles, as_item, &view), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_use_lit(w.gles, as_item, w.lit, none), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_use_lit(w.gles, w.item, as_lit, none), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_use_lit(w.gles, w.item, w.lit, as_lit), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_use_lit(NULL, w.item, w.lit, none), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_update(w.gles, as_lit, NULL, &view, 0), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_update(w.gles, none, NULL, &view, 0), NACRE_ERR_ARGUMENT);
    nacre_gles_lit_remove(w.gles, as_lit);
    assert_int_equal(nacre_gles_draw(w.gles, w.item, &view), NACRE_OK);
    nacre_gles_lit_state s;
    nacre_gles_lit_get_state(w.gles, as_lit, &s);
    assert_int_equal(s.ready | s.current | s.lights_done | s.pictures, 0);
    close_world(&w);
}

/* ---- updating --------------------------------------------------------------------------------- */

static void refuses_what_it_cannot_light(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    nacre_view view = kit_view(2, 1, 0);
    const long calls = fake_gl_calls();
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 0), NACRE_ERR_UNSUPPORTED);
    view = many_lights(NACRE_MAX_LIT_LIGHTS + 1, 0);
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 0), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, NULL, 0), NACRE_ERR_ARGUMENT);
    assert_int_equal(nacre_gles_lit_update(NULL, w.lit, NULL, &view, 0), NACRE_ERR_ARGUMENT);
    assert_int_equal(fake_gl_calls(), calls);
    assert_int_equal(state_of(&w).ready, 0);
    view.light_count--;
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 0), NACRE_OK);
    assert_int_equal(state_of(&w).ready, 1);
    close_world(&w);
}

/* 1 when a call with this view made a new picture; 0: it did not touch GL. */
static int makes_a_picture(world *w, const nacre_q16 centre[3], const nacre_view *view)
{
    const uint32_t pictures = state_of(w).pictures;
    const long calls = fake_gl_calls();
    assert_int_equal(nacre_gles_lit_update(w->gles, w->lit, centre, view, 0), NACRE_OK);
    assert_int_equal(state_of(w).ready, 1);
    assert_int_equal(state_of(w).current, 1);
    if (state_of(w).pictures != pictures) return 1;
    assert_int_equal(fake_gl_calls(), calls);
    return 0;
}

static void only_changes_are_drawn(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    nacre_view view = many_lights(3, 0);
    assert_true(makes_a_picture(&w, NULL, &view));
    assert_false(makes_a_picture(&w, NULL, &view));
#define CHANGES(change)                                                                                                \
    do {                                                                                                               \
        change;                                                                                                        \
        if (!makes_a_picture(&w, NULL, &view)) fail_msg("no new picture after " #change);                              \
        assert_false(makes_a_picture(&w, NULL, &view));                                                                \
    } while (0)
    CHANGES(lights[1].direction.x++);
    CHANGES(lights[2].direction.y--);
    CHANGES(lights[0].direction.z -= 5);
    CHANGES(lights[2].power.r++);
    CHANGES(lights[2].power.g++);
    CHANGES(lights[2].power.b++);
    CHANGES(lights[0].shadow = 1);
    CHANGES(view.light_count = 2);
    CHANGES(view.exposure = 70000);
    CHANGES(view.ambient.b = 1);
    CHANGES(view.tint.r = 65536);
    CHANGES(view.output = NACRE_OUTPUT_LINEAR);
#undef CHANGES
    /* what does not matter: camera and place of an object under an orthographic camera */
    view.object_to_view.m[12] += 65536;
    view.view_to_clip.m[0] /= 2;
    lights[0].position[0] = 5;
    assert_false(makes_a_picture(&w, NULL, &view));
    close_world(&w);
}

static void view_direction_has_a_tolerance(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    nacre_view view = many_lights(2, 1);
    nacre_q16 centre[3] = {0, 0, 0};
    for (int i = 0; i < 16; i++) view.object_to_view.m[i] = i % 5 ? 0 : NACRE_Q16_ONE;
    view.object_to_view.m[14] = -100 * NACRE_Q16_ONE;
    assert_true(makes_a_picture(&w, centre, &view));
    centre[0] = 36700; /* .56 of 100: .32 degrees; the tolerance is .3516 */
    assert_false(makes_a_picture(&w, centre, &view));
    centre[0] = 42600; /* .65: .37 degrees */
    assert_true(makes_a_picture(&w, centre, &view));
    centre[0] = 0; /* .37 degrees back */
    assert_true(makes_a_picture(&w, centre, &view));
    view.object_to_view.m[14] *= 3; /* straight away: the same direction */
    assert_false(makes_a_picture(&w, centre, &view));
    close_world(&w);
}

/* ---- spreading -------------------------------------------------------------------------------- */

static void budgets_spread_updates(void **state)
{
    (void)state;
    for (int es = 2; es <= 3; es++) {
        world w;
        open_world(&w, &(fake_gl_options){.es = es, .fragment_vectors = 64}, NULL);
        nacre_view view = many_lights(MANY, 0);
        const int passes = es == 2 ? 2 : 1; /* draws for both bytes of a sum */
        int draws = fake_gl_draws();
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 8), NACRE_OK);
        assert_int_equal(fake_gl_draws() - draws, passes);
        assert_int_equal(state_of(&w).ready, 0);
        assert_int_equal(state_of(&w).lights_done, 8);
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 3), NACRE_OK); /* rounded up to 8 */
        assert_int_equal(state_of(&w).lights_done, 16);
        draws = fake_gl_draws();
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 8), NACRE_OK); /* 4, and the last pass */
        assert_int_equal(fake_gl_draws() - draws, passes + 1);
        assert_int_equal(state_of(&w).ready, 1);
        assert_int_equal(state_of(&w).current, 1);
        assert_int_equal(state_of(&w).lights_done, 0);

        /* lights that move meanwhile: the old picture serves, the new one is made all the same, and then once more */
        for (int i = 0; i < 3; i++) {
            lights[i].direction.y = 300;
            assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 8), NACRE_OK);
            assert_int_equal(state_of(&w).ready, 1);
            assert_int_equal(state_of(&w).current, 0);
        }
        assert_int_equal(state_of(&w).pictures, 2);
        for (int i = 0; i < 3; i++) assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 8), NACRE_OK);
        assert_int_equal(state_of(&w).pictures, 3);
        assert_int_equal(state_of(&w).current, 1);
        assert_false(makes_a_picture(&w, NULL, &view));

        /* without a budget: at once, from the start */
        lights[5].direction.y = 900;
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 8), NACRE_OK);
        lights[6].direction.y = 900;
        assert_true(makes_a_picture(&w, NULL, &view));
        close_world(&w);
    }
}

/* Two spheres under way do not disturb each other. */
static void updates_take_turns(void **state)
{
    (void)state;
    world w;
    open_world(&w, &(fake_gl_options){.fragment_vectors = 64}, NULL);
    const nacre_material m = kit_material(&assets, KIT_SPHERES, 0);
    const nacre_view view = many_lights(MANY, 0);
    const nacre_gles_lit first = w.lit;
    nacre_gles_lit other;
    nacre_gles_lit_state s;
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, &(nacre_gles_lit_desc){.size = 32}, &other), NACRE_OK);
    for (int i = 0; i < 5; i++) { /* spheres hold 4 lights a pass: 5 calls; the table needs 3 */
        assert_int_equal(nacre_gles_lit_update(w.gles, first, NULL, &view, 8), NACRE_OK);
        assert_int_equal(nacre_gles_lit_update(w.gles, other, NULL, &view, 4), NACRE_OK);
        assert_int_equal(state_of(&w).ready, i >= 2);
        nacre_gles_lit_get_state(w.gles, other, &s);
        assert_int_equal(s.ready, i == 4);
        assert_int_equal(fake_gl_texture_bytes(), nacre_gles_texture_bytes(w.gles));
    }
    nacre_gles_lit_remove(w.gles, other);
    close_world(&w);
}

/* ---- GL state --------------------------------------------------------------------------------- */

static void updates_put_state_back(void **state)
{
    (void)state;
    for (int es = 2; es <= 3; es++)
        for (int count = 1; count <= MANY; count += MANY - 1)
            for (int budget = 0; budget <= 8; budget += 8) {
                world w;
                long before[FAKE_GL_STATES], after[FAKE_GL_STATES];
                open_world(&w, &(fake_gl_options){.es = es}, NULL);
                const nacre_view view = many_lights(count, 1);
                kit_hostile_state(es);
                const int states = fake_gl_snapshot(before);
                for (int i = 0; i < 4; i++) {
                    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, (unsigned)budget), NACRE_OK);
                    assert_int_equal(nacre_gles_draw(w.gles, w.item, &view), NACRE_OK);
                    fake_gl_snapshot(after);
                    for (int k = 0; k < states; k++)
                        if (before[k] != after[k])
                            fail_msg("ES %d, %d lights, call %d: %s was %ld, is %ld", es, count, i,
                                     fake_gl_state_name(k), before[k], after[k]);
                }
                assert_int_equal(fake_gl_pending_error(), 0);
                nacre_gles_shutdown(w.gles);
                assert_true(kit_world_free(&w.w));
            }
}

/* ---- falling back -------------------------------------------------------------------------------- */

static void falls_back_to_direct_shading(void **state)
{
    (void)state;
    world w;
    open_world(&w, NULL, NULL);
    nacre_view view = kit_view(2, 0, 0), other = view;
    const uint32_t direct = program_of(&w, &view); /* no picture yet */
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 0), NACRE_OK);
    assert_int_not_equal(program_of(&w, &view), direct);
    other.output = NACRE_OUTPUT_SQRT; /* the picture holds sRGB */
    const uint32_t root = program_of(&w, &other);
    assert_int_not_equal(root, direct);
    nacre_gles_use_lit(w.gles, w.item, (nacre_gles_lit){0}, w.lit);
    assert_int_equal(program_of(&w, &view), direct);
    assert_int_equal(program_of(&w, &other), root);
    nacre_gles_use_lit(w.gles, w.item, w.lit, w.lit); /* two without a mask: the first */
    assert_int_not_equal(program_of(&w, &view), direct);
    nacre_gles_lit_remove(w.gles, w.lit);
    assert_int_equal(program_of(&w, &view), direct);
    close_world(&w);
}

/* A budget that holds the picture, but not the sums of passes. */
static void a_budget_is_kept(void **state)
{
    (void)state;
    world w;
    const uint32_t table = 24 * 21 * 4, picture = 64 * 64 * 4;
    open_world(&w, NULL, &(nacre_gles_desc){.texture_budget = table + picture + 8 * 64 * 64});
    const nacre_view one = kit_view(1, 0, 0), many = many_lights(MANY, 0);
    const uint32_t direct = program_of(&w, &one);
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &one, 0), NACRE_OK);
    assert_int_not_equal(program_of(&w, &one), direct);
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &many, 0), NACRE_ERR_BUDGET);
    assert_int_equal(state_of(&w).ready, 0);
    assert_int_equal(program_of(&w, &one), direct);
    assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &one, 0), NACRE_OK);
    assert_int_not_equal(program_of(&w, &one), direct);
    close_world(&w);
}

static void incomplete_framebuffers_are_told(void **state)
{
    (void)state;
    const fake_gl_options o = {.incomplete = 1};
    const nacre_material m = kit_material(&assets, KIT_TABLE, 0);
    const nacre_view view = kit_view(1, 0, 0);
    kit_world w;
    nacre_gles_item item;
    nacre_gles_lit lit = {0};
    fake_gl_start(&o);
    kit_world_make(&w, NULL);
    assert_int_equal(kit_world_init(&w), NACRE_OK);
    assert_int_equal(nacre_gles_add(w.gles, &assets.ball, &m, &item), NACRE_OK);
    const int live = fake_gl_live();
    const uint32_t bytes = nacre_gles_texture_bytes(w.gles);
    assert_int_equal(nacre_gles_lit_add(w.gles, &m, NULL, &lit), NACRE_ERR_GL);
    assert_int_equal(lit.id, 0);
    assert_int_equal(fake_gl_live(), live);
    assert_int_equal(nacre_gles_texture_bytes(w.gles), bytes);
    assert_int_equal(nacre_gles_draw(w.gles, item, &view), NACRE_OK);
    nacre_gles_shutdown(w.gles);
    assert_int_equal(fake_gl_live(), 0);
    assert_true(kit_world_free(&w));
}

/* ---- lost contexts ---------------------------------------------------------------------------------- */

static void comes_back_after_a_loss(void **state)
{
    (void)state;
    for (int spread = 0; spread < 2; spread++) {
        world w;
        open_world(&w, NULL, NULL);
        const nacre_view view = many_lights(MANY, 0), few = kit_view(2, 0, 0);
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, spread ? 4 : 0), NACRE_OK);
        nacre_gles_abandon(w.gles);
        const long calls = fake_gl_calls();
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 0), NACRE_ERR_LOST);
        nacre_gles_lit_state s;
        nacre_gles_lit_get_state(w.gles, w.lit, &s);
        assert_int_equal(s.ready, 0);
        assert_int_equal(fake_gl_calls(), calls);
        fake_gl_new_context();
        assert_int_equal(nacre_gles_restore(w.gles), NACRE_OK);
        const uint32_t direct = program_of(&w, &few);
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &few, 0), NACRE_OK);
        assert_int_not_equal(program_of(&w, &few), direct);
        assert_int_equal(nacre_gles_lit_update(w.gles, w.lit, NULL, &view, 0), NACRE_OK);
        assert_int_equal(state_of(&w).current, 1);
        close_world(&w);
    }
}

static int open_assets(void **state)
{
    (void)state;
    kit_open(&assets);
    return 0;
}

static int close_assets(void **state)
{
    (void)state;
    kit_close(&assets);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(add_checks_and_counts),
        cmocka_unit_test(ids_are_of_one_kind),
        cmocka_unit_test(refuses_what_it_cannot_light),
        cmocka_unit_test(only_changes_are_drawn),
        cmocka_unit_test(view_direction_has_a_tolerance),
        cmocka_unit_test(budgets_spread_updates),
        cmocka_unit_test(updates_take_turns),
        cmocka_unit_test(updates_put_state_back),
        cmocka_unit_test(falls_back_to_direct_shading),
        cmocka_unit_test(a_budget_is_kept),
        cmocka_unit_test(incomplete_framebuffers_are_told),
        cmocka_unit_test(comes_back_after_a_loss),
    };
    return cmocka_run_group_tests(tests, open_assets, close_assets);
}
