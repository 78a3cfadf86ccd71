#include "cli/clump_files.h"
#include "report/program.h"

#include "base/file.h"
#include "cli/output.h"
#include "report/provenance.h"

#include <stdlib.h>

static const char *const figures[] = {"clump.png", "clump.svg", "clump.pdf"};
static const char *const others[] = {"clump.json", "clump.csv", "clump.txt", "provenance.json",
                                     "report.html"};
enum { FIGURE_COUNT = 3, OTHER_COUNT = 5 };

/* A build without pictures has no figures. */
static int figure_count(void) {
  return scree_build_has(SCREE_BUILD_PICTURES) ? FIGURE_COUNT : 0;
}

void clump_name_objects(clump_run *run) {
  for (size_t i = 0; i < run->count; i++) {
    run->objects[i].word = run->call->inputs[i];
    cli_distinct_name(run->objects[i].word, run->objects[0].name, sizeof *run->objects, i,
                      CLUMP_NAME_BYTES);
  }
}

static scree_status join(const clump_run *run, const char *name, const char *ending,
                         char path[CLUMP_PATH_BYTES], scree_error *error) {
  const clump_arguments *a = run->call->options;
  return cli_join_path(a->output, "", name, ending, path, CLUMP_PATH_BYTES, error);
}

static scree_status check(const clump_run *run, const char *name, const char *ending,
                          scree_error *error) {
  const clump_arguments *a = run->call->options;
  char path[CLUMP_PATH_BYTES];
  SCREE_TRY(join(run, name, ending, path, error));
  return cli_check_output(run->call, path, a->overwrite, error);
}

scree_status clump_check_files(const clump_run *run, scree_error *error) {
  const clump_arguments *a = run->call->options;
  SCREE_TRY(cli_make_folder(a->output, error));
  for (size_t i = 0; i < run->count; i++)
    SCREE_TRY(check(run, run->objects[i].name, ".csv", error));
  for (int i = 0; i < figure_count(); i++) SCREE_TRY(check(run, figures[i], "", error));
  for (int i = 0; i < OTHER_COUNT; i++) SCREE_TRY(check(run, others[i], "", error));
  return SCREE_OK;
}

scree_status clump_report_make(const clump_run *run, scree_clump_report *report,
                               scree_error *error) {
  const clump_arguments *a = run->call->options;
  scree_clump_entry *entries = calloc(run->count, sizeof *entries);
  *report = (scree_clump_report){entries, run->count, run->call->command_line};
  if (!entries)
    return cli_refuse(error, SCREE_OUT_OF_MEMORY, run->objects[0].word, "out of memory");
  for (size_t i = 0; i < run->count; i++) {
    clump_object *o = &run->objects[i];
    if (a->output) snprintf(o->file, sizeof o->file, "%s.csv", o->name);
    entries[i] = (scree_clump_entry){.name = o->name,
                                     .file = o->word,
                                     .format = o->surface.format,
                                     .checksum = o->surface.checksum,
                                     .unit_m = o->surface.unit_m,
                                     .note = o->surface.note[0] ? o->surface.note : NULL,
                                     .scan_triangle_count = o->surface.scan_triangle_count,
                                     .mesh = &o->surface.mesh,
                                     .clumps = &o->clumps,
                                     .chosen = o->chosen,
                                     .clump_file = a->output ? o->file : NULL};
  }
  return SCREE_OK;
}

void clump_report_free(scree_clump_report *report) {
  free((void *)(uintptr_t)report->entries);
  report->entries = NULL;
}

static scree_status write_text(const clump_run *run, scree_error *error) {
  const clump_arguments *a = run->call->options;
  char path[CLUMP_PATH_BYTES];
  scree_output output;
  SCREE_TRY(join(run, "clump.txt", "", path, error));
  SCREE_TRY(scree_output_open(path, a->overwrite, &output, error));
  clump_print(output.stream, run);
  return scree_output_commit(&output, error);
}

scree_status clump_write_files(clump_run *run, const scree_clump_report *report,
                               scree_error *error) {
  const clump_arguments *a = run->call->options;
  char path[CLUMP_PATH_BYTES];
  for (size_t i = 0; i < run->count; i++) {
    const clump_object *o = &run->objects[i];
    SCREE_TRY(join(run, o->name, ".csv", path, error));
    SCREE_TRY(
        scree_spheres_write(&o->clumps, o->chosen, o->surface.unit_m, path, a->overwrite, error));
  }
  for (int i = 0; i < figure_count(); i++) {
    SCREE_TRY(join(run, figures[i], "", path, error));
    SCREE_TRY(scree_clump_figure_write(report, path, a->overwrite, error));
  }
  SCREE_TRY(join(run, "clump.json", "", path, error));
  SCREE_TRY(scree_clump_json_write(report, path, a->overwrite, error));
  SCREE_TRY(join(run, "clump.csv", "", path, error));
  SCREE_TRY(scree_clump_csv_write(report, path, a->overwrite, error));
  SCREE_TRY(write_text(run, error));
  SCREE_TRY(join(run, "provenance.json", "", path, error));
  SCREE_TRY(
      scree_provenance_write(&run->start, run->call->command_line, path, a->overwrite, error));
  SCREE_TRY(join(run, "report.html", "", path, error));
  return scree_page_write_named(a->output, a->output, path, a->overwrite, error);
}
