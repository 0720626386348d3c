/* SPDX-License-Identifier: MIT */
/*
 * fake_gl - a GL loader that records, and breaks on purpose
 *
 * Without a real loader it is a GL of its own that draws nothing: object names, bindings and states are kept, and what
 * ES 2.0 (or 3.0) forbids gives the error it must. Around a real loader it passes every call on. Either way it counts calls
 * and texture bytes, knows which objects live, fails the n-th call, loses the context at the n-th call, or answers
 * smaller limits. One at a time: GL entry points carry no user pointer.
 */
#ifndef FAKE_GL_H
#define FAKE_GL_H

#include <stddef.h>
#include <stdint.h>

typedef struct fake_gl_options {                 /* zero means default */
    void *(*real)(void *user, const char *name); /* (none) wrap this loader */
    void *real_user;
    int es;                 /* without a real loader: 2 or 3 (2) */
    const char *extensions; /* without a real loader: between spaces (none) */
    const char *version;    /* GL_VERSION (as es or the real one says) */
    int fragment_vectors;   /* answers of glGetIntegerv (16; the real ones) */
    int texture_units;      /* (8) */
    int max_texture;        /* (2048) */
    int no_optional;        /* 1: no entry points beyond ES 2.0 */
    int reset_status;       /* 1: glGetGraphicsResetStatus is there */
    const char *missing;    /* one entry point that get_proc does not know */
    int incomplete;         /* 1: no framebuffer is complete */
} fake_gl_options;

void fake_gl_start(const fake_gl_options *options);
/* For nacre_gles_desc.get_proc. */
void *fake_gl_proc(void *user, const char *name);

/* The n-th call from now fails (1 = the next; 0: none): no effect, no object, GL_OUT_OF_MEMORY. Calls that can't fail on a
   living context go through. */
void fake_gl_fail(long n);
/* From the n-th call from now on the context is lost. */
void fake_gl_lose(long n);
/* A new context: all objects are gone, states are as created (without a real loader). */
void fake_gl_new_context(void);

long fake_gl_calls(void);                /* so far, glGetError not counted */
long fake_gl_calls_of(const char *name); /* of one entry point, without "gl" */
long fake_gl_queries(void);              /* glGet*, glIs* and glCheck* so far, glGetError counted */
int fake_gl_failed(void);                /* 1: the call of fake_gl_fail came and did fail */
const char *fake_gl_failed_name(void);   /* which one it was, "" for none */
int fake_gl_live(void);                  /* objects made and not deleted */
uint32_t fake_gl_texture_bytes(void);    /* in living textures and renderbuffers */
uint32_t fake_gl_buffer_bytes(void);
int fake_gl_pending_error(void); /* GL error flag that is set, without a real loader */
int fake_gl_draws(void);         /* glDraw* that were valid */

/* Every state that draw could touch, as numbers, without a real loader or with it (asked through the real one). Returns how many. */
#define FAKE_GL_STATES 256
int fake_gl_snapshot(long *out);
/* What number i of a snapshot is. */
const char *fake_gl_state_name(int i);

#endif
