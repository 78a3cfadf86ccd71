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
  if (!more) return scree_fail_memory(error, 0, "failures");
  g->failures = more;
  char *copy = scree_strdup(reason);
  if (!copy) return scree_fail_memory(error, 0, "failures");
  g->failures[g->failure_count++] = copy;
  return SCREE_OK;
}

/* The work of a run that no clock tells: bodies times steps. */
static double work_of(const scree_study_record *r) {
  return (double)r->costs.step_count * (double)(r->result.body_count + r->result.left_count + 1);
}

static scree_status take_record(scree_answers *g, size_t experiment, const scree_study *study,
                                size_t run, double *work, scree_error *error) {
  scree_study_record record;
  char mark[SCREE_CHECKSUM_TEXT];
  double *answers = g->answers[experiment] + run * study->answer_count;
  const char *path = SCREE_STUDY_PATH(study, "results", study->keys[run], ".yaml");
  bool there = scree_path_exists(path);
  scree_status status = there ? scree_study_record_read(path, &record, error) : SCREE_OK;
  if (status == SCREE_BAD_FILE) there = false; /* the next worker puts it aside */
  if (there && status == SCREE_OK && !record.failed) {
    scree_study_answers_mark(study, mark);
    there = !strcmp(mark, record.answered); /* or takes its answers anew */
    if (!there) scree_study_record_free(&record);
  }
  if (!there) {
    g->open++;
    return SCREE_OK;
  }
  if (status != SCREE_OK) return status;
  for (size_t a = 0; !record.failed && a < study->answer_count; a++)
    if (a < record.answer_count) answers[a] = record.answers[a];
  g->seconds += record.costs.processor_seconds;
  *work += work_of(&record);
  if (record.failed)
    status = note_failure(g, record.reason, error);
  else
    g->done++;
  scree_study_record_free(&record);
  return status;
}

static scree_status gather_experiment(const scree_calibration *c, size_t e, scree_answers *g,
                                      scree_error *error) {
  scree_study *study;
  scree_status status = scree_rounds_study(c, e, &study, error);
  if (status != SCREE_OK || !study) return status;
  size_t count = scree_study_run_count(study), n = 0, d = c->parameter_count;
  double work = 0;
  g->x[e] = scree_alloc(count * d, sizeof *g->x[e]);
  g->answers[e] = scree_alloc(count * study->answer_count, sizeof *g->answers[e]);
  g->run_counts[e] = count;
  if (!g->x[e] || !g->answers[e]) status = scree_fail_memory(error, 0, "answers");
  for (size_t i = 0; status == SCREE_OK && i < count * study->answer_count; i++)
    g->answers[e][i] = NAN;
  for (size_t i = 0; status == SCREE_OK && i < c->run_count; i++) {
    if (c->runs[i].experiment != e) continue;
    memcpy(g->x[e] + n * d, c->runs[i].x, d * sizeof(double));
    size_t open = g->open;
    status = take_record(g, e, study, n, &work, error);
    if (c->runs[i].round < scree_rounds_fitted(c)) g->waiting[e] += g->open - open;
    n++;
  }
  g->costs[e] = work > 0 ? work / (double)count : 1;
  scree_study_free(study);
  return status;
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
  scree_answers g = {.experiment_count = c->experiment_count};
  scree_status status = SCREE_OUT_OF_MEMORY;
  size_t n = c->experiment_count;
  g.run_counts = scree_alloc_zero(n, sizeof *g.run_counts);
  g.waiting = scree_alloc_zero(n, sizeof *g.waiting);
  g.x = scree_alloc_zero(n, sizeof *g.x);
  g.answers = scree_alloc_zero(n, sizeof *g.answers);
  g.costs = scree_alloc_zero(n, sizeof *g.costs);
  if (g.run_counts && g.waiting && g.x && g.answers && g.costs)
    status = SCREE_OK;
  else
    scree_fail_memory(error, 0, "answers");
  for (size_t e = 0; status == SCREE_OK && e < n; e++) status = gather_experiment(c, e, &g, error);
  if (status == SCREE_OK) {
    settle_costs(c, &g);
    *gathered = g;
  } else {
    scree_answers_free(&g);
  }
  return status;
}

/* ---- the model ---- */

void scree_calibration_model_free(const scree_calibration *c, scree_calibration_model *m) {
  for (size_t q = 0; m->bases && q < c->quantity_count; q++) scree_curve_basis_free(&m->bases[q]);
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

static void fit_some(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  fitting *f = context;
  for (size_t i = begin; i < end; i++) {
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
  *y = scree_alloc(n, sizeof **y);
  if (!*y) return scree_fail_memory(error, 0, "answers");
  for (size_t i = 0; i < n; i++) {
    const double *answers = f->g->answers[q->experiment] + i * all + q->first_answer;
    (*y)[i] = q->x ? scree_curve_score(&f->m->bases[quantity], component, answers) : answers[0];
  }
  return SCREE_OK;
}

static scree_status make_basis(fitting *f, size_t quantity, scree_error *error) {
  const scree_quantity *q = &f->c->quantities[quantity];
  size_t all = f->c->experiments[q->experiment].answer_count, n = f->run_counts[q->experiment];
  double *curves = scree_alloc(n * q->answer_count, sizeof *curves);
  if (!curves) return scree_fail_memory(error, 0, "curves");
  for (size_t i = 0; i < n; i++)
    memcpy(curves + i * q->answer_count, f->g->answers[q->experiment] + i * all + q->first_answer,
           q->answer_count * sizeof *curves);
  scree_status status =
      scree_curve_basis_make(curves, n, q->answer_count, &f->m->bases[quantity], error);
  scree_free(curves);
  return status;
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
  f->status = scree_alloc_zero(model->count, sizeof *f->status);
  f->errors = scree_alloc_zero(model->count, sizeof *f->errors);
  if (!f->status || !f->errors) return scree_fail_memory(error, 0, "a model");
  scree_parallel_for(model->count, 1, fit_some, f);
  for (size_t i = 0; i < model->count; i++)
    if (f->status[i] != SCREE_OK) return tell(f, i, error);
  return scree_model_correlate(model, (const double *const *)f->g->x, f->run_counts,
                               (const double *const *)f->y, error);
}

scree_status scree_calibration_fit(const scree_calibration *c, const scree_answers *gathered,
                                   size_t round_count, scree_calibration_model *model,
                                   scree_error *error) {
  size_t most = c->quantity_count * SCREE_MOST_COMPONENTS;
  *model = (scree_calibration_model){.model.dimension_count = c->parameter_count};
  fitting f = {.c = c, .g = gathered, .m = model};
  scree_status status = SCREE_OUT_OF_MEMORY;
  model->model.items = scree_alloc_zero(most, sizeof *model->model.items);
  model->first = scree_alloc_zero(c->quantity_count, sizeof *model->first);
  model->count = scree_alloc_zero(c->quantity_count, sizeof *model->count);
  model->bases = scree_alloc_zero(c->quantity_count, sizeof *model->bases);
  f.run_counts = scree_alloc_zero(c->experiment_count, sizeof *f.run_counts);
  f.y = scree_alloc_zero(most, sizeof *f.y);
  if (model->model.items && model->first && model->count && model->bases && f.run_counts && f.y) {
    for (size_t e = 0; e < c->experiment_count; e++)
      f.run_counts[e] = scree_rounds_until(c, e, round_count);
    status = lay_out(&f, error);
    if (status == SCREE_OK) status = fit_all(&f, error);
  } else {
    scree_fail_memory(error, 0, "a model");
  }
  for (size_t i = 0; f.y && i < most; i++) scree_free(f.y[i]);
  scree_free(f.y);
  scree_free(f.run_counts);
  scree_free(f.status);
  scree_free(f.errors);
  if (status != SCREE_OK) scree_calibration_model_free(c, model);
  return status;
}
