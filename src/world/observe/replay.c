/* A pair is evaluated once more on a copy of its memory, so that looking changes nothing. */
#include "world/observe/replay.h"
#include "world/contact/contact.h"
#include "world/contact/spheres.h"
#include "world/state/pairs.h"

#include "base/alloc.h"
#include "base/array.h"

bool scree_copy_pair(const scree_world *world, const scree_pair *pair, scree_pair_copy *copy) {
  const scree_pools *from = &world->pools;
  scree_pair *p = &copy->pair;
  scree_neighbours *n = &copy->neighbours;
  scree_pools_free(&copy->pools);
  copy->pools = (scree_pools){0};
  *p = *pair;
  *n = (scree_neighbours){.a = pair->a, .b = pair->b, .spheres = true, .law = pair->law};
  if (pair->spheres && !pair->wall) return true; /* two spheres have no lists */
  *n = world->list.neighbours.items[pair->neighbours];
  p->active.count = n->sleeping.count = 0; /* nothing to move yet */
  if (!scree_pack_features(&copy->pools, p, 1, 0) || !scree_pack_sleeping(&copy->pools, n, 1))
    return false;
  p->active.count = pair->active.count;
  n->sleeping.count = world->list.neighbours.items[pair->neighbours].sleeping.count;
  for (uint32_t i = 0; i < p->active.count; i++) {
    copy->pools.features[i] = from->features[pair->active.first + i];
    copy->pools.further[i] = from->further[pair->active.first + i];
  }
  uint32_t first = world->list.neighbours.items[pair->neighbours].sleeping.first;
  for (uint32_t i = 0; i < n->sleeping.count; i++)
    copy->pools.sleeping_features[i] = from->sleeping_features[first + i];
  return true;
}

static bool evaluate_spheres(const scree_world *world, scree_pair_copy *copy) {
  scree_contact_list *contacts = &copy->scratch.contacts;
  if (!SCREE_RESERVE(contacts, 1)) return false;
  scree_take_in_hand(&copy->scratch, &copy->pools, &copy->pair, &copy->neighbours);
  scree_spheres_evaluate(world, &copy->pair, &copy->scratch, contacts->items);
  contacts->count = copy->pair.touching;
  return true;
}

bool scree_evaluate_copy(const scree_world *world, scree_pair_copy *copy) {
  if (copy->pair.spheres) return evaluate_spheres(world, copy);
  for (;;) {
    scree_take_in_hand(&copy->scratch, &copy->pools, &copy->pair, &copy->neighbours);
    if (scree_pair_narrow_phase(world, &copy->pair, &copy->scratch)) return true;
    if (!SCREE_RESERVE(&copy->scratch.contacts, copy->scratch.contacts_needed) ||
        !scree_pools_grow(&copy->pools, &copy->pair, 1, &copy->neighbours, 1))
      return false;
  }
}

void scree_free_pair_copy(scree_pair_copy *copy) {
  scree_pools_free(&copy->pools);
  scree_free(copy->scratch.contacts.items);
}
