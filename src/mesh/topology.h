/* scree_mesh_topology (scree/measure.h) for callers that need the adjacency as well. */
#pragma once

#include "mesh/adjacency.h"

/* Of a verified mesh. Counting comes in parts that may run beside each other, each filling fields
 * of its own of a topology that is zero before. */
enum { SCREE_TOPOLOGY_PARTS = 3 };
scree_status scree_topology_count(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                  size_t part, scree_topology *topology, scree_error *error);
/* Once all parts are done: the rest. Where shells are not counted by then the genus means nothing.
 */
scree_status scree_topology_finish(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                   scree_topology *topology, scree_error *error);
