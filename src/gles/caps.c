/* SPDX-License-Identifier: MIT */
/* What this context is and what it can do. */
#include "gles.h"

#include <string.h>

/* 1 when the text starts with word. */
static int starts_with(const char *text, const char *word)
{
    while (*word)
        if (*text++ != *word++) return 0;
    return 1;
}

/* 1 when list, words between spaces, holds exactly this word: GL_OES_texture_3D is not GL_OES_texture_3D_extra. */
static int list_has(const char *list, const char *word)
{
    while (*list) {
        const char *w = word;
        while (*list == ' ') list++;
        while (*w && *list == *w) {
            list++;
            w++;
        }
        if (!*w && (*list == ' ' || !*list)) return 1;
        while (*list && *list != ' ') list++;
    }
    return 0;
}

/* major: of the GL version; from 3 on extensions are listed one by one. */
static int has_extension(const gles_procs *gl, unsigned major, const char *name)
{
    const char *list;
    gl_int count = 0;
    gl_int i;
    if (major < 3 || !gl->GetStringi) {
        list = (const char *)gl->GetString(GLES_EXTENSIONS);
        return list && list_has(list, name);
    }
    gl->GetIntegerv(GLES_NUM_EXTENSIONS, &count);
    for (i = 0; i < count; i++) {
        const char *e = (const char *)gl->GetStringi(GLES_EXTENSIONS, (gl_uint)i);
        if (e && list_has(e, name)) return 1;
    }
    return 0;
}

/* "OpenGL ES 3.2 ...", "4.5 (Compatibility Profile) ...": 10 * major + minor, *desktop; 0 when it is neither. */
static unsigned parse_version(const char *text, uint8_t *desktop)
{
    static const char es[] = "OpenGL ES ";
    unsigned major;
    *desktop = !starts_with(text, "OpenGL ES");
    if (!*desktop) {
        if (!starts_with(text, es)) return 0; /* OpenGL ES-CM 1.1 */
        text += sizeof es - 1;
    }
    if (*text < '1' || *text > '9' || text[1] != '.' || text[2] < '0' || text[2] > '9') return 0;
    major = (unsigned)(*text - '0');
    return 10 * major + (unsigned)(text[2] - '0');
}

static uint16_t limit(const gles_procs *gl, gl_enum name, gl_int floor, gl_int ceiling)
{
    gl_int v = 0;
    gl->GetIntegerv(name, &v);
    if (v < floor) v = floor;
    if (v > ceiling) v = ceiling;
    return (uint16_t)v;
}

/* Of the GPUs whose compilers we know, only Bifrost (Mali-G31, G51, G52, G71, G72, G76) looks x^n of one lobe up faster than
   it computes it: 1.54 cycles against 1.79. */
static int has_fast_tables(const char *renderer)
{
    static const char name[] = "Mali-G", models[] = "315152717276";
    const char *m;
    unsigned i = 0;
    for (; renderer && *renderer; renderer++) {
        for (i = 0; name[i] && renderer[i] == name[i]; i++) continue;
        if (name[i]) continue;
        for (m = models; *m; m += 2)
            if (renderer[i] == m[0] && renderer[i + 1] == m[1]) return 1;
    }
    return 0;
}

nacre_result gles_caps_read(gles_caps *caps, const gles_procs *gl)
{
    const char *text = (const char *)gl->GetString(GLES_VERSION);
    unsigned version, major;
    gles_caps c = {0};
    if (!text) return NACRE_ERR_LOST;
    version = parse_version(text, &c.desktop);
    major = version / 10;
    if (version < 20) return NACRE_ERR_UNSUPPORTED;
    if (c.desktop && version < 41 && !has_extension(gl, major, "GL_ARB_ES2_compatibility"))
        return NACRE_ERR_UNSUPPORTED;

    c.es3 = c.desktop ? version >= 43 || has_extension(gl, major, "GL_ARB_ES3_compatibility") : version >= 30;
    c.es3_texts = c.es3 && gl->DrawBuffers;
    c.level_limit = c.unpack_rows = c.desktop || c.es3;
    c.npot = c.desktop || c.es3 || has_extension(gl, major, "GL_OES_texture_npot");
    c.index_uint = c.desktop || c.es3 || has_extension(gl, major, "GL_OES_element_index_uint");
    c.two_framebuffers = version >= 30;
    c.vertex_arrays = gl->GenVertexArrays && gl->DeleteVertexArrays && gl->BindVertexArray;
    c.samplers = gl->BindSampler != NULL;
    if (c.es3)
        c.etc1 = c.etc2 = GLES_COMPRESSED_RGB8_ETC2;
    else if (has_extension(gl, major, "GL_OES_compressed_ETC1_RGB8_texture"))
        c.etc1 = GLES_ETC1_RGB8;
    /* The minima of ES 2.0 (table 6.20) where a driver answers nothing. */
    c.max_texture = limit(gl, GLES_MAX_TEXTURE_SIZE, 64, 32768);
    c.units = (uint8_t)limit(gl, GLES_MAX_TEXTURE_IMAGE_UNITS, 2, GLES_MAX_UNITS);
    c.fragment_vectors = limit(gl, GLES_MAX_FRAGMENT_UNIFORM_VECTORS, 16, 4096);
    c.vertex_vectors = limit(gl, GLES_MAX_VERTEX_UNIFORM_VECTORS, 128, 4096);
    c.power_table = has_fast_tables((const char *)gl->GetString(GLES_RENDERER));
    *caps = c;
    return NACRE_OK;
}

/* Names without "gl", each with its NUL; pointers of gles_procs in the same order. */
#define NAME_V(name, parameters, arguments)       #name "\0"
#define NAME_R(type, name, parameters, arguments) #name "\0"
static const char required_names[] = GLES_PROCS(NAME_V, NAME_R);
#undef NAME_V
#undef NAME_R

typedef void(GLES_APIENTRY *any_proc)(void);

/* Where entry points beyond ES 2.0 come from: a version, or an extension with a suffix of its own. Loaders may answer for
   functions that the context has not, so only those that it must have are asked for. */
static const struct {
    uint16_t offset;     /* in gles_procs */
    uint8_t es, desktop; /* 10 * major + minor, 0: never */
    char name[24], suffix[4], extension[28];
} optional[] = {
#define ROW(name, es, desktop, suffix, extension)                                                                      \
    {                                                                                                                  \
        offsetof(gles_procs, name), es, desktop, #name, suffix, extension                                              \
    }
    ROW(GetStringi, 30, 30, "", ""), /* first: lists extensions */
    ROW(GenVertexArrays, 30, 30, "OES", "GL_OES_vertex_array_object"),
    ROW(DeleteVertexArrays, 30, 30, "OES", "GL_OES_vertex_array_object"),
    ROW(BindVertexArray, 30, 30, "OES", "GL_OES_vertex_array_object"),
    ROW(DrawBuffers, 30, 20, "", ""),
    ROW(BindSampler, 30, 33, "", ""),
    ROW(GetGraphicsResetStatus, 32, 45, "KHR", "GL_KHR_robustness"),
    ROW(GetGraphicsResetStatus, 0, 0, "EXT", "GL_EXT_robustness"),
    ROW(GetGraphicsResetStatus, 0, 0, "ARB", "GL_ARB_robustness"),
#undef ROW
};

/* "gl" name suffix, and how the caller's loader answers. text holds 40 characters: the longest name has 23. */
static void *ask(const nacre_gles_desc *desc, char *text, const char *name, const char *suffix)
{
    unsigned n = 2;
    text[0] = 'g';
    text[1] = 'l';
    while (*name) text[n++] = *name++;
    while (*suffix) text[n++] = *suffix++;
    text[n] = 0;
    return desc->get_proc(desc->user, text);
}

/* The pointers of gl are NULL before. On desktop GL, names of KHR extensions have no suffix. */
static void load_optional(const nacre_gles_desc *desc, gles_procs *gl)
{
    const char *text = (const char *)gl->GetString(GLES_VERSION);
    char name[40];
    uint8_t desktop = 0;
    const unsigned version = text ? parse_version(text, &desktop) : 0;
    unsigned i;
    for (i = 0; i < sizeof optional / sizeof *optional; i++) {
        char *const at = (char *)gl + optional[i].offset;
        const unsigned since = desktop ? optional[i].desktop : optional[i].es;
        void *proc = NULL;
        if (since && version >= since)
            proc = ask(desc, name, optional[i].name, "");
        else if (version && *optional[i].extension && has_extension(gl, version / 10, optional[i].extension))
            proc = ask(desc, name, optional[i].name, desktop && *optional[i].suffix == 'K' ? "" : optional[i].suffix);
        if (proc) memcpy(at, &proc, sizeof proc);
    }
}

nacre_result gles_procs_load(nacre_gles *gles)
{
    char *out = (char *)&gles->gl;
    const char *name;
    char text[40];
    void *proc;
    memset(&gles->gl, 0, sizeof gles->gl);
    /* ISO C has no cast from void * to a function pointer; where there is a GL loader the bits are the same. */
    for (name = required_names; *name; name++) {
        proc = ask(&gles->desc, text, name, "");
        if (!proc) return gles_fail(gles, NACRE_ERR_UNSUPPORTED, "missing entry point: ", text);
        memcpy(out, &proc, sizeof proc);
        out += sizeof(any_proc);
        while (*name) name++;
    }
    load_optional(&gles->desc, &gles->gl);
    return NACRE_OK;
}
