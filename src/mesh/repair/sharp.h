/* Edges too sharp for contact: what decides it, for check, repair and particles. */
#pragma once

#include "base/vec.h"
#include "mesh/adjacency.h"
#include "mesh/mesh.h"

/* Whether neighbours with these normals, of any lengths, make an angle of less than
 * SCREE_LEAST_EDGE_DEG, in material or outside; false where one has no area. */
bool scree_normals_are_sharp(vec3 a, vec3 b);
/* Whether the facets of half-edges h and its only twin do; false where they are wound unlike. */
bool scree_edge_is_sharp(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t h);
/* The number of such edges; marked (may be NULL) gets true for their facets. */
size_t scree_sharp_edges(const scree_mesh *mesh, const scree_adjacency *adjacency, bool *marked);
