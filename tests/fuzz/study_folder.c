/* The files of a study's folder, one of them of the fuzzer's making: what is known of a shape, a
 * lease, the list of its dead holders, the database as bytes, or the database with any values in
 * its tables. Opened, looked at, analysed and reported, or refused in a sentence. */
#define _GNU_SOURCE /* memfd_create, nftw */
#include "fuzz/folder.h"
#include "report/program.h"
#include "study/database.h"
#include "study/lease.h"

#include <sqlite3.h>
#include <string.h>
#include <sys/stat.h>

typedef enum kind { SHAPE, LEASE, DEATHS, BYTES, VALUES, KINDS } kind;

enum { MOST_ROWS = 40 };

static const char plan[] = "name: fuzz\nreplicates: 2\nbase: {preset: demo}\nunit: m\n"
                           "shapes: [sample:box, a.stl]\nfactors: {rp: [spheres, 0.1, 0.2, 1]}\n";
static const char box[] =
    "source: 'sample:box'\nchecksum: '0123456789abcdef0123456789abcdef'\n"
    "triangle_count: 12\narea: 6\nvolume: 1\npaper_rp: 1\nrobust_rp: 0.5\nrecommended_rp: 0.5\n";

static void start(void) {
  static const char *const kinds[] = {"shapes", "leases", "runs", "results"};
  fuzz_make_folder();
  for (int i = 0; i < 4; i++) FUZZ_CHECK(mkdir(fuzz_in_folder(kinds[i]), 0700) == 0);
  fuzz_write(fuzz_in_folder("study.yaml"), plan, sizeof plan - 1);
  fuzz_write(fuzz_in_folder("shapes/box.yaml"), box, sizeof box - 1);
}

/* ---- any values in the tables ---- */

static void bind(sqlite3_stmt *s, int column, const uint8_t *data, size_t size, size_t *at) {
  static const double reals[] = {0, -1, 1e308, -1e308, 4e-324, 45, 0x1p63};
  static const char *const texts[] = {"", "done", "failed", "running", "lifting", "settling", "0"};
  uint8_t byte = *at < size ? data[(*at)++] : 0;
  if (byte < 64)
    sqlite3_bind_int64(s, column, byte - 8);
  else if (byte < 128)
    sqlite3_bind_double(s, column, byte / 3.0);
  else if (byte < 160)
    sqlite3_bind_text(s, column, texts[byte % 7], -1, SQLITE_STATIC);
  else if (byte < 192)
    sqlite3_bind_double(s, column, reals[byte % 7]);
  else if (byte < 208)
    sqlite3_bind_blob(s, column, data, byte % 16 < (int)size ? byte % 16 : 0, SQLITE_STATIC);
  else if (byte < 224)
    sqlite3_bind_int64(s, column, byte & 1 ? INT64_MAX : INT64_MIN);
  else
    sqlite3_bind_null(s, column);
}

static void insert(sqlite3 *handle, const char *sql, int columns, const uint8_t *data, size_t size,
                   size_t *at) {
  sqlite3_stmt *s;
  FUZZ_CHECK(sqlite3_prepare_v2(handle, sql, -1, &s, NULL) == SQLITE_OK);
  for (int row = 0; row < MOST_ROWS && *at < size; row++) {
    if (data[(*at)++] % 8 == 0) break;
    for (int c = 1; c <= columns; c++) bind(s, c, data, size, at);
    sqlite3_step(s); /* a key that is there already is refused */
    sqlite3_reset(s);
  }
  sqlite3_finalize(s);
}

/* The rows of the tables that are read back. */
static void fill_tables(const scree_study *study, const uint8_t *data, size_t size) {
  scree_database d;
  scree_error error;
  size_t at = 0;
  FUZZ_CHECK(scree_database_open(study, true, &d, &error) == SCREE_OK);
  sqlite3_exec(d.handle, "PRAGMA synchronous = OFF; BEGIN", NULL, NULL, NULL);
  insert(d.handle,
         "INSERT INTO run(key, planned, run, point, replicate, state, reason, version, sector_deg, "
         "processor_seconds, wall_seconds, height, run_out, coordination, packing_fraction, "
         "body_count, left_count, triangle_count, still, fraction) "
         "VALUES(?,1,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
         19, data, size, &at);
  insert(d.handle, "INSERT INTO series(key, time, phase, mean_rotation) VALUES(?,?,?,?)", 4, data,
         size, &at);
  sqlite3_exec(d.handle, "COMMIT", NULL, NULL, NULL);
  scree_database_close(&d);
}

/* ---- the folder ---- */

static void put_file(kind which, const uint8_t *data, size_t size) {
  static const char *const names[] = {"shapes/a.yaml", "leases/run", "leases/run.deaths",
                                      "study.sqlite"};
  for (int i = 0; i < 4; i++) unlink(fuzz_in_folder(names[i]));
  if (which < VALUES) fuzz_write(fuzz_in_folder(names[which]), data, size);
}

static void check_sentence(scree_status status, const scree_error *error) {
  FUZZ_CHECK(status == SCREE_OK || (error->message[0] && !strchr(error->message, '\n')));
  FUZZ_CHECK(status != SCREE_OUT_OF_MEMORY);
}

static void look_at_leases(void) {
  scree_lease lease;
  scree_error error = {0};
  char last[SCREE_LEASE_NAME], path[128];
  bool taken;
  snprintf(path, sizeof path, "%s/leases", fuzz_folder);
  scree_lease_view view = scree_lease_look(path, "run", 1e6);
  FUZZ_CHECK(strlen(view.worker) < sizeof view.worker && strlen(view.note) < sizeof view.note);
  scree_lease_deaths(path, "run", last);
  FUZZ_CHECK(scree_lease_take(path, "run", 1e6, "fuzz", &taken, &lease, &error) == SCREE_OK);
  FUZZ_CHECK(taken || view.held);
  if (taken) scree_lease_release(&lease);
}

/* Whether it could be. */
static bool analyse(const scree_study *study) {
  scree_study_result result;
  scree_error error = {0};
  scree_status status = scree_study_analyse(study, &result, &error);
  check_sentence(status, &error);
  if (status != SCREE_OK) return false;
  for (size_t i = 0; i < result.point_count; i++) FUZZ_CHECK(result.points[i].label);
  FUZZ_CHECK(scree_study_json_write(&result, "/dev/null", true, &error) == SCREE_OK);
  FUZZ_CHECK(scree_study_csv_write(&result, "/dev/null", true, &error) == SCREE_OK);
  scree_study_result_free(&result);
  return true;
}

/* With what is known of a shape from the fuzzer. */
static void open_with_shape(void) {
  scree_study *study = NULL;
  scree_error error = {0};
  scree_status status = scree_study_open_folder(fuzz_folder, &study, &error);
  check_sentence(status, &error);
  scree_study_free(study);
}

/* Once for all inputs, which takes longer than all that comes after it. */
static scree_study *study;

static void close_study(void) {
  scree_study_free(study);
}

static void open_study(void) {
  scree_error error = {0};
  start();
  FUZZ_CHECK(scree_study_open_folder(fuzz_folder, &study, &error) == SCREE_OK);
  scree_study_result result;
  if (scree_study_analyse(study, &result, &error) == SCREE_OK) scree_study_result_free(&result);
  atexit(close_study);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size < 1) return 0;
  if (!study) open_study();
  size_t used = scree_memory_used();
  kind which = data[0] % KINDS;
  put_file(which, data + 1, size - 1);
  if (which == SHAPE) open_with_shape();
  if (which == VALUES) fill_tables(study, data + 1, size - 1);
  if (which == LEASE || which == DEATHS) look_at_leases();
  bool analysed = (which == BYTES || which == VALUES) && analyse(study);
  fuzz_taken += which == BYTES && size > 1 && analysed;
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
