/* SPDX-License-Identifier: MIT */
/* Mesh files through assimp, in a process of its own: of broken files some make it abort, crash or never end. */
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apart.h"
#include "mesh_inner.h"
#include "vec3.h"

enum { MAX_CORNERS = 3 << 26, MAX_NODE_DEPTH = 256 };

/* ---- assimp's scene ----------------------------------------------------------------------- */

typedef struct load {
    const struct aiScene *scene;
    mesh *out; /* NULL while counting */
    uint8_t *normal_known;
    int64_t vertices, corners;
    failure *f;
} load;

/* m x (v, w), in double. */
static void transform(const struct aiMatrix4x4 *m, const struct aiVector3D *v, double w, double out[3])
{
    double x = (double)v->x, y = (double)v->y, z = (double)v->z;
    out[0] = (double)m->a1 * x + (double)m->a2 * y + (double)m->a3 * z + (double)m->a4 * w;
    out[1] = (double)m->b1 * x + (double)m->b2 * y + (double)m->b3 * z + (double)m->b4 * w;
    out[2] = (double)m->c1 * x + (double)m->c2 * y + (double)m->c3 * z + (double)m->c4 * w;
}

/* Cofactors of the upper 3 x 3: what normals turn by under any scale; returns the determinant. */
static double cofactors(const struct aiMatrix4x4 *m, double out[3][3])
{
    const double row[3][3] = {{(double)m->a1, (double)m->a2, (double)m->a3},
                              {(double)m->b1, (double)m->b2, (double)m->b3},
                              {(double)m->c1, (double)m->c2, (double)m->c3}};
    for (int i = 0; i < 3; i++) cross3(out[i], row[(i + 1) % 3], row[(i + 2) % 3]);
    return dot3(row[0], out[0]);
}

static int set_position(load *l, int at, const struct aiVector3D *from, const struct aiMatrix4x4 *matrix)
{
    mesh *m = l->out;
    const double stored[3] = {(double)from->x, (double)from->y, (double)from->z};
    double p[3];
    transform(matrix, from, 1, p);
    for (int k = 0; k < 3; k++) m->position[at][k] = (float)p[k];
    /* One bad component makes all three of the product bad: the file's own come first. */
    for (int k = 0; k < 6; k++) {
        double x = k < 3 ? stored[k] : (double)m->position[at][k - 3];
        if (!isfinite(x))
            return fail(l->f, FAIL_INVALID, "%s: vertex %d: found %c = %g, expected a finite number", m->name, at,
                        'x' + k % 3, x);
    }
    return FAIL_NONE;
}

static int set_normal(mesh *m, int at, const struct aiVector3D *from, double cofactor[3][3], double side)
{
    const double v[3] = {(double)from->x, (double)from->y, (double)from->z};
    double n[3] = {side * dot3(cofactor[0], v), side * dot3(cofactor[1], v), side * dot3(cofactor[2], v)};
    if (!mesh_direction(n)) return 0;
    for (int i = 0; i < 3; i++) m->normal[at][i] = (float)n[i];
    return 1;
}

static void set_tangent(mesh *m, int at, const struct aiMesh *part, unsigned i, const struct aiMatrix4x4 *matrix)
{
    double t[3], b[3], across[3], n[3];
    for (int k = 0; k < 3; k++) n[k] = (double)m->normal[at][k];
    transform(matrix, &part->mTangents[i], 0, t);
    transform(matrix, &part->mBitangents[i], 0, b);
    double along = dot3(t, n);
    for (int k = 0; k < 3; k++) t[k] -= along * n[k];
    if (!mesh_direction(t)) return;
    cross3(across, n, t);
    for (int k = 0; k < 3; k++) m->tangent[at][k] = (float)t[k];
    m->tangent[at][3] = dot3(across, b) < 0 ? -1 : 1;
}

static int add_vertices(load *l, const struct aiMesh *part, const struct aiMatrix4x4 *matrix)
{
    mesh *m = l->out;
    double cofactor[3][3], side = cofactors(matrix, cofactor) < 0 ? -1 : 1;
    for (unsigned i = 0; i < part->mNumVertices; i++) {
        int at = (int)l->vertices + (int)i;
        int code = set_position(l, at, &part->mVertices[i], matrix);
        if (code) return code;
        l->normal_known[at] = part->mNormals && set_normal(m, at, &part->mNormals[i], cofactor, side);
        if (!part->mTextureCoords[0]) continue;
        m->uv[at][0] = part->mTextureCoords[0][i].x;
        m->uv[at][1] = part->mTextureCoords[0][i].y;
        if (!isfinite(m->uv[at][0]) || !isfinite(m->uv[at][1]))
            return fail(l->f, FAIL_INVALID, "%s: vertex %d: found texture coordinates %g, %g, expected finite numbers",
                        m->name, at, (double)m->uv[at][0], (double)m->uv[at][1]);
        if (l->normal_known[at] && part->mTangents && part->mBitangents) set_tangent(m, at, part, i, matrix);
    }
    return FAIL_NONE;
}

static int add_faces(load *l, const struct aiMesh *part, int mirrored)
{
    mesh *m = l->out;
    uint32_t *to = m->index + l->corners;
    for (unsigned i = 0; i < part->mNumFaces; i++) {
        const struct aiFace *face = &part->mFaces[i];
        if (face->mNumIndices != 3) continue;
        for (int k = 0; k < 3; k++) {
            unsigned index = face->mIndices[mirrored ? 2 - k : k];
            if (index >= part->mNumVertices)
                return fail(l->f, FAIL_INVALID, "%s: face %u: found vertex %u, expected less than %u", m->name, i,
                            index, part->mNumVertices);
            *to++ = (uint32_t)l->vertices + index;
        }
    }
    return FAIL_NONE;
}

static int64_t count_corners(const struct aiMesh *part)
{
    int64_t corners = 0;
    for (unsigned i = 0; i < part->mNumFaces; i++) corners += part->mFaces[i].mNumIndices == 3 ? 3 : 0;
    return corners;
}

/* Every triangle mesh of a node and its children, in the root's space; only counted when there is no l->out. */
static int add_node(load *l, const struct aiNode *node, const struct aiMatrix4x4 *parent, int depth)
{
    struct aiMatrix4x4 matrix = *parent;
    double unused[3][3];
    aiMultiplyMatrix4(&matrix, &node->mTransformation);
    int mirrored = cofactors(&matrix, unused) < 0;
    if (depth > MAX_NODE_DEPTH) return fail(l->f, FAIL_UNSUPPORTED, "nodes nested deeper than %d", MAX_NODE_DEPTH);
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        const struct aiMesh *part = l->scene->mMeshes[node->mMeshes[i]];
        int64_t corners = count_corners(part);
        if (!corners) continue;
        if (l->out) {
            int code = add_vertices(l, part, &matrix);
            if (!code) code = add_faces(l, part, mirrored);
            if (code) return code;
        }
        l->vertices += part->mNumVertices;
        l->corners += corners;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        int code = add_node(l, node->mChildren[i], &matrix, depth + 1);
        if (code) return code;
    }
    return FAIL_NONE;
}

static int convert_scene(mesh *out, const struct aiScene *scene, const char *name, failure *f)
{
    struct aiMatrix4x4 identity;
    aiIdentityMatrix4(&identity);
    load l = {.scene = scene, .f = f};
    int code = scene->mRootNode ? add_node(&l, scene->mRootNode, &identity, 0) : FAIL_NONE;
    if (code) return fail(f, code, "%s: found nodes nested deeper than %d, expected fewer", name, MAX_NODE_DEPTH);
    if (!l.corners) return fail(f, FAIL_INVALID, "%s: mesh without faces", name);
    if (l.corners > MAX_CORNERS || l.vertices > MAX_CORNERS)
        return fail(f, FAIL_UNSUPPORTED, "%s: found %lld triangles, expected at most %d", name,
                    (long long)(l.corners / 3), MAX_CORNERS / 3);
    mesh m = mesh_make(name, (int)l.vertices, (int)l.corners);
    l.normal_known = need_memory((size_t)m.vertex_count, 1);
    l.out = &m;
    l.vertices = l.corners = 0;
    code = add_node(&l, scene->mRootNode, &identity, 0);
    if (!code && memchr(l.normal_known, 0, (size_t)m.vertex_count)) mesh_make_normals(&m, l.normal_known);
    if (!code) mesh_make_tangents(&m);
    free(l.normal_known);
    if (code) {
        mesh_free(&m);
        return code;
    }
    *out = m;
    return FAIL_NONE;
}

/* assimp's reason, as the rest of one line. */
static int fail_import(failure *f, const char *name)
{
    char reason[400];
    snprintf(reason, sizeof reason, "%s", aiGetErrorString());
    for (char *c = reason; *c; c++)
        if ((unsigned char)*c < ' ') *c = ' ';
    return fail(f, FAIL_INVALID, "%s: not a mesh that can be read: %s", name, *reason ? reason : "unknown content");
}

/* What assimp's later steps trust: faces have corners, and corners are vertices. */
static int check_faces(const struct aiScene *scene, const char *name, failure *f)
{
    for (unsigned k = 0; k < scene->mNumMeshes; k++) {
        const struct aiMesh *part = scene->mMeshes[k];
        for (unsigned i = 0; i < part->mNumFaces; i++) {
            const struct aiFace *face = &part->mFaces[i];
            if (!face->mNumIndices)
                return fail(f, FAIL_INVALID, "%s: face %u: found no vertices, expected 3 or more", name, i);
            for (unsigned c = 0; c < face->mNumIndices; c++)
                if (face->mIndices[c] >= part->mNumVertices)
                    return fail(f, FAIL_INVALID, "%s: face %u: found vertex %u, expected less than %u", name, i,
                                face->mIndices[c], part->mNumVertices);
        }
    }
    return FAIL_NONE;
}

static int import_here(mesh *out, const char *name, failure *f)
{
    const struct aiScene *scene = aiImportFile(name, 0);
    if (!scene) return fail_import(f, name);
    int code = check_faces(scene, name, f);
    if (!code) {
        scene = aiApplyPostProcessing(scene,
                                      aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
        if (!scene) return fail_import(f, name);
        code = convert_scene(out, scene, name, f);
    }
    aiReleaseImport(scene);
    return code;
}

/* ---- the process around it ---------------------------------------------------------------- */

typedef struct reply { /* then the arrays in the order of struct mesh */
    int code, vertex_count, index_count;
    char text[sizeof((failure *)0)->text];
} reply;

static int transfer(int fd, void *data, size_t size, int out)
{
    return out ? apart_write(fd, data, size) : apart_read(fd, data, size);
}

static int transfer_arrays(int fd, mesh *m, int out)
{
    size_t vertices = (size_t)m->vertex_count;
    return transfer(fd, m->position, vertices * sizeof *m->position, out) ||
           transfer(fd, m->normal, vertices * sizeof *m->normal, out) ||
           transfer(fd, m->tangent, vertices * sizeof *m->tangent, out) ||
           transfer(fd, m->uv, vertices * sizeof *m->uv, out) ||
           transfer(fd, m->index, (size_t)m->index_count * sizeof *m->index, out);
}

/* In the child: only the reply counts. */
static int reply_with_mesh(int fd, const char *name)
{
    mesh m = {0};
    failure f = {0};
    reply r = {.code = import_here(&m, name, &f)};
    r.vertex_count = m.vertex_count;
    r.index_count = m.index_count;
    memcpy(r.text, f.text, sizeof r.text);
    return transfer(fd, &r, sizeof r, 1) || (!r.code && transfer_arrays(fd, &m, 1));
}

static int take_reply(mesh *out, int fd, const char *name, failure *f)
{
    reply r;
    if (transfer(fd, &r, sizeof r, 0)) return fail(f, FAIL_INTERNAL, "%s: mesh loader: no reply", name);
    if (r.code) return fail(f, r.code, "%s", r.text);
    mesh m = mesh_make(name, r.vertex_count, r.index_count);
    if (transfer_arrays(fd, &m, 0)) {
        mesh_free(&m);
        return fail(f, FAIL_INTERNAL, "%s: mesh loader: short reply", name);
    }
    *out = m;
    return FAIL_NONE;
}

int mesh_import(mesh *out, const char *name, failure *f)
{
    int fd, code = apart_run(reply_with_mesh, name, "mesh", &fd, f);
    if (code) return code;
    code = take_reply(out, fd, name, f);
    close(fd);
    return code;
}
