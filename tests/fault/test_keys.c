/* SPDX-License-Identifier: MIT */
/*
 * Files and views that are well formed but mean harm: every number of the keys, and of the view, is anything that its
 * type holds. add refuses the file or draw takes it; then each uniform is finite, light factors are in 0..2048 so that
 * fp16 can add eight of them, nothing overflows (the sanitizers see this program), and GL has no error.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "gles_kit.h"
#include "nacre_asset.h"

#include <cmocka.h> /* last: it makes fail a macro */

enum { FILES = 400, VIEWS = 1500 }; /* of each model */

static kit assets;

/* ---- random numbers, the same in every run ----------------------------------------------------- */

static uint32_t random_state;

static uint32_t random_u32(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state;
}

/* Ends of ranges, small numbers, or any number, of any magnitude. */
static int32_t nasty(void)
{
    static const int32_t ends[] = {0,      1,      -1,        2,         255,        256,       32767,
                                   32768,  65535,  65536,     65537,     -65536,     262144,    314573,
                                   524288, 524289, INT32_MAX, INT32_MIN, -INT32_MAX, 0x3FFFFFFF};
    const uint32_t kind = random_u32() % 4;
    if (kind < 2) return ends[random_u32() % (sizeof ends / sizeof *ends)];
    const int32_t any = (int32_t)random_u32();
    return kind == 2 ? any : any / (1 << random_u32() % 31);
}

/* ---- uniforms on their way to GL ------------------------------------------------------------------ */

static long uniforms_seen;

static void assert_finite(const float *v, int count)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(v[i])) fail_msg("a uniform is %f (seed %08x)", (double)v[i], (unsigned)random_state);
    uniforms_seen += count;
}

enum { FACTOR_LOCATION = 10000 }; /* larger than any of fake_gl */

static int seen_location(unsigned program, const char *name)
{
    int (*ask)(unsigned, const char *) =
        (int (*)(unsigned, const char *))(uintptr_t)fake_gl_proc(NULL, "glGetUniformLocation");
    const int at = ask(program, name);
    assert_in_range(at, 0, FACTOR_LOCATION - 1);
    return strcmp(name, "u_factor") && strcmp(name, "u_ambient") ? at : FACTOR_LOCATION;
}

static void seen_4fv(int at, int n, const float *v)
{
    assert_finite(v, 4 * n);
    for (int i = 0; at == FACTOR_LOCATION && i < 4 * n; i++)
        if (v[i] < 0 || v[i] > 2048) fail_msg("a light factor is %f (seed %08x)", (double)v[i], (unsigned)random_state);
}

static void seen_matrix3(int at, int n, unsigned char transpose, const float *v)
{
    (void)at;
    assert_int_equal(transpose, 0);
    assert_finite(v, 9 * n);
}

static void seen_matrix4(int at, int n, unsigned char transpose, const float *v)
{
    (void)at;
    assert_int_equal(transpose, 0);
    assert_finite(v, 16 * n);
}

static void *watching_proc(void *user, const char *name)
{
    if (!strcmp(name, "glGetUniformLocation")) return (void *)(uintptr_t)seen_location;
    if (!strcmp(name, "glUniform4fv")) return (void *)(uintptr_t)seen_4fv;
    if (!strcmp(name, "glUniformMatrix3fv")) return (void *)(uintptr_t)seen_matrix3;
    if (!strcmp(name, "glUniformMatrix4fv")) return (void *)(uintptr_t)seen_matrix4;
    return fake_gl_proc(user, name);
}

static void open_world(kit_world *w)
{
    fake_gl_start(&(fake_gl_options){.fragment_vectors = 64});
    kit_world_make(w, &(nacre_gles_desc){.max_programs = 64});
    w->desc.get_proc = watching_proc;
    assert_int_equal(kit_world_init(w), NACRE_OK);
}

static void close_world(kit_world *w)
{
    assert_int_equal(fake_gl_pending_error(), 0);
    nacre_gles_shutdown(w->gles);
    assert_int_equal(fake_gl_live(), 0);
    assert_true(kit_world_free(w));
}

static void draw(kit_world *w, nacre_gles_item item, const nacre_view *view)
{
    const nacre_result result = nacre_gles_draw(w->gles, item, view);
    if (result && result != NACRE_ERR_ARGUMENT) fail_msg("draw said %d\n%s", (int)result, w->log);
    assert_int_equal(fake_gl_pending_error(), 0);
}

/* ---- files ------------------------------------------------------------------------------------------ */

static const kit_model models[] = {KIT_TABLE, KIT_FINE, KIT_EARLY, KIT_SPHERES, KIT_PAPER, KIT_QUARTER};

/* Some numbers of the file's keys, each written over; put back by restore. */
static void spoil(kit_model model)
{
    static const char *const keys[] = {NACRE_KEY_ALBEDO, NACRE_KEY_TABLE, NACRE_KEY_LIGHT_POLAR,
                                       NACRE_KEY_SCALE,  NACRE_KEY_DISC,  NACRE_KEY_COSINE};
    const nacre_image *image = &assets.image[model];
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        uint32_t size = 0;
        uint8_t *value = (uint8_t *)(uintptr_t)nacre_image_key(image, keys[k], &size);
        uint32_t rising = 0;
        for (uint32_t i = 0; value && i + 4 <= size; i += 4) {
            uint32_t x = (uint32_t)nasty();
            if (random_u32() % 3) continue;
            if (!strcmp(keys[k], NACRE_KEY_LIGHT_POLAR) && random_u32() % 4) { /* mostly in order, or none would open */
                rising += 1 + x % 8191;
                x = rising;
            }
            if (!strcmp(keys[k], NACRE_KEY_COSINE)) continue;              /* the kit has both */
            if (!strcmp(keys[k], NACRE_KEY_TABLE) && i == 5 * 4) continue; /* 4 or 4.8, or refused */
            for (int b = 0; b < 4; b++) value[i + b] = (uint8_t)(x >> 8 * b);
        }
    }
}

static void any_number_in_a_file(void **state)
{
    (void)state;
    kit_world w;
    int opened = 0, refused = 0;
    random_state = 0x2F6E2B1;
    open_world(&w);
    for (size_t m = 0; m < sizeof models / sizeof *models; m++) {
        const nacre_image *image = &assets.image[models[m]];
        uint8_t kept[1024];
        uint8_t *kv = (uint8_t *)assets.file[models[m]] + image->kv_offset;
        assert_true(image->kv_size <= sizeof kept);
        memcpy(kept, kv, image->kv_size);
        for (int i = 0; i < FILES; i++) {
            const nacre_material material = kit_material(&assets, models[m], 0);
            nacre_gles_item item = {0};
            spoil(models[m]);
            const nacre_result result = nacre_gles_add(w.gles, &assets.ball, &material, &item);
            if (result) {
                assert_int_equal(result, NACRE_ERR_ASSET);
                assert_int_equal(item.id, 0);
                refused++;
            } else {
                opened++;
            }
            for (int lights = 1; !result && lights <= 4; lights++) {
                nacre_view view = kit_view(lights, lights == 3, lights & 1);
                view.output = (uint8_t)(random_u32() % 3);
                view.ambient = nacre_rgb_from_float(0.5f, 0, 1e4f);
                if (lights & 2) memset(&view.ambient, 0, sizeof view.ambient);
                draw(&w, item, &view);
            }
            nacre_gles_remove(w.gles, item);
            memcpy(kv, kept, image->kv_size);
        }
    }
    print_message("%d spoilt files drawn, %d refused, %ld uniforms\n", opened, refused, uniforms_seen);
    assert_true(opened >= FILES / 4);
    assert_true(refused >= FILES / 4);
    close_world(&w);
}

/* ---- views ------------------------------------------------------------------------------------------ */

static void spoil_rgb(nacre_rgb *c)
{
    if (random_u32() % 2) c->r = nasty();
    if (random_u32() % 2) c->g = nasty();
    if (random_u32() % 2) c->b = nasty();
}

static void spoil_light(nacre_light *light)
{
    light->type = random_u32() % 2;
    light->shadow = (int16_t)(random_u32() % 16385);
    light->direction.x = (int16_t)nasty();
    light->direction.y = (int16_t)nasty();
    light->direction.z = (int16_t)nasty();
    for (int i = 0; i < 3; i++) light->position[i] = nasty();
    spoil_rgb(&light->power);
}

static void any_number_in_a_view(void **state)
{
    (void)state;
    kit_world w;
    nacre_light light[NACRE_MAX_LIGHTS];
    random_state = 0x7A11C3D;
    uniforms_seen = 0;
    open_world(&w);
    for (size_t m = 0; m < sizeof models / sizeof *models; m++) {
        nacre_mesh mesh = assets.ball;
        const nacre_material material = kit_material(&assets, models[m], 1);
        nacre_gles_item item;
        for (int i = 0; i < VIEWS; i++) {
            for (int k = 0; k < 3; k++) {
                mesh.centre[k] = nasty();
                mesh.half_extent[k] = nasty() & INT32_MAX;
            }
            assert_int_equal(nacre_gles_add(w.gles, &mesh, &material, &item), NACRE_OK);
            nacre_view view = kit_view((int)(1 + random_u32() % 5), 0, (int)(random_u32() % 2));
            memcpy(light, view.lights, sizeof light);
            view.lights = light;
            for (int k = 0; k < 12; k++)
                if (random_u32() % 2) view.object_to_view.m[k + k / 3] = nasty();
            for (int k = 0; k < 16; k++)
                if (random_u32() % 3 == 0) view.view_to_clip.m[k] = nasty();
            for (int k = 0; k < view.light_count; k++) spoil_light(&light[k]);
            view.exposure = nasty() & INT32_MAX;
            view.output = (uint8_t)(random_u32() % 3);
            view.distant_viewer = random_u32() % 2;
            spoil_rgb(&view.ambient);
            spoil_rgb(&view.tint);
            draw(&w, item, &view);
            nacre_gles_remove(w.gles, item);
        }
    }
    print_message("%ld uniforms\n", uniforms_seen);
    assert_true(uniforms_seen > 100000);
    close_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_in_a_file),
        cmocka_unit_test(any_number_in_a_view),
    };
    int failed;
    kit_open(&assets);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    kit_close(&assets);
    return failed;
}
