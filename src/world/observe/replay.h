/* Pairs evaluated once more on a copy. */
#pragma once

#include "world/state/scratch.h"

/* A pair and its neighbours with pools of their own. Zeroed before the first use; free it. */
typedef struct scree_pair_copy {
  scree_pair pair;
  scree_neighbours neighbours;
  scree_pools pools;
  scree_scratch scratch;
} scree_pair_copy;
/* A copy of an awake pair; false when memory is out. */
bool scree_copy_pair(const scree_world *world, const scree_pair *pair, scree_pair_copy *copy);
/* Its contact at this moment; the contacts are in the copy's scratch. False when memory is out. */
bool scree_evaluate_copy(const scree_world *world, scree_pair_copy *copy);
void scree_free_pair_copy(scree_pair_copy *copy);
