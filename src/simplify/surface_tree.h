/* A tree of boxes over the triangles of a surface as they lie in memory, which is near their
 * neighbours (morton.h): leaf k has triangles LEAF k to LEAF k + LEAF - 1, node i has children 2i
 * and 2i + 1. Bounds are single numbers, rounded outward. Boxes grow as triangles move;
 * scree_surface_tree_fit makes them tight again.
 * It is no scree_tree (base/tree.h): it is fitted anew in every pass and grows between, which takes
 * nodes whose parents and leaves are known by number. */
#pragma once

#include "simplify/halfmesh.h"

typedef struct scree_bounds {
  float low[3], high[3];
} scree_bounds;

/* A node also knows which of 26 directions (to the faces, edges and corners of a cube) some
 * triangle in it does not face: bit k set if the normal has no positive product with direction k.
 */
typedef struct scree_surface_node {
  scree_bounds bounds;
  uint32_t averse;
} scree_surface_node;

typedef struct scree_surface_tree {
  scree_surface_node *node; /* 1 is the root; leaves from `leaves` on */
  size_t leaves;            /* a power of two */
} scree_surface_tree;

scree_status scree_surface_tree_make(const scree_halfmesh *s, scree_surface_tree *tree,
                                     scree_error *error);
void scree_surface_tree_free(scree_surface_tree *tree);

/* Boxes of what is there. The surface may have become smaller. Parallel. */
void scree_surface_tree_fit(scree_surface_tree *tree, const scree_halfmesh *s);

/* A triangle lies within these bounds now, with that doubled area vector. */
void scree_surface_tree_grow(scree_surface_tree *tree, uint32_t triangle,
                             const scree_bounds *bounds, vec3 normal);

/* Along each of 13 lines the least and the greatest product with doubled area vectors of triangles:
 * whether all face one of its two directions. */
enum { SCREE_FACING_LINES = 13 };
typedef struct scree_facing {
  double least[SCREE_FACING_LINES], most[SCREE_FACING_LINES];
} scree_facing;

/* The facing of no triangle at all: none is averse to any direction. */
static inline scree_facing scree_facing_all(void) {
  scree_facing f;
  for (int k = 0; k < SCREE_FACING_LINES; k++) f.least[k] = INFINITY, f.most[k] = -INFINITY;
  return f;
}
void scree_facing_add(scree_facing *facing, vec3 normal);
/* The directions that some triangle does not face. */
uint32_t scree_facing_averse(const scree_facing *facing);
#define SCREE_ALL_AVERSE ((UINT32_C(1) << 26) - 1)

/* Whether there is a direction, not among those averse to, that all triangles in nodes that meet
 * the bounds face. */
bool scree_surface_tree_faces(const scree_surface_tree *tree, const scree_bounds *bounds,
                              uint32_t averse);

/* Triangles whose leaf meets the bounds, at most `room`, gone ones among them; answers how many
 * there are. */
size_t scree_surface_tree_overlap(const scree_surface_tree *tree, const scree_halfmesh *s,
                                  const scree_bounds *bounds, uint32_t *found, size_t room);

/* The squared distance of p from the surface or, where that is at most `enough`, of any triangle as
 * near. The triangle *hint, unless NONE, is looked at first; it becomes the one found. */
double scree_surface_tree_distance(const scree_surface_tree *tree, const scree_halfmesh *s, vec3 p,
                                   double enough, uint32_t *hint);

static inline scree_bounds scree_bounds_empty(void) {
  return (scree_bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}
void scree_bounds_add(scree_bounds *bounds, vec3 p);
static inline bool scree_bounds_meet(const scree_bounds *a, const scree_bounds *b) {
  return (a->low[0] <= b->high[0]) & (b->low[0] <= a->high[0]) & (a->low[1] <= b->high[1]) &
         (b->low[1] <= a->high[1]) & (a->low[2] <= b->high[2]) & (b->low[2] <= a->high[2]);
}

/* The squared distance of p from the triangle, after Ericson, "Real-time collision detection"
 * (2005), 5.1.5; scree_triangle_closest (mesh/index/closest.h), which finds the point too and minds
 * needles, would make a decimation an eighth slower. */
static inline double scree_distance2(const vec3 corner[3], vec3 p) {
  vec3 ab = vec3_sub(corner[1], corner[0]), ac = vec3_sub(corner[2], corner[0]),
       ap = vec3_sub(p, corner[0]);
  double d1 = vec3_dot(ab, ap), d2 = vec3_dot(ac, ap), u = 0, v = 0;
  double bb = vec3_norm2(ab), cc = vec3_norm2(ac), bc = vec3_dot(ab, ac);
  double d3 = d1 - bb, d4 = d2 - bc, d5 = d1 - bc, d6 = d2 - cc;
  double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (d1 <= 0 && d2 <= 0) {
  } else if (d3 >= 0 && d4 <= d3) {
    u = 1;
  } else if (d6 >= 0 && d5 <= d6) {
    v = 1;
  } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    u = d1 / (d1 - d3);
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    v = d2 / (d2 - d6);
  } else if (va <= 0 && d4 >= d3 && d5 >= d6) {
    v = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    u = 1 - v;
  } else {
    double sum = va + vb + vc;
    u = vb / sum;
    v = vc / sum;
  }
  return vec3_norm2(vec3_mad(vec3_mad(ap, ab, -u), ac, -v));
}
