/* The best settings of a design by expected improvement (Jones, Schonlau and Welch 1998) on
 * Gaussian processes with noise. What is improved upon is the best of the processes' means where
 * there are runs, not of what single runs gave (Picheny and others 2013 compare; this is their
 * plug-in). Each limit multiplies by the probability that it holds (Gardner and others 2014). Of a
 * batch each is chosen as if those before had answered what was expected of them. */
#include "calibrate/calibration.h"

#include "base/math.h"
#include "base/rng.h"
#include "study/design.h"
#include "study/special.h"

#include <stdlib.h>
#include <string.h>

enum { WIDE = 512, CLOSE = 128, CANDIDATES = WIDE + CLOSE, CLOSE_STREAM = 7 << 20 };
static const double close_step = 0.1;    /* of the half range */
static const double least_allowed = 0.5; /* probability of the limits at the best */
/* It ends when no place is expected to better the best by this share of the answer's range. */
static const double settled_gain = 1e-3;
static const double root2 = 1.41421356237309504880, root2pi = 2.50662827463100050242;

static double normal_below(double z) {
  return 0.5 * erfc(-z / root2);
}

/* Expected excess of a normal value over `best`, larger ones better. */
static double improvement(double mean, double sd, double best) {
  if (!(sd > 0)) return fmax(mean - best, 0);
  double z = (mean - best) / sd;
  return (mean - best) * normal_below(z) + sd * scree_exp(-0.5 * z * z) / root2pi;
}

static const scree_response *response_of(const scree_calibration_model *m, size_t quantity) {
  return &m->model.items[m->first[quantity]];
}

/* The sought answer so that more is better. */
static double sign_of(const scree_calibration *c) {
  return c->plan.maximise ? 1 : -1;
}

/* Probability that all limits hold at x, on the mean. */
static double allowed_at(const scree_calibration *c, const scree_calibration_model *m,
                         const double *x) {
  double all = 1;
  for (size_t q = 0; q < c->quantity_count; q++) {
    const scree_plan_quantity *p = c->quantities[q].plan;
    if (c->quantities[q].kind != SCREE_QUANTITY_LIMIT) continue;
    scree_gp_value value = scree_gp_at(response_of(m, q)->gp, x);
    double sd = sqrt(fmax(value.variance, 1e-300)), within = 1;
    if (!isnan(p->at_most)) within = normal_below((p->at_most - value.mean) / sd);
    if (!isnan(p->at_least)) within -= normal_below((p->at_least - value.mean) / sd);
    all *= fmax(within, 0);
  }
  return all;
}

static size_t sought(const scree_calibration *c) {
  size_t q = 0;
  while (c->quantities[q].kind != SCREE_QUANTITY_SOUGHT) q++;
  return q;
}

/* The best mean among places with runs where the limits likely hold; where they do nowhere, the
 * place where they most likely do. Its coordinates. */
static double find_best(const scree_calibration *c, const scree_calibration_model *m,
                        const scree_answers *g, const double **x) {
  const scree_gp *gp = response_of(m, sought(c))->gp;
  size_t d = c->parameter_count;
  double best = -INFINITY, most = -1;
  bool any = false;
  for (size_t e = 0; e < c->experiment_count; e++)
    for (size_t i = 0; i < g->run_counts[e]; i++) {
      const double *place = g->x[e] + i * d;
      double allowed = allowed_at(c, m, place), value = sign_of(c) * scree_gp_mean(gp, place);
      bool good = allowed >= least_allowed;
      if (any && !good) continue;
      if (good ? any && value <= best : allowed <= most) continue;
      any = any || good;
      best = value;
      most = allowed;
      *x = place;
    }
  return best;
}

/* Sobol's sequence all over, and random steps about the best. */
static void list_candidates(const scree_calibration *c, const double *best, double *x) {
  size_t d = c->parameter_count;
  scree_rng rng = {c->plan.seed, CLOSE_STREAM + c->round_count, 0};
  scree_design_sobol(c->plan.seed + c->round_count, WIDE, d, x);
  for (size_t i = 0; i < WIDE * d; i++) x[i] = 2 * x[i] - 1;
  for (size_t i = WIDE * d; i < CANDIDATES * d; i++) {
    double step = close_step * scree_rng_normal(&rng);
    x[i] = fmax(-1, fmin(1, best[i % d] + step));
  }
  for (size_t i = 0; i < CANDIDATES * d; i++)
    x[i] = scree_parameter_snap(&c->parameters[i % d], x[i]);
}

typedef struct field {
  double *x, *mean, *allowed, *covariance, *noise;
} field;

static void free_field(field *f) {
  scree_free(f->x);
  scree_free(f->mean);
  scree_free(f->covariance);
}

static scree_status make_field(const scree_calibration *c, const scree_calibration_model *m,
                               const double *best, field *f, scree_error *error) {
  size_t d = c->parameter_count;
  const scree_gp *gp = response_of(m, sought(c))->gp;
  SCREE_TRY_ALLOC(f->x, CANDIDATES * d, error);
  SCREE_TRY_ALLOC(f->mean, 3 * CANDIDATES, error);
  SCREE_TRY_ALLOC(f->covariance, CANDIDATES * CANDIDATES, error);
  f->allowed = f->mean + CANDIDATES;
  f->noise = f->allowed + CANDIDATES;
  list_candidates(c, best, f->x);
  for (size_t i = 0; i < CANDIDATES; i++) {
    f->mean[i] = sign_of(c) * scree_gp_mean(gp, f->x + i * d);
    f->noise[i] = scree_gp_noise(gp, f->x + i * d);
    f->allowed[i] = allowed_at(c, m, f->x + i * d);
  }
  return scree_gp_covariance(gp, f->x, CANDIDATES, f->covariance, error);
}

/* The candidate of the greatest expected improvement; then what is known after runs there. */
static size_t take_best(field *f, double best, double *gain) {
  size_t chosen = 0;
  *gain = -1;
  for (size_t i = 0; i < CANDIDATES; i++) {
    double sd = sqrt(fmax(f->covariance[i * CANDIDATES + i], 0));
    double expected = improvement(f->mean[i], sd, best) * f->allowed[i];
    if (expected <= *gain) continue;
    *gain = expected;
    chosen = i;
  }
  double variance = f->covariance[chosen * CANDIDATES + chosen] + f->noise[chosen];
  const double *row = f->covariance + chosen * CANDIDATES;
  for (size_t i = 0; i < CANDIDATES; i++) /* only variances are asked for, and this row */
    if (i != chosen)
      for (size_t j = 0; j < CANDIDATES; j++)
        if (j != chosen) f->covariance[i * CANDIDATES + j] -= row[i] * row[j] / variance;
  double keep = f->noise[chosen] / variance;
  for (size_t i = 0; i < CANDIDATES; i++) {
    f->covariance[chosen * CANDIDATES + i] *= keep;
    f->covariance[i * CANDIDATES + chosen] = f->covariance[chosen * CANDIDATES + i];
  }
  return chosen;
}

/* Runs of every experiment at each place: the answer sought and all limits. */
scree_status scree_search_next(const scree_calibration *c, const scree_calibration_model *m,
                               const scree_answers *g, size_t count, scree_place_pick *picks,
                               double *left, scree_error *error) {
  size_t d = c->parameter_count, made = 0;
  const double *place = g->x[0];
  SCREE_CLEANUP(free_field) field f = {0};
  double best = find_best(c, m, g, &place), low = INFINITY, high = -INFINITY, first = 0;
  SCREE_TRY(make_field(c, m, place, &f, error));
  for (size_t i = 0; i < CANDIDATES; i++) {
    low = fmin(low, f.mean[i]);
    high = fmax(high, f.mean[i]);
  }
  while (made < count) {
    double gain;
    size_t chosen = take_best(&f, best, &gain);
    if (made == 0) first = gain;
    for (size_t e = 0; e < c->experiment_count && made < count; e++) {
      picks[made].experiment = e;
      memcpy(picks[made++].x, f.x + chosen * d, d * sizeof(double));
    }
  }
  *left = first > settled_gain * (high - low) ? 1 : 0;
  return SCREE_OK;
}

/* ---- what it says ---- */

enum { MOST_NEAR = 10 };

static bool seen_before(const scree_answers *g, size_t run, size_t d) {
  for (size_t i = 0; i < run; i++)
    if (!memcmp(g->x[0] + i * d, g->x[0] + run * d, d * sizeof(double))) return true;
  return false;
}

static scree_status describe_place(const scree_calibration *c, const scree_calibration_model *m,
                                   const scree_answers *g, const double *x, scree_arena *arena,
                                   scree_setting *out) {
  size_t d = c->parameter_count;
  scree_gp_value value = scree_gp_at(response_of(m, sought(c))->gp, x);
  /* of a normal value */
  double half = -scree_student_quantile(0.5 * (1 - c->plan.confidence), 1e9) * sqrt(value.variance);
  *out = (scree_setting){.mean = value.mean,
                         .low = value.mean - half,
                         .high = value.mean + half,
                         .allowed = allowed_at(c, m, x),
                         .values = scree_arena_take(arena, d, sizeof(double))};
  if (!out->values) return SCREE_OUT_OF_MEMORY;
  for (size_t k = 0; k < d; k++) out->values[k] = scree_parameter_number(&c->parameters[k], x[k]);
  for (size_t i = 0; i < g->run_counts[0]; i++)
    out->run_count += !memcmp(g->x[0] + i * d, x, d * sizeof(double));
  return SCREE_OK;
}

/* The best mean after each round, by the processes as they are now. */
static scree_status describe_rounds(const scree_calibration *c, const scree_calibration_model *m,
                                    scree_arena *arena, scree_calibration_result *r) {
  double best = -INFINITY;
  const scree_gp *gp = response_of(m, sought(c))->gp;
  r->history = scree_arena_take(arena, 2 * c->round_count, sizeof *r->history);
  if (!r->history) return SCREE_OUT_OF_MEMORY;
  for (size_t i = 0; i < c->run_count; i++) {
    if (allowed_at(c, m, c->runs[i].x) >= least_allowed)
      best = fmax(best, sign_of(c) * scree_gp_mean(gp, c->runs[i].x));
    double *row = r->history + 2 * c->runs[i].round;
    row[0] = (double)(i + 1);
    row[1] = best > -INFINITY ? sign_of(c) * best : (double)NAN;
  }
  r->history_count = c->round_count;
  return SCREE_OK;
}

/* Better first; those whose limits likely hold before the others. */
static bool is_better(const scree_calibration *c, const scree_setting *a, const scree_setting *b) {
  bool good_a = a->allowed >= least_allowed, good_b = b->allowed >= least_allowed;
  if (good_a != good_b) return good_a;
  return good_a ? sign_of(c) * a->mean > sign_of(c) * b->mean : a->allowed > b->allowed;
}

scree_status scree_search_describe(const scree_calibration *c, const scree_calibration_model *m,
                                   const scree_answers *g, scree_arena *arena,
                                   scree_calibration_result *r, scree_error *error) {
  size_t d = c->parameter_count;
  scree_status status = SCREE_OK;
  r->settings = scree_arena_take(arena, g->run_counts[0], sizeof *r->settings);
  r->sought = scree_arena_text(arena, c->quantities[sought(c)].plan->answer);
  if (!r->settings || !r->sought) return scree_fail_memory(error, 0, "candidates");
  for (size_t i = 0; status == SCREE_OK && i < g->run_counts[0]; i++) {
    if (seen_before(g, i, d)) continue;
    scree_setting made;
    status = describe_place(c, m, g, g->x[0] + i * d, arena, &made);
    size_t at = r->setting_count++;
    for (; at > 0 && is_better(c, &made, &r->settings[at - 1]); at--)
      r->settings[at] = r->settings[at - 1];
    r->settings[at] = made;
  }
  if (r->setting_count > MOST_NEAR) r->setting_count = MOST_NEAR;
  if (status == SCREE_OK) status = describe_rounds(c, m, arena, r);
  return status == SCREE_OK ? status : scree_fail_memory(error, 0, "candidates");
}
