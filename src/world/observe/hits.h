/* What neighbours have done to each other, for those who follow single contacts. */
#pragma once

#include "world/observe/replay.h"

/* J that two neighbours have dissipated since they became neighbours: in the dashpots (hysteresis
 * with them), and by the tangential forces, with what their springs hold now. */
typedef struct scree_pair_losses {
  uint32_t a, b, at; /* at: for scree_pair_normal_energy */
  bool wall, touching;
  double normal, tangential;
} scree_pair_losses;

typedef struct scree_losses {
  scree_pair_losses *items;
  size_t count, capacity;
} scree_losses;

/* The losses of all neighbours that touch or have lost anything, by the first, bodies before walls,
 * by the second. The lists must be here (scree_world_bring). False when memory is out. */
bool scree_find_losses(const scree_world *world, scree_losses *losses);

/* J, of the neighbours' motion towards each other where they touch: m v^2/2 with v their relative
 * velocity along the normal and 1/m the sum of what a unit impulse along it changes at the place,
 * 1/m_a + (r x n) I_a^-1 (r x n) and likewise of b; and what the normal springs hold. So it stays
 * the same while they hit each other, but for what is dissipated. False when memory is out. */
bool scree_pair_normal_energy(const scree_world *world, uint32_t which, scree_pair_copy *copy,
                              double *energy);
