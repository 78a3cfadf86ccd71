/* From the database to what a study says: every point's statistics; where the angle has converged;
 * time against Rp. docs/reference/study.md has the reasons. */
#include "base/array.h"
#include "base/file.h"
#include "base/number.h"
#include "study/database.h"
#include "study/record.h"
#include "study/study.h"

#include <math.h>
#include <sqlite3.h>
#include <string.h>

/* Numbers of a run; behind these stand those that a record tells (study/record.h). */
enum {
  ANGLE,
  SECONDS,
  LEFT,
  PEAK_ROTATION, /* from its series */
  TRIANGLES,
  WALL,
  FRACTION,
  FIRST_TOLD,
  NUMBERS = FIRST_TOLD + SCREE_RECORD_TOLD
};

/* A run's row. */
typedef struct row {
  size_t point, replicate;
  char key[SCREE_RUN_KEY_BYTES], state[12], version[32];
  const char *reason;
  bool still;
  double number[NUMBERS];
  double *answers;         /* of a scene */
  double *time, *rotation; /* since the lift began */
  size_t series_count;
  double started, ended; /* s since 1970; NaN: it has not */
  const char *machine;
} row;

typedef struct analysis {
  const scree_study *study;
  scree_arena *arena;
  scree_database database;
  row *rows;
  size_t row_count;
  scree_study_result *result;
  scree_error *error;
} analysis;

static scree_status no_memory(const analysis *a) {
  return scree_fail_memory(a->error, 0, "the analysis of a study");
}

/* ---- reading ---- */

static double real_of(sqlite3_stmt *s, int column) {
  return sqlite3_column_type(s, column) == SQLITE_NULL ? NAN : sqlite3_column_double(s, column);
}
static void text_of(sqlite3_stmt *s, int column, char *text, size_t size) {
  const unsigned char *found = sqlite3_column_text(s, column);
  snprintf(text, size, "%s", found ? (const char *)found : "");
}

static scree_status read_row(analysis *a, sqlite3_stmt *s, row *r) {
  const unsigned char *reason = sqlite3_column_text(s, 4);
  char machine[160];
  r->point = (size_t)sqlite3_column_int64(s, 0);
  r->replicate = (size_t)sqlite3_column_int64(s, 1);
  text_of(s, 2, r->key, sizeof r->key);
  text_of(s, 3, r->state, sizeof r->state);
  r->reason = scree_arena_text(a->arena, reason ? (const char *)reason : "");
  text_of(s, 5, r->version, sizeof r->version);
  r->still = sqlite3_column_int64(s, 6) != 0;
  for (int i = 0; i < NUMBERS; i++) r->number[i] = real_of(s, 7 + i);
  r->started = real_of(s, 7 + NUMBERS);
  r->ended = real_of(s, 8 + NUMBERS);
  text_of(s, 9 + NUMBERS, machine, sizeof machine);
  r->machine = scree_arena_text(a->arena, machine);
  return r->reason && r->machine ? SCREE_OK : no_memory(a);
}

static scree_status read_rows(analysis *a) {
  char sql[1024];
  SCREE_STATEMENT s = NULL;
  size_t most = scree_study_run_count(a->study);
  SCREE_TRY_TAKE(a->rows, a->arena, most, a->error);
  snprintf(sql, sizeof sql,
           "SELECT point, replicate, key, state, reason, version, still, %s_deg, "
           "processor_seconds, CAST(left_count AS REAL) / (body_count + left_count), NULL, "
           "triangle_count, wall_seconds, fraction",
           a->study->analysis_angle);
  for (size_t i = 0; i < SCREE_RECORD_FIELDS; i++)
    if (scree_record_is_told[i]) SCREE_ADD_TEXT(sql, ", %s", scree_record_fields[i].key);
  SCREE_ADD_TEXT(sql, ", started, ended, machine FROM run WHERE planned = 1 ORDER BY run");
  SCREE_TRY(scree_database_prepare(&a->database, sql, &s, a->error));
  for (bool more; a->row_count < most;) {
    row *r = &a->rows[a->row_count];
    SCREE_TRY(scree_database_step(&a->database, s, &more, a->error));
    if (!more) break;
    SCREE_TRY(read_row(a, s, r));
    a->row_count += r->point < a->study->point_count;
  }
  return SCREE_OK;
}

/* Whether it is a phase before the one in which something moves. */
static bool is_early(const scree_study *study, const char *phase) {
  for (size_t i = 0; i < study->moving_phase && i < study->phase_count; i++)
    if (!strcmp(study->phases[i], phase)) return true;
  return false;
}

typedef struct number_list {
  double *items;
  size_t count, capacity;
} number_list;

static void free_numbers(number_list *list) {
  scree_free(list->items);
}

/* The series since the lift began; a run without one has none. */
static scree_status read_series(analysis *a, row *r, sqlite3_stmt *s) {
  SCREE_CLEANUP(free_numbers) number_list list = {0};
  double start = NAN;
  sqlite3_reset(s);
  sqlite3_bind_text(s, 1, r->key, -1, SQLITE_STATIC);
  for (bool more;;) {
    SCREE_TRY(scree_database_step(&a->database, s, &more, a->error));
    if (!more) break;
    const unsigned char *phase = sqlite3_column_text(s, 2);
    bool early = phase && is_early(a->study, (const char *)phase);
    if (isnan(start) && !early) start = real_of(s, 0);
    if (!SCREE_PUSH(&list, real_of(s, 0)) || !SCREE_PUSH(&list, real_of(s, 1))) return no_memory(a);
  }
  r->series_count = list.count / 2;
  SCREE_TRY_TAKE(r->time, a->arena, r->series_count, a->error);
  SCREE_TRY_TAKE(r->rotation, a->arena, r->series_count, a->error);
  for (size_t i = 0; i < r->series_count; i++) {
    r->time[i] = list.items[2 * i] - start;
    r->rotation[i] = list.items[2 * i + 1];
    if (r->time[i] >= 0) r->number[PEAK_ROTATION] = fmax(r->number[PEAK_ROTATION], r->rotation[i]);
  }
  if (isnan(start)) r->series_count = 0;
  return SCREE_OK;
}

static scree_status read_all_series(analysis *a) {
  SCREE_STATEMENT s = NULL;
  SCREE_TRY(scree_database_prepare(
      &a->database, "SELECT time, mean_rotation, phase FROM series WHERE key = ?1 ORDER BY time",
      &s, a->error));
  for (size_t i = 0; i < a->row_count; i++)
    if (!strcmp(a->rows[i].state, "done")) SCREE_TRY(read_series(a, &a->rows[i], s));
  return SCREE_OK;
}

/* ---- answers of a scene ---- */

static scree_status read_answers(analysis *a) {
  const scree_study *study = a->study;
  SCREE_STATEMENT s = NULL;
  for (size_t i = 0; i < a->row_count; i++) {
    SCREE_TRY_TAKE(a->rows[i].answers, a->arena, study->answer_count, a->error);
    for (size_t k = 0; k < study->answer_count; k++) a->rows[i].answers[k] = NAN;
  }
  if (!study->answer_count) return SCREE_OK;
  SCREE_TRY(scree_database_prepare(&a->database, "SELECT number, value FROM answer WHERE key = ?1",
                                   &s, a->error));
  for (size_t i = 0; i < a->row_count; i++) {
    sqlite3_reset(s);
    sqlite3_bind_text(s, 1, a->rows[i].key, -1, SQLITE_STATIC);
    for (bool more;;) {
      SCREE_TRY(scree_database_step(&a->database, s, &more, a->error));
      if (!more) break;
      size_t number = (size_t)sqlite3_column_int64(s, 0);
      if (number < study->answer_count) a->rows[i].answers[number] = real_of(s, 1);
    }
  }
  return SCREE_OK;
}

/* Where a row has number `index` of those that points have. */
static size_t number_at(size_t index) {
  return index < SCREE_RECORD_TOLD    ? FIRST_TOLD + index
         : index == SCREE_RECORD_TOLD ? LEFT
                                      : PEAK_ROTATION;
}

static scree_status name_numbers(const analysis *a) {
  scree_study_result *r = a->result;
  SCREE_TRY_TAKE(r->numbers, a->arena, SCREE_RECORD_TOLD + 2, a->error);
  for (size_t i = 0; i < SCREE_RECORD_FIELDS; i++)
    if (scree_record_is_told[i]) r->numbers[r->number_count++] = scree_record_fields[i].key;
  r->numbers[r->number_count++] = "left";
  r->numbers[r->number_count++] = "peak_rotation";
  return SCREE_OK;
}

static scree_status name_columns(const analysis *a) {
  scree_study_result *r = a->result;
  SCREE_TRY(name_numbers(a));
  r->answer_count = a->study->answer_count;
  SCREE_TRY_TAKE(r->answers, a->arena, r->answer_count, a->error);
  SCREE_TRY_TAKE(r->units, a->arena, r->answer_count, a->error);
  SCREE_TRY_TAKE(r->factors, a->arena, r->factor_count, a->error);
  for (size_t k = 0; k < r->answer_count; k++) {
    const scree_answer *answer = &a->study->answers[k];
    r->units[k] = answer->outline ? "m" : answer->unit ? answer->unit : "";
    if (!(r->answers[k] = scree_arena_text(a->arena, answer->name))) return no_memory(a);
  }
  for (size_t k = 0; k < r->factor_count; k++)
    if (!(r->factors[k] = scree_arena_text(a->arena, a->study->factors[k].key)))
      return no_memory(a);
  return SCREE_OK;
}

/* ---- points ---- */

static void count_state(scree_study_counts *counts, const char *state) {
  counts->waiting += !strcmp(state, "waiting");
  counts->leased += !strcmp(state, "leased");
  counts->running += !strcmp(state, "running");
  counts->done += !strcmp(state, "done");
  counts->failed += !strcmp(state, "failed");
}

/* Summary of one number, or one answer, over the point's finished runs. */
static scree_summary summarise(const analysis *a, size_t point, bool answer, size_t which,
                               double *scratch) {
  size_t count = 0;
  for (size_t i = 0; i < a->row_count; i++)
    if (a->rows[i].point == point && !strcmp(a->rows[i].state, "done"))
      scratch[count++] = answer ? a->rows[i].answers[which] : a->rows[i].number[which];
  return scree_summarise(scratch, count, a->study->confidence);
}

/* The value of a run's series at a time: between its points by a straight line; after its end the
 * last one if the run came to rest; else NaN. */
static double series_at(const row *r, double time) {
  size_t n = r->series_count;
  if (n == 0 || time < r->time[0]) return NAN;
  if (time > r->time[n - 1]) return r->still ? r->rotation[n - 1] : NAN;
  size_t low = 0, high = n - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (r->time[middle] <= time)
      low = middle;
    else
      high = middle;
  }
  double span = r->time[high] - r->time[low];
  double u = span > 0 ? (time - r->time[low]) / span : 0;
  return r->rotation[low] + u * (r->rotation[high] - r->rotation[low]);
}

/* Times at which runs are averaged: a run saves some thousands, a damaged record may ask for any
 * number. */
static const double MOST_TIMES = 10000;

static scree_status average_rotation(const analysis *a, size_t point, scree_point_result *p,
                                     double *scratch) {
  double start = INFINITY, end = -INFINITY, step = INFINITY;
  for (size_t i = 0; i < a->row_count; i++) {
    const row *r = &a->rows[i];
    if (r->point != point || r->series_count < 2) continue;
    start = fmin(start, r->time[0]);
    end = fmax(end, r->time[r->series_count - 1]);
    step = fmin(step, (r->time[r->series_count - 1] - r->time[0]) / (double)(r->series_count - 1));
  }
  if (!(end > start) || !(end - start < INFINITY)) return SCREE_OK;
  step = fmax(step, (end - start) / MOST_TIMES);
  if (!(step > 0)) return SCREE_OK;
  /* a multiple of the step from the lift on, so that zero is one of the times */
  double first = ceil(start / step) * step;
  if (!(first <= end)) return SCREE_OK;
  size_t count = (size_t)floor((end - first) / step) + 1;
  double **all[] = {&p->time, &p->rotation, &p->rotation_low, &p->rotation_high};
  for (int k = 0; k < 4; k++) SCREE_TRY_TAKE(*all[k], a->arena, count, a->error);
  for (size_t t = 0; t < count; t++) {
    size_t n = 0;
    p->time[t] = first + step * (double)t;
    for (size_t i = 0; i < a->row_count; i++)
      if (a->rows[i].point == point) scratch[n++] = series_at(&a->rows[i], p->time[t]);
    scree_summary s = scree_summarise(scratch, n, 0);
    double sd = isnan(s.sd) ? 0 : s.sd;
    p->rotation[t] = s.mean;
    p->rotation_low[t] = fmax(0, s.mean - sd);
    p->rotation_high[t] = s.mean + sd;
  }
  p->series_count = count;
  return SCREE_OK;
}

/* The Rp of a point as a number; of a multiple of the recommended ones with their geometric mean.
 * NaN of spheres, and where the shapes are not made yet. */
static double rp_value(const scree_study *study, const scree_study_point *point) {
  const scree_shape_set *set = &study->sets[point->set];
  double value = !strcmp(point->rp, "scan") ? 1 : NAN, factor, sum = 0;
  if (!scree_choice_is_recommended(point->rp, &factor)) {
    scree_number_read(point->rp, &value);
    return value;
  }
  for (size_t i = 0; i < set->count; i++) {
    const scree_study_shape *shape = &study->shapes[set->shapes[i]];
    if (!(shape->recommended_rp > 0)) return NAN;
    sum += log(fmin(1, factor * shape->recommended_rp));
  }
  return exp(sum / (double)set->count);
}

static scree_status make_point(const analysis *a, size_t index, double *scratch) {
  const scree_study_point *point = &a->study->points[index];
  scree_point_result *p = &a->result->points[index];
  p->label = scree_arena_text(a->arena, point->label);
  p->rp = scree_arena_text(a->arena, point->rp);
  p->shapes = scree_arena_text(a->arena, a->study->sets[point->set].label);
  SCREE_TRY_TAKE(p->values, a->arena, a->study->factor_count, a->error);
  SCREE_TRY_TAKE(p->answers, a->arena, a->study->answer_count, a->error);
  SCREE_TRY_TAKE(p->numbers, a->arena, a->result->number_count, a->error);
  if (!p->label || !p->rp || !p->shapes) return no_memory(a);
  for (size_t k = 0; k < a->study->factor_count; k++)
    if (!(p->values[k] = scree_arena_text(a->arena, point->values[k]))) return no_memory(a);
  p->rp_value = rp_value(a->study, point);
  for (size_t i = 0; i < a->row_count; i++) { /* rows of low replicates come first */
    const row *r = &a->rows[i];
    if (r->point != index) continue;
    count_state(&p->counts, r->state);
    if (p->pile || strcmp(r->state, "done") != 0) continue;
    p->pile = scree_arena_text(a->arena, r->key);
    if (!p->pile) return no_memory(a);
  }
  p->angle_deg = summarise(a, index, false, ANGLE, scratch);
  p->seconds = summarise(a, index, false, SECONDS, scratch);
  for (size_t k = 0; k < a->result->number_count; k++)
    p->numbers[k] = summarise(a, index, false, number_at(k), scratch);
  p->triangle_count = summarise(a, index, false, TRIANGLES, scratch).mean;
  p->heap_count = p->angle_deg.count;
  for (size_t k = 0; k < a->study->answer_count; k++)
    p->answers[k] = summarise(a, index, true, k, scratch);
  return average_rotation(a, index, p, scratch);
}

/* ---- families ---- */

static size_t rp_factor(const scree_study *study) {
  for (size_t f = 0; f < study->factor_count; f++)
    if (!strcmp(study->factors[f].key, "rp")) return f;
  return SIZE_MAX;
}

static bool same_family(const scree_study *study, size_t a, size_t b) {
  for (size_t f = 0; f < study->factor_count; f++)
    if (strcmp(study->factors[f].key, "rp") != 0 &&
        strcmp(study->points[a].values[f], study->points[b].values[f]) != 0)
      return false;
  return true;
}

static const char *family_label(const analysis *a, size_t point) {
  char text[512] = "";
  size_t used = 0;
  for (size_t f = 0; f < a->study->factor_count && used < sizeof text; f++)
    if (strcmp(a->study->factors[f].key, "rp") != 0)
      used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %s", used ? ", " : "",
                               a->study->factors[f].key, a->study->points[point].values[f]);
  return scree_arena_text(a->arena, text);
}

/* Levels by rising Rp, spheres and clumps apart. */
static void gather_levels(const analysis *a, size_t first, scree_family_result *family) {
  const scree_point_result *points = a->result->points;
  family->spheres = SIZE_MAX;
  for (size_t p = first; p < a->study->point_count; p++) {
    if (!same_family(a->study, first, p)) continue;
    if (!strcmp(points[p].rp, "spheres")) {
      family->spheres = p;
      continue;
    }
    if (scree_study_spheres(points[p].rp)) continue;
    size_t at = family->level_count++;
    for (; at > 0 && points[family->levels[at - 1]].rp_value > points[p].rp_value; at--)
      family->levels[at] = family->levels[at - 1];
    family->levels[at] = p;
  }
}

static void test_convergence(const analysis *a, scree_family_result *family) {
  const scree_point_result *points = a->result->points;
  double alpha = 1 - a->study->confidence;
  size_t finest = family->level_count - 1;
  const scree_summary *reference = &points[family->levels[finest]].angle_deg;
  for (size_t i = 0; i < finest; i++)
    family->comparisons[i] =
        scree_compare(&points[family->levels[i]].angle_deg, reference, a->study->margin_deg, alpha);
  family->converged_from = finest;
  while (family->converged_from > 0 && family->comparisons[family->converged_from - 1].equivalent)
    family->converged_from--;
  family->converged = family->converged_from < finest;
}

/* Whether even the lowest Rp chosen lies at or above the Rp converged from. A tenth of a per mille
 * is forgiven: grids are written with few digits. */
static scree_in_range in_range(const analysis *a, const scree_family_result *family, double low) {
  if (!family->converged || !(low > 0)) return SCREE_IN_RANGE_UNKNOWN;
  double from = a->result->points[family->levels[family->converged_from]].rp_value;
  return low >= from * (1 - 1e-4) ? SCREE_IN_RANGE_YES : SCREE_IN_RANGE_NO;
}

/* The mean of the shapes' chosen Rp, each a double at an offset in scree_study_shape; NaN where
 * some are not made yet. */
static scree_rp_pick gather_pick(const analysis *a, size_t point, size_t offset,
                                 const scree_family_result *family) {
  const scree_shape_set *set = &a->study->sets[a->study->points[point].set];
  scree_rp_pick pick = {.low = INFINITY};
  double sum = 0;
  for (size_t i = 0; i < set->count; i++) {
    double rp;
    memcpy(&rp, (const char *)&a->study->shapes[set->shapes[i]] + offset, sizeof rp);
    if (!(rp > 0)) return (scree_rp_pick){NAN, NAN, NAN, SCREE_IN_RANGE_UNKNOWN};
    pick.low = fmin(pick.low, rp);
    pick.high = fmax(pick.high, rp);
    sum += log(rp);
  }
  pick.mean = exp(sum / (double)set->count);
  pick.in_range = in_range(a, family, pick.low);
  return pick;
}

/* Where levels are multiples of the recommended one, it is in the range by the multiple: shapes of
 * a set have each its own Rp. */
static void gather_picks(const analysis *a, size_t point, scree_family_result *family) {
  double factor;
  family->by_ip = gather_pick(a, point, offsetof(scree_study_shape, paper_rp), family);
  family->by_robust = gather_pick(a, point, offsetof(scree_study_shape, robust_rp), family);
  family->recommended = gather_pick(a, point, offsetof(scree_study_shape, recommended_rp), family);
  const char *from = a->result->points[family->levels[family->converged_from]].rp;
  if (family->recommended.in_range != SCREE_IN_RANGE_UNKNOWN &&
      scree_choice_is_recommended(from, &factor))
    family->recommended.in_range = factor <= 1 ? SCREE_IN_RANGE_YES : SCREE_IN_RANGE_NO;
}

static scree_status fit_time(const analysis *a, scree_family_result *family) {
  double *x, *y;
  size_t count = 0;
  SCREE_TRY_TAKE(x, a->arena, a->row_count, a->error);
  SCREE_TRY_TAKE(y, a->arena, a->row_count, a->error);
  for (size_t i = 0; i < a->row_count; i++)
    for (size_t k = 0; k < family->level_count; k++)
      if (a->rows[i].point == family->levels[k] && a->rows[i].number[SECONDS] > 0) {
        x[count] = a->result->points[family->levels[k]].rp_value;
        y[count++] = a->rows[i].number[SECONDS];
      }
  /* too few levels yet: counts stay 0 */
  scree_fit_power(x, y, count, a->study->confidence, &family->time_law, NULL);
  scree_fit_polynomial(x, y, count, SCREE_POLYNOMIAL_DEGREE, &family->time_curve, NULL);
  return SCREE_OK;
}

static scree_status make_family(const analysis *a, size_t first, scree_family_result *family) {
  SCREE_TRY_TAKE(family->levels, a->arena, a->study->point_count, a->error);
  SCREE_TRY_TAKE(family->comparisons, a->arena, a->study->point_count, a->error);
  family->label = family_label(a, first);
  if (!family->label) return no_memory(a);
  gather_levels(a, first, family);
  if (family->level_count < 2) return SCREE_OK;
  test_convergence(a, family);
  gather_picks(a, first, family);
  return fit_time(a, family);
}

static scree_status make_families(analysis *a) {
  scree_study_result *r = a->result;
  if (rp_factor(a->study) == SIZE_MAX || a->study->design != SCREE_DESIGN_GRID) return SCREE_OK;
  SCREE_TRY_TAKE(r->families, a->arena, a->study->point_count, a->error);
  for (size_t p = 0; p < a->study->point_count; p++) {
    bool seen = false;
    for (size_t q = 0; q < p && !seen; q++) seen = same_family(a->study, p, q);
    if (seen) continue;
    scree_family_result family = {0};
    SCREE_TRY(make_family(a, p, &family));
    if (family.level_count >= 2) r->families[r->family_count++] = family;
  }
  return SCREE_OK;
}

/* ---- the whole ---- */

static scree_status make_whole(analysis *a) {
  scree_study_result *r = a->result;
  double wall = 0, left = 0;
  const char *version = NULL;
  SCREE_TRY_TAKE(r->failures, a->arena, a->row_count, a->error);
  for (size_t i = 0; i < a->row_count; i++) {
    const row *w = &a->rows[i];
    count_state(&r->counts, w->state);
    if (!strcmp(w->state, "failed"))
      r->failures[r->failure_count++] =
          (scree_failure){r->points[w->point].label, w->reason, w->replicate};
    if (!strcmp(w->state, "waiting")) left += 1;
    if (!strcmp(w->state, "leased")) left += 1;
    if (!strcmp(w->state, "running"))
      left += isnan(w->number[FRACTION]) ? 1 : 1 - w->number[FRACTION];
    if (strcmp(w->state, "done") != 0) continue;
    wall += w->number[WALL];
    r->seconds_spent += w->number[SECONDS];
    if (version && strcmp(version, w->version) != 0) r->mixed_versions = true;
    version = w->version;
    if (r->origin.started == 0 || w->started < r->origin.started) r->origin.started = w->started;
    if (w->ended >= r->origin.ended) r->origin.ended = w->ended, r->origin.machine = w->machine;
  }
  r->worker_count = r->counts.leased + r->counts.running;
  double workers = r->worker_count > 0 ? (double)r->worker_count : 1;
  r->seconds_left = left == 0        ? 0
                    : r->counts.done ? left * wall / (double)r->counts.done / workers
                                     : NAN;
  return SCREE_OK;
}

static scree_status add_input(analysis *a, const char *path, scree_checksum checksum) {
  scree_input *out = &a->result->origin.inputs[a->result->origin.input_count++];
  *out = (scree_input){scree_arena_text(a->arena, path), checksum};
  return out->path ? SCREE_OK : no_memory(a);
}

/* The study's own text, its scene's and its shapes. */
static scree_status list_inputs(analysis *a) {
  const scree_study *s = a->study;
  SCREE_TRY_TAKE(a->result->origin.inputs, a->arena, 2 + s->shape_count, a->error);
  SCREE_TRY(add_input(a, s->path, scree_checksum_of(s->text, s->text_size)));
  if (s->scene_text && s->scene_is_file)
    SCREE_TRY(add_input(a, s->scene_path, scree_checksum_of(s->scene_text, strlen(s->scene_text))));
  for (size_t i = 0; i < s->shape_count; i++)
    if (s->shapes[i].known) SCREE_TRY(add_input(a, s->shapes[i].word, s->shapes[i].checksum));
  return SCREE_OK;
}

static scree_status make_result(analysis *a) {
  const scree_study *s = a->study;
  scree_study_result *r = a->result;
  r->name = scree_arena_text(a->arena, s->name);
  r->design = scree_study_design_name(s);
  r->method = scree_method_name(s->method);
  r->angle = scree_arena_text(a->arena, s->analysis_angle);
  r->version = scree_version();
  r->replicate_count = s->replicate_count;
  r->point_count = s->point_count;
  r->factor_count = s->factor_count;
  r->seed = s->seed;
  r->margin_deg = s->margin_deg;
  r->confidence = s->confidence;
  double *scratch;
  SCREE_TRY_TAKE(r->points, a->arena, s->point_count, a->error);
  SCREE_TRY_TAKE(scratch, a->arena, scree_study_run_count(s), a->error);
  if (!r->name || !r->angle) return no_memory(a);
  SCREE_TRY(read_rows(a));
  SCREE_TRY(read_all_series(a));
  SCREE_TRY(read_answers(a));
  SCREE_TRY(name_columns(a));
  for (size_t p = 0; p < s->point_count; p++) SCREE_TRY(make_point(a, p, scratch));
  SCREE_TRY(make_families(a));
  SCREE_TRY(list_inputs(a));
  return make_whole(a);
}

scree_status scree_study_analyse(const scree_study *study, scree_study_result *result,
                                 scree_error *error) {
  SCREE_CLEANUP(scree_study_result_free) scree_study_result made = {0};
  analysis a = {.study = study, .result = &made, .error = error};
  SCREE_TRY_ALLOC_ZERO(a.arena, 1, error);
  made.memory = a.arena;
  SCREE_TRY(scree_database_open(study, false, &a.database, error));
  scree_status status = make_result(&a);
  scree_database_close(&a.database);
  SCREE_TRY(status);
  *result = made;
  made = (scree_study_result){0};
  return SCREE_OK;
}

void scree_study_result_free(scree_study_result *result) {
  if (result->memory) scree_arena_free(result->memory);
  scree_free(result->memory);
  *result = (scree_study_result){0};
}
