/* SPDX-License-Identifier: MIT */
/* uniforms - locations, and finished integers into GLfloat. The only place of the runtime with float. */
#ifndef GLES_UNIFORMS_H
#define GLES_UNIFORMS_H

#include "key.h"
#include "proc.h"
#include "shade.h"

/* Names and meanings: shaders_gles/. */
#define GLES_UNIFORMS(U)                                                                                               \
    U(clip)                                                                                                            \
    U(view)                                                                                                            \
    U(normal)                                                                                                          \
    U(tangent)                                                                                                         \
    U(extent)                                                                                                          \
    U(centre)                                                                                                          \
    U(uv)                                                                                                              \
    U(half)                                                                                                            \
    U(light)                                                                                                           \
    U(x1)                                                                                                              \
    U(x2)                                                                                                              \
    U(y)                                                                                                               \
    U(rim)                                                                                                             \
    U(azimuth)                                                                                                         \
    U(turn0)                                                                                                           \
    U(turn1)                                                                                                           \
    U(turn2)                                                                                                           \
    U(near)                                                                                                            \
    U(far)                                                                                                             \
    U(scale)                                                                                                           \
    U(tiles)                                                                                                           \
    U(place)                                                                                                           \
    U(x)                                                                                                               \
    U(bound)                                                                                                           \
    U(factor)                                                                                                          \
    U(model)                                                                                                           \
    U(eye)                                                                                                             \
    U(ambient)                                                                                                         \
    U(byte)

typedef struct gles_uniforms { /* locations; -1: the program has no such uniform */
#define GLES_U(name) gl_int name;
    GLES_UNIFORMS(GLES_U)
#undef GLES_U
} gles_uniforms;

/* Where vertices come from. */
typedef struct gles_vertex_map {
    nacre_q16 centre[3], half_extent[3]; /* object = centre + half_extent x attribute; caller's buffers: 0 and 1 */
    uint8_t uv_q11;                      /* 1: the attribute is raw q11 (nacre_vertex, not normalized). Images are
                                            stored from the top, v points up: the shader turns it over */
} gles_vertex_map;

/* Find the locations, and set the samplers to their units (key.h). The program must be current and linked; attributes
   are bound before linking by gles_attribute_name. */
void gles_uniforms_locate(const gles_procs *gl, gl_uint program, const gles_key *key, gles_uniforms *out);

/* Name of the attribute at location 0..NACRE_GLES_ATTRIBUTE_COUNT-1, for glBindAttribLocation. */
const char *gles_attribute_name(unsigned location);

/* Set every uniform of the current program. frame: from shade_setup with all the view's lights; this program draws
   lights first_light .. first_light + key->lights - 1, and lobes from first_lobe (0 where there are none). Of a lit sphere's frame only turn and position_shift are read. */
void gles_uniforms_set(const gles_procs *gl, const gles_uniforms *at, const gles_key *key, const nacre_view *view,
                       const gles_vertex_map *vertices, const shade_frame *frame, unsigned first_light,
                       unsigned first_lobe);

/* SUM passes: which byte (0 high, 1 low) of the new sum is written. */
void gles_uniforms_set_byte(const gles_procs *gl, const gles_uniforms *at, unsigned byte);

#endif
