/* Neighbours are made by the broad phase and kept while two bounding boxes are near; pairs while
 * they are awake. Both are recycled with their arrays, so that a warm world allocates nothing. */
#include "world/world.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/parallel.h"

#include <string.h>

static double size_of(const scree_world *world, const scree_particle *particle) {
  return world->options.size > 0 ? world->options.size : particle->measures.size;
}

double scree_thin_overlap(const scree_particle *particle) {
  /* rays grazing a notch find walls thinner than they are: never below four roundings */
  const scree_particle_measures *m = &particle->measures;
  return fmax(0.5 * m->thickness, 4 * m->rounding);
}

static void set_up(scree_world *world, scree_neighbours *n) {
  const scree_bodies *bodies = &world->bodies;
  const scree_particle *a = bodies->particle[n->a], *b = scree_shape_of(world, n->b, n->wall);
  double size = size_of(world, a), mass = bodies->mass[n->a], thin = scree_thin_overlap(a);
  size_t material_a = bodies->material[n->a], material_b;
  if (n->wall) {
    material_b = world->walls.items[n->b].given.material;
  } else {
    material_b = bodies->material[n->b];
    size = fmin(size, size_of(world, b));
    mass = mass * bodies->mass[n->b] / (mass + bodies->mass[n->b]);
    thin = fmin(thin, scree_thin_overlap(b));
  }
  const scree_material_pair *contact = &world->contacts[material_a][material_b];
  n->law.stiffness = scree_pair_stiffness(world, material_a, material_b, size);
  n->law.damping = world->options.law == SCREE_LAW_LINEAR
                       ? 2 * contact->damping_ratio * sqrt(mass * n->law.stiffness)
                       : 0;
  n->law.contact_time = 3.14159265358979323846 * sqrt(mass / n->law.stiffness);
  n->law.friction = contact->friction;
  n->law.restitution = contact->restitution;
  n->law.smoothing = world->options.smoothing * size;
  n->law.limit = world->options.overlap_limit * size;
  n->law.thin = fmin(n->law.limit, thin);
  n->law.reach =
      (a->face_count ? a->measures.rounding : 0) + (b && b->face_count ? b->measures.rounding : 0);
}

/* There is room for all. */
static void give_pair_back(scree_world *world, scree_pair *pair) {
  world->spare_pairs.items[world->spare_pairs.count++] = pair;
}

/* All memory goes, also what is read only while they sleep: a checkpoint holds it. */
static void forget(scree_world *world, scree_neighbours *n) {
  if (n->pair) give_pair_back(world, n->pair);
  n->pair = NULL;
  n->asleep = false;
  n->sleeping.count = 0;
  n->list = (scree_list_state){.next_item = -INFINITY, .end = -INFINITY};
  n->wake = n->asleep_since = 0;
  n->asleep_at = (vec3){0};
  n->asleep_turned = (quat){0};
}

static void use_own_items(scree_pair *pair) {
  pair->active.items = pair->own_items;
  pair->active.capacity = SCREE_OWN_ITEMS;
  pair->further = pair->own_further;
}

/* How many to make where there are `total`: as many again, from 64 to 8192 (5 MB of pairs). */
static size_t spares_for(size_t total) {
  return total < 64 ? 64 : total > 8192 ? 8192 : total;
}

static bool make_spare_neighbours(scree_world *world) {
  size_t total = 0;
  for (size_t i = 0; i < world->neighbour_slabs.count; i++)
    total += world->neighbour_slabs.items[i].count;
  size_t count = spares_for(total);
  if (!SCREE_RESERVE(&world->neighbour_slabs, world->neighbour_slabs.count + 1) ||
      !SCREE_RESERVE(&world->spare_neighbours, world->spare_neighbours.count + count))
    return false;
  scree_neighbours *items = scree_alloc_zero(count, sizeof *items);
  if (!items) return false;
  world->neighbour_slabs.items[world->neighbour_slabs.count++] =
      (scree_neighbour_slab){items, count};
  for (size_t i = count; i-- > 0;)
    world->spare_neighbours.items[world->spare_neighbours.count++] = &items[i];
  return true;
}

static bool make_spare_pairs(scree_world *world) {
  size_t total = 0;
  for (size_t i = 0; i < world->pair_slabs.count; i++) total += world->pair_slabs.items[i].count;
  size_t count = spares_for(total);
  /* room for all: giving back needs none */
  if (!SCREE_RESERVE(&world->pair_slabs, world->pair_slabs.count + 1) ||
      !SCREE_RESERVE(&world->spare_pairs, total + count))
    return false;
  scree_pair *pairs = scree_alloc_zero(count, sizeof *pairs);
  scree_further *further = scree_alloc_zero(SCREE_OWN_ITEMS * count, sizeof *further);
  if (!pairs || !further) {
    scree_free(pairs);
    scree_free(further);
    return false;
  }
  for (size_t i = 0; i < count; i++) {
    pairs[i].own_further = &further[SCREE_OWN_ITEMS * i];
    use_own_items(&pairs[i]);
  }
  world->pair_slabs.items[world->pair_slabs.count++] = (scree_pair_slab){pairs, further, count};
  for (size_t i = count; i-- > 0;) world->spare_pairs.items[world->spare_pairs.count++] = &pairs[i];
  return true;
}

scree_neighbours *scree_neighbours_take(scree_world *world, uint32_t a, uint32_t b, bool wall) {
  if (world->spare_neighbours.count == 0 && !make_spare_neighbours(world)) return NULL;
  scree_neighbours *n = world->spare_neighbours.items[--world->spare_neighbours.count];
  n->a = a;
  n->b = b;
  n->wall = wall;
  forget(world, n);
  set_up(world, n);
  return n;
}

/* What finds no room among the spares stays with its slab. */
void scree_neighbours_give_back(scree_world *world, scree_neighbours *n) {
  forget(world, n);
  (void)SCREE_PUSH(&world->spare_neighbours, n);
}

static scree_pair *take_pair(scree_world *world) {
  if (world->spare_pairs.count == 0 && !make_spare_pairs(world)) return NULL;
  return world->spare_pairs.items[--world->spare_pairs.count];
}

scree_pair *scree_pair_wake(scree_scratch *scratch, scree_neighbours *n) {
  scree_pair *p = &scratch->pair;
  p->own_further = scratch->further;
  use_own_items(p);
  p->neighbours = n;
  p->a = n->a;
  p->b = n->b;
  p->wall = n->wall;
  p->asleep = n->asleep;
  p->touching = false;
  p->contact_count = 0;
  p->wrench = (scree_wrench){0};
  p->dashpot = p->tangential = (scree_kept_load){0};
  p->list = n->list;
  p->law = n->law;
  p->age = p->overlap = p->largest = p->elastic = p->tangential_elastic = 0;
  p->active.count = 0;
  return p;
}

/* All but what belongs to the place itself; where the items fill an array of their own, the arrays
 * change places. */
static void move_pair(scree_pair *from, scree_pair *to) {
  scree_further *own_further = to->own_further;
  scree_item_array array = to->array;
  bool own = from->active.items == from->own_items;
  *to = *from;
  to->own_further = own_further;
  if (own) {
    to->array = array;
    memcpy(own_further, from->own_further, from->active.count * sizeof *own_further);
    use_own_items(to);
  } else {
    from->array = array;
    use_own_items(from);
  }
}

/* Two places change their contents, further anchors and arrays of items with them. */
static void exchange_pairs(scree_pair *one, scree_pair *other) {
  scree_pair kept = *one;
  bool own = other->active.items == other->own_items;
  *one = *other;
  if (own) one->active.items = one->own_items;
  own = kept.active.items == one->own_items;
  *other = kept;
  if (own) other->active.items = other->own_items;
}

/* Moves the pairs to the first places, in the order of their neighbours. */
static void sort_pairs(scree_world *world) {
  const scree_pair_slab *slabs = world->pair_slabs.items;
  size_t slab = 0, at = 0;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    scree_neighbours *n = world->neighbours.items[k];
    if (!n->pair) continue;
    if (at == slabs[slab].count) slab++, at = 0;
    scree_pair *place = &slabs[slab].pairs[at++], *pair = n->pair;
    if (place == pair) continue;
    scree_neighbours *there = place->neighbours; /* of one that came, or went long ago */
    exchange_pairs(pair, place);
    if (there && there->pair == place) there->pair = pair;
    n->pair = place;
  }
  world->spare_pairs.count = 0;
  for (size_t s = world->pair_slabs.count; s-- > slab;)
    for (size_t i = slabs[s].count; i-- > (s == slab ? at : 0);)
      world->spare_pairs.items[world->spare_pairs.count++] = &slabs[s].pairs[i];
}

void scree_pairs_tidy(scree_world *world) {
  size_t count = 0, astray = 0;
  const scree_pair *next = NULL;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    const scree_pair *pair = world->neighbours.items[k]->pair;
    if (!pair) continue;
    astray += pair != next;
    next = pair + 1;
    count++;
  }
  if (astray > count / 8 + 1) sort_pairs(world);
}

bool scree_pair_settle(scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  scree_neighbours *n = pair->neighbours;
  bool stays = pair->active.count > 0;
  if (!stays) {
    n->asleep = pair->asleep;
    n->list = pair->list;
  }
  if (stays != (pair == &scratch->pair)) return true;
  scree_enter_alone();
  if (stays)
    n->pair = take_pair(world);
  else
    give_pair_back(world, n->pair);
  scree_leave_alone();
  if (!stays)
    n->pair = NULL;
  else if (n->pair)
    move_pair(pair, n->pair);
  return !stays || n->pair;
}

void scree_neighbours_set_up(scree_world *world) {
  for (size_t k = 0; k < world->neighbours.count; k++) {
    scree_neighbours *n = world->neighbours.items[k];
    set_up(world, n);
    if (n->pair) n->pair->law = n->law;
  }
}

void scree_neighbours_wake(scree_world *world, size_t wall) {
  for (size_t k = 0; k < world->neighbours.count; k++) {
    scree_neighbours *n = world->neighbours.items[k];
    if (n->wall && n->b == wall && n->asleep) n->wake = -INFINITY;
  }
}

bool scree_pair_reserve_items(scree_pair *pair, size_t needed) {
  if (needed <= pair->active.capacity) return true;
  scree_item *before = pair->active.items, *items = pair->array.items;
  size_t capacity = pair->array.capacity, count = pair->active.count;
  bool grows = needed > capacity;
  if (grows) {
    capacity = 2 * pair->active.capacity < needed ? needed : 2 * pair->active.capacity;
    items = scree_alloc(capacity, sizeof *items + sizeof *pair->further);
    if (!items) return false;
  }
  scree_further *further = (scree_further *)(items + capacity);
  memcpy(items, before, count * sizeof *items);
  memcpy(further, pair->further, count * sizeof *further);
  if (grows) scree_free(pair->array.items);
  pair->array = (scree_item_array){items, capacity};
  pair->active.items = items;
  pair->active.capacity = capacity;
  pair->further = further;
  return true;
}

void scree_pair_trim_items(scree_pair *pair) {
  if (pair->active.items == pair->own_items || pair->active.count > SCREE_OWN_ITEMS) return;
  memcpy(pair->own_items, pair->active.items, pair->active.count * sizeof *pair->own_items);
  memcpy(pair->own_further, pair->further, pair->active.count * sizeof *pair->further);
  use_own_items(pair);
}

bool scree_copy_pair(const scree_pair *pair, scree_pair_copy *copy) {
  size_t active = pair->active.count, sleeping = pair->neighbours->sleeping.count;
  scree_pair *p = &copy->pair;
  scree_neighbours *n = &copy->neighbours;
  *p = *pair;
  *n = *pair->neighbours;
  p->neighbours = n;
  p->own_further = copy->further;
  use_own_items(p);
  p->array = (scree_item_array){0};
  n->pair = NULL;
  n->sleeping.items = NULL;
  n->sleeping.capacity = p->active.count = 0; /* nothing to move yet */
  if (!scree_pair_reserve_items(p, active) || !SCREE_RESERVE(&n->sleeping, sleeping)) return false;
  p->active.count = active;
  memcpy(p->active.items, pair->active.items, active * sizeof *p->active.items);
  memcpy(p->further, pair->further, active * sizeof *p->further);
  if (sleeping)
    memcpy(n->sleeping.items, pair->neighbours->sleeping.items,
           sleeping * sizeof *n->sleeping.items);
  return true;
}

void scree_free_pair_copy(scree_pair_copy *copy) {
  scree_free(copy->pair.array.items);
  scree_free(copy->neighbours.sleeping.items);
}

void scree_pairs_free(scree_world *world) {
  for (size_t s = 0; s < world->neighbour_slabs.count; s++) {
    scree_neighbour_slab *slab = &world->neighbour_slabs.items[s];
    for (size_t i = 0; i < slab->count; i++) scree_free(slab->items[i].sleeping.items);
    scree_free(slab->items);
  }
  for (size_t s = 0; s < world->pair_slabs.count; s++) {
    scree_pair_slab *slab = &world->pair_slabs.items[s];
    for (size_t i = 0; i < slab->count; i++) scree_free(slab->pairs[i].array.items);
    scree_free(slab->pairs);
    scree_free(slab->further);
  }
  scree_free(world->neighbour_slabs.items);
  scree_free(world->pair_slabs.items);
}

void scree_body_forget(scree_world *world, size_t body) {
  world->pairs_stale = true;
  for (size_t i = 0; i < world->neighbours.count; i++) {
    scree_neighbours *n = world->neighbours.items[i];
    if (n->a == body || (!n->wall && n->b == body)) forget(world, n);
  }
}
