/* The lists of spheres. */
#pragma once

#include "world/state/world.h"

/* Whether there are two. */
bool scree_spheres_are_there(const scree_world *world);
/* Room for what follows of the bodies. */
scree_status scree_spheres_reserve(scree_world *world, scree_error *error);
/* The order in space; what is listed becomes the old list. */
scree_status scree_spheres_order(scree_world *world, scree_error *error);
/* Room for so many pairs. */
bool scree_spheres_reserve_pairs(scree_world *world, size_t count);
/* From the second places, which were written to spheres.found: the pairs. */
scree_status scree_spheres_list(scree_world *world, scree_error *error);
/* For checkpoints: order, pairs and contacts that were loaded, each contact where its pair is. */
scree_status scree_spheres_restore(scree_world *world, scree_error *error);
/* For a device. */
scree_status scree_spheres_list_seconds(scree_world *world, scree_error *error);
void scree_spheres_free(scree_world *world);
