#include "study/database.h"

#include "base/file.h"
#include "base/platform.h"
#include "study/record.h"

#include <sqlite3.h>
#include <string.h>

enum { APPLICATION = 0x73637253 /* "scrS" */, BUSY_MS = 60000 };

/* The columns of runs and of the series go on with the fields of records. */
static const char tables[] =
    "CREATE TABLE study(name TEXT PRIMARY KEY, value);"
    "CREATE TABLE shape(name TEXT PRIMARY KEY, source TEXT, checksum TEXT, triangle_count INTEGER,"
    " area REAL, volume REAL, paper_rp REAL, robust_rp REAL,"
    " recommended_rp REAL);"
    "CREATE TABLE point(point INTEGER PRIMARY KEY, label TEXT, rp TEXT, shapes TEXT);"
    "CREATE TABLE factor(point INTEGER, key TEXT, value TEXT, PRIMARY KEY(point, key));"
    "CREATE TABLE parameter(point INTEGER, key TEXT, value TEXT, PRIMARY KEY(point, key));"
    "CREATE TABLE failure(key TEXT, number INTEGER, reason TEXT, worker TEXT, ended REAL,"
    " PRIMARY KEY(key, number));";
static const char runs[] =
    "CREATE TABLE run(key TEXT PRIMARY KEY, planned INTEGER, run INTEGER, point INTEGER,"
    " replicate INTEGER, seed INTEGER, state TEXT, reason TEXT, attempts INTEGER, worker TEXT,"
    " fraction REAL";
enum { OF_RUNS = 3 }; /* fields that stand there already, or are no column */
static const char series[] = "CREATE TABLE series(key TEXT, time REAL, phase TEXT, bodies INTEGER";

static const char *type_of(scree_field_kind kind) {
  return kind == SCREE_FIELD_REAL ? "REAL" : kind == SCREE_FIELD_CHARS ? "TEXT" : "INTEGER";
}

/* The tables; their version is the checksum of this text, for their columns are rows elsewhere. */
static void write_schema(char sql[4096]) {
  snprintf(sql, 4096, "%s%s", tables, runs);
  for (size_t i = OF_RUNS; i + 1 < SCREE_RECORD_FIELDS; i++)
    scree_add_text(sql, 4096, ", %s %s", scree_record_fields[i].key,
                   type_of(scree_record_fields[i].kind));
  scree_add_text(sql, 4096, ");%s", series);
  for (size_t i = 1; i < SCREE_RECORD_COLUMNS; i++)
    scree_add_text(sql, 4096, ", %s REAL", scree_record_columns[i].key);
  scree_add_text(sql, 4096, ", PRIMARY KEY(key, time)) WITHOUT ROWID;");
}

static int32_t version_of(const char *sql) {
  return (int32_t)(scree_checksum_of(sql, strlen(sql)).low & INT32_MAX);
}

static scree_status make_tables(scree_database *d, const char *sql, scree_error *error) {
  char begin[128];
  snprintf(begin, sizeof begin,
           "BEGIN IMMEDIATE; PRAGMA application_id = %d; PRAGMA user_version = %d;", APPLICATION,
           version_of(sql));
  SCREE_TRY(scree_database_run(d, begin, error));
  SCREE_TRY(scree_database_run(d, sql, error));
  return scree_database_run(d, "COMMIT", error);
}

/* The table of answers, of studies of scenes. */
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

void scree_statement_end(sqlite3_stmt **statement) {
  sqlite3_finalize(*statement);
}

static scree_status ask_number(scree_database *d, const char *sql, int64_t *number,
                               scree_error *error) {
  SCREE_STATEMENT statement = NULL;
  bool row;
  SCREE_TRY(scree_database_prepare(d, sql, &statement, error));
  SCREE_TRY(scree_database_step(d, statement, &row, error));
  *number = row ? sqlite3_column_int64(statement, 0) : 0;
  return SCREE_OK;
}

/* An empty file becomes ours; another one must be. */
static scree_status adopt(scree_database *d, bool writing, scree_error *error) {
  int64_t application = 0, version = 0, table_count = 0;
  SCREE_TRY(ask_number(d, "PRAGMA application_id", &application, error));
  SCREE_TRY(ask_number(d, "PRAGMA user_version", &version, error));
  SCREE_TRY(ask_number(d, "SELECT count(*) FROM sqlite_master", &table_count, error));
  char sql[4096];
  write_schema(sql);
  if (writing && application == 0 && table_count == 0) return make_tables(d, sql, error);
  if (application != APPLICATION)
    return scree_fail(error, SCREE_BAD_FILE, "%s: is a database, but not one of a study", d->path);
  if (version != version_of(sql))
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: has the tables of another version of scree; delete it, and the same "
                      "command makes it again from the results beside it",
                      d->path);
  return SCREE_OK;
}

/* A rollback journal, not WAL, which shared folders cannot do. */
scree_status scree_database_open(const scree_study *study, bool writing, scree_database *database,
                                 scree_error *error) {
  SCREE_CLEANUP(scree_database_close) scree_database d = {0};
  scree_study_path(study, "", "study.sqlite", "", d.path);
  if (!writing && !scree_path_exists(d.path))
    return scree_fail(error, SCREE_IO, "%s: not there yet", d.path);
  int flags = writing ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  if (sqlite3_open_v2(d.path, &d.handle, flags, NULL) != SQLITE_OK)
    return d.handle ? fail_database(&d, error) : scree_fail_memory(error, 0, d.path);
  sqlite3_busy_timeout(d.handle, BUSY_MS);
  if (writing)
    SCREE_TRY(
        scree_database_run(&d, "PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL;", error));
  SCREE_TRY(adopt(&d, writing, error));
  if (writing) SCREE_TRY(scree_database_run(&d, answers_table, error));
  *database = d;
  d.handle = NULL;
  return SCREE_OK;
}

void scree_database_close(scree_database *database) {
  sqlite3_close(database->handle);
  *database = (scree_database){0};
}
