/* Making shapes: what is not public of it. */
#pragma once

#include "base/error.h"

/* A box about the origin; free with scree_mesh_free. */
scree_status scree_box_mesh(const double sides[3], scree_mesh *mesh, scree_error *error);
/* Has the store give this particle for the spec; it holds its own reference. */
scree_status scree_shape_store_put(scree_shape_store *store, const scree_shape_spec *spec,
                                   const scree_shape_made *made, scree_error *error);
