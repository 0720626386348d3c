// SPDX-License-Identifier: MIT
// Common to both stages: GLSL ES 1.00 and 3.00 from the same words, precisions, output curves.
// The #defines before this text are written by src/gles/text.c: LIGHTS, PERSP, OUTPUT, FORM, ... always a number.

#if ES3
#define texture2D texture
#define texture2DProj textureProj
#define attribute in
#ifdef STAGE_VERTEX
#define varying out
#else
#define varying in
#endif
#endif

#ifdef STAGE_VERTEX
precision highp float;
#define HIGHP highp
#define UNIT mediump
#else
#if SPHERE && defined GL_FRAGMENT_PRECISION_HIGH
precision highp float; // texels are few, and many lights are added up
#else
precision mediump float;
#endif
// Positions and texture coordinates of normal maps want more than 11 bits; everything else is safe in fp16.
#ifdef GL_FRAGMENT_PRECISION_HIGH
#define HIGHP highp
#else
#define HIGHP mediump
#endif
// Unit vectors. Tables with directions per pixel want small differences of them, pictures of lit spheres all there is.
#if SPHERE || (PERSP && LAYERS == 0)
#define UNIT HIGHP
#else
#define UNIT mediump
#endif
#endif

varying UNIT vec3 v_normal; // SPHERE: see frame.vert
#if SPHERE
varying HIGHP vec2 v_at;
varying UNIT vec3 v_axis;
#endif
// Spatially varying, one directional light: its direction in the frame of the vertex in place of the frame.
#define OWN_FRAME (SBRDF && LIGHTS == 1 && !PERSP && !NORMAL_MAP && !PASS)
#if NORMAL_MAP || (SBRDF && LIGHTS && !OWN_FRAME)
#define FRAME 1
varying UNIT vec3 v_tangent;
varying UNIT vec3 v_bitangent;
#else
#define FRAME 0
#endif
#if NORMAL_MAP || MASK || SBRDF || PALETTE
varying HIGHP vec2 v_uv;
#endif
#if PERSP
varying HIGHP vec3 v_position; // view space x 2^position_shift
#endif
#if PASS
varying HIGHP vec3 v_screen; // for texture2DProj: this pixel's own place in a target as large as the viewport
#endif
