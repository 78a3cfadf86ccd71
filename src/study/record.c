/* One table of fields serves writing and reading. Numbers that do not exist are null. */
#include "study/record.h"

#include "base/file.h"
#include "base/number.h"
#include "base/yaml.h"
#include "heap/repose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum kind { REAL, COUNT, WIDE, FLAG, TEXT } kind;
typedef struct field {
  const char *key;
  kind kind;
  size_t offset, size;
} field;

#define AT(key, kind, member)                                                                      \
  { key, kind, offsetof(scree_study_record, member), sizeof(((scree_study_record *)0)->member) }

static const field fields[] = {
    AT("failed", FLAG, failed),
    AT("reason", TEXT, reason),
    AT("worker", TEXT, worker),
    AT("machine", TEXT, machine),
    AT("version", TEXT, version),
    AT("started", REAL, started),
    AT("ended", REAL, ended),
    AT("triangle_count", REAL, triangle_count),
    AT("time_step", REAL, costs.time_step),
    AT("step_count", WIDE, costs.step_count),
    AT("particle_steps", WIDE, costs.particle_steps),
    AT("wall_seconds", REAL, costs.wall_seconds),
    AT("processor_seconds", REAL, costs.processor_seconds),
    AT("piece_count", COUNT, costs.piece_count),
    AT("largest_overlap", REAL, costs.largest_overlap),
    AT("heap", FLAG, result.repose.heap),
    AT("heap_reason", TEXT, result.repose.reason),
    AT("sector_deg", REAL, result.repose.sector_deg),
    AT("sector_sd_deg", REAL, result.repose.sector_sd_deg),
    AT("cone_deg", REAL, result.repose.cone_deg),
    AT("silhouette_deg", REAL, result.repose.silhouette_deg),
    AT("silhouette_sd_deg", REAL, result.repose.silhouette_sd_deg),
    AT("height", REAL, result.repose.height),
    AT("base_radius", REAL, result.repose.base_radius),
    AT("run_out", REAL, result.repose.run_out),
    AT("body_count", COUNT, result.body_count),
    AT("left_count", COUNT, result.left_count),
    AT("packing_fraction", REAL, result.packing_fraction),
    AT("coordination", REAL, result.coordination),
    AT("particle_size", REAL, result.particle_size),
    AT("kinetic", REAL, result.kinetic),
    AT("time", REAL, result.time),
    AT("still", FLAG, result.still),
    AT("hash", TEXT, hash),
    AT("answered", TEXT, answered),
};
enum { FIELD_COUNT = sizeof fields / sizeof *fields };

#undef AT
#define AT(member) offsetof(scree_record_point, member)
/* Columns of the series, a row each; phase and body count are whole. */
static const struct {
  const char *key;
  size_t offset;
} columns[] = {
    {"time", AT(time)},
    {"mean_rotation", AT(mean_rotation)},
    {"kinetic", AT(kinetic)},
    {"highest_speed", AT(highest_speed)},
    {"largest_overlap", AT(largest_overlap)},
    {"coordination", AT(coordination)},
    {"cylinder_height", AT(cylinder_height)},
    {"sector_deg", AT(sector_deg)},
    {"cone_deg", AT(cone_deg)},
    {"silhouette_deg", AT(silhouette_deg)},
    {"height", AT(height)},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

void scree_study_record_free(scree_study_record *record) {
  scree_free(record->series);
  scree_free(record->answers);
  record->answers = NULL;
  record->answer_count = 0;
  record->series = NULL;
  record->series_count = 0;
}

scree_record_result scree_no_result(void) {
  return (scree_record_result){
      .repose = scree_no_repose(), .packing_fraction = NAN, .particle_size = NAN};
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

static void write_text(FILE *stream, const char *text) {
  putc('"', stream);
  for (; *text; text++) {
    unsigned char c = (unsigned char)*text;
    if (c == '"' || c == '\\')
      fprintf(stream, "\\%c", c);
    else
      putc(c < 0x20 ? ' ' : c > 0x7e ? '?' : c, stream);
  }
  putc('"', stream);
}

static void write_field(FILE *stream, const field *f, const scree_study_record *record) {
  const void *value = (const char *)record + f->offset;
  switch (f->kind) {
  case REAL:
    write_real(stream, *(const double *)value);
    break;
  case COUNT:
    fprintf(stream, "%zu", *(const size_t *)value);
    break;
  case WIDE:
    fprintf(stream, "%llu", (unsigned long long)*(const uint64_t *)value);
    break;
  case FLAG:
    fputs(*(const bool *)value ? "true" : "false", stream);
    break;
  case TEXT:
    write_text(stream, value);
    break;
  }
}

static void write_series(FILE *stream, const scree_study_record *record) {
  fputs(" \"phase\": [", stream);
  for (size_t i = 0; i < record->series_count; i++)
    fprintf(stream, "%s%zu", i ? ", " : "", record->series[i].phase);
  fputs("],\n \"bodies\": [", stream);
  for (size_t i = 0; i < record->series_count; i++)
    fprintf(stream, "%s%zu", i ? ", " : "", record->series[i].body_count);
  fputs("]", stream);
  for (int c = 0; c < COLUMN_COUNT; c++) {
    fprintf(stream, ",\n \"series_%s\": [", columns[c].key);
    for (size_t i = 0; i < record->series_count; i++) {
      if (i) fputs(", ", stream);
      write_real(stream, *(const double *)((const char *)&record->series[i] + columns[c].offset));
    }
    fputs("]", stream);
  }
}

scree_status scree_study_record_write(const scree_study_record *record, const char *path,
                                      scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, true, &output, error));
  fputs("{", output.stream);
  for (int i = 0; i < FIELD_COUNT; i++) {
    fprintf(output.stream, "%s\"%s\": ", i ? " " : "", fields[i].key);
    write_field(output.stream, &fields[i], record);
    fputs(",\n", output.stream);
  }
  fputs(" \"answers\": [", output.stream);
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

static bool parse_whole(const char *text, unsigned long long *value) {
  char *end;
  *value = strtoull(text, &end, 10);
  return *text >= '0' && *text <= '9' && !*end;
}

static bool parse_field(const field *f, const char *text, scree_study_record *record) {
  void *value = (char *)record + f->offset;
  unsigned long long whole;
  switch (f->kind) {
  case REAL:
    return parse_real(text, value);
  case COUNT:
    if (!parse_whole(text, &whole)) return false;
    *(size_t *)value = (size_t)whole;
    return true;
  case WIDE:
    if (!parse_whole(text, &whole)) return false;
    *(uint64_t *)value = whole;
    return true;
  case FLAG:
    *(bool *)value = !strcmp(text, "true");
    return *(bool *)value || !strcmp(text, "false");
  case TEXT:
    snprintf(value, f->size, "%s", text);
    return true;
  }
  return false;
}

static scree_status read_fields(const char *path, const scree_yaml *root,
                                scree_study_record *record, scree_error *error) {
  for (int i = 0; i < FIELD_COUNT; i++) {
    const scree_yaml *node = scree_yaml_find(root, fields[i].key);
    if (!node || node->kind != SCREE_YAML_SCALAR || !parse_field(&fields[i], node->text, record))
      return scree_fail(error, SCREE_BAD_FILE, "%s: is no record of a run: no good '%s'", path,
                        fields[i].key);
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
    unsigned long long p, b;
    good = parse_whole(phase->items[i].text, &p) && parse_whole(bodies->items[i].text, &b);
    if (good) record->series[i].phase = (size_t)p;
    if (good) record->series[i].body_count = (size_t)b;
  }
  for (int c = 0; good && c < COLUMN_COUNT; c++) {
    char name[64];
    snprintf(name, sizeof name, "series_%s", columns[c].key);
    const scree_yaml *list = find_list(root, name, count);
    good = list != NULL;
    for (size_t i = 0; good && i < count; i++)
      good = parse_real(list->items[i].text,
                        (double *)(void *)((char *)&record->series[i] + columns[c].offset));
  }
  return good;
}

/* Of a record made before there were any, none. */
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
  char *bytes;
  size_t byte_count;
  scree_yaml root;
  scree_study_record made = {0};
  SCREE_TRY(scree_file_read(path, LARGEST_RECORD, &bytes, &byte_count, error));
  scree_status status = scree_yaml_parse(bytes, byte_count, path, &root, error);
  scree_free(bytes);
  if (status != SCREE_OK) return status;
  status = root.kind == SCREE_YAML_MAPPING
               ? read_fields(path, &root, &made, error)
               : scree_fail(error, SCREE_BAD_FILE, "%s: is no record of a run", path);
  const scree_yaml *phase = scree_yaml_find(&root, "phase");
  if (status == SCREE_OK && phase) {
    made.series_count = phase->item_count;
    made.series = scree_alloc_zero(made.series_count, sizeof *made.series);
    if (!made.series)
      status = scree_fail_memory(error, made.series_count * sizeof *made.series, path);
  }
  if (status == SCREE_OK && !read_columns(&root, &made))
    status = scree_fail(error, SCREE_BAD_FILE, "%s: is no record of a run: its series", path);
  if (status == SCREE_OK) status = read_answers(path, &root, &made, error);
  scree_yaml_free(&root);
  if (status == SCREE_OK)
    *record = made;
  else
    scree_study_record_free(&made);
  return status;
}
