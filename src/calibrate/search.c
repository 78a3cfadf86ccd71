/* The best settings of a design by the knowledge gradient (Frazier, Powell and Dayanik 2009) on
 * Gaussian processes with noise: each run is made where what is known after it is expected to have
 * the best mean, at any of several hundred places where the limits hold with the confidence asked.
 * What single runs gave does not count, and hollows that the processes take for noise are worth a
 * run. The gain is multiplied by the probability that the limits hold at the place itself (Gardner
 * and others 2014). Of a batch each is chosen as if those before had answered what was expected of
 * them.
 *
 * The last runs are made at the best settings so far, then at the best alone: which it is, that
 * the limits hold there, and what it gives are told by runs there. */
#include "calibrate/calibration.h"

#include "base/math.h"
#include "base/rng.h"
#include "study/design.h"
#include "study/special.h"

#include <stdlib.h>
#include <string.h>

enum { WIDE = 512, CLOSE = 192, CANDIDATES = WIDE + CLOSE, CLOSE_STREAM = 7 << 20 };
static const double close_steps[] = {0.15, 0.05, 0.015}; /* of the half range */
enum { BEST = 4, STEPS = sizeof close_steps / sizeof *close_steps };
/* Share of the budget for runs at the best settings, of which there are at least so many; how many
 * tell an interval.
 */
static const double confirm_share = 0.25;
enum { LEAST_CONFIRM = 8, TELLING = 4 };
/* It ends when no place is expected to better the best by this share of the answer's range. */
static const double settled_gain = 1e-3;
static const double root2 = 1.41421356237309504880, root2pi = 2.50662827463100050242;

static double normal_below(double z) {
  return 0.5 * erfc(-z / root2);
}

/* A line over a standard normal Z: what the mean at a place will be after a run somewhere. */
typedef struct line {
  double at_zero, slope;
} line;

static int by_slope(const void *a, const void *b) {
  const line *p = a, *q = b;
  if (p->slope != q->slope) return p->slope < q->slope ? -1 : 1;
  return p->at_zero < q->at_zero ? -1 : p->at_zero > q->at_zero;
}

/* E max (a + b Z) - max a of `count` lines, which are sorted and of which those on the upper
 * envelope stay (Frazier, Powell and Dayanik 2009, their algorithm 1). */
static double knowledge_gain(line *lines, size_t count) {
  double gain = 0;
  size_t kept = 0;
  SCREE_ASSERT(count > 0 && count <= CANDIDATES + 1);
  double from[CANDIDATES + 1]; /* Z from which on a line is the highest */
  qsort(lines, count, sizeof *lines, by_slope);
  for (size_t i = 0; i < count; i++) {
    double z = -INFINITY;
    while (kept > 0) {
      const line *top = &lines[kept - 1];
      if (lines[i].slope > top->slope) {
        z = (top->at_zero - lines[i].at_zero) / (lines[i].slope - top->slope);
        if (z > from[kept - 1]) break;
      }
      kept--;
      z = -INFINITY;
    }
    from[kept] = z;
    lines[kept++] = lines[i];
  }
  for (size_t i = 1; i < kept; i++) {
    double z = fabs(from[i]);
    gain += (lines[i].slope - lines[i - 1].slope) *
            (scree_exp(-0.5 * z * z) / root2pi - z * normal_below(-z));
  }
  return gain;
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

/* Places with runs, the best first; those whose limits hold with the confidence before the others.
 */
typedef struct ranking {
  const double *x[BEST];
  double value[BEST], allowed[BEST];
  size_t count;
} ranking;

static bool is_before(const scree_calibration *c, double allowed, double value,
                      double other_allowed, double other_value) {
  bool good = allowed >= c->plan.confidence, other = other_allowed >= c->plan.confidence;
  if (good != other) return good;
  return good ? value > other_value : allowed > other_allowed;
}

static bool is_ranked(const ranking *r, const double *x, size_t d) {
  for (size_t i = 0; i < r->count; i++)
    if (!memcmp(r->x[i], x, d * sizeof *x)) return true;
  return false;
}

static ranking rank_places(const scree_calibration *c, const scree_calibration_model *m,
                           const scree_answers *g) {
  const scree_gp *gp = response_of(m, sought(c))->gp;
  ranking r = {0};
  for (size_t e = 0; e < c->experiment_count; e++)
    for (size_t i = 0; i < g->run_counts[e]; i++) {
      const double *x = g->x[e] + i * c->parameter_count;
      double allowed = allowed_at(c, m, x), value = sign_of(c) * scree_gp_mean(gp, x);
      if (is_ranked(&r, x, c->parameter_count)) continue;
      size_t at = r.count < BEST ? r.count : BEST;
      while (at > 0 && is_before(c, allowed, value, r.allowed[at - 1], r.value[at - 1])) at--;
      if (at == BEST) continue;
      if (r.count < BEST) r.count++;
      for (size_t k = r.count - 1; k > at; k--) {
        r.x[k] = r.x[k - 1];
        r.value[k] = r.value[k - 1];
        r.allowed[k] = r.allowed[k - 1];
      }
      r.x[at] = x;
      r.value[at] = value;
      r.allowed[at] = allowed;
    }
  return r;
}

/* Sobol's sequence all over, another part of it each time, and random steps about the best. */
static void list_candidates(const scree_calibration *c, const ranking *r, double *x) {
  size_t d = c->parameter_count;
  scree_rng rng = {c->plan.seed, CLOSE_STREAM + c->round_count, 0};
  scree_design_sobol(c->plan.seed + 7919 * c->round_count, WIDE, d, x);
  for (size_t i = 0; i < WIDE * d; i++) x[i] = 2 * x[i] - 1;
  for (size_t i = 0; i < CLOSE; i++) {
    const double *centre = r->x[r->count ? i % r->count : 0];
    if (!centre) break;
    for (size_t k = 0; k < d; k++) {
      double step = close_steps[i / BEST % STEPS] * scree_rng_normal(&rng);
      x[(WIDE + i) * d + k] = fmax(-1, fmin(1, centre[k] + step));
    }
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
                               const ranking *r, field *f, scree_error *error) {
  size_t d = c->parameter_count;
  const scree_gp *gp = response_of(m, sought(c))->gp;
  SCREE_TRY_ALLOC(f->x, CANDIDATES * d, error);
  SCREE_TRY_ALLOC(f->mean, 3 * CANDIDATES, error);
  SCREE_TRY_ALLOC(f->covariance, CANDIDATES * CANDIDATES, error);
  f->allowed = f->mean + CANDIDATES;
  f->noise = f->allowed + CANDIDATES;
  list_candidates(c, r, f->x);
  for (size_t i = 0; i < CANDIDATES; i++) {
    f->mean[i] = sign_of(c) * scree_gp_mean(gp, f->x + i * d);
    f->noise[i] = scree_gp_noise(gp, f->x + i * d);
    f->allowed[i] = allowed_at(c, m, f->x + i * d);
  }
  return scree_gp_covariance(gp, f->x, CANDIDATES, f->covariance, error);
}

/* What a run at a candidate is expected to add to the best mean where the limits hold; without any
 * such place, to `worst`. */
static double gain_at(const field *f, size_t i, double confidence, double worst, line *lines) {
  const double *row = f->covariance + i * CANDIDATES;
  double sd = sqrt(row[i] + f->noise[i]);
  size_t count = 0;
  if (!(row[i] > 0)) return 0;
  for (size_t j = 0; j < CANDIDATES; j++)
    if (j == i || f->allowed[j] >= confidence) lines[count++] = (line){f->mean[j], row[j] / sd};
  if (count == 1) lines[count++] = (line){worst, 0};
  return f->allowed[i] * knowledge_gain(lines, count);
}

/* The candidate of the greatest gain; then what is known after runs there. */
static size_t take_best(field *f, double confidence, double worst, double *gain) {
  line lines[CANDIDATES + 1];
  size_t chosen = 0;
  *gain = -1;
  for (size_t i = 0; i < CANDIDATES; i++) {
    double expected = gain_at(f, i, confidence, worst, lines);
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

/* Runs of every experiment at a place: the answer sought and all limits. */
static void pick_place(const scree_calibration *c, const double *x, size_t count,
                       scree_place_pick *picks, size_t *made) {
  for (size_t e = 0; x && e < c->experiment_count && *made < count; e++) {
    picks[*made].experiment = e;
    memcpy(picks[(*made)++].x, x, c->parameter_count * sizeof *x);
  }
}

static size_t runs_at(const scree_calibration *c, const scree_answers *g, const double *x) {
  size_t count = 0, d = c->parameter_count;
  for (size_t i = 0; i < g->run_counts[0]; i++) count += !memcmp(g->x[0] + i * d, x, d * sizeof *x);
  return count;
}

/* At the best places in turn while half of what is kept for this is left, then at the best. */
static void confirm(const scree_calibration *c, const ranking *r, bool early, size_t count,
                    scree_place_pick *picks) {
  for (size_t made = 0, i = 0; made < count; i++)
    pick_place(c, r->x[early && r->count ? i % r->count : 0], count, picks, &made);
}

scree_status scree_search_next(const scree_calibration *c, const scree_calibration_model *m,
                               const scree_answers *g, size_t *most, scree_place_pick *picks,
                               double *left, scree_error *error) {
  size_t d = c->parameter_count, count = *most, made = 0, budget = c->plan.budget->runs,
         still = budget - c->run_count,
         kept = (size_t)fmax(LEAST_CONFIRM * (double)c->experiment_count,
                             confirm_share * (double)budget);
  SCREE_CLEANUP(free_field) field f = {0};
  ranking r = rank_places(c, m, g);
  double low = INFINITY, high = -INFINITY, first = 0;
  *left = 1;
  if (still <= kept) {
    confirm(c, &r, 2 * still > kept, count, picks);
    return SCREE_OK;
  }
  if (count > still - kept) *most = count = still - kept;
  SCREE_TRY(make_field(c, m, &r, &f, error));
  for (size_t i = 0; i < CANDIDATES; i++) {
    low = fmin(low, f.mean[i]);
    high = fmax(high, f.mean[i]);
  }
  while (made < count) {
    double gain;
    size_t chosen = take_best(&f, c->plan.confidence, low, &gain);
    if (made == 0) first = gain;
    pick_place(c, f.x + chosen * d, count, picks, &made);
  }
  if (first > settled_gain * (high - low)) return SCREE_OK;
  if (runs_at(c, g, r.x[0]) > TELLING)
    *left = 0;
  else
    confirm(c, &r, false, made, picks);
  return SCREE_OK;
}

/* ---- what it says ---- */

enum { MOST_NEAR = 10 };

static bool seen_before(const scree_answers *g, size_t run, size_t d) {
  for (size_t i = 0; i < run; i++)
    if (!memcmp(g->x[0] + i * d, g->x[0] + run * d, d * sizeof(double))) return true;
  return false;
}

/* Tells of a setting with enough runs what these give, but for the first, by which it was found. */
static void tell_by_runs(const scree_calibration *c, const scree_answers *g, const double *x,
                         scree_setting *out) {
  const scree_quantity *q = &c->quantities[sought(c)];
  size_t d = c->parameter_count, e = q->experiment, all = c->experiments[e].answer_count, n = 0;
  double mean = 0, squares = 0;
  bool first = true;
  for (size_t i = 0; i < g->run_counts[e]; i++) {
    double y = g->answers[e][i * all + q->first_answer];
    if (isnan(y) || memcmp(g->x[e] + i * d, x, d * sizeof *x) != 0) continue;
    double step = y - mean;
    if (!first) squares += step * (y - (mean += step / (double)++n));
    first = false;
  }
  if (n < TELLING) return;
  double half = scree_student_quantile(0.5 * (1 + c->plan.confidence), (double)(n - 1)) *
                sqrt(squares / (double)(n - 1) / (double)n);
  out->mean = mean;
  out->low = mean - half;
  out->high = mean + half;
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
  out->run_count = runs_at(c, g, x);
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
    if (allowed_at(c, m, c->runs[i].x) >= c->plan.confidence)
      best = fmax(best, sign_of(c) * scree_gp_mean(gp, c->runs[i].x));
    double *row = r->history + 2 * c->runs[i].round;
    row[0] = (double)(i + 1);
    row[1] = best > -INFINITY ? sign_of(c) * best : (double)NAN;
  }
  r->history_count = c->round_count;
  return SCREE_OK;
}

scree_status scree_search_describe(const scree_calibration *c, const scree_calibration_model *m,
                                   const scree_answers *g, scree_arena *arena,
                                   scree_calibration_result *r, scree_error *error) {
  size_t d = c->parameter_count;
  scree_status status = SCREE_OK;
  SCREE_SCRATCH(const double *, x, g->run_counts[0] + 1, error);
  r->settings = scree_arena_take(arena, g->run_counts[0], sizeof *r->settings);
  r->sought = scree_arena_text(arena, c->quantities[sought(c)].plan->answer);
  if (!r->settings || !r->sought) return scree_fail_memory(error, 0, "candidates");
  for (size_t i = 0; status == SCREE_OK && i < g->run_counts[0]; i++) {
    if (seen_before(g, i, d)) continue;
    scree_setting made;
    status = describe_place(c, m, g, g->x[0] + i * d, arena, &made);
    size_t at = r->setting_count++;
    double value = sign_of(c) * made.mean;
    while (at > 0 && is_before(c, made.allowed, value, r->settings[at - 1].allowed,
                               sign_of(c) * r->settings[at - 1].mean)) {
      r->settings[at] = r->settings[at - 1];
      x[at] = x[at - 1];
      at--;
    }
    r->settings[at] = made;
    x[at] = g->x[0] + i * d;
  }
  if (r->setting_count > MOST_NEAR) r->setting_count = MOST_NEAR;
  for (size_t i = 0; i < r->setting_count; i++) tell_by_runs(c, g, x[i], &r->settings[i]);
  if (status == SCREE_OK) status = describe_rounds(c, m, arena, r);
  return status == SCREE_OK ? status : scree_fail_memory(error, 0, "candidates");
}
