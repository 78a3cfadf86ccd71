/* Where the cells of a fracture are. */
#pragma once

#include "base/error.h"
#include "mesh/mesh.h"

/* Points in the body, drawn and relaxed as the options say. Its space is that in which cells are as
 * long as wide; `there` leads from it to that of the options' places, which have one origin. */
scree_status scree_sites_draw(const scree_mesh *mesh, const mat3 *there,
                              const scree_fracture_options *options, vec3 *sites,
                              scree_error *error);
