/* A member of a struct as a row of a table, said once: what is read of files (schema.h), and what
 * is written to them, drawn and told.
 *
 *     static const scree_field rows[] = {
 *         SCREE_FIELD_OF(scree_clump, iou),
 *         SCREE_FIELD_AS(scree_clump, "to_mesh_mean", to_mesh.mean)};
 *
 * A row takes its kind and size from the member, so that it cannot contradict the struct. */
#pragma once

#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum scree_field_kind {
  SCREE_FIELD_REAL,      /* double; NAN: not given */
  SCREE_FIELD_COUNT,     /* size_t; 0: not given */
  SCREE_FIELD_SEED,      /* uint64_t */
  SCREE_FIELD_FLAG,      /* bool */
  SCREE_FIELD_WORD,      /* int: which of the words that `unit` lists; -1: not given */
  SCREE_FIELD_TEXT,      /* const char *; NULL: not given */
  SCREE_FIELD_TEXTS,     /* scree_texts: one text, or a list of them */
  SCREE_FIELD_VECTOR,    /* double[3]; first NAN: not given */
  SCREE_FIELD_DIRECTION, /* the same, not [0, 0, 0] */
  SCREE_FIELD_TURN,      /* double[4], w x y z; first NAN: not given */
  SCREE_FIELD_TABLE,     /* scree_table: [[t, value], ...], t rising */
  SCREE_FIELD_WEIGHTS,   /* scree_weights: {name: number, ...}, a list of names, or one name */
  SCREE_FIELD_RECORD,    /* struct *; NULL: not given */
  SCREE_FIELD_NAMED,     /* TYPE_list: {name: record, ...} */
  SCREE_FIELD_LIST,      /* TYPE_list: [record, ...] */
  SCREE_FIELD_VALUES,    /* scree_values: {name: any one value, ...} */
  SCREE_FIELD_NODE, /* const scree_yaml *: as it stands there, for its reader to look at; NULL: not
                       given; never printed */
  /* never read of a file */
  SCREE_FIELD_SINGLE, /* float */
  SCREE_FIELD_WHOLE,  /* int64_t */
  SCREE_FIELD_BYTE,   /* uint8_t */
  SCREE_FIELD_CHARS,  /* char[] */
} scree_field_kind;

struct scree_record;

typedef struct scree_field {
  const char *key;
  scree_field_kind kind;
  size_t offset, size;     /* in the struct, B */
  double minimum, maximum; /* of numbers that are read; both 0: any that is finite */
  const char *unit;        /* "" for a pure number; the words of a word */
  const char *comment;
  const struct scree_record *record;
} scree_field;

#define SCREE_FIELD_OF(T, member)       SCREE_FIELD_AS(T, #member, member)
#define SCREE_FIELD_AS(T, name, member) SCREE_FIELD_IN(T, name, "", member)
#define SCREE_FIELD_IN(T, name, unit, member)                                                      \
  {                                                                                                \
    name, SCREE_FIELD_KIND(((T *)0)->member), offsetof(T, member), sizeof(((T *)0)->member), 0, 0, \
        unit, "", NULL                                                                             \
  }
/* Of an array: its elements'. */
#define SCREE_FIELD_KIND(value)                                                                    \
  _Generic((value), double                                                                         \
           : SCREE_FIELD_REAL, double *                                                            \
           : SCREE_FIELD_REAL, double(*)[3]                                                        \
           : SCREE_FIELD_REAL, vec3                                                                \
           : SCREE_FIELD_REAL, float                                                               \
           : SCREE_FIELD_SINGLE, float *                                                           \
           : SCREE_FIELD_SINGLE, bool                                                              \
           : SCREE_FIELD_FLAG, uint8_t                                                             \
           : SCREE_FIELD_BYTE, int                                                                 \
           : SCREE_FIELD_WORD, unsigned                                                            \
           : SCREE_FIELD_WORD, long                                                                \
           : SCREE_FIELD_WHOLE, long long                                                          \
           : SCREE_FIELD_WHOLE, unsigned long long                                                 \
           : SCREE_FIELD_SEED, const char *                                                        \
           : SCREE_FIELD_TEXT, char *                                                              \
           : SCREE_FIELD_CHARS, default                                                            \
           : SCREE_FIELD_COUNT)

static inline const void *scree_field_at(const scree_field *field, const void *record) {
  return (const char *)record + field->offset;
}
/* Of a REAL, which may be an array; of a COUNT or SEED. */
static inline double scree_field_real(const scree_field *field, const void *record) {
  return *(const double *)scree_field_at(field, record);
}
static inline uint64_t scree_field_whole(const scree_field *field, const void *record) {
  const void *at = scree_field_at(field, record);
  return field->kind == SCREE_FIELD_COUNT ? *(const size_t *)at : *(const uint64_t *)at;
}
/* Of either. */
static inline double scree_field_number(const scree_field *field, const void *record) {
  return field->kind == SCREE_FIELD_REAL ? scree_field_real(field, record)
                                         : (double)scree_field_whole(field, record);
}
