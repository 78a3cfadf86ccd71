/* Materials and the time step: what contacts follow from them. */
#pragma once

#include "world/world.h"

/* material.c: eta of the clamped linear dashpot for a restitution in (0, 1]. */
double scree_damping_ratio(double restitution);
/* alpha of Hertz's, C = alpha (m* h)^1/2 m^1/4 with F = h m^3/2. */
double scree_hertz_damping(double restitution);

/* L of the law and of its limits: the particle's, or that of the options. */
static inline double scree_size_in(const scree_world *world, const scree_particle *particle) {
  return world->options.size > 0 ? world->options.size : particle->measures.size;
}

/* time_step.c */
double scree_world_choose_time_step(const scree_world *world, char reason[256]);
/* Two sides of a contact: their shapes and materials. */
typedef struct scree_contact_sides {
  const scree_particle *a, *b; /* b NULL: a wall */
  size_t material_a, material_b;
  double size, mass; /* L of the smaller; reduced */
} scree_contact_sides;
/* Stiffnesses of the law: K, and those of Hertz and Mindlin; the rest is left as it is. */
void scree_set_stiffness(const scree_world *world, const scree_contact_sides *sides,
                         scree_pair_law *law);
