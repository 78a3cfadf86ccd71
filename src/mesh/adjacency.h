/* Which facets meet at which edge, for meshes of any quality.
 *
 * Half-edge 3t + k runs along triangle t from corner k to corner k + 1. All half-edges between the
 * same two vertices, in either direction, form one edge; they are linked in a ring in ascending
 * order: ring[h] is the next half-edge of the same edge. So ring[h] == h on a boundary,
 * ring[ring[h]] == h on a manifold edge (ring[h] is the twin), and a longer cycle where three or
 * more facets meet. A triangle that names a vertex twice takes no part: its half-edges have
 * ring[h] == SCREE_NO_HALF_EDGE. */
#pragma once

#include "base/error.h"

#define SCREE_NO_HALF_EDGE UINT32_MAX

typedef struct scree_adjacency {
  uint32_t *ring;  /* 3 * triangle_count of the mesh */
  uint32_t *edges; /* the lowest half-edge of each edge, by its lower, then its higher vertex */
  size_t edge_count;
} scree_adjacency;

/* Builds it in O(N + longest fan * log) by a counting sort; needs 3 * triangle_count < 2^32 - 1 and
 * verified indices. 24 bytes per triangle stay, 30 more are used while building. Empty where it
 * fails. */
scree_status scree_adjacency_build(const scree_mesh *mesh, scree_adjacency *adjacency,
                                   scree_error *error);
void scree_adjacency_free(scree_adjacency *adjacency);

/* Whether it names three vertices. */
static inline bool scree_takes_part(const scree_adjacency *adjacency, size_t triangle) {
  return adjacency->ring[3 * triangle] != SCREE_NO_HALF_EDGE;
}

/* The half-edges before and after h in its triangle. */
static inline uint32_t scree_half_edge_next(uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
static inline uint32_t scree_half_edge_previous(uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}
/* The vertices that h runs from and to. */
static inline uint32_t scree_half_edge_from(const scree_mesh *mesh, uint32_t h) {
  return mesh->triangles[h];
}
static inline uint32_t scree_half_edge_to(const scree_mesh *mesh, uint32_t h) {
  return mesh->triangles[scree_half_edge_next(h)];
}

/* How many facets meet at the edge of h. */
static inline size_t scree_edge_facet_count(const scree_adjacency *adjacency, uint32_t h) {
  size_t count = 1;
  for (uint32_t g = adjacency->ring[h]; g != h; g = adjacency->ring[g]) count++;
  return count;
}

/* Union-find on indices: connected pieces of anything. parent[i] == i makes i a root. */
static inline uint32_t scree_find_root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}
/* The lower root wins, so roots do not depend on the order of the calls. */
static inline void scree_join(uint32_t *parent, uint32_t i, uint32_t j) {
  i = scree_find_root(parent, i), j = scree_find_root(parent, j);
  if (i < j)
    parent[j] = i;
  else
    parent[i] = j;
}
/* The facets connected through shared edges; parent has one of each facet. `manifold`: through
 * edges of two facets alone. */
void scree_join_over_edges(const scree_mesh *mesh, const scree_adjacency *adjacency, bool manifold,
                           uint32_t *parent);

/* ---- scree_mesh_topology (scree/measure.h) for callers that need the adjacency as well ---- */

/* Counts in a verified mesh. They come in parts that may run beside each other, each filling fields
 * of its own of a topology that is zero before. */
enum { SCREE_TOPOLOGY_PARTS = 3 };
scree_status scree_topology_count(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                  size_t part, scree_topology *topology, scree_error *error);
/* Once all parts are done: the rest. Where shells are not counted by then the genus means nothing.
 */
scree_status scree_topology_finish(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                   scree_topology *topology, scree_error *error);
