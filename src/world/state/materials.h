/* Materials: what contacts follow from them. */
#pragma once

#include "world/state/world.h"

/* material.c: eta of the clamped linear dashpot for a restitution in (0, 1]. */
double scree_damping_ratio(double restitution);
/* alpha of Hertz's, C = alpha (m* h)^1/2 m^1/4 with F = h m^3/2. */
double scree_hertz_damping(double restitution);

/* L of the law and of its limits: the particle's, or that of the options. */
static inline double scree_size_in(const scree_world *world, const scree_particle *particle) {
  return world->options.size > 0 ? world->options.size : particle->measures.size;
}
