#include "base/rng.h"
#include "scree.h"
#include "study/special.h"
#include "study/study.h"
#include "support/check.h"

#define RELATIVE(got, expected, tolerance) CHECK_NEAR(got, expected, (tolerance)*fabs(expected))

/* t by mpmath in 30 digits (scipy 1.10 has its ppf to 1e-9 only), chi-square by scipy. */
static void quantiles_as_published(void **state) {
  (void)state;
  static const double t[][3] = {{0.975, 9, 2.2621571627982055},   {0.95, 4, 2.1318467863266503},
                                {0.995, 2.5, 7.1637281389487855}, {0.025, 1, -12.706204736174705},
                                {0.9, 100, 1.290074761346516},    {1e-6, 3, -103.29946778041934}};
  static const double c[][3] = {{0.025, 9, 2.7003894999803584},   {0.975, 9, 19.02276779864163},
                                {0.5, 1, 0.454936423119572},      {0.99, 30, 50.89218131151707},
                                {0.001, 2, 0.002001000667167068}, {0.95, 100, 124.34211340400407}};
  for (int i = 0; i < 6; i++) {
    RELATIVE(scree_student_quantile(t[i][0], t[i][1]), t[i][2], 1e-12);
    RELATIVE(scree_chi_square_quantile(c[i][0], c[i][1]), c[i][2], 1e-11);
  }
  CHECK_NEAR(scree_student_cdf(0.1, 3), 0.5366738255995971, 1e-14);
  CHECK_NEAR(scree_student_cdf(2.5, 7.3), 0.9801748826671998, 1e-14);
  RELATIVE(scree_student_cdf(-30, 2), 0.0005546313409798294, 1e-12);
}

/* t with 1 and 2 degrees and chi-square with 2 have closed forms. */
static void distributions_have_their_closed_forms(void **state) {
  (void)state;
  scree_rng rng = {3, 0, 0};
  for (int i = 0; i < 2000; i++) {
    double t = 10 * scree_rng_normal(&rng), x = 30 * scree_rng_uniform(&rng);
    CHECK_NEAR(scree_student_cdf(t, 1), 0.5 + atan(t) / acos(-1), 1e-14);
    CHECK_NEAR(scree_student_cdf(t, 2), 0.5 + t / (2 * sqrt(2 + t * t)), 1e-14);
    CHECK_NEAR(scree_chi_square_cdf(x, 2), -expm1(-x / 2), 1e-14);
    CHECK_NEAR(scree_chi_square_cdf(x * x, 1), erf(x / sqrt(2)), 1e-13);
  }
}

/* Simpson's rule on the density. */
static double student_by_integration(double t, double degrees) {
  enum { STEPS = 20000 };
  double front =
             exp(lgamma(0.5 * (degrees + 1)) - lgamma(0.5 * degrees)) / sqrt(degrees * acos(-1)),
         sum = 0;
  for (int i = 0; i <= STEPS; i++) {
    double x = t * i / STEPS;
    sum += (i == 0 || i == STEPS ? 1
            : i % 2              ? 4
                                 : 2) *
           pow(1 + x * x / degrees, -0.5 * (degrees + 1));
  }
  return 0.5 + front * sum * t / STEPS / 3;
}

static void student_is_the_integral_of_its_density(void **state) {
  (void)state;
  scree_rng rng = {4, 0, 0};
  for (int i = 0; i < 100; i++) {
    double degrees = 0.5 + 40 * scree_rng_uniform(&rng), t = 6 * scree_rng_uniform(&rng) - 3;
    CHECK_NEAR(scree_student_cdf(t, degrees), student_by_integration(t, degrees), 1e-11);
    double p = scree_rng_uniform(&rng);
    CHECK_NEAR(scree_student_cdf(scree_student_quantile(p, degrees), degrees), p, 1e-13);
    CHECK_NEAR(scree_chi_square_cdf(scree_chi_square_quantile(p, degrees), degrees), p, 1e-12);
  }
}

static const double a_values[] = {24.1, 25.3, 23.8, 26.0, 24.9},
                    b_values[] = {25.2, 24.6, 26.1, 25.5};

/* numpy and scipy: mean, std(ddof=1), t.interval, chi2, ttest_ind(equal_var=False). */
static void summary_and_comparison_as_by_scipy(void **state) {
  (void)state;
  scree_summary a = scree_summarise(a_values, 5, 0.95), b = scree_summarise(b_values, 4, 0.95);
  CHECK_NEAR(a.mean, 24.82, 1e-12);
  CHECK_NEAR(a.sd, 0.8927485648266253, 1e-12);
  CHECK_NEAR(a.cv, 0.8927485648266253 / 24.82, 1e-13);
  CHECK_NEAR(a.mean_low, 23.7115062476067, 1e-10);
  CHECK_NEAR(a.mean_high, 25.9284937523933, 1e-10);
  CHECK_NEAR(a.sd_low, 0.5348752501020752, 1e-10);
  CHECK_NEAR(a.sd_high, 2.5653626682727935, 1e-10);
  scree_comparison c = scree_compare(&a, &b, 2, 0.05);
  CHECK_NEAR(c.degrees, 6.931910419668854, 1e-9);
  CHECK_NEAR(c.low, -1.49169391, 1e-8);
  CHECK_NEAR(c.high, 0.43169391, 1e-8);
  CHECK_NEAR(c.p_difference, 0.3308009938270015, 1e-10);
  CHECK_NEAR(c.p_equivalence, 0.011613607078395675, 1e-10);
  assert_true(c.equivalent && !c.different);
  assert_int_equal(c.count_needed, 3);
  c = scree_compare(&a, &b, 1, 0.05);
  assert_true(!c.equivalent && !c.different);
  assert_true(c.count_needed > 5);
  c = scree_compare(&a, &b, 0.5, 0.05);
  assert_int_equal(c.count_needed, 0);
}

static void what_is_too_few_is_not_a_number(void **state) {
  (void)state;
  const double one[] = {NAN, 3, NAN}, same[] = {4, 4};
  scree_summary none = scree_summarise(one, 1, 0.95), s = scree_summarise(one, 3, 0.95);
  assert_int_equal(none.count, 0);
  assert_true(isnan(none.mean));
  assert_int_equal(s.count, 1);
  assert_true(s.mean == 3 && isnan(s.sd) && isnan(s.mean_low));
  scree_summary exact = scree_summarise(same, 2, 0.95);
  scree_comparison c = scree_compare(&s, &exact, 1, 0.05);
  assert_true(isnan(c.low) && !c.equivalent && !c.different);
  c = scree_compare(&exact, &exact, 1, 0.05);
  assert_true(c.equivalent && c.difference == 0 && c.low == 0);
}

/* How often does the interval hold the truth, and how often is a difference at the margin called
 * equivalent? Both are promised: 95 % and 5 %. */
static void promises_hold_on_random_data(void **state) {
  (void)state;
  enum { TRIALS = 4000, REPLICATES = 5 };
  scree_rng rng = {5, 0, 0};
  int covered = 0, sd_covered = 0, false_equivalent = 0, false_different = 0;
  for (int trial = 0; trial < TRIALS; trial++) {
    double x[REPLICATES], y[REPLICATES], z[REPLICATES];
    for (int i = 0; i < REPLICATES; i++) {
      x[i] = 20 + 1.5 * scree_rng_normal(&rng);
      y[i] = 24 + 1.5 * scree_rng_normal(&rng); /* exactly at the margin of 4 */
      z[i] = 20 + 1.5 * scree_rng_normal(&rng);
    }
    scree_summary s = scree_summarise(x, REPLICATES, 0.95),
                  t = scree_summarise(y, REPLICATES, 0.95),
                  u = scree_summarise(z, REPLICATES, 0.95);
    covered += s.mean_low <= 20 && 20 <= s.mean_high;
    sd_covered += s.sd_low <= 1.5 && 1.5 <= s.sd_high;
    false_equivalent += scree_compare(&s, &t, 4, 0.05).equivalent;
    false_different += scree_compare(&s, &u, 0.01, 0.05).different;
  }
  CHECK_NEAR(covered, 0.95 * TRIALS, 60);
  CHECK_NEAR(sd_covered, 0.95 * TRIALS, 60);
  CHECK_NEAR(false_equivalent, 0.05 * TRIALS, 60);
  CHECK_NEAR(false_different, 0.05 * TRIALS, 70);
}

static const double x_values[] = {1e-5, 1e-4, 5e-4, 1e-3, 2e-3, 1e-3},
                    y_values[] = {12, 19, 44, 60, 103, 64};

/* scipy.stats.linregress on logarithms; numpy Polynomial.fit. */
static void fits_as_by_scipy(void **state) {
  (void)state;
  scree_power_law law;
  scree_polynomial p;
  scree_error error;
  CHECK_OK(scree_fit_power(x_values, y_values, 6, 0.95, &law, &error), error);
  CHECK_NEAR(law.exponent, 0.40023428953015744, 1e-12);
  RELATIVE(law.factor, 1001.3348746718813, 1e-10);
  CHECK_NEAR(law.r2, 0.9495451660431081, 1e-12);
  CHECK_NEAR(law.exponent_low, 0.27215852, 1e-8);
  CHECK_NEAR(law.exponent_high, 0.52831006, 1e-8);
  CHECK_OK(scree_fit_polynomial(x_values, y_values, 6, 4, &p, &error), error);
  static const double expected[] = {11.194061258790526, 80865.55312338307, -27060805.279529136,
                                    -10787374906.845655, 7788565804208.26};
  for (int k = 0; k < 5; k++) RELATIVE(p.coefficient[k], expected[k], 1e-8);
  CHECK_NEAR(scree_polynomial_value(&p, 1e-3), 62, 1e-8); /* between the two values there */
  CHECK_NEAR(p.rms, sqrt(8.0 / 6), 1e-8);
}

static void fits_recover_what_was_put_in(void **state) {
  (void)state;
  scree_rng rng = {6, 0, 0};
  for (int trial = 0; trial < 500; trial++) {
    double x[12], y[12], z[12], c[5], exponent = scree_rng_normal(&rng),
                                      factor = exp(scree_rng_normal(&rng));
    for (int k = 0; k < 5; k++) c[k] = scree_rng_normal(&rng);
    for (int i = 0; i < 12; i++) {
      x[i] = 0.05 + scree_rng_uniform(&rng);
      y[i] = factor * pow(x[i], exponent);
      z[i] = c[0] + x[i] * (c[1] + x[i] * (c[2] + x[i] * (c[3] + x[i] * c[4])));
    }
    scree_power_law law;
    scree_polynomial p;
    scree_error error;
    CHECK_OK(scree_fit_power(x, y, 12, 0.95, &law, &error), error);
    CHECK_NEAR(law.exponent, exponent, 1e-12);
    RELATIVE(law.factor, factor, 1e-12);
    CHECK_OK(scree_fit_polynomial(x, z, 12, 4, &p, &error), error);
    for (int i = 0; i < 12; i++) CHECK_NEAR(scree_polynomial_value(&p, x[i]), z[i], 1e-11);
  }
}

static void fits_of_too_little_are_refused(void **state) {
  (void)state;
  const double x[] = {1, 1, 2}, y[] = {1, 2, 3}, negative[] = {-1, 0, 3};
  scree_power_law law;
  scree_polynomial p;
  scree_error error;
  assert_int_equal(scree_fit_power(x, y, 2, 0.95, &law, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_fit_power(negative, y, 3, 0.95, &law, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_fit_polynomial(x, y, 3, 2, &p, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_fit_polynomial(x, y, 3, 5, &p, &error), SCREE_BAD_ARGUMENT);
  CHECK_OK(scree_fit_polynomial(x, y, 3, 1, &p, &error), error);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(quantiles_as_published),
      cmocka_unit_test(distributions_have_their_closed_forms),
      cmocka_unit_test(student_is_the_integral_of_its_density),
      cmocka_unit_test(summary_and_comparison_as_by_scipy),
      cmocka_unit_test(what_is_too_few_is_not_a_number),
      cmocka_unit_test(promises_hold_on_random_data),
      cmocka_unit_test(fits_as_by_scipy),
      cmocka_unit_test(fits_recover_what_was_put_in),
      cmocka_unit_test(fits_of_too_little_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
