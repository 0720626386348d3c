// SPDX-License-Identifier: MIT
attribute vec3 a_position;
attribute vec3 a_normal;
#if FRAME || OWN_FRAME
attribute vec4 a_tangent;
uniform mat3 u_tangent;
#endif
#if NORMAL_MAP || MASK || SBRDF || PALETTE
attribute vec2 a_uv;
uniform vec4 u_uv;
#endif
uniform mat4 u_clip;
uniform vec4 u_extent; // w: -1 when the transform mirrors, else 1
uniform vec4 u_centre;
uniform mat3 u_normal;
#if PERSP
uniform mat4 u_view;
#endif
#if OWN_FRAME
uniform vec4 u_light[1]; // l
varying vec3 v_eye;
varying vec3 v_light;
#endif

void main()
{
#if SPHERE
    // The whole picture: place p holds the normal n with p = xy of (n + z) / |n + z|, so n = 2 sqrt(1 - |p|^2) (p, 0) +
    // (1 - 2 |p|^2) z. Both vectors are sent turned to where the lights are.
    v_at = a_position.xy * u_extent.x;
    v_normal = u_normal * vec3(v_at, 0.0);
    v_axis = u_normal[2];
    gl_Position = vec4(a_position.xy, 0.0, 1.0);
#else
    vec4 p = vec4(a_position * u_extent.xyz + u_centre.xyz, 1.0);
    gl_Position = u_clip * p;
    v_normal = normalize(u_normal * a_normal);
#if FRAME
    v_tangent = normalize(u_tangent * a_tangent.xyz);
    v_bitangent = cross(v_normal, v_tangent) * (sign(a_tangent.w) * u_extent.w);
#elif OWN_FRAME
    vec3 t = u_tangent * a_tangent.xyz;
    t = normalize(t - v_normal * dot(v_normal, t));
    vec3 b = cross(v_normal, t) * (sign(a_tangent.w) * u_extent.w);
    v_eye = vec3(t.z, b.z, v_normal.z);
    v_light = vec3(dot(t, u_light[0].xyz), dot(b, u_light[0].xyz), dot(v_normal, u_light[0].xyz));
#endif
#if NORMAL_MAP || MASK || SBRDF || PALETTE
    v_uv = a_uv * u_uv.xy + u_uv.zw;
#endif
#if PERSP
    v_position = (u_view * p).xyz;
#endif
#if LIT && !NORMAL_MAP
    v_normal.z += 1.0; // twice the bisector of normal and eye
#endif
#endif
#if PASS
    v_screen = vec3(0.5 * (gl_Position.xy + gl_Position.w), gl_Position.w);
#endif
}
