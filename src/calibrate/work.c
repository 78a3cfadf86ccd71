/* The loop of a worker: take runs, wait for those of others, plan the next ones. */
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "calibrate/calibration.h"
#include "calibrate/ensemble.h"
#include "study/design.h"
#include "study/lease.h"

#include <string.h>

/* More runs do not narrow a posterior whose width is that of the measurements: it ends when this
 * share of the variance, at most, is the emulators'. */
static const double settled_share = 0.03;
enum { REFERENCE = 128, CHECKS = 3 };

/* ---- the posterior ---- */

typedef struct density {
  const scree_calibration *c;
  const scree_model *model;
} density;

static double log_density(const void *context, const double *x) {
  const density *p = context;
  double snapped[SCREE_MOST_PARAMETERS];
  for (size_t k = 0; k < p->c->parameter_count; k++)
    snapped[k] = scree_parameter_snap(&p->c->parameters[k], x[k]);
  return scree_model_log_likelihood(p->model, snapped);
}

scree_status scree_calibration_sample(const scree_calibration *c, const scree_model *model,
                                      int effort, double **samples, size_t *count,
                                      scree_error *error) {
  density p = {c, model};
  size_t d = c->parameter_count;
  scree_ensemble e = {.density = log_density,
                      .context = &p,
                      .dimension_count = d,
                      .walker_count = 4 * (d + 1) < 32 ? 32 : 4 * (d + 1),
                      .first_steps = effort ? 300 : 80,
                      .steps = effort ? 1000 : 80,
                      .thin = effort ? 10 : 20,
                      .seed = c->plan.seed};
  *count = scree_ensemble_count(&e);
  *samples = scree_alloc(*count * d, sizeof **samples);
  if (!*samples) return scree_fail_memory(error, 0, "samples");
  scree_status status = scree_ensemble_sample(&e, *samples, error);
  for (size_t i = 0; status == SCREE_OK && i < *count * d; i++)
    (*samples)[i] = scree_parameter_snap(&c->parameters[i % d], (*samples)[i]);
  if (status != SCREE_OK) {
    scree_free(*samples);
    *samples = NULL;
  }
  return status;
}

/* ---- planning ---- */

/* Points of Sobol's sequence, every second one twice: the replicates tell the scatter. */
static scree_status plan_start(scree_calibration *c, scree_error *error) {
  size_t d = c->parameter_count, count = 0;
  scree_place_pick *picks = scree_alloc(SCREE_GP_MOST_PLACES * 2, sizeof *picks);
  double *unit = scree_alloc(SCREE_GP_MOST_PLACES * d, sizeof *unit);
  scree_status status = picks && unit ? SCREE_OK : scree_fail_memory(error, 0, "the first runs");
  for (size_t e = 0; status == SCREE_OK && e < c->experiment_count; e++) {
    size_t points = scree_calibration_start(c, e);
    scree_design_sobol(c->plan.seed + e, points, d, unit);
    for (size_t i = 0; i < points; i++)
      for (size_t twin = 0; twin < 1 + i % 2; twin++) {
        picks[count].experiment = e;
        for (size_t k = 0; k < d; k++) picks[count].x[k] = 2 * unit[i * d + k] - 1;
        count++;
      }
  }
  if (status == SCREE_OK) status = scree_rounds_add(c, picks, count, false, 0, error);
  scree_free(picks);
  scree_free(unit);
  return status;
}

static scree_status ask(const scree_calibration *c, const scree_calibration_model *m,
                        const scree_answers *g, size_t count, scree_place_pick *picks, double *left,
                        scree_error *error) {
  size_t d = c->parameter_count, sample_count;
  double *samples;
  SCREE_TRY(scree_calibration_sample(c, &m->model, 0, &samples, &sample_count, error));
  if (sample_count > REFERENCE) { /* those of the last steps, which have forgotten the start */
    memmove(samples, samples + (sample_count - REFERENCE) * d, REFERENCE * d * sizeof *samples);
    sample_count = REFERENCE;
  }
  scree_next_question q = {.samples = samples,
                           .sample_count = sample_count,
                           .experiment_count = c->experiment_count,
                           .places = (const double *const *)g->x,
                           .place_counts = g->run_counts,
                           .costs = g->costs};
  scree_status status = scree_model_next(&m->model, &q, count, picks, left, error);
  scree_free(samples);
  return status;
}

/* The coordinate of the mean over the posterior, of a list of the value nearest to it. */
static double answer_at(const scree_calibration *c, size_t k, const double *samples, size_t count) {
  const scree_plan_parameter *p = &c->parameters[k];
  char number[SCREE_NUMBER_SIZE];
  double mean = 0;
  for (size_t i = 0; i < count; i++) {
    double x = samples[i * c->parameter_count + k];
    mean += (p->values.count ? x : scree_parameter_value(p, x)) / (double)count;
  }
  if (p->values.count) return scree_parameter_snap(p, mean);
  scree_number_format_digits(mean, 9, number);
  return scree_parameter_coordinate(p, number);
}

/* Some runs of every experiment at the answer: what they give beside what is expected of them shows
 * whether it can be relied on. They come on top of the budget. */
static scree_status plan_check(scree_calibration *c, const scree_calibration_model *m, double begun,
                               scree_error *error) {
  size_t d = c->parameter_count, sample_count, count = CHECKS * c->experiment_count;
  double *samples;
  scree_status status = scree_calibration_sample(c, &m->model, 1, &samples, &sample_count, error);
  if (status != SCREE_OK) return status;
  scree_place_pick *picks = scree_alloc(count, sizeof *picks);
  if (!picks) status = scree_fail_memory(error, 0, "the check at the answer");
  for (size_t i = 0; status == SCREE_OK && i < count; i++) {
    picks[i].experiment = i / CHECKS;
    for (size_t k = 0; k < d; k++) picks[i].x[k] = answer_at(c, k, samples, sample_count);
  }
  if (status == SCREE_OK)
    status = scree_rounds_add(c, picks, count, true, scree_processor_time() - begun, error);
  scree_free(picks);
  scree_free(samples);
  return status;
}

static scree_status plan_next(scree_calibration *c, const scree_answers *g, size_t batch,
                              scree_error *error) {
  double begun = scree_processor_time(), left = 1;
  const scree_plan_budget *budget = c->plan.budget;
  size_t count = c->run_count < budget->runs ? budget->runs - c->run_count : 0;
  if (count > batch) count = batch;
  bool spent = count == 0 || g->seconds > budget->time,
       last = c->checked || scree_calibration_is_search(c);
  const char *reason = spent ? "the budget is spent" : NULL;
  if (spent && last) return scree_rounds_stop(c, reason, 0, error);
  scree_calibration_model m;
  scree_error why;
  scree_status status = scree_calibration_fit(c, g, scree_rounds_fitted(c), &m, &why);
  if (status != SCREE_OK)
    return scree_fail(error, status, "%.400s%s%.500s", why.message,
                      g->failure_count ? "; of those that failed: " : "",
                      g->failure_count ? g->failures[0] : "");
  scree_place_pick *picks = scree_alloc(count + 1, sizeof *picks);
  if (!picks)
    status = scree_fail_memory(error, 0, "the next runs");
  else if (scree_calibration_is_search(c))
    status = scree_search_next(c, &m, g, count, picks, &left, error);
  else if (!spent)
    status = ask(c, &m, g, count, picks, &left, error);
  if (left < settled_share && !spent) reason = "more runs would tell no more";
  double seconds = scree_processor_time() - begun;
  if (status == SCREE_OK && !reason)
    status = scree_rounds_add(c, picks, count, false, seconds, error);
  else if (status == SCREE_OK)
    status = last ? scree_rounds_stop(c, reason, seconds, error) : plan_check(c, &m, begun, error);
  scree_free(picks);
  scree_calibration_model_free(c, &m);
  return status;
}

/* Under the lease, if nobody else has it; what others have planned by now is left as it is. */
static scree_status plan(scree_calibration *c, size_t batch, const scree_study_options *o,
                         const scree_answers *g, bool *taken, scree_error *error) {
  char worker[SCREE_LEASE_NAME];
  scree_lease lease;
  size_t rounds = c->round_count;
  char *folder = scree_calibration_path(c, "rounds");
  if (!folder) return scree_fail_memory(error, 0, "a path");
  scree_lease_default_worker(worker);
  scree_status status = scree_lease_take(folder, "plan", o->lease_s, o->worker ? o->worker : worker,
                                         taken, &lease, error);
  scree_free(folder);
  if (status != SCREE_OK || !*taken) return status;
  status = scree_rounds_read(c, error);
  if (status == SCREE_OK && c->round_count == rounds)
    status = rounds == 0 ? plan_start(c, error) : plan_next(c, g, batch, error);
  scree_lease_release(&lease);
  return status;
}

/* ---- working ---- */

/* Runs of all experiments that nobody has. */
static scree_status work_on_runs(const scree_calibration *c, const scree_study_options *o,
                                 const scree_progress *progress, scree_error *error) {
  scree_study_options options = *o;
  scree_status status = SCREE_OK;
  options.wait = false;
  for (size_t e = 0; status == SCREE_OK && e < c->experiment_count; e++) {
    scree_study *study;
    status = scree_rounds_study(c, e, &study, error);
    if (status == SCREE_OK && study)
      status = scree_study_work(study, &options, progress, NULL, error);
    scree_study_free(study);
  }
  return status;
}

static scree_status pause(const scree_study_options *o, const scree_progress *p,
                          scree_error *error) {
  scree_sleep(o->poll_s);
  if (p && p->report && !p->report(p->context, "others work on what is left", 0))
    return scree_fail(error, SCREE_CANCELLED, "cancelled");
  return SCREE_OK;
}

scree_status scree_calibration_work(scree_calibration *c, size_t batch,
                                    const scree_study_options *options,
                                    const scree_progress *progress, scree_error *error) {
  const scree_study_options defaults = scree_default_study_options(),
                            *o = options ? options : &defaults;
  if (!c->folder)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a calibration must be opened before work on it");
  if (batch < c->plan.batch) batch = c->plan.batch;
  for (;;) {
    const char *end;
    scree_answers g = {0};
    bool planned = false;
    scree_status status = scree_rounds_read(c, error);
    if (status == SCREE_OK) status = work_on_runs(c, o, progress, error);
    if (status == SCREE_OK) status = scree_gather(c, &g, error);
    if (status == SCREE_OK) status = scree_rounds_end(c, &end, error);
    bool ended = status == SCREE_OK && g.open == 0 && *end;
    if (status == SCREE_OK && !ended && g.open == 0)
      status = plan(c, batch, o, &g, &planned, error);
    bool others = g.open > 0 || !planned;
    scree_answers_free(&g);
    if (status != SCREE_OK || ended || (others && !o->wait)) return status;
    if (others) status = pause(o, progress, error);
    if (status != SCREE_OK) return status;
  }
}

scree_status scree_calibration_look(scree_calibration *c, scree_calibration_progress *progress,
                                    scree_error *error) {
  scree_answers g;
  if (!c->folder) return scree_fail(error, SCREE_BAD_ARGUMENT, "the calibration is not opened");
  scree_status status = scree_rounds_read(c, error);
  if (status == SCREE_OK) status = scree_gather(c, &g, error);
  if (status != SCREE_OK) return status;
  *progress = (scree_calibration_progress){.rounds = c->round_count,
                                           .run_count = c->run_count,
                                           .done = g.done,
                                           .failed = g.failed,
                                           .budget = c->plan.budget->runs,
                                           .seconds = g.seconds,
                                           .planning_seconds = scree_rounds_seconds(c)};
  scree_answers_free(&g);
  return SCREE_OK;
}
