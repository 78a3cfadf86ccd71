/* Meshes with closed forms, for tests and demonstrations. */
#pragma once

#include "base/error.h"

/* A cube about the origin, every face a grid of cells x cells squares cut into two triangles:
 * 12 cells^2 triangles. cells in [1, 8192]. */
scree_status scree_sample_box(double edge, size_t cells, scree_mesh *mesh, scree_error *error);

/* An icosahedron whose triangles are cut into four `level` times and put on the sphere about the
 * origin: 20 * 4^level triangles. level in [0, 11]. */
scree_status scree_sample_icosphere(double radius, int level, scree_mesh *mesh, scree_error *error);
