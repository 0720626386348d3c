/* SPDX-License-Identifier: MIT */
/*
 * Materials that vary over the surface: every texel a Lafortune BRDF (McAllister et al. 2002), as the 8-bit codes of the
 * roles "albedo" and "lobes" in nacre_asset.h. Codes and values meet here and nowhere else in the tools.
 */
#ifndef SBRDF_MAP_H
#define SBRDF_MAP_H

#include "brdf.h"
#include "lafortune_solve.h"
#include "nacre.h"
#include "output.h"

enum { SBRDF_MAX_LEVELS = NACRE_MAX_LEVELS };

/* Limits of fits for maps: exponents (below 1 a table of x^n is coarse at 0), and how much lobes may grow beyond 75 degrees. */
#define SBRDF_EXPONENT_LEAST 1
#define SBRDF_EXPONENT_MOST  255
#define SBRDF_GRAZING_MAX    8

/* ---- one texel ------------------------------------------------------------------------------------ */

typedef struct sbrdf_texel {
    lafortune_shared brdf; /* kd is the diffuse albedo; ks in 1/sr, as f_r has it */
    double alpha;          /* opacity, 0..1 */
    double direction[2];   /* of anisotropy, unit; (1, 0): the tangent */
} sbrdf_texel;

/* f_r of a texel; directions in the frame of tangent, bitangent, normal. */
void sbrdf_texel_eval(const sbrdf_texel *t, const double to_light[3], const double to_eye[3], double f_r[3]);

/* ---- codes ---------------------------------------------------------------------------------------- */

double sbrdf_shape_value(double code, double most); /* most (code - 128)/127 */
int sbrdf_shape_code(double value, double most);    /* nearest, 0..255 */
double sbrdf_exponent_value(double code);           /* 255 (code/255)^2 */
int sbrdf_exponent_code(double n);                  /* nearest in the code, 0..255 */
double sbrdf_albedo_value(double code, double most);
int sbrdf_albedo_code(double value, double most);

/* ---- maps ----------------------------------------------------------------------------------------- */

typedef struct sbrdf_map {
    int width, height, lobes, levels;
    int has_direction;
    int layers;                             /* of the lobes: 2 x lobes, 3 for one lobe with a direction */
    double albedo_most;                     /* diffuse albedo of code 255 */
    double most[LAFORTUNE_MAX_LOBES];       /* lobe albedo (pi f_r) of code 255 */
    double shape_most[LAFORTUNE_MAX_LOBES]; /* C of code 255 */
    double white_sky[3];                    /* hemispherical albedo, mean over the map */
    char name[128];
    uint8_t *albedo[SBRDF_MAX_LEVELS]; /* RGBA, rows from the top */
    uint8_t *lobe[SBRDF_MAX_LEVELS];   /* RGBA, layer after layer */
} sbrdf_map;

/* Codes 0 of levels 0..levels-1; most and shape_most 1. levels 0: the full chain, 1 if a side is no power of two. */
void sbrdf_map_make(sbrdf_map *m, int width, int height, int lobes, int has_direction, int levels);
void sbrdf_map_free(sbrdf_map *m);
int sbrdf_level_width(const sbrdf_map *m, int level);
int sbrdf_level_height(const sbrdf_map *m, int level);

/* The texel (x, y) of a level, decoded: what GL_NEAREST reads. */
void sbrdf_map_texel(const sbrdf_map *m, int level, int x, int y, sbrdf_texel *out);
/* The mean of the codes of side x side texels of level 0 from (x, y) on, decoded: what a GPU's own smaller levels hold. */
void sbrdf_map_mean_codes(const sbrdf_map *m, int x, int y, int side, sbrdf_texel *out);
/* The same at u, v (v = 0 is the last row) and lod, repeated: codes are filtered as by GL_LINEAR_MIPMAP_LINEAR and decoded
   then. lod is limited to the levels there are. */
void sbrdf_map_sample(const sbrdf_map *m, double u, double v, double lod, sbrdf_texel *out);

/* The material as a BRDF: eval_at filters level 0, eval is the smallest level's texel. Takes the map over: *m is emptied. */
brdf *sbrdf_map_brdf(sbrdf_map *m);

/* The two files. */
void sbrdf_map_write(const sbrdf_map *m, bytes *albedo, bytes *lobes);
/* FAIL_INVALID: a key, format or size is not what nacre_asset.h says, or the two files do not belong together. The paths
   are for messages. */
int sbrdf_map_read(sbrdf_map *out, const nacre_image *albedo, const char *albedo_path, const nacre_image *lobes,
                   const char *lobes_path, failure *f);
/* Either alone, checked: NULL what there is no need of. */
int sbrdf_check_albedo(const nacre_image *image, const char *path, double *most, failure *f);
int sbrdf_check_lobes(const nacre_image *image, const char *path, sbrdf_map *keys, failure *f);

#endif
