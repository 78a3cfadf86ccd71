/* From records of runs to Gaussian processes. */
#include "base/parallel.h"
#include "base/platform.h"
#include "calibrate/calibration.h"
#include "study/record.h"

#include <math.h>
#include <string.h>

/* ---- records ---- */

void scree_answers_free(scree_answers *g) {
  for (size_t e = 0; e < g->experiment_count; e++) {
    if (g->x) scree_free(g->x[e]);
    if (g->answers) scree_free(g->answers[e]);
  }
  for (size_t i = 0; i < g->failure_count; i++) scree_free(g->failures[i]);
  scree_free(g->failures);
  scree_free(g->run_counts);
  scree_free(g->waiting);
  scree_free(g->x);
  scree_free(g->answers);
  scree_free(g->costs);
  *g = (scree_answers){0};
}

static scree_status note_failure(scree_answers *g, const char *reason, scree_error *error) {
  g->failed++;
  for (size_t i = 0; i < g->failure_count; i++)
    if (!strcmp(g->failures[i], reason)) return SCREE_OK;
  char **more = scree_resize(g->failures, g->failure_count + 1, sizeof *more);
  if (more) g->failures = more;
  if (!more || !(more[g->failure_count] = scree_strdup(reason)))
    return scree_fail_memory(error, 0, "failures");
  g->failure_count++;
  return SCREE_OK;
}

/* The work of a run that no clock tells: bodies times steps. */
static double work_of(const scree_study_record *r) {
  return (double)r->costs.step_count * (double)(r->result.body_count + r->result.left_count + 1);
}

static scree_status take_record(scree_answers *g, size_t experiment, const scree_study *study,
                                size_t run, double *work, scree_error *error) {
  SCREE_CLEANUP(scree_study_record_free) scree_study_record record = {0};
  char mark[SCREE_CHECKSUM_TEXT];
  double *answers = g->answers[experiment] + run * study->answer_count;
  const char *path = SCREE_STUDY_PATH(study, "results", study->keys[run], ".yaml");
  bool there = scree_path_exists(path);
  scree_status status = there ? scree_study_record_read(path, &record, error) : SCREE_OK;
  if (status == SCREE_BAD_FILE) there = false; /* the next worker puts it aside */
  if (there) SCREE_TRY(status);
  scree_study_answers_mark(study, mark); /* or takes its answers anew */
  if (!there || (!record.failed && strcmp(mark, record.answered) != 0)) {
    g->open++;
    return SCREE_OK;
  }
  for (size_t a = 0; !record.failed && a < study->answer_count; a++)
    if (a < record.answer_count) answers[a] = record.answers[a];
  g->seconds += record.costs.processor_seconds;
  if (g->started == 0 || record.started < g->started) g->started = record.started;
  if (record.ended >= g->ended) {
    g->ended = record.ended;
    memcpy(g->machine, record.machine, sizeof g->machine);
  }
  *work += work_of(&record);
  if (record.failed) return note_failure(g, record.reason, error);
  g->done++;
  return SCREE_OK;
}

static scree_status gather_experiment(const scree_calibration *c, size_t e, scree_answers *g,
                                      scree_error *error) {
  SCREE_OWNED(scree_study, study);
  SCREE_TRY(scree_rounds_study(c, e, &study, error));
  if (!study) return SCREE_OK;
  size_t count = scree_study_run_count(study), n = 0, d = c->parameter_count;
  double work = 0;
  SCREE_TRY_ALLOC(g->x[e], count * d, error);
  SCREE_TRY_ALLOC(g->answers[e], count * study->answer_count, error);
  g->run_counts[e] = count;
  for (size_t i = 0; i < count * study->answer_count; i++) g->answers[e][i] = NAN;
  for (size_t i = 0; i < c->run_count; i++) {
    if (c->runs[i].experiment != e) continue;
    memcpy(g->x[e] + n * d, c->runs[i].x, d * sizeof(double));
    size_t open = g->open;
    SCREE_TRY(take_record(g, e, study, n, &work, error));
    if (c->runs[i].round < scree_rounds_fitted(c)) g->waiting[e] += g->open - open;
    n++;
  }
  g->costs[e] = work > 0 ? work / (double)count : 1;
  return SCREE_OK;
}

/* Costs as the file has them; where it has none of a command, nothing is known of any. */
static void settle_costs(const scree_calibration *c, scree_answers *g) {
  bool unknown = false;
  for (size_t e = 0; e < c->experiment_count; e++)
    unknown =
        unknown || c->experiments[e].plan->command.count || !isnan(c->experiments[e].plan->cost);
  for (size_t e = 0; e < c->experiment_count; e++) {
    if (unknown) g->costs[e] = 1;
    if (!isnan(c->experiments[e].plan->cost)) g->costs[e] = c->experiments[e].plan->cost;
  }
}

scree_status scree_gather(const scree_calibration *c, scree_answers *gathered, scree_error *error) {
  SCREE_CLEANUP(scree_answers_free) scree_answers g = {.experiment_count = c->experiment_count};
  size_t n = c->experiment_count;
  SCREE_TRY_ALLOC_ZERO(g.run_counts, n, error);
  SCREE_TRY_ALLOC_ZERO(g.waiting, n, error);
  SCREE_TRY_ALLOC_ZERO(g.x, n, error);
  SCREE_TRY_ALLOC_ZERO(g.answers, n, error);
  SCREE_TRY_ALLOC_ZERO(g.costs, n, error);
  for (size_t e = 0; e < n; e++) SCREE_TRY(gather_experiment(c, e, &g, error));
  settle_costs(c, &g);
  *gathered = g;
  g = (scree_answers){0};
  return SCREE_OK;
}

/* ---- the model ---- */

void scree_calibration_model_free(scree_calibration_model *m) {
  for (size_t q = 0; m->bases && q < m->quantity_count; q++) scree_curve_basis_free(&m->bases[q]);
  scree_free(m->bases);
  scree_free(m->first);
  scree_free(m->count);
  scree_model_free(&m->model);
  *m = (scree_calibration_model){0};
}

typedef struct fitting {
  const scree_calibration *c;
  const scree_answers *g;
  scree_calibration_model *m;
  size_t *run_counts; /* of the rounds looked at */
  double **y;         /* of every response */
  scree_status *status;
  scree_error *errors;
} fitting;

static void fit_some(void *context, scree_block block) {
  fitting *f = context;
  for (size_t i = block.begin; i < block.end; i++) {
    scree_response *r = &f->m->model.items[i];
    const scree_experiment_plan *e = &f->c->experiments[r->experiment];
    scree_gp_runs runs = {f->run_counts[r->experiment],
                          f->c->parameter_count,
                          f->g->x[r->experiment],
                          f->y[i],
                          e->active,
                          e->active_count};
    f->status[i] = scree_gp_fit(&runs, &r->gp, &f->errors[i]);
  }
}

static void describe(const scree_quantity *q, scree_response *r) {
  *r = (scree_response){.experiment = q->experiment,
                        .measured = q->measured && q->kind == SCREE_QUANTITY_TARGET,
                        .predicted = q->kind == SCREE_QUANTITY_PREDICTION,
                        .value = q->value,
                        .uncertainty = q->uncertainty,
                        .scatter = q->scatter,
                        .repeat_count = q->repeat_count};
}

/* The answers of a quantity's response, of every run. */
static scree_status take_answers(fitting *f, size_t quantity, size_t component, double **y,
                                 scree_error *error) {
  const scree_quantity *q = &f->c->quantities[quantity];
  size_t all = f->c->experiments[q->experiment].answer_count, n = f->run_counts[q->experiment];
  SCREE_TRY_ALLOC(*y, n, error);
  for (size_t i = 0; i < n; i++) {
    const double *answers = f->g->answers[q->experiment] + i * all + q->first_answer;
    (*y)[i] = q->x ? scree_curve_score(&f->m->bases[quantity], component, answers) : answers[0];
  }
  return SCREE_OK;
}

static scree_status make_basis(fitting *f, size_t quantity, scree_error *error) {
  const scree_quantity *q = &f->c->quantities[quantity];
  size_t all = f->c->experiments[q->experiment].answer_count, n = f->run_counts[q->experiment];
  SCREE_SCRATCH(double, curves, n * q->answer_count, error);
  for (size_t i = 0; i < n; i++)
    memcpy(curves + i * q->answer_count, f->g->answers[q->experiment] + i * all + q->first_answer,
           q->answer_count * sizeof *curves);
  return scree_curve_basis_make(curves, n, q->answer_count, &f->m->bases[quantity], error);
}

/* Responses without their processes, and their answers. */
static scree_status lay_out(fitting *f, scree_error *error) {
  const scree_calibration *c = f->c;
  scree_calibration_model *m = f->m;
  for (size_t q = 0; q < c->quantity_count; q++) {
    const scree_quantity *quantity = &c->quantities[q];
    m->first[q] = m->model.count;
    m->count[q] = 1;
    if (quantity->x) {
      SCREE_TRY(make_basis(f, q, error));
      m->count[q] = m->bases[q].component_count;
    }
    for (size_t k = 0; k < m->count[q]; k++) {
      scree_response *r = &m->model.items[m->model.count];
      describe(quantity, r);
      if (quantity->x) r->value = scree_curve_score(&m->bases[q], k, quantity->y);
      SCREE_TRY(take_answers(f, q, k, &f->y[m->model.count], error));
      m->model.count++;
    }
  }
  return SCREE_OK;
}

/* Names the quantity that cannot be fitted. */
static scree_status tell(const fitting *f, size_t response, scree_error *error) {
  size_t q = 0;
  while (q + 1 < f->c->quantity_count && f->m->first[q + 1] <= response) q++;
  const scree_plan_quantity *plan = f->c->quantities[q].plan;
  return scree_fail(error, f->status[response], "%s: %s", plan->place.path,
                    f->errors[response].message);
}

static scree_status fit_all(fitting *f, scree_error *error) {
  scree_model *model = &f->m->model;
  SCREE_TRY_ALLOC_ZERO(f->status, model->count, error);
  SCREE_TRY_ALLOC_ZERO(f->errors, model->count, error);
  scree_parallel_for(model->count, 1, fit_some, f);
  for (size_t i = 0; i < model->count; i++)
    if (f->status[i] != SCREE_OK) return tell(f, i, error);
  return scree_model_correlate(model, (const double *const *)f->g->x, f->run_counts,
                               (const double *const *)f->y, error);
}

static void free_fitting(fitting *f) {
  for (size_t i = 0; f->y && i < f->m->quantity_count * SCREE_MOST_COMPONENTS; i++)
    scree_free(f->y[i]);
  scree_free(f->y);
  scree_free(f->run_counts);
  scree_free(f->status);
  scree_free(f->errors);
}

scree_status scree_calibration_fit(const scree_calibration *c, const scree_answers *gathered,
                                   size_t round_count, scree_calibration_model *model,
                                   scree_error *error) {
  size_t n = c->quantity_count, most = n * SCREE_MOST_COMPONENTS;
  SCREE_CLEANUP(scree_calibration_model_free)
  scree_calibration_model m = {.model.dimension_count = c->parameter_count, .quantity_count = n};
  SCREE_CLEANUP(free_fitting) fitting f = {.c = c, .g = gathered, .m = &m};
  SCREE_TRY_ALLOC_ZERO(m.model.items, most, error);
  SCREE_TRY_ALLOC_ZERO(m.first, n, error);
  SCREE_TRY_ALLOC_ZERO(m.count, n, error);
  SCREE_TRY_ALLOC_ZERO(m.bases, n, error);
  SCREE_TRY_ALLOC_ZERO(f.run_counts, c->experiment_count, error);
  SCREE_TRY_ALLOC_ZERO(f.y, most, error);
  for (size_t e = 0; e < c->experiment_count; e++)
    f.run_counts[e] = scree_rounds_until(c, e, round_count);
  SCREE_TRY(lay_out(&f, error));
  SCREE_TRY(fit_all(&f, error));
  *model = m;
  m = (scree_calibration_model){.quantity_count = n};
  return SCREE_OK;
}
