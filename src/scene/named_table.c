#include "scene/named_table.h"

#include "base/number.h"
#include "base/unit.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

scree_status scree_named_fail(const scree_named_table *t, scree_error *error, const char *format,
                              ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return scree_fail(error, SCREE_BAD_FILE, "%s: line %zu: %s", t->name, t->line, text);
}

/* The next line that says something; NULL at the end. */
static char *next_line(scree_named_table *t) {
  for (char *line; (line = t->rest) != NULL;) {
    t->rest = strchr(line, '\n');
    if (t->rest) *t->rest++ = 0;
    t->line++;
    if (*line != '#' && line[strspn(line, " \t\r")]) return line;
  }
  return NULL;
}

/* The next field of a line, without blanks around it; false at the line's end. */
static bool next_field(char **at, char **field) {
  if (!*at) return false;
  char *comma = strchr(*at, ','), *end = comma ? comma : *at + strlen(*at);
  char *begin = *at + strspn(*at, " \t");
  while (end > begin && strchr(" \t\r", end[-1])) end--;
  *end = 0;
  *field = begin;
  *at = comma ? comma + 1 : NULL;
  return true;
}

static scree_status read_name(scree_named_table *t, char *field, scree_error *error) {
  char *unit = strchr(field, '['), all[200] = "";
  int which = 0;
  if (unit) {
    *unit++ = 0;
    unit[strcspn(unit, "]")] = 0;
    size_t length = strlen(field);
    while (length && field[length - 1] == ' ') field[--length] = 0;
  }
  while (which < t->known_count && strcmp(t->known[which].name, field) != 0) which++;
  for (int k = 0; k < t->known_count; k++)
    snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", k ? ", " : "", t->known[k].name);
  if (which == t->known_count)
    return scree_named_fail(t, error, "no column '%.40s'; there are %s", field, all);
  if (t->there[which]) return scree_named_fail(t, error, "the column %s stands here twice", field);
  const char *own = t->known[which].unit;
  double factor = 1;
  if (unit && own && scree_unit_convert(unit, own, &factor) != SCREE_UNIT_FITS)
    return scree_named_fail(t, error, "the column %s is in %s, not '%.20s'", field, own, unit);
  t->there[which] = true;
  t->factors[t->column_count] = factor;
  t->columns[t->column_count++] = which;
  return SCREE_OK;
}

scree_status scree_named_open(scree_named_table *table, const char *name, char *text,
                              const scree_named_column *known, int known_count,
                              scree_error *error) {
  *table =
      (scree_named_table){.name = name, .rest = text, .known = known, .known_count = known_count};
  char *line = next_line(table);
  if (!line) return scree_named_fail(table, error, "no line of names");
  for (char *field; next_field(&line, &field);) SCREE_TRY(read_name(table, field, error));
  return SCREE_OK;
}

scree_status scree_named_row(scree_named_table *t, double *values, const char **words, bool *there,
                             scree_error *error) {
  char *line = next_line(t);
  int count = 0;
  *there = line != NULL;
  for (char *field; next_field(&line, &field); count++) {
    if (count == t->column_count) return scree_named_fail(t, error, "more fields than names");
    const int which = t->columns[count];
    if (!t->known[which].unit) {
      words[which] = field;
      continue;
    }
    if (!scree_number_read(field, &values[which]))
      return scree_named_fail(t, error, "%s: '%.40s' is no number", t->known[which].name, field);
    values[which] *= t->factors[count];
  }
  if (*there && count < t->column_count)
    return scree_named_fail(t, error, "fewer fields than names");
  return SCREE_OK;
}
