/* How bodies move. */
#pragma once

#include "world/state/world.h"

/* Sums the forces on every body; false where the step would leave the model's range, with the
 * reason in world->failure. */
bool scree_world_gather(scree_world *world);
/* Kick, turn and drift of every body and wall; removal below the floor. */
void scree_world_advance(scree_world *world);
