/* A streaming JSON writer (RFC 8259): no tree in memory, correct nesting and commas by itself.
 *
 *   scree_json json = scree_json_start(stream);
 *   scree_json_object(&json, NULL);
 *   scree_json_number(&json, "area", 1.5);
 *   scree_json_end(&json);
 *
 * A key is given inside objects and NULL inside arrays. Numbers are written in the shortest form
 * that reads back as the same double; NaN and infinities, which JSON lacks, as null. Texts that are
 * not UTF-8 keep their good parts; each bad byte becomes U+FFFD. Write errors stay in the stream
 * (ferror). */
#pragma once

#include "base/error.h"
#include "base/field.h"
#include "base/file.h"

enum { SCREE_JSON_DEPTH = 32 };

typedef struct scree_json {
  FILE *stream;
  scree_output output; /* of scree_json_open */
  int depth;
  struct {
    char closing;  /* ']' or '}' */
    bool one_line; /* its content, and all below */
    bool filled;
  } open[SCREE_JSON_DEPTH];
} scree_json;

scree_json scree_json_start(FILE *stream);
/* A whole file, to be committed; "-" is stdout. */
scree_status scree_json_open(scree_json *json, const char *path, bool overwrite,
                             scree_error *error);
scree_status scree_json_commit(scree_json *json, scree_error *error);
void scree_json_object(scree_json *json, const char *key);
void scree_json_array(scree_json *json, const char *key);
/* The same, all on one line: for rows of a table. */
void scree_json_row_object(scree_json *json, const char *key);
void scree_json_row_array(scree_json *json, const char *key);
/* Closes the innermost object or array; after the outermost a line end follows. */
void scree_json_end(scree_json *json);
void scree_json_text(scree_json *json, const char *key, const char *text); /* NULL: null */
void scree_json_number(scree_json *json, const char *key, double value);
void scree_json_count(scree_json *json, const char *key, uint64_t value);
void scree_json_bool(scree_json *json, const char *key, bool value);
/* An array of them on one line. */
void scree_json_numbers(scree_json *json, const char *key, const double *values, size_t count);
void scree_json_matrix(scree_json *json, const char *key, const double values[3][3]);

/* An array of `count` elements, which the statement behind it writes one by one, without leaving
 * it:
 *
 *   SCREE_JSON_LIST(json, "names", i, count) scree_json_text(json, NULL, names[i]); */
#define SCREE_JSON_LIST(json, key, index, count)                                                   \
  SCREE_JSON_EACH(scree_json_array, json, key, index, count)
#define SCREE_JSON_ROW_LIST(json, key, index, count)                                               \
  SCREE_JSON_EACH(scree_json_row_array, json, key, index, count)
#define SCREE_JSON_EACH(open, json, key, index, count)                                             \
  for (size_t index = (open((json), (key)), 0); index < (count) || (scree_json_end(json), false);  \
       index++)

/* A value with its key, as its type is written: OF a member under its own name, AS another. */
typedef struct scree_json_value {
  const char *key;
  enum { SCREE_JSON_NUMBER, SCREE_JSON_COUNT, SCREE_JSON_BOOL, SCREE_JSON_TEXT } kind;
  double number;
  uint64_t count; /* of a bool: 1 or 0 */
  const char *text;
} scree_json_value;
#define AS(name, value)                                                                            \
  _Generic((value), double                                                                         \
           : scree_json_of_number, float                                                           \
           : scree_json_of_number, bool                                                            \
           : scree_json_of_bool, const char *                                                      \
           : scree_json_of_text, char *                                                            \
           : scree_json_of_text, default                                                           \
           : scree_json_of_count)(name, value)
#define OF(object, member) AS(#member, (object)->member)
scree_json_value scree_json_of_number(const char *key, double value);
scree_json_value scree_json_of_count(const char *key, uint64_t value);
scree_json_value scree_json_of_bool(const char *key, bool value);
scree_json_value scree_json_of_text(const char *key, const char *value);
void scree_json_values(scree_json *json, const scree_json_value *values, size_t count);
/* Some of them, one after the other:
 *
 *   SCREE_JSON_MEMBERS(json, OF(mesh, vertex_count), AS("unit", unit)); */
#define SCREE_JSON_MEMBERS(json, ...)                                                              \
  scree_json_values(json, (const scree_json_value[]){__VA_ARGS__},                                 \
                    sizeof((const scree_json_value[]){__VA_ARGS__}) / sizeof(scree_json_value))
/* An object on one line of them alone. */
#define SCREE_JSON_ROW(json, key, ...)                                                             \
  (scree_json_row_object(json, key), SCREE_JSON_MEMBERS(json, __VA_ARGS__), scree_json_end(json))

/* A member under its row's key; NaN of a REAL is null, 3 x 3 of them are rows. */
void scree_json_field(scree_json *json, const scree_field *field, const void *record);

/* Fields that many files have. Of what: a file's format, checksum, and unit of length in metres. */
void scree_json_source(scree_json *json, const char *format, scree_checksum checksum,
                       double unit_m);
/* By what: version and command. */
void scree_json_maker(scree_json *json, const char *command_line);
/* words.c: verdict, state, sentence, but, next. */
struct scree_words;
void scree_json_words(scree_json *json, const struct scree_words *words);
/* heap_json.c: a heap's angles and lengths. */
void scree_json_repose(scree_json *json, const scree_repose *repose);

/* Whether bytes are one JSON text (RFC 8259), nothing more: what goes into a page must not break
 * it. Nested to SCREE_JSON_DEPTH at most. Strings are not checked for UTF-8.
 * bytes[byte_count] must be 0 (as scree_file_read leaves it). name goes into the sentence. */
scree_status scree_json_check(const char *bytes, size_t byte_count, const char *name,
                              scree_error *error);
