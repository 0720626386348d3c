/* SPDX-License-Identifier: MIT */
/* Triangle meshes: files through assimp, built-in shapes, and the runtime's packed form. */
#ifndef MESH_H
#define MESH_H

#include "nacre.h"
#include "output.h"

typedef struct mesh {              /* object space, right-handed, +y up; malloc'd */
    int vertex_count, index_count; /* index_count = 3 x triangles, counter-clockwise front */
    float (*position)[3];
    float (*normal)[3];  /* unit */
    float (*tangent)[4]; /* unit, w = handedness +-1: bitangent = w cross(normal, tangent) */
    float (*uv)[2];      /* v up */
    uint32_t *index;
    char name[256];
} mesh;

/* A built-in shape or a file (.obj, .gltf, .glb, .ply, .stl; node transforms applied, points and lines left out).
     sphere  radius 1 around the origin, 128 x 64 cells, exact normals
     teapot  Newell's, 4,048 triangles, y up, spout along +x, centred, its farthest vertex at distance 1
     plane   -1..1 in x and y, facing +z, uv 0..1
     torus   radius 1 in the plane z = 0, tube 0.4
   Missing normals (smooth, by angle) and tangents (from uv, else any) are made. *out is left alone on failure.
   FAIL_IO: no such file or shape, or can't be read. FAIL_UNSUPPORTED: another suffix, or too large. FAIL_INVALID:
   content, no faces, numbers that are not finite; files are read in a child process, so this includes those that make
   the loader crash or take longer than 10 s + 1 s per MB. */
int mesh_open(mesh *out, const char *name, failure *f);
void mesh_free(mesh *m);
/* Bounds: centre and half extent per axis. */
void mesh_bounds(const mesh *m, float centre[3], float half_extent[3]);

/* Runtime meshes of at most 65,535 vertices each, triangles in their order; *count of them in *parts (one malloc'd block,
   free() frees all). All parts have the whole mesh's bounds, so no cracks open between them. Positions are off by at most
   half_extent / 65534 per axis. uv beyond -16..16 are shifted by whole numbers, triangle by triangle.
   FAIL_UNSUPPORTED: positions beyond +-32767, or a triangle's uv more than 32 wide. */
int mesh_pack(const mesh *m, nacre_mesh **parts, int *count, failure *f);

/* For firmware. F.c: `const nacre_vertex NAME_vertices[]`, `const uint16_t NAME_indices[]`,
   `const nacre_mesh NAME` (NAME_0, NAME_1, ... when split). F.bin: little-endian u32 "NMSH", version 1, parts, then per
   part u32 vertex_count, index_count, s32 centre[3], half_extent[3], vertices, indices (padded to 4). */
int mesh_write(const mesh *m, const char *path, failure *f);

#endif
