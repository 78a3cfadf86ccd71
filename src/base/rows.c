#include "base/rows.h"

#include "base/number.h"

#include <ctype.h>
#include <stdarg.h>
#include <string.h>
#include <strings.h>

scree_status scree_rows_fail(const scree_text_rows *rows, const char *format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return scree_fail(rows->error, SCREE_BAD_FILE, "%s: line %zu: %s", rows->name, rows->line, text);
}

scree_status scree_rows_open(scree_text_rows *rows, const char *name, char *text, size_t byte_count,
                             scree_error *error) {
  bool wide = byte_count >= 2 && (!memcmp(text, "\xff\xfe", 2) || !memcmp(text, "\xfe\xff", 2) ||
                                  !text[0] != !text[1]);
  const char *nul = memchr(text, 0, byte_count);
  if (wide) return scree_fail(error, SCREE_BAD_FILE, "%s: text in UTF-16; save it as UTF-8", name);
  if (nul)
    return scree_fail(error, SCREE_BAD_FILE, "%s: byte %zu is 0, which no text has", name,
                      (size_t)(nul - text));
  bool has_mark = byte_count >= 3 && !memcmp(text, "\xef\xbb\xbf", 3);
  *rows = (scree_text_rows){.name = name, .rest = text + (has_mark ? 3 : 0), .error = error};
  return SCREE_OK;
}

static bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

/* Whether each comma stands between two digits: decimal commas, where something else parts. */
static bool are_decimal(const char *line) {
  for (const char *comma = strchr(line, ','); comma; comma = strchr(comma + 1, ','))
    if (comma == line || !isdigit((unsigned char)comma[-1]) || !isdigit((unsigned char)comma[1]))
      return false;
  return true;
}

static char separator_of(const char *line) {
  char weaker = strchr(line, '\t') ? '\t' : ' ';
  if (strchr(line, ';')) return ';';
  if (!strchr(line, ',')) return weaker;
  return line[strcspn(line, " \t")] && are_decimal(line) ? weaker : ',';
}

/* A quoted cell, in place; what is behind it, or NULL: its quote is not closed. */
static char *unquote(char *cell) {
  char *in = cell + 1;
  for (;; *cell++ = *in++) {
    if (!*in) return NULL;
    if (*in == '"' && *++in != '"') break;
  }
  *cell = 0;
  return in;
}

/* Cuts a cell off, without the quotes and blanks around it: what is behind it, whose character goes
 * into *last; NULL: its quotes are wrong. */
static char *cut_cell(char **cell, char separator, char *last) {
  const char ends[3] = {separator, separator == ' ' ? '\t' : 0, 0};
  while (is_blank(**cell) && !strchr(ends, **cell)) (*cell)++;
  bool quoted = **cell == '"';
  char *behind = quoted ? unquote(*cell) : *cell + strcspn(*cell, ends);
  while (quoted && behind && is_blank(*behind) && !strchr(ends, *behind)) behind++;
  *last = behind ? *behind : 0;
  if (!behind || (quoted && !strchr(ends, *last))) return NULL;
  char *end = behind;
  while (!quoted && end > *cell && is_blank(end[-1])) end--;
  if (!quoted) *end = 0;
  return behind;
}

scree_status scree_rows_split(scree_text_rows *rows, char *line) {
  if (!rows->separator) rows->separator = separator_of(line);
  rows->count = 0;
  for (char last = rows->separator; last; line++) {
    if (rows->separator == ' ') line += strspn(line, " \t");
    if (!line[strspn(line, " ")] && rows->count) break; /* a last separator */
    char *cell = line;
    line = cut_cell(&cell, rows->separator, &last);
    if (!line) return scree_rows_fail(rows, "a quote is not closed, or something follows it");
    if (rows->count == SCREE_ROW_CELLS)
      return scree_rows_fail(rows, "more than %d columns", SCREE_ROW_CELLS);
    rows->cells[rows->count++] = cell;
  }
  return SCREE_OK;
}

/* Where a comment begins behind a row: at a # outside of quotes. */
static char *comment_behind(char *line) {
  char quote = 0;
  for (; *line; line++) {
    if (quote ? *line == quote : *line == '"') quote = quote ? 0 : *line;
    if (!quote && *line == '#') return line;
  }
  return line;
}

/* The mark of a line that is a comment; 0 characters: it is a row. */
static size_t comment_mark(const char *line) {
  return !strncmp(line, "//", 2) ? 2 : *line == '#' || *line == '%';
}

scree_status scree_rows_next(scree_text_rows *rows, bool *there) {
  for (*there = false; *rows->rest;) {
    char *line = rows->rest, *end = line + strcspn(line, "\r\n");
    rows->rest = end + (*end == '\r' && end[1] == '\n' ? 2 : *end ? 1 : 0);
    *end = 0;
    rows->line++;
    line += strspn(line, " ");
    if (!line[strspn(line, " \t,;")]) continue; /* rows that a spreadsheet leaves empty, too */
    *there = true;
    rows->comment = comment_mark(line) ? line + comment_mark(line) : NULL;
    if (rows->comment) return SCREE_OK;
    *comment_behind(line) = 0;
    return scree_rows_split(rows, line);
  }
  return SCREE_OK;
}

scree_status scree_rows_next_row(scree_text_rows *rows, bool *there) {
  do SCREE_TRY(scree_rows_next(rows, there));
  while (*there && rows->comment);
  return SCREE_OK;
}

bool scree_rows_has_number(const scree_text_rows *rows, size_t cell) {
  double value;
  const char *text = cell < rows->count ? rows->cells[cell] : "", *end = text + strlen(text);
  return *text && scree_number_parse(text, end, &value) == end;
}

scree_status scree_rows_number(const scree_text_rows *rows, size_t cell, const char *what,
                               double *value) {
  const char *text = rows->cells[cell], *end = text + strlen(text);
  const char *behind = scree_number_parse(text, end, value);
  if (behind && behind == end) return SCREE_OK;
  bool decimal = behind && *behind == ',' && isdigit((unsigned char)behind[1]);
  return scree_rows_fail(rows, "%s is '%.40s', %s", what, text,
                         decimal ? "with a decimal comma; write a point" : "which is no number");
}

const char *scree_cell_unit(char *cell) {
  char *open = cell + strcspn(cell, "[("), *unit = *open ? open + 1 : open;
  unit[strcspn(unit, "])")] = 0;
  *open = 0;
  while (open > cell && is_blank(open[-1])) *--open = 0;
  return unit;
}

bool scree_cell_is_index(const char *name) {
  return !*name || !strcasecmp(name, "index") || !strncasecmp(name, "unnamed: ", 9);
}
