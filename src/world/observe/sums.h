/* What an observation adds up, in parts that do not depend on where it is done: blocks of bodies,
 * then blocks of neighbours, then the walls. Parts are merged in their order. */
#pragma once

#include "base/sum.h"
#include "world/state/world.h"

enum { SCREE_SUM_BLOCK = 128 };

typedef struct scree_sums {
  scree_sum kinetic, rotational, potential, rotation, momentum[3], angular[3];
  scree_sum elastic, tangential_elastic, dashpot, tangential, wall, applied;
  double speed; /* the highest */
  uint64_t bodies, removed, pairs, depenetrating, contacts, body_sides;
} scree_sums;

size_t scree_sum_part_count(const scree_world *world);
/* Part `part`, which needs the state of bodies and walls, and the lists. */
scree_sums scree_sum_part(const scree_world *world, size_t part);
void scree_sums_merge(scree_sums *sums, const scree_sums *part);
