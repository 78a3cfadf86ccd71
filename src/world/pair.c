/* Neighbours are made by the broad phase and kept while two bounding boxes are near; pairs while
 * they are awake. Pairs are recycled with their places for feature pairs. */
#include "world/contact.h"
#include "world/grids.h"
#include "world/materials.h"
#include "world/pairs.h"
#include "world/spheres.h"

#include "base/alloc.h"
#include "base/array.h"

double scree_thin_overlap(const scree_particle *particle) {
  /* rays grazing a notch find walls thinner than they are: never below four contact radii */
  const scree_particle_measures *m = &particle->measures;
  return scree_max(0.5 * m->thickness, 4 * particle->radius);
}

/* 1/r of a sphere; of any other body, 2/L. */
static double curvature_of(const scree_world *world, const scree_particle *particle) {
  bool sphere = particle->measures.kind == SCREE_PARTICLE_SPHERE;
  return sphere ? 1 / particle->point_radii[0] : 2 / scree_size_in(world, particle);
}

/* 1/(I + m r^2) of a sphere that rolls, about where it touches. */
static double ease_of_rolling(const scree_world *world, size_t body) {
  const scree_bodies *b = &world->bodies;
  double r = b->particle[body]->point_radii[0];
  return 1 / (b->inertia[body].x + b->mass[body] * r * r);
}

/* Rolling resistance of type C: the spring is 9/4 K (mu_r R)^2 (law.c). */
static void set_up_rolling(const scree_world *world, double rolling_friction, scree_neighbours *n) {
  const scree_particle *sides[2] = {world->bodies.particle[n->a],
                                    n->wall ? NULL : world->bodies.particle[n->b]};
  const size_t bodies[2] = {n->a, n->b};
  double curvature = 0, ease = 0;
  for (int i = 0; i < 2; i++) {
    if (!sides[i] || sides[i]->measures.kind != SCREE_PARTICLE_SPHERE) continue;
    curvature += curvature_of(world, sides[i]);
    ease += ease_of_rolling(world, bodies[i]);
  }
  bool rolls = curvature > 0 && rolling_friction > 0;
  n->law.rolling = rolls ? rolling_friction / curvature : 0;
  double stiffness = 2.25 * n->law.stiffness * n->law.rolling * n->law.rolling;
  n->law.rolling_damping = rolls ? 2 * rolling_damping_ratio * sqrt(stiffness / ease) : 0;
}

static double pull_of(const scree_world *world, const scree_material_contact *contact,
                      const scree_neighbours *n) {
  double curvature = curvature_of(world, world->bodies.particle[n->a]);
  if (!n->wall) curvature += curvature_of(world, world->bodies.particle[n->b]);
  return contact->pull_off + 1.5 * 3.14159265358979323846 * contact->surface_energy / curvature;
}

static void set_up(const scree_world *world, scree_neighbours *n) {
  const scree_bodies *bodies = &world->bodies;
  const scree_particle *a = bodies->particle[n->a], *b = scree_shape_of(world, n->b, n->wall);
  double size = scree_size_in(world, a), mass = bodies->mass[n->a], thin = scree_thin_overlap(a);
  size_t material_a = bodies->material[n->a], material_b;
  if (n->wall) {
    material_b = world->walls.items[n->b].given.material;
  } else {
    material_b = bodies->material[n->b];
    size = scree_min(size, scree_size_in(world, b));
    mass = mass * bodies->mass[n->b] / (mass + bodies->mass[n->b]);
    thin = scree_min(thin, scree_thin_overlap(b));
  }
  const scree_material_pair *contact = &world->contacts[material_a][material_b];
  const scree_contact_sides sides = {a, n->wall ? NULL : b, material_a, material_b, size, mass};
  scree_set_stiffness(world, &sides, &n->law);
  if (n->law.hertz > 0)
    n->law.damping = contact->hertz_damping * sqrt(mass * n->law.hertz);
  else if (world->options.law == SCREE_LAW_HYSTERETIC)
    n->law.damping = 0;
  else
    n->law.damping = 2 * contact->damping_ratio * sqrt(mass * n->law.stiffness);
  n->law.contact_time = 3.14159265358979323846 * sqrt(mass / n->law.stiffness);
  n->law.friction = contact->given.friction;
  n->law.restitution = contact->given.restitution;
  n->law.pull = pull_of(world, &contact->given, n);
  set_up_rolling(world, contact->given.rolling_friction, n);
  n->law.smoothing = world->options.smoothing * size;
  n->law.limit = world->options.overlap_limit * size;
  n->law.thin = scree_min(n->law.limit, thin);
  n->law.reach = 0;
  if (a->face_count) n->law.reach += n->wall ? a->radius : scree_contact_radius(a, b);
  if (b && b->face_count) n->law.reach += n->wall ? b->radius : scree_contact_radius(b, a);
}

scree_neighbours scree_neighbours_new(const scree_world *world, uint32_t a, uint32_t b, bool wall) {
  scree_neighbours n = {.a = a, .b = b, .wall = wall};
  n.spheres = scree_are_spheres(world, &n);
  n.list.next_feature = n.list.end = -INFINITY;
  set_up(world, &n);
  return n;
}

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
                       .substeps = 1};
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
  uint32_t place = 0, *pair_of = world->pair_of.items;
  scree_pair *pairs = world->pairs.items;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    uint32_t pair = pair_of[k], at = place;
    if (pair == scree_none) continue;
    place++;
    if (pair == at) continue;
    uint32_t there = pairs[at].neighbours; /* of one that came, or went long ago */
    exchange_pairs(world, &pairs[pair], &pairs[at]);
    if (there < world->neighbours.count && pair_of[there] == at) pair_of[there] = pair;
    pair_of[k] = at;
  }
  atomic_store(&world->spare_pairs.count, 0);
  for (size_t i = world->pairs.count; i-- > place;) scree_pair_give_back(world, (uint32_t)i);
}

void scree_pairs_tidy(scree_world *world) {
  size_t count = 0, astray = 0;
  uint32_t next = 0;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    uint32_t pair = world->pair_of.items[k];
    if (pair == scree_none) continue;
    astray += pair != next;
    next = pair + 1;
    count++;
  }
  if (astray > count / 8 + 1) sort_pairs(world);
}

void scree_neighbours_set_up(scree_world *world) {
  for (size_t k = 0; k < world->neighbours.count; k++) {
    scree_neighbours *n = &world->neighbours.items[k];
    scree_pair *pair = scree_pair_of(world, k);
    set_up(world, n);
    if (pair) pair->law = n->law;
  }
}

bool scree_body_has_neighbours(const scree_world *world, size_t body) {
  return world->broad && body < world->broad->old_bodies;
}

/* All memory goes, also what is read only while they sleep: a checkpoint holds it. */
void scree_body_forget(scree_world *world, size_t body) {
  world->pairs_stale = true;
  if (!scree_body_has_neighbours(world, body)) return;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    scree_neighbours *n = &world->neighbours.items[k];
    if (n->a != body && (n->wall || n->b != body)) continue;
    if (world->pair_of.items[k] != scree_none) scree_pair_give_back(world, world->pair_of.items[k]);
    world->pair_of.items[k] = scree_none;
    scree_range place = {n->sleeping.first, 0, n->sleeping.capacity};
    *n = scree_neighbours_new(world, n->a, n->b, n->wall);
    n->sleeping = place;
  }
}

bool scree_copy_pair(const scree_world *world, const scree_pair *pair, scree_pair_copy *copy) {
  const scree_pools *from = &world->pools;
  scree_pair *p = &copy->pair;
  scree_neighbours *n = &copy->neighbours;
  scree_pools_free(&copy->pools);
  copy->pools = (scree_pools){0};
  *p = *pair;
  *n = world->neighbours.items[pair->neighbours];
  p->active.count = n->sleeping.count = 0; /* nothing to move yet */
  if (!scree_pack_features(&copy->pools, p, 1, 0) || !scree_pack_sleeping(&copy->pools, n, 1))
    return false;
  p->active.count = pair->active.count;
  n->sleeping.count = world->neighbours.items[pair->neighbours].sleeping.count;
  for (uint32_t i = 0; i < p->active.count; i++) {
    copy->pools.features[i] = from->features[pair->active.first + i];
    copy->pools.further[i] = from->further[pair->active.first + i];
  }
  uint32_t first = world->neighbours.items[pair->neighbours].sleeping.first;
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
