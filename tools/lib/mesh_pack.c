/* SPDX-License-Identifier: MIT */
/* The runtime's form of a mesh: 24-byte vertices and 16-bit indices, as C text or bytes for firmware. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mesh.h"

enum { MAX_PART_VERTICES = 65535, POSITION_ONE = 32767, UV_ONE = 2048 };

typedef struct q16_bounds {
    nacre_q16 centre[3], half_extent[3];
} q16_bounds;

/* A vertex as some corner uses it: textures repeat, so a triangle's uv may be shifted by whole numbers. */
typedef struct corner_vertex {
    uint32_t source;
    int32_t shift[2];
    int32_t next; /* of the same source, -1 at the end */
} corner_vertex;

/* Half extents are rounded up so that every position stays within -32767..32767, and never 0. */
static int find_bounds(const mesh *m, q16_bounds *out, failure *f)
{
    float centre[3], half[3];
    mesh_bounds(m, centre, half);
    for (int axis = 0; axis < 3; axis++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int i = 0; i < m->vertex_count; i++) {
            lo = fmin(lo, (double)m->position[i][axis]);
            hi = fmax(hi, (double)m->position[i][axis]);
        }
        double at = floor(0.5 * (lo + hi) * 65536 + 0.5);
        double reach = ceil(fmax(hi * 65536 - at, at - lo * 65536));
        if (!(fabs(at) + reach <= 2147483647.0))
            return fail(f, FAIL_UNSUPPORTED, "%s: found %c from %g to %g, expected within +-32767 (fixed point)",
                        m->name, 'x' + axis, lo, hi);
        out->centre[axis] = (nacre_q16)at;
        out->half_extent[axis] = reach < 1 ? 1 : (nacre_q16)reach;
    }
    return FAIL_NONE;
}

static int32_t nearest(double x)
{
    return (int32_t)floor(x + 0.5);
}

static int16_t snorm16(double x)
{
    return (int16_t)nearest(fmin(fmax(x, -1), 1) * POSITION_ONE);
}

static nacre_vertex pack_vertex(const mesh *m, const corner_vertex *from, const q16_bounds *bounds)
{
    nacre_vertex v = {{0}, {0}, {0}, {0}};
    uint32_t i = from->source;
    for (int axis = 0; axis < 3; axis++) {
        double offset = (double)m->position[i][axis] * 65536 - bounds->centre[axis];
        v.position[axis] = snorm16(offset / bounds->half_extent[axis]);
        v.normal[axis] = snorm16((double)m->normal[i][axis]);
        v.tangent[axis] = (int8_t)nearest(fmin(fmax((double)m->tangent[i][axis], -1), 1) * 127);
    }
    v.tangent[3] = m->tangent[i][3] < 0 ? -127 : 127;
    for (int axis = 0; axis < 2; axis++) {
        int32_t code = nearest(((double)m->uv[i][axis] + from->shift[axis]) * UV_ONE);
        v.uv[axis] = (int16_t)(code > 32767 ? 32767 : code); /* 16 itself becomes 15.9995 */
    }
    return v;
}

/* The whole number that brings lo..hi into -16..16: 0 where possible, then a multiple of 16 (neighbours mostly get
   the same and share vertices), then whatever fits. */
static int choose_shift(double lo, double hi, int32_t *shift)
{
    const double middle = 0.5 * (lo + hi);
    const double choice[3] = {0, -16 * floor(middle / 16 + 0.5), -floor(middle + 0.5)};
    for (int i = 0; i < 3; i++) {
        if (!(lo + choice[i] >= -16 && hi + choice[i] <= 16 && fabs(choice[i]) < 1e9)) continue;
        *shift = (int32_t)choice[i];
        return 1;
    }
    return 0;
}

/* For every corner the vertex it needs; *vertices grows by those that other shifts ask for. Returns their count, or
   -1 with the failure set. */
static int expand_corners(const mesh *m, corner_vertex *vertices, uint32_t *corner, failure *f)
{
    int count = m->vertex_count;
    for (int i = 0; i < count; i++) vertices[i] = (corner_vertex){.source = UINT32_MAX, .next = -1};
    for (int t = 0; t < m->index_count; t += 3) {
        int32_t shift[2];
        for (int axis = 0; axis < 2; axis++) {
            double lo = INFINITY, hi = -INFINITY;
            for (int k = 0; k < 3; k++) {
                lo = fmin(lo, (double)m->uv[m->index[t + k]][axis]);
                hi = fmax(hi, (double)m->uv[m->index[t + k]][axis]);
            }
            if (!choose_shift(lo, hi, &shift[axis])) {
                fail(f, FAIL_UNSUPPORTED,
                     "%s: triangle %d: found texture coordinate %c from %g to %g, expected at most "
                     "32 wide",
                     m->name, t / 3, 'u' + axis, lo, hi);
                return -1;
            }
        }
        for (int k = 0; k < 3; k++) {
            int32_t at = (int32_t)m->index[t + k], last = at;
            if (vertices[at].source == UINT32_MAX) {
                vertices[at] = (corner_vertex){(uint32_t)at, {shift[0], shift[1]}, -1};
            } else {
                while (at >= 0 && (vertices[at].shift[0] != shift[0] || vertices[at].shift[1] != shift[1])) {
                    last = at;
                    at = vertices[at].next;
                }
                if (at < 0) {
                    at = count++;
                    vertices[at] = (corner_vertex){m->index[t + k], {shift[0], shift[1]}, -1};
                    vertices[last].next = at;
                }
            }
            corner[t + k] = (uint32_t)at;
        }
    }
    return count;
}

/* Cut the triangles, in their order, into parts of at most 65,535 vertices. Fills local[] with each corner's index
   inside its part, order[] with the vertices of all parts in a row, and part_of[] with each triangle's part; returns
   the number of parts and *total vertices. */
static int cut_parts(const uint32_t *corner, int index_count, int vertex_count, uint16_t *local, uint32_t *order,
                     int *part_of, int *total)
{
    int *stamp = need_memory((size_t)vertex_count, sizeof *stamp), part = 0, used = 0;
    uint16_t *slot = need_memory((size_t)vertex_count, sizeof *slot);
    for (int i = 0; i < vertex_count; i++) stamp[i] = -1;
    *total = 0;
    for (int t = 0; t < index_count; t += 3) {
        int fresh = 0;
        for (int k = 0; k < 3; k++) fresh += stamp[corner[t + k]] != part;
        if (used + fresh > MAX_PART_VERTICES) {
            part++;
            used = 0;
        }
        for (int k = 0; k < 3; k++) {
            uint32_t v = corner[t + k];
            if (stamp[v] != part) {
                stamp[v] = part;
                slot[v] = (uint16_t)used++;
                order[(*total)++] = v;
            }
            local[t + k] = slot[v];
        }
        part_of[t / 3] = part;
    }
    free(stamp);
    free(slot);
    return part + 1;
}

/* One block: the meshes, then all vertices, then all indices. */
static nacre_mesh *build_parts(const mesh *m, const q16_bounds *bounds, const corner_vertex *vertices,
                               const uint32_t *order, int total, const uint16_t *local, const int *part_of, int count)
{
    size_t head = ((size_t)count * sizeof(nacre_mesh) + 7) & ~(size_t)7;
    uint8_t *block = need_memory(1, head + (size_t)total * sizeof(nacre_vertex) + (size_t)m->index_count * 2);
    nacre_mesh *parts = (nacre_mesh *)(void *)block;
    nacre_vertex *vertex = (nacre_vertex *)(void *)(block + head);
    uint16_t *index = (uint16_t *)(void *)(vertex + total);
    for (int i = 0; i < total; i++) vertex[i] = pack_vertex(m, &vertices[order[i]], bounds);
    memcpy(index, local, (size_t)m->index_count * 2);
    int t = 0;
    for (int part = 0; part < count; part++) {
        nacre_mesh *p = &parts[part];
        p->vertices = vertex;
        p->indices = index;
        for (; t < m->index_count && part_of[t / 3] == part; t += 3) {
            for (int k = 0; k < 3; k++)
                if (local[t + k] >= p->vertex_count) p->vertex_count = (uint16_t)(local[t + k] + 1);
            p->index_count += 3;
        }
        memcpy(p->centre, bounds->centre, sizeof p->centre);
        memcpy(p->half_extent, bounds->half_extent, sizeof p->half_extent);
        vertex += p->vertex_count;
        index += p->index_count;
    }
    return parts;
}

int mesh_pack(const mesh *m, nacre_mesh **parts, int *count, failure *f)
{
    if (m->index_count < 3) return fail(f, FAIL_INVALID, "%s: mesh without faces", m->name);
    q16_bounds bounds;
    int code = find_bounds(m, &bounds, f);
    if (code) return code;
    size_t corners = (size_t)m->index_count;
    corner_vertex *vertices = need_memory((size_t)m->vertex_count + corners, sizeof *vertices);
    uint32_t *corner = need_memory(corners, sizeof *corner), *order = need_memory(corners, sizeof *order);
    uint16_t *local = need_memory(corners, sizeof *local);
    int *part_of = need_memory(corners / 3, sizeof *part_of), total;
    int vertex_count = expand_corners(m, vertices, corner, f);
    if (vertex_count < 0) {
        code = FAIL_UNSUPPORTED;
    } else {
        *count = cut_parts(corner, m->index_count, vertex_count, local, order, part_of, &total);
        *parts = build_parts(m, &bounds, vertices, order, total, local, part_of, *count);
    }
    free(vertices);
    free(corner);
    free(order);
    free(local);
    free(part_of);
    return code;
}

/* ---- files -------------------------------------------------------------------------------- */

static void append_u16(bytes *b, unsigned value)
{
    const uint8_t le[2] = {(uint8_t)value, (uint8_t)(value >> 8)};
    bytes_append(b, le, 2);
}

static void append_binary_part(bytes *b, const nacre_mesh *p)
{
    bytes_append_u32(b, p->vertex_count);
    bytes_append_u32(b, p->index_count);
    for (int i = 0; i < 3; i++) bytes_append_u32(b, (uint32_t)p->centre[i]);
    for (int i = 0; i < 3; i++) bytes_append_u32(b, (uint32_t)p->half_extent[i]);
    for (int i = 0; i < p->vertex_count; i++) {
        const nacre_vertex *v = &p->vertices[i];
        for (int k = 0; k < 4; k++) append_u16(b, (uint16_t)v->position[k]);
        for (int k = 0; k < 4; k++) append_u16(b, (uint16_t)v->normal[k]);
        bytes_append(b, v->tangent, 4);
        for (int k = 0; k < 2; k++) append_u16(b, (uint16_t)v->uv[k]);
    }
    for (uint32_t i = 0; i < p->index_count; i++) append_u16(b, p->indices[i]);
    if (p->index_count & 1) append_u16(b, 0);
}

/* C99 that compiles alone, as C or C++, with include/ on the path. */
static void append_c_part(bytes *b, const nacre_mesh *p, const char *name)
{
    bytes_printf(b, "\nextern const nacre_vertex %s_vertices[%d];\nextern const uint16_t %s_indices[%u];\n", name,
                 p->vertex_count, name, (unsigned)p->index_count);
    bytes_printf(b, "extern const nacre_mesh %s;\n\nconst nacre_vertex %s_vertices[%d] = {\n", name, name,
                 p->vertex_count);
    for (int i = 0; i < p->vertex_count; i++) {
        const nacre_vertex *v = &p->vertices[i];
        bytes_printf(b, "{{%d,%d,%d,0},{%d,%d,%d,0},{%d,%d,%d,%d},{%d,%d}},\n", v->position[0], v->position[1],
                     v->position[2], v->normal[0], v->normal[1], v->normal[2], v->tangent[0], v->tangent[1],
                     v->tangent[2], v->tangent[3], v->uv[0], v->uv[1]);
    }
    bytes_printf(b, "};\n\nconst uint16_t %s_indices[%u] = {", name, (unsigned)p->index_count);
    for (uint32_t i = 0; i < p->index_count; i++) bytes_printf(b, "%s%u,", i % 18 ? "" : "\n", p->indices[i]);
    bytes_printf(
        b, "\n};\n\nconst nacre_mesh %s = {%s_vertices, %s_indices, %uu, %uu, {%ld, %ld, %ld}, {%ld, %ld, %ld}};\n",
        name, name, name, (unsigned)p->index_count, (unsigned)p->vertex_count, (long)p->centre[0], (long)p->centre[1],
        (long)p->centre[2], (long)p->half_extent[0], (long)p->half_extent[1], (long)p->half_extent[2]);
}

static void c_name(const char *path, char *out, size_t size)
{
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    size_t length = strlen(base) - 2, n = 0;
    if (isdigit((unsigned char)base[0])) out[n++] = '_';
    for (size_t i = 0; i < length && n + 1 < size; i++) out[n++] = isalnum((unsigned char)base[i]) ? base[i] : '_';
    out[n] = 0;
}

static int has_suffix(const char *path, const char *suffix)
{
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    size_t length = strlen(base), wanted = strlen(suffix);
    return length > wanted && !strcmp(base + length - wanted, suffix);
}

static void append_c_file(bytes *b, const nacre_mesh *parts, int count, const char *path)
{
    char name[240], part_name[256];
    c_name(path, name, sizeof name);
    bytes_printf(b, "/* Written by nacre: a mesh in %d part%s. */\n#include \"nacre.h\"\n", count,
                 count > 1 ? "s" : "");
    for (int i = 0; i < count; i++) {
        snprintf(part_name, sizeof part_name, count > 1 ? "%s_%d" : "%s", name, i);
        append_c_part(b, &parts[i], part_name);
    }
}

int mesh_write(const mesh *m, const char *path, failure *f)
{
    int as_c = has_suffix(path, ".c");
    if (!as_c && !has_suffix(path, ".bin"))
        return fail(f, FAIL_USAGE, "-o %s: expected a name that ends in .c or .bin", path);
    nacre_mesh *parts;
    int count, code = mesh_pack(m, &parts, &count, f);
    if (code) return code;
    bytes b = {0};
    if (as_c) {
        append_c_file(&b, parts, count, path);
    } else {
        bytes_append(&b, "NMSH", 4);
        bytes_append_u32(&b, 1);
        bytes_append_u32(&b, (uint32_t)count);
        for (int i = 0; i < count; i++) append_binary_part(&b, &parts[i]);
    }
    free(parts);
    code = output_write_raw(path, &b, f);
    bytes_free(&b);
    return code;
}
