#include "base/curve_file.h"

#include "base/array.h"
#include "base/file.h"
#include "base/rows.h"
#include "base/unit.h"

#include <math.h>

enum { LARGEST_FILE = 16 << 20 };

void scree_curve_file_free(scree_curve_file *c) {
  scree_free(c->x);
  scree_free(c->y);
  *c = (scree_curve_file){0};
}

/* Names with units; how many columns before the first of the two: one that counts the rows. */
static size_t read_names(const scree_text_rows *rows, scree_curve_file *c) {
  size_t first = rows->count == 3 && scree_cell_is_index(rows->cells[0]);
  for (size_t k = 0; k < 2 && first + k < rows->count; k++)
    snprintf(c->units[k], sizeof c->units[k], "%s", scree_cell_unit(rows->cells[first + k]));
  return first;
}

static scree_status read_row(const scree_text_rows *rows, size_t first, size_t capacity[2],
                             scree_curve_file *c) {
  if (rows->count < first + 2) return scree_rows_fail(rows, "needs two numbers");
  if (rows->count > first + 2) return scree_rows_fail(rows, "has more than two numbers");
  if (!scree_array_reserve((void **)&c->x, &capacity[0], c->count + 1, sizeof *c->x) ||
      !scree_array_reserve((void **)&c->y, &capacity[1], c->count + 1, sizeof *c->y))
    return scree_fail_memory(rows->error, c->count * sizeof *c->x, rows->name);
  double *x = &c->x[c->count], *y = &c->y[c->count];
  SCREE_TRY(scree_rows_number(rows, first, "the first of two numbers", x));
  SCREE_TRY(scree_rows_number(rows, first + 1, "the second of two numbers", y));
  if (!isfinite(*x) || !isfinite(*y)) return scree_rows_fail(rows, "a number that is not finite");
  if (c->count > 0 && !(*x > x[-1]))
    return scree_rows_fail(rows, "%g does not come after %g", *x, x[-1]);
  c->count++;
  return SCREE_OK;
}

static scree_status read_rows(const char *path, char *bytes, size_t size, scree_curve_file *c,
                              scree_error *error) {
  scree_text_rows rows;
  size_t first = 0, capacity[2] = {0};
  SCREE_TRY(scree_rows_open(&rows, path, bytes, size, error));
  for (bool there, begun = false;; begun = true) {
    SCREE_TRY(scree_rows_next_row(&rows, &there));
    if (!there) break;
    if (!begun && !scree_rows_has_number(&rows, 0) && !scree_rows_has_number(&rows, 1))
      first = read_names(&rows, c);
    else
      SCREE_TRY(read_row(&rows, first, capacity, c));
  }
  if (c->count >= 3) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_FILE, "%s: a curve needs three points, not %zu", path,
                    c->count);
}

scree_status scree_curve_file_read(const char *path, scree_curve_file *columns,
                                   scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  SCREE_CLEANUP(scree_curve_file_free) scree_curve_file c = {0};
  size_t size;
  SCREE_TRY(scree_file_read(path, LARGEST_FILE, &bytes, &size, error));
  SCREE_TRY(read_rows(path, bytes, size, &c, error));
  *columns = c;
  c = (scree_curve_file){0};
  return SCREE_OK;
}

scree_status scree_curve_file_convert(scree_curve_file *c, int column, const char *wanted,
                                      double otherwise, const char *path, scree_error *error) {
  double factor = 1, *values = column ? c->y : c->x;
  const char *unit = c->units[column];
  if (!*unit)
    factor = otherwise;
  else if (scree_unit_convert(unit, wanted, &factor) != SCREE_UNIT_FITS)
    return scree_fail(error, SCREE_BAD_FILE, "%s: the unit '%s' of column %d is none of %s", path,
                      unit, column + 1, wanted);
  for (size_t i = 0; i < c->count; i++) values[i] *= factor;
  return SCREE_OK;
}
