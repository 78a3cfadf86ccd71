/* The kernels of the broad phase: the stages of grids.c and lists.c, which the loops of broad.c
 * call too. */
#include "world/broad/grids.h"
#include "world/broad/lists.h"
#include "world/device/kernels/threads.h"

#define GROUPS(name, member)                                                                       \
  static void sum_##name(scree_world *world, size_t c) {                                           \
    scree_groups_sum(&world->broad->member, c);                                                    \
  }                                                                                                \
  static void place_##name(scree_world *world, size_t c) {                                         \
    scree_groups_place(&world->broad->member, c);                                                  \
  }                                                                                                \
  STAGE(name##_sums, sum_##name, scree_groups_chunks(&world->broad->member))                       \
  STAGE(name##_places, place_##name, scree_groups_chunks(&world->broad->member))

STAGE(box, scree_grids_box, world->bodies.count)
STAGE(grids, scree_grids_begin, 1)
STAGE(cell, scree_grids_cell, world->bodies.count)
GROUPS(bucket, buckets)
STAGE(bin, scree_grids_bin, world->bodies.count)
STAGE(find, scree_grids_find, world->bodies.count)
GROUPS(key, listed)
STAGE(key_write, scree_grids_write, world->bodies.count)
STAGE(key_sort, scree_lists_sort, world->bodies.count)
STAGE(match, scree_lists_match, world->list.keys.count)
STAGE(drop, scree_lists_drop, world->broad->old_bodies)
GROUPS(left, left)
STAGE(leave, scree_lists_leave, world->broad->old_bodies)
STAGE(leave_wall, scree_lists_leave_wall, world->walls.count)
STAGE(carry, scree_lists_carry, world->list.keys.count)
STAGE(renew, scree_lists_renew, world->list.keys.count)
STAGE(side_count, scree_lists_count, world->list.keys.count)
GROUPS(side, sides)
STAGE(side, scree_lists_side, world->list.keys.count)
STAGE(list_body, scree_lists_body, world->bodies.count)
GROUPS(wall, walls)
STAGE(list_walls, scree_lists_walls, world->bodies.count)
STAGE(list_touching, scree_lists_touching, world->list.keys.count / 64 + 1)

/* Bodies, and after them all walls. */
static void date(scree_world *world, size_t i) {
  if (i < world->bodies.count) {
    scree_lists_date(world, i);
    return;
  }
  scree_lists_end(world, 0);
  scree_lists_date_walls(world, 0);
}
STAGE(list_date, date, world->bodies.count + 1)
