/* In place of qhull, which is not there in 32 bits: every point is a corner, without triangles, as
 * of a flat body. */
#include "base/array.h"
#include "mesh/measure/hull.h"

scree_status scree_hull_build(const vec3 *points, size_t point_count, scree_hull *hull,
                              scree_error *error) {
  SCREE_ALLOC_OR(hull->points, point_count, error, out_of_memory);
  hull->point_count = point_count;
  for (size_t i = 0; i < point_count; i++) hull->points[i] = points[i];
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_hull_free(scree_hull *hull) {
  scree_free(hull->points);
}
