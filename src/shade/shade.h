/* SPDX-License-Identifier: MIT */
/*
 * shade - the models' set-up values: what is constant over a draw or over one light, in integers
 *
 * Two camera cases. "dist": one view direction for the whole draw; everything is turned by the rotation `turn` so that
 * it becomes +z. "persp": directions per pixel; positions stay in view space (x 2^position_shift).
 */
#ifndef SHADE_H
#define SHADE_H

#include "fx.h"
#include "nacre.h"
#include "nacre_asset.h"

/* Parts that a build may leave out, see nacre_soft.h. Conditions on them are constant; what only they lead to is dropped. */
#ifdef NACRE_NO_TABLES
enum { SHADE_HAS_TABLES = 0 };
#else
enum { SHADE_HAS_TABLES = 1 };
#endif
#ifdef NACRE_NO_FINE
enum { SHADE_HAS_FINE = 0 };
#else
enum { SHADE_HAS_FINE = 1 };
#endif
#ifdef NACRE_NO_SPHERES
enum { SHADE_HAS_SPHERES = 0 };
#else
enum { SHADE_HAS_SPHERES = 1 };
#endif
#if defined(NACRE_NO_SBRDF) || defined(NACRE_NO_MAPS)
enum { SHADE_HAS_SBRDF = 0 };
#else
enum { SHADE_HAS_SBRDF = 1 };
#endif
#ifdef NACRE_NO_MAPS
enum { SHADE_HAS_MAPS = 0 };
#else
enum { SHADE_HAS_MAPS = 1 };
#endif
#ifdef NACRE_NO_NEAR
enum { SHADE_HAS_NEAR = 0 };
#else
enum { SHADE_HAS_NEAR = 1 };
#endif
#ifdef NACRE_NO_GLES
enum { SHADE_HAS_GLES = 0 };
#else
enum { SHADE_HAS_GLES = 1 };
#endif

#define SHADE_MAX_UNITS 8 /* sphere layers that one program can sample: ES 2.0 has 8 texture units */

/* Decoded keys of a table file (nacre_asset.h, NACRE_KEY_TABLE). */
typedef struct shade_table {
    nacre_q16 e;    /* > 0 */
    nacre_q16 ymax; /* > 0 */
    nacre_q16 w[3]; /* one layer: all 0: no phi_d term */
    nacre_q16 p;    /* 4.8 or 4 */
    nacre_q16 eps;  /* > 0 */
    nacre_q16 k1;   /* two layers, early */
    nacre_q16 k2;   /* two layers */
    nacre_q16 rows; /* B of the row curve, -1..1 */
    nacre_q16 d[3]; /* two layers: 0..6.5 */
    nacre_q16 v[3]; /* two layers */
    nacre_q16 k4;   /* two layers */
    uint16_t width, height;
    uint16_t image_width, image_height; /* of a palette, texels: a table begins image_guard texels inside its tile */
    uint8_t image_guard;                /* plain tables: the same as width and height, and 0 */
    uint8_t toe;                        /* 1: draw the linear toe of sRGB */
} shade_table;

/* Decoded keys of palette and index files, and constants of a draw. The tables' common numbers are a shade_table. */
typedef struct shade_palette {
    uint16_t count;         /* 1..256 */
    uint8_t columns;        /* of tiles */
    uint16_t rows;          /* of tiles */
    uint8_t blend;          /* 1: between four texels of the index map */
    uint16_t width, height; /* of the index map */
} shade_palette;

/* Decoded keys of a spheres file. */
typedef struct shade_spheres {
    uint16_t polar_bam[NACRE_MAX_LAYERS]; /* rising, below 32768 */
    uint8_t layers;                       /* 1..64 */
    uint8_t cosine;                       /* 1: paper mode */
    nacre_q16 scale[3];
    nacre_q16 disc; /* 0.5..1 */
    uint16_t size;  /* quarters: texels a side, 2 or more; 0: whole spheres */
} shade_spheres;

#define SHADE_MAX_QUARTERS 16 /* images */

/* 1: quartered spheres: in GL all layers are one texture, one below the other, as they lie in the file. */
int shade_is_quartered(const nacre_image *image);

/* Decoded keys of albedo and lobes files. */
typedef struct shade_sbrdf {
    uint8_t lobes;         /* 1..3 */
    uint8_t direction;     /* 1: the direction of anisotropy is in alphas */
    uint16_t power_width;  /* columns of the power table, 0: none */
    uint8_t power_serves;  /* 1: there is one, and one lobe whose exponents it is made for: 3 and more */
    nacre_q16 albedo_most; /* > 0 */
    nacre_q16 most[NACRE_MAX_LOBES], shape_most[NACRE_MAX_LOBES];
} shade_sbrdf;

typedef struct shade_material {
    nacre_model model;
    uint8_t fine;        /* table: two layers */
    uint8_t early;       /* fine: nine numbers, see NACRE_KEY_TABLE */
    nacre_q16 albedo[3]; /* NACRE_KEY_ALBEDO; sbrdf: without the diffuse albedo, which is in the texels; palette: 1 */
    shade_palette palette;
    union {
        shade_table table; /* palette too */
        shade_spheres spheres;
        shade_sbrdf sbrdf;
    } is;
} shade_material;

/* Role of the image that holds a model's reflectance (SBRDF: the lobes); -1: no such model. */
int shade_model_role(nacre_model model);
/* 1: images of this role are looked at by their place on the surface. */
int shade_role_has_uv(int role);
/* 1: its set-up is that of a table. */
static inline int shade_is_table(const shade_material *material)
{
    if (!SHADE_HAS_TABLES) return 0;
    return (!SHADE_HAS_SPHERES && !SHADE_HAS_SBRDF) || material->model == NACRE_MODEL_TABLE ||
           material->model == NACRE_MODEL_PALETTE;
}

static inline int shade_is_quarter(const shade_material *material)
{
    return SHADE_HAS_SPHERES && material->model == NACRE_MODEL_SPHERES && material->is.spheres.size;
}

static inline int shade_is_sbrdf(const shade_material *material)
{
    return SHADE_HAS_SBRDF && material->model == NACRE_MODEL_SBRDF;
}

static inline int shade_is_fine(const shade_material *material)
{
    return SHADE_HAS_FINE && material->fine;
}

/* 1: materials of this model may have an image of this role. */
int shade_model_takes(nacre_model model, int role);

/* The files of a material, checked. NACRE_ERR_ARGUMENT: no image for the model. NACRE_ERR_ASSET: an image that does not
   hold what its role says. */
nacre_result shade_material_read(shade_material *out, const nacre_material *material);

/* Tables in SHADE_SRGB take the logarithm of n.l, not below 2^-14. So that the unlit side stays dark, n.l is multiplied by
   2^lift and factor holds the inverse. dist: no more than needed, for fp16 is exact near log2 = 0. */
#define SHADE_LIFT_MOST  13
#define SHADE_LIFT_PERSP 6

/* What the light factors of a frame multiply: follows from the program (gles_key_form); on CPUs always SHADE_LINEAR. */
typedef enum shade_form {
    SHADE_LINEAR, /* linear radiance */
    SHADE_ROOT,   /* its square root: one light, no sum */
    SHADE_SRGB    /* 1.055 x its 2.4th root: one light, sRGB at once (tables with p = 4.8; paper: without the 1.055) */
} shade_form;

/* One light on a table, dist. A program with this light alone works in the light's own frame: h is +z there, l = (sin, 0,
   cos) and v = (-sin, 0, cos) of half the angle between l and v. */
typedef struct shade_table_setup {
    int32_t to_light_q28[3];    /* l, turned */
    int32_t half_q28[3];        /* h, turned */
    int32_t own_turn_q28[3][3]; /* rows of the rotation from view space to the light's own frame */
    int32_t sin_q28, cos_q28;   /* of half the angle between l and v */
    int32_t row_q28;            /* texture coordinate v' of its l.h; palette: from the tile's origin, as u' is */
} shade_table_setup;

/* One light on spheres, dist. Rows are dotted with the normal; those that give texture coordinates are x disc / 2 (add
   1/2). */
typedef struct shade_spheres_setup {
    uint8_t layer[2];        /* the pair of layers around the light's polar angle; equal beyond the ends */
    int32_t weight_q28;      /* of layer[1] */
    int32_t x_q28[2][3];     /* cosine-free: x coordinate in either layer */
    int32_t y_q28[3];        /* y coordinate */
    int32_t rim_q28[3];      /* cosine-free: depth behind the rim of layer[1] x what is added to its x coordinate */
    int32_t to_light_q28[3]; /* l, turned */
    int32_t azimuth_q28[2];  /* paper: cos and sin of the light's azimuth */
    int32_t half_q28[2];     /* paper: x and z of the half vector in the plane of light and eye */
    int32_t turn_q28[3][4];  /* paper: (sin 1, sin 2, cos 1, cos 2) of k x difference = [0] + s ([1] + s [2]), s =
                                sin(alpha_h) of eq. 3 */
} shade_spheres_setup;

/* One light on quartered spheres, dist. The light's own frame: x along l - v, z is h; l = (sin, 0, cos) of half the angle
   between l and v. */
typedef struct shade_quarter_setup {
    int32_t x_q28[3], y_q28[3]; /* rows of its own frame, turned */
    int32_t to_light_q28[3];    /* l, turned */
    int32_t own_turn_q28[3][3]; /* rows of the rotation from view space to its own frame */
    int32_t sin_q28, cos_q28;
    uint8_t layer;      /* image before the light's angle; never the last */
    int32_t weight_q28; /* of the next one */
    fx_real root4[3];   /* fourth root of the linear factor, R G B */
} shade_quarter_setup;

/* One light on a material that varies, dist. */
typedef struct shade_sbrdf_setup {
    int32_t to_light_q28[3]; /* l, turned; l.v is [2] */
} shade_sbrdf_setup;

typedef struct shade_light {
    fx_real factor[3];   /* R G B, see shade_form; 0 when the light adds nothing */
    fx_real linear[3];   /* the same in SHADE_LINEAR */
    int lift;            /* dist, tables in SHADE_SRGB: 0..SHADE_LIFT_MOST; otherwise 0 */
    fx_real position[4]; /* persp: xyz and w of r = xyz - w P, P = view position x 2^position_shift; |r| is 1 at the
                            centre of the mesh (tables in SHADE_SRGB: 1/8, see SHADE_LIFT_PERSP) */
    union {
        shade_table_setup table;
        shade_spheres_setup spheres;
        shade_quarter_setup quarter;
        shade_sbrdf_setup sbrdf;
    } is;
} shade_light;

/* Constant over a draw: table. */
typedef struct shade_table_draw {
    fx_real scale, bias; /* u' = scale log2(|n - h|^2 + 2 eps) + bias */
    fx_real two_eps, root_two_eps;
    nacre_q16 phi_q16[3];                         /* W; early fine tier: K1, K2, 0 */
    nacre_q16 d_q16[3], v_q16[3], k2_q16, k4_q16; /* fine tier */
    int32_t tile_q28[2]; /* palette, from a tile's origin: u' of the last column, v' of the albedo */
    int32_t row_q28[3];  /* persp: v' = A s + B s^2 + C, s = sqrt(1 - l.h) */
} shade_table_draw;

/* Constant over a draw: spheres, persp. The layers are spread over the file's when it has more than units. */
typedef struct shade_spheres_draw {
    uint8_t count;                      /* units in use */
    uint8_t layer[SHADE_MAX_UNITS];     /* layer that unit i holds; beyond count: the last one again */
    int32_t polar_q28[SHADE_MAX_UNITS]; /* radians */
    int32_t cos_q28[SHADE_MAX_UNITS];   /* of half the polar angle, x disc / 2 */
    int32_t sin_q28[SHADE_MAX_UNITS];
    int32_t rim_q28[SHADE_MAX_UNITS]; /* what depth behind the rim (already x disc / 2) adds to x */
    fx_real ramp[SHADE_MAX_UNITS][2]; /* weight of unit i + 1 over unit i: [0] x polar angle + [1], clamped to 0..1 */
    int32_t half_disc_q28;            /* disc / 2; paper: x 0.995 */
} shade_spheres_draw;

/* Constant over a draw: quartered spheres, all images in one texture, one below the other. With p = log2(|x| + 1/8):
   u' = scale[0] p + bias[0], v' = scale[1] p + bias[1] + image x step. */
typedef struct shade_quarter_draw {
    int32_t scale_q28[2], bias_q28[2], step_q28;
    fx_real ramp[SHADE_MAX_QUARTERS]
                [2]; /* persp: the image's number is the sum of [0] s + [1], each clamped to 0..1, s =
                                            sqrt(1 - l.h) */
} shade_quarter_draw;

/* Constant over a draw: a material that varies. With c what codes 0..1 give for the dot product of a lobe, x = K c. */
typedef struct shade_sbrdf_draw {
    fx_real log2_scale[NACRE_MAX_LOBES];   /* 255 log2 K */
    fx_real column_scale[NACRE_MAX_LOBES]; /* power table: u = column_scale c^2 */
    int32_t
        log2_weight_q16[NACRE_MAX_LOBES]; /* of code 255 of the lobe's albedo, over that of the diffuse albedo; <= 15 */
    fx_real ambient[3]; /* radiance that the ambient light adds where the diffuse albedo's code is 255 */
} shade_sbrdf_draw;

/* One draw. About 2 KB. Lights beyond light_count have factor 0 and are otherwise like directional ones from the eye. */
typedef struct shade_frame {
    shade_light light[NACRE_MAX_LIGHTS];
    uint8_t light_count;
    uint8_t persp;
    int32_t turn_q28[3][3]; /* rows of the rotation (dist, perspective camera; otherwise the identity) */
    int position_shift;
    fx_real eye[4];     /* persp: xyz and w of v = normalize(xyz - w P) */
    fx_real ambient[3]; /* radiance: albedo x ambient / pi x tint x exposure */
    shade_palette palette;
    union {
        shade_table_draw table;
        shade_spheres_draw spheres;
        shade_quarter_draw quarter;
        shade_sbrdf_draw sbrdf;
    } is;
} shade_frame;

/* 1 when the view needs directions per pixel: a point light, or a perspective camera without distant_viewer. */
int shade_needs_persp(const nacre_view *view);

/* All values of one draw. centre: of the mesh's bounds, object space: what a distant viewer looks at, and where point
   lights have |r| = 1. units: sphere layers that the program samples (persp), 2..SHADE_MAX_UNITS. persp: what the program
   was chosen for; without it point lights count as directional ones, seen from the centre. Nothing fails: what is out of
   range saturates. */
void shade_setup(shade_frame *out, const nacre_view *view, const nacre_q16 centre[3], const shade_material *material,
                 shade_form form, int persp, int units);

/* Unit direction towards the eye of a distant viewer, view space: +z under an orthographic camera, else from centre
   (object space) to the eye. */
void shade_eye(const nacre_view *view, const nacre_q16 centre[3], int32_t out_q28[3]);
/* Three rows of the least rotation that takes the unit vector v to +z: `turn` of a frame with this direction to the eye. */
void shade_turn_to_z(const int32_t v_q28[3], int32_t row_q28[][3]);

/* ---- x^n ---------------------------------------------------------------------------------------------------------- */

/* 2^24 log2(1 + i/256) and 2^31 2^(-i/256), i = 0..256: power_table.c, made by tools/gen/power_table.c. */
extern const uint32_t shade_log2_table[257], shade_exp2_table[257];

/* Exponent of a code 0..255 (nacre_asset.h: n = 255 (code/255)^2), q16; worst 1.5 ulp. */
int32_t shade_exponent_q16(uint32_t code);
/* -log2(m 2^-31), q24, for m in 1..2^31: 0 or more; worst 5e-6. */
int64_t shade_minus_log2_q24(uint32_t m);
/* x^n, q16: 0..65536; x above 1 counts as 1, x at and below 0 gives 0. No division, two table entries each way.
   n q16, 0..255. worst 2^-17 + 1.5e-4 of the value. */
uint32_t shade_power_q16(int32_t x_q28, int32_t n_q16);
/* Texel (column, row) of the power table of nacre_asset.h: x^(n/2), 0..65535; width, height 2..4096. Set-up. */
uint32_t shade_power_texel(unsigned column, unsigned row, unsigned width, unsigned height);

/* Pictures of lit spheres are indexed by x and y of the bisector of normal and eye, this far to each side (0.8: normals up to
   106 degrees from the eye), on every backend. */
#define SHADE_LIT_HALF_Q16 52429

/* ---- between the files of this room ----------------------------------------------------------- */

#define SHADE_LOG2_PI_Q16 108232 /* log2(pi) */
#define SHADE_SHRINK_Q14  16302  /* 0.995: in paper mode normals are shortened before sampling, section 4 */

/* What a model's file needs to know of one light. */
typedef struct shade_incoming {
    int32_t to_light_q28[3]; /* unit, turned; l.v is [2] */
    int32_t l_dot_h_q28;     /* >= .022  */
    int lost;                /* 1: l.v < -.999, the half vector is undefined */
} shade_incoming;

/* The light's own frame: x in the plane of l and v, z is h; sin and cos of half the angle between them. */
void shade_own_frame(int32_t turn_q28[][3], int32_t *sin_q28, int32_t *cos_q28, const shade_incoming *in);
/* 1 - l.h, q28, exact near the eye; 1 when h is undefined. */
int32_t shade_away(const shade_incoming *in);

void shade_table_light(shade_table_setup *out, const shade_incoming *in, const shade_table *table);
void shade_table_prepare(shade_table_draw *out, const shade_table *table, int early);
/* log2 (q16) of what table values have to be multiplied by: Ymax^p / (pi E), for light 1 and l.h 1. */
int32_t shade_table_log2(const shade_table *table);

void shade_spheres_light(shade_spheres_setup *out, const shade_incoming *in, const shade_spheres *spheres);
void shade_spheres_prepare(shade_spheres_draw *out, const shade_spheres *spheres, int units);
void shade_quarter_light(shade_quarter_setup *out, const shade_incoming *in, const shade_spheres *spheres);
/* sqrt(1 - l.h) at the polar angle of an image, q28. */
int32_t shade_quarter_step(const shade_spheres *spheres, int layer);
/* Texels an octave of 8 |x| + 1, q9 from q12. */
int32_t shade_quarter_texels(unsigned size);
void shade_quarter_prepare(shade_quarter_draw *out, const shade_spheres *spheres);
int32_t shade_spheres_log2(const shade_spheres *spheres, int channel);

void shade_sbrdf_light(shade_sbrdf_setup *out, const shade_incoming *in);
void shade_sbrdf_prepare(shade_sbrdf_draw *out, const shade_sbrdf *sbrdf);
/* log2 (q16) of the diffuse albedo of code 255, over pi. */
int32_t shade_sbrdf_log2(const shade_sbrdf *sbrdf);

#endif
