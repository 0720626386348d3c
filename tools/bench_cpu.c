/* SPDX-License-Identifier: MIT */
/* The CPU renderer beside Mesa's, on the same pictures: milliseconds of CPU a frame, one thread; and the CPU renderer by
   more threads. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "mesh.h"
#include "mesh_inner.h"
#include "nacre_gles.h"
#include "nacre_soft.h"
#include "scene.h"
#include "table_bake.h"

#define PI            3.14159265358979323846
#define BAND_ROWS     512
#define LIT_SIZE      128
#define THREADED_ROWS 32 /* of a band, with several threads */

enum { MAX_ROWS = 80, MAX_PARTS = 8, MESHES = 2, MOST_LIGHTS = 64 };

typedef enum renderer { SOFT_AVX2, SOFT_SSE41, SOFT_NEON, SOFT_SCALAR, LLVMPIPE, SOFTPIPE } renderer;
static const char *const renderer_names[] = {"soft-avx2",   "soft-sse41", "soft-neon",
                                             "soft-scalar", "llvmpipe",   "softpipe"};
static const char *const kernel_names[] = {"avx2", "sse41", "neon", "portable"};
static const char *const mesh_names[MESHES] = {"teapot", "bunny"};

typedef struct cpu_row {
    renderer by;
    int lit; /* path */
    int mesh, lights, threads;
    bench_time time;
    double factor; /* several threads: times as fast as one, on the clock */
} cpu_row;

typedef struct cpu_mesh {
    nacre_mesh *parts;
    int part_count, triangles;
    nacre_gles_item item[MAX_PARTS];
} cpu_mesh;

typedef struct cpu_bench {
    int size, threads;
    bytes file;
    nacre_image image;
    nacre_material material;
    cpu_mesh mesh[MESHES];
    cpu_row row[MAX_ROWS];
    int row_count;
    void *block, *scratch; /* scratch: of every thread */
    size_t block_size;
    uint32_t *pixels;
    uint32_t lit_texels[LIT_SIZE * LIT_SIZE];
    gl_headless *gl;
    nacre_gles *gles;
    void *gles_block;
    bench_gl device;
} cpu_bench;

/* About 70,000 triangles with the spread of sizes and directions of a scanned animal: a sphere with lumps. */
static mesh lumpy(void)
{
    enum { ACROSS = 264, UP = 132 };
    mesh m = mesh_make("bunny", (ACROSS + 1) * (UP + 1), ACROSS * UP * 6);
    int i, j, n = 0;

    for (j = 0; j <= UP; j++)
        for (i = 0; i <= ACROSS; i++, n++) {
            const double a = 2 * PI * (i % ACROSS) / ACROSS, b = PI * j / UP;
            const double r = 0.75 + 0.12 * sin(3 * a) * sin(b) * sin(2 * b) + 0.08 * cos(5 * b + 1) +
                             0.02 * sin(19 * a) * sin(17 * b) * sin(b);
            m.position[n][0] = (float)(r * sin(b) * sin(a));
            m.position[n][1] = (float)(r * cos(b));
            m.position[n][2] = (float)(r * sin(b) * cos(a));
        }
    for (j = 0, n = 0; j < UP; j++)
        for (i = 0; i < ACROSS; i++) {
            const uint32_t at = (uint32_t)(j * (ACROSS + 1) + i), below = at + ACROSS + 1;
            const uint32_t corner[6] = {at, below, below + 1, at, below + 1, at + 1};
            memcpy(m.index + n, corner, sizeof corner);
            n += 6;
        }
    {
        uint8_t *known = need_memory((size_t)m.vertex_count, 1);
        mesh_make_normals(&m, known);
        mesh_make_tangents(&m);
        free(known);
    }
    return m;
}

static int open_meshes(cpu_bench *b, failure *f)
{
    int i, code = FAIL_NONE;

    for (i = 0; i < MESHES && !code; i++) {
        mesh m;
        if (i == 0)
            code = mesh_open(&m, "teapot", f);
        else
            m = lumpy();
        if (code) return code;
        b->mesh[i].triangles = m.index_count / 3;
        code = mesh_pack(&m, &b->mesh[i].parts, &b->mesh[i].part_count, f);
        mesh_free(&m);
        if (!code && b->mesh[i].part_count > MAX_PARTS)
            code = fail(f, FAIL_INTERNAL, "%s: too many parts", mesh_names[i]);
    }
    return code;
}

static int bake(cpu_bench *b, const char *name, failure *f)
{
    table_asset t = {0};
    brdf *source;
    int code = brdf_open(&source, name, f);

    if (code) return code;
    code = table_bake(&t, source, &(table_options){0}, f);
    t.toe = 0; /* the display form is what is timed, on both sides */
    brdf_close(source);
    if (code) return code;
    table_write(&t, &b->file);
    table_free(&t);
    if (nacre_image_open(&b->image, b->file.data, b->file.size))
        return fail(f, FAIL_INTERNAL, "a baked file is refused by the runtime");
    b->material = (nacre_material){.model = NACRE_MODEL_TABLE};
    b->material.image[NACRE_ROLE_TABLE] = &b->image;
    return FAIL_NONE;
}

static void make_view(nacre_view *view, nacre_light *light, int count)
{
    static const float object_to_view[16] = {.906f,  -.144f, .397f, 0, 0, .940f, .342f, 0,
                                             -.423f, -.310f, .852f, 0, 0, 0,     -2,    1};
    static const float view_to_clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.5f, 0, 0, 0, -1, 1}; /* orthographic */
    const float power = 2.0f / (float)count;
    int i;

    memset(view, 0, sizeof *view);
    memset(light, 0, sizeof *light * (size_t)count);
    for (i = 0; i < count; i++) {
        const double polar = 0.6 + 0.1 * (i % 8), azimuth = 2.4 * i;
        light[i].direction = nacre_dir_from_float((float)(sin(polar) * cos(azimuth)),
                                                  (float)(sin(polar) * sin(azimuth)), (float)cos(polar));
        light[i].power = nacre_rgb_from_float(power, power, power);
    }
    view->object_to_view = nacre_mat4_from_float(object_to_view);
    view->view_to_clip = nacre_mat4_from_float(view_to_clip);
    view->lights = light;
    view->light_count = (uint16_t)count;
}

/* ---- the CPU renderer ------------------------------------------------------------------------------------------------- */

static nacre_soft_desc soft_desc(const cpu_bench *b, renderer by, int threads)
{
    nacre_soft_desc desc = {.width = (uint16_t)b->size,
                            .height = (uint16_t)b->size,
                            .format = NACRE_SOFT_RGBA8,
                            .band_rows = threads > 1 ? THREADED_ROWS : BAND_ROWS,
                            .max_items = MAX_PARTS,
                            .max_lights = NACRE_MAX_LIGHTS};
    int i, k;

    desc.kernels = scene_soft_kernels(kernel_names[by]);
    for (i = 0; i < MESHES; i++) {
        uint32_t vertices = 0, triangles = 0;
        for (k = 0; k < b->mesh[i].part_count; k++) {
            vertices += b->mesh[i].parts[k].vertex_count;
            triangles += b->mesh[i].parts[k].index_count / 3;
        }
        if (vertices > desc.max_vertices) desc.max_vertices = vertices;
        if (triangles > desc.max_triangles) desc.max_triangles = triangles;
    }
    return desc;
}

/* Bands by whoever is free. */
static nacre_result draw_bands(const cpu_bench *b, const nacre_soft *soft, size_t scratch_size, int threads)
{
    const size_t stride = (size_t)b->size * 4;
    nacre_result result = NACRE_OK;
    int y;

#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (y = 0; y < b->size; y += THREADED_ROWS) {
        const int end = y + THREADED_ROWS < b->size ? y + THREADED_ROWS : b->size;
        uint8_t *scratch = (uint8_t *)b->scratch + (size_t)omp_get_thread_num() * scratch_size;
        const nacre_result r =
            nacre_soft_band(soft, y, end, scratch, scratch_size, (uint8_t *)b->pixels + (size_t)y * stride, stride);
        if (r) {
#pragma omp critical
            result = r;
        }
    }
    return result;
}

static int draw_soft(cpu_bench *b, const cpu_row *row, failure *f)
{
    nacre_soft_desc desc = soft_desc(b, row->by, row->threads);
    const nacre_soft_lit lit = {b->lit_texels, LIT_SIZE};
    const cpu_mesh *m = &b->mesh[row->mesh];
    nacre_soft_item items[MAX_PARTS];
    nacre_light light[MOST_LIGHTS];
    nacre_view view;
    nacre_soft *soft;
    nacre_result r;
    size_t scratch_size;
    int i;

    desc.max_items = (uint16_t)m->part_count;
    scratch_size = nacre_soft_scratch_size(&desc);
    make_view(&view, light, row->lights);
    for (i = 0; i < m->part_count; i++)
        items[i] = (nacre_soft_item){.mesh = &m->parts[i],
                                     .material = &b->material,
                                     .lit = row->lit ? &lit : NULL,
                                     .object_to_view = view.object_to_view};
    r = nacre_soft_init(&soft, b->block, b->block_size, &desc);
    if (!r) r = nacre_soft_prepare(soft, items, m->part_count, &view);
    if (!r && row->threads > 1)
        r = draw_bands(b, soft, scratch_size, row->threads);
    else if (!r)
        r = nacre_soft_frame(soft, b->scratch, scratch_size, b->pixels, (size_t)b->size * 4);
    return r ? fail(f, FAIL_INTERNAL, "soft: %s", nacre_result_text(r)) : FAIL_NONE;
}

/* ---- Mesa -------------------------------------------------------------------------------------------------------------- */

static int open_gl(cpu_bench *b, gl_backend backend, failure *f)
{
    const nacre_gles_desc desc = {.get_proc = gl_headless_proc, .max_items = 2 * MAX_PARTS, .host_resets_state = 1};
    void (*enable)(unsigned);
    nacre_result r;
    int i, k, code = gl_headless_open(&b->gl, backend, b->size, b->size, f);

    if (code) return code;
    bench_gl_begin(&b->device);
    *(void **)&enable = gl_headless_proc(NULL, "glEnable");
    enable(0x0B44); /* GL_CULL_FACE */
    b->gles_block = need_memory(1, nacre_gles_size(&desc));
    r = nacre_gles_init(&b->gles, b->gles_block, nacre_gles_size(&desc), &desc);
    for (i = 0; i < MESHES && !r; i++)
        for (k = 0; k < b->mesh[i].part_count && !r; k++)
            r = nacre_gles_add(b->gles, &b->mesh[i].parts[k], &b->material, &b->mesh[i].item[k]);
    return r ? fail(f, FAIL_UNSUPPORTED, "the GLES backend: %s", nacre_result_text(r)) : FAIL_NONE;
}

static void close_gl(cpu_bench *b)
{
    if (b->gles) nacre_gles_shutdown(b->gles);
    if (b->gl) gl_headless_close(b->gl);
    free(b->gles_block);
    b->gles = NULL;
    b->gl = NULL;
    b->gles_block = NULL;
}

static int draw_gl(cpu_bench *b, const cpu_row *row, failure *f)
{
    const cpu_mesh *m = &b->mesh[row->mesh];
    nacre_light light[NACRE_MAX_LIGHTS];
    nacre_view view;
    int i;

    make_view(&view, light, row->lights);
    gl_headless_clear(b->gl, 0, 0, 0, 0);
    for (i = 0; i < m->part_count; i++) {
        nacre_result r = nacre_gles_draw(b->gles, m->item[i], &view);
        if (r) return fail(f, FAIL_UNSUPPORTED, "%s: %s", renderer_names[row->by], nacre_result_text(r));
    }
    b->device.finish();
    return FAIL_NONE;
}

/* ---- rows ----------------------------------------------------------------------------------------------------------------- */

static int draw_row(void *user, int index, failure *f)
{
    cpu_bench *b = user;
    const cpu_row *row = &b->row[index];

    return row->by == LLVMPIPE || row->by == SOFTPIPE ? draw_gl(b, row, f) : draw_soft(b, row, f);
}

/* The CPU renderer again by several threads, side by side with one: after the others, because threads that wait for the next
   frame take CPU time. */
static int measure_threads(cpu_bench *b, int rounds, int frames, failure *f)
{
    const int all = b->row_count;
    cpu_bench *const pairs = need_memory(1, sizeof *pairs);
    bench_time time[MAX_ROWS];
    int i, code;

    *pairs = *b;
    pairs->row_count = 0;
    for (i = 0; i < all; i++) {
        cpu_row row = b->row[i];
        if (row.by > SOFT_SCALAR) continue;
        pairs->row[pairs->row_count++] = row;
        row.threads = b->threads;
        pairs->row[pairs->row_count++] = row;
    }
    code = bench_measure(pairs->row_count, rounds, frames, draw_row, pairs, time, f);
    for (i = 0; i < pairs->row_count && !code; i += 2) {
        cpu_row *const row = &b->row[b->row_count++];
        *row = pairs->row[i + 1];
        row->time = time[i + 1];
        row->factor = time[i].wall_ms / time[i + 1].wall_ms;
    }
    free(pairs);
    return code;
}

typedef struct softpipe_row {
    cpu_bench *b;
    int index;
} softpipe_row;

static int draw_softpipe(void *user, int index, failure *f)
{
    const softpipe_row *r = user;

    (void)index;
    return draw_row(r->b, r->index, f);
}

static void add_row(cpu_bench *b, renderer by, int lit, int which, int lights)
{
    b->row[b->row_count++] = (cpu_row){.by = by, .lit = lit, .mesh = which, .lights = lights, .threads = 1};
}

static void add_rows(cpu_bench *b)
{
    int i, k;

    for (i = 0; i < MESHES; i++)
        for (k = SOFT_AVX2; k <= LLVMPIPE; k++) {
            if (k <= SOFT_SCALAR && !scene_soft_kernels(kernel_names[k])) continue;
            add_row(b, (renderer)k, 0, i, 1);
            add_row(b, (renderer)k, 0, i, 8);
            if (k == LLVMPIPE) continue;
            add_row(b, (renderer)k, 1, i, 1);
            add_row(b, (renderer)k, 1, i, 8);
            add_row(b, (renderer)k, 1, i, 64);
        }
}

/* Seconds a frame: once each, after the others, where OSMesa has it. */
static int measure_softpipe(cpu_bench *b, failure *f)
{
    const int first = b->row_count;
    bench_time time;
    int i, code;

    setenv("GALLIUM_DRIVER", "softpipe", 1);
    if (open_gl(b, GL_BACKEND_OSMESA, f)) return FAIL_NONE;
    for (i = 0; i < MESHES; i++) {
        add_row(b, SOFTPIPE, 0, i, 1);
        add_row(b, SOFTPIPE, 0, i, 8);
    }
    for (i = first, code = FAIL_NONE; i < b->row_count && !code; i++) {
        softpipe_row r = {b, i};
        code = bench_measure(1, 1, 1, draw_softpipe, &r, &time, f);
        b->row[i].time = time;
    }
    close_gl(b);
    return code;
}

static int measure(cpu_bench *b, int rounds, int frames, failure *f)
{
    bench_time time[MAX_ROWS];
    int i, code = open_gl(b, GL_BACKEND_EGL2, f);

    if (code) return code;
    add_rows(b);
    code = bench_measure(b->row_count, rounds, frames, draw_row, b, time, f);
    for (i = 0; i < b->row_count; i++) b->row[i].time = time[i];
    close_gl(b);
    if (!code) code = measure_softpipe(b, f);
    return code || b->threads == 1 ? code : measure_threads(b, rounds, frames, f);
}

static void print_rows(const cpu_bench *b, int rounds)
{
    int i;

    printf("%d x %d, table, sRGB, orthographic, back faces culled; teapot %d and bunny-like mesh %d triangles\n"
           "ms of CPU a frame, medians of %d rounds%s\n%-12s %-7s %-7s %6s %9s%s\n",
           b->size, b->size, b->mesh[0].triangles, b->mesh[1].triangles, rounds,
           b->threads > 1 ? "; with several threads of the clock, and times as fast as one" : "", "renderer", "path",
           "mesh", "lights", "cpu ms", b->threads > 1 ? " threads  factor" : "");
    for (i = 0; i < b->row_count; i++) {
        const cpu_row *r = &b->row[i];
        printf("%-12s %-7s %-7s %6d %9.3f", renderer_names[r->by], r->lit ? "lit" : "direct", mesh_names[r->mesh],
               r->lights, r->threads > 1 ? r->time.wall_ms : r->time.cpu_ms);
        if (r->threads > 1) printf(" %7d %7.2f", r->threads, r->factor);
        printf("\n");
    }
}

static int write_json(const cpu_bench *b, const char *path, failure *f)
{
    json j = {0};
    int i;

    json_begin(&j, NULL, '{');
    json_int(&j, "size", b->size);
    json_begin(&j, "rows", '[');
    for (i = 0; i < b->row_count; i++) {
        const cpu_row *r = &b->row[i];
        json_begin(&j, NULL, '{');
        json_text(&j, "renderer", renderer_names[r->by]);
        json_text(&j, "path", r->lit ? "lit" : "direct");
        json_text(&j, "model", "table");
        json_text(&j, "mesh", mesh_names[r->mesh]);
        json_int(&j, "lights", r->lights);
        json_int(&j, "threads", r->threads);
        json_real(&j, "cpu_ms", r->time.cpu_ms);
        json_real(&j, "wall_ms", r->time.wall_ms);
        json_end(&j, '}');
    }
    json_end(&j, ']');
    json_end(&j, '}');
    return json_write(&j, path, f);
}

/* For one thread, or for all. */
static void get_memory(cpu_bench *b)
{
    const nacre_soft_desc one = soft_desc(b, SOFT_SCALAR, 1), several = soft_desc(b, SOFT_SCALAR, b->threads);
    const size_t size = nacre_soft_size(&several),
                 scratch_size = nacre_soft_scratch_size(&several) * (size_t)b->threads;

    b->block_size = nacre_soft_size(&one) > size ? nacre_soft_size(&one) : size;
    b->block = need_memory(1, b->block_size);
    b->scratch =
        need_memory(1, nacre_soft_scratch_size(&one) > scratch_size ? nacre_soft_scratch_size(&one) : scratch_size);
    b->pixels = need_memory((size_t)b->size * (size_t)b->size, 4);
}

int bench_cpu(const bench_settings *s, failure *f)
{
    static cpu_bench b;
    const int rounds = s->rounds ? s->rounds : 7, frames = s->frames ? s->frames : 12;
    int i, code;

    setenv("LP_NUM_THREADS", "0", 0);
    b.size = s->size;
    b.threads = s->threads;
    if ((code = open_meshes(&b, f)) || (code = bake(&b, s->material ? s->material : "sgd:gold-metallic-paint", f)))
        return code;
    for (i = 0; i < LIT_SIZE * LIT_SIZE; i++) b.lit_texels[i] = (uint32_t)i * 0x010203u | 255u << 24;
    get_memory(&b);
    code = measure(&b, rounds, frames, f);
    if (!code && bench_prints(s)) print_rows(&b, rounds);
    if (!code && s->json_path) code = write_json(&b, s->json_path, f);
    close_gl(&b);
    for (i = 0; i < MESHES; i++) free(b.mesh[i].parts);
    bytes_free(&b.file);
    free(b.block);
    free(b.scratch);
    free(b.pixels);
    return code;
}
