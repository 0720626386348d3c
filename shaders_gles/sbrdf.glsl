// SPDX-License-Identifier: MIT
// Every texel its own Lafortune BRDF (McAllister et al. 2002): pi f_r = albedo + sum of lobe albedo x max(x, 0)^n with
// x = Cx lx vx + Cy ly vy + Cz lz vz in the frame of tangent, bitangent and normal. Codes: nacre_asset.h.
// Units: diffuse albedo (DIFFUSE), then albedo and shape of each lobe; layers whose alphas hold the direction, where they
// are none of these (DIRECTION_X, DIRECTION_Y); the power table.

uniform sampler2D u_map[MAPS];
#if DIFFUSE
vec4 g_albedo;
#define FIRST 1
#else
#define FIRST 0
#endif

#if LIGHTS
// u_factor: rgb, of code 255 of the diffuse albedo
// u_model, one a lobe, where x = K times what codes 0..1 give, and w = its albedo relative to the diffuse one:
// 255 log2 K, log2 w; with a power table of W columns: K^2 (W - 1/2)/W, w
uniform vec4 u_factor[LIGHTS];
uniform vec4 u_model[LOBES];

#define ZERO vec4(vec3(0.5019608), 0.0) // code 128: C = 0

// Of the lobes: RGB albedo; xyz what is dotted with l to give x / K, exponent code.
vec3 g_lobe0;
vec4 g_shape0;
#if LOBES > 1
vec3 g_lobe1;
vec4 g_shape1;
#endif
#if LOBES > 2
vec3 g_lobe2;
vec4 g_shape2;
#endif

float power(float x, float exponent, vec4 model)
{
    x = clamp(x, 0.0, 1.0);
#if POWER_TABLE
    float y = texture2D(u_map[MAPS - 1], vec2(x * x * model.x, exponent)).r; // the table holds roots
    return y * y * model.y;
#else
    return exp2((exponent * exponent + 1.0e-6) * (log2(x) * 255.0 + model.x) + model.y); // 1.0e-6: 0^0 is no NaN
#endif
}

#if OWN_FRAME
// One directional light and one view direction: both come in the frame of the vertex, as in the paper.
varying vec3 v_eye;
varying vec3 v_light;
#else
#if PERSP
uniform HIGHP vec4 u_light[LIGHTS]; // r = xyz - w P points to the light, |r| = 1 at the centre of the mesh
uniform HIGHP vec4 u_eye[1];        // v ~ xyz - w P
#else
uniform vec4 u_light[LIGHTS]; // l
#endif
#endif

// Reflectance relative to code 255 of the diffuse albedo.
vec3 reflectance(UNIT vec3 l)
{
    vec3 sum = g_lobe0 * power(dot(g_shape0.xyz, l), g_shape0.w, u_model[0]);
#if DIFFUSE
    sum += g_albedo.rgb;
#endif
#if LOBES > 1
    sum += g_lobe1 * power(dot(g_shape1.xyz, l), g_shape1.w, u_model[1]);
#endif
#if LOBES > 2
    sum += g_lobe2 * power(dot(g_shape2.xyz, l), g_shape2.w, u_model[2]);
#endif
    return sum;
}

// Fetch the texel. Returns the direction of anisotropy: its x from tangent to bitangent.
vec2 texel()
{
#if DIFFUSE
    g_albedo = texture2D(u_map[0], v_uv);
#endif
    vec4 lobe = texture2D(u_map[FIRST], v_uv);
    vec2 direction = vec2(lobe.a, 0.0);
    g_lobe0 = lobe.rgb;
    g_shape0 = texture2D(u_map[FIRST + 1], v_uv) - ZERO;
#if LOBES > 1
    lobe = texture2D(u_map[FIRST + 2], v_uv);
    direction.y = lobe.a;
    g_lobe1 = lobe.rgb;
    g_shape1 = texture2D(u_map[FIRST + 3], v_uv) - ZERO;
#endif
#if LOBES > 2
    g_lobe2 = texture2D(u_map[FIRST + 4], v_uv).rgb;
    g_shape2 = texture2D(u_map[FIRST + 5], v_uv) - ZERO;
#endif
#if DIRECTION
#if DIRECTION_X
    direction.x = texture2D(u_map[DIRECTION_X], v_uv).a;
#endif
#if DIRECTION_Y
    direction.y = texture2D(u_map[DIRECTION_Y], v_uv).a;
#endif
    direction -= ZERO.xy;
    return direction * inversesqrt(max(dot(direction, direction), 0.0001));
#else
    return vec2(1.0, 0.0);
#endif
}

#if OWN_FRAME
#if DIRECTION
vec3 turned(vec3 a, vec2 d)
{
    return vec3(dot(a.xy, d), a.y * d.x - a.x * d.y, a.z);
}
#else
#define turned(a, d) a
#endif

vec3 own_light()
{
    vec2 d = texel();
    vec3 l = turned(normalize(v_light), d), eye = turned(normalize(v_eye), d);
    g_shape0.xyz *= eye;
#if LOBES > 1
    g_shape1.xyz *= eye;
#endif
#if LOBES > 2
    g_shape2.xyz *= eye;
#endif
    // Where one light is all, encode() keeps out what is below 0.
#if AMBIENT || OUTPUT == OUTPUT_LINEAR
    l.z = max(l.z, 0.0);
#endif
    return reflectance(l) * l.z * u_factor[0].rgb;
}
#define LIGHT(i) own_light()
#else

// The texel in the frame of this pixel's normal, seen from v.
void surface(UNIT vec3 n, UNIT vec3 v)
{
    UNIT vec3 t = normalize(v_tangent - n * dot(n, v_tangent)), b = cross(n, t);
    vec2 d = texel();
#if DIRECTION
    d.y *= sign(dot(b, v_bitangent));
    t = t * d.x + b * d.y;
    b = cross(n, t);
#endif
    UNIT vec3 eye = vec3(dot(t, v), dot(b, v), dot(n, v));
#define SHAPE(s) t * ((s).x * eye.x) + b * ((s).y * eye.y) + n * ((s).z * eye.z)
    g_shape0.xyz = SHAPE(g_shape0);
#if LOBES > 1
    g_shape1.xyz = SHAPE(g_shape1);
#endif
#if LOBES > 2
    g_shape2.xyz = SHAPE(g_shape2);
#endif
}

#if PERSP
vec3 light(UNIT vec3 n, HIGHP vec4 place, vec3 factor)
{
    HIGHP vec3 r = place.xyz - place.w * v_position;
    HIGHP float inverse = inversesqrt(dot(r, r));
    UNIT vec3 l = r * inverse;
    float near = min(inverse, 16.0);
    return reflectance(l) * min(factor * (max(dot(n, l), 0.0) * near * near), 2048.0);
}
#define LIGHT(i) light(n, u_light[i], u_factor[i].rgb)
#else
vec3 light(vec3 n, vec3 l, vec3 factor)
{
    return reflectance(l) * (factor * max(dot(n, l), 0.0));
}
#define LIGHT(i) light(n, u_light[i].xyz, u_factor[i].rgb)
#endif
#endif
#endif
