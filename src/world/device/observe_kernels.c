/* The kernels for whoever looks at a world, or has changed it: what the processor does in sums.c
 * and wall.c. */
#include "world/device/device.h"
#include "world/device/threads.h"
#include "world/sums.h"
#include "world/walls.h"

static void sum(scree_world *world, size_t part) {
  world->sums[part] = scree_sum_part(world, part);
}

STAGE(sums, sum, scree_sum_part_count(world))
STAGE(wall_forces, scree_wall_sum, world->walls.count)
STAGE(wall_threshold, scree_set_wall_wake_threshold, world->walls.count)
