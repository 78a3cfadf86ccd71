/* The files of `choose -o DIR`:
 *
 *   NAME.stl             the chosen mesh of each object
 *   NAME.mass.json       its mass, centre and inertia, as `scree export` writes them
 *   set/NAME.stl         its mesh at the set's Rp, where there are several objects
 *   set/NAME.mass.json
 *   NAME.curve.csv       its dense curve
 *   choice.txt           what is printed
 *   choice.json, choice.csv
 *   figure.png, .svg, .pdf, .csv, .gnuplot
 *   provenance.json      when, where, how long
 *   levels/NAME.levels   what the report shows of each object in 3D
 *   report.html          all of it as one page, as `scree report DIR` makes it
 *
 * They are written into another folder and moved when all are there: who cancels finds none. */
#include "cli/choose.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const FIGURES[] = {"figure.png", "figure.svg", "figure.pdf", "figure.csv",
                                      "figure.gnuplot"};
enum { FIGURE_COUNT = 5 };
static const char *const SINGLE_FILES[] = {"choice.csv", "choice.txt", "provenance.json",
                                           "choice.json", "report.html"};
enum { SINGLE_FILE_COUNT = 5 };
static const char *const SUBFOLDERS[] = {"levels", "set"};

/* FOLDER/before name after */
static scree_status join_in(const char *folder, const char *before, const char *name,
                            const char *after, char path[CHOOSE_PATH_BYTES], scree_error *error) {
  int length = snprintf(path, CHOOSE_PATH_BYTES, "%s/%s%s%s", folder, before, name, after);
  if (length < CHOOSE_PATH_BYTES) return SCREE_OK;
  return cli_refuse(error, SCREE_LIMIT, folder, "the path is too long");
}

/* The same where it is written. */
static scree_status join(const choose_run *run, const char *before, const char *name,
                         const char *after, char path[CHOOSE_PATH_BYTES], scree_error *error) {
  return join_in(run->stage.path, before, name, after, path, error);
}

/* ---- from where it is written to where it was asked for ---- */

typedef scree_status visit_file(const choose_run *run, const char *before, const char *name,
                                const char *after, scree_error *error);

static scree_status check_file(const choose_run *run, const char *before, const char *name,
                               const char *after, scree_error *error) {
  char path[CHOOSE_PATH_BYTES];
  scree_status status = join_in(run->arguments->output, before, name, after, path, error);
  return status == SCREE_OK ? cli_check_output(run->call, path, run->arguments->overwrite, error)
                            : status;
}

static scree_status move_file(const choose_run *run, const char *before, const char *name,
                              const char *after, scree_error *error) {
  char from[CHOOSE_PATH_BYTES], to[CHOOSE_PATH_BYTES];
  scree_status status = join(run, before, name, after, from, error);
  if (status == SCREE_OK) status = join_in(run->arguments->output, before, name, after, to, error);
  if (status == SCREE_OK && rename(from, to) != 0)
    status = cli_refuse(error, SCREE_IO, to, strerror(errno));
  return status;
}

/* All files; those that a finished choice is known by come last. */
static scree_status visit_files(const choose_run *run, visit_file *visit, scree_error *error) {
  static const char *const MESH_FILES[] = {".stl", ".mass.json"};
  scree_status status = SCREE_OK;
  for (int i = 0; i < FIGURE_COUNT && status == SCREE_OK; i++)
    status = visit(run, "", FIGURES[i], "", error);
  for (size_t i = 0; i < run->count && status == SCREE_OK; i++) {
    const char *name = run->objects[i].name;
    for (int k = 0; k < 2 && status == SCREE_OK; k++) {
      status = visit(run, "", name, MESH_FILES[k], error);
      if (status == SCREE_OK && run->count > 1)
        status = visit(run, "set/", name, MESH_FILES[k], error);
    }
    if (status == SCREE_OK) status = visit(run, "", name, ".curve.csv", error);
    if (status == SCREE_OK) status = visit(run, "levels/", name, ".levels", error);
  }
  for (int i = 0; i < SINGLE_FILE_COUNT && status == SCREE_OK; i++)
    status = visit(run, "", SINGLE_FILES[i], "", error);
  return status;
}

static scree_status make_subfolders(const choose_run *run, const char *folder, scree_error *error) {
  char path[CHOOSE_PATH_BYTES];
  scree_status status = SCREE_OK;
  for (int i = 0; i < (run->count > 1 ? 2 : 1) && status == SCREE_OK; i++) {
    status = join_in(folder, SUBFOLDERS[i], "", "", path, error);
    if (status == SCREE_OK) status = cli_make_folder(path, error);
  }
  return status;
}

scree_status choose_prepare_folder(choose_run *run, scree_error *error) {
  scree_status status = cli_stage_open(run->arguments->output, &run->stage, error);
  if (status == SCREE_OK && run->stage.existed) {
    status = make_subfolders(run, run->arguments->output, error);
    if (status == SCREE_OK) status = visit_files(run, check_file, error);
  }
  return status == SCREE_OK ? make_subfolders(run, run->stage.path, error) : status;
}

/* A file that came into the folder meanwhile is spared, unless it may be overwritten. */
static scree_status put_in_place(choose_run *run, scree_error *error) {
  if (!cli_terminal_settle())
    return cli_refuse(error, SCREE_CANCELLED, run->arguments->output, "cancelled while writing");
  char empty[CHOOSE_PATH_BYTES];
  if (run->count == 1 && join(run, "set", "", "", empty, error) == SCREE_OK)
    (void)rmdir(empty); /* the others failed */
  if (!run->stage.existed) return cli_stage_rename(&run->stage, error);
  scree_status status = visit_files(run, check_file, error);
  return status == SCREE_OK ? visit_files(run, move_file, error) : status;
}

/* ---- the files ---- */

/* One level of object `index` into `before`: path gets the mesh's, what it weighs lies beside it.
 */
static scree_status write_level(const choose_run *run, size_t index, const scree_curve *curve,
                                size_t level_index, const char *before,
                                char path[CHOOSE_PATH_BYTES], scree_error *error) {
  const choose_object *object = &run->objects[index];
  scree_export_options options = scree_default_export_options();
  char mass_path[CHOOSE_PATH_BYTES];
  scree_mesh mesh = {0};
  options.density = run->arguments->density;
  options.unit_m = run->arguments->source.unit;
  options.overwrite = run->arguments->overwrite;
  options.source = object->word;
  options.command_line = run->call->command_line;
  options.checksum = object->checksum;
  scree_status status = join(run, before, object->name, ".stl", path, error);
  if (status == SCREE_OK) status = join(run, before, object->name, ".mass.json", mass_path, error);
  if (status == SCREE_OK) status = scree_curve_mesh(curve, level_index, &mesh, error);
  if (status == SCREE_OK)
    status = cli_check_rounded(&mesh, path, options.unit_m, NULL, NULL, error);
  if (status == SCREE_OK)
    status = scree_particle_export(&mesh, &options, path, mass_path, NULL, error);
  double lost = cli_volume_lost(&mesh, path, options.unit_m);
  size_t used = strlen(object->note);
  if (status == SCREE_OK && lost >= CLI_NOTABLE_LOSS && !strstr(object->note, "single precision"))
    snprintf(run->objects[index].note + used, sizeof object->note - used,
             "%san STL's single precision changes the volume by %.2g of it", used ? "; " : "",
             lost);
  scree_mesh_free(&mesh);
  return status;
}

scree_status choose_write_meshes(const choose_run *run, size_t index, const scree_curve *curve,
                                 const scree_choice *choice, const scree_set_choice *set,
                                 scree_error *error) {
  choose_object *object = &run->objects[index];
  size_t level = choose_default_pick(run, choice)->level_index;
  char path[CHOOSE_PATH_BYTES];
  scree_status status = write_level(run, index, curve, level, "", path, error);
  if (status == SCREE_OK)
    status = join_in(run->arguments->output, "", object->name, ".stl", object->mesh_path, error);
  if (status == SCREE_OK) status = join(run, "levels/", object->name, ".levels", path, error);
  if (status == SCREE_OK)
    status = scree_levels_write(curve, choice, SCREE_LEVELS_BYTES / run->left, path,
                                run->arguments->overwrite, error);
  if (status != SCREE_OK || run->left < 2) return status;
  double rp = choose_default_set_pick(run, set)->rp;
  level = scree_curve_find(curve, scree_choice_target(rp, choice->triangle_count));
  return write_level(run, index, curve, level, "set/", path, error);
}

/* choice.txt: what choose_print says. */
static scree_status write_text(const choose_run *run, scree_error *error) {
  char *text = NULL, path[CHOOSE_PATH_BYTES];
  size_t size;
  scree_status status = join(run, "", "choice.txt", "", path, error);
  if (status != SCREE_OK) return status;
  FILE *stream = open_memstream(&text, &size);
  if (stream) choose_print(stream, run);
  if (!stream || fclose(stream) != 0)
    status = cli_refuse(error, SCREE_OUT_OF_MEMORY, path, "out of memory");
  else
    status = scree_text_write(text, path, run->arguments->overwrite, error);
  free(text);
  return status;
}

/* What is made of the other files, so the last. */
static scree_status write_page(const choose_run *run, scree_error *error) {
  char path[CHOOSE_PATH_BYTES];
  bool overwrite = run->arguments->overwrite;
  scree_status status = write_text(run, error);
  if (status == SCREE_OK) status = join(run, "", "provenance.json", "", path, error);
  if (status == SCREE_OK)
    status = scree_provenance_write(&run->start, run->call->command_line, path, overwrite, error);
  if (status == SCREE_OK) status = join(run, "", "report.html", "", path, error);
  if (status == SCREE_OK)
    status =
        scree_page_write_named(run->stage.path, run->arguments->output, path, overwrite, error);
  return status;
}

scree_status choose_write_reports(choose_run *run, const scree_choice_report *report,
                                  scree_error *error) {
  bool overwrite = run->arguments->overwrite;
  char path[CHOOSE_PATH_BYTES];
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < run->count && status == SCREE_OK; i++) {
    status = join(run, "", run->objects[i].name, ".curve.csv", path, error);
    if (status == SCREE_OK)
      status = scree_choice_curve_csv_write(&report->entries[i], path, overwrite, error);
  }
  for (int i = 0; i < FIGURE_COUNT && status == SCREE_OK; i++) {
    status = join(run, "", FIGURES[i], "", path, error);
    if (status == SCREE_OK) status = scree_choice_figure_write(report, path, overwrite, error);
  }
  if (status == SCREE_OK) status = join(run, "", "choice.csv", "", path, error);
  if (status == SCREE_OK) status = scree_choice_csv_write(report, path, overwrite, error);
  if (status == SCREE_OK) status = join(run, "", "choice.json", "", path, error);
  if (status == SCREE_OK) status = scree_choice_json_write(report, path, overwrite, error);
  if (status == SCREE_OK) status = write_page(run, error);
  return status == SCREE_OK ? put_in_place(run, error) : status;
}
