// SPDX-License-Identifier: MIT
// The frame around a model: normal, sum over lights, earlier passes, ambient, output curve.

#if NORMAL_MAP
uniform sampler2D u_normal_map;
#endif
#if AMBIENT
uniform vec4 u_ambient[1]; // radiance
#endif
#if PASS
uniform sampler2D u_sum_high;
uniform sampler2D u_sum_low;
#endif
#if ES3
out mediump vec4 o_color;
#define gl_FragColor o_color
#endif

UNIT vec3 surface_normal()
{
#if NORMAL_MAP
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

vec3 encode(vec3 radiance)
{
#if OUTPUT == OUTPUT_LINEAR
    return radiance;
#else
    return encode_root(sqrt(min(radiance, 1.0)));
#endif
}

void main()
{
#if LIGHTS
    UNIT vec3 n = surface_normal();
#if PERSP
    UNIT vec3 v = normalize(u_eye[0].xyz - u_eye[0].w * v_position);
#endif
#endif
#if FORM == FORM_SRGB
    vec3 color = LIGHT(0);
#elif FORM == FORM_ROOT
    vec3 color = encode_root(LIGHT(0));
#else
#if PASS
    // High byte floor(255 sum), low byte fract(204 sum). Two programs wrote them, and may have rounded the sum to different
    // sides of a whole number: because 204 is less than 255, the low byte still says which step is meant.
    HIGHP vec3 low = texture2DProj(u_sum_low, v_screen).rgb;
    HIGHP vec3 sum = (low + floor(texture2DProj(u_sum_high, v_screen).rgb * 204.0 + 0.9 - low)) * (1.0 / 204.0);
#else
    vec3 sum = vec3(0.0);
#endif
#if AMBIENT
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
#if PASS == PASS_SUM_HIGH
    vec3 color = floor(min(sum, 1.0) * 255.0) * (1.0 / 255.0);
#elif PASS == PASS_SUM_LOW
    vec3 color = fract(min(sum, 1.0) * 204.0);
#elif PASS == PASS_LAST && OUTPUT == OUTPUT_LINEAR
    vec3 color = 16.0 * sum;
#else
    vec3 color = encode(sum);
#endif
#endif
    gl_FragColor = vec4(color, 1.0);
}
