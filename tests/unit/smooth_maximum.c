/* The smooth maximum in closed form against bisection, and closest points of segments against a
 * search. */
#include "support/check.h"

#include "base/rng.h"
#include "particle/closest.h"
#include "world/contact/overlap.h"

/* sum w (o - t)+^2 - l^2 at t. */
static double equation(const scree_contact_point *contacts, size_t count, double l0, double kappa,
                       double t) {
  double l = l0 + kappa * (t + l0) / (1 - kappa), sum = -l * l;
  for (size_t i = 0; i < count; i++) {
    double above = fmax(0, contacts[i].overlap - t);
    sum += contacts[i].taper * above * above;
  }
  return sum;
}

/* The root between -l0 and the highest overlap; false where the pair does not touch. */
static bool bisect(const scree_contact_point *contacts, size_t count, double l0, double kappa,
                   double *t) {
  double low = -l0, high = -l0;
  for (size_t i = 0; i < count; i++) high = fmax(high, contacts[i].overlap);
  if (!(equation(contacts, count, l0, kappa, low) > 0)) return false;
  for (int i = 0; i < 200; i++) {
    double middle = 0.5 * (low + high);
    if (equation(contacts, count, l0, kappa, middle) > 0)
      low = middle;
    else
      high = middle;
  }
  *t = 0.5 * (low + high);
  return true;
}

static double power_between(scree_rng *rng, double low, double high) {
  return low * pow(high / low, scree_rng_uniform(rng));
}

static void closed_form(void **state) {
  (void)state;
  scree_rng rng = {.seed = 5, .stream = 1};
  const double l0 = 2e-6;
  size_t touching = 0;
  for (int trial = 0; trial < 20000; trial++) {
    scree_contact_point contacts[24] = {0};
    size_t count = 1 + scree_rng_below(&rng, trial % 3 ? 5 : 24);
    double kappa = 0.05 * (double)scree_rng_below(&rng, 8), depth = power_between(&rng, 1e-8, 1e-3);
    for (size_t i = 0; i < count; i++) {
      contacts[i].overlap = trial % 2 ? depth * (1 - 1e-3 * scree_rng_uniform(&rng))
                                      : depth * scree_rng_uniform(&rng) - l0;
      contacts[i].taper = trial % 5 ? 1 : power_between(&rng, 1e-9, 1);
    }
    double t, sum = 0;
    scree_smooth_maximum got;
    bool expected = bisect(contacts, count, l0, kappa, &t);
    assert_int_equal(scree_solve_smooth_maximum(contacts, count, l0, kappa, &got), expected);
    if (!expected) continue;
    touching++;
    double m = (t + l0) / (1 - kappa), scale = depth + l0;
    for (size_t i = 0; i < count; i++) sum += contacts[i].taper * fmax(0, contacts[i].overlap - t);
    assert_true(fabs(got.cutoff - t) < 1e-13 * scale);
    assert_true(fabs(got.value - m) < 1e-13 * scale);
    double denominator = sum * (1 - kappa) + kappa * (l0 + kappa * m);
    assert_true(fabs(got.denominator - denominator) < 1e-12 * denominator + 1e-13 * scale);
  }
  assert_true(touching > 10000);
}

static vec3 random_point(scree_rng *rng) {
  return (vec3){scree_rng_uniform(rng), scree_rng_uniform(rng), scree_rng_uniform(rng)};
}

/* Least distance from p + s u to a segment. */
static double distance_to(vec3 point, vec3 q, vec3 v, double length) {
  double t = fmin(fmax(vec3_dot(vec3_sub(point, q), v), 0), length);
  return vec3_distance(point, vec3_mad(q, v, t));
}

static void segments(void **state) {
  (void)state;
  scree_rng rng = {.seed = 6, .stream = 1};
  for (int trial = 0; trial < 20000; trial++) {
    vec3 p = random_point(&rng), q = random_point(&rng),
         u = vec3_unit(vec3_sub(random_point(&rng), p)),
         v = trial % 4 ? vec3_unit(vec3_sub(random_point(&rng), q)) : u;
    double lp = power_between(&rng, 1e-3, 1), lq = power_between(&rng, 1e-3, 1), s, t;
    scree_closest_on_segments(p, u, lp, q, v, lq, &s, &t);
    assert_true(s >= 0 && s <= lp && t >= 0 && t <= lq);
    double got = vec3_distance(vec3_mad(p, u, s), vec3_mad(q, v, t));
    /* the distance to a segment is convex along a line: ternary search */
    double low = 0, high = lp;
    for (int i = 0; i < 100; i++) {
      double a = low + (high - low) / 3, b = high - (high - low) / 3;
      if (distance_to(vec3_mad(p, u, a), q, v, lq) < distance_to(vec3_mad(p, u, b), q, v, lq))
        high = b;
      else
        low = a;
    }
    assert_true(fabs(got - distance_to(vec3_mad(p, u, low), q, v, lq)) < 1e-9);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(closed_form), cmocka_unit_test(segments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
