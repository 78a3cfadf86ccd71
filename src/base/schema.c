#include "base/schema.h"
#include "base/quote.h"

#include "base/number.h"
#include "base/unit.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_NAME = 64, LONGEST_PATH = 256 };

/* ---- saying what is wrong ---- */

SCREE_PRINTF(5, 0)
static scree_status fail_text(const scree_reader *r, size_t line, size_t column, const char *path,
                              const char *format, va_list arguments) {
  char text[700], where[96];
  vsnprintf(text, sizeof text, format, arguments);
  if (!*r->file) return scree_fail(r->error, SCREE_BAD_ARGUMENT, "%s", text); /* of a program */
  if (line)
    snprintf(where, sizeof where, ", line %zu, column %zu", line, column);
  else
    snprintf(where, sizeof where, " as changed");
  return scree_fail(r->error, SCREE_BAD_FILE, "%.300s%s: %s%s%s", r->file, where, path,
                    *path ? ": " : "", text);
}

scree_status scree_fail_place(const scree_reader *reader, const scree_place *place,
                              const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  scree_status status = fail_text(reader, place->line, place->column,
                                  place->path ? place->path : "", format, arguments);
  va_end(arguments);
  return status;
}

static const char *path_of(const scree_reader *r, const char *key, char path[LONGEST_PATH]) {
  snprintf(path, LONGEST_PATH, "%s%s%s", r->path, *r->path && key ? "." : "", key ? key : "");
  return path;
}

/* Fails with a sentence about the value of a key. */
SCREE_PRINTF(3, 4)
static scree_status fail_at(const scree_reader *r, const scree_yaml *node, const char *format,
                            ...) {
  char path[LONGEST_PATH];
  va_list arguments;
  va_start(arguments, format);
  scree_status status =
      fail_text(r, node->line, node->column, path_of(r, node->key, path), format, arguments);
  va_end(arguments);
  return status;
}

static scree_status fail_memory(const scree_reader *r) {
  return scree_fail_memory(r->error, 0, r->file);
}

/* ---- names that are nearly right ---- */

/* Insertions, deletions, replacements and swaps of neighbours from a to b (Damerau 1964, as optimal
 * string alignment). */
static size_t edit_distance(const char *a, const char *b) {
  size_t m = strlen(a), n = strlen(b), row[3][LONGEST_NAME + 1];
  if (m > LONGEST_NAME || n > LONGEST_NAME) return SIZE_MAX;
  for (size_t j = 0; j <= n; j++) row[0][j] = j;
  for (size_t i = 1; i <= m; i++) {
    size_t *now = row[i % 3], *last = row[(i + 2) % 3], *before = row[(i + 1) % 3];
    now[0] = i;
    for (size_t j = 1; j <= n; j++) {
      size_t best = last[j - 1] + (a[i - 1] != b[j - 1]);
      if (last[j] + 1 < best) best = last[j] + 1;
      if (now[j - 1] + 1 < best) best = now[j - 1] + 1;
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
          before[j - 2] + 1 < best)
        best = before[j - 2] + 1;
      now[j] = best;
    }
  }
  return row[m % 3][n];
}

/* The one name that begins so; NULL where there are several. */
static const char *begun(const char *word, const char *const *names, size_t count) {
  const char *found = NULL;
  size_t length = strlen(word);
  for (size_t i = 0; i < count; i++) {
    if (length < 2 || strncmp(names[i], word, length) != 0) continue;
    if (found) return NULL;
    found = names[i];
  }
  return found;
}

const char *scree_nearest_name(const char *word, const char *const *names, size_t count) {
  char small[LONGEST_NAME + 1] = "";
  const char *nearest = begun(word, names, count);
  size_t least = strlen(word) / 3 + 2;
  if (nearest || strlen(word) > LONGEST_NAME) return nearest;
  for (size_t i = 0; word[i]; i++) small[i] = (char)tolower((unsigned char)word[i]);
  for (size_t i = 0; i < count; i++) {
    size_t distance = edit_distance(word, names[i]);
    if (distance > 1 && !strcmp(small, names[i])) distance = 1;
    if (distance >= least || distance >= strlen(names[i])) continue;
    least = distance;
    nearest = names[i];
  }
  return nearest;
}

void scree_name_hint(const char *name, const char *const *names, size_t count,
                     char hint[SCREE_NAME_HINT]) {
  const size_t size = SCREE_NAME_HINT;
  const char *nearest = scree_nearest_name(name, names, count);
  *hint = 0;
  if (nearest) {
    scree_add_text(hint, size, "; did you mean '%s'?", nearest);
    return;
  }
  scree_add_text(hint, size, "; there %s%s", count == 1 ? "is" : "are", count ? "" : " none");
  for (size_t i = 0; i < count; i++) {
    if (strlen(hint) + strlen(names[i]) + 40 > size) {
      scree_add_text(hint, size, " and %zu more", count - i);
      return;
    }
    scree_add_text(hint, size, "%s %s", i ? "," : "", names[i]);
  }
}

scree_status scree_fail_name(const scree_reader *reader, const scree_place *place, const char *what,
                             const char *name, const char *const *names, size_t count) {
  char hint[SCREE_NAME_HINT];
  scree_name_hint(name, names, count, hint);
  return scree_fail_place(reader, place, "no %s '%.64s'%s", what, name, hint);
}

static scree_status fail_unknown(const scree_reader *r, const scree_yaml *item,
                                 const scree_record *kind) {
  const char *names[64] = {NULL};
  char list[600] = "";
  size_t count = 0;
  for (size_t i = 0; i < kind->field_count && count < 64; i++) {
    names[count++] = kind->fields[i].key;
    SCREE_ADD_TEXT(list, "%s%s", *list ? ", " : "", kind->fields[i].key);
  }
  const char *nearest = scree_nearest_name(item->key, names, count);
  scree_place place = {NULL, r->path, item->key_line, item->key_column};
  if (nearest)
    return scree_fail_place(r, &place, "no field '%s' in %s; did you mean '%s'? There are %s",
                            item->key, kind->what, nearest, list);
  return scree_fail_place(r, &place, "no field '%s' in %s; there are %s", item->key, kind->what,
                          list);
}

/* ---- single values ---- */

/* The column of a unit as "s|m/s", or the whole of one that has none. */
static const char *unit_of(const scree_field *f, size_t column, char unit[32]) {
  const char *at = f->unit ? f->unit : "";
  for (; column > 0 && strchr(at, '|'); column--) at = strchr(at, '|') + 1;
  snprintf(unit, 32, "%.*s", (int)strcspn(at, "|"), at);
  return unit;
}

static bool has_decimal_comma(const char *text) {
  size_t digits = strspn(text, "+-0123456789");
  return digits > 0 && text[digits] == ',' && text[digits + 1] >= '0' && text[digits + 1] <= '9';
}

/* A number, behind which a unit may stand, as one in the field's. */
static scree_status read_number(const scree_reader *r, const scree_yaml *node, const char *unit,
                                double *value) {
  const char *text = node->text, *in = *unit ? " in " : "";
  const char *rest = scree_number_parse(text, text + strlen(text), value);
  if (!rest || !isfinite(*value))
    return fail_at(r, node, "'%.60s': must be a number%s%s", text, in, unit);
  if (has_decimal_comma(text))
    return fail_at(r, node, "'%.60s': has a decimal comma; write a point, as in 0.5", text);
  rest += strspn(rest, " ");
  scree_unit_answer answer = *rest ? scree_unit_convert(rest, unit, value) : SCREE_UNIT_FITS;
  if (answer == SCREE_UNIT_UNKNOWN)
    return fail_at(r, node, "'%.60s': must be a number%s%s; what is '%.60s'?", text, in, unit,
                   rest);
  if (answer == SCREE_UNIT_DIFFERS)
    return fail_at(r, node, "'%.60s': must be a number%s%s; '%.60s' measures something else", text,
                   in, unit, rest);
  return SCREE_OK;
}

static scree_status read_column(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                                size_t column, double *value) {
  char unit[32];
  double number;
  unit_of(f, column, unit);
  if (node->kind != SCREE_YAML_SCALAR) return fail_at(r, node, "must be one number");
  SCREE_TRY(read_number(r, node, unit, &number));
  if ((f->minimum != 0 || f->maximum != 0) && !(number >= f->minimum && number <= f->maximum))
    return fail_at(r, node, "%g: must be %g to %g%s%s", number, f->minimum, f->maximum,
                   *unit ? " " : "", unit);
  *value = number;
  return SCREE_OK;
}

static scree_status read_real(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                              double *value) {
  return read_column(r, node, f, 0, value);
}

static scree_status read_whole(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                               uint64_t *value) {
  char *end = NULL;
  if (node->kind != SCREE_YAML_SCALAR || *node->text < '0' || *node->text > '9')
    return fail_at(r, node, "%s%.60s%s: must be a whole number", node->text ? "'" : "",
                   node->text ? node->text : "a group", node->text ? "'" : "");
  errno = 0;
  unsigned long long whole = strtoull(node->text, &end, 10);
  double real;
  if (errno) return fail_at(r, node, "'%.60s': is too large", node->text);
  if (*end && scree_number_read(node->text, &real) && real == floor(real) && real < 1e18)
    whole = (unsigned long long)real, end = NULL; /* 1e4 */
  if (end && *end) return fail_at(r, node, "'%.60s': must be a whole number", node->text);
  if (f->maximum > 0 && !((double)whole >= f->minimum && (double)whole <= f->maximum))
    return fail_at(r, node, "%llu: must be %.0f to %.0f", whole, f->minimum, f->maximum);
  *value = whole;
  return SCREE_OK;
}

static scree_status read_flag(const scree_reader *r, const scree_yaml *node, bool *value) {
  const char *text = node->kind == SCREE_YAML_SCALAR ? node->text : "";
  *value = !strcmp(text, "true") || !strcmp(text, "True") || !strcmp(text, "TRUE");
  if (!*value && strcmp(text, "false") != 0 && strcmp(text, "False") != 0 &&
      strcmp(text, "FALSE") != 0)
    return fail_at(r, node, "must be true or false");
  return SCREE_OK;
}

static scree_status read_word(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                              int *value) {
  const char *text = node->kind == SCREE_YAML_SCALAR ? node->text : "";
  int index = 0;
  for (const char *word = f->unit;; index++) {
    size_t length = strcspn(word, "|");
    if (strlen(text) == length && !strncmp(text, word, length)) {
      *value = index;
      return SCREE_OK;
    }
    if (!word[length]) return fail_at(r, node, "'%.60s': must be one of %s", text, f->unit);
    word += length + 1;
  }
}

static const char *keep_text(const scree_reader *r, const char *text) {
  size_t size = strlen(text) + 1;
  char *copy = scree_arena_take(r->arena, size, 1);
  return copy ? memcpy(copy, text, size) : NULL;
}

static scree_status read_text(const scree_reader *r, const scree_yaml *node, const char **value) {
  if (node->kind != SCREE_YAML_SCALAR || !*node->text) return fail_at(r, node, "must be a text");
  *value = keep_text(r, node->text);
  return *value ? SCREE_OK : fail_memory(r);
}

static scree_status read_texts(const scree_reader *r, const scree_yaml *node, scree_texts *value) {
  bool one = node->kind == SCREE_YAML_SCALAR;
  if (node->kind == SCREE_YAML_MAPPING || (!one && node->item_count == 0))
    return fail_at(r, node, "must be a text or a list of texts");
  value->count = one ? 1 : node->item_count;
  value->items = scree_arena_take(r->arena, value->count, sizeof *value->items);
  if (!value->items) return fail_memory(r);
  for (size_t i = 0; i < value->count; i++) {
    SCREE_TRY(read_text(r, one ? node : &node->items[i], &value->items[i]));
  }
  return SCREE_OK;
}

static scree_status read_reals(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                               size_t count, double *values) {
  double read[4];
  if (node->kind != SCREE_YAML_SEQUENCE || node->item_count != count)
    return fail_at(r, node, "must be %zu numbers%s%s, as in %s%s", count, *f->unit ? " in " : "",
                   f->unit, count == 3 ? "[0, 0, 1]" : "[1, 0, 0, 0]",
                   node->item_count > count ? "; decimals stand behind a point, not a comma" : "");
  for (size_t i = 0; i < count; i++) {
    scree_yaml item = node->items[i];
    item.key = node->key;
    SCREE_TRY(read_real(r, &item, f, &read[i]));
  }
  memcpy(values, read, count * sizeof *values);
  return SCREE_OK;
}

static scree_status read_direction(const scree_reader *r, const scree_yaml *node,
                                   const scree_field *f, double *value) {
  SCREE_TRY(read_reals(r, node, f, 3, value));
  if (value[0] != 0 || value[1] != 0 || value[2] != 0) return SCREE_OK;
  return fail_at(r, node, "[0, 0, 0] points nowhere");
}

static scree_status read_table(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                               scree_table *value) {
  if (node->kind != SCREE_YAML_SEQUENCE || node->item_count < 1)
    return fail_at(r, node, "must be a list of %s, as in [[0, 0], [1, 2]]", f->comment);
  value->items = scree_arena_take(r->arena, node->item_count, sizeof *value->items);
  if (!value->items) return fail_memory(r);
  value->count = node->item_count;
  for (size_t i = 0; i < value->count; i++) {
    scree_yaml row = node->items[i];
    row.key = node->key;
    if (row.kind != SCREE_YAML_SEQUENCE || row.item_count != 2)
      return fail_at(r, &row, "row %zu must be two numbers: %s", i + 1, f->comment);
    for (size_t k = 0; k < 2; k++) {
      scree_yaml item = row.items[k];
      item.key = node->key;
      SCREE_TRY(read_column(r, &item, f, k, &value->items[i][k]));
    }
    if (i && !(value->items[i][0] > value->items[i - 1][0]))
      return fail_at(r, &row, "the first number of rows must rise: %g after %g", value->items[i][0],
                     value->items[i - 1][0]);
  }
  return SCREE_OK;
}

static scree_status read_weights(const scree_reader *r, const scree_yaml *node,
                                 const scree_field *f, scree_weights *value) {
  bool one = node->kind == SCREE_YAML_SCALAR, weighted = node->kind == SCREE_YAML_MAPPING;
  size_t count = one ? 1 : node->item_count;
  if (count == 0) return fail_at(r, node, "must name at least one");
  value->names = scree_arena_take(r->arena, count, sizeof *value->names);
  value->values = scree_arena_take(r->arena, count, sizeof *value->values);
  if (!value->names || !value->values) return fail_memory(r);
  value->count = count;
  char path[LONGEST_PATH];
  scree_reader inner = *r;
  inner.path = path_of(r, node->key, path);
  for (size_t i = 0; i < count; i++) {
    scree_yaml item = one ? *node : node->items[i];
    scree_status status = SCREE_OK;
    value->values[i] = 1;
    if (weighted) {
      value->names[i] = keep_text(r, item.key);
      status = read_real(&inner, &item, f, &value->values[i]);
      if (status == SCREE_OK && !(value->values[i] > 0))
        status = fail_at(&inner, &item, "%g: a share must be above 0", value->values[i]);
      if (!value->names[i]) return fail_memory(r);
    } else {
      item.key = node->key;
      status = read_text(r, &item, &value->names[i]);
    }
    if (status != SCREE_OK) return status;
    for (size_t k = 0; k < i; k++)
      if (!strcmp(value->names[i], value->names[k]))
        return fail_at(r, &item, "'%.60s' stands here twice", value->names[i]);
  }
  return SCREE_OK;
}

static scree_status read_values(const scree_reader *r, const scree_yaml *node,
                                scree_values *value) {
  if (node->kind != SCREE_YAML_MAPPING) return fail_at(r, node, "must be {name: value, ...}");
  value->names = scree_arena_take(r->arena, node->item_count, sizeof *value->names);
  value->texts = scree_arena_take(r->arena, node->item_count, sizeof *value->texts);
  if (!value->names || !value->texts) return fail_memory(r);
  value->count = node->item_count;
  for (size_t i = 0; i < value->count; i++) {
    value->names[i] = keep_text(r, node->items[i].key);
    if (!value->names[i]) return fail_memory(r);
    SCREE_TRY(read_text(r, &node->items[i], &value->texts[i]));
  }
  return SCREE_OK;
}

/* ---- records ---- */

/* One record below the reader's, at `path`. */
static scree_status read_inner(const scree_reader *r, const scree_yaml *node, const char *path,
                               const scree_record *kind, void *record) {
  scree_reader inner = *r;
  inner.path = keep_text(r, path);
  if (!inner.path) return fail_memory(r);
  scree_place place = {NULL, inner.path, node->line, node->column};
  if (node->kind != SCREE_YAML_MAPPING)
    return scree_fail_place(r, &place, "must be a group, as in {%s: ...}", kind->fields[0].key);
  return scree_record_read(&inner, node, kind, record);
}

static scree_status read_records(const scree_reader *r, const scree_yaml *node,
                                 const scree_field *f, void *value) {
  bool named = f->kind == SCREE_FIELD_NAMED;
  if (node->kind != (named ? SCREE_YAML_MAPPING : SCREE_YAML_SEQUENCE))
    return fail_at(r, node,
                   named ? "must be a group of names, as in {name: {...}}"
                         : "must be a list of groups, as in [{...}]");
  char *items = scree_arena_take(r->arena, node->item_count, f->record->size);
  if (!items) return fail_memory(r);
  for (size_t i = 0; i < node->item_count; i++) {
    char path[LONGEST_PATH], key[LONGEST_NAME + 32];
    void *record = items + i * f->record->size;
    if (named && (strlen(node->items[i].key) > LONGEST_NAME || strchr(node->items[i].key, '.') ||
                  !*node->items[i].key))
      return fail_at(r, &node->items[i], "a name has 1 to %d characters and no point",
                     LONGEST_NAME);
    if (named)
      snprintf(key, sizeof key, "%s.%s", node->key, node->items[i].key);
    else
      snprintf(key, sizeof key, "%s.%zu", node->key, i);
    SCREE_TRY(read_inner(r, &node->items[i], path_of(r, key, path), f->record, record));
    scree_place *place = record;
    place->name = named ? keep_text(r, node->items[i].key) : NULL;
    if (named && !place->name) return fail_memory(r);
  }
  const scree_records made = {items, node->item_count};
  memcpy(value, &made, sizeof made);
  return SCREE_OK;
}

static scree_status read_one(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                             void **value) {
  char path[LONGEST_PATH];
  void *record = scree_arena_take(r->arena, 1, f->record->size);
  if (!record) return fail_memory(r);
  *value = record;
  return read_inner(r, node, path_of(r, node->key, path), f->record, record);
}

scree_status scree_field_read(const scree_reader *r, const scree_yaml *node, const scree_field *f,
                              void *record) {
  void *value = (char *)record + f->offset;
  uint64_t whole = 0;
  scree_status status;
  switch (f->kind) {
  case SCREE_FIELD_REAL:
    return read_real(r, node, f, value);
  case SCREE_FIELD_SEED:
    return read_whole(r, node, f, value);
  case SCREE_FIELD_COUNT:
    status = read_whole(r, node, f, &whole);
    if (status == SCREE_OK) *(size_t *)value = (size_t)whole;
    return status;
  case SCREE_FIELD_FLAG:
    return read_flag(r, node, value);
  case SCREE_FIELD_WORD:
    return read_word(r, node, f, value);
  case SCREE_FIELD_TEXT:
    return read_text(r, node, value);
  case SCREE_FIELD_TEXTS:
    return read_texts(r, node, value);
  case SCREE_FIELD_VECTOR:
    return read_reals(r, node, f, 3, value);
  case SCREE_FIELD_DIRECTION:
    return read_direction(r, node, f, value);
  case SCREE_FIELD_TURN:
    return read_reals(r, node, f, 4, value);
  case SCREE_FIELD_TABLE:
    return read_table(r, node, f, value);
  case SCREE_FIELD_WEIGHTS:
    return read_weights(r, node, f, value);
  case SCREE_FIELD_RECORD:
    return read_one(r, node, f, value);
  case SCREE_FIELD_NAMED:
  case SCREE_FIELD_LIST:
    return read_records(r, node, f, value);
  case SCREE_FIELD_VALUES:
    return read_values(r, node, value);
  case SCREE_FIELD_NODE:
    *(const scree_yaml **)value = node;
    return SCREE_OK;
  default:
    return SCREE_OK;
  }
}

/* `{sphere: 0,01}` has a key 01. */
static scree_status check_commas(const scree_reader *r, const scree_yaml *node) {
  for (size_t i = 1; i < node->item_count; i++) {
    const scree_yaml *item = &node->items[i], *before = item - 1;
    const char *text = before->kind == SCREE_YAML_SCALAR ? before->text : "";
    if (!*text || text[strspn(text, "+-0123456789")] || !isdigit((unsigned char)*item->key))
      continue;
    scree_place place = {NULL, r->path, before->line, before->column};
    return scree_fail_place(r, &place, "%s: %s,%s: has a decimal comma; write %s.%s", before->key,
                            text, item->key, text, item->key);
  }
  return SCREE_OK;
}

static bool is_of_word(char c) {
  return isalpha((unsigned char)c) || c == '_';
}

/* Whether a word of the sentence is the key. */
static bool has_word(const char *sentence, const char *key) {
  size_t length = strlen(key);
  for (const char *at = sentence; (at = strstr(at, key)); at += length)
    if ((at == sentence || !is_of_word(at[-1])) && !is_of_word(at[length])) return true;
  return false;
}

static scree_status check_needs(const scree_reader *r, const scree_record *kind,
                                const void *record) {
  for (size_t i = 0; kind->needs && i < kind->field_count; i++)
    if (!scree_field_is_given(&kind->fields[i], record) &&
        has_word(kind->needs, kind->fields[i].key))
      return scree_fail_place(r, record, "needs %s", kind->needs);
  return SCREE_OK;
}

scree_status scree_record_read(const scree_reader *reader, const scree_yaml *node,
                               const scree_record *kind, void *record) {
  memcpy(record, kind->defaults, kind->size);
  *(scree_place *)record = (scree_place){NULL, reader->path, node->line, node->column};
  SCREE_TRY(check_commas(reader, node));
  for (size_t i = 0; i < node->item_count; i++) {
    const scree_field *field = NULL;
    for (size_t k = 0; k < kind->field_count; k++)
      if (!strcmp(kind->fields[k].key, node->items[i].key)) field = &kind->fields[k];
    if (!field) return fail_unknown(reader, &node->items[i], kind);
    SCREE_TRY(scree_field_read(reader, &node->items[i], field, record));
  }
  SCREE_TRY(check_needs(reader, kind, record));
  return kind->check ? kind->check(reader, record) : SCREE_OK;
}

/* A list of records as one of any kind. */
static scree_records records_in(const void *list) {
  scree_records records;
  memcpy(&records, list, sizeof records);
  return records;
}

bool scree_field_is_given(const scree_field *field, const void *record) {
  const void *value = (const char *)record + field->offset;
  switch (field->kind) {
  case SCREE_FIELD_REAL:
  case SCREE_FIELD_VECTOR:
  case SCREE_FIELD_DIRECTION:
  case SCREE_FIELD_TURN:
    return !isnan(*(const double *)value);
  case SCREE_FIELD_COUNT:
    return *(const size_t *)value > 0;
  case SCREE_FIELD_WORD:
    return *(const int *)value >= 0;
  case SCREE_FIELD_VALUES:
    return ((const scree_values *)value)->count > 0;
  case SCREE_FIELD_TEXT:
  case SCREE_FIELD_RECORD:
  case SCREE_FIELD_NODE:
    return *(void *const *)value != NULL;
  case SCREE_FIELD_TEXTS:
    return ((const scree_texts *)value)->count > 0;
  case SCREE_FIELD_TABLE:
    return ((const scree_table *)value)->count > 0;
  case SCREE_FIELD_WEIGHTS:
    return ((const scree_weights *)value)->count > 0;
  case SCREE_FIELD_NAMED:
  case SCREE_FIELD_LIST:
    return records_in(value).count > 0;
  default:
    return true;
  }
}

/* ---- printing ---- */

/* A text that is a number, as a count of spheres in place of their table, is written as one. */
static void put_text(FILE *stream, const char *text) {
  double number;
  if (scree_number_read(text, &number))
    fputs(text, stream);
  else
    scree_quote(stream, SCREE_QUOTE_YAML, text);
}

/* With the fewest of 6 to 17 digits that read back as the same number. */
static void real_text(double value, char text[SCREE_NUMBER_SIZE]) {
  double back;
  for (int digits = 6; digits <= 17; digits++) {
    scree_number_format_digits(value, digits, text);
    if (scree_number_read(text, &back) && back == value) break;
  }
}

static void put_real(FILE *stream, double value) {
  char text[SCREE_NUMBER_SIZE];
  real_text(value, text);
  fputs(text, stream);
}

static void put_reals(FILE *stream, const double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    fputs(i ? ", " : "[", stream);
    put_real(stream, values[i]);
  }
  putc(']', stream);
}

static void put_weights(FILE *stream, const scree_weights *w) {
  putc('{', stream);
  for (size_t i = 0; i < w->count; i++) {
    if (i) fputs(", ", stream);
    put_text(stream, w->names[i]);
    fputs(": ", stream);
    put_real(stream, w->values[i]);
  }
  putc('}', stream);
}

static void put_table(FILE *stream, const scree_table *table) {
  putc('[', stream);
  for (size_t i = 0; i < table->count; i++) {
    if (i) fputs(", ", stream);
    put_reals(stream, table->items[i], 2);
  }
  putc(']', stream);
}

static void put_texts(FILE *stream, const scree_texts *texts) {
  putc('[', stream);
  for (size_t i = 0; i < texts->count; i++) {
    if (i) fputs(", ", stream);
    put_text(stream, texts->items[i]);
  }
  putc(']', stream);
}

static void put_values(FILE *stream, const scree_values *values) {
  putc('{', stream);
  for (size_t i = 0; i < values->count; i++) {
    if (i) fputs(", ", stream);
    put_text(stream, values->names[i]);
    fputs(": ", stream);
    put_text(stream, values->texts[i]);
  }
  putc('}', stream);
}

void scree_field_text(const scree_field *f, const void *record, char *text, size_t size) {
  const void *value = (const char *)record + f->offset;
  char real[SCREE_NUMBER_SIZE];
  const char *word = f->unit;
  switch (f->kind) {
  case SCREE_FIELD_COUNT:
    snprintf(text, size, "%zu", *(const size_t *)value);
    break;
  case SCREE_FIELD_SEED:
    snprintf(text, size, "%llu", (unsigned long long)*(const uint64_t *)value);
    break;
  case SCREE_FIELD_FLAG:
    snprintf(text, size, "%s", *(const bool *)value ? "true" : "false");
    break;
  case SCREE_FIELD_WORD:
    for (int i = *(const int *)value; i > 0; i--) word += strcspn(word, "|") + 1;
    snprintf(text, size, "%.*s", (int)strcspn(word, "|"), word);
    break;
  default:
    real_text(*(const double *)value, real);
    snprintf(text, size, "%s", real);
  }
}

static void put_value(FILE *stream, const scree_field *f, const void *record) {
  const void *value = (const char *)record + f->offset;
  char text[64];
  switch (f->kind) {
  case SCREE_FIELD_TEXT:
    put_text(stream, *(const char *const *)value);
    break;
  case SCREE_FIELD_TEXTS:
    put_texts(stream, value);
    break;
  case SCREE_FIELD_VECTOR:
  case SCREE_FIELD_DIRECTION:
    put_reals(stream, value, 3);
    break;
  case SCREE_FIELD_TURN:
    put_reals(stream, value, 4);
    break;
  case SCREE_FIELD_TABLE:
    put_table(stream, value);
    break;
  case SCREE_FIELD_WEIGHTS:
    put_weights(stream, value);
    break;
  case SCREE_FIELD_VALUES:
    put_values(stream, value);
    break;
  default:
    scree_field_text(f, record, text, sizeof text);
    fputs(text, stream);
  }
}

void scree_field_print_comment(const scree_field *f, FILE *stream) {
  bool one = f->kind != SCREE_FIELD_WORD && f->kind != SCREE_FIELD_TABLE;
  const char *unit = f->unit && one ? f->unit : "";
  if (f->kind == SCREE_FIELD_WORD)
    fprintf(stream, "  # %s; %s", f->unit, f->comment);
  else if (*unit)
    fprintf(stream, "  # %s%s%s", unit, *f->comment ? "; " : "", f->comment);
  else if (f->comment && *f->comment)
    fprintf(stream, "  # %s", f->comment);
}

static bool is_empty(const scree_record *kind, const void *record) {
  for (size_t i = 0; i < kind->field_count; i++)
    if (scree_field_is_given(&kind->fields[i], record)) return false;
  return true;
}

static void put_records(FILE *stream, const scree_field *f, const void *value, int depth,
                        bool comments) {
  const scree_records records = records_in(value);
  for (size_t i = 0; i < records.count; i++) {
    const void *record = (const char *)records.items + i * f->record->size;
    const scree_place *place = record;
    fprintf(stream, "%*s", 2 * depth, "");
    if (f->kind == SCREE_FIELD_NAMED) put_text(stream, place->name);
    fputs(f->kind == SCREE_FIELD_NAMED ? ":" : "-", stream);
    fputs(is_empty(f->record, record) ? " {}\n" : "\n", stream);
    scree_record_print(f->record, record, depth + 1, comments, stream);
  }
}

void scree_record_print(const scree_record *kind, const void *record, int depth, bool comments,
                        FILE *stream) {
  for (size_t i = 0; i < kind->field_count; i++) {
    const scree_field *f = &kind->fields[i];
    const void *value = (const char *)record + f->offset;
    bool records = f->kind == SCREE_FIELD_NAMED || f->kind == SCREE_FIELD_LIST;
    if (!scree_field_is_given(f, record)) continue;
    fprintf(stream, "%*s%s:", 2 * depth, "", f->key);
    if (f->kind == SCREE_FIELD_RECORD) {
      fputs(is_empty(f->record, *(void *const *)value) ? " {}" : "", stream);
    } else if (!records) {
      putc(' ', stream);
      put_value(stream, f, record);
    }
    if (comments) scree_field_print_comment(f, stream);
    putc('\n', stream);
    if (records) put_records(stream, f, value, depth + 1, comments);
    if (f->kind == SCREE_FIELD_RECORD)
      scree_record_print(f->record, *(void *const *)value, depth + 1, comments, stream);
  }
}
