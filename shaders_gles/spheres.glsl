// SPDX-License-Identifier: MIT
// Sphere images of Mihalik & Durikovic 2015, one texture a light polar angle.
//
// Cosine-free: image i holds y with pi f_r = scale y^4. Turned about the plane of light and eye by half the difference
// of the polar angles (k = 1/2), half vector falls on half vector, so theta_half and phi_diff are exact. What remains is
// linear in n: the CPU gives rows. A normal past the rim (only towards the light, in the image of the larger angle)
// would fold back to the front; its x is pushed outwards by tan(difference / 4) x its depth, where the padding repeats
// the rim.
//
// Quarters: all images in one texture, one below the other, each the quarter x, y >= 0 about the half vector; see
// include/nacre_asset.h. Neighbouring images are read at the same place: it depends on x and y alone. A light alone has its
// own frame, where n.x and n.y are that already.
//
// Paper: eq. 1-4 with the cosine in the image, k from eq. 3 as sin(alpha_h), 0.995 of section 4, and the tail.

#if QUARTER && PERSP
uniform sampler2D u_map[1];
uniform HIGHP vec4 u_light[LIGHTS]; // r = xyz - w P points to the light
uniform vec4 u_factor[LIGHTS];
uniform HIGHP vec4 u_eye[1];        // v ~ xyz - w P
// [0] scale and bias of u and v  [1].x from image to image  [2 + 2 i] s + [3 + 2 i], clamped: parts of the image's number
uniform vec4 u_model[2 + 2 * LAYERS];
#elif QUARTER && LIGHTS
// u_near, u_far: fourth root of the factor, x the weight of either image
uniform sampler2D u_map[1];
uniform vec4 u_near[LIGHTS];
uniform vec4 u_far[LIGHTS];
#if LIGHTS == 1
// In the light's own frame, h = +z. u_scale, u_place: of u and v in either image; l.x in w of u_near, l.z of u_far.
uniform vec4 u_scale[1];
uniform vec4 u_place[1];
#else
// Rows of x, y, l. In w: bias of u and of v in the first image; of light 0's u_light, u_near, u_far: scale of u and of v, and
// from image to image.
uniform vec4 u_x[LIGHTS];
uniform vec4 u_y[LIGHTS];
uniform vec4 u_light[LIGHTS];
#endif
#elif PERSP
uniform sampler2D u_map[LAYERS];
uniform HIGHP vec4 u_light[LIGHTS]; // r = xyz - w P points to the light
uniform vec4 u_factor[LIGHTS];      // rgb; in w of the first disc / 2 (paper: x 0.995)
uniform HIGHP vec4 u_eye[1];        // v ~ xyz - w P
// for layers 0..3 and 4..7: [0] cos, [1] sin of half the polar angle and [2] rim, x disc / 2 (paper: [0] polar angle,
// [1].x the last one); [3] x polar + [4] is the weight of the next layer
#if LAYERS > 4
uniform vec4 u_model[10];
#else
uniform vec4 u_model[5];
#endif
#elif LIGHTS && PAPER
uniform sampler2D u_map[2 * LIGHTS];
uniform vec4 u_azimuth[LIGHTS]; // cos, sin of the azimuth; x, z of the half vector
uniform vec4 u_turn0[LIGHTS];   // (sin 1, sin 2, cos 1, cos 2) of k x difference = turn0 + s (turn1 + s turn2)
uniform vec4 u_turn1[LIGHTS];
uniform vec4 u_turn2[LIGHTS];
uniform vec4 u_bound[LIGHTS];   // rgb: linear light factor; disc / 2 x 0.995
uniform vec4 u_factor[LIGHTS];  // rgb, weight of the second layer
#elif LIGHTS
uniform sampler2D u_map[2 * LIGHTS];
uniform vec4 u_x1[LIGHTS]; // rows: x in layer 1, x in layer 2, y, excess over the rim, l; texture coordinates minus 1/2
uniform vec4 u_x2[LIGHTS];
uniform vec4 u_y[LIGHTS];
uniform vec4 u_rim[LIGHTS];
uniform vec4 u_light[LIGHTS];
uniform vec4 u_factor[LIGHTS]; // rgb, weight of the second layer
#endif

#if LIGHTS && PAPER
// Encoded texel times light, as FORM says: sRGB at once (bound: the linear factor, right for dark codes), or linear.
vec3 paper_light(vec3 y, vec3 bound, vec3 factor)
{
#if FORM == FORM_SRGB
    vec3 color = (y + 0.055) * factor - 0.055; // the curve without its toe; the toe lies between these two bounds
    return max(min(color, y * max(bound, 1.0)), y * min(bound, 1.0));
#else
    vec3 power = exp2(log2((y + 0.055) * (1.0 / 1.055)) * 2.4);
    return mix(y * (1.0 / 12.92), power, step(0.04045, y)) * factor;
#endif
}
#elif LIGHTS && (PERSP || !QUARTER)
vec3 sphere_light(vec3 y, float cosine, vec3 factor)
{
    y *= y;
#if FORM == FORM_ROOT
    return y * (sqrt(max(cosine, 1.0e-7)) * factor);
#else
    factor *= max(cosine, 0.0);
#if PERSP
    factor = min(factor, 2048.0); // eight lights together stay below 16,384
#endif
    return y * y * factor;
#endif
}
#endif

#if QUARTER && PERSP
vec3 light(vec3 n, vec3 v, HIGHP vec4 place, vec3 factor)
{
    HIGHP vec3 r = place.xyz - place.w * v_position;
    HIGHP float inverse = inversesqrt(dot(r, r));
    vec3 l = r * inverse;
    float near = min(inverse, 16.0);
    // 16 (l - v), never shorter than 1/16: when the light is at the eye any direction across v will do
    vec3 d = (l - v) * 16.0 + vec3(v.z, 0.0, -v.x) * 0.0625;
    vec3 sum = l + v;
    float dd = dot(d, d);
    float id = inversesqrt(dd);
    float ss = max(dot(sum, sum), 0.0009765625);
    float is = inversesqrt(ss); // 1 / (2 l.h)
    d *= id;
    // sqrt(1 - l.h) = sin / sqrt(1 + l.h): no difference near the eye
    float s = dd * id * 0.03125 * inversesqrt(1.0 + 0.5 * ss * is);
    float image = dot(clamp(u_model[2] * s + u_model[3], 0.0, 1.0), vec4(1.0));
#if LAYERS > 1
    image += dot(clamp(u_model[4] * s + u_model[5], 0.0, 1.0), vec4(1.0));
#endif
#if LAYERS > 2
    image += dot(clamp(u_model[6] * s + u_model[7], 0.0, 1.0), vec4(1.0));
    image += dot(clamp(u_model[8] * s + u_model[9], 0.0, 1.0), vec4(1.0));
#endif
    float first = floor(image);
    vec2 xy = vec2(dot(n, d), dot(n, cross(sum, d)) * is);
    vec2 at = log2(abs(xy) + 0.125) * u_model[0].xy + u_model[0].zw;
    at.y += first * u_model[1].x;
    vec3 root = mix(texture2D(u_map[0], at).rgb, texture2D(u_map[0], vec2(at.x, at.y + u_model[1].x)).rgb, image - first);
    return sphere_light(root, dot(n, l) * is * near * near, factor);
}
#define LIGHT(i) light(n, v, u_light[i], u_factor[i].rgb)

#elif QUARTER && LIGHTS
// y: of either image x its weight and the fourth root of the factor, added up
vec3 quarter_light(vec3 y, float cosine)
{
#if FORM == FORM_ROOT
    return y * y * sqrt(max(cosine, 1.0e-7));
#else
    y *= y;
    return y * y * max(cosine, 0.0);
#endif
}

#if LIGHTS == 1
vec3 light(vec3 n, vec4 near, vec4 far, vec4 scale, vec4 place)
{
    vec4 at = log2(abs(n.xy) + 0.125).xyxy * scale + place;
    vec3 y = texture2D(u_map[0], at.xy).rgb * near.rgb + texture2D(u_map[0], at.zw).rgb * far.rgb;
    return quarter_light(y, n.x * near.w + n.z * far.w);
}
#define LIGHT(i) light(n, u_near[i], u_far[i], u_scale[i], u_place[i])
#else
vec3 light(vec3 n, vec4 x, vec4 y, vec3 to_light, vec3 near, vec3 far)
{
    vec2 p = log2(vec2(abs(dot(n, x.xyz)) + 0.125, abs(dot(n, y.xyz)) + 0.125));
    vec2 at = p * vec2(u_light[0].w, u_near[0].w) + vec2(x.w, y.w);
    vec3 first = texture2D(u_map[0], at).rgb, second = texture2D(u_map[0], vec2(at.x, at.y + u_far[0].w)).rgb;
    return quarter_light(first * near + second * far, dot(n, to_light));
}
#define LIGHT(i) light(n, u_x[i], u_y[i], u_light[i].xyz, u_near[i].rgb, u_far[i].rgb)
#endif

#elif PERSP
// Blend of the layers' texels at x (a value a layer) and y, by the light's polar angle (radians).
vec3 blend_layers(vec4 x0, vec4 x1, float y, float polar)
{
    vec4 t0 = clamp(u_model[3] * polar + u_model[4], 0.0, 1.0);
    vec3 sum = texture2D(u_map[0], vec2(x0.x, y)).rgb;
    sum = mix(sum, texture2D(u_map[1], vec2(x0.y, y)).rgb, t0.x);
#if LAYERS > 2
    sum = mix(sum, texture2D(u_map[2], vec2(x0.z, y)).rgb, t0.y);
    sum = mix(sum, texture2D(u_map[3], vec2(x0.w, y)).rgb, t0.z);
#endif
#if LAYERS > 4
    vec4 t1 = clamp(u_model[8] * polar + u_model[9], 0.0, 1.0);
    sum = mix(sum, texture2D(u_map[4], vec2(x1.x, y)).rgb, t0.w);
    sum = mix(sum, texture2D(u_map[5], vec2(x1.y, y)).rgb, t1.x);
#endif
#if LAYERS > 6
    sum = mix(sum, texture2D(u_map[6], vec2(x1.z, y)).rgb, t1.y);
    sum = mix(sum, texture2D(u_map[7], vec2(x1.w, y)).rgb, t1.z);
#endif
    return sum;
}

// 2 asin(s), s in 0..1: Abramowitz & Stegun 4.4.45, worst 1.4e-4.
float twice_asin(float s)
{
    float p = 1.5707288 + s * (-0.2121144 + s * (0.0742610 - 0.0187293 * s));
    return 3.1415927 - 2.0 * sqrt(max(1.0 - s, 0.0)) * p;
}

#if PAPER
vec4 paper_x(vec4 turn, float x, float z, float radius)
{
    vec4 s = sin(turn);
    vec4 c = cos(turn);
    vec4 across = x * c + z * s;
    // past the rim (z < 0): the rim at the same y
    return mix(across, sign(across) * radius, step(z * c, x * s)) * u_factor[0].w + 0.5;
}
#else
vec4 half_x(vec4 c, vec4 s, vec4 rim, float along, float middle)
{
    return along * c + middle * s + max(along * s - middle * c, 0.0) * rim + 0.5;
}
#endif

vec3 light(vec3 n, vec3 v, HIGHP vec4 place, vec3 factor)
{
    HIGHP vec3 r = place.xyz - place.w * v_position;
    HIGHP float inverse = inversesqrt(dot(r, r));
    vec3 l = r * inverse;
    float near = min(inverse, 16.0);
    // 16 (l - v), never shorter than 1/16: when the light is at the eye any direction across v will do
    vec3 d = (l - v) * 16.0 + vec3(v.z, 0.0, -v.x) * 0.0625;
    float dd = dot(d, d);
    float id = inversesqrt(dd);
    float polar = twice_asin(min(dd * id * 0.03125, 1.0));
#if PAPER
    d -= v * dot(d, v);
    d *= inversesqrt(max(dot(d, d), 0.00006103516));
    float x = dot(n, d);
    float y = dot(n, cross(v, d));
    float z = dot(n, v);
    vec3 sum = l + v;
    vec2 h = vec2(dot(sum, d), dot(sum, v)) * inversesqrt(max(dot(sum, sum), 0.0009765625));
    float across = max(1.0 - y * y, 0.0009765625);
    float i = inversesqrt(across);
    // eq. 3; beyond the last layer 3/4 (section 3)
    float k = mix(0.5 + 0.5 * abs(h.x * z - h.y * x) * i, 0.75, step(u_model[1].x, polar));
    float radius = across * i;
    vec4 x0 = paper_x((u_model[0] - polar) * k, x, z, radius);
    vec4 x1 = x0;
#if LAYERS > 4
    x1 = paper_x((u_model[5] - polar) * k, x, z, radius);
#endif
    vec3 texel = blend_layers(x0, x1, y * u_factor[0].w + 0.5, polar);
    return paper_light(texel, vec3(1.0), min(factor * (near * near), 2048.0));
#else
    vec3 sum = l + v;
    vec3 h = sum * inversesqrt(max(dot(sum, sum), 0.0009765625));
    d *= id;
    float along = dot(n, d);
    float middle = dot(n, h);
    vec4 x0 = half_x(u_model[0], u_model[1], u_model[2], along, middle);
    vec4 x1 = x0;
#if LAYERS > 4
    x1 = half_x(u_model[5], u_model[6], u_model[7], along, middle);
#endif
    float y = dot(n, cross(h, d)) * u_factor[0].w + 0.5;
    return sphere_light(blend_layers(x0, x1, y, polar), dot(n, l) * near * near, factor);
#endif
}
#define LIGHT(i) light(n, v, u_light[i], u_factor[i].rgb)

#elif LIGHTS && PAPER
vec3 light(vec3 n, sampler2D map1, sampler2D map2, vec4 azimuth, vec4 turn0, vec4 turn1, vec4 turn2, vec4 bound,
           vec4 factor)
{
    float x = dot(n.xy, azimuth.xy);
    float y = n.y * azimuth.x - n.x * azimuth.y;
    float across = max(1.0 - y * y, 0.0009765625);
    float i = inversesqrt(across);
    float s = abs(azimuth.z * n.z - azimuth.w * x) * i; // sin(alpha_h), eq. 3
    vec4 turn = turn0 + s * (turn1 + s * turn2);
    vec2 at = x * turn.zw + n.z * turn.xy;
    vec2 depth = n.z * turn.zw - x * turn.xy;
    at = mix(at, sign(at) * (across * i), step(depth, vec2(0.0))) * bound.w + 0.5; // past the rim: the rim
    y = y * bound.w + 0.5;
    vec3 texel = mix(texture2D(map1, vec2(at.x, y)).rgb, texture2D(map2, vec2(at.y, y)).rgb, factor.w);
    return paper_light(texel, bound.rgb, factor.rgb);
}
#define LIGHT(i) light(n, u_map[2 * i], u_map[2 * i + 1], u_azimuth[i], u_turn0[i], u_turn1[i], u_turn2[i], u_bound[i], u_factor[i])

#elif LIGHTS
vec3 light(vec3 n, sampler2D map1, sampler2D map2, vec3 x1, vec3 x2, vec3 y, vec3 rim, vec3 to_light, vec4 factor)
{
    vec3 at = vec3(dot(n, x1), dot(n, x2) + max(dot(n, rim), 0.0), dot(n, y)) + 0.5;
    vec3 root = mix(texture2D(map1, at.xz).rgb, texture2D(map2, at.yz).rgb, factor.w);
    return sphere_light(root, dot(n, to_light), factor.rgb);
}
#define LIGHT(i) light(n, u_map[2 * i], u_map[2 * i + 1], u_x1[i].xyz, u_x2[i].xyz, u_y[i].xyz, u_rim[i].xyz, u_light[i].xyz, u_factor[i])
#endif
