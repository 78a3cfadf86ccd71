/* Sub-steps: a pair that is deep and fast is followed alone, in shorter steps, while all else
 * waits.
 *
 * Where the way of a step is not small beside the contact radii, blends between features are
 * crossed in one step, and no force that is a slope of the energy could be told from samples so far
 * apart. The two bodies are moved on copies, by leapfrog with steps dt/n, under the forces of their
 * pair, and under all others as they will be if they change by as much as in the last step. What
 * the world's step is given is the mean wrench that brings its own leapfrog to where the copies
 * have come, less that of the others; what their velocities have more by then is owed to the
 * bodies, and the pair begins its next step with it. So no other part of the step knows of
 * sub-steps. By what the others do otherwise the bodies come elsewhere than the copies: the balance
 * of the pair's spring is drawn with the work on that way.
 *
 * Leapfrog with steps that differ kicks with the mean of the steps before and after. */
#include "world/contact.h"
#include "world/integrate.h"
#include "world/law.h"
#include "world/walls.h"

enum { ROUNDS = 4 };

/* A body, or a wall, of which `free` is false. */
typedef struct mover {
  scree_frame frame;
  quat orientation;
  vec3 momentum, inertia;
  scree_wrench others; /* force and moment of all but the pair */
  double mass;
  bool free;
} mover;

static mover mover_of(const scree_world *world, uint32_t index, bool is_wall) {
  const scree_bodies *b = &world->bodies;
  if (is_wall)
    return (mover){.frame = world->walls.items[index].frame,
                   .orientation = world->walls.items[index].orientation};
  return (mover){.frame = b->frame[index],
                 .orientation = b->orientation[index],
                 .momentum = b->momentum[index],
                 .inertia = b->inertia[index],
                 .mass = b->mass[index],
                 .free = true};
}

static vec3 spin_of(const mover *m, vec3 momentum) {
  const mat3 *rotation = &m->frame.rotation;
  return mat3_mul_vec(rotation, scree_local_spin(m->inertia, rotation, momentum));
}

/* Of each of its parts, in the last step. */
static double part_of_step(const scree_world *world, const scree_pair *pair) {
  return world->time_step / pair->substeps;
}

scree_wrench scree_wrench_of_others(const scree_world *world, const scree_pair *pair,
                                    const scree_scratch *scratch, bool of_b) {
  const scree_bodies *b = &world->bodies;
  const scree_pair_wrench *last = &scratch->last;
  if (of_b && pair->wall) return (scree_wrench){{0, 0, 0}, {0, 0, 0}};
  uint32_t index = of_b ? pair->b : pair->a;
  vec3 force = of_b ? vec3_neg(last->force) : last->force,
       moment = of_b ? last->torque_b : last->torque_a,
       weight = vec3_scale(vec3_load(world->options.gravity), b->mass[index]);
  return (scree_wrench){vec3_add(vec3_sub(b->force[index], force), weight),
                        vec3_sub(b->torque[index], moment)};
}

/* An impulse and its moment; `ahead`: what of it the velocities half a step on have more. */
static void kick(mover *m, vec3 impulse, vec3 moment, double ahead) {
  if (!m->free) return;
  vec3 change = vec3_scale(impulse, 1 / m->mass);
  m->momentum = vec3_add(m->momentum, moment);
  m->frame.velocity = vec3_add(m->frame.velocity, change);
  m->frame.velocity_now = vec3_mad(m->frame.velocity, change, ahead);
  m->frame.spin = spin_of(m, m->momentum);
  m->frame.spin_now = spin_of(m, vec3_mad(m->momentum, moment, ahead));
}

/* As the world moves bodies (integrate.c). */
static void drift(mover *m, double dt) {
  m->frame.position = vec3_mad(m->frame.position, m->frame.velocity, dt);
  vec3 turn = mat3_tmul_vec(&m->frame.rotation, m->frame.spin);
  if (m->free)
    m->orientation = scree_turned(&m->orientation, turn, m->inertia, m->momentum, dt);
  else
    m->orientation =
        quat_unit(quat_mul(m->orientation, quat_from_rotation_vector(vec3_scale(turn, dt))));
  m->frame.rotation = quat_to_mat3(m->orientation);
  if (!m->free) return;
  vec3 ahead = vec3_sub(m->frame.spin_now, m->frame.spin);
  m->frame.spin = spin_of(m, m->momentum);
  m->frame.spin_now = vec3_add(m->frame.spin, ahead);
}

static void kick_by_others(mover *m, double time, double half) {
  if (!m->free) return;
  const double now = time + half;
  vec3 acceleration = vec3_scale(m->others.force, 1 / m->mass),
       turning = spin_of(m, m->others.moment);
  m->momentum = vec3_mad(m->momentum, m->others.moment, time);
  m->frame.velocity = vec3_mad(m->frame.velocity, acceleration, time);
  m->frame.velocity_now = vec3_mad(m->frame.velocity_now, acceleration, now);
  m->frame.spin = vec3_mad(m->frame.spin, turning, time);
  m->frame.spin_now = vec3_mad(m->frame.spin_now, turning, now);
}

static void kick_both(mover *a, mover *b, const scree_pair_wrench *w, double dt, double ahead) {
  kick(a, vec3_scale(w->force, dt), vec3_scale(w->torque_a, dt), ahead);
  kick(b, vec3_scale(w->force, -dt), vec3_scale(w->torque_b, dt), ahead);
}

/* The momentum with which the world's drift turns `from` to `to` in dt. */
static vec3 turning_momentum(const mover *from, quat to, double dt) {
  quat turn = quat_mul(quat_conjugate(from->orientation), to);
  vec3 axis = {turn.x, turn.y, turn.z};
  double sine = vec3_norm(axis), angle = 2 * scree_atan2(turn.w < 0 ? -sine : sine, fabs(turn.w));
  vec3 spin = vec3_scale(axis, sine > 1e-12 ? angle / (sine * dt) : 2 / dt),
       local = {spin.x * from->inertia.x, spin.y * from->inertia.y, spin.z * from->inertia.z},
       momentum = mat3_mul_vec(&from->frame.rotation, local);
  for (int round = 0; round < ROUNDS; round++) {
    vec3 first = scree_local_spin(from->inertia, &from->frame.rotation, momentum);
    mat3 half = quat_to_mat3(scree_half_turned(&from->orientation, first, dt));
    momentum = mat3_mul_vec(&half, local);
  }
  return momentum;
}

/* By what touches alone, which no list of features changes. */
uint32_t scree_substep_count(const scree_world *world, const scree_pair *pair,
                             const scree_frame *relative, const scree_scratch *scratch) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  const double reach = pair->law.reach;
  if (!(pair->list.travel > followed_way * reach)) return 1; /* than which none moves farther */
  if (!scree_knows_depths(a, b) || pair->depenetrating) return 1; /* nothing is blended */
  if (pair->wall && scree_wall_is_belt(&world->walls.items[pair->b])) return 1;
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

/* Velocities at the middle of the last step's last part. Those of the bodies are at the middle of
 * the step; what the others add since then they are given with the coming step. */
scree_frame scree_owed_frame(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch, bool of_b) {
  mover m = mover_of(world, of_b ? pair->b : pair->a, of_b && pair->wall);
  m.others = scree_wrench_of_others(world, pair, scratch, of_b);
  kick_by_others(&m, 0.5 * (world->time_step - part_of_step(world, pair)), 0);
  scree_frame f = m.frame;
  const scree_pair_wrench *owed = &pair->owed;
  kick(&m, of_b ? vec3_neg(owed->force) : owed->force, of_b ? owed->torque_b : owed->torque_a, 0);
  vec3 ahead = vec3_sub(f.velocity_now, f.velocity), spin = vec3_sub(f.spin_now, f.spin);
  m.frame.velocity_now = vec3_mad(m.frame.velocity, ahead, 1.0 / pair->substeps);
  m.frame.spin_now = vec3_mad(m.frame.spin, spin, 1.0 / pair->substeps);
  return m.frame;
}

/* W/s: by how much the others make the spring's power grow. */
static double power_by_others(const scree_world *world, const scree_pair *pair, const mover m[2]) {
  vec3 arm = scree_pair_between(world, pair, &m[0].frame, &m[1].frame),
       spin = spin_of(&m[0], m[0].others.moment),
       u = vec3_sub(vec3_scale(m[0].others.force, 1 / m[0].mass), vec3_cross(spin, arm));
  if (m[1].free) {
    u = vec3_mad(u, m[1].others.force, -1 / m[1].mass);
    spin = vec3_sub(spin, spin_of(&m[1], m[1].others.moment));
  }
  return vec3_dot(pair->spring.force, u) + vec3_dot(pair->spring.moment, spin);
}

/* J, of the spring on the way of a step by what the others do; the last part's way has been counted
 * with its velocity. */
static double work_by_others(const scree_world *world, const scree_pair *pair, const mover m[2]) {
  const double dt = world->time_step, h = part_of_step(world, pair);
  return dt * (dt - h) * power_by_others(world, pair, m);
}

double scree_unforeseen_work(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch) {
  mover m[2] = {mover_of(world, pair->a, false), mover_of(world, pair->b, pair->wall)};
  for (int k = 0; k < 2; k++) m[k].others = scree_wrench_of_others(world, pair, scratch, k == 1);
  return work_by_others(world, pair, m) - pair->foreseen;
}

/* If they go on to change as they did since the step before, where that is known. */
static scree_wrench foresee(const scree_wrench *last, scree_kept_wrench *kept, bool known) {
  const scree_wrench before = known ? scree_kept_as_wrench(kept) : *last;
  *kept = scree_kept(last);
  return (scree_wrench){vec3_sub(vec3_scale(last->force, 2), before.force),
                        vec3_sub(vec3_scale(last->moment, 2), before.moment)};
}

/* What the pair shows while it is looked at: that of the moment at which the step began. */
typedef struct shown {
  double elastic, tangential_elastic;
  uint32_t contact_count;
} shown;

static void take_out(scree_pair_wrench *wrench, const mover movers[2], double time) {
  wrench->force = vec3_mad(wrench->force, movers[0].others.force, -time);
  wrench->torque_a = vec3_mad(wrench->torque_a, movers[0].others.moment, -time);
  wrench->torque_b = vec3_mad(wrench->torque_b, movers[1].others.moment, -time);
}

/* What the others did is theirs: in the mean of the step, and by half of what the last part ends
 * later than the step's mean does. */
static void settle_debts(scree_pair *pair, const mover begin[2], const mover end[2], double dt,
                         double h) {
  const mover *a = &begin[0], *b = &begin[1];
  vec3 mean = vec3_scale(vec3_sub(end[0].frame.position, a->frame.position), 1 / dt),
       turning_a = turning_momentum(a, end[0].orientation, dt), turning_b = {0, 0, 0};
  if (b->free) turning_b = turning_momentum(b, end[1].orientation, dt);
  pair->wrench.force = vec3_scale(vec3_sub(mean, a->frame.velocity), a->mass / dt);
  pair->wrench.torque_a = vec3_scale(vec3_sub(turning_a, a->momentum), 1 / dt);
  pair->owed.force = vec3_scale(vec3_sub(end[0].frame.velocity, mean), a->mass);
  pair->owed.torque_a = vec3_sub(end[0].momentum, turning_a);
  if (b->free) {
    pair->wrench.torque_b = vec3_scale(vec3_sub(turning_b, b->momentum), 1 / dt);
    pair->owed.torque_b = vec3_sub(end[1].momentum, turning_b);
  }
  take_out(&pair->wrench, begin, 1);
  take_out(&pair->owed, begin, 0.5 * (dt - h));
}

/* The impulse up to the step's beginning, less half of the step's. */
static vec3 motion_ahead(vec3 owed, vec3 force, double half, vec3 mean, double dt) {
  return vec3_mad(vec3_mad(owed, force, half), mean, -0.5 * dt);
}

void scree_pair_follow(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  const uint32_t count = scratch->substeps;
  const double dt = world->time_step, h = scratch->step;
  const shown first = {pair->elastic, pair->tangential_elastic, pair->contact_count};
  mover begin[2] = {mover_of(world, pair->a, false), mover_of(world, pair->b, pair->wall)};
  for (int k = 0; k < 2; k++) {
    const scree_wrench last = scree_wrench_of_others(world, pair, scratch, k == 1);
    begin[k].others = foresee(&last, &pair->others[k], pair->substeps > 1);
  }
  mover now[2] = {begin[0], begin[1]};
  kick_both(&now[0], &now[1], &pair->owed, 1, 0);
  const scree_pair_wrench w = pair->wrench, owed = pair->owed; /* at the step's beginning */
  const double half = pair->touching ? 0.5 * scratch->drift : 0;
  bool acts = vec3_norm2(owed.force) > 0;
  vec3 on_wall = {0, 0, 0};
  scratch->a = &now[0].frame;
  scratch->b = &now[1].frame;
  for (uint32_t i = 1;; i++) {
    double time = pair->touching ? pair->kick : 0;
    acts |= pair->touching;
    on_wall = vec3_mad(on_wall, pair->wrench.torque_b, time / dt);
    kick_both(&now[0], &now[1], &pair->wrench, time, time > 0 ? 0.5 * h / time : 0);
    for (int k = 0; k < 2; k++) kick_by_others(&now[k], i == 1 ? 0.5 * (dt + h) : h, 0.5 * h);
    drift(&now[0], h);
    drift(&now[1], h);
    if (i == count) break;
    scratch->drift = h;
    scree_pair_narrow_phase_between(world, pair, scratch);
  }
  settle_debts(pair, begin, now, dt, h);
  if (pair->wall) pair->wrench.torque_b = on_wall;
  if (count == 1) pair->owed = (scree_pair_wrench){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  pair->touching = pair->followed = acts;
  pair->ahead =
      (scree_pair_wrench){motion_ahead(owed.force, w.force, half, pair->wrench.force, dt),
                          motion_ahead(owed.torque_a, w.torque_a, half, pair->wrench.torque_a, dt),
                          motion_ahead(owed.torque_b, w.torque_b, half, pair->wrench.torque_b, dt)};
  pair->elastic_since = (float)(pair->elastic - first.elastic);
  pair->elastic = first.elastic;
  pair->tangential_elastic = first.tangential_elastic;
  pair->contact_count = first.contact_count;
  pair->substeps = (uint8_t)count;
  pair->foreseen = work_by_others(world, pair, now);
}
