#include "base/curve_file.h"

#include "base/file.h"
#include "base/number.h"
#include "base/unit.h"

#include <math.h>
#include <string.h>

enum { LARGEST_FILE = 16 << 20 };

void scree_curve_file_free(scree_curve_file *c) {
  scree_free(c->x);
  scree_free(c->y);
  *c = (scree_curve_file){0};
}

/* The next number of a line, behind what parts them; NULL: there is none. */
static const char *next_number(const char *at, const char *end, double *value) {
  while (at < end && strchr(" \t,;", *at)) at++;
  return scree_number_parse(at, end, value);
}

/* What stands in brackets of either kind, one after the other. */
static void read_units(const char *line, const char *end, scree_curve_file *c) {
  for (int k = 0; k < 2; k++) {
    const char *open = line + strcspn(line, "[(\r\n");
    const char *shut = open + strcspn(open, "])\r\n");
    if (shut >= end) return;
    snprintf(c->units[k], sizeof c->units[k], "%.*s", (int)(shut - open) - 1, open + 1);
    line = shut + 1;
  }
}

static scree_status read_line(const char *line, const char *end, size_t number, bool *begun,
                              scree_curve_file *c, const char *path, scree_error *error) {
  if (line == end || *line == '#') return SCREE_OK;
  const char *at = next_number(line, end, &c->x[c->count]);
  if (at) at = next_number(at, end, &c->y[c->count]);
  if (!at && *begun)
    return scree_fail(error, SCREE_BAD_FILE, "%s, line %zu: needs two numbers", path, number);
  *begun = true;
  if (!at) {
    read_units(line, end, c);
    return SCREE_OK;
  }
  double more;
  if (next_number(at, end, &more))
    return scree_fail(error, SCREE_BAD_FILE, "%s, line %zu: has more than two numbers", path,
                      number);
  double x = c->x[c->count], y = c->y[c->count];
  if (!isfinite(x) || !isfinite(y))
    return scree_fail(error, SCREE_BAD_FILE, "%s, line %zu: a number that is not finite", path,
                      number);
  if (c->count > 0 && !(x > c->x[c->count - 1]))
    return scree_fail(error, SCREE_BAD_FILE, "%s, line %zu: %g does not come after %g", path,
                      number, x, c->x[c->count - 1]);
  c->count++;
  return SCREE_OK;
}

scree_status scree_curve_file_read(const char *path, scree_curve_file *columns,
                                   scree_error *error) {
  char *bytes;
  size_t size, number = 0;
  scree_curve_file c = {0};
  bool begun = false;
  scree_status status = scree_file_read(path, LARGEST_FILE, &bytes, &size, error);
  if (status != SCREE_OK) return status;
  c.x = scree_alloc(size / 2 + 1, sizeof *c.x);
  c.y = scree_alloc(size / 2 + 1, sizeof *c.y);
  if (!c.x || !c.y) status = scree_fail_memory(error, size, path);
  for (const char *line = bytes; status == SCREE_OK && *line;) {
    const char *end = line + strcspn(line, "\r\n");
    number++;
    status = read_line(line, end, number, &begun, &c, path, error);
    line = *end == '\r' && end[1] == '\n' ? end + 2 : *end ? end + 1 : end;
  }
  scree_free(bytes);
  if (status == SCREE_OK && c.count < 3)
    status =
        scree_fail(error, SCREE_BAD_FILE, "%s: a curve needs three points, not %zu", path, c.count);
  if (status == SCREE_OK)
    *columns = c;
  else
    scree_curve_file_free(&c);
  return status;
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
