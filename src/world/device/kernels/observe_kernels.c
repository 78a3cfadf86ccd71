/* The kernels for whoever looks at a world, or has changed it: what the processor does in sums.c
 * and wall_forces.c. */
#include "world/device/kernels/threads.h"
#include "world/observe/sums.h"
#include "world/state/walls.h"

static void sum(scree_world *world, size_t part) {
  world->residence.sums[part] = scree_sum_part(world, part);
}

STAGE(sums, sum, scree_sum_part_count(world))
STAGE(wall_forces, scree_wall_sum, world->walls.count)
STAGE(wall_threshold, scree_set_wall_wake_threshold, world->walls.count)
