/* SPDX-License-Identifier: MIT */
/* Meshes: memory, names, and the normals and tangents that files leave out. */
#include "mesh.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "mesh_inner.h"
#include "vec3.h"

mesh mesh_make(const char *name, int vertex_count, int index_count)
{
    mesh m = {.vertex_count = vertex_count, .index_count = index_count};
    size_t vertices = (size_t)vertex_count;
    m.position = need_memory(vertices, sizeof *m.position);
    m.normal = need_memory(vertices, sizeof *m.normal);
    m.tangent = need_memory(vertices, sizeof *m.tangent);
    m.uv = need_memory(vertices, sizeof *m.uv);
    m.index = need_memory((size_t)index_count, sizeof *m.index);
    snprintf(m.name, sizeof m.name, "%s", name);
    return m;
}

void mesh_free(mesh *m)
{
    free(m->position);
    free(m->normal);
    free(m->tangent);
    free(m->uv);
    free(m->index);
    *m = (mesh){0};
}

void mesh_bounds(const mesh *m, float centre[3], float half_extent[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int i = 0; i < m->vertex_count; i++) {
            lo = fmin(lo, (double)m->position[i][axis]);
            hi = fmax(hi, (double)m->position[i][axis]);
        }
        centre[axis] = lo <= hi ? (float)(0.5 * (lo + hi)) : 0;
        half_extent[axis] = lo <= hi ? (float)(0.5 * (hi - lo)) : 0;
    }
}

/* ---- vectors in double: sums over many small triangles ------------------------------------ */

static void subtract(double out[3], const float a[3], const float b[3])
{
    for (int i = 0; i < 3; i++) out[i] = (double)a[i] - (double)b[i];
}

int mesh_direction(double v[3])
{
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(largest > 0 && largest < INFINITY)) return 0;
    for (int i = 0; i < 3; i++) v[i] /= largest; /* squares of tiny edges would be 0 */
    double length = sqrt(dot3(v, v));
    for (int i = 0; i < 3; i++) v[i] /= length;
    return 1;
}

/* ---- missing normals ---------------------------------------------------------------------- */

/* Vertices at the same place, whatever their uv, share one normal: group[i] is the first of them. */
static uint32_t *group_by_position(const mesh *m)
{
    size_t slots = 16;
    while (slots < 2 * (size_t)m->vertex_count) slots *= 2;
    int32_t *table = need_memory(slots, sizeof *table);
    uint32_t *group = need_memory((size_t)m->vertex_count, sizeof *group);
    memset(table, -1, slots * sizeof *table);
    for (int i = 0; i < m->vertex_count; i++) {
        float key[3];
        uint32_t word[3];
        for (int k = 0; k < 3; k++) key[k] = m->position[i][k] + 0.0f; /* -0 and 0 are one place */
        memcpy(word, key, sizeof word);
        uint64_t hash =
            (word[0] * 0x9E3779B97F4A7C15u) ^ (word[1] * 0xC2B2AE3D27D4EB4Fu) ^ (word[2] * 0x165667B19E3779F9u);
        size_t at = (size_t)(hash ^ hash >> 29) & (slots - 1);
        while (table[at] >= 0) {
            const float *other = m->position[table[at]];
            if (other[0] == key[0] && other[1] == key[1] && other[2] == key[2]) break;
            at = (at + 1) & (slots - 1);
        }
        if (table[at] < 0) table[at] = i;
        group[i] = (uint32_t)table[at];
    }
    free(table);
    return group;
}

/* The weights are the triangles' angles at the vertex (Thuermer & Wuethrich 1998), so that the mean does not depend on
   how faces are cut into triangles. */
void mesh_make_normals(mesh *m, const uint8_t *known)
{
    uint32_t *group = group_by_position(m);
    double(*sum)[3] = need_memory((size_t)m->vertex_count, sizeof *sum);
    for (int t = 0; t < m->index_count; t += 3) {
        const uint32_t *corner = m->index + t;
        double edge[3][3], normal[3], back[3];
        for (int k = 0; k < 3; k++) subtract(edge[k], m->position[corner[(k + 1) % 3]], m->position[corner[k]]);
        if (!mesh_direction(edge[0]) || !mesh_direction(edge[1]) || !mesh_direction(edge[2])) continue;
        cross3(normal, edge[0], edge[1]);
        if (dot3(normal, normal) < 1e-24 || !mesh_direction(normal)) continue;
        for (int k = 0; k < 3; k++) {
            for (int i = 0; i < 3; i++) back[i] = -edge[(k + 2) % 3][i];
            double angle = acos(fmin(fmax(dot3(edge[k], back), -1), 1));
            for (int i = 0; i < 3; i++) sum[group[corner[k]]][i] += angle * normal[i];
        }
    }
    for (int v = 0; v < m->vertex_count; v++) {
        if (known[v]) continue;
        double n[3] = {0, 0, 1}, s[3];
        memcpy(s, sum[group[v]], sizeof s);
        if (dot3(s, s) > 1e-20 && mesh_direction(s)) memcpy(n, s, sizeof n);
        for (int i = 0; i < 3; i++) m->normal[v][i] = (float)n[i];
    }
    free(group);
    free(sum);
}

/* ---- missing tangents --------------------------------------------------------------------- */

/* Direction of growing u in a triangle, and the sign of its uv area; 0 if uv has none. */
static double triangle_tangent(const mesh *m, const uint32_t *corner, double tangent[3])
{
    double e1[3], e2[3];
    subtract(e1, m->position[corner[1]], m->position[corner[0]]);
    subtract(e2, m->position[corner[2]], m->position[corner[0]]);
    const float *uv0 = m->uv[corner[0]], *uv1 = m->uv[corner[1]], *uv2 = m->uv[corner[2]];
    double u1 = (double)uv1[0] - (double)uv0[0], v1 = (double)uv1[1] - (double)uv0[1];
    double u2 = (double)uv2[0] - (double)uv0[0], v2 = (double)uv2[1] - (double)uv0[1];
    double area = u1 * v2 - u2 * v1;
    if (!(fabs(area) > 1e-20)) return 0;
    double sign = area > 0 ? 1 : -1;
    for (int i = 0; i < 3; i++) tangent[i] = sign * (e1[i] * v2 - e2[i] * v1);
    return mesh_direction(tangent) ? sign : 0;
}

/* Any unit vector perpendicular to n that changes little with n: x turned with n, or y near the x axis. */
static void fallback_tangent(const double n[3], double tangent[3])
{
    const double axis[3] = {fabs(n[0]) < 0.9, fabs(n[0]) >= 0.9, 0};
    double along = dot3(axis, n);
    for (int i = 0; i < 3; i++) tangent[i] = axis[i] - along * n[i];
    mesh_direction(tangent);
}

/* Weighted by corner angle as normals are. */
void mesh_make_tangents(mesh *m)
{
    double(*sum)[4] = need_memory((size_t)m->vertex_count, sizeof *sum);
    for (int t = 0; t < m->index_count; t += 3) {
        const uint32_t *corner = m->index + t;
        double tangent[3], to_next[3], to_last[3], sign = triangle_tangent(m, corner, tangent);
        if (sign == 0) continue;
        for (int k = 0; k < 3; k++) {
            subtract(to_next, m->position[corner[(k + 1) % 3]], m->position[corner[k]]);
            subtract(to_last, m->position[corner[(k + 2) % 3]], m->position[corner[k]]);
            if (!mesh_direction(to_next) || !mesh_direction(to_last)) continue;
            double angle = acos(fmin(fmax(dot3(to_next, to_last), -1), 1));
            for (int i = 0; i < 3; i++) sum[corner[k]][i] += angle * tangent[i];
            sum[corner[k]][3] += angle * sign;
        }
    }
    for (int v = 0; v < m->vertex_count; v++) {
        if (m->tangent[v][3] != 0) continue;
        double n[3] = {(double)m->normal[v][0], (double)m->normal[v][1], (double)m->normal[v][2]}, s[3];
        double along = dot3(sum[v], n);
        for (int i = 0; i < 3; i++) s[i] = sum[v][i] - along * n[i];
        if (!(dot3(s, s) > 1e-12) || !mesh_direction(s)) fallback_tangent(n, s);
        for (int i = 0; i < 3; i++) m->tangent[v][i] = (float)s[i];
        m->tangent[v][3] = sum[v][3] < 0 ? -1 : 1;
    }
    free(sum);
}

/* ---- names -------------------------------------------------------------------------------- */

static int is_mesh_suffix(const char *name)
{
    static const char *const known[] = {".obj", ".gltf", ".glb", ".ply", ".stl"};
    const char *suffix = strrchr(name, '.');
    for (size_t i = 0; suffix && i < sizeof known / sizeof *known; i++)
        if (!strcasecmp(suffix, known[i])) return 1;
    return 0;
}

static int check_file(const char *name, failure *f)
{
    FILE *file = fopen(name, "rb");
    if (!file) {
        int error = errno;
        if (error == ENOENT && !strpbrk(name, "./"))
            return fail(f, FAIL_IO, "%s: found no such file, expected one, or a built-in mesh: %s", name,
                        MESH_BUILTIN_NAMES);
        return fail(f, FAIL_IO, "%s: %s", name, strerror(error));
    }
    errno = 0;
    int first = getc(file), error = ferror(file) ? errno : 0;
    fclose(file);
    if (error) return fail(f, FAIL_IO, "%s: can't read: %s", name, strerror(error));
    if (!is_mesh_suffix(name))
        return fail(f, FAIL_UNSUPPORTED, "%s: expected a name that ends in .obj, .gltf, .glb, .ply or .stl", name);
    if (first == EOF) return fail(f, FAIL_INVALID, "%s: found an empty file, expected a mesh", name);
    return FAIL_NONE;
}

int mesh_open(mesh *out, const char *name, failure *f)
{
    if (mesh_builtin(out, name)) return FAIL_NONE;
    int code = check_file(name, f);
    if (code) return code;
    return mesh_import(out, name, f);
}
