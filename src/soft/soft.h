/* SPDX-License-Identifier: MIT */
/*
 * soft - the rasteriser. prepare.c: a frame's items; transform.c: vertices; clip.c: triangles that leave the frustum;
 * bins.c: triangles into bands; setup.c: one triangle's edges and planes; raster.c: its pixels' depth and normals;
 * span.c: normals into pixels; store.c: pixel formats; band.c: one band. mapped.c: triangles with textures or blended;
 * sbrdf.c: pixels of materials that vary over the surface, which are shaded as they are rasterised.
 *
 * Screen positions are 28.4 from the upper left corner, y down; a pixel's sample is at its centre. A pixel belongs to a
 * triangle when its centre is inside, on a left edge or on a top edge.
 */
#ifndef SOFT_H
#define SOFT_H

#include "eval.h"
#include "eval_persp.h"
#include "eval_sbrdf.h"
#include "eval_spheres_persp.h"
#include "nacre_soft.h"

/* Depth of what nothing covers. A blended item is drawn over depths that are there already: where it is not, the normal says
   so; no other looks so. */
#define SOFT_FAR   65535u
#define SOFT_EMPTY 0x80808080u

#define SOFT_MOST_DEPTH ((int32_t)65533 << 15)

typedef struct soft_vertex {
    int32_t x, y;      /* screen */
    int32_t z;         /* depth, q15, 0..SOFT_MOST_DEPTH; SOFT_OUTSIDE: to be clipped, x and y say nothing */
    int16_t normal[3]; /* q14: turned unit normal; by a lit sphere half of normal + eye */
    uint16_t nearness; /* 1/w over the item's largest, q16 */
} soft_vertex;

#define SOFT_OUTSIDE INT32_MIN

enum { SOFT_PLANES = 4 }; /* depth, normal x, y, z */

typedef struct soft_plane { /* a value at a pixel, and its steps; wraps */
    uint32_t at, dx, dy;
} soft_plane;

typedef struct soft_edge { /* first pixel at or right of the edge, row by row */
    int32_t x, step;
    int32_t rest, rest_step, whole; /* of the division, whole: its divisor */
} soft_edge;

typedef struct soft_triangle {
    int32_t y0, y1, y2; /* rows y0..y2-1, from y1 on the lower part */
    int32_t x0, row0;   /* where the planes' `at` is */
    soft_edge edge[3];  /* long, upper, lower */
    uint8_t long_left;
    soft_plane plane[SOFT_PLANES]; /* depth: q15; normals q30 */
} soft_triangle;

/* Pixels of one band, one array a value. */
typedef struct soft_pixels {
    uint16_t *depth;
    uint32_t *xy; /* of the normal */
    int16_t *z;
    uint8_t *item;          /* NULL: there is only one */
    int32_t stride;         /* pixels a row */
    int32_t row0;           /* of the first pixel */
    int32_t y0, y1, x0, x1; /* rows and columns that are drawn */
} soft_pixels;

typedef struct soft_camera { /* of one item, see transform.c */
    int32_t row[4][4];       /* clip = (row . (position, 32768)) >> 15: one common scale, below 2^30 */
    int32_t screen[3][3];    /* affine: x and y = (screen . position + screen_at) >> 28, z: >> 15 */
    int64_t screen_at[3];
    int32_t normal[3][3];  /* q15: a vertex's normal into the turned frame, not longer */
    int32_t tangent[3][3]; /* the same for tangents */
    uint8_t mirrored;
    int64_t depth_low;   /* z / w, q30, that is depth 0 */
    int64_t depth_scale; /* q24 */
    int32_t nearest;     /* least w, in the scale of row */
    int64_t depth_step;  /* of z / w, q46, for a step of 16-bit depth */
    uint8_t inside;      /* nothing needs clipping */
    uint8_t affine;      /* and w is the same everywhere */
    uint8_t half;        /* normals become half of normal + eye */
} soft_camera;

typedef struct soft_detail { /* of a corner of a mapped triangle */
    int16_t tangent[3];      /* q14, turned */
    int16_t handed;          /* +-1 */
    int16_t uv[2];           /* q11 */
} soft_detail;

#define SOFT_CLAMP   1u
#define SOFT_NEAREST 2u

typedef struct soft_texture {
    const uint8_t *texels; /* NULL: none */
    uint16_t width, height;
    uint8_t channels; /* bytes a texel */
    uint8_t flags;
} soft_texture;

/* Where pixels are in view space: (z ax + bx, z ay + by, z) with ax, ... linear in the pixel's place and z a quotient of
   depth: (c - d s) / (s e - f) for s = z / w. */
typedef struct soft_lens {
    int64_t a[2], a_step[2], b[2], b_step[2]; /* q30 at pixel 0, a pixel */
    int32_t c, d, e, f;                       /* q16 */
    int32_t eye[3];                           /* q14: of a distant viewer */
    uint8_t near;                             /* 1: directions to the eye differ */
} soft_lens;

typedef struct soft_item {
    const nacre_mesh *mesh;
    const nacre_soft_lit *lit;
    soft_camera camera;
    uint32_t first_vertex, first_triangle, triangle_count; /* in the frame's numbering */
    uint8_t cull;
    uint8_t lights;    /* that add something */
    uint8_t one_code;  /* display codes at once */
    uint8_t codes_565; /* and RGB565 */
    uint8_t output;    /* nacre_output */
    fx_real ambient[3];
    shade_table_eval *table; /* of every light; NULL */
    shade_spheres_eval *spheres;
    shade_table_persp *near; /* directions per pixel: the table or the spheres, and their lights */
    shade_spheres_persp *near_spheres;
    shade_persp_light *near_light;
    soft_lens lens;
    shade_sbrdf_eval *sbrdf; /* pixels are finished codes; and its lights */
    shade_sbrdf_eval_light *sbrdf_light;
    const nacre_image *albedo, *lobes;
    soft_texture normal_map, mask;
    uint8_t texture_flags; /* of albedo and lobes */
    uint8_t persp;         /* directions per pixel: the lens is set */
    uint8_t mapped;        /* drawn by mapped.c */
    uint8_t alpha_least;   /* mask alpha below it is not drawn */
    uint8_t blend;
} soft_item;

struct nacre_soft_kernels {
    void (*draw)(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item);
    void (*normalise)(uint32_t *xy, int16_t *z, int count);
    void (*table_add)(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count,
                      shade_rgb radiance);
    void (*table_code)(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count, uint32_t *rgba);
    void (*encode)(shade_rgb radiance, int count, nacre_output output, uint32_t *rgba);
    void (*lit)(const nacre_soft_lit *lit, const uint32_t *xy, const int16_t *z, int count, unsigned bytes, void *to);
    /* NULL: table_code and soft_store. RGB565 without dither at once; eval: of one layer, not dark */
    void (*table_565)(const shade_table_eval *eval, const uint32_t *xy, const int16_t *z, int count, uint16_t *to);
};

struct nacre_soft {
    nacre_soft_desc desc;
    uint32_t clear;
    int32_t scissor[4];           /* x0 y0 x1 y1 */
    uint32_t bands, band_inverse; /* band_inverse: above 2^24 / band_rows */
    uint32_t vertex_count, triangle_count;
    uint32_t reference_count; /* 0 with triangles there: they did not fit, every band looks at all */
    uint32_t reference_room;
    uint16_t item_count;
    uint8_t sorted;
    soft_vertex *vertex;
    void *reference;      /* triangle numbers, band after band; uint16_t up to 65,536 triangles, else uint32_t */
    uint32_t *band_begin; /* bands + 2 */
    soft_item *item;
    uint8_t *light_room; /* evaluators and columns */
    shade_frame *frame;  /* while preparing */
};

static inline uint32_t soft_band_of(const nacre_soft *soft, int32_t row)
{
    return (uint32_t)row * soft->band_inverse >> 24;
}

/* context.c */
size_t soft_light_bytes(const nacre_soft_desc *desc); /* of one light of an item */

/* transform.c */
/* *low, *high: widened by the depths (z / w, q30) of the item. turn: of shade_frame. */
void soft_camera_set(soft_camera *out, const nacre_soft_item *item, const nacre_view *view, int32_t turn[3][3],
                     int64_t *low, int64_t *high);
void soft_camera_depth(const nacre_soft *soft, soft_camera *out, int64_t low, int64_t high);
void soft_transform(const nacre_soft *soft, const soft_camera *camera, const nacre_mesh *mesh, soft_vertex *out);
void soft_to_half(int16_t n[3]);
void soft_clip_position(const soft_camera *camera, const int16_t position[3], int32_t clip[4]);
void soft_project(const nacre_soft *soft, const soft_camera *camera, const int32_t clip[4], soft_vertex *out);

/* clip.c: the part of a triangle inside the frustum (and 4 frames around it); returns the corners of a convex polygon. */
enum { SOFT_MOST_CORNERS = 9 };
int soft_clip(const nacre_soft *soft, const soft_item *item, const uint32_t index[3],
              soft_vertex out[SOFT_MOST_CORNERS], soft_detail detail[SOFT_MOST_CORNERS]);

/* setup.c */
/* Rows *y0..*y1-1 of the frame that a triangle touches. 0: none, or culled (nacre_soft_cull). */
int soft_triangle_rows(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c, int cull, int32_t height,
                       int32_t *y0, int32_t *y1);
/* 0: nothing in the rows of `to`, or culled. */
int soft_triangle_set(soft_triangle *out, const soft_vertex *const corner[3], int cull, const soft_pixels *to);

/* bins.c */
void soft_sort(nacre_soft *soft);
/* Calls `each` for every triangle of a band, in order. */
typedef void soft_each(void *user, const soft_item *item, unsigned item_index, const uint32_t index[3]);
void soft_each_triangle(const nacre_soft *soft, uint32_t band, soft_each *each, void *user);

/* raster.c */
void soft_draw(const soft_vertex *const corner[3], int cull, const soft_pixels *to, unsigned item);

/* mapped.c: triangles with textures or blended */
void soft_detail_of(const soft_item *item, uint32_t index, soft_detail *out);
void soft_draw_mapped(const soft_item *item, const soft_vertex *const corner[3], const soft_detail *const detail[3],
                      const soft_pixels *to, unsigned index);

/* sample.c: codes x 65536 at u v (q27 a repetition; rows from the top) of some layers, one behind the other in memory.
   share: 0, or how much of 256 they are of what *out holds already */
void soft_sample(const soft_texture *t, unsigned layers, int32_t u_q27, int32_t v_q27, int32_t share,
                 int32_t (*out)[4]);

/* sbrdf.c */
/* Texel of a material that varies. rate: the most that u or v changes a pixel. */
void soft_sbrdf_sample(const soft_item *item, int32_t u_q27, int32_t v_q27, uint32_t rate_q27, shade_sbrdf_codes out);
/* The code of a pixel whose depth and normal are there, in place of the normal; alpha (q16) above it. mirrored: the bitangent
   is tangent x normal. */
void soft_sbrdf_put(const soft_item *item, const int16_t tangent[3], int mirrored, shade_sbrdf_codes codes,
                    int32_t alpha, const soft_pixels *to, int32_t x, int32_t y);

/* lens.c */
/* 0: a camera whose axes are skewed. */
int soft_lens_set(soft_lens *out, const nacre_soft *soft, const nacre_view *view, const shade_frame *frame);
/* Pixels x .. x + count - 1 of row y: positions, and directions to the eye. */
void soft_lens_look(const soft_item *item, int32_t x, int32_t y, const uint16_t *depth, int count,
                    int32_t *const position[3], uint32_t *eye_xy, int16_t *eye_z);

/* span.c */
void soft_lit(const nacre_soft_lit *lit, const uint32_t *xy, const int16_t *z, int count, unsigned bytes, void *to);
/* Columns x0..x1-1 of a row, all of them covered by one item or empty. */
void soft_shade_row(const nacre_soft *soft, const soft_pixels *from, int32_t row, void *to);
/* The same for one item over what is there, its alpha in from->item. */
void soft_blend_row(const nacre_soft *soft, const soft_item *item, const soft_pixels *from, int32_t row, void *to);

/* store.c */
unsigned soft_pixel_bytes(unsigned format);
void soft_load(const nacre_soft_desc *desc, const void *from, int count, uint32_t *rgba);
uint16_t soft_565(uint32_t rgba);            /* nearest, native */
void soft_swap(uint16_t *pixels, int count); /* the other byte order */
void soft_store(const nacre_soft_desc *desc, int32_t x, int32_t y, const uint32_t *rgba, int count, void *to);

#endif
