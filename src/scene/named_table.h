/* Tables as text: a line of names, then a line for each row, between commas; blank lines and those
 * that begin with # are passed over. Behind a name its unit may stand: `x [mm]`. */
#pragma once

#include "base/error.h"

typedef struct scree_named_column {
  const char *name, *unit; /* in which its values come; NULL: it is of words */
} scree_named_column;

enum { SCREE_NAMED_COLUMNS = 16 };

typedef struct scree_named_table {
  const char *name; /* of the file */
  char *rest;       /* of its text, which is cut up; NULL: it is over */
  const scree_named_column *known;
  int known_count;
  size_t line;
  int column_count, columns[SCREE_NAMED_COLUMNS]; /* which of the known each is */
  double factors[SCREE_NAMED_COLUMNS];            /* of its unit */
  bool there[SCREE_NAMED_COLUMNS];                /* of the known */
} scree_named_table;

/* SCREE_BAD_FILE with the file's name and the line. */
scree_status scree_named_fail(const scree_named_table *table, scree_error *error,
                              const char *format, ...) SCREE_PRINTF(3, 4);
/* The line of names of a text that is the caller's and stays. */
scree_status scree_named_open(scree_named_table *table, const char *name, char *text,
                              const scree_named_column *known, int known_count, scree_error *error);
/* The next row, by known columns: what is not there is left as it was. *there: whether there was
 * one. */
scree_status scree_named_row(scree_named_table *table, double *values, const char **words,
                             bool *there, scree_error *error);
