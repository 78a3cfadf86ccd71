/* How far a collapse takes the surface astray: the largest of the distances of
 *   - the witnesses of the triangles that change, from the new ones, where it grows;
 *   - the new vertex and some places on every new edge, from the surface kept.
 * In batches, as long as no surface is kept: of the new vertex from the old triangles; as long as
 * there are no witnesses, of the middles of the new edges from the surface besides. */
#ifndef SCREE_SIMPLIFY_STRAY_H
#define SCREE_SIMPLIFY_STRAY_H

#include "simplify/memory.h"

/* Places looked at on each new edge, and where levels are held close: a long edge passes over
 * narrow grooves. */
enum { SCREE_EDGE_PLACES = 5, SCREE_MOST_EDGE_PLACES = 11 };

/* Of one ring, from one target to the next, for their places lie near each other: what was near to
 * each place, and which was farthest off. It changes no answer. Begin with scree_no_hints. */
typedef struct scree_hints {
  uint32_t known;    /* places, the new vertex first; 0: none yet */
  uint32_t farthest; /* place; 0: not known */
  uint32_t
      near[1 + SCREE_MOST_EDGE_PLACES * SCREE_RING_MAX]; /* kept triangles, in the tree's order */
} scree_hints;

static inline void scree_no_hints(scree_hints *hints) {
  hints->known = hints->farthest = 0;
}

/* The square of the stray, or `least`, where it is smaller; where it is above `most`, something
 * above that is enough. These are squares as well. Of the places on every edge the first so many,
 * the middle first. */
double scree_memory_stray(const scree_memory *memory, const scree_halfmesh *s,
                          const scree_ring *ring, vec3 target, uint32_t places_on_edge,
                          double least, double most, scree_hints *hints);

/* Of a vertex at x, and of the places on the edges from there to the fan's rim: the largest squared
 * distance from the surface kept, or `least`, where it is smaller; whether it is at most `most`. */
double scree_memory_edges_stray(const scree_memory *memory, const scree_halfmesh *s,
                                const scree_ring *fan, vec3 x, double least, scree_hints *hints);
bool scree_memory_edges_within(const scree_memory *memory, const scree_halfmesh *s,
                               const scree_ring *fan, vec3 x, double most, scree_hints *hints);

/* In batches: whether the stray is at most `most`, both squared, with the first so many places on
 * every edge, the middle first; that of the witnesses only once there are any. */
bool scree_memory_stays_within(const scree_memory *memory, const scree_halfmesh *s,
                               const scree_ring *ring, vec3 target, uint32_t places_on_edge,
                               double most);

/* What the collapse alone makes of them: by how much the sum of the distances grows, and the
 * largest squared distance of a witness of the ring's triangles, of the new vertex or of a place on
 * a new edge, or `least`, where it is smaller. */
double scree_memory_growth(const scree_memory *memory, const scree_halfmesh *s,
                           const scree_ring *ring, vec3 target, double least, double *worst);

/* The largest squared distance of all: of a witness, of a vertex or of a place on an edge; in
 * parallel. */
double scree_memory_farthest(const scree_memory *memory, const scree_halfmesh *s);
/* The squared distance of one vertex; the largest of the places on one edge; or `least`, where it
 * is smaller. */
double scree_memory_vertex_stray(const scree_memory *memory, const scree_halfmesh *s,
                                 uint32_t vertex, double least);
double scree_memory_edge_stray(const scree_memory *memory, const scree_halfmesh *s,
                               uint32_t half_edge, double least);

/* A place on the level, at this share of the way along a half-edge, that is far from the surface
 * kept, and where that is nearest. */
typedef struct scree_far_place {
  uint32_t half_edge;
  double share;
  vec3 at, nearest;
  double distance2;
} scree_far_place;

/* Places looked at of each half-edge: a vertex and those on its edge, if they are its to tell; and
 * what was found of one before, somewhere nearby. */
enum { SCREE_LEVEL_PLACES = 1 + SCREE_EDGE_PLACES };
typedef struct scree_place_hint {
  vec3 at;       /* where it was */
  double within; /* no farther off than that there */
  uint32_t near; /* the triangle kept that is that near */
} scree_place_hint;

/* Lists the vertices and places on edges that are farther off than `least`, squared, and tells how
 * many these are. hints: per half-edge, `hinted`: from any level of the same kept surface; they
 * change no answer. */
size_t scree_memory_far_places(const scree_memory *memory, const scree_halfmesh *s, double least,
                               bool hinted, scree_place_hint (*hints)[SCREE_LEVEL_PLACES],
                               scree_far_place *far);

/* In batches, before: whether the new vertex is so near to the old triangles; whether the old ends
 * are to the new ones. Squared. */
bool scree_stays_within(const scree_halfmesh *s, const scree_ring *ring, vec3 target, double most);
bool scree_ends_stay_within(const scree_halfmesh *s, const scree_ring *ring, vec3 target,
                            double most);

#endif
