/* How wide a surface is along fixed directions. */
#pragma once

#include "base/error.h"
#include "base/vec.h"

/* Along the edges of an octahedron there are so many steps from one axis to the next. */
enum {
  SCREE_EXTENT_STEPS = 7,
  SCREE_EXTENT_COUNT = 2 * SCREE_EXTENT_STEPS * SCREE_EXTENT_STEPS + 1
};

/* From low to high along each direction (x, y, z), side by side for loops over them; the first
 * three are the frame's axes. */
typedef struct scree_extent {
  double x[SCREE_EXTENT_COUNT], y[SCREE_EXTENT_COUNT], z[SCREE_EXTENT_COUNT];
  double low[SCREE_EXTENT_COUNT], high[SCREE_EXTENT_COUNT];
} scree_extent;

/* The extent of nothing yet. The frame's rows are orthonormal. The directions are the same
 * whichever way round and in whichever order these come. */
void scree_extent_start(scree_extent *extent, const double frame[3][3]);
void scree_extent_add(scree_extent *extent, vec3 p);

/* The extent of a mesh's facets. O(N). */
void scree_extent_of_mesh(scree_extent *extent, const double frame[3][3], const scree_mesh *mesh);

static inline double scree_extent_along(const scree_extent *extent, int i, vec3 p) {
  return extent->x[i] * p.x + extent->y[i] * p.y + extent->z[i] * p.z;
}
static inline double scree_extent_width(const scree_extent *extent, int i) {
  return extent->high[i] - extent->low[i];
}

/* Where p lies nearest to an end of the extent, as a share of the width there: direction i, ~i for
 * the low end. */
int scree_extent_end(const scree_extent *extent, vec3 p);
/* How far p lies within that end. */
static inline double scree_extent_depth(const scree_extent *extent, int end, vec3 p) {
  int i = end < 0 ? ~end : end;
  double along = scree_extent_along(extent, i, p);
  return end < 0 ? along - extent->low[i] : extent->high[i] - along;
}

/* How far p lies beyond the extent, at most, times size over the width there where that is less
 * than `size`; 0 within. */
double scree_extent_beyond(const scree_extent *extent, vec3 p, double size);
