/* A quick proof that a surface nowhere meets itself. */
#pragma once

#include "mesh/adjacency.h"
#include "mesh/mesh.h"

/* *apart: no two facets of the verified mesh meet beyond what they share (mesh/index/intersect.h).
 * Not proven is not disproven: the search stops at the first pair that meets, and where facets
 * crowd in few cells of a grid or are large beside the others. Exact; cost: about 0.3 us of one
 * core per facet, on all threads, and 20 bytes per facet.
 *
 * adjacency: of the mesh, if no facet names a vertex twice and the facets at every vertex hang
 * together through its edges; else NULL. It saves tests of facets that share a vertex, most where
 * the surface is flat. */
scree_status scree_facets_apart(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                bool *apart, scree_error *error);
