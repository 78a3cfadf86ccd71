/* Gaussian process, sampler and the choice of runs, each against a slow oracle. */
#include "base/rng.h"
#include "calibrate/model.h"
#include "support/check.h"

enum { MOST = 40 };

static const size_t both[] = {0, 1};

/* A solver by Gauss-Jordan with pivots; log of |det|. */
static double solve(double a[MOST][MOST], double *b, size_t n) {
  double log_det = 0;
  for (size_t i = 0; i < n; i++) {
    size_t p = i;
    for (size_t r = i; r < n; r++)
      if (fabs(a[r][i]) > fabs(a[p][i])) p = r;
    for (size_t c = 0; c < n; c++) {
      double t = a[i][c];
      a[i][c] = a[p][c];
      a[p][c] = t;
    }
    double t = b[i];
    b[i] = b[p];
    b[p] = t;
    log_det += log(fabs(a[i][i]));
    for (size_t r = 0; r < n; r++) {
      if (r == i) continue;
      double f = a[r][i] / a[i][i];
      for (size_t c = i; c < n; c++) a[r][c] -= f * a[i][c];
      b[r] -= f * b[i];
    }
  }
  for (size_t i = 0; i < n; i++) b[i] /= a[i][i];
  return log_det;
}

typedef struct runs {
  scree_gp_runs view;
  double x[2 * MOST], y[MOST];
} runs;

/* Some places with one to three replicates each; the noise grows along x. */
static void make_runs(runs *r, uint64_t seed, size_t count) {
  scree_rng rng = {seed, 0, 0};
  for (size_t i = 0; i < count; i++) {
    bool again = i > 0 && scree_rng_uniform(&rng) < 0.5;
    for (int k = 0; k < 2; k++)
      r->x[2 * i + (size_t)k] =
          again ? r->x[2 * i - 2 + (size_t)k] : 2 * scree_rng_uniform(&rng) - 1;
    double a = r->x[2 * i], b = r->x[2 * i + 1];
    r->y[i] = 30 + 4 * a + 3 * sin(2 * b) + 0.3 * exp(a) * scree_rng_normal(&rng);
  }
  r->view = (scree_gp_runs){count, 2, r->x, r->y, both, 2};
}

static double kernel(const double *s, const double *a, const double *b) {
  double squared = 0;
  for (int k = 0; k < 2; k++) squared += pow((a[k] - b[k]) / exp(s[k]), 2);
  double r = sqrt(5 * squared);
  return 1 + a[0] * b[0] + a[1] * b[1] + exp(s[2]) * (1 + r + r * r / 3) * exp(-r);
}
/* Of the process asked, whose factor is checked by itself. */
static const scree_gp *asked;
static double noise_of(const double *s, const double *x) {
  return 1e-7 + scree_gp_factor(asked, x) * exp(s[3] + s[4] * x[0] + s[5] * x[1]);
}

static void standardise(const runs *r, double *z, double *shift, double *scale) {
  double sum = 0, squares = 0;
  size_t n = r->view.run_count;
  for (size_t i = 0; i < n; i++) sum += r->y[i] / (double)n;
  for (size_t i = 0; i < n; i++) squares += pow(r->y[i] - sum, 2);
  *shift = sum;
  *scale = sqrt(squares / (double)(n - 1));
  for (size_t i = 0; i < n; i++) z[i] = (r->y[i] - sum) / *scale;
}

/* The density of all single runs, whose covariance has as many rows as there are runs. */
static double density_of_runs(const runs *r, const double *s) {
  double a[MOST][MOST], z[MOST], b[MOST], shift, scale, sum = 0;
  size_t n = r->view.run_count;
  standardise(r, z, &shift, &scale);
  for (size_t i = 0; i < n; i++) {
    b[i] = z[i];
    for (size_t j = 0; j < n; j++)
      a[i][j] = kernel(s, r->x + 2 * i, r->x + 2 * j) + (i == j ? noise_of(s, r->x + 2 * i) : 0);
  }
  sum -= 0.5 * solve(a, b, n);
  for (size_t i = 0; i < n; i++) sum -= 0.5 * z[i] * b[i];
  static const double mean[] = {0.7, 0.7, -1, -2.3, 0, 0}, sd[] = {0.8, 0.8, 2, 2, 1, 1};
  for (int i = 0; i < 6; i++) sum -= 0.5 * pow((s[i] - mean[i]) / sd[i], 2);
  return sum;
}

static void random_settings(scree_rng *rng, double *s) {
  static const double mean[] = {0, 0, -1, -2, 0, 0};
  for (int i = 0; i < 6; i++) s[i] = mean[i] + 0.5 * scree_rng_normal(rng);
}

/* By means and sums of squares of the replicates the density is that of all runs, but for a
 * constant; its gradient is that by differences. */
static void replicates_are_all_runs(void **state) {
  (void)state;
  scree_rng rng = {9, 0, 0};
  scree_error error;
  for (uint64_t seed = 0; seed < 40; seed++) {
    runs r;
    scree_gp *gp;
    double first[6], second[6], gradient[SCREE_GP_MOST_SETTINGS], other[SCREE_GP_MOST_SETTINGS];
    make_runs(&r, seed, 6 + (size_t)(seed % 25));
    CHECK_OK(scree_gp_fit(&r.view, &gp, &error), error);
    asked = gp;
    random_settings(&rng, first);
    random_settings(&rng, second);
    double difference = scree_gp_log_density(gp, first, gradient);
    difference -= scree_gp_log_density(gp, second, other);
    CHECK_NEAR(difference, density_of_runs(&r, first) - density_of_runs(&r, second),
               1e-7 * (1 + fabs(difference)));
    for (int i = 0; i < 6; i++) {
      double up[6], down[6], h = 1e-5;
      memcpy(up, first, sizeof up);
      memcpy(down, first, sizeof down);
      up[i] += h;
      down[i] -= h;
      double slope = scree_gp_log_density(gp, up, other) - scree_gp_log_density(gp, down, other);
      CHECK_NEAR(gradient[i], slope / (2 * h), 1e-4 * (1 + fabs(gradient[i])));
    }
    scree_gp_free(gp);
  }
}

/* Means (2), covariance (2 x 2) and noise (2) of two places with one choice of settings, in units
 * of the standardised answers. */
typedef struct oracle {
  double mean[2], covariance[2][2], noise[2];
} oracle;

static oracle ask_all_runs(const runs *r, const double *s, const double *z, const double *places) {
  oracle o = {0};
  double k[2][MOST], a[MOST][MOST], b[MOST];
  size_t n = r->view.run_count;
  for (int p = 0; p < 2; p++) {
    for (size_t i = 0; i < n; i++) {
      b[i] = k[p][i] = kernel(s, places + 2 * p, r->x + 2 * i);
      for (size_t j = 0; j < n; j++)
        a[i][j] = kernel(s, r->x + 2 * i, r->x + 2 * j) + (i == j ? noise_of(s, r->x + 2 * i) : 0);
    }
    solve(a, b, n);
    o.noise[p] = noise_of(s, places + 2 * p);
    for (size_t i = 0; i < n; i++) o.mean[p] += b[i] * z[i];
    for (int q = 0; q <= p; q++) {
      double sum = kernel(s, places + 2 * p, places + 2 * q);
      for (size_t i = 0; i < n; i++) sum -= b[i] * k[q][i];
      o.covariance[p][q] = o.covariance[q][p] = sum;
    }
  }
  return o;
}

/* Mean and covariance of the mixture as from the covariance of all single runs. */
static void predictions_are_those_of_all_runs(void **state) {
  (void)state;
  scree_error error;
  scree_rng rng = {10, 0, 0};
  for (uint64_t seed = 0; seed < 30; seed++) {
    runs r;
    scree_gp *gp;
    oracle all = {0};
    double s[SCREE_GP_MOST_SETTINGS], z[MOST], shift, scale, places[4], covariance[4], share,
        shares = 0;
    make_runs(&r, seed, 8 + (size_t)(seed % 20));
    CHECK_OK(scree_gp_fit(&r.view, &gp, &error), error);
    asked = gp;
    standardise(&r, z, &shift, &scale);
    for (int i = 0; i < 4; i++) places[i] = 2 * scree_rng_uniform(&rng) - 1;
    for (size_t m = 0; (share = scree_gp_member(gp, m, s)) >= 0; m++) {
      oracle one = ask_all_runs(&r, s, z, places);
      shares += share;
      for (int p = 0; p < 2; p++) {
        all.mean[p] += share * one.mean[p];
        all.noise[p] += share * one.noise[p];
        for (int q = 0; q < 2; q++)
          all.covariance[p][q] += share * (one.covariance[p][q] + one.mean[p] * one.mean[q]);
      }
    }
    CHECK_NEAR(shares, 1, 1e-12);
    CHECK_OK(scree_gp_covariance(gp, places, 2, covariance, &error), error);
    double unit = scale * scale;
    for (int p = 0; p < 2; p++) {
      scree_gp_value value = scree_gp_at(gp, places + 2 * p);
      double variance = all.covariance[p][p] - all.mean[p] * all.mean[p];
      CHECK_NEAR(value.mean, shift + scale * all.mean[p], 1e-6 * scale);
      CHECK_NEAR(value.mean, scree_gp_mean(gp, places + 2 * p), 1e-9 * scale);
      CHECK_NEAR(value.variance, unit * variance, 1e-6 * unit);
      CHECK_NEAR(covariance[3 * p], unit * variance, 1e-6 * unit);
      CHECK_NEAR(value.noise, unit * all.noise[p], 1e-9 * unit);
      CHECK_NEAR(value.noise, scree_gp_noise(gp, places + 2 * p), 1e-12 * unit);
    }
    CHECK_NEAR(covariance[1], unit * (all.covariance[1][0] - all.mean[0] * all.mean[1]),
               1e-6 * unit);
    CHECK_NEAR(covariance[2], covariance[1], 0);
    scree_gp_free(gp);
  }
}

/* Noise that grows e^2 times from one end to the other is found, and 90 % intervals hold the true
 * mean in about 90 % of places. */
static void noise_that_depends_on_the_place_is_found(void **state) {
  (void)state;
  enum { PLACES = 60, RUNS = 120, FITS = 12, ASKED = 40 };
  static double x[2 * RUNS], y[RUNS];
  scree_error error;
  size_t inside = 0;
  double ratio = 0;
  for (uint64_t seed = 0; seed < FITS; seed++) {
    scree_rng rng = {seed, 7, 0};
    scree_gp *gp;
    for (size_t i = 0; i < RUNS; i++) {
      for (size_t k = 0; k < 2; k++)
        x[2 * i + k] = i < PLACES ? 2 * scree_rng_uniform(&rng) - 1 : x[2 * (i - PLACES) + k];
      y[i] = 5 * x[2 * i] + 2 * cos(3 * x[2 * i + 1]) + exp(x[2 * i]) * scree_rng_normal(&rng);
    }
    scree_gp_runs view = {RUNS, 2, x, y, both, 2};
    CHECK_OK(scree_gp_fit(&view, &gp, &error), error);
    double left[] = {-1, 0}, right[] = {1, 0};
    ratio += log(scree_gp_noise(gp, right) / scree_gp_noise(gp, left)) / FITS;
    for (int i = 0; i < ASKED; i++) {
      double place[] = {2 * scree_rng_uniform(&rng) - 1, 2 * scree_rng_uniform(&rng) - 1};
      scree_gp_value value = scree_gp_at(gp, place);
      double truth = 5 * place[0] + 2 * cos(3 * place[1]);
      inside += fabs(truth - value.mean) < 1.645 * sqrt(value.variance);
    }
    scree_gp_free(gp);
  }
  CHECK_NEAR(ratio, 4, 1);
  CHECK_NEAR((double)inside / (FITS * ASKED), 0.9, 0.07);
}

/* Noise that is small in one place alone, which no plane has, is found by what scatters there. */
static void noise_of_a_place_is_found(void **state) {
  (void)state;
  enum { PLACES = 40, RUNS = 80, FITS = 10 };
  static double x[2 * RUNS], y[RUNS];
  scree_error error;
  double quiet = 0, loud = 0;
  for (uint64_t seed = 0; seed < FITS; seed++) {
    scree_rng rng = {seed, 8, 0};
    scree_gp *gp;
    for (size_t i = 0; i < RUNS; i++) {
      for (size_t k = 0; k < 2; k++) /* half of the runs near the middle, as of a calibration */
        x[2 * i + k] = i >= PLACES      ? x[2 * (i - PLACES) + k]
                       : i < PLACES / 2 ? 0.2 * scree_rng_normal(&rng)
                                        : 2 * scree_rng_uniform(&rng) - 1;
      double squared = x[2 * i] * x[2 * i] + x[2 * i + 1] * x[2 * i + 1],
             sd = 0.1 + 0.9 * (1 - exp(-3 * squared));
      y[i] = 5 * x[2 * i] + 3 * x[2 * i + 1] + sd * scree_rng_normal(&rng);
    }
    scree_gp_runs view = {RUNS, 2, x, y, both, 2};
    CHECK_OK(scree_gp_fit(&view, &gp, &error), error);
    const double middle[] = {0, 0}, corner[] = {0.8, 0.8};
    quiet += 0.5 * log(scree_gp_noise(gp, middle)) / FITS;
    loud += 0.5 * log(scree_gp_noise(gp, corner)) / FITS;
    scree_gp_free(gp);
  }
  if (!(quiet < log(0.4) && quiet > log(0.08))) fail_msg("sd %g and %g", exp(quiet), exp(loud));
  CHECK_NEAR(loud, 0, 0.5);
}

static void runs_without_answers_are_left_out(void **state) {
  (void)state;
  runs r;
  scree_gp *gp = NULL, *fewer = NULL;
  scree_error error;
  make_runs(&r, 3, 20);
  r.view.run_count = 18;
  CHECK_OK(scree_gp_fit(&r.view, &fewer, &error), error);
  r.view.run_count = 20;
  r.y[18] = r.y[19] = NAN;
  CHECK_OK(scree_gp_fit(&r.view, &gp, &error), error);
  double place[] = {0.3, -0.2};
  CHECK_NEAR(scree_gp_mean(gp, place), scree_gp_mean(fewer, place), 0);
  scree_gp_free(gp);
  scree_gp_free(fewer);
  for (int i = 0; i < 20; i++) r.y[i] = NAN;
  assert_int_equal(scree_gp_fit(&r.view, &gp, &error), SCREE_BAD_ARGUMENT);
}

/* A thin ridge, whose moments are known: x + y within 0.05 of 0, cut off by the box. */
static double ridge(const void *context, const double *x) {
  (void)context;
  double across = (x[0] + x[1]) / 0.05;
  return -0.5 * across * across;
}

static void a_ridge_is_walked_along(void **state) {
  (void)state;
  scree_error error;
  scree_ensemble e = {.density = ridge,
                      .dimension_count = 2,
                      .walker_count = 40,
                      .first_steps = 200,
                      .steps = 2000,
                      .thin = 10,
                      .seed = 5};
  size_t count = scree_ensemble_count(&e);
  double *samples = malloc(count * 2 * sizeof *samples), *again = malloc(count * 2 * sizeof *again);
  CHECK_OK(scree_ensemble_sample(&e, samples, &error), error);
  double mean = 0, squares = 0, across = 0;
  for (size_t i = 0; i < count; i++) {
    mean += samples[2 * i] / (double)count;
    squares += samples[2 * i] * samples[2 * i] / (double)count;
    across += pow(samples[2 * i] + samples[2 * i + 1], 2) / (double)count;
  }
  CHECK_NEAR(mean, 0, 0.05);
  CHECK_NEAR(squares, 1.0 / 3, 0.03); /* uniform along the ridge */
  CHECK_NEAR(across, 0.0025, 0.0003);
  scree_set_threads(scree_threads() == 1 ? 3 : 1);
  CHECK_OK(scree_ensemble_sample(&e, again, &error), error);
  assert_memory_equal(samples, again, count * 2 * sizeof *samples);
  free(samples);
  free(again);
}

/* ---- the model ---- */

static void model_of(runs *r, scree_model *model, uint64_t seed, bool second) {
  scree_error error;
  make_runs(r, seed, 30);
  *model = (scree_model){.dimension_count = 2, .count = second ? 2 : 1};
  model->items = scree_alloc_zero(model->count, sizeof *model->items);
  for (size_t i = 0; i < model->count; i++) {
    if (i == 1)
      for (size_t k = 0; k < 30; k++) r->y[k] += 6 * r->x[2 * k + 1];
    CHECK_OK(scree_gp_fit(&r->view, &model->items[i].gp, &error), error);
    model->items[i].measured = i == 0;
    model->items[i].value = 31;
    model->items[i].uncertainty = 0.2;
    model->items[i].repeat_count = 1;
    model->items[i].experiment = i;
  }
  const double *x[] = {r->x, r->x}, *y[] = {r->y, r->y};
  size_t counts[] = {30, 30};
  CHECK_OK(scree_model_correlate(model, x, counts, y, &error), error);
}

/* Two answers that scatter together: the likelihood is that of the two-dimensional normal. */
static void likelihood_knows_that_answers_scatter_together(void **state) {
  (void)state;
  runs r;
  scree_model model;
  scree_rng rng = {4, 0, 0};
  model_of(&r, &model, 3, true);
  model.items[1].experiment = 0;
  model.items[1].measured = true;
  model.items[1].value = 29;
  model.correlation[1] = model.correlation[2] = 0.7;
  for (int i = 0; i < 100; i++) {
    double x[2], z[2], sd[2], v[2];
    for (int k = 0; k < 2; k++) x[k] = 2 * scree_rng_uniform(&rng) - 1;
    for (int k = 0; k < 2; k++) {
      scree_gp_value value = scree_gp_at(model.items[k].gp, x);
      z[k] = model.items[k].value - value.mean;
      sd[k] = sqrt(value.variance + value.noise);
      v[k] = sd[k] * sd[k] + 0.04;
    }
    double c = 0.7 * sd[0] * sd[1], det = v[0] * v[1] - c * c;
    double expected = -0.5 * (z[0] * z[0] * v[1] - 2 * c * z[0] * z[1] + z[1] * z[1] * v[0]) / det -
                      0.5 * log(det);
    CHECK_NEAR(scree_model_log_likelihood(&model, x), expected, 1e-9 * (1 + fabs(expected)));
  }
  scree_model_free(&model);
}

/* Each pick against all candidates by brute force: a process fitted with the same settings would
 * be asked anew; here the variance left is computed from the covariance with the picks so far. */
static void picks_are_the_best_of_all_candidates(void **state) {
  (void)state;
  enum { SAMPLES = 12 };
  runs r;
  scree_model model;
  scree_error error;
  scree_rng rng = {21, 0, 0};
  double samples[2 * SAMPLES], left, costs[] = {1, 1e9}, c[SAMPLES][SAMPLES];
  scree_place_pick picks[3];
  model_of(&r, &model, 8, false);
  for (int i = 0; i < 2 * SAMPLES; i++) samples[i] = 2 * scree_rng_uniform(&rng) - 1;
  const double *places[] = {NULL, NULL};
  size_t counts[] = {0, 0};
  scree_next_question q = {samples, SAMPLES, 2, places, counts, costs};
  CHECK_OK(scree_model_next(&model, &q, 3, picks, &left, &error), error);
  CHECK_OK(scree_gp_covariance(model.items[0].gp, samples, SAMPLES, &c[0][0], &error), error);
  double weight[SAMPLES], noise[SAMPLES], share = 0;
  for (size_t s = 0; s < SAMPLES; s++) {
    scree_gp_value value = scree_gp_at(model.items[0].gp, samples + 2 * s);
    weight[s] = 1 / (value.variance + value.noise + 0.04);
    noise[s] = value.noise;
    share += value.variance * weight[s] / SAMPLES;
  }
  CHECK_NEAR(left, share, 1e-9);
  size_t chosen[3];
  for (size_t p = 0; p < 3; p++) {
    double best = INFINITY;
    for (size_t t = 0; t < SAMPLES; t++) { /* the variance left with t added to those chosen */
      double sum = 0;
      chosen[p] = t;
      for (size_t s = 0; s < SAMPLES; s++) {
        double a[MOST][MOST], b[MOST];
        for (size_t i = 0; i <= p; i++) {
          b[i] = c[chosen[i]][s];
          for (size_t j = 0; j <= p; j++)
            a[i][j] = c[chosen[i]][chosen[j]] + (i == j ? noise[chosen[i]] : 0);
        }
        double variance = c[s][s];
        solve(a, b, p + 1);
        for (size_t i = 0; i <= p; i++) variance -= b[i] * c[chosen[i]][s];
        sum += variance * weight[s];
      }
      if (sum < best - 1e-12) {
        best = sum;
        memcpy(picks[p].x + 4, samples + 2 * t, 2 * sizeof(double));
      }
    }
    for (size_t t = 0; t < SAMPLES; t++)
      if (samples[2 * t] == picks[p].x[4] && samples[2 * t + 1] == picks[p].x[5]) chosen[p] = t;
    CHECK_NEAR(picks[p].x[0], picks[p].x[4], 0);
    CHECK_NEAR(picks[p].x[1], picks[p].x[5], 0);
    assert_int_equal(picks[p].experiment, 0);
  }
  scree_model_free(&model);
}

/* For a plane and normal samples the posterior is known: a measurement of x0 with standard
 * deviation s leaves 1 / (1 / S^2 + 1 / s^2). */
static void another_measurement_is_foreseen(void **state) {
  (void)state;
  enum { SAMPLES = 4000, RUNS = 60 };
  static double x[2 * RUNS], y[RUNS], samples[2 * SAMPLES];
  scree_rng rng = {33, 0, 0};
  scree_error error;
  for (int i = 0; i < RUNS; i++) {
    for (int k = 0; k < 2; k++) x[2 * i + k] = 2 * scree_rng_uniform(&rng) - 1;
    y[i] = 10 * x[2 * i] + 1e-3 * scree_rng_normal(&rng);
  }
  for (int i = 0; i < 2 * SAMPLES; i++) samples[i] = 0.2 * scree_rng_normal(&rng);
  scree_response response = {.uncertainty = 1, .repeat_count = 1};
  scree_gp_runs view = {RUNS, 2, x, y, both, 2};
  CHECK_OK(scree_gp_fit(&view, &response.gp, &error), error);
  scree_model model = {.dimension_count = 2, .count = 1, .items = &response};
  double sd[2];
  size_t chosen = 0;
  CHECK_OK(scree_model_expect(&model, samples, SAMPLES, &chosen, 1, 1, sd, &error), error);
  CHECK_NEAR(sd[0], 1 / sqrt(1 / 0.04 + 100), 0.006);
  CHECK_NEAR(sd[1], 0.2, 0.02);
  scree_gp_free(response.gp);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(replicates_are_all_runs),
      cmocka_unit_test(predictions_are_those_of_all_runs),
      cmocka_unit_test(noise_that_depends_on_the_place_is_found),
      cmocka_unit_test(noise_of_a_place_is_found),
      cmocka_unit_test(runs_without_answers_are_left_out),
      cmocka_unit_test(a_ridge_is_walked_along),
      cmocka_unit_test(likelihood_knows_that_answers_scatter_together),
      cmocka_unit_test(picks_are_the_best_of_all_candidates),
      cmocka_unit_test(another_measurement_is_foreseen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
