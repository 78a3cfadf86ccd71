/* Geometry, of whatever kind (scene/geometry/kind.h). */
#pragma once

#include "scene/geometry/kind.h"

/* What layers in it fill; all 0: no layers can. */
scree_container scree_geometry_container(const scree_plan_geometry *geometry);
/* Fails unless each can be in a periodic domain. */
scree_status scree_geometry_check_periodic(const scree_reader *reader, const scree_plan *plan);
/* The name of file `index`; NULL: there are no more. */
const char *scree_geometry_file_name(const scree_plan_geometry *geometry, size_t index);
/* Walls into a world, with their motions. */
scree_status scree_geometry_add(scree_scene *scene, const char *folder, scree_world *world,
                                scree_error *error);
