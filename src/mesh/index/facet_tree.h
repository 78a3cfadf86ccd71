/* A tree of boxes over the facets of a mesh, for finding which facets come near each other or lie
 * on a ray. See facet_tree.c for what it is and why. */
#ifndef SCREE_MESH_INDEX_FACET_TREE_H
#define SCREE_MESH_INDEX_FACET_TREE_H

#include "base/box.h"
#include "mesh/mesh.h"

enum { SCREE_LEAF_FACETS = 4 };

scree_box scree_facet_box(const scree_mesh *mesh, uint32_t facet);

/* Node i's children are i + 1 and right; a leaf has right == 0 and at most SCREE_LEAF_FACETS. */
typedef struct scree_facet_node {
  scree_box bounds;
  uint32_t begin, count; /* of order[] */
  uint32_t right;
  uint32_t frame; /* internal */
} scree_facet_node;

typedef struct scree_facet_tree {
  const scree_mesh *mesh; /* borrowed */
  uint32_t *order;        /* facets, so that each node has a run of them */
  vec3 *middle;           /* while building: of each facet's box, by facet */
  struct {
    scree_facet_node *items; /* the root is items[0] */
    size_t count, capacity;
  } nodes;
  struct {
    struct scree_facet_frame *items;
    size_t count, capacity;
  } frames;
  struct {
    struct scree_facet_cone *items;
    size_t count, capacity;
  } cones;
} scree_facet_tree;

/* Builds the tree of a verified mesh with at least one facet, in O(N log N): 0.3 us per facet of
 * one core. The tree is at most 160 deep. */
scree_status scree_facet_tree_build(const scree_mesh *mesh, scree_facet_tree *tree,
                                    scree_error *error);
void scree_facet_tree_free(scree_facet_tree *tree);

/* True where no facet of one node has a point in common with a facet of the other but vertices that
 * they share. */
bool scree_facet_nodes_apart(const scree_facet_tree *tree, const scree_facet_node *a,
                             const scree_facet_node *b);

static inline bool scree_facet_node_is_leaf(const scree_facet_node *node) {
  return node->right == 0;
}

#endif
