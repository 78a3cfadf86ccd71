/* What the laws of spheres (spheres.c) and of all other pairs (law.c) share: the pair's spring over
 * an impact, the slider, rolling resistance. docs/background/physics.md has the equations. */
#pragma once

#include "world/state/constants.h"
#include "world/state/scratch.h"

/* Force and energy of the pair's spring at an overlap of 0 or more, N and J. */
typedef struct scree_spring_state {
  double force, energy;
} scree_spring_state;

static inline scree_spring_state scree_soft_spring_at(const scree_pair_law *law, double m) {
  double k = law->stiffness, hertz = law->hertz;
  if (hertz == 0) return (scree_spring_state){k * m, 0.5 * k * m * m};
  double force = hertz * m * sqrt(m);
  return (scree_spring_state){force, 0.4 * force * m};
}

/* C over the law's damping, at an overlap. */
static inline double scree_dashpot_grown(const scree_pair_law *law, double m) {
  return law->hertz > 0 ? sqrt(sqrt(m)) : 1;
}
/* Its integral over `acts` steps from a touch's begin, over what it is after `way` steps. */
static inline double scree_dashpot_acts(const scree_pair_law *law, double acts, double way) {
  return law->hertz > 0 ? 0.8 * acts * sqrt(sqrt(acts / way)) : acts;
}

/* What a spring presses with more where it is deeper than a contact should be: its stiffness grows
 * by k y/w up to k, and stays there. */
static inline scree_spring_state scree_hardened(const scree_pair_law *law, double m, double k) {
  const double w = hard_width * law->limit, y = m - hard_from * law->limit, z = y - 0.5 * w;
  if (!(y > 0)) return (scree_spring_state){0, 0};
  if (y < w) return (scree_spring_state){0.5 * k * y * y / w, k * y * y * y / (6 * w)};
  return (scree_spring_state){k * z, k * (0.5 * z * z + w * w / 24)};
}

static inline double scree_hard(const scree_pair *pair) {
  return pair->spheres ? hard_most : hard_most_turning;
}

static inline scree_spring_state scree_spring_at(const scree_pair *pair, double m) {
  const scree_pair_law *law = &pair->law;
  const scree_spring_state soft = scree_soft_spring_at(law, m),
                           hard = scree_hardened(law, m, scree_hard(pair) * law->stiffness);
  return (scree_spring_state){soft.force + hard.force, soft.energy + hard.energy};
}

/* The hysteretic one's, on loading. It unloads 1/e^2 times as steeply, which steps must follow. */
static inline scree_spring_state scree_loaded_at(const scree_pair *pair, double m) {
  const scree_pair_law *law = &pair->law;
  const double e2 = law->restitution * law->restitution;
  const scree_spring_state hard = scree_hardened(law, m, e2 * scree_hard(pair) * law->stiffness);
  return (scree_spring_state){law->stiffness * m + hard.force,
                              0.5 * law->stiffness * m * m + hard.energy};
}

/* J, of what the hysteretic spring took up to this overlap it does not give back. */
static inline double scree_spent_at(const scree_pair *pair, double m) {
  return (1 - pair->law.restitution * pair->law.restitution) * scree_loaded_at(pair, m).energy;
}

/* The pair's spring, its largest overlap so far being known. The hysteretic one goes back from
 * there along e^2 of its way in, to e^2 of the energy, whatever the loading was; what it spends
 * counts as its energy here. */
static inline scree_spring_state scree_bearing_at(bool hysteretic, const scree_pair *pair,
                                                  double m) {
  if (!hysteretic) return scree_spring_at(pair, m);
  if (m >= pair->history.largest) return scree_loaded_at(pair, m);
  const double e2 = pair->law.restitution * pair->law.restitution;
  const scree_spring_state back =
      scree_loaded_at(pair, scree_max(0, pair->history.largest - (pair->history.largest - m) / e2));
  return (scree_spring_state){back.force,
                              e2 * back.energy + scree_spent_at(pair, pair->history.largest)};
}

/* The width l in which features share the overlap m, and dl/dm. Turning the bodies is as stiff as
 * F/l: where the spring hardens l grows with it. */
typedef struct scree_blend {
  double width, slope;
} scree_blend;

static inline scree_blend scree_blend_at(const scree_pair_law *law, double kappa, double m) {
  const double w = hard_width * law->limit, y = m - hard_from * law->limit,
               more = hard_sharing - kappa;
  scree_blend blend = {law->smoothing + kappa * m, kappa};
  if (!(y > 0) || !(more > 0)) return blend;
  blend.width += y < w ? more * 0.5 * y * y / w : more * (y - 0.5 * w);
  blend.slope += more * (y < w ? y / w : 1);
  return blend;
}

/* The reduced mass of both bodies, kg. */
static inline double scree_reduced_mass(const scree_pair_law *law) {
  const double pace = law->contact_time / 3.14159265358979323846;
  return law->stiffness * pace * pace;
}

/* How far the contact is no impact any more, from 0 to 1: the tangential dashpot. An oblique impact
 * follows the spring and slider alone; what rests on each other is calmed. */
static inline double scree_lasting(const scree_pair *pair) {
  double age = pair->history.age / pair->law.contact_time;
  return age < 1.5 ? 0 : age > 3 ? 1 : (age - 1.5) / 1.5;
}

/* With q = (2 U/K)^1/2 in place of m the motion is that of a linear spring where C grows as dq/dm:
 * so e is kept, however hard the spring is. By how much more than where it is soft. */
static inline double scree_hardened_damping(const scree_pair *pair) {
  if (!(pair->contact.overlap > hard_from * pair->law.limit)) return 1;
  const scree_spring_state soft = scree_soft_spring_at(&pair->law, pair->contact.overlap),
                           is = scree_spring_at(pair, pair->contact.overlap);
  /* in what lasts steps do not bear as much where many hold one */
  return 1 +
         (is.force / soft.force * sqrt(soft.energy / is.energy) - 1) * (1 - scree_lasting(pair));
}

/* By which factor all springs would have to be stiffer for the pair to stay within its limit: in an
 * impact what bears as much energy, in a contact that lasts as much force. */
static inline double scree_stiffness_missing(const scree_world *world, const scree_pair *pair) {
  const bool hysteretic = world->options.law == SCREE_LAW_HYSTERETIC;
  const scree_spring_state soft = scree_soft_spring_at(&pair->law, pair->law.limit),
                           is = hysteretic ? scree_loaded_at(pair, pair->contact.overlap)
                                           : scree_spring_at(pair, pair->contact.overlap);
  return scree_lasting(pair) == 1 ? is.force / soft.force : is.energy / soft.energy;
}

/* Whether one of the two is through the other's middle, or numbers are no more. What parts lies
 * deeper from the start, or has edges that do. */
static inline bool scree_is_through(const scree_world *world, const scree_pair *pair) {
  const double half = 0.5 / world->options.overlap_limit;
  return !(pair->contact.overlap <= scree_min(most_pressed, half) * pair->law.limit) &&
         !pair->depenetrating;
}

/* What leapfrog keeps of the spring's energy in the midst of a drift from one overlap to another:
 * K x y/2 of a linear one. */
static inline double scree_energy_between(bool hysteretic, const scree_pair *pair, double x,
                                          double y) {
  scree_spring_state at_x = scree_bearing_at(hysteretic, pair, x),
                     at_y = scree_bearing_at(hysteretic, pair, y);
  return 0.5 * (at_x.energy + at_y.energy) - 0.25 * (at_x.force - at_y.force) * (x - y);
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
  double rest;        /* the overlap at which the spring, unloading, presses no more */
  bool hysteretic, first; /* first: in this contact */
} scree_overlap_motion;

/* From the last look to this one, by the rates. */
static inline scree_overlap_motion scree_overlap_moves(const scree_world *world,
                                                       const scree_pair *pair,
                                                       const scree_scratch *scratch, double rate,
                                                       double rate_now) {
  const bool hysteretic = world->options.law == SCREE_LAW_HYSTERETIC;
  const double e = pair->law.restitution;
  return (scree_overlap_motion){.overlap = pair->contact.overlap,
                                .before = scratch->overlap_before,
                                .rate = rate,
                                .rate_now = rate_now,
                                .drift = scratch->drift,
                                .step = scratch->step,
                                .spring_work = scratch->spring_work,
                                .lasts = scree_lasting(pair),
                                .rest = hysteretic && pair->contact.overlap < pair->history.largest
                                            ? (1 - e * e) * pair->history.largest
                                            : 0,
                                .hysteretic = hysteretic,
                                .first = scratch->overlap_before == 0 ||
                                         scratch->before.was_depenetrating};
}

/* In a contact that lasts, deep beside its way in a step, the balance is not drawn. */
static inline bool scree_is_settled(const scree_pair *pair, double lasts) {
  return lasts == 1 && pair->contact.overlap >= steep_overlap * pair->list.travel;
}

/* The way on the other side of the touch's begin or end. */
static inline double scree_outer_way(const scree_overlap_motion *m) {
  return m->rate_now > 0 ? fabs(m->rate) * m->drift : fabs(m->rate_now) * m->step;
}

/* Whether a touch begins or ends within this step, or the spring alone. */
static inline bool scree_is_edge_of_touch(const scree_pair *pair, const scree_overlap_motion *m) {
  const double in = m->overlap - m->rest;
  return in < steep_overlap * pair->list.travel && scree_outer_way(m) > in && in > 0 &&
         m->rate != 0;
}

/* For which share of the kick dashpots act, and for how long what slides or rolls has stretched its
 * springs in the last drift, s: where the touch begins or ends within the step, by the way on the
 * other side. A dashpot that grows from nothing, as Hertz's, acts as m^1/4 does in the mean. */
typedef struct scree_touch_time {
  double damped, slid;
  bool first;
} scree_touch_time;

static inline scree_touch_time scree_touch_time_of(const scree_pair *pair,
                                                   const scree_overlap_motion *m) {
  scree_touch_time t = {1, m->first ? 0 : m->drift, m->first};
  const double part =
      m->overlap / scree_outer_way(m); /* rounding must not decide about a whole step */
  const bool begins = m->first && m->rate_now > 0 && m->rate > 0 && part < 1.01;
  if (!begins && !scree_is_edge_of_touch(pair, m)) return t;
  const double way = scree_min(part, 1), acts = 0.5 + way;
  t.damped = scree_dashpot_acts(&pair->law, acts, way);
  /* Mindlin's K_t grows with the root of the overlap */
  if (m->first) t.slid = way * m->drift * (pair->law.hertz > 0 ? 2.0 / 3 : 1);
  return t;
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
  const double x = m->overlap, kick = 0.5 * (m->drift + m->step), speed = fabs(m->rate),
               spent = m->rest > 0 ? scree_spent_at(pair, pair->history.largest) : 0;
  const bool begins = m->rate_now > 0;
  scree_felt f = {scree_bearing_at(m->hysteretic, pair, x).force, 1};
  for (int round = 0; round < 2; round++) {
    double change = round == 0 ? 0 : (f.force - pair->law.pull * f.pull) * kick * m->inverse,
           middle = begins ? speed - 0.5 * change : speed + 0.5 * change,
           inner = scree_max(0, begins ? (speed - change) * m->step : speed * m->drift),
           way = scree_max(middle, 0.5 * speed) * kick;
    f.force = (scree_energy_between(m->hysteretic, pair, x, x + inner) - spent) / way;
    if (m->rest == 0) f.pull = (x + 0.5 * inner) / way;
  }
  return f;
}

/* The spring's force at overlap m, felt so, less that with which the bodies hold each other, and
 * the energy that comes back from both. */
static inline double scree_spring_force(bool hysteretic, scree_pair *pair, double m,
                                        scree_felt felt) {
  pair->contact.elastic = scree_bearing_at(hysteretic, pair, m).energy - pair->law.pull * m;
  if (hysteretic) {
    pair->history.largest = scree_max(pair->history.largest, m);
    pair->contact.elastic -= scree_spent_at(pair, pair->history.largest);
  }
  return felt.force - pair->law.pull * felt.pull;
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
  const double m = pair->contact.overlap;
  return scree_spring_force(hysteretic, pair, m,
                            (scree_felt){scree_bearing_at(hysteretic, pair, m).force, 1});
}

/* The spring's force in a contact that is not settled. The balance of its work is drawn in the
 * midst of the last drift: leapfrog keeps m v2/2 + K x x'/2, with x' the overlap before, also where
 * the way is bent. */
static inline double scree_press_moving(scree_pair *pair, const scree_overlap_motion *m) {
  const double overlap = m->overlap;
  const bool edge = scree_is_edge_of_touch(pair, m);
  const scree_spring_state is = scree_bearing_at(m->hysteretic, pair, overlap);
  const scree_felt felt = edge ? scree_felt_at_edge(pair, m) : (scree_felt){is.force, 1};
  double spring = scree_spring_force(m->hysteretic, pair, overlap, felt);
  if (m->hysteretic) return spring;
  const double before = m->first ? scree_max(0, overlap - m->rate * m->drift) : m->before;
  double half = -0.25 * (m->drift + m->step) * m->rate,
         stored = scree_energy_between(false, pair, overlap, before) -
                  0.5 * pair->law.pull * (overlap + before),
         worked = pair->history.worked + m->spring_work;
  if (m->first) worked = before > 0 ? -stored : 0; /* what is there already */
  if (!edge) spring *= 1 + scree_repaid(m->lasts, stored + worked, 2 * half * spring, is.energy);
  pair->history.worked = worked + half * spring;
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
  double grown = sqrt(pair->contact.overlap);
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

/* The stiffness of rolling resistance over (mu_r R)^2. */
static inline double scree_rolling_stiffness(const scree_pair *pair) {
  double hertz = pair->law.hertz;
  return 2.25 * (hertz > 0 ? 1.5 * hertz * sqrt(pair->contact.overlap) : pair->law.stiffness);
}

/* The couple of a spring and dashpot against rolling. Ai and others' type C: the spring alone is
 * limited, and there the dashpot is none, as in LIGGGHTS's EPSD; else the limit is the whole's. */
static inline vec3 scree_resist_rolling(bool epsd, const scree_slider *law, scree_anchor *spring,
                                        vec3 n, vec3 rolled, vec3 seen, double pressed,
                                        double *energy) {
  if (!epsd) return scree_slide(law, spring, 1, n, rolled, seen, pressed, energy);
  const scree_slider alone = {.stiffness = law->stiffness, .friction = law->friction};
  const double most = law->friction * pressed;
  const vec3 couple = scree_slide(&alone, spring, 1, n, rolled, seen, pressed, energy);
  const bool slips = vec3_norm2(couple) > (1 - 1e-12) * most * most;
  return slips ? couple : vec3_mad(couple, seen, -law->damping);
}

/* Rolling resistance of spheres: a spring and dashpot against the relative turning about axes along
 * the surface, as the tangential ones against sliding: the couple is at most mu_r R times the force
 * `pressed` along n. The pair keeps the spring, which the last drift turned to `rolled`; `seen` is
 * the turning that the dashpot sees, for a share `damped` of the kick. */
static inline vec3 scree_roll(bool epsd, scree_pair *pair, vec3 n, vec3 rolled, vec3 seen,
                              double damped, double pressed, double *energy) {
  double arm = pair->law.rolling;
  const scree_slider law = {.stiffness = scree_rolling_stiffness(pair) * arm * arm,
                            .damping = damped * pair->law.rolling_damping,
                            .friction = arm};
  scree_anchor spring = {.weight = 1};
  vec3 couple = scree_resist_rolling(epsd, &law, &spring, n, rolled, seen, pressed, energy);
  pair->history.rolled = spring.stretch;
  return couple;
}

static inline scree_kept_wrench scree_kept(const scree_wrench *load) {
  vec3 f = load->force, m = load->moment;
  return (scree_kept_wrench){{(float)f.x, (float)f.y, (float)f.z},
                             {(float)m.x, (float)m.y, (float)m.z}};
}
