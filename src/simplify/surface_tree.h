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

/* What collapses of one pass will do: chosen[v] is NONE or the index of the collapse that takes
 * vertex v to target[chosen[v]]. */
typedef struct scree_planned {
  const uint32_t *chosen;
  const vec3 *target;
} scree_planned;

scree_status scree_surface_tree_make(const scree_halfmesh *s, scree_surface_tree *tree,
                                     scree_error *error);
void scree_surface_tree_free(scree_surface_tree *tree);

/* Boxes of what is there, and of what is planned (NULL: nothing). The surface may have become
 * smaller. Parallel. */
void scree_surface_tree_fit(scree_surface_tree *tree, const scree_halfmesh *s,
                            const scree_planned *planned);

/* A triangle lies within these bounds now, with that doubled area vector. */
void scree_surface_tree_grow(scree_surface_tree *tree, uint32_t triangle,
                             const scree_bounds *bounds, vec3 normal);

/* The directions that a triangle with this doubled area vector does not face. */
uint32_t scree_averse(vec3 normal);
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

/* The squared distance of p from the triangle; scree_triangle_closest (mesh/index/closest.h), which
 * finds the point too and minds needles, would make a decimation an eighth slower. */
double scree_distance2(const vec3 corner[3], vec3 p);
