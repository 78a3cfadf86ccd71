/* Integrals over a mesh for internal use: no checks, chosen origin. */
#pragma once

#include "mesh/mesh.h"

/* Bounds of the corners of all triangles; of nothing (infinite, reversed) without triangles. */
void scree_mesh_bounds(const scree_mesh *mesh, vec3 *low, vec3 *high);

/* Whether every edge is used equally often in both directions: the surface has no boundary, and its
 * volume depends on no origin. O(N) without memory: the sum over all half-edges of a 128-bit hash
 * of the vertex pair, positive one way and negative the other, is zero; a miss has odds of 2^-128.
 */
bool scree_mesh_is_cycle(const scree_mesh *mesh);
