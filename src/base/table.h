/* Values over a coordinate that rises from row to row: straight lines between rows, held before the
 * first and after the last. A row begins with the coordinate and the value and is `width` numbers
 * long. */
#pragma once

#include <stddef.h>

typedef struct scree_rows {
  const double *rows;
  size_t width, count; /* count: at least 1 */
} scree_rows;

/* The last row at or before x; the first where there is none. */
static inline const double *scree_rows_last(const scree_rows *t, double x) {
  size_t low = 0, high = t->count - 1;
  while (low < high) {
    size_t middle = (low + high + 1) / 2;
    if (t->rows[middle * t->width] <= x)
      low = middle;
    else
      high = middle - 1;
  }
  return t->rows + low * t->width;
}

static inline double scree_rows_at(const scree_rows *t, double x, double *slope) {
  const double *row = scree_rows_last(t, x), *next = row + t->width;
  *slope = 0;
  if (x <= row[0] || next == t->rows + t->count * t->width) return row[1];
  *slope = (next[1] - row[1]) / (next[0] - row[0]);
  return row[1] + *slope * (x - row[0]);
}
