// SPDX-License-Identifier: MIT
attribute vec3 a_position;
attribute vec3 a_normal;
#if NORMAL_MAP
attribute vec4 a_tangent;
attribute vec2 a_uv;
uniform mat3 u_tangent;
uniform vec4 u_uv;
#endif
uniform mat4 u_clip;
uniform vec4 u_extent; // w: -1 when the transform mirrors, else 1
uniform vec4 u_centre;
uniform mat3 u_normal;
#if PERSP
uniform mat4 u_view;
#endif

void main()
{
    vec4 p = vec4(a_position * u_extent.xyz + u_centre.xyz, 1.0);
    gl_Position = u_clip * p;
    v_normal = normalize(u_normal * a_normal);
#if NORMAL_MAP
    v_tangent = normalize(u_tangent * a_tangent.xyz);
    v_bitangent = cross(v_normal, v_tangent) * (sign(a_tangent.w) * u_extent.w);
    v_uv = a_uv * u_uv.xy + u_uv.zw;
#endif
#if PERSP
    v_position = (u_view * p).xyz;
#endif
#if PASS
    v_screen = vec3(0.5 * (gl_Position.xy + gl_Position.w), gl_Position.w);
#endif
}
