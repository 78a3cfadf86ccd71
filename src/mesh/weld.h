/* From loose triangles to an indexed mesh in canonical order: what every reader ends with. */
#pragma once

#include "base/alloc.h"

/* The largest coordinate, in metres: products of up to ten still fit a double. */
#define SCREE_COORDINATE_LIMIT 1e30
/* Triangles of one mesh: three corners each have an index below 2^32. */
#define SCREE_TRIANGLE_LIMIT ((size_t)1400000000)

/* Fills out[0 .. 3 count) with the positions, in metres, of the corners [first, first + count). */
typedef void scree_corner_fetch(const void *context, size_t first, size_t count, double *out);

/* Where the corners to be welded come from. With triangles NULL, corners 3t..3t+2 are triangle t;
 * else triangles holds 3 * triangle_count indices below corner_count. */
typedef struct scree_corner_source {
  scree_corner_fetch *fetch;
  const void *context;
  size_t corner_count;
  const uint32_t *triangles;
  size_t triangle_count;
} scree_corner_source;

/* scree_mesh_weld for any source. Where a coordinate is not finite or beyond the limit, answers
 * SCREE_BAD_ARGUMENT, and *bad_corner (may be NULL) is the first such corner. */
scree_status scree_weld_corners(const scree_corner_source *source, double tolerance,
                                scree_mesh *mesh, size_t *degenerate_count, size_t *bad_corner,
                                scree_error *error);
