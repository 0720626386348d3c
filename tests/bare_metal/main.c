/* SPDX-License-Identifier: MIT */
/*
 * The teapot on a microcontroller: two frames of 320 x 240 in RGB565, one by a lit sphere and one by a table under one
 * light, band by band with two band buffers, written out by semihosting to the file frame.rgb565. On a host the same
 * program writes with stdio; both files must be equal.
 *
 * Prints the bytes of RAM in use and, on the microcontroller, instructions: SysTick counts them when qemu runs with
 * -icount shift=0 (one a nanosecond; 25 MHz make a tick of 40).
 */
#include <string.h>

#include "nacre_soft.h"
#include "scene_example.h"

enum { BAND = 8, PATCH = 2 };

static void write_pixels(const void *data, size_t size);
static void say(const char *text);
static uint32_t ticks(void);

/* ---- RAM: everything but the stack ------------------------------------------------------------------------------------------ */

static uint32_t block[34 * 1024 / 4];
static uint32_t scratch[(EXAMPLE_WIDTH * BAND * 9 + 128) / 4];
static uint16_t colour[2][EXAMPLE_WIDTH * BAND];

static void say_number(const char *text, uint32_t x)
{
    char line[80];
    size_t n = strlen(text), digits = 1;
    uint32_t rest;

    memcpy(line, text, n);
    for (rest = x; rest > 9; rest /= 10) digits++;
    line[n + digits] = '\n';
    line[n + digits + 1] = 0;
    while (digits--) {
        line[n + digits] = (char)('0' + x % 10);
        x /= 10;
    }
    say(line);
}

static int send_band(void *user, int y0, int y1, void *pixels, size_t stride)
{
    (void)user;
    write_pixels(pixels, stride * (size_t)(y1 - y0));
    return 0;
}

static int count_band(void *user, int y0, int y1, void *pixels, size_t stride)
{
    (void)user, (void)y0, (void)y1, (void)pixels, (void)stride;
    return 0;
}

static const nacre_soft_desc desc = {.width = EXAMPLE_WIDTH,
                                     .height = EXAMPLE_HEIGHT,
                                     .format = NACRE_SOFT_RGB565,
                                     .band_rows = BAND,
                                     .max_vertices = 1000,
                                     .max_triangles = 1000,
                                     .table_columns = 24,
#ifdef EXAMPLE_KERNELS
                                     .kernels = &EXAMPLE_KERNELS
#endif
};

static int draw(nacre_soft *soft, nacre_soft_ready *ready)
{
    return nacre_soft_bands(soft, scratch, sizeof scratch, colour[0], colour[1], EXAMPLE_WIDTH * 2, ready, NULL);
}

/* A frame with its figures. */
static int frame(nacre_soft *soft, const char *name, const nacre_soft_item *item, const nacre_view *view)
{
    uint32_t start, prepared, drawn;
    int r;

    say(name);
    start = ticks();
    r = nacre_soft_prepare(soft, item, 1, view);
    prepared = ticks();
    if (!r) r = draw(soft, count_band);
    drawn = ticks();
    if (drawn != start) {
        say_number(": prepare, instructions: ", (prepared - start) * 40);
        say_number("bands, instructions: ", (drawn - prepared) * 40);
    } else {
        say("\n");
    }
    return r ? r : draw(soft, send_band);
}

/* A square that fills the frame, its normals a dome: instructions a pixel, almost without triangles. */
static int per_pixel(nacre_soft *soft, const char *name, nacre_soft_item item, const nacre_view *view)
{
    static nacre_vertex vertex[(PATCH + 1) * (PATCH + 1)];
    static uint16_t index[PATCH * PATCH * 6];
    nacre_mesh mesh = {
        vertex, index, PATCH * PATCH * 6, (PATCH + 1) * (PATCH + 1), {0, 0, 0}, {131072, 131072, 131072}};
    uint32_t start, drawn;
    int i, n = 0, r;

    for (i = 0; i < (PATCH + 1) * (PATCH + 1); i++) {
        const int x = 2 * (i % (PATCH + 1)) - PATCH, y = 2 * (i / (PATCH + 1)) - PATCH;

        vertex[i].position[0] = (int16_t)(x * 32767 / PATCH);
        vertex[i].position[1] = (int16_t)(y * 32767 / PATCH);
        vertex[i].normal[0] = (int16_t)(x * 10000);
        vertex[i].normal[1] = (int16_t)(y * 10000);
        vertex[i].normal[2] = 20000;
    }
    for (i = 0; i < PATCH * PATCH; i++) {
        const uint16_t at = (uint16_t)(i / PATCH * (PATCH + 1) + i % PATCH), up = (uint16_t)(at + PATCH + 1);
        const uint16_t corner[6] = {at, (uint16_t)(at + 1), (uint16_t)(up + 1), at, (uint16_t)(up + 1), up};

        memcpy(index + n, corner, sizeof corner);
        n += 6;
    }
    item.mesh = &mesh;
    memset(&item.object_to_view, 0, sizeof item.object_to_view);
    for (i = 0; i < 16; i += 5) item.object_to_view.m[i] = 65536;
    item.object_to_view.m[14] = -131072;
    r = nacre_soft_prepare(soft, &item, 1, view);
    start = ticks();
    if (!r) r = draw(soft, count_band);
    drawn = ticks();
    if (drawn != start) {
        say(name);
        say_number(": tenths of an instruction a pixel: ",
                   (drawn - start) * 40 / (EXAMPLE_WIDTH * EXAMPLE_HEIGHT / 10));
    }
    return r;
}

int main(void)
{
    const nacre_soft_lit lit = {example_lit, EXAMPLE_LIT};
    nacre_material material = {NACRE_MODEL_TABLE, {0}};
    nacre_soft_item item = {.mesh = &example_mesh};
    nacre_light lights[EXAMPLE_LIGHTS];
    nacre_image table;
    nacre_view view;
    nacre_soft *soft;
    int r = nacre_image_open(&table, example_table, example_table_size);

    say_number("RAM: object ", (uint32_t)nacre_soft_size(&desc));
    say_number("RAM: scratch ", (uint32_t)nacre_soft_scratch_size(&desc));
    if (!r) r = nacre_soft_init(&soft, block, sizeof block, &desc);
    if (r) return 1;
    example_view(&view, lights, 1);
    item.object_to_view = view.object_to_view;
    material.image[NACRE_ROLE_TABLE] = &table;
    nacre_soft_clear_color(soft, 0x00302820);
    item.lit = &lit;
    r = frame(soft, "lit sphere", &item, &view);
    if (!r) r = per_pixel(soft, "lit sphere", item, &view);
    item.lit = NULL;
    item.material = &material;
    if (!r) r = frame(soft, "table", &item, &view);
    if (!r) r = per_pixel(soft, "table", item, &view);
    return r != 0;
}

/* ---- the board ---------------------------------------------------------------------------------------------------------------- */

#ifdef __ARM_ARCH_PROFILE
extern uint32_t _sidata, _sdata, _edata, __bss_start__, __bss_end__, _stack;

#define SYST_CSR (*(volatile uint32_t *)0xE000E010)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018)

static volatile uint32_t wraps;

static int semihost(int operation, const void *argument)
{
    register int r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = argument;

    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void say(const char *text)
{
    semihost(4, text);
}

static void write_pixels(const void *data, size_t size)
{
    static uintptr_t file;
    uintptr_t argument[3];

    if (!file) {
        const uintptr_t open[3] = {(uintptr_t) "frame.rgb565", 5, 12}; /* wb */

        file = (uintptr_t)semihost(1, open);
    }
    argument[0] = file;
    argument[1] = (uintptr_t)data;
    argument[2] = size;
    semihost(5, argument);
}

static uint32_t ticks(void)
{
    const uint32_t w = wraps, now = SYST_CVR;

    return w * 0x1000000u + (0xFFFFFFu - now);
}

static void stop(int code)
{
    const uintptr_t exit_argument[2] = {0x20026, (uintptr_t)code};

    semihost(0x20, exit_argument);
    for (;;) continue;
}

static void reset(void)
{
    uint32_t *from = &_sidata, *to = &_sdata;

    while (to < &_edata) *to++ = *from++;
    for (to = &__bss_start__; to < &__bss_end__;) *to++ = 0;
    SYST_RVR = 0xFFFFFF;
    SYST_CVR = 0;
    SYST_CSR = 7;
    stop(main());
}

static void tick(void)
{
    wraps++;
}

static void fault(void)
{
    say("fault\n");
    stop(99);
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    (void (*)(void)) & _stack, reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, 0, 0, fault, tick};
#else
#include <stdio.h>

static void say(const char *text)
{
    fputs(text, stdout);
}

static void write_pixels(const void *data, size_t size)
{
    static FILE *file;

    if (!file) file = fopen("frame.rgb565", "wb");
    if (file) fwrite(data, 1, size, file);
    if (file) fflush(file);
}

static uint32_t ticks(void)
{
    return 0;
}
#endif
