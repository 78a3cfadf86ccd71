/* The file of a calibration, by its table of fields; then what only the whole can say: which
 * parameter acts in which experiment, and which answers each has to give. */
#include "base/curve_file.h"
#include "base/file.h"
#include "base/math.h"
#include "base/number.h"
#include "base/platform.h"
#include "base/quote.h"
#include "calibrate/calibration.h"
#include "scene/file.h"

#include <stdlib.h>
#include <string.h>

enum { LARGEST_FILE = 1 << 20, MOST_CURVE = 40 };

SCREE_RECORD_TABLE(scree_plan_experiment, SCREE_PLAN_EXPERIMENT, "an experiment", NULL, NULL)
SCREE_RECORD_TABLE(scree_plan_parameter, SCREE_PLAN_SOUGHT_PARAMETER, "a parameter", NULL, NULL)
SCREE_RECORD_TABLE_OF(scree_plan_target, SCREE_PLAN_QUANTITY, SCREE_PLAN_TARGET, "a target", NULL,
                      NULL)
SCREE_RECORD_TABLE_OF(scree_plan_sought, SCREE_PLAN_QUANTITY, SCREE_PLAN_ANSWER, "what is sought",
                      NULL, NULL)
SCREE_RECORD_TABLE_OF(scree_plan_limit, SCREE_PLAN_QUANTITY, SCREE_PLAN_LIMIT, "a limit", NULL,
                      NULL)
SCREE_RECORD_TABLE(scree_plan_budget, SCREE_PLAN_BUDGET, "the budget", NULL, NULL)
SCREE_RECORD_TABLE(scree_plan_start, SCREE_PLAN_START, "the start", NULL, NULL)
SCREE_RECORD_TABLE(scree_plan_calibration, SCREE_PLAN_CALIBRATION, "a calibration", NULL, NULL)

typedef struct reader {
  scree_calibration *c;
  scree_reader in;
} reader;

static scree_status fail_memory(const reader *r) {
  return scree_fail_memory(r->in.error, 0, r->in.file);
}

/* ---- parameters ---- */

double scree_parameter_value(const scree_plan_parameter *p, double x) {
  double u = 0.5 * (x + 1);
  return p->scale ? scree_exp(scree_log(p->from) + u * (scree_log(p->to) - scree_log(p->from)))
                  : p->from + u * (p->to - p->from);
}

/* Which of the list; each has as much of [-1, 1]. */
static size_t level_of(const scree_plan_parameter *p, double x) {
  double level = floor(0.5 * (x + 1) * (double)p->values.count);
  return level < 0 ? 0 : level >= (double)p->values.count ? p->values.count - 1 : (size_t)level;
}

static double level_coordinate(const scree_plan_parameter *p, size_t level) {
  return (2 * (double)level + 1) / (double)p->values.count - 1;
}

double scree_parameter_snap(const scree_plan_parameter *p, double x) {
  return p->values.count ? level_coordinate(p, level_of(p, x)) : x;
}

double scree_parameter_number(const scree_plan_parameter *p, double x) {
  double number;
  if (!p->values.count) return scree_parameter_value(p, x);
  size_t level = level_of(p, x);
  return scree_number_read(p->values.items[level], &number) ? number : (double)level;
}

const char *scree_parameter_text(const scree_plan_parameter *p, double x, scree_arena *arena) {
  char number[SCREE_NUMBER_SIZE];
  if (p->values.count) return p->values.items[level_of(p, x)];
  scree_number_format_digits(scree_parameter_value(p, x), 9, number);
  return scree_arena_text(arena, number);
}

double scree_parameter_coordinate(const scree_plan_parameter *p, const char *value) {
  double number;
  for (size_t i = 0; i < p->values.count; i++)
    if (!strcmp(p->values.items[i], value)) return level_coordinate(p, i);
  if (p->values.count || !scree_number_read(value, &number)) return NAN;
  if (!p->scale) return 2 * (number - p->from) / (p->to - p->from) - 1;
  return 2 * scree_log(number / p->from) / scree_log(p->to / p->from) - 1;
}

static scree_status check_parameter(const reader *r, const scree_plan_parameter *p) {
  if (p->values.count) {
    if (!isnan(p->from) || !isnan(p->to))
      return scree_fail_place(&r->in, &p->place, "needs from and to, or values, not both");
    if (p->values.count == 1) return scree_fail_place(&r->in, &p->place, "one value is no choice");
    for (size_t i = 0; i < p->values.count; i++)
      for (size_t j = 0; j < i; j++)
        if (!strcmp(p->values.items[i], p->values.items[j]))
          return scree_fail_place(&r->in, &p->place, "the value '%s' stands here twice",
                                  p->values.items[i]);
    return SCREE_OK;
  }
  if (isnan(p->from) || isnan(p->to))
    return scree_fail_place(&r->in, &p->place, "needs a range, from and to, or values");
  if (!(p->from < p->to))
    return scree_fail_place(&r->in, &p->place, "from: %g must be below to: %g", p->from, p->to);
  if (p->scale && !(p->from > 0))
    return scree_fail_place(&r->in, &p->place, "from %g must be above 0 on a log scale", p->from);
  return SCREE_OK;
}

/* ---- experiments ---- */

/* A path beside the calibration's file, in full. */
static const char *full_path(const reader *r, const char *name) {
  char path[4096], full[4096];
  const char *slash = strrchr(r->in.file, '/');
  snprintf(path, sizeof path, "%.*s%s", *name == '/' || !slash ? 0 : (int)(slash + 1 - r->in.file),
           r->in.file, name);
  return scree_arena_text(&r->c->arena, scree_path_full(path, full, sizeof full) ? full : path);
}

static bool is_command(const scree_plan_experiment *e) {
  return e->command.count > 0;
}

static scree_status check_experiment(const reader *r, const scree_plan_experiment *e) {
  static const char taken[] = "rounds";
  if (!strcmp(e->place.name, taken) || strspn(e->place.name, ".") == strlen(e->place.name) ||
      strpbrk(e->place.name, "/\\"))
    return scree_fail_place(&r->in, &e->place, "'%s' cannot be a folder's name here",
                            e->place.name);
  if (is_command(e) == (e->scene != NULL))
    return scree_fail_place(&r->in, &e->place, "needs either scene or command");
  if (!isnan(e->timeout) && !is_command(e))
    return scree_fail_place(&r->in, &e->place, "timeout: is of a command");
  if (e->set && (is_command(e) || e->set->kind != SCREE_YAML_MAPPING))
    return scree_fail_place(&r->in, &e->place, "set: must be `FIELD: VALUE` lines of a scene");
  return SCREE_OK;
}

/* The scene with what is set here, to be freed. */
static scree_status read_scene(const reader *r, const scree_experiment_plan *e,
                               scree_scene_file **file) {
  scree_error error;
  SCREE_OWNED(scree_scene_file, made);
  const scree_yaml *set = e->plan->set;
  if (scree_scene_file_read(e->scene_path, &made, &error) != SCREE_OK)
    return scree_fail_place(&r->in, &e->plan->place, "%s", error.message);
  for (size_t i = 0; set && i < set->item_count; i++) {
    const scree_yaml *item = &set->items[i];
    scree_place place = {NULL, e->plan->place.path, item->line, item->column};
    if (item->kind != SCREE_YAML_SCALAR)
      return scree_fail_place(&r->in, &place, "set.%s: must be one value", item->key);
    if (scree_scene_file_set(made, item->key, item->text, &error) != SCREE_OK)
      return scree_fail_place(&r->in, &place, "set.%s: %s", item->key, error.message);
  }
  if (scree_scene_file_check(made, &error) != SCREE_OK)
    return scree_fail_place(&r->in, &e->plan->place, "%s", error.message);
  *file = made;
  made = NULL;
  return SCREE_OK;
}

/* Whether the scene takes a parameter's ends; else why not. */
static bool takes(scree_scene_file *file, const scree_plan_parameter *p, scree_arena *arena,
                  scree_error *why) {
  bool any = false;
  for (size_t f = 0; f < p->fields.count; f++) {
    bool good = true;
    for (int end = -1; good && end <= 1; end += 2) {
      const char *text = scree_parameter_text(p, end, arena);
      good = text && scree_scene_file_set(file, p->fields.items[f], text, why) == SCREE_OK;
    }
    any = any || good;
  }
  return any;
}

static scree_status find_active(const reader *r, scree_error *why, bool *anywhere) {
  scree_calibration *c = r->c;
  for (size_t i = 0; i < c->experiment_count; i++) {
    scree_experiment_plan *e = &c->experiments[i];
    SCREE_OWNED(scree_scene_file, file);
    if (!is_command(e->plan)) SCREE_TRY(read_scene(r, e, &file));
    for (size_t p = 0; p < c->parameter_count; p++) {
      const scree_plan_parameter *parameter = &c->parameters[p];
      if (!(file ? takes(file, parameter, &c->arena, &why[p])
                 : scree_command_has(&e->plan->command, parameter->place.name)))
        continue;
      e->active[e->active_count++] = p;
      anywhere[p] = true;
    }
    if (e->active_count == 0)
      return scree_fail_place(&r->in, &e->plan->place,
                              is_command(e->plan)
                                  ? "none of its words has a parameter, as in {friction}"
                                  : "has none of the parameters' fields");
  }
  return SCREE_OK;
}

static scree_status read_experiments(const reader *r) {
  scree_calibration *c = r->c;
  scree_error why[SCREE_MOST_PARAMETERS] = {0};
  bool anywhere[SCREE_MOST_PARAMETERS] = {false};
  SCREE_TRY_TAKE(c->experiments, &c->arena, c->experiment_count, r->in.error);
  for (size_t i = 0; i < c->experiment_count; i++) {
    scree_experiment_plan *e = &c->experiments[i];
    *e = (scree_experiment_plan){.plan = &c->plan.experiments.items[i]};
    SCREE_TRY(check_experiment(r, e->plan));
    if (!is_command(e->plan) && !(e->scene_path = full_path(r, e->plan->scene)))
      return fail_memory(r);
  }
  for (size_t i = 0; i < c->parameter_count; i++) SCREE_TRY(check_parameter(r, &c->parameters[i]));
  SCREE_TRY(find_active(r, why, anywhere));
  for (size_t p = 0; p < c->parameter_count; p++)
    if (!anywhere[p])
      return scree_fail_place(&r->in, &c->parameters[p].place,
                              why[p].message[0] ? "%s" : "no experiment has such a parameter%s",
                              why[p].message);
  return SCREE_OK;
}

/* ---- curves ---- */

/* Means of MOST_CURVE equal parts, where there are more points. */
static void thin_curve(scree_quantity *q, double *x, double *y, size_t count) {
  if (count > MOST_CURVE) {
    double low = x[0], width = (x[count - 1] - x[0]) / MOST_CURVE;
    size_t made = 0, i = 0;
    for (size_t part = 0; part < MOST_CURVE && i < count; part++) {
      double sum_x = 0, sum_y = 0, used = 0;
      for (; i < count && (x[i] < low + width * (double)(part + 1) || part + 1 == MOST_CURVE);
           i++) {
        sum_x += x[i];
        sum_y += y[i];
        used++;
      }
      if (used == 0) continue;
      x[made] = sum_x / used;
      y[made++] = sum_y / used;
    }
    count = made;
  }
  q->x = x;
  q->y = y;
  q->answer_count = count;
}

static scree_status read_curve(scree_calibration *c, scree_quantity *q, const char *path,
                               scree_error *error) {
  bool outline = !strcmp(q->plan->answer, "outline");
  SCREE_CLEANUP(scree_curve_file_free) scree_curve_file read = {0};
  double *x, *y;
  SCREE_TRY(scree_curve_file_read(path, &read, error));
  SCREE_TRY(scree_curve_file_convert(&read, 0, outline ? "m" : "s", 1, path, error));
  if (outline) SCREE_TRY(scree_curve_file_convert(&read, 1, "m", 1, path, error));
  SCREE_TRY_TAKE(x, &c->arena, read.count, error);
  SCREE_TRY_TAKE(y, &c->arena, read.count, error);
  memcpy(x, read.x, read.count * sizeof *x);
  memcpy(y, read.y, read.count * sizeof *y);
  thin_curve(q, x, y, read.count);
  return SCREE_OK;
}

/* ---- quantities ---- */

static scree_status read_repeats(const reader *r, scree_quantity *q) {
  const scree_yaml *list = q->plan->measured;
  scree_place place = {NULL, q->plan->place.path, list->line, list->column};
  double sum = 0, squares = 0;
  if (list->kind != SCREE_YAML_SEQUENCE || list->item_count < 2)
    return scree_fail_place(
        &r->in, &place, "measured: must be a list of two numbers or more; a single one is a value");
  for (size_t i = 0; i < list->item_count; i++) {
    double number;
    const scree_yaml *item = &list->items[i];
    if (item->kind != SCREE_YAML_SCALAR || !scree_number_read(item->text, &number))
      return scree_fail_place(&r->in, &place, "measured: '%s' is no number",
                              item->text ? item->text : "");
    double step = number - sum;
    sum += step / (double)(i + 1);
    squares += step * (number - sum);
  }
  q->value = sum;
  q->scatter = sqrt(squares / (double)(list->item_count - 1));
  q->repeat_count = (double)list->item_count;
  return SCREE_OK;
}

static scree_status read_measured(const reader *r, scree_quantity *q) {
  const scree_plan_quantity *p = q->plan;
  int ways = !isnan(p->value) + (p->measured != NULL) + (p->curve != NULL);
  if (ways > 1)
    return scree_fail_place(&r->in, &p->place, "needs one of value, measured and curve");
  if (p->measured && p->repeats > 1)
    return scree_fail_place(&r->in, &p->place, "repeats: measured has its own");
  q->measured = ways > 0;
  q->value = p->value;
  q->repeat_count = (double)p->repeats;
  q->uncertainty = p->uncertainty;
  if (p->measured) return read_repeats(r, q);
  if (!p->curve) return SCREE_OK;
  if (!isnan(p->at) || !isnan(p->from) || !isnan(p->until))
    return scree_fail_place(&r->in, &p->place, "a curve has its own places or times");
  if (p->uncertainty == 0)
    return scree_fail_place(&r->in, &p->place,
                            "a curve needs the uncertainty of measuring it, in its own unit");
  const char *path = full_path(r, p->curve);
  return path ? read_curve(r->c, q, path, r->in.error) : fail_memory(r);
}

static scree_status find_experiment(const reader *r, scree_quantity *q) {
  const scree_calibration *c = r->c;
  const char *names[64];
  size_t count = c->experiment_count < 64 ? c->experiment_count : 64;
  if (!q->plan->experiment && c->experiment_count == 1) return SCREE_OK;
  if (!q->plan->experiment)
    return scree_fail_place(&r->in, &q->plan->place, "needs its experiment");
  for (size_t i = 0; i < count; i++) {
    names[i] = c->experiments[i].plan->place.name;
    if (strcmp(names[i], q->plan->experiment) != 0) continue;
    q->experiment = i;
    return SCREE_OK;
  }
  return scree_fail_name(&r->in, &q->plan->place, "experiment", q->plan->experiment, names, count);
}

/* That its scene has such a column; its unit. */
static scree_status check_answer(const reader *r, scree_quantity *q) {
  const scree_plan_quantity *p = q->plan;
  const scree_experiment_plan *e = &r->c->experiments[q->experiment];
  bool outline = !strcmp(p->answer, "outline");
  q->unit = p->unit ? p->unit : outline && !is_command(e->plan) ? "m" : "";
  if (is_command(e->plan))
    return isnan(p->at) && isnan(p->from) && isnan(p->until) && !p->take && !p->curve
               ? SCREE_OK
               : scree_fail_place(&r->in, &p->place, "what a command prints has no times");
  if (outline && isnan(p->at) && !p->curve)
    return scree_fail_place(&r->in, &p->place, "an outline needs a curve, or at");
  if (!isnan(p->at) && (!isnan(p->from) || !isnan(p->until)))
    return scree_fail_place(&r->in, &p->place, "needs at, or from and until");
  if (p->take && (!isnan(p->at) || !isnan(p->from) || !isnan(p->until) || outline || p->curve))
    return scree_fail_place(&r->in, &p->place,
                            "take is over the sensor's window: without at, from, until, curve");
  if (outline) return SCREE_OK;
  SCREE_OWNED(scree_scene_file, file);
  char name[96];
  enum { MOST_NAMES = 400 };
  const char *names[MOST_NAMES];
  const char *unit;
  size_t count = 0;
  SCREE_TRY(read_scene(r, e, &file));
  while (count < MOST_NAMES &&
         scree_scene_file_column(file, count, name, &unit, NULL) == SCREE_OK && *name) {
    if (!strcmp(name, p->answer)) {
      if (!p->unit) q->unit = scree_arena_text(&r->c->arena, unit);
      return q->unit ? SCREE_OK : fail_memory(r);
    }
    if (!(names[count++] = scree_arena_text(&r->c->arena, name))) return fail_memory(r);
  }
  return scree_fail_name(&r->in, &p->place, "column", p->answer, names, count);
}

/* Its lines in the study of its experiment. */
static scree_status add_answers(const reader *r, scree_quantity *q) {
  scree_experiment_plan *e = &r->c->experiments[q->experiment];
  const scree_plan_quantity *p = q->plan;
  char *text = NULL;
  size_t size = 0;
  FILE *stream = scree_memory_open(&text, &size);
  if (!stream) return fail_memory(r);
  if (e->answers) fputs(e->answers, stream);
  q->first_answer = e->answer_count;
  q->answer_count = q->x ? q->answer_count : 1;
  for (size_t i = 0; i < q->answer_count; i++) {
    char number[2][SCREE_NUMBER_SIZE];
    double at = q->x ? q->x[i] : p->at;
    fputs("  - ", stream);
    scree_quote(stream, SCREE_QUOTE_YAML, p->answer);
    if (!isnan(at)) {
      scree_number_format(at, number[0]);
      fprintf(stream, ": {at: %s}\n", number[0]);
    } else if (!isnan(p->from) || !isnan(p->until)) {
      scree_number_format(isnan(p->from) ? 0 : p->from, number[0]);
      scree_number_format(isnan(p->until) ? 1e9 : p->until, number[1]);
      fprintf(stream, ": {from: %s, until: %s}\n", number[0], number[1]);
    } else {
      static const char *const takes[] = {"", ": mean", ": sd"};
      fprintf(stream, "%s\n", takes[p->take]);
    }
  }
  e->answer_count += q->answer_count;
  bool good = !ferror(stream);
  good = scree_memory_close(stream) && good;
  e->answers = good ? scree_arena_text(&r->c->arena, text) : NULL;
  free(text);
  return e->answers ? SCREE_OK : fail_memory(r);
}

static scree_status read_quantity(const reader *r, scree_quantity *q) {
  if (!q->plan->answer) return scree_fail_place(&r->in, &q->plan->place, "needs its answer");
  SCREE_TRY(find_experiment(r, q));
  SCREE_TRY(read_measured(r, q));
  SCREE_TRY(check_answer(r, q));
  if (q->kind == SCREE_QUANTITY_LIMIT && isnan(q->plan->at_most) && isnan(q->plan->at_least))
    return scree_fail_place(&r->in, &q->plan->place, "needs at_most or at_least");
  return add_answers(r, q);
}

static void list_quantities(scree_calibration *c, scree_quantity_kind kind,
                            const scree_plan_quantity *plans, size_t count) {
  for (size_t i = 0; i < count; i++)
    c->quantities[c->quantity_count++] = (scree_quantity){.kind = kind, .plan = &plans[i]};
}

static scree_status read_quantities(const reader *r) {
  scree_calibration *c = r->c;
  const scree_plan_calibration *p = &c->plan;
  const scree_plan_quantity *sought = p->minimise ? p->minimise : p->maximise;
  size_t most = p->targets.count + p->predict.count + p->limits.count + 1;
  SCREE_TRY_TAKE(c->quantities, &c->arena, most, r->in.error);
  list_quantities(c, SCREE_QUANTITY_SOUGHT, sought, sought != NULL);
  list_quantities(c, SCREE_QUANTITY_LIMIT, p->limits.items, p->limits.count);
  list_quantities(c, SCREE_QUANTITY_TARGET, p->targets.items, p->targets.count);
  list_quantities(c, SCREE_QUANTITY_PREDICTION, p->predict.items, p->predict.count);
  bool measured = false, used[64] = {false};
  size_t responses = 0;
  for (size_t i = 0; i < c->quantity_count; i++) {
    scree_quantity *q = &c->quantities[i];
    SCREE_TRY(read_quantity(r, q));
    measured = measured || (q->measured && q->kind == SCREE_QUANTITY_TARGET);
    used[q->experiment] = true;
    responses += q->x ? SCREE_MOST_COMPONENTS : 1;
  }
  if (!sought && !measured)
    return scree_fail_place(&r->in, &p->place, "needs a target with a value, measured or curve");
  if (responses > SCREE_MOST_RESPONSES)
    return scree_fail_place(&r->in, &p->place,
                            "too many targets: %zu, a curve counting %d times, at most %d",
                            responses, SCREE_MOST_COMPONENTS, SCREE_MOST_RESPONSES);
  for (size_t e = 0; e < c->experiment_count; e++)
    if (!used[e])
      return scree_fail_place(&r->in, &c->experiments[e].plan->place, "no target is of it");
  return SCREE_OK;
}

/* ---- the whole ---- */

static scree_status check_whole(const reader *r) {
  const scree_plan_calibration *p = &r->c->plan;
  bool search = p->minimise || p->maximise;
  if (p->minimise && p->maximise)
    return scree_fail_place(&r->in, &p->place, "minimise or maximise, not both");
  if (search && (p->targets.count || p->predict.count))
    return scree_fail_place(&r->in, &p->place,
                            "targets and predict are of a calibration, which has no %s",
                            p->minimise ? "minimise" : "maximise");
  if (!search && p->limits.count)
    return scree_fail_place(&r->in, &p->place, "limits are of minimise or maximise");
  if (p->experiments.count == 0 || p->experiments.count > 64)
    return scree_fail_place(&r->in, &p->place, "needs 1 to 64 experiments, not %zu",
                            p->experiments.count);
  if (p->parameters.count == 0 || p->parameters.count > SCREE_MOST_PARAMETERS)
    return scree_fail_place(&r->in, &p->place, "needs 1 to %d parameters, not %zu",
                            SCREE_MOST_PARAMETERS, p->parameters.count);
  return SCREE_OK;
}

size_t scree_calibration_start(const scree_calibration *c, size_t experiment) {
  return c->plan.start && c->plan.start->points ? c->plan.start->points
                                                : 4 * (c->experiments[experiment].active_count + 1);
}

/* The first runs of each experiment are points, every second one twice. */
static scree_status check_budget(const reader *r) {
  const scree_calibration *c = r->c;
  const scree_plan_budget *budget = c->plan.budget;
  size_t first = 0;
  for (size_t e = 0; e < c->experiment_count; e++) {
    size_t points = scree_calibration_start(c, e);
    first += points + points / 2;
  }
  if (first <= budget->runs) return SCREE_OK;
  const scree_place *place = budget->place.line ? &budget->place : &c->plan.place;
  return scree_fail_place(&r->in, place,
                          "%zu runs are too few for the %zu that come first; give more, or fewer "
                          "points as `start: {points: N}`",
                          budget->runs, first);
}

static scree_status read_all(scree_calibration *c, scree_error *error) {
  reader r = {c, {c->path, &c->arena, error, ""}};
  SCREE_TRY(scree_yaml_parse(c->text, c->text_size, c->path, &c->root, error));
  if (c->root.kind != SCREE_YAML_MAPPING)
    return scree_fail(error, SCREE_BAD_FILE, "%s: a calibration is `key: value` lines", c->path);
  SCREE_TRY(scree_record_read(&r.in, &c->root, &scree_plan_calibration_record, &c->plan));
  if (!c->plan.budget && (c->plan.budget = scree_arena_take(&c->arena, 1, sizeof *c->plan.budget)))
    *c->plan.budget = scree_plan_budget_defaults;
  if (!c->plan.budget) return fail_memory(&r);
  c->experiment_count = c->plan.experiments.count;
  c->parameter_count = c->plan.parameters.count;
  c->parameters = c->plan.parameters.items;
  SCREE_TRY(check_whole(&r));
  SCREE_TRY(read_experiments(&r));
  SCREE_TRY(read_quantities(&r));
  return check_budget(&r);
}

scree_status scree_calibration_read(const char *path, scree_calibration **calibration,
                                    scree_error *error) {
  SCREE_OWNED(scree_calibration, c);
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  SCREE_TRY_ALLOC_ZERO(c, 1, error);
  SCREE_TRY(scree_file_read(path, LARGEST_FILE, &bytes, &c->text_size, error));
  c->text = scree_arena_text(&c->arena, bytes);
  c->path = scree_arena_text(&c->arena, path);
  if (!c->text || !c->path) return scree_fail_memory(error, c->text_size, path);
  SCREE_TRY(read_all(c, error));
  *calibration = c;
  c = NULL;
  return SCREE_OK;
}

void scree_calibration_free(scree_calibration *c) {
  if (!c) return;
  scree_yaml_free(&c->root);
  scree_free(c->folder);
  scree_free(c->runs);
  scree_arena_free(&c->run_arena);
  scree_arena_free(&c->arena);
  scree_free(c);
}

bool scree_calibration_is_search(const scree_calibration *c) {
  return c->plan.minimise || c->plan.maximise;
}
