/* Winding numbers on both sides of a facet, at a point of it, of meshes whose facets may cross
 * elsewhere. A facet is seen along the axis nearest to its normal. */
#pragma once

#include "mesh/index/facet_tree.h"

/* A point as seen along an axis. */
typedef struct scree_seen {
  double x, y;
} scree_seen;

/* A facet seen along an axis: its corners, and the two coordinates that are seen. */
typedef struct scree_view {
  const double *corner[3];
  int axis, u, v; /* u, v: the other two, so that (u, v, axis) turns right-handed */
  int side;       /* +1: the facet's normal points along the axis; -1: against; 0: no area */
} scree_view;

scree_view scree_view_of(const scree_mesh *mesh, uint32_t facet);
/* The same from given corners. */
scree_view scree_view_of_corners(const double *a, const double *b, const double *c);

static inline scree_seen scree_view_point(const scree_view *f, const double *p) {
  return (scree_seen){p[f->u], p[f->v]};
}

/* How far along the axis the facet's plane lies at p. */
double scree_view_height(const scree_view *f, scree_seen p);

/* +1, -1: all corners of u lie above, below the plane of t (or in it), as its normal points; 0:
 * they lie on both sides. */
int scree_view_side_of(const scree_view *t, const scree_view *u);

/* What is asked. */
typedef struct scree_winding {
  const scree_facet_tree *tree;
  const int32_t *weights; /* by facet: how often it counts, negative: turned round; NULL: once */
  /* facets that share an area with facet t of the same plane are partners[first[t] ..
   * first[t + 1]), as facet << 1 | 1; others there, with the lowest bit 0, are passed over. NULL:
   * there are none. */
  const uint32_t *first, *partners;
  double rounding; /* of heights over flat ground, m: scree_winding_rounding */
} scree_winding;

double scree_winding_rounding(const scree_facet_tree *tree);

typedef struct scree_sides {
  int above, below; /* along the axis */
  bool owner;       /* no lower facet of the same plane covers the point */
} scree_sides;

/* At point p of the facet, which must not be crossed there. False where the point lies on the rim
 * of a facet as seen along the axis, or the order of two sheets cannot be told: another point may
 * do. O(log N + facets over p). */
bool scree_winding_look(const scree_winding *w, uint32_t facet, const scree_view *f, scree_seen p,
                        scree_sides *found);
