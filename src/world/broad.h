/* The list of neighbours. */
#pragma once

#include "world/world.h"

/* broad.c: brings the list of pairs up to date when a body could have left its margin. */
scree_status scree_broad_update(scree_world *world, scree_error *error);
void scree_broad_free(scree_world *world);
/* For a device that makes the list: the margin of one to be made now; room in the world's own
 * arrays for as many neighbours as it has there. */
double scree_broad_margin(const scree_world *world);
bool scree_broad_reserve(scree_world *world);
/* Room for what the broad phase has of each body. */
scree_status scree_broad_reserve_bodies(scree_world *world, scree_error *error);
/* For checkpoints: a list that was loaded, with its margin. */
scree_status scree_broad_restore(scree_world *world, double margin, scree_error *error);
