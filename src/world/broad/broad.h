/* The list of neighbours. */
#pragma once

#include "world/state/world.h"

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

/* Whether no two bodies that are not neighbours can have come near each other. */
bool scree_broad_is_valid(const scree_world *world);
/* The margin of a body's box, m: small bodies among large ones have one of their own size. */
static inline double scree_body_margin(const scree_world *world, size_t i) {
  const double own_share = 0.4; /* at most of the body's size */
  return scree_min(world->list.margin, own_share * world->bodies.particle[i]->measures.size);
}
/* Since the neighbours were made it has moved farther than they hold for. */
static inline bool scree_body_has_left(const scree_world *world, size_t i) {
  return world->bodies.path[i] - world->list.body_path_at_build[i] >
         0.5 * scree_body_margin(world, i);
}
static inline bool scree_wall_has_left(const scree_world_wall *wall) {
  return wall->path - wall->path_at_build > wall->slack;
}

/* ---- stages of the broad phase on the processor ---- */

/* For all elements, in any order. */
typedef void scree_broad_stage(scree_world *world, size_t i);
void scree_broad_run(scree_world *world, scree_broad_stage *function, size_t count);
