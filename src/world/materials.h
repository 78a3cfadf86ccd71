/* Materials and the time step: what contacts follow from them. */
#ifndef SCREE_WORLD_MATERIALS_H
#define SCREE_WORLD_MATERIALS_H

#include "world/world.h"

/* material.c: eta of the clamped linear dashpot for a restitution in (0, 1]. */
double scree_damping_ratio(double restitution);

/* time_step.c */
double scree_world_choose_time_step(const scree_world *world, char reason[256]);
/* K of a pair of materials at size L. */
double scree_pair_stiffness(const scree_world *world, size_t material_a, size_t material_b,
                            double size);

#endif
