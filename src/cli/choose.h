/* What the files of the verb `choose` share. */
#pragma once

#include "cli/args.h"
#include "cli/input.h"
#include "cli/output.h"
#include "report/program.h"
#include "report/provenance.h"

enum { CHOOSE_NAME_BYTES = 128, CHOOSE_NOTE_BYTES = 1536, CHOOSE_PATH_BYTES = 4096 };

typedef struct choose_arguments {
  const char *output, *grid, *tolerance;
  cli_source source;
  double weight, density;
  int method, reference, rule;
  bool samples, paper, errors, json, csv, no_repair, keep_handles, overwrite;
} choose_arguments;

/* One object from its word on the command line to its files. */
typedef struct choose_object {
  const char *word;
  char name[CHOOSE_NAME_BYTES]; /* unique among the objects */
  char format[32];
  double unit_m;                /* of the file: as asked for, or as it states */
  char note[CHOOSE_NOTE_BYTES]; /* what was repaired or is wrong, a sentence a line */
  char mesh_path[CHOOSE_PATH_BYTES];
  scree_checksum checksum;
  bool failed;
} choose_object;

typedef struct choose_run {
  const cli_call *call;
  const choose_arguments *arguments;
  choose_object *objects;
  scree_choice *choices;
  size_t count, left;  /* objects; those that did not fail, which alone are counted in the end */
  size_t failed_count; /* in the end, behind them */
  cli_stage stage;     /* of the output's folder, while it is written */
  scree_set_choice set;
  scree_choice_options options;
  scree_simplify_options simplify;
  scree_work_start start;
  scree_choice_report report;   /* in the end */
  char note[CHOOSE_NOTE_BYTES]; /* what is to be said of all */
} choose_run;

/* The run whose member it is. */
static inline const choose_run *choose_run_of(const void *report) {
  return (const choose_run *)((const char *)report - offsetof(choose_run, report));
}

/* What to do, for people: a dozen lines, or the whole of it. */
void choose_print(FILE *out, const choose_run *run, bool whole);
/* All that is worth a warning, a line each. */
void choose_print_warnings(FILE *out, const choose_run *run);

/* The figure's file, the first of its kinds that this build writes. */
const char *choose_first_figure(void);

/* Refuses early where a file that will be written exists; makes the folder to write into. */
scree_status choose_prepare_folder(choose_run *run, scree_error *error);
/* The meshes of one object, and its levels for the report. */
scree_status choose_write_meshes(const choose_run *run, size_t index, const scree_curve *curve,
                                 const scree_choice *choice, const scree_set_choice *set,
                                 scree_error *error);
/* Everything else: curves, figure, tables, the page. Then all of it is put where it was asked for,
 * or nothing where the call was cancelled before. */
scree_status choose_write_reports(choose_run *run, scree_error *error);
