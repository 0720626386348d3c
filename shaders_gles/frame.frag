// SPDX-License-Identifier: MIT
// The frame around a model: normal, sum over lights, earlier passes, ambient, output curve.

#if NORMAL_MAP
uniform sampler2D u_normal_map;
#endif
#if AMBIENT
uniform vec4 u_ambient[1 + SBRDF]; // radiance; SBRDF: [1] x diffuse albedo besides
#endif
#if PASS
uniform HIGHP sampler2D u_sum_high;
uniform HIGHP sampler2D u_sum_low;
#endif
#if PASS == PASS_SUM && !ES3
uniform vec4 u_byte[1]; // 1 0: write the high byte, 0 1: the low one
#endif
#if PASS == PASS_SUM && ES3
layout(location = 0) out mediump vec4 o_color; // high bytes
layout(location = 1) out mediump vec4 o_low;
#elif ES3
out mediump vec4 o_color;
#endif
#if ES3
#define gl_FragColor o_color
#endif

UNIT vec3 surface_normal()
{
#if SPHERE
    HIGHP float r = min(dot(v_at, v_at), 1.0);
    return normalize(v_normal * (2.0 * sqrt(1.0 - r)) + v_axis * (1.0 - 2.0 * r));
#elif NORMAL_MAP
    vec3 m = texture2D(u_normal_map, v_uv).rgb * 2.0 - 1.0;
    return normalize(v_tangent * m.x + v_bitangent * m.y + v_normal * m.z);
#else
    return normalize(v_normal);
#endif
}

// sRGB of s^2 for s in 0..1: 57.0 dB (worst frame 51.9) from the exact curve.
vec3 encode_root(vec3 s)
{
#if OUTPUT == OUTPUT_SRGB
    s = min(s, 1.0);
    return s * (s * (s * 0.1633 - 0.4481) + 1.3117) - 0.0263;
#else
    return s;
#endif
}

#if SBRDF
#define LIMITED(c) clamp(c, 0.0, 1.0)
#else
#define LIMITED(c) min(c, 1.0)
#endif

vec3 encode(vec3 radiance)
{
#if OUTPUT == OUTPUT_LINEAR
    return radiance;
#elif OUTPUT == OUTPUT_SRGB && SPHERE
    // Texels are few: the exact curve. 2^-14 is the smallest normal number of fp16.
    vec3 curve = exp2(log2(clamp(radiance, 0.00006103516, 1.0)) * (1.0 / 2.4)) * 1.055 - 0.055;
    return mix(max(radiance, 0.0) * 12.92, curve, step(0.0031308, radiance));
#else
    return encode_root(sqrt(LIMITED(radiance)));
#endif
}

void main()
{
#if PALETTE
    find_tiles();
#endif
#if LIGHTS && !OWN_FRAME
    UNIT vec3 n = surface_normal();
#if PERSP
    UNIT vec3 v = normalize(u_eye[0].xyz - u_eye[0].w * v_position);
#endif
#if SBRDF
#if PERSP
    surface(n, v);
#else
    surface(n, vec3(0.0, 0.0, 1.0));
#endif
#endif
#elif SBRDF && !LIGHTS
    g_albedo = texture2D(u_map[0], v_uv);
#endif
#if FORM == FORM_SRGB
    vec3 color = LIGHT(0);
#elif FORM == FORM_ROOT
    vec3 color = encode_root(LIGHT(0));
#else
#if PASS
    // 16 bits, k / 65535 with k = 256 high + low.
    HIGHP vec3 sum = texture2DProj(u_sum_high, v_screen).rgb * (65280.0 / 65535.0);
    sum += texture2DProj(u_sum_low, v_screen).rgb * (255.0 / 65535.0);
#else
    vec3 sum = vec3(0.0);
#endif
#if AMBIENT && PALETTE
    vec3 root = palette_texel(vec2(0.5 * u_tiles[0].x, u_tiles[0].w)).rgb;
    sum += u_ambient[0].rgb * root * root;
#elif AMBIENT && !SBRDF
    sum += u_ambient[0].rgb;
#endif
#if LIGHTS > 0
    sum += LIGHT(0);
#endif
#if LIGHTS > 1
    sum += LIGHT(1);
#endif
#if LIGHTS > 2
    sum += LIGHT(2);
#endif
#if LIGHTS > 3
    sum += LIGHT(3);
#endif
#if LIGHTS > 4
    sum += LIGHT(4);
#endif
#if LIGHTS > 5
    sum += LIGHT(5);
#endif
#if LIGHTS > 6
    sum += LIGHT(6);
#endif
#if LIGHTS > 7
    sum += LIGHT(7);
#endif
#if AMBIENT && SBRDF
    sum += u_ambient[0].rgb + u_ambient[1].rgb * g_albedo.rgb;
#endif
#if PASS == PASS_SUM
    HIGHP vec3 steps = min(sum, 1.0) * (65535.0 / 256.0) + 0.5 / 256.0; // nearest k, / 256
    HIGHP vec3 high = min(floor(steps), 255.0);
    HIGHP vec3 low = floor((steps - high) * 256.0);
#if ES3
    vec3 color = high * (1.0 / 255.0);
    o_low = vec4(low * (1.0 / 255.0), 1.0);
#else
    vec3 color = (high * u_byte[0].x + low * u_byte[0].y) * (1.0 / 255.0);
#endif
#elif PASS == PASS_LAST && OUTPUT == OUTPUT_LINEAR
    vec3 color = 16.0 * sum;
#else
    vec3 color = encode(sum);
#endif
#endif
#if SBRDF && PASS != PASS_SUM
    gl_FragColor = vec4(color, g_albedo.a);
#else
    gl_FragColor = vec4(color, 1.0);
#endif
}
