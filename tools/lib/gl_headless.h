/* SPDX-License-Identifier: MIT */
/* GL contexts without a window, and offscreen targets to draw into. */
#ifndef GL_HEADLESS_H
#define GL_HEADLESS_H

#include "failure.h"
#include "pixels.h"

typedef enum gl_backend { GL_BACKEND_EGL2, GL_BACKEND_EGL3, GL_BACKEND_OSMESA, GL_BACKEND_COUNT } gl_backend;

typedef struct gl_headless gl_headless;

#define GL_HEADLESS_MAX_SIZE 8192

/* A current context with a width x height RGBA8 framebuffer (name 0) and 24 bits of depth, cleared to 0.
   FAIL_UNSUPPORTED (with the reason) where this machine can't. One context a process at a time for OSMesa.
   GL_BACKEND_EGL2 says "OpenGL ES 2.0" in GL_VERSION even where the driver gives a later context; to make the driver
   itself refuse later features, set MESA_GLES_VERSION_OVERRIDE=2.0 before the process starts. OSMesa says desktop GL. */
int gl_headless_open(gl_headless **out, gl_backend backend, int width, int height, failure *f);
void gl_headless_close(gl_headless *gl);
/* For nacre_gles_desc.get_proc (user is ignored). */
void *gl_headless_proc(void *user, const char *name);
/* GL_VENDOR / GL_RENDERER / GL_VERSION in one line. */
const char *gl_headless_description(const gl_headless *gl);
void gl_headless_clear(gl_headless *gl, float r, float g, float b, float a);
/* The frame as RGBA, rows from the top; *out is made. */
void gl_headless_read(gl_headless *gl, image_u8 *out);

#endif
