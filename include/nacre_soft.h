/* SPDX-License-Identifier: MIT */
/*
 * nacre_soft.h - the materials of nacre.h on a CPU: integers only, no heap, band by band
 *
 *   nacre_soft_desc desc = {.width = 320, .height = 240, .max_vertices = 600, .max_triangles = 1000};
 *   nacre_soft *soft;
 *   nacre_soft_init(&soft, block, sizeof block, &desc);              block: nacre_soft_size(&desc) bytes
 *   nacre_soft_prepare(soft, &item, 1, &view);                       once a frame
 *   nacre_soft_frame(soft, scratch, sizeof scratch, pixels, stride); or nacre_soft_bands, nacre_soft_band
 *
 * A frame is prepared once: vertices are transformed, triangles clipped, culled and sorted into bands of rows, lights
 * turned into look-up values. Then bands are drawn, in any order, each with scratch memory of its own: by one thread with
 * one scratch, or by several. A band is complete when its call returns, so a panel can receive one while the next is drawn.
 *
 * Pictures are the same to the bit on every machine and with every set of kernels.
 *
 * Not done: no anti-aliasing, no mip levels but those of SBRDF materials, no file or panel access, no threads of its own.
 */
/*
 * A build for little flash can leave parts out; what needs them answers NACRE_ERR_UNSUPPORTED. Define for all files of the
 * runtime, and link with -ffunction-sections -Wl,--gc-sections:
 *   NACRE_NO_TABLES   materials by table
 *   NACRE_NO_FINE     tables of two layers
 *   NACRE_NO_SPHERES  materials by spheres
 *   NACRE_NO_SBRDF    materials that vary over the surface
 *   NACRE_NO_MAPS     normal maps, masks and blending; implies NACRE_NO_SBRDF
 *   NACRE_NO_NEAR     directions per pixel: point lights, near viewers, paper-mode spheres
 *   NACRE_NO_GLES     what nacre_gles.h needs of the set-up; don't link both
 * Cortex-M4, gcc -Os, code and constant tables without libc and libgcc: everything but GLES 45 KB; tables of one layer and
 * lit spheres made of them 23 KB; lit spheres from flash alone (no tables, no spheres, no maps) 12 KB. Stack: 1.4, 1.2 and
 * 1.1 KB.
 */
#ifndef NACRE_SOFT_H
#define NACRE_SOFT_H

#include "nacre.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nacre_soft nacre_soft;

typedef enum nacre_soft_format {
    NACRE_SOFT_RGB565 = 0,     /* 2 bytes, R in bits 15..11 of a native uint16_t */
    NACRE_SOFT_RGB565_SWAPPED, /* 2 bytes, the other byte order: what most SPI panels take from a little-endian CPU */
    NACRE_SOFT_GRAY8,          /* 1 byte: 0.2126 R + 0.7152 G + 0.0722 B of the codes */
    NACRE_SOFT_RGBA8           /* 4 bytes R G B A in memory; alpha 255 where covered (SBRDF: the opacity) */
} nacre_soft_format;

/* Inner loops for one instruction set. All give the same pictures. */
typedef struct nacre_soft_kernels nacre_soft_kernels;
extern const nacre_soft_kernels nacre_soft_portable;
#if defined(__x86_64__) || defined(__i386__)
extern const nacre_soft_kernels nacre_soft_avx2;  /* for CPUs that have AVX2 ... */
extern const nacre_soft_kernels nacre_soft_sse41; /* ... or SSE4.1; the caller asks the CPU */
#elif defined(__ARM_FEATURE_DSP) && defined(__thumb2__)
extern const nacre_soft_kernels nacre_soft_dsp; /* Cortex-M4, M7, M33, ...; little-endian */
#endif
#if defined(__ARM_NEON)
extern const nacre_soft_kernels nacre_soft_neon; /* every AArch64; ARMv7 built with NEON. Little-endian */
#endif

typedef struct nacre_soft_desc {
    uint16_t width, height; /* pixels, 1..4096 */
    uint8_t format;         /* nacre_soft_format (RGB565) */
    uint8_t dither;         /* (0) 1: RGB565 through a 4 x 4 ordered pattern, fixed to the pixels */
    uint16_t band_rows;     /* (8) rows of a band, 1..4096: more rows, more scratch, less work twice */
    uint32_t max_vertices;  /* of all items of a frame, without those that clipping makes; 1..2^24 */
    uint32_t max_triangles; /* of all items, before culling; 1..2^24 */
    uint16_t max_items;     /* (1) 1..255 */
    uint8_t max_lights;     /* (1) of an item that is shaded directly, 1..8; items by a lit sphere need none */
    uint8_t table_columns;  /* (32) of the widest table, 2..64 */
    uint8_t fine;           /* (0) 1: tables of the fine tier too */
    uint8_t blend;          /* (0) 1: items may be blended */
    const nacre_soft_kernels *kernels; /* (portable) */
} nacre_soft_desc;

/* A sphere of finished display codes in one material under one set of lights, indexed by the bisector h of normal and
   eye: texel (x, y) = (1/2 + 5/8 h.x, 1/2 - 5/8 h.y) x size, nearest. Any number of lights costs one fetch a pixel. */
typedef struct nacre_soft_lit {
    const void *texels; /* borrowed; size x size, tight rows from the top, in the frame's format */
    uint16_t size;      /* 8..512 */
} nacre_soft_lit;

/* What a lit sphere shows. Materials: TABLE or SPHERES, texels RGB8 or RGBA8; SBRDF and PALETTE vary over the surface, there
   is no sphere of them. Normal map and mask are ignored. */
typedef struct nacre_soft_lit_desc {
    const nacre_material *material;
    const nacre_view *view; /* lights (all directional, up to NACRE_MAX_LIT_LIGHTS: `nacre bake lights` makes them of an
                               environment), exposure, ambient, tint, output; camera and object_to_view for the
                               direction to the eye */
    nacre_q16 centre[3];    /* of the mesh, object space: what the eye's direction is taken from */
    uint16_t size;          /* texels a side, 8..512: 64 for matt, 128 to 256 for glossy materials */
    uint8_t format;         /* nacre_soft_format (RGB565): the frame's */
    const nacre_soft_kernels *kernels; /* (portable) */
} nacre_soft_lit_desc;

/* Bytes of scratch, 4-byte aligned, for so many rows at once: 2,116 + 16 (fine: 32) a column of the table (paper mode: about
   150 in all) + 30 x size a row. One row is enough; more are faster with many lights, whose set-up is repeated for each
   portion. 0: desc is not valid. */
size_t nacre_soft_lit_scratch_size(const nacre_soft_lit_desc *desc, unsigned rows);

/* Shade rows y0..y1-1 of the picture whose first texel is at texels (size x size, tight). All lights are summed in linear
   radiance, 16 bits or more a channel, and encoded once. To spread an update over frames, shade some rows a frame into a
   second picture under one and the same view, and swap them: the bits do not depend on the portions.
   NACRE_ERR_ARGUMENT: desc, rows or a pointer not valid. NACRE_ERR_MEMORY: scratch for less than a row.
   NACRE_ERR_ASSET / UNSUPPORTED: a material that this backend can't draw, or a point light. */
nacre_result nacre_soft_lit_rows(const nacre_soft_lit_desc *desc, void *texels, unsigned y0, unsigned y1, void *scratch,
                                 size_t scratch_size);

typedef enum nacre_soft_cull { NACRE_SOFT_CULL_BACK = 0, NACRE_SOFT_CULL_NONE, NACRE_SOFT_CULL_FRONT } nacre_soft_cull;

/* Materials: TABLE; SPHERES, texels RGB8 or RGBA8 (of more than 16 images with directions per pixel, 16 are used); SBRDF: x^n is
   computed (an image of role POWER is not looked at), levels are blended as in GL, the texel's opacity is the alpha where
   there is no mask. */
typedef struct nacre_soft_item {
    const nacre_mesh *mesh;         /* borrowed until the last band of the frame is drawn */
    const nacre_material *material; /* the same */
    const nacre_soft_lit *lit;      /* (NULL) drawn by this instead of material, which may then be NULL */
    nacre_mat4 object_to_view;      /* this item's; the view's is not used */
    uint8_t cull;                   /* nacre_soft_cull (back faces) */
    uint8_t alpha_test;             /* (0) pixels of a lower alpha are not drawn: 1..255 */
    uint8_t blend;                  /* (0) 1: blended by their alpha over what is there, after all others, as one
                                        surface; several in their order, the farthest first. desc.blend must be 1 */
    uint8_t clamp, nearest;         /* (0: repeated, bilinear) how maps are read */
} nacre_soft_item;

/* Bytes of the object, 0 if desc is not valid; on a 32-bit CPU, each part rounded up to 16:
     128 + 20 max_vertices + the larger of 4 max_triangles (above 65,536: 8) and 2,116 + 4 (bands + 2)
     + max_items (464 + max_lights (52 + 16 table_columns (fine: 32); 176 or more))
   and of the scratch for each band that is drawn at the same time:
     128 + band_rows x width x 8 (several items, or blend: 9).
   320 x 240 RGB565 with 530 vertices, 992 triangles, two band buffers and a lit sphere of 64: 54 KB; 160 x 128 in bands of
   4 rows with 250 vertices and 440 triangles: 24 KB. */
size_t nacre_soft_size(const nacre_soft_desc *desc);
size_t nacre_soft_scratch_size(const nacre_soft_desc *desc);

/* block: aligned for any type, borrowed. NACRE_ERR_ARGUMENT: desc is not valid. NACRE_ERR_MEMORY: size is too small. */
nacre_result nacre_soft_init(nacre_soft **out, void *block, size_t size, const nacre_soft_desc *desc);

/* Colour of pixels that nothing covers: R | G << 8 | B << 16 | A << 24 (0). */
void nacre_soft_clear_color(nacre_soft *soft, uint32_t rgba);

/* Draw nothing outside of x0 <= x < x1, y0 <= y < y1; there pixels are not touched. Bands outside cost nothing. Holds until
   set again; the whole frame at first. */
void nacre_soft_scissor(nacre_soft *soft, int x0, int y0, int x1, int y1);

/* Transform, clip, cull and sort one frame. view: camera, lights and light scale for all items; may go when this returns.
   NACRE_ERR_ARGUMENT: a mesh, matrix or light is not valid. NACRE_ERR_BUDGET: more than desc says. NACRE_ERR_ASSET: a
   material's file. NACRE_ERR_UNSUPPORTED: a material or format that this backend can't draw. Nothing is drawn by bands
   after a failure but the clear colour. */
nacre_result nacre_soft_prepare(nacre_soft *soft, const nacre_soft_item *items, int count, const nacre_view *view);

/* Draw rows y0..y1-1, at most band_rows of them, into pixels: the address of row y0, stride bytes a row. Only reads *soft:
   bands may run on several threads with a scratch each.
   NACRE_ERR_ARGUMENT: rows outside the frame or too many, a NULL pointer, pixels or stride not a multiple of the pixel.
   NACRE_ERR_MEMORY: size is smaller than nacre_soft_scratch_size. */
nacre_result nacre_soft_band(const nacre_soft *soft, int y0, int y1, void *scratch, size_t size, void *pixels,
                             size_t stride);

/* The whole frame, band after band. */
nacre_result nacre_soft_frame(const nacre_soft *soft, void *scratch, size_t size, void *pixels, size_t stride);

/* A finished band: overlay it, send it off. pixels: one of the buffers given, free for reuse when the next but one band
   begins (two buffers) or the next (one). Return 0 to go on. */
typedef int nacre_soft_ready(void *user, int y0, int y1, void *pixels, size_t stride);

/* The whole frame through one or two band buffers (second may be NULL) of band_rows x stride bytes: while `ready` has one
   sent by DMA, the other is drawn. Bands outside the scissor are left out. Returns what `ready` returned if not 0, else a
   nacre_result. */
int nacre_soft_bands(const nacre_soft *soft, void *scratch, size_t size, void *first, void *second, size_t stride,
                     nacre_soft_ready *ready, void *user);

#ifdef __cplusplus
}
#endif
#endif
