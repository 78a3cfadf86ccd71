/* Pair objects: made by the broad phase, kept while two bounding boxes are near, recycled with
 * their arrays so that a warm world allocates nothing. */
#include "world/world.h"

#include "base/alloc.h"
#include "base/array.h"

#include <string.h>

static double size_of(const scree_world *world, const scree_particle *particle) {
  return world->options.size > 0 ? world->options.size : particle->measures.size;
}

double scree_thin_overlap(const scree_particle *particle) {
  /* rays grazing a notch find walls thinner than they are: never below four roundings */
  const scree_particle_measures *m = &particle->measures;
  return fmax(0.5 * m->thickness, 4 * m->rounding);
}

static void set_up(scree_world *world, scree_pair *pair) {
  const scree_bodies *bodies = &world->bodies;
  const scree_particle *a = bodies->particle[pair->a], *b = scree_pair_shape_b(world, pair);
  double size = size_of(world, a), mass = bodies->mass[pair->a], thin = scree_thin_overlap(a);
  size_t material_a = bodies->material[pair->a], material_b;
  if (pair->wall) {
    material_b = world->walls.items[pair->b].given.material;
  } else {
    material_b = bodies->material[pair->b];
    size = fmin(size, size_of(world, b));
    mass = mass * bodies->mass[pair->b] / (mass + bodies->mass[pair->b]);
    thin = fmin(thin, scree_thin_overlap(b));
  }
  const scree_material_pair *contact = &world->contacts[material_a][material_b];
  pair->stiffness = scree_pair_stiffness(world, material_a, material_b, size);
  pair->damping = world->options.law == SCREE_LAW_LINEAR
                      ? 2 * contact->damping_ratio * sqrt(mass * pair->stiffness)
                      : 0;
  pair->contact_time = 3.14159265358979323846 * sqrt(mass / pair->stiffness);
  pair->friction = contact->friction;
  pair->restitution = contact->restitution;
  pair->smoothing = world->options.smoothing * size;
  pair->limit = world->options.overlap_limit * size;
  pair->thin = fmin(pair->limit, thin);
  pair->reach =
      (a->face_count ? a->measures.rounding : 0) + (b && b->face_count ? b->measures.rounding : 0);
}

/* All memory goes, also what is read only while the pair touches or sleeps: a checkpoint holds it.
 */
static void forget(scree_pair *pair) {
  pair->active.count = pair->sleeping.count = 0;
  pair->asleep = pair->touching = false;
  pair->travel = pair->path = pair->region_radius = pair->wake = pair->asleep_since = 0;
  pair->next_item = pair->list_end = -INFINITY;
  pair->elastic = pair->tangential_elastic = pair->overlap = pair->largest = pair->age = 0;
  pair->contact_count = 0;
  pair->wrench = (scree_wrench){0};
  pair->dashpot = pair->tangential = (scree_kept_load){0};
  pair->region = pair->asleep_at = (vec3){0};
  pair->asleep_turned = (quat){0};
}

static void use_own_items(scree_pair *pair) {
  pair->active.items = pair->own_items;
  pair->active.capacity = SCREE_OWN_ITEMS;
  pair->further = pair->own_further;
}

/* As many again as there are, from 64 to 8192 (4 MB), into the spares. */
static bool make_spares(scree_world *world) {
  size_t total = 0;
  for (size_t i = 0; i < world->slabs.count; i++) total += world->slabs.items[i].count;
  size_t count = total < 64 ? 64 : total > 8192 ? 8192 : total;
  if (!SCREE_RESERVE(&world->slabs, world->slabs.count + 1) ||
      !SCREE_RESERVE(&world->spare_pairs, world->spare_pairs.count + count))
    return false;
  scree_pair *pairs = scree_alloc_zero(count, sizeof *pairs);
  if (!pairs) return false;
  for (size_t i = 0; i < count; i++) use_own_items(&pairs[i]);
  world->slabs.items[world->slabs.count++] = (scree_pair_slab){pairs, count};
  for (size_t i = count; i-- > 0;) world->spare_pairs.items[world->spare_pairs.count++] = &pairs[i];
  return true;
}

scree_pair *scree_pair_take(scree_world *world, uint32_t a, uint32_t b, bool wall) {
  if (world->spare_pairs.count == 0 && !make_spares(world)) return NULL;
  scree_pair *pair = world->spare_pairs.items[--world->spare_pairs.count];
  pair->a = a;
  pair->b = b;
  pair->wall = wall;
  forget(pair);
  set_up(world, pair);
  return pair;
}

/* A pair that finds no room among the spares stays with its slab. */
void scree_pair_give_back(scree_world *world, scree_pair *pair) {
  (void)SCREE_PUSH(&world->spare_pairs, pair);
}

bool scree_pair_reserve_items(scree_pair *pair, size_t needed) {
  if (needed <= pair->active.capacity) return true;
  size_t grown = 2 * pair->active.capacity, count = pair->active.count;
  if (grown < needed) grown = needed;
  scree_item *items = scree_alloc(grown, sizeof *items + sizeof *pair->further);
  if (!items) return false;
  scree_further *further = (scree_further *)(items + grown);
  memcpy(items, pair->active.items, count * sizeof *items);
  memcpy(further, pair->further, count * sizeof *further);
  if (pair->active.items != pair->own_items) scree_free(pair->active.items);
  pair->active.items = items;
  pair->active.capacity = grown;
  pair->further = further;
  return true;
}

bool scree_pair_copy(const scree_pair *pair, scree_pair *copy) {
  size_t active = pair->active.count, sleeping = pair->sleeping.count;
  *copy = *pair;
  use_own_items(copy);
  copy->sleeping.items = NULL;
  copy->sleeping.capacity = copy->active.count = 0; /* nothing to move yet */
  if (!scree_pair_reserve_items(copy, active) || !SCREE_RESERVE(&copy->sleeping, sleeping))
    return false;
  copy->active.count = active;
  memcpy(copy->active.items, pair->active.items, active * sizeof *copy->active.items);
  memcpy(copy->further, pair->further, active * sizeof *copy->further);
  if (sleeping)
    memcpy(copy->sleeping.items, pair->sleeping.items, sleeping * sizeof *copy->sleeping.items);
  return true;
}

void scree_pair_free_lists(scree_pair *pair) {
  if (pair->active.items != pair->own_items) scree_free(pair->active.items);
  scree_free(pair->sleeping.items);
}

void scree_pairs_free(scree_world *world) {
  for (size_t s = 0; s < world->slabs.count; s++) {
    scree_pair_slab *slab = &world->slabs.items[s];
    for (size_t i = 0; i < slab->count; i++) scree_pair_free_lists(&slab->pairs[i]);
    scree_free(slab->pairs);
  }
  scree_free(world->slabs.items);
}

void scree_body_forget(scree_world *world, size_t body) {
  world->pairs_stale = true;
  for (size_t i = 0; i < world->pairs.count; i++) {
    scree_pair *pair = world->pairs.items[i];
    if (pair->a == body || (!pair->wall && pair->b == body)) forget(pair);
  }
}
