/* scree_mesh_topology (scree/measure.h) for callers that need the adjacency as well. */
#ifndef SCREE_MESH_TOPOLOGY_H
#define SCREE_MESH_TOPOLOGY_H

#include "mesh/adjacency.h"

/* Counts what scree_topology says of a verified mesh; without shells, their counts stay 0 and the
 * genus means nothing. */
scree_status scree_topology_count(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                  bool with_shells, scree_topology *topology, scree_error *error);

#endif
