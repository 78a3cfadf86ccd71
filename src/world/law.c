/* The contact law of a pair: anchored smooth maximum (docs/physics.md, "One spring").
 *
 * The pair's overlap m is a smooth maximum of its features' overlaps o_i, with a width l that grows
 * with the overlap, l = l0 + kappa m: m = (t + l0)/(1 - kappa), where t solves
 *   sum_i w_i (o_i - t)+^2 = l^2.
 * One feature gives m = o; n equal ones at most (o + l0)/(1 - kappa). U = K m^2/2 is the energy and
 * s_i = dm/do_i = w_i (o_i - t)+ / (S (1 - kappa) + kappa l), S = sum w_i (o_i - t)+, the shares:
 *   f_i = max(0, s_i (K m + C do_i/dt)).
 * Tangentially each feature has a spring K_t s_i stretched by xi_i, which turns with b, follows the
 * sliding, and is shortened to the Coulomb limit; when the share grows the force stays (xi s is
 * kept), so that energy is only ever lost.
 * Hysteretic: F = K m on first loading, K/e^2 (m - m0) below the largest m, m0 = (1 - e^2) max m.
 */
#include "world/world.h"

enum { NEWTON_STEPS = 30 };

typedef struct smooth_maximum {
  double value, cutoff, denominator; /* m, t, S (1 - kappa) + kappa l */
} smooth_maximum;

/* False when the pair does not touch. Newton from below the root, where the function is positive,
 * falling and convex: every step stays on that side. */
static bool solve(const scree_touch *touches, size_t count, double l0, double kappa,
                  smooth_maximum *result) {
  double highest = -l0, weight = 1, at_zero = 0;
  for (size_t i = 0; i < count; i++) {
    double o = touches[i].overlap, above = o + l0;
    at_zero += touches[i].weight * above * above;
    if (o > highest) highest = o, weight = touches[i].weight;
  }
  if (!(at_zero > l0 * l0)) return false;
  double k = kappa / (1 - kappa);
  double t = highest - (l0 + k * (highest + l0)) / sqrt(weight);
  if (t < -l0) t = -l0;
  double sum = 0;
  for (int step = 0; step < NEWTON_STEPS; step++) {
    double square = 0, l = l0 + k * (t + l0);
    sum = 0;
    for (size_t i = 0; i < count; i++) {
      double above = touches[i].overlap - t;
      if (above <= 0) continue;
      double weighted = touches[i].weight * above;
      sum += weighted;
      square += weighted * above;
    }
    double change = (square - l * l) / (2 * (sum + l * k));
    t += change;
    if (!(fabs(change) > 1e-15 * (l + fabs(t)))) break;
  }
  double m = (t + l0) / (1 - kappa), l = l0 + kappa * m;
  *result = (smooth_maximum){m, t, sum * (1 - kappa) + kappa * l};
  return m > 0;
}

static void solve_one(const scree_touch *touch, double l0, double kappa, smooth_maximum *result) {
  double l = l0 + kappa * touch->overlap;
  *result = (smooth_maximum){touch->overlap, touch->overlap - l, l};
}

static bool find_overlap(const scree_world *world, const scree_pair *pair,
                         const scree_touch_list *touches, smooth_maximum *result) {
  if (touches->count == 1 && touches->items[0].weight == 1) {
    if (!(touches->items[0].overlap > 0)) return false;
    solve_one(&touches->items[0], pair->smoothing, world->options.sharing, result);
    return true;
  }
  return solve(touches->items, touches->count, pair->smoothing, world->options.sharing, result);
}

/* The spring's force at overlap m, and the energy that comes back from it. */
static double spring_force(const scree_world *world, scree_pair *pair, double m) {
  if (world->options.law == SCREE_LAW_LINEAR) {
    pair->elastic = 0.5 * pair->stiffness * m * m;
    return pair->stiffness * m;
  }
  double e2 = pair->restitution * pair->restitution, unloading = pair->stiffness / e2;
  pair->largest = fmax(pair->largest, m);
  double force = fmax(0, fmin(pair->stiffness * m, unloading * (m - (1 - e2) * pair->largest)));
  pair->elastic = 0.5 * force * force / unloading;
  return force;
}

/* How far the contact is no impact any more, from 0 to 1: the tangential dashpot. An oblique impact
 * follows the spring and slider alone; what rests on each other is calmed. */
static double lasting(const scree_pair *pair) {
  double age = pair->age / pair->contact_time;
  return age < 1.5 ? 0 : age > 3 ? 1 : (age - 1.5) / 1.5;
}

/* Stretches the spring by the last drift, and answers the tangential force. */
static vec3 slide(const scree_world *world, const scree_pair *pair, scree_touch *touch,
                  double normal_force, double *energy) {
  scree_anchor *anchor = touch->anchor;
  double ratio = world->options.tangential_ratio, s = touch->share;
  vec3 n = touch->normal;
  vec3 v = vec3_mad(touch->velocity, n, -vec3_dot(touch->velocity, n));
  vec3 xi = {0, 0, 0};
  if (anchor->share > 0) {
    xi = vec3_mad(anchor->stretch, v, world->time_step);
    xi = vec3_mad(xi, n, -vec3_dot(xi, n));
    if (s > anchor->share) xi = vec3_scale(xi, anchor->share / s);
  }
  double k = pair->stiffness * ratio * s, c = lasting(pair) * pair->damping * sqrt(ratio) * s;
  double most = pair->friction * normal_force, stretch = vec3_norm(xi);
  if (k * stretch > most) xi = vec3_scale(xi, most / (k * stretch));
  vec3 force = vec3_mad(vec3_scale(xi, -k), v, -c);
  double size = vec3_norm(force);
  if (size > most) force = vec3_scale(force, most / size);
  anchor->stretch = xi;
  *energy += 0.5 * k * vec3_norm2(xi);
  return force;
}

static void add_force(scree_wrench *sum, vec3 at, vec3 force) {
  sum->force = vec3_add(sum->force, force);
  sum->torque_b = vec3_add(sum->torque_b, vec3_cross(at, force));
}

/* From sums about the origin of b, in its frame, to wrenches about both centres in space. */
static void finish(scree_wrench *sum, const scree_frame *relative, const mat3 *rotation_b) {
  vec3 about_a = vec3_sub(sum->torque_b, vec3_cross(relative->position, sum->force));
  sum->force = mat3_mul_vec(rotation_b, sum->force);
  sum->torque_a = mat3_mul_vec(rotation_b, about_a);
  sum->torque_b = vec3_neg(mat3_mul_vec(rotation_b, sum->torque_b));
}

void scree_pair_apply_law(const scree_world *world, scree_pair *pair, scree_touch_list *touches,
                          const scree_frame *relative) {
  smooth_maximum maximum;
  if (touches->count == 0 || !find_overlap(world, pair, touches, &maximum)) {
    for (size_t i = 0; i < touches->count; i++) touches->items[i].anchor->share = 0;
    pair->largest = pair->age = 0;
    return;
  }
  pair->touching = true;
  pair->age += world->time_step;
  pair->overlap = maximum.value;
  double spring = spring_force(world, pair, maximum.value);
  scree_wrench sum = {0}, dashpot = {0}, tangential = {0};
  for (size_t i = 0; i < touches->count; i++) {
    scree_touch *touch = &touches->items[i];
    double above = touch->overlap - maximum.cutoff;
    touch->share = above > 0 ? touch->weight * above / maximum.denominator : 0;
    if (touch->share <= 0) {
      touch->anchor->share = 0;
      continue;
    }
    touch->velocity = vec3_add(relative->velocity, vec3_cross(relative->spin, touch->at));
    vec3 now = vec3_add(relative->velocity_now, vec3_cross(relative->spin_now, touch->at));
    touch->rate = -vec3_dot(now, touch->normal);
    double elastic = touch->share * spring;
    double normal = fmax(0, elastic + touch->share * pair->damping * touch->rate);
    vec3 along = slide(world, pair, touch, normal, &pair->tangential_elastic);
    touch->force = vec3_mad(along, touch->normal, normal);
    touch->anchor->normal = touch->normal;
    touch->anchor->share = touch->share;
    pair->contact_count++;
    add_force(&sum, touch->at, touch->force);
    add_force(&dashpot, touch->at, vec3_scale(touch->normal, normal - elastic));
    add_force(&tangential, touch->at, along);
  }
  const mat3 *rotation_b = &scree_pair_frame_b(world, pair)->rotation;
  finish(&sum, relative, rotation_b);
  finish(&dashpot, relative, rotation_b);
  finish(&tangential, relative, rotation_b);
  pair->elastic += pair->tangential_elastic;
  pair->wrench = sum;
  pair->dashpot = dashpot;
  pair->tangential = tangential;
}
