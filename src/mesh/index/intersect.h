/* Do two triangles of a mesh meet where they should not? Exact, and free of tolerances.
 *
 * Triangles of a clean surface have nothing in common but the vertices and the edge that they
 * share. What they have beyond that is classified here. Vertices are shared when their indices are
 * equal: weld first. */
#pragma once

#include "base/progress.h"
#include "mesh/index/facet_tree.h"
#include "mesh/predicates.h"

typedef enum scree_meet {
  SCREE_MEET_NOT,     /* nothing in common beyond what they share */
  SCREE_MEET_TOUCH,   /* common points, but neither passes through the other: a vertex or an edge of
                         one lies on the other, or two edges cross */
  SCREE_MEET_CROSS,   /* they pass through each other along a segment */
  SCREE_MEET_OVERLAP, /* coplanar with a common area: doubled, or folded flat over a shared edge */
} scree_meet;

/* Classifies triangles t and u of three vertex indices each; bounding boxes are not looked at, so
 * compare those first (scree_box_meets). The order of the two, and of the corners in each, does
 * not matter. A triangle without area meets nothing. Cost: about 20 ns where a plane obviously
 * separates them, a microsecond or two where rounding could deceive. */
scree_meet scree_triangles_meet(const double *positions, const uint32_t t[3], const uint32_t u[3]);

/* A pair of facets that meet where they should not; first < second. */
typedef struct scree_meeting {
  uint32_t first, second;
  scree_meet meet;
} scree_meeting;

typedef struct scree_meetings {
  scree_meeting *items; /* ascending */
  size_t count, capacity;
  bool truncated; /* more than the limit: items is empty, count is the limit */
} scree_meetings;

/* All pairs of facets of a verified mesh (finite, indices in range) that meet beyond what they
 * share. With more than `limit` of them the search ends early. Cost: O(N log N + pairs found) where
 * facets are spread as on a surface, however thin and slanted they are; about a microsecond of one
 * core per facet, on all threads. Free items with scree_free. */
scree_status scree_facet_meetings(const scree_facet_tree *tree, size_t limit,
                                  const scree_progress *progress, scree_meetings *found,
                                  scree_error *error);
/* The same but for pairs of which both facets are `settled` (by facet). The cost is that of looking
 * for the others. */
scree_status scree_facet_meetings_new(const scree_facet_tree *tree, const bool *settled,
                                      size_t limit, const scree_progress *progress,
                                      scree_meetings *found, scree_error *error);
/* The same with a tree of its own, of what is near the others where these are few; settled NULL:
 * none is. The mesh may be empty. */
scree_status scree_mesh_meetings(const scree_mesh *mesh, const bool *settled, size_t limit,
                                 const scree_progress *progress, scree_meetings *found,
                                 scree_error *error);
