/* How bodies move. */
#ifndef SCREE_WORLD_INTEGRATE_H
#define SCREE_WORLD_INTEGRATE_H

#include "world/world.h"

/* Sums the forces on every body; false where the step would leave the model's range, with the
 * reason in world->failure. */
bool scree_world_gather(scree_world *world);
/* Kick, turn and drift of every body and wall; removal below the floor. */
void scree_world_advance(scree_world *world);
/* Angular velocity of body i for angular momentum `momentum` and rotation `rotation`. */
vec3 scree_spin_of(const scree_bodies *bodies, size_t i, const mat3 *rotation, vec3 momentum);
/* Angular velocity in the body's own frame. */
vec3 scree_local_spin(vec3 inertia, const mat3 *rotation, vec3 momentum);
/* An orientation after half a drift and after a whole one, where it turns by `turn` in its own
 * frame before, and has this momentum. */
quat scree_half_turned(const quat *q, vec3 turn, double dt);
quat scree_turned(const quat *q, vec3 turn, vec3 inertia, vec3 momentum, double dt);

#endif
