/* The contact law of a pair: anchored smooth maximum (docs/background/physics.md, "One spring").
 *
 * The pair's overlap m is a smooth maximum of its features' overlaps o_i, with a width l that grows
 * with the overlap, l = l0 + kappa m: m = (t + l0)/(1 - kappa), where t solves
 *   sum_i w_i (o_i - t)+^2 = l^2.
 * One feature gives m = o; n equal ones at most (o + l0)/(1 - kappa). U = K m^2/2 is the energy and
 * s_i = dm/do_i = w_i (o_i - t)+ / (S (1 - kappa) + kappa l), S = sum w_i (o_i - t)+, the contact
 * weights: f_i = max(0, s_i (K m + C do_i/dt)). Tangentially each feature has a spring K_t s_i
 * stretched by xi_i, which turns with both, follows the sliding, and is shortened to the Coulomb
 * limit; when the contact weight grows the force stays (xi s is kept), so that energy is only ever
 * lost. Hysteretic: F = K m on first loading, K/e^2 (m - m0) below the largest m, m0 = (1 - e^2)
 * max m.
 *
 * C = 2 eta sqrt(mu K), with the effective mass mu of both bodies at the contact: 1/mu = g M^-1 g,
 * g the mean by contact weights of the features' wrenches of length 1, M the masses and moments of
 * inertia.
 *
 * Hertz: U = 2/5 h m^5/2 and K_t = 8 G* (R* m)^1/2, by which the tangential force grows with the
 * sliding as Mindlin's without micro-slip does.
 *
 * Features come and go, and steps do not resolve all of it. What the spring has won or lost by
 * that, dU + W over an impact, it gives back: its force is up to twice as large, or none, until the
 * balance is even (compare Love and Laursen 2003, "Energy conserving algorithms for contact").
 */
#include "world/contact/law.h"
#include "world/broad/candidates.h"
#include "world/contact/carry.h"
#include "world/contact/contact.h"
#include "world/contact/overlap.h"
#include "world/state/walls.h"

/* Halvings of a bracket down to rounding. */
enum { EASE_ROUNDS = 60 };

/* dm/do of a touch. */
static double weight_of(const scree_contact_point *contact, const scree_smooth_maximum *maximum) {
  double above = contact->overlap - maximum->cutoff;
  return above > 0 ? contact->taper * above / maximum->denominator : 0;
}

/* What all contacts of the pair share: in sliding, and the motion that their dashpots see. */
typedef struct slider {
  scree_slider along;
  double time_step, normal_damping; /* dt, C */
  scree_touch_time touch;
  vec3 velocity, spin;
  const scree_world_wall *belt; /* b, whose surface moves along itself; NULL: it does not */
} slider;

static slider make_slider(const scree_world *world, const scree_pair *pair,
                          const scree_frame *relative, double drift) {
  double lasts = scree_lasting(pair), lead = scree_dashpot_lead(lasts);
  vec3 velocity = vec3_sub(relative->velocity_now, relative->velocity),
       spin = vec3_sub(relative->spin_now, relative->spin);
  slider law = {.along = scree_slider_of(pair, world->options.tangential_ratio, lasts),
                .time_step = drift,
                .velocity = vec3_mad(relative->velocity, velocity, lead),
                .spin = vec3_mad(relative->spin, spin, lead)};
  if (pair->wall && scree_wall_is_belt(&world->walls.items[pair->b]))
    law.belt = &world->walls.items[pair->b];
  return law;
}

/* Forces on a and their moments about the origin of b, in its frame: normal ones, the dashpots'
 * part of them, tangential ones; and the power of the latter two in the last drift. */
typedef struct load_sums {
  scree_wrench normal, dashpot, tangential;
  double dashpot_power, tangential_power;
  double belt_power; /* of the tangential ones by a belt's motion along itself */
  double pressed;    /* the normal forces, without what holds the bodies together */
} load_sums;

static void add_wrench(scree_wrench *load, vec3 direction, vec3 arm, double size) {
  load->force = vec3_mad(load->force, direction, size);
  load->moment = vec3_mad(load->moment, arm, size);
}

/* moment I^-1 moment */
static double by_moments(vec3 moment, vec3 inertia) {
  return moment.x * moment.x / inertia.x + moment.y * moment.y / inertia.y +
         moment.z * moment.z / inertia.z;
}

/* 1/m of both bodies along a wrench in the frame of b, its moment about b's origin. */
static double inverse_mass(const scree_world *world, const scree_pair *pair,
                           const scree_frame *relative, const scree_wrench *along) {
  const scree_bodies *bodies = &world->bodies;
  vec3 moment = vec3_sub(along->moment, vec3_cross(relative->position, along->force)),
       of_a = mat3_tmul_vec(&relative->rotation, moment), of_b = along->moment;
  double square = vec3_norm2(along->force),
         inverse = square / bodies->mass[pair->a] + by_moments(of_a, bodies->inertia[pair->a]);
  if (pair->wall) return inverse;
  return inverse + square / bodies->mass[pair->b] + by_moments(of_b, bodies->inertia[pair->b]);
}

/* Most that steps resolve of the slope of a blend or of a fading taper, which lets go of much of
 * the overlap in a small part of the way: the force must move the bodies by little of that way in a
 * step, by K m dt^2/mu. */
static double most_resolved(const scree_pair *pair, double step, double inverse, double least) {
  double moves = scree_spring_at(pair, pair->contact.overlap).force * step * step * inverse;
  return scree_max(least, resolved_share * pair->law.reach / moves);
}

/* What a contact's overlap adds to the slope of the pair's, the slopes limited. */
static void add_slope(const scree_world *world, const scree_pair *pair, const scree_frame *relative,
                      double step, scree_contact_point *contact, scree_wrench *slope) {
  const scree_wrench along = {contact->normal, vec3_cross(contact->at, contact->normal)};
  if (contact->gap_gradient > most_slopes[0])
    contact->gap_gradient = scree_min(
        contact->gap_gradient,
        most_resolved(pair, step, inverse_mass(world, pair, relative, &along), most_slopes[0]));
  add_wrench(slope, along.force, along.moment, contact->weight * contact->gap_gradient);
}

/* Its taper's part, with dm/dw = (o - t)^2/(2 (S (1 - kappa) + kappa l)). */
static void add_fading(const scree_world *world, const scree_pair *pair,
                       const scree_frame *relative, double step,
                       const scree_smooth_maximum *maximum, scree_contact_point *contact,
                       scree_wrench *slope) {
  double size = vec3_norm(contact->fading), above = contact->overlap - maximum->cutoff,
         slopes = 0.5 * above * above / maximum->denominator * size;
  if (!(size > 0)) return;
  vec3 n = vec3_scale(contact->fading, 1 / size);
  const scree_wrench along = {n, vec3_cross(contact->at, n)};
  slopes = scree_min(slopes, most_resolved(pair, step, inverse_mass(world, pair, relative, &along),
                                           most_slopes[1]));
  contact->fading = vec3_scale(n, slopes);
  add_wrench(slope, along.force, along.moment, slopes);
}

/* How the pair's overlap grows with the bodies' motion, as a wrench, and the part of it that fading
 * tapers have; the sum of the weights. */
typedef struct overlap_slope {
  scree_wrench whole, fading;
  double weight;
} overlap_slope;

static overlap_slope find_slope(const scree_world *world, const scree_pair *pair,
                                const scree_smooth_maximum *maximum, scree_scratch *scratch) {
  overlap_slope slope = {0};
  for (size_t i = 0; i < scratch->contacts.count; i++) {
    scree_contact_point *contact = &scratch->contacts.items[i];
    contact->weight = weight_of(contact, maximum);
    if (!(contact->weight > 0)) continue;
    slope.weight += contact->weight;
    add_slope(world, pair, &scratch->relative, scratch->step, contact, &slope.whole);
    add_fading(world, pair, &scratch->relative, scratch->step, maximum, contact, &slope.fading);
  }
  return slope;
}

/* By the pair's damping, which is that of its reduced mass; features that press against each other
 * have no less. */
static double damping_at(const scree_world *world, const scree_pair *pair,
                         const scree_frame *relative, const overlap_slope *slope) {
  double inverse =
             inverse_mass(world, pair, relative, &slope->whole) / (slope->weight * slope->weight),
         share = scree_min(1, 1 / (inverse * scree_reduced_mass(&pair->law))),
         damping = pair->law.damping * sqrt(share);
  damping *= scree_hardened_damping(pair);
  return damping * scree_dashpot_grown(&pair->law, pair->contact.overlap);
}

static double along_motion(const scree_wrench *wrench, vec3 velocity, vec3 spin) {
  return vec3_dot(wrench->force, velocity) + vec3_dot(wrench->moment, spin);
}

/* Into space. */
static scree_wrench turned(const scree_wrench *load, const mat3 *rotation) {
  return (scree_wrench){mat3_mul_vec(rotation, load->force), mat3_mul_vec(rotation, load->moment)};
}

/* One touching feature: its forces, added to the sums. */
static void contact_force(const scree_pair *pair, const slider *law, double spring,
                          scree_contact_point *contact, const scree_frame *relative, double *energy,
                          load_sums *sums) {
  vec3 n = contact->normal, arm = vec3_cross(contact->at, n);
  vec3 v = vec3_add(relative->velocity, vec3_cross(relative->spin, contact->at));
  double approach = vec3_dot(v, n);
  v = vec3_mad(v, n, -approach);
  vec3 seen = vec3_add(law->velocity, vec3_cross(law->spin, contact->at));
  double rate = -vec3_dot(seen, n);
  seen = vec3_mad(seen, n, rate);
  vec3 belt = {0, 0, 0};
  if (law->belt) {
    belt = scree_belt_velocity(law->belt, contact->at, n);
    v = vec3_sub(v, belt);
    seen = vec3_sub(seen, belt);
  }
  double weight = contact->weight * contact->gap_gradient, pull = weight * pair->law.pull,
         pressing = weight * spring + pull,
         normal = pressing + weight * law->normal_damping * contact->gap_gradient * rate;
  if (!(normal > 0)) normal = 0;
  double dashpot = normal - pressing, pressed = normal;
  normal -= pull;
  sums->pressed += pressed;
  add_wrench(&sums->normal, n, arm, normal);
  add_wrench(&sums->dashpot, n, arm, dashpot);
  sums->dashpot_power += dashpot * approach;
  contact->force = vec3_scale(n, normal);
  if (contact->of_depth) return;
  const double weight_along = contact->weight * law->along.grown;
  const bool begins = law->touch.first && law->touch.slid > 0;
  if (begins) *contact->anchor = (scree_anchor){.weight = weight_along};
  vec3 xi = scree_stretched(contact->anchor->stretch, v, relative->spin,
                            begins ? law->touch.slid : law->time_step),
       along =
           scree_slide(&law->along, contact->anchor, weight_along, n, xi, seen, pressed, energy);
  contact->force = vec3_mad(along, n, normal);
  contact->anchor->normal = n;
  contact->anchor->weight = weight_along;
  sums->tangential.force = vec3_add(sums->tangential.force, along);
  sums->tangential.moment = vec3_add(sums->tangential.moment, vec3_cross(contact->at, along));
  sums->tangential_power += vec3_dot(along, v);
  if (law->belt) sums->belt_power += vec3_dot(along, belt);
}

/* What a fading taper presses with. */
static void fade(double spring, scree_contact_point *contact, load_sums *sums) {
  vec3 force = vec3_scale(contact->fading, spring);
  contact->force = vec3_add(contact->force, force);
  sums->normal.force = vec3_add(sums->normal.force, force);
  sums->normal.moment = vec3_add(sums->normal.moment, vec3_cross(contact->at, force));
}

/* Where the contacts hold the bodies against each other these are to part, from the next step on,
 * unless its look at depths finds that one is wedged in the other. So they are where features alone
 * cancel and the contact lasts, deeper than references count from: the next step asks for the
 * depth; not in a sheet, which has none, and between whose sides a body may be wedged. And so they
 * are where edges lie inside and are pressed beyond the overlap limit.
 */
static void judge(const scree_world *world, scree_pair *pair, const scree_contact_list *contacts) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  if (!scree_knows_depths(a, b)) return;
  bool jammed =
           pair->contact.overlap > 0.5 * pair->law.reach && scree_lasting(pair) == 1 && !b->sheet,
       pressed = pair->contact.overlap > most_pressed * pair->law.limit && pair->depth > 0;
  if (!jammed && !pressed && !contacts->items[contacts->count - 1].of_depth)
    return; /* depths come last */
  vec3 net = {0, 0, 0};
  double total = 0, of_depth = 0;
  for (size_t i = 0; i < contacts->count; i++) {
    const scree_contact_point *contact = &contacts->items[i];
    net = vec3_mad(net, contact->normal, contact->weight * contact->gap_gradient);
    total += contact->weight;
    if (contact->of_depth) of_depth += contact->weight;
  }
  bool held = (of_depth > 0 || jammed) && vec3_norm(net) < pinched_net * total;
  if (!held && !pressed) return;
  pair->depenetrating = true;
  if (of_depth == 0) pair->depth = -INFINITY;
}

/* How the two roll on each other: n, along which they press; b, how far from their centres that
 * acts, of both 1/b = 1/b_a + 1/b_b; of it what the spring knows; the sum of 1/I of both
 * bodies. */
typedef struct rolling_arm {
  vec3 n;
  double whole, felt, ease;
} rolling_arm;

/* Where the contacts press, in the mean. */
static vec3 centre_of_pressure(const scree_contact_list *contacts) {
  vec3 sum = {0, 0, 0};
  double total = 0;
  for (size_t i = 0; i < contacts->count; i++) {
    const scree_contact_point *contact = &contacts->items[i];
    if (!(contact->weight > 0)) continue;
    double weight = contact->weight * contact->gap_gradient;
    sum = vec3_mad(sum, contact->at, weight);
    total += weight;
  }
  return total > 0 ? vec3_scale(sum, 1 / total) : sum;
}

/* The sum of 1/I about three axes. */
static double ease_of_turning(vec3 inertia) {
  return 1 / inertia.x + 1 / inertia.y + 1 / inertia.z;
}

/* b is taken along n, not straight to the centres: that of a face on a plane does not change as
 * the pressure moves on it, and every body begins to roll on a slope steeper by mu_r. A body that
 * turns more easily than its arm is long has a softer spring, which steps resolve. */
static rolling_arm find_rolling_arm(const scree_world *world, const scree_pair *pair,
                                    const scree_scratch *scratch, vec3 n) {
  const scree_bodies *bodies = &world->bodies;
  const scree_frame *relative = &scratch->relative;
  const vec3 at = centre_of_pressure(&scratch->contacts);
  double of_a = fabs(vec3_dot(vec3_sub(relative->position, at), n)), arm = of_a,
         ease = ease_of_turning(bodies->inertia[pair->a]);
  if (!pair->wall) {
    double of_b = fabs(vec3_dot(at, n)), sum = of_a + of_b;
    arm = sum > 0 ? of_a * of_b / sum : 0;
    ease += ease_of_turning(bodies->inertia[pair->b]);
  }
  double most = sqrt(softest_rolling / (scree_reduced_mass(&pair->law) * ease)) / pair->law.rolling;
  return (rolling_arm){n, arm, scree_min(arm, most), ease};
}

/* The couple of rolling resistance (scree_roll), where the arm changes as the bodies turn: the
 * spring is kept as a way, b theta, so that its energy does not change by that. About n it resists
 * as friction on a patch as large as the couple moves the pressure, mu_r b: else a body that it
 * holds on a corner would spin there for ever. */
static void roll(const scree_world *world, scree_pair *pair, const slider *sliding,
                 const scree_scratch *scratch, double *energy, load_sums *sums) {
  if (!(pair->law.rolling > 0)) return;
  double size = vec3_norm(sums->normal.force), mu = pair->law.rolling;
  if (!(size > 0)) return;
  const rolling_arm arm =
      find_rolling_arm(world, pair, scratch, vec3_scale(sums->normal.force, 1 / size));
  const vec3 n = arm.n, spin = scratch->relative.spin,
             rolled = scree_stretched(pair->history.rolled, vec3_scale(spin, arm.felt), spin,
                                      sliding->touch.slid),
             twisted = vec3_scale(n, vec3_dot(rolled, n)),
             twists = vec3_scale(n, vec3_dot(sliding->spin, n));
  const double stiffness = scree_rolling_stiffness(pair) * mu * mu;
  scree_slider law = {.stiffness = stiffness,
                      .damping = sliding->touch.damped * 2 * rolling_damping_ratio *
                                 sqrt(rolls_about_contact * stiffness / arm.ease),
                      .friction = arm.felt < arm.whole ? mu * arm.whole / arm.felt : mu};
  scree_anchor across = {.weight = 1}, about = {.weight = 1};
  vec3 along = scree_resist_rolling(world->options.rolling == SCREE_ROLLING_EPSD, &law, &across, n,
                                    rolled, vec3_sub(sliding->spin, twists), sums->pressed, energy);
  law.friction *= pair->law.friction;
  along = vec3_add(
      along, scree_slide(&law, &about, 1, (vec3){0, 0, 0}, twisted, twists, sums->pressed, energy));
  pair->history.rolled = vec3_add(across.stretch, about.stretch);
  const vec3 couple = vec3_scale(along, arm.felt);
  sums->tangential.moment = vec3_add(sums->tangential.moment, couple);
  sums->tangential_power += vec3_dot(couple, spin);
}

static void store_wrenches(const scree_world *world, const scree_scratch *scratch, scree_pair *pair,
                           const load_sums *sums) {
  const scree_frame *a = scratch->a, *b = scratch->b;
  scree_wrench normal = turned(&sums->normal, &b->rotation);
  scree_wrench dashpot = turned(&sums->dashpot, &b->rotation);
  scree_wrench tangential = turned(&sums->tangential, &b->rotation);
  pair->book.dashpot = scree_kept(&dashpot);
  pair->book.tangential = scree_kept(&tangential);
  pair->contact.belt_power = (float)sums->belt_power;
  vec3 arm = scree_pair_between(world, pair, a, b);
  vec3 force = vec3_add(normal.force, tangential.force),
       moment = vec3_add(normal.moment, tangential.moment);
  pair->contact.wrench =
      (scree_pair_wrench){force, vec3_sub(moment, vec3_cross(arm, force)), vec3_neg(moment)};
}

/* Where the body came from, by what its features remember of the surface of b; 0: not known. */
static vec3 remembered_side(const scree_pair *pair, const scree_scratch *scratch) {
  vec3 sum = {0, 0, 0};
  for (uint32_t i = 0; i < pair->active.count; i++) {
    const scree_feature_pair *feature = &scratch->features[i];
    if (feature->kind == SCREE_FEATURE_POINT_FACE && feature->has_reference)
      sum = vec3_add(sum, feature->reference);
  }
  return vec3_unit(sum);
}

/* The way in which a body is moved out of a mesh wall: that of its seam's area, off a sheet over
 * its rims; but back to where it came from. A sheet has no outside, and of a body that pierces a
 * wall the areas where it enters and leaves cancel. */
static vec3 separation_from_wall(const scree_particle *a, const scree_particle *wall,
                                 const scree_frame *relative, vec3 came) {
  vec3 way = vec3_unit(scree_separation_direction(a, wall, relative));
  if (wall->sheet && vec3_dot(way, came) < 0) way = vec3_neg(way);
  return vec3_dot(way, came) < way_back_cosine * vec3_norm(came) ? came : way;
}

/* The way in which bodies part, kept in the frame of b until they are apart. */
static vec3 separation_of(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                          const scree_scratch *scratch) {
  if (vec3_norm2(pair->apart.direction) > 0) return pair->apart.direction;
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  vec3 way = vec3_unit(scree_separation_off_rims(world, pair, relative));
  if (vec3_norm2(way) == 0 && b->face_count)
    way = pair->wall ? separation_from_wall(a, b, relative, remembered_side(pair, scratch))
                     : vec3_unit(scree_separation_direction(a, b, relative));
  if (vec3_norm2(way) == 0) way = vec3_unit(relative->position);
  if (vec3_norm2(way) == 0) way = (vec3){0, 0, 1};
  return pair->apart.direction = way;
}

/* Where bodies that part are pushed. */
static vec3 place_of_push(const scree_world *world, const scree_pair *pair,
                          const scree_contact_list *contacts, const scree_frame *relative) {
  vec3 sum = {0, 0, 0};
  double total = 0;
  for (size_t i = 0; i < contacts->count; i++) {
    double weight = contacts->items[i].overlap + pair->law.smoothing;
    sum = vec3_mad(sum, contacts->items[i].at, weight);
    total += weight;
  }
  if (total > 0) return vec3_scale(sum, 1 / total);
  return scree_pair_smaller_is_a(world, pair) ? relative->position : (vec3){0, 0, 0};
}

/* With what force, along the way, all else pressed the bodies together in the last step: what is
 * held is not moved by less. */
static double held_with(const scree_world *world, const scree_pair *pair, vec3 way,
                        const scree_scratch *scratch) {
  vec3 out = mat3_mul_vec(&scratch->b->rotation, way);
  scree_wrench on_a = scree_wrench_of_others(world, pair, scratch, false),
               on_b = scree_wrench_of_others(world, pair, scratch, true);
  double of_a = vec3_dot(on_a.force, out), mass = world->bodies.mass[pair->a];
  if (pair->wall) return scree_max(0, -of_a);
  double of_b = vec3_dot(on_b.force, out), other = world->bodies.mass[pair->b];
  return scree_max(0, (of_b * mass - of_a * other) / (mass + other));
}

/* The pair remembers nothing of a contact. */
static void forget_contact(scree_pair *pair, scree_contact_list *contacts) {
  for (size_t i = 0; i < contacts->count; i++) contacts->items[i].anchor->weight = 0;
  pair->history.largest = 0;
  pair->book.spring = (scree_wrench){{0, 0, 0}, {0, 0, 0}};
  pair->history.rolled = (vec3){0, 0, 0};
}

/* Edges that lie in each other may each be nearest to a separation direction that is the other's
 * way in. Then no feature counts: the bodies are brought to the speed of those that part along one
 * way, by no more than a spring as deep as they are, or at its limit, would press with: what lies
 * behind must bear it too. */
static scree_powers part(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                         scree_scratch *scratch) {
  scree_contact_list *contacts = &scratch->contacts; /* with room for more than one */
  forget_contact(pair, contacts);
  if (scratch->found.question.edges)
    pair->apart.place = place_of_push(world, pair, contacts, relative);
  vec3 at = pair->apart.place, way = separation_of(world, pair, relative, scratch),
       arm = vec3_cross(at, way);
  pair->touching = true;
  pair->contact.count = 1;
  pair->history.age += scratch->drift;
  pair->contact.overlap = scree_max(0, pair->depth + pair->law.reach);
  slider law = make_slider(world, pair, relative, scratch->drift);
  vec3 seen = vec3_add(law.velocity, vec3_cross(law.spin, at)),
       v = vec3_add(relative->velocity, vec3_cross(relative->spin, at));
  double brake = depenetration_damping * scree_reduced_mass(&pair->law) / world->time_step *
                 (scree_depenetration_speed(&pair->law) - vec3_dot(seen, way)),
         push = scree_max(0, brake + held_with(world, pair, way, scratch)),
         most = pair->law.stiffness * scree_min(pair->contact.overlap, pair->law.limit),
         force = scree_min(most, push);
  load_sums sums = {0};
  add_wrench(&sums.normal, way, arm, force);
  sums.dashpot = sums.normal;
  contacts->items[0] = (scree_contact_point){.at = at,
                                             .normal = way,
                                             .overlap = pair->contact.overlap,
                                             .taper = 1,
                                             .weight = 1,
                                             .gap_gradient = 1,
                                             .force = vec3_scale(way, force)};
  contacts->count = 1; /* who looks at the contacts sees the push */
  store_wrenches(world, scratch, pair, &sums);
  return (scree_powers){force * vec3_dot(v, way), 0};
}

/* The spring's force. */
static double press(const scree_world *world, scree_pair *pair, const overlap_slope *slope,
                    const scree_scratch *scratch, scree_touch_time *touch) {
  const scree_frame *relative = &scratch->relative;
  if (scree_is_settled(pair, scree_lasting(pair))) {
    pair->book.spring = (scree_wrench){{0, 0, 0}, {0, 0, 0}};
    *touch = (scree_touch_time){1, scratch->drift, false};
    return scree_press_settled(world->options.law == SCREE_LAW_HYSTERETIC, pair);
  }
  const scree_wrench all = {vec3_add(slope->whole.force, slope->fading.force),
                            vec3_add(slope->whole.moment, slope->fading.moment)};
  scree_overlap_motion motion = scree_overlap_moves(
      world, pair, scratch, -along_motion(&all, relative->velocity, relative->spin),
      -along_motion(&all, relative->velocity_now, relative->spin_now));
  if (scree_is_edge_of_touch(pair, &motion))
    motion.inverse = inverse_mass(world, pair, relative, &all);
  *touch = scree_touch_time_of(pair, &motion);
  const double spring = scree_press_moving(pair, &motion);
  const scree_wrench pressed = {vec3_scale(all.force, spring), vec3_scale(all.moment, spring)};
  pair->book.spring = turned(&pressed, &scratch->b->rotation);
  return spring;
}

/* By how much less overlap the smooth maximum of all would be 0, where sum taper (overlap + l)^2 is
 * l^2 (overlap.c): several that touch press earlier than each by itself. */
static double slack_of(double l, const scree_contact_list *contacts) {
  double low = 0, high = 0;
  for (size_t i = 0; i < contacts->count; i++) {
    const scree_contact_point *c = &contacts->items[i];
    high = scree_max(high, c->overlap + l);
    if (c->taper > 0) low = scree_max(low, c->overlap + l - l / sqrt(c->taper));
  }
  for (int k = 0; k < EASE_ROUNDS; k++) {
    double middle = 0.5 * (low + high), sum = 0;
    for (size_t i = 0; i < contacts->count; i++) {
      double above = scree_max(0, contacts->items[i].overlap + l - middle);
      sum += contacts->items[i].taper * above * above;
    }
    if (sum > l * l)
      low = middle;
    else
      high = middle;
  }
  return high;
}

/* Two that were joined begin from how deep they lie in each other where they come apart. */
static void ease(scree_pair *pair, scree_contact_list *contacts) {
  size_t kept = 0;
  pair->list.eased = scree_min(pair->list.eased, slack_of(pair->law.smoothing, contacts));
  for (size_t i = 0; i < contacts->count; i++) {
    scree_contact_point *contact = &contacts->items[i];
    contact->overlap -= pair->list.eased;
    if (contact->overlap > -pair->law.smoothing)
      contacts->items[kept++] = *contact;
    else
      contact->anchor->weight = 0;
  }
  contacts->count = kept;
}

scree_powers scree_pair_apply_law(const scree_world *world, scree_pair *pair,
                                  const scree_frame *relative, scree_scratch *scratch) {
  scree_contact_list *contacts = &scratch->contacts;
  scree_smooth_maximum maximum;
  if (pair->depenetrating) return part(world, pair, relative, scratch);
  if (pair->list.eased > 0) ease(pair, contacts);
  if (contacts->count == 0 ||
      !scree_find_smooth_maximum(&pair->law, world->options.sharing, contacts, &maximum)) {
    forget_contact(pair, contacts);
    pair->history.age = 0;
    return (scree_powers){0, 0};
  }
  pair->touching = true;
  pair->history.age += scratch->drift;
  pair->contact.overlap = maximum.value;
  overlap_slope slope = find_slope(world, pair, &maximum, scratch);
  scree_touch_time touch;
  double spring = press(world, pair, &slope, scratch, &touch), energy = 0;
  slider law = make_slider(world, pair, relative, scratch->drift);
  law.touch = touch;
  law.normal_damping = touch.damped * damping_at(world, pair, relative, &slope);
  load_sums sums;
  sums.normal = sums.dashpot = sums.tangential = (scree_wrench){{0, 0, 0}, {0, 0, 0}};
  sums.dashpot_power = sums.tangential_power = sums.belt_power = sums.pressed = 0;
  uint32_t count = 0;
  for (size_t i = 0; i < contacts->count; i++) {
    scree_contact_point *contact = &contacts->items[i];
    if (contact->weight > 0) {
      contact_force(pair, &law, spring, contact, relative, &energy, &sums);
      if (contact->fading.x != 0 || contact->fading.y != 0 || contact->fading.z != 0)
        fade(spring, contact, &sums);
      count++;
    } else {
      contact->anchor->weight = 0;
    }
  }
  judge(world, pair, contacts);
  roll(world, pair, &law, scratch, &energy, &sums);
  pair->contact.count = count;
  pair->contact.tangential_elastic = energy;
  pair->contact.elastic += energy;
  store_wrenches(world, scratch, pair, &sums);
  return (scree_powers){sums.dashpot_power, sums.tangential_power};
}
