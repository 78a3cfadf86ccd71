/* How far a collapse takes the surface astray.
 *
 * The surface is kept as a tree at some point, and later vertices of the scan (keep.c). Each of
 * these, a witness, knows a triangle that stands for it now, the nearest of those that took the
 * place of the last one, and its distance from it. The stray of a collapse is the largest of the
 * distances of
 *   - the witnesses of the triangles that change, from the new ones, where it grows;
 *   - the new vertex and five places on every new edge, from the surface kept.
 * In batches, as long as no surface is kept: of the new vertex from the old triangles; as long as
 * there are no witnesses, of the middles of the new edges from the surface besides. */
#ifndef SCREE_SIMPLIFY_STRAY_H
#define SCREE_SIMPLIFY_STRAY_H

#include "mesh/bvh.h"
#include "simplify/collapse.h"

typedef struct scree_witness {
  vec3 at;
  double distance2; /* from its triangle, squared; below 0: dropped */
  uint32_t next;    /* of the same triangle, or NONE */
  float weight;     /* what it counts in the mean */
} scree_witness;

/* From a triangle of the surface kept on towards a place, and how far off that is. In single
 * precision: it tells where to look, and bounds the distance of what lies above the triangle. A
 * cache line each. */
typedef struct scree_way {
  float second[4], third[4]; /* shares of these corners at a place x: second[0..2].x + second[3] */
  float height[4];           /* of x above the plane, likewise */
  uint32_t beside[3];        /* triangles across the edge from corner k, or NONE */
  float error; /* what rounding may take off the distance of a place that seems to lie above */
} scree_way;

/* Where to begin looking for a place: of every cell of a grid about the surface a triangle in it,
 * in the tree's order, or NONE. */
typedef struct scree_starts {
  uint32_t *triangle;
  vec3 low;
  double cells_per_length;
  uint32_t size[3];
} scree_starts;

typedef struct scree_memory {
  scree_bvh surface;
  scree_way *ways; /* of its triangles, in the tree's order */
  scree_starts starts;
  uint32_t *near; /* per vertex of the level: a triangle kept near it, in the tree's order */
  double area;
  double roughness; /* the mean distance with which the scan's vertices began */
  scree_witness *witnesses;
  size_t count, left; /* left: not dropped */
  double weight;      /* of those left */
  uint32_t *first;    /* per triangle: its first witness, or NONE */
} scree_memory;

/* In the unit box: distances that differ by no more are the same. */
#define SCREE_SAME_DISTANCE 1e-12

/* The squared distance up to which others are the same as this one. */
static inline double scree_past_rounding(double distance2) {
  double distance = sqrt(distance2) + SCREE_SAME_DISTANCE;
  return distance * distance;
}

/* Keeps the surface as it is, for now without witnesses. */
scree_status scree_memory_keep_surface(const scree_halfmesh *s, scree_memory *memory,
                                       scree_error *error);
static inline bool scree_memory_has_surface(const scree_memory *memory) {
  return memory->ways != NULL;
}

/* Gives it witnesses, and the surface as it is, if it has none: the memory is zero then. The
 * witnesses are those placed, made with scree_alloc and taken over whatever the outcome: each with
 * its distance from a triangle, whose number is in `next`. NULL: the surface's own vertices. */
scree_status scree_memory_keep(const scree_halfmesh *s, scree_witness *placed, size_t placed_count,
                               scree_memory *memory, scree_error *error);
void scree_memory_free(scree_memory *memory);
static inline bool scree_memory_is_kept(const scree_memory *memory) {
  return memory->first != NULL;
}

/* Other witnesses instead, made with scree_alloc and taken over, of which `at` is set. The level
 * has SCREE_RING_MAX triangles at the most: each witness gets the nearest, and weighs what it
 * stands for of its area. */
void scree_memory_replace(scree_memory *memory, const scree_halfmesh *s, scree_witness *witnesses,
                          size_t count);

/* Whether x is near enough to the surface kept for a vertex of a level of so many triangles: within
 * half of sqrt(area / count). */
bool scree_memory_allows(const scree_memory *memory, size_t triangle_count, vec3 x);

/* Places looked at on each new edge. */
enum { SCREE_EDGE_PLACES = 5 };

/* Of one ring, from one target to the next, for their places lie near each other: what was near to
 * each place, and which was farthest off. It changes no answer. Begin with scree_no_hints. */
typedef struct scree_hints {
  uint32_t known;    /* places, the new vertex first; 0: none yet */
  uint32_t farthest; /* place; 0: not known */
  uint32_t near[1 + SCREE_EDGE_PLACES * SCREE_RING_MAX]; /* kept triangles, in the tree's order */
} scree_hints;

static inline void scree_no_hints(scree_hints *hints) {
  hints->known = hints->farthest = 0;
}

/* The square of the stray, or `least`, where it is smaller; where it is above `most`, something
 * above that is enough. These are squares as well. */
double scree_memory_stray(const scree_memory *memory, const scree_halfmesh *s,
                          const scree_ring *ring, vec3 target, double least, double most,
                          scree_hints *hints);

/* Of a vertex at x, and of the places on the edges from there to the fan's rim: the largest squared
 * distance from the surface kept, or `least`, where it is smaller; whether it is at most `most`. */
double scree_memory_edges_stray(const scree_memory *memory, const scree_halfmesh *s,
                                const scree_ring *fan, vec3 x, double least, scree_hints *hints);
bool scree_memory_edges_within(const scree_memory *memory, const scree_halfmesh *s,
                               const scree_ring *fan, vec3 x, double most, scree_hints *hints);

/* The corners of the ring's triangles with their moving one, the first, at target. */
void scree_ring_corners(const scree_halfmesh *s, const scree_ring *ring, vec3 target,
                        double (*corners)[9]);

/* In batches: whether the stray is at most `most`, both squared, with the first so many places on
 * every edge, the middle first; that of the witnesses only once there are any. */
bool scree_memory_stays_within(const scree_memory *memory, const scree_halfmesh *s,
                               const scree_ring *ring, vec3 target, uint32_t places_on_edge,
                               double most);

/* The mean distance of the witnesses, and the largest. */
double scree_memory_mean(const scree_memory *memory);
double scree_memory_worst(const scree_memory *memory);

/* What the collapse alone makes of them: by how much the sum of the distances grows, and the
 * largest squared distance of a witness of the ring's triangles, of the new vertex or of a place on
 * a new edge, or `least`, where it is smaller. */
double scree_memory_growth(const scree_memory *memory, const scree_halfmesh *s,
                           const scree_ring *ring, vec3 target, double least, double *worst);

/* The largest squared distance of all: of a witness, of a vertex or of a place on an edge; in
 * parallel. */
double scree_memory_farthest(const scree_memory *memory, const scree_halfmesh *s);
/* The squared distance of the farthest witness; of one vertex; the largest of the places on one
 * edge; or `least`, where it is smaller. */
double scree_memory_witness_stray(const scree_memory *memory, const scree_halfmesh *s);
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
 * many these are. hints: per half-edge, `hinted`: from the same surface, before vertices moved;
 * they change no answer. */
size_t scree_memory_far_places(const scree_memory *memory, const scree_halfmesh *s, double least,
                               bool hinted, scree_place_hint (*hints)[SCREE_LEVEL_PLACES],
                               scree_far_place *far);

/* How far off a place may be as things stand: ten times the mean distance of the witnesses, nine
 * times where the level is held close, less five times the one with which those placed began; 0
 * where none is off but for rounding. */
double scree_memory_usual(const scree_memory *memory, bool close);

/* While there are more than `crowd` witnesses for a triangle, and more than `least`, every second
 * of each triangle goes, in the order of their distances; the farthest of each stays. */
void scree_memory_thin(scree_memory *memory, const scree_halfmesh *s, size_t crowd, size_t least);

/* Forgets the witnesses that were dropped; those of a triangle lie side by side then. */
scree_status scree_memory_squeeze(scree_memory *memory, const scree_halfmesh *s,
                                  scree_error *error);

/* Before scree_halfmesh_compact: triangles and vertices get the numbers that they will have. */
void scree_memory_compact(scree_memory *memory, const scree_halfmesh *s);

/* Gives the witnesses of the ring's triangles to those that will be there; before the collapse. */
void scree_memory_move(scree_memory *memory, const scree_halfmesh *s, const scree_ring *ring,
                       vec3 target);

/* After many vertices moved: each witness goes to the nearest of its triangle and those beside.
 * lists: room for a number per triangle. */
void scree_memory_follow(scree_memory *memory, const scree_halfmesh *s, uint32_t *lists);

/* In batches, before: whether the new vertex is so near to the old triangles; whether the old ends
 * are to the new ones. Squared. */
bool scree_stays_within(const scree_halfmesh *s, const scree_ring *ring, vec3 target, double most);
bool scree_ends_stay_within(const scree_halfmesh *s, const scree_ring *ring, vec3 target,
                            double most);

#endif
