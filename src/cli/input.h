/* What a verb is given: a file, standard input, or a built-in sample by "sample:NAME". */
#pragma once

#include "base/platform.h"
#include "cli/args.h"

typedef struct cli_input_options {
  scree_read_options read;
  scree_sample_options sample;
  bool remarked; /* what is to be remarked of the file has been, or will be */
  bool keep_handles;
} cli_input_options;

/* The options that every verb with surfaces as input has, as a member of its struct. */
typedef struct cli_source {
  double unit;              /* m per unit of the files */
  double resolution, noise; /* m; of samples */
  size_t seed;
} cli_source;

#define CLI_SOURCE_DEFAULTS                                                                        \
  { 1e-3, 0.27e-3, 0.02e-3, 1 }

/* Their rows in the option table of a verb whose struct has the member `source`. */
#define CLI_SOURCE_OPTIONS                                                                         \
  CLI_WORDS_ROW(CLI_UNIT, "unit", source.unit, "UNIT", CLI_UNITS,                                  \
                "The files' unit of length: m, cm, mm, um, inch, ft or km. Default: mm."),         \
      CLI_RANGE_ROW(CLI_LENGTH, "resolution", source.resolution, "LENGTH", 0.02e-3, 5e-3,          \
                    "Spacing of built-in samples. Default: 0.27mm."),                              \
      CLI_RANGE_ROW(CLI_LENGTH, "noise", source.noise, "LENGTH", 0, 2e-3,                          \
                    "Scanner noise of built-in samples. Default: 0.02mm."),                        \
      CLI_RANGE_ROW(CLI_COUNT, "sample-seed", source.seed, "N", 0, 1e15,                           \
                    "Seed of that noise. Default: 1.")

/* What they do nothing without, among the verb's partners. */
#define CLI_SAMPLE_PARTNERS "resolution:sample: noise:sample: sample-seed:sample:"

cli_input_options cli_source_options(const cli_source *source);

/* Whether the word names a built-in sample; then *name (may be NULL) is its name. */
bool cli_is_sample(const char *word, const char **name);

/* From here on --quiet and --unit count: without -u, what scree wrote is in the unit that it wrote
 * into it. */
void cli_input_obeys(const cli_common *common);
/* "word: sentence" on stderr, unless it is to be quiet. */
void cli_remark(const char *word, const char *format, ...) SCREE_PRINTF(2, 3);
/* The same where a size (m) whose unit nobody may have named is as of a wrong one; hint: how it is
 * named. */
void cli_remark_size(const char *word, double size, const char *hint);
/* One line more in a text of so many bytes. */
void cli_add_line(char *text, size_t size, const char *format, ...) SCREE_PRINTF(3, 4);
/* Lines where the file contradicts itself, says another unit than the options, or is of a size
 * that no particle has; positions are in metres once they are multiplied by scale. */
void cli_scan_remarks(const cli_input_options *options, const scree_scan *scan, double scale,
                      char *text, size_t size);
/* The same on stderr, with the word before each. */
void cli_remark_scan(const char *word, const cli_input_options *options, const scree_scan *scan,
                     double scale);
/* Reads or makes the surface, and remarks on it; a sample's format is "sample", its checksum zero.
 * Free with scree_scan_free. */
scree_status cli_load(const char *word, const cli_input_options *options,
                      const scree_progress *progress, scree_scan *scan, scree_error *error);

/* ", coordinates in mm" of a file; nothing of a sample, or where the unit has no name. */
void cli_print_unit(FILE *stream, const char *word, const scree_scan *scan);

/* The word without folders and ending, or the sample's name, into buffer; "stdin" for "-". */
void cli_short_name(const char *word, char *buffer, size_t size);
/* The same into the name after `before` others that lie `stride` bytes apart, the first at `names`,
 * each of `size` bytes: of equal ones come name, name-2, name-3. */
void cli_distinct_name(const char *word, char *names, size_t stride, size_t before, size_t size);
/* UTF-8 text as a cell of a table: of at least and at most so many characters. What is longer has a
 * ~ in its middle, for names are told apart by their beginnings or their ends. */
void cli_print_cell(FILE *stream, const char *text, size_t least, size_t most);
