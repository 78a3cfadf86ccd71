/* Do two triangles of a mesh meet where they should not? Exact, and free of tolerances.
 *
 * Triangles of a clean surface have nothing in common but the vertices and the edge that they
 * share. What they have beyond that is classified here. Vertices are shared when their indices are
 * equal: weld first. */
#ifndef SCREE_MESH_INTERSECT_H
#define SCREE_MESH_INTERSECT_H

#include "base/progress.h"
#include "mesh/predicates.h"

typedef enum scree_meet {
  SCREE_MEET_NOT,     /* nothing in common beyond what they share */
  SCREE_MEET_TOUCH,   /* common points, but neither passes through the other: a vertex or an edge of
                         one lies on the other, or two edges cross */
  SCREE_MEET_CROSS,   /* they pass through each other along a segment */
  SCREE_MEET_OVERLAP, /* coplanar with a common area: doubled, or folded flat over a shared edge */
} scree_meet;

/* Classifies triangles t and u of three vertex indices each; bounding boxes are not looked at, so
 * compare those first (scree_boxes_apart). The order of the two, and of the corners in each, does
 * not matter. A triangle without area meets nothing. Cost: about 20 ns where a plane obviously
 * separates them, a microsecond or two where rounding could deceive. */
scree_meet scree_triangles_meet(const double *positions, const uint32_t t[3], const uint32_t u[3]);

/* Whether the bounding boxes of two triangles have no point in common. */
bool scree_boxes_apart(const double *positions, const uint32_t t[3], const uint32_t u[3]);

/* True where all three corners lie on one line (or coincide), exactly. */
bool scree_triangle_is_flat(const double *positions, const uint32_t t[3]);

#endif
