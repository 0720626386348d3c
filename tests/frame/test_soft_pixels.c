/* SPDX-License-Identifier: MIT */
/*
 * What the CPU renderer does with pixels once they are shaded, and with lights that stand somewhere, against closed forms in
 * double: alpha blending, alpha test, dither, scissor and dirty rectangles, point lights. Scenes are rectangles whose texels
 * say what they reflect: a diffuse albedo (and lobes) of materials that vary over the surface.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ktx2_write.h"
#include "metric.h"
#include "nacre_asset.h"
#include "nacre_soft.h"
#include "pixels.h"
#include "sbrdf_map.h"

#include <cmocka.h> /* last: it makes a macro of fail */

#define PI 3.14159265358979323846

enum { WIDTH = 64, HEIGHT = 48, BAND = 8, MOST_ITEMS = 3 };

/* ---- rectangles -------------------------------------------------------------------------------------------------- */

/* A material of side x side texels. */
typedef struct cloth {
    sbrdf_map map; /* painted by the test, then written */
    bytes file[2];
    nacre_image image[2];
    nacre_material material;
} cloth;

static void cloth_begin(cloth *c, int side, int lobes)
{
    memset(c, 0, sizeof *c);
    sbrdf_map_make(&c->map, side, side, lobes, 0, 1);
    for (int i = 0; i < side * side; i++) {
        memset(c->map.albedo[0] + 4 * i, 255, 4);
        for (int j = 0; j < lobes; j++) { /* no lobe: albedo 0 */
            memset(c->map.lobe[0] + 4 * (2 * j * side * side + i), 0, 3);
            c->map.lobe[0][4 * (2 * j * side * side + i) + 3] = 255;
        }
    }
}

static void cloth_end(cloth *c)
{
    sbrdf_map_write(&c->map, &c->file[0], &c->file[1]);
    for (int i = 0; i < 2; i++)
        assert_int_equal(nacre_image_open(&c->image[i], c->file[i].data, c->file[i].size), NACRE_OK);
    c->material.model = NACRE_MODEL_SBRDF;
    c->material.image[NACRE_ROLE_ALBEDO] = &c->image[0];
    c->material.image[NACRE_ROLE_LOBES] = &c->image[1];
}

static void cloth_free(cloth *c)
{
    sbrdf_map_free(&c->map);
    for (int i = 0; i < 2; i++) bytes_free(&c->file[i]);
}

/* One diffuse colour. */
static void plain(cloth *c, int red, int green, int blue)
{
    cloth_begin(c, 1, 1);
    c->map.albedo[0][0] = (uint8_t)red;
    c->map.albedo[0][1] = (uint8_t)green;
    c->map.albedo[0][2] = (uint8_t)blue;
    cloth_end(c);
}

/* Corners (+-x, +-y) about the middle, z towards the eye rising by slope x; u v from 0 0 below left to 1 1. */
typedef struct rectangle {
    nacre_vertex vertex[4];
    nacre_mesh mesh;
} rectangle;

static void rectangle_make(rectangle *r, double x, double y, double z, double slope)
{
    static const uint16_t index[6] = {0, 1, 2, 2, 1, 3};
    const double length = hypot(slope, 1);

    memset(r, 0, sizeof *r);
    for (int i = 0; i < 4; i++) {
        nacre_vertex *const v = &r->vertex[i];
        v->position[0] = i & 1 ? 32767 : -32767;
        v->position[1] = i & 2 ? 32767 : -32767;
        v->position[2] = (i & 1) == (slope > 0) ? 32767 : -32767;
        v->normal[0] = (int16_t)lrint(-32767 * slope / length);
        v->normal[2] = (int16_t)lrint(32767 / length);
        v->tangent[0] = (int8_t)lrint(127 / length);
        v->tangent[2] = (int8_t)lrint(127 * slope / length);
        v->tangent[3] = 127;
        v->uv[0] = i & 1 ? 2048 : 0;
        v->uv[1] = i & 2 ? 2048 : 0;
    }
    r->mesh = (nacre_mesh){.vertices = r->vertex, .indices = index, .index_count = 6, .vertex_count = 4};
    r->mesh.centre[2] = (nacre_q16)lrint(65536 * z);
    r->mesh.half_extent[0] = (nacre_q16)lrint(65536 * x);
    r->mesh.half_extent[1] = (nacre_q16)lrint(65536 * y);
    r->mesh.half_extent[2] = (nacre_q16)lrint(65536 * x * fabs(slope));
}

typedef struct stage {
    nacre_soft_desc desc;
    nacre_view view;
    nacre_light light[NACRE_MAX_LIGHTS];
    nacre_soft_item item[MOST_ITEMS];
    int items;
    uint32_t clear;
    int scissor[4];
    uint8_t pixel[WIDTH * HEIGHT * 4];
} stage;

static nacre_mat4 identity(void)
{
    nacre_mat4 m = {{0}};
    for (int i = 0; i < 4; i++) m.m[5 * i] = 65536;
    return m;
}

/* Orthographic over -1..1; one light from the eye, of which a diffuse white reflects 1. */
static void stage_begin(stage *s, int format, int output)
{
    memset(s, 0, sizeof *s);
    s->desc = (nacre_soft_desc){.width = WIDTH,
                                .height = HEIGHT,
                                .format = (uint8_t)format,
                                .band_rows = BAND,
                                .max_vertices = 4 * MOST_ITEMS,
                                .max_triangles = 2 * MOST_ITEMS,
                                .max_items = MOST_ITEMS,
                                .max_lights = NACRE_MAX_LIGHTS,
                                .blend = 1};
    s->view.object_to_view = s->view.view_to_clip = identity();
    s->view.view_to_clip.m[10] = -65536 / 4;
    s->view.output = (uint8_t)output;
    s->view.exposure = 65536;
    s->view.lights = s->light;
    s->view.light_count = 1;
    s->light[0].direction = (nacre_dir){0, 0, 16384};
    s->light[0].power = nacre_rgb_from_float((float)PI, (float)PI, (float)PI);
    s->scissor[2] = WIDTH;
    s->scissor[3] = HEIGHT;
    memset(s->pixel, 0x5A, sizeof s->pixel);
}

static nacre_soft_item *stage_add(stage *s, const rectangle *r, const nacre_material *material)
{
    nacre_soft_item *const item = &s->item[s->items++];
    *item = (nacre_soft_item){.mesh = &r->mesh, .material = material, .object_to_view = identity()};
    return item;
}

static size_t pixel_bytes(const stage *s)
{
    return s->desc.format == NACRE_SOFT_RGBA8 ? 4 : 2;
}

static void stage_draw(stage *s)
{
    void *const block = need_memory(1, nacre_soft_size(&s->desc));
    void *const scratch = need_memory(1, nacre_soft_scratch_size(&s->desc));
    nacre_soft *soft;

    assert_int_equal(nacre_soft_init(&soft, block, nacre_soft_size(&s->desc), &s->desc), NACRE_OK);
    nacre_soft_clear_color(soft, s->clear);
    nacre_soft_scissor(soft, s->scissor[0], s->scissor[1], s->scissor[2], s->scissor[3]);
    assert_int_equal(nacre_soft_prepare(soft, s->item, s->items, &s->view), NACRE_OK);
    assert_int_equal(
        nacre_soft_frame(soft, scratch, nacre_soft_scratch_size(&s->desc), s->pixel, WIDTH * pixel_bytes(s)), NACRE_OK);
    free(block);
    free(scratch);
}

/* Normalised device coordinates of a pixel's centre. */
static double ndc_x(int x)
{
    return (2 * x + 1.0) / WIDTH - 1;
}

static double ndc_y(int y)
{
    return 1 - (2 * y + 1.0) / HEIGHT;
}

static uint32_t code_of(const stage *s, int x, int y, int channel)
{
    return s->pixel[4 * (y * WIDTH + x) + channel];
}

static uint32_t short_of(const stage *s, int x, int y)
{
    const uint8_t *const p = s->pixel + 2 * (y * WIDTH + x);
    uint16_t value;

    memcpy(&value, p, 2);
    return s->desc.format == NACRE_SOFT_RGB565_SWAPPED ? (uint32_t)(value >> 8 | (value & 255) << 8) : value;
}

static double display(double linear)
{
    return 255 * srgb_encode(fmin(fmax(linear, 0), 1));
}

/* ---- alpha ----------------------------------------------------------------------------------------------------------- */

/* Alphas rise to the right and back again, so that they repeat. */
static int ramp(int column)
{
    static const int code[8] = {0, 30, 90, 170, 255, 200, 120, 40};
    return code[column & 7];
}

static void veil(cloth *c, int red, int green, int blue)
{
    cloth_begin(c, 8, 1);
    for (int i = 0; i < 64; i++) {
        const uint8_t texel[4] = {(uint8_t)red, (uint8_t)green, (uint8_t)blue, (uint8_t)ramp(i % 8)};
        memcpy(c->map.albedo[0] + 4 * i, texel, 4);
    }
    cloth_end(c);
}

/* Between texels as GL_LINEAR, GL_REPEAT reads them; codes. u: 0..1. */
static double ramp_at(double u, int clamp)
{
    const double at = 8 * u - .5, whole = floor(at), part = at - whole;
    const int low = (int)whole, high = low + 1;

    if (clamp) return ramp(low < 0 ? 0 : low) * (1 - part) + ramp(high > 7 ? 7 : high) * part;
    return ramp(low + 8) * (1 - part) + ramp(high + 8) * part;
}

static double over(double under, double above, double alpha)
{
    return under + (above - under) * alpha;
}

/* Two veils, the farther one first, over an opaque rectangle in the middle and over a clear colour. Alpha is rounded to a code twice, codes once each
   time: 1.6. */
static void veils_are_blended_in_their_order(void **state)
{
    static const int colour[3][3] = {{40, 120, 200}, {220, 60, 20}, {90, 200, 140}};
    rectangle back, first, second;
    cloth cloths[3];
    stage s;
    int formats, x, y, c;

    (void)state;
    plain(&cloths[0], colour[0][0], colour[0][1], colour[0][2]);
    veil(&cloths[1], colour[1][0], colour[1][1], colour[1][2]);
    veil(&cloths[2], colour[2][0], colour[2][1], colour[2][2]);
    rectangle_make(&back, 1, .5, -1, 0);
    rectangle_make(&first, 1, 1, 0, 0);
    rectangle_make(&second, .5, 1, .5, 0);
    for (formats = 0; formats < 2; formats++) {
        stage_begin(&s, formats ? NACRE_SOFT_RGB565 : NACRE_SOFT_RGBA8, NACRE_OUTPUT_SRGB);
        s.clear = 10u | 20u << 8 | 250u << 16 | 0u << 24;
        stage_add(&s, &back, &cloths[0].material);
        stage_add(&s, &first, &cloths[1].material)->blend = 1;
        stage_add(&s, &second, &cloths[2].material)->blend = 1;
        s.item[2].clamp = 1;
        stage_draw(&s);
        for (y = 0; y < HEIGHT; y++)
            for (x = 0; x < WIDTH; x++) {
                const int opaque = fabs(ndc_y(y)) < .5, twice = fabs(ndc_x(x)) < .5;
                const double a = ramp_at((ndc_x(x) + 1) / 2, 0) / 255, b = ramp_at(ndc_x(x) + .5, 1) / 255;
                double alpha = over(opaque, 1, a);

                for (c = 0; c < 3; c++) {
                    const double steps = c == 1 ? 63 : 31, clear = s.clear >> (8 * c) & 255;
                    double wanted = opaque ? display(colour[0][c] / 255.) : clear;

                    wanted = over(wanted, display(colour[1][c] / 255.), a);
                    if (twice) wanted = over(wanted, display(colour[2][c] / 255.), b);
                    if (!formats) {
                        if (!(fabs(code_of(&s, x, y, c) - wanted) < 1.6))
                            fail_msg("pixel %d %d channel %d: %u, expected %.2f", x, y, c, code_of(&s, x, y, c),
                                     wanted);
                    } else { /* three times to the nearest of the steps: half of one each time, less what is faded */
                        const uint32_t p = short_of(&s, x, y);
                        const double found = c == 0 ? p >> 11 : c == 1 ? p >> 5 & 63 : p & 31;
                        assert_true(fabs(found - wanted * steps / 255) < 1.5 + 1.6 * steps / 255);
                    }
                }
                if (twice) alpha = over(alpha, 1, b);
                if (!formats) assert_true(fabs(code_of(&s, x, y, 3) - 255 * alpha) < 1.6);
            }
    }
    for (c = 0; c < 3; c++) cloth_free(&cloths[c]);
}

/* A mask of two or four channels for a material that has no opacity of its own: here a lit sphere of one colour. */
static void make_mask(bytes *file, nacre_image *image, int channels)
{
    ktx2_image k = {.width = 8, .height = 1, .faces = 1, .levels = 1};
    uint8_t texel[32];

    k.format = channels == 2 ? NACRE_FORMAT_RG8 : NACRE_FORMAT_RGBA8;
    for (int i = 0; i < 8 * channels; i++) texel[i] = (uint8_t)(i % channels == channels - 1 ? ramp(i / channels) : 77);
    bytes_append(&k.level[0], texel, (size_t)(8 * channels));
    ktx2_key_text(&k, NACRE_KEY_ROLE, "mask");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "linear");
    ktx2_write(&k, file);
    ktx2_free(&k);
    assert_int_equal(nacre_image_open(image, file->data, file->size), NACRE_OK);
}

static const uint32_t *one_colour(void)
{
    static uint32_t texel[64];

    for (int i = 0; i < 64; i++) texel[i] = 200u | 100u << 8 | 50u << 16 | 255u << 24;
    return texel;
}

static void masks_fade_lit_spheres(void **state)
{
    const nacre_soft_lit lit = {one_colour(), 8};
    rectangle r;
    cloth c;
    stage s;

    (void)state;
    plain(&c, 255, 255, 255);
    rectangle_make(&r, 1, 1, 0, 0);
    for (int channels = 2; channels <= 4; channels += 2) {
        nacre_material material = c.material;
        nacre_image mask;
        bytes file = {0};

        make_mask(&file, &mask, channels);
        material.image[NACRE_ROLE_MASK] = &mask;
        stage_begin(&s, NACRE_SOFT_RGBA8, NACRE_OUTPUT_SRGB);
        s.clear = 255u << 24 | 30u;
        stage_add(&s, &r, &material)->blend = 1;
        s.item[0].lit = &lit;
        stage_draw(&s);
        for (int x = 0; x < WIDTH; x++) {
            const double alpha = ramp_at((ndc_x(x) + 1) / 2, 0) / 255;
            assert_true(fabs(code_of(&s, x, 9, 0) - over(30, 200, alpha)) < 1.1);
            assert_true(fabs(code_of(&s, x, 9, 1) - over(0, 100, alpha)) < 1.1);
            assert_int_equal(code_of(&s, x, 9, 3), 255);
        }
        bytes_free(&file);
    }
    cloth_free(&c);
}

/* A grid in front, drawn first: where its alpha is below the threshold, what is behind it shows, so depth was not written
   either. */
static void thin_pixels_are_not_there(void **state)
{
    static const int least[] = {1, 60, 128, 255};
    rectangle front, behind;
    cloth grid, wall;
    stage s;
    int seen = 0, through = 0;

    (void)state;
    veil(&grid, 200, 0, 0);
    plain(&wall, 0, 200, 0);
    rectangle_make(&front, 1, 1, .5, 0);
    rectangle_make(&behind, 1, 1, -.5, 0);
    for (int i = 0; i < 8; i++) {
        const int nearest = i >= 4, threshold = least[i % 4];
        stage_begin(&s, NACRE_SOFT_RGBA8, NACRE_OUTPUT_LINEAR);
        stage_add(&s, &front, &grid.material)->alpha_test = (uint8_t)threshold;
        s.item[0].nearest = (uint8_t)nearest;
        stage_add(&s, &behind, &wall.material);
        stage_draw(&s);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const double u = (ndc_x(x) + 1) / 2, alpha = nearest ? ramp((int)(8 * u)) : ramp_at(u, 0);
                const int drawn = code_of(&s, x, y, 0) > 100;

                assert_int_equal(code_of(&s, x, y, 1) > 100, !drawn);
                /* rounded to a code; filters have 256 steps */
                if (alpha > threshold - .5 + .4) assert_true(drawn);
                if (alpha < threshold - .5 - .4) assert_false(drawn);
                seen += drawn;
                through += !drawn;
            }
    }
    assert_true(seen > WIDTH && through > WIDTH);
    cloth_free(&grid);
    cloth_free(&wall);
}

/* ---- dither ---------------------------------------------------------------------------------------------------------- */

/* Every pixel is the step below or above the colour; so many of each 16 that their mean is within 1/16 below it. */
static void look_at_block(const stage *s, int x0, int y0, int channel, double low, double high)
{
    const int shift = channel == 0 ? 11 : channel == 1 ? 5 : 0, most = channel == 1 ? 63 : 31;
    double sum = 0;

    low *= most / 255.;
    high *= most / 255.;
    for (int i = 0; i < 16; i++) {
        const double found = short_of(s, x0 + i % 4, y0 + i / 4) >> shift & (uint32_t)most;
        if (!(found > low - 1 && found < high + 1))
            fail_msg("pixel %d %d channel %d: %.0f, expected %.2f", x0 + i % 4, y0 + i / 4, channel, found, low);
        sum += found;
    }
    assert_true(sum / 16 <= high + 1e-9 && sum / 16 > low - 1 / 16. - 1e-9);
}

static void dither_keeps_the_mean(void **state)
{
    rectangle r;
    cloth c;
    stage s;

    (void)state;
    cloth_begin(&c, 16, 1);
    for (int i = 0; i < 256; i++)
        for (int k = 0; k < 3; k++) c.map.albedo[0][4 * i + k] = (uint8_t)(k == 1 ? 255 - i : i);
    cloth_end(&c);
    rectangle_make(&r, 1, 64. / HEIGHT, 0, 0); /* 64 x 64 pixels, of which 48 rows are seen: 4 x 4 a texel */
    for (int swapped = 0; swapped < 2; swapped++) {
        stage_begin(&s, swapped ? NACRE_SOFT_RGB565_SWAPPED : NACRE_SOFT_RGB565, NACRE_OUTPUT_LINEAR);
        s.desc.dither = 1;
        stage_add(&s, &r, &c.material)->nearest = 1;
        stage_draw(&s);
        for (int y = 0; y < HEIGHT; y += 4)
            for (int x = 0; x < WIDTH; x += 4) {
                const int i = (y / 4 + 2) * 16 + x / 4;
                for (int k = 0; k < 3; k++) /* codes are 1 off at most */
                    look_at_block(&s, x, y, k, (k == 1 ? 255 - i : i) - 1, (k == 1 ? 255 - i : i) + 1);
            }
    }
    /* the clear colour exactly, from any pixel on */
    for (int code = 0; code < 256; code++) {
        stage_begin(&s, NACRE_SOFT_RGB565, NACRE_OUTPUT_LINEAR);
        s.desc.dither = 1;
        s.clear = (uint32_t)code * 0x010101u;
        s.scissor[0] = code % 4;
        s.scissor[1] = code / 4 % 4;
        stage_draw(&s);
        for (int k = 0; k < 3; k++) look_at_block(&s, 8 + code % 3, 12, k, code, code);
    }
    cloth_free(&c);
}

/* ---- scissor --------------------------------------------------------------------------------------------------------- */

static uint32_t seed = 1;
static int roll(int below)
{
    seed = seed * 1664525u + 1013904223u;
    return (int)((uint64_t)seed * (uint64_t)below >> 32);
}

enum { GREY = 204, CLEARED = 17 };
static const double half_x = .62, half_y = .7;

/* A grey rectangle in the middle. */
static void grey_rectangle(cloth *c, rectangle *r)
{
    plain(c, GREY, GREY, GREY);
    rectangle_make(r, half_x, half_y, 0, 0);
}

/* What green is there: the rectangle's, within a code, or the clear colour's. */
static int is_drawn(uint32_t green, int x, int y)
{
    const int covered = fabs(ndc_x(x)) < half_x && fabs(ndc_y(y)) < half_y;
    return abs((int)green - (covered ? GREY : CLEARED)) <= covered;
}

/* Inside: the rectangle or the clear colour. Outside: what was there. */
static void look_at_scissor(const stage *s)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const int inside = x >= s->scissor[0] && x < s->scissor[2] && y >= s->scissor[1] && y < s->scissor[3];
            const uint32_t green = code_of(s, x, y, 1);

            assert_true(inside ? is_drawn(green, x, y) : green == 0x5A);
        }
}

static void nothing_is_touched_outside_the_scissor(void **state)
{
    rectangle r;
    cloth c;
    stage s;

    (void)state;
    grey_rectangle(&c, &r);
    for (int i = 0; i < 200; i++) {
        stage_begin(&s, NACRE_SOFT_RGBA8, NACRE_OUTPUT_LINEAR);
        s.clear = (uint32_t)CLEARED << 8;
        s.scissor[0] = roll(WIDTH + 20) - 10;
        s.scissor[1] = roll(HEIGHT + 20) - 10;
        s.scissor[2] = s.scissor[0] + roll(WIDTH);
        s.scissor[3] = s.scissor[1] + roll(HEIGHT);
        stage_add(&s, &r, &c.material)->blend = (uint8_t)roll(2);
        stage_draw(&s);
        look_at_scissor(&s);
    }
    cloth_free(&c);
}

/* A panel that keeps what it was sent: only bands with dirty rows are sent, and only dirty columns of them are new. */
typedef struct panel {
    uint8_t seen[HEIGHT];
    const stage *s;
} panel;

static int send(void *user, int y0, int y1, void *pixels, size_t stride)
{
    panel *const p = user;

    for (int y = y0; y < y1; y++) {
        p->seen[y]++;
        for (int x = p->s->scissor[0]; x < p->s->scissor[2]; x++) {
            const uint8_t *const at = (uint8_t *)pixels + (size_t)(y - y0) * stride + 4 * (size_t)x;
            if (y >= p->s->scissor[1] && y < p->s->scissor[3]) assert_true(is_drawn(at[1], x, y));
        }
    }
    return 0;
}

static void only_dirty_bands_are_sent(void **state)
{
    static uint8_t band[2][BAND * WIDTH * 4];
    rectangle r;
    cloth c;
    stage s;

    (void)state;
    grey_rectangle(&c, &r);
    for (int i = 0; i < 40; i++) {
        panel p = {{0}, &s};
        nacre_soft *soft;
        void *block, *scratch;

        stage_begin(&s, NACRE_SOFT_RGBA8, NACRE_OUTPUT_LINEAR);
        stage_add(&s, &r, &c.material);
        s.scissor[0] = roll(WIDTH);
        s.scissor[1] = roll(HEIGHT);
        s.scissor[2] = s.scissor[0] + roll(WIDTH - s.scissor[0] + 1);
        s.scissor[3] = s.scissor[1] + 1 + roll(HEIGHT - s.scissor[1]);
        block = need_memory(1, nacre_soft_size(&s.desc));
        scratch = need_memory(1, nacre_soft_scratch_size(&s.desc));
        assert_int_equal(nacre_soft_init(&soft, block, nacre_soft_size(&s.desc), &s.desc), NACRE_OK);
        nacre_soft_clear_color(soft, (uint32_t)CLEARED << 8);
        nacre_soft_scissor(soft, s.scissor[0], s.scissor[1], s.scissor[2], s.scissor[3]);
        assert_int_equal(nacre_soft_prepare(soft, s.item, s.items, &s.view), NACRE_OK);
        assert_int_equal(nacre_soft_bands(soft, scratch, nacre_soft_scratch_size(&s.desc), band[0],
                                          i % 2 ? band[1] : NULL, WIDTH * 4, send, &p),
                         0);
        for (int y = 0; y < HEIGHT; y++) {
            const int first = y / BAND * BAND;
            assert_int_equal(p.seen[y], first < s.scissor[3] && first + BAND > s.scissor[1]);
        }
        free(block);
        free(scratch);
    }
    cloth_free(&c);
}

/* ---- point lights ------------------------------------------------------------------------------------------------------ */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double unit(const double v[3], double out[3])
{
    const double length = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++) out[i] = v[i] / length;
    return length;
}

typedef struct tilted { /* the plane z = depth + slope x */
    double depth, slope;
    int perspective; /* the eye is at the origin, the frame 2 x 2 at distance 1.5 */
} tilted;

/* Where pixel (x, y) sees the plane. */
static void seen_at(const tilted *t, int x, int y, double at[3])
{
    if (!t->perspective) {
        at[0] = ndc_x(x);
        at[1] = ndc_y(y);
        at[2] = t->depth + t->slope * at[0];
    } else { /* along s (x, y, -1.5) */
        const double s = t->depth / (-1.5 - t->slope * ndc_x(x));
        at[0] = s * ndc_x(x);
        at[1] = s * ndc_y(y);
        at[2] = -1.5 * s;
    }
}

/* Lafortune's model: diffuse .5, and a forward lobe .4 max(-t.l t.v - b.l b.v + n.l n.v, 0)^n; pi f_r. */
static double reflected(const tilted *t, const double at[3], const double place[3], double strength, double n)
{
    const double length = hypot(t->slope, 1), normal[3] = {-t->slope / length, 0, 1 / length};
    const double tangent[3] = {1 / length, 0, t->slope / length}, bitangent[3] = {0, 1, 0};
    const double back[3] = {-at[0], -at[1], -at[2]}, way[3] = {place[0] - at[0], place[1] - at[1], place[2] - at[2]};
    double eye[3] = {0, 0, 1}, l[3], x, distance = unit(way, l);

    if (t->perspective) unit(back, eye);
    x = dot(normal, l) * dot(normal, eye) - dot(tangent, l) * dot(tangent, eye) -
        dot(bitangent, l) * dot(bitangent, eye);
    return (.5 + (x > 0 ? .4 * pow(x, n) : 0)) / PI * fmax(dot(normal, l), 0) * strength / (distance * distance);
}

static void lamps_stand_where_they_are(void **state)
{
    static const tilted plane[3] = {{-2, .4, 0}, {-3, .8, 1}, {-2.2, -.5, 1}};
    static const double place[2][3] = {{.3, .4, -1.2}, {-.6, -.2, -1.5}}, strength[2] = {2.5, 1};
    double error = 0;
    cloth c;

    (void)state;
    cloth_begin(&c, 1, 1);
    c.map.albedo_most = .5;
    c.map.most[0] = .4;
    {
        uint8_t *const lobe = c.map.lobe[0];
        memset(lobe, 255, 3);
        lobe[4] = lobe[5] = (uint8_t)sbrdf_shape_code(-1, 1);
        lobe[6] = (uint8_t)sbrdf_shape_code(1, 1);
        lobe[7] = (uint8_t)sbrdf_exponent_code(40);
    }
    cloth_end(&c);
    for (int k = 0; k < 3; k++) {
        const tilted *const t = &plane[k];
        const double n = sbrdf_exponent_value(c.map.lobe[0][7]), size = t->perspective ? 4 : 1.5;
        rectangle r;
        stage s;
        int count = 0;

        rectangle_make(&r, size, size, t->depth, t->slope);
        stage_begin(&s, NACRE_SOFT_RGBA8, NACRE_OUTPUT_SRGB);
        s.view.view_to_clip.m[0] = s.view.view_to_clip.m[5] = t->perspective ? 98304 : 65536; /* 1.5 */
        if (t->perspective) {                                                                 /* near .25, far 16 */
            s.view.view_to_clip.m[10] = (nacre_q16)lrint(65536 * (16.25 / -15.75));
            s.view.view_to_clip.m[14] = (nacre_q16)lrint(65536 * (8 / -15.75));
            s.view.view_to_clip.m[11] = -65536;
            s.view.view_to_clip.m[15] = 0;
        }
        s.view.light_count = 2;
        for (int i = 0; i < 2; i++) {
            s.light[i] = (nacre_light){.type = NACRE_LIGHT_POINT};
            for (int a = 0; a < 3; a++) s.light[i].position[a] = (nacre_q16)lrint(65536 * place[i][a]);
            s.light[i].power = nacre_rgb_from_float((float)strength[i], (float)strength[i], (float)strength[i]);
        }
        stage_add(&s, &r, &c.material)->cull = NACRE_SOFT_CULL_NONE;
        stage_draw(&s);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                double at[3], wanted, off;

                seen_at(t, x, y, at);
                if (fabs(at[0]) > size || fabs(at[1]) > size || -at[2] < .3 || -at[2] > 15) continue;
                wanted =
                    display(reflected(t, at, place[0], strength[0], n) + reflected(t, at, place[1], strength[1], n));
                off = fabs(code_of(&s, x, y, 0) - wanted);
                error = fmax(error, off);
                /* half a code of rounding, and places from 16 bits of depth */
                if (off > 1.5)
                    fail_msg("plane %d, pixel %d %d: %u, expected %.2f", k, x, y, code_of(&s, x, y, 0), wanted);
                count++;
            }
        assert_true(count > WIDTH * HEIGHT / 2);
    }
    print_message("point lights: at most %.2f codes off\n", error);
    cloth_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(veils_are_blended_in_their_order),
        cmocka_unit_test(masks_fade_lit_spheres),
        cmocka_unit_test(thin_pixels_are_not_there),
        cmocka_unit_test(dither_keeps_the_mean),
        cmocka_unit_test(nothing_is_touched_outside_the_scissor),
        cmocka_unit_test(only_dirty_bands_are_sent),
        cmocka_unit_test(lamps_stand_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
