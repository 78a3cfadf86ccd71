#include "scene/named_table.h"

#include "base/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static scree_status read_name(scree_named_table *t, char *field) {
  const char *unit = scree_cell_unit(field);
  char all[200] = "";
  int which = 0;
  while (which < t->known_count && strcmp(t->known[which].name, field) != 0) which++;
  for (int k = 0; k < t->known_count; k++)
    snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", k ? ", " : "", t->known[k].name);
  if (which == t->known_count && scree_cell_is_index(field)) which = -1;
  if (which == t->known_count)
    return scree_rows_fail(&t->rows, "no column '%.40s'; there are %s", field, all);
  if (which >= 0 && t->there[which])
    return scree_rows_fail(&t->rows, "the column %s stands here twice", field);
  const char *own = which >= 0 ? t->known[which].unit : NULL;
  double factor = 1;
  if (*unit && own && scree_unit_convert(unit, own, &factor) != SCREE_UNIT_FITS)
    return scree_rows_fail(&t->rows, "the column %s is in %s, not '%.20s'", field, own, unit);
  if (which >= 0) t->there[which] = true;
  t->factors[t->column_count] = factor;
  t->columns[t->column_count++] = which;
  return SCREE_OK;
}

static const double MOST = 1e9; /* as of fields of a scene */

scree_status scree_named_open(scree_named_table *table, const char *name, char *text, size_t size,
                              const scree_named_column *known, int known_count,
                              scree_error *error) {
  bool there;
  *table = (scree_named_table){.known = known, .known_count = known_count};
  SCREE_TRY(scree_rows_open(&table->rows, name, text, size, error));
  SCREE_TRY(scree_rows_next_row(&table->rows, &there));
  if (!there) return scree_rows_fail(&table->rows, "no line of names");
  for (size_t i = 0; i < table->rows.count; i++) SCREE_TRY(read_name(table, table->rows.cells[i]));
  return SCREE_OK;
}

scree_status scree_named_row(scree_named_table *t, double *values, const char **words,
                             bool *there) {
  SCREE_TRY(scree_rows_next_row(&t->rows, there));
  if (!*there) return SCREE_OK;
  if (t->rows.count != t->column_count)
    return scree_rows_fail(&t->rows, "%s fields than names",
                           t->rows.count > t->column_count ? "more" : "fewer");
  for (size_t i = 0; i < t->column_count; i++) {
    const int which = t->columns[i];
    if (which < 0) continue;
    if (!t->known[which].unit) {
      words[which] = t->rows.cells[i];
      continue;
    }
    SCREE_TRY(scree_rows_number(&t->rows, i, t->known[which].name, &values[which]));
    values[which] *= t->factors[i];
    if (!(fabs(values[which]) <= MOST))
      return scree_rows_fail(&t->rows, "%s is %g %s: 1e9 at most", t->known[which].name,
                             values[which], t->known[which].unit);
  }
  return SCREE_OK;
}
