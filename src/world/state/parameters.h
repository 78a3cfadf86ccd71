/* The parameters of a contact's law. */
#pragma once

#include "world/state/world.h"

/* Two sides of a contact: their shapes and materials. */
typedef struct scree_contact_sides {
  const scree_particle *a, *b; /* b NULL: a wall */
  size_t material_a, material_b;
  double size, mass; /* L of the smaller; reduced */
} scree_contact_sides;
/* Stiffnesses of the law: K, and those of Hertz and Mindlin; the rest is left as it is. */
void scree_set_stiffness(const scree_world *world, const scree_contact_sides *sides,
                         scree_pair_law *law);
/* Half the particle's thinnest wall, m. */
double scree_thin_overlap(const scree_particle *particle);
/* Whether neighbours are two spheres, or a sphere and a plane, disc or cylinder. */
bool scree_are_spheres(const scree_world *world, const scree_neighbours *neighbours);
/* Neighbours a and b, new and set up. */
scree_neighbours scree_neighbours_new(const scree_world *world, uint32_t a, uint32_t b, bool wall);
/* The laws of pairs of spheres, whose number is known. */
void scree_spheres_set_up_laws(scree_world *world);
/* After a change of the materials: stiffness, damping and so on of all neighbours and pairs. */
void scree_neighbours_set_up(scree_world *world);
