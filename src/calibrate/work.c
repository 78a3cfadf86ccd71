/* The loop of a worker: take runs, wait for those of others, plan the next ones. */
#include "base/platform.h"
#include "calibrate/calibration.h"
#include "calibrate/model.h"
#include "study/design.h"
#include "study/lease.h"

#include <string.h>

/* More runs do not narrow a posterior whose width is that of the measurements: it ends when this
 * share of the variance, at most, is the emulators'. */
static const double settled_share = 0.03;
/* Runs of a check, and checks: each at another setting that the model then holds for possible. */
enum { REFERENCE = 128, CHECKS = 3, MOST_CHECKS = 4 };

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
  SCREE_SCRATCH(double, made, *count *d, error);
  SCREE_TRY(scree_ensemble_sample(&e, made, error));
  for (size_t i = 0; i < *count * d; i++)
    made[i] = scree_parameter_snap(&c->parameters[i % d], made[i]);
  *samples = made;
  made = NULL;
  return SCREE_OK;
}

/* ---- planning ---- */

/* Points of Sobol's sequence, every second one twice: the replicates tell the scatter. */
static scree_status plan_start(scree_calibration *c, scree_error *error) {
  size_t d = c->parameter_count, count = 0;
  SCREE_SCRATCH(scree_place_pick, picks, SCREE_GP_MOST_PLACES * 2, error);
  SCREE_SCRATCH(double, unit, SCREE_GP_MOST_PLACES *d, error);
  for (size_t e = 0; e < c->experiment_count; e++) {
    size_t points = scree_calibration_start(c, e);
    scree_design_sobol(c->plan.seed + e, points, d, unit);
    for (size_t i = 0; i < points; i++)
      for (size_t twin = 0; twin < 1 + i % 2; twin++) {
        picks[count].experiment = e;
        for (size_t k = 0; k < d; k++) picks[count].x[k] = 2 * unit[i * d + k] - 1;
        count++;
      }
  }
  return scree_rounds_add(c, picks, count, false, 0, error);
}

static scree_status ask(const scree_calibration *c, const scree_calibration_model *m,
                        const scree_answers *g, size_t count, scree_place_pick *picks, double *left,
                        scree_error *error) {
  size_t d = c->parameter_count, sample_count;
  SCREE_CLEANUP(scree_free_at) double *samples = NULL;
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
  return scree_model_next(&m->model, &q, count, picks, left, error);
}

/* Some runs of every experiment at x: what they give shows whether the model gives what was
 * measured, and whether what is expected can be relied on. They come on top of the budget. */
static scree_status plan_check(scree_calibration *c, const double *x, double begun,
                               scree_error *error) {
  size_t count = CHECKS * c->experiment_count;
  SCREE_SCRATCH(scree_place_pick, picks, count, error);
  for (size_t i = 0; i < count; i++) {
    picks[i].experiment = i / CHECKS;
    memcpy(picks[i].x, x, c->parameter_count * sizeof *x);
  }
  return scree_rounds_add(c, picks, count, true, scree_processor_time() - begun, error);
}

/* The most probable place, and how far is too far. */
static scree_status find_nearest(const scree_calibration *c, const scree_answers *g,
                                 const scree_calibration_model *m, double *x, double *limit,
                                 scree_error *error) {
  size_t count;
  SCREE_CLEANUP(scree_free_at) double *samples = NULL;
  SCREE_TRY(scree_calibration_sample(c, &m->model, 0, &samples, &count, error));
  scree_calibration_nearest(c, g, &m->model, samples, count, x);
  *limit = scree_calibration_limit(c, &m->model, x, samples, count);
  return SCREE_OK;
}

/* After a check: where it misses what was measured and the model, which learns of it, holds another
 * setting for possible, that one is checked. */
static scree_status plan_after_check(scree_calibration *c, const scree_answers *g,
                                     const scree_calibration_model *m, const char *reason,
                                     scree_error *error) {
  double begun = scree_processor_time(), x[SCREE_MOST_PARAMETERS], limit, log_determinant;
  SCREE_CLEANUP(scree_calibration_model_free) scree_calibration_model all = {0};
  SCREE_TRY(find_nearest(c, g, m, x, &limit, error));
  bool over = c->check_rounds >= MOST_CHECKS || scree_check_distance(c, g, m) <= limit;
  if (!over) {
    SCREE_TRY(scree_calibration_fit(c, g, c->round_count, &all, error));
    SCREE_TRY(find_nearest(c, g, &all, x, &limit, error));
    over = scree_model_distance_at(&all.model, x, &log_determinant) > limit;
  }
  if (!over) return plan_check(c, x, begun, error);
  return scree_rounds_stop(c, reason, scree_processor_time() - begun, error);
}

static scree_status plan_next(scree_calibration *c, const scree_answers *g, size_t batch,
                              scree_error *error) {
  double begun = scree_processor_time(), left = 1, x[SCREE_MOST_PARAMETERS], limit;
  const scree_plan_budget *budget = c->plan.budget;
  size_t made = c->run_count - c->check_rounds * CHECKS * c->experiment_count,
         count = made < budget->runs ? budget->runs - made : 0;
  if (count > batch) count = batch;
  bool spent = count == 0 || g->seconds > budget->time, search = scree_calibration_is_search(c);
  const char *reason = spent ? "the budget is spent" : "more runs would tell no more";
  if (spent && search) return scree_rounds_stop(c, reason, 0, error);
  SCREE_CLEANUP(scree_calibration_model_free) scree_calibration_model m = {0};
  scree_error why;
  scree_status status = scree_calibration_fit(c, g, scree_rounds_fitted(c), &m, &why);
  if (status != SCREE_OK)
    return scree_fail(error, status, "%.400s%s%.500s", why.message,
                      g->failure_count ? "; of those that failed: " : "",
                      g->failure_count ? g->failures[0] : "");
  if (c->checked) return plan_after_check(c, g, &m, reason, error);
  SCREE_SCRATCH(scree_place_pick, picks, count + 1, error);
  if (search)
    SCREE_TRY(scree_search_next(c, &m, g, &count, picks, &left, error));
  else if (!spent)
    SCREE_TRY(ask(c, &m, g, count, picks, &left, error));
  double seconds = scree_processor_time() - begun;
  if (left >= settled_share && !spent)
    return scree_rounds_add(c, picks, count, false, seconds, error);
  if (search) return scree_rounds_stop(c, reason, seconds, error);
  SCREE_TRY(find_nearest(c, g, &m, x, &limit, error));
  return plan_check(c, x, begun, error);
}

/* Under the lease, if nobody else has it; what others have planned by now is left as it is. */
static scree_status plan(scree_calibration *c, size_t batch, const scree_study_options *o,
                         const scree_answers *g, bool *taken, scree_error *error) {
  char worker[SCREE_LEASE_NAME];
  scree_lease lease;
  size_t rounds = c->round_count;
  scree_lease_default_worker(worker);
  SCREE_TRY(scree_lease_take(SCREE_PATH_IN(c->folder, "rounds"), "plan", o->lease_s,
                             o->worker ? o->worker : worker, taken, &lease, error));
  if (!*taken) return SCREE_OK;
  scree_status status = scree_rounds_read(c, error);
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
  options.wait = false;
  for (size_t e = 0; e < c->experiment_count; e++) {
    SCREE_OWNED(scree_study, study);
    SCREE_TRY(scree_rounds_study(c, e, &study, error));
    if (study) SCREE_TRY(scree_study_work(study, &options, progress, NULL, error));
  }
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
    SCREE_CLEANUP(scree_answers_free) scree_answers g = {0};
    bool planned = false;
    SCREE_TRY(scree_rounds_read(c, error));
    SCREE_TRY(work_on_runs(c, o, progress, error));
    SCREE_TRY(scree_gather(c, &g, error));
    SCREE_TRY(scree_rounds_end(c, &end, error));
    if (g.open == 0 && *end) return SCREE_OK;
    if (g.open == 0) SCREE_TRY(plan(c, batch, o, &g, &planned, error));
    if (planned) continue;
    if (!o->wait) return SCREE_OK;
    SCREE_TRY(scree_study_pause(o, progress, "others work on what is left", error));
  }
}

scree_status scree_calibration_look(scree_calibration *c, scree_calibration_progress *progress,
                                    scree_error *error) {
  SCREE_CLEANUP(scree_answers_free) scree_answers g = {0};
  if (!c->folder) return scree_fail(error, SCREE_BAD_ARGUMENT, "the calibration is not opened");
  SCREE_TRY(scree_rounds_read(c, error));
  SCREE_TRY(scree_gather(c, &g, error));
  *progress = scree_calibration_stands(c, &g);
  return SCREE_OK;
}

scree_calibration_progress scree_calibration_stands(const scree_calibration *c,
                                                    const scree_answers *g) {
  return (scree_calibration_progress){.rounds = c->round_count,
                                      .run_count = c->run_count,
                                      .done = g->done,
                                      .failed = g->failed,
                                      .budget = c->plan.budget->runs,
                                      .seconds = g->seconds,
                                      .planning_seconds = scree_rounds_seconds(c)};
}
