/* What the laws of spheres (spheres.c) and of all other pairs (law.c) share: the pair's spring over
 * an impact, the slider, rolling resistance. docs/background/physics.md has the equations. */
#pragma once

#include "world/contact.h"

/* Of the pair's spring, at an overlap of 0 or more. */
typedef struct scree_spring_state {
  double force, energy;
} scree_spring_state;

static inline scree_spring_state scree_spring_at(const scree_pair *pair, double m) {
  double k = pair->law.stiffness, hertz = pair->law.hertz;
  if (hertz == 0) return (scree_spring_state){k * m, 0.5 * k * m * m};
  double force = hertz * m * sqrt(m);
  return (scree_spring_state){force, 0.4 * force * m};
}

/* What leapfrog keeps of the spring's energy in the midst of a drift from one overlap to another:
 * K x y/2 of a linear one. */
static inline double scree_energy_between(const scree_pair *pair, double x, double y) {
  scree_spring_state at_x = scree_spring_at(pair, x), at_y = scree_spring_at(pair, y);
  return 0.5 * (at_x.energy + at_y.energy) - 0.25 * (at_x.force - at_y.force) * (x - y);
}

/* Of both bodies. */
static inline double scree_reduced_mass(const scree_pair_law *law) {
  const double pace = law->contact_time / 3.14159265358979323846;
  return law->stiffness * pace * pace;
}

/* How far the contact is no impact any more, from 0 to 1: the tangential dashpot. An oblique impact
 * follows the spring and slider alone; what rests on each other is calmed. */
static inline double scree_lasting(const scree_pair *pair) {
  double age = pair->age / pair->law.contact_time;
  return age < 1.5 ? 0 : age > 3 ? 1 : (age - 1.5) / 1.5;
}

/* With u the velocity of the last drift and a dt what the last forces added to it, dashpots of an
 * impact see u + a dt/2, that of their own moment, and those that last u - a dt/4. A motion that
 * turns about from step to step grows where c dt/m > 1 by the former, > 2 by u alone, and > 4 by
 * the latter, which no other factor exceeds. A slender body that many others hold has so much: with
 * u + a dt/2 it never came to rest, and what trembles creeps. The lead is that of u to u + a dt/2.
 */
static inline double scree_dashpot_lead(double lasts) {
  const double impact = 1, lasting = -0.5;
  return impact + (lasting - impact) * lasts;
}

/* ---- the spring over a step ---- */

/* How the overlap moves: now and at the last look; its rate by the velocities of the last drift and
 * by those of the present moment; s of the last drift and of the coming step. */
typedef struct scree_overlap_motion {
  double overlap, before, rate, rate_now, drift, step;
  double inverse;     /* 1/kg, of both bodies along it; where scree_is_edge_of_touch asks for it */
  double spring_work; /* J, of the spring since the last look */
  double lasts;       /* scree_lasting */
  bool first;         /* in this contact */
} scree_overlap_motion;

/* From the last look to this one, by the rates. */
static inline scree_overlap_motion scree_overlap_moves(const scree_pair *pair,
                                                       const scree_scratch *scratch, double rate,
                                                       double rate_now) {
  return (scree_overlap_motion){.overlap = pair->overlap,
                                .before = scratch->overlap_before,
                                .rate = rate,
                                .rate_now = rate_now,
                                .drift = scratch->drift,
                                .step = scratch->step,
                                .spring_work = scratch->spring_work,
                                .lasts = scree_lasting(pair),
                                .first =
                                    scratch->overlap_before == 0 || scratch->was_depenetrating};
}

/* In a contact that lasts, deep beside its way in a step, the balance is not drawn. */
static inline bool scree_is_settled(const scree_pair *pair, double lasts) {
  return lasts == 1 && pair->overlap >= steep_overlap * pair->list.travel;
}

/* The way on the other side of the touch's begin or end. */
static inline double scree_outer_way(const scree_overlap_motion *m) {
  return m->rate_now > 0 ? fabs(m->rate) * m->drift : fabs(m->rate_now) * m->step;
}

/* Whether a touch begins or ends within this step. */
static inline bool scree_is_edge_of_touch(const scree_pair *pair, const scree_overlap_motion *m) {
  return m->overlap < steep_overlap * pair->list.travel && scree_outer_way(m) > m->overlap &&
         m->rate != 0;
}

/* What acts in a kick: the spring's force, and this share of what holds the bodies. */
typedef struct scree_felt {
  double force, pull;
} scree_felt;

/* In the step in which a touch begins or ends the overlap x is less than the way on the other side.
 * The whole force, acting for the whole kick, would work on that way too. Leapfrog keeps m v2/2 + U
 * from one drift to the next, with U = K x x'/2 - P (x + x')/2 of a linear spring; and so it does
 * from before the touch, or to after it, where the kick's work is this U, with x' the overlap a
 * step further inside. The kick changes the velocity by less than itself, so that one more round
 * finds it. */
static inline scree_felt scree_felt_at_edge(const scree_pair *pair, const scree_overlap_motion *m) {
  const double x = m->overlap, kick = 0.5 * (m->drift + m->step), speed = fabs(m->rate);
  const bool begins = m->rate_now > 0;
  scree_felt f = {scree_spring_at(pair, x).force, 1};
  for (int round = 0; round < 2; round++) {
    double change = round == 0 ? 0 : (f.force - pair->law.pull * f.pull) * kick * m->inverse,
           middle = begins ? speed - 0.5 * change : speed + 0.5 * change,
           inner = scree_max(0, begins ? (speed - change) * m->step : speed * m->drift),
           way = scree_max(middle, 0.5 * speed) * kick;
    f = (scree_felt){scree_energy_between(pair, x, x + inner) / way, (x + 0.5 * inner) / way};
  }
  return f;
}

/* The spring's force at overlap m, which a linear one feels as `felt` says, less that with which
 * the bodies hold each other, and the energy that comes back from both. Hysteretic: what it loses
 * as a touch begins it wins in the mean as it ends. */
static inline double scree_spring_force(bool hysteretic, scree_pair *pair, double m,
                                        scree_felt felt) {
  double pull = pair->law.pull, stiffness = pair->law.stiffness;
  if (!hysteretic) {
    pair->elastic = scree_spring_at(pair, m).energy - pull * m;
    return felt.force - pull * felt.pull;
  }
  double e2 = pair->law.restitution * pair->law.restitution, unloading = stiffness / e2;
  pair->largest = scree_max(pair->largest, m);
  double force = scree_max(0, scree_min(stiffness * m, unloading * (m - (1 - e2) * pair->largest)));
  pair->elastic = 0.5 * force * force / unloading - pull * m;
  return force - pull;
}

/* By how much the spring's force is changed so that what it has won or lost in this impact by no
 * work comes back with the kick; by no larger share than that is of its energy. Not where a touch
 * begins or ends, which leaves a debt to the next step. */
static inline double scree_repaid(double lasts, double balance, double kick_work, double stored) {
  if (!(stored > 0) || kick_work == 0) return 0;
  double most = scree_min(1, fabs(balance) / stored) * (1 - lasts), share = -balance / kick_work;
  return share > most ? most : scree_max(share, -most);
}

static inline double scree_press_settled(bool hysteretic, scree_pair *pair) {
  return scree_spring_force(hysteretic, pair, pair->overlap,
                            (scree_felt){scree_spring_at(pair, pair->overlap).force, 1});
}

/* The spring's force in a contact that is not settled. The balance of its work is drawn in the
 * midst of the last drift: leapfrog keeps m v2/2 + K x x'/2, with x' the overlap before, also where
 * the way is bent. */
static inline double scree_press_moving(bool hysteretic, scree_pair *pair,
                                        const scree_overlap_motion *m) {
  const double overlap = m->overlap;
  const bool edge = scree_is_edge_of_touch(pair, m);
  scree_felt felt =
      edge ? scree_felt_at_edge(pair, m) : (scree_felt){scree_spring_at(pair, overlap).force, 1};
  double spring = scree_spring_force(hysteretic, pair, overlap, felt);
  if (hysteretic) return spring;
  const double before = m->first ? scree_max(0, overlap - m->rate * m->drift) : m->before;
  double half = -0.25 * (m->drift + m->step) * m->rate,
         stored = scree_energy_between(pair, overlap, before) -
                  0.5 * pair->law.pull * (overlap + before),
         worked = pair->worked + m->spring_work;
  if (m->first) worked = before > 0 ? -stored : 0; /* what is there already */
  if (!edge)
    spring *= 1 + scree_repaid(m->lasts, stored + worked, 2 * half * spring,
                               scree_spring_at(pair, overlap).energy);
  pair->worked = worked + half * spring;
  return spring;
}

/* ---- sliding and rolling ---- */

/* A spring and dashpot along the surface: k_t and c_t over contact weight, mu. */
typedef struct scree_slider {
  double stiffness, damping, friction;
  double grown; /* by which the contact weights count in sliding */
} scree_slider;

/* Hertz: K_t and C_t, C by the ratio of tangential and normal stiffness, over the root of the
 * overlap. */
static inline scree_slider scree_slider_of(const scree_pair *pair, double ratio, double lasts) {
  const scree_pair_law *l = &pair->law;
  if (l->hertz == 0)
    return (scree_slider){l->stiffness * ratio, lasts * l->damping * sqrt(ratio), l->friction, 1};
  double grown = sqrt(pair->overlap);
  return (scree_slider){l->mindlin,
                        lasts * l->damping * sqrt(l->mindlin / (1.5 * l->hertz)) / sqrt(grown),
                        l->friction, grown};
}

/* A spring after the last drift's velocity v along the surface, turned by half of its spin. */
static inline vec3 scree_stretched(vec3 xi, vec3 v, vec3 spin, double time_step) {
  return vec3_mad(xi, vec3_mad(v, vec3_cross(spin, xi), 0.5), time_step);
}

/* The tangential force; the spring was stretched to xi by the last drift, and is kept in the
 * anchor; `seen` is what the dashpot sees. */
static inline vec3 scree_slide(const scree_slider *law, scree_anchor *anchor, double s, vec3 n,
                               vec3 xi, vec3 seen, double normal_force, double *energy) {
  if (!(anchor->weight > 0)) {
    xi = (vec3){0, 0, 0};
  } else {
    xi = vec3_mad(xi, n, -vec3_dot(xi, n));
    if (s > anchor->weight) xi = vec3_scale(xi, anchor->weight / s);
  }
  double k = law->stiffness * s, c = law->damping * s, most = law->friction * normal_force;
  double length2 = vec3_norm2(xi);
  if (k * k * length2 > most * most) {
    xi = vec3_scale(xi, most / (k * sqrt(length2)));
    length2 = vec3_norm2(xi);
  }
  vec3 force = vec3_mad(vec3_scale(xi, -k), seen, -c);
  double size2 = vec3_norm2(force);
  if (size2 > most * most) force = vec3_scale(force, most / sqrt(size2));
  anchor->stretch = xi;
  *energy += 0.5 * k * length2;
  return force;
}

/* Rolling resistance (Ai and others 2011, type C, but that the limit is the whole couple's): a
 * spring and dashpot against the relative turning about axes along the surface, as the tangential
 * ones against sliding: the couple is at most mu_r R times the force `pressed` along n. The pair
 * keeps the spring, which the last drift
 * turned to `rolled`; `seen` is the turning that the dashpot sees. */
static inline vec3 scree_roll(scree_pair *pair, vec3 n, vec3 rolled, vec3 seen, double pressed,
                              double *energy) {
  double arm = pair->law.rolling;
  double stiffness =
      pair->law.hertz > 0 ? 1.5 * pair->law.hertz * sqrt(pair->overlap) : pair->law.stiffness;
  const scree_slider law = {.stiffness = 2.25 * stiffness * arm * arm,
                            .damping = pair->law.rolling_damping,
                            .friction = arm};
  scree_anchor spring = {.weight = 1};
  vec3 couple = scree_slide(&law, &spring, 1, n, rolled, seen, pressed, energy);
  pair->rolled = spring.stretch;
  return couple;
}

static inline scree_kept_wrench scree_kept(const scree_wrench *load) {
  vec3 f = load->force, m = load->moment;
  return (scree_kept_wrench){{(float)f.x, (float)f.y, (float)f.z},
                             {(float)m.x, (float)m.y, (float)m.z}};
}
