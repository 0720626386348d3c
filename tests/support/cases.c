/* SPDX-License-Identifier: MIT */
#include "cases.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ktx2_write.h"
#include "nacre_asset.h"
#include "palette_case.h"
#include "sbrdf_map.h"
#include "sphere_bake.h"
#include "table_bake.h"

#define PI 3.14159265358979323846

/*
 * What the bounds are made of, in codes of 255, driver minus exact double decode of the same file:
 *   filter       texture filters weigh in 1/256: the texel read is up to 1 code of 255 off. What follows multiplies that:
 *                by 2 to 2.4 in sRGB and square root, by 4.8 in linear light (radiance goes with texel^4.8) near white, and
 *                there by exposure too (0.3 % of the pixels may be further off)
 *   +-1          rounding, finished integers (q14 vectors, q16 matrices)
 *   -3           one light of a table, sRGB: the curve is drawn without its linear toe, at worst -2.7 codes near black
 *   -1.4, +1.5   sums of lights, sRGB: a cubic of the square root stands for the curve
 *   outliers     quarters, light past the last angle: n.l and 1 / l.h amplify what a normal's rounding does at the rim;
 *                spheres: a normal turned past the rim is held to it along x, in double along the radius (0.3 % of the
 *                pixels, lights behind); meshes: packed normals, and outlines of parts before others that move by 1/256
 *                pixel, one pixel wide (2 % of the pixels); paper under perspective: mip levels, which double leaves out,
 *                where the frame is much smaller than the images
 *   lit          between texels of 256 a side: flanks of highlights, the terminator and the rim are off there (0.2 % of the
 *                pixels further); normals bumped by more than 16 degrees past the rim are beyond the picture
 *   fp16         11 bits: some codes more on the flank of highlights (test_fp16.c compares it with fp32)
 */
static const compare_bound toe = {-5, 4, 0, 0}, sum = {-4, 4, 0, 0}, root = {-3, 3, 0, 0}, light = {-4, 4, .003, 0};
static const compare_bound rim = {-4, 4, .003, 0}, mip = {-4, 4, .02, 0}, bump = {-6, 5, 0, 0};
static const compare_bound lit_256 = {-4, 4, .002, 0}, half_lit = {-5, 5, .002, 0}, mesh_lit = {-6, 6, .005, .003};
static const compare_bound lit_bump = {-7, 7, .015, 0};
/* Made-up tables of a palette, half of them steeper than a measured one's: llvmpipe rounds filtered normals to 8 bits. */
static const compare_bound bump_tile = {-7, 6, 0, 0};
static const compare_bound mesh_toe = {-5, 4, .004, .003}, mesh_sum = {-4, 4, .02, .003};
static const compare_bound half = {-7, 6, .001, 0}, half_rim = {-7, 6, .004, 0}, mesh_half = {-7, 6, .008, .003};

#define GOLD   "sgd:gold-metallic-paint"
#define YELLOW "sgd:yellow-plastic"
#define VIOLET "sgd:specular-violet-phenolic"
#define SRGB   NACRE_OUTPUT_SRGB
#define SQRT   NACRE_OUTPUT_SQRT
#define LINEAR NACRE_OUTPUT_LINEAR

const frame_case frame_cases[] = {
    {.name = "table 1 light srgb", .brdf = GOLD, .lights = 1, .fp32 = &toe, .fp16 = &half},
    {.name = "table 1 light sqrt", .brdf = GOLD, .lights = 1, .output = SQRT, .fp32 = &root, .fp16 = &half},
    {.name = "table 1 light linear", .brdf = GOLD, .lights = 1, .output = LINEAR, .fp32 = &light, .fp16 = &half},
    {.name = "table 1 light at 75", .brdf = YELLOW, .lights = 1, .polar_deg = 75, .fp32 = &toe, .fp16 = &half},
    {.name = "table 1 light at 110", .brdf = YELLOW, .lights = 1, .polar_deg = 110, .fp32 = &toe, .fp16 = &half},
    {.name = "table 1 light at 150", .brdf = GOLD, .lights = 1, .polar_deg = 150, .fp32 = &toe, .fp16 = &half},
    {.name = "table 1 light at the eye", .brdf = GOLD, .lights = 1, .polar_deg = 1e-9, .fp32 = &toe, .fp16 = &half},
    {.name = "table narrow lobe", .brdf = VIOLET, .lights = 1, .exposure = 2, .fp32 = &toe, .fp16 = &half},
    {.name = "table p4 1 light sqrt",
     .model = CASE_TABLE_P4,
     .brdf = GOLD,
     .lights = 1,
     .output = SQRT,
     .fp32 = &root,
     .fp16 = &half},
    {.name = "table p4 1 light srgb", .model = CASE_TABLE_P4, .brdf = GOLD, .lights = 1, .fp32 = &sum, .fp16 = &half},
    {.name = "table without phi_d", .model = CASE_TABLE_RGB, .brdf = YELLOW, .lights = 1, .fp32 = &toe, .fp16 = &half},
    {.name = "table without phi_d, perspective, point",
     .model = CASE_TABLE_RGB,
     .brdf = YELLOW,
     .camera = CASE_PERSPECTIVE,
     .points = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "table 2 lights", .brdf = YELLOW, .lights = 2, .fp32 = &sum, .fp16 = &half},
    {.name = "table 4 lights", .brdf = YELLOW, .lights = 4, .fp32 = &sum, .fp16 = &half},
    {.name = "table 8 lights", .brdf = GOLD, .lights = 8, .fp32 = &sum, .fp16 = &half},
    {.name = "table 3 lights sqrt", .brdf = GOLD, .lights = 3, .output = SQRT, .fp32 = &root, .fp16 = &half},
    {.name = "table perspective 1 light",
     .brdf = GOLD,
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "table perspective 4 lights",
     .brdf = YELLOW,
     .camera = CASE_PERSPECTIVE,
     .lights = 4,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "table perspective 2 lights, 2 points",
     .brdf = GOLD,
     .camera = CASE_PERSPECTIVE,
     .lights = 2,
     .points = 2,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "table orthographic point", .brdf = GOLD, .points = 1, .fp32 = &sum, .fp16 = &half},
    {.name = "table distant viewer", .brdf = GOLD, .camera = CASE_DISTANT, .lights = 2, .fp32 = &sum, .fp16 = &half},
    {.name = "table distant viewer, point",
     .brdf = GOLD,
     .camera = CASE_DISTANT,
     .lights = 1,
     .points = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "table ambient, tint, exposure, shadow",
     .brdf = YELLOW,
     .lights = 1,
     .ambient = .5,
     .tint = .7,
     .exposure = 1.5,
     .shadow = .4,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "table ambient alone", .brdf = YELLOW, .ambient = 2, .fp32 = &sum, .fp16 = &half},
    {.name = "fine 1 light", .model = CASE_FINE, .brdf = GOLD, .lights = 1, .fp32 = &sum, .fp16 = &half},
    {.name = "fine 1 light sqrt",
     .model = CASE_FINE,
     .brdf = GOLD,
     .lights = 1,
     .output = SQRT,
     .fp32 = &root,
     .fp16 = &half},
    {.name = "fine 4 lights", .model = CASE_FINE, .brdf = YELLOW, .lights = 4, .fp32 = &sum, .fp16 = &half},
    {.name = "fine perspective 1 light, 1 point",
     .model = CASE_FINE,
     .brdf = GOLD,
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .points = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "spheres 1 light", .model = CASE_SPHERES, .brdf = GOLD, .lights = 1, .fp32 = &rim, .fp16 = &half_rim},
    {.name = "spheres 1 light sqrt",
     .model = CASE_SPHERES,
     .brdf = GOLD,
     .lights = 1,
     .output = SQRT,
     .fp32 = &root,
     .fp16 = &half_rim},
    {.name = "spheres stored angle",
     .model = CASE_SPHERES,
     .brdf = GOLD,
     .lights = 1,
     .polar_deg = 45,
     .fp32 = &rim,
     .fp16 = &half_rim},
    {.name = "spheres past the last angle",
     .model = CASE_SPHERES,
     .brdf = YELLOW,
     .lights = 1,
     .polar_deg = 150,
     .fp32 = &rim,
     .fp16 = &half_rim},
    {.name = "spheres 2 lights", .model = CASE_SPHERES, .brdf = YELLOW, .lights = 2, .fp32 = &rim, .fp16 = &half_rim},
    {.name = "spheres 4 lights", .model = CASE_SPHERES, .brdf = YELLOW, .lights = 4, .fp32 = &rim, .fp16 = &half_rim},
    {.name = "spheres 8 lights", .model = CASE_SPHERES, .brdf = GOLD, .lights = 8, .fp32 = &rim, .fp16 = &half_rim},
    {.name = "spheres perspective 1 light",
     .model = CASE_SPHERES,
     .brdf = GOLD,
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .fp32 = &rim,
     .fp16 = &half_rim},
    {.name = "spheres perspective 2 lights, 1 point",
     .model = CASE_SPHERES,
     .brdf = YELLOW,
     .camera = CASE_PERSPECTIVE,
     .lights = 2,
     .points = 1,
     .fp32 = &rim,
     .fp16 = &half_rim},
    {.name = "spheres distant viewer",
     .model = CASE_SPHERES,
     .brdf = GOLD,
     .camera = CASE_DISTANT,
     .lights = 1,
     .fp32 = &rim,
     .fp16 = &half_rim},
    {.name = "spheres ambient, tint",
     .model = CASE_SPHERES,
     .brdf = GOLD,
     .lights = 1,
     .ambient = .5,
     .tint = .6,
     .fp32 = &rim,
     .fp16 = &half_rim},
    {.name = "quarter 1 light", .model = CASE_QUARTER, .brdf = GOLD, .lights = 1, .fp32 = &sum, .fp16 = &half},
    {.name = "quarter 1 light sqrt",
     .model = CASE_QUARTER,
     .brdf = GOLD,
     .lights = 1,
     .output = SQRT,
     .fp32 = &root,
     .fp16 = &half},
    {.name = "quarter 1 light linear",
     .model = CASE_QUARTER,
     .brdf = GOLD,
     .lights = 1,
     .output = LINEAR,
     .fp32 = &light,
     .fp16 = &half},
    {.name = "quarter narrow lobe",
     .model = CASE_QUARTER,
     .brdf = VIOLET,
     .lights = 1,
     .exposure = 2,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "quarter stored angle",
     .model = CASE_QUARTER_ETC1,
     .brdf = YELLOW,
     .lights = 1,
     .polar_deg = 90,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "quarter past the last angle",
     .model = CASE_QUARTER,
     .brdf = YELLOW,
     .lights = 1,
     .polar_deg = 172,
     .fp32 = &light,
     .fp16 = &half},
    {.name = "quarter at the eye",
     .model = CASE_QUARTER,
     .brdf = GOLD,
     .lights = 1,
     .polar_deg = 1e-9,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "quarter etc1 2 lights",
     .model = CASE_QUARTER_ETC1,
     .brdf = YELLOW,
     .lights = 2,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "quarter 4 lights", .model = CASE_QUARTER, .brdf = YELLOW, .lights = 4, .fp32 = &sum, .fp16 = &half},
    {.name = "quarter 8 lights", .model = CASE_QUARTER, .brdf = GOLD, .lights = 8, .fp32 = &sum, .fp16 = &half},
    {.name = "quarter perspective 1 light",
     .model = CASE_QUARTER,
     .brdf = GOLD,
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "quarter etc1 perspective 2 lights, 1 point",
     .model = CASE_QUARTER_ETC1,
     .brdf = YELLOW,
     .camera = CASE_PERSPECTIVE,
     .lights = 2,
     .points = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "quarter distant viewer",
     .model = CASE_QUARTER,
     .brdf = GOLD,
     .camera = CASE_DISTANT,
     .lights = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "quarter ambient, tint",
     .model = CASE_QUARTER,
     .brdf = GOLD,
     .lights = 1,
     .ambient = .5,
     .tint = .6,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "paper 1 light", .model = CASE_PAPER, .brdf = YELLOW, .lights = 1, .fp32 = &toe, .fp16 = &half},
    {.name = "paper stored angle",
     .model = CASE_PAPER,
     .brdf = YELLOW,
     .lights = 1,
     .polar_deg = 90,
     .fp32 = &toe,
     .fp16 = &half},
    {.name = "paper past the last angle",
     .model = CASE_PAPER,
     .brdf = YELLOW,
     .lights = 1,
     .polar_deg = 150,
     .fp32 = &toe,
     .fp16 = &half},
    {.name = "paper 2 lights", .model = CASE_PAPER, .brdf = YELLOW, .lights = 2, .fp32 = &sum, .fp16 = &half},
    {.name = "paper 4 lights linear",
     .model = CASE_PAPER,
     .brdf = YELLOW,
     .lights = 4,
     .output = LINEAR,
     .fp32 = &light,
     .fp16 = &half},
    {.name = "paper perspective 1 light, 1 point",
     .model = CASE_PAPER,
     .brdf = YELLOW,
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .points = 1,
     .fp32 = &mip,
     .fp16 = &half},
    {.name = "teapot table 1 light",
     .brdf = GOLD,
     .mesh = "teapot",
     .lights = 1,
     .fp32 = &mesh_toe,
     .fp16 = &mesh_half},
    {.name = "teapot table perspective 4 lights",
     .brdf = YELLOW,
     .mesh = "teapot",
     .camera = CASE_PERSPECTIVE,
     .lights = 4,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "teapot spheres perspective 1 light",
     .model = CASE_SPHERES,
     .brdf = YELLOW,
     .mesh = "teapot",
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "torus fine perspective 2 lights, 1 point",
     .model = CASE_FINE,
     .brdf = GOLD,
     .mesh = "torus",
     .camera = CASE_PERSPECTIVE,
     .lights = 2,
     .points = 1,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "torus paper 2 lights",
     .model = CASE_PAPER,
     .brdf = YELLOW,
     .mesh = "torus",
     .lights = 2,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "sphere table normal map", .brdf = GOLD, .lights = 1, .normal_map = 1, .fp32 = &bump, .fp16 = &half},
    {.name = "plane table normal map, point",
     .brdf = GOLD,
     .mesh = "plane",
     .points = 1,
     .normal_map = 1,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "torus table normal map 2 lights",
     .brdf = YELLOW,
     .mesh = "torus",
     .lights = 2,
     .normal_map = 1,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "torus quarter normal map",
     .model = CASE_QUARTER,
     .brdf = GOLD,
     .mesh = "torus",
     .lights = 1,
     .normal_map = 1,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "torus spheres normal map perspective",
     .model = CASE_SPHERES,
     .brdf = YELLOW,
     .mesh = "torus",
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .normal_map = 1,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "palette 1 light", .model = CASE_PALETTE, .lights = 1, .exposure = 1, .fp32 = &sum, .fp16 = &half},
    {.name = "palette 3 lights sqrt",
     .model = CASE_PALETTE,
     .lights = 3,
     .output = SQRT,
     .exposure = .7,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "palette 1 light linear",
     .model = CASE_PALETTE,
     .lights = 1,
     .output = LINEAR,
     .exposure = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "palette ambient, tint, exposure",
     .model = CASE_PALETTE,
     .lights = 2,
     .ambient = .5,
     .tint = .8,
     .exposure = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "palette ambient alone", .model = CASE_PALETTE, .ambient = 2, .fp32 = &sum, .fp16 = &half},
    {.name = "palette blended ambient alone", .model = CASE_PALETTE_BLEND, .ambient = 2, .fp32 = &sum, .fp16 = &half},
    {.name = "palette perspective 8 lights, ambient",
     .model = CASE_PALETTE,
     .camera = CASE_PERSPECTIVE,
     .lights = 8,
     .ambient = .3,
     .exposure = .4,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "palette distant viewer, normal map",
     .model = CASE_PALETTE,
     .camera = CASE_DISTANT,
     .lights = 2,
     .normal_map = 1,
     .exposure = .7,
     .fp32 = &bump_tile,
     .fp16 = &half},
    {.name = "palette blended 1 light",
     .model = CASE_PALETTE_BLEND,
     .lights = 1,
     .exposure = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "palette blended 8 lights",
     .model = CASE_PALETTE_BLEND,
     .lights = 8,
     .exposure = .4,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "palette blended perspective 1 light, 2 points",
     .model = CASE_PALETTE_BLEND,
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .points = 2,
     .exposure = .5,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "torus palette blended normal map",
     .model = CASE_PALETTE_BLEND,
     .mesh = "torus",
     .lights = 2,
     .normal_map = 1,
     .exposure = .7,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "sbrdf 1 lobe 1 light", .model = CASE_SBRDF, .lights = 1, .exposure = 1, .fp32 = &sum, .fp16 = &half},
    {.name = "sbrdf 2 lobes 3 lights sqrt",
     .model = CASE_SBRDF2,
     .lights = 3,
     .output = SQRT,
     .exposure = 1,
     .fp32 = &root,
     .fp16 = &half},
    {.name = "sbrdf 3 lobes 8 lights",
     .model = CASE_SBRDF3,
     .lights = 8,
     .exposure = .5,
     .tint = .7,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "sbrdf 3 lobes perspective 1 light, 1 point",
     .model = CASE_SBRDF3,
     .camera = CASE_PERSPECTIVE,
     .lights = 1,
     .points = 1,
     .exposure = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "sbrdf 2 lobes distant viewer",
     .model = CASE_SBRDF2,
     .camera = CASE_DISTANT,
     .lights = 2,
     .exposure = 1,
     .fp32 = &sum,
     .fp16 = &half},
    {.name = "sbrdf 1 lobe normal map",
     .model = CASE_SBRDF,
     .lights = 2,
     .normal_map = 1,
     .exposure = 1,
     .fp32 = &bump,
     .fp16 = &half},
    {.name = "torus sbrdf 2 lobes perspective",
     .model = CASE_SBRDF2,
     .mesh = "torus",
     .camera = CASE_PERSPECTIVE,
     .lights = 2,
     .exposure = 1,
     .fp32 = &mesh_sum,
     .fp16 = &mesh_half},
    {.name = "lit 1 light", .brdf = GOLD, .lights = 1, .lit = 256, .fp32 = &lit_256, .fp16 = &half_lit},
    {.name = "lit 1 light at 110",
     .brdf = YELLOW,
     .lights = 1,
     .polar_deg = 110,
     .lit = 256,
     .fp32 = &lit_256,
     .fp16 = &half_lit},
    {.name = "lit p4 3 lights sqrt",
     .model = CASE_TABLE_P4,
     .brdf = GOLD,
     .lights = 3,
     .output = SQRT,
     .lit = 256,
     .fp32 = &lit_256,
     .fp16 = &half_lit},
    {.name = "lit 8 lights linear",
     .brdf = YELLOW,
     .lights = 8,
     .output = LINEAR,
     .lit = 256,
     .fp32 = &lit_256,
     .fp16 = &half_lit},
    {.name = "lit ambient, tint, exposure, shadow",
     .brdf = YELLOW,
     .lights = 2,
     .ambient = .5,
     .tint = .7,
     .exposure = 1.5,
     .shadow = .4,
     .lit = 256,
     .fp32 = &lit_256,
     .fp16 = &half_lit},
    {.name = "lit ambient alone", .brdf = YELLOW, .ambient = 2, .lit = 64, .fp32 = &lit_256, .fp16 = &half_lit},
    {.name = "lit 64 lights", .brdf = GOLD, .distant = 64, .lit = 256, .fp32 = &lit_256, .fp16 = &half_lit},
    {.name = "lit fine 40 lights linear",
     .model = CASE_FINE,
     .brdf = YELLOW,
     .lights = 1,
     .distant = 39,
     .output = LINEAR,
     .lit = 256,
     .fp32 = &sum, /* forty lights leave no flank steep enough to lie between texels */
     .fp16 = &half_lit},
    {.name = "lit spheres 5 lights",
     .model = CASE_SPHERES,
     .brdf = GOLD,
     .lights = 5,
     .lit = 256,
     .fp32 = &lit_256,
     .fp16 = &half_lit},
    {.name = "lit paper 2 lights",
     .model = CASE_PAPER,
     .brdf = YELLOW,
     .lights = 2,
     .lit = 256,
     .fp32 = &lit_256,
     .fp16 = &half_lit},
    {.name = "lit normal map, 12 lights",
     .brdf = GOLD,
     .distant = 12,
     .normal_map = 1,
     .lit = 256,
     .fp32 = &lit_bump,
     .fp16 = &lit_bump},
    {.name = "lit distant viewer 4 lights",
     .brdf = GOLD,
     .camera = CASE_DISTANT,
     .lights = 4,
     .lit = 256,
     .fp32 = &lit_256,
     .fp16 = &half_lit},
    {.name = "teapot lit distant viewer 20 lights",
     .brdf = YELLOW,
     .mesh = "teapot",
     .camera = CASE_DISTANT,
     .distant = 20,
     .lit = 256,
     .fp32 = &mesh_lit,
     .fp16 = &mesh_lit},
    {.name = "torus lit normal map 2 lights",
     .brdf = YELLOW,
     .mesh = "torus",
     .lights = 2,
     .normal_map = 1,
     .lit = 256,
     .fp32 = &mesh_lit,
     .fp16 = &mesh_lit},
};
const int frame_case_count = sizeof frame_cases / sizeof *frame_cases;

/* ---- scenes ---------------------------------------------------------------------------------------------------- */

/* count lights over the whole sphere, dim ones among them; together about as strong as the fixed set. */
static const light_set *lights_around(int count)
{
    static distant_light all[64];
    static light_set set = {all, 0};
    int i, k;

    set.count = count;
    for (i = 0; i < count; i++) {
        const double z = 1 - 2 * (i + .5) / count, azimuth = 2.399963 * i, across = sqrt(1 - z * z);
        const double power = 12. / count * (i % 5 ? .6 : 2.6);
        all[i].direction[0] = across * cos(azimuth);
        all[i].direction[1] = across * sin(azimuth);
        all[i].direction[2] = z;
        for (k = 0; k < 3; k++) all[i].irradiance[k] = power * (1 + .4 * cos(azimuth + k));
    }
    return count ? &set : NULL;
}

void case_scene(scene *s, const frame_case *c, const mesh *shape, int width, int height)
{
    /* polar, azimuth, power: no two alike, some grazing, one behind */
    static const double direction[8][5] = {{35, 40, 2.2, 2.2, 2.2}, {70, 200, .9, 1.1, 1.4}, {110, 300, 1.5, 1.2, .9},
                                           {60, 120, .5, .4, .6},   {15, 0, .3, .3, .4},     {85, 270, .7, .8, .6},
                                           {100, 30, 1, .9, 1.1},   {50, 330, .4, .6, .3}};
    static const double place[2][3] = {{1.4, 1.1, 1.8}, {-1.6, 0.4, 1.2}}, strength[2][3] = {{6, 6, 6}, {3, 4, 5}};
    const scene_camera camera = {.kind = c->camera == CASE_ORTHO ? SCENE_CAMERA_ORTHO : SCENE_CAMERA_FIT,
                                 .yaw_deg = c->mesh ? 25 : 0,
                                 .pitch_deg = c->mesh ? 20 : 0,
                                 .fovy_deg = 40};
    failure f = {0};
    int i, k;

    scene_begin(s, shape, width, height);
    if (scene_aim(s, &camera, &f)) {
        fprintf(stderr, "%s: %s\n", c->name, f.text);
        exit(1);
    }
    s->distant_viewer = c->camera == CASE_DISTANT;
    s->output = c->output;
    s->exposure = c->exposure > 0 ? c->exposure : 2.5; /* bright enough for errors to show */
    for (k = 0; k < 3; k++) {
        s->ambient[k] = c->ambient;
        s->tint[k] = c->tint > 0 ? pow(c->tint, k) : 1;
    }
    for (i = 0; i < c->lights; i++)
        scene_add_light(s, i == 0 && c->polar_deg > 0 ? c->polar_deg : direction[i][0], direction[i][1],
                        &direction[i][2]);
    for (i = 0; i < c->points; i++) {
        /* places are about the mesh's centre */
        double at[3] = {place[i][0], place[i][1], place[i][2] + s->object_to_view[14]};
        scene_add_point(s, at, strength[i]);
    }
    s->light[0].shadow = c->shadow;
    s->distant = lights_around(c->distant);
    s->lit_size = c->lit;
}

/* ---- assets ---------------------------------------------------------------------------------------------------- */

static void need(int code, const failure *f)
{
    if (!code) return;
    fprintf(stderr, "%s\n", f->text);
    exit(1);
}

static int is_spheres(case_model model)
{
    return model == CASE_SPHERES || model == CASE_PAPER || model == CASE_QUARTER || model == CASE_QUARTER_ETC1;
}

static int sbrdf_lobes(case_model model)
{
    return model == CASE_SBRDF ? 1 : model == CASE_SBRDF2 ? 2 : model == CASE_SBRDF3 ? 3 : 0;
}

/* Codes that change slowly and repeat at the edges, so that the steps of a texture filter do not show: a forward lobe, an
   anisotropic off-specular one, a retroreflective one. */
static void paint(sbrdf_map *m, int lobes)
{
    enum { SIDE = 8 };
    static const int shape[3][4] = {{20, 20, 240, 150}, {12, 70, 220, 110}, {225, 225, 235, 60}};
    int i, j, c;

    sbrdf_map_make(m, SIDE, SIDE, lobes, lobes < 3, 1);
    m->albedo_most = .6;
    for (i = 0; i < SIDE * SIDE; i++) {
        const double x = 2 * PI * (i % SIDE) / SIDE, y = 2 * PI * (i / SIDE) / SIDE;

        for (c = 0; c < 4; c++) m->albedo[0][4 * i + c] = (uint8_t)(c < 3 ? 90 + 40 * sin(x + c) * cos(y) : 255);
        for (j = 0; j < lobes; j++) {
            uint8_t *albedo = m->lobe[0] + 4 * (2 * j * SIDE * SIDE + i), *codes = albedo + 4 * SIDE * SIDE;

            for (c = 0; c < 4; c++) albedo[c] = (uint8_t)(c < 3 ? 120 + 50 * cos(x + j) * sin(y + c) : 255);
            for (c = 0; c < 4; c++) codes[c] = (uint8_t)(shape[j][c] + (c == 3 ? 12 : 5) * sin(x - j) * sin(y));
        }
        if (!m->has_direction) continue;
        m->lobe[0][4 * i + 3] = (uint8_t)(128 + 90 * cos(.4 * sin(y) + .5));
        m->lobe[0][4 * (2 * SIDE * SIDE + i) + 3] = (uint8_t)(128 + 90 * sin(.4 * sin(y) + .5));
    }
    m->most[0] = 1.2;
    m->shape_most[0] = 1.1;
}

static void open_or_exit(nacre_image *image, const bytes *file, const char *name)
{
    if (!nacre_image_open(image, file->data, file->size)) return;
    fprintf(stderr, "%s: nacre_image_open refuses its own file\n", name);
    exit(1);
}

static void open_sbrdf(case_asset *a, case_model model)
{
    sbrdf_map m;

    paint(&m, sbrdf_lobes(model));
    sbrdf_map_write(&m, &a->file, &a->second_file);
    a->decoded = sbrdf_map_brdf(&m);
    open_or_exit(&a->image, &a->file, "albedo");
    open_or_exit(&a->second_image, &a->second_file, "lobes");
    a->material.model = NACRE_MODEL_SBRDF;
    a->material.image[NACRE_ROLE_ALBEDO] = &a->image;
    a->material.image[NACRE_ROLE_LOBES] = &a->second_image;
}

static int is_palette(case_model model)
{
    return model == CASE_PALETTE || model == CASE_PALETTE_BLEND;
}

static void open_palette(case_asset *a, case_model model)
{
    palette p;

    palette_case_make(&p, model == CASE_PALETTE_BLEND);
    palette_write(&p, &a->file, &a->second_file);
    a->decoded = palette_brdf(&p);
    memcpy(a->albedo, palette_case_albedo, sizeof a->albedo);
    open_or_exit(&a->image, &a->file, "palette");
    open_or_exit(&a->second_image, &a->second_file, "index");
    a->material.model = NACRE_MODEL_PALETTE;
    a->material.image[NACRE_ROLE_PALETTE] = &a->image;
    a->material.image[NACRE_ROLE_INDEX] = &a->second_image;
}

static void bake(bytes *file, case_model model, const char *brdf_name)
{
    const table_options table[CASE_MODEL_COUNT] = {
        [CASE_TABLE_P4] = {.power = 4}, [CASE_TABLE_RGB] = {.tier = TABLE_RGB}, [CASE_FINE] = {.tier = TABLE_FINE}};
    const sphere_options spheres[CASE_MODEL_COUNT] = {
        [CASE_SPHERES] = {.mode = SPHERE_COSINE_FREE},
        [CASE_PAPER] = {.mode = SPHERE_PAPER},
        [CASE_QUARTER_ETC1] = {.images = 11, .size = 16, .format = NACRE_FORMAT_ETC2_RGB8}};
    failure f = {0};
    brdf *b;

    need(brdf_open(&b, brdf_name, &f), &f);
    if (is_spheres(model)) {
        sphere_asset s;
        need(sphere_bake(&s, b, &spheres[model], &f), &f);
        sphere_write(&s, file);
        sphere_free(&s);
    } else {
        table_asset t;
        need(table_bake(&t, b, &table[model], &f), &f);
        table_write(&t, file);
        table_free(&t);
    }
    brdf_close(b);
}

static void decode(case_asset *a, case_model model, const char *name)
{
    failure f = {0};
    int k;

    open_or_exit(&a->image, &a->file, name);
    if (is_spheres(model)) {
        sphere_asset s;
        need(sphere_read(&s, &a->image, name, &f), &f);
        a->decoded = sphere_brdf(&s, &(sphere_decode_options){0});
        for (k = 0; k < 3; k++) a->albedo[k] = s.albedo[k];
        sphere_free(&s);
        a->material.model = NACRE_MODEL_SPHERES;
        a->material.image[NACRE_ROLE_SPHERES] = &a->image;
    } else {
        table_asset t;
        need(table_read(&t, &a->image, name, &f), &f);
        a->decoded = table_brdf(&t);
        for (k = 0; k < 3; k++) a->albedo[k] = t.albedo[k];
        table_free(&t);
        a->material.model = NACRE_MODEL_TABLE;
        a->material.image[NACRE_ROLE_TABLE] = &a->image;
    }
}

/* Smooth bumps, up to 0.35 off the vertical, that repeat at the edges. */
static void make_normal_map(case_asset *a)
{
    enum { SIZE = 64 };
    ktx2_image k = {.format = NACRE_FORMAT_RGBA8, .width = SIZE, .height = SIZE, .faces = 1, .levels = 1};
    int x, y, c;

    a->normal_map = image_u8_make(SIZE, SIZE, 4);
    for (y = 0; y < SIZE; y++)
        for (x = 0; x < SIZE; x++) {
            double n[3] = {0.35 * sin(4 * PI * x / SIZE), 0.35 * cos(6 * PI * y / SIZE), 1};
            double length = sqrt(n[0] * n[0] + n[1] * n[1] + 1);
            uint8_t *to = a->normal_map.texel + 4 * (y * SIZE + x);
            for (c = 0; c < 3; c++) to[c] = unorm8(0.5 + 0.5 * n[c] / length);
            to[3] = 255;
        }
    bytes_append(&k.level[0], a->normal_map.texel, SIZE * SIZE * 4);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "normal");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "linear");
    ktx2_write(&k, &a->normal_file);
    ktx2_free(&k);
    open_or_exit(&a->normal_image, &a->normal_file, "normal map");
    a->material.image[NACRE_ROLE_NORMAL] = &a->normal_image;
}

void case_asset_open(case_asset *out, case_model model, const char *brdf_name, int normal_map, const char *directory)
{
    char path[600] = "";
    failure f = {0};

    *out = (case_asset){0};
    if (normal_map) make_normal_map(out);
    if (sbrdf_lobes(model)) {
        open_sbrdf(out, model);
        return;
    }
    if (is_palette(model)) {
        open_palette(out, model);
        return;
    }
    if (directory) snprintf(path, sizeof path, "%s/%d-%s", directory, model, brdf_name);
    if (!directory || file_read(&out->file, path, &f)) {
        bake(&out->file, model, brdf_name);
        if (directory) need(output_write_raw(path, &out->file, &f), &f);
    }
    decode(out, model, brdf_name);
}

void case_asset_close(case_asset *a)
{
    brdf_close(a->decoded);
    bytes_free(&a->file);
    bytes_free(&a->normal_file);
    bytes_free(&a->second_file);
    image_u8_free(&a->normal_map);
}
