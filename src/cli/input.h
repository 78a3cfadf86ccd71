/* What a verb is given: a file, standard input, or a built-in sample by "sample:NAME". */
#ifndef SCREE_CLI_INPUT_H
#define SCREE_CLI_INPUT_H

#include "scree.h"

typedef struct cli_input_options {
  scree_read_options read;
  scree_sample_options sample;
} cli_input_options;

/* Whether the word names a built-in sample; then *name (may be NULL) is its name. */
bool cli_is_sample(const char *word, const char **name);

/* Reads or makes the surface; a sample's format is "sample", its checksum zero. Free with
 * scree_scan_free. */
scree_status cli_load(const char *word, const cli_input_options *options,
                      const scree_progress *progress, scree_scan *scan, scree_error *error);

/* The word without folders and ending, or the sample's name, into buffer; "stdin" for "-". */
void cli_short_name(const char *word, char *buffer, size_t size);

/* 12345678 as 12,345,678 */
const char *cli_count_text(size_t count, char buffer[32]);

#endif
