#include "report/json.h"

#include "base/file.h"
#include "base/number.h"
#include "base/quote.h"

#include <math.h>

scree_json scree_json_start(FILE *stream) {
  return (scree_json){.stream = stream};
}

/* Comma, line end, indentation and key before a value. */
static void lead(scree_json *json, const char *key) {
  if (json->depth > 0) {
    bool filled = json->open[json->depth - 1].filled;
    if (filled) putc(',', json->stream);
    if (json->open[json->depth - 1].one_line) {
      if (filled) putc(' ', json->stream);
    } else {
      fprintf(json->stream, "\n%*s", 2 * json->depth, "");
    }
    json->open[json->depth - 1].filled = true;
  }
  if (!key) return;
  scree_quote(json->stream, SCREE_QUOTE_JSON, key);
  fputs(": ", json->stream);
}

static void open_value(scree_json *json, const char *key, char opening, bool one_line) {
  SCREE_ASSERT(json->depth < SCREE_JSON_DEPTH);
  lead(json, key);
  putc(opening, json->stream);
  bool outer = json->depth > 0 && json->open[json->depth - 1].one_line;
  json->open[json->depth].closing = opening == '{' ? '}' : ']';
  json->open[json->depth].one_line = one_line || outer;
  json->open[json->depth].filled = false;
  json->depth++;
}

void scree_json_object(scree_json *json, const char *key) {
  open_value(json, key, '{', false);
}
void scree_json_array(scree_json *json, const char *key) {
  open_value(json, key, '[', false);
}
void scree_json_row_object(scree_json *json, const char *key) {
  open_value(json, key, '{', true);
}
void scree_json_row_array(scree_json *json, const char *key) {
  open_value(json, key, '[', true);
}

void scree_json_end(scree_json *json) {
  SCREE_ASSERT(json->depth > 0);
  json->depth--;
  if (json->open[json->depth].filled && !json->open[json->depth].one_line)
    fprintf(json->stream, "\n%*s", 2 * json->depth, "");
  putc(json->open[json->depth].closing, json->stream);
  if (json->depth == 0) putc('\n', json->stream);
}

void scree_json_text(scree_json *json, const char *key, const char *text) {
  lead(json, key);
  if (text)
    scree_quote(json->stream, SCREE_QUOTE_JSON, text);
  else
    fputs("null", json->stream);
}

void scree_json_number(scree_json *json, const char *key, double value) {
  char buffer[SCREE_NUMBER_SIZE] = "null";
  lead(json, key);
  if (isfinite(value)) scree_number_format(value, buffer);
  fputs(buffer, json->stream);
}

void scree_json_count(scree_json *json, const char *key, uint64_t value) {
  lead(json, key);
  fprintf(json->stream, "%llu", (unsigned long long)value);
}

void scree_json_bool(scree_json *json, const char *key, bool value) {
  lead(json, key);
  fputs(value ? "true" : "false", json->stream);
}

scree_json_value scree_json_of_number(const char *key, double value) {
  return (scree_json_value){.key = key, .kind = SCREE_JSON_NUMBER, .number = value};
}
scree_json_value scree_json_of_count(const char *key, uint64_t value) {
  return (scree_json_value){.key = key, .kind = SCREE_JSON_COUNT, .count = value};
}
scree_json_value scree_json_of_bool(const char *key, bool value) {
  return (scree_json_value){.key = key, .kind = SCREE_JSON_BOOL, .count = value};
}
scree_json_value scree_json_of_text(const char *key, const char *value) {
  return (scree_json_value){.key = key, .kind = SCREE_JSON_TEXT, .text = value};
}

void scree_json_values(scree_json *json, const scree_json_value *values, size_t count) {
  for (const scree_json_value *v = values; v < values + count; v++) {
    if (v->kind == SCREE_JSON_NUMBER) scree_json_number(json, v->key, v->number);
    if (v->kind == SCREE_JSON_COUNT) scree_json_count(json, v->key, v->count);
    if (v->kind == SCREE_JSON_BOOL) scree_json_bool(json, v->key, v->count);
    if (v->kind == SCREE_JSON_TEXT) scree_json_text(json, v->key, v->text);
  }
}

void scree_json_numbers(scree_json *json, const char *key, const double *values, size_t count) {
  SCREE_JSON_ROW_LIST (json, key, i, count) scree_json_number(json, NULL, values[i]);
}

void scree_json_matrix(scree_json *json, const char *key, const double values[3][3]) {
  SCREE_JSON_ROW_LIST (json, key, i, 3) scree_json_numbers(json, NULL, values[i], 3);
}

static void put_reals(scree_json *json, const char *key, const double *values, size_t count) {
  if (count == 1)
    scree_json_number(json, key, *values);
  else if (count == 9)
    scree_json_matrix(json, key, (const void *)values);
  else
    scree_json_numbers(json, key, values, count);
}

void scree_json_field(scree_json *json, const scree_field *f, const void *record) {
  const void *at = scree_field_at(f, record);
  switch (f->kind) {
  case SCREE_FIELD_COUNT:
  case SCREE_FIELD_SEED:
    scree_json_count(json, f->key, scree_field_whole(f, record));
    break;
  case SCREE_FIELD_WHOLE:
    scree_json_number(json, f->key, (double)*(const long long *)at);
    break;
  case SCREE_FIELD_FLAG:
    scree_json_bool(json, f->key, *(const bool *)at);
    break;
  default:
    put_reals(json, f->key, at, f->size / sizeof(double));
  }
}

scree_status scree_json_open(scree_json *json, const char *path, bool overwrite,
                             scree_error *error) {
  *json = (scree_json){0};
  SCREE_TRY(scree_output_open(path, overwrite, &json->output, error));
  json->stream = json->output.stream;
  return SCREE_OK;
}

scree_status scree_json_commit(scree_json *json, scree_error *error) {
  return scree_output_commit(&json->output, error);
}

void scree_json_source(scree_json *json, const char *format, scree_checksum checksum,
                       double unit_m) {
  char text[SCREE_CHECKSUM_TEXT];
  scree_json_text(json, "format", format);
  scree_json_text(json, "checksum", scree_checksum_text(checksum, text));
  scree_json_number(json, "unit_m", unit_m);
}

void scree_json_maker(scree_json *json, const char *command_line) {
  scree_json_text(json, "version", scree_version());
  scree_json_text(json, "command", command_line);
}
