/* SPDX-License-Identifier: MIT */
/* Built-in shapes, each from its equation: exact normals and tangents, no file. */
#include "mesh_inner.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "vec3.h"

extern const unsigned char embedded_teapot_csv[];
extern const unsigned long embedded_teapot_csv_size;

static const double pi = 3.14159265358979323846;

typedef struct surface_point {
    double position[3], normal[3], tangent[3], uv[2];
    double handedness;
} surface_point;

static void set_vertex(mesh *m, int at, const surface_point *p)
{
    for (int i = 0; i < 3; i++) {
        m->position[at][i] = (float)p->position[i];
        m->normal[at][i] = (float)p->normal[i];
        m->tangent[at][i] = (float)p->tangent[i];
    }
    m->tangent[at][3] = (float)p->handedness;
    m->uv[at][0] = (float)p->uv[0];
    m->uv[at][1] = (float)p->uv[1];
}

/* Two triangles of a grid cell, counter-clockwise where columns run right and rows run up. Triangles without area
   (a == b, say, where a row is one point) are the caller's to leave out. */
static int add_triangle(mesh *m, int at, int a, int b, int c)
{
    m->index[at] = (uint32_t)a;
    m->index[at + 1] = (uint32_t)b;
    m->index[at + 2] = (uint32_t)c;
    return at + 3;
}

/* Latitude-longitude sphere of radius 1 around the origin, poles on y. uv: azimuth and height angle over 0..1. */
static void make_sphere(mesh *out)
{
    enum { COLUMNS = 128, ROWS = 64 };
    mesh m = mesh_make("sphere", (COLUMNS + 1) * (ROWS + 1), 3 * 2 * COLUMNS * (ROWS - 1));
    int at = 0;
    for (int row = 0; row <= ROWS; row++) {
        double polar = pi * (1 - (double)row / ROWS), radius = row == 0 || row == ROWS ? 0 : sin(polar);
        for (int column = 0; column <= COLUMNS; column++) {
            /* A pole has one vertex per triangle that meets there, its tangent that of the triangle's middle. */
            double shift = row == 0 || row == ROWS ? 0.5 : 0;
            double u = (column + shift) / COLUMNS, azimuth = 2 * pi * (column == COLUMNS && !shift ? 0 : u);
            surface_point p = {.tangent = {cos(azimuth), 0, -sin(azimuth)}, .uv = {u, (double)row / ROWS}};
            p.position[0] = radius * sin(azimuth);
            p.position[1] = row == 0 ? -1 : row == ROWS ? 1 : cos(polar);
            p.position[2] = radius * cos(azimuth);
            memcpy(p.normal, p.position, sizeof p.normal);
            p.handedness = 1;
            set_vertex(&m, row * (COLUMNS + 1) + column, &p);
            if (row == ROWS || column == COLUMNS) continue;
            int a = row * (COLUMNS + 1) + column, b = a + 1, c = b + COLUMNS + 1, d = c - 1;
            if (row > 0) at = add_triangle(&m, at, a, b, row == ROWS - 1 ? d : c);
            if (row == 0) at = add_triangle(&m, at, a, c, d);
            if (row > 0 && row < ROWS - 1) at = add_triangle(&m, at, a, c, d);
        }
    }
    *out = m;
}

/* The square -1..1 in x and y, facing +z. */
static void make_plane(mesh *out)
{
    mesh m = mesh_make("plane", 4, 6);
    for (int i = 0; i < 4; i++) {
        double u = i & 1, v = i >> 1;
        surface_point p = {{2 * u - 1, 2 * v - 1, 0}, {0, 0, 1}, {1, 0, 0}, {u, v}, 1};
        set_vertex(&m, i, &p);
    }
    add_triangle(&m, 0, 0, 1, 3);
    add_triangle(&m, 3, 0, 3, 2);
    *out = m;
}

/* A ring of radius 1 in the plane z = 0 with a tube of radius 0.4. uv: 4 turns along the ring by 1 around the tube,
   roughly square. */
static void make_torus(mesh *out)
{
    enum { COLUMNS = 96, ROWS = 48 };
    const double tube = 0.4;
    mesh m = mesh_make("torus", (COLUMNS + 1) * (ROWS + 1), 3 * 2 * COLUMNS * ROWS);
    int at = 0;
    for (int row = 0; row <= ROWS; row++) {
        double around = 2 * pi * (row % ROWS) / ROWS;
        for (int column = 0; column <= COLUMNS; column++) {
            double along = 2 * pi * (column % COLUMNS) / COLUMNS, c = cos(along), s = sin(along);
            surface_point p = {.tangent = {-s, c, 0}, .handedness = 1};
            p.normal[0] = c * cos(around), p.normal[1] = s * cos(around), p.normal[2] = sin(around);
            p.position[0] = c * (1 + tube * cos(around));
            p.position[1] = s * (1 + tube * cos(around));
            p.position[2] = tube * sin(around);
            p.uv[0] = 4.0 * column / COLUMNS;
            p.uv[1] = (double)row / ROWS;
            set_vertex(&m, row * (COLUMNS + 1) + column, &p);
            if (row == ROWS || column == COLUMNS) continue;
            int corner = row * (COLUMNS + 1) + column;
            at = add_triangle(&m, at, corner, corner + 1, corner + COLUMNS + 2);
            at = add_triangle(&m, at, corner, corner + COLUMNS + 2, corner + COLUMNS + 1);
        }
    }
    *out = m;
}

/* ---- teapot ------------------------------------------------------------------------------- */

enum { PATCHES = 32, MAX_POINTS = 512, SPOUT_TIP = 2 };

typedef struct patch {
    double point[4][4][3]; /* row, column */
    int is_spout, is_lid;
} patch;

static void bernstein(double t, double value[4], double slope[4])
{
    double s = 1 - t;
    const double b[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    const double d[4] = {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t};
    memcpy(value, b, sizeof b);
    memcpy(slope, d, sizeof d);
}

static void evaluate(const patch *p, double column, double row, double position[3], double d_column[3], double d_row[3])
{
    double bc[4], dc[4], br[4], dr[4];
    bernstein(column, bc, dc);
    bernstein(row, br, dr);
    for (int axis = 0; axis < 3; axis++) {
        position[axis] = d_column[axis] = d_row[axis] = 0;
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                double x = p->point[i][j][axis];
                position[axis] += br[i] * bc[j] * x;
                d_column[axis] += br[i] * dc[j] * x;
                d_row[axis] += dr[i] * bc[j] * x;
            }
        }
    }
}

/* Where an edge of the patch is one point (top of the knob, middle of the bottom), the slope along it is 0 and the
   frame is that of a point a millionth inwards: off from the limit by about as much. */
static surface_point patch_point(const patch *p, double column, double row)
{
    surface_point out = {.handedness = 1};
    double d_column[3], d_row[3], skip[3];
    evaluate(p, column, row, out.position, d_column, d_row);
    if (dot3(d_column, d_column) < 1e-12 || dot3(d_row, d_row) < 1e-12) {
        const double inwards = 1e-6;
        evaluate(p, fmin(fmax(column, inwards), 1 - inwards), fmin(fmax(row, inwards), 1 - inwards), skip, d_column,
                 d_row);
    }
    cross3(out.normal, d_column, d_row);
    normalise3(out.normal);
    /* Seen from outside columns run left and rows down, textures right and up. */
    double along = dot3(d_column, out.normal);
    for (int i = 0; i < 3; i++) out.tangent[i] = -(d_column[i] - along * out.normal[i]);
    normalise3(out.tangent);
    out.uv[0] = 1 - column;
    out.uv[1] = 1 - row;
    return out;
}

static const char *next_line(const char *at, const char *end)
{
    while (at < end && *at != '\n') at++;
    return at < end ? at + 1 : end;
}

static void read_number(const char **at, const char *end, double *out)
{
    char text[32];
    size_t n = 0;
    while (*at < end && **at != ',' && **at != '\n' && n + 1 < sizeof text) text[n++] = *(*at)++;
    text[n] = 0;
    if (*at < end && **at == ',') (*at)++;
    *out = strtod(text, NULL);
}

/* fixtures/in/teapot.csv, built in: a broken one is a broken program. */
static void read_patches(patch patches[PATCHES])
{
    double point[MAX_POINTS][3];
    int points = 0, count = 0;
    const char *at = (const char *)embedded_teapot_csv, *end = at + embedded_teapot_csv_size;
    for (; at < end; at = next_line(at, end)) {
        if (!strncmp(at, "point,", 6) && points < MAX_POINTS) {
            at += 6;
            for (int i = 0; i < 3; i++) read_number(&at, end, &point[points][i]);
            points++;
        } else if (!strncmp(at, "patch,", 6) && count < PATCHES) {
            patch *p = &patches[count++];
            at += 6;
            p->is_spout = !strncmp(at, "spout,", 6);
            p->is_lid = !strncmp(at, "lid,", 4);
            while (*at++ != ',') {}
            for (int i = 0; i < 16; i++) {
                double index;
                read_number(&at, end, &index);
                if (!(index >= 0 && index < points)) index = 0;
                memcpy(p->point[i / 4][i % 4], point[(int)index], sizeof point[0]);
            }
        }
    }
    if (count != PATCHES) {
        fprintf(stderr, "nacre: built-in teapot: found %d patches, expected %d\n", count, PATCHES);
        abort();
    }
}

/* y up; the lid, published a little too small, widened from radius 1.3 to the 1.4 of the rim it lies in, so that no
   gap shows the inside. */
static void place_patches(patch patches[PATCHES])
{
    for (int k = 0; k < PATCHES; k++) {
        double widen = patches[k].is_lid ? 1.4 / 1.3 : 1;
        for (int i = 0; i < 16; i++) {
            double *p = patches[k].point[i / 4][i % 4], y = p[1] * widen;
            p[0] *= widen;
            p[1] = p[2];
            p[2] = -y;
        }
    }
}

/* Centre of the bounds to the origin, farthest vertex to distance 1. */
static void fit_unit_sphere(mesh *m)
{
    float centre[3], half[3];
    mesh_bounds(m, centre, half);
    double farthest = 0;
    for (int i = 0; i < m->vertex_count; i++) {
        double p[3];
        for (int j = 0; j < 3; j++) p[j] = (double)m->position[i][j] - centre[j];
        farthest = fmax(farthest, sqrt(dot3(p, p)));
    }
    for (int i = 0; i < m->vertex_count; i++)
        for (int j = 0; j < 3; j++) m->position[i][j] = (float)(((double)m->position[i][j] - centre[j]) / farthest);
}

/* One cell of a patch's grid; corners at the single point of a degenerate edge make one triangle, not two. */
static int add_cell(mesh *m, int at, int corner, int stride)
{
    int a = corner, b = corner + 1, c = b + stride, d = a + stride;
    const float *pa = m->position[a], *pb = m->position[b];
    if (memcmp(pa, pb, 3 * sizeof *pa)) at = add_triangle(m, at, a, b, c);
    return add_triangle(m, at, a, c, d);
}

/* Level tea closes the spout: the last row of its two tip patches lies in one plane. */
static int add_tea(mesh *m, int *vertex, int at, const patch tip[SPOUT_TIP], int cells)
{
    int centre = (*vertex)++;
    surface_point p = {.normal = {0, 1, 0}, .tangent = {1, 0, 0}, .handedness = 1};
    int first = *vertex;
    for (int k = 0; k < SPOUT_TIP; k++) {
        for (int i = 0; i <= cells; i++) {
            double skip[2][3];
            evaluate(&tip[k], (double)i / cells, 1, p.position, skip[0], skip[1]);
            p.uv[0] = p.position[0];
            p.uv[1] = -p.position[2];
            set_vertex(m, (*vertex)++, &p);
        }
    }
    for (int i = 0; i < 3; i++) /* between the tip's two ends on the plane of symmetry */
        p.position[i] = 0.5 * (tip[0].point[3][0][i] + tip[0].point[3][3][i]);
    p.uv[0] = p.position[0];
    p.uv[1] = -p.position[2];
    set_vertex(m, centre, &p);
    for (int k = 0; k < SPOUT_TIP; k++)
        for (int i = 0; i < cells; i++)
            at = add_triangle(m, at, centre, first + k * (cells + 1) + i, first + k * (cells + 1) + i + 1);
    return at;
}

/* Newell's teapot: 32 patches of cells x cells, frames from the patches' derivatives; uv 0..1 on every patch. */
void mesh_teapot(mesh *out, int cells)
{
    const int stride = cells + 1;
    patch patches[PATCHES];
    read_patches(patches);
    place_patches(patches);
    mesh m = mesh_make("teapot", PATCHES * stride * stride + 1 + SPOUT_TIP * stride,
                       3 * (PATCHES * cells * cells * 2 + SPOUT_TIP * cells));
    int vertex = 0, at = 0, tip = 0;
    for (int k = 0; k < PATCHES; k++) {
        int first = vertex;
        for (int i = 0; i < stride * stride; i++) {
            surface_point p = patch_point(&patches[k], (double)(i % stride) / cells, (double)(i / stride) / cells);
            set_vertex(&m, vertex++, &p);
        }
        for (int i = 0; i < cells * cells; i++) at = add_cell(&m, at, first + i / cells * stride + i % cells, stride);
        if (patches[k].is_spout) tip = k - SPOUT_TIP + 1;
    }
    at = add_tea(&m, &vertex, at, patches + tip, cells);
    m.index_count = at;
    fit_unit_sphere(&m);
    *out = m;
}

static void make_teapot(mesh *out)
{
    mesh_teapot(out, 8);
}

int mesh_builtin(mesh *out, const char *name)
{
    static const struct {
        const char *name;
        void (*make)(mesh *out);
    } shapes[] = {{"sphere", make_sphere}, {"teapot", make_teapot}, {"plane", make_plane}, {"torus", make_torus}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (strcmp(name, shapes[i].name)) continue;
        shapes[i].make(out);
        return 1;
    }
    return 0;
}
