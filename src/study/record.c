/* One table of fields serves writing and reading. Numbers that do not exist are null. */
#include "study/record.h"

#include "base/file.h"
#include "base/number.h"
#include "base/quote.h"
#include "base/yaml.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(key, member, is_told) SCREE_FIELD_AS(scree_study_record, #key, member),
#define TOLD(key, member, is_told)  is_told,
const scree_field scree_record_fields[SCREE_RECORD_FIELDS] = {SCREE_RUN_ROWS(FIELD)};
const bool scree_record_is_told[SCREE_RECORD_FIELDS] = {SCREE_RUN_ROWS(TOLD)};

#define COLUMN(key, of_scene) SCREE_FIELD_OF(scree_record_point, key),
#define SOURCE(key, of_scene) of_scene,
const scree_field scree_record_columns[SCREE_RECORD_COLUMNS] = {SCREE_SERIES_ROWS(COLUMN)};
const char *const scree_record_of_scene[SCREE_RECORD_COLUMNS] = {SCREE_SERIES_ROWS(SOURCE)};

void scree_study_record_free(scree_study_record *record) {
  scree_free(record->series);
  scree_free(record->answers);
  record->answers = NULL;
  record->series = NULL;
  record->answer_count = record->series_count = 0;
}

scree_record_result scree_no_result(void) {
  return (scree_record_result){.pile = scree_no_pile()};
}

/* ---- writing ---- */

static void write_real(FILE *stream, double value) {
  char text[SCREE_NUMBER_SIZE];
  if (!isfinite(value)) {
    fputs("null", stream);
    return;
  }
  scree_number_format(value, text);
  fputs(text, stream);
}

static void write_field(FILE *stream, const scree_field *f, const scree_study_record *record) {
  const void *value = scree_field_at(f, record);
  fprintf(stream, "\"%s\": ", f->key);
  if (f->kind == SCREE_FIELD_REAL)
    write_real(stream, *(const double *)value);
  else if (f->kind == SCREE_FIELD_FLAG)
    fputs(*(const bool *)value ? "true" : "false", stream);
  else if (f->kind == SCREE_FIELD_CHARS)
    scree_quote(stream, SCREE_QUOTE_JSON, value);
  else if (scree_field_whole(f, record) == SCREE_UNKNOWN_COUNT)
    fputs("null", stream);
  else
    fprintf(stream, "%llu", (unsigned long long)scree_field_whole(f, record));
}

static void write_series(FILE *stream, const scree_study_record *record) {
  fputs(" \"phase\": [", stream);
  for (size_t i = 0; i < record->series_count; i++)
    fprintf(stream, "%s%zu", i ? ", " : "", record->series[i].phase);
  fputs("],\n \"bodies\": [", stream);
  for (size_t i = 0; i < record->series_count; i++)
    fprintf(stream, "%s%zu", i ? ", " : "", record->series[i].body_count);
  fputs("]", stream);
  for (size_t c = 0; c < SCREE_RECORD_COLUMNS; c++) {
    fprintf(stream, ",\n \"series_%s\": [", scree_record_columns[c].key);
    for (size_t i = 0; i < record->series_count; i++) {
      if (i) fputs(", ", stream);
      write_real(stream, *scree_record_number(&record->series[i], c));
    }
    fputs("]", stream);
  }
}

scree_status scree_study_record_write(const scree_study_record *record, const char *path,
                                      scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, true, &output, error));
  fputs("{", output.stream);
  for (int i = 0; i < SCREE_RECORD_FIELDS; i++) {
    write_field(output.stream, &scree_record_fields[i], record);
    fputs(",\n ", output.stream);
  }
  fputs("\"answers\": [", output.stream);
  for (size_t i = 0; i < record->answer_count; i++) {
    if (i) fputs(", ", output.stream);
    write_real(output.stream, record->answers[i]);
  }
  fputs("],\n", output.stream);
  write_series(output.stream, record);
  fputs("}\n", output.stream);
  return scree_output_commit(&output, error);
}

/* ---- reading ---- */

static bool parse_real(const char *text, double *value) {
  if (!strcmp(text, "null")) {
    *value = NAN;
    return true;
  }
  return scree_number_read(text, value);
}

static bool parse_whole(const char *text, uint64_t *value) {
  char *end;
  *value = SCREE_UNKNOWN_COUNT;
  if (!strcmp(text, "null")) return true;
  *value = strtoull(text, &end, 10);
  return *text >= '0' && *text <= '9' && !*end;
}

static bool parse_field(const scree_field *f, const char *text, scree_study_record *record) {
  void *value = (char *)record + f->offset;
  if (f->kind == SCREE_FIELD_REAL) return parse_real(text, value);
  if (f->kind == SCREE_FIELD_FLAG) {
    *(bool *)value = !strcmp(text, "true");
    return *(bool *)value || !strcmp(text, "false");
  }
  if (f->kind != SCREE_FIELD_CHARS) return parse_whole(text, value);
  snprintf(value, f->size, "%s", text);
  return true;
}

/* What a record made by another version has no row of is not known. */
static void set_unknown(const scree_field *f, scree_study_record *record) {
  void *value = (char *)record + f->offset;
  if (f->kind == SCREE_FIELD_REAL) *(double *)value = NAN;
  if (f->kind == SCREE_FIELD_COUNT || f->kind == SCREE_FIELD_SEED)
    *(uint64_t *)value = SCREE_UNKNOWN_COUNT;
}

static scree_status read_fields(const char *path, const scree_yaml *root,
                                scree_study_record *record, scree_error *error) {
  for (int i = 0; i < SCREE_RECORD_FIELDS; i++) {
    const scree_field *f = &scree_record_fields[i];
    const scree_yaml *node = scree_yaml_find(root, f->key);
    if (i > 0 && !node) {
      set_unknown(f, record);
      continue;
    }
    if (!node || node->kind != SCREE_YAML_SCALAR || !parse_field(f, node->text, record))
      return scree_fail(error, SCREE_BAD_FILE, "%s: is no record of a run: no good '%s'", path,
                        f->key);
  }
  return SCREE_OK;
}

/* The list of this name with as many numbers as the others, or NULL. */
static const scree_yaml *find_list(const scree_yaml *root, const char *name, size_t count) {
  const scree_yaml *list = scree_yaml_find(root, name);
  if (!list || list->kind != SCREE_YAML_SEQUENCE || list->item_count != count) return NULL;
  for (size_t i = 0; i < count; i++)
    if (list->items[i].kind != SCREE_YAML_SCALAR) return NULL;
  return list;
}

static bool read_columns(const scree_yaml *root, scree_study_record *record) {
  size_t count = record->series_count;
  const scree_yaml *phase = find_list(root, "phase", count),
                   *bodies = find_list(root, "bodies", count);
  bool good = phase && bodies;
  for (size_t i = 0; good && i < count; i++) {
    uint64_t p, b;
    good = parse_whole(phase->items[i].text, &p) && parse_whole(bodies->items[i].text, &b);
    if (good) record->series[i].phase = (size_t)p;
    if (good) record->series[i].body_count = (size_t)b;
  }
  for (size_t c = 0; good && c < SCREE_RECORD_COLUMNS; c++) {
    char name[64];
    snprintf(name, sizeof name, "series_%s", scree_record_columns[c].key);
    const scree_yaml *list = find_list(root, name, count);
    good = list || !scree_yaml_find(root, name);
    for (size_t i = 0; good && i < count; i++)
      good = parse_real(list ? list->items[i].text : "null",
                        scree_record_number(&record->series[i], c));
  }
  return good;
}

/* Reads the answers of a record; one made before there were any has none. */
static scree_status read_answers(const char *path, const scree_yaml *root,
                                 scree_study_record *record, scree_error *error) {
  const scree_yaml *list = scree_yaml_find(root, "answers");
  if (!list || list->kind != SCREE_YAML_SEQUENCE) return SCREE_OK;
  record->answers = scree_alloc(list->item_count, sizeof *record->answers);
  if (!record->answers) return scree_fail_memory(error, list->item_count, path);
  for (size_t i = 0; i < list->item_count; i++)
    if (list->items[i].kind != SCREE_YAML_SCALAR ||
        !parse_real(list->items[i].text, &record->answers[i]))
      return scree_fail(error, SCREE_BAD_FILE, "%s: is no record of a run: its answers", path);
  record->answer_count = list->item_count;
  return SCREE_OK;
}

scree_status scree_study_record_read(const char *path, scree_study_record *record,
                                     scree_error *error) {
  enum { LARGEST_RECORD = 256 << 20 };
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  SCREE_CLEANUP(scree_yaml_free) scree_yaml root = {0};
  SCREE_CLEANUP(scree_study_record_free) scree_study_record made = {0};
  size_t byte_count;
  SCREE_TRY(scree_file_read(path, LARGEST_RECORD, &bytes, &byte_count, error));
  SCREE_TRY(scree_yaml_parse(bytes, byte_count, path, &root, error));
  if (root.kind != SCREE_YAML_MAPPING)
    return scree_fail(error, SCREE_BAD_FILE, "%s: is no record of a run", path);
  SCREE_TRY(read_fields(path, &root, &made, error));
  const scree_yaml *phase = scree_yaml_find(&root, "phase");
  if (phase) {
    made.series_count = phase->item_count;
    SCREE_TRY_ALLOC_ZERO(made.series, made.series_count, error);
  }
  if (!read_columns(&root, &made))
    return scree_fail(error, SCREE_BAD_FILE, "%s: is no record of a run: its series", path);
  SCREE_TRY(read_answers(path, &root, &made, error));
  *record = made;
  made = (scree_study_record){0};
  return SCREE_OK;
}
