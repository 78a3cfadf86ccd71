/* Records whose fields are each said once, in a list of rows:
 *
 *     #define SCREE_PLAN_DISC(ROW, T)                       \
 *       ROW(T, REAL, radius, NAN, 1e-9, 1e6, "m", "")       \
 *       ROW(T, VECTOR, normal, (0, 0, 1), 0, 0, "", "")
 *     SCREE_RECORD_TYPE(scree_plan_disc, SCREE_PLAN_DISC)
 *
 * is the struct, whose members are the rows', and a list of such structs, scree_plan_disc_list. In
 * one .c file
 *
 *     SCREE_RECORD_TABLE(scree_plan_disc, SCREE_PLAN_DISC, "a disc", "a radius", NULL)
 *
 * is scree_plan_disc_record, its table and defaults, with what it needs. A row has the kind
 * (scree_field_kind), the member, which is the key too, and
 *
 *     REAL, VECTOR: default, least, most, unit, sentence     COUNT: default, least, most, sentence
 *     DIRECTION, SEED, FLAG: default, sentence               WORD: default, words, sentence
 *     TEXT, TEXTS, VALUES, NODE: sentence                    TABLE, WEIGHTS: least, most, unit,
 *     GROUP, NAMED, LIST: type of the record, sentence         sentence
 *
 * AS: a key, then the row of a member that is not called so. OWN: declaration, name and default of
 * a member that the file knows nothing of. */
#pragma once

#include "base/schema.h"

#define SCREE_NONE                  (NAN, NAN, NAN)
#define SCREE_ZERO                  (0, 0, 0)
#define SCREE_WITHOUT_BRACKETS(...) __VA_ARGS__

#define SCREE_RECORD_TYPE(type, list)                                                              \
  typedef struct type {                                                                            \
    scree_place place;                                                                             \
    list(SCREE_MEMBER, type)                                                                       \
  } type;                                                                                          \
  SCREE_RECORD_LIST(type);
/* What a record's lists are, and that there is its table. */
#define SCREE_RECORD_LIST(type)                                                                    \
  typedef struct type##_list {                                                                     \
    type *items;                                                                                   \
    size_t count;                                                                                  \
  } type##_list;                                                                                   \
  extern const scree_record type##_record

/* The same struct, of which another record has some members, with other keys and ranges. */
#define SCREE_RECORD_LIKE(type, other)                                                             \
  typedef type other;                                                                              \
  SCREE_RECORD_LIST(other)

#define SCREE_RECORD_TABLE(type, list, what, needs, check)                                         \
  SCREE_RECORD_TABLE_OF(type, list, list, what, needs, check)
/* Tables of a record that has rows for some of the members; the others have defaults, too. */
#define SCREE_RECORD_TABLE_OF(type, all, list, what, needs, check)                                 \
  static const type type##_defaults = {.place = {0}, all(SCREE_DEFAULT, type)};                    \
  static const scree_field type##_fields[] = {list(SCREE_ROW, type)};                              \
  const scree_record type##_record = {                                                             \
      what,         type##_fields,    sizeof(type##_fields) / sizeof *type##_fields,               \
      sizeof(type), &type##_defaults, needs,                                                       \
      check};

/* ---- a row as member of the struct ---- */

#define SCREE_MEMBER(T, kind, ...)               SCREE_MEMBER_##kind(T, __VA_ARGS__)
#define SCREE_MEMBER_AS(T, key, kind, ...)       SCREE_MEMBER_##kind(T, __VA_ARGS__)
#define SCREE_MEMBER_OWN(T, declaration, ...)    declaration;
#define SCREE_MEMBER_REAL(T, member, ...)        double member;
#define SCREE_MEMBER_VECTOR(T, member, ...)      double member[3];
#define SCREE_MEMBER_DIRECTION(T, member, ...)   double member[3];
#define SCREE_MEMBER_COUNT(T, member, ...)       size_t member;
#define SCREE_MEMBER_SEED(T, member, ...)        uint64_t member;
#define SCREE_MEMBER_FLAG(T, member, ...)        bool member;
#define SCREE_MEMBER_WORD(T, member, ...)        int member;
#define SCREE_MEMBER_TEXT(T, member, ...)        const char *member;
#define SCREE_MEMBER_TEXTS(T, member, ...)       scree_texts member;
#define SCREE_MEMBER_TABLE(T, member, ...)       scree_table member;
#define SCREE_MEMBER_WEIGHTS(T, member, ...)     scree_weights member;
#define SCREE_MEMBER_VALUES(T, member, ...)      scree_values member;
#define SCREE_MEMBER_NODE(T, member, ...)        const scree_yaml *member;
#define SCREE_MEMBER_GROUP(T, member, type, ...) type *member;
#define SCREE_MEMBER_NAMED(T, member, type, ...) type##_list member;
#define SCREE_MEMBER_LIST(T, member, type, ...)  type##_list member;

/* ---- as its default ---- */

#define SCREE_DEFAULT(T, kind, ...)                    SCREE_DEFAULT_##kind(T, __VA_ARGS__)
#define SCREE_DEFAULT_AS(T, key, kind, ...)            SCREE_DEFAULT_##kind(T, __VA_ARGS__)
#define SCREE_DEFAULT_OWN(T, declaration, name, value) .name = value,
#define SCREE_DEFAULT_REAL(T, member, value, ...)      .member = (value),
#define SCREE_DEFAULT_VECTOR(T, member, value, ...)    .member = {SCREE_WITHOUT_BRACKETS value},
#define SCREE_DEFAULT_DIRECTION                        SCREE_DEFAULT_VECTOR
#define SCREE_DEFAULT_COUNT                            SCREE_DEFAULT_REAL
#define SCREE_DEFAULT_SEED                             SCREE_DEFAULT_REAL
#define SCREE_DEFAULT_FLAG                             SCREE_DEFAULT_REAL
#define SCREE_DEFAULT_WORD                             SCREE_DEFAULT_REAL
#define SCREE_DEFAULT_TEXT(...)
#define SCREE_DEFAULT_TEXTS(...)
#define SCREE_DEFAULT_TABLE(...)
#define SCREE_DEFAULT_WEIGHTS(...)
#define SCREE_DEFAULT_VALUES(...)
#define SCREE_DEFAULT_NODE(...)
#define SCREE_DEFAULT_GROUP(...)
#define SCREE_DEFAULT_NAMED(...)
#define SCREE_DEFAULT_LIST(...)

/* ---- in the table ---- */

#define SCREE_ROW(T, kind, member, ...) SCREE_ROW_##kind(kind, T, #member, member, __VA_ARGS__)
/* as: the word AS; none: the key as a text of text */
#define SCREE_ROW_AS(as, T, none, key, kind, ...) SCREE_ROW_##kind(kind, T, key, __VA_ARGS__)
#define SCREE_ROW_OWN(...)
#define SCREE_ROW_OF(kind, T, key, member, least, most, unit, comment, record)                     \
  {key,                                                                                            \
   SCREE_FIELD_##kind,                                                                             \
   offsetof(T, member),                                                                            \
   sizeof(((T *)0)->member),                                                                       \
   least,                                                                                          \
   most,                                                                                           \
   unit,                                                                                           \
   comment,                                                                                        \
   record},
#define SCREE_ROW_REAL(kind, T, key, member, value, least, most, unit, comment)                    \
  SCREE_ROW_OF(kind, T, key, member, least, most, unit, comment, NULL)
#define SCREE_ROW_VECTOR SCREE_ROW_REAL
#define SCREE_ROW_COUNT(kind, T, key, member, value, least, most, comment)                         \
  SCREE_ROW_OF(kind, T, key, member, least, most, "", comment, NULL)
#define SCREE_ROW_TABLE(kind, T, key, member, least, most, unit, comment)                          \
  SCREE_ROW_OF(kind, T, key, member, least, most, unit, comment, NULL)
#define SCREE_ROW_WEIGHTS SCREE_ROW_TABLE
#define SCREE_ROW_WORD(kind, T, key, member, value, words, comment)                                \
  SCREE_ROW_OF(kind, T, key, member, 0, 0, words, comment, NULL)
#define SCREE_ROW_SEED(kind, T, key, member, value, comment)                                       \
  SCREE_ROW_OF(kind, T, key, member, 0, 0, "", comment, NULL)
#define SCREE_ROW_FLAG      SCREE_ROW_SEED
#define SCREE_ROW_DIRECTION SCREE_ROW_SEED
#define SCREE_ROW_TEXT(kind, T, key, member, comment)                                              \
  SCREE_ROW_OF(kind, T, key, member, 0, 0, "", comment, NULL)
#define SCREE_ROW_TEXTS  SCREE_ROW_TEXT
#define SCREE_ROW_VALUES SCREE_ROW_TEXT
#define SCREE_ROW_NODE   SCREE_ROW_TEXT
#define SCREE_ROW_NAMED(kind, T, key, member, type, comment)                                       \
  SCREE_ROW_OF(kind, T, key, member, 0, 0, "", comment, &type##_record)
#define SCREE_ROW_LIST SCREE_ROW_NAMED
#define SCREE_ROW_GROUP(kind, T, key, member, type, comment)                                       \
  SCREE_ROW_OF(RECORD, T, key, member, 0, 0, "", comment, &type##_record)

/* ---- of kinds, whose fields each are known in a file of their own: that there is the record ----
 */

#define SCREE_KIND_RECORD(T, row, ...) SCREE_KIND_RECORD_##row(__VA_ARGS__)
#define SCREE_KIND_RECORD_GROUP(key, type, ...)                                                    \
  typedef struct type type;                                                                        \
  extern const scree_record type##_record;
#define SCREE_KIND_RECORD_VECTOR(...)
#define SCREE_KIND_RECORD_DIRECTION(...)
#define SCREE_KIND_RECORD_TEXT(...)
#define SCREE_KIND_RECORD_TEXTS(...)
