/* SPDX-License-Identifier: MIT */
/*
 * nacre_asset.h - the file profile: one asset = one KTX2 file
 *
 * The profile (what nacre_image_open accepts):
 *   supercompressionScheme 0; pixelDepth 0; levelCount 1..12, complete or cut short; faceCount 1 or 6;
 *   layerCount 0..64 (0 means one, not an array); 1..4096 texels a side; high words of 64-bit fields zero.
 *   Image data tight; every level length equals layers x faces x the level's size computed from the header;
 *   level offsets aligned to 4 and to the texel or block size. Formats: NACRE_FORMAT_*. 3D data is stored as layers.
 * Numbers in values are u32 or q16 (s32), little-endian; texts are ASCII with their NUL.
 */
#ifndef NACRE_ASSET_H
#define NACRE_ASSET_H

#define NACRE_ASSET_VERSION 1

/* Limits of the profile. */
#define NACRE_MAX_TEXELS 4096
#define NACRE_MAX_LAYERS 64
#define NACRE_MAX_FILE_BYTES 0x7FFFFFFF

/* Texel formats: the vkFormat numbers of KTX2. */
#define NACRE_FORMAT_RGB565 4   /* R in bits 15..11 of a little-endian u16 */
#define NACRE_FORMAT_R8 9
#define NACRE_FORMAT_RG8 16
#define NACRE_FORMAT_RGB8 23
#define NACRE_FORMAT_RGBA8 37
#define NACRE_FORMAT_RGBA16F 97  /* GLES 3 only */
#define NACRE_FORMAT_E5BGR9 123  /* GLES 3 only */
#define NACRE_FORMAT_ETC2_RGB8 147 /* with key nacre.etc1: only ETC1 modes, so GLES 2 takes it too */

/* Keys of every file. */
#define NACRE_KEY_VERSION "nacre.asset_version" /* u32: NACRE_ASSET_VERSION */
#define NACRE_KEY_ROLE "nacre.role"         /* text: "table", "spheres", "normal" */
#define NACRE_KEY_TRANSFER "nacre.transfer" /* text: how a code y in 0..1 maps to its value, see below */
#define NACRE_KEY_NAME "nacre.name"         /* text: the BRDF that was baked */
#define NACRE_KEY_ETC1 "nacre.etc1_only"     /* u32: 1 = every block is valid ETC1 */
#define NACRE_KEY_ALBEDO "nacre.white_sky" /* 3 q16: hemispherical (white-sky) albedo, R G B */

/* role "table" (TABLE model). One layer (default, RGB tier) or two (fine tier), RGBA8, one level. With
   y = RGB + (A - 1/2) a^2 W (fine: RGB + (T.rgb - 1/2) a^2 K1 + (A - 1/2) |a| K2), a = n.l - n.v:
   (Ymax y)^p = pi E f_r l.h. Rows run over s = sqrt(1 - l.h): v = 0.7 s + 0.3 s^2; columns over t = 1 - n.h:
   u = log2(t/eps + 1) / log2(1/eps + 1); both end-aligned (texel centres of the first and last texel are 0 and 1). */
#define NACRE_KEY_TABLE "nacre.table" /* 9 q16: E, Ymax, W.r, W.g, W.b, p, eps, K1, K2 (K1, K2: 0 but in the fine tier) */

/* role "spheres" (SPHERES model). One layer per light polar angle; a unit sphere seen along -z from +z, the light at
   (sin polar, 0, cos polar); image row 0 is the top (+y). The disc of the sphere has radius disc/2 of the image's
   width, centred; texels beyond it repeat the rim. Transfer "root4": pi f_r = scale y^4 per channel, without the
   cosine; "srgb": y = sRGB(min(pi E f_r n.l, 1)), scale holds E. */
#define NACRE_KEY_LIGHT_POLAR "nacre.polar_bam" /* one u32 per layer: polar angle in bam (32768 = 180 degrees), rising */
#define NACRE_KEY_COSINE "nacre.cosine_in" /* u32: 1 = the cosine n.l is in the image (paper mode), 0 = not */
#define NACRE_KEY_SCALE "nacre.scale"             /* 3 q16: R G B */
#define NACRE_KEY_DISC "nacre.disc_size" /* q16: disc diameter / image width, 0.5..1; 1 = not padded */

#endif
