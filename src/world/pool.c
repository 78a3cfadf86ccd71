/* Pools: the lists of all pairs in one array a kind. Lists double as they grow and leave their old
 * places behind; packing them anew is both how a pool grows and how it is swept. */
#include "world/contact.h"
#include "world/pairs.h"

#include "base/alloc.h"

#include <string.h>

/* A place for a list that needs room for `needed`, in range->capacity from *first on. */
static bool take_place(atomic_uint_least64_t *used, uint64_t pool_capacity, uint32_t least,
                       uint32_t needed, const scree_range *range, scree_range *place) {
  uint32_t capacity = range->capacity < least ? least : 2 * range->capacity;
  if (capacity < needed) capacity = needed;
  uint64_t first = atomic_fetch_add_explicit(used, capacity, memory_order_relaxed);
  *place = (scree_range){(uint32_t)first, range->count, capacity};
  return first + capacity <= pool_capacity;
}

bool scree_grow_items(scree_scratch *s, scree_pair *pair, uint32_t needed) {
  scree_pools *pools = s->pools;
  scree_range place;
  if (!take_place(&pools->items_used, pools->item_capacity, SCREE_FIRST_ITEMS, needed,
                  &pair->active, &place))
    return false;
  for (uint32_t i = 0; i < place.count; i++) {
    pools->items[place.first + i] = s->items[i];
    if (s->items[i].notched) pools->further[place.first + i] = s->further[i];
  }
  pair->active = place;
  s->items = pools->items + place.first;
  s->further = pools->further + place.first;
  return true;
}

bool scree_grow_sleepers(scree_scratch *s, uint32_t needed) {
  scree_pools *pools = s->pools;
  scree_range place;
  if (!take_place(&pools->sleepers_used, pools->sleeper_capacity, SCREE_FIRST_SLEEPERS, needed,
                  &s->neighbours->sleeping, &place))
    return false;
  const scree_sleeper *from = scree_sleepers(s);
  for (uint32_t i = 0; i < place.count; i++) pools->sleepers[place.first + i] = from[i];
  s->neighbours->sleeping = place;
  return true;
}

bool scree_reserve_touches(scree_scratch *s, size_t needed) {
  scree_pools *pools = s->pools;
  if (needed <= s->touches.capacity) return true;
  s->touches_needed = needed;
  if (!pools->touches) return false;
  uint64_t first = atomic_fetch_add_explicit(&pools->touches_used, needed, memory_order_relaxed);
  if (first + needed > pools->touch_capacity) return false;
  s->first_touch = (size_t)first;
  s->touches = (scree_touch_list){pools->touches + first, 0, needed};
  return true;
}

/* Of a pool whose lists have `total` places. What was asked for in vain is in `used`. */
static uint64_t roomy(uint64_t total, uint64_t extra, uint64_t used, uint64_t capacity) {
  uint64_t asked = used > capacity ? used - capacity : 0, needed = total + extra + asked;
  return needed < 512 ? 1024 : needed + needed / 2;
}

/* Room for as much again as is in the list: what was needed once, right after the neighbours were
 * found, is given up. */
static uint32_t trimmed(const scree_range *range, uint32_t least) {
  uint32_t most = 2 * range->count < least ? least : 2 * range->count;
  return range->capacity < most ? range->capacity : most;
}

bool scree_pack_items(scree_pools *pools, scree_pair *pairs, size_t count, size_t extra) {
  uint64_t total = 0;
  for (size_t p = 0; p < count; p++) total += trimmed(&pairs[p].active, SCREE_FIRST_ITEMS);
  uint64_t capacity = roomy(total, extra, atomic_load(&pools->items_used), pools->item_capacity);
  if (capacity > UINT32_MAX) return false;
  scree_item *items = scree_alloc(capacity, sizeof *items);
  scree_further *further = scree_alloc(capacity, sizeof *further);
  if (!items || !further) {
    scree_free(items);
    scree_free(further);
    return false;
  }
  uint32_t used = 0;
  for (size_t p = 0; p < count; p++) {
    scree_range *range = &pairs[p].active;
    for (uint32_t i = 0; i < range->count; i++) {
      items[used + i] = pools->items[range->first + i];
      if (items[used + i].notched) further[used + i] = pools->further[range->first + i];
    }
    range->first = used;
    range->capacity = trimmed(range, SCREE_FIRST_ITEMS);
    used += range->capacity;
  }
  scree_free(pools->items);
  scree_free(pools->further);
  pools->items = items;
  pools->further = further;
  pools->item_capacity = capacity;
  atomic_store(&pools->items_used, used);
  return true;
}

bool scree_pack_sleepers(scree_pools *pools, scree_neighbours *neighbours, size_t count) {
  uint64_t total = 0;
  for (size_t k = 0; k < count; k++)
    total += trimmed(&neighbours[k].sleeping, SCREE_FIRST_SLEEPERS);
  uint64_t capacity = roomy(total, 0, atomic_load(&pools->sleepers_used), pools->sleeper_capacity);
  if (capacity > UINT32_MAX) return false;
  scree_sleeper *sleepers = scree_alloc(capacity, sizeof *sleepers);
  if (!sleepers) return false;
  uint32_t used = 0;
  for (size_t k = 0; k < count; k++) {
    scree_range *range = &neighbours[k].sleeping;
    if (range->count)
      memcpy(sleepers + used, pools->sleepers + range->first, range->count * sizeof *sleepers);
    range->first = used;
    range->capacity = trimmed(range, SCREE_FIRST_SLEEPERS);
    used += range->capacity;
  }
  scree_free(pools->sleepers);
  pools->sleepers = sleepers;
  pools->sleeper_capacity = capacity;
  atomic_store(&pools->sleepers_used, used);
  return true;
}

bool scree_pools_grow(scree_pools *pools, scree_pair *pairs, size_t pair_count,
                      scree_neighbours *neighbours, size_t neighbour_count) {
  return (atomic_load(&pools->items_used) <= pools->item_capacity ||
          scree_pack_items(pools, pairs, pair_count, 0)) &&
         (atomic_load(&pools->sleepers_used) <= pools->sleeper_capacity ||
          scree_pack_sleepers(pools, neighbours, neighbour_count));
}

void scree_pools_free(scree_pools *pools) {
  scree_free(pools->items);
  scree_free(pools->further);
  scree_free(pools->sleepers);
}
