/* A calibration: what its file says, its folder, its runs, and the model of them. */
#pragma once

#include "base/schema_rows.h"
#include "calibrate/model.h"
#include "study/study.h"

/* ---- the file ---- */

#define SCREE_PLAN_EXPERIMENT(ROW, T)                                                              \
  ROW(T, TEXT, scene, "file of a scene")                                                           \
  ROW(T, TEXTS, command, "program and words")                                                      \
  ROW(T, REAL, timeout, NAN, 1e-3, 1e9, "s", "of a run of the command; not given: no limit")       \
  ROW(T, NODE, set, "fields of the scene that differ here")                                        \
  ROW(T, REAL, cost, NAN, 1e-9, 1e9, "", "of a run, beside the others; not given: as measured")
SCREE_RECORD_TYPE(scree_plan_experiment, SCREE_PLAN_EXPERIMENT)

#define SCREE_PLAN_SOUGHT_PARAMETER(ROW, T)                                                        \
  ROW(T, AS, "field", TEXTS, fields, "of the scenes; none: its name, of a command")                \
  ROW(T, REAL, from, NAN, -1e300, 1e300, "", "")                                                   \
  ROW(T, REAL, to, NAN, -1e300, 1e300, "", "")                                                     \
  ROW(T, WORD, scale, 0, "linear|log", "")                                                         \
  ROW(T, TEXTS, values, "in place of a range")                                                     \
  ROW(T, TEXT, unit, "")
SCREE_RECORD_TYPE(scree_plan_parameter, SCREE_PLAN_SOUGHT_PARAMETER)

/* What the simulation answers; what was measured of it; what it may be. */
#define SCREE_PLAN_ANSWER(ROW, T)                                                                  \
  ROW(T, TEXT, experiment, "")                                                                     \
  ROW(T, TEXT, answer, "column of a sensor, or outline")                                           \
  ROW(T, TEXT, unit, "of what a command prints; not given: the sensor's")                          \
  ROW(T, REAL, at, NAN, -1e9, 1e9, "", "s; of an outline m")                                       \
  ROW(T, REAL, from, NAN, 0, 1e9, "s", "of the mean over a window")                                \
  ROW(T, REAL, until, NAN, 0, 1e9, "s", "")                                                        \
  ROW(T, WORD, take, 0, "last|mean|sd", "over the sensor's window")
#define SCREE_PLAN_TARGET(ROW, T)                                                                  \
  SCREE_PLAN_ANSWER(ROW, T)                                                                        \
  ROW(T, REAL, value, NAN, -1e300, 1e300, "", "measured")                                          \
  ROW(T, NODE, measured, "repeats, a list")                                                        \
  ROW(T, TEXT, curve, "file of two columns")                                                       \
  ROW(T, REAL, uncertainty, 0, 0, 1e300, "", "standard")                                           \
  ROW(T, COUNT, repeats, 1, 1, 1e6, "that the value is the mean of")
#define SCREE_PLAN_BOUNDS(ROW, T)                                                                  \
  ROW(T, REAL, at_most, NAN, -1e300, 1e300, "", "")                                                \
  ROW(T, REAL, at_least, NAN, -1e300, 1e300, "", "")
#define SCREE_PLAN_LIMIT(ROW, T)    SCREE_PLAN_ANSWER(ROW, T) SCREE_PLAN_BOUNDS(ROW, T)
#define SCREE_PLAN_QUANTITY(ROW, T) SCREE_PLAN_TARGET(ROW, T) SCREE_PLAN_BOUNDS(ROW, T)
SCREE_RECORD_TYPE(scree_plan_quantity, SCREE_PLAN_QUANTITY)
SCREE_RECORD_LIKE(scree_plan_quantity, scree_plan_target);
SCREE_RECORD_LIKE(scree_plan_quantity, scree_plan_sought);
SCREE_RECORD_LIKE(scree_plan_quantity, scree_plan_limit);

#define SCREE_PLAN_BUDGET(ROW, T)                                                                  \
  ROW(T, COUNT, runs, 100, 2, 1000, "of all experiments together")                                 \
  ROW(T, REAL, time, NAN, 0, 1e12, "s", "of the processor; not given: no limit")
SCREE_RECORD_TYPE(scree_plan_budget, SCREE_PLAN_BUDGET)

#define SCREE_PLAN_START(ROW, T) ROW(T, COUNT, points, 0, 2, 1000, "of each experiment")
SCREE_RECORD_TYPE(scree_plan_start, SCREE_PLAN_START)

#define SCREE_PLAN_CALIBRATION(ROW, T)                                                             \
  ROW(T, TEXT, title, "")                                                                          \
  ROW(T, SEED, seed, 1, "")                                                                        \
  ROW(T, NAMED, experiments, scree_plan_experiment, "")                                            \
  ROW(T, NAMED, parameters, scree_plan_parameter, "")                                              \
  ROW(T, NAMED, targets, scree_plan_target, "")                                                    \
  ROW(T, NAMED, predict, scree_plan_target, "")                                                    \
  ROW(T, GROUP, minimise, scree_plan_sought, "")                                                   \
  ROW(T, GROUP, maximise, scree_plan_sought, "")                                                   \
  ROW(T, NAMED, limits, scree_plan_limit, "")                                                      \
  ROW(T, GROUP, budget, scree_plan_budget, "")                                                     \
  ROW(T, GROUP, start, scree_plan_start, "")                                                       \
  ROW(T, COUNT, batch, 8, 1, 1000, "runs planned at a time")                                       \
  ROW(T, REAL, confidence, 0.9, 0.5, 0.9999, "", "of intervals")
SCREE_RECORD_TYPE(scree_plan_calibration, SCREE_PLAN_CALIBRATION)

/* ---- what follows from it ---- */

typedef enum scree_quantity_kind {
  SCREE_QUANTITY_TARGET, /* measured, or on offer */
  SCREE_QUANTITY_PREDICTION,
  SCREE_QUANTITY_SOUGHT,
  SCREE_QUANTITY_LIMIT
} scree_quantity_kind;

/* Something that the simulation answers: one number, or a curve of them. */
typedef struct scree_quantity {
  scree_quantity_kind kind;
  const scree_plan_quantity *plan;
  const char *unit; /* "" where it is not known */
  size_t experiment;
  size_t first_answer, answer_count; /* of those of its experiment's study */
  bool measured;
  double value, uncertainty, scatter, repeat_count;
  double *x, *y; /* of a curve: answer_count points; else NULL */
} scree_quantity;

typedef struct scree_experiment_plan {
  const scree_plan_experiment *plan;
  const char *scene_path;                             /* in full; NULL: a command */
  size_t active[SCREE_MOST_PARAMETERS], active_count; /* parameters that it has */
  const char *answers;                                /* the lines of its study */
  size_t answer_count;
} scree_experiment_plan;

/* A run that was planned. */
typedef struct scree_planned_run {
  size_t experiment, round;
  uint64_t seed;
  const char *values[SCREE_MOST_PARAMETERS]; /* as in the scene */
  double x[SCREE_MOST_PARAMETERS];
} scree_planned_run;

struct scree_calibration {
  scree_arena arena; /* all that follows from the file */
  scree_yaml root;
  scree_plan_calibration plan;
  const char *path, *text;
  size_t text_size;
  char *folder; /* NULL before it is opened */
  size_t experiment_count, parameter_count, quantity_count;
  scree_experiment_plan *experiments;
  const scree_plan_parameter *parameters;
  scree_quantity *quantities;
  /* rounds.c */
  scree_arena run_arena;
  scree_planned_run *runs;
  size_t run_count, round_count;
  bool checked; /* the last round is this file's check: runs at the answer, unknown to the model */
  size_t check_rounds; /* so many at the end are such */
};

/* read.c: the value at a coordinate as the scene takes it, in the arena; NULL: memory is out. The
 * coordinate of a value; NAN: it is none of the parameter's list. */
const char *scree_parameter_text(const scree_plan_parameter *parameter, double x,
                                 scree_arena *arena);
double scree_parameter_value(const scree_plan_parameter *parameter, double x);
double scree_parameter_coordinate(const scree_plan_parameter *parameter, const char *value);
/* The same of a list: the value where it is a number, else its place in the list. */
double scree_parameter_number(const scree_plan_parameter *parameter, double x);
/* The coordinate that stands for x: of a list that of the nearest value. */
double scree_parameter_snap(const scree_plan_parameter *parameter, double x);
/* Points of an experiment's first runs. */
size_t scree_calibration_start(const scree_calibration *c, size_t experiment);

/* rounds.c: a word of a command with the folder of the file in place of {here}. */
void scree_calibration_word(const scree_calibration *c, const char *word, char *text, size_t size);
/* Reads all rounds of the folder. */
scree_status scree_rounds_read(scree_calibration *c, scree_error *error);
/* Writes one more, whole or not at all. */
scree_status scree_rounds_add(scree_calibration *c, const scree_place_pick *picks, size_t count,
                              bool check, double seconds, scree_error *error);
/* Rounds that the model is of. A check is one of them once the file is another. */
size_t scree_rounds_fitted(const scree_calibration *c);
/* How many runs of an experiment the first rounds have. */
size_t scree_rounds_until(const scree_calibration *c, size_t experiment, size_t round_count);
/* The study of an experiment with all its runs, opened and prepared. *study NULL: it has none. */
scree_status scree_rounds_study(const scree_calibration *c, size_t experiment, scree_study **study,
                                scree_error *error);
/* Why it has stopped, as far as this file says; "" where it has not. In the run arena. */
scree_status scree_rounds_end(scree_calibration *c, const char **reason, scree_error *error);
scree_status scree_rounds_stop(scree_calibration *c, const char *reason, double seconds,
                               scree_error *error);
double scree_rounds_seconds(const scree_calibration *c);

/* ---- results ---- */

/* What the runs of the first rounds gave. */
typedef struct scree_answers {
  size_t experiment_count;
  size_t *run_counts;        /* of each experiment */
  size_t *waiting;           /* of those that the model is fitted to, not ended yet */
  double **x, **answers;     /* run_counts x parameters; run_counts x answer_count, NAN: none */
  double *costs, seconds;    /* of a run, without a clock; processor time of all */
  double started, ended;     /* s since 1970: the first, the last */
  char machine[160];         /* of the last */
  size_t done, failed, open; /* open: not ended yet */
  char **failures;           /* reasons, each once */
  size_t failure_count;
} scree_answers;
scree_status scree_gather(const scree_calibration *c, scree_answers *gathered, scree_error *error);
void scree_answers_free(scree_answers *gathered);
/* work.c */
scree_calibration_progress scree_calibration_stands(const scree_calibration *c,
                                                    const scree_answers *gathered);

/* curve.c: the shapes in which curves vary. centre: point_count; basis: component_count x
 * point_count, of root mean square 1. */
enum { SCREE_MOST_COMPONENTS = 4 };
typedef struct scree_curve_basis {
  size_t point_count, component_count;
  double *centre, *basis;
} scree_curve_basis;
scree_status scree_curve_basis_make(const double *curves, size_t count, size_t point_count,
                                    scree_curve_basis *basis, scree_error *error);
void scree_curve_basis_free(scree_curve_basis *basis);
double scree_curve_score(const scree_curve_basis *basis, size_t component, const double *curve);
/* Root mean square of what of a curve no component has. */
double scree_curve_left(const scree_curve_basis *basis, const double *curve);

/* The model of all quantities, from the first `round_count` rounds. */
typedef struct scree_calibration_model {
  scree_model model;
  size_t quantity_count, *first, *count; /* responses of each quantity */
  scree_curve_basis *bases;              /* of each quantity; empty where it is no curve */
} scree_calibration_model;
scree_status scree_calibration_fit(const scree_calibration *c, const scree_answers *gathered,
                                   size_t round_count, scree_calibration_model *model,
                                   scree_error *error);
void scree_calibration_model_free(scree_calibration_model *model);

/* posterior.c: samples of the parameters' coordinates, *count x parameters, to be freed; `effort` 0
 * for planning, 1 for the answer. */
scree_status scree_calibration_sample(const scree_calibration *c, const scree_model *model,
                                      int effort, double **samples, size_t *count,
                                      scree_error *error);

/* verdict.c: the most probable place, from samples of the posterior. */
void scree_calibration_nearest(const scree_calibration *c, const scree_answers *gathered,
                               const scree_model *model, const double *samples, size_t count,
                               double *x);
/* The distance (scree_model_distance) beyond which a model whose nearest place is x does not give
 * what was measured. */
double scree_calibration_limit(const scree_calibration *c, const scree_model *model,
                               const double *x, const double *samples, size_t count);
/* Where the runs of the check are; false: there was none. Their mean of a quantity, or of a
 * component of a curve: NAN where none of the *count gave it. The distance by them; NAN: there are
 * none, INFINITY: an answer is missing. */
bool scree_check_place(const scree_calibration *c, double *x);
double scree_check_mean(const scree_calibration *c, const scree_answers *gathered,
                        const scree_calibration_model *model, size_t quantity, size_t component,
                        size_t *count);
double scree_check_distance(const scree_calibration *c, const scree_answers *gathered,
                            const scree_calibration_model *model);
/* Whether the run nearest to x gave the quantity's answer; of several there, any. */
bool scree_answered_near(const scree_calibration *c, const scree_answers *gathered,
                         const scree_quantity *quantity, const double *x);

/* result.c: whether the shortest interval of that confidence begins (-1) or ends (1) with the
 * sorted samples, so that an end of the range closes it; 0: neither. */
int scree_samples_end(const double *values, size_t count, double confidence);

/* search.c: the next places of a search, at most so many. */
scree_status scree_search_next(const scree_calibration *c, const scree_calibration_model *model,
                               const scree_answers *gathered, size_t *count,
                               scree_place_pick *picks, double *left, scree_error *error);
/* Its candidates and history into the result. */
scree_status scree_search_describe(const scree_calibration *c, const scree_calibration_model *m,
                                   const scree_answers *gathered, scree_arena *arena,
                                   scree_calibration_result *result, scree_error *error);
