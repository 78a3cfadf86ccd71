/* A tree of boxes over the facets of a mesh, for finding which facets come near each other or lie
 * on a ray. See facet_tree.c for what it is and why. */
#pragma once

#include "base/tree.h"
#include "mesh/mesh.h"

enum { SCREE_LEAF_FACETS = 4 };

typedef struct scree_facet_tree {
  const scree_mesh *mesh; /* borrowed */
  scree_tree tree;        /* of its facets */
  uint32_t *frame_of;     /* by node: which of the frames; internal */
  struct scree_facet_frame *frames;
  size_t frame_count;
} scree_facet_tree;

/* Builds the tree of a verified mesh with at least one facet, in O(N log N). */
scree_status scree_facet_tree_build(const scree_mesh *mesh, scree_facet_tree *tree,
                                    scree_error *error);
void scree_facet_tree_free(scree_facet_tree *tree);

/* True where no facet of one node has a point in common with a facet of the other but vertices that
 * they share. */
bool scree_facet_nodes_apart(const scree_facet_tree *tree, uint32_t a, uint32_t b);
