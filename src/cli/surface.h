/* What check and repair say about a surface. */
#ifndef SCREE_CLI_SURFACE_H
#define SCREE_CLI_SURFACE_H

#include "scree.h"

/* The counts that are not 0, a line each, and the volume. */
void cli_print_check(FILE *stream, const scree_check *check);
/* "repaired: 3 holes filled, ..." of a surface that needed it, else "". */
void cli_repair_text(const scree_repair_report *report, char *buffer, size_t size);
/* What was done, a line each; "nothing" where nothing was. */
void cli_print_repair(FILE *stream, const scree_repair_report *report);

/* A file of single precision, as STL is, may not hold what is sound in double: SCREE_BAD_MESH where
 * the mesh, read from the file that the path will name, would no longer pass the check. "-" is an
 * STL. how may be NULL. */
scree_status cli_check_rounded(const scree_mesh *mesh, const char *path, double unit,
                               const scree_check_options *how, const scree_progress *progress,
                               scree_error *error);

#endif
