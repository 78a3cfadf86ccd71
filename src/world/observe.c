/* Observables. Forces belong to positions x_n, velocities run half a step behind, so the state is
 * brought back to the last force evaluation: x_n = x - v dt, v_n = v - (F/m + g) dt/2. */
#include "world/integrate.h"

#include "base/file.h"
#include "base/sum.h"

typedef struct energy_sums {
  scree_sum kinetic, rotational, potential, rotation, momentum[3], angular[3];
  double speed;
} energy_sums;

static void add_body(const scree_world *world, size_t i, double dt, energy_sums *sums) {
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

/* Of a body in a pair that was followed in sub-steps: its motion has more than the step's mean. */
static void add_motion_ahead(const scree_world *world, size_t i, vec3 impulse, vec3 moment,
                             energy_sums *sums) {
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

static void add_pairs(const scree_world *world, scree_observation *o, energy_sums *sums) {
  scree_sum elastic = {0};
  size_t body_sides = 0;
  for (size_t k = 0; k < world->neighbours.count; k++) {
    const scree_pair *pair = scree_pair_of(world, k);
    if (!pair || !pair->touching || scree_pair_is_removed(world, pair)) continue;
    scree_sum_add(&elastic, pair->elastic);
    const scree_wrench *ahead = &pair->ahead;
    if (pair->followed) add_motion_ahead(world, pair->a, ahead->force, ahead->torque_a, sums);
    if (pair->followed && !pair->wall)
      add_motion_ahead(world, pair->b, vec3_neg(ahead->force), ahead->torque_b, sums);
    o->pair_count++;
    o->contact_count += pair->contact_count;
    body_sides += pair->wall ? 1 : 2;
  }
  o->elastic = scree_sum_value(elastic);
  o->coordination = o->body_count ? (double)body_sides / (double)o->body_count : 0;
}

/* Elastic energy of the tangential springs is no dissipation yet. */
static double tangential_elastic(const scree_world *world) {
  scree_sum sum = {0};
  for (size_t k = 0; k < world->neighbours.count; k++) {
    const scree_pair *pair = scree_pair_of(world, k);
    if (pair && pair->touching && !scree_pair_is_removed(world, pair))
      scree_sum_add(&sum, pair->tangential_elastic);
  }
  return scree_sum_value(sum);
}

/* Of all that are neighbours or were. */
static void add_ledger(const scree_world *world, scree_observation *o) {
  scree_sum dashpot = {0}, tangential = {0}, wall = {0}, applied = {0};
  for (size_t k = 0; k < world->neighbours.count; k++) {
    const scree_booked *booked = &world->ledger.items[k];
    scree_sum_add(&dashpot, booked->dashpot);
    scree_sum_add(&tangential, booked->tangential);
    scree_sum_add(&wall, booked->wall);
  }
  for (size_t w = 0; w < world->walls.count; w++)
    scree_sum_add(&wall, world->walls.items[w].energy);
  for (size_t i = 0; i < world->bodies.count; i++) {
    scree_sum_add(&dashpot, world->bodies.booked[i].dashpot);
    scree_sum_add(&tangential, world->bodies.booked[i].tangential);
    if (world->bodies.applied) scree_sum_add(&applied, world->bodies.applied[i].work);
  }
  o->dissipated_dashpot = -scree_sum_value(dashpot);
  o->dissipated_friction = -scree_sum_value(tangential) - tangential_elastic(world);
  o->wall_work = scree_sum_value(wall);
  o->applied_work = scree_sum_value(applied);
}

void scree_world_observe(const scree_world *world, scree_observation *observation) {
  scree_observation o = {.time = world->time, .largest_overlap = world->largest_overlap};
  double dt = world->step_count ? world->time_step : 0;
  energy_sums sums = {0};
  for (size_t i = 0; i < world->bodies.count; i++) {
    if (world->bodies.removed[i]) {
      o.removed_count++;
      continue;
    }
    o.body_count++;
    add_body(world, i, dt, &sums);
  }
  add_pairs(world, &o, &sums);
  o.kinetic = scree_sum_value(sums.kinetic);
  o.rotational = scree_sum_value(sums.rotational);
  o.potential = scree_sum_value(sums.potential);
  o.mean_rotation = o.body_count ? scree_sum_value(sums.rotation) / (double)o.body_count : 0;
  o.highest_speed = sums.speed;
  for (int k = 0; k < 3; k++) {
    o.momentum[k] = scree_sum_value(sums.momentum[k]);
    o.angular_momentum[k] = scree_sum_value(sums.angular[k]);
  }
  o.parting_count = world->parting_count;
  add_ledger(world, &o);
  *observation = o;
}

/* ---- hash ---- */

static void mix(scree_checksum *hash, const void *bytes, size_t count) {
  struct {
    scree_checksum before, now;
  } both = {*hash, scree_checksum_of(bytes, count)};
  *hash = scree_checksum_of(&both, sizeof both);
}

scree_checksum scree_world_hash(const scree_world *world) {
  scree_checksum hash = {0};
  const scree_bodies *b = &world->bodies;
  mix(&hash, &world->time, sizeof world->time);
  mix(&hash, &world->step_count, sizeof world->step_count);
  for (size_t i = 0; i < b->count; i++) {
    if (b->removed[i]) continue;
    const vec3 vectors[3] = {b->frame[i].position, b->frame[i].velocity, b->momentum[i]};
    mix(&hash, vectors, sizeof vectors);
    mix(&hash, &b->orientation[i], sizeof b->orientation[i]);
  }
  for (size_t k = 0; k < world->neighbours.count; k++) {
    const scree_pair *pair = scree_pair_of(world, k);
    for (uint32_t i = 0; pair && i < pair->active.count; i++) {
      const scree_item *item = &world->pools.items[pair->active.first + i];
      const scree_further *further = &world->pools.further[pair->active.first + i];
      const uint32_t names[5] = {pair->a, pair->b, item->kind, item->a, item->b};
      mix(&hash, names, sizeof names);
      for (int j = 0; j < (item->notched ? SCREE_ANCHORS : 1); j++) {
        const scree_anchor *anchor = j ? &further->anchor[j - 1] : &item->anchor;
        if (anchor->share <= 0) continue;
        mix(&hash, &anchor->stretch, sizeof anchor->stretch);
        mix(&hash, &anchor->share, sizeof anchor->share);
      }
    }
  }
  return hash;
}
