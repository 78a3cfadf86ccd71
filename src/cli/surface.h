/* What check and repair say about a surface. */
#ifndef SCREE_CLI_SURFACE_H
#define SCREE_CLI_SURFACE_H

#include "scree.h"

/* The counts that are not 0, a line each, and the volume. */
void cli_print_check(FILE *stream, const scree_check *check);
/* What was done, a line each; "nothing" where nothing was. */
void cli_print_repair(FILE *stream, const scree_repair_report *report);

#endif
