/* A file of two columns of numbers, as CSV or with blanks between. */
#pragma once

#include "base/error.h"

typedef struct scree_curve_file {
  size_t count;
  double *x, *y;
  char units[2][24]; /* as the head says, `x [mm], z [mm]`; "" where it says none */
} scree_curve_file;

/* A table (base/rows.h) whose first row may be a head; x rises. SCREE_BAD_FILE with the line. Free
 * with scree_curve_file_free. */
scree_status scree_curve_file_read(const char *path, scree_curve_file *columns, scree_error *error);
void scree_curve_file_free(scree_curve_file *columns);
/* Brings a column, 0 or 1, into `wanted`; a column without a unit is in units of `otherwise`. */
scree_status scree_curve_file_convert(scree_curve_file *columns, int column, const char *wanted,
                                      double otherwise, const char *path, scree_error *error);
