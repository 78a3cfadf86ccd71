/* Pair objects: made by the broad phase, kept while two bounding boxes are near, recycled with
 * their arrays so that a warm world allocates nothing. */
#include "world/world.h"

#include "base/alloc.h"
#include "base/array.h"

static double size_of(const scree_world *world, const scree_particle *particle) {
  return world->options.size > 0 ? world->options.size : particle->measures.size;
}

static double thickness_limit(const scree_particle *particle) {
  /* rays grazing a notch find walls thinner than they are: never below four roundings */
  const scree_particle_measures *m = &particle->measures;
  return fmax(0.5 * m->thickness, 4 * m->rounding);
}

static void set_up(scree_world *world, scree_pair *pair) {
  const scree_bodies *bodies = &world->bodies;
  const scree_particle *a = bodies->particle[pair->a], *b = scree_pair_shape_b(world, pair);
  double size = size_of(world, a), mass = bodies->mass[pair->a], limit = thickness_limit(a);
  size_t material_a = bodies->material[pair->a], material_b;
  if (pair->wall) {
    material_b = world->walls.items[pair->b].given.material;
  } else {
    material_b = bodies->material[pair->b];
    size = fmin(size, size_of(world, b));
    mass = mass * bodies->mass[pair->b] / (mass + bodies->mass[pair->b]);
    limit = fmin(limit, thickness_limit(b));
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
  pair->limit = fmin(world->options.overlap_limit * size, limit);
  pair->reach =
      (a->face_count ? a->measures.rounding : 0) + (b && b->face_count ? b->measures.rounding : 0);
}

static void forget(scree_pair *pair) {
  pair->active.count = pair->sleeping.count = 0;
  pair->asleep = pair->touching = false;
  pair->path = 0;
  pair->next_item = pair->list_end = -INFINITY;
  pair->elastic = pair->overlap = pair->largest = pair->age = 0;
  pair->contact_count = 0;
}

scree_pair *scree_pair_take(scree_world *world, uint32_t a, uint32_t b, bool wall) {
  scree_pair *pair = world->spare_pairs.count ? world->spare_pairs.items[--world->spare_pairs.count]
                                              : scree_alloc_zero(1, sizeof *pair);
  if (!pair) return NULL;
  pair->a = a;
  pair->b = b;
  pair->wall = wall;
  forget(pair);
  set_up(world, pair);
  return pair;
}

void scree_pair_give_back(scree_world *world, scree_pair *pair) {
  if (!SCREE_PUSH(&world->spare_pairs, pair)) scree_pair_free(pair);
}

void scree_pair_free(scree_pair *pair) {
  if (!pair) return;
  scree_free(pair->active.items);
  scree_free(pair->sleeping.items);
  scree_free(pair);
}

void scree_body_forget(scree_world *world, size_t body) {
  world->pairs_stale = true;
  for (size_t i = 0; i < world->pairs.count; i++) {
    scree_pair *pair = world->pairs.items[i];
    if (pair->a == body || (!pair->wall && pair->b == body)) forget(pair);
  }
}
