/* SPDX-License-Identifier: MIT */
/* Tables 1 and 2 of McAllister et al. 2002, made again: frames a second by lights and lobes on a mesh whose texels all
   differ, and how many draws of the mesh each takes. CPU time of one thread. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "nacre_asset.h"
#include "nacre_gles.h"
#include "sbrdf_map.h"

enum { LIGHTS = 3, LOBES = NACRE_MAX_LOBES, ROWS = LIGHTS * LOBES, SIDE = 256 };

/* Frames a second of the paper's table 1, GeForce 4; [lights - 1][lobes - 1]. */
static const double published[LIGHTS][LOBES] = {{50.7, 29.5, 20.8}, {29.4, 16.2, 11.1}, {20.8, 11.1, 7.57}};

typedef struct table {
    gl_headless *gl;
    nacre_gles *gles;
    void *block;
    bench_gl device;
    bytes albedo[LOBES], lobes[LOBES];
    nacre_image albedo_image[LOBES], lobes_image[LOBES];
    bench_mesh mesh;
    nacre_gles_item item[LOBES][BENCH_MAX_PARTS];
    bench_time time[ROWS];
    int draws[ROWS]; /* of each part of the mesh */
} table;

/* Counts glDrawElements on the way to GL. */
static int draw_count;
static void (*draw_elements)(unsigned mode, int count, unsigned type, const void *offset);

static void counted_draw(unsigned mode, int count, unsigned type, const void *offset)
{
    draw_count++;
    draw_elements(mode, count, type, offset);
}

static void *counting_proc(void *user, const char *name)
{
    void (*const counted)(unsigned, int, unsigned, const void *) = counted_draw;
    void *proc = gl_headless_proc(user, name);
    if (!proc || strcmp(name, "glDrawElements")) return proc;
    memcpy(&draw_elements, &proc, sizeof proc);
    memcpy(&proc, &counted, sizeof proc);
    return proc;
}

/* Codes that drift from texel to texel, all of them lobes that exist. */
static void make_material(table *t, int lobes)
{
    sbrdf_map m;
    sbrdf_map_make(&m, SIDE, SIDE, lobes, 0, 1);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int x = i % SIDE, y = i / SIDE;
        for (int c = 0; c < 4; c++) m.albedo[0][4 * i + c] = (uint8_t)(c < 3 ? 40 + (x * (c + 1) + y) % 120 : 255);
        for (int j = 0; j < lobes; j++) {
            uint8_t *albedo = m.lobe[0] + 4 * (2 * j * SIDE * SIDE + i), *shape = albedo + 4 * SIDE * SIDE;
            const uint8_t across = (uint8_t)(1 + (x + 3 * y + 50 * j) % 20);
            for (int c = 0; c < 3; c++) albedo[c] = (uint8_t)(30 + (x + y * (c + 2)) % 60);
            albedo[3] = 255;
            shape[0] = shape[1] = across;
            shape[2] = 255;
            shape[3] = (uint8_t)(30 + (x + y) % 150 + 20 * j);
        }
    }
    sbrdf_map_write(&m, &t->albedo[lobes - 1], &t->lobes[lobes - 1]);
    sbrdf_map_free(&m);
}

static int add_material(table *t, int lobes, failure *f)
{
    const int k = lobes - 1;
    nacre_material material = {.model = NACRE_MODEL_SBRDF};
    make_material(t, lobes);
    int code = bench_check(nacre_image_open(&t->albedo_image[k], t->albedo[k].data, t->albedo[k].size), "albedo", f);
    if (!code) code = bench_check(nacre_image_open(&t->lobes_image[k], t->lobes[k].data, t->lobes[k].size), "lobes", f);
    material.image[NACRE_ROLE_ALBEDO] = &t->albedo_image[k];
    material.image[NACRE_ROLE_LOBES] = &t->lobes_image[k];
    for (int i = 0; i < t->mesh.part_count && !code; i++)
        code = bench_check(nacre_gles_add(t->gles, &t->mesh.parts[i], &material, &t->item[k][i]), "material", f);
    return code;
}

static int open_table(table *t, const bench_settings *s, failure *f)
{
    int code = bench_mesh_open(&t->mesh, s->mesh ? s->mesh : "teapot", f);
    if (code) return code;
    setenv("LP_NUM_THREADS", "0", 0); /* Mesa's rasteriser in this thread */
    if ((code = gl_headless_open(&t->gl, s->backend, s->size, s->size, f))) return code;
    bench_gl_begin(&t->device);
    const nacre_gles_desc desc = {
        .get_proc = counting_proc, .max_items = LOBES * BENCH_MAX_PARTS, .max_programs = 2 * ROWS};
    t->block = need_memory(1, nacre_gles_size(&desc));
    code = bench_check(nacre_gles_init(&t->gles, t->block, nacre_gles_size(&desc), &desc), "the GLES backend", f);
    for (int lobes = 1; lobes <= LOBES && !code; lobes++) code = add_material(t, lobes, f);
    return code;
}

static int draw_row(void *user, int row, failure *f)
{
    table *t = user;
    nacre_light light[LIGHTS];
    nacre_view view;
    int code = FAIL_NONE;
    bench_view(&view, light, row / LOBES + 1, 0);
    gl_headless_clear(t->gl, 0, 0, 0, 0);
    draw_count = 0;
    for (int i = 0; i < t->mesh.part_count && !code; i++)
        code = bench_check(nacre_gles_draw(t->gles, t->item[row % LOBES][i], &view), "draw", f);
    t->draws[row] = draw_count / t->mesh.part_count;
    t->device.finish();
    return code;
}

static double rate(const table *t, int lights, int lobes)
{
    return 1e3 / t->time[(lights - 1) * LOBES + lobes - 1].cpu_ms;
}

static void print_tables(const table *t, int size, int rounds)
{
    printf("%s\n%d x %d, one thread, medians of %d rounds\n", gl_headless_description(t->gl), size, size, rounds);
    printf("Table 1: frames/s, and as a part of 1 light and 1 lobe (printed: GeForce 4, another scene)\n%-6s",
           "lights");
    for (int k = 1; k <= LOBES; k++) printf("   %d lobe%s            ", k, k > 1 ? "s" : " ");
    for (int n = 1; n <= LIGHTS; n++) {
        printf("\n%-6d", n);
        for (int k = 1; k <= LOBES; k++)
            printf("   %7.1f %.2f (%.2f)", rate(t, n, k), rate(t, n, k) / rate(t, 1, 1),
                   published[n - 1][k - 1] / published[0][0]);
    }
    printf("\nTable 2: draws of the mesh (printed: passes, 2 per lobe and light)\n");
    for (int n = 1; n <= LIGHTS; n++) {
        printf("%-6d", n);
        for (int k = 1; k <= LOBES; k++) printf("   %d (%d)", t->draws[(n - 1) * LOBES + k - 1], 2 * n * k);
        printf("\n");
    }
}

static int write_json(const table *t, int size, const char *path, failure *f)
{
    json j = {0};
    bench_json_begin(&j, t->gl, size);
    for (int n = 1; n <= LIGHTS; n++)
        for (int k = 1; k <= LOBES; k++) {
            json_begin(&j, NULL, '{');
            json_int(&j, "lights", n);
            json_int(&j, "lobes", k);
            json_real(&j, "frames_per_second", rate(t, n, k));
            json_real(&j, "ratio", rate(t, n, k) / rate(t, 1, 1));
            json_real(&j, "published_ratio", published[n - 1][k - 1] / published[0][0]);
            json_int(&j, "draws", t->draws[(n - 1) * LOBES + k - 1]);
            json_int(&j, "published_passes", 2 * n * k);
            json_end(&j, '}');
        }
    return bench_json_end(&j, path, f);
}

int bench_paper000(const bench_settings *s, failure *f)
{
    const int rounds = s->rounds ? s->rounds : 7, frames = s->frames ? s->frames : 16;
    static table t;
    int code = open_table(&t, s, f);
    if (!code) code = bench_measure(ROWS, rounds, frames, draw_row, &t, t.time, f);
    if (!code && bench_prints(s)) print_tables(&t, s->size, rounds);
    if (!code && s->json_path) code = write_json(&t, s->size, s->json_path, f);
    if (t.gles) nacre_gles_shutdown(t.gles);
    if (t.gl) gl_headless_close(t.gl);
    for (int k = 0; k < LOBES; k++) {
        bytes_free(&t.albedo[k]);
        bytes_free(&t.lobes[k]);
    }
    bench_mesh_close(&t.mesh);
    free(t.block);
    return code;
}
