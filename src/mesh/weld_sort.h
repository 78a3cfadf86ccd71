/* The canonical order of a mesh: vertices by position, triangles by index. */
#pragma once

#include "base/alloc.h"

/* A mesh whose vertices and triangles stand in any order. All borrowed. */
typedef struct scree_loose_mesh {
  const double *positions; /* distinct, finite */
  const uint8_t *used;     /* vertices with 0 are dropped; NULL: all are used */
  size_t vertex_count;
  const uint32_t *triangles; /* three different, used vertices each */
  size_t triangle_count;
} scree_loose_mesh;

/* Writes the same mesh in canonical order (see scree_mesh_weld). */
scree_status scree_weld_sort(const scree_loose_mesh *loose, scree_mesh *mesh, scree_error *error);
