/* Neighbours are made by the broad phase and kept while two bounding boxes are near; pairs while
 * they are awake. Pairs are recycled with their places for feature pairs. */
#include "world/state/pairs.h"
#include "world/state/parameters.h"

#include "base/array.h"

void scree_pair_begin(scree_pair *pair, const scree_neighbours *n, uint32_t index) {
  scree_range place = {pair->active.first, 0, pair->active.capacity};
  *pair = (scree_pair){.a = n->a,
                       .b = n->b,
                       .wall = n->wall,
                       .spheres = n->spheres,
                       .asleep = n->asleep,
                       .list = n->list,
                       .active = place,
                       .neighbours = index,
                       .law = n->law,
                       .depth = -INFINITY,
                       .substeps.count = 1};
}

void scree_pair_end(const scree_pair *pair, scree_neighbours *n) {
  n->asleep = pair->asleep;
  n->list = pair->list;
}

uint32_t scree_pair_take(scree_world *world) {
  int64_t count = atomic_fetch_sub_explicit(&world->spare_pairs.count, 1, memory_order_relaxed);
  return count > 0 ? world->spare_pairs.items[count - 1] : scree_none;
}

/* There is room for all. */
void scree_pair_give_back(scree_world *world, uint32_t pair) {
  world->pairs.items[pair].active.count = 0;
  int64_t place = atomic_fetch_add_explicit(&world->spare_pairs.count, 1, memory_order_relaxed);
  world->spare_pairs.items[place] = pair;
}

static bool reserve_features(scree_world *world, size_t extra) {
  scree_pools *pools = &world->pools;
  return atomic_load(&pools->features_used) + extra <= pools->feature_capacity ||
         scree_pack_features(pools, world->pairs.items, world->pairs.count, extra);
}

/* As many again as there are, from 64 to 8192. */
bool scree_pairs_grow(scree_world *world) {
  int64_t spare = atomic_load(&world->spare_pairs.count);
  size_t total = world->pairs.count, missing = spare < 0 ? (size_t)-spare : 0,
         count = (total < 64     ? 64
                  : total > 8192 ? 8192
                                 : total) +
                 missing;
  if (total + count >= scree_none || !SCREE_RESERVE(&world->pairs, total + count) ||
      !SCREE_RESERVE(&world->spare_pairs, total + count) ||
      !reserve_features(world, SCREE_FIRST_FEATURES * count))
    return false;
  uint32_t first = (uint32_t)atomic_load(&world->pools.features_used);
  for (size_t i = 0; i < count; i++, first += SCREE_FIRST_FEATURES)
    world->pairs.items[total + i] = (scree_pair){.active = {first, 0, SCREE_FIRST_FEATURES}};
  atomic_store(&world->pools.features_used, first);
  world->pairs.count = total + count;
  atomic_store(&world->spare_pairs.count, spare < 0 ? 0 : spare);
  for (size_t i = total + count; i-- > total;) scree_pair_give_back(world, (uint32_t)i);
  return true;
}

/* Two pairs change places; their feature pairs too where these take as much room, so that they stay
 * in the order of their pairs. */
static void exchange_pairs(scree_world *world, scree_pair *one, scree_pair *other) {
  scree_pair kept = *one;
  *one = *other;
  *other = kept;
  if (one->active.capacity != other->active.capacity) return;
  scree_feature_pair *items = world->pools.features;
  scree_further *further = world->pools.further;
  uint32_t to = other->active.first, from = one->active.first, count = other->active.count;
  other->active.first = from;
  one->active.first = to;
  if (count < one->active.count) count = one->active.count;
  for (uint32_t i = 0; i < count; i++) {
    scree_feature_pair feature = items[from + i];
    scree_further more = further[from + i];
    items[from + i] = items[to + i];
    further[from + i] = further[to + i];
    items[to + i] = feature;
    further[to + i] = more;
  }
}

/* Moves the pairs to the first places, in the order of their neighbours. */
static void sort_pairs(scree_world *world) {
  uint32_t place = 0, *pair_of = world->list.pair_of.items;
  scree_pair *pairs = world->pairs.items;
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    uint32_t pair = pair_of[k], at = place;
    if (pair == scree_none) continue;
    place++;
    if (pair == at) continue;
    uint32_t there = pairs[at].neighbours; /* of one that came, or went long ago */
    exchange_pairs(world, &pairs[pair], &pairs[at]);
    if (there < world->list.neighbours.count && pair_of[there] == at) pair_of[there] = pair;
    pair_of[k] = at;
  }
  atomic_store(&world->spare_pairs.count, 0);
  for (size_t i = world->pairs.count; i-- > place;) scree_pair_give_back(world, (uint32_t)i);
}

void scree_pairs_tidy(scree_world *world) {
  size_t count = 0, astray = 0;
  uint32_t next = 0;
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    uint32_t pair = world->list.pair_of.items[k];
    if (pair == scree_none) continue;
    astray += pair != next;
    next = pair + 1;
    count++;
  }
  if (astray > count / 8 + 1) sort_pairs(world);
}

bool scree_body_has_neighbours(const scree_world *world, size_t body) {
  return body < world->list.body_count;
}

/* Contacts with other spheres; what they have booked stays. */
static void forget_spheres(scree_world *world, uint32_t body) {
  scree_sphere_list *list = &world->spheres.list;
  if (body >= list->body_count || list->place_of[body] == scree_none) return;
  const uint32_t place = list->place_of[body];
  for (size_t k = 0; k < list->pairs.count; k++) {
    scree_sphere_pair *two = &list->pairs.items[k];
    if (two->contact == scree_none || (two->a != place && two->b != place)) continue;
    two->contact &= ~scree_sphere_touches;
    scree_sphere_contact *c = &list->contacts.items[two->contact];
    *c = (scree_sphere_contact){.dashpot = c->dashpot, .tangential = c->tangential};
  }
}

/* All memory goes, also what is read only while they sleep: a checkpoint holds it. */
void scree_body_forget(scree_world *world, size_t body) {
  world->list.stale = true;
  if (!scree_body_has_neighbours(world, body)) return;
  forget_spheres(world, (uint32_t)body);
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    scree_neighbours *n = &world->list.neighbours.items[k];
    if (n->a != body && (n->wall || n->b != body)) continue;
    if (world->list.pair_of.items[k] != scree_none)
      scree_pair_give_back(world, world->list.pair_of.items[k]);
    world->list.pair_of.items[k] = scree_none;
    scree_range place = {n->sleeping.first, 0, n->sleeping.capacity};
    *n = scree_neighbours_new(world, n->a, n->b, n->wall);
    n->sleeping = place;
  }
}
