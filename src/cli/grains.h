/* The shapes of runs: scans, samples and clumps at one or several Rp, and as spheres. */
#ifndef SCREE_CLI_GRAINS_H
#define SCREE_CLI_GRAINS_H

#include "cli/input.h"

enum { CLI_MOST_LEVELS = 40, CLI_LARGEST_GRAIN = 100000 };
#define CLI_RECOMMENDED 0.0 /* in place of an Rp: the one that `scree choose` recommends */

typedef struct cli_grain_options {
  cli_source source;
  int method;     /* a scree_method */
  bool no_repair; /* refuse instead */
  bool quiet;     /* do not say which level is taken where none was asked for */
  scree_mass_rule mass_rule;
  double rp[CLI_MOST_LEVELS];
  size_t clump[CLI_MOST_LEVELS]; /* spheres of the clump that stands for the shape there; 0: none */
  size_t rp_count;               /* 0: surfaces as they are; dense ones as recommended */
  bool spheres;                  /* one level more, the last, of equal-volume spheres */
} cli_grain_options;

/* Every shape at every level. */
typedef struct cli_grains {
  size_t shape_count, level_count;
  scree_grain *grains;     /* level_count rows of shape_count */
  scree_run_shape *shapes; /* the same, ready for a run, with name and source */
  char (*texts)[320];      /* what names and sources point to */
} cli_grains;

/* "1e-5,recommended,clump:20" into options; false where it is none, or too long. */
bool cli_parse_levels(const char *text, cli_grain_options *options);

size_t cli_level_count(const cli_grain_options *options);

/* The level in words, for folders and tables: "rp-1e-05", "recommended", "clump-20", "spheres",
 * "as-given". */
void cli_level_name(const cli_grain_options *options, size_t level, char *buffer, size_t size);

/* Loads, checks, repairs, decimates. words: files, sample:NAME, or NAME.csv with one sphere of a
 * clump a line (x, y, z, radius, in the files' unit), which is the same at every level but that of
 * spheres. Free with cli_grains_free. */
scree_status cli_make_grains(const char *const *words, size_t count,
                             const cli_grain_options *options, const scree_progress *progress,
                             cli_grains *grains, scree_error *error);
void cli_grains_free(cli_grains *grains);

#endif
