/* Points spread evenly over a surface, each standing for the same share of its area. */
#pragma once

#include "base/error.h"
#include "base/vec.h"

typedef struct scree_spread {
  size_t count;
  vec3 *points;
  vec3 *normals; /* unit, of the facet that the point lies on */
  /* The surface's vertices, those near point i from starts[i] to starts[i + 1], and how far the
   * farthest of them lies from it. */
  uint32_t *vertices, *starts;
  double *reach;
} scree_spread;

/* Spreads about `count` points over a verified mesh with area. The same points for any number of
 * threads. O(N). */
scree_status scree_spread_make(const scree_mesh *mesh, size_t count, scree_spread *spread,
                               scree_error *error);
void scree_spread_free(scree_spread *spread);
