/* A YAML file (JSON is YAML) as a small tree whose every node knows its line and column. Only what
 * configuration needs: one document of mappings, sequences and scalars; no anchors, aliases or
 * tags. */
#pragma once

#include "base/error.h"

typedef enum scree_yaml_kind {
  SCREE_YAML_SCALAR,
  SCREE_YAML_SEQUENCE,
  SCREE_YAML_MAPPING
} scree_yaml_kind;

typedef struct scree_yaml {
  scree_yaml_kind kind;
  size_t line, column; /* from 1; 0: put there by scree_yaml_set */
  size_t key_line, key_column;
  char *key;                /* in a mapping; else NULL */
  char *text;               /* of a scalar; else NULL */
  struct scree_yaml *items; /* of a sequence or a mapping */
  size_t item_count;
} scree_yaml;

/* Reads a file of at most 1 MB ("-" is stdin); an empty file is an empty mapping. */
scree_status scree_yaml_read(const char *path, scree_yaml *root, scree_error *error);
scree_status scree_yaml_parse(const char *bytes, size_t byte_count, const char *name,
                              scree_yaml *root, scree_error *error);
void scree_yaml_free(scree_yaml *root);

/* A copy that knows the same places; free it. */
scree_status scree_yaml_copy(const scree_yaml *node, scree_yaml *copy, scree_error *error);

/* The item with the key, or NULL. */
const scree_yaml *scree_yaml_find(const scree_yaml *mapping, const char *key);
/* What stands where the keys say, as of scree_yaml_set; NULL: nothing does. */
const scree_yaml *scree_yaml_at(const scree_yaml *root, const char *keys);

/* Puts the value, itself YAML, where the keys say, joined by points, as in inlets.feed.rate; of a
 * sequence the item's number from 0. Mappings that are missing on the way are made. */
scree_status scree_yaml_set(scree_yaml *root, const char *keys, const char *value,
                            scree_error *error);

/* Puts all of `over`, which is freed, over what is there: mappings key by key, all else as it is.
 */
scree_status scree_yaml_merge(scree_yaml *root, scree_yaml *over, scree_error *error);
