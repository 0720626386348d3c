/* SPDX-License-Identifier: MIT */
#include "gles_kit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ktx2_write.h"
#include "nacre_asset.h"
#include "palette.h"

/* ---- assets -------------------------------------------------------------------------------------- */

static uint8_t code(double x)
{
    return (uint8_t)(x < 0 ? 0 : x > 1 ? 255 : x * 255 + 0.5);
}

/* Smooth texels: brighter to the lower left, each channel its own slope. */
static void append_texel(bytes *out, int format, double x, double y, int layer)
{
    const double v[4] = {0.2 + 0.5 * x * y + 0.05 * layer, 0.3 + 0.3 * (1 - x) + 0.1 * y, 0.7 - 0.4 * x - 0.03 * layer,
                         0.5 + 0.2 * (x - y)};
    uint8_t t[4] = {code(v[0]), code(v[1]), code(v[2]), code(v[3])};
    if (format == NACRE_FORMAT_RGB565) {
        const unsigned w = (unsigned)(t[0] >> 3) << 11 | (unsigned)(t[1] >> 2) << 5 | t[2] >> 3;
        t[0] = (uint8_t)w;
        t[1] = (uint8_t)(w >> 8);
    }
    bytes_append(out, t,
                 format == NACRE_FORMAT_RGBA8  ? 4
                 : format == NACRE_FORMAT_RGB8 ? 3
                 : format == NACRE_FORMAT_R8   ? 1
                                               : 2);
}

static void append_normal(bytes *out, double x, double y)
{
    const double nx = 0.3 * sin(6.28 * x), ny = 0.3 * cos(6.28 * y), nz = sqrt(1 - nx * nx - ny * ny);
    const uint8_t t[3] = {code(nx / 2 + 0.5), code(ny / 2 + 0.5), code(nz / 2 + 0.5)};
    bytes_append(out, t, 3);
}

/* An ETC1 block of one colour: both halves alike, differences 0. */
static void append_block(bytes *out, int layer, int i)
{
    const uint8_t block[8] = {(uint8_t)((8 + layer) << 3), (uint8_t)((20 - layer) << 3), (uint8_t)((4 + i % 8) << 3),
                              2};
    bytes_append(out, block, 8);
}

static void fill(ktx2_image *k, int normal)
{
    const int layers = k->layers ? k->layers : 1;
    for (int level = 0; level < k->levels; level++) {
        int w = k->width >> level, h = k->height >> level;
        if (w < 1) w = 1;
        if (h < 1) h = 1;
        for (int layer = 0; layer < layers; layer++) {
            if (k->format == NACRE_FORMAT_ETC2_RGB8) {
                for (int i = 0; i < (w + 3) / 4 * ((h + 3) / 4); i++) append_block(&k->level[level], layer, i);
                continue;
            }
            for (int y = 0; y < h; y++)
                for (int x = 0; x < w; x++)
                    if (normal)
                        append_normal(&k->level[level], (x + 0.5) / w, (y + 0.5) / h);
                    else
                        append_texel(&k->level[level], k->format, (x + 0.5) / w, (y + 0.5) / h, layer);
        }
    }
}

/* Of a material that varies over the surface. */
static void add_map_keys(ktx2_image *k, kit_model model)
{
    static const double most[3] = {0.75, 2, 1}, shape[3] = {1, 1.5, 1};
    const uint32_t lobes = 3, one = 1;
    ktx2_key_text(k, NACRE_KEY_ROLE, model == KIT_SBRDF ? "albedo" : model == KIT_LOBES ? "lobes" : "power");
    ktx2_key_text(k, NACRE_KEY_TRANSFER, model == KIT_POWER ? "root" : "linear");
    if (model == KIT_POWER) return;
    ktx2_key_q16(k, NACRE_KEY_MOST, most, model == KIT_LOBES ? 3 : 1);
    if (model != KIT_LOBES) return;
    ktx2_key_u32(k, NACRE_KEY_LOBES, &lobes, 1);
    ktx2_key_q16(k, NACRE_KEY_SHAPE, shape, 3);
    ktx2_key_u32(k, NACRE_KEY_DIRECTION, &one, 1);
}

static int is_map(kit_model model)
{
    return model == KIT_SBRDF || model == KIT_LOBES || model == KIT_POWER;
}

static int is_table(kit_model model)
{
    return model == KIT_TABLE || model == KIT_FINE || model == KIT_EARLY;
}

static void add_table_keys(ktx2_image *k, kit_model model)
{
    /* E, Ymax, W, p, eps, K1, K2, B; fine: D, V, K4 */
    static const double plain[10] = {1.5, 2.25, 0.5, 0.25, -0.25, 4.8, 1.0 / 256, 0, 0, 0.3},
                        early[9] = {1.5, 2.25, 0, 0, 0, 4, 1.0 / 256, 0.5, 0.25},
                        fine[17] = {1.5, 2.25, 0.5, 0.25, -0.25, 4,   1.0 / 256, 0,    0.25,
                                    0.5, 0.25, 0.1, 0.2,  -0.25, 0.5, 0.25,      0.125};
    ktx2_key_text(k, NACRE_KEY_ROLE, "table");
    if (model == KIT_TABLE) ktx2_key_q16(k, NACRE_KEY_TABLE, plain, 10);
    if (model == KIT_EARLY) ktx2_key_q16(k, NACRE_KEY_TABLE, early, 9);
    if (model == KIT_FINE) ktx2_key_q16(k, NACRE_KEY_TABLE, fine, 17);
}

static void add_keys(ktx2_image *k, kit_model model)
{
    static const double albedo[3] = {0.25, 0.5, 0.125}, f_scale[3] = {20, 12.5, 5}, e[3] = {0.5, 0.5, 0.5};
    const uint32_t cosine = model == KIT_PAPER, one = 1, polar[5] = {0, 8192, 16384, 24576, 30000};
    const double disc = model == KIT_PAPER ? 1 : 0.9375;
    if (model == KIT_NORMAL) {
        ktx2_key_text(k, NACRE_KEY_ROLE, "normal");
        return;
    }
    ktx2_key_q16(k, NACRE_KEY_ALBEDO, albedo, 3);
    if (is_map(model)) {
        add_map_keys(k, model);
        return;
    }
    if (is_table(model)) {
        add_table_keys(k, model);
        return;
    }
    ktx2_key_text(k, NACRE_KEY_ROLE, "spheres");
    ktx2_key_text(k, NACRE_KEY_TRANSFER, cosine ? "srgb" : model == KIT_QUARTER ? "root4-lh" : "root4");
    ktx2_key_u32(k, NACRE_KEY_LIGHT_POLAR, polar, k->layers);
    ktx2_key_u32(k, NACRE_KEY_COSINE, &cosine, 1);
    ktx2_key_q16(k, NACRE_KEY_SCALE, cosine ? e : f_scale, 3);
    if (model == KIT_QUARTER)
        ktx2_key_u32(k, NACRE_KEY_QUARTERS, &one, 1);
    else
        ktx2_key_q16(k, NACRE_KEY_DISC, &disc, 1);
    if (model == KIT_ETC1) ktx2_key_u32(k, NACRE_KEY_ETC1, &one, 1);
}

/* Takes the bytes over. */
static void keep(kit *k, kit_model model, const bytes *file)
{
    k->file[model] = file->data;
    if (nacre_image_open(&k->image[model], file->data, file->size)) {
        fprintf(stderr, "gles_kit: asset %d is not valid\n", (int)model);
        exit(70);
    }
}

static void make_asset(kit *k, kit_model model)
{
    static const struct {
        int format, width, height, layers, levels;
    } shape[KIT_MODELS] = {
        [KIT_TABLE] = {NACRE_FORMAT_RGBA8, 24, 21, 0, 1},    [KIT_FINE] = {NACRE_FORMAT_RGBA8, 8, 5, 2, 1},
        [KIT_SPHERES] = {NACRE_FORMAT_RGBA8, 32, 32, 4, 6},  [KIT_PAPER] = {NACRE_FORMAT_RGBA8, 128, 128, 4, 8},
        [KIT_ETC1] = {NACRE_FORMAT_ETC2_RGB8, 16, 16, 3, 5}, [KIT_RGB565] = {NACRE_FORMAT_RGB565, 20, 12, 5, 2},
        [KIT_QUARTER] = {NACRE_FORMAT_RGB8, 16, 16, 5, 1},   [KIT_NORMAL] = {NACRE_FORMAT_RGB8, 8, 8, 0, 4},
        [KIT_SBRDF] = {NACRE_FORMAT_RGBA8, 16, 16, 0, 5},    [KIT_LOBES] = {NACRE_FORMAT_RGBA8, 16, 16, 6, 5},
        [KIT_POWER] = {NACRE_FORMAT_R8, 32, 16, 0, 1},       [KIT_EARLY] = {NACRE_FORMAT_RGBA8, 8, 5, 2, 1},
    };
    ktx2_image image;
    bytes file = {0};
    memset(&image, 0, sizeof image);
    image.format = shape[model].format;
    image.width = shape[model].width;
    image.height = shape[model].height;
    image.layers = shape[model].layers;
    image.levels = shape[model].levels;
    image.faces = 1;
    fill(&image, model == KIT_NORMAL);
    add_keys(&image, model);
    ktx2_write(&image, &file);
    ktx2_free(&image);
    keep(k, model, &file);
}

static int is_palette(kit_model model)
{
    return model == KIT_PALETTE || model == KIT_INDEX || model == KIT_BLEND;
}

/* In patches of four texels; smaller levels go on with what their first texel has. */
static void fill_index(palette *p)
{
    for (int level = 0; level < p->levels; level++) {
        const int side = p->width >> level;
        p->code[level] = need_memory((size_t)side, (size_t)side);
        for (int i = 0; i < side * side; i++) {
            const int x = i % side << level, y = i / side << level;
            p->code[level][i] = (uint8_t)((x / 4 + 2 * (y / 4)) % p->count);
        }
    }
}

static void make_palette(kit *k)
{
    const table_asset common = {.width = 8,
                                .height = 5,
                                .layers = 1,
                                .layout = TABLE_ONE_LAYER,
                                .e = 1.5,
                                .ymax = 2.25,
                                .w = {0.5, 0.25, -0.25},
                                .p = 4,
                                .eps = 1.0 / 256,
                                .rows = 0.25,
                                .albedo = {0.25, 0.5, 0.125}};
    bytes tables = {0}, nearest = {0}, blended = {0};
    palette p = {.count = 5, .width = 16, .height = 16, .levels = 5, .white_sky = {0.25, 0.5, 0.125}};
    p.table = need_memory((size_t)p.count, sizeof *p.table);
    for (int i = 0; i < p.count; i++) {
        bytes texels = {0};
        for (int t = 0; t < common.width * common.height; t++)
            append_texel(&texels, NACRE_FORMAT_RGBA8, (t % common.width + 0.5) / common.width,
                         (t / common.width + 0.5) / common.height, 2 * i);
        p.table[i] = common;
        p.table[i].rgba = texels.data;
    }
    fill_index(&p);
    palette_write(&p, &tables, &nearest);
    keep(k, KIT_PALETTE, &tables);
    keep(k, KIT_INDEX, &nearest);
    p.blend = 1;
    tables = (bytes){0};
    palette_write(&p, &tables, &blended);
    bytes_free(&tables);
    keep(k, KIT_BLEND, &blended);
    palette_free(&p);
}

/* ---- the ball: an ellipsoid of rings --------------------------------------------------------------- */

#define RINGS 24
#define SIDES 32

static void make_ball(kit *k)
{
    const int vertices = (RINGS + 1) * (SIDES + 1), triangles = RINGS * SIDES * 2;
    const double extent[3] = {1, 0.75, 0.5}, centre[3] = {0.25, 0.5, -0.125};
    nacre_vertex *v = calloc((size_t)vertices, sizeof *v);
    uint16_t *index = malloc((size_t)triangles * 3 * sizeof *index), *at = index;
    float *f = k->floats = malloc((size_t)vertices * 12 * sizeof *f);
    for (int r = 0; r <= RINGS; r++)
        for (int s = 0; s <= SIDES; s++, v++, f += 12) {
            const double polar = M_PI * r / RINGS, azimuth = 2 * M_PI * s / SIDES;
            const double p[3] = {sin(polar) * cos(azimuth), cos(polar), -sin(polar) * sin(azimuth)};
            const double t[3] = {-sin(azimuth) * extent[0], 0, -cos(azimuth) * extent[2]};
            double n[3], length = 0, tangent_length = hypot(t[0], t[2]);
            for (int i = 0; i < 3; i++) length += pow(p[i] / extent[i], 2);
            for (int i = 0; i < 3; i++) {
                n[i] = p[i] / extent[i] / sqrt(length);
                v->position[i] = (int16_t)lrint(p[i] * 32767);
                v->normal[i] = (int16_t)lrint(n[i] * 32767);
                v->tangent[i] = (int8_t)lrint(t[i] / tangent_length * 127);
                /* floats of the packed values, so that both paths draw the same mesh */
                f[i] = (float)(centre[i] + extent[i] * v->position[i] / 32767);
                f[3 + i] = v->normal[i] / 32767.0f;
                f[6 + i] = v->tangent[i] / 127.0f;
            }
            v->tangent[3] = 127;
            f[9] = 1;
            v->uv[0] = (int16_t)(2 * 2048 * s / SIDES);
            v->uv[1] = (int16_t)(2048 * r / RINGS);
            f[10] = v->uv[0] / 2048.0f;
            f[11] = v->uv[1] / 2048.0f;
        }
    for (int r = 0; r < RINGS; r++)
        for (int s = 0; s < SIDES; s++) {
            const int a = r * (SIDES + 1) + s, b = a + SIDES + 1;
            const int corner[6] = {a, b, a + 1, a + 1, b, b + 1};
            for (int i = 0; i < 6; i++) *at++ = (uint16_t)corner[i];
        }
    k->ball.vertices = v - vertices;
    k->ball.indices = index;
    k->ball.index_count = (uint32_t)triangles * 3;
    k->ball.vertex_count = (uint16_t)vertices;
    for (int i = 0; i < 3; i++) {
        k->ball.centre[i] = nacre_q16_from_float((float)centre[i]);
        k->ball.half_extent[i] = nacre_q16_from_float((float)extent[i]);
    }
}

void kit_open(kit *k)
{
    memset(k, 0, sizeof *k);
    for (int i = 0; i < KIT_MODELS; i++)
        if (!is_palette((kit_model)i)) make_asset(k, (kit_model)i);
    make_palette(k);
    make_ball(k);
}

void kit_close(kit *k)
{
    for (int i = 0; i < KIT_MODELS; i++) free(k->file[i]);
    free((void *)(uintptr_t)k->ball.vertices);
    free((void *)(uintptr_t)k->ball.indices);
    free(k->floats);
}

nacre_material kit_material(const kit *k, kit_model model, int normal)
{
    nacre_material m;
    memset(&m, 0, sizeof m);
    if (model == KIT_SBRDF) {
        m.model = NACRE_MODEL_SBRDF;
        m.image[NACRE_ROLE_ALBEDO] = &k->image[KIT_SBRDF];
        m.image[NACRE_ROLE_LOBES] = &k->image[KIT_LOBES];
        m.image[NACRE_ROLE_POWER] = &k->image[KIT_POWER];
    } else if (is_palette(model)) {
        m.model = NACRE_MODEL_PALETTE;
        m.image[NACRE_ROLE_PALETTE] = &k->image[KIT_PALETTE];
        m.image[NACRE_ROLE_INDEX] = &k->image[model == KIT_BLEND ? KIT_BLEND : KIT_INDEX];
    } else {
        m.model = is_table(model) ? NACRE_MODEL_TABLE : NACRE_MODEL_SPHERES;
        m.image[m.model == NACRE_MODEL_TABLE ? NACRE_ROLE_TABLE : NACRE_ROLE_SPHERES] = &k->image[model];
    }
    if (normal) m.image[NACRE_ROLE_NORMAL] = &k->image[KIT_NORMAL];
    return m;
}

/* ---- views ---------------------------------------------------------------------------------------- */

nacre_view kit_view(int lights, int points, int perspective)
{
    static nacre_light light[NACRE_MAX_LIGHTS];
    /* turned about y by 30 degrees, scaled by 0.8, three units away */
    static const float model[16] = {0.6928f, 0, -0.4f, 0, 0, 0.8f, 0, 0, 0.4f, 0, 0.6928f, 0, -0.15f, -0.4f, -3, 1};
    static const float frustum[16] = {2.4f, 0, 0, 0, 0, 2.4f, 0, 0, 0, 0, -1.5f, -1, 0, 0, -2.5f, 0};
    static const float box[16] = {0.9f, 0, 0, 0, 0, 0.9f, 0, 0, 0, 0, -0.25f, 0, 0, 0, -1, 1};
    nacre_view view;
    memset(&view, 0, sizeof view);
    memset(light, 0, sizeof light);
    for (int i = 0; i < NACRE_MAX_LIGHTS; i++) {
        const double a = 0.8 * i, polar = 0.3 + 0.12 * i;
        light[i].type = i >= lights - points && i < lights ? NACRE_LIGHT_POINT : NACRE_LIGHT_DIRECTIONAL;
        light[i].direction =
            nacre_dir_from_float((float)(sin(polar) * cos(a)), (float)(sin(polar) * sin(a)), (float)cos(polar));
        for (int k = 0; k < 3; k++)
            light[i].position[k] = nacre_q16_from_float((float)(k == 2 ? -1.2 : 1.5 * (k ? sin(a) : cos(a))));
        light[i].power = nacre_rgb_from_float(0.2f + 0.05f * (float)(i % 3), 0.25f, 0.3f - 0.03f * (float)(i % 4));
        light[i].shadow = (int16_t)(i == 1 ? 4096 : 0);
    }
    view.object_to_view = nacre_mat4_from_float(model);
    view.view_to_clip = nacre_mat4_from_float(perspective ? frustum : box);
    view.lights = light;
    view.light_count = (uint8_t)lights;
    view.exposure = NACRE_Q16_ONE;
    return view;
}

/* ---- contexts and frames --------------------------------------------------------------------------- */

int kit_context(gl_headless **out, gl_backend backend, int width, int height)
{
    failure f;
    memset(&f, 0, sizeof f);
    return gl_headless_open(out, backend, width, height, &f) == 0;
}

int kit_difference(const image_u8 *a, const image_u8 *b, int *covered)
{
    int largest = 0, n = 0;
    for (int i = 0; i < a->width * a->height; i++) {
        n += a->texel[4 * i + 3] != 0;
        for (int c = 0; c < 4; c++) {
            const int d = abs(a->texel[4 * i + c] - b->texel[4 * i + c]);
            if (d > largest) largest = d;
        }
    }
    if (covered) *covered = n;
    return largest;
}

/* ---- the object ------------------------------------------------------------------------------------ */

static void note(void *user, nacre_result code, const char *message)
{
    kit_world *w = user;
    const size_t n = strlen(w->log);
    snprintf(w->log + n, sizeof w->log - n, "%d %s\n", (int)code, message);
}

void kit_world_make(kit_world *w, const nacre_gles_desc *desc)
{
    memset(w, 0, sizeof *w);
    if (desc) w->desc = *desc;
    w->desc.get_proc = fake_gl_proc;
    w->desc.log = note;
    w->desc.user = w;
    workspace_make(&w->block, nacre_gles_size(&w->desc), WORKSPACE_FAULT_AFTER);
}

nacre_result kit_world_init(kit_world *w)
{
    return nacre_gles_init(&w->gles, w->block.data, w->block.size, &w->desc);
}

int kit_world_free(kit_world *w)
{
    const int intact = workspace_intact(&w->block);
    workspace_free(&w->block);
    return intact;
}

void kit_hostile_state(int es)
{
    void (*gen_textures)(int, uint32_t *) = (void (*)(int, uint32_t *))(uintptr_t)fake_gl_proc(NULL, "glGenTextures");
    void (*gen_buffers)(int, uint32_t *) = (void (*)(int, uint32_t *))(uintptr_t)fake_gl_proc(NULL, "glGenBuffers");
    void (*active)(unsigned) = (void (*)(unsigned))(uintptr_t)fake_gl_proc(NULL, "glActiveTexture");
    void (*bind_texture)(unsigned, uint32_t) =
        (void (*)(unsigned, uint32_t))(uintptr_t)fake_gl_proc(NULL, "glBindTexture");
    void (*bind_buffer)(unsigned, uint32_t) =
        (void (*)(unsigned, uint32_t))(uintptr_t)fake_gl_proc(NULL, "glBindBuffer");
    void (*store)(unsigned, int) = (void (*)(unsigned, int))(uintptr_t)fake_gl_proc(NULL, "glPixelStorei");
    void (*pointer)(unsigned, int, unsigned, uint8_t, int, const void *) =
        (void (*)(unsigned, int, unsigned, uint8_t, int, const void *))(uintptr_t)fake_gl_proc(NULL,
                                                                                               "glVertexAttribPointer");
    void (*enable_array)(unsigned) = (void (*)(unsigned))(uintptr_t)fake_gl_proc(NULL, "glEnableVertexAttribArray");
    void (*enable)(unsigned) = (void (*)(unsigned))(uintptr_t)fake_gl_proc(NULL, "glEnable");
    void (*viewport)(int, int, int, int) = (void (*)(int, int, int, int))(uintptr_t)fake_gl_proc(NULL, "glViewport");
    uint32_t texture[3], buffer[3];
    gen_textures(3, texture);
    gen_buffers(3, buffer);
    for (unsigned u = 0; u < 3; u++) {
        active(0x84C0 + u);
        bind_texture(0x0DE1, texture[u]);
    }
    active(0x84C0 + 5);
    bind_buffer(0x8892, buffer[0]);
    pointer(0, 2, 0x1401, 1, 20, (const void *)8);
    pointer(3, 4, 0x1406, 0, 0, NULL);
    enable_array(0);
    enable_array(3);
    bind_buffer(0x8892, buffer[1]);
    bind_buffer(0x8893, buffer[2]);
    store(0x0CF5, 8);
    if (es == 3) {
        store(0x0CF2, 100);
        store(0x0CF3, 3);
        bind_buffer(0x88EC, buffer[1]);
    }
    enable(0x0BE2);
    enable(0x0C11);
    enable(0x0B44);
    if (es == 3) enable(0x8C89);
    viewport(3, 5, 77, 99);
}
