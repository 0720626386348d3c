/* SPDX-License-Identifier: MIT */
/* The parts of mesh.c that mesh_builtin.c and mesh.c share. */
#ifndef MESH_BUILTIN_H
#define MESH_BUILTIN_H

#include "mesh.h"

/* Arrays of so many vertices and indices, zero. */
mesh mesh_make(const char *name, int vertex_count, int index_count);

/* One of the built-in shapes; 0 if there is none of this name. Needs no file. */
int mesh_builtin(mesh *out, const char *name);
/* Their names, for messages. */
#define MESH_BUILTIN_NAMES "sphere, teapot, plane, torus"

#endif
