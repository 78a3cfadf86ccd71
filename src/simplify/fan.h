/* What an edge collapse changes: the triangles around it that stay, before and after. */
#pragma once

#include "simplify/surface_tree.h"

/* Collapses that would leave a vertex with more triangles are refused. */
enum { SCREE_FAN_MAX = 128 };

/* The edge (a, b) and the triangles around it that stay: triangle i has the half-edge edge[i]
 * across from a (i < a_count) or from b. Around a, then around b, counter-clockwise each: a closed
 * loop from apex c over a's side to apex d and over b's side back, unless a boundary interrupts it.
 * A fan about one vertex has this vertex as both ends, and no triangle goes. */
typedef struct scree_fan {
  uint32_t half_edge, a, b, c, d; /* d NONE: the edge is boundary */
  uint32_t a_count, count;
  uint32_t edge[SCREE_FAN_MAX];
  vec3 from[SCREE_FAN_MAX], to[SCREE_FAN_MAX]; /* ends of the edges */
  vec3 before[SCREE_FAN_MAX];                  /* doubled area vectors */
  /* set by scree_fan_set */
  vec3 at; /* of the new vertex */
  vec3 after[SCREE_FAN_MAX];
} scree_fan;

/* False: more triangles than that. */
bool scree_fan_of_edge(const scree_halfmesh *s, uint32_t half_edge, scree_fan *fan);
/* False: the vertex is on a boundary as well. */
bool scree_fan_of_vertex(const scree_halfmesh *s, uint32_t vertex, scree_fan *fan);
void scree_fan_set(scree_fan *fan, vec3 at);

/* Bounds of triangle i afterwards. */
scree_bounds scree_fan_bounds(const scree_fan *fan, uint32_t i);

/* Triangle k of those around: the fan's, then those that go; and how many these are. */
static inline uint32_t scree_fan_triangle(const scree_halfmesh *s, const scree_fan *f, uint32_t k) {
  uint32_t h = k < f->count    ? f->edge[k]
               : k == f->count ? f->half_edge
                               : s->half[f->half_edge].twin;
  return h / 3;
}
static inline uint32_t scree_fan_triangle_count(const scree_fan *f) {
  return f->count + (f->c != SCREE_NONE) + (f->d != SCREE_NONE);
}
static inline vec3 scree_normal_of(const scree_halfmesh *s, size_t triangle) {
  vec3 at[3];
  scree_corners(s, triangle, at);
  return vec3_triangle_normal(at[0], at[1], at[2]);
}

/* What collapsing, or moving the vertex, changes of area and volume. */
void scree_fan_measure(const scree_halfmesh *s, const scree_fan *fan, double *area, double *volume);

/* Whether the surface stays a manifold if the edge is collapsed: the link condition (Dey,
 * Edelsbrunner, Guha, Nekhayev 1999). a and b have exactly the apexes c and d as common neighbours,
 * compared as vertices of the mesh given; an edge between two boundary vertices is itself boundary;
 * at least three triangles stay. */
bool scree_fan_keeps_topology(const scree_halfmesh *s, const scree_fan *fan);

/* Collapses: a moves to fan->at, b goes, with the triangles at the edge. Touches only triangles of
 * the fan and the outgoing half-edges of a, b, c and d. */
void scree_fan_collapse(scree_halfmesh *s, const scree_fan *fan);
