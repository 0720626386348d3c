/* SPDX-License-Identifier: MIT */
/* Programs by key: compiled when first needed, the least recently used dropped. */
#include "gles.h"

#include <string.h>

#define LOG_SIZE  1024
#define LINE_SIZE 160

/* Send the shader's text to the log, one message a line, as "  12: text", so that the driver's numbers can be read. */
static void log_source(nacre_gles *gles, const char *const *part, const int *length, int parts)
{
    char line[LINE_SIZE];
    unsigned number = 1, n = 0;
    int i, k;
    for (i = 0; i < parts; i++) {
        for (k = 0; k < length[i]; k++) {
            if (!n) {
                line[n++] = (char)(number >= 100 ? '0' + number / 100 % 10 : ' ');
                line[n++] = (char)(number >= 10 ? '0' + number / 10 % 10 : ' ');
                line[n++] = (char)('0' + number % 10);
                line[n++] = ':';
                line[n++] = ' ';
            }
            if (part[i][k] != '\n') {
                if (n < sizeof line - 1) line[n++] = part[i][k];
                continue;
            }
            line[n] = 0;
            gles_fail(gles, NACRE_ERR_GL, line, NULL);
            number++;
            n = 0;
        }
    }
    if (!n) return;
    line[n] = 0;
    gles_fail(gles, NACRE_ERR_GL, line, NULL);
}

static void log_name(nacre_gles *gles, const gles_key *key, const char *what)
{
    char name[GLES_KEY_NAME_SIZE];
    if (!gles->desc.log) return;
    gles_key_name(key, name);
    gles_fail(gles, NACRE_ERR_GL, what, name);
}

static void log_shader(nacre_gles *gles, gl_uint shader, const char *const *part, const int *length, int parts)
{
    char text[LOG_SIZE];
    gl_sizei n = 0;
    if (!gles->desc.log) return;
    text[0] = 0;
    gles->gl.GetShaderInfoLog(shader, sizeof text - 1, &n, text);
    text[sizeof text - 1] = 0;
    gles->desc.log(gles->desc.user, NACRE_ERR_GL, text);
    log_source(gles, part, length, parts);
}

static void log_program(nacre_gles *gles, gl_uint program)
{
    char text[LOG_SIZE];
    gl_sizei n = 0;
    if (!gles->desc.log) return;
    text[0] = 0;
    gles->gl.GetProgramInfoLog(program, sizeof text - 1, &n, text);
    text[sizeof text - 1] = 0;
    gles->desc.log(gles->desc.user, NACRE_ERR_GL, text);
}

static nacre_result make_shader(nacre_gles *gles, const gles_key *key, int fragment, gl_uint *out)
{
    const gles_procs *gl = &gles->gl;
    const char *part[GLES_TEXT_PARTS];
    int length[GLES_TEXT_PARTS];
    char defines[GLES_DEFINES_SIZE];
    const int parts = gles_text(key, fragment, part, length, defines);
    const gl_uint shader = gl->CreateShader(fragment ? GLES_FRAGMENT_SHADER : GLES_VERTEX_SHADER);
    gl_int compiled = 0;
    if (!shader) return gles_gl_failed(gles, "glCreateShader");
    gl->ShaderSource(shader, parts, part, length);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GLES_COMPILE_STATUS, &compiled);
    if (compiled) {
        *out = shader;
        return NACRE_OK;
    }
    log_name(gles, key, fragment ? "fragment shader does not compile: " : "vertex shader does not compile: ");
    log_shader(gles, shader, part, length, parts);
    gl->DeleteShader(shader);
    return gles_gl_failed(gles, "glCompileShader");
}

static nacre_result link_program(nacre_gles *gles, const gles_key *key, gl_uint vertex, gl_uint fragment, gl_uint *out)
{
    const gles_procs *gl = &gles->gl;
    const gl_uint program = gl->CreateProgram();
    nacre_result result;
    gl_int linked = 0;
    unsigned i;
    if (!program) return gles_gl_failed(gles, "glCreateProgram");
    gl->AttachShader(program, vertex);
    gl->AttachShader(program, fragment);
    for (i = 0; i < NACRE_GLES_ATTRIBUTE_COUNT; i++) gl->BindAttribLocation(program, i, gles_attribute_name(i));
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GLES_LINK_STATUS, &linked);
    if (!linked) {
        log_name(gles, key, "program does not link: ");
        log_program(gles, program);
    }
    result = linked ? gles_check(gles, "program") : gles_gl_failed(gles, "glLinkProgram");
    if (result) {
        gl->DeleteProgram(program);
        return result;
    }
    *out = program;
    return NACRE_OK;
}

static nacre_result make_program(nacre_gles *gles, const gles_key *key, gl_uint *out)
{
    gl_uint vertex, fragment;
    nacre_result result = gles_begin(gles);
    if (!result) result = make_shader(gles, key, 0, &vertex);
    if (result) return result;
    result = make_shader(gles, key, 1, &fragment);
    if (!result) {
        result = link_program(gles, key, vertex, fragment, out);
        gles->gl.DeleteShader(fragment);
    }
    gles->gl.DeleteShader(vertex);
    return result;
}

void gles_program_delete(nacre_gles *gles, gles_program *program)
{
    if (program->name) gles->gl.DeleteProgram(program->name);
    program->name = 0;
}

/* A free slot, or the one that was not used for the longest time. */
static gles_program *choose_slot(nacre_gles *gles)
{
    gles_program *oldest = gles->programs;
    unsigned i;
    for (i = 0; i < gles->desc.max_programs; i++) {
        gles_program *p = &gles->programs[i];
        if (!p->name) return p;
        if (gles->clock - p->used > gles->clock - oldest->used) oldest = p;
    }
    return oldest;
}

nacre_result gles_program_use(nacre_gles *gles, const gles_key *key, gles_program **out)
{
    gles_program *p = gles->programs;
    gles_program *const end = p + gles->desc.max_programs;
    gl_uint name = 0;
    nacre_result result;
    while (p < end && !(p->name && !memcmp(&p->key, key, sizeof *key))) p++;
    gles->clock++;
    if (p < end) {
        gles->gl.UseProgram(p->name);
        p->used = gles->clock;
        *out = p;
        return NACRE_OK;
    }
    result = make_program(gles, key, &name);
    if (result) return result;
    gles->gl.UseProgram(name);
    p = choose_slot(gles);
    gles_program_delete(gles, p);
    p->key = *key;
    p->name = name;
    p->used = gles->clock;
    gles_uniforms_locate(&gles->gl, name, key, &p->at);
    result = gles_check(gles, "uniforms");
    if (result) {
        gles->gl.UseProgram(0);
        gles_program_delete(gles, p);
        return result;
    }
    *out = p;
    return NACRE_OK;
}
