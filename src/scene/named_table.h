/* Tables of known columns (base/rows.h): a line of names, then a line for each row. Behind a name
 * its unit may stand: `x [mm]`. */
#pragma once

#include "base/rows.h"

typedef struct scree_named_column {
  const char *name, *unit; /* in which its values come; NULL: it is of words */
} scree_named_column;

enum { SCREE_NAMED_COLUMNS = 16 };

typedef struct scree_named_table {
  scree_text_rows rows;
  const scree_named_column *known;
  int known_count;
  size_t column_count;
  int columns[SCREE_ROW_CELLS];    /* which of the known each is; -1: one that counts the rows */
  double factors[SCREE_ROW_CELLS]; /* of its unit */
  bool there[SCREE_NAMED_COLUMNS]; /* of the known */
} scree_named_table;

/* The line of names of a text of `size` bytes, and a 0 behind them, that is the caller's and stays.
 */
scree_status scree_named_open(scree_named_table *table, const char *name, char *text, size_t size,
                              const scree_named_column *known, int known_count, scree_error *error);
/* The next row, by known columns: what is not there is left as it was. *there: whether there was
 * one. */
scree_status scree_named_row(scree_named_table *table, double *values, const char **words,
                             bool *there);
