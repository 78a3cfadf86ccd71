#include "world/observe/hits.h"
#include "world/contact/spheres.h"
#include "world/state/keys.h"

#include "base/array.h"

#include <stdlib.h>

static int compare(const void *x, const void *y) {
  const scree_pair_losses *a = x, *b = y;
  const uint64_t one = scree_key_of(a->a, a->b, a->wall), other = scree_key_of(b->a, b->b, b->wall);
  return one < other ? -1 : one > other;
}

/* Where they touch or have booked anything; false when memory is out. */
static bool add(scree_losses *losses, const scree_pair_losses *one) {
  return (!one->touching && one->normal == 0 && one->tangential == 0) || SCREE_PUSH(losses, *one);
}

static bool add_neighbours(const scree_world *world, uint32_t k, scree_losses *losses) {
  const scree_balance *balance = &world->list.ledger.items[k];
  const scree_pair *pair = scree_pair_of(world, k);
  const scree_neighbours *n = &world->list.neighbours.items[k];
  const scree_pair_losses one = {.a = n->a,
                                 .b = n->b,
                                 .at = k,
                                 .wall = n->wall,
                                 .touching =
                                     pair && pair->touching && !scree_pair_is_removed(world, pair),
                                 .normal = -balance->dashpot,
                                 .tangential = -balance->tangential};
  return add(losses, &one);
}

static bool add_spheres(const scree_world *world, uint32_t k, scree_losses *losses) {
  const scree_sphere_list *list = &world->spheres.list;
  const scree_sphere_pair *two = &list->pairs.items[k];
  if (two->contact == scree_none) return true;
  const scree_sphere_contact *c = &list->contacts.items[two->contact & ~scree_sphere_touches];
  const uint32_t a = list->body[two->a], b = list->body[two->b];
  const bool gone = world->bodies.removed[a] || world->bodies.removed[b];
  const scree_pair_losses one = {.a = a < b ? a : b,
                                 .b = a < b ? b : a,
                                 .at = k | scree_of_spheres,
                                 .touching = c->overlap > 0 && !gone,
                                 .normal = -c->dashpot,
                                 .tangential = -c->tangential};
  return add(losses, &one);
}

bool scree_find_losses(const scree_world *world, scree_losses *losses) {
  bool good = true;
  losses->count = 0;
  for (uint32_t k = 0; k < world->list.neighbours.count && good; k++)
    good = add_neighbours(world, k, losses);
  for (uint32_t k = 0; k < world->spheres.list.pairs.count && good; k++)
    good = add_spheres(world, k, losses);
  if (losses->count) qsort(losses->items, losses->count, sizeof *losses->items, compare);
  return good;
}

/* What a unit impulse along n at `arm` from the centre changes of the velocity there, along n. */
static double mobility(const scree_world *world, uint32_t body, vec3 arm, vec3 n) {
  const scree_bodies *b = &world->bodies;
  vec3 turned = mat3_tmul_vec(&b->frame[body].rotation, vec3_cross(arm, n)), i = b->inertia[body];
  return 1 / b->mass[body] + turned.x * turned.x / i.x + turned.y * turned.y / i.y +
         turned.z * turned.z / i.z;
}

static vec3 velocity_at(const scree_frame *frame, vec3 arm) {
  return vec3_add(frame->velocity, vec3_cross(frame->spin, arm));
}

bool scree_pair_normal_energy(const scree_world *world, uint32_t which, scree_pair_copy *copy,
                              double *energy) {
  scree_pair two;
  const scree_pair *pair = &two;
  if (which & scree_of_spheres)
    two = scree_sphere_pair_of(world, which & ~scree_of_spheres);
  else
    pair = scree_pair_of(world, which);
  *energy = 0;
  if (!pair) return true;
  if (!scree_copy_pair(world, pair, copy) || !scree_evaluate_copy(world, copy)) return false;
  const scree_pair *now = &copy->pair;
  const scree_contact_list *contacts = &copy->scratch.contacts;
  vec3 n = {0, 0, 0}, at = {0, 0, 0};
  double weights = 0;
  for (size_t i = 0; now->touching && i < contacts->count; i++) {
    const scree_contact_point *point = &contacts->items[i];
    n = vec3_mad(n, point->normal, point->weight);
    at = vec3_mad(at, point->at, point->weight);
    weights += point->weight;
  }
  *energy = now->contact.elastic - now->contact.tangential_elastic;
  if (!(weights > 0) || !(vec3_norm(n) > 0)) return true;
  const scree_frame *a = &world->bodies.frame[now->a], *b = scree_pair_frame_b(world, now);
  n = vec3_unit(mat3_mul_vec(&b->rotation, n));
  vec3 from_b = mat3_mul_vec(&b->rotation, vec3_scale(at, 1 / weights)),
       from_a = vec3_sub(from_b, scree_pair_between(world, now, a, b));
  double light = mobility(world, now->a, from_a, n);
  if (!now->wall) light += mobility(world, now->b, from_b, n);
  /* From the middle of the last step to now, by half of the coming kick. */
  double push = 0.5 * world->time_step * light * vec3_dot(n, now->contact.wrench.force);
  double speed = vec3_dot(n, vec3_sub(velocity_at(a, from_a), velocity_at(b, from_b))) + push;
  const scree_pair_work *work = &copy->scratch.work;
  *energy += 0.5 * speed * speed / light + work->lost - work->later_dashpot - work->dashpot;
  return true;
}
