/* What `scree clump` works with, and the files it leaves. */
#pragma once

#include "cli/clump_surface.h"
#include "report/program.h"
#include "report/provenance.h"

typedef struct clump_arguments {
  cli_source source;
  const char *output;
  size_t count, most, triangles;
  double tolerance, outside, ratio, angle;
  int method;
  bool inside, no_repair, json, csv, overwrite;
} clump_arguments;

enum { CLUMP_NAME_BYTES = 256, CLUMP_PATH_BYTES = 4096 };

typedef struct clump_object {
  const char *word;
  char name[CLUMP_NAME_BYTES], file[CLUMP_PATH_BYTES];
  cli_clump_surface surface;
  size_t mesh_count; /* triangles of the mesh to take instead; 0: spheres will do */
  bool made;         /* the clumps */
  scree_clumps clumps;
  const scree_clump *chosen;
} clump_object;

typedef struct clump_run {
  const cli_call *call;
  scree_work_start start;
  clump_object *objects;
  size_t count;
} clump_run;

/* Names from the inputs' words; of the same name in several folders: name, name-2, name-3. */
void clump_name_objects(clump_run *run);

/* What will be written, before any work. */
scree_status clump_check_files(const clump_run *run, scree_error *error);

/* All objects as the report wants them. Free with clump_report_free. */
scree_status clump_report_make(const clump_run *run, scree_clump_report *report,
                               scree_error *error);
void clump_report_free(scree_clump_report *report);

scree_status clump_write_files(clump_run *run, const scree_clump_report *report,
                               scree_error *error);

/* The answer for people. */
void clump_print(FILE *out, const clump_run *run);
