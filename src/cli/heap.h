/* What a heap looks like in text, and as a picture. */
#ifndef SCREE_CLI_HEAP_H
#define SCREE_CLI_HEAP_H

#include "cli/args.h"

/* The result on one screen, without the costs. */
void cli_print_heap(FILE *stream, const scree_run *run, const scree_run_result *result);
void cli_print_costs(FILE *stream, const scree_run *run);

scree_status cli_write_picture(const scree_run *run, const scree_render_options *options,
                               const char *path, bool overwrite, const scree_progress *progress,
                               scree_error *error);

#endif
