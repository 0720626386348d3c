/* SPDX-License-Identifier: MIT */
/*
 * nacre.h - measured materials on small GPUs and CPUs
 *
 *   nacre_image table;
 *   if (nacre_image_open(&table, file_bytes, file_size)) return;
 *   nacre_material gold = { .model = NACRE_MODEL_TABLE, .image[NACRE_ROLE_TABLE] = &table };
 *
 * A backend (nacre_gles.h) draws such a material on a mesh under lights.
 *
 * Conventions that hold for every declaration in the public headers:
 *
 *   memory    nacre never allocates. The caller gives each object one block, sized by its *_size()
 *             function. "Borrowed" pointers must stay valid and unchanged until the object that
 *             took them is shut down; asset bytes may live in flash or in a read-only mapping.
 *   desc      Zero-initialise, set what you need; 0 means the default given in (brackets).
 *   results   0 is success, errors are negative. On failure out-parameters are left untouched.
 *   numbers   q16: signed Q15.16 in int32_t, 1.0 == 65536.   q14: signed Q1.14 in int16_t, 1.0 == 16384.
 *             bam: uint16_t binary angle, 65536 == one turn.  Radiance and irradiance are q16.
 *             The nacre_*_from_float helpers at the end convert for applications that think in float.
 *   spaces    Right-handed. View space has the eye at the origin looking along -z. Directions are
 *             unit length and point away from the surface (towards the light, towards the eye).
 *   radiance  Linear and scene-referred; encoding happens only when a pixel is stored.
 *   angles    "polar" is measured from an axis (0 = along it), "azimuth" around it.
 *   threads   No global state. One object, one thread at a time.
 *
 * nacre does not create contexts or windows, load files, own threads or animate.
 */
#ifndef NACRE_H
#define NACRE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define NACRE_VERSION_MAJOR 0
#define NACRE_VERSION_MINOR 1
#define NACRE_VERSION_PATCH 0

/* Version of the linked library: major << 16 | minor << 8 | patch. Compare with NACRE_VERSION. */
uint32_t nacre_version(void);
#define NACRE_VERSION (NACRE_VERSION_MAJOR << 16 | NACRE_VERSION_MINOR << 8 | NACRE_VERSION_PATCH)

typedef enum nacre_result {
    NACRE_OK = 0,
    NACRE_ERR_ARGUMENT = -1,    /* a documented precondition does not hold */
    NACRE_ERR_MEMORY = -2,      /* the block given is smaller than *_size() said */
    NACRE_ERR_ASSET = -3,       /* truncated or inconsistent asset bytes */
    NACRE_ERR_UNSUPPORTED = -4, /* valid, but not on this backend or device */
    NACRE_ERR_BUDGET = -5,      /* would exceed a budget of the desc; nothing was created */
    NACRE_ERR_GL = -6,          /* compile, link or upload failed; the log has the text */
    NACRE_ERR_LOST = -7         /* the GL context is gone: abandon, then restore */
} nacre_result;

/* Static text for a result, never NULL. */
const char *nacre_result_text(nacre_result result);

typedef int32_t nacre_q16;
typedef int16_t nacre_q14;
typedef uint16_t nacre_bam;

#define NACRE_Q16_ONE 65536
#define NACRE_Q14_ONE 16384

typedef struct nacre_dir {
    nacre_q14 x, y, z;
} nacre_dir;
typedef struct nacre_rgb {
    nacre_q16 r, g, b;
} nacre_rgb;
typedef struct nacre_mat4 {
    nacre_q16 m[16];
} nacre_mat4; /* column-major, like GL */

/* ---- assets: read-only views of one KTX2 file (profile: nacre_asset.h) ------------------- */

#define NACRE_MAX_LEVELS 12

typedef struct nacre_image {
    const uint8_t *bytes;                    /* borrowed */
    uint32_t size;                           /* bytes */
    uint32_t level_offset[NACRE_MAX_LEVELS]; /* of layer 0, face 0, from bytes */
    uint32_t kv_offset, kv_size;             /* key/value data, from bytes */
    uint16_t width, height;                  /* texels of level 0, 1..4096 */
    uint16_t layers;                         /* 1..64 */
    uint8_t faces;                           /* 1, or 6 for a cube map */
    uint8_t levels;                          /* 1..NACRE_MAX_LEVELS */
    uint8_t format;                          /* NACRE_FORMAT_* (nacre_asset.h) */
} nacre_image;

/* Check every offset and length in the file and fill *out. Nothing is copied or decoded; bytes are
   borrowed for as long as *out is used, at any alignment.
   NACRE_ERR_ARGUMENT: a NULL pointer. NACRE_ERR_ASSET: not KTX2, truncated, or sizes disagree.
   NACRE_ERR_UNSUPPORTED: KTX2, but outside the profile of nacre_asset.h. */
nacre_result nacre_image_open(nacre_image *out, const void *bytes, size_t size);

/* Texels of one level, layer and face, tight rows; *size (may be NULL) receives their bytes.
   NULL if the image has no such part. */
const uint8_t *nacre_image_texels(const nacre_image *image, unsigned level, unsigned layer, unsigned face,
                                  uint32_t *size);

/* Value of a key (nacre_asset.h lists them); *size receives its bytes. NULL if the file has no such key. */
const uint8_t *nacre_image_key(const nacre_image *image, const char *key, uint32_t *size);

/* ---- what to draw: shared by every backend ---------------------------------------------- */

typedef enum nacre_model {
    NACRE_MODEL_NONE = 0,
    NACRE_MODEL_TABLE,   /* half-vector table: one image, one fetch per light (fine tier: two) */
    NACRE_MODEL_SPHERES, /* sphere images per light polar angle (Mihalik & Durikovic 2015) */
    NACRE_MODEL_SBRDF,   /* albedo and lobes: 1 to 3 Lafortune lobes per texel (McAllister et al. 2002) */
    NACRE_MODEL_PALETTE  /* index and palette: every texel one of up to 256 half-vector tables (GLES alone) */
} nacre_model;

/* What an image is for. A material names its images by role; a model uses those it knows. */
typedef enum nacre_role {
    NACRE_ROLE_TABLE,   /* TABLE: one RGBA8 layer; fine tier: two */
    NACRE_ROLE_SPHERES, /* SPHERES: one layer per light polar angle */
    NACRE_ROLE_NORMAL,  /* tangent-space normals, RGB8 or RGBA8: xyz = 2 code/255 - 1, +y up; any model */
    NACRE_ROLE_MASK,    /* any format with uv: R how much of the second lit sphere, alpha what is written to alpha */
    NACRE_ROLE_ALBEDO,  /* SBRDF: diffuse albedo, opacity */
    NACRE_ROLE_LOBES,   /* SBRDF: two layers per lobe: lobe albedo; Cx Cy Cz n */
    NACRE_ROLE_POWER,   /* SBRDF, may be missing: table of x^n, for GPUs that look it up faster than they compute it */
    NACRE_ROLE_PALETTE, /* PALETTE: the tables, side by side in one image */
    NACRE_ROLE_INDEX,   /* PALETTE: R8, which table a texel is of */
    NACRE_ROLE_COUNT
} nacre_role;

typedef struct nacre_material {
    nacre_model model;
    const nacre_image *image[NACRE_ROLE_COUNT]; /* borrowed; NULL where unused */
} nacre_material;

typedef struct nacre_vertex { /* 24 bytes, every attribute on a 4-byte boundary */
    int16_t position[4];      /* 32767 == the mesh's half extent; [3] is unused */
    int16_t normal[4];        /* unit vector, 32767 == 1.0; [3] is unused */
    int8_t tangent[4];        /* unit vector, 127 == 1.0; [3] is the handedness, +-127 */
    int16_t uv[2];            /* q11, so that textures can tile: -16..16 */
} nacre_vertex;

/* object position = centre + half_extent * position / 32767, per axis. */
typedef struct nacre_mesh {
    const nacre_vertex *vertices; /* borrowed */
    const uint16_t *indices;      /* borrowed; triangles, counter-clockwise front */
    uint32_t index_count;         /* a multiple of 3 */
    uint16_t vertex_count;        /* 1..65535 */
    nacre_q16 centre[3], half_extent[3];
} nacre_mesh;

typedef enum nacre_light_type { NACRE_LIGHT_DIRECTIONAL = 0, NACRE_LIGHT_POINT = 1 } nacre_light_type;

typedef struct nacre_light {
    uint8_t type;          /* nacre_light_type (directional) */
    nacre_q14 shadow;      /* (0) part of the light that is blocked: 0 = fully lit .. 16384 = none arrives */
    nacre_dir direction;   /* directional: view space, towards the light; any length but 0, nacre normalises */
    nacre_q16 position[3]; /* point: view space */
    nacre_rgb power;       /* directional: irradiance on a surface that faces the light; point: radiant
                              intensity (irradiance at distance 1). Negative counts as 0 */
} nacre_light;

/* How a pixel stores radiance x exposure. */
typedef enum nacre_output {
    NACRE_OUTPUT_SRGB = 0, /* the sRGB curve, clamped to 0..1, for ordinary 8-bit framebuffers */
    NACRE_OUTPUT_SQRT,     /* square root: cheapest, but only 35 dB from sRGB */
    NACRE_OUTPUT_LINEAR    /* no curve, for sRGB-encoding or HDR framebuffers */
} nacre_output;

#define NACRE_MAX_LIGHTS     8    /* that every backend shades directly */
#define NACRE_MAX_LIT_LIGHTS 1024 /* directional ones, through a lit sphere */

typedef struct nacre_view {
    nacre_mat4 object_to_view; /* rigid motion x scale (may be non-uniform, not 0) */
    nacre_mat4 view_to_clip;   /* as for GL; orthographic when row 3 is 0 0 0 1: the viewer is distant then */
    const nacre_light *lights; /* borrowed for the call */
    uint16_t light_count;   /* 0..NACRE_MAX_LIT_LIGHTS: through a lit sphere, or directly by GLES, in passes where one
                                   program can't hold them; 0..NACRE_MAX_LIGHTS directly on the CPU. 0: ambient alone */
    uint8_t output;         /* nacre_output (sRGB) */
    uint8_t distant_viewer; /* (0) 1: one view direction per draw, towards the mesh's centre, also under a
                                   perspective camera: cheaper; good for small or far objects. Point lights
                                   always use per-pixel directions */
    nacre_q16 exposure;     /* (65536) multiplies radiance before encoding */
    nacre_rgb ambient;      /* (0) irradiance from everywhere; adds albedo x ambient / pi, where albedo is
                                   the hemispherical albedo stored in the asset */
    nacre_rgb tint;         /* (1,1,1 when all are 0) multiplies reflected radiance; negative counts as 0 */
} nacre_view;

typedef void (*nacre_log_fn)(void *user, nacre_result code, const char *message);

/* ---- conversions for applications that think in float (host side; the runtime has none) ------- */

/* Nearest, saturating; NaN gives 0. */
static inline int32_t nacre_round_from_float(float x, float scale, int32_t lo, int32_t hi)
{
    float y = x * scale;
    if (!(y > (float)lo)) return y == y ? lo : 0;
    if (y >= (float)hi) return hi;
    return (int32_t)(y < 0 ? y - 0.5f : y + 0.5f);
}

static inline nacre_q16 nacre_q16_from_float(float x)
{
    return nacre_round_from_float(x, 65536.0f, INT32_MIN, INT32_MAX);
}

static inline nacre_q14 nacre_q14_from_float(float x)
{
    return (nacre_q14)nacre_round_from_float(x, 16384.0f, INT16_MIN, INT16_MAX);
}

/* Components of a unit vector, -1..1. */
static inline nacre_dir nacre_dir_from_float(float x, float y, float z)
{
    nacre_dir d;
    d.x = nacre_q14_from_float(x);
    d.y = nacre_q14_from_float(y);
    d.z = nacre_q14_from_float(z);
    return d;
}

static inline nacre_rgb nacre_rgb_from_float(float r, float g, float b)
{
    nacre_rgb c;
    c.r = nacre_q16_from_float(r);
    c.g = nacre_q16_from_float(g);
    c.b = nacre_q16_from_float(b);
    return c;
}

/* column_major: 16 floats, as for glUniformMatrix4fv. */
static inline nacre_mat4 nacre_mat4_from_float(const float *column_major)
{
    nacre_mat4 m;
    int i;
    for (i = 0; i < 16; i++) m.m[i] = nacre_q16_from_float(column_major[i]);
    return m;
}

#ifdef __cplusplus
}
#endif
#endif
