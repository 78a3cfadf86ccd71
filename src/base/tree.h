/* A binary tree of boxes over a fixed set of boxed items: for nearest items, for what meets a box,
 * a ray or another tree. Constant once built, so any number of threads may walk it. The tree
 * depends on the items alone, not on the number of threads. */
#pragma once

#include "base/box.h"
#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* Nodes are stored parent first; the two children of a node lie side by side. */
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
  size_t node_count;
  scree_cone *cones; /* of each node's items; NULL unless scree_tree_add_cones made them */
  uint32_t *order;   /* items in leaf order: neighbours in it are near in space */
  size_t item_count;
} scree_tree;

/* Trees are at most 80 deep, and a walk keeps one entry a level and one more. */
enum { SCREE_TREE_STACK = 96 };

typedef enum scree_tree_split {
  SCREE_SPLIT_AREA,   /* by the surface area heuristic: the fewest visits on the way to an item */
  SCREE_SPLIT_HALVES, /* at the median: the least deep */
} scree_tree_split;

/* Items with their boxes, which are asked for twice each, by any thread. */
typedef struct scree_boxed {
  size_t count;
  scree_box (*box)(const void *context, size_t item);
  const void *context;
  uint32_t leaf; /* items of a leaf at most, from 2 */
  scree_tree_split split;
} scree_boxed;

/* O(N log N), parallel. 32 bytes an item stay, four times as many are used while building. */
scree_status scree_tree_build(const scree_boxed *items, scree_tree *tree, scree_error *error);
/* Adds for each node a cone that holds the cones of its items. */
scree_status scree_tree_add_cones(scree_tree *tree, const scree_cone *items, scree_error *error);
void scree_tree_free(scree_tree *tree);

/* ---- Walks ---- */

/* Depth first, the left child first:
 *
 *   scree_tree_walk walk;
 *   scree_tree_start(&walk, tree);
 *   for (const scree_tree_node *n; (n = scree_tree_next(&walk));) {
 *     if (nothing is to be found in n->box || scree_tree_enter(&walk, n)) continue;
 *     look at the items order[n->first], ... of the leaf
 *   }
 */
typedef struct scree_tree_walk {
  const scree_tree_node *nodes;
  int depth;
  uint32_t stack[SCREE_TREE_STACK];
} scree_tree_walk;

static inline void scree_tree_start(scree_tree_walk *w, const scree_tree *tree) {
  w->nodes = tree->nodes;
  w->depth = tree->item_count > 0;
  w->stack[0] = 0;
}
static inline const scree_tree_node *scree_tree_next(scree_tree_walk *w) {
  return w->depth > 0 ? &w->nodes[w->stack[--w->depth]] : NULL;
}
/* False for a leaf; else its children come next. */
static inline bool scree_tree_enter(scree_tree_walk *w, const scree_tree_node *node) {
  if (node->count) return false;
  w->stack[w->depth++] = node->first + 1;
  w->stack[w->depth++] = node->first;
  return true;
}

/* Leaves by their distance from a point, the nearer child first. */
typedef struct scree_tree_search {
  const scree_tree_node *nodes;
  vec3 p;
  double passed2; /* no item passed over is nearer, squared */
  int depth;
  struct {
    uint32_t node;
    double distance2;
  } stack[SCREE_TREE_STACK];
} scree_tree_search;

/* Begins a search among the items below a node; the tree has some. */
static inline void scree_tree_search_below(scree_tree_search *s, const scree_tree *tree,
                                           uint32_t node, vec3 p) {
  s->nodes = tree->nodes;
  s->p = p;
  s->passed2 = INFINITY;
  s->stack[0].node = node;
  s->stack[0].distance2 = scree_box_distance2(&s->nodes[node].box, p);
  s->depth = 1;
}
/* The next leaf whose box is no farther, squared, than `bound2`, which only falls from call to
 * call; NULL: there is none. */
static inline const scree_tree_node *scree_tree_nearer(scree_tree_search *s, double bound2) {
  while (s->depth > 0) {
    uint32_t at = s->stack[--s->depth].node;
    double distance2 = s->stack[s->depth].distance2;
    while (distance2 <= bound2) {
      const scree_tree_node *node = &s->nodes[at];
      if (node->count) return node;
      uint32_t left = node->first;
      double dl = scree_box_distance2(&s->nodes[left].box, s->p),
             dr = scree_box_distance2(&s->nodes[left + 1].box, s->p);
      bool left_first = dl <= dr;
      double farther = left_first ? dr : dl;
      if (farther <= bound2) {
        s->stack[s->depth].node = left + left_first;
        s->stack[s->depth++].distance2 = farther;
      } else {
        s->passed2 = scree_smaller(s->passed2, farther);
      }
      at = left + !left_first;
      distance2 = left_first ? dl : dr;
    }
    s->passed2 = scree_smaller(s->passed2, distance2);
  }
  return NULL;
}

/* ---- Cones ---- */

/* Whether the two have a direction in common. */
static inline bool scree_cones_meet(const scree_cone *a, const scree_cone *b) {
  return vec3_dot(a->axis, b->axis) >= a->cosine * b->cosine - a->sine * b->sine ||
         a->sine * b->cosine + a->cosine * b->sine <= 0; /* together more than half around */
}
/* The rotated cone's opposite directions. */
static inline scree_cone scree_cone_opposite(const scree_cone *cone, const mat3 *rotation) {
  return (scree_cone){vec3_neg(mat3_mul_vec(rotation, cone->axis)), cone->cosine, cone->sine};
}
