/* One edge collapse: its surroundings, whether it is allowed, doing it. */
#ifndef SCREE_SIMPLIFY_COLLAPSE_H
#define SCREE_SIMPLIFY_COLLAPSE_H

#include "simplify/halfmesh.h"

/* Collapses that would leave a vertex with more neighbours are refused. */
enum { SCREE_RING_MAX = 256 };

/* The edge (a, b) and the triangles around it that stay: triangle i has the half-edge edge[i]
 * across from a (i < a_count) or from b. Around a, then around b, counter-clockwise each: a closed
 * loop from apex c over a's side to apex d and over b's side back, unless a boundary interrupts it.
 */
typedef struct scree_ring {
  uint32_t half_edge, a, b, c, d; /* d NONE: the edge is boundary */
  uint32_t a_count, count;
  uint32_t *edge; /* the caller's room for SCREE_RING_MAX */
  vec3 low, high; /* box of all corners, old and new; set by scree_collapse_check */
} scree_ring;

typedef struct scree_change {
  vec3 target;
  double area, volume; /* change of them, unit box */
} scree_change;

/* Fills the ring; ring->edge must have room for SCREE_RING_MAX. False: more triangles than that. */
bool scree_ring_gather(const scree_halfmesh *s, uint32_t half_edge, scree_ring *ring);

/* The triangles around one vertex, as a ring of which both ends are this vertex and no triangle
 * goes: c and d are NONE. What asks about a collapse answers for a move of the vertex then. False:
 * the vertex is on a boundary, or there are more triangles than that. */
bool scree_ring_gather_fan(const scree_halfmesh *s, uint32_t vertex, scree_ring *ring);

/* Ends and apexes of the ring from its half-edge. */
void scree_ring_name(const scree_halfmesh *s, uint32_t half_edge, scree_ring *ring);

/* Triangle k of those around: the ring's, then the edge's own; and how many these are. */
static inline uint32_t scree_ring_triangle(const scree_halfmesh *s, const scree_ring *r,
                                           uint32_t k) {
  uint32_t h = k < r->count    ? r->edge[k]
               : k == r->count ? r->half_edge
                               : s->half[r->half_edge].twin;
  return h / 3;
}
static inline uint32_t scree_ring_triangle_count(const scree_ring *r) {
  return r->count + (r->c != SCREE_NONE) + (r->d != SCREE_NONE);
}

/* The corners of the ring's triangle i, with its moving corner, the first, at x; of all. */
void scree_ring_corners_at(const scree_halfmesh *s, const scree_ring *ring, uint32_t i, vec3 x,
                           double *corners);
void scree_ring_corners(const scree_halfmesh *s, const scree_ring *ring, vec3 target,
                        double (*corners)[9]);

/* Cosine of a fold, 149 degrees: one to spare for coordinates rounded to float. */
#define SCREE_FOLD (-0.857)

/* Whether the doubled area vectors make a fold. */
static inline bool scree_folded(vec3 n, vec3 m) {
  double dot = vec3_dot(n, m);
  return dot < 0 && dot * dot > SCREE_FOLD * SCREE_FOLD * vec3_norm2(n) * vec3_norm2(m);
}

/* Whether the surface stays a manifold (link condition) if the edge is collapsed. */
bool scree_collapse_keeps_topology(const scree_halfmesh *s, const scree_ring *ring);

/* The doubled area vectors of the ring's triangles. */
typedef struct scree_around {
  vec3 before[SCREE_RING_MAX], after[SCREE_RING_MAX];
  bool steep; /* some new triangle is at more than 60 degrees to its neighbour outside the ring */
} scree_around;

/* The cosine of the largest turn of a triangle's normal in one collapse: 84 degrees. What stands on
 * the surface steeply, and is small against the triangles of a coarse level, can only go by larger
 * ones: 107 degrees. Folds and meetings are looked for in either case. */
#define SCREE_LEAST_TURN        0.1
#define SCREE_LEAST_COARSE_TURN (-0.3)

/* Whether the triangles around change->target would be sound: none turned farther than that,
 * degenerate, a sliver worse than those before, no more folds than before. Fills the rest of
 * change, the box, and *around; what they hold is complete only where the answer is true. */
bool scree_collapse_check(const scree_halfmesh *s, scree_ring *ring, double least_turn,
                          scree_change *change, scree_around *around);

/* Of this what asks about the ring's triangles and the edge's own, and not about those beyond: the
 * answer stays while no vertex of the ring moves or goes. */
bool scree_collapse_suits_ring(const scree_halfmesh *s, scree_ring *ring, double least_turn,
                               vec3 target);

/* Collapses: a moves to target, b goes, with the triangles at the edge. Touches only triangles of
 * the two fans and the outgoing half-edges of a, b, c and d. */
void scree_collapse_apply(scree_halfmesh *s, const scree_ring *ring, vec3 target);

#endif
