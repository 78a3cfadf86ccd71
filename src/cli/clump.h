/* Clumps of spheres from tables. */
#pragma once

#include "scree.h"

/* Whether a word of the command line names a clump. */
static inline bool cli_is_clump(const char *word) {
  return scree_is_clump_table(word);
}
