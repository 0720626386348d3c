// SPDX-License-Identifier: MIT
// Drawn by lit spheres: one fetch by the bisector of normal and eye, which is (n + z) / |n + z| in the sphere's frame. Its
// x and y are an equal-area map of the directions; the picture is 1.6 wide: normals up to 106 degrees from the eye.

uniform sampler2D u_map[1 + MIX];
#if NORMAL_MAP
uniform sampler2D u_normal_map;
#endif
#if MASK
uniform sampler2D u_mask;
#endif
#if ES3
out mediump vec4 o_color;
#define gl_FragColor o_color
#endif

void main()
{
#if MASK
    vec4 mask = texture2D(u_mask, v_uv);
#endif
#if NORMAL_MAP
    vec3 m = texture2D(u_normal_map, v_uv).rgb * 2.0 - 1.0;
    vec3 h = normalize(v_tangent * m.x + v_bitangent * m.y + v_normal * m.z) + vec3(0.0, 0.0, 1.0);
#else
    vec3 h = v_normal; // the vertex stage has added z
#endif
    vec2 at = normalize(h).xy * 0.625 + 0.5;
    vec3 color = texture2D(u_map[0], at).rgb;
#if MIX
    color = (texture2D(u_map[1], at).rgb - color) * mask.r + color; // a word less on Mali-450 than mix()
#endif
#if MASK
    gl_FragColor = vec4(color, mask.a);
#else
    gl_FragColor = vec4(color, 1.0);
#endif
}
