/* Convex hulls. */
#pragma once

#include "base/error.h"
#include "base/vec.h"
#include "mesh/mesh.h"

/* The hull as a triangulated surface. Where the points lie in a plane, on a line or in one point to
 * within rounding, there are no triangles, area and volume are 0, and points holds all of them. */
typedef struct scree_hull {
  vec3 *points; /* the corners */
  size_t point_count;
  uint32_t *triangles; /* 3 * triangle_count, outward */
  size_t triangle_count;
  double area, volume;
} scree_hull;

/* By qhull (O(n log n) for n points, some 0.3 kB and 10 us per corner of the hull); its memory does
 * not pass through scree_alloc, and it cannot be asked to stop. Best called with points about the
 * origin. */
scree_status scree_hull_build(const vec3 *points, size_t point_count, scree_hull *hull,
                              scree_error *error);
void scree_hull_free(scree_hull *hull);

/* The hull as a mesh; one of flat points has no triangles. */
scree_status scree_hull_mesh(const vec3 *points, size_t point_count, scree_mesh *mesh,
                             scree_error *error);
