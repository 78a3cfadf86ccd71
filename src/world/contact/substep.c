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
#include "world/contact/carry.h"
#include "world/contact/contact.h"
#include "world/contact/law.h"
#include "world/state/spin.h"

enum { ROUNDS = 4 };

/* As the world moves bodies (integrate.c). */
static void drift(scree_substep_body *m, double dt) {
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
  m->frame.spin = scree_substep_spin(m, m->momentum);
  m->frame.spin_now = vec3_add(m->frame.spin, ahead);
}

static void kick_both(scree_substep_body *a, scree_substep_body *b, const scree_pair_wrench *w,
                      double dt, double ahead) {
  scree_kick(a, vec3_scale(w->force, dt), vec3_scale(w->torque_a, dt), ahead);
  scree_kick(b, vec3_scale(w->force, -dt), vec3_scale(w->torque_b, dt), ahead);
}

/* The momentum with which the world's drift turns `from` to `to` in dt. */
static vec3 turning_momentum(const scree_substep_body *from, quat to, double dt) {
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

static void take_out(scree_pair_wrench *wrench, const scree_substep_body movers[2], double time) {
  wrench->force = vec3_mad(wrench->force, movers[0].others.force, -time);
  wrench->torque_a = vec3_mad(wrench->torque_a, movers[0].others.moment, -time);
  wrench->torque_b = vec3_mad(wrench->torque_b, movers[1].others.moment, -time);
}

/* What the others did is theirs: in the mean of the step, and by half of what the last part ends
 * later than the step's mean does. */
static void settle_debts(scree_pair *pair, const scree_substep_body begin[2],
                         const scree_substep_body end[2], double dt, double h) {
  const scree_substep_body *a = &begin[0], *b = &begin[1];
  vec3 mean = vec3_scale(vec3_sub(end[0].frame.position, a->frame.position), 1 / dt),
       turning_a = turning_momentum(a, end[0].orientation, dt), turning_b = {0, 0, 0};
  if (b->free) turning_b = turning_momentum(b, end[1].orientation, dt);
  pair->contact.wrench.force = vec3_scale(vec3_sub(mean, a->frame.velocity), a->mass / dt);
  pair->contact.wrench.torque_a = vec3_scale(vec3_sub(turning_a, a->momentum), 1 / dt);
  pair->substeps.owed.force = vec3_scale(vec3_sub(end[0].frame.velocity, mean), a->mass);
  pair->substeps.owed.torque_a = vec3_sub(end[0].momentum, turning_a);
  if (b->free) {
    pair->contact.wrench.torque_b = vec3_scale(vec3_sub(turning_b, b->momentum), 1 / dt);
    pair->substeps.owed.torque_b = vec3_sub(end[1].momentum, turning_b);
  }
  take_out(&pair->contact.wrench, begin, 1);
  take_out(&pair->substeps.owed, begin, 0.5 * (dt - h));
}

/* The impulse up to the step's beginning, less half of the step's. */
static vec3 motion_ahead(vec3 owed, vec3 force, double half, vec3 mean, double dt) {
  return vec3_mad(vec3_mad(owed, force, half), mean, -0.5 * dt);
}

void scree_pair_follow(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  const uint32_t count = scratch->substeps;
  const double dt = world->time_step, h = scratch->step;
  const shown first = {pair->contact.elastic, pair->contact.tangential_elastic,
                       pair->contact.count};
  scree_substep_body begin[2] = {scree_substep_body_of(world, pair->a, false),
                                 scree_substep_body_of(world, pair->b, pair->wall)};
  for (int k = 0; k < 2; k++) {
    const scree_wrench last = scree_wrench_of_others(world, pair, scratch, k == 1);
    begin[k].others = foresee(&last, &pair->substeps.others[k], pair->substeps.count > 1);
  }
  scree_substep_body now[2] = {begin[0], begin[1]};
  kick_both(&now[0], &now[1], &pair->substeps.owed, 1, 0);
  const scree_pair_wrench w = pair->contact.wrench,
                          owed = pair->substeps.owed; /* at the step's beginning */
  const double half = pair->touching ? 0.5 * scratch->drift : 0;
  bool acts = vec3_norm2(owed.force) > 0;
  vec3 on_wall = {0, 0, 0};
  scratch->a = &now[0].frame;
  scratch->b = &now[1].frame;
  for (uint32_t i = 1;; i++) {
    double time = pair->touching ? pair->book.kick : 0;
    acts |= pair->touching;
    on_wall = vec3_mad(on_wall, pair->contact.wrench.torque_b, time / dt);
    kick_both(&now[0], &now[1], &pair->contact.wrench, time, time > 0 ? 0.5 * h / time : 0);
    for (int k = 0; k < 2; k++) scree_kick_by_others(&now[k], i == 1 ? 0.5 * (dt + h) : h, 0.5 * h);
    drift(&now[0], h);
    drift(&now[1], h);
    if (i == count) break;
    scratch->drift = h;
    scree_pair_narrow_phase_between(world, pair, scratch);
  }
  settle_debts(pair, begin, now, dt, h);
  if (pair->wall) pair->contact.wrench.torque_b = on_wall;
  if (count == 1) pair->substeps.owed = (scree_pair_wrench){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  pair->touching = pair->substeps.followed = acts;
  pair->substeps.ahead = (scree_pair_wrench){
      motion_ahead(owed.force, w.force, half, pair->contact.wrench.force, dt),
      motion_ahead(owed.torque_a, w.torque_a, half, pair->contact.wrench.torque_a, dt),
      motion_ahead(owed.torque_b, w.torque_b, half, pair->contact.wrench.torque_b, dt)};
  pair->substeps.elastic_since = (float)(pair->contact.elastic - first.elastic);
  pair->contact.elastic = first.elastic;
  pair->contact.tangential_elastic = first.tangential_elastic;
  pair->contact.count = first.contact_count;
  pair->substeps.count = (uint8_t)count;
  pair->substeps.foreseen = scree_work_by_others(world, pair, now);
}
