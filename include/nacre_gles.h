/* SPDX-License-Identifier: MIT */
/*
 * nacre_gles.h - the OpenGL ES 2.0 / 3.0 backend (conventions: nacre.h). Includes no GL header.
 */
#ifndef NACRE_GLES_H
#define NACRE_GLES_H

#include "nacre.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nacre_gles nacre_gles;
typedef struct nacre_gles_item {
    uint32_t id;
} nacre_gles_item; /* 0 is never valid */

/* How x^n of SBRDF materials is found. A table takes a texture unit: where none of 8 is left (three lobes with a normal
   map), and where the material has none, it is computed. */
typedef enum nacre_gles_power {
    NACRE_GLES_POWER_AUTO =
        0, /* the table on Mali's Bifrost GPUs, for one lobe of exponents of 3 and more; else computed */
    NACRE_GLES_POWER_COMPUTED, /* log2 and exp2 */
    NACRE_GLES_POWER_TABLE     /* the material's NACRE_ROLE_POWER */
} nacre_gles_power;

typedef struct nacre_gles_desc {
    void *(*get_proc)(void *user, const char *name); /* required; all GL entry points come from it */
    nacre_log_fn log;                                /* (none) shader and link texts in full */
    void *user;                                      /* passed to get_proc and log */
    uint32_t texture_budget;   /* (unlimited) bytes of texels, render targets of light passes included */
    uint8_t max_items;         /* (16) mesh + material pairs, 1..255 */
    uint8_t max_programs;      /* (8) programs kept; the least recently used is dropped */
    uint16_t max_textures;     /* (48) texture objects: one for each layer of each image; items share them */
    uint8_t host_resets_state; /* (0) 1: draw and bind query nothing and leave changed what nacre_gles_state lists */
    uint8_t power;             /* nacre_gles_power (as this device does it faster) */
    uint8_t prefer_es2;        /* (0) 1: GLSL ES 1.00 texts also on a GLES 3 context */
} nacre_gles_desc;

/* Bytes of the block for this desc, which must be 4-byte aligned; 0 if desc is not valid. On 64-bit machines about
   984 + 144 a program + 400 an item + 16 a texture: 9,308 by default. */
size_t nacre_gles_size(const nacre_gles_desc *desc);

/* The calling thread's GL context must be current, here and in every call below but abandon, texture_bytes and changed;
   until abandon always the same one.
   Init, add, prepare, restore, and draws that must compile or make targets, read glGetError: an error that was pending
   is dropped.
   NACRE_ERR_UNSUPPORTED: an entry point is missing, or the context is older than ES 2.0 / GL 2.0 + ES2 compatibility.
   NACRE_ERR_GL / LOST: GL made no objects. */
nacre_result nacre_gles_init(nacre_gles **out, void *block, size_t size, const nacre_gles_desc *desc);

/* Attribute locations of every nacre program, for applications with buffers or draw loops of their own. */
#define NACRE_GLES_POSITION        0 /* vec3 */
#define NACRE_GLES_NORMAL          1 /* vec3, need not be unit length */
#define NACRE_GLES_TANGENT         2 /* vec4, w = handedness; only read with a normal map and by SBRDF */
#define NACRE_GLES_UV              3 /* vec2; only read with maps: normal, mask, albedo and lobes, index */
#define NACRE_GLES_ATTRIBUTE_COUNT 4

typedef struct nacre_gles_attribute {
    uint32_t type;      /* GL enum: GL_FLOAT 0x1406, GL_FIXED 0x140C, GL_HALF_FLOAT 0x140B or 0x8D61, GL_BYTE 0x1400,
                           GL_SHORT 0x1402, or the unsigned 0x1401, 0x1403. The device must have it */
    uint8_t count;      /* 1..4 components; 0: the mesh has no such attribute */
    uint8_t normalized; /* 1: integer types map to -1..1 or 0..1 */
    uint32_t offset;    /* bytes into the vertex buffer */
    uint32_t stride;    /* bytes from vertex to vertex, 0 = tight */
} nacre_gles_attribute;

/* Buffers that the application owns. Positions are object space as stored; the names must be valid in the current
   context whenever the item is drawn. */
typedef struct nacre_gles_buffers {
    uint32_t vertex_buffer; /* GL name */
    uint32_t index_buffer;  /* GL name; 0: draw arrays */
    uint32_t index_type;    /* GL_UNSIGNED_SHORT 0x1403, or GL_UNSIGNED_INT 0x1405 where the device has it */
    uint32_t index_offset;  /* bytes */
    uint32_t first, count;  /* first: of glDrawArrays; count: vertices or indices, a multiple of 3 */
    nacre_gles_attribute attribute[NACRE_GLES_ATTRIBUTE_COUNT];
    nacre_q16 centre[3]; /* object space, of the mesh's bounds: what distant_viewer looks at */
} nacre_gles_buffers;

/* Upload straight from the borrowed bytes. The structs are copied, but the images, their bytes, vertices and indices
   are borrowed until the item is removed, so that restore can repeat it. Textures are shared by items whose material
   names the same nacre_image. Mips that a device can't use (ES 2.0: sides that are no powers of two, chains cut short)
   are not uploaded; nor do such normal maps repeat there; an image larger than the device's textures starts at its first
   level that fits.
   NACRE_ERR_ARGUMENT: material or mesh not valid. NACRE_ERR_ASSET: an image lacks what its model needs.
   NACRE_ERR_UNSUPPORTED: a texture format or size that the device has not (blocks of ETC2: `nacre bake --format etc1` makes
   files for GLES 2 with GL_OES_compressed_ETC1_RGB8_texture and for GLES 3, rgb8 and rgb565 draw everywhere).
   NACRE_ERR_BUDGET: texture_budget, max_textures or max_items; nothing was created.
   NACRE_ERR_GL / LOST: upload failed. Nothing is half-made. */
nacre_result nacre_gles_add(nacre_gles *gles, const nacre_mesh *mesh, const nacre_material *material,
                            nacre_gles_item *out);
/* The same with the caller's buffers (copied description), or with buffers == NULL for items that are only bound: those
   have their centre at the object's origin. Positions need 2..4 components, normals 3..4; with a normal map tangents 4
   and uv 2..4. NACRE_ERR_UNSUPPORTED also: 32-bit indices that the device has not. */
nacre_result nacre_gles_add_buffers(nacre_gles *gles, const nacre_gles_buffers *buffers, const nacre_material *material,
                                    nacre_gles_item *out);
/* Unknown or removed items are ignored. */
void nacre_gles_remove(nacre_gles *gles, nacre_gles_item item);
/* Describe the caller's new buffers after a context loss, or when they changed. */
nacre_result nacre_gles_set_buffers(nacre_gles *gles, nacre_gles_item item, const nacre_gles_buffers *buffers);

/* Compile now what drawing this item in this view will need (lights, camera kind and output count; numbers do not),
   not at the first draw. */
nacre_result nacre_gles_prepare(nacre_gles *gles, nacre_gles_item item, const nacre_view *view);

/* Draw. Puts back every GL state it changes (see host_resets_state). Framebuffer, viewport, blend, depth, stencil, masks
   and cull are the caller's; where there are no vertex arrays, instance divisors of arrays 0..3 must be 0. Alpha is
   written as 1; SBRDF: as the opacity of the texel, for the caller's blending.
   Lights that one program can't hold on this device (uniform vectors, texture units; GLSL ES 1.00 programs hold 6 lights of
   a fine table, 4 of SBRDF and of a blended palette; with directions per pixel 4 of a table, fine or not, of a palette and of
   SBRDF, 2 of a blended palette and of spheres, 1 of spheres with the cosine in the image) are drawn in passes
   through render targets of nacre's own, as large as the viewport (18 bytes a pixel, counted in texture_budget, kept
   until the viewport changes). They hold linear sums at 16 bits a channel, up to 1 (NACRE_OUTPUT_LINEAR: 16), for the
   nearest surface of the item at each pixel, by a depth buffer of their own (projections, and a glDepthRange, that let
   depth fall with distance are understood; an empty range is not). The last pass alone draws to the caller's
   framebuffer, with the caller's depth, stencil, blend and mask states. There is one sum a pixel: in a multisampled
   framebuffer, samples of pixels whose centre the item misses get ambient alone. prepare compiles the passes' programs,
   up to four.
   No errors are read: NACRE_ERR_GL and LOST come only from compiling and from making targets. NACRE_ERR_ARGUMENT: the
   view is not valid, or the item is unknown, only bound, or waits for set_buffers. NACRE_ERR_UNSUPPORTED: not even one
   light fits, or the viewport is larger than textures may be. NACRE_ERR_BUDGET: the targets. NACRE_ERR_LOST also: known
   to be lost, or abandoned; nothing was called. */
nacre_result nacre_gles_draw(nacre_gles *gles, nacre_gles_item item, const nacre_view *view);

/* ---- the lit sphere: any number of directional lights for one fetch a pixel ---------------------------------------

   Under directional lights and one view direction radiance depends on the normal alone. A lit sphere is a small picture
   of a sphere in one material under one set of lights, seen from one direction, in finished display codes. Items that
   use it are drawn with one fetch by their normal, as a MatCap is: 1 light, 64 lights and an environment cost the same.

     nacre_gles_lit_add(gles, &material, NULL, &lit);              once
     nacre_gles_use_lit(gles, item, lit, none);                    once
     nacre_gles_lit_update(gles, lit, mesh.centre, &view, 0);      before the frame; does nothing while nothing changed
     nacre_gles_draw(gles, item, &view);                           as ever

   Use it for more than one directional light, and for environments (as lights: `nacre bake lights`); point lights need
   direct shading. Where an item's lit sphere holds no picture, or one for another output than the view's, draw shades
   directly. */
typedef struct nacre_gles_lit {
    uint32_t id;
} nacre_gles_lit; /* 0 is never valid */

typedef struct nacre_gles_lit_desc {
    uint16_t size;            /* (128) texels a side, 16..512: 4 bytes a texel. 64 for matt, 256 for glossy materials */
    uint8_t rgb565;           /* (0) 1: 2 bytes a texel, visibly coarser */
    nacre_bam view_tolerance; /* (64: 0.35 degrees) a picture is kept while the view direction has moved by less */
} nacre_gles_lit_desc;

/* Make a lit sphere of a material (TABLE or SPHERES; its normal map and mask are ignored). It takes one of max_items, and
   its texture counts in texture_budget. desc may be NULL. Results as for nacre_gles_add;
   NACRE_ERR_UNSUPPORTED also: SBRDF and PALETTE, which are no one material. */
nacre_result nacre_gles_lit_add(nacre_gles *gles, const nacre_material *material, const nacre_gles_lit_desc *desc,
                                nacre_gles_lit *out);
/* Unknown ones are ignored; items that use it are shaded directly. */
void nacre_gles_lit_remove(nacre_gles *gles, nacre_gles_lit lit);

/* Bring the picture up to date: the view's lights (all directional, up to NACRE_MAX_LIT_LIGHTS), exposure, ambient, tint
   and output, seen from the direction in which an object with this centre (object space; NULL: its origin) has the eye.
   Nothing is drawn while neither these nor the view direction changed (view_tolerance). budget 0: at once; else spread
   over calls, so many lights a call, rounded up to what one pass holds: items show the last finished picture meanwhile,
   lights that move in between enter as they are when their turn comes.
   More lights than one program holds are summed in passes, in linear radiance at 16 bits a channel, clamped to 1 (linear
   output: 16); only the last pass writes display codes.
   Call it with the host's GL state as it is, outside bind .. unbind: framebuffer, viewport and all other state are left as
   found. On failure items that use it are shaded directly until an update succeeds.
   NACRE_ERR_ARGUMENT: view or lit not valid. NACRE_ERR_UNSUPPORTED: a point light. NACRE_ERR_BUDGET: texture_budget: passes
   need 16 bytes a texel more, shared by lit spheres of one size, and 8 for each whose update is spread. NACRE_ERR_GL: a
   framebuffer that is not complete, too. NACRE_ERR_LOST. */
nacre_result nacre_gles_lit_update(nacre_gles *gles, nacre_gles_lit lit, const nacre_q16 centre[3],
                                   const nacre_view *view, unsigned budget);

typedef struct nacre_gles_lit_state {
    uint8_t ready;        /* 1: it holds a picture */
    uint8_t current;      /* 1: of what the last update asked for; 0: an update is under way, or failed */
    uint16_t lights_done; /* of the update under way */
    uint32_t pictures;    /* finished so far */
} nacre_gles_lit_state;
/* All 0 for unknown ones. */
void nacre_gles_lit_get_state(const nacre_gles *gles, nacre_gles_lit lit, nacre_gles_lit_state *out);

/* Draw and bind an item by a lit sphere, of any material (its own model is what direct shading falls back to); id 0: directly
   again. With two, the material's mask (red) mixes their display codes; without a mask the second is ignored. Both
   are looked up in the frame of the first: update them with one view. Direct shading knows no mask: it draws the item's
   own material and writes alpha 1. */
nacre_result nacre_gles_use_lit(nacre_gles *gles, nacre_gles_item item, nacre_gles_lit first, nacre_gles_lit second);

/* For applications with a draw loop of their own: make the program current, bind the textures, set every uniform;
   *program (may be NULL) receives the GL name. Attributes are at NACRE_GLES_*. NACRE_ERR_UNSUPPORTED when this view
   needs more than one pass, see draw: every device holds four lights of a table in one, two of spheres (one, where the
   cosine is in the image). unbind puts back what bind changed (nothing with host_resets_state); a second bind
   unbinds first. Between bind and unbind no other item may be drawn or prepared: that may drop the program. */
nacre_result nacre_gles_bind(nacre_gles *gles, nacre_gles_item item, const nacre_view *view, uint32_t *program);
nacre_result nacre_gles_unbind(nacre_gles *gles);

/* What the last draw or bind left changed under host_resets_state. A draw in passes asks for and puts back the states
   of framebuffer, viewport, depth, blend, scissor, dither and masks all the same: its last pass is drawn with them. */
typedef struct nacre_gles_state {
    uint8_t program;        /* 1: glUseProgram */
    uint8_t buffers;        /* 1: array buffer binding; without vertex_array the element array binding too */
    uint8_t attributes;     /* bit i: array i is enabled and points elsewhere (not with vertex_array) */
    uint8_t vertex_array;   /* 1: the vertex array binding is 0; our own was used between */
    uint8_t texture_units;  /* units 0..n-1 have other 2D textures */
    uint8_t samplers;       /* 1: and no sampler object bound */
    uint8_t active_texture; /* 1: glActiveTexture is another unit */
} nacre_gles_state;
void nacre_gles_changed(const nacre_gles *gles, nacre_gles_state *out);

/* Context lost: forget every GL name without calling GL. Items stay valid but not resident, and may be removed. */
void nacre_gles_abandon(nacre_gles *gles);
/* A new context is current: load entry points and upload all again. Items with the caller's buffers need
   nacre_gles_set_buffers before they are drawn. On failure all is as after abandon: try again. NACRE_ERR_LOST: lost,
   but not abandoned, or lost again; UNSUPPORTED, BUDGET: the new context can't hold the items. */
nacre_result nacre_gles_restore(nacre_gles *gles);

uint32_t nacre_gles_texture_bytes(const nacre_gles *gles);
/* Delete every GL object nacre made (none after abandon). The block is the caller's again. */
void nacre_gles_shutdown(nacre_gles *gles);

#ifdef __cplusplus
}
#endif
#endif
