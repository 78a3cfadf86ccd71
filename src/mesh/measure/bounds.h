/* What is asked of a mesh before anything is measured on it. */
#pragma once

#include "mesh/adjacency.h"
#include "mesh/index/intersect.h"
#include "mesh/measure/hull.h"
#include "mesh/mesh.h"

/* Bounds of the corners of all triangles; of nothing (infinite, reversed) without triangles. */
void scree_mesh_bounds(const scree_mesh *mesh, vec3 *low, vec3 *high);

/* Whether every edge is used equally often in both directions: the surface has no boundary, and its
 * volume depends on no origin. O(N) without memory: the sum over all half-edges of a 128-bit hash
 * of the vertex pair, positive one way and negative the other, is zero; a miss has odds of 2^-128.
 */
bool scree_mesh_is_cycle(const scree_mesh *mesh);

/* A box of least volume around points. */
typedef struct scree_minimum_box {
  mat3 axes; /* rows: unit directions of the sides, right-handed */
  vec3 size; /* along the rows, descending */
  vec3 center;
} scree_minimum_box;

/* Fits a box around a hull (see the top of minimum_box.c for how near to the least it comes); axes
 * are three more directions to try, such as the principal ones. Never larger than the axis-aligned
 * box, or the box along axes. */
scree_status scree_minimum_box_fit(const scree_hull *hull, const mat3 *axes, scree_minimum_box *box,
                                   scree_error *error);

/* The volume of the union of closed shells that may cross, touch and overlap: of the space where
 * the winding number of the mesh is positive, m^3. found holds all meetings of the tree's mesh,
 * whose edges are all used equally often both ways. *known is false, and *volume left alone, where
 * a winding number is negative somewhere (a part is inside out), where a sample point keeps falling
 * on edges, or where facets are cut in too many pieces. Relative error about 1e-12. Cost: about ten
 * microseconds per facet that meets another and per piece of surface between such facets. */
scree_status scree_union_volume(const scree_facet_tree *tree, const scree_adjacency *adjacency,
                                const scree_meetings *found, double *volume, bool *known,
                                scree_error *error);
