/* The law of a joint between two frames, for the processor and devices alike: no state but the
 * joint's, no memory.
 *
 * A total law: from where the two faces are now follow an offset d (in a frame midway between both)
 * and a chord of rotation th = 2 v, v the vector of the unit quaternion from one face to the other,
 * and an energy U(d, th). Forces and moments are its exact slope, at any turn, so that momentum and
 * energy are kept and nothing drifts:
 *
 *   qa = QA fa, qb = QB fb (negated if qa.qb < 0), (c, v) = conj(qa) qb, R = matrix(unit(qa + qb)),
 *   D = (xB + rb) - (xA + ra), d = R^T D, f = -dU/dd, g = dU/dth,
 *   m = -(g - v (v.g)/(1 + c)), t = f x d, w = v/(1 + c):
 *   on B the force R f and the torque rb x R f + R(m + (t + w x t)/2); on A the opposite force, and
 *   -ra x R f + R(-m + (t - w x t)/2).
 *
 * Whole, U = 1/2 K d^2 + 1/2 C th^2. Once it is broken the faces press on each other at four
 * points, which are as far out as gives the same stiffness in bending, and rub by Coulomb's law on
 * a spring that is anchored where it last slid. So nothing jumps where a pressed joint breaks, and
 * where it has opened all over its contact begins from nothing. The step in which it breaks has the
 * mean of both laws: it held until that moment. Compare Potyondy and Cundall (2004), whose bonds
 * add up increments, and gain or lose energy as they turn. */
#pragma once

#include "world/state/joints.h"

/* Opened by so much of the section's reach at each corner, the two touch as any others: their cores
 * are apart, so that each is seen from its side. */
#define SCREE_JOINT_OPENED 1e-4

/* Turned by so much (2 sin of half the angle) against each other, broken faces are none any more:
 * what hangs by an edge would swing round it into the other. */
#define SCREE_JOINT_TURNED 0.2

/* How the two faces of a joint stand to each other. */
typedef struct scree_joint_strain {
  vec3 ra, rb, middle; /* from the centres to the faces; between these, in space */
  vec3 d, v;           /* in the frame `turned` */
  double c;
  mat3 turned;
} scree_joint_strain;

static inline scree_joint_strain scree_joint_strain_of(const scree_world_joint *j,
                                                       const scree_joint_side *a,
                                                       const scree_joint_side *b) {
  scree_joint_strain s;
  quat qa = quat_mul(a->orientation, j->fa), qb = quat_mul(b->orientation, j->fb);
  if (qa.w * qb.w + qa.x * qb.x + qa.y * qb.y + qa.z * qb.z < 0)
    qb = (quat){-qb.w, -qb.x, -qb.y, -qb.z};
  quat between = quat_mul(quat_conjugate(qa), qb);
  s.ra = mat3_mul_vec(&a->frame->rotation, j->pa);
  s.rb = mat3_mul_vec(&b->frame->rotation, j->pb);
  vec3 apart = vec3_sub(vec3_add(b->frame->position, s.rb), vec3_add(a->frame->position, s.ra));
  s.middle = vec3_mad(vec3_add(a->frame->position, s.ra), apart, 0.5);
  s.turned = quat_to_mat3(quat_unit((quat){qa.w + qb.w, qa.x + qb.x, qa.y + qb.y, qa.z + qb.z}));
  s.d = mat3_tmul_vec(&s.turned, apart);
  s.v = (vec3){between.x, between.y, between.z};
  s.c = between.w;
  return s;
}

/* An energy and its slope: the force on b, and g above. */
typedef struct scree_joint_load {
  double energy;
  vec3 force, slope;
} scree_joint_load;

static inline vec3 scree_by_component(vec3 a, vec3 b) {
  return (vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

static inline scree_joint_load scree_joint_whole(const scree_world_joint *j,
                                                 const scree_joint_strain *s) {
  scree_joint_load l;
  vec3 th = vec3_scale(s->v, 2);
  l.force = vec3_neg(scree_by_component(j->stiffness, s->d));
  l.slope = scree_by_component(j->turning, th);
  l.energy = 0.5 * (vec3_dot(l.slope, th) - vec3_dot(l.force, s->d));
  return l;
}

/* The gap of the faces at a place of the section. */
static inline double scree_joint_gap(const scree_joint_strain *s, double y, double z) {
  return s->d.x + 2 * (s->v.y * z - s->v.z * y);
}

/* Slides the anchor where the tangential spring is beyond Coulomb's limit; the work of that. */
static inline double scree_joint_slide(scree_world_joint *j, const scree_joint_strain *s,
                                       double pressing) {
  double y = s->d.y - j->anchor[0], z = s->d.z - j->anchor[1], k = j->stiffness.y,
         force = k * sqrt(y * y + z * z), most = j->strength.friction * pressing;
  if (!(force > most)) return 0;
  double kept = most / force;
  j->anchor[0] = s->d.y - kept * y;
  j->anchor[1] = s->d.z - kept * z;
  return most * (force - most) / k;
}

/* As it was pressed: four points, and the tangential spring from its anchor. */
static inline scree_joint_load scree_joint_cracked(const scree_world_joint *j,
                                                   const scree_joint_strain *s) {
  scree_joint_load l = {0, {0, 0, 0}, {0, 0, 0}};
  double k = j->stiffness.x, y = sqrt(j->turning.z / k), z = sqrt(j->turning.y / k);
  for (int corner = 0; corner < 4; corner++) {
    double py = corner & 1 ? y : -y, pz = corner & 2 ? z : -z, gap = scree_joint_gap(s, py, pz);
    if (!(gap < 0)) continue;
    double f = -0.25 * k * gap;
    l.force.x += f;
    l.slope.y -= f * pz;
    l.slope.z += f * py;
    l.energy += -0.5 * f * gap;
  }
  double ty = s->d.y - j->anchor[0], tz = s->d.z - j->anchor[1];
  if (!(l.force.x > 0)) return l;
  l.force.y = -j->stiffness.y * ty;
  l.force.z = -j->stiffness.y * tz;
  l.energy += 0.5 * j->stiffness.y * (ty * ty + tz * tz);
  return l;
}

static inline bool scree_joint_is_open(const scree_world_joint *j, const scree_joint_strain *s) {
  double least = SCREE_JOINT_OPENED * (j->reach[0] + j->reach[1]),
         slid = scree_larger(fabs(s->d.y) - j->reach[0], fabs(s->d.z) - j->reach[1]);
  bool open = true;
  for (int corner = 0; corner < 4; corner++)
    open &= scree_joint_gap(s, corner & 1 ? j->reach[0] : -j->reach[0],
                            corner & 2 ? j->reach[1] : -j->reach[1]) > least;
  return open || slid > 0 || 4 * vec3_norm2(s->v) > SCREE_JOINT_TURNED * SCREE_JOINT_TURNED;
}

/* The moment on b by a slope, in the frame `turned`. */
static inline vec3 scree_joint_moment(const scree_joint_strain *s, vec3 slope) {
  return vec3_sub(vec3_scale(s->v, vec3_dot(s->v, slope) / (1 + s->c)), slope);
}

/* Tension by s + bending over tension, shear by Mohr and Coulomb, energy by area: the largest use
 * of strength, and by what. */
static inline double scree_joint_use(const scree_world_joint *j, const scree_joint_load *l,
                                     vec3 moment, uint8_t *mode) {
  double s = -l->force.x / j->area,
         bending = fabs(moment.y) / j->moduli.y + fabs(moment.z) / j->moduli.z,
         shear = sqrt(l->force.y * l->force.y + l->force.z * l->force.z) / j->area +
                 fabs(moment.x) / j->moduli.x,
         limit = j->strength.cohesion + j->strength.friction * scree_larger(0, -s);
  double use = 0,
         uses[3] = {j->strength.tension > 0 ? (s + bending) / j->strength.tension : 0,
                    j->strength.cohesion > 0 ? shear / limit : 0,
                    j->strength.toughness > 0 ? l->energy / (j->area * j->strength.toughness) : 0};
  for (int k = 0; k < 3; k++)
    if (uses[k] > use) use = uses[k], *mode = (uint8_t)(SCREE_JOINT_BY_TENSION + k);
  return use;
}

/* Adds what a force and a couple in the frame `turned` do, if both come of an energy. */
static inline void scree_joint_apply(const scree_joint_strain *s, vec3 f, vec3 m,
                                     scree_pair_wrench *w) {
  vec3 force = mat3_mul_vec(&s->turned, f), arm = vec3_scale(vec3_cross(f, s->d), 0.5),
       twist = vec3_cross(vec3_scale(s->v, 1 / (1 + s->c)), arm);
  vec3 on_b = vec3_add(m, vec3_add(arm, twist)), on_a = vec3_sub(vec3_sub(arm, twist), m);
  w->force = vec3_sub(w->force, force);
  w->torque_a =
      vec3_add(w->torque_a, vec3_sub(mat3_mul_vec(&s->turned, on_a), vec3_cross(s->ra, force)));
  w->torque_b =
      vec3_add(w->torque_b, vec3_add(mat3_mul_vec(&s->turned, on_b), vec3_cross(s->rb, force)));
}

/* The motion of b's face against a's, in the frame `turned`: velocity at the middle, and spin. */
static inline void scree_joint_slip(const scree_joint_strain *s, const scree_joint_side *a,
                                    const scree_joint_side *b, bool now, vec3 *velocity,
                                    vec3 *spin) {
  const scree_frame *fa = a->frame, *fb = b->frame;
  vec3 va = now ? fa->velocity_now : fa->velocity, vb = now ? fb->velocity_now : fb->velocity,
       wa = now ? fa->spin_now : fa->spin, wb = now ? fb->spin_now : fb->spin;
  va = vec3_add(va, vec3_cross(wa, vec3_sub(s->middle, fa->position)));
  vb = vec3_add(vb, vec3_cross(wb, vec3_sub(s->middle, fb->position)));
  *velocity = mat3_tmul_vec(&s->turned, vec3_sub(vb, va));
  *spin = mat3_tmul_vec(&s->turned, vec3_sub(wb, wa));
}

/* The dashpots of a whole joint, and their work by the trapezoid rule: half by the force of the
 * last step, half by this one's. */
static inline void scree_joint_damp(scree_world_joint *j, const scree_joint_strain *s,
                                    const scree_joint_side *a, const scree_joint_side *b, double dt,
                                    bool acts, scree_pair_wrench *w) {
  vec3 velocity, spin, force = {0, 0, 0}, moment = {0, 0, 0};
  scree_joint_slip(s, a, b, true, &velocity, &spin);
  if (acts) {
    force = vec3_neg(scree_by_component(j->damping, velocity));
    moment = vec3_neg(scree_by_component(j->turning_damping, spin));
  }
  scree_joint_slip(s, a, b, false, &velocity, &spin);
  j->spent.damped -= 0.5 * dt *
                     (vec3_dot(vec3_add(force, j->dashpot.force), velocity) +
                      vec3_dot(vec3_add(moment, j->dashpot.moment), spin));
  j->dashpot = (scree_wrench){force, moment};
  vec3 f = mat3_mul_vec(&s->turned, force), m = mat3_mul_vec(&s->turned, moment);
  vec3 arm_a = vec3_sub(s->middle, a->frame->position),
       arm_b = vec3_sub(s->middle, b->frame->position);
  w->force = vec3_sub(w->force, f);
  w->torque_a = vec3_sub(w->torque_a, vec3_add(m, vec3_cross(arm_a, f)));
  w->torque_b = vec3_add(w->torque_b, vec3_add(m, vec3_cross(arm_b, f)));
}

/* Whole: its load, or where it breaks the mean of that and of what it becomes. */
static inline scree_joint_load scree_joint_try(scree_world_joint *j, const scree_joint_strain *s) {
  scree_joint_load whole = scree_joint_whole(j, s);
  uint8_t mode = SCREE_JOINT_NOT_BROKEN;
  j->load = scree_joint_use(j, &whole, scree_joint_moment(s, whole.slope), &mode);
  if (!(j->load > 1)) return whole;
  j->load = 1;
  j->mode = mode;
  j->state = SCREE_JOINT_CRACKED;
  /* what was sheared goes on as far as friction holds it */
  j->anchor[0] = j->anchor[1] = 0;
  scree_joint_load cracked = scree_joint_cracked(j, s);
  (void)scree_joint_slide(j, s, cracked.force.x);
  cracked = scree_joint_cracked(j, s);
  j->spent.fracture = whole.energy - cracked.energy;
  return (scree_joint_load){cracked.energy, vec3_scale(vec3_add(whole.force, cracked.force), 0.5),
                            vec3_scale(vec3_add(whole.slope, cracked.slope), 0.5)};
}

/* The step of one joint. True where its state changed. */
static inline bool scree_joint_evaluate(scree_world_joint *j, const scree_joint_side *a,
                                        const scree_joint_side *b, double dt, double time) {
  const uint8_t before = j->state;
  j->wrench = (scree_pair_wrench){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  scree_joint_strain s = scree_joint_strain_of(j, a, b);
  scree_joint_load l;
  if (before == SCREE_JOINT_WHOLE) {
    l = scree_joint_try(j, &s);
  } else {
    j->spent.rubbed += scree_joint_slide(j, &s, scree_joint_cracked(j, &s).force.x);
    l = scree_joint_cracked(j, &s);
  }
  if (before == SCREE_JOINT_WHOLE) {
    scree_joint_damp(j, &s, a, b, dt, j->state == SCREE_JOINT_WHOLE, &j->wrench);
    if (j->state != before) j->broke_at = time;
  }
  j->energy = l.energy;
  j->force = l.force;
  j->moment = scree_joint_moment(&s, l.slope);
  scree_joint_apply(&s, l.force, j->moment, &j->wrench);
  if (j->state == SCREE_JOINT_CRACKED && scree_joint_is_open(j, &s)) {
    j->spent.fracture += j->energy; /* of one that slid off its face */
    j->energy = 0;
    j->state = SCREE_JOINT_OPEN;
  }
  return j->state != before;
}
