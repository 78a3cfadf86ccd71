/* What neighbours have done to each other, for those who follow single contacts. */
#pragma once

#include "world/pairs.h"

/* J that two neighbours have dissipated since they became neighbours: in the dashpots (hysteresis
 * with them), and by the tangential forces, with what their springs hold now. */
typedef struct scree_pair_losses {
  uint32_t a, b;
  bool wall, touching;
  double normal, tangential;
} scree_pair_losses;

/* Of the next neighbours from index *k on that touch or have lost anything, in the order of
 * world->neighbours; *k is then behind them. False: there are no more. The lists must be here
 * (scree_world_bring). */
bool scree_next_losses(const scree_world *world, size_t *k, scree_pair_losses *losses);

/* J, of the neighbours' motion towards each other where they touch: m v^2/2 with v their relative
 * velocity along the normal and 1/m the sum of what a unit impulse along it changes at the place,
 * 1/m_a + (r x n) I_a^-1 (r x n) and likewise of b; and what the normal springs hold. So it stays
 * the same while they hit each other, but for what is dissipated. False when memory is out. */
bool scree_pair_normal_energy(const scree_world *world, size_t neighbours, scree_pair_copy *copy,
                              double *energy);
