/* Records that are read from YAML by a table of their fields (field.h): each has a key, a kind, a
 * range, a unit and a sentence. The same table reads, refuses what is wrong with its place, and
 * prints the record with units and comments. */
#pragma once

#include "base/arena.h"
#include "base/error.h"
#include "base/field.h"
#include "base/yaml.h"

typedef struct scree_texts {
  const char **items;
  size_t count;
} scree_texts;

typedef struct scree_table {
  double (*items)[2];
  size_t count;
} scree_table;

typedef struct scree_weights {
  const char **names;
  double *values;
  size_t count;
} scree_weights;

typedef struct scree_values {
  const char **names, **texts;
  size_t count;
} scree_values;

/* As the list of every type of record (schema_rows.h) lies in memory. */
typedef struct scree_records {
  void *items;
  size_t count;
} scree_records;

/* Where a record was read; the first member of each. */
typedef struct scree_place {
  const char *name; /* its key, where records are named */
  const char *path; /* "inlets.feed" */
  size_t line, column;
} scree_place;

typedef struct scree_reader scree_reader;

typedef struct scree_record {
  const char *what; /* "an inlet" */
  const scree_field *fields;
  size_t field_count, size;
  const void *defaults;
  /* What must be given, to say so: the words of it that are keys. NULL: nothing. */
  const char *needs;
  /* What single fields cannot say; NULL: nothing. */
  scree_status (*check)(const scree_reader *reader, const void *record);
} scree_record;

struct scree_reader {
  const char *file; /* for messages */
  scree_arena *arena;
  scree_error *error;
  const char *path; /* of the record being read, "" at the top */
};

/* Reads a mapping into *record, which begins with a scree_place; it is in the arena, or all of it
 * is the caller's. */
scree_status scree_record_read(const scree_reader *reader, const scree_yaml *node,
                               const scree_record *kind, void *record);
/* "FILE, line L, column C: PATH: ..." as an error of SCREE_BAD_FILE. */
scree_status scree_fail_place(const scree_reader *reader, const scree_place *place,
                              const char *format, ...) SCREE_PRINTF(3, 4);
/* "no material 'glas'; did you mean 'glass'?" or which there are. */
scree_status scree_fail_name(const scree_reader *reader, const scree_place *place, const char *what,
                             const char *name, const char *const *names, size_t count);
/* One field of a record, which need not begin with a scree_place, from its value. */
scree_status scree_field_read(const scree_reader *reader, const scree_yaml *node,
                              const scree_field *field, void *record);
/* A number, flag or word as text that reads back to the same. */
void scree_field_text(const scree_field *field, const void *record, char *text, size_t size);
/* "  # unit; sentence" */
void scree_field_print_comment(const scree_field *field, FILE *stream);
/* Whether a field of the record was given; `field` is its offset. */
bool scree_field_is_given(const scree_field *field, const void *record);

/* Prints what was given or has a default, as YAML that reads back to the same values. */
void scree_record_print(const scree_record *kind, const void *record, int depth, bool comments,
                        FILE *stream);

/* The name that is a typing error away from `word`; NULL: none is. */
const char *scree_nearest_name(const char *word, const char *const *names, size_t count);
/* That one, else the names as far as there is room, to end a sentence on a name that is not there.
 */
enum { SCREE_NAME_HINT = 400 };
void scree_name_hint(const char *name, const char *const *names, size_t count,
                     char hint[SCREE_NAME_HINT]);
