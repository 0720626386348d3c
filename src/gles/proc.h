/* SPDX-License-Identifier: MIT */
/*
 * proc.h - the GL that nacre uses: types, the few enums, and every entry point once
 *
 * No GL header is included: an application's own may be ES or desktop, and ours must build where there is none.
 * GLES_PROCS(V, R) lists the required entry points, GLES_OPTIONAL_PROCS(V, R) those of GLES 3 and extensions:
 * V(name, parameters, arguments) for those without a result, R(type, name, parameters, arguments) for the others.
 */
#ifndef GLES_PROC_H
#define GLES_PROC_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && !defined(__SCITECH_SNAP__)
#define GLES_APIENTRY __stdcall
#else
#define GLES_APIENTRY
#endif

typedef unsigned int gl_enum;
typedef unsigned int gl_uint;
typedef int gl_int;
typedef int gl_sizei;
typedef float gl_float;
typedef unsigned char gl_boolean;
typedef unsigned char gl_ubyte;
typedef unsigned int gl_bitfield;
typedef ptrdiff_t gl_sizeiptr;
typedef char gl_char;

enum {
    GLES_TRIANGLES = 0x0004,
    GLES_DEPTH_BUFFER_BIT = 0x0100,
    GLES_COLOR_BUFFER_BIT = 0x4000,
    GLES_LESS = 0x0201,
    GLES_GREATER = 0x0204,
    GLES_OUT_OF_MEMORY = 0x0505,
    GLES_CONTEXT_LOST = 0x0507,

    GLES_BYTE = 0x1400,
    GLES_UNSIGNED_BYTE = 0x1401,
    GLES_SHORT = 0x1402,
    GLES_UNSIGNED_SHORT = 0x1403,
    GLES_UNSIGNED_INT = 0x1405,
    GLES_FLOAT = 0x1406,
    GLES_FIXED = 0x140C,
    GLES_HALF_FLOAT = 0x140B,
    GLES_HALF_FLOAT_OES = 0x8D61,
    GLES_UNSIGNED_SHORT_5_6_5 = 0x8363,

    GLES_VENDOR = 0x1F00,
    GLES_RENDERER = 0x1F01,
    GLES_VERSION = 0x1F02,
    GLES_EXTENSIONS = 0x1F03,
    GLES_NUM_EXTENSIONS = 0x821D,
    GLES_MAX_TEXTURE_SIZE = 0x0D33,
    GLES_MAX_TEXTURE_IMAGE_UNITS = 0x8872,
    GLES_MAX_VERTEX_UNIFORM_VECTORS = 0x8DFB,
    GLES_MAX_FRAGMENT_UNIFORM_VECTORS = 0x8DFD,

    GLES_CULL_FACE = 0x0B44,
    GLES_DEPTH_RANGE = 0x0B70,
    GLES_DEPTH_TEST = 0x0B71,
    GLES_DEPTH_WRITEMASK = 0x0B72,
    GLES_DEPTH_CLEAR_VALUE = 0x0B73,
    GLES_DEPTH_FUNC = 0x0B74,
    GLES_STENCIL_TEST = 0x0B90,
    GLES_VIEWPORT = 0x0BA2,
    GLES_DITHER = 0x0BD0,
    GLES_BLEND = 0x0BE2,
    GLES_SCISSOR_TEST = 0x0C11,
    GLES_COLOR_CLEAR_VALUE = 0x0C22,
    GLES_COLOR_WRITEMASK = 0x0C23,
    GLES_SAMPLE_ALPHA_TO_COVERAGE = 0x809E,
    GLES_SAMPLE_COVERAGE = 0x80A0,
    GLES_RASTERIZER_DISCARD = 0x8C89,

    GLES_UNPACK_ROW_LENGTH = 0x0CF2,
    GLES_UNPACK_SKIP_ROWS = 0x0CF3,
    GLES_UNPACK_SKIP_PIXELS = 0x0CF4,
    GLES_UNPACK_ALIGNMENT = 0x0CF5,
    GLES_PIXEL_UNPACK_BUFFER = 0x88EC,
    GLES_PIXEL_UNPACK_BUFFER_BINDING = 0x88EF,

    GLES_TEXTURE_2D = 0x0DE1,
    GLES_TEXTURE_BINDING_2D = 0x8069,
    GLES_TEXTURE0 = 0x84C0,
    GLES_ACTIVE_TEXTURE = 0x84E0,
    GLES_SAMPLER_BINDING = 0x8919,
    GLES_RGB = 0x1907,
    GLES_RGBA = 0x1908,
    GLES_LUMINANCE = 0x1909,
    GLES_LUMINANCE_ALPHA = 0x190A,
    GLES_ETC1_RGB8 = 0x8D64,
    GLES_COMPRESSED_RGB8_ETC2 = 0x9274,
    GLES_NEAREST = 0x2600,
    GLES_LINEAR = 0x2601,
    GLES_NEAREST_MIPMAP_NEAREST = 0x2700,
    GLES_LINEAR_MIPMAP_LINEAR = 0x2703,
    GLES_TEXTURE_MAG_FILTER = 0x2800,
    GLES_TEXTURE_MIN_FILTER = 0x2801,
    GLES_TEXTURE_WRAP_S = 0x2802,
    GLES_TEXTURE_WRAP_T = 0x2803,
    GLES_REPEAT = 0x2901,
    GLES_CLAMP_TO_EDGE = 0x812F,
    GLES_TEXTURE_MAX_LEVEL = 0x813D,

    GLES_ARRAY_BUFFER = 0x8892,
    GLES_ELEMENT_ARRAY_BUFFER = 0x8893,
    GLES_ARRAY_BUFFER_BINDING = 0x8894,
    GLES_ELEMENT_ARRAY_BUFFER_BINDING = 0x8895,
    GLES_STATIC_DRAW = 0x88E4,
    GLES_VERTEX_ARRAY_BINDING = 0x85B5,
    GLES_VERTEX_ATTRIB_ARRAY_ENABLED = 0x8622,
    GLES_VERTEX_ATTRIB_ARRAY_SIZE = 0x8623,
    GLES_VERTEX_ATTRIB_ARRAY_STRIDE = 0x8624,
    GLES_VERTEX_ATTRIB_ARRAY_TYPE = 0x8625,
    GLES_VERTEX_ATTRIB_ARRAY_POINTER = 0x8645,
    GLES_VERTEX_ATTRIB_ARRAY_NORMALIZED = 0x886A,
    GLES_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING = 0x889F,

    GLES_FRAGMENT_SHADER = 0x8B30,
    GLES_VERTEX_SHADER = 0x8B31,
    GLES_COMPILE_STATUS = 0x8B81,
    GLES_LINK_STATUS = 0x8B82,
    GLES_CURRENT_PROGRAM = 0x8B8D,

    GLES_FRAMEBUFFER = 0x8D40,
    GLES_READ_FRAMEBUFFER = 0x8CA8,
    GLES_DRAW_FRAMEBUFFER = 0x8CA9,
    GLES_RENDERBUFFER = 0x8D41,
    GLES_FRAMEBUFFER_BINDING = 0x8CA6,
    GLES_READ_FRAMEBUFFER_BINDING = 0x8CAA,
    GLES_RENDERBUFFER_BINDING = 0x8CA7,
    GLES_FRAMEBUFFER_COMPLETE = 0x8CD5,
    GLES_COLOR_ATTACHMENT0 = 0x8CE0,
    GLES_COLOR_ATTACHMENT1 = 0x8CE1,
    GLES_DEPTH_ATTACHMENT = 0x8D00,
    GLES_DEPTH_COMPONENT16 = 0x81A5
};

/* clang-format off */
#define GLES_PROCS(V, R)                                                                                               \
    R(gl_enum, GetError, (void), ())                                                                                   \
    R(const gl_ubyte *, GetString, (gl_enum name), (name))                                                             \
    V(GetIntegerv, (gl_enum name, gl_int *out), (name, out))                                                           \
    V(GetFloatv, (gl_enum name, gl_float *out), (name, out))                                                           \
    R(gl_boolean, IsEnabled, (gl_enum cap), (cap))                                                                     \
    V(Enable, (gl_enum cap), (cap))                                                                                    \
    V(Disable, (gl_enum cap), (cap))                                                                                   \
    V(GenTextures, (gl_sizei n, gl_uint *names), (n, names))                                                           \
    V(DeleteTextures, (gl_sizei n, const gl_uint *names), (n, names))                                                  \
    V(BindTexture, (gl_enum target, gl_uint name), (target, name))                                                     \
    V(ActiveTexture, (gl_enum unit), (unit))                                                                           \
    V(PixelStorei, (gl_enum name, gl_int value), (name, value))                                                        \
    V(TexParameteri, (gl_enum target, gl_enum name, gl_int value), (target, name, value))                              \
    V(TexImage2D, (gl_enum target, gl_int level, gl_int internal, gl_sizei w, gl_sizei h, gl_int border,               \
                   gl_enum format, gl_enum type, const void *texels),                                                  \
      (target, level, internal, w, h, border, format, type, texels))                                                   \
    V(CompressedTexImage2D, (gl_enum target, gl_int level, gl_enum internal, gl_sizei w, gl_sizei h, gl_int border,    \
                             gl_sizei size, const void *blocks),                                                       \
      (target, level, internal, w, h, border, size, blocks))                                                           \
    V(GenBuffers, (gl_sizei n, gl_uint *names), (n, names))                                                            \
    V(DeleteBuffers, (gl_sizei n, const gl_uint *names), (n, names))                                                   \
    V(BindBuffer, (gl_enum target, gl_uint name), (target, name))                                                      \
    V(BufferData, (gl_enum target, gl_sizeiptr size, const void *data, gl_enum usage), (target, size, data, usage))    \
    V(GenFramebuffers, (gl_sizei n, gl_uint *names), (n, names))                                                       \
    V(DeleteFramebuffers, (gl_sizei n, const gl_uint *names), (n, names))                                              \
    V(BindFramebuffer, (gl_enum target, gl_uint name), (target, name))                                                 \
    V(FramebufferTexture2D, (gl_enum target, gl_enum attachment, gl_enum textarget, gl_uint name, gl_int level),       \
      (target, attachment, textarget, name, level))                                                                    \
    V(FramebufferRenderbuffer, (gl_enum target, gl_enum attachment, gl_enum rbtarget, gl_uint name),                   \
      (target, attachment, rbtarget, name))                                                                            \
    R(gl_enum, CheckFramebufferStatus, (gl_enum target), (target))                                                     \
    V(GenRenderbuffers, (gl_sizei n, gl_uint *names), (n, names))                                                      \
    V(DeleteRenderbuffers, (gl_sizei n, const gl_uint *names), (n, names))                                             \
    V(BindRenderbuffer, (gl_enum target, gl_uint name), (target, name))                                                \
    V(RenderbufferStorage, (gl_enum target, gl_enum internal, gl_sizei w, gl_sizei h), (target, internal, w, h))       \
    R(gl_uint, CreateShader, (gl_enum type), (type))                                                                   \
    V(ShaderSource, (gl_uint shader, gl_sizei n, const gl_char *const *texts, const gl_int *lengths),                  \
      (shader, n, texts, lengths))                                                                                     \
    V(CompileShader, (gl_uint shader), (shader))                                                                       \
    V(GetShaderiv, (gl_uint shader, gl_enum name, gl_int *out), (shader, name, out))                                   \
    V(GetShaderInfoLog, (gl_uint shader, gl_sizei size, gl_sizei *length, gl_char *out), (shader, size, length, out))  \
    V(DeleteShader, (gl_uint shader), (shader))                                                                        \
    R(gl_uint, CreateProgram, (void), ())                                                                              \
    V(AttachShader, (gl_uint program, gl_uint shader), (program, shader))                                              \
    V(BindAttribLocation, (gl_uint program, gl_uint index, const gl_char *name), (program, index, name))               \
    V(LinkProgram, (gl_uint program), (program))                                                                       \
    V(GetProgramiv, (gl_uint program, gl_enum name, gl_int *out), (program, name, out))                                \
    V(GetProgramInfoLog, (gl_uint program, gl_sizei size, gl_sizei *length, gl_char *out),                             \
      (program, size, length, out))                                                                                    \
    V(DeleteProgram, (gl_uint program), (program))                                                                     \
    V(UseProgram, (gl_uint program), (program))                                                                        \
    R(gl_int, GetUniformLocation, (gl_uint program, const gl_char *name), (program, name))                             \
    V(Uniform1i, (gl_int location, gl_int x), (location, x))                                                           \
    V(Uniform4fv, (gl_int location, gl_sizei n, const gl_float *v), (location, n, v))                                  \
    V(UniformMatrix3fv, (gl_int location, gl_sizei n, gl_boolean transpose, const gl_float *v),                        \
      (location, n, transpose, v))                                                                                     \
    V(UniformMatrix4fv, (gl_int location, gl_sizei n, gl_boolean transpose, const gl_float *v),                        \
      (location, n, transpose, v))                                                                                     \
    V(Viewport, (gl_int x, gl_int y, gl_sizei w, gl_sizei h), (x, y, w, h))                                            \
    V(Clear, (gl_bitfield mask), (mask))                                                                               \
    V(ClearColor, (gl_float r, gl_float g, gl_float b, gl_float a), (r, g, b, a))                                      \
    V(ClearDepthf, (gl_float depth), (depth))                                                                          \
    V(ColorMask, (gl_boolean r, gl_boolean g, gl_boolean b, gl_boolean a), (r, g, b, a))                               \
    V(DepthMask, (gl_boolean on), (on))                                                                                \
    V(DepthFunc, (gl_enum func), (func))                                                                               \
    V(VertexAttribPointer, (gl_uint index, gl_int size, gl_enum type, gl_boolean normalized, gl_sizei stride,          \
                            const void *pointer), (index, size, type, normalized, stride, pointer))                    \
    V(EnableVertexAttribArray, (gl_uint index), (index))                                                               \
    V(DisableVertexAttribArray, (gl_uint index), (index))                                                              \
    V(GetVertexAttribiv, (gl_uint index, gl_enum name, gl_int *out), (index, name, out))                               \
    V(GetVertexAttribPointerv, (gl_uint index, gl_enum name, void **out), (index, name, out))                          \
    V(DrawArrays, (gl_enum mode, gl_int first, gl_sizei count), (mode, first, count))                                  \
    V(DrawElements, (gl_enum mode, gl_sizei count, gl_enum type, const void *offset), (mode, count, type, offset))

#define GLES_OPTIONAL_PROCS(V, R)                                                                                      \
    R(const gl_ubyte *, GetStringi, (gl_enum name, gl_uint index), (name, index))                                      \
    V(GenVertexArrays, (gl_sizei n, gl_uint *names), (n, names))                                                       \
    V(DeleteVertexArrays, (gl_sizei n, const gl_uint *names), (n, names))                                              \
    V(BindVertexArray, (gl_uint name), (name))                                                                         \
    V(DrawBuffers, (gl_sizei n, const gl_enum *buffers), (n, buffers))                                                 \
    V(BindSampler, (gl_uint unit, gl_uint sampler), (unit, sampler))                                                   \
    R(gl_enum, GetGraphicsResetStatus, (void), ())
/* clang-format on */

typedef struct gles_procs {
#define GLES_V(name, parameters, arguments)       void(GLES_APIENTRY * name) parameters;
#define GLES_R(type, name, parameters, arguments) type(GLES_APIENTRY *name) parameters;
    GLES_PROCS(GLES_V, GLES_R)
    GLES_OPTIONAL_PROCS(GLES_V, GLES_R)
#undef GLES_V
#undef GLES_R
} gles_procs;

#endif
