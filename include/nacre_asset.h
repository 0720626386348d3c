/* SPDX-License-Identifier: MIT */
/*
 * nacre_asset.h - the file profile: one asset = one KTX2 file
 *
 * An asset is a Khronos KTX 2.0 texture file that keeps within the limits below; any KTX2 tool reads it, and images of
 * other tools open too if they keep within them. It holds layers x faces x mip levels of one size and format, and a few
 * keys. All numbers are little-endian. Offsets count from the first byte of the file; sizes are bytes.
 *
 * Layout. The parts follow each other in this order; there is no other freedom than the lengths:
 *
 *   header | level index | data format descriptor | keys | padding, level n-1 | ... | padding, level 0
 *
 * Header, 80 bytes
 *
 *   offset size  field                    value
 *        0   12  identifier               AB "KTX 20" BB 0D 0A 1A 0A
 *       12    4  vkFormat                 NACRE_FORMAT_*
 *       16    4  typeSize                 2 for RGB565 and RGBA16F, 4 for E5B9G9R9, else 1
 *       20    4  pixelWidth               1..4096 texels
 *       24    4  pixelHeight              1..4096 texels; equal to the width if there are 6 faces
 *       28    4  pixelDepth               0: slices of 3D data are stored as layers, GLES 2 has no 3D textures
 *       32    4  layerCount               0..64; 0 means one layer, and no array texture
 *       36    4  faceCount                1, or 6: +X -X +Y -Y +Z -Z
 *       40    4  levelCount               1..12 and at most the number of halvings to 1 texel, plus 1; may be fewer
 *       44    4  supercompressionScheme   0
 *       48    4  dfdByteOffset            80 + 24 levelCount
 *       52    4  dfdByteLength            44..108, a multiple of 4
 *       56    4  kvdByteOffset            dfdByteOffset + dfdByteLength; 0 if there are no keys
 *       60    4  kvdByteLength            a multiple of 4
 *       64    8  sgdByteOffset            0
 *       72    8  sgdByteLength            0
 *
 * Level index, 24 bytes a level, level 0 (the largest) first
 *
 *        0    8  byteOffset               where the level begins, see below; upper 4 bytes 0
 *        8    8  byteLength               layers x faces x bytes of one image; upper 4 bytes 0
 *       16    8  uncompressedByteLength   the same
 *
 * Data format descriptor: its size (u32, equal to dfdByteLength), then one basic block of the Khronos Data Format
 * Specification that says the same as vkFormat, BT.709 primaries, straight alpha, and in its byte 14 the transfer
 * function: 1 linear, or 2 where texels hold sRGB codes. The runtime looks at the size alone.
 *
 * Keys, sorted by code point, none twice. One entry: u32 length of name, NUL and value; name; NUL; value; zeros up to a
 * multiple of 4. Numbers are u32, or q16 (signed, 65536 = 1.0); the length of such a key's name with its NUL is a
 * multiple of 4, as KTX2 demands, so that they are aligned in the file (hence "asset_version" and not "version"). The
 * runtime reads them at any alignment. Texts are ASCII and end with NUL. Unknown keys are ignored.
 *
 * Level data. Levels are stored smallest first. Each begins after zeros up to the next multiple of lcm(texel or block
 * bytes, 4): 12 for RGB8, 8 for RGBA16F and ETC2, else 4. Level i has max(1, width >> i) x max(1, height >> i) texels;
 * images follow each other by layer, then face; rows run from the top (KTXorientation "rd"), left to right, and are
 * tight: glPixelStorei(GL_UNPACK_ALIGNMENT, 1). ETC2 images are whole blocks of 4 x 4 texels, 8 bytes each. The file
 * ends with the last byte of level 0. It is at most NACRE_MAX_FILE_BYTES long.
 *
 * Results. Anything cut off, or a number that contradicts another one, is NACRE_ERR_ASSET. A format, size, depth, layer
 * or level count, supercompression or nacre.asset_version outside the above is NACRE_ERR_UNSUPPORTED.
 *
 * The smallest file nacre writes: one R8 texel (0x95), 229 bytes.
 *
 *   00  ab 4b 54 58 20 32 30 bb 0d 0a 1a 0a 09 00 00 00   identifier; vkFormat 9 = R8
 *   10  01 00 00 00 01 00 00 00 01 00 00 00 00 00 00 00   typeSize 1; 1 x 1 x 0
 *   20  00 00 00 00 01 00 00 00 01 00 00 00 00 00 00 00   no array; 1 face; 1 level; no supercompression
 *   30  68 00 00 00 2c 00 00 00 94 00 00 00 50 00 00 00   descriptor: 44 bytes at 0x68; keys: 80 at 0x94
 *   40  00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00   no supercompression data
 *   50  e4 00 00 00 00 00 00 00 01 00 00 00 00 00 00 00   level 0: at 0xe4, 1 byte
 *   60  01 00 00 00 00 00 00 00 2c 00 00 00 00 00 00 00   the same uncompressed | descriptor: 44 bytes; Khronos, basic
 *   70  02 00 28 00 01 01 01 00 00 00 00 00 01 00 00 00   version 2, 40 bytes; RGB, BT.709, linear; 1 byte a texel
 *   80  00 00 00 00 00 00 07 00 00 00 00 00 00 00 00 00   one sample: bits 0..7, red; 0 ..
 *   90  ff 00 00 00 12 00 00 00 4b 54 58 6f 72 69 65 6e   .. 255 | 18 bytes: KTXorien
 *   a0  74 61 74 69 6f 6e 00 72 64 00 00 00 16 00 00 00   tation, rd, 2 zeros; 22 bytes:
 *   b0  4b 54 58 77 72 69 74 65 72 00 6e 61 63 72 65 20   KTXwriter, nacre
 *   c0  30 2e 31 2e 30 00 00 00 18 00 00 00 6e 61 63 72   0.1.0, 2 zeros; 24 bytes: nacr
 *   d0  65 2e 61 73 73 65 74 5f 76 65 72 73 69 6f 6e 00   e.asset_version,
 *   e0  01 00 00 00 95                                    1 | the texel
 */
#ifndef NACRE_ASSET_H
#define NACRE_ASSET_H

#define NACRE_ASSET_VERSION 1

/* Limits of the profile. */
#define NACRE_MAX_TEXELS     4096
#define NACRE_MAX_LAYERS     64
#define NACRE_MAX_FILE_BYTES 0x7FFFFFFF

/* Texel formats: the vkFormat numbers of KTX2. */
#define NACRE_FORMAT_RGB565    4  /* R in bits 15..11 of a little-endian u16 */
#define NACRE_FORMAT_R8        9  /* GLES 2: LUMINANCE */
#define NACRE_FORMAT_RG8       16 /* GLES 2: LUMINANCE_ALPHA, sampled as .ra */
#define NACRE_FORMAT_RGB8      23
#define NACRE_FORMAT_RGBA8     37
#define NACRE_FORMAT_RGBA16F   97  /* GLES 3 only */
#define NACRE_FORMAT_E5BGR9    123 /* GLES 3 only */
#define NACRE_FORMAT_ETC2_RGB8 147 /* with key nacre.etc1_only: only ETC1 modes, so GLES 2 takes it too */

/* Keys of every file, next to KTXorientation ("rd") and KTXwriter. The role decides which others there are. Transfer:
   how a code y in 0..1 maps to its value: "root", "root4", "root4-lh", "srgb" or "linear", see the roles. */
#define NACRE_KEY_VERSION "nacre.asset_version" /* u32: NACRE_ASSET_VERSION; a file without it is a plain image */
#define NACRE_KEY_ROLE                                                                                                 \
    "nacre.role"                             /* text: "table", "spheres", "normal", "mask", "albedo",
                                                     "lobes", "power", "palette", "index"; none: a plain image */
#define NACRE_KEY_TRANSFER "nacre.transfer"  /* text, see above */
#define NACRE_KEY_NAME     "nacre.name"      /* text: the BRDF that was baked */
#define NACRE_KEY_ETC1     "nacre.etc1_only" /* u32: 1 = every ETC2 block is in a mode of ETC1 */
#define NACRE_KEY_ALBEDO   "nacre.white_sky" /* 3 q16, 0..1: hemispherical (white-sky) albedo, R G B */

/* role "table" (TABLE model). One layer (default, RGB tier) or two (fine tier), RGBA8, one level, transfer "root":
   (Ymax y)^p = pi E f_r l.h. With a = n.l - n.v, R G B A of the first layer and T of the second, filtered, 0..1:

     one layer           y = RGB + (A - 1/2) a^2 W
     two layers          y = RGB + A D + ((T.r - 1/2) W + (T.g - 1/2) V) a^2 + (T.b - 1/2) K2 |a| + (T.a - 1/2) K4 a^4
     two layers, early   y = RGB + (T.rgb - 1/2) K1 a^2 + (A - 1/2) K2 |a|

   Rows run over s = sqrt(1 - l.h): v = (1 - B) s + B s^2; columns over t = 1 - n.h: u = log2(t/eps + 1) / log2(1/eps + 1);
   both end-aligned (texel centres of the first and last texel are 0 and 1). The key's numbers: E, Ymax, W.r, W.g, W.b, p,
   eps, K1, K2; with one layer B follows; with two layers B, D.r, D.g, D.b, V.r, V.g, V.b, K4. Files of nine numbers, from
   before B was a number, have B = 0.3, and with two layers are the early ones. Ranges: -1 <= B <= 1, 0 <= D <= 6.5,
   |V| <= 64, 0 <= K4 <= 64. */
#define NACRE_KEY_TABLE "nacre.table" /* 10 q16 (one layer), 17 (two), 9 (early) */
/* Shaders that turn y^4.8 into sRGB at once leave the curve's linear toe out, which is at most 2.7 codes of 255 and, but for
   dark materials, costs nothing. With this key they draw it. */
#define NACRE_KEY_TOE "nacre.keeps_toe" /* u32: 1 = as above; 0 or no such key: without the toe */

/* role "spheres" (SPHERES model). One layer per light polar angle; a unit sphere seen along -z from +z, the light at
   (sin polar, 0, cos polar); image row 0 is the top (+y). The disc of the sphere has radius disc/2 of the image's
   width, centred; texels beyond it repeat the rim. Transfer "root4": pi f_r = scale y^4 per channel, without the
   cosine; "srgb": y = sRGB(min(pi E f_r n.l, 1)), scale holds E. */
#define NACRE_KEY_LIGHT_POLAR "nacre.polar_bam" /* u32 per layer: polar angle in bam (32768 = 180 degrees), rising */
#define NACRE_KEY_COSINE      "nacre.cosine_in" /* u32: 1 = the cosine n.l is in the image (paper mode), 0 = not */
#define NACRE_KEY_SCALE       "nacre.scale"     /* 3 q16: R G B */
#define NACRE_KEY_DISC        "nacre.disc_size" /* q16: disc diameter / image width, 0.5..1; 1 = not padded */

/* role "spheres" with nacre.quartered = 1: each image is the quarter x, y >= 0 of a sphere centred on the half vector, one
   level, 2..16 layers. With d the direction of l - v and h the half vector, x = |n.d| and y = |n.(h x d)|: an isotropic,
   reciprocal and mirror-symmetric BRDF is the same in all four quarters. Columns run over u = log2(8 x + 1) / log2(9), rows
   from the top over the same of y; both end-aligned. Transfer "root4-lh": pi f_r l.h = scale code^4. Between layers codes
   are blended linearly in s = sqrt(1 - l.h), l.h = cos(polar / 2); below the first and beyond the last layer it stands
   alone. No nacre.disc_size. */
#define NACRE_KEY_QUARTERS "nacre.quartered" /* u32: 1 = as above; 0 or no such key: whole spheres */

/* role "normal" (any model). RGB8 or RGBA8, one layer, transfer "linear": x y z = 2 code/255 - 1 in tangent space, +y up
   the v axis. */

/* role "mask" (any model, drawn by lit spheres). R8, RG8, RGB8 or RGBA8, one layer, transfer "linear": the first channel
   is how much of the second lit sphere shows, alpha (RG8: the second channel; R8, RGB8: 1) what is written to alpha. */

/* roles "albedo" and "lobes" (SBRDF model): every texel its own Lafortune BRDF (McAllister et al. 2002). Both RGBA8, of one
   size and as many levels, transfer "linear". With l and v in the frame of tangent, bitangent and normal,

     pi f_r = albedo + sum over lobes of lobe albedo x max(Cx lx vx + Cy ly vy + Cz lz vz, 0)^n

   "albedo": one layer; RGB diffuse albedo = most code/255, A opacity (255: opaque). "lobes": two layers a lobe, 2 j and
   2 j + 1. Layer 2 j: RGB lobe albedo = most[j] code/255. Layer 2 j + 1: RGB Cx Cy Cz = shape[j] (code - 128)/127,
   exact at 0 and +-shape[j]; A the exponent, n = 255 (code/255)^2. The sum does not exceed 1 for any pair of directions
   (max(|Cx|, |Cy|, Cz) <= 1): what is above 1 at grazing angles is in the lobe albedo, whose most[j] goes up to 32767.

   With nacre.direction, the direction of anisotropy d = (x, y) of a texel, shared by its lobes, is in the alphas of layers
   0 and 2, (code - 128)/127, to be normalised; l and v are then taken along d, across it (-y, x), and along the normal. A
   file of one lobe has a third layer for it, black. Without nacre.direction these alphas are 255.

   Levels below the first are fits to the mean reflectance of the texels they cover, not means of parameters. */
#define NACRE_KEY_MOST      "nacre.max_value" /* albedo: 1 q16, lobes: 1 q16 a lobe; above 0 */
#define NACRE_KEY_LOBES     "nacre.lobes"     /* lobes: u32, 1..3 */
#define NACRE_KEY_SHAPE     "nacre.shape_max" /* lobes: 1 q16 a lobe, 1..2 */
#define NACRE_KEY_DIRECTION "nacre.direction" /* lobes: u32, 1 = the alphas hold the direction of anisotropy; else 0 */
#define NACRE_MAX_LOBES     3
#define NACRE_CODE_ZERO     128 /* code of C = 0 and direction 0 */
#define NACRE_CODE_STEPS    127 /* codes from there to shape[j], and to 1 */
#define NACRE_EXPONENT_MOST 255

/* role "power" (SBRDF model): x^n for 0 <= x <= 1, to be filtered linearly. R8, one layer, one level, transfer "root": x^n is
   the square of what is filtered, so that tails of highlights are as smooth as display codes. Column i of W is x' = x^2 = (i + 1/2)/(W - 1/2), so that
   u = x' (W - 1/2)/W; row j of H is n' = (j + 1/2)/H, n = 255 n'^2, so that v is the exponent's code/255 as it is sampled.
   Values lie a little below the root's, half of what a chord lies above it; x = 1 and 0 are
   exact; for n below 3, x below 0.08 is not as near. */

/* roles "palette" and "index" (PALETTE model): every texel of a surface one of up to 256 half-vector tables, each as in role
   "table" with one layer and p = 4.

   "palette": RGBA8, one layer, one level, transfer "root". The tables have one size and share the ten numbers of nacre.table
   (so that a light's place in them is one for all). They stand in tiles, row after row, table i in column i mod columns of
   tiles and row i / columns. A tile, of w + 2 x h + 4 texels for tables of w x h, from its top:

     one row, the table's first again | h rows | one row, the last again | two rows of one colour

   with a column at either side that repeats the first and last one: a coordinate that fp16 rounds by up to half a texel never
   meets a neighbour. The two rows hold the square root of the table's white-sky albedo, A 255, read between them. Tiles that
   no table needs are black. The image is columns x (w + 2) texels wide and as high as its rows of tiles. nacre.white_sky is
   the mean over the texels of the map that it was baked with.

   "index": R8, one layer, any levels: the table's number, below the palette's count in every texel of every level. Smaller
   levels hold the table that comes nearest to the mean of what they cover, no means of numbers. */
#define NACRE_KEY_TILES "nacre.tiles" /* palette: 4 u32: count 1..256, columns 1, 2, 4, 8 or 16, w and h, 4..128 */
#define NACRE_KEY_BLEND                                                                                                \
    "nacre.blend" /* index: u32, 1 = a place between four texels draws the bilinear mean of their y */
#define NACRE_MAX_PALETTE 256

#endif
