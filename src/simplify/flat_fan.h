/* Flat fans of very many triangles, as CAD programs cut the ends of cylinders. */
#pragma once

#include "base/error.h"

/* Flips edges of flat fans about a vertex of more than SCREE_FAN_MAX triangles until as many are
 * left, or as few as can be: the same surface, cut otherwise. *triangles gets 3 indices for each of
 * the mesh's, or NULL where there is no such fan; free with scree_free. The mesh is verified.
 * O(N log N) where there is one, else O(N). */
scree_status scree_flat_fans_cut(const scree_mesh *mesh, uint32_t **triangles, scree_error *error);
