/* Pools: the lists of all pairs in one array a kind. Lists double as they grow and leave their old
 * places behind; packing them anew is both how a pool grows and how it is swept. */
#include "world/state/pairs.h"
#include "world/state/scratch.h"

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

bool scree_grow_features(scree_scratch *s, scree_pair *pair, uint32_t needed) {
  scree_pools *pools = s->pools;
  scree_range place;
  if (!take_place(&pools->features_used, pools->feature_capacity, SCREE_FIRST_FEATURES, needed,
                  &pair->active, &place))
    return false;
  for (uint32_t i = 0; i < place.count; i++) {
    pools->features[place.first + i] = s->features[i];
    if (s->features[i].notched) pools->further[place.first + i] = s->further[i];
  }
  pair->active = place;
  s->features = pools->features + place.first;
  s->further = pools->further + place.first;
  return true;
}

bool scree_grow_sleeping(scree_scratch *s, uint32_t needed) {
  scree_pools *pools = s->pools;
  scree_range place;
  if (!take_place(&pools->sleeping_used, pools->sleeping_capacity, SCREE_FIRST_SLEEPING, needed,
                  &s->neighbours->sleeping, &place))
    return false;
  const scree_sleeping_feature *from = scree_sleeping_features(s);
  for (uint32_t i = 0; i < place.count; i++) pools->sleeping_features[place.first + i] = from[i];
  s->neighbours->sleeping = place;
  return true;
}

bool scree_reserve_contacts(scree_scratch *s, size_t needed) {
  scree_pools *pools = s->pools;
  if (needed <= s->contacts.capacity) return true;
  s->contacts_needed = needed;
  if (!pools->contacts) return false;
  uint64_t first = atomic_fetch_add_explicit(&pools->contacts_used, needed, memory_order_relaxed);
  if (first + needed > pools->contact_capacity) return false;
  s->first_contact = (size_t)first;
  s->contacts = (scree_contact_list){pools->contacts + first, 0, needed};
  return true;
}

/* The capacity of a pool whose lists have `total` places. What was asked for in vain is in `used`.
 */
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

bool scree_pack_features(scree_pools *pools, scree_pair *pairs, size_t count, size_t extra) {
  uint64_t total = 0;
  for (size_t p = 0; p < count; p++) total += trimmed(&pairs[p].active, SCREE_FIRST_FEATURES);
  uint64_t capacity =
      roomy(total, extra, atomic_load(&pools->features_used), pools->feature_capacity);
  if (capacity > UINT32_MAX) return false;
  scree_feature_pair *items = scree_alloc(capacity, sizeof *items);
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
      items[used + i] = pools->features[range->first + i];
      if (items[used + i].notched) further[used + i] = pools->further[range->first + i];
    }
    range->first = used;
    range->capacity = trimmed(range, SCREE_FIRST_FEATURES);
    used += range->capacity;
  }
  scree_free(pools->features);
  scree_free(pools->further);
  pools->features = items;
  pools->further = further;
  pools->feature_capacity = capacity;
  atomic_store(&pools->features_used, used);
  return true;
}

bool scree_pack_sleeping(scree_pools *pools, scree_neighbours *neighbours, size_t count) {
  uint64_t total = 0;
  for (size_t k = 0; k < count; k++)
    total += trimmed(&neighbours[k].sleeping, SCREE_FIRST_SLEEPING);
  uint64_t capacity = roomy(total, 0, atomic_load(&pools->sleeping_used), pools->sleeping_capacity);
  if (capacity > UINT32_MAX) return false;
  scree_sleeping_feature *sleeping_features = scree_alloc(capacity, sizeof *sleeping_features);
  if (!sleeping_features) return false;
  uint32_t used = 0;
  for (size_t k = 0; k < count; k++) {
    scree_range *range = &neighbours[k].sleeping;
    if (range->count)
      memcpy(sleeping_features + used, pools->sleeping_features + range->first,
             range->count * sizeof *sleeping_features);
    range->first = used;
    range->capacity = trimmed(range, SCREE_FIRST_SLEEPING);
    used += range->capacity;
  }
  scree_free(pools->sleeping_features);
  pools->sleeping_features = sleeping_features;
  pools->sleeping_capacity = capacity;
  atomic_store(&pools->sleeping_used, used);
  return true;
}

bool scree_pools_grow(scree_pools *pools, scree_pair *pairs, size_t pair_count,
                      scree_neighbours *neighbours, size_t neighbour_count) {
  return (atomic_load(&pools->features_used) <= pools->feature_capacity ||
          scree_pack_features(pools, pairs, pair_count, 0)) &&
         (atomic_load(&pools->sleeping_used) <= pools->sleeping_capacity ||
          scree_pack_sleeping(pools, neighbours, neighbour_count));
}

void scree_pools_free(scree_pools *pools) {
  scree_free(pools->features);
  scree_free(pools->further);
  scree_free(pools->sleeping_features);
}
