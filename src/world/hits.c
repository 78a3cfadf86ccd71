#include "world/hits.h"

bool scree_next_losses(const scree_world *world, size_t *k, scree_pair_losses *losses) {
  for (; *k < world->neighbours.count; (*k)++) {
    const scree_balance *balance = &world->ledger.items[*k];
    const scree_pair *pair = scree_pair_of(world, *k);
    bool touching = pair && pair->touching && !scree_pair_is_removed(world, pair);
    if (!touching && balance->dashpot == 0 && balance->tangential == 0) continue;
    const scree_neighbours *n = &world->neighbours.items[*k];
    *losses = (scree_pair_losses){.a = n->a,
                                  .b = n->b,
                                  .wall = n->wall,
                                  .touching = touching,
                                  .normal = -balance->dashpot,
                                  .tangential = -balance->tangential};
    (*k)++;
    return true;
  }
  return false;
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

bool scree_pair_normal_energy(const scree_world *world, size_t neighbours, scree_pair_copy *copy,
                              double *energy) {
  const scree_pair *pair = scree_pair_of(world, neighbours);
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
  *energy = now->elastic - now->tangential_elastic;
  if (!(weights > 0) || !(vec3_norm(n) > 0)) return true;
  const scree_frame *a = &world->bodies.frame[now->a], *b = scree_pair_frame_b(world, now);
  n = vec3_unit(mat3_mul_vec(&b->rotation, n));
  vec3 from_b = mat3_mul_vec(&b->rotation, vec3_scale(at, 1 / weights)),
       from_a = vec3_sub(from_b, scree_pair_between(world, now, a, b));
  double light = mobility(world, now->a, from_a, n);
  if (!now->wall) light += mobility(world, now->b, from_b, n);
  /* From the middle of the last step to now, by half of the coming kick. */
  double push = 0.5 * world->time_step * light * vec3_dot(n, now->wrench.force);
  double speed = vec3_dot(n, vec3_sub(velocity_at(a, from_a), velocity_at(b, from_b))) + push;
  const scree_pair_work *work = &copy->scratch.work;
  *energy += 0.5 * speed * speed / light + work->lost - work->later_dashpot - work->dashpot;
  return true;
}
