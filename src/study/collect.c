/* From the folder's files to the database. One process collects at a time, under a lease; each time
 * the plan is written anew and records that are not in yet are added, in one transaction. */
#include "base/number.h"
#include "base/platform.h"
#include "scene/scene.h"
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

static scree_status make(writer *w, const char *sql, sqlite3_stmt **statement) {
  return scree_database_prepare(&w->database, sql, statement, w->error);
}

/* Runs a filled statement that gives no rows, and makes it ready for the next values. */
static scree_status put(writer *w, sqlite3_stmt *statement) {
  bool row;
  scree_status status = scree_database_step(&w->database, statement, &row, w->error);
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  return status;
}

static void bind_text(sqlite3_stmt *statement, int column, const char *text) {
  sqlite3_bind_text(statement, column, text, -1, SQLITE_TRANSIENT);
}
static void bind_real(sqlite3_stmt *statement, int column, double value) {
  if (isfinite(value))
    sqlite3_bind_double(statement, column, value);
  else
    sqlite3_bind_null(statement, column);
}
static void bind_whole(sqlite3_stmt *statement, int column, uint64_t value) {
  sqlite3_bind_int64(statement, column, (sqlite3_int64)value);
}

/* ---- the plan ---- */

static scree_status put_facts(writer *w) {
  const scree_study *s = w->study;
  static const char *const designs[] = {"grid", "latin", "sobol", "list"};
  char seed[32], margin[SCREE_NUMBER_SIZE], confidence[SCREE_NUMBER_SIZE], points[32],
      replicates[32];
  snprintf(seed, sizeof seed, "%llu", (unsigned long long)s->seed);
  scree_number_format_digits(s->margin_deg, 9, margin);
  scree_number_format_digits(s->confidence, 9, confidence);
  snprintf(points, sizeof points, "%zu", s->point_count);
  snprintf(replicates, sizeof replicates, "%zu", s->replicate_count);
  const char *facts[][2] = {{"name", s->name},
                            {"version", scree_version()},
                            {"design", designs[s->design]},
                            {"seed", seed},
                            {"points", points},
                            {"replicates", replicates},
                            {"method", scree_method_name(s->method)},
                            {"angle", s->analysis_angle},
                            {"margin_deg", margin},
                            {"confidence", confidence},
                            {"yaml", s->text}};
  sqlite3_stmt *statement;
  scree_status status = make(w, "INSERT OR REPLACE INTO study VALUES(?1, ?2)", &statement);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; status == SCREE_OK && i < sizeof facts / sizeof *facts; i++) {
    bind_text(statement, 1, facts[i][0]);
    bind_text(statement, 2, facts[i][1]);
    status = put(w, statement);
  }
  sqlite3_finalize(statement);
  return status;
}

static scree_status put_shapes(writer *w) {
  sqlite3_stmt *statement;
  scree_status status = make(
      w, "INSERT OR REPLACE INTO shape VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)", &statement);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; status == SCREE_OK && i < w->study->shape_count; i++) {
    const scree_study_shape *shape = &w->study->shapes[i];
    char sum[SCREE_CHECKSUM_TEXT];
    if (!shape->known) continue;
    scree_checksum_text(shape->checksum, sum);
    bind_text(statement, 1, shape->name);
    bind_text(statement, 2, shape->word);
    bind_text(statement, 3, sum);
    bind_whole(statement, 4, shape->triangle_count);
    bind_real(statement, 5, shape->area);
    bind_real(statement, 6, shape->volume);
    bind_real(statement, 7, shape->paper_rp);
    bind_real(statement, 8, shape->robust_rp);
    bind_real(statement, 9, shape->recommended_rp);
    status = put(w, statement);
  }
  sqlite3_finalize(statement);
  return status;
}

static scree_status put_pair(writer *w, sqlite3_stmt *statement, size_t point, const char *key,
                             const char *value) {
  bind_whole(statement, 1, point);
  bind_text(statement, 2, key);
  bind_text(statement, 3, value);
  return put(w, statement);
}

/* The values of a point: its factors, and the whole scene that follows, as text. */
static scree_status put_values(writer *w, size_t point, sqlite3_stmt *factor,
                               sqlite3_stmt *parameter) {
  const scree_study *s = w->study;
  scree_scene_file *file;
  char *text = NULL;
  scree_status status = SCREE_OK;
  for (size_t f = 0; status == SCREE_OK && f < s->factor_count; f++)
    status = put_pair(w, factor, point, s->factors[f].key, s->points[point].values[f]);
  if (status != SCREE_OK || s->command.count) return status;
  SCREE_TRY(scree_study_scene(s, &s->points[point], &file, w->error));
  status = scree_scene_file_text(file, &text, w->error);
  scree_scene_file_free(file);
  if (status == SCREE_OK) status = put_pair(w, parameter, point, "scene", text);
  scree_free(text);
  return status;
}

static scree_status put_points(writer *w) {
  const scree_study *s = w->study;
  sqlite3_stmt *point = NULL, *factor = NULL, *parameter = NULL;
  scree_status status = scree_database_run(
      &w->database, "DELETE FROM point; DELETE FROM factor; DELETE FROM parameter;", w->error);
  if (status == SCREE_OK) status = make(w, "INSERT INTO point VALUES(?1, ?2, ?3, ?4)", &point);
  if (status == SCREE_OK) status = make(w, "INSERT INTO factor VALUES(?1, ?2, ?3)", &factor);
  if (status == SCREE_OK) status = make(w, "INSERT INTO parameter VALUES(?1, ?2, ?3)", &parameter);
  for (size_t i = 0; status == SCREE_OK && i < s->point_count; i++) {
    bind_whole(point, 1, i);
    bind_text(point, 2, s->points[i].label);
    bind_text(point, 3, s->points[i].rp);
    bind_text(point, 4, s->sets[s->points[i].set].label);
    status = put(w, point);
    if (status == SCREE_OK) status = put_values(w, i, factor, parameter);
  }
  sqlite3_finalize(point);
  sqlite3_finalize(factor);
  sqlite3_finalize(parameter);
  return status;
}

/* ---- runs ---- */

static scree_status put_result(writer *w, const char *key, const scree_study_record *r) {
  static const char sql[] =
      "UPDATE run SET state = ?2, reason = ?3, worker = ?4, machine = ?5, version = ?6, started = "
      "?7, ended = ?8, triangle_count = ?9, time_step = ?10, step_count = ?11, particle_steps = "
      "?12, wall_seconds = ?13, processor_seconds = ?14, piece_count = ?15, largest_overlap = ?16, "
      "heap = ?17, heap_reason = ?18, sector_deg = ?19, sector_sd_deg = ?20, cone_deg = ?21, "
      "silhouette_deg = ?22, silhouette_sd_deg = ?23, height = ?24, base_radius = ?25, run_out = "
      "?26, body_count = ?27, left_count = ?28, packing_fraction = ?29, coordination = ?30, "
      "particle_size = ?31, kinetic = ?32, time = ?33, still = ?34, hash = ?35, fraction = 1 WHERE "
      "key = ?1";
  sqlite3_stmt *s;
  SCREE_TRY(make(w, sql, &s));
  const scree_repose *p = &r->result.repose;
  bind_text(s, 1, key);
  bind_text(s, 2, r->failed ? "failed" : "done");
  bind_text(s, 3, r->reason);
  bind_text(s, 4, r->worker);
  bind_text(s, 5, r->machine);
  bind_text(s, 6, r->version);
  bind_real(s, 7, r->started);
  bind_real(s, 8, r->ended);
  bind_real(s, 9, r->triangle_count);
  if (!r->failed) {
    const double reals[] = {
        p->sector_deg,        p->sector_sd_deg, p->cone_deg,    p->silhouette_deg,
        p->silhouette_sd_deg, p->height,        p->base_radius, p->run_out};
    bind_real(s, 10, r->costs.time_step);
    bind_whole(s, 11, r->costs.step_count);
    bind_whole(s, 12, r->costs.particle_steps);
    bind_real(s, 13, r->costs.wall_seconds);
    bind_real(s, 14, r->costs.processor_seconds);
    bind_whole(s, 15, r->costs.piece_count);
    bind_real(s, 16, r->costs.largest_overlap);
    bind_whole(s, 17, p->heap);
    bind_text(s, 18, p->reason);
    for (int i = 0; i < 8; i++) bind_real(s, 19 + i, reals[i]);
    bind_whole(s, 27, r->result.body_count);
    bind_whole(s, 28, r->result.left_count);
    bind_real(s, 29, r->result.packing_fraction);
    bind_real(s, 30, r->result.coordination);
    bind_real(s, 31, r->result.particle_size);
    bind_real(s, 32, r->result.kinetic);
    bind_real(s, 33, r->result.time);
    bind_whole(s, 34, r->result.still);
    bind_text(s, 35, r->hash);
  }
  scree_status status = put(w, s);
  sqlite3_finalize(s);
  return status;
}

static scree_status put_series(writer *w, const char *key, const scree_study_record *r) {
  sqlite3_stmt *s;
  scree_status status = make(w,
                             "INSERT OR REPLACE INTO series VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, "
                             "?9, ?10, ?11, ?12, ?13, ?14)",
                             &s);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; status == SCREE_OK && i < r->series_count; i++) {
    const scree_record_point *p = &r->series[i];
    const double reals[] = {
        p->mean_rotation,   p->kinetic,    p->highest_speed, p->largest_overlap, p->coordination,
        p->cylinder_height, p->sector_deg, p->cone_deg,      p->silhouette_deg,  p->height};
    bind_text(s, 1, key);
    bind_real(s, 2, p->time);
    bind_text(s, 3, p->phase < w->study->phase_count ? w->study->phases[p->phase] : "done");
    bind_whole(s, 4, p->body_count);
    for (int k = 0; k < 10; k++) bind_real(s, 5 + k, reals[k]);
    status = put(w, s);
  }
  sqlite3_finalize(s);
  return status;
}

static scree_status put_answers(writer *w, const char *key, const scree_study_record *r) {
  sqlite3_stmt *s;
  char mark[SCREE_CHECKSUM_TEXT];
  scree_study_answers_mark(w->study, mark);
  if (strcmp(mark, r->answered) != 0) return SCREE_OK; /* the next worker takes them anew */
  scree_status status = make(w, "INSERT OR REPLACE INTO answer VALUES(?1, ?2, ?3, ?4)", &s);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; status == SCREE_OK && i < r->answer_count && i < w->study->answer_count; i++) {
    bind_text(s, 1, key);
    bind_whole(s, 2, i);
    bind_text(s, 3, w->study->answers[i].name);
    bind_real(s, 4, r->answers[i]);
    status = put(w, s);
  }
  sqlite3_finalize(s);
  return status;
}

static scree_status put_failure(writer *w, const char *key, int number,
                                const scree_study_record *r) {
  sqlite3_stmt *s;
  SCREE_TRY(make(w, "INSERT OR REPLACE INTO failure VALUES(?1, ?2, ?3, ?4, ?5)", &s));
  bind_text(s, 1, key);
  bind_whole(s, 2, (uint64_t)number);
  bind_text(s, 3, r->reason);
  bind_text(s, 4, r->worker);
  bind_real(s, 5, r->ended);
  scree_status status = put(w, s);
  sqlite3_finalize(s);
  return status;
}

/* Earlier failures, which later attempts have moved aside. */
static scree_status put_failures(writer *w, const char *key) {
  scree_status status = SCREE_OK;
  for (int n = 1; status == SCREE_OK; n++) {
    char ending[32];
    scree_study_record record;
    snprintf(ending, sizeof ending, ".failed-%d", n);
    const char *path = SCREE_STUDY_PATH(w->study, "results", key, ending);
    bool there = scree_path_exists(path);
    if (there && scree_study_record_read(path, &record, NULL) == SCREE_OK) {
      status = put_failure(w, key, n, &record);
      scree_study_record_free(&record);
    }
    if (!there) break;
  }
  return status;
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
  bind_text(update, 1, key);
  bind_text(update, 2, state);
  bind_text(update, 3, view.alive ? view.worker : "");
  bind_real(update, 4, fraction);
  bind_whole(update, 5, scree_lease_deaths(w->leases, name, last));
  return put(w, update);
}

static scree_status put_run(writer *w, size_t index, sqlite3_stmt *insert) {
  const scree_study *s = w->study;
  bind_text(insert, 1, s->keys[index]);
  bind_whole(insert, 2, index);
  bind_whole(insert, 3, scree_study_run_point(s, index));
  bind_whole(insert, 4, scree_study_run_replicate(s, index));
  bind_whole(insert, 5, scree_study_run_seed(s, index));
  return put(w, insert);
}

static bool in_already(writer *w, const char *key, sqlite3_stmt *ask, double ended) {
  bool row = false;
  bind_text(ask, 1, key);
  bool same = scree_database_step(&w->database, ask, &row, NULL) == SCREE_OK && row &&
              sqlite3_column_double(ask, 0) == ended;
  sqlite3_reset(ask);
  return same;
}

static scree_status put_record(writer *w, const char *key, sqlite3_stmt *ask, bool *found) {
  scree_study_record record;
  const char *path = SCREE_STUDY_PATH(w->study, "results", key, ".yaml");
  *found = scree_path_exists(path);
  scree_status status = *found ? scree_study_record_read(path, &record, w->error) : SCREE_OK;
  if (status == SCREE_BAD_FILE) { /* the next worker puts it aside */
    *found = false;
    return SCREE_OK;
  }
  if (status != SCREE_OK || !*found) return status;
  if (!in_already(w, key, ask, record.ended)) {
    status = put_result(w, key, &record);
    if (status == SCREE_OK && !record.failed) status = put_series(w, key, &record);
    if (status == SCREE_OK && !record.failed) status = put_answers(w, key, &record);
    if (status == SCREE_OK) status = put_failures(w, key);
  }
  scree_study_record_free(&record);
  return status;
}

static scree_status put_runs(writer *w) {
  sqlite3_stmt *insert = NULL, *update = NULL, *ask = NULL;
  scree_status status = scree_database_run(&w->database, "UPDATE run SET planned = 0", w->error);
  if (status == SCREE_OK)
    status = make(w,
                  "INSERT INTO run(key, planned, run, point, replicate, seed, state) VALUES(?1, 1, "
                  "?2, ?3, ?4, ?5, 'waiting') ON CONFLICT(key) DO UPDATE SET planned = 1, run = "
                  "?2, point = ?3, replicate = ?4, seed = ?5",
                  &insert);
  if (status == SCREE_OK)
    status = make(w,
                  "UPDATE run SET state = ?2, worker = ?3, fraction = ?4, attempts = ?5, reason = "
                  "NULL, ended = NULL WHERE key = ?1",
                  &update);
  if (status == SCREE_OK)
    status = make(w, "SELECT ended FROM run WHERE key = ?1 AND state IN ('done', 'failed')", &ask);
  for (size_t i = 0; status == SCREE_OK && i < scree_study_run_count(w->study); i++) {
    bool found;
    const char *key = w->study->keys[i];
    status = put_run(w, i, insert);
    if (status == SCREE_OK) status = put_record(w, key, ask, &found);
    if (status == SCREE_OK && !found) status = put_state(w, key, update);
  }
  sqlite3_finalize(insert);
  sqlite3_finalize(update);
  sqlite3_finalize(ask);
  return status;
}

static scree_status write_all(writer *w) {
  SCREE_TRY(scree_database_open(w->study, true, &w->database, w->error));
  scree_status status = scree_database_run(&w->database, "BEGIN IMMEDIATE", w->error);
  if (status == SCREE_OK) status = put_facts(w);
  if (status == SCREE_OK) status = put_shapes(w);
  if (status == SCREE_OK) status = put_points(w);
  if (status == SCREE_OK && w->study->keys) status = put_runs(w);
  if (status == SCREE_OK) status = scree_database_run(&w->database, "COMMIT", w->error);
  scree_database_close(&w->database); /* rolls back what was not committed */
  return status;
}

scree_status scree_study_collect(scree_study *study, bool wait, scree_error *error) {
  writer w = {.study = study, .error = error};
  char worker[SCREE_LEASE_NAME];
  bool taken = false;
  scree_lease lease;
  scree_lease_default_worker(worker);
  w.leases = SCREE_STUDY_PATH(study, "leases", "", "");
  scree_status status;
  for (;;) {
    status = scree_lease_take(w.leases, "writer", writer_lease, worker, &taken, &lease, error);
    if (status != SCREE_OK || taken || !wait) break;
    scree_sleep(0.2);
  }
  if (status == SCREE_OK && taken) {
    status = write_all(&w);
    scree_lease_release(&lease);
  }
  return status;
}
