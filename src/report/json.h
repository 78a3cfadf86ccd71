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

/* Members of *object under their own names, up to ten, each as its type is written. */
#define SCREE_JSON_MEMBERS(json, object, ...)                                                      \
  SCREE_JSON_CHOSEN(__VA_ARGS__, SCREE_JSON_10, SCREE_JSON_9, SCREE_JSON_8, SCREE_JSON_7,          \
                    SCREE_JSON_6, SCREE_JSON_5, SCREE_JSON_4, SCREE_JSON_3, SCREE_JSON_2,          \
                    SCREE_JSON_1, )                                                                \
  (json, object, __VA_ARGS__)
#define SCREE_JSON_CHOSEN(a, b, c, d, e, f, g, h, i, j, name, ...) name
#define SCREE_JSON_1(json, object, member)                                                         \
  _Generic((object)->member, double                                                                \
           : scree_json_number, bool                                                               \
           : scree_json_bool, const char *                                                         \
           : scree_json_text, char *                                                               \
           : scree_json_text, default                                                              \
           : scree_json_count)(json, #member, (object)->member)
#define SCREE_JSON_2(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_1(j, o, __VA_ARGS__))
#define SCREE_JSON_3(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_2(j, o, __VA_ARGS__))
#define SCREE_JSON_4(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_3(j, o, __VA_ARGS__))
#define SCREE_JSON_5(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_4(j, o, __VA_ARGS__))
#define SCREE_JSON_6(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_5(j, o, __VA_ARGS__))
#define SCREE_JSON_7(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_6(j, o, __VA_ARGS__))
#define SCREE_JSON_8(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_7(j, o, __VA_ARGS__))
#define SCREE_JSON_9(j, o, m, ...)  (SCREE_JSON_1(j, o, m), SCREE_JSON_8(j, o, __VA_ARGS__))
#define SCREE_JSON_10(j, o, m, ...) (SCREE_JSON_1(j, o, m), SCREE_JSON_9(j, o, __VA_ARGS__))
/* An object on one line of such members alone. */
#define SCREE_JSON_ROW(json, key, object, ...)                                                     \
  (scree_json_row_object(json, key), SCREE_JSON_MEMBERS(json, object, __VA_ARGS__),                \
   scree_json_end(json))

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
