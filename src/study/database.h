/* study.sqlite: opened, checked, and asked. */
#pragma once

#include "study/study.h"

struct sqlite3;
struct sqlite3_stmt;

/* A statement that is finalized with its block. */
#define SCREE_STATEMENT SCREE_CLEANUP(scree_statement_end) struct sqlite3_stmt *
void scree_statement_end(struct sqlite3_stmt **statement);

typedef struct scree_database {
  struct sqlite3 *handle;
  char path[SCREE_PATH_BYTES];
} scree_database;

/* Opens FOLDER/study.sqlite; for writing it is made where it is not there. SCREE_BAD_FILE where it
 * is no database of a study, or a damaged one. Close with scree_database_close. */
scree_status scree_database_open(const scree_study *study, bool writing, scree_database *database,
                                 scree_error *error);
void scree_database_close(scree_database *database);

scree_status scree_database_run(scree_database *database, const char *sql, scree_error *error);
scree_status scree_database_prepare(scree_database *database, const char *sql,
                                    struct sqlite3_stmt **statement, scree_error *error);
/* One step of a statement: *row whether it gave a row. */
scree_status scree_database_step(scree_database *database, struct sqlite3_stmt *statement,
                                 bool *row, scree_error *error);
