/* What a pair that moved its bodies alone, in sub-steps, carries over to the next step; and the
 * forces of all else on them (substep.c). */
#include "world/contact/carry.h"
#include "world/contact/contact.h"
#include "world/state/spin.h"
#include "world/state/walls.h"

scree_substep_body scree_substep_body_of(const scree_world *world, uint32_t index, bool is_wall) {
  const scree_bodies *b = &world->bodies;
  if (is_wall)
    return (scree_substep_body){.frame = world->walls.items[index].frame,
                                .orientation = world->walls.items[index].orientation};
  return (scree_substep_body){.frame = b->frame[index],
                              .orientation = b->orientation[index],
                              .momentum = b->momentum[index],
                              .inertia = b->inertia[index],
                              .mass = b->mass[index],
                              .free = true};
}

vec3 scree_substep_spin(const scree_substep_body *m, vec3 momentum) {
  const mat3 *rotation = &m->frame.rotation;
  return mat3_mul_vec(rotation, scree_local_spin(m->inertia, rotation, momentum));
}

double scree_part_of_step(const scree_world *world, const scree_pair *pair) {
  return world->time_step / pair->substeps.count;
}

scree_wrench scree_wrench_of_others(const scree_world *world, const scree_pair *pair,
                                    const scree_scratch *scratch, bool of_b) {
  const scree_bodies *b = &world->bodies;
  const scree_pair_wrench *last = &scratch->before.wrench;
  if (of_b && pair->wall) return (scree_wrench){{0, 0, 0}, {0, 0, 0}};
  uint32_t index = of_b ? pair->b : pair->a;
  vec3 force = of_b ? vec3_neg(last->force) : last->force,
       moment = of_b ? last->torque_b : last->torque_a,
       weight = vec3_scale(vec3_load(world->options.gravity), b->mass[index]);
  return (scree_wrench){vec3_add(vec3_sub(b->force[index], force), weight),
                        vec3_sub(b->torque[index], moment)};
}

void scree_kick(scree_substep_body *m, vec3 impulse, vec3 moment, double ahead) {
  if (!m->free) return;
  vec3 change = vec3_scale(impulse, 1 / m->mass);
  m->momentum = vec3_add(m->momentum, moment);
  m->frame.velocity = vec3_add(m->frame.velocity, change);
  m->frame.velocity_now = vec3_mad(m->frame.velocity, change, ahead);
  m->frame.spin = scree_substep_spin(m, m->momentum);
  m->frame.spin_now = scree_substep_spin(m, vec3_mad(m->momentum, moment, ahead));
}

void scree_kick_by_others(scree_substep_body *m, double time, double half) {
  if (!m->free) return;
  const double now = time + half;
  vec3 acceleration = vec3_scale(m->others.force, 1 / m->mass),
       turning = scree_substep_spin(m, m->others.moment);
  m->momentum = vec3_mad(m->momentum, m->others.moment, time);
  m->frame.velocity = vec3_mad(m->frame.velocity, acceleration, time);
  m->frame.velocity_now = vec3_mad(m->frame.velocity_now, acceleration, now);
  m->frame.spin = vec3_mad(m->frame.spin, turning, time);
  m->frame.spin_now = vec3_mad(m->frame.spin_now, turning, now);
}

/* Sub-steps for a spring that is hardened at the end of the step. A hit on a corner feels a mass up
 * to seven times smaller than the reduced one. */
static uint32_t hardened_parts(const scree_world *world, const scree_pair *pair) {
  const scree_pair_law *law = &pair->law;
  const double beyond = pair->contact.overlap + pair->list.travel - hard_from * law->limit;
  if (!pair->touching || !(beyond > 0)) return 1;
  const double stiffer = 1 + hard_most_turning * scree_min(1, beyond / (hard_width * law->limit)),
               pace = 3.14159265358979323846 / law->contact_time * sqrt(7 * stiffer),
               parts = pace * world->time_step / hard_pace;
  return parts < SCREE_MOST_SUBSTEPS ? 1 + (uint32_t)parts : SCREE_MOST_SUBSTEPS;
}

/* By what touches alone, which no list of features changes. */
static uint32_t blended_parts(const scree_world *world, const scree_pair *pair,
                              const scree_frame *relative, const scree_scratch *scratch) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  const double reach = pair->law.reach;
  if (!(pair->list.travel > followed_way * reach)) return 1; /* than which none moves farther */
  if (!scree_knows_depths(a, b)) return 1;                   /* nothing is blended */
  double farthest = 0;
  for (size_t i = 0; i < scratch->contacts.count; i++) {
    const scree_contact_point *contact = &scratch->contacts.items[i];
    vec3 v = vec3_add(relative->velocity, vec3_cross(relative->spin, contact->at));
    double way = vec3_norm(v) * world->time_step;
    if (contact->overlap + way > blended_depth * reach) farthest = scree_max(farthest, way);
  }
  if (!(farthest > followed_way * reach)) return 1;
  const double parts = farthest / (longest_way * reach);
  return parts < SCREE_MOST_SUBSTEPS ? 1 + (uint32_t)parts : SCREE_MOST_SUBSTEPS;
}

uint32_t scree_substep_count(const scree_world *world, const scree_pair *pair,
                             const scree_frame *relative, const scree_scratch *scratch) {
  if (pair->depenetrating) return 1;
  if (pair->wall && scree_wall_is_belt(&world->walls.items[pair->b])) return 1;
  const uint32_t hardened = hardened_parts(world, pair),
                 blended = blended_parts(world, pair, relative, scratch);
  return hardened > blended ? hardened : blended;
}

/* Velocities at the middle of the last step's last part. Those of the bodies are at the middle of
 * the step; what the others add since then they are given with the coming step. */
scree_frame scree_owed_frame(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch, bool of_b) {
  scree_substep_body m = scree_substep_body_of(world, of_b ? pair->b : pair->a, of_b && pair->wall);
  m.others = scree_wrench_of_others(world, pair, scratch, of_b);
  scree_kick_by_others(&m, 0.5 * (world->time_step - scree_part_of_step(world, pair)), 0);
  scree_frame f = m.frame;
  const scree_pair_wrench *owed = &pair->substeps.owed;
  scree_kick(&m, of_b ? vec3_neg(owed->force) : owed->force, of_b ? owed->torque_b : owed->torque_a,
             0);
  vec3 ahead = vec3_sub(f.velocity_now, f.velocity), spin = vec3_sub(f.spin_now, f.spin);
  m.frame.velocity_now = vec3_mad(m.frame.velocity, ahead, 1.0 / pair->substeps.count);
  m.frame.spin_now = vec3_mad(m.frame.spin, spin, 1.0 / pair->substeps.count);
  return m.frame;
}

/* W/s: by how much the others make the spring's power grow. */
static double power_by_others(const scree_world *world, const scree_pair *pair,
                              const scree_substep_body m[2]) {
  vec3 arm = scree_pair_between(world, pair, &m[0].frame, &m[1].frame),
       spin = scree_substep_spin(&m[0], m[0].others.moment),
       u = vec3_sub(vec3_scale(m[0].others.force, 1 / m[0].mass), vec3_cross(spin, arm));
  if (m[1].free) {
    u = vec3_mad(u, m[1].others.force, -1 / m[1].mass);
    spin = vec3_sub(spin, scree_substep_spin(&m[1], m[1].others.moment));
  }
  return vec3_dot(pair->book.spring.force, u) + vec3_dot(pair->book.spring.moment, spin);
}

double scree_work_by_others(const scree_world *world, const scree_pair *pair,
                            const scree_substep_body m[2]) {
  const double dt = world->time_step, h = scree_part_of_step(world, pair);
  return dt * (dt - h) * power_by_others(world, pair, m);
}

double scree_unforeseen_work(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch) {
  scree_substep_body m[2] = {scree_substep_body_of(world, pair->a, false),
                             scree_substep_body_of(world, pair->b, pair->wall)};
  for (int k = 0; k < 2; k++) m[k].others = scree_wrench_of_others(world, pair, scratch, k == 1);
  return scree_work_by_others(world, pair, m) - pair->substeps.foreseen;
}
