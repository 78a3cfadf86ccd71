/* A binary tree of axis-aligned boxes over a fixed set of boxed items, for closest-point and
 * overlap queries. Nodes are stored parent first; the two children of a node lie side by side. */
#ifndef SCREE_PARTICLE_TREE_H
#define SCREE_PARTICLE_TREE_H

#include "base/box.h"
#include "base/error.h"

typedef struct scree_tree_node {
  scree_box box;
  uint32_t first; /* leaf: first place in order; else the left child */
  uint32_t count; /* leaf: items; 0 for an inner node */
} scree_tree_node;

/* All directions within an angle of an axis. */
typedef struct scree_cone {
  vec3 axis;           /* unit */
  double cosine, sine; /* of the angle, 0 to pi */
} scree_cone;

typedef struct scree_tree {
  scree_tree_node *nodes; /* nodes[0] is the root; NULL for no items */
  scree_cone *cones;      /* of each node's items; NULL unless scree_tree_add_cones made them */
  uint32_t *order;        /* items in leaf order */
  size_t item_count;
} scree_tree;

/* Median splits of 2^32 items are at most 32 deep, and a walk keeps at most two entries a level. */
enum { SCREE_TREE_LEAF = 2, SCREE_TREE_STACK = 72 };

/* Over item_count boxes; split at the median of the longest side of the centres, ties by index. */
scree_status scree_tree_build(const scree_box *boxes, size_t item_count, scree_tree *tree,
                              scree_error *error);
/* Adds for each node a cone that holds the cones of its items. */
scree_status scree_tree_add_cones(scree_tree *tree, const scree_cone *items, scree_error *error);
void scree_tree_free(scree_tree *tree);

/* Whether the two have a direction in common. */
static inline bool scree_cones_meet(const scree_cone *a, const scree_cone *b) {
  return vec3_dot(a->axis, b->axis) >= a->cosine * b->cosine - a->sine * b->sine ||
         a->sine * b->cosine + a->cosine * b->sine <= 0; /* together more than half around */
}
/* The rotated cone's opposite directions. */
static inline scree_cone scree_cone_opposite(const scree_cone *cone, const mat3 *rotation) {
  return (scree_cone){vec3_neg(mat3_mul_vec(rotation, cone->axis)), cone->cosine, cone->sine};
}

/* Cuts [from, to] to the part of the way start + s along that lies within the box; false for none.
 */
bool scree_box_cut(const scree_box *box, vec3 start, vec3 along, double *from, double *to);
/* The box of `box` after x -> rotation x + shift. */
scree_box scree_box_moved(const scree_box *box, const mat3 *rotation, vec3 shift);

#endif
