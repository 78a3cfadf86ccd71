#include "report/csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void scree_shortest_double(double value, char *buffer) {
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(buffer, 32, "%.*g", digits, value);
    if (strtod(buffer, NULL) == value) return;
  }
}

void scree_csv_text(FILE *stream, const char *text) {
  if (!text[strcspn(text, ",\"\r\n")]) {
    fputs(text, stream);
    return;
  }
  putc('"', stream);
  for (; *text; text++) {
    if (*text == '"') putc('"', stream);
    putc(*text, stream);
  }
  putc('"', stream);
}

void scree_csv_number(FILE *stream, double value) {
  if (!isfinite(value)) return;
  char buffer[32];
  scree_shortest_double(value, buffer);
  fputs(buffer, stream);
}
