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

/* ---- welding within a tolerance ---- */

/* Unites the vertices of a canonical mesh that are linked by steps of at most tolerance times its
 * bounding box diagonal, and brings the result into canonical order (see scree_mesh_weld). The mesh
 * is untouched on failure. */
scree_status scree_weld_near(scree_mesh *mesh, double tolerance, scree_error *error);

/* ---- the canonical order of a mesh: vertices by position, triangles by index ---- */

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
