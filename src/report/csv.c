#include "report/csv.h"

#include "base/number.h"

#include <math.h>

void scree_csv_number(FILE *stream, double value) {
  if (!isfinite(value)) return;
  char buffer[SCREE_NUMBER_SIZE];
  scree_number_format(value, buffer);
  fputs(buffer, stream);
}

void scree_csv_numbers(FILE *stream, const double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    putc(',', stream);
    scree_csv_number(stream, values[i]);
  }
}
