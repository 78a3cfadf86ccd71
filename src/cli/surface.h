/* Surfaces that are checked and repaired before use, and what check and repair say about one. */
#pragma once

#include "cli/input.h"

/* cli_load, and what is no closed surface is repaired, or with no_repair refused; of samples, which
 * are made closed, short handles alone are cut. Errors name the word. scale is NULL where the
 * surface is not decimated; else it is in metres only once it is multiplied by *scale, as
 * scree_curve_build_scaled does, because levels must not hang on the unit. report is in metres, and
 * may be NULL. */
scree_status cli_load_closed(const char *word, const cli_input_options *options, bool no_repair,
                             const scree_progress *progress, scree_scan *scan, double *scale,
                             scree_repair_report *report, scree_error *error);

/* Into metres what cli_load_closed gave with a scale and is not decimated after all: read anew, but
 * for stdin, because a second multiplication may miss the numbers of the file by rounding. */
scree_status cli_into_metres(const char *word, const cli_input_options *options, bool no_repair,
                             double scale, const scree_progress *progress, scree_mesh *mesh,
                             scree_error *error);

/* How a scan comes to be what a decimation may assume, as a member of a verb's struct. */
typedef struct cli_soundness {
  bool no_repair, unchecked, keep_handles;
} cli_soundness;

#define CLI_KEEP_HANDLES_ROW(member)                                                               \
  CLI_FLAG_ROW("keep-handles", member,                                                             \
               "Leave handles round which a loop of six mean edges or less leads: slots that the " \
               "scan's net has bridged, which cannot be decimated away.")

/* Their rows in the option table of a verb whose struct has the member `soundness`; they exclude
 * each other. */
#define CLI_SOUNDNESS_OPTIONS                                                                      \
  CLI_FLAG_ROW("no-repair", soundness.no_repair,                                                   \
               "Refuse a scan that is no closed surface instead of repairing it."),                \
      CLI_FLAG_ROW("unchecked", soundness.unchecked,                                               \
                   "Take the scan as it is, neither checked nor repaired: an open surface stays "  \
                   "open, and what meets itself may go on doing so."),                             \
      CLI_KEEP_HANDLES_ROW(soundness.keep_handles)
#define CLI_SOUNDNESS_EXCLUSIVE "no-repair|unchecked"

/* The call's first input as the options ask, as cli_load_closed gives it; repairs are said on
 * stderr, unless it is quiet. */
scree_status cli_load_for_levels(const cli_call *call, const cli_source *source,
                                 const cli_soundness *how, scree_scan *scan, double *scale,
                                 scree_error *error);

/* The level that `scree choose` recommends of a curve of the mesh. */
scree_status cli_recommended_level(scree_curve *curve, const scree_mesh *mesh,
                                   const scree_progress *progress, size_t *level,
                                   scree_error *error);

/* Where the repair of the word failed for what an option allows: the command, at the end of the
 * error. */
void cli_hint_at_option(const char *word, const scree_repair_report *report,
                        const scree_repair_options *options, scree_error *error);

/* The facets that reading left out, where there were any. */
void cli_print_left_out(FILE *stream, size_t count);
/* The size, the counts that are not 0, a line each, and the volume. */
void cli_print_check(FILE *stream, const scree_check *check);
/* "repaired: 3 holes filled, ..." of a surface that needed it, else "". */
void cli_repair_text(const scree_repair_report *report, char *buffer, size_t size);
/* The bodies of the repaired surface: outward shells that nothing holds together. */
size_t cli_body_count(const scree_repair_report *report);
/* What was done, a line each; "nothing" where nothing was. */
void cli_print_repair(FILE *stream, const scree_repair_report *report);

/* A file of single precision, as STL is, may not hold what is sound in double: SCREE_BAD_MESH where
 * the mesh, read from the file that the path will name, would no longer pass the check. "-" is an
 * STL. how may be NULL. */
scree_status cli_check_rounded(const scree_mesh *mesh, const char *path, double unit,
                               const scree_check_options *how, const scree_progress *progress,
                               scree_error *error);

/* What single precision, if the file that the path will name has that, takes from the volume or
 * adds to it, relative; of a mesh far from the origin it is much. */
double cli_volume_lost(const scree_mesh *mesh, const char *path, double unit);
/* From here on it is said: scans are no more exact than that. */
#define CLI_NOTABLE_LOSS 1e-6
/* So is what a repair changes the volume by. */
#define CLI_NOTABLE_CHANGE 1e-3

/* Surfaces that clumps are fitted to. */
typedef struct cli_clump_surface {
  size_t triangles; /* at most so many */
  bool no_repair;   /* refuse instead */
  /* What cli_load_for_clump fills. */
  scree_mesh mesh; /* m; free with scree_mesh_free */
  char note[1024]; /* what was repaired; "" */
  char format[sizeof((scree_scan *)0)->format];
  double unit_m;
  scree_checksum checksum;
  size_t scan_triangle_count;
} cli_clump_surface;

static inline void cli_clump_surface_free(cli_clump_surface *surface) {
  scree_mesh_free(&surface->mesh);
}

/* Loads, checks, repairs and decimates. Errors name the word. */
scree_status cli_load_for_clump(const char *word, const cli_input_options *input,
                                const scree_progress *progress, cli_clump_surface *surface,
                                scree_error *error);
