/* Sums over bodies and pairs. Forces belong to positions x_n, velocities run half a step behind, so
 * the state is brought back to the last force evaluation: x_n = x - v dt, v_n = v - (F/m + g) dt/2.
 */
#include "world/observe/sums.h"
#include "world/contact/contact.h"
#include "world/contact/spheres.h"
#include "world/state/spin.h"

static void add_body(const scree_world *world, size_t i, double dt, scree_sums *sums) {
  const scree_bodies *b = &world->bodies;
  const scree_frame *frame = &b->frame[i];
  vec3 g = vec3_load(world->options.gravity);
  vec3 acceleration = vec3_mad(g, b->force[i], 1 / b->mass[i]);
  vec3 v = vec3_mad(frame->velocity, acceleration, -0.5 * dt);
  vec3 x = vec3_mad(frame->position, frame->velocity, -dt);
  vec3 l = vec3_mad(b->momentum[i], b->torque[i], -0.5 * dt);
  vec3 spin = scree_spin_of(b, i, &frame->rotation, l);
  double m = b->mass[i];
  scree_sum_add(&sums->kinetic, 0.5 * m * vec3_norm2(v));
  scree_sum_add(&sums->rotational, 0.5 * vec3_dot(l, spin));
  scree_sum_add(&sums->potential, -m * vec3_dot(g, x));
  scree_sum_add(&sums->rotation, vec3_norm(spin));
  vec3 p = vec3_scale(v, m), about_origin = vec3_add(l, vec3_cross(x, p));
  const double ps[3] = {p.x, p.y, p.z}, ls[3] = {about_origin.x, about_origin.y, about_origin.z};
  for (int k = 0; k < 3; k++) {
    scree_sum_add(&sums->momentum[k], ps[k]);
    scree_sum_add(&sums->angular[k], ls[k]);
  }
  sums->speed = scree_max(sums->speed, vec3_norm(v));
}

/* Adds what the motion of a body has more than the step's mean where a pair of it was sub-stepped.
 */
static void add_motion_ahead(const scree_world *world, size_t i, vec3 impulse, vec3 moment,
                             scree_sums *sums) {
  const scree_bodies *b = &world->bodies;
  double dt = world->time_step, m = b->mass[i];
  vec3 g = vec3_load(world->options.gravity);
  vec3 v = vec3_mad(b->frame[i].velocity, vec3_mad(g, b->force[i], 1 / m), -0.5 * dt),
       l = vec3_mad(b->momentum[i], b->torque[i], -0.5 * dt);
  const mat3 *rotation = &b->frame[i].rotation;
  vec3 spin = scree_spin_of(b, i, rotation, l), change = scree_spin_of(b, i, rotation, moment);
  scree_sum_add(&sums->kinetic, vec3_dot(v, impulse) + 0.5 * vec3_norm2(impulse) / m);
  scree_sum_add(&sums->rotational, vec3_dot(spin, moment) + 0.5 * vec3_dot(change, moment));
}

/* Elastic energy of the tangential springs is no dissipation yet. */
static void add_pair(const scree_world *world, const scree_pair *pair, scree_sums *sums) {
  scree_sum_add(&sums->elastic, pair->contact.elastic);
  scree_sum_add(&sums->tangential_elastic, pair->contact.tangential_elastic);
  const scree_pair_wrench *ahead = &pair->substeps.ahead;
  if (pair->substeps.followed)
    add_motion_ahead(world, pair->a, ahead->force, ahead->torque_a, sums);
  if (pair->substeps.followed && !pair->wall)
    add_motion_ahead(world, pair->b, vec3_neg(ahead->force), ahead->torque_b, sums);
  sums->pairs++;
  sums->depenetrating += scree_is_pushed(pair); /* not what is only suspected */
  sums->contacts += pair->contact.count;
  sums->body_sides += pair->wall ? 1 : 2;
}

/* The ledger is of all that are neighbours or were. */
static void sum_body(const scree_world *world, size_t i, scree_sums *sums) {
  const scree_bodies *b = &world->bodies;
  scree_sum_add(&sums->dashpot, b->balance[i].dashpot);
  scree_sum_add(&sums->tangential, b->balance[i].tangential);
  if (b->applied) scree_sum_add(&sums->applied, b->applied[i].work);
  if (b->removed[i]) {
    sums->removed++;
    return;
  }
  sums->bodies++;
  add_body(world, i, world->step_count ? world->time_step : 0, sums);
}

static void sum_neighbours(const scree_world *world, size_t k, scree_sums *sums) {
  const scree_balance *balance = &world->list.ledger.items[k];
  scree_sum_add(&sums->dashpot, balance->dashpot);
  scree_sum_add(&sums->tangential, balance->tangential);
  scree_sum_add(&sums->wall, balance->wall);
  const scree_pair *pair = scree_pair_of(world, k);
  if (pair && pair->touching && !scree_pair_is_removed(world, pair)) add_pair(world, pair, sums);
}

static void sum_spheres(const scree_world *world, size_t k, scree_sums *sums) {
  const scree_sphere_list *list = &world->spheres.list;
  const uint32_t contact = list->pairs.items[k].contact;
  if (contact == scree_none) return;
  const scree_sphere_contact *c = &list->contacts.items[contact & ~scree_sphere_touches];
  scree_sum_add(&sums->dashpot, c->dashpot);
  scree_sum_add(&sums->tangential, c->tangential);
  const scree_pair pair = scree_sphere_pair_of(world, k);
  if (pair.touching && !scree_pair_is_removed(world, &pair)) add_pair(world, &pair, sums);
}

static size_t blocks_of(size_t count) {
  return (count + SCREE_SUM_BLOCK - 1) / SCREE_SUM_BLOCK;
}

size_t scree_sum_part_count(const scree_world *world) {
  return blocks_of(world->bodies.count) + blocks_of(world->list.neighbours.count) +
         blocks_of(world->spheres.list.pairs.count) + 1;
}

scree_sums scree_sum_part(const scree_world *world, size_t part) {
  const struct {
    size_t count;
    void (*add)(const scree_world *world, size_t i, scree_sums *sums);
  } kinds[] = {{world->bodies.count, sum_body},
               {world->list.neighbours.count, sum_neighbours},
               {world->spheres.list.pairs.count, sum_spheres}};
  scree_sums sums = {0};
  for (size_t kind = 0; kind < 3; kind++) {
    const size_t blocks = blocks_of(kinds[kind].count);
    if (part >= blocks) {
      part -= blocks;
      continue;
    }
    for (size_t i = part * SCREE_SUM_BLOCK;
         i < (part + 1) * SCREE_SUM_BLOCK && i < kinds[kind].count; i++)
      kinds[kind].add(world, i, &sums);
    return sums;
  }
  for (size_t w = 0; w < world->walls.count; w++)
    scree_sum_add(&sums.wall, world->walls.items[w].energy);
  return sums;
}

void scree_sums_merge(scree_sums *sums, const scree_sums *part) {
  scree_sum_merge(&sums->kinetic, part->kinetic);
  scree_sum_merge(&sums->rotational, part->rotational);
  scree_sum_merge(&sums->potential, part->potential);
  scree_sum_merge(&sums->rotation, part->rotation);
  for (int k = 0; k < 3; k++) {
    scree_sum_merge(&sums->momentum[k], part->momentum[k]);
    scree_sum_merge(&sums->angular[k], part->angular[k]);
  }
  scree_sum_merge(&sums->elastic, part->elastic);
  scree_sum_merge(&sums->tangential_elastic, part->tangential_elastic);
  scree_sum_merge(&sums->dashpot, part->dashpot);
  scree_sum_merge(&sums->tangential, part->tangential);
  scree_sum_merge(&sums->wall, part->wall);
  scree_sum_merge(&sums->applied, part->applied);
  sums->speed = scree_max(sums->speed, part->speed);
  sums->bodies += part->bodies;
  sums->removed += part->removed;
  sums->pairs += part->pairs;
  sums->depenetrating += part->depenetrating;
  sums->contacts += part->contacts;
  sums->body_sides += part->body_sides;
}
