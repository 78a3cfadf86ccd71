/* Clumps of spheres from tables. */
#ifndef SCREE_CLI_CLUMP_H
#define SCREE_CLI_CLUMP_H

#include "cli/input.h"

/* Whether a word of the command line names a clump: a file .csv. */
bool cli_is_clump(const char *word);

/* The particle of a table with one sphere a line (x, y, z, radius in `unit`, m); messages name the
 * file. */
scree_status cli_read_clump(const char *path, double unit, scree_particle **particle,
                            scree_error *error);

#endif
