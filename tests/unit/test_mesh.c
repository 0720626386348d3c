/* SPDX-License-Identifier: MIT */
/* Meshes: closed forms of the built-in shapes, files with known content, the packed form and its files. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Before cmocka.h, which makes fail() a macro. */
#include "mesh.h"

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* ---- a directory for this run ------------------------------------------------------------- */

static char directory[64];
static char written[64][128];
static int written_count;

static int make_directory(void **state)
{
    (void)state;
    strcpy(directory, "/tmp/nacre_mesh.XXXXXX");
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    (void)state;
    for (int i = 0; i < written_count; i++) unlink(written[i]);
    return rmdir(directory);
}

/* A path in the directory, removed at the end. */
static const char *path_of(const char *name)
{
    assert_true(written_count < 64);
    snprintf(written[written_count], sizeof written[0], "%s/%s", directory, name);
    return written[written_count++];
}

static const char *write_file(const char *name, const void *data, size_t size)
{
    const char *path = path_of(name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    return path;
}

static const char *write_text(const char *name, const char *text)
{
    return write_file(name, text, strlen(text));
}

static mesh open_mesh(const char *name)
{
    mesh m;
    failure f = {0};
    int code = mesh_open(&m, name, &f);
    if (code) fail_msg("%s", f.text);
    return m;
}

/* The error is one line that names the file and holds every word given (NULL ends them). */
static void assert_failure(const failure *f, int got, int code, const char *name, const char *word)
{
    if (got != code || f->code != code || !strstr(f->text, name) || !strstr(f->text, word) || strchr(f->text, '\n'))
        fail_msg("found code %d \"%s\", expected code %d naming %s and %s", got, f->text, code, name, word);
}

static void assert_open_fails(const char *name, int code, const char *word)
{
    mesh m = {.vertex_count = 77};
    failure f = {0};
    int got = mesh_open(&m, name, &f);
    assert_failure(&f, got, code, name, word);
    assert_int_equal(m.vertex_count, 77); /* untouched */
}

/* ---- measures, in double ------------------------------------------------------------------ */

static void corner(const mesh *m, int at, double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = (double)m->position[m->index[at]][i];
}

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Twice the area, along the face's normal. */
static void face_vector(const mesh *m, int t, double out[3])
{
    double a[3], b[3], c[3];
    corner(m, t, a), corner(m, t + 1, b), corner(m, t + 2, c);
    for (int i = 0; i < 3; i++) b[i] -= a[i], c[i] -= a[i];
    out[0] = b[1] * c[2] - b[2] * c[1];
    out[1] = b[2] * c[0] - b[0] * c[2];
    out[2] = b[0] * c[1] - b[1] * c[0];
}

static double area(const mesh *m)
{
    double sum = 0, n[3];
    for (int t = 0; t < m->index_count; t += 3) {
        face_vector(m, t, n);
        sum += 0.5 * sqrt(dot3(n, n));
    }
    return sum;
}

/* Positive when faces are counter-clockwise from outside (divergence theorem). */
static double volume(const mesh *m)
{
    double sum = 0, n[3], a[3];
    for (int t = 0; t < m->index_count; t += 3) {
        face_vector(m, t, n);
        corner(m, t, a);
        sum += dot3(n, a) / 6;
    }
    return sum;
}

typedef struct topology {
    int vertices, edges, faces, open_edges; /* open: of one triangle only */
} topology;

static int64_t *sort_keys;

static int by_key(const void *a, const void *b)
{
    const int64_t *x = &sort_keys[3 * *(const int *)a], *y = &sort_keys[3 * *(const int *)b];
    for (int i = 0; i < 3; i++)
        if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
    return 0;
}

static int by_value(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* With vertices of one place (to 2^-18, shifted off 0 so that rounding noise there splits none) taken as one. Fails
   if two triangles use an edge in the same direction. */
static topology measure(const mesh *m)
{
    topology out = {0};
    int *order = malloc(sizeof *order * (size_t)m->vertex_count), *id = malloc(sizeof *id * (size_t)m->vertex_count);
    sort_keys = malloc(3 * sizeof *sort_keys * (size_t)m->vertex_count);
    uint8_t *used = calloc((size_t)m->vertex_count, 1);
    for (int i = 0; i < m->index_count; i++) used[m->index[i]] = 1;
    for (int i = 0; i < m->vertex_count; i++) {
        order[i] = i;
        for (int k = 0; k < 3; k++)
            sort_keys[3 * i + k] = (int64_t)floor(((double)m->position[i][k] + 8.0000017) * 262144);
    }
    qsort(order, (size_t)m->vertex_count, sizeof *order, by_key);
    int last = -1, count = 0;
    for (int i = 0; i < m->vertex_count; i++) {
        if (!used[order[i]]) continue;
        if (last < 0 || by_key(&last, &order[i])) count++;
        id[order[i]] = count - 1;
        last = order[i];
    }
    out.vertices = count;
    out.faces = m->index_count / 3;
    uint64_t *edge = malloc(sizeof *edge * (size_t)m->index_count);
    for (int t = 0; t < m->index_count; t += 3) {
        for (int k = 0; k < 3; k++) {
            uint64_t a = (uint64_t)id[m->index[t + k]], b = (uint64_t)id[m->index[t + (k + 1) % 3]];
            assert_true(a != b);
            edge[t + k] = a < b ? (a << 32 | b) << 1 : (b << 32 | a) << 1 | 1; /* last bit: direction */
        }
    }
    qsort(edge, (size_t)m->index_count, sizeof *edge, by_value);
    for (int i = 0; i < m->index_count; i++) {
        int pair = i + 1 < m->index_count && edge[i] >> 1 == edge[i + 1] >> 1;
        if (pair) assert_true(edge[i] != edge[i + 1]);
        out.edges++;
        out.open_edges += !pair;
        i += pair;
    }
    free(order), free(id), free(sort_keys), free(used), free(edge);
    return out;
}

/* What every mesh must have, whatever made it. */
static void assert_sound(const mesh *m)
{
    assert_true(m->vertex_count > 0 && m->index_count > 0 && m->index_count % 3 == 0);
    for (int i = 0; i < m->index_count; i++) assert_true(m->index[i] < (uint32_t)m->vertex_count);
    for (int i = 0; i < m->vertex_count; i++) {
        double n[3], t[3];
        for (int k = 0; k < 3; k++) {
            assert_true(isfinite(m->position[i][k]));
            n[k] = (double)m->normal[i][k], t[k] = (double)m->tangent[i][k];
        }
        /* 4 roundings of floats near 1 */
        assert_float_equal(dot3(n, n), 1, 3e-7);
        assert_float_equal(dot3(t, t), 1, 3e-7);
        assert_float_equal(dot3(n, t), 0, 3e-7);
        assert_true(m->tangent[i][3] == 1 || m->tangent[i][3] == -1);
        assert_true(isfinite(m->uv[i][0]) && isfinite(m->uv[i][1]));
    }
}

/* The tangent is the direction of growing u, and w cross(normal, tangent) that of growing v, on every triangle. */
static void assert_tangents_follow_uv(const mesh *m, double least_cosine)
{
    for (int t = 0; t < m->index_count; t += 3) {
        double e[2][3], a[3], d[2][2], u[3], v[3];
        corner(m, t, a);
        for (int k = 0; k < 2; k++) {
            corner(m, t + k + 1, e[k]);
            for (int i = 0; i < 3; i++) e[k][i] -= a[i];
            for (int i = 0; i < 2; i++) d[k][i] = (double)m->uv[m->index[t + k + 1]][i] - (double)m->uv[m->index[t]][i];
        }
        double det = d[0][0] * d[1][1] - d[1][0] * d[0][1];
        assert_true(fabs(det) > 0);
        for (int i = 0; i < 3; i++) {
            u[i] = (e[0][i] * d[1][1] - e[1][i] * d[0][1]) / det;
            v[i] = (e[1][i] * d[0][0] - e[0][i] * d[1][0]) / det;
        }
        for (int k = 0; k < 3; k++) {
            const float *n = m->normal[m->index[t + k]], *w = m->tangent[m->index[t + k]];
            const double tangent[3] = {(double)w[0], (double)w[1], (double)w[2]};
            const double b[3] = {(double)(w[3] * (n[1] * w[2] - n[2] * w[1])),
                                 (double)(w[3] * (n[2] * w[0] - n[0] * w[2])),
                                 (double)(w[3] * (n[0] * w[1] - n[1] * w[0]))};
            assert_true(dot3(u, tangent) > least_cosine * sqrt(dot3(u, u)));
            assert_true(dot3(v, b) > least_cosine * sqrt(dot3(v, v)));
        }
    }
}

static void assert_normals_face_outwards(const mesh *m)
{
    for (int t = 0; t < m->index_count; t += 3) {
        double n[3];
        face_vector(m, t, n);
        for (int k = 0; k < 3; k++) {
            const float *v = m->normal[m->index[t + k]];
            assert_true(n[0] * (double)v[0] + n[1] * (double)v[1] + n[2] * (double)v[2] > 0);
        }
    }
}

/* ---- built-in shapes ---------------------------------------------------------------------- */

static void sphere_is_a_sphere(void **state)
{
    (void)state;
    mesh m = open_mesh("sphere");
    assert_sound(&m);
    assert_normals_face_outwards(&m);
    for (int i = 0; i < m.vertex_count; i++) {
        double r2 = 0;
        for (int k = 0; k < 3; k++) {
            assert_true(m.position[i][k] == m.normal[i][k]);
            r2 += (double)m.position[i][k] * (double)m.position[i][k];
        }
        assert_float_equal(r2, 1, 3e-7);
    }
    /* 64 rows of 128 planar trapezoids (triangles at the poles), summed in closed form */
    double expected = 0, half = pi / 128;
    for (int row = 0; row < 64; row++) {
        double p0 = pi * row / 64, p1 = pi * (row + 1) / 64;
        double height = hypot((sin(p1) - sin(p0)) * cos(half), cos(p1) - cos(p0));
        expected += 128 * (sin(p0) + sin(p1)) * sin(half) * height;
    }
    assert_float_equal(area(&m), expected, 1e-5); /* float vertices */
    assert_true(area(&m) < 4 * pi && area(&m) > 4 * pi * (1 - 0.002));
    assert_true(volume(&m) > 4 * pi / 3 * (1 - 0.002));
    topology t = measure(&m);
    assert_int_equal(t.open_edges, 0);
    assert_int_equal(t.vertices - t.edges + t.faces, 2);
    /* around the poles the uv of a triangle's tip is the middle: at most half a column off */
    assert_tangents_follow_uv(&m, 0.99);
    mesh_free(&m);
    assert_null(m.position);
}

static void plane_is_a_square(void **state)
{
    (void)state;
    mesh m = open_mesh("plane");
    assert_sound(&m);
    assert_float_equal(area(&m), 4, 0);
    float centre[3], half[3];
    mesh_bounds(&m, centre, half);
    const float expected[6] = {0, 0, 0, 1, 1, 0};
    for (int i = 0; i < 3; i++) assert_true(centre[i] == expected[i] && half[i] == expected[3 + i]);
    for (int i = 0; i < 4; i++) {
        assert_true(m.normal[i][2] == 1);
        assert_true(m.position[i][0] == 2 * m.uv[i][0] - 1 && m.position[i][1] == 2 * m.uv[i][1] - 1);
    }
    assert_normals_face_outwards(&m);
    assert_tangents_follow_uv(&m, 0.999999);
    topology t = measure(&m);
    assert_int_equal(t.open_edges, 4);
    assert_int_equal(t.vertices - t.edges + t.faces, 1);
    mesh_free(&m);
}

static void torus_is_a_torus(void **state)
{
    (void)state;
    mesh m = open_mesh("torus");
    assert_sound(&m);
    assert_normals_face_outwards(&m);
    for (int i = 0; i < m.vertex_count; i++) {
        double x = (double)m.position[i][0], y = (double)m.position[i][1], z = (double)m.position[i][2],
               r = hypot(x, y);
        assert_float_equal(hypot(r - 1, z), 0.4, 2e-7);
        const double n[3] = {x / r * (r - 1) / 0.4, y / r * (r - 1) / 0.4, z / 0.4};
        for (int k = 0; k < 3; k++) assert_float_equal((double)m.normal[i][k], n[k], 1e-6);
    }
    /* 4 pi^2 R r, less about (2 pi / 48)^2 / 6 for flat cells */
    assert_true(area(&m) < 4 * pi * pi * 0.4 && area(&m) > 4 * pi * pi * 0.4 * (1 - 0.004));
    assert_float_equal(volume(&m), 2 * pi * pi * 0.16, 2 * pi * pi * 0.16 * 0.006);
    topology t = measure(&m);
    assert_int_equal(t.open_edges, 0);
    assert_int_equal(t.vertices - t.edges + t.faces, 0);
    assert_tangents_follow_uv(&m, 0.99);
    mesh_free(&m);
}

static void teapot_is_sound(void **state)
{
    (void)state;
    mesh m = open_mesh("teapot");
    assert_sound(&m);
    assert_normals_face_outwards(&m);
    assert_int_equal(m.index_count / 3, 32 * 128 - 8 * 8 + 16);
    float centre[3], half[3];
    mesh_bounds(&m, centre, half);
    double farthest = 0;
    for (int i = 0; i < 3; i++) assert_float_equal((double)centre[i], 0, 1e-7);
    for (int i = 0; i < m.vertex_count; i++) {
        const float *p = m.position[i];
        farthest = fmax(farthest, sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])));
    }
    assert_float_equal(farthest, 1, 2e-7);
    /* Proportions of the published points: 3.15 high, the body 4 across (its widest curve is Bezier in both
       directions: radius 2 at its circle's joints, at the height where the profile's tangent is vertical). */
    assert_float_equal((double)(half[1] / half[2]), 3.15 / 2 / 2, 1e-6);
    /* Open only where handle (two ends) and spout (one) enter the body: 2 patches of 8 cells around. */
    topology t = measure(&m);
    assert_int_equal(t.open_edges, 3 * 16);
    mesh_free(&m);
}

/* Top of the knob and middle of the bottom: edges of patches shrunk to a point, where du x dv is 0 / 0. */
static void teapot_poles_have_their_normals(void **state)
{
    (void)state;
    mesh m = open_mesh("teapot");
    int poles = 0;
    float centre[3], half[3];
    mesh_bounds(&m, centre, half);
    for (int i = 0; i < m.vertex_count; i++) {
        double y = (double)m.position[i][1];
        if (fabs(fabs(y) - (double)half[1]) > 1e-6) continue;
        if (fabs((double)m.position[i][2]) > 1e-6) continue;
        assert_float_equal((double)m.normal[i][1], y > 0 ? 1 : -1, 1e-6);
        poles++;
    }
    assert_int_equal(poles, 8 * 9); /* 4 patches of 9 coinciding vertices at either end */
    mesh_free(&m);
}

/* Exact normals differ from the faces only by the tessellation: the worst cell is on the tight curl of the spout's tip. */
static void teapot_normals_agree_with_faces(void **state)
{
    (void)state;
    mesh m = open_mesh("teapot");
    double sum = 0;
    for (int t = 0; t < m.index_count; t += 3) {
        double n[3], mean[3] = {0, 0, 0};
        face_vector(&m, t, n);
        for (int k = 0; k < 9; k++) mean[k % 3] += (double)m.normal[m.index[t + k / 3]][k % 3];
        double cosine = dot3(n, mean) / sqrt(dot3(n, n) * dot3(mean, mean));
        assert_true(cosine > 0.83);
        sum += 1 - cosine;
    }
    assert_true(sum / (m.index_count / 3) < 0.005); /* 5.7 degrees root mean square */
    assert_tangents_follow_uv(&m, 0.35);            /* v is skewed against u there */
    mesh_free(&m);
}

/* Vertices of neighbouring patches that lie in one place have one normal: the published surface is smooth but where the
   lid meets the rim and the tea the spout, both at height 2.4 of 3.15, and the one point where the handle's end touches
   the body, in the plane of symmetry. */
static void teapot_has_no_seams(void **state)
{
    (void)state;
    mesh m = open_mesh("teapot");
    float centre[3], half[3];
    mesh_bounds(&m, centre, half);
    double crease = (double)half[1] * (2 * 2.4 / 3.15 - 1);
    int shared = 0, creased = 0;
    for (int i = 0; i < m.vertex_count; i++) {
        for (int j = 0; j < i; j++) {
            double apart = 0, cosine = 0;
            for (int k = 0; k < 3; k++) {
                apart = fmax(apart, fabs((double)(m.position[i][k] - m.position[j][k])));
                cosine += (double)m.normal[i][k] * (double)m.normal[j][k];
            }
            if (apart > 1e-6) continue;
            shared++;
            if (cosine > 1 - 1e-6) continue;
            if (m.position[i][0] > 0 || fabs((double)m.position[i][2]) > 1e-6)
                assert_float_equal((double)m.position[i][1], crease, 1e-6);
            creased++;
        }
    }
    assert_true(shared > 500 && creased >= 32 + 16 && creased < 200);
    mesh_free(&m);
}

/* ---- files -------------------------------------------------------------------------------- */

/* Whatever way its squares are cut into triangles, a cube's smooth normals are its diagonals. */
static void obj_cube_gets_smooth_normals(void **state)
{
    (void)state;
    mesh m = open_mesh(write_text("cube.obj", "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n"
                                              "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                                              "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"));
    assert_sound(&m);
    assert_int_equal(m.vertex_count, 8);
    assert_int_equal(m.index_count, 36);
    assert_float_equal(area(&m), 24, 0);
    assert_float_equal(volume(&m), 8, 1e-12);
    for (int i = 0; i < 8; i++) {
        for (int k = 0; k < 3; k++)
            assert_float_equal((double)m.normal[i][k], (double)m.position[i][k] / sqrt(3), 1e-7);
        assert_true(m.uv[i][0] == 0 && m.uv[i][1] == 0);
    }
    mesh_free(&m);
}

/* One roof, its ridge doubled by different uv on either side: the normal is shared all the same, and the mirrored
   half has handedness -1. */
static void obj_seam_and_mirrored_uv(void **state)
{
    (void)state;
    mesh m = open_mesh(write_text("roof.obj", "v 0 0 1\nv 0 1 1\nv 1 0 0\nv -1 0 0\n"
                                              "vt 0 0\nvt 0 1\nvt 1 0\nvt 0.5 0\nvt 0.5 1\nvt 1.5 0\n"
                                              "f 1/1 3/3 2/2\nf 1/4 2/5 4/6\n"));
    assert_sound(&m);
    assert_int_equal(m.vertex_count, 6);
    int ridge = 0, mirrored = 0;
    for (int i = 0; i < 6; i++) {
        mirrored += m.tangent[i][3] < 0;
        if (m.position[i][0] != 0) continue;
        ridge++;
        assert_float_equal((double)m.normal[i][0], 0, 1e-7);
        assert_float_equal((double)m.normal[i][2], 1, 1e-7);
        assert_float_equal((double)m.tangent[i][0], m.tangent[i][3] > 0 ? 1 : -1, 1e-7);
    }
    assert_int_equal(ridge, 4);
    assert_int_equal(mirrored, 3);
    assert_tangents_follow_uv(&m, 0.7); /* cos 45 degrees at the ridge */
    mesh_free(&m);
}

static void obj_degenerate_faces_give_no_nan(void **state)
{
    (void)state;
    mesh m = open_mesh(write_text("thin.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 5 5 5\nv 0 1 0\nvn 0 0 0\nvt 1 1\n"
                                              "f 1/1/1 2/1/1 3/1/1\nf 4/1/1 4/1/1 4/1/1\nf 1/1/1 2/1/1 5/1/1\n"));
    assert_sound(&m);
    for (int i = 0; i < m.vertex_count; i++) assert_true(m.normal[i][2] == 1);
    mesh_free(&m);
}

static void obj_keeps_its_normals(void **state)
{
    (void)state;
    mesh m = open_mesh(write_text("tilted.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 3 0 4\nf 1//1 2//1 3//1\n"));
    assert_sound(&m);
    for (int i = 0; i < 3; i++) {
        assert_float_equal((double)m.normal[i][0], 0.6, 1e-7);
        assert_float_equal((double)m.normal[i][2], 0.8, 1e-7);
    }
    mesh_free(&m);
}

/* Points and lines beside triangles are left out. */
static void obj_drops_lines(void **state)
{
    (void)state;
    mesh m = open_mesh(write_text("mixed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nl 1 4\np 4\nf 1 2 3\n"));
    assert_sound(&m);
    assert_int_equal(m.index_count, 3);
    assert_int_equal(m.vertex_count, 3);
    mesh_free(&m);
}

static void ply_and_stl(void **state)
{
    (void)state;
    mesh m =
        open_mesh(write_text("t.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                                      "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
                                      "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n"
                                      "3 1 2 3\n"));
    assert_sound(&m);
    assert_int_equal(m.vertex_count, 4);
    assert_int_equal(m.index_count, 12);
    assert_float_equal(volume(&m), 1.0 / 6, 1e-12);
    mesh_free(&m);

    m = open_mesh(write_text("t.stl",
                             "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\n"
                             "endloop\nendfacet\nendsolid t\n"));
    assert_sound(&m);
    assert_float_equal(area(&m), 2, 0);
    assert_true(m.normal[0][2] == 1);
    mesh_free(&m);
}

/* One triangle (0,0,0) (1,0,0) (0,1,0) with uv (0,0) (1,0) (0,1) in glTF's sense (v down) and 16-bit indices. */
static size_t triangle_buffer(uint8_t out[68])
{
    const float position[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, uv[6] = {0, 0, 1, 0, 0, 1};
    const uint16_t index[4] = {0, 1, 2, 0};
    memcpy(out, position, 36);
    memcpy(out + 36, uv, 24);
    memcpy(out + 60, index, 8);
    return 68;
}

static int gltf_text(char *out, size_t size, const char *uri, const char *node)
{
    return snprintf(out, size,
                    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
                    "\"nodes\":[{\"children\":[1],\"translation\":[10,20,30]},{\"mesh\":0%s}],"
                    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2}]}],"
                    "\"buffers\":[{%s\"byteLength\":68}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,"
                    "\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":24},{\"buffer\":0,"
                    "\"byteOffset\":60,\"byteLength\":6}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
                    "\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]},{\"bufferView\":1,"
                    "\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"},{\"bufferView\":2,\"componentType\":5123,"
                    "\"count\":3,\"type\":\"SCALAR\"}]}",
                    node, uri);
}

static void append_glb_chunk(bytes *b, const char *type, const void *data, size_t size, char pad)
{
    bytes_append_u32(b, (uint32_t)((size + 3) & ~(size_t)3));
    bytes_append(b, type, 4);
    bytes_append(b, data, size);
    while (b->size % 4) bytes_append(b, &pad, 1);
}

static bytes make_glb(const char *node)
{
    char text[2048];
    uint8_t data[68];
    size_t text_size = (size_t)gltf_text(text, sizeof text, "", node), data_size = triangle_buffer(data);
    bytes b = {0};
    bytes_append(&b, "glTF", 4);
    bytes_append_u32(&b, 2);
    bytes_append_u32(&b, (uint32_t)(12 + 8 + ((text_size + 3) & ~(size_t)3) + 8 + data_size));
    append_glb_chunk(&b, "JSON", text, text_size, ' ');
    append_glb_chunk(&b, "BIN\0", data, data_size, 0);
    return b;
}

static void assert_vertex(const mesh *m, int at, double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int k = 0; k < 3; k++) assert_float_equal((double)m->position[m->index[at]][k], expected[k], 1e-6);
}

static void glb_nodes_are_applied(void **state)
{
    (void)state;
    bytes b = make_glb(",\"scale\":[2,3,4]");
    mesh m = open_mesh(write_file("scaled.glb", b.data, b.size));
    assert_sound(&m);
    assert_int_equal(m.index_count, 3);
    assert_vertex(&m, 0, 10, 20, 30);
    assert_vertex(&m, 1, 12, 20, 30);
    assert_vertex(&m, 2, 10, 23, 30);
    assert_true(m.normal[0][2] == 1);
    /* v is turned up: u grows with x, v falls with y */
    assert_float_equal((double)m.uv[m.index[2]][1] - (double)m.uv[m.index[0]][1], -1, 1e-6);
    assert_true(m.tangent[0][0] == 1 && m.tangent[0][3] == -1);
    mesh_free(&m);
    bytes_free(&b);
}

/* A mirroring node turns the triangle over; its front must stay the front. */
static void glb_mirror_keeps_the_front(void **state)
{
    (void)state;
    bytes b = make_glb(",\"scale\":[-1,1,1]");
    mesh m = open_mesh(write_file("mirrored.glb", b.data, b.size));
    assert_sound(&m);
    double n[3];
    face_vector(&m, 0, n);
    assert_true(n[2] > 0 && m.normal[0][2] == 1);
    assert_tangents_follow_uv(&m, 0.999);
    mesh_free(&m);
    bytes_free(&b);
}

static void gltf_with_a_buffer_beside(void **state)
{
    (void)state;
    char text[2048];
    uint8_t data[68];
    triangle_buffer(data);
    write_file("t.bin", data, sizeof data);
    gltf_text(text, sizeof text, "\"uri\":\"t.bin\",", "");
    mesh m = open_mesh(write_text("t.gltf", text));
    assert_sound(&m);
    assert_vertex(&m, 1, 11, 20, 30);
    mesh_free(&m);
}

static const char *write_ply(const char *name, const char *vertices, const char *face)
{
    char text[512];
    snprintf(text, sizeof text,
             "ply\nformat ascii 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n%s",
             vertices, face);
    return write_text(name, text);
}

/* Some of these make the loader itself crash: that is one line, too. */
static void bad_files_are_one_line_each(void **state)
{
    (void)state;
    assert_open_fails("/nonexistent/mesh.obj", FAIL_IO, strerror(ENOENT));
    assert_open_fails("teapott", FAIL_IO, "sphere, teapot, plane, torus");
    assert_open_fails(directory, FAIL_IO, strerror(EISDIR));
    assert_open_fails(write_text("mesh.txt", "v 0 0 0\n"), FAIL_UNSUPPORTED, ".obj, .gltf, .glb, .ply or .stl");
    assert_open_fails(write_text("empty.obj", ""), FAIL_INVALID, "empty");
    assert_open_fails(write_text("garbage.ply", "not a mesh\n"), FAIL_INVALID, "not a mesh");
    assert_open_fails(write_text("garbage.glb", "glTF\2\0\0"), FAIL_INVALID, "not a mesh");
    assert_open_fails(write_text("garbage.gltf", "{\"asset\":"), FAIL_INVALID, "not a mesh");
    assert_open_fails(write_text("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), FAIL_INVALID, "mesh without faces");
    assert_open_fails(write_text("lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), FAIL_INVALID, "mesh without faces");
    assert_open_fails(write_text("points.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                               "property float y\nproperty float z\nend_header\n0 0 0\n"),
                      FAIL_INVALID, "mesh without faces");
    assert_open_fails(write_text("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), FAIL_INVALID, "");
    assert_open_fails(write_ply("far.ply", "3", "3 0 1 3\n"), FAIL_INVALID,
                      "face 0: found vertex 3, expected less than 3");
    assert_open_fails(write_ply("none.ply", "3", "0\n"), FAIL_INVALID, "face 0: found no vertices");
#ifndef __SANITIZE_ADDRESS__ /* it ends the loader where the plain new throws */
    assert_open_fails(write_ply("many.ply", "4294967295", "3 0 1 2\n"), FAIL_INVALID, "not a mesh");
#endif
    assert_open_fails(write_text("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), FAIL_INVALID, "finite");
    assert_open_fails(write_text("inf.obj", "v 0 0 0\nv 1 0 inf\nv 0 1 0\nf 1 2 3\n"), FAIL_INVALID, "finite");
    bytes b = make_glb("");
    assert_open_fails(write_file("short.glb", b.data, b.size - 40), FAIL_INVALID, "not a mesh");
    const float nan = NAN;
    memcpy(b.data + b.size - 68 + 36, &nan, 4); /* the first u */
    assert_open_fails(write_file("nan_uv.glb", b.data, b.size), FAIL_INVALID, "texture coordinates nan, 1");
    memcpy(b.data + b.size - 68 + 4, &nan, 4); /* the first y */
    assert_open_fails(write_file("nan.glb", b.data, b.size), FAIL_INVALID, "vertex 0: found y = nan");
    bytes_free(&b);
}

/* ---- the packed form ---------------------------------------------------------------------- */

static nacre_mesh *pack(const mesh *m, int *count)
{
    nacre_mesh *parts;
    failure f = {0};
    int code = mesh_pack(m, &parts, count, &f);
    if (code) fail_msg("%s", f.text);
    return parts;
}

/* Each corner of each triangle, in order, against the source: position to half a step (half_extent / 65534; 2^-40 for
   the arithmetic here), normals to 0.5 / 32767, tangents to 0.5 / 127, uv to 0.5 / 2048 but for whole turns. */
static void assert_packed(const mesh *m, const nacre_mesh *parts, int count)
{
    int at = 0;
    float centre[3], half[3];
    mesh_bounds(m, centre, half);
    for (int part = 0; part < count; part++) {
        const nacre_mesh *p = &parts[part];
        assert_true(p->vertex_count >= 1 && p->index_count % 3 == 0 && p->index_count > 0);
        for (int k = 0; k < 3; k++) {
            /* no more than the true bounds and two roundings to q16 */
            assert_true(p->half_extent[k] >= 1);
            assert_true(p->half_extent[k] <= (double)half[k] * 65536 + 2);
        }
        for (uint32_t i = 0; i < p->index_count; i++, at++) {
            assert_true(p->indices[i] < p->vertex_count && at < m->index_count);
            const nacre_vertex *v = &p->vertices[p->indices[i]];
            uint32_t s = m->index[at];
            for (int k = 0; k < 3; k++) {
                double h = p->half_extent[k] / 65536.0, x = p->centre[k] / 65536.0 + h * v->position[k] / 32767.0;
                assert_true(fabs(x - (double)m->position[s][k]) <= h / 65534 + 0x1p-40);
                assert_true(fabs(v->normal[k] / 32767.0 - (double)m->normal[s][k]) <= 0.5000001 / 32767);
                assert_true(fabs(v->tangent[k] / 127.0 - (double)m->tangent[s][k]) <= 0.5000001 / 127);
            }
            assert_int_equal(v->tangent[3], m->tangent[s][3] < 0 ? -127 : 127);
            for (int k = 0; k < 2; k++) {
                double d = v->uv[k] / 2048.0 - (double)m->uv[s][k];
                assert_true(fabs(d - floor(d + 0.5)) <= 0.5 / 2048 + 0x1p-20);
            }
            assert_true(v->position[3] == 0 && v->normal[3] == 0);
        }
    }
    assert_int_equal(at, m->index_count);
}

static void packing_is_within_half_a_step(void **state)
{
    (void)state;
    static const char *const names[] = {"sphere", "teapot", "plane", "torus", "fixtures/in/bunny.obj"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        mesh m = open_mesh(names[i]);
        int count;
        nacre_mesh *parts = pack(&m, &count);
        assert_int_equal(count, 1);
        assert_packed(&m, parts, count);
        free(parts);
        mesh_free(&m);
    }
}

/* A flat grid of columns x rows vertices, uv growing by uv_step per cell. */
static mesh make_grid(int columns, int rows, float uv_step)
{
    int cells = (columns - 1) * (rows - 1), at = 0;
    size_t n = (size_t)columns * (size_t)rows;
    mesh m = {.vertex_count = (int)n, .index_count = 6 * cells, .name = "grid"};
    m.position = calloc(n, sizeof *m.position), m.normal = calloc(n, sizeof *m.normal);
    m.tangent = calloc(n, sizeof *m.tangent), m.uv = calloc(n, sizeof *m.uv);
    m.index = calloc((size_t)m.index_count, sizeof *m.index);
    for (int i = 0; i < (int)n; i++) {
        m.position[i][0] = (float)(i % columns) + 0.25f, m.position[i][1] = -7 + 3 * (float)(i / columns);
        m.normal[i][2] = m.tangent[i][0] = m.tangent[i][3] = 1;
        m.uv[i][0] = uv_step * (float)(i % columns), m.uv[i][1] = uv_step * (float)(i / columns);
    }
    for (int i = 0; i < cells; i++) {
        uint32_t a = (uint32_t)(i / (columns - 1) * columns + i % (columns - 1)), stride = (uint32_t)columns;
        const uint32_t index[6] = {a, a + 1, a + stride + 1, a, a + stride + 1, a + stride};
        memcpy(m.index + at, index, sizeof index);
        at += 6;
    }
    return m;
}

/* A centre halfway between two steps of q16 is rounded: the farther side must still be in range. */
static void rounded_centres_keep_both_ends(void **state)
{
    (void)state;
    mesh m = make_grid(2, 2, 1);
    for (int i = 0; i < 4; i++) {
        m.position[i][0] = i & 1 ? 65537 / 65536.0f : 0;
        m.position[i][1] = i & 2 ? -65537 / 65536.0f : 0;
    }
    int count;
    nacre_mesh *parts = pack(&m, &count);
    assert_packed(&m, parts, count);
    free(parts);
    mesh_free(&m);
}

static void large_meshes_are_split(void **state)
{
    (void)state;
    mesh m = make_grid(280, 250, 0);
    assert_int_equal(m.vertex_count, 70000);
    int count;
    nacre_mesh *parts = pack(&m, &count);
    assert_int_equal(count, 2);
    assert_true(parts[0].vertex_count > 65530);
    assert_packed(&m, parts, count);
    /* one grid of steps for all parts: no cracks between them */
    assert_memory_equal(parts[0].centre, parts[1].centre, sizeof parts[0].centre);
    assert_memory_equal(parts[0].half_extent, parts[1].half_extent, sizeof parts[0].half_extent);
    free(parts);
    mesh_free(&m);

    m = make_grid(65535 / 5, 5, 0); /* as many as fit in one */
    parts = pack(&m, &count);
    assert_int_equal(count, 1);
    assert_int_equal(parts[0].vertex_count, 65535);
    assert_packed(&m, parts, count);
    free(parts);
    mesh_free(&m);
}

static void far_uv_are_wrapped(void **state)
{
    (void)state;
    mesh m = make_grid(41, 3, 1.25f); /* u up to 50 */
    int count;
    nacre_mesh *parts = pack(&m, &count);
    assert_packed(&m, parts, count);
    assert_true(parts[0].vertex_count < m.vertex_count + 3 * 4); /* doubled only where the shift changes */
    /* inside a triangle differences stay what they were */
    for (uint32_t i = 0; i < parts[0].index_count; i += 3) {
        double d = parts[0].vertices[parts[0].indices[i + 1]].uv[0] - parts[0].vertices[parts[0].indices[i]].uv[0];
        assert_float_equal(d / 2048, (double)(m.uv[m.index[i + 1]][0] - m.uv[m.index[i]][0]), 1.0 / 2048);
    }
    free(parts);
    mesh_free(&m);
}

static void assert_pack_fails(const mesh *m, int code, const char *word)
{
    failure f = {0};
    nacre_mesh *parts = NULL;
    int count = 5, got = mesh_pack(m, &parts, &count, &f);
    assert_failure(&f, got, code, m->name, word);
    assert_true(!parts && count == 5);
}

static void what_does_not_pack(void **state)
{
    (void)state;
    mesh m = make_grid(2, 2, 33);
    assert_pack_fails(&m, FAIL_UNSUPPORTED, "texture coordinate u from 0 to 33");
    m.uv[1][0] = m.uv[3][0] = 31.9f, m.uv[2][1] = m.uv[3][1] = 0;
    int count;
    nacre_mesh *parts = pack(&m, &count); /* nearly the whole range, shifted */
    assert_packed(&m, parts, count);
    free(parts);
    m.position[2][1] = 40000;
    assert_pack_fails(&m, FAIL_UNSUPPORTED, "y from -7 to 40000");
    m.index_count = 0;
    assert_pack_fails(&m, FAIL_INVALID, "mesh without faces");
    mesh_free(&m);
}

/* ---- files for firmware ------------------------------------------------------------------- */

static uint32_t u32_at(const uint8_t *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void write_mesh(const mesh *m, const char *path)
{
    failure f = {0};
    if (mesh_write(m, path, &f)) fail_msg("%s", f.text);
}

static bytes read_back(const char *path)
{
    bytes b = {0};
    failure f = {0};
    if (file_read(&b, path, &f)) fail_msg("%s", f.text);
    return b;
}

static void binary_file_is_as_described(void **state)
{
    (void)state;
    mesh m = make_grid(280, 250, 0.125f);
    const char *path = path_of("grid.bin");
    write_mesh(&m, path);
    bytes b = read_back(path);
    int count;
    nacre_mesh *parts = pack(&m, &count);
    assert_memory_equal(b.data, "NMSH", 4);
    assert_int_equal(u32_at(b.data + 4), 1);
    assert_int_equal(u32_at(b.data + 8), count);
    const uint8_t *at = b.data + 12;
    for (int i = 0; i < count; i++) {
        assert_int_equal(u32_at(at), parts[i].vertex_count);
        assert_int_equal(u32_at(at + 4), parts[i].index_count);
        for (int k = 0; k < 3; k++) {
            assert_int_equal((int32_t)u32_at(at + 8 + 4 * k), parts[i].centre[k]);
            assert_int_equal((int32_t)u32_at(at + 20 + 4 * k), parts[i].half_extent[k]);
        }
        at += 32;
        /* the file is little-endian, and so are the machines that run this test */
        assert_memory_equal(at, parts[i].vertices, 24u * parts[i].vertex_count);
        at += 24u * parts[i].vertex_count;
        assert_memory_equal(at, parts[i].indices, 2u * parts[i].index_count);
        at += (2u * parts[i].index_count + 3) & ~3u;
    }
    assert_ptr_equal(at, b.data + b.size);
    write_mesh(&m, path);
    bytes again = read_back(path);
    assert_int_equal(again.size, b.size);
    assert_memory_equal(again.data, b.data, b.size);
    bytes_free(&b), bytes_free(&again);
    free(parts);
    mesh_free(&m);
}

static void run(const char *format, ...)
{
    char command[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(command, sizeof command, format, args);
    va_end(args);
    if (system(command)) fail_msg("failed: %s", command);
}

/* Compiled strictly and printed by a program that includes nothing of ours but nacre.h, the C file says what the
   binary file says. */
static void c_file_compiles_and_equals_the_binary(void **state)
{
    (void)state;
    static const char printer[] =
        "#include <stdio.h>\n#include \"nacre.h\"\n"
        "extern const nacre_mesh my_teapot_2;\n"
        "static void u32(unsigned long x){int i;for(i=0;i<4;i++)putchar((int)(x>>8*i&255));}\n"
        "static void u16(unsigned x){putchar((int)(x&255));putchar((int)(x>>8&255));}\n"
        "int main(void){const nacre_mesh*m=&my_teapot_2;unsigned long i;int k;\n"
        "u32(m->vertex_count);u32(m->index_count);for(k=0;k<3;k++)u32((unsigned long)m->centre[k]);\n"
        "for(k=0;k<3;k++)u32((unsigned long)m->half_extent[k]);\n"
        "for(i=0;i<m->vertex_count;i++){const nacre_vertex*v=&m->vertices[i];\n"
        "for(k=0;k<4;k++)u16((unsigned)v->position[k]);for(k=0;k<4;k++)u16((unsigned)v->normal[k]);\n"
        "for(k=0;k<4;k++)putchar(v->tangent[k]&255);for(k=0;k<2;k++)u16((unsigned)v->uv[k]);}\n"
        "for(i=0;i<m->index_count;i++)u16(m->indices[i]);if(m->index_count&1)u16(0);return 0;}\n";
    mesh m = open_mesh("teapot");
    const char *c = path_of("my-teapot.2.c"), *bin = path_of("teapot.bin"), *out = path_of("printed");
    const char *program = path_of("printer"), *main_c = write_text("printer.c", printer), *object = path_of("arm.o");
    write_mesh(&m, c);
    write_mesh(&m, bin);
    run("cc -std=c99 -pedantic -Wall -Wextra -Werror -Iinclude -c -o %s %s", object, c);
    run("cc -std=c99 -Iinclude -o %s %s %s", program, object, main_c);
    run("%s > %s", program, out);
    bytes a = read_back(out), b = read_back(bin);
    assert_int_equal(a.size + 12, b.size);
    assert_memory_equal(a.data, b.data + 12, a.size);
    if (system("command -v arm-none-eabi-gcc >/dev/null 2>&1") == 0)
        run("arm-none-eabi-gcc -mcpu=cortex-m4 -std=c99 -pedantic -Wall -Wextra -Werror -Iinclude -c -o %s %s", object,
            c);
    else
        print_message("arm-none-eabi-gcc is not here: not compiled for Cortex-M4\n");
    bytes_free(&a), bytes_free(&b);
    mesh_free(&m);
}

static void split_c_file_compiles(void **state)
{
    (void)state;
    mesh m = make_grid(280, 250, 0);
    const char *c = path_of("7grid.c"), *object = path_of("7grid.o");
    write_mesh(&m, c);
    run("cc -std=c99 -pedantic -Wall -Wextra -Werror -Iinclude -c -o %s %s", object, c);
    run("nm %s | grep -q ' _7grid_0$' && nm %s | grep -q ' _7grid_1_vertices$'", object, object);
    mesh_free(&m);
}

static void unwritable_files(void **state)
{
    (void)state;
    mesh m = open_mesh("plane");
    failure f = {0};
    int code = mesh_write(&m, "/nonexistent/plane.bin", &f);
    assert_failure(&f, code, FAIL_IO, "/nonexistent/plane.bin", strerror(ENOENT));
    code = mesh_write(&m, "plane.obj", &f);
    assert_failure(&f, code, FAIL_USAGE, "plane.obj", ".c or .bin");
    code = mesh_write(&m, ".c", &f);
    assert_failure(&f, code, FAIL_USAGE, "-o .c", ".c or .bin");
    /* nothing is written when the mesh does not pack */
    const char *path = path_of("never.c");
    m.position[0][0] = 1e9f;
    code = mesh_write(&m, path, &f);
    assert_failure(&f, code, FAIL_UNSUPPORTED, "plane", "x from");
    assert_int_equal(access(path, F_OK), -1);
    mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_is_a_sphere),
        cmocka_unit_test(plane_is_a_square),
        cmocka_unit_test(torus_is_a_torus),
        cmocka_unit_test(teapot_is_sound),
        cmocka_unit_test(teapot_poles_have_their_normals),
        cmocka_unit_test(teapot_normals_agree_with_faces),
        cmocka_unit_test(teapot_has_no_seams),
        cmocka_unit_test(obj_cube_gets_smooth_normals),
        cmocka_unit_test(obj_seam_and_mirrored_uv),
        cmocka_unit_test(obj_degenerate_faces_give_no_nan),
        cmocka_unit_test(obj_keeps_its_normals),
        cmocka_unit_test(obj_drops_lines),
        cmocka_unit_test(ply_and_stl),
        cmocka_unit_test(glb_nodes_are_applied),
        cmocka_unit_test(glb_mirror_keeps_the_front),
        cmocka_unit_test(gltf_with_a_buffer_beside),
        cmocka_unit_test(bad_files_are_one_line_each),
        cmocka_unit_test(packing_is_within_half_a_step),
        cmocka_unit_test(rounded_centres_keep_both_ends),
        cmocka_unit_test(large_meshes_are_split),
        cmocka_unit_test(far_uv_are_wrapped),
        cmocka_unit_test(what_does_not_pack),
        cmocka_unit_test(binary_file_is_as_described),
        cmocka_unit_test(c_file_compiles_and_equals_the_binary),
        cmocka_unit_test(split_c_file_compiles),
        cmocka_unit_test(unwritable_files),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
