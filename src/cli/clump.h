/* Clumps of spheres from tables. */
#ifndef SCREE_CLI_CLUMP_H
#define SCREE_CLI_CLUMP_H

#include <stdbool.h>
#include <string.h>

/* Whether a word of the command line names a clump: a file .csv. */
static inline bool cli_is_clump(const char *word) {
  const char *dot = strrchr(word, '.');
  return dot && !strcmp(dot, ".csv");
}

#endif
