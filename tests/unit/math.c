/* Our elementary functions against the C library's in long double, and where they are exact. */
#include "base/math.h"

#include "base/rng.h"
#include "support/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ARGUMENTS = 200000 };

static bool same_bits(double a, double b) {
  uint64_t p, q;
  memcpy(&p, &a, sizeof p);
  memcpy(&q, &b, sizeof q);
  return p == q || (isnan(a) && isnan(b));
}

/* In units in the last place of the true value. */
static double ulps(double got, long double want) {
  double near = (double)want, unit = nextafter(fabs(near), INFINITY) - fabs(near);
  return (double)fabsl((long double)got - want) / unit;
}

/* Of either sign, spread over its logarithm. */
static double spread(scree_rng *rng, double low, double high) {
  double u = scree_rng_uniform(rng), size = pow(low, 1 - u) * pow(high, u);
  return scree_rng_below(rng, 2) ? size : -size;
}

static void within_an_ulp(void **state) {
  (void)state;
  scree_rng rng = {.seed = 5};
  double worst[7] = {0};
  for (int i = 0; i < ARGUMENTS; i++) {
    double x = spread(&rng, 1e-9, i % 2 ? 1e6 : 10), y = spread(&rng, 1e-9, 1e9),
           share = 2 * scree_rng_uniform(&rng) - 1, e = spread(&rng, 1e-9, 700),
           size = fabs(spread(&rng, 1e-300, 1e300));
    worst[0] = fmax(worst[0], ulps(scree_sin(x), sinl(x)));
    worst[1] = fmax(worst[1], ulps(scree_cos(x), cosl(x)));
    worst[2] = fmax(worst[2], ulps(scree_atan2(y, x), atan2l(y, x)));
    worst[3] = fmax(worst[3], ulps(scree_acos(share), acosl(share)));
    worst[4] = fmax(worst[4], ulps(scree_exp(e), expl(e)));
    worst[5] = fmax(worst[5], ulps(scree_log(i % 2 ? size : 1 + 0.5 * share),
                                   logl(i % 2 ? size : 1 + 0.5 * share)));
    worst[6] = fmax(worst[6], ulps(scree_cbrt(size), cbrtl(size)));
  }
  const double most[7] = {1, 1, 1.5, 2, 1, 1, 1};
  for (int k = 0; k < 7; k++) {
    print_message("%d: %.3f ulp\n", k, worst[k]);
    assert_true(worst[k] <= most[k]);
  }
}

static void exact_cases(void **state) {
  (void)state;
  static const double edges[] = {0, -0.0, 1, -1, INFINITY, -INFINITY, NAN, 5e-324, -5e-324, 1e300};
  enum { EDGES = sizeof edges / sizeof *edges };
  for (int i = 0; i < EDGES; i++) {
    for (int k = 0; k < EDGES; k++)
      assert_true(same_bits(scree_atan2(edges[i], edges[k]), atan2(edges[i], edges[k])));
    assert_true(same_bits(scree_log(edges[i]), log(edges[i])));
    bool small = !(fabs(edges[i]) >= 1);
    assert_true(fabs(edges[i]) == 1 || same_bits(scree_exp(edges[i]), exp(edges[i])));
    assert_true(!small || same_bits(scree_sin(edges[i]), sin(edges[i])));
    assert_true(!small || same_bits(scree_cos(edges[i]), cos(edges[i])));
  }
  assert_true(isnan(scree_sin(INFINITY)) && isnan(scree_cos(-INFINITY)) && isnan(scree_acos(1.5)));
  assert_true(scree_acos(1) == 0 && scree_acos(-1) == acos(-1) && scree_cbrt(-27) == -3);
  assert_true(scree_exp(710) == INFINITY && scree_exp(-746) == 0 && scree_exp(-740) == exp(-740));
  for (double x = 1e7; x < 1e300; x *= 1e7) {
    double sine = scree_sin(x), cosine = scree_cos(x);
    assert_true(fabs(sine * sine + cosine * cosine - 1) < 1e-14);
    assert_true(same_bits(scree_sin(-x), -sine) && same_bits(scree_cos(-x), cosine));
  }
}

/* The first of two equal ones; a number rather than NaN. */
static void least_and_most(void **state) {
  (void)state;
  assert_true(same_bits(scree_min(0.0, -0.0), 0.0) && same_bits(scree_max(0.0, -0.0), 0.0));
  assert_true(same_bits(scree_min(-0.0, 0.0), -0.0) && same_bits(scree_max(-0.0, 0.0), -0.0));
  assert_true(scree_min(1, 2) == 1 && scree_max(1, 2) == 2);
  assert_true(scree_min(2, 1) == 1 && scree_max(2, 1) == 2);
  assert_true(scree_min(NAN, 1) == 1 && scree_min(1, NAN) == 1);
  assert_true(scree_max(NAN, 1) == 1 && scree_max(1, NAN) == 1);
  assert_true(isnan(scree_max(NAN, NAN)));
}

static void powers_of_ten(void **state) {
  (void)state;
  scree_rng rng = {.seed = 6};
  double worst = 0;
  for (int i = 0; i < ARGUMENTS; i++) {
    double x = 44 * scree_rng_uniform(&rng) - 22;
    worst = fmax(worst, ulps(scree_power_of_ten(x), powl(10, x)));
  }
  assert_true(worst < 0.5001);
  for (int i = 0; i < ARGUMENTS; i++) {
    double x = fabs(spread(&rng, 1e-20, 1e20));
    assert_true(ulps(scree_log10(x), log10l(x)) < 2);
  }
  for (int n = -22; n <= 22; n++) {
    char text[8];
    snprintf(text, sizeof text, "1e%d", n);
    assert_true(same_bits(scree_power_of_ten(n), strtod(text, NULL)));
    assert_true(scree_log10(strtod(text, NULL)) == n);
  }
  assert_true(isnan(scree_power_of_ten(NAN)));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(within_an_ulp), cmocka_unit_test(exact_cases),
                                     cmocka_unit_test(least_and_most),
                                     cmocka_unit_test(powers_of_ten)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
