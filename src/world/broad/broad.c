/* The broad phase: the stages of grids.c and lists.c in turn. The list of pairs stays valid until
 * some body's path since it was made exceeds half its margin, or a wall's. Room is made between the
 * stages, where it is known how much. */
#include "world/broad/broad.h"
#include "world/broad/grids.h"
#include "world/broad/lists.h"
#include "world/broad/spheres.h"
#include "world/state/pairs.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/parallel.h"

#include <string.h>

/* Rebuilds against extra pairs: of the mean body size. */
static const double margin_share = 0.1;

void scree_broad_free(scree_world *world) {
  scree_broad *broad = world->broad;
  if (!broad) return;
  void *arrays[] = {broad->boxes,
                    broad->cells,
                    broad->wall_reach,
                    broad->buckets.count,
                    broad->buckets.begin,
                    broad->binned,
                    broad->found,
                    broad->found_count,
                    broad->listed.count,
                    broad->listed.begin,
                    broad->old_keys,
                    broad->old_begin,
                    broad->match.items,
                    broad->left.count,
                    broad->left.begin,
                    broad->left_features.items,
                    broad->sides.count,
                    broad->spheres.count,
                    broad->walls.count,
                    broad->walls.begin,
                    broad};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) scree_free(arrays[i]);
}

/* For so many bodies; what counts begins at 0. */
static scree_status reserve_bodies(scree_broad *broad, size_t capacity, scree_error *error) {
  size_t buckets = 64;
  while (buckets < 2 * capacity) buckets *= 2;
  const struct {
    void **array;
    size_t count, size;
    bool counts;
  } arrays[] = {{(void **)&broad->boxes, capacity, sizeof *broad->boxes, false},
                {(void **)&broad->cells, capacity, sizeof *broad->cells, false},
                {(void **)&broad->binned, capacity, sizeof *broad->binned, false},
                {(void **)&broad->found, SCREE_FOUND * capacity, sizeof *broad->found, false},
                {(void **)&broad->found_count, capacity, sizeof *broad->found_count, false},
                {(void **)&broad->old_begin, capacity + 1, sizeof *broad->old_begin, false},
                {(void **)&broad->buckets.begin, buckets + 1, sizeof *broad->buckets.begin, false},
                {(void **)&broad->listed.begin, capacity + 1, sizeof *broad->listed.begin, false},
                {(void **)&broad->walls.begin, capacity + 1, sizeof *broad->walls.begin, false},
                {(void **)&broad->left.begin, capacity + 1, sizeof *broad->left.begin, false},
                {(void **)&broad->left.count, capacity, sizeof *broad->left.count, false},
                {(void **)&broad->buckets.count, buckets, sizeof *broad->buckets.count, true},
                {(void **)&broad->listed.count, capacity, sizeof *broad->listed.count, true},
                {(void **)&broad->sides.count, capacity, sizeof *broad->sides.count, true},
                {(void **)&broad->spheres.count, capacity, sizeof *broad->spheres.count, true},
                {(void **)&broad->walls.count, capacity, sizeof *broad->walls.count, true}};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
    void *moved = scree_resize(*arrays[i].array, arrays[i].count, arrays[i].size);
    if (!moved)
      return scree_fail_memory(error, arrays[i].count * arrays[i].size, "the broad phase");
    if (arrays[i].counts) memset(moved, 0, arrays[i].count * arrays[i].size);
    *arrays[i].array = moved;
  }
  broad->capacity = capacity;
  broad->bucket_count = buckets;
  return SCREE_OK;
}

scree_status scree_broad_reserve_bodies(scree_world *world, scree_error *error) {
  if (!world->broad) world->broad = scree_alloc_zero(1, sizeof *world->broad);
  scree_broad *broad = world->broad;
  if (!broad) return scree_fail_memory(error, sizeof *broad, "the broad phase");
  if (broad->capacity < world->bodies.capacity)
    SCREE_TRY(reserve_bodies(broad, world->bodies.capacity, error));
  if (!scree_array_reserve((void **)&broad->wall_reach, &broad->wall_capacity,
                           2 * world->walls.count, sizeof *broad->wall_reach))
    return scree_fail_memory(error, world->walls.count * sizeof *broad->wall_reach, "walls");
  broad->wall_gap = broad->wall_reach + world->walls.count;
  broad->sides.begin = world->list.side_begin;
  broad->buckets.length = broad->bucket_count;
  broad->listed.length = broad->sides.length = broad->walls.length = world->bodies.count;
  return SCREE_OK;
}

/* For the lists of `count` neighbours. */
static bool reserve_lists(scree_world *world, uint64_t count) {
  size_t k = (size_t)count;
  return count < SCREE_MOST_NEIGHBOURS && SCREE_RESERVE(&world->list.keys, k) &&
         SCREE_RESERVE(&world->broad->match, k) && SCREE_RESERVE(&world->list.neighbours, k) &&
         SCREE_RESERVE(&world->list.pair_of, k) && SCREE_RESERVE(&world->list.ledger, k) &&
         SCREE_RESERVE(&world->list.sides, 2 * k) && SCREE_RESERVE(&world->list.acting, 2 * k) &&
         SCREE_RESERVE(&world->list.wake_threshold, world->bodies.count + world->walls.count) &&
         SCREE_RESERVE(&world->list.slots, k) && SCREE_RESERVE(&world->list.touching, k / 64 + 1) &&
         SCREE_RESERVE(&world->broad->left_features, world->list.wall_pairs.count) &&
         SCREE_RESERVE(&world->list.wall_pairs, k);
}

/* ---- stages ---- */

/* In one piece. */
static void place_groups(scree_groups *scan) {
  scan->chunk = scan->length;
  scree_groups_place(scan, 0);
}

double scree_broad_margin(const scree_world *world) {
  const scree_bodies *bodies = &world->bodies;
  double size = 0;
  size_t present = 0;
  for (size_t i = 0; i < bodies->count; i++)
    if (!bodies->removed[i]) {
      size += bodies->particle[i]->measures.size;
      present++;
    }
  return present ? margin_share * size / (double)present : 0;
}

/* What is listed becomes the old list. */
static void keep_keys(scree_world *world) {
  scree_broad *broad = world->broad;
  uint64_t *keys = broad->old_keys;
  uint32_t *begin = broad->old_begin;
  size_t capacity = broad->old_key_capacity;
  broad->old_keys = world->list.keys.items;
  broad->old_key_capacity = world->list.keys.capacity;
  broad->old_begin = broad->listed.begin;
  world->list.keys.items = keys;
  world->list.keys.capacity = capacity;
  broad->listed.begin = begin;
}

/* Who is near whom, counted by first body. */
static void find_all(scree_world *world) {
  size_t bodies = world->bodies.count;
  world->broad->widest = 0;
  world->broad->used = 0;
  for (size_t w = 0; w < 2 * world->walls.count; w++) world->broad->wall_reach[w] = 0;
  scree_broad_run(world, scree_grids_box, bodies);
  scree_broad_run(world, scree_grids_begin, 1);
  scree_broad_run(world, scree_grids_cell, bodies);
  place_groups(&world->broad->buckets);
  scree_broad_run(world, scree_grids_bin, bodies);
  scree_broad_run(world, scree_grids_find, bodies);
  place_groups(&world->broad->listed);
  place_groups(&world->broad->spheres);
}

/* Those that stay, in place: first those that move down, then from the end those that move up. As
 * none overtakes another, nothing is written over that is still to move. */
static void carry_neighbours(scree_world *world) {
  const uint32_t *from = world->broad->match.items;
  size_t count = world->list.keys.count;
  for (size_t k = 0; k < count; k++)
    if (from[k] != scree_none && from[k] > k) scree_lists_carry(world, k);
  for (size_t k = count; k-- > 0;)
    if (from[k] != scree_none && from[k] < k) scree_lists_carry(world, k);
}

/* Those that do not stay. */
static void drop_neighbours(scree_world *world) {
  scree_broad *broad = world->broad;
  broad->left.length = broad->old_bodies;
  scree_broad_run(world, scree_lists_drop, broad->old_bodies);
  place_groups(&broad->left);
  scree_broad_run(world, scree_lists_leave, broad->old_bodies);
  scree_broad_run(world, scree_lists_leave_wall, world->walls.count);
}

/* The neighbours by the new keys. */
static void list_neighbours(scree_world *world) {
  scree_broad *broad = world->broad;
  size_t bodies = world->bodies.count, count = world->list.keys.count;
  broad->old_neighbours = world->list.neighbours.items;
  broad->old_pair_of = world->list.pair_of.items;
  broad->old_ledger = world->list.ledger.items;
  scree_broad_run(world, scree_grids_write, bodies);
  scree_broad_run(world, scree_lists_sort, bodies);
  scree_broad_run(world, scree_lists_match, count);
  drop_neighbours(world);
  carry_neighbours(world);
  world->list.neighbours.count = world->list.pair_of.count = count;
  scree_broad_run(world, scree_lists_renew, count);
  scree_pairs_tidy(world);
}

/* For every body the neighbours it is in, ascending: the order in which forces are summed; and what
 * else follows. */
static void list_sides(scree_world *world) {
  size_t bodies = world->bodies.count, count = world->list.keys.count;
  scree_broad_run(world, scree_lists_count, count);
  place_groups(&world->broad->sides);
  scree_broad_run(world, scree_lists_side, count);
  scree_broad_run(world, scree_lists_body, bodies);
  place_groups(&world->broad->walls);
  scree_broad_run(world, scree_lists_walls, bodies);
  scree_broad_run(world, scree_lists_touching, count / 64 + 1);
  scree_broad_run(world, scree_lists_end, 1);
  world->broad->old_bodies = world->list.body_count = bodies;
}

bool scree_broad_is_valid(const scree_world *world) {
  if (world->list.stale) return false;
  for (size_t w = 0; w < world->walls.count; w++)
    if (scree_wall_has_left(&world->walls.items[w])) return false;
  for (size_t i = 0; i < world->bodies.count; i++)
    if (!world->bodies.removed[i] && scree_body_has_left(world, i)) return false;
  return true;
}

static scree_status order_spheres(scree_world *world, scree_error *error) {
  SCREE_TRY(scree_spheres_reserve(world, error));
  SCREE_TRY(scree_spheres_order(world, error));
  world->broad->spheres.begin = world->spheres.list.begin;
  world->broad->spheres.length = world->spheres.list.count;
  return SCREE_OK;
}

scree_status scree_broad_update(scree_world *world, scree_error *error) {
  if (world->bodies.count == 0 || scree_broad_is_valid(world)) return SCREE_OK;
  SCREE_TRY(scree_broad_reserve_bodies(world, error));
  world->list.margin = scree_broad_margin(world);
  SCREE_TRY(order_spheres(world, error));
  keep_keys(world);
  find_all(world);
  uint64_t count = world->broad->listed.total, spheres = world->broad->spheres.total;
  if (!scree_spheres_reserve_pairs(world, (size_t)spheres))
    return scree_fail_memory(error, (size_t)spheres * sizeof(scree_sphere_contact),
                             "pairs of spheres");
  if (!reserve_lists(world, count))
    return scree_fail_memory(error, (size_t)count * sizeof(scree_neighbours), "pairs of bodies");
  world->list.keys.count = (size_t)count;
  world->spheres.list.pairs.count = (size_t)spheres;
  list_neighbours(world);
  list_sides(world);
  SCREE_TRY(scree_spheres_list(world, error));
  scree_broad_run(world, scree_lists_date, world->bodies.count);
  scree_broad_run(world, scree_lists_date_walls, 1);
  world->list.stale = false;
  world->timings.broad_builds++;
  return SCREE_OK;
}

bool scree_broad_reserve(scree_world *world) {
  return reserve_lists(world, world->list.neighbours.count);
}

scree_status scree_broad_restore(scree_world *world, double margin, scree_error *error) {
  size_t count = world->list.neighbours.count;
  SCREE_TRY(scree_broad_reserve_bodies(world, error));
  world->list.margin = margin;
  if (world->bodies.count == 0) return SCREE_OK; /* there are no arrays yet */
  if (!reserve_lists(world, count)) return scree_fail_memory(error, 0, "pairs of bodies");
  world->list.keys.count = count;
  scree_broad_run(world, scree_lists_key, count);
  place_groups(&world->broad->listed);
  scree_broad_run(world, scree_lists_sort, world->bodies.count);
  list_sides(world);
  return SCREE_OK;
}

enum { STAGE_BLOCK = 128 };

typedef struct stage {
  scree_world *world;
  scree_broad_stage *function;
} stage;

static void run_block(void *context, scree_block block) {
  const stage *s = context;
  for (size_t i = block.begin; i < block.end; i++) s->function(s->world, i);
}

void scree_broad_run(scree_world *world, scree_broad_stage *function, size_t count) {
  stage s = {world, function};
  scree_parallel_for(count, STAGE_BLOCK, run_block, &s);
}
