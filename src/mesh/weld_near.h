/* Welding within a tolerance. */
#pragma once

#include "base/alloc.h"

/* Unites the vertices of a canonical mesh that are linked by steps of at most tolerance times its
 * bounding box diagonal, and brings the result into canonical order (see scree_mesh_weld). The mesh
 * is untouched on failure. */
scree_status scree_weld_near(scree_mesh *mesh, double tolerance, scree_error *error);
