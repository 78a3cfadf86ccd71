/* Cutting by one plane. */
#pragma once

#include "base/vec.h"
#include "scree.h"

/* The pieces on both sides of a plane through `at` with this unit normal, closed and apart; the
 * plane may be moved by a millionth of the size, a length of the mesh. Errors as
 * scree_mesh_fracture; a plane that does not meet the mesh leaves it as it is. */
scree_status scree_mesh_halve(const scree_mesh *mesh, vec3 at, vec3 normal, double size,
                              scree_fracture *halves, scree_error *error);
