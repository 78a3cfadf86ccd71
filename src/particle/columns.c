#include "particle/columns.h"

#include <string.h>

/* The strongest separator that the line has. */
static char separator_of(const char *begin, const char *end) {
  static const char order[] = ";,\t";
  for (const char *s = order; *s; s++)
    if (memchr(begin, *s, (size_t)(end - begin))) return *s;
  return 0;
}

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

static scree_token trim(const char *begin, const char *end) {
  while (begin < end && (is_blank(*begin) || *begin == '"' || *begin == '\'')) begin++;
  while (begin < end && (is_blank(end[-1]) || end[-1] == '"' || end[-1] == '\'')) end--;
  return (scree_token){begin, (size_t)(end - begin)};
}

size_t scree_columns_split(const char *begin, const char *end, char separator,
                           scree_token cells[SCREE_MOST_COLUMNS]) {
  size_t count = 0;
  if (separator) {
    scree_token cell = {begin, 0};
    for (const char *p = begin; p <= end; p++) {
      if (p < end && *p != separator) continue;
      cell = trim(begin, p);
      if (count < SCREE_MOST_COLUMNS) cells[count] = cell;
      count++;
      begin = p + 1;
    }
    return count > 1 && cell.length == 0 ? count - 1 : count; /* a last separator */
  }
  while (begin < end) {
    const char *p = begin;
    while (p < end && !is_blank(*p) && *p != ',' && *p != ';') p++;
    if (p > begin) {
      if (count < SCREE_MOST_COLUMNS) cells[count] = trim(begin, p);
      count++;
    }
    begin = p + (p < end);
  }
  return count;
}

typedef enum role { ROLE_X, ROLE_Y, ROLE_Z, ROLE_RADIUS, ROLE_DIAMETER, ROLE_NONE } role;

/* Letters of the name in lower case and its digits, without what stands in brackets. */
static void simplify(scree_token cell, char name[24]) {
  size_t n = 0;
  for (size_t i = 0; i < cell.length && n < 23; i++) {
    char c = cell.begin[i];
    if (c == '(' || c == '[') break;
    if (c >= 'A' && c <= 'Z') c = (char)(c - 'A' + 'a');
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) name[n++] = c;
  }
  name[n] = 0;
}

static role role_of(const char *name) {
  static const struct {
    const char *name;
    role role;
  } names[] = {{"r", ROLE_RADIUS},      {"rad", ROLE_RADIUS},       {"radius", ROLE_RADIUS},
               {"radii", ROLE_RADIUS},  {"d", ROLE_DIAMETER},       {"dia", ROLE_DIAMETER},
               {"diam", ROLE_DIAMETER}, {"diameter", ROLE_DIAMETER}};
  static const char *const before[] = {"",       "c",      "p",     "pos",    "position",
                                       "centre", "center", "coord", "sphere", "pebble"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    size_t length = strlen(name), tail = strlen(names[i].name);
    if (!strcmp(name, names[i].name) ||
        (tail > 2 && length > tail && !strcmp(name + length - tail, names[i].name)))
      return names[i].role;
  }
  for (size_t i = 0; i < sizeof before / sizeof *before; i++) {
    size_t length = strlen(before[i]);
    if (strlen(name) >= length + 1 && !strncmp(name, before[i], length) && name[length] >= 'x' &&
        name[length] <= 'z' && (!name[length + 1] || !strcmp(name + length + 1, "coordinate")))
      return (role)(name[length] - 'x');
    if (strlen(name) == length + 1 && name[0] >= 'x' && name[0] <= 'z' &&
        !strcmp(name + 1, before[i]))
      return (role)(name[0] - 'x');
  }
  return ROLE_NONE;
}

/* Of "x (mm)" or "x [mm]", metres; 0: none, or one that is not known. */
static double unit_of(scree_token cell) {
  static const struct {
    const char *name;
    double unit_m;
  } units[] = {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}};
  const char *end = cell.begin + cell.length, *open = cell.begin;
  while (open < end && *open != '(' && *open != '[') open++;
  if (open == end) return 0;
  scree_token name = {open + 1, 0};
  while (name.begin + name.length < end && !strchr(")]", name.begin[name.length])) name.length++;
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (scree_token_is(name, units[i].name)) return units[i].unit_m;
  return 0;
}

bool scree_columns_name(const char *begin, const char *end, scree_columns *columns,
                        char reason[160]) {
  static const char *const words[] = {"x", "y", "z", "radius", "diameter"};
  scree_token cells[SCREE_MOST_COLUMNS];
  size_t found[5], known = 0;
  for (int i = 0; i < 5; i++) found[i] = SIZE_MAX;
  *columns = (scree_columns){.separator = separator_of(begin, end)};
  columns->count = scree_columns_split(begin, end, columns->separator, cells);
  reason[0] = 0;
  for (size_t i = 0; i < columns->count && i < SCREE_MOST_COLUMNS; i++) {
    char name[24];
    simplify(cells[i], name);
    role r = role_of(name);
    if (r == ROLE_NONE) continue;
    if (found[r] != SIZE_MAX) {
      snprintf(reason, 160, "columns %zu and %zu both say %s", found[r] + 1, i + 1, words[r]);
      return false;
    }
    found[r] = i;
    known++;
    if (unit_of(cells[i]) > 0) columns->unit_m = unit_of(cells[i]);
  }
  if (known == 0) return false;
  role size = found[ROLE_RADIUS] != SIZE_MAX ? ROLE_RADIUS : ROLE_DIAMETER;
  columns->share = size == ROLE_RADIUS ? 1 : 0.5;
  for (int i = 0; i < 4; i++) {
    columns->at[i] = found[i == 3 ? size : (role)i];
    if (columns->at[i] != SIZE_MAX) continue;
    snprintf(reason, 160,
             "no column is named %s; a table of spheres needs x, y, z and radius or "
             "diameter",
             i == 3 ? "radius or diameter" : words[i]);
    return false;
  }
  return true;
}
