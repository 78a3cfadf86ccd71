/* What the decimation remembers of the scan: the surface as it was at some point, kept as a tree
 * (memory.c), and witnesses, vertices of the scan that went (witness.c; keep.c finds them). Each of
 * these knows a triangle that stands for it now, the nearest of those that took the place of the
 * last one, and its distance from it. */
#ifndef SCREE_SIMPLIFY_MEMORY_H
#define SCREE_SIMPLIFY_MEMORY_H

#include "base/prefetch.h"
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

/* The number of the cell of x, or of the nearest. */
static inline uint32_t scree_start_cell(const scree_starts *g, vec3 x) {
  const double at[3] = {x.x - g->low.x, x.y - g->low.y, x.z - g->low.z};
  uint32_t i[3];
  for (int k = 0; k < 3; k++) {
    double cell = at[k] * g->cells_per_length;
    i[k] = cell > 0 ? cell < g->size[k] ? (uint32_t)cell : g->size[k] - 1 : 0;
  }
  return (i[2] * g->size[1] + i[1]) * g->size[0] + i[0];
}

/* Of the triangles kept the one that x lies above, or one near to it, looked for from *near on,
 * then from x's cell. Answers a distance: x is no farther from it. */
double scree_memory_walk(const scree_memory *memory, vec3 x, uint32_t *near);

/* Whether x, which is near this triangle, is farther from the surface kept than `least`, squared;
 * then *hit is where it is nearest. */
bool scree_memory_find_farther(const scree_memory *memory, vec3 x, double least, uint32_t near,
                               scree_bvh_hit *hit);

/* The squared distance of x from the surface kept, if above `least`; else that. *near: a triangle
 * to begin with, then one near x. */
double scree_memory_farther(const scree_memory *memory, vec3 x, double least, uint32_t *near);

/* The mean distance of the witnesses, and the largest. */
double scree_memory_mean(const scree_memory *memory);
double scree_memory_worst(const scree_memory *memory);
/* The squared distance of the farthest. */
double scree_memory_witness_stray(const scree_memory *memory, const scree_halfmesh *s);

/* How far off a place may be as things stand: ten times the mean distance of the witnesses, nine
 * times where the level is held close, less five times the one with which those placed began; 0
 * where none is off but for rounding. */
double scree_memory_usual(const scree_memory *memory, bool close);

/* Asks for the witnesses of the triangles around: along all lists at once, for each tells only
 * where its next one is. */
SCREE_PREFETCHES void scree_memory_ask(const scree_memory *m, const scree_halfmesh *s,
                                       const scree_ring *r) {
  uint32_t at[SCREE_RING_MAX + 3], count = 0, around = scree_ring_triangle_count(r);
  for (uint32_t k = 0; k < around; k++) {
    at[count] = m->first[scree_ring_triangle(s, r, k)];
    count += at[count] != SCREE_NONE;
  }
  while (count > 0) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
      at[left] = m->witnesses[at[i]].next;
      if (at[left] == SCREE_NONE) continue;
      __builtin_prefetch(&m->witnesses[at[left]]);
      left++;
    }
    count = left;
  }
}

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

/* After many vertices moved: each witness goes to the nearest of its triangle and those beside; in
 * parallel. lists, triangle: room for a number per triangle and per witness. */
void scree_memory_follow(scree_memory *memory, const scree_halfmesh *s, uint32_t *lists,
                         uint32_t *triangle);

#endif
