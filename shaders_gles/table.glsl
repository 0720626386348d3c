// SPDX-License-Identifier: MIT
// The half-vector table. One fetch (fine tier: two) gives y with (Ymax y)^p = pi E f_r l.h at
// u = log2(t / eps + 1), t = 1 - n.h, and v, a polynomial in sqrt(1 - l.h).
// t is taken as |n - h|^2 / 2: the subtraction 1 - n.h has no bits left near the peak in fp16.

#if PALETTE
// Every texel of the surface has a table of its own in a tile of the first map; the second one says which.
uniform sampler2D u_map[2];
// [0] 1 / columns, 1 / rows of tiles; from a tile's origin: u' of the last column, v' of the albedo
// BLEND: [1] size of the index map, 1 / size
uniform HIGHP vec4 u_tiles[1 + BLEND];
// Origins of the tiles, in highp where there is such: fp16 knows a quarter of a texel at 512.
#if BLEND
HIGHP vec4 g_tile_u, g_tile_v;
vec2 g_part; // how much of the right ones, and of the lower ones
#else
HIGHP float g_tile_u, g_tile_v;
#endif

void find_tiles()
{
#if BLEND
    HIGHP vec2 at = v_uv * u_tiles[1].xy - 0.5, low = floor(at);
    g_part = at - low;
    HIGHP vec4 near = (low.xyxy + vec4(0.5, 0.5, 1.5, 1.5)) * u_tiles[1].zwzw;
    vec4 code = vec4(texture2D(u_map[1], near.xy).r, texture2D(u_map[1], near.zy).r, texture2D(u_map[1], near.xw).r,
                     texture2D(u_map[1], near.zw).r);
    HIGHP vec4 tile = floor(code * 255.0 + 0.5) * u_tiles[0].x, row = floor(tile);
#else
    HIGHP float tile = floor(texture2D(u_map[1], v_uv).r * 255.0 + 0.5) * u_tiles[0].x, row = floor(tile);
#endif
    g_tile_u = tile - row;
    g_tile_v = row * u_tiles[0].y;
}

vec4 palette_texel(HIGHP vec2 at)
{
#if BLEND
    return mix(mix(texture2D(u_map[0], at + vec2(g_tile_u.x, g_tile_v.x)),
                   texture2D(u_map[0], at + vec2(g_tile_u.y, g_tile_v.y)), g_part.x),
               mix(texture2D(u_map[0], at + vec2(g_tile_u.z, g_tile_v.z)),
                   texture2D(u_map[0], at + vec2(g_tile_u.w, g_tile_v.w)), g_part.x),
               g_part.y);
#else
    return texture2D(u_map[0], at + vec2(g_tile_u, g_tile_v));
#endif
}
#elif LIGHTS
uniform sampler2D u_map[1 + FINE + EARLY];
#endif

#if PERSP
// u_light: r = xyz - w P points to the light; u_factor: rgb.
uniform HIGHP vec4 u_light[LIGHTS];
uniform vec4 u_factor[LIGHTS];
// [0] S, bias, 2 eps   [1] A, B, C of the row   then as below   eye: v ~ xyz - w P
uniform HIGHP vec4 u_eye[1];
uniform vec4 u_model[2 + PHID + 2 * FINE];
#define SCALE u_model[0].x
#define BIAS u_model[0].y
#define FIRST 2
#elif LIGHTS == 1
// In the frame where h = +z and l, v lie in the plane y = 0: n - h is then small and exact near the peak.
// u_half: l.z, 0, 1, sqrt(2 eps)   u_light: l (FORM_SRGB: 2^lift l), S   u_factor: rgb, row
// u_model: each term's share of (l.x - v.x)^n multiplied in
uniform vec4 u_half[1];
uniform vec4 u_light[1];
uniform vec4 u_factor[1];
uniform vec4 u_model[1 + 2 * FINE];
#define SCALE u_light[0].w
#define BIAS u_model[0].w
#define FIRST 0
#elif LIGHTS
// u_half: h, sqrt(2 eps)   u_light: l, S   u_factor: rgb, row
// u_model: [0] W (early: K1 and K2); fine: [0] D   [1] W, K2   [2] V, K4; without PERSP bias in w of [0]
uniform vec4 u_half[LIGHTS];
uniform vec4 u_light[LIGHTS];
uniform vec4 u_factor[LIGHTS];
uniform vec4 u_model[1 + 2 * FINE];
#define SCALE u_light[0].w
#define BIAS u_model[0].w
#define FIRST 0
#endif

#if LIGHTS
// Floor under logarithms: 2^-14, the smallest normal number of fp16. Where n.l itself stands there (FORM_SRGB), the CPU
// has multiplied it by 2^lift (PERSP: 2^6), or grazing lights of shiny materials would light the dark side.
#define DARK 0.00006103516

// q = |d|^2 + 2 eps, slope = n.l - n.v
vec3 table_root(float q, float slope, float row)
{
    vec2 at = vec2(log2(q) * SCALE + BIAS, row);
#if PALETTE
    at.x = min(at.x, u_tiles[0].z); // beyond 90 degrees: another tile
    vec4 t = palette_texel(at);
#else
    vec4 t = texture2D(u_map[0], at);
#endif
#if PHID && !FINE
    t -= vec4(0.0, 0.0, 0.0, 0.5);
#endif
#if FINE
    vec4 c = texture2D(u_map[1], at) - 0.5;
    float square = slope * slope;
    c.zw *= vec2(u_model[FIRST + 1].w, u_model[FIRST + 2].w * square);
    return u_model[FIRST].rgb * t.a + t.rgb + square * (u_model[FIRST + 1].rgb * c.x + (u_model[FIRST + 2].rgb * c.y + c.w)) +
           c.z * abs(slope);
#elif EARLY
    vec3 curve = texture2D(u_map[1], at).rgb - 0.5;
    return t.rgb + curve * (slope * slope * u_model[FIRST].x) + t.a * abs(slope) * u_model[FIRST].y;
#elif PHID
    return u_model[FIRST].rgb * (slope * slope * t.a) + t.rgb;
#else
    return t.rgb;
#endif
}

// factor y^p cosine in the form of FORM: linear, its root, or sRGB at once.
vec3 table_light(vec3 y, float cosine, vec3 factor)
{
#if FORM == FORM_SRGB
    vec3 color = y * y * (exp2(log2(max(cosine, DARK)) * (1.0 / 2.4)) * factor);
#if TOE
    // The toe as a parabola, 0.2 codes of 255 off at most: color - 0.055 + 5.75 min(color - 0.0985, 0)^2.
    vec3 below = color - 0.0985;
    return below * (min(below, 0.0) * 5.75 + 1.0) + 0.0435;
#else
    return color - 0.055;
#endif
#elif FORM == FORM_ROOT
    cosine = sqrt(max(cosine, 1.0e-7)); // as good as 0.0, and an instruction less on Adreno 220
#if POWER48
    return exp2(log2(max(y, DARK)) * 2.4) * (cosine * factor);
#else
    return y * y * (cosine * factor);
#endif
#else
    factor *= max(cosine, 0.0);
#if PERSP
    factor = min(factor, 2048.0); // eight lights together stay below 16,384
#endif
#if POWER48 && SPHERE && !FINE
    // Drivers that run on CPUs update pictures twice as fast so; GPUs have units for the other form. y is 0..1.
    y = max(y, 0.0);
    vec3 rest = y * (y * (y * 0.143254 - 0.430754) + 1.244381) + 0.042565; // y^0.8: worst 0.12 codes of 255
    y *= y;
    return y * y * (rest * factor);
#elif POWER48
    return exp2(log2(max(y, DARK)) * 4.8) * factor;
#else
    y *= y;
    return y * y * factor;
#endif
#endif
}

#if PERSP
vec3 light(UNIT vec3 n, UNIT vec3 v, HIGHP vec4 place, vec3 factor)
{
    HIGHP vec3 r = place.xyz - place.w * v_position;
    HIGHP float inverse = inversesqrt(dot(r, r));
    UNIT vec3 l = r * inverse;
#if FORM == FORM_SRGB
    float near = min(inverse, 128.0); // |r| is 1/8 at the centre of the mesh
#else
    float near = min(inverse, 16.0);  // 1
#endif
    UNIT vec3 sum = l + v;
    UNIT float i = inversesqrt(max(dot(sum, sum), 0.0009765625)); // 1 / (2 l.h), l.h >= 2^-6
    UNIT vec3 h = sum * i;
    UNIT vec3 d = n - h;
    UNIT float twice = dot(sum, sum) * i; // 2 l.h
    UNIT float away = max(1.0 - 0.5 * twice, 0.0);
    float nl = dot(n, l);
    float row = sqrt(away) * u_model[1].x + (away * u_model[1].y + u_model[1].z);
    float slope = min(abs(nl - dot(n, v)), twice); // no more where lit and seen; beyond, nothing bounds the phi_d term
    vec3 y = table_root(dot(d, d) + u_model[0].z, slope, row);
    return table_light(y, nl * i * near * near, factor);
}
#define LIGHT(i) light(n, v, u_light[i], u_factor[i].rgb)
#else
// The order of the first lines is the one that compiles to fewest words.
vec3 light(vec3 n, vec4 middle, vec3 to_light, vec4 factor, float limit)
{
    vec4 d = vec4(n, 0.0) - middle; // the constant sqrt(2 eps) in w comes along in the dot product
    float nl = dot(n, to_light);
#if LIGHTS == 1
    // (n.l - n.v) / (l.x - v.x): at most cos where lit and seen; beyond, nothing bounds the phi_d term
    float slope = min(abs(n.x), limit);
#else
    float slope = nl - n.z;
#endif
    return table_light(table_root(dot(d, d), slope, factor.w), nl, factor.rgb);
}
#if LIGHTS == 1
#define LIGHT(i) light(n, u_half[i].yyzw, u_light[i].xyz, u_factor[i], u_half[i].x)
#else
#define LIGHT(i) light(n, u_half[i], u_light[i].xyz, u_factor[i], 2.0)
#endif
#endif
#endif
