/* SPDX-License-Identifier: MIT */
#include "drivers.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* llvmpipe lowers mediump to fp16 where the CPU converts it (F16C); held to SSE 4.1 it computes in fp32. */
#define FP32 "GALLIUM_OVERRIDE_CPU_CAPS=sse4.1"
#define LLVM "GALLIUM_DRIVER=llvmpipe"

const driver drivers[] = {
    {"osmesa, fp32", GL_BACKEND_OSMESA, {LLVM, FP32}, 0, 96},
    {"egl gles 2, fp32", GL_BACKEND_EGL2, {LLVM, FP32, "MESA_GLES_VERSION_OVERRIDE=2.0"}, 0, 96},
    {"egl gles 3, fp32", GL_BACKEND_EGL3, {LLVM, FP32}, 0, 96},
    {"softpipe gles 2", GL_BACKEND_EGL2, {"GALLIUM_DRIVER=softpipe", "MESA_GLES_VERSION_OVERRIDE=2.0"}, 0, 48},
    {"osmesa, fp16", GL_BACKEND_OSMESA, {LLVM}, 1, 96},
    {"egl gles 2, fp16", GL_BACKEND_EGL2, {LLVM, "MESA_GLES_VERSION_OVERRIDE=2.0"}, 1, 96},
    {"egl gles 3, fp16", GL_BACKEND_EGL3, {LLVM}, 1, 96},
};
const int driver_count = sizeof drivers / sizeof *drivers;

int driver_run(int index, const char *argument)
{
    char number[12];
    int status;
    pid_t child;

    snprintf(number, sizeof number, "%d", index);
    fflush(stdout);
    child = fork();
    if (child == 0) {
        int i;
        unsetenv("GALLIUM_OVERRIDE_CPU_CAPS");
        unsetenv("MESA_GLES_VERSION_OVERRIDE");
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
        for (i = 0; i < 4 && drivers[index].environment[i]; i++) {
            /* putenv keeps the pointer; these strings live as long as the program */
            char *setting = strdup(drivers[index].environment[i]);
            if (setting) putenv(setting);
        }
        execl("/proc/self/exe", "/proc/self/exe", "--driver", number, argument, (char *)NULL);
        perror("exec");
        _exit(70);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0) {
        perror("fork");
        return 70;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 70;
}

int driver_of_arguments(int argc, char **argv, const char **argument)
{
    int index = argc == 4 && !strcmp(argv[1], "--driver") ? atoi(argv[2]) : -1;

    *argument = argc == 4 ? argv[3] : NULL;
    return index >= 0 && index < driver_count ? index : -1;
}

/* ---- the probe ------------------------------------------------------------------------------------------------- */

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

void driver_remove_directory(const char *path)
{
    DIR *d = opendir(path);
    struct dirent *e;

    while (d && (e = readdir(d))) {
        char name[600];
        snprintf(name, sizeof name, "%s/%s", path, e->d_name);
        if (e->d_name[0] != '.') unlink(name);
    }
    if (d) closedir(d);
    rmdir(path);
}

int driver_mediump_probe(gl_headless *gl)
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
