/* Whether the model gives what was measured. The nearest setting is the most probable one; runs
 * there, which the processes are not fitted to, are held against the measurements. What they miss
 * by, all together, is the squared Mahalanobis distance, in the scatter of runs and measurements
 * and the uncertainty of measuring. If the model is right it is distributed as chi-square, with a
 * degree for each answer less one for each parameter that the answers tell; an end of a range
 * gives one back. Beyond the quantile of `sure` the model does not give what was measured. */
#include "base/rng.h"
#include "calibrate/calibration.h"
#include "study/special.h"

#include <math.h>
#include <string.h>

static const double sure = 0.99;
enum { LOOKS = 200, STEPS = 300, STEP_STREAM = 8 << 20 };
static const double first_step = 0.3, last_step = 0.003; /* of the half range */
static const double near_end = 0.98;

bool scree_answered_near(const scree_calibration *c, const scree_answers *g,
                         const scree_quantity *q, const double *x) {
  const scree_experiment_plan *e = &c->experiments[q->experiment];
  const double *place = g->x[q->experiment];
  const double *answer = g->answers[q->experiment] + q->first_answer;
  double nearest = INFINITY;
  bool answered = false;
  for (size_t i = 0; i < g->run_counts[q->experiment]; i++) {
    double distance = 0;
    bool has = !isnan(answer[i * e->answer_count]);
    for (size_t k = 0; k < e->active_count; k++) {
      double way = x[e->active[k]] - place[i * c->parameter_count + e->active[k]];
      distance += way * way;
    }
    if (distance < nearest || (distance == nearest && has)) answered = has;
    nearest = fmin(nearest, distance);
  }
  return answered;
}

static bool is_target(const scree_quantity *q) {
  return q->kind == SCREE_QUANTITY_TARGET && q->measured;
}

/* Log likelihood; places whose nearest runs gave no answer come last. */
static double value_at(const scree_calibration *c, const scree_answers *g, const scree_model *m,
                       const double *x) {
  const double far = 1e6;
  double value = scree_model_log_likelihood(m, x);
  for (size_t q = 0; q < c->quantity_count; q++)
    if (is_target(&c->quantities[q]) && !scree_answered_near(c, g, &c->quantities[q], x))
      value -= far;
  return value;
}

void scree_calibration_nearest(const scree_calibration *c, const scree_answers *g,
                               const scree_model *m, const double *samples, size_t count,
                               double *x) {
  size_t d = c->parameter_count;
  double best = -INFINITY, step = first_step;
  scree_rng rng = {c->plan.seed, STEP_STREAM, 0};
  for (size_t i = 0; i < LOOKS; i++) {
    const double *tried = samples + i * count / LOOKS * d;
    double value = value_at(c, g, m, tried);
    if (i > 0 && !(value > best)) continue;
    best = value;
    memcpy(x, tried, d * sizeof *x);
  }
  for (size_t i = 0; i < STEPS; i++, step *= pow(last_step / first_step, 1.0 / STEPS)) {
    double tried[SCREE_MOST_PARAMETERS];
    for (size_t k = 0; k < d; k++) {
      double moved = x[k] + step * scree_rng_normal(&rng);
      tried[k] = scree_parameter_snap(&c->parameters[k], fmax(-1, fmin(1, moved)));
    }
    double value = value_at(c, g, m, tried);
    if (!(value > best)) continue;
    best = value;
    memcpy(x, tried, d * sizeof *x);
  }
}

/* How many parameters the measurements tell: one that keeps all of its range's variance is none.
 */
static double told_count(const scree_calibration *c, const double *samples, size_t count) {
  size_t d = c->parameter_count;
  double told = 0;
  for (size_t k = 0; k < d; k++) {
    double mean = 0, squares = 0;
    for (size_t i = 0; i < count; i++) mean += samples[i * d + k] / (double)count;
    for (size_t i = 0; i < count; i++) {
      double off = samples[i * d + k] - mean;
      squares += off * off / (double)count;
    }
    told += fmax(0, 1 - 3 * squares); /* a range from -1 to 1 has variance 1/3 */
  }
  return told;
}

double scree_calibration_limit(const scree_calibration *c, const scree_model *m, const double *x,
                               const double *samples, size_t count) {
  double measured = 0, degrees = -told_count(c, samples, count);
  for (size_t i = 0; i < m->count; i++) measured += m->items[i].measured;
  for (size_t k = 0; k < c->parameter_count; k++)
    degrees += !c->parameters[k].values.count && fabs(x[k]) > near_end;
  degrees = fmax(1, fmin(measured, measured + degrees));
  return scree_chi_square_quantile(sure, degrees);
}

/* ---- by runs ---- */

bool scree_check_place(const scree_calibration *c, double *x) {
  if (!c->checked) return false;
  for (size_t i = 0; i < c->run_count; i++)
    if (c->runs[i].round == scree_rounds_fitted(c))
      memcpy(x, c->runs[i].x, c->parameter_count * sizeof *x);
  return true;
}

double scree_check_mean(const scree_calibration *c, const scree_answers *g,
                        const scree_calibration_model *m, size_t quantity, size_t component,
                        size_t *count) {
  const scree_quantity *q = &c->quantities[quantity];
  size_t all = c->experiments[q->experiment].answer_count;
  double sum = 0;
  *count = 0;
  for (size_t i = 0, run = 0; c->checked && i < c->run_count; i++) {
    if (c->runs[i].experiment != q->experiment) continue;
    const double *answers = g->answers[q->experiment] + run++ * all + q->first_answer;
    if (c->runs[i].round < scree_rounds_fitted(c) || isnan(answers[0])) continue;
    sum += q->x ? scree_curve_score(&m->bases[quantity], component, answers) : answers[0];
    ++*count;
  }
  return *count ? sum / (double)*count : (double)NAN;
}

/* What of a curve that was measured no setting has, beside what single runs have of that. */
static double left_over(const scree_calibration *c, const scree_answers *g,
                        const scree_calibration_model *m, size_t quantity) {
  const scree_quantity *q = &c->quantities[quantity];
  const scree_curve_basis *b = &m->bases[quantity];
  size_t all = c->experiments[q->experiment].answer_count, used = 0;
  double squares = 0, left = scree_curve_left(b, q->y);
  for (size_t i = 0; i < g->run_counts[q->experiment]; i++) {
    const double *curve = g->answers[q->experiment] + i * all + q->first_answer;
    if (isnan(curve[0])) continue;
    double own = scree_curve_left(b, curve);
    squares += own * own;
    used++;
  }
  return left * left / (q->uncertainty * q->uncertainty + squares / (double)(used ? used : 1));
}

double scree_check_distance(const scree_calibration *c, const scree_answers *g,
                            const scree_calibration_model *m) {
  double x[SCREE_MOST_PARAMETERS], log_determinant, more = 0;
  scree_gp_value values[SCREE_MOST_RESPONSES] = {0};
  if (!scree_check_place(c, x)) return NAN;
  for (size_t q = 0; q < c->quantity_count; q++) {
    if (!is_target(&c->quantities[q])) continue;
    for (size_t k = 0; k < m->count[q]; k++) {
      size_t n, i = m->first[q] + k;
      double noise = scree_gp_noise(m->model.items[i].gp, x),
             mean = scree_check_mean(c, g, m, q, k, &n);
      if (n == 0) return INFINITY; /* no such answer there */
      values[i] = (scree_gp_value){mean, noise / (double)n, noise};
    }
    if (c->quantities[q].x) more += left_over(c, g, m, q);
  }
  return more + scree_model_distance(&m->model, values, &log_determinant);
}
