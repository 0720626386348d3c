/* SPDX-License-Identifier: MIT */
/* What mesh.c, mesh_file.c and mesh_builtin.c share. */
#ifndef MESH_INNER_H
#define MESH_INNER_H

#include "mesh.h"

/* Arrays of so many vertices and indices, zero. */
mesh mesh_make(const char *name, int vertex_count, int index_count);

/* One of the built-in shapes; 0 if there is none of this name. Needs no file. */
int mesh_builtin(mesh *out, const char *name);
/* Their names, for messages. */
#define MESH_BUILTIN_NAMES "sphere, teapot, plane, torus"

/* The teapot with patches of cells x cells; built in: 8. */
void mesh_teapot(mesh *out, int cells);

/* A file that exists, by its suffix. Node transforms are applied, points and lines left out; FAIL_INVALID: content. */
int mesh_import(mesh *out, const char *name, failure *f);

/* Make v a unit vector, however small or large it is. Returns 0, and leaves v alone, if it has no direction. */
int mesh_direction(double v[3]);

/* Give every vertex of which known[] is 0 the mean normal of the triangles around its place, whatever their uv.
   Triangles without area count nothing; a vertex that has no others gets +z. */
void mesh_make_normals(mesh *m, const uint8_t *known);
/* Give every vertex with tangent[3] == 0 the direction of growing u, perpendicular to its normal, or, where uv says
   nothing, any such direction. Where mirrored halves of a texture share a vertex, the larger decides the handedness. */
void mesh_make_tangents(mesh *m);

#endif
