/* SPDX-License-Identifier: MIT */
#include "fake_gl.h"

#include <stdio.h>
#include <string.h>

#include "proc.h"

#define OBJECTS 512 /* alive at once */
#define UNITS   16
#define VAOS    16

enum { INVALID_ENUM = 0x0500, INVALID_VALUE = 0x0501, INVALID_OPERATION = 0x0502 };
typedef enum kind { NONE, TEXTURE, BUFFER, FRAMEBUFFER, RENDERBUFFER, SHADER, PROGRAM, VERTEX_ARRAY } kind;

typedef struct object {
    kind what; /* NONE: free */
    gl_uint name;
    uint32_t bytes[13]; /* textures by level; buffers and renderbuffers in [0] */
} object;

typedef struct attribute {
    gl_int enabled, size, type, normalized, stride, buffer;
    const void *pointer;
} attribute;

typedef struct array_state {
    gl_uint element_buffer;
    attribute attribute[8];
} array_state;

#define ID(name) P_##name
enum {
#define LIST_V(name, parameters, arguments)       ID(name),
#define LIST_R(type, name, parameters, arguments) ID(name),
    GLES_PROCS(LIST_V, LIST_R) GLES_OPTIONAL_PROCS(LIST_V, LIST_R) PROC_COUNT
};
static const char *const proc_names[] = {
#undef LIST_V
#undef LIST_R
#define LIST_V(name, parameters, arguments)       #name,
#define LIST_R(type, name, parameters, arguments) #name,
    GLES_PROCS(LIST_V, LIST_R) GLES_OPTIONAL_PROCS(LIST_V, LIST_R)};

static struct fake {
    fake_gl_options o;
    gles_procs real;
    long calls, queries, calls_of[PROC_COUNT];
    long fail_at, lose_at;
    int failed_proc; /* -1: none */
    gl_enum error;
    int draws;
    /* objects: by kind and name */
    object objects[OBJECTS];
    gl_uint next_name;
    /* state */
    gl_uint program, framebuffer, read_framebuffer, renderbuffer, array_buffer, unpack_buffer, vertex_array;
    gl_uint active, texture[UNITS], sampler[UNITS];
    array_state array[VAOS]; /* [0] is vertex array 0 */
    gl_uint array_name[VAOS];
    gl_int alignment, row_length, skip_rows, skip_pixels, viewport[4], depth_func, depth_mask, color_mask[4];
    gl_float clear_color[4], clear_depth;
    uint8_t enabled[9];
} f;

static const uint16_t caps[] = {GLES_CULL_FACE,
                                GLES_DEPTH_TEST,
                                GLES_STENCIL_TEST,
                                GLES_DITHER,
                                GLES_BLEND,
                                GLES_SCISSOR_TEST,
                                GLES_SAMPLE_ALPHA_TO_COVERAGE,
                                GLES_SAMPLE_COVERAGE,
                                GLES_RASTERIZER_DISCARD /* ES 3 */};

static size_t cap_count(void)
{
    return sizeof caps / sizeof *caps - (f.o.es != 3);
}

static int is_real(void)
{
    return f.o.real != NULL;
}

static int is_lost(void)
{
    return f.lose_at && f.calls >= f.lose_at;
}

static void set_error(gl_enum e)
{
    if (!f.error) f.error = e;
}

/* ---- counting, failing, losing ------------------------------------------------------------------ */

static int starts(const char *text, const char *word)
{
    return !strncmp(text, word, strlen(word));
}

/* Calls that GL may refuse for want of memory, or that report failure. */
static int can_fail(int proc)
{
    static const char *const words[] = {"Gen",
                                        "Create",
                                        "TexImage",
                                        "Compressed",
                                        "BufferData",
                                        "RenderbufferStorage",
                                        "ShaderSource",
                                        "CompileShader",
                                        "GetShaderiv",
                                        "GetProgramiv",
                                        "AttachShader",
                                        "BindAttrib",
                                        "LinkProgram",
                                        "Framebuffer",
                                        "CheckFramebuffer",
                                        "TexParameter",
                                        "GetUniformLocation",
                                        "Uniform",

                                        "DrawArrays",
                                        "DrawElements"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (starts(proc_names[proc], words[i])) return 1;
    return 0;
}

/* 1: go on; 0: the call has no effect. */
static int enter(int proc)
{
    const char *name = proc_names[proc];
    if (starts(name, "Get") || starts(name, "Is") || starts(name, "Check")) f.queries++;
    f.calls_of[proc]++;
    if (proc == P_GetError || proc == P_GetGraphicsResetStatus) return 1;
    f.calls++;
    if (is_lost()) return 0;
    if (f.fail_at && f.calls == f.fail_at && can_fail(proc)) {
        f.failed_proc = proc;
        if (proc != P_GetShaderiv && proc != P_GetProgramiv && proc != P_CheckFramebufferStatus)
            set_error(GLES_OUT_OF_MEMORY);
        return 0;
    }
    return 1;
}

/* ---- objects ------------------------------------------------------------------------------------ */

static object *find_object(kind k, gl_uint name)
{
    for (int i = 0; name && i < OBJECTS; i++)
        if (f.objects[i].what == k && f.objects[i].name == name) return &f.objects[i];
    return NULL;
}

static void made(kind k, gl_uint name)
{
    for (int i = 0; name && i < OBJECTS; i++) {
        if (f.objects[i].what != NONE) continue;
        memset(&f.objects[i], 0, sizeof f.objects[i]);
        f.objects[i].what = k;
        f.objects[i].name = name;
        return;
    }
}

static gl_uint new_name(kind k)
{
    made(k, ++f.next_name);
    return f.next_name;
}

static void gen(kind k, gl_sizei n, gl_uint *names)
{
    for (gl_sizei i = 0; i < n; i++)
        if (is_real())
            made(k, names[i]);
        else
            names[i] = new_name(k);
}

static int deletes(kind k, gl_uint name)
{
    object *o = find_object(k, name);
    if (o) o->what = NONE;
    return o != NULL;
}

static int lives(kind k, gl_uint name)
{
    return find_object(k, name) != NULL;
}

static void set_bytes(kind k, gl_uint name, int level, uint32_t bytes)
{
    object *o = find_object(k, name);
    if (o) o->bytes[level] = bytes;
}

static uint32_t first_bytes(kind k, gl_uint name)
{
    const object *o = find_object(k, name);
    return o ? o->bytes[0] : 0;
}

/* Binding a name: it must be 0 or alive (names that were never generated are legal in ES, and a bug of ours). */
static int may_bind(kind k, gl_uint name)
{
    if (!name || lives(k, name) || is_real()) return 1;
    set_error(INVALID_OPERATION);
    return 0;
}

static void fresh_array(array_state *a)
{
    memset(a, 0, sizeof *a);
    for (int i = 0; i < 8; i++) a->attribute[i].size = 4, a->attribute[i].type = GLES_FLOAT;
}

static array_state *array_now(void)
{
    for (int i = 0; i < VAOS; i++)
        if (f.array_name[i] == f.vertex_array) return &f.array[i];
    return &f.array[0];
}

static gl_uint *buffer_binding(gl_enum target)
{
    if (target == GLES_ARRAY_BUFFER) return &f.array_buffer;
    if (target == GLES_ELEMENT_ARRAY_BUFFER) return &array_now()->element_buffer;
    return target == GLES_PIXEL_UNPACK_BUFFER && f.o.es == 3 ? &f.unpack_buffer : NULL;
}

static int has_extension(const char *name)
{
    const char *at = f.o.extensions ? strstr(f.o.extensions, name) : NULL;
    return at && (at[strlen(name)] == ' ' || !at[strlen(name)]);
}

static unsigned texel_bytes(gl_enum format, gl_enum type)
{
    if (type == GLES_UNSIGNED_SHORT_5_6_5) return 2;
    switch (format) {
    case GLES_RGBA:
        return 4;
    case GLES_RGB:
        return 3;
    case GLES_LUMINANCE_ALPHA:
        return 2;
    case GLES_LUMINANCE:
        return 1;
    default:
        return 0;
    }
}

/* ---- one function per entry point: what it does to the model; in front of a real GL, what is to be recorded --------- */

static gl_enum on_GetError(void)
{
    return 0;
}

static const gl_ubyte *on_GetString(gl_enum name)
{
    if (name == GLES_VERSION && f.o.version) return (const gl_ubyte *)f.o.version;
    if (name == GLES_VERSION) return (const gl_ubyte *)(f.o.es == 3 ? "OpenGL ES 3.0 fake" : "OpenGL ES 2.0 fake");
    if (name == GLES_EXTENSIONS) return (const gl_ubyte *)(f.o.extensions ? f.o.extensions : "");
    return (const gl_ubyte *)"fake";
}

static const gl_ubyte *on_GetStringi(gl_enum name, gl_uint i)
{
    (void)name, (void)i;
    return (const gl_ubyte *)(f.o.extensions ? f.o.extensions : "");
}

static void limit_answer(gl_enum name, gl_int *out)
{
    if (name == GLES_MAX_FRAGMENT_UNIFORM_VECTORS && (f.o.fragment_vectors || !is_real()))
        *out = f.o.fragment_vectors ? f.o.fragment_vectors : 16;
    if (name == GLES_MAX_TEXTURE_IMAGE_UNITS && (f.o.texture_units || !is_real()))
        *out = f.o.texture_units ? f.o.texture_units : 8;
    if (name == GLES_MAX_TEXTURE_SIZE && (f.o.max_texture || !is_real()))
        *out = f.o.max_texture ? f.o.max_texture : 2048;
    if (name == GLES_MAX_VERTEX_UNIFORM_VECTORS && !is_real()) *out = 128;
}

static void on_GetIntegerv(gl_enum name, gl_int *out)
{
    limit_answer(name, out);
    if (is_real()) return;
    switch (name) {
    case GLES_MAX_FRAGMENT_UNIFORM_VECTORS:
    case GLES_MAX_TEXTURE_IMAGE_UNITS:
    case GLES_MAX_TEXTURE_SIZE:
    case GLES_MAX_VERTEX_UNIFORM_VECTORS:
        return;
    case GLES_CURRENT_PROGRAM:
        *out = (gl_int)f.program;
        return;
    case GLES_ACTIVE_TEXTURE:
        *out = (gl_int)(GLES_TEXTURE0 + f.active);
        return;
    case GLES_TEXTURE_BINDING_2D:
        *out = (gl_int)f.texture[f.active];
        return;
    case GLES_ARRAY_BUFFER_BINDING:
        *out = (gl_int)f.array_buffer;
        return;
    case GLES_ELEMENT_ARRAY_BUFFER_BINDING:
        *out = (gl_int)array_now()->element_buffer;
        return;
    case GLES_FRAMEBUFFER_BINDING:
        *out = (gl_int)f.framebuffer;
        return;
    case GLES_RENDERBUFFER_BINDING:
        *out = (gl_int)f.renderbuffer;
        return;
    case GLES_UNPACK_ALIGNMENT:
        *out = f.alignment;
        return;
    case GLES_VIEWPORT:
        memcpy(out, f.viewport, sizeof f.viewport);
        return;
    case GLES_DEPTH_FUNC:
        *out = f.depth_func;
        return;
    case GLES_DEPTH_WRITEMASK:
        *out = f.depth_mask;
        return;
    case GLES_COLOR_WRITEMASK:
        memcpy(out, f.color_mask, sizeof f.color_mask);
        return;
    default:
        break;
    }
    if (f.o.es < 3) {
        set_error(INVALID_ENUM);
        return;
    }
    switch (name) {
    case GLES_NUM_EXTENSIONS:
        *out = f.o.extensions ? 1 : 0;
        return;
    case GLES_SAMPLER_BINDING:
        *out = (gl_int)f.sampler[f.active];
        return;
    case GLES_VERTEX_ARRAY_BINDING:
        *out = (gl_int)f.vertex_array;
        return;
    case GLES_PIXEL_UNPACK_BUFFER_BINDING:
        *out = (gl_int)f.unpack_buffer;
        return;
    case GLES_UNPACK_ROW_LENGTH:
        *out = f.row_length;
        return;
    case GLES_UNPACK_SKIP_ROWS:
        *out = f.skip_rows;
        return;
    case GLES_UNPACK_SKIP_PIXELS:
        *out = f.skip_pixels;
        return;
    case GLES_READ_FRAMEBUFFER_BINDING:
        *out = (gl_int)f.read_framebuffer;
        return;
    default:
        set_error(INVALID_ENUM);
    }
}

static void on_GetFloatv(gl_enum name, gl_float *out)
{
    if (is_real()) return;
    if (name == GLES_COLOR_CLEAR_VALUE)
        memcpy(out, f.clear_color, sizeof f.clear_color);
    else if (name == GLES_DEPTH_CLEAR_VALUE)
        *out = f.clear_depth;
    else if (name == GLES_DEPTH_RANGE)
        out[0] = 0, out[1] = 1;
    else
        set_error(INVALID_ENUM);
}

static uint8_t *enable_of(gl_enum cap)
{
    for (size_t i = 0; i < cap_count(); i++)
        if (caps[i] == cap) return &f.enabled[i];
    set_error(INVALID_ENUM);
    return NULL;
}

static gl_boolean on_IsEnabled(gl_enum cap)
{
    const uint8_t *e = enable_of(cap);
    return e ? *e : 0;
}

static void on_Enable(gl_enum cap)
{
    uint8_t *e = is_real() ? NULL : enable_of(cap);
    if (e) *e = 1;
}

static void on_Disable(gl_enum cap)
{
    uint8_t *e = is_real() ? NULL : enable_of(cap);
    if (e) *e = 0;
}

static void on_GenTextures(gl_sizei n, gl_uint *names)
{
    gen(TEXTURE, n, names);
}

static void on_DeleteTextures(gl_sizei n, const gl_uint *names)
{
    for (gl_sizei i = 0; i < n; i++)
        if (deletes(TEXTURE, names[i]))
            for (int u = 0; u < UNITS; u++)
                if (f.texture[u] == names[i]) f.texture[u] = 0;
}

static void on_BindTexture(gl_enum target, gl_uint name)
{
    if (target != GLES_TEXTURE_2D)
        set_error(INVALID_ENUM);
    else if (may_bind(TEXTURE, name))
        f.texture[f.active] = name;
}

static void on_ActiveTexture(gl_enum unit)
{
    if (unit - GLES_TEXTURE0 < UNITS)
        f.active = unit - GLES_TEXTURE0;
    else
        set_error(INVALID_ENUM);
}

static void on_DrawBuffers(gl_sizei n, const gl_enum *buffers)
{
    for (gl_sizei i = 0; i < n; i++)
        if (!f.framebuffer || buffers[i] != GLES_COLOR_ATTACHMENT0 + (gl_enum)i) set_error(INVALID_OPERATION);
}

static void on_BindSampler(gl_uint unit, gl_uint sampler)
{
    if (unit < UNITS) f.sampler[unit] = sampler;
}

static void on_PixelStorei(gl_enum name, gl_int value)
{
    if (name == GLES_UNPACK_ALIGNMENT)
        f.alignment = value;
    else if (f.o.es < 3)
        set_error(INVALID_ENUM);
    else if (name == GLES_UNPACK_ROW_LENGTH)
        f.row_length = value;
    else if (name == GLES_UNPACK_SKIP_ROWS)
        f.skip_rows = value;
    else if (name == GLES_UNPACK_SKIP_PIXELS)
        f.skip_pixels = value;
    else
        set_error(INVALID_ENUM);
}

static void on_TexParameteri(gl_enum target, gl_enum name, gl_int value)
{
    (void)value;
    if (target != GLES_TEXTURE_2D || (name == GLES_TEXTURE_MAX_LEVEL && f.o.es < 3)) set_error(INVALID_ENUM);
}

static void store_level(gl_int level, gl_sizei w, gl_sizei h, uint32_t bytes)
{
    const gl_uint name = f.texture[f.active];
    gl_int largest = 0;
    limit_answer(GLES_MAX_TEXTURE_SIZE, &largest);
    if (!name || level < 0 || level > 12 || w < 1 || h < 1)
        set_error(INVALID_VALUE);
    else if (!is_real() && (w > largest || h > largest))
        set_error(INVALID_VALUE);
    else if (!is_real() && f.o.es < 3 && level && ((w & (w - 1)) || (h & (h - 1))) &&
             !has_extension("GL_OES_texture_npot"))
        set_error(INVALID_VALUE);
    else
        set_bytes(TEXTURE, name, level, bytes);
}

static void on_TexImage2D(gl_enum target, gl_int level, gl_int internal, gl_sizei w, gl_sizei h, gl_int border,
                          gl_enum format, gl_enum type, const void *texels)
{
    const unsigned texel = texel_bytes(format, type);
    if (target != GLES_TEXTURE_2D || !texel || border) set_error(INVALID_ENUM);
    if ((gl_enum)internal != format) set_error(INVALID_OPERATION);
    if (texels && f.alignment != 1) set_error(INVALID_OPERATION); /* legal, but our rows are tight */
    if (f.row_length || f.skip_rows || f.skip_pixels || f.unpack_buffer) set_error(INVALID_OPERATION);
    store_level(level, w, h, (uint32_t)w * (uint32_t)h * texel);
}

static void on_CompressedTexImage2D(gl_enum target, gl_int level, gl_enum internal, gl_sizei w, gl_sizei h,
                                    gl_int border, gl_sizei size, const void *blocks)
{
    const int etc1 = internal == GLES_ETC1_RGB8 && has_extension("GL_OES_compressed_ETC1_RGB8_texture");
    const int etc2 = internal == GLES_COMPRESSED_RGB8_ETC2 && f.o.es == 3;
    if (target != GLES_TEXTURE_2D || border || !blocks || (!is_real() && !etc1 && !etc2)) set_error(INVALID_ENUM);
    if (size != (w + 3) / 4 * ((h + 3) / 4) * 8) set_error(INVALID_VALUE);
    store_level(level, w, h, (uint32_t)size);
}

static void on_GenBuffers(gl_sizei n, gl_uint *names)
{
    gen(BUFFER, n, names);
}

static void on_DeleteBuffers(gl_sizei n, const gl_uint *names)
{
    for (gl_sizei i = 0; i < n; i++) {
        if (!deletes(BUFFER, names[i])) continue;
        if (f.array_buffer == names[i]) f.array_buffer = 0;
        if (array_now()->element_buffer == names[i]) array_now()->element_buffer = 0;
    }
}

static void on_BindBuffer(gl_enum target, gl_uint name)
{
    gl_uint *b = buffer_binding(target);
    if (!b)
        set_error(INVALID_ENUM);
    else if (may_bind(BUFFER, name))
        *b = name;
}

static void on_BufferData(gl_enum target, gl_sizeiptr size, const void *data, gl_enum usage)
{
    gl_uint *b = buffer_binding(target);
    (void)data, (void)usage;
    if (!b || !*b)
        set_error(INVALID_OPERATION);
    else
        set_bytes(BUFFER, *b, 0, (uint32_t)size);
}

static void on_GenFramebuffers(gl_sizei n, gl_uint *names)
{
    gen(FRAMEBUFFER, n, names);
}

static void on_DeleteFramebuffers(gl_sizei n, const gl_uint *names)
{
    for (gl_sizei i = 0; i < n; i++)
        if (deletes(FRAMEBUFFER, names[i]) && f.framebuffer == names[i]) f.framebuffer = 0;
}

static void on_BindFramebuffer(gl_enum target, gl_uint name)
{
    if (target == GLES_DRAW_FRAMEBUFFER && f.o.es < 3 && !is_real()) {
        set_error(INVALID_ENUM);
        return;
    }
    if (!may_bind(FRAMEBUFFER, name)) return;
    f.framebuffer = name;
    if (target == GLES_FRAMEBUFFER) f.read_framebuffer = name;
}

static void on_FramebufferTexture2D(gl_enum target, gl_enum attachment, gl_enum textarget, gl_uint name, gl_int level)
{
    (void)target, (void)attachment, (void)textarget, (void)level;
    if (!lives(TEXTURE, name) || !f.framebuffer) set_error(INVALID_OPERATION);
}

static void on_FramebufferRenderbuffer(gl_enum target, gl_enum attachment, gl_enum rbtarget, gl_uint name)
{
    (void)target, (void)attachment, (void)rbtarget;
    if (!lives(RENDERBUFFER, name) || !f.framebuffer) set_error(INVALID_OPERATION);
}

static gl_enum on_CheckFramebufferStatus(gl_enum target)
{
    (void)target;
    return f.o.incomplete ? 0x8CDD /* unsupported */ : GLES_FRAMEBUFFER_COMPLETE;
}

static void on_GenRenderbuffers(gl_sizei n, gl_uint *names)
{
    gen(RENDERBUFFER, n, names);
}

static void on_DeleteRenderbuffers(gl_sizei n, const gl_uint *names)
{
    for (gl_sizei i = 0; i < n; i++)
        if (deletes(RENDERBUFFER, names[i]) && f.renderbuffer == names[i]) f.renderbuffer = 0;
}

static void on_BindRenderbuffer(gl_enum target, gl_uint name)
{
    (void)target;
    if (may_bind(RENDERBUFFER, name)) f.renderbuffer = name;
}

static void on_RenderbufferStorage(gl_enum target, gl_enum internal, gl_sizei w, gl_sizei h)
{
    (void)target;
    if (internal != GLES_DEPTH_COMPONENT16 || !f.renderbuffer)
        set_error(INVALID_ENUM);
    else
        set_bytes(RENDERBUFFER, f.renderbuffer, 0, (uint32_t)w * (uint32_t)h * 2);
}

static gl_uint on_CreateShader(gl_enum type)
{
    (void)type;
    return f.next_name + 1;
}

static void on_ShaderSource(gl_uint shader, gl_sizei n, const gl_char *const *texts, const gl_int *lengths)
{
    (void)texts, (void)lengths;
    if (!lives(SHADER, shader) || n < 1) set_error(INVALID_VALUE);
}

static void on_CompileShader(gl_uint shader)
{
    if (!lives(SHADER, shader)) set_error(INVALID_VALUE);
}

static void on_GetShaderiv(gl_uint shader, gl_enum name, gl_int *out)
{
    (void)shader, (void)name;
    if (!is_real()) *out = 1;
}

static void on_GetShaderInfoLog(gl_uint shader, gl_sizei size, gl_sizei *length, gl_char *out)
{
    (void)shader;
    if (is_real() || size < 5) return;
    memcpy(out, "fake", 5);
    if (length) *length = 4;
}

static void on_DeleteShader(gl_uint shader)
{
    if (shader && !deletes(SHADER, shader)) set_error(INVALID_VALUE);
}

static gl_uint on_CreateProgram(void)
{
    return f.next_name + 1;
}

static void on_AttachShader(gl_uint program, gl_uint shader)
{
    if (!lives(PROGRAM, program) || !lives(SHADER, shader)) set_error(INVALID_VALUE);
}

static void on_BindAttribLocation(gl_uint program, gl_uint index, const gl_char *name)
{
    (void)name;
    if (!lives(PROGRAM, program) || index > 7) set_error(INVALID_VALUE);
}

static void on_LinkProgram(gl_uint program)
{
    if (!lives(PROGRAM, program)) set_error(INVALID_VALUE);
}

static void on_GetProgramiv(gl_uint program, gl_enum name, gl_int *out)
{
    (void)program, (void)name;
    if (!is_real()) *out = 1;
}

static void on_GetProgramInfoLog(gl_uint program, gl_sizei size, gl_sizei *length, gl_char *out)
{
    on_GetShaderInfoLog(program, size, length, out);
}

static void on_DeleteProgram(gl_uint program)
{
    if (program && !deletes(PROGRAM, program)) set_error(INVALID_VALUE);
}

static void on_UseProgram(gl_uint program)
{
    if (program && !lives(PROGRAM, program) && !is_real())
        set_error(INVALID_VALUE);
    else
        f.program = program;
}

static gl_int on_GetUniformLocation(gl_uint program, const gl_char *name)
{
    if (!lives(PROGRAM, program)) set_error(INVALID_VALUE);
    return (gl_int)(strlen(name) + (unsigned char)name[2]);
}

static void need_program(void)
{
    if (!f.program) set_error(INVALID_OPERATION);
}

static void on_Uniform1i(gl_int location, gl_int x)
{
    (void)location, (void)x;
    need_program();
}

static void on_Uniform4fv(gl_int location, gl_sizei n, const gl_float *v)
{
    (void)location, (void)v, (void)n;
    need_program();
}

static void on_UniformMatrix3fv(gl_int location, gl_sizei n, gl_boolean transpose, const gl_float *v)
{
    (void)location, (void)n, (void)v;
    if (transpose) set_error(INVALID_VALUE);
    need_program();
}

static void on_UniformMatrix4fv(gl_int location, gl_sizei n, gl_boolean transpose, const gl_float *v)
{
    on_UniformMatrix3fv(location, n, transpose, v);
}

static void on_Viewport(gl_int x, gl_int y, gl_sizei w, gl_sizei h)
{
    const gl_int v[4] = {x, y, w, h};
    memcpy(f.viewport, v, sizeof v);
}

static void on_Clear(gl_bitfield mask)
{
    (void)mask;
}

static void on_ClearColor(gl_float r, gl_float g, gl_float b, gl_float a)
{
    const gl_float c[4] = {r, g, b, a};
    memcpy(f.clear_color, c, sizeof c);
}

static void on_ClearDepthf(gl_float depth)
{
    f.clear_depth = depth;
}

static void on_ColorMask(gl_boolean r, gl_boolean g, gl_boolean b, gl_boolean a)
{
    const gl_int m[4] = {r, g, b, a};
    memcpy(f.color_mask, m, sizeof m);
}

static void on_DepthMask(gl_boolean on)
{
    f.depth_mask = on;
}

static void on_DepthFunc(gl_enum func)
{
    if (func < 0x0200 || func > 0x0207)
        set_error(INVALID_ENUM);
    else
        f.depth_func = (gl_int)func;
}

static void on_VertexAttribPointer(gl_uint index, gl_int size, gl_enum type, gl_boolean normalized, gl_sizei stride,
                                   const void *pointer)
{
    const attribute a = {0, size, (gl_int)type, normalized, stride, (gl_int)f.array_buffer, pointer};
    gl_int enabled;
    if (index > 7 || size < 1 || size > 4 || stride < 0) {
        set_error(INVALID_VALUE);
        return;
    }
    enabled = array_now()->attribute[index].enabled;
    array_now()->attribute[index] = a;
    array_now()->attribute[index].enabled = enabled;
}

static void on_EnableVertexAttribArray(gl_uint index)
{
    if (index < 8) array_now()->attribute[index].enabled = 1;
}

static void on_DisableVertexAttribArray(gl_uint index)
{
    if (index < 8) array_now()->attribute[index].enabled = 0;
}

static void on_GetVertexAttribiv(gl_uint index, gl_enum name, gl_int *out)
{
    const attribute *a = &array_now()->attribute[index & 7];
    if (is_real()) return;
    switch (name) {
    case GLES_VERTEX_ATTRIB_ARRAY_ENABLED:
        *out = a->enabled;
        break;
    case GLES_VERTEX_ATTRIB_ARRAY_SIZE:
        *out = a->size;
        break;
    case GLES_VERTEX_ATTRIB_ARRAY_TYPE:
        *out = a->type;
        break;
    case GLES_VERTEX_ATTRIB_ARRAY_NORMALIZED:
        *out = a->normalized;
        break;
    case GLES_VERTEX_ATTRIB_ARRAY_STRIDE:
        *out = a->stride;
        break;
    case GLES_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING:
        *out = a->buffer;
        break;
    default:
        set_error(INVALID_ENUM);
    }
}

static void on_GetVertexAttribPointerv(gl_uint index, gl_enum name, void **out)
{
    (void)name;
    if (!is_real()) *out = (void *)(uintptr_t)array_now()->attribute[index & 7].pointer;
}

static void on_GenVertexArrays(gl_sizei n, gl_uint *names)
{
    gen(VERTEX_ARRAY, n, names);
    for (gl_sizei k = 0; k < n; k++)
        for (int i = 1; i < VAOS; i++) {
            if (f.array_name[i]) continue;
            f.array_name[i] = names[k];
            fresh_array(&f.array[i]);
            break;
        }
}

static void on_DeleteVertexArrays(gl_sizei n, const gl_uint *names)
{
    for (gl_sizei i = 0; i < n; i++) {
        if (deletes(VERTEX_ARRAY, names[i]) && f.vertex_array == names[i]) f.vertex_array = 0;
        for (int k = 1; k < VAOS; k++)
            if (f.array_name[k] == names[i]) f.array_name[k] = 0;
    }
}

static void on_BindVertexArray(gl_uint name)
{
    if (may_bind(VERTEX_ARRAY, name)) f.vertex_array = name;
}

static gl_enum on_GetGraphicsResetStatus(void)
{
    return 0;
}

/* A draw is valid when a program is current, textures and buffers live, and enabled arrays have a buffer with data. */
static void check_draw(void)
{
    int ok = lives(PROGRAM, f.program) && lives(TEXTURE, f.texture[0]);
    for (int i = 0; i < 2; i++) {
        const attribute *a = &array_now()->attribute[i];
        ok = ok && a->enabled && lives(BUFFER, (gl_uint)a->buffer) && first_bytes(BUFFER, (gl_uint)a->buffer);
    }
    if (ok || is_real())
        f.draws++;
    else
        set_error(INVALID_OPERATION);
}

static void on_DrawArrays(gl_enum mode, gl_int first, gl_sizei count)
{
    if (mode != GLES_TRIANGLES || first < 0 || count < 0) set_error(INVALID_VALUE);
    check_draw();
}

static void on_DrawElements(gl_enum mode, gl_sizei count, gl_enum type, const void *offset)
{
    const gl_uint b = array_now()->element_buffer;
    const uint32_t size = type == GLES_UNSIGNED_INT ? 4 : 2;
    if (mode != GLES_TRIANGLES || count < 0) set_error(INVALID_VALUE);
    if (!is_real() && (!lives(BUFFER, b) || (uintptr_t)offset + (uint32_t)count * size > first_bytes(BUFFER, b)))
        set_error(INVALID_OPERATION);
    check_draw();
}

/* ---- the entry points ------------------------------------------------------------------------- */

/* What calls that report something report when they fail or the context is lost. */
static void refuse(int proc, void *out, gl_sizei n)
{
    if (starts(proc_names[proc], "Gen") && out) memset(out, 0, (size_t)n * sizeof(gl_uint));
}

#define WRAP_V(name, parameters, arguments)                                                                            \
    static void GLES_APIENTRY w_##name parameters                                                                      \
    {                                                                                                                  \
        if (!enter(ID(name))) {                                                                                        \
            lost_##name arguments;                                                                                     \
            return;                                                                                                    \
        }                                                                                                              \
        if (f.real.name) f.real.name arguments;                                                                        \
        on_##name arguments;                                                                                           \
    }
#define WRAP_R(type, name, parameters, arguments)                                                                      \
    static type GLES_APIENTRY w_##name parameters                                                                      \
    {                                                                                                                  \
        type r;                                                                                                        \
        if (!enter(ID(name))) return (type)0;                                                                          \
        r = f.real.name ? f.real.name arguments : on_##name arguments;                                                 \
        return (type)after(ID(name), (uintptr_t)r);                                                                    \
    }

/* Results that the model has its own word on. */
static uintptr_t after(int proc, uintptr_t r)
{
    if (proc == P_GetError) {
        const gl_enum e = is_lost() ? GLES_CONTEXT_LOST : f.error ? f.error : (gl_enum)r;
        f.error = 0;
        return e;
    }
    if (proc == P_GetGraphicsResetStatus) return is_lost() ? 0x8253 : r;
    if (proc == P_CreateShader || proc == P_CreateProgram) {
        if (!is_real()) f.next_name++;
        made(proc == P_CreateShader ? SHADER : PROGRAM, (gl_uint)r);
    }
    return r;
}

#define lost_GenTextures(n, names)      refuse(P_GenTextures, names, n)
#define lost_GenBuffers(n, names)       refuse(P_GenBuffers, names, n)
#define lost_GenFramebuffers(n, names)  refuse(P_GenFramebuffers, names, n)
#define lost_GenRenderbuffers(n, names) refuse(P_GenRenderbuffers, names, n)
#define lost_GenVertexArrays(n, names)  refuse(P_GenVertexArrays, names, n)
/* GL_COMPLETION and status queries must not make anyone wait for a context that is gone: they answer "yes". */
#define lost_GetShaderiv(s, name, out)  (void)(*(out) = is_lost())
#define lost_GetProgramiv(p, name, out) (void)(*(out) = is_lost())

#define NOTHING(name)                      lost_##name
#define lost_GetIntegerv(...)              (void)0
#define lost_GetFloatv(...)                (void)0
#define lost_Enable(...)                   (void)0
#define lost_Disable(...)                  (void)0
#define lost_DeleteTextures(...)           (void)0
#define lost_BindTexture(...)              (void)0
#define lost_ActiveTexture(...)            (void)0
#define lost_PixelStorei(...)              (void)0
#define lost_TexParameteri(...)            (void)0
#define lost_TexImage2D(...)               (void)0
#define lost_CompressedTexImage2D(...)     (void)0
#define lost_DeleteBuffers(...)            (void)0
#define lost_BindBuffer(...)               (void)0
#define lost_BufferData(...)               (void)0
#define lost_DeleteFramebuffers(...)       (void)0
#define lost_BindFramebuffer(...)          (void)0
#define lost_FramebufferTexture2D(...)     (void)0
#define lost_FramebufferRenderbuffer(...)  (void)0
#define lost_DeleteRenderbuffers(...)      (void)0
#define lost_BindRenderbuffer(...)         (void)0
#define lost_RenderbufferStorage(...)      (void)0
#define lost_ShaderSource(...)             (void)0
#define lost_CompileShader(...)            (void)0
#define lost_GetShaderInfoLog(...)         (void)0
#define lost_DeleteShader(...)             (void)0
#define lost_AttachShader(...)             (void)0
#define lost_BindAttribLocation(...)       (void)0
#define lost_LinkProgram(...)              (void)0
#define lost_GetProgramInfoLog(...)        (void)0
#define lost_DeleteProgram(...)            (void)0
#define lost_UseProgram(...)               (void)0
#define lost_Uniform1i(...)                (void)0
#define lost_Uniform4fv(...)               (void)0
#define lost_UniformMatrix3fv(...)         (void)0
#define lost_UniformMatrix4fv(...)         (void)0
#define lost_Viewport(...)                 (void)0
#define lost_Clear(...)                    (void)0
#define lost_ClearColor(...)               (void)0
#define lost_ClearDepthf(...)              (void)0
#define lost_ColorMask(...)                (void)0
#define lost_DepthMask(...)                (void)0
#define lost_DepthFunc(...)                (void)0
#define lost_VertexAttribPointer(...)      (void)0
#define lost_EnableVertexAttribArray(...)  (void)0
#define lost_DisableVertexAttribArray(...) (void)0
#define lost_GetVertexAttribiv(...)        (void)0
#define lost_GetVertexAttribPointerv(...)  (void)0
#define lost_DrawArrays(...)               (void)0
#define lost_DrawElements(...)             (void)0
#define lost_DeleteVertexArrays(...)       (void)0
#define lost_BindVertexArray(...)          (void)0
#define lost_DrawBuffers(...)              (void)0
#define lost_BindSampler(...)              (void)0

GLES_PROCS(WRAP_V, WRAP_R)
GLES_OPTIONAL_PROCS(WRAP_V, WRAP_R)

static const gles_procs wrappers = {
#define ENTRY_V(name, parameters, arguments)       w_##name,
#define ENTRY_R(type, name, parameters, arguments) w_##name,
    GLES_PROCS(ENTRY_V, ENTRY_R) GLES_OPTIONAL_PROCS(ENTRY_V, ENTRY_R)};

/* ---- public ------------------------------------------------------------------------------------- */

static int find_proc(const char *name)
{
    for (int i = 0; i < PROC_COUNT; i++)
        if (!strcmp(proc_names[i], name)) return i;
    return -1;
}

void fake_gl_new_context(void)
{
    memset(f.objects, 0, sizeof f.objects);
    memset(f.texture, 0, sizeof f.texture);
    memset(f.sampler, 0, sizeof f.sampler);
    memset(f.array_name, 0, sizeof f.array_name);
    fresh_array(&f.array[0]);
    memset(f.enabled, 0, sizeof f.enabled);
    f.enabled[3] = 1; /* dither */
    f.program = f.framebuffer = f.read_framebuffer = f.renderbuffer = f.array_buffer = f.unpack_buffer =
        f.vertex_array = 0;
    f.active = 0;
    f.next_name = 0;
    f.alignment = 4;
    f.row_length = f.skip_rows = f.skip_pixels = 0;
    f.viewport[0] = f.viewport[1] = 0;
    f.viewport[2] = f.viewport[3] = 16;
    f.depth_func = GLES_LESS;
    f.depth_mask = 1;
    for (int i = 0; i < 4; i++) f.color_mask[i] = 1, f.clear_color[i] = 0;
    f.clear_depth = 1;
    f.error = 0;
    f.fail_at = f.lose_at = 0;
    f.failed_proc = -1;
}

void fake_gl_start(const fake_gl_options *options)
{
    memset(&f, 0, sizeof f);
    f.o = *options;
    if (!f.o.es) f.o.es = f.o.real ? 3 : 2;
    fake_gl_new_context();
    for (int i = 0; f.o.real && i < PROC_COUNT; i++) {
        char name[40];
        snprintf(name, sizeof name, "gl%s", proc_names[i]);
        void *p = f.o.real(f.o.real_user, name);
        memcpy((char *)&f.real + (size_t)i * sizeof p, &p, sizeof p);
    }
}

/* "glGenVertexArraysOES", "glGetGraphicsResetStatusKHR": the names that ES 2.0 extensions give. */
static int find_extension_proc(const char *name)
{
    char plain[40];
    const size_t n = strlen(name);
    if (n < 4 || n > sizeof plain) return -1;
    memcpy(plain, name, n - 3);
    plain[n - 3] = 0;
    const int i = find_proc(plain);
    const int khr = i == P_GetGraphicsResetStatus, oes = i > P_GetStringi && i < P_DrawBuffers;
    return (khr && !strcmp(name + n - 3, "KHR")) || (oes && !strcmp(name + n - 3, "OES")) ? i : -1;
}

void *fake_gl_proc(void *user, const char *name)
{
    void *p;
    int i = starts(name, "gl") ? find_proc(name + 2) : -1;
    if (i < 0 && starts(name, "gl")) i = find_extension_proc(name + 2);
    (void)user;
    if (i < 0 || (f.o.missing && !strcmp(f.o.missing, name))) return NULL;
    if (i >= P_GetStringi) {
        if (i == P_GetGraphicsResetStatus) {
            if (!f.o.reset_status) return NULL;
        } else if (f.o.no_optional || (!f.o.real && f.o.es < 3)) {
            return NULL;
        }
    }
    memcpy(&p, (const char *)&wrappers + (size_t)i * sizeof p, sizeof p);
    return p;
}

void fake_gl_fail(long n)
{
    f.fail_at = n ? f.calls + n : 0;
    f.failed_proc = -1;
}

void fake_gl_lose(long n)
{
    f.lose_at = n ? f.calls + n : 0;
}

long fake_gl_calls(void)
{
    return f.calls;
}

long fake_gl_calls_of(const char *name)
{
    const int i = find_proc(name);
    return i < 0 ? 0 : f.calls_of[i];
}

long fake_gl_queries(void)
{
    return f.queries;
}

int fake_gl_failed(void)
{
    return f.failed_proc >= 0;
}

const char *fake_gl_failed_name(void)
{
    return f.failed_proc < 0 ? "" : proc_names[f.failed_proc];
}

int fake_gl_live(void)
{
    int n = 0;
    for (int i = 0; i < OBJECTS; i++) n += f.objects[i].what != NONE;
    return n;
}

static uint32_t bytes_of(kind k)
{
    uint32_t sum = 0;
    for (int i = 0; i < OBJECTS; i++)
        for (int l = 0; l < 13 && f.objects[i].what == k; l++) sum += f.objects[i].bytes[l];
    return sum;
}

uint32_t fake_gl_texture_bytes(void)
{
    return bytes_of(TEXTURE) + bytes_of(RENDERBUFFER);
}

uint32_t fake_gl_buffer_bytes(void)
{
    return bytes_of(BUFFER);
}

int fake_gl_pending_error(void)
{
    return (int)f.error;
}

int fake_gl_draws(void)
{
    return f.draws;
}

/* ---- snapshots ------------------------------------------------------------------------------------ */

static char state_names[FAKE_GL_STATES][32];

typedef struct snapshot {
    long *out;
    int n;
} snapshot;

static void note(snapshot *s, long value, const char *what, int a, int b)
{
    if (s->n >= FAKE_GL_STATES) return;
    snprintf(state_names[s->n], sizeof state_names[s->n], "%s %04x %d", what, (unsigned)a, b);
    s->out[s->n++] = value;
}

int fake_gl_snapshot(long *out)
{
    static const uint16_t ints[] = {GLES_CURRENT_PROGRAM,      GLES_ACTIVE_TEXTURE,
                                    GLES_ARRAY_BUFFER_BINDING, GLES_ELEMENT_ARRAY_BUFFER_BINDING,
                                    GLES_FRAMEBUFFER_BINDING,  GLES_RENDERBUFFER_BINDING,
                                    GLES_UNPACK_ALIGNMENT,     GLES_DEPTH_FUNC,
                                    GLES_DEPTH_WRITEMASK};
    static const uint16_t ints3[] = {GLES_VERTEX_ARRAY_BINDING, GLES_PIXEL_UNPACK_BUFFER_BINDING,
                                     GLES_UNPACK_ROW_LENGTH,    GLES_UNPACK_SKIP_ROWS,
                                     GLES_UNPACK_SKIP_PIXELS,   GLES_READ_FRAMEBUFFER_BINDING};
    static const uint16_t attributes[] = {GLES_VERTEX_ATTRIB_ARRAY_ENABLED, GLES_VERTEX_ATTRIB_ARRAY_SIZE,
                                          GLES_VERTEX_ATTRIB_ARRAY_TYPE,    GLES_VERTEX_ATTRIB_ARRAY_NORMALIZED,
                                          GLES_VERTEX_ATTRIB_ARRAY_STRIDE,  GLES_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING};
    const struct fake kept = f;
    const gles_procs *gl = is_real() ? &f.real : &wrappers;
    snapshot s = {out, 0};
    gl_int v[4] = {0}, active = 0;
    gl_float c[4] = {0};
    f.fail_at = f.lose_at = 0;
    for (size_t i = 0; i < sizeof ints / sizeof *ints; i++) {
        gl->GetIntegerv(ints[i], v);
        note(&s, v[0], "int", ints[i], 0);
    }
    for (size_t i = 0; i < sizeof ints3 / sizeof *ints3 && f.o.es == 3 && !f.o.no_optional; i++) {
        gl->GetIntegerv(ints3[i], v);
        note(&s, v[0], "int", ints3[i], 0);
    }
    gl->GetIntegerv(GLES_VIEWPORT, v);
    for (int k = 0; k < 4; k++) note(&s, v[k], "viewport", 0, k);
    gl->GetIntegerv(GLES_COLOR_WRITEMASK, v);
    for (int k = 0; k < 4; k++) note(&s, v[k], "color mask", 0, k);
    gl->GetFloatv(GLES_COLOR_CLEAR_VALUE, c);
    for (int k = 0; k < 4; k++) note(&s, (long)(c[k] * 1000), "clear color", 0, k);
    gl->GetFloatv(GLES_DEPTH_CLEAR_VALUE, c);
    note(&s, (long)(c[0] * 1000), "clear depth", 0, 0);
    for (size_t i = 0; i < cap_count(); i++) note(&s, gl->IsEnabled(caps[i]), "enabled", caps[i], 0);
    gl->GetIntegerv(GLES_ACTIVE_TEXTURE, &active);
    for (int u = 0; u < 8; u++) {
        gl->ActiveTexture(GLES_TEXTURE0 + (gl_enum)u);
        gl->GetIntegerv(GLES_TEXTURE_BINDING_2D, v);
        note(&s, v[0], "texture", 0, u);
        if (f.o.es == 3 && !f.o.no_optional) {
            gl->GetIntegerv(GLES_SAMPLER_BINDING, v);
            note(&s, v[0], "sampler", 0, u);
        }
    }
    gl->ActiveTexture((gl_enum)active);
    for (gl_uint i = 0; i < 6; i++) {
        void *pointer = NULL;
        for (size_t k = 0; k < sizeof attributes / sizeof *attributes; k++) {
            gl->GetVertexAttribiv(i, attributes[k], v);
            note(&s, v[0], "attribute", attributes[k], (int)i);
        }
        gl->GetVertexAttribPointerv(i, GLES_VERTEX_ATTRIB_ARRAY_POINTER, &pointer);
        note(&s, (long)(intptr_t)pointer, "attribute pointer", 0, (int)i);
    }
    f = kept; /* counters too */
    return s.n;
}

const char *fake_gl_state_name(int i)
{
    return i >= 0 && i < FAKE_GL_STATES ? state_names[i] : "";
}
