/* SPDX-License-Identifier: MIT */
/* The CPU renderer on random meshes and cameras: slivers, huge coordinates, everything in one point, behind the eye. It
   must stay inside its memory (blocks of exact size under AddressSanitizer), and draw the same picture with every set of
   kernels and whatever the bands are. NACRE_LONG=1: many more. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "nacre_soft.h"

#include <cmocka.h> /* last: it makes a macro of fail */

static uint32_t seed;

static uint32_t roll(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)seed * below >> 32);
}

static int32_t any(int bits)
{
    const int32_t x = (int32_t)(roll(0xFFFFFFFFu) >> (32 - bits));

    return roll(2) ? x : -x;
}

enum { MOST_VERTICES = 64, MOST_TRIANGLES = 96, SIDE = 61 };

typedef struct world {
    nacre_vertex vertex[MOST_VERTICES];
    uint16_t index[3 * MOST_TRIANGLES];
    nacre_mesh mesh;
    nacre_light light[4];
    nacre_view view;
    nacre_soft_item item;
    nacre_soft_lit lit;
    uint32_t texels[64 * 64];
} world;

static void make_mesh(world *w)
{
    const unsigned kind = roll(5);
    uint32_t i;
    int k;

    w->mesh = (nacre_mesh){w->vertex, w->index, 3 * (1 + roll(MOST_TRIANGLES)), (uint16_t)(3 + roll(MOST_VERTICES - 2)),
                           {0},       {0}};
    for (i = 0; i < w->mesh.vertex_count; i++)
        for (k = 0; k < 4; k++) {
            const int thin = kind == 1 && k == 1, point = kind == 2;
            w->vertex[i].position[k] = (int16_t)(point ? 77 : thin ? any(2) : any(15));
            w->vertex[i].normal[k] = (int16_t)any(roll(8) ? 15 : 2);
            w->vertex[i].tangent[k] = (int8_t)any(7);
            if (k < 2) w->vertex[i].uv[k] = (int16_t)any(15);
        }
    for (i = 0; i < w->mesh.index_count; i++) w->index[i] = (uint16_t)roll(w->mesh.vertex_count);
    for (k = 0; k < 3; k++) {
        w->mesh.centre[k] = roll(6) ? any(14) : any(31);
        w->mesh.half_extent[k] = abs(roll(6) ? any(17) : any(31));
    }
}

static void make_view(world *w)
{
    nacre_mat4 *const m = &w->view.object_to_view, *const p = &w->view.view_to_clip;
    const int wild = !roll(8);
    int i;

    memset(&w->view, 0, sizeof w->view);
    for (i = 0; i < 16; i++) {
        m->m[i] = i % 4 == 3 ? (i == 15) * 65536 : any(wild ? 31 : i < 12 ? 16 : 17);
        p->m[i] = wild ? any(31) : 0;
    }
    if (!wild) {
        m->m[14] = -(int32_t)roll(roll(3) ? 200000 : 20000);
        p->m[0] = 30000 + (int32_t)roll(200000);
        p->m[5] = 30000 + (int32_t)roll(200000);
        p->m[10] = -70000;
        p->m[14] = -20000 - (int32_t)roll(20000);
        if (roll(4))
            p->m[11] = -65536; /* perspective */
        else
            p->m[15] = 65536;
    }
    w->view.lights = w->light;
    w->view.light_count = (uint16_t)roll(5);
    w->view.output = (uint8_t)roll(3);
    w->view.distant_viewer = (uint8_t)roll(2);
    w->view.exposure = any(roll(4) ? 18 : 31);
    for (i = 0; i < 4; i++) {
        nacre_light *l = &w->light[i];
        memset(l, 0, sizeof *l);
        l->type = (uint8_t)(roll(4) == 0);
        l->direction = (nacre_dir){(nacre_q14)any(14), (nacre_q14)any(14), (nacre_q14)any(14)};
        l->position[0] = any(roll(4) ? 18 : 31);
        l->position[1] = any(18);
        l->position[2] = any(18);
        l->power = (nacre_rgb){any(roll(4) ? 18 : 31), any(18), any(18)};
    }
}

static void make_item(world *w, const nacre_material *materials, int count)
{
    w->item = (nacre_soft_item){
        .mesh = &w->mesh, .material = &materials[roll((uint32_t)count)], .object_to_view = w->view.object_to_view};
    w->item.cull = (uint8_t)roll(3);
    w->item.alpha_test = (uint8_t)(roll(4) ? 0 : roll(256));
    w->item.blend = (uint8_t)!roll(6);
    w->item.clamp = (uint8_t)roll(2);
    w->item.nearest = (uint8_t)roll(2);
    w->lit = (nacre_soft_lit){w->texels, (uint16_t)(8 + roll(57))};
    if (!roll(3)) w->item.lit = &w->lit;
}

/* 0: not drawn; pixels: SIDE x SIDE RGBA8. */
static int draw(const world *w, const nacre_soft_kernels *kernels, unsigned band_rows, uint32_t *pixels)
{
    const nacre_soft_desc desc = {.width = SIDE,
                                  .height = SIDE,
                                  .format = NACRE_SOFT_RGBA8,
                                  .band_rows = (uint16_t)band_rows,
                                  .max_vertices = w->mesh.vertex_count,
                                  .max_triangles = w->mesh.index_count / 3,
                                  .max_lights = 4,
                                  .fine = 1,
                                  .blend = 1,
                                  .kernels = kernels};
    void *block = need_memory(1, nacre_soft_size(&desc)), *scratch = need_memory(1, nacre_soft_scratch_size(&desc));
    nacre_soft *soft;
    nacre_result r;

    memset(pixels, 0x5A, SIDE * SIDE * 4);
    assert_int_equal(nacre_soft_init(&soft, block, nacre_soft_size(&desc), &desc), NACRE_OK);
    nacre_soft_scissor(soft, 3, 5, 58, 55);
    r = nacre_soft_prepare(soft, &w->item, 1, &w->view);
    assert_int_equal(nacre_soft_frame(soft, scratch, nacre_soft_scratch_size(&desc), pixels, SIDE * 4), NACRE_OK);
    free(block);
    free(scratch);
    return r == NACRE_OK;
}

static int covers(const uint32_t *pixels)
{
    int i;

    for (i = 0; i < SIDE * SIDE; i++)
        if (pixels[i] != 0x5A5A5A5A && pixels[i]) return 1;
    return 0;
}

static void outside_is_untouched(const uint32_t *pixels)
{
    int i;

    for (i = 0; i < SIDE * SIDE; i++) {
        const int x = i % SIDE, y = i / SIDE;
        if (x < 3 || x >= 58 || y < 5 || y >= 55) assert_int_equal(pixels[i], 0x5A5A5A5A);
    }
}

/* Every set of kernels that this machine can run gives the bits of `first`. */
static void kernels_agree(const world *w, int round, const uint32_t *first)
{
    static const char *const names[] = {"sse41", "avx2", "neon"};
    static uint32_t other[SIDE * SIDE];
    int i;

    for (i = 0; i < 3; i++) {
        const nacre_soft_kernels *kernels = scene_soft_kernels(names[i]);
        if (!kernels) continue;
        draw(w, kernels, 8, other);
        if (memcmp(first, other, sizeof other)) fail_msg("round %d: %s kernels differ", round, names[i]);
    }
}

static void random_worlds(void **state)
{
    static const case_model models[] = {CASE_TABLE,   CASE_FINE,  CASE_TABLE_P4, CASE_SPHERES, CASE_PAPER,
                                        CASE_QUARTER, CASE_SBRDF, CASE_SBRDF2,   CASE_SBRDF3};
    enum { MODELS = sizeof models / sizeof *models };
    const int rounds = getenv("NACRE_LONG") ? 50000 : 1500;
    static world w;
    static uint32_t first[SIDE * SIDE], other[SIDE * SIDE];
    case_asset asset[MODELS];
    nacre_material material[2 * MODELS];
    int i, drawn = 0, covered = 0;

    (void)state;
    for (i = 0; i < MODELS; i++) { /* with a normal map, some with a mask too; and without */
        case_asset_open(&asset[i], models[i], "sgd:gold-metallic-paint", 1, NULL);
        material[i] = material[MODELS + i] = asset[i].material;
        if (i % 2) material[i].image[NACRE_ROLE_MASK] = material[i].image[NACRE_ROLE_NORMAL];
        material[MODELS + i].image[NACRE_ROLE_NORMAL] = NULL;
    }
    for (i = 0; i < 64 * 64; i++) w.texels[i] = (uint32_t)i * 2654435761u;
    for (i = 0; i < rounds; i++) {
        seed = (uint32_t)i * 7919u + 1;
        make_mesh(&w);
        make_view(&w);
        make_item(&w, material, 2 * MODELS);
        if (!draw(&w, &nacre_soft_portable, 8, first)) continue;
        drawn++;
        covered += covers(first);
        outside_is_untouched(first);
        kernels_agree(&w, i, first);
        draw(&w, scene_soft_kernels("best"), 1 + roll(61), other);
        if (memcmp(first, other, sizeof first)) fail_msg("round %d: bands differ", i);
    }
    print_message("%d worlds: %d drawn, %d with pixels covered\n", rounds, drawn, covered);
    assert_true(drawn > rounds / 2 && covered > rounds / 10);
    for (i = 0; i < MODELS; i++) case_asset_close(&asset[i]);
}

/* What the header promises: everything but the assets in flash. */
static size_t memory_of(const nacre_soft_desc *desc, size_t lit_bytes)
{
    return nacre_soft_size(desc) + nacre_soft_scratch_size(desc) + 2 * (size_t)desc->band_rows * desc->width * 2 +
           lit_bytes;
}

static void memory(void **state)
{
    const nacre_soft_desc large = {.width = 320, .height = 240, .max_vertices = 530, .max_triangles = 992};
    const nacre_soft_desc small = {
        .width = 160, .height = 128, .band_rows = 4, .max_vertices = 250, .max_triangles = 440};
    nacre_soft_desc d = large;

    (void)state;
    d.band_rows = 8;
    print_message("320 x 240, 530 vertices, 992 triangles, lit sphere of 64: %zu bytes\n", memory_of(&d, 64 * 64 * 2));
    print_message("160 x 128, 250 vertices, 440 triangles, lit sphere of 64: %zu bytes\n",
                  memory_of(&small, 64 * 64 * 2));
    assert_true(memory_of(&d, 64 * 64 * 2) <= 64 * 1024);
    assert_true(memory_of(&small, 64 * 64 * 2) <= 24 * 1024);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_worlds), cmocka_unit_test(memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
