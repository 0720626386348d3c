/* SPDX-License-Identifier: MIT */
#include "gl_probe.h"

#include <stddef.h>
#include <string.h>

static void load(void *function, const char *name)
{
    void *p = gl_headless_proc(NULL, name);

    memcpy(function, &p, sizeof p);
}

static unsigned compile(unsigned kind, const char *text)
{
    unsigned (*create)(unsigned), shader;
    void (*source)(unsigned, int, const char *const *, const int *);
    void (*compile_shader)(unsigned);

    load(&create, "glCreateShader");
    load(&source, "glShaderSource");
    load(&compile_shader, "glCompileShader");
    shader = create(kind);
    source(shader, 1, &text, NULL);
    compile_shader(shader);
    return shader;
}

int gl_probe_mediump(gl_headless *gl)
{
    static const char vertex[] = "#version 100\nattribute vec2 p;\nvoid main() { gl_Position = vec4(p, 0.0, 1.0); }\n";
    static const char fragment[] = "#version 100\nprecision mediump float;\nuniform float a, b;\n"
                                   "void main() { gl_FragColor = vec4(fract(a + b)); }\n";
    static const float corner[] = {-1, -1, 3, -1, -1, 3};
    unsigned (*create)(void), program;
    void (*attach)(unsigned, unsigned), (*link)(unsigned), (*use)(unsigned), (*enable)(unsigned), (*disable)(unsigned);
    void (*pointer)(unsigned, int, unsigned, unsigned char, int, const void *);
    void (*draw)(unsigned, int, int), (*uniform)(int, float);
    void (*bind_attribute)(unsigned, unsigned, const char *);
    int (*location)(unsigned, const char *), found;
    image_u8 frame;

    load(&create, "glCreateProgram");
    load(&attach, "glAttachShader");
    load(&link, "glLinkProgram");
    load(&use, "glUseProgram");
    load(&enable, "glEnableVertexAttribArray");
    load(&disable, "glDisableVertexAttribArray");
    load(&pointer, "glVertexAttribPointer");
    load(&draw, "glDrawArrays");
    load(&uniform, "glUniform1f");
    load(&location, "glGetUniformLocation");
    load(&bind_attribute, "glBindAttribLocation");
    program = create();
    attach(program, compile(0x8B31u /* GL_VERTEX_SHADER */, vertex));
    attach(program, compile(0x8B30u /* GL_FRAGMENT_SHADER */, fragment));
    bind_attribute(program, 0, "p");
    link(program);
    use(program);
    uniform(location(program, "a"), 4096);
    uniform(location(program, "b"), 0.5f);
    pointer(0, 2, 0x1406u /* GL_FLOAT */, 0, 0, corner);
    enable(0);
    draw(4 /* GL_TRIANGLES */, 0, 3);
    disable(0);
    use(0);
    gl_headless_read(gl, &frame);
    found = frame.texel[0];
    image_u8_free(&frame);
    gl_headless_clear(gl, 0, 0, 0, 0);
    return found;
}
