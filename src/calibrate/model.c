/* Density. The difference between a measured mean and the emulator's is normal, with the variance
 * of the emulator, that of single runs over the number of repeats, and that of measuring (Kennedy
 * and O'Hagan 2001, without a discrepancy). Answers of one experiment come from the same heap or
 * drum, so that their scatter is correlated, as it is in the simulation.
 *
 * Next runs. A run at c takes cov(s, c)^2 / (var(c) + noise(c)) of the emulator's variance at s,
 * whatever it answers; so a batch is chosen one after the other without answers in between. Weighed
 * by the whole variance of the comparison at s and averaged over the posterior this is the expected
 * reduction of that variance where it matters (the integrated variance of Seo and others 2000,
 * weighed by the posterior as Surer, Plumlee and Wild 2023 do). Candidates are the posterior's
 * samples, and places that have runs: a replicate wins where scatter rules.
 *
 * Another measurement. Each sample in turn is the truth, a measurement is drawn from it, and all
 * samples are weighed by its likelihood. */
#include "calibrate/model.h"

#include "base/math.h"
#include "base/parallel.h"
#include "base/rng.h"

#include <string.h>

void scree_model_free(scree_model *model) {
  for (size_t i = 0; model->items && i < model->count; i++) scree_gp_free(model->items[i].gp);
  scree_free(model->items);
  scree_free(model->correlation);
  *model = (scree_model){0};
}

/* Variance that single runs, or single measurements, have about their mean. */
static double scatter_of(const scree_response *r, const scree_gp_value *value) {
  return fmax(value->noise, r->scatter * r->scatter);
}

double scree_response_variance(const scree_response *r, const scree_gp_value *value,
                               double repeat_count) {
  return value->variance + scatter_of(r, value) / repeat_count + r->uncertainty * r->uncertainty;
}

double scree_model_distance(const scree_model *model, const scree_gp_value *values,
                            double *log_determinant) {
  double a[SCREE_MOST_RESPONSES][SCREE_MOST_RESPONSES], z[SCREE_MOST_RESPONSES],
      sd[SCREE_MOST_RESPONSES], squares = 0;
  size_t index[SCREE_MOST_RESPONSES], n = 0;
  *log_determinant = 0;
  for (size_t i = 0; i < model->count && n < SCREE_MOST_RESPONSES; i++) {
    const scree_response *r = &model->items[i];
    if (!r->measured) continue;
    z[n] = r->value - values[i].mean;
    sd[n] = sqrt(values[i].variance + scatter_of(r, &values[i]) / r->repeat_count);
    for (size_t j = 0; j < n; j++)
      a[n][j] = model->correlation[i * model->count + index[j]] * sd[n] * sd[j];
    a[n][n] = sd[n] * sd[n] + r->uncertainty * r->uncertainty;
    index[n++] = i;
  }
  for (size_t i = 0; i < n; i++) { /* Cholesky and forward substitution in one */
    for (size_t j = 0; j <= i; j++) {
      for (size_t k = 0; k < j; k++) a[i][j] -= a[i][k] * a[j][k];
      if (i == j && !(a[i][i] > 0)) return INFINITY;
      a[i][j] = i == j ? sqrt(a[i][i]) : a[i][j] / a[j][j];
    }
    for (size_t k = 0; k < i; k++) z[i] -= a[i][k] * z[k];
    z[i] /= a[i][i];
    squares += z[i] * z[i];
    *log_determinant += 2 * scree_log(a[i][i]);
  }
  return squares;
}

double scree_model_distance_at(const scree_model *model, const double *x, double *log_determinant) {
  scree_gp_value values[SCREE_MOST_RESPONSES];
  for (size_t i = 0; i < model->count; i++)
    if (model->items[i].measured) values[i] = scree_gp_at(model->items[i].gp, x);
  return scree_model_distance(model, values, log_determinant);
}

double scree_model_log_likelihood(const scree_model *model, const double *x) {
  double log_determinant, squares = scree_model_distance_at(model, x, &log_determinant);
  return -0.5 * (squares + log_determinant);
}

/* ---- correlations ---- */

/* The correlation of two answers of one experiment over the runs that gave both, drawn to 0 as if
 * there had been `doubt` more runs without any. */
static double correlate(const double *a, const double *b, size_t count) {
  const double doubt = 8;
  double ab = 0, aa = 0, bb = 0, used = 0;
  for (size_t i = 0; i < count; i++) {
    if (isnan(a[i]) || isnan(b[i])) continue;
    ab += a[i] * b[i];
    aa += a[i] * a[i];
    bb += b[i] * b[i];
    used++;
  }
  return aa > 0 && bb > 0 ? ab / sqrt(aa * bb) * used / (used + doubt) : 0;
}

scree_status scree_model_correlate(scree_model *model, const double *const *x,
                                   const size_t *run_counts, const double *const *y,
                                   scree_error *error) {
  size_t n = model->count, d = model->dimension_count, total = 0;
  for (size_t i = 0; i < n; i++) total += run_counts[model->items[i].experiment];
  SCREE_SCRATCH(double, residual, total, error);
  SCREE_SCRATCH(size_t, begin, n, error);
  scree_free(model->correlation);
  SCREE_TRY_ALLOC_ZERO(model->correlation, n * n, error);
  for (size_t i = 0, used = 0; i < n; i++) {
    const scree_response *r = &model->items[i];
    begin[i] = used;
    for (size_t run = 0; run < run_counts[r->experiment]; run++) {
      const double *place = x[r->experiment] + run * d;
      residual[used++] =
          (y[i][run] - scree_gp_mean(r->gp, place)) / sqrt(scree_gp_noise(r->gp, place));
    }
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      bool same = model->items[i].experiment == model->items[j].experiment;
      model->correlation[i * n + j] = i == j ? 1
                                      : same ? correlate(residual + begin[i], residual + begin[j],
                                                         run_counts[model->items[i].experiment])
                                             : 0;
    }
  return SCREE_OK;
}

/* ---- the next runs ---- */

/* One response at its candidates: the samples, then the places of its experiment. */
typedef struct outlook {
  const scree_response *response;
  size_t count;
  double *covariance;     /* count x count */
  double *noise, *weight; /* of single runs at each candidate; 1 / whole variance at each sample */
} outlook;

typedef struct outlooks {
  outlook *items;
  size_t count;
} outlooks;

static void free_outlooks(outlooks *all) {
  for (size_t i = 0; all->items && i < all->count; i++) {
    scree_free(all->items[i].covariance);
    scree_free(all->items[i].noise);
    scree_free(all->items[i].weight);
  }
  scree_free(all->items);
}

static const double *candidate(const scree_next_question *q, size_t experiment, size_t index,
                               size_t d) {
  return index < q->sample_count ? q->samples + index * d
                                 : q->places[experiment] + (index - q->sample_count) * d;
}

static scree_status look_out(const scree_model *model, const scree_response *r,
                             const scree_next_question *q, outlook *o, scree_error *error) {
  size_t d = model->dimension_count, e = r->experiment;
  *o = (outlook){.response = r, .count = q->sample_count + q->place_counts[e]};
  SCREE_TRY_ALLOC(o->covariance, o->count * o->count, error);
  SCREE_TRY_ALLOC(o->noise, o->count, error);
  SCREE_TRY_ALLOC(o->weight, q->sample_count, error);
  SCREE_SCRATCH(double, x, o->count *d, error);
  for (size_t i = 0; i < o->count; i++) memcpy(x + i * d, candidate(q, e, i, d), d * sizeof *x);
  SCREE_TRY(scree_gp_covariance(r->gp, x, o->count, o->covariance, error));
  for (size_t i = 0; i < o->count; i++) o->noise[i] = scree_gp_noise(r->gp, x + i * d);
  for (size_t s = 0; s < q->sample_count; s++) {
    scree_gp_value value = {0, o->covariance[s * o->count + s], o->noise[s]};
    o->weight[s] = 1 / scree_response_variance(r, &value, r->repeat_count);
  }
  return SCREE_OK;
}

static double gain_of(const outlook *o, size_t c, size_t sample_count) {
  double sum = 0, variance = o->covariance[c * o->count + c] + o->noise[c];
  for (size_t s = 0; s < sample_count; s++) {
    double both = o->covariance[c * o->count + s];
    sum += both * both * o->weight[s];
  }
  return sum / variance;
}

/* What is known after a run at candidate c; its own row and column come last, as they are the
 * factors. */
static void condition(outlook *o, size_t c) {
  double variance = o->covariance[c * o->count + c] + o->noise[c], keep = o->noise[c] / variance;
  double *row = o->covariance + c * o->count;
  for (size_t i = 0; i < o->count; i++) {
    double factor = i == c ? 0 : row[i] / variance;
    for (size_t j = 0; j < o->count; j++)
      if (j != c) o->covariance[i * o->count + j] -= factor * row[j];
  }
  for (size_t i = 0; i < o->count; i++) {
    row[i] *= keep;
    o->covariance[i * o->count + c] = row[i];
  }
}

static double share_left(const outlook *all, size_t count, size_t sample_count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    for (size_t s = 0; s < sample_count; s++)
      sum += fmax(all[i].covariance[s * all[i].count + s], 0) * all[i].weight[s];
  return sum / (double)(count * sample_count);
}

static void pick_one(const scree_model *model, const scree_next_question *q, outlook *all,
                     scree_place_pick *pick) {
  size_t best_experiment = 0, best = 0, d = model->dimension_count;
  double most = -1;
  for (size_t e = 0; e < q->experiment_count; e++)
    for (size_t c = 0; c < q->sample_count + q->place_counts[e]; c++) {
      double gain = 0;
      for (size_t i = 0; i < model->count; i++)
        if (all[i].response->experiment == e) gain += gain_of(&all[i], c, q->sample_count);
      gain /= q->costs[e];
      if (gain <= most) continue;
      most = gain;
      best_experiment = e;
      best = c;
    }
  pick->experiment = best_experiment;
  memcpy(pick->x, candidate(q, best_experiment, best, d), d * sizeof *pick->x);
  for (size_t i = 0; i < model->count; i++)
    if (all[i].response->experiment == best_experiment) condition(&all[i], best);
}

scree_status scree_model_next(const scree_model *model, const scree_next_question *question,
                              size_t count, scree_place_pick *picks, double *left,
                              scree_error *error) {
  SCREE_CLEANUP(free_outlooks) outlooks all = {.count = model->count};
  SCREE_TRY_ALLOC_ZERO(all.items, model->count, error);
  for (size_t i = 0; i < model->count; i++)
    SCREE_TRY(look_out(model, &model->items[i], question, &all.items[i], error));
  *left = share_left(all.items, model->count, question->sample_count);
  for (size_t i = 0; i < count; i++) pick_one(model, question, all.items, &picks[i]);
  return SCREE_OK;
}

/* ---- another measurement ---- */

enum { TRUTHS = 64, TRUTH_STREAM = 5 << 20 };

typedef struct expectation {
  const scree_model *model;
  const double *samples;
  size_t sample_count, chosen_count;
  double *mean, *variance; /* chosen x sample */
  double *log_weight;      /* of the samples, per truth */
  double *spread;          /* TRUTHS x d: variances */
} expectation;

static void weigh(const expectation *w, size_t truth, double *weight) {
  size_t n = w->sample_count, t = truth * n / TRUTHS;
  scree_rng rng = {1, TRUTH_STREAM + truth, 0};
  double most = -INFINITY;
  for (size_t s = 0; s < n; s++) weight[s] = 0;
  for (size_t c = 0; c < w->chosen_count; c++) {
    const double *mean = w->mean + c * n, *variance = w->variance + c * n;
    double drawn = mean[t] + sqrt(variance[t]) * scree_rng_normal(&rng);
    for (size_t s = 0; s < n; s++) {
      double z = drawn - mean[s];
      weight[s] -= 0.5 * (z * z / variance[s] + scree_log(variance[s]));
    }
  }
  for (size_t s = 0; s < n; s++) most = fmax(most, weight[s]);
  for (size_t s = 0; s < n; s++) weight[s] = scree_exp(weight[s] - most);
}

static void expect_truths(void *context, scree_block block) {
  expectation *w = context;
  size_t d = w->model->dimension_count, n = w->sample_count;
  for (size_t truth = block.begin; truth < block.end; truth++) {
    double *weight = w->log_weight + truth * n, all = 0;
    weigh(w, truth, weight);
    for (size_t s = 0; s < n; s++) all += weight[s];
    for (size_t k = 0; k < d; k++) {
      double sum = 0, squares = 0;
      for (size_t s = 0; s < n; s++) sum += weight[s] * w->samples[s * d + k];
      sum /= all;
      for (size_t s = 0; s < n; s++) {
        double step = w->samples[s * d + k] - sum;
        squares += weight[s] * step * step;
      }
      w->spread[truth * d + k] = squares / all;
    }
  }
}

scree_status scree_model_expect(const scree_model *model, const double *samples,
                                size_t sample_count, const size_t *chosen, size_t chosen_count,
                                double repeat_count, double *sd, scree_error *error) {
  size_t n = sample_count, d = model->dimension_count;
  SCREE_SCRATCH(double, mean, chosen_count *n, error);
  SCREE_SCRATCH(double, variance, chosen_count *n, error);
  SCREE_SCRATCH(double, log_weight, TRUTHS *n, error);
  SCREE_SCRATCH(double, spread, TRUTHS *d, error);
  expectation w = {model, samples, n, chosen_count, mean, variance, log_weight, spread};
  for (size_t c = 0; c < chosen_count; c++)
    for (size_t s = 0; s < n; s++) {
      const scree_response *r = &model->items[chosen[c]];
      scree_gp_value value = scree_gp_at(r->gp, samples + s * d);
      mean[c * n + s] = value.mean;
      variance[c * n + s] = scree_response_variance(r, &value, repeat_count);
    }
  scree_parallel_for(TRUTHS, 1, expect_truths, &w);
  for (size_t k = 0; k < d; k++) {
    double sum = 0;
    for (size_t t = 0; t < TRUTHS; t++) sum += spread[t * d + k];
    sd[k] = sqrt(sum / TRUTHS);
  }
  return SCREE_OK;
}
