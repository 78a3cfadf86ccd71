/* A pair's step: wake what has reached its threshold, find the touching features, apply the law,
 * let the rest sleep.
 *
 * Sleeping is exact. The pair's `path` bounds from above how far any two points near the contact
 * have moved relative to each other; a feature pair that is `gap` from touching cannot touch before
 * the path has grown by gap. Near the contact is a ball (scree_pair_list): what lies outside it
 * by e is e farther from touching too, and as the bodies turn by less than a radian while the list
 * holds, its faster motion does not make up for that. A feature pair is woken two steps' travel
 * early, so that it is first seen from outside. When nothing is awake the whole pair sleeps on the
 * sum of the two bodies' paths; the step asks that of the pair's slot, so that sleeping pairs are
 * not touched at all.
 *
 * The ledger: the work of the dashpots and of the tangential forces over a kick of length dt is
 * dt/2 W.(v before + v after), with W the wrench. The first half is added when
 * the wrench is known, the second at the next evaluation: a trapezoid rule along the path, of
 * second order like the integrator. */
#include "world/contact/contact.h"
#include "world/broad/candidates.h"
#include "world/contact/carry.h"
#include "world/contact/law.h"
#include "world/state/walls.h"

static const double least_sleep = 4; /* steps of travel: shorter naps cost more than they save */

static double power_of(const scree_kept_wrench *kept, vec3 velocity, vec3 spin) {
  scree_wrench load = scree_kept_as_wrench(kept);
  return vec3_dot(load.force, velocity) + vec3_dot(load.moment, spin);
}

/* The second half: the loads of the last evaluation with the velocities after their kick. With
 * torques M - arm x F on a and -M on b, the power is F.(va - vb - wa x arm) + M.(wa - wb); the arm
 * is as it was before the drift. */
static void add_later_work(const scree_world *world, const scree_pair *pair, scree_scratch *scratch,
                           scree_pair_work *work) {
  scratch->spring_work = 0;
  if (!pair->touching) return;
  const scree_frame *a = scratch->a, *b = scratch->b;
  vec3 slip = vec3_sub(a->velocity, b->velocity),
       arm = vec3_mad(scree_pair_between(world, pair, a, b), slip, -scratch->drift),
       u = vec3_sub(slip, vec3_cross(a->spin, arm)), spin = vec3_sub(a->spin, b->spin);
  double half = 0.5 * pair->book.kick;
  scratch->spring_work =
      half * (vec3_dot(pair->book.spring.force, u) + vec3_dot(pair->book.spring.moment, spin));
  work->later_dashpot += half * power_of(&pair->book.dashpot, u, spin);
  work->later_tangential +=
      half * (power_of(&pair->book.tangential, u, spin) - pair->contact.belt_power);
}

double scree_half_work_of_wall(const scree_world *world, const scree_pair *pair) {
  const scree_wrench all = {pair->contact.wrench.force, vec3_neg(pair->contact.wrench.torque_b)};
  return 0.5 * world->time_step *
         scree_wall_power(&world->walls.items[pair->b], &all, pair->contact.belt_power);
}

/* A ball in the frame of b around all points whose motion counts: the list's region, else the
 * smaller body and a little beyond, with a at `at`. */
static double moving_ball(const scree_world *world, const scree_pair *pair, vec3 at, vec3 *centre) {
  *centre = pair->list.region;
  if (pair->list.region_radius > 0) return pair->list.region_radius;
  *centre = scree_pair_smaller_is_a(world, pair) ? at : (vec3){0, 0, 0};
  return scree_pair_radius(world, pair);
}

/* How far the bodies' points have moved relative to each other since the pair fell asleep. The sum
 * of the bodies' paths is a bound, but bodies that fly together hardly move relative to each other:
 * the net motion is another, and as good, since nothing can have touched in between. */
static double slept_path(const scree_world *world, const scree_pair *pair,
                         const scree_scratch *scratch) {
  const scree_neighbours *n = scratch->neighbours;
  const scree_frame *relative = &scratch->relative;
  vec3 centre;
  double radius = moving_ball(world, pair, n->asleep_at, &centre);
  mat3 then = quat_to_mat3(n->asleep_turned);
  vec3 of_a = mat3_tmul_vec(&then, vec3_sub(centre, n->asleep_at)),
       now = vec3_add(mat3_mul_vec(&relative->rotation, of_a), relative->position);
  double net = vec3_distance(now, centre) +
               radius * quat_chord(n->asleep_turned, scree_pair_turned(world, pair));
  return scree_min(net, scree_bodies_path(world, pair) - n->asleep_since);
}

/* a in the frame of b, its velocity and spin such that a's point at q moves with velocity + spin x
 * q. Answers a bound on the relative speed of the points that count. */
static double relate(const scree_world *world, const scree_pair *pair, scree_scratch *scratch) {
  scree_frame *relative = &scratch->relative;
  const scree_frame *a = scratch->a, *b = scratch->b;
  vec3 between = scree_pair_between(world, pair, a, b), slip = vec3_sub(a->velocity, b->velocity),
       spin = vec3_sub(a->spin, b->spin), at_b = vec3_sub(slip, vec3_cross(a->spin, between)),
       now = vec3_sub(vec3_sub(a->velocity_now, b->velocity_now), vec3_cross(a->spin_now, between));
  const mat3 *turned = &b->rotation;
  relative->rotation = mat3_tmul(turned, &a->rotation);
  relative->position = mat3_tmul_vec(turned, between);
  relative->velocity = mat3_tmul_vec(turned, at_b);
  relative->spin = mat3_tmul_vec(turned, spin);
  relative->velocity_now = mat3_tmul_vec(turned, now);
  relative->spin_now = mat3_tmul_vec(turned, vec3_sub(a->spin_now, b->spin_now));
  vec3 centre;
  double radius = moving_ball(world, pair, relative->position, &centre);
  vec3 there = vec3_add(relative->velocity, vec3_cross(relative->spin, centre));
  return vec3_norm(there) + radius * vec3_norm(spin);
}

/* What reaches its threshold wakes; when there is no room for all some are awake already, which is
 * no harm. */
static bool wake_features(scree_pair *pair, scree_scratch *scratch) {
  double wakes = pair->list.path + 2 * pair->list.travel + scree_pair_edge_reach(pair),
         next = INFINITY;
  if (wakes < pair->list.next_feature) return true;
  scree_range *sleeping = &scratch->neighbours->sleeping;
  scree_sleeping_feature *sleeping_features = scree_sleeping_features(scratch);
  bool room = true;
  uint32_t kept = 0;
  for (uint32_t i = 0; i < sleeping->count; i++) {
    scree_sleeping_feature sleeping_feature = sleeping_features[i];
    room = room && (wakes < sleeping_feature.wake ||
                    scree_reserve_features(scratch, pair, pair->active.count + 1));
    if (wakes < sleeping_feature.wake || !room) {
      next = scree_min(next, sleeping_feature.wake);
      if (kept < i) sleeping_features[kept] = sleeping_feature;
      kept++;
      continue;
    }
    scratch->features[pair->active.count++] = (scree_feature_pair){
        .kind = (uint8_t)sleeping_feature.kind, .a = sleeping_feature.a, .b = sleeping_feature.b};
  }
  sleeping->count = kept;
  pair->list.next_feature = next;
  return room;
}

/* For the contacts of all awake feature pairs and of edges inside, and for them all to fall asleep.
 */
static bool has_room(const scree_pair *pair, scree_scratch *scratch) {
  size_t contacts = (size_t)SCREE_ANCHORS * pair->active.count + SCREE_DEPTHS;
  return scree_reserve_contacts(scratch, contacts) &&
         scree_reserve_sleeping(scratch, scratch->neighbours->sleeping.count + pair->active.count);
}

static void begin_visits(const scree_pair *pair, scree_scratch *scratch) {
  scratch->found.nap = least_sleep * pair->list.travel + scree_pair_edge_reach(pair);
  scratch->contacts.count = 0;
}

void scree_pair_visit_feature(const scree_world *world, const scree_pair *pair, uint32_t i,
                              scree_scratch *scratch) {
  scree_feature_pair *feature = &scratch->features[i];
  feature->gap = scree_feature_contact(world, pair, feature, &scratch->relative, scratch);
}

/* What the visits found. Feature pairs that cannot touch soon go to sleep, but move only after the
 * law: the contacts point at their anchors. */
static void end_visits(const scree_pair *pair, scree_scratch *scratch) {
  scratch->found.least_gap = INFINITY;
  scratch->found.any_inside = false;
  scratch->found.to_sleep = 0;
  for (uint32_t i = 0; i < pair->active.count; i++) {
    scree_feature_pair *feature = &scratch->features[i];
    if (feature->gap < scratch->found.least_gap) scratch->found.least_gap = feature->gap;
    scratch->found.any_inside |= feature->inside;
    if (!(feature->gap > scratch->found.nap && feature->gap > 0) || feature->inside)
      feature->gap = 0;
    scratch->found.to_sleep += feature->gap > 0;
  }
}

static void settle_features(scree_pair *pair, scree_scratch *scratch) {
  scree_sleeping_feature *sleeping_features = scree_sleeping_features(scratch);
  uint32_t kept = 0;
  for (uint32_t i = 0; i < pair->active.count; i++) {
    const scree_feature_pair *feature = &scratch->features[i];
    if (feature->gap > 0) {
      scree_sleeping_feature sleeping_feature = {pair->list.path + feature->gap, feature->a,
                                                 feature->b, feature->kind};
      sleeping_features[scratch->neighbours->sleeping.count++] = sleeping_feature;
      pair->list.next_feature = scree_min(pair->list.next_feature, sleeping_feature.wake);
      continue;
    }
    if (kept != i) {
      scratch->features[kept] = *feature;
      if (feature->notched) scratch->further[kept] = scratch->further[i];
    }
    kept++;
  }
  pair->active.count = kept;
}

static void clear_results(scree_pair *pair) {
  pair->touching = false;
  pair->substeps.elastic_since = 0;
  pair->substeps.followed = false;
  pair->contact.elastic = pair->contact.tangential_elastic = pair->contact.overlap = 0;
  pair->contact.count = 0;
}

double scree_hysteresis_loss(const scree_pair *pair, double before) {
  return scree_spent_at(pair, pair->history.largest) - scree_spent_at(pair, before);
}

void scree_note_pressed(const scree_world *world, const scree_pair *pair, scree_scratch *scratch,
                        scree_pair_work *work) {
  const double from = hard_from * pair->law.limit;
  work->pressed |= scree_is_through(world, pair);
  if (!(pair->contact.overlap > from) || pair->depenetrating) return;
  work->begins_hardening |= !(scratch->overlap_before > from);
  work->missing = scree_max(work->missing, scree_stiffness_missing(world, pair));
}

/* Whether a point can pass a wall of the other body between two steps: then neither sees it. A
 * sheet knows the side of every point, and a plane has no other. */
static bool passes_unseen(const scree_world *world, const scree_pair *pair) {
  if (pair->wall && scree_wall_is_analytic(&world->walls.items[pair->b])) return false;
  return pair->active.count > 0 && !(pair->list.travel <= 2 * pair->law.thin);
}

bool scree_pair_needs_list(const scree_pair *pair) {
  return pair->list.path + 2 * pair->list.travel >= pair->list.end;
}

bool scree_pair_wake(scree_pair *pair, scree_scratch *scratch) {
  if (!wake_features(pair, scratch) || !has_room(pair, scratch)) return false;
  begin_visits(pair, scratch);
  return true;
}

/* Where the two are. */
static void take_places(const scree_world *world, const scree_pair *pair, scree_scratch *scratch) {
  scratch->a = &world->bodies.frame[pair->a];
  scratch->b = scree_pair_frame_b(world, pair);
  scratch->drift = world->time_step / pair->substeps.count;
  if (pair->substeps.count == 1) return;
  scratch->own[0] = scree_owed_frame(world, pair, scratch, false);
  scratch->own[1] = scree_owed_frame(world, pair, scratch, true);
  scratch->a = &scratch->own[0];
  scratch->b = &scratch->own[1];
}

/* What is to be found before the law. */
static void ask(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  scratch->before.was_depenetrating = pair->was_depenetrating;
  pair->was_depenetrating = false;
  scree_pair_ask_depths(world, pair, scratch);
}

/* The law at the present places. */
static void apply_contact_law(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                              scree_pair_work *work) {
  const scree_frame *relative = &scratch->relative;
  const bool pushed = scree_is_pushed(pair), was_depenetrating = scratch->before.was_depenetrating;
  if (pair->depenetrating)
    work->let_go = pair->contact.elastic + pair->substeps.elastic_since; /* of the last step */
  scratch->overlap_before = pair->contact.overlap;
  clear_results(pair);
  double largest = pair->history.largest;
  scree_powers powers = scree_pair_apply_law(world, pair, relative, scratch);
  pair->book.kick = 0;
  if (was_depenetrating)
    work->let_go -= pair->contact.elastic; /* what the features feel anew was not loaded by work */
  if (!pair->touching) return;
  pair->book.kick = 0.5 * (scratch->drift + scratch->step);
  work->begins_depenetration |= !pushed && scree_is_pushed(pair);
  const double half = 0.5 * scratch->drift, rest = 0.5 * pair->book.kick - half;
  work->dashpot = half * powers.dashpot;
  work->tangential = half * powers.tangential;
  pair->book.later_dashpot += rest * powers.dashpot;
  pair->book.later_tangential += rest * powers.tangential;
  if (world->options.law == SCREE_LAW_HYSTERETIC && pair->history.largest > largest)
    work->lost = scree_hysteresis_loss(pair, largest);
  scree_note_pressed(world, pair, scratch, work);
}

void scree_pair_begin_work(const scree_world *world, const scree_pair *pair,
                           scree_scratch *scratch) {
  scratch->before.wrench =
      pair->touching ? pair->contact.wrench : (scree_pair_wrench){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  take_places(world, pair, scratch);
  scratch->work = (scree_pair_work){.later_dashpot = pair->book.later_dashpot,
                                    .later_tangential = pair->book.later_tangential};
  add_later_work(world, pair, scratch, &scratch->work);
  if (pair->substeps.count > 1) scratch->spring_work += scree_unforeseen_work(world, pair, scratch);
  if (pair->touching && pair->wall) scratch->work.wall = scree_half_work_of_wall(world, pair);
}

void scree_pair_relate(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  scratch->before.list = pair->list;
  scratch->before.asleep = pair->asleep;
  scree_pair_begin_work(world, pair, scratch);
  double speed = relate(world, pair, scratch);
  pair->list.travel = speed * world->time_step;
  pair->list.path +=
      scratch->before.asleep ? slept_path(world, pair, scratch) : speed * scratch->drift;
  pair->asleep = false;
}

void scree_pair_step_back(scree_pair *pair, const scree_scratch *scratch) {
  pair->list = scratch->before.list;
  pair->asleep = scratch->before.asleep;
}

void scree_pair_meet(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  scratch->work.too_fast = passes_unseen(world, pair);
  pair->book.later_dashpot = pair->book.later_tangential = 0;
  end_visits(pair, scratch);
  scratch->substeps = scree_substep_count(world, pair, &scratch->relative, scratch);
  scratch->step = world->time_step / scratch->substeps;
  ask(world, pair, scratch);
}

void scree_pair_contact_law(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  apply_contact_law(world, pair, scratch, &scratch->work);
  if (scratch->found.to_sleep > 0) settle_features(pair, scratch);
}

bool scree_pair_narrow_phase(const scree_world *world, scree_pair *pair, scree_scratch *scratch) {
  scree_pair_relate(world, pair, scratch);
  if ((scree_pair_needs_list(pair) && !scree_pair_list(world, pair, scratch)) ||
      !scree_pair_wake(pair, scratch)) {
    scree_pair_step_back(pair, scratch);
    return false;
  }
  for (uint32_t i = 0; i < pair->active.count; i++)
    scree_pair_visit_feature(world, pair, i, scratch);
  scree_pair_meet(world, pair, scratch);
  if (scree_asks_depths(&scratch->found.question))
    scree_pair_find_depths(world, pair, scratch, &scratch->work);
  scree_pair_contact_law(world, pair, scratch);
  return true;
}

void scree_pair_narrow_phase_between(const scree_world *world, scree_pair *pair,
                                     scree_scratch *scratch) {
  scree_pair_work part = {0};
  add_later_work(world, pair, scratch, &part);
  pair->list.travel = relate(world, pair, scratch) * scratch->drift;
  pair->list.path += pair->list.travel;
  begin_visits(pair, scratch);
  for (uint32_t i = 0; i < pair->active.count; i++)
    scree_pair_visit_feature(world, pair, i, scratch);
  end_visits(pair, scratch);
  ask(world, pair, scratch);
  if (scree_asks_depths(&scratch->found.question))
    scree_pair_find_depths(world, pair, scratch, &part);
  apply_contact_law(world, pair, scratch, &part);
  pair->book.later_dashpot += part.later_dashpot + part.dashpot - part.lost - part.let_go;
  pair->book.later_tangential += part.later_tangential + part.tangential;
  scratch->work.begins_depenetration |= part.begins_depenetration;
  scratch->work.pressed |= part.pressed;
  scratch->work.begins_hardening |= part.begins_hardening;
  scratch->work.missing = scree_max(scratch->work.missing, part.missing);
}
