/* SPDX-License-Identifier: MIT */
/* Triangle meshes: files through assimp, built-in shapes, and the runtime's packed form. */
#ifndef MESH_H
#define MESH_H

#include "nacre.h"
#include "output.h"

typedef struct mesh { /* object space, right-handed, +y up; malloc'd */
    int vertex_count, index_count; /* index_count = 3 x triangles, counter-clockwise front */
    float (*position)[3];
    float (*normal)[3];  /* unit */
    float (*tangent)[4]; /* unit, w = handedness +-1: bitangent = w cross(normal, tangent) */
    float (*uv)[2];      /* v up */
    uint32_t *index;
    char name[256];
} mesh;

/* "sphere", "teapot", "plane", "torus", or a file (OBJ, glTF, GLB, PLY, STL). Missing normals and tangents are made. */
int mesh_open(mesh *out, const char *name, failure *f);
void mesh_free(mesh *m);
/* Bounds: centre and half extent per axis. */
void mesh_bounds(const mesh *m, float centre[3], float half_extent[3]);

/* Runtime meshes of at most 65,535 vertices each; *count of them in *parts (one malloc'd block, free() frees all). */
int mesh_pack(const mesh *m, nacre_mesh **parts, int *count, failure *f);

/* For firmware. F.c: `const nacre_vertex NAME_vertices[]`, `const unsigned short NAME_indices[]`,
   `const nacre_mesh NAME` (NAME_0, NAME_1, ... when split). F.bin: little-endian u32 "NMSH", version 1, parts, then per
   part u32 vertex_count, index_count, s32 centre[3], half_extent[3], vertices, indices (padded to 4). */
int mesh_write(const mesh *m, const char *path, failure *f);

#endif
