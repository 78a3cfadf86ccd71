/* The list of neighbours and what follows from it. Old and new keys are both sorted, so that each
 * body's can be looked up in the other list: neighbours that stay keep what they are. */
#include "world/broad/lists.h"
#include "world/broad/grids.h"
#include "world/state/keys.h"
#include "world/state/pairs.h"
#include "world/state/parameters.h"

/* Ascending, without further memory (Shell 1959, with gaps of Knuth's): few as a rule. */
#define SORTS(name, type)                                                                          \
  void name(type *items, size_t count) {                                                           \
    size_t gap = 1;                                                                                \
    while (gap < count / 3) gap = 3 * gap + 1;                                                     \
    for (; gap > 0; gap /= 3)                                                                      \
      for (size_t i = gap; i < count; i++) {                                                       \
        type feature = items[i];                                                                   \
        size_t j = i;                                                                              \
        for (; j >= gap && items[j - gap] > feature; j -= gap) items[j] = items[j - gap];          \
        items[j] = feature;                                                                        \
      }                                                                                            \
  }
static SORTS(sort_keys, uint64_t) SORTS(scree_sort_places, uint32_t)
#undef SORTS

    static uint32_t first_of(uint64_t key) {
  return (uint32_t)(key >> 32);
}
static bool is_with_wall(uint64_t key) {
  return (key & scree_wall_partner) != 0;
}

void scree_lists_key(scree_world *world, size_t k) {
  const scree_neighbours *n = &world->list.neighbours.items[k];
  world->list.keys.items[k] = scree_key_of(n->a, n->b, n->wall);
  scree_atomic_add(&world->broad->listed.count[n->a], 1);
}

void scree_lists_sort(scree_world *world, size_t i) {
  const scree_broad *broad = world->broad;
  uint32_t begin = broad->listed.begin[i], count = broad->listed.begin[i + 1] - begin;
  sort_keys(world->list.keys.items + begin, count);
  broad->sides.count[i] = count;
}

/* The place of a key among those of its body; scree_none: it is not listed. */
static uint32_t find_key(const uint64_t *keys, const uint32_t *begins, uint64_t key) {
  uint32_t low = begins[first_of(key)], end = begins[first_of(key) + 1], high = end;
  while (low < high) {
    uint32_t middle = low + (high - low) / 2;
    if (keys[middle] < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < end && keys[low] == key ? low : scree_none;
}

void scree_lists_match(scree_world *world, size_t k) {
  const scree_broad *broad = world->broad;
  uint64_t key = world->list.keys.items[k];
  broad->match.items[k] = first_of(key) < broad->old_bodies
                              ? find_key(broad->old_keys, broad->old_begin, key)
                              : scree_none;
}

static bool is_dropped(const scree_world *world, size_t k) {
  const scree_broad *broad = world->broad;
  return find_key(world->list.keys.items, broad->listed.begin, broad->old_keys[k]) == scree_none;
}

void scree_lists_drop(scree_world *world, size_t i) {
  const scree_broad *broad = world->broad;
  scree_balance *balance = &world->bodies.balance[i];
  uint32_t walls = 0;
  for (uint32_t k = broad->old_begin[i]; k < broad->old_begin[i + 1]; k++) {
    if (!is_dropped(world, k)) continue;
    balance->dashpot += broad->old_ledger[k].dashpot;
    balance->tangential += broad->old_ledger[k].tangential;
    if (broad->old_pair_of[k] != scree_none) scree_pair_give_back(world, broad->old_pair_of[k]);
    walls += is_with_wall(broad->old_keys[k]);
  }
  broad->left.count[i] = walls;
}

void scree_lists_leave(scree_world *world, size_t i) {
  const scree_broad *broad = world->broad;
  uint32_t place = broad->left.begin[i], end = broad->left.begin[i + 1];
  for (uint32_t k = broad->old_begin[i + 1]; place < end; k--)
    if (is_dropped(world, k - 1)) broad->left_features.items[--end] = k - 1;
}

void scree_lists_leave_wall(scree_world *world, size_t w) {
  const scree_broad *broad = world->broad;
  for (uint64_t j = 0; j < broad->left.total; j++) {
    uint32_t k = broad->left_features.items[j];
    if (scree_key_second(broad->old_keys[k]) == w)
      world->walls.items[w].energy += broad->old_ledger[k].wall;
  }
}

void scree_lists_carry(scree_world *world, size_t k) {
  const scree_broad *broad = world->broad;
  uint32_t from = broad->match.items[k];
  if (from == scree_none) return;
  world->list.neighbours.items[k] = broad->old_neighbours[from];
  world->list.pair_of.items[k] = broad->old_pair_of[from];
  world->list.ledger.items[k] = broad->old_ledger[from];
}

void scree_lists_renew(scree_world *world, size_t k) {
  uint64_t key = world->list.keys.items[k];
  if (world->broad->match.items[k] == scree_none) {
    world->list.neighbours.items[k] =
        scree_neighbours_new(world, first_of(key), scree_key_second(key), is_with_wall(key));
    world->list.pair_of.items[k] = scree_none;
    world->list.ledger.items[k] = (scree_balance){0, 0, 0};
    return;
  }
  scree_pair *pair = scree_pair_of(world, k);
  if (pair) pair->neighbours = (uint32_t)k;
}

void scree_lists_count(scree_world *world, size_t k) {
  uint64_t key = world->list.keys.items[k];
  if (!is_with_wall(key)) scree_atomic_add(&world->broad->sides.count[scree_key_second(key)], 1);
}

/* A body's sides are first those of neighbours that it is second in, which all come earlier in the
 * list. */
void scree_lists_side(scree_world *world, size_t k) {
  const scree_broad *broad = world->broad;
  const uint32_t *begin = broad->listed.begin, *sides = broad->sides.begin;
  uint64_t key = world->list.keys.items[k];
  uint32_t a = first_of(key), b = scree_key_second(key);
  world->list.sides.items[sides[a + 1] - (begin[a + 1] - (uint32_t)k)] = (uint32_t)(2 * k);
  if (!is_with_wall(key))
    world->list.sides.items[scree_groups_take(&broad->sides, b) - (begin[b + 1] - begin[b])] =
        (uint32_t)(2 * k + 1);
  const scree_neighbours *n = &world->list.neighbours.items[k];
  world->list.slots.items[k] =
      (scree_slot){n->asleep ? n->wake : -INFINITY, a,
                   is_with_wall(key) ? (uint32_t)world->bodies.count + b : b};
}

void scree_lists_body(scree_world *world, size_t i) {
  const scree_broad *broad = world->broad;
  uint32_t begin = broad->listed.begin[i], end = broad->listed.begin[i + 1], walls = 0;
  uint32_t sides = broad->sides.begin[i + 1] - broad->sides.begin[i];
  scree_sort_places(world->list.sides.items + broad->sides.begin[i], sides - (end - begin));
  while (walls < end - begin && is_with_wall(world->list.keys.items[end - 1 - walls])) walls++;
  broad->walls.count[i] = walls;
  broad->listed.count[i] = 0;
  scree_set_body_wake_threshold(world, i);
}

void scree_lists_walls(scree_world *world, size_t i) {
  const scree_broad *broad = world->broad;
  uint32_t begin = broad->walls.begin[i], count = broad->walls.begin[i + 1] - begin,
           first = broad->listed.begin[i + 1] - count;
  for (uint32_t j = 0; j < count; j++) world->list.wall_pairs.items[begin + j] = first + j;
}

void scree_lists_touching(scree_world *world, size_t word) {
  uint64_t bits = 0;
  for (size_t k = 64 * word; k < 64 * word + 64 && k < world->list.neighbours.count; k++) {
    const scree_pair *pair = scree_pair_of(world, k);
    if (pair && pair->touching) bits |= (uint64_t)1 << k % 64;
  }
  world->list.touching.items[word] = bits;
}

void scree_lists_end(scree_world *world, size_t i) {
  (void)i;
  world->list.slots.count = world->list.neighbours.count;
  world->list.wake_threshold.count = world->bodies.count + world->walls.count;
  world->list.sides.count = world->broad->sides.total;
  world->list.wall_pairs.count = world->broad->walls.total;
  for (size_t w = 0; w < world->walls.count; w++) scree_set_wall_wake_threshold(world, w);
}

void scree_lists_date(scree_world *world, size_t i) {
  world->list.body_path_at_build[i] = world->bodies.path[i];
}

void scree_lists_date_walls(scree_world *world, size_t i) {
  (void)i;
  scree_grids_widen_walls(world);
  for (size_t w = 0; w < world->walls.count; w++)
    world->walls.items[w].path_at_build = world->walls.items[w].path;
}
