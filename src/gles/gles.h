/* SPDX-License-Identifier: MIT */
/*
 * gles.h - inside of the GLES backend: one object in the caller's block
 *
 * Block: nacre_gles, then max_programs x gles_program, max_items x gles_item, max_textures x gles_texture.
 * GL names are 0 where nothing is made. gles_check and gles_gl_failed are for calls that create; a draw asks no errors.
 */
#ifndef GLES_GLES_H
#define GLES_GLES_H

#include "key.h"
#include "nacre_gles.h"
#include "proc.h"
#include "shade.h"
#include "uniforms.h"

/* Programs use at most the 8 units that ES 2.0 guarantees: the texts are then the same on every device. */
#define GLES_MAX_UNITS 8

typedef struct gles_caps {
    uint8_t desktop;          /* desktop GL with ES 2.0 compatibility, as OSMesa gives */
    uint8_t es3;              /* is ES 3, or desktop GL compatible with it */
    uint8_t es3_texts;        /* takes GLSL ES 3.00, and programs that write two targets */
    uint8_t level_limit;      /* has GL_TEXTURE_MAX_LEVEL */
    uint8_t unpack_rows;      /* has GL_UNPACK_ROW_LENGTH and its kin, and pixel unpack buffers */
    uint8_t npot;             /* mips and repetition of textures whose sides are no powers of two */
    uint8_t index_uint;       /* 32-bit indices */
    uint8_t two_framebuffers; /* separate bindings for reading and drawing */
    uint8_t vertex_arrays;
    uint8_t samplers;     /* has sampler objects, which would override our filters */
    uint8_t power_table;  /* looks x^n up faster than it computes it */
    uint8_t units;        /* texture units that we use, at most GLES_MAX_UNITS */
    uint16_t etc1, etc2;  /* GL format for files of ETC1 and of any ETC2 RGB blocks; 0: none */
    uint16_t max_texture; /* texels a side */
    uint16_t fragment_vectors, vertex_vectors;
} gles_caps;

typedef struct gles_program {
    gles_key key;
    gl_uint name;  /* 0: free */
    uint32_t used; /* value of nacre_gles.clock when it was last used */
    gles_uniforms at;
} gles_program;

/* One layer of an image. The layers of one image lie side by side; the first counts the items that use them. */
typedef struct gles_texture {
    const nacre_image *image; /* NULL: free */
    gl_uint name;
    uint16_t users; /* of the whole image; layer 0 only */
    uint8_t layer;
    uint8_t role; /* nacre_role: filter and wrap follow from it */
} gles_texture;

typedef enum gles_source {
    GLES_SOURCE_FREE = 0, /* slot not in use */
    GLES_SOURCE_MESH,     /* buffers of ours, made from a borrowed mesh */
    GLES_SOURCE_BUFFERS,  /* the caller's buffers */
    GLES_SOURCE_LOST,     /* the caller's buffers, to be described again after a context loss */
    GLES_SOURCE_BOUND,    /* none: bind only */
    GLES_SOURCE_LIT       /* a lit sphere */
} gles_source;

/* A sum of light passes in two RGBA8 textures: high bytes, low bytes. */
typedef struct gles_sum {
    gl_uint texture[2], framebuffer[2];
    uint16_t width, height; /* 0: none */
} gles_sum;

typedef struct gles_lit {
    uint64_t shown, begun; /* what the picture shows, what the update under way began with (lit.c), 0: nothing */
    gl_uint texture, framebuffer;
    gles_sum sum;                        /* of the update under way */
    int32_t eye_q28[3], next_eye_q28[3]; /* towards the eye, view space: of the picture, of the update under way */
    uint32_t pictures;
    uint16_t size, view_tolerance, lights_done;
    uint8_t rgb565, output, next_output, under_way, mixed /* since begun, something changed */, failed;
} gles_lit;

typedef struct gles_item {
    uint32_t generation; /* 24 bits, of the id that is or will be given out */
    uint8_t source;      /* gles_source */
    uint16_t first_texture[NACRE_ROLE_COUNT];
    const nacre_image *image[NACRE_ROLE_COUNT]; /* NULL: the material has none */
    gl_uint vertex_buffer, index_buffer;        /* of GLES_SOURCE_MESH */
    union {
        nacre_mesh mesh;
        nacre_gles_buffers buffers;
        gles_lit lit;
    } is;
    nacre_gles_lit use[2]; /* lit spheres to draw by, 0: none */
    shade_material material;
} gles_item;

/* What draw and bind put back. */
typedef struct gles_saved {
    gl_int program, vertex_array, array_buffer, element_buffer, active_texture;
    gl_int texture[GLES_MAX_UNITS], sampler[GLES_MAX_UNITS];
    struct {
        gl_int enabled, size, type, normalized, stride, buffer;
        void *pointer;
    } attribute[NACRE_GLES_ATTRIBUTE_COUNT];
    uint8_t units;      /* 0..units - 1 are saved and changed */
    uint8_t attributes; /* bit i: attribute i is saved and changed */
    uint8_t buffers;    /* array and, without vertex arrays, element array bindings are saved and changed */
    uint8_t arrays;     /* the vertex array binding is saved and changed */
} gles_saved;

/* For light passes of draws: the previous and the new sum, and a depth buffer. */
typedef struct gles_targets {
    gles_sum sum[2];
    gl_uint depth; /* renderbuffer */
    uint32_t depth_bytes;
} gles_targets;

struct nacre_gles {
    gles_procs gl;
    nacre_gles_desc desc; /* defaults filled in */
    gles_caps caps;
    gles_program *programs;
    gles_item *items;
    gles_texture *textures;
    gles_targets targets;
    gles_sum lit_sum[2];    /* for light passes of lit spheres */
    gl_uint lit_triangle;   /* vertex buffer: one triangle over the whole picture */
    uint32_t clock;         /* programs' age */
    uint32_t texture_bytes; /* textures and targets */
    gl_uint vertex_array;   /* ours; 0 where the device has none */
    uint32_t described;     /* id of the item whose buffers vertex_array describes, 0: none */
    uint8_t enabled;        /* bit i: attribute i is enabled in vertex_array */
    uint8_t resident;       /* GL objects exist */
    uint8_t lost;           /* a call found the context lost */
    uint8_t bound;          /* bind without unbind: saved is in use */
    gles_saved saved;
    nacre_gles_state changed;
};

/* caps.c */
nacre_result gles_procs_load(nacre_gles *gles);
nacre_result gles_caps_read(gles_caps *caps, const gles_procs *gl);

/* 1: programs are GLSL ES 3.00, else 1.00. */
static inline int gles_uses_es3(const nacre_gles *gles)
{
    return gles->caps.es3_texts && !gles->desc.prefer_es2;
}

/* lost.c: results, messages, and the life of GL objects */
/* Log text and detail (may be NULL) as one message; returns result. */
nacre_result gles_fail(nacre_gles *gles, nacre_result result, const char *text, const char *detail);
/* Drop errors of earlier calls that were not ours; ERR_LOST when the context is: no GL call until restore then. */
nacre_result gles_begin(nacre_gles *gles);
/* Read GL's errors: OK, ERR_LOST, or ERR_GL with a message. */
nacre_result gles_check(nacre_gles *gles, const char *what);
/* A call gave no object: gles_check, but never OK. */
nacre_result gles_gl_failed(nacre_gles *gles, const char *what);
/* Entry points, capabilities, and all that the items need. On failure nothing is left. */
nacre_result gles_start(nacre_gles *gles);
void gles_delete_all(nacre_gles *gles);

/* item.c */
/* NULL for ids that were never given out or are removed. */
gles_item *gles_item_find(nacre_gles *gles, nacre_gles_item id);
/* Vertex attributes that its images ask for. */
int gles_item_needs_tangent(const gles_item *item);
int gles_item_needs_uv(const gles_item *item);

/* program.c */
/* The program for key, compiled where needed, made current. */
nacre_result gles_program_use(nacre_gles *gles, const gles_key *key, gles_program **out);
void gles_program_delete(nacre_gles *gles, gles_program *program);

/* upload.c: the caller saves and puts back bindings (gles_upload_begin) */
/* Texel bytes of all layers of an image in that role; ERR_UNSUPPORTED. Makes nothing. */
nacre_result gles_texture_cost(const gles_caps *caps, const nacre_image *image, unsigned role, uint32_t *bytes);
/* How many textures an image becomes: one a layer, or one in all for quartered spheres. */
unsigned gles_texture_count(const nacre_image *image, unsigned role);
/* Make one layer's texture. On failure the name, if any, is left in the record. */
nacre_result gles_texture_upload(nacre_gles *gles, gles_texture *texture);
nacre_result gles_mesh_upload(nacre_gles *gles, gles_item *item);
void gles_mesh_delete(nacre_gles *gles, gles_item *item);

/* state.c */
typedef struct gles_upload_state {
    gl_int texture, array_buffer, element_buffer, alignment, unpack_buffer, row[3];
} gles_upload_state;
/* Save what uploads change and set what they need; put it back. */
void gles_upload_begin(const nacre_gles *gles, gles_upload_state *state);
void gles_upload_end(const nacre_gles *gles, const gles_upload_state *state);
/* Save program and texture unit. With query 0, here and below, nothing is asked and only what changes is noted. */
void gles_save(const nacre_gles *gles, gles_saved *saved, int query);
/* same: our vertex array already describes the buffers. attributes: bit i: array i is going to be used. */
void gles_save_buffers(const nacre_gles *gles, gles_saved *saved, unsigned attributes, int same, int query);
/* Bind a texture, saving what was there the first time. */
void gles_texture_bind(const nacre_gles *gles, gles_saved *saved, unsigned unit, gl_uint name, int query);
void gles_put_back(const nacre_gles *gles, const gles_saved *saved);
/* Under host_resets_state, in place of gles_put_back: report what was left. */
void gles_note(nacre_gles *gles, const gles_saved *saved);

/* draw.c */
typedef struct gles_draw { /* one draw on its way */
    const nacre_view *view;
    const gles_item *item;
    uint32_t id;
    const gles_lit *lit[2]; /* spheres to draw by, NULL: shade directly */
    uint8_t sphere;         /* 1: the picture of a lit sphere */
    uint8_t first_lobe;     /* sbrdf: of the sum pass under way */
    uint8_t sum_lights;     /* 0: one pass; else passes of so many lights (1, 2, 4 or 8) and a last one without */
    int query;              /* 0 under host_resets_state */
    int form;               /* shade_form of frame, -1: not set up */
    unsigned first_light;   /* of frame: it holds NACRE_MAX_LIGHTS from here */
    nacre_q16 centre[3];
    gles_vertex_map vertices;
    shade_frame frame;
} gles_draw;
/* The key of a pass with so many lights (gles_key_pass). */
void gles_key_of(const nacre_gles *gles, gles_key *key, const gles_draw *draw, unsigned lights, unsigned pass);
/* Lights of the pass that begins with this one. */
unsigned gles_pass_lights(const gles_draw *draw, unsigned first_light);
/* Go on to the next pass over the same lights, with the lobes that there was no room for; 0: there is none. */
int gles_pass_next_lobes(gles_draw *draw);
/* Program, the model's textures and uniforms of one pass. */
nacre_result gles_pass_bind(nacre_gles *gles, gles_draw *draw, gles_saved *saved, const gles_key *key,
                            unsigned first_light, gles_program **program);
void gles_bind_vertices(nacre_gles *gles, const gles_draw *draw, gles_saved *saved);
/* glDraw* of the item. */
void gles_issue(const nacre_gles *gles, const gles_item *item);

int gles_view_is_valid(const nacre_view *view);
/* One pass, or several, for this draw on this device; in_passes: several even where one would do. */
nacre_result gles_plan_passes(const nacre_gles *gles, gles_draw *draw, int in_passes);

/* passes.c */
nacre_result gles_draw_passes(nacre_gles *gles, gles_draw *draw, gles_saved *saved);
void gles_targets_delete(nacre_gles *gles);

/* State that passes change and the last one, or the host, needs back. */
typedef struct gles_host_state {
    gl_int framebuffer, viewport[4], depth_func, depth_mask, color_mask[4];
    gl_float clear_color[4], clear_depth;
    gl_boolean enabled[6];
    uint8_t switches; /* of enabled that are kept */
} gles_host_state;
/* picture: 0 before passes of a mesh, 1 before gles_picture_state. */
void gles_host_save(const nacre_gles *gles, gles_host_state *s, int picture);
void gles_host_put_back(const nacre_gles *gles, const gles_host_state *s);
/* State for drawing a picture or its sums: nothing but the triangle. */
void gles_picture_state(const nacre_gles *gles, gl_int size);

/* Target for GL calls that bind what is drawn to. */
gl_enum gles_draw_target(const nacre_gles *gles);
/* An RGBA8 or RGB565 texture and its framebuffer, counted nowhere; depth: renderbuffer, 0: none. Bindings of texture and
   framebuffer are changed. On failure names, if any, are left. */
nacre_result gles_target_make(nacre_gles *gles, gl_uint *texture, gl_uint *framebuffer, gl_int width, gl_int height,
                              int rgb565, gl_int filter, gl_uint depth);
/* The same twice, counted in texture_bytes; nothing is left on failure. */
nacre_result gles_sum_make(nacre_gles *gles, gles_sum *sum, gl_int width, gl_int height, gl_uint depth);
void gles_sum_delete(nacre_gles *gles, gles_sum *sum);
void gles_sum_clear(nacre_gles *gles, const gles_sum *sum);
/* Draw both bytes of sum[1 - from] = sum[from] + lights of the pass that begins with this one. */
nacre_result gles_sum_pass(nacre_gles *gles, gles_draw *draw, gles_saved *saved, const gles_sum sum[2],
                           unsigned first_light, unsigned from);
/* Bind sum as the previous one, and draw the last pass to the framebuffer that is bound. */
nacre_result gles_last_pass(nacre_gles *gles, gles_draw *draw, gles_saved *saved, const gles_sum *sum);

/* lit.c */
/* The spheres that this item is drawn by in this view; 0: none. */
int gles_lit_of(nacre_gles *gles, const gles_item *item, const nacre_view *view, const gles_lit *out[2]);
void gles_lit_abandon(gles_lit *lit);
/* GL objects and their bytes. */
void gles_lit_delete(nacre_gles *gles, gles_lit *lit);

#endif
