/* SPDX-License-Identifier: MIT */
/*
 * The assembled texts compiled and linked by the drivers here, and what the linked program needs against what the
 * runtime believes it needs (key.h): texts of 0, 1, 2 and the most lights, for a light more repeats a line; GLSL ES 1.00
 * on OSMesa and ES 2, GLSL ES 3.00 on OSMesa and ES 3. With NACRE_LONG=1 every text on every driver that takes it.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers.h"
#include "key.h"
#include "uniforms.h"

#include <cmocka.h> /* last: it makes a macro of fail */

#define ACTIVE_UNIFORMS 0x8B86
#define SAMPLER_2D      0x8B5E

static struct {
    unsigned (*CreateShader)(unsigned kind);
    void (*ShaderSource)(unsigned shader, int count, const char *const *text, const int *length);
    void (*CompileShader)(unsigned shader);
    void (*GetShaderiv)(unsigned shader, unsigned name, int *out);
    void (*GetShaderInfoLog)(unsigned shader, int size, int *length, char *out);
    void (*DeleteShader)(unsigned shader);
    unsigned (*CreateProgram)(void);
    void (*AttachShader)(unsigned program, unsigned shader);
    void (*BindAttribLocation)(unsigned program, unsigned index, const char *name);
    void (*LinkProgram)(unsigned program);
    void (*GetProgramiv)(unsigned program, unsigned name, int *out);
    void (*GetProgramInfoLog)(unsigned program, int size, int *length, char *out);
    void (*GetActiveUniform)(unsigned program, unsigned i, int size, int *length, int *count, unsigned *type,
                             char *name);
    void (*DeleteProgram)(unsigned program);
    unsigned (*GetError)(void);
} gl;

static void load_all(void)
{
#define LOAD(name)                                                                                                     \
    do {                                                                                                               \
        void *p = gl_headless_proc(NULL, "gl" #name);                                                                  \
        memcpy(&gl.name, &p, sizeof p);                                                                                \
    } while (0)
    LOAD(CreateShader);
    LOAD(ShaderSource);
    LOAD(CompileShader);
    LOAD(GetShaderiv);
    LOAD(GetShaderInfoLog);
    LOAD(DeleteShader);
    LOAD(CreateProgram);
    LOAD(AttachShader);
    LOAD(BindAttribLocation);
    LOAD(LinkProgram);
    LOAD(GetProgramiv);
    LOAD(GetProgramInfoLog);
    LOAD(GetActiveUniform);
    LOAD(DeleteProgram);
    LOAD(GetError);
#undef LOAD
}

static unsigned compile(const gles_key *key, int fragment)
{
    const char *part[GLES_TEXT_PARTS];
    int length[GLES_TEXT_PARTS], ok = 0;
    char defines[GLES_DEFINES_SIZE], name[GLES_KEY_NAME_SIZE], log[2000] = "";
    const int parts = gles_text(key, fragment, part, length, defines);
    const unsigned shader = gl.CreateShader(fragment ? GLES_FRAGMENT_SHADER : GLES_VERTEX_SHADER);

    gl.ShaderSource(shader, parts, part, length);
    gl.CompileShader(shader);
    gl.GetShaderiv(shader, GLES_COMPILE_STATUS, &ok);
    if (ok) return shader;
    gl.GetShaderInfoLog(shader, sizeof log, NULL, log);
    gles_key_name(key, name);
    printf("%s.%s: %s\n", name, fragment ? "frag" : "vert", log);
    gl.DeleteShader(shader);
    return 0;
}

/* The vertex stages are few: kept from text to text, by the #defines that make them. */
static unsigned vertex_stage(const gles_key *key)
{
    enum { MOST = 256 };
    static struct {
        char defines[GLES_DEFINES_SIZE];
        unsigned shader;
    } kept[MOST];
    const char *part[GLES_TEXT_PARTS];
    int length[GLES_TEXT_PARTS], i = 0;
    char defines[GLES_DEFINES_SIZE];

    gles_text(key, 0, part, length, defines);
    while (i < MOST && kept[i].shader && strcmp(kept[i].defines, defines)) i++;
    if (i == MOST) return compile(key, 0);
    if (!kept[i].shader) {
        memcpy(kept[i].defines, defines, sizeof defines);
        kept[i].shader = compile(key, 0);
    }
    return kept[i].shader;
}

static int is_vertex_uniform(const char *name)
{
    static const char *const names[] = {"u_clip", "u_view", "u_normal", "u_tangent", "u_extent", "u_centre", "u_uv"};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(name, names[i])) return 1;
    return 0;
}

/* A driver may leave out what it finds unused, so it can only need less, and units are all in use. */
static int needs_what_was_said(const gles_key *key, unsigned program)
{
    unsigned vectors = 0, units = 0;
    char name[GLES_KEY_NAME_SIZE];
    int count = 0;

    gl.GetProgramiv(program, ACTIVE_UNIFORMS, &count);
    for (int i = 0; i < count; i++) {
        char uniform[64] = "";
        unsigned type = 0;
        int elements = 0;

        gl.GetActiveUniform(program, (unsigned)i, sizeof uniform, NULL, &elements, &type, uniform);
        if (type == SAMPLER_2D)
            units += (unsigned)elements;
        else if (!is_vertex_uniform(uniform))
            vectors += (unsigned)elements;
    }
    const unsigned said = gles_key_uniform_vectors(key);
    if (vectors == said && units == gles_key_units(key)) return 1;
    gles_key_name(key, name);
    printf("%s: %u uniform vectors and %u units, key.h says %u and %u\n", name, vectors, units, said,
           gles_key_units(key));
    return 0;
}

static int build(const gles_key *key)
{
    char name[GLES_KEY_NAME_SIZE], log[2000] = "";
    const unsigned vertex = vertex_stage(key), fragment = compile(key, 1);
    int ok = 0;

    if (!vertex || !fragment) return 0;
    const unsigned program = gl.CreateProgram();
    gl.AttachShader(program, vertex);
    gl.AttachShader(program, fragment);
    for (unsigned i = 0; gles_attribute_name(i); i++) gl.BindAttribLocation(program, i, gles_attribute_name(i));
    gl.LinkProgram(program);
    gl.GetProgramiv(program, GLES_LINK_STATUS, &ok);
    if (!ok) {
        gl.GetProgramInfoLog(program, sizeof log, NULL, log);
        gles_key_name(key, name);
        printf("%s: link: %s\n", name, log);
    }
    ok = ok && needs_what_was_said(key, program);
    gl.DeleteProgram(program);
    gl.DeleteShader(fragment);
    return ok;
}

static int by_bytes(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(gles_key));
}

/* list is sorted. */
static int has_lights(const gles_key *list, unsigned count, gles_key key, unsigned lights)
{
    key.lights = (uint8_t)lights;
    return bsearch(&key, list, count, sizeof key, by_bytes) != NULL;
}

static int is_chosen(const gles_key *key, const gles_key *list, unsigned count, const driver *d)
{
    if (key->es3 && d->backend == GL_BACKEND_EGL2) return 0;
    if (getenv("NACRE_LONG")) return 1;
    if (!key->es3 && d->backend == GL_BACKEND_EGL3) return 0;
    for (unsigned more = key->lights + 1u; key->lights > 2 && more <= NACRE_MAX_LIGHTS; more++)
        if (has_lights(list, count, *key, more)) return 0;
    return 1;
}

static int run_driver(int index)
{
    const driver *d = &drivers[index];
    const unsigned count = gles_key_list(NULL, 0);
    gles_key *key = calloc(count, sizeof *key);
    gl_headless *context;
    failure f = {0};
    unsigned built = 0, failed = 0;

    if (!key) return 70;
    if (gl_headless_open(&context, d->backend, 16, 16, &f)) {
        printf("SKIPPED: driver %s: %s\n", d->name, f.text);
        free(key);
        return DRIVER_SKIPPED;
    }
    load_all();
    gles_key_list(key, count);
    qsort(key, count, sizeof *key, by_bytes);
    for (unsigned i = 0; i < count && failed < 20; i++) {
        if (!is_chosen(&key[i], key, count, d)) continue;
        built++;
        failed += !build(&key[i]);
    }
    if (gl.GetError()) failed++;
    printf("%s: %u of %u programs, %u failed\n", d->name, built, count, failed);
    gl_headless_close(context);
    free(key);
    return failed ? 1 : 0;
}

static void test_driver(void **state)
{
    const int code = driver_run((int)(intptr_t)*state, "compile");

    if (code == DRIVER_SKIPPED) skip();
    assert_int_equal(code, 0);
}

int main(int argc, char **argv)
{
    /* the other drivers share their compiler with one of these */
    const struct CMUnitTest tests[] = {
        {"osmesa", test_driver, NULL, NULL, (void *)(intptr_t)0},
        {"egl gles 2", test_driver, NULL, NULL, (void *)(intptr_t)1},
        {"egl gles 3", test_driver, NULL, NULL, (void *)(intptr_t)2},
    };
    const char *argument;
    const int index = driver_of_arguments(argc, argv, &argument);

    return index >= 0 ? run_driver(index) : cmocka_run_group_tests(tests, NULL, NULL);
}
