/* What a calibration says: intervals of parameters, pairs that trade against each other, answers
 * beside what was measured, and which measurement would help most. */
#include "base/file.h"
#include "base/math.h"
#include "base/platform.h"
#include "base/radix.h"
#include "base/rng.h"
#include "calibrate/calibration.h"
#include "study/special.h"

#include <stdlib.h>
#include <string.h>

/* A parameter is called identified where the model gives what was measured, its interval is at most
 * this share of that of its range, no end of the range is part of it, and runs at what agrees gave
 * the answers that were measured. */
static const double identified_share = 0.5;
static const double end_share = 0.01; /* of samples: so few beyond are none */
/* Two trade against each other where one tells this share of the other's variance. */
static const double trade_share = 0.5;
enum { LARGEST_INPUT = 64 << 20 };
enum { BINS = 8, MOST_HISTORY = 10, ANSWER_STREAM = 6 << 20, MOST_ADVISED = 500 };

typedef struct analysis {
  const scree_calibration *c;
  scree_answers gathered;
  scree_calibration_model model;
  scree_arena arena; /* all of the result */
  scree_calibration_result *r;
  double unanswered;                     /* share of the samples: below */
  double nearest[SCREE_MOST_PARAMETERS]; /* coordinates */
  double *samples;                       /* coordinates, sample_count x d */
  double *column;                        /* scratch: sample_count */
  scree_error *error;
} analysis;

static scree_status fail_memory(const analysis *a) {
  return scree_fail_memory(a->error, 0, "a calibration's result");
}

typedef struct interval {
  double mean, sd, median, low, high;
} interval;

/* Sorts the values. */
static interval summarise(double *values, size_t count, double confidence) {
  interval s = {0};
  for (size_t i = 0; i < count; i++) s.mean += values[i] / (double)count;
  for (size_t i = 0; i < count; i++)
    s.sd += (values[i] - s.mean) * (values[i] - s.mean) / (double)(count > 1 ? count - 1 : 1);
  s.sd = sqrt(s.sd);
  scree_sort_numbers(values, count);
  s.median = scree_quantile(values, count, 0.5);
  s.low = scree_quantile(values, count, 0.5 * (1 - confidence));
  s.high = scree_quantile(values, count, 0.5 * (1 + confidence));
  return s;
}

/* ---- parameters ---- */

/* Width of the interval of a coordinate beside that of its range. */
static double narrowed(const double *samples, size_t count, size_t d, size_t k, double confidence,
                       double *scratch) {
  for (size_t i = 0; i < count; i++) scratch[i] = samples[i * d + k];
  interval s = summarise(scratch, count, confidence);
  return (s.high - s.low) / (2 * confidence);
}

int scree_samples_end(const double *values, size_t count, double confidence) {
  size_t held = (size_t)(confidence * (double)count), shortest = 0;
  size_t near = (size_t)(end_share * (double)count);
  for (size_t i = 1; i + held < count; i++)
    if (values[i + held] - values[i] < values[shortest + held] - values[shortest]) shortest = i;
  return shortest <= near ? -1 : shortest + held + near >= count - 1 ? 1 : 0;
}

/* The largest share of the posterior, over what was measured, that lies nearest to runs without
 * such an answer, as of a heap too low to have an angle. The process continues to there from
 * elsewhere, so that an interval which rests on it tells nothing. */
static double find_unanswered(const analysis *a) {
  size_t n = a->r->sample_count;
  double most = 0;
  for (size_t q = 0; q < a->c->quantity_count; q++) {
    const scree_quantity *quantity = &a->c->quantities[q];
    size_t without = 0;
    if (quantity->kind != SCREE_QUANTITY_TARGET || !quantity->measured) continue;
    for (size_t i = 0; i < n; i++)
      without += !scree_answered_near(a->c, &a->gathered, quantity,
                                      a->samples + i * a->c->parameter_count);
    most = fmax(most, (double)without / (double)n);
  }
  return most;
}

/* What the posterior says in one word. A list has no beyond. */
static void judge(analysis *a, size_t k, scree_parameter_result *out) {
  const scree_plan_parameter *p = &a->c->parameters[k];
  size_t n = a->r->sample_count;
  double confidence = a->r->confidence;
  out->narrowed = narrowed(a->samples, n, a->c->parameter_count, k, confidence, a->column);
  int end = p->values.count ? 0 : scree_samples_end(a->column, n, confidence);
  bool narrow = out->narrowed <= identified_share;
  out->identified = narrow && end == 0 && a->unanswered <= 1 - confidence;
  if (narrow && end > 0)
    out->at_least = scree_parameter_number(p, scree_quantile(a->column, n, 1 - confidence));
  if (narrow && end < 0)
    out->at_most = scree_parameter_number(p, scree_quantile(a->column, n, confidence));
}

static scree_status describe_parameters(analysis *a) {
  const scree_calibration *c = a->c;
  size_t d = c->parameter_count, n = a->r->sample_count;
  SCREE_TRY_TAKE(a->r->parameters, &a->arena, d, a->error);
  SCREE_TRY_TAKE(a->r->samples, &a->arena, n * d + 1, a->error);
  a->r->parameter_count = d;
  for (size_t k = 0; k < d; k++) {
    const scree_plan_parameter *p = &c->parameters[k];
    scree_parameter_result *out = &a->r->parameters[k];
    *out = (scree_parameter_result){.name = scree_arena_text(&a->arena, p->place.name),
                                    .unit = scree_arena_text(&a->arena, p->unit ? p->unit : ""),
                                    .logarithmic = p->scale == 1,
                                    .from = scree_parameter_number(p, -1),
                                    .to = scree_parameter_number(p, 1)};
    out->nearest = out->mean = out->sd = out->median = out->low = out->high = out->narrowed = NAN;
    out->at_least = out->at_most = NAN;
    if (!out->name || !out->unit) return fail_memory(a);
    if (a->r->is_search) continue;
    out->nearest = scree_parameter_number(p, a->nearest[k]);
    if (a->r->agreement == SCREE_AGREEMENT_NO) continue;
    for (size_t i = 0; i < n; i++)
      a->column[i] = a->r->samples[i * d + k] = scree_parameter_number(p, a->samples[i * d + k]);
    interval s = summarise(a->column, n, a->r->confidence);
    out->mean = s.mean;
    out->sd = s.sd;
    out->median = s.median;
    out->low = s.low;
    out->high = s.high;
    judge(a, k, out);
  }
  return SCREE_OK;
}

/* ---- pairs ---- */

typedef struct pair {
  double a, b;
} pair;

static int compare_pairs(const void *x, const void *y) {
  double p = ((const pair *)x)->a, q = ((const pair *)y)->a;
  return (p > q) - (p < q);
}

/* The share of b's variance that a tells: between the means of parts of equal count along a (the
 * correlation ratio), which also sees lines that are bent. Sorts by a. */
static double told_share(pair *pairs, size_t count) {
  double mean = 0, whole = 0, between = 0;
  qsort(pairs, count, sizeof *pairs, compare_pairs);
  for (size_t i = 0; i < count; i++) mean += pairs[i].b / (double)count;
  for (size_t i = 0; i < count; i++) whole += (pairs[i].b - mean) * (pairs[i].b - mean);
  for (size_t bin = 0; bin < BINS; bin++) {
    size_t begin = bin * count / BINS, end = (bin + 1) * count / BINS;
    double sum = 0;
    for (size_t i = begin; i < end; i++) sum += pairs[i].b - mean;
    if (end > begin) between += sum * sum / (double)(end - begin);
  }
  return whole > 0 ? between / whole : 0;
}

static double correlation(const pair *pairs, size_t count) {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < count; i++) {
    a += pairs[i].a / (double)count;
    b += pairs[i].b / (double)count;
  }
  for (size_t i = 0; i < count; i++) {
    aa += (pairs[i].a - a) * (pairs[i].a - a);
    bb += (pairs[i].b - b) * (pairs[i].b - b);
    ab += (pairs[i].a - a) * (pairs[i].b - b);
  }
  return aa > 0 && bb > 0 ? ab / sqrt(aa * bb) : 0;
}

static void load_pairs(const analysis *a, size_t first, size_t second, pair *pairs) {
  size_t d = a->c->parameter_count;
  for (size_t i = 0; i < a->r->sample_count; i++)
    pairs[i] = (pair){a->samples[i * d + first], a->samples[i * d + second]};
}

/* Where the line begins and ends: the means of the tenths of samples with the least and the
 * greatest a. `pairs` are sorted. */
static void find_ends(const analysis *a, const pair *pairs, scree_trade *trade) {
  size_t n = a->r->sample_count, tenth = n / 10 ? n / 10 : 1;
  for (int end = 0; end < 2; end++) {
    double sum[2] = {0};
    for (size_t i = 0; i < tenth; i++) {
      const pair *p = &pairs[end ? n - 1 - i : i];
      sum[0] += p->a / (double)tenth;
      sum[1] += p->b / (double)tenth;
    }
    trade->ends[end][0] = scree_parameter_number(&a->c->parameters[trade->a], sum[0]);
    trade->ends[end][1] = scree_parameter_number(&a->c->parameters[trade->b], sum[1]);
  }
}

static scree_status find_trades(analysis *a) {
  size_t d = a->c->parameter_count, n = a->r->sample_count;
  SCREE_TRY_TAKE(a->r->trades, &a->arena, d * d, a->error);
  SCREE_SCRATCH(pair, pairs, n, a->error);
  for (size_t i = 0; i < d; i++)
    for (size_t j = i + 1; j < d; j++) {
      scree_trade trade = {.a = i, .b = j};
      if (a->r->parameters[i].identified && a->r->parameters[j].identified) continue;
      load_pairs(a, j, i, pairs);
      trade.share = told_share(pairs, n);
      load_pairs(a, i, j, pairs);
      trade.share = fmax(trade.share, told_share(pairs, n));
      if (trade.share < trade_share) continue;
      trade.correlation = correlation(pairs, n);
      find_ends(a, pairs, &trade);
      a->r->trades[a->r->trade_count++] = trade;
    }
  return SCREE_OK;
}

/* ---- answers ---- */

/* Draws of a response over the posterior: its mean, and one measurement of it. */
typedef struct draws {
  double *mean, *single, *measured;
} draws;

static double draw_response(const scree_response *r, const double *x, scree_rng *rng,
                            double *single, double *measured) {
  scree_gp_value value = scree_gp_at(r->gp, x);
  double mean = value.mean + sqrt(value.variance) * scree_rng_normal(rng);
  double scatter = sqrt(fmax(value.noise, r->scatter * r->scatter));
  double error = r->uncertainty * scree_rng_normal(rng), z = scree_rng_normal(rng);
  *single = mean + scatter * z + error;
  *measured = mean + scatter / sqrt(r->repeat_count) * z + error;
  return mean;
}

static void describe_scalar(analysis *a, const scree_response *r, size_t stream, draws *d,
                            scree_answer_result *out) {
  size_t n = a->r->sample_count, dimensions = a->c->parameter_count;
  double noise = 0;
  for (size_t i = 0; i < n; i++) {
    const double *x = a->samples + i * dimensions;
    scree_rng rng = {a->r->seed, ANSWER_STREAM + stream, 16 * i};
    d->mean[i] = draw_response(r, x, &rng, &d->single[i], &d->measured[i]);
    noise += scree_gp_noise(r->gp, x) / (double)n;
  }
  interval mean = summarise(d->mean, n, a->r->confidence);
  interval single = summarise(d->single, n, a->r->confidence);
  interval measured = summarise(d->measured, n, a->r->confidence);
  out->mean = mean.mean;
  out->low = mean.low;
  out->high = mean.high;
  out->single_low = single.low;
  out->single_high = single.high;
  out->noise = sqrt(noise);
  out->inside = out->value >= measured.low && out->value <= measured.high;
}

/* A curve from draws of its scores; `inside` where no point but some of the share that may be
 * outside is. */
static scree_status describe_curve(analysis *a, size_t quantity, draws *d,
                                   scree_answer_result *out) {
  const scree_quantity *q = &a->c->quantities[quantity];
  const scree_curve_basis *b = &a->model.bases[quantity];
  size_t n = a->r->sample_count, points = q->answer_count, outside = 0;
  double *room;
  SCREE_SCRATCH(double, scores, n * b->component_count, a->error);
  SCREE_TRY_TAKE(room, &a->arena, 5 * points, a->error);
  out->point_count = points;
  out->x = memcpy(room, q->x, points * sizeof *room);
  out->y = memcpy(room + points, q->y, points * sizeof *room);
  out->curve_mean = room + 2 * points;
  out->curve_low = room + 3 * points;
  out->curve_high = room + 4 * points;
  for (size_t k = 0; k < b->component_count; k++)
    for (size_t i = 0; i < n; i++) {
      const scree_response *r = &a->model.model.items[a->model.first[quantity] + k];
      scree_rng rng = {a->r->seed, ANSWER_STREAM + a->model.first[quantity] + k, 16 * i};
      draw_response(r, a->samples + i * a->c->parameter_count, &rng, &d->single[0],
                    &scores[i * b->component_count + k]);
    }
  for (size_t p = 0; p < points; p++) {
    for (size_t i = 0; i < n; i++) {
      d->mean[i] = b->centre[p];
      for (size_t k = 0; k < b->component_count; k++)
        d->mean[i] += scores[i * b->component_count + k] * b->basis[k * points + p];
    }
    interval s = summarise(d->mean, n, a->r->confidence);
    out->curve_mean[p] = s.mean;
    out->curve_low[p] = s.low;
    out->curve_high[p] = s.high;
    outside += q->y[p] < s.low || q->y[p] > s.high;
  }
  out->unexplained = scree_curve_left(b, q->y);
  out->inside = (double)outside <= 2 * (1 - a->r->confidence) * (double)points;
  return SCREE_OK;
}

/* What one of several intervals must hold for all of them to hold with the confidence (Sidak
 * 1967): else one of ten sound answers would be told as a misfit. */
static double one_of_all(const analysis *a) {
  size_t count = 0;
  for (size_t q = 0; q < a->c->quantity_count; q++) count += a->c->quantities[q].x == NULL;
  return scree_exp(scree_log(a->r->confidence) / (double)count);
}

/* What the runs at the nearest setting gave, where the process expects their mean, and what both
 * say of what was measured. */
static void describe_check(const analysis *a, size_t quantity, scree_answer_result *out) {
  const scree_quantity *q = &a->c->quantities[quantity];
  const scree_response *r = &a->model.model.items[a->model.first[quantity]];
  scree_gp_value value = scree_gp_at(r->gp, a->nearest);
  double x[SCREE_MOST_PARAMETERS],
      all = scree_student_quantile(0.5 * (1 + one_of_all(a)), 1e6),
      half = -scree_student_quantile(0.5 * (1 - a->r->confidence), 1e6), missed;
  if (scree_check_place(a->c, x)) {
    out->check_mean =
        scree_check_mean(a->c, &a->gathered, &a->model, quantity, 0, &out->check_count);
    if (out->check_count == 0) return;
    double spread = all * sqrt(value.variance + value.noise / (double)out->check_count);
    out->check_low = value.mean - spread;
    out->check_high = value.mean + spread;
    value = (scree_gp_value){out->check_mean, value.noise / (double)out->check_count, value.noise};
  }
  missed = fmax(out->check_mean - out->check_high, out->check_low - out->check_mean);
  if (q->kind == SCREE_QUANTITY_PREDICTION && missed > 0) {
    out->counted_low = fmin(out->low, out->check_mean);
    out->counted_high = fmax(out->high, out->check_mean);
  }
  if (!q->measured) return;
  out->gap = value.mean - q->value;
  out->gap_sd = sqrt(scree_response_variance(r, &value, r->repeat_count));
  out->met = fabs(out->gap) <= half * out->gap_sd;
}

/* Least and greatest of what runs gave. */
static void describe_runs(const analysis *a, const scree_quantity *q, scree_answer_result *out) {
  size_t all = a->c->experiments[q->experiment].answer_count;
  for (size_t i = 0; i < a->gathered.run_counts[q->experiment]; i++) {
    double y = a->gathered.answers[q->experiment][i * all + q->first_answer];
    if (isnan(y)) continue;
    out->lowest = isnan(out->lowest) ? y : fmin(out->lowest, y);
    out->highest = isnan(out->highest) ? y : fmax(out->highest, y);
  }
}

static scree_status describe_answer(analysis *a, size_t quantity, draws *d) {
  const scree_quantity *q = &a->c->quantities[quantity];
  const scree_response *r = &a->model.model.items[a->model.first[quantity]];
  scree_answer_result *out = &a->r->answers[quantity];
  const char *name = q->plan->place.name ? q->plan->place.name : q->plan->answer;
  *out = (scree_answer_result){
      .name = scree_arena_text(&a->arena, name),
      .experiment = scree_arena_text(&a->arena, a->c->experiments[q->experiment].plan->place.name),
      .answer = scree_arena_text(&a->arena, q->plan->answer),
      .unit = scree_arena_text(&a->arena, q->unit),
      .measured = q->measured,
      .predicted = q->kind == SCREE_QUANTITY_PREDICTION,
      .value = q->value,
      .uncertainty = q->uncertainty,
      .scatter = q->scatter > 0 ? q->scatter : NAN,
      .repeat_count = q->repeat_count,
      .run_count = scree_gp_run_count(r->gp)};
  out->mean = out->low = out->high = out->single_low = out->single_high = out->noise = out->lowest =
      out->highest = NAN;
  out->gap = out->gap_sd = out->counted_low = out->counted_high = out->check_mean = out->check_low =
      out->check_high = out->unexplained = NAN;
  if (!out->name || !out->experiment || !out->answer || !out->unit) return fail_memory(a);
  out->missing = scree_rounds_until(a->c, q->experiment, scree_rounds_fitted(a->c)) -
                 a->gathered.waiting[q->experiment] - out->run_count;
  if (!q->x) describe_runs(a, q, out);
  if (a->r->is_search) return SCREE_OK;
  if (q->x) return describe_curve(a, quantity, d, out);
  describe_scalar(a, r, a->model.first[quantity], d, out);
  describe_check(a, quantity, out);
  return SCREE_OK;
}

static scree_status describe_answers(analysis *a) {
  size_t n = a->r->sample_count + 1;
  SCREE_SCRATCH(double, room, 3 * n, a->error);
  draws d = {room, room + n, room + 2 * n};
  a->r->answer_count = a->c->quantity_count;
  SCREE_TRY_TAKE(a->r->answers, &a->arena, a->c->quantity_count, a->error);
  for (size_t q = 0; q < a->c->quantity_count; q++) SCREE_TRY(describe_answer(a, q, &d));
  return SCREE_OK;
}

/* ---- advice ---- */

/* Expected widths after some more measurements of a quantity. */
static scree_status expect(analysis *a, size_t quantity, size_t repeats, const double *thinned,
                           size_t count, const double *now, scree_advice *out) {
  size_t d = a->c->parameter_count, chosen[SCREE_MOST_COMPONENTS];
  double sd[SCREE_MOST_PARAMETERS];
  for (size_t k = 0; k < a->model.count[quantity]; k++) chosen[k] = a->model.first[quantity] + k;
  SCREE_TRY(scree_model_expect(&a->model.model, thinned, count, chosen, a->model.count[quantity],
                               (double)repeats, sd, a->error));
  out->repeat_count = repeats;
  out->identified = 0;
  for (size_t k = 0; k < d; k++) {
    out->narrowed[k] = now[k] > 0 ? a->r->parameters[k].narrowed * sd[k] / now[k] : 0;
    out->identified += out->narrowed[k] <= identified_share;
  }
  return SCREE_OK;
}

static double mean_of(const double *values, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) sum += values[i] / (double)count;
  return sum;
}

/* As many repeats as are worth it: fewer would leave a tenth more. */
static scree_status advise(analysis *a, size_t quantity, const double *thinned, size_t count,
                           const double *now) {
  static const size_t repeats[] = {16, 8, 4, 2, 1};
  size_t d = a->c->parameter_count;
  scree_advice best = {0}, tried = {0};
  SCREE_TRY_TAKE(best.narrowed, &a->arena, d, a->error);
  SCREE_TRY_TAKE(tried.narrowed, &a->arena, d, a->error);
  SCREE_TRY(expect(a, quantity, repeats[0], thinned, count, now, &best));
  double limit = 1.1 * mean_of(best.narrowed, d);
  for (size_t i = 1; i < sizeof repeats / sizeof *repeats; i++) {
    SCREE_TRY(expect(a, quantity, repeats[i], thinned, count, now, &tried));
    if (tried.identified < best.identified || mean_of(tried.narrowed, d) > limit) break;
    scree_advice swap = best;
    best = tried;
    tried = swap;
  }
  best.name = a->r->answers[quantity].name;
  a->r->advice[a->r->advice_count++] = best;
  return SCREE_OK;
}

static scree_status advise_all(analysis *a) {
  const scree_calibration *c = a->c;
  size_t d = c->parameter_count, n = a->r->sample_count,
         count = n < MOST_ADVISED ? n : MOST_ADVISED;
  double now[SCREE_MOST_PARAMETERS] = {0};
  SCREE_SCRATCH(double, thinned, count *d, a->error);
  SCREE_TRY_TAKE(a->r->advice, &a->arena, c->quantity_count, a->error);
  for (size_t i = 0; i < count; i++)
    memcpy(thinned + i * d, a->samples + i * n / count * d, d * sizeof *thinned);
  for (size_t k = 0; k < d; k++) {
    for (size_t i = 0; i < count; i++) a->column[i] = thinned[i * d + k];
    now[k] = summarise(a->column, count, a->r->confidence).sd;
  }
  for (size_t q = 0; q < c->quantity_count; q++)
    if (c->quantities[q].kind == SCREE_QUANTITY_TARGET)
      SCREE_TRY(advise(a, q, thinned, count, now));
  for (size_t i = 1; i < a->r->advice_count; i++) /* the best first */
    for (size_t j = i;
         j > 0 && mean_of(a->r->advice[j].narrowed, d) < mean_of(a->r->advice[j - 1].narrowed, d);
         j--) {
      scree_advice swap = a->r->advice[j];
      a->r->advice[j] = a->r->advice[j - 1];
      a->r->advice[j - 1] = swap;
    }
  return SCREE_OK;
}

/* ---- history ---- */

/* What was known after some rounds: their number, then the widths. */
static scree_status look_back(analysis *a, size_t rounds, double *row) {
  size_t d = a->c->parameter_count, count;
  SCREE_CLEANUP(scree_calibration_model_free) scree_calibration_model model = {0};
  SCREE_CLEANUP(scree_free_at) double *samples = NULL;
  SCREE_TRY(scree_calibration_fit(a->c, &a->gathered, rounds, &model, a->error));
  SCREE_TRY(scree_calibration_sample(a->c, &model.model, 0, &samples, &count, a->error));
  SCREE_SCRATCH(double, scratch, count, a->error);
  for (size_t i = 0; i < a->c->run_count; i++) row[0] += a->c->runs[i].round < rounds;
  for (size_t k = 0; k < d; k++)
    row[1 + k] = narrowed(samples, count, d, k, a->r->confidence, scratch);
  return SCREE_OK;
}

static scree_status describe_history(analysis *a) {
  size_t rounds = scree_rounds_fitted(a->c), d = a->c->parameter_count;
  size_t steps = rounds < MOST_HISTORY ? rounds : MOST_HISTORY;
  SCREE_TRY_TAKE(a->r->history, &a->arena, steps * (1 + d), a->error);
  for (size_t i = 0; i < steps; i++) {
    size_t until = steps > 1 ? 1 + i * (rounds - 1) / (steps - 1) : 1;
    scree_status status = look_back(a, until, a->r->history + a->r->history_count * (1 + d));
    if (status == SCREE_OUT_OF_MEMORY) return status;
    a->r->history_count += status == SCREE_OK; /* too few runs to say anything yet */
  }
  return SCREE_OK;
}

/* ---- where the model does not give what was measured ---- */

static void judge_fit(analysis *a) {
  const scree_model *m = &a->model.model;
  double log_determinant;
  if (!scree_check_place(a->c, a->nearest))
    scree_calibration_nearest(a->c, &a->gathered, m, a->samples, a->r->sample_count, a->nearest);
  a->r->misfit_limit = scree_calibration_limit(a->c, m, a->nearest, a->samples, a->r->sample_count);
  a->r->misfit =
      a->gathered.open ? (double)NAN : scree_check_distance(a->c, &a->gathered, &a->model);
  if (isnan(a->r->misfit)) /* not checked yet */
    a->r->misfit = scree_model_distance_at(m, a->nearest, &log_determinant);
  else
    a->r->agreement = a->r->misfit <= a->r->misfit_limit ? SCREE_AGREEMENT_YES : SCREE_AGREEMENT_NO;
}

/* The fit without the measurement of a quantity: where it is, and what that one would be there. */
static scree_status refit(analysis *a, size_t quantity, scree_refit *out) {
  size_t d = a->c->parameter_count, count;
  scree_model *m = &a->model.model;
  double x[SCREE_MOST_PARAMETERS], log_determinant;
  SCREE_CLEANUP(scree_free_at) double *samples = NULL;
  SCREE_TRY(scree_calibration_sample(a->c, m, 0, &samples, &count, a->error));
  SCREE_SCRATCH(double, column, count, a->error);
  scree_calibration_nearest(a->c, &a->gathered, m, samples, count, x);
  out->fits = scree_model_distance_at(m, x, &log_determinant) <=
              scree_calibration_limit(a->c, m, x, samples, count);
  for (size_t q = 0; q < a->c->quantity_count; q++)
    out->answers[q] =
        a->c->quantities[q].x ? (double)NAN : scree_gp_mean(m->items[a->model.first[q]].gp, x);
  for (size_t k = 0; k < d; k++) {
    for (size_t i = 0; i < count; i++)
      column[i] = scree_parameter_number(&a->c->parameters[k], samples[i * d + k]);
    interval s = summarise(column, count, a->r->confidence);
    out->nearest[k] = scree_parameter_number(&a->c->parameters[k], x[k]);
    out->low[k] = out->fits ? s.low : (double)NAN;
    out->high[k] = out->fits ? s.high : (double)NAN;
  }
  if (!out->fits || a->c->quantities[quantity].x) return SCREE_OK;
  for (size_t i = 0; i < count; i++)
    column[i] = scree_gp_mean(m->items[a->model.first[quantity]].gp, samples + i * d);
  interval s = summarise(column, count, a->r->confidence);
  out->value_low = s.low;
  out->value_high = s.high;
  return SCREE_OK;
}

/* Each measurement left out in turn: which of them is at odds with the rest. */
static scree_status refit_all(analysis *a) {
  size_t d = a->c->parameter_count, n = a->c->quantity_count, measured = 0;
  for (size_t q = 0; q < n; q++) measured += a->r->answers[q].measured;
  SCREE_TRY_TAKE(a->r->refits, &a->arena, n, a->error);
  for (size_t q = 0; measured > 1 && q < n; q++) {
    scree_refit *out = &a->r->refits[a->r->refit_count];
    scree_response *first = &a->model.model.items[a->model.first[q]];
    if (!first->measured) continue;
    *out = (scree_refit){.without = a->r->answers[q].name, .value_low = NAN, .value_high = NAN};
    SCREE_TRY_TAKE(out->nearest, &a->arena, 3 * d, a->error);
    SCREE_TRY_TAKE(out->answers, &a->arena, n, a->error);
    out->low = out->nearest + d;
    out->high = out->low + d;
    for (size_t k = 0; k < a->model.count[q]; k++) first[k].measured = false;
    scree_status status = refit(a, q, out);
    for (size_t k = 0; k < a->model.count[q]; k++) first[k].measured = true;
    SCREE_TRY(status);
    a->r->refit_count++;
  }
  return SCREE_OK;
}

/* Nothing is fitted, so nothing is said to follow: no interval, no prediction, no sample. */
static scree_status describe_misfit(analysis *a) {
  for (size_t q = 0; q < a->r->answer_count; q++) {
    scree_answer_result *out = &a->r->answers[q];
    out->mean = out->low = out->high = out->single_low = out->single_high = NAN;
    out->counted_low = out->counted_high = NAN;
    out->inside = false;
  }
  a->r->sample_count = 0;
  return refit_all(a);
}

/* ---- runs and inputs ---- */

static scree_status list_runs(analysis *a) {
  const scree_calibration *c = a->c;
  size_t d = c->parameter_count, *next;
  SCREE_TRY_TAKE(a->r->runs, &a->arena, c->run_count, a->error);
  SCREE_TRY_TAKE(next, &a->arena, c->experiment_count, a->error);
  memset(next, 0, c->experiment_count * sizeof *next);
  for (size_t i = 0; i < c->run_count; i++) {
    const scree_planned_run *p = &c->runs[i];
    const scree_experiment_plan *e = &c->experiments[p->experiment];
    const double *answers =
        a->gathered.answers[p->experiment] + next[p->experiment]++ * e->answer_count;
    scree_calibration_run *out = &a->r->runs[a->r->run_count];
    bool any = false;
    *out = (scree_calibration_run){.experiment = scree_arena_text(&a->arena, e->plan->place.name),
                                   .seed = p->seed,
                                   .check = c->checked && p->round == scree_rounds_fitted(c)};
    SCREE_TRY_TAKE(out->values, &a->arena, d + c->quantity_count, a->error);
    out->answers = out->values + d;
    if (!out->experiment) return fail_memory(a);
    for (size_t k = 0; k < d; k++)
      out->values[k] = scree_parameter_number(&c->parameters[k], p->x[k]);
    for (size_t q = 0; q < c->quantity_count; q++) {
      const scree_quantity *quantity = &c->quantities[q];
      bool has = quantity->experiment == p->experiment && !isnan(answers[quantity->first_answer]);
      out->answers[q] = has && !quantity->x ? answers[quantity->first_answer] : (double)NAN;
      any = any || has;
    }
    a->r->run_count += any;
  }
  return SCREE_OK;
}

static scree_status add_input(analysis *a, const char *path) {
  scree_input *out = &a->r->origin.inputs[a->r->origin.input_count++];
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  size_t size = 0;
  *out = (scree_input){.path = scree_arena_text(&a->arena, path)};
  if (!out->path) return fail_memory(a);
  if (scree_file_read(path, LARGEST_INPUT, &bytes, &size, NULL) == SCREE_OK)
    out->checksum = scree_checksum_of(bytes, size);
  return SCREE_OK;
}

/* The calibration's file, its scenes, and the files that its commands name beside it. */
static scree_status list_inputs(analysis *a) {
  const scree_calibration *c = a->c;
  size_t most = 1 + c->experiment_count;
  for (size_t e = 0; e < c->experiment_count; e++) most += c->experiments[e].plan->command.count;
  SCREE_TRY_TAKE(a->r->origin.inputs, &a->arena, most, a->error);
  SCREE_TRY(add_input(a, c->path));
  for (size_t e = 0; e < c->experiment_count; e++) {
    const scree_texts *words = &c->experiments[e].plan->command;
    if (c->experiments[e].scene_path) SCREE_TRY(add_input(a, c->experiments[e].scene_path));
    for (size_t i = 0; i < words->count; i++) {
      char path[SCREE_PATH_BYTES];
      if (!strstr(words->items[i], "{here}")) continue;
      scree_calibration_word(c, words->items[i], path, sizeof path);
      if (scree_path_exists(path)) SCREE_TRY(add_input(a, path));
    }
  }
  return SCREE_OK;
}

/* ---- the whole ---- */

/* As given; else what it seeks: "friction, rolling by heap, tray". */
static const char *title_of(analysis *a) {
  const scree_calibration *c = a->c;
  char text[300] = "";
  if (c->plan.title) return scree_arena_text(&a->arena, c->plan.title);
  for (size_t k = 0; k < c->parameter_count; k++)
    scree_add_text(text, sizeof text, "%s%.60s", k ? ", " : "", c->parameters[k].place.name);
  for (size_t e = 0; e < c->experiment_count; e++)
    scree_add_text(text, sizeof text, "%s%.60s", e ? ", " : " by ",
                   c->experiments[e].plan->place.name);
  return scree_arena_text(&a->arena, text);
}

static scree_status start(analysis *a, scree_calibration *c) {
  SCREE_TRY(scree_rounds_read(c, a->error));
  SCREE_TRY(scree_gather(c, &a->gathered, a->error));
  if (c->round_count == 0)
    return scree_fail(a->error, SCREE_BAD_ARGUMENT, "%s: no run has been made yet", c->folder);
  SCREE_TRY(scree_calibration_fit(c, &a->gathered, scree_rounds_fitted(c), &a->model, a->error));
  const char *end;
  scree_calibration_result *r = a->r;
  SCREE_TRY(scree_rounds_end(c, &end, a->error));
  r->progress = scree_calibration_stands(c, &a->gathered);
  r->title = title_of(a);
  r->version = scree_version();
  r->stopped = *end && a->gathered.open == 0 ? scree_arena_text(&a->arena, end) : NULL;
  r->is_search = scree_calibration_is_search(c);
  r->maximise = c->plan.maximise != NULL;
  r->confidence = c->plan.confidence;
  r->seed = c->plan.seed;
  r->origin.started = a->gathered.started;
  r->origin.ended = a->gathered.ended;
  r->origin.machine = scree_arena_text(&a->arena, a->gathered.machine);
  if (!r->origin.machine) return fail_memory(a);
  SCREE_TRY(list_inputs(a));
  SCREE_TRY(list_runs(a));
  r->failure_count = a->gathered.failure_count;
  SCREE_TRY_TAKE(r->failures, &a->arena, r->failure_count + 1, a->error);
  if (!r->title) return fail_memory(a);
  for (size_t i = 0; i < r->failure_count; i++)
    if (!(r->failures[i] = scree_arena_text(&a->arena, a->gathered.failures[i])))
      return fail_memory(a);
  return SCREE_OK;
}

static scree_status calibrate(analysis *a) {
  scree_calibration_result *r = a->r;
  SCREE_TRY(
      scree_calibration_sample(a->c, &a->model.model, 1, &a->samples, &r->sample_count, a->error));
  SCREE_TRY_ALLOC(a->column, r->sample_count, a->error);
  judge_fit(a);
  a->unanswered = find_unanswered(a);
  SCREE_TRY(describe_parameters(a));
  SCREE_TRY(describe_answers(a));
  if (r->agreement == SCREE_AGREEMENT_NO) return describe_misfit(a);
  SCREE_TRY(find_trades(a));
  SCREE_TRY(advise_all(a));
  return describe_history(a);
}

static scree_status search(analysis *a) {
  SCREE_TRY(describe_parameters(a));
  SCREE_TRY(describe_answers(a));
  return scree_search_describe(a->c, &a->model, &a->gathered, &a->arena, a->r, a->error);
}

static void free_analysis(analysis *a) {
  scree_calibration_model_free(&a->model);
  scree_answers_free(&a->gathered);
  scree_free(a->samples);
  scree_free(a->column);
  scree_arena_free(&a->arena);
}

scree_status scree_calibration_analyse(scree_calibration *calibration,
                                       scree_calibration_result *result, scree_error *error) {
  scree_calibration_result made = {0};
  SCREE_CLEANUP(free_analysis) analysis a = {.c = calibration, .r = &made, .error = error};
  if (!calibration->folder)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the calibration is not opened");
  SCREE_TRY(start(&a, calibration));
  SCREE_TRY(made.is_search ? search(&a) : calibrate(&a));
  scree_arena *kept;
  SCREE_TRY_ALLOC(kept, 1, error);
  *kept = a.arena;
  a.arena = (scree_arena){0};
  made.memory = kept;
  *result = made;
  return SCREE_OK;
}

void scree_calibration_result_free(scree_calibration_result *result) {
  if (!result || !result->memory) return;
  scree_arena_free(result->memory);
  scree_free(result->memory);
  *result = (scree_calibration_result){0};
}
