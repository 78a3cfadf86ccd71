/* From the folder's files to the database. One process collects at a time, under a lease; each time
 * the plan is written anew and records that are not in yet are added, in one transaction. */
#include "base/number.h"
#include "base/platform.h"
#include "scene/file.h"
#include "study/database.h"
#include "study/lease.h"
#include "study/record.h"

#include <math.h>
#include <sqlite3.h>
#include <string.h>

static const double writer_lease = 120; /* s */

typedef struct writer {
  const scree_study *study;
  scree_database database;
  const char *leases;
  scree_error *error;
} writer;

/* ---- statements ---- */

static scree_status make(writer *w, const char *sql, sqlite3_stmt **statement) {
  return scree_database_prepare(&w->database, sql, statement, w->error);
}

/* What takes the place of a ?: a text, a number, a whole number. */
typedef struct value {
  const char *text; /* NULL: none */
  double real;      /* where it is not finite there is no value */
  uint64_t whole;
  bool is_whole;
} value;

static value text_value(const char *text) {
  return (value){.text = text};
}
static value real_value(double real) {
  return (value){.real = real};
}
static value whole_value(uint64_t whole) {
  return (value){.whole = whole, .is_whole = true};
}

static void bind(sqlite3_stmt *statement, int place, const value *v) {
  if (v->text)
    sqlite3_bind_text(statement, place, v->text, -1, SQLITE_TRANSIENT);
  else if (v->is_whole)
    sqlite3_bind_int64(statement, place, (sqlite3_int64)v->whole);
  else if (isfinite(v->real))
    sqlite3_bind_double(statement, place, v->real);
}

/* Runs a statement that gives no rows with values for ?1, ?2, ... */
static scree_status put_values(writer *w, sqlite3_stmt *statement, const value *values,
                               size_t count) {
  bool row;
  for (size_t i = 0; i < count; i++) bind(statement, (int)i + 1, &values[i]);
  scree_status status = scree_database_step(&w->database, statement, &row, w->error);
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  return status;
}
#define PUT(w, statement, ...)                                                                     \
  put_values(w, statement, (const value[]){__VA_ARGS__},                                           \
             sizeof((const value[]){__VA_ARGS__}) / sizeof(value))

/* ---- the plan ---- */

static scree_status put_facts(writer *w) {
  const scree_study *s = w->study;
  char seed[32], margin[SCREE_NUMBER_SIZE], confidence[SCREE_NUMBER_SIZE], points[32],
      replicates[32];
  snprintf(seed, sizeof seed, "%llu", (unsigned long long)s->seed);
  scree_number_format_digits(s->margin_deg, 9, margin);
  scree_number_format_digits(s->confidence, 9, confidence);
  snprintf(points, sizeof points, "%zu", s->point_count);
  snprintf(replicates, sizeof replicates, "%zu", s->replicate_count);
  const char *facts[][2] = {{"name", s->name},
                            {"version", scree_version()},
                            {"design", scree_study_design_name(s)},
                            {"seed", seed},
                            {"points", points},
                            {"replicates", replicates},
                            {"method", scree_method_name(s->method)},
                            {"angle", s->analysis_angle},
                            {"margin_deg", margin},
                            {"confidence", confidence},
                            {"yaml", s->text}};
  SCREE_STATEMENT statement = NULL;
  SCREE_TRY(make(w, "INSERT OR REPLACE INTO study VALUES(?1, ?2)", &statement));
  for (size_t i = 0; i < sizeof facts / sizeof *facts; i++)
    SCREE_TRY(PUT(w, statement, text_value(facts[i][0]), text_value(facts[i][1])));
  return SCREE_OK;
}

static scree_status put_shapes(writer *w) {
  SCREE_STATEMENT statement = NULL;
  SCREE_TRY(make(w, "INSERT OR REPLACE INTO shape VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)",
                 &statement));
  for (size_t i = 0; i < w->study->shape_count; i++) {
    const scree_study_shape *shape = &w->study->shapes[i];
    char sum[SCREE_CHECKSUM_TEXT];
    if (!shape->known) continue;
    scree_checksum_text(shape->checksum, sum);
    SCREE_TRY(PUT(w, statement, text_value(shape->name), text_value(shape->word), text_value(sum),
                  whole_value(shape->triangle_count), real_value(shape->area),
                  real_value(shape->volume), real_value(shape->paper_rp),
                  real_value(shape->robust_rp), real_value(shape->recommended_rp)));
  }
  return SCREE_OK;
}

/* The values of a point: its factors, and the whole scene that follows, as text. */
static scree_status put_point(writer *w, size_t point, sqlite3_stmt *factor,
                              sqlite3_stmt *parameter) {
  const scree_study *s = w->study;
  SCREE_OWNED(scree_scene_file, file);
  SCREE_CLEANUP(scree_free_at) char *text = NULL;
  for (size_t f = 0; f < s->factor_count; f++)
    SCREE_TRY(PUT(w, factor, whole_value(point), text_value(s->factors[f].key),
                  text_value(s->points[point].values[f])));
  if (s->command.count) return SCREE_OK;
  SCREE_TRY(scree_study_scene(s, &s->points[point], &file, w->error));
  SCREE_TRY(scree_scene_file_text(file, &text, w->error));
  return PUT(w, parameter, whole_value(point), text_value("scene"), text_value(text));
}

static scree_status put_points(writer *w) {
  const scree_study *s = w->study;
  SCREE_STATEMENT point = NULL;
  SCREE_STATEMENT factor = NULL;
  SCREE_STATEMENT parameter = NULL;
  SCREE_TRY(scree_database_run(
      &w->database, "DELETE FROM point; DELETE FROM factor; DELETE FROM parameter;", w->error));
  SCREE_TRY(make(w, "INSERT INTO point VALUES(?1, ?2, ?3, ?4)", &point));
  SCREE_TRY(make(w, "INSERT INTO factor VALUES(?1, ?2, ?3)", &factor));
  SCREE_TRY(make(w, "INSERT INTO parameter VALUES(?1, ?2, ?3)", &parameter));
  for (size_t i = 0; i < s->point_count; i++) {
    const scree_study_point *p = &s->points[i];
    SCREE_TRY(PUT(w, point, whole_value(i), text_value(p->label), text_value(p->rp),
                  text_value(s->sets[p->set].label)));
    SCREE_TRY(put_point(w, i, factor, parameter));
  }
  return SCREE_OK;
}

/* ---- runs ---- */

static value count_value(uint64_t count) {
  return count == SCREE_UNKNOWN_COUNT ? real_value(NAN) : whole_value(count);
}

static value field_value(const scree_field *f, const scree_study_record *r) {
  const void *at = scree_field_at(f, r);
  return f->kind == SCREE_FIELD_REAL    ? real_value(*(const double *)at)
         : f->kind == SCREE_FIELD_FLAG  ? whole_value(*(const bool *)at)
         : f->kind == SCREE_FIELD_CHARS ? text_value(at)
                                        : count_value(scree_field_whole(f, r));
}

static scree_status put_result(writer *w, const char *key, const scree_study_record *r) {
  char sql[2048] = "UPDATE run SET state = ?2, fraction = 1";
  value values[SCREE_RECORD_FIELDS + 2] = {text_value(key),
                                           text_value(r->failed ? "failed" : "done")};
  size_t count = 2;
  SCREE_STATEMENT statement = NULL;
  for (size_t i = 1; i + 1 < SCREE_RECORD_FIELDS; i++) {
    bool there = !r->failed || i < SCREE_RECORD_OF_FAILED;
    values[count++] = there ? field_value(&scree_record_fields[i], r) : real_value(NAN);
    SCREE_ADD_TEXT(sql, ", %s = ?%zu", scree_record_fields[i].key, count);
  }
  SCREE_ADD_TEXT(sql, " WHERE key = ?1");
  SCREE_TRY(make(w, sql, &statement));
  return put_values(w, statement, values, count);
}

static scree_status put_series(writer *w, const char *key, const scree_study_record *r) {
  SCREE_STATEMENT statement = NULL;
  char sql[256] = "INSERT OR REPLACE INTO series VALUES(?1, ?2, ?3";
  for (int i = 3; i < 3 + SCREE_RECORD_COLUMNS; i++) SCREE_ADD_TEXT(sql, ", ?%d", i + 1);
  SCREE_ADD_TEXT(sql, ")");
  SCREE_TRY(make(w, sql, &statement));
  for (size_t i = 0; i < r->series_count; i++) {
    const scree_record_point *p = &r->series[i];
    value values[3 + SCREE_RECORD_COLUMNS] = {
        text_value(key), real_value(p->time),
        text_value(p->phase < w->study->phase_count ? w->study->phases[p->phase] : "done"),
        whole_value(p->body_count)};
    for (size_t k = 1; k < SCREE_RECORD_COLUMNS; k++)
      values[3 + k] = real_value(*scree_record_number(&r->series[i], k));
    SCREE_TRY(put_values(w, statement, values, 3 + SCREE_RECORD_COLUMNS));
  }
  return SCREE_OK;
}

static scree_status put_answers(writer *w, const char *key, const scree_study_record *r) {
  SCREE_STATEMENT statement = NULL;
  char mark[SCREE_CHECKSUM_TEXT];
  scree_study_answers_mark(w->study, mark);
  if (strcmp(mark, r->answered) != 0) return SCREE_OK; /* the next worker takes them anew */
  SCREE_TRY(make(w, "INSERT OR REPLACE INTO answer VALUES(?1, ?2, ?3, ?4)", &statement));
  for (size_t i = 0; i < r->answer_count && i < w->study->answer_count; i++)
    SCREE_TRY(PUT(w, statement, text_value(key), whole_value(i),
                  text_value(w->study->answers[i].name), real_value(r->answers[i])));
  return SCREE_OK;
}

/* Earlier failures, which later attempts have moved aside. */
static scree_status put_failures(writer *w, const char *key) {
  SCREE_STATEMENT statement = NULL;
  SCREE_TRY(make(w, "INSERT OR REPLACE INTO failure VALUES(?1, ?2, ?3, ?4, ?5)", &statement));
  for (uint64_t n = 1;; n++) {
    char ending[32];
    snprintf(ending, sizeof ending, ".failed-%d", (int)n);
    const char *path = SCREE_STUDY_PATH(w->study, "results", key, ending);
    SCREE_CLEANUP(scree_study_record_free) scree_study_record r = {0};
    if (!scree_path_exists(path)) return SCREE_OK;
    if (scree_study_record_read(path, &r, NULL) != SCREE_OK) continue;
    SCREE_TRY(PUT(w, statement, text_value(key), whole_value(n), text_value(r.reason),
                  text_value(r.worker), real_value(r.ended)));
  }
}

static scree_status put_state(writer *w, const char *key, sqlite3_stmt *update) {
  char name[64], last[SCREE_LEASE_NAME] = "";
  const char *state = "waiting";
  double fraction = NAN;
  snprintf(name, sizeof name, "run-%s", key);
  scree_lease_view view = scree_lease_look(w->leases, name, 300);
  if (view.held && view.alive) {
    bool running = !strncmp(view.note, "running ", 8);
    state = running ? "running" : "leased";
    if (running) scree_number_parse(view.note + 8, view.note + strlen(view.note), &fraction);
  }
  return PUT(w, update, text_value(key), text_value(state),
             text_value(view.alive ? view.worker : ""), real_value(fraction),
             whole_value(scree_lease_deaths(w->leases, name, last)));
}

static bool in_already(writer *w, const char *key, sqlite3_stmt *ask, double ended) {
  bool row = false;
  const value of_key = text_value(key);
  bind(ask, 1, &of_key);
  bool same = scree_database_step(&w->database, ask, &row, NULL) == SCREE_OK && row &&
              sqlite3_column_double(ask, 0) == ended;
  sqlite3_reset(ask);
  return same;
}

/* *found: whether the run has ended; a damaged record is none, the next worker puts it aside. */
static scree_status put_record(writer *w, const char *key, sqlite3_stmt *ask, bool *found) {
  SCREE_CLEANUP(scree_study_record_free) scree_study_record record = {0};
  const char *path = SCREE_STUDY_PATH(w->study, "results", key, ".yaml");
  *found = scree_path_exists(path);
  if (!*found) return SCREE_OK;
  scree_status status = scree_study_record_read(path, &record, w->error);
  *found = status != SCREE_BAD_FILE;
  if (!*found) return SCREE_OK;
  SCREE_TRY(status);
  if (in_already(w, key, ask, record.ended)) return SCREE_OK;
  SCREE_TRY(put_result(w, key, &record));
  if (!record.failed) SCREE_TRY(put_series(w, key, &record));
  if (!record.failed) SCREE_TRY(put_answers(w, key, &record));
  return put_failures(w, key);
}

static scree_status put_runs(writer *w) {
  const scree_study *s = w->study;
  SCREE_STATEMENT insert = NULL;
  SCREE_STATEMENT update = NULL;
  SCREE_STATEMENT ask = NULL;
  SCREE_TRY(scree_database_run(&w->database, "UPDATE run SET planned = 0", w->error));
  SCREE_TRY(make(w,
                 "INSERT INTO run(key, planned, run, point, replicate, seed, state) VALUES(?1, 1, "
                 "?2, ?3, ?4, ?5, 'waiting') ON CONFLICT(key) DO UPDATE SET planned = 1, run = "
                 "?2, point = ?3, replicate = ?4, seed = ?5",
                 &insert));
  SCREE_TRY(make(w,
                 "UPDATE run SET state = ?2, worker = ?3, fraction = ?4, attempts = ?5, reason = "
                 "NULL, ended = NULL WHERE key = ?1",
                 &update));
  SCREE_TRY(make(w, "SELECT ended FROM run WHERE key = ?1 AND state IN ('done', 'failed')", &ask));
  for (size_t i = 0; i < scree_study_run_count(s); i++) {
    bool found;
    SCREE_TRY(PUT(
        w, insert, text_value(s->keys[i]), whole_value(i), whole_value(scree_study_run_point(s, i)),
        whole_value(scree_study_run_replicate(s, i)), whole_value(scree_study_run_seed(s, i))));
    SCREE_TRY(put_record(w, s->keys[i], ask, &found));
    if (!found) SCREE_TRY(put_state(w, s->keys[i], update));
  }
  return SCREE_OK;
}

static scree_status write_all(writer *w) {
  SCREE_TRY(scree_database_run(&w->database, "BEGIN IMMEDIATE", w->error));
  SCREE_TRY(put_facts(w));
  SCREE_TRY(put_shapes(w));
  SCREE_TRY(put_points(w));
  if (w->study->keys) SCREE_TRY(put_runs(w));
  return scree_database_run(&w->database, "COMMIT", w->error);
}

scree_status scree_study_collect(scree_study *study, bool wait, scree_error *error) {
  writer w = {.study = study, .error = error};
  char worker[SCREE_LEASE_NAME];
  bool taken = false;
  scree_lease lease;
  scree_lease_default_worker(worker);
  w.leases = SCREE_STUDY_PATH(study, "leases", "", "");
  for (;;) {
    SCREE_TRY(scree_lease_take(w.leases, "writer", writer_lease, worker, &taken, &lease, error));
    if (taken) break;
    if (!wait) return SCREE_OK;
    scree_sleep(0.2);
  }
  scree_status status = scree_database_open(study, true, &w.database, error);
  if (status == SCREE_OK) status = write_all(&w);
  scree_database_close(&w.database); /* rolls back what was not committed */
  scree_lease_release(&lease);
  return status;
}
