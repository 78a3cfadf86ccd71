#include "study/database.h"

#include "base/platform.h"

#include <sqlite3.h>

/* "scrS" and the version of the tables */
enum { APPLICATION = 0x73637253, SCHEMA = 2, BUSY_MS = 60000 };

static const char schema[] =
    "CREATE TABLE study(name TEXT PRIMARY KEY, value);"
    "CREATE TABLE shape(name TEXT PRIMARY KEY, source TEXT, checksum TEXT, triangle_count INTEGER,"
    " area REAL, volume REAL, paper_rp REAL, robust_rp REAL,"
    " recommended_rp REAL);"
    "CREATE TABLE point(point INTEGER PRIMARY KEY, label TEXT, rp TEXT, shapes TEXT);"
    "CREATE TABLE factor(point INTEGER, key TEXT, value TEXT, PRIMARY KEY(point, key));"
    "CREATE TABLE parameter(point INTEGER, key TEXT, value TEXT, PRIMARY KEY(point, key));"
    "CREATE TABLE run(key TEXT PRIMARY KEY, planned INTEGER, run INTEGER, point INTEGER,"
    " replicate INTEGER, seed INTEGER, state TEXT, reason TEXT, attempts INTEGER, worker TEXT,"
    " fraction REAL, machine TEXT, version TEXT, started REAL, ended REAL, triangle_count REAL,"
    " time_step REAL, step_count INTEGER, particle_steps INTEGER, wall_seconds REAL,"
    " processor_seconds REAL, piece_count INTEGER, largest_overlap REAL, heap INTEGER,"
    " heap_reason TEXT, sector_deg REAL, sector_sd_deg REAL, cone_deg REAL, silhouette_deg REAL,"
    " silhouette_sd_deg REAL, height REAL, base_radius REAL, run_out REAL, body_count INTEGER,"
    " left_count INTEGER, packing_fraction REAL, coordination REAL, particle_size REAL,"
    " kinetic REAL, time REAL, still INTEGER, hash TEXT);"
    "CREATE TABLE series(key TEXT, time REAL, phase TEXT, bodies INTEGER, mean_rotation REAL,"
    " kinetic REAL, highest_speed REAL, largest_overlap REAL, coordination REAL,"
    " cylinder_height REAL, sector_deg REAL, cone_deg REAL, silhouette_deg REAL, height REAL,"
    " PRIMARY KEY(key, time)) WITHOUT ROWID;"
    "CREATE TABLE failure(key TEXT, number INTEGER, reason TEXT, worker TEXT, ended REAL,"
    " PRIMARY KEY(key, number));";

/* Of studies of scenes. */
static const char answers_table[] =
    "CREATE TABLE IF NOT EXISTS answer(key TEXT, number INTEGER, name TEXT, value REAL,"
    " PRIMARY KEY(key, number))";

static scree_status fail_database(const scree_database *d, scree_error *error) {
  int code = sqlite3_errcode(d->handle);
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: is damaged (%s); delete it, and the same command makes it again from "
                      "the results beside it",
                      d->path, sqlite3_errmsg(d->handle));
  if (code == SQLITE_NOMEM) return scree_fail_memory(error, 0, d->path);
  return scree_fail(error, SCREE_IO, "%s: %s", d->path, sqlite3_errmsg(d->handle));
}

scree_status scree_database_run(scree_database *d, const char *sql, scree_error *error) {
  if (sqlite3_exec(d->handle, sql, NULL, NULL, NULL) == SQLITE_OK) return SCREE_OK;
  return fail_database(d, error);
}

scree_status scree_database_prepare(scree_database *d, const char *sql, sqlite3_stmt **statement,
                                    scree_error *error) {
  if (sqlite3_prepare_v2(d->handle, sql, -1, statement, NULL) == SQLITE_OK) return SCREE_OK;
  return fail_database(d, error);
}

scree_status scree_database_step(scree_database *d, sqlite3_stmt *statement, bool *row,
                                 scree_error *error) {
  int code = sqlite3_step(statement);
  *row = code == SQLITE_ROW;
  return code == SQLITE_ROW || code == SQLITE_DONE ? SCREE_OK : fail_database(d, error);
}

static scree_status ask_number(scree_database *d, const char *sql, int64_t *number,
                               scree_error *error) {
  sqlite3_stmt *statement;
  bool row;
  SCREE_TRY(scree_database_prepare(d, sql, &statement, error));
  scree_status status = scree_database_step(d, statement, &row, error);
  if (status == SCREE_OK) *number = row ? sqlite3_column_int64(statement, 0) : 0;
  sqlite3_finalize(statement);
  return status;
}

/* An empty file becomes ours; another one must be. */
static scree_status adopt(scree_database *d, bool writing, scree_error *error) {
  int64_t application = 0, version = 0, tables = 0;
  SCREE_TRY(ask_number(d, "PRAGMA application_id", &application, error));
  SCREE_TRY(ask_number(d, "PRAGMA user_version", &version, error));
  SCREE_TRY(ask_number(d, "SELECT count(*) FROM sqlite_master", &tables, error));
  if (writing && application == 0 && tables == 0) {
    char sql[sizeof schema + 160];
    snprintf(sql, sizeof sql,
             "BEGIN IMMEDIATE; PRAGMA application_id = %d; PRAGMA user_version = "
             "%d; %s COMMIT;",
             APPLICATION, SCHEMA, schema);
    return scree_database_run(d, sql, error);
  }
  if (application != APPLICATION)
    return scree_fail(error, SCREE_BAD_FILE, "%s: is a database, but not one of a study", d->path);
  if (version != SCHEMA)
    return scree_fail(
        error, SCREE_BAD_FILE,
        "%s: has tables of version %lld, this scree knows %d; delete it, and the same "
        "command makes it again from the results beside it",
        d->path, (long long)version, SCHEMA);
  return SCREE_OK;
}

/* A rollback journal, not WAL, which shared folders cannot do. */
scree_status scree_database_open(const scree_study *study, bool writing, scree_database *database,
                                 scree_error *error) {
  scree_database d = {0};
  scree_study_path(study, "", "study.sqlite", "", d.path);
  scree_status status = SCREE_OK;
  if (!writing && !scree_path_exists(d.path))
    status = scree_fail(error, SCREE_IO, "%s: not there yet", d.path);
  int flags = writing ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  if (status == SCREE_OK && sqlite3_open_v2(d.path, &d.handle, flags, NULL) != SQLITE_OK)
    status = d.handle ? fail_database(&d, error) : scree_fail_memory(error, 0, d.path);
  if (status == SCREE_OK) sqlite3_busy_timeout(d.handle, BUSY_MS);
  if (status == SCREE_OK && writing)
    status =
        scree_database_run(&d, "PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL;", error);
  if (status == SCREE_OK) status = adopt(&d, writing, error);
  if (status == SCREE_OK && writing) status = scree_database_run(&d, answers_table, error);
  if (status == SCREE_OK)
    *database = d;
  else
    scree_database_close(&d);
  return status;
}

void scree_database_close(scree_database *database) {
  sqlite3_close(database->handle);
  *database = (scree_database){0};
}
