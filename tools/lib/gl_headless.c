/* SPDX-License-Identifier: MIT */
/* EGL and OSMesa are opened at run time, so that everything but drawing works where they are missing. */
#include "gl_headless.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The few GL values used here; any GL header would drag in a choice between ES and desktop. */
#define GL_COLOR_AND_DEPTH (0x4000u | 0x0100u)
#define GL_VENDOR          0x1F00u
#define GL_RENDERER        0x1F01u
#define GL_VERSION         0x1F02u
#define GL_RGBA            0x1908u
#define GL_UNSIGNED_BYTE   0x1401u

typedef void (*any_function)(void);

struct gl_headless {
    gl_backend backend;
    int width, height;
    EGLContext egl_context;
    EGLSurface egl_surface;
    void *osmesa_context;
    uint8_t *osmesa_frame;
    char description[400];
    char version_2[200]; /* what GL_VERSION says on GL_BACKEND_EGL2 where the driver's context is a later one */
};

static struct {
    EGLDisplay display;
    __typeof__(&eglGetProcAddress) get_proc;
    __typeof__(&eglGetError) get_error;
    __typeof__(&eglInitialize) initialize;
    __typeof__(&eglBindAPI) bind_api;
    __typeof__(&eglChooseConfig) choose_config;
    __typeof__(&eglCreateContext) create_context;
    __typeof__(&eglDestroyContext) destroy_context;
    __typeof__(&eglCreatePbufferSurface) create_surface;
    __typeof__(&eglDestroySurface) destroy_surface;
    __typeof__(&eglMakeCurrent) make_current;
} egl;

static struct {
    void *library;
    any_function (*get_proc)(const char *name);
    void *(*create_context)(unsigned format, int depth_bits, int stencil_bits, int accum_bits, void *share);
    void (*destroy_context)(void *context);
    unsigned char (*make_current)(void *context, void *frame, unsigned type, int width, int height);
} osmesa;

/* The context whose entry points gl_headless_proc hands out. */
static gl_headless *current;

/* dlsym gives an object pointer; C has no cast from it to a function pointer, POSIX says the bits are the same. */
static int load(void *library, const char *name, void *function)
{
    void *p = dlsym(library, name);
    memcpy(function, &p, sizeof p);
    return p != NULL;
}

static int egl_load(failure *f)
{
    void *library;
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_display;
    EGLDisplay display;

    setenv("EGL_LOG_LEVEL", "fatal", 0); /* what the driver warns of is in our own line */
    library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) return fail(f, FAIL_UNSUPPORTED, "EGL: libEGL.so.1 can't be opened; install libegl1");
    if (!load(library, "eglGetProcAddress", &egl.get_proc) || !load(library, "eglGetError", &egl.get_error) ||
        !load(library, "eglInitialize", &egl.initialize) || !load(library, "eglBindAPI", &egl.bind_api) ||
        !load(library, "eglChooseConfig", &egl.choose_config) ||
        !load(library, "eglCreateContext", &egl.create_context) ||
        !load(library, "eglDestroyContext", &egl.destroy_context) ||
        !load(library, "eglCreatePbufferSurface", &egl.create_surface) ||
        !load(library, "eglDestroySurface", &egl.destroy_surface) ||
        !load(library, "eglMakeCurrent", &egl.make_current))
        return fail(f, FAIL_UNSUPPORTED, "EGL: libEGL.so.1 lacks an entry point of EGL 1.4");
    get_display = (PFNEGLGETPLATFORMDISPLAYEXTPROC)egl.get_proc("eglGetPlatformDisplayEXT");
    if (!get_display) return fail(f, FAIL_UNSUPPORTED, "EGL: no platform displays (EGL_EXT_platform_base)");
    display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (display == EGL_NO_DISPLAY || !egl.initialize(display, NULL, NULL))
        return fail(f, FAIL_UNSUPPORTED,
                    "EGL: no surfaceless display, error 0x%x; install libegl-mesa0 libgl1-mesa-dri",
                    (unsigned)egl.get_error());
    egl.display = display; /* kept until the process ends: drivers come up slowly */
    return FAIL_NONE;
}

static int egl_open(gl_headless *gl, failure *f)
{
    int version = gl->backend == GL_BACKEND_EGL3 ? 3 : 2;
    const EGLint wanted[] = {EGL_SURFACE_TYPE,
                             EGL_PBUFFER_BIT,
                             EGL_RENDERABLE_TYPE,
                             version == 3 ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_ES2_BIT,
                             EGL_RED_SIZE,
                             8,
                             EGL_GREEN_SIZE,
                             8,
                             EGL_BLUE_SIZE,
                             8,
                             EGL_ALPHA_SIZE,
                             8,
                             EGL_DEPTH_SIZE,
                             24,
                             EGL_NONE};
    const EGLint context[] = {EGL_CONTEXT_CLIENT_VERSION, version, EGL_NONE};
    const EGLint surface[] = {EGL_WIDTH, gl->width, EGL_HEIGHT, gl->height, EGL_NONE};
    EGLConfig config;
    EGLint count = 0;

    if (!egl.display && egl_load(f)) return FAIL_UNSUPPORTED;
    egl.bind_api(EGL_OPENGL_ES_API);
    if (!egl.choose_config(egl.display, wanted, &config, 1, &count) || count < 1)
        return fail(f, FAIL_UNSUPPORTED, "EGL: no RGBA8 configuration with 24 bits of depth for OpenGL ES %d", version);
    gl->egl_context = egl.create_context(egl.display, config, EGL_NO_CONTEXT, context);
    if (!gl->egl_context)
        return fail(f, FAIL_UNSUPPORTED, "EGL: no OpenGL ES %d context, error 0x%x", version,
                    (unsigned)egl.get_error());
    gl->egl_surface = egl.create_surface(egl.display, config, surface);
    if (!gl->egl_surface)
        return fail(f, FAIL_UNSUPPORTED, "EGL: no %dx%d surface, error 0x%x", gl->width, gl->height,
                    (unsigned)egl.get_error());
    if (!egl.make_current(egl.display, gl->egl_surface, gl->egl_surface, gl->egl_context))
        return fail(f, FAIL_UNSUPPORTED, "EGL: the context can't be made current, error 0x%x",
                    (unsigned)egl.get_error());
    return FAIL_NONE;
}

static int osmesa_load(failure *f)
{
    void *library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);

    if (!library) library = dlopen("libOSMesa.so.6", RTLD_NOW | RTLD_LOCAL);
    if (!library)
        return fail(f, FAIL_UNSUPPORTED,
                    "OSMesa: neither libOSMesa.so.8 nor .6 can be opened; install libosmesa6, "
                    "or use --backend egl2");
    if (!load(library, "OSMesaGetProcAddress", &osmesa.get_proc) ||
        !load(library, "OSMesaCreateContextExt", &osmesa.create_context) ||
        !load(library, "OSMesaDestroyContext", &osmesa.destroy_context) ||
        !load(library, "OSMesaMakeCurrent", &osmesa.make_current))
        return fail(f, FAIL_UNSUPPORTED, "OSMesa: the library lacks an entry point");
    osmesa.library = library;
    return FAIL_NONE;
}

static int osmesa_open(gl_headless *gl, failure *f)
{
    if (!osmesa.library && osmesa_load(f)) return FAIL_UNSUPPORTED;
    gl->osmesa_context = osmesa.create_context(GL_RGBA, 24, 0, 0, NULL);
    if (!gl->osmesa_context) return fail(f, FAIL_UNSUPPORTED, "OSMesa: no context");
    gl->osmesa_frame = need_memory((size_t)gl->width * (size_t)gl->height, 4);
    if (!osmesa.make_current(gl->osmesa_context, gl->osmesa_frame, GL_UNSIGNED_BYTE, gl->width, gl->height))
        return fail(f, FAIL_UNSUPPORTED, "OSMesa: no %dx%d frame", gl->width, gl->height);
    return FAIL_NONE;
}

static any_function real_proc(const gl_headless *gl, const char *name)
{
    any_function found;

    if (gl->backend == GL_BACKEND_OSMESA)
        found = osmesa.get_proc(name);
    else
        found = (any_function)egl.get_proc(name);
    return found;
}

static const char *real_string(const gl_headless *gl, unsigned name)
{
    const unsigned char *(*get_string)(unsigned) = (const unsigned char *(*)(unsigned))real_proc(gl, "glGetString");
    const char *text = get_string ? (const char *)get_string(name) : NULL;
    return text ? text : "";
}

/* A request for OpenGL ES 2 may be answered by a context of 3.x. GL_BACKEND_EGL2 stands for a 2.0 device, so that is
   what its users are told. */
static const unsigned char *get_string_2(unsigned name)
{
    return (const unsigned char *)(name == GL_VERSION ? current->version_2 : real_string(current, name));
}

void *gl_headless_proc(void *user, const char *name)
{
    any_function function;
    void *p;

    (void)user;
    if (!current) return NULL;
    function = real_proc(current, name);
    if (current->version_2[0] && !strcmp(name, "glGetString")) function = (any_function)get_string_2;
    memcpy(&p, &function, sizeof p);
    return p;
}

int gl_headless_open(gl_headless **out, gl_backend backend, int width, int height, failure *f)
{
    gl_headless *gl;
    int code;

    if (width < 1 || height < 1 || width > GL_HEADLESS_MAX_SIZE || height > GL_HEADLESS_MAX_SIZE)
        return fail(f, FAIL_UNSUPPORTED, "frame of %dx%d: expected 1..%d a side", width, height, GL_HEADLESS_MAX_SIZE);
    gl = need_memory(1, sizeof *gl);
    gl->backend = backend;
    gl->width = width;
    gl->height = height;
    code = backend == GL_BACKEND_OSMESA ? osmesa_open(gl, f) : egl_open(gl, f);
    if (code) {
        gl_headless_close(gl);
        return code;
    }
    current = gl;
    if (backend == GL_BACKEND_EGL2 && strncmp(real_string(gl, GL_VERSION), "OpenGL ES 2", 11))
        snprintf(gl->version_2, sizeof gl->version_2, "OpenGL ES 2.0 on %.150s", real_string(gl, GL_VERSION));
    snprintf(gl->description, sizeof gl->description, "%.100s / %.100s / %.150s", real_string(gl, GL_VENDOR),
             real_string(gl, GL_RENDERER), gl->version_2[0] ? gl->version_2 : real_string(gl, GL_VERSION));
    gl_headless_clear(gl, 0, 0, 0, 0);
    *out = gl;
    return FAIL_NONE;
}

void gl_headless_close(gl_headless *gl)
{
    if (!gl) return;
    if (gl->egl_context || gl->egl_surface) {
        if (current == gl) egl.make_current(egl.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (gl->egl_surface) egl.destroy_surface(egl.display, gl->egl_surface);
        if (gl->egl_context) egl.destroy_context(egl.display, gl->egl_context);
    }
    if (gl->osmesa_context) {
        if (current == gl) osmesa.make_current(NULL, NULL, 0, 0, 0);
        osmesa.destroy_context(gl->osmesa_context);
    }
    if (current == gl) current = NULL;
    free(gl->osmesa_frame);
    free(gl);
}

const char *gl_headless_description(const gl_headless *gl)
{
    return gl->description;
}

void gl_headless_clear(gl_headless *gl, float r, float g, float b, float a)
{
    void (*clear_color)(float, float, float, float) =
        (void (*)(float, float, float, float))real_proc(gl, "glClearColor");
    void (*clear)(unsigned) = (void (*)(unsigned))real_proc(gl, "glClear");

    clear_color(r, g, b, a);
    clear(GL_COLOR_AND_DEPTH);
}

void gl_headless_read(gl_headless *gl, image_u8 *out)
{
    void (*read_pixels)(int, int, int, int, unsigned, unsigned, void *) =
        (void (*)(int, int, int, int, unsigned, unsigned, void *))real_proc(gl, "glReadPixels");
    size_t pitch = (size_t)gl->width * 4;
    uint8_t *rows = need_memory((size_t)gl->height, pitch);
    int y;

    *out = image_u8_make(gl->width, gl->height, 4);
    read_pixels(0, 0, gl->width, gl->height, GL_RGBA, GL_UNSIGNED_BYTE, rows);
    for (y = 0; y < gl->height; y++)
        memcpy(out->texel + (size_t)y * pitch, rows + (size_t)(gl->height - 1 - y) * pitch, pitch);
    free(rows);
}
