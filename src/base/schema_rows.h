/* Rows of the tables in base/schema.h, for files that hold such tables: the field is the member of
 * that name of the type that the macro RECORD names there. */
#pragma once

#include "base/schema.h"

#define SCREE_ROW(member, kind, least, most, unit, comment, record)                                \
  { #member, SCREE_FIELD_##kind, offsetof(RECORD, member), least, most, unit, comment, record }

#define REAL(member, least, most, unit, comment)                                                   \
  SCREE_ROW(member, REAL, least, most, unit, comment, NULL)
#define VECTOR(member, least, most, unit, comment)                                                 \
  SCREE_ROW(member, VECTOR, least, most, unit, comment, NULL)
#define WEIGHTS(member, least, most, unit, comment)                                                \
  SCREE_ROW(member, WEIGHTS, least, most, unit, comment, NULL)
#define COUNT(member, least, most, comment) SCREE_ROW(member, COUNT, least, most, "", comment, NULL)
#define WORD(member, words, comment)        SCREE_ROW(member, WORD, 0, 0, words, comment, NULL)
#define TABLE(member, units, comment)       SCREE_ROW(member, TABLE, 0, 0, units, comment, NULL)
#define FLAG(member, comment)               SCREE_ROW(member, FLAG, 0, 0, "", comment, NULL)
#define SEED(member, comment)               SCREE_ROW(member, SEED, 0, 0, "", comment, NULL)
#define TEXT(member, comment)               SCREE_ROW(member, TEXT, 0, 0, "", comment, NULL)
#define TEXTS(member, comment)              SCREE_ROW(member, TEXTS, 0, 0, "", comment, NULL)
#define VALUES(member, comment)             SCREE_ROW(member, VALUES, 0, 0, "", comment, NULL)
#define NODE(member, comment)               SCREE_ROW(member, NODE, 0, 0, "", comment, NULL)
#define GROUP(member, comment, record)      SCREE_ROW(member, RECORD, 0, 0, "", comment, record)
#define NAMED(member, comment, record)      SCREE_ROW(member, NAMED, 0, 0, "", comment, record)
#define LIST(member, comment, record)       SCREE_ROW(member, LIST, 0, 0, "", comment, record)

/* The record of a table and its defaults. */
#define SCREE_RECORD(what, table, defaults, check)                                                 \
  { what, table, sizeof(table) / sizeof *(table), sizeof(defaults), &(defaults), check }
