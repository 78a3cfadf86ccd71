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
 * They are written into another folder and moved when all are there: who cancels finds none. What
 * an earlier choice left in the folder and this one has not goes with it, before the answer is
 * moved. */
#include "base/file.h"
#include "base/platform.h"
#include "cli/choose.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"
#include "report/provenance.h"

#include <errno.h>
#include <string.h>

static const char *const FIGURES[] = {"figure.png", "figure.svg", "figure.pdf", "figure.csv",
                                      "figure.gnuplot"};
enum { PICTURE_COUNT = 3, FIGURE_COUNT = 5 };
static const char *const SINGLE_FILES[] = {"choice.csv", "choice.txt", "provenance.json",
                                           "choice.json", "report.html"};
enum { SINGLE_FILE_COUNT = 5 };
static const char *const SUBFOLDERS[] = {"levels", "set"};
/* What each object has, and how each such file begins. */
static const struct {
  const char *before, *after, *begin;
} OBJECT_FILES[] = {{"", ".stl", "scree "},
                    {"set/", ".stl", "scree "},
                    {"", ".mass.json", "{\n  \"mesh_file\": "},
                    {"set/", ".mass.json", "{\n  \"mesh_file\": "},
                    {"", ".curve.csv", "rp,triangle_count,"},
                    {"levels/", ".levels", "screeLVL"}};
enum { LEVELS_FILE = 5, OBJECT_FILE_COUNT };

static scree_status join_in(const char *folder, const char *before, const char *name,
                            const char *after, char path[CHOOSE_PATH_BYTES], scree_error *error) {
  return cli_join_path(folder, before, name, after, path, CHOOSE_PATH_BYTES, error);
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
  SCREE_TRY(join_in(run->arguments->output, before, name, after, path, error));
  return cli_check_output(run->call, path, run->arguments->overwrite, error);
}

static scree_status move_file(const choose_run *run, const char *before, const char *name,
                              const char *after, scree_error *error) {
  char from[CHOOSE_PATH_BYTES], to[CHOOSE_PATH_BYTES];
  SCREE_TRY(join(run, before, name, after, from, error));
  SCREE_TRY(join_in(run->arguments->output, before, name, after, to, error));
  if (!scree_path_rename(from, to)) return cli_refuse(error, SCREE_IO, to, strerror(errno));
  return SCREE_OK;
}

/* A build without pictures leaves out those that come first. */
static int first_figure(void) {
  return scree_build_has(SCREE_BUILD_PICTURES) ? 0 : PICTURE_COUNT;
}

const char *choose_first_figure(void) {
  return FIGURES[first_figure()];
}

static bool in_set(const char *before) {
  return !strcmp(before, "set/");
}

/* All files but those that a finished choice is known by. */
static scree_status visit_parts(const choose_run *run, visit_file *visit, scree_error *error) {
  scree_status status = SCREE_OK;
  for (int i = first_figure(); i < FIGURE_COUNT && status == SCREE_OK; i++)
    status = visit(run, "", FIGURES[i], "", error);
  for (size_t i = 0; i < run->count; i++)
    for (int k = 0; k < OBJECT_FILE_COUNT && status == SCREE_OK; k++)
      if (run->count > 1 || !in_set(OBJECT_FILES[k].before))
        status =
            visit(run, OBJECT_FILES[k].before, run->objects[i].name, OBJECT_FILES[k].after, error);
  return status;
}

static scree_status visit_answer(const choose_run *run, visit_file *visit, scree_error *error) {
  for (int i = 0; i < SINGLE_FILE_COUNT; i++) SCREE_TRY(visit(run, "", SINGLE_FILES[i], "", error));
  return SCREE_OK;
}

/* ---- what an earlier choice left ---- */

static bool begins_with(const char *path, const char *text) {
  char start[32];
  size_t length = strlen(text);
  FILE *file = scree_open_stream(path, "rb");
  bool same = file && fread(start, 1, length, file) == length && !memcmp(start, text, length);
  if (file) fclose(file);
  return same;
}

static bool has_object(const choose_run *run, const char *name) {
  for (size_t i = 0; i < run->count; i++)
    if (!strcmp(run->objects[i].name, name)) return true;
  return false;
}

/* The files of one object of an earlier choice that this one does not write. */
static scree_status visit_stale(const choose_run *run, const char *name, visit_file *visit,
                                scree_error *error) {
  char path[CHOOSE_PATH_BYTES];
  bool stays = has_object(run, name);
  for (int k = 0; k < OBJECT_FILE_COUNT; k++) {
    const char *before = OBJECT_FILES[k].before, *after = OBJECT_FILES[k].after;
    if (stays && (run->count > 1 || !in_set(before))) continue;
    SCREE_TRY(join_in(run->arguments->output, before, name, after, path, error));
    if (begins_with(path, OBJECT_FILES[k].begin)) SCREE_TRY(visit(run, before, name, after, error));
  }
  return SCREE_OK;
}

/* Objects of earlier choices are known by their levels, which nothing else writes. */
static scree_status visit_earlier(const choose_run *run, visit_file *visit, scree_error *error) {
  static const char ending[] = ".levels";
  char path[CHOOSE_PATH_BYTES], name[CHOOSE_PATH_BYTES];
  scree_status status = join_in(run->arguments->output, "levels", "", "", path, error);
  scree_folder *entries = status == SCREE_OK ? scree_folder_open(path) : NULL;
  for (const char *found; status == SCREE_OK && entries && (found = scree_folder_next(entries));) {
    size_t length = strlen(found), end = sizeof ending - 1;
    if (length <= end || strcmp(found + length - end, ending) != 0) continue;
    status = join_in(path, found, "", "", name, error);
    if (status != SCREE_OK || !begins_with(name, OBJECT_FILES[LEVELS_FILE].begin)) continue;
    snprintf(name, sizeof name, "%.*s", (int)(length - end), found);
    status = visit_stale(run, name, visit, error);
  }
  if (entries) scree_folder_close(entries);
  return status;
}

static scree_status remove_file(const choose_run *run, const char *before, const char *name,
                                const char *after, scree_error *error) {
  char path[CHOOSE_PATH_BYTES];
  SCREE_TRY(join_in(run->arguments->output, before, name, after, path, error));
  if (!scree_path_remove(path)) return cli_refuse(error, SCREE_IO, path, strerror(errno));
  if (in_set(before)) {
    SCREE_TRY(join_in(run->arguments->output, before, "", "", path, error));
    (void)scree_folder_remove(path); /* where it was the last */
  }
  return SCREE_OK;
}

static scree_status check_files(const choose_run *run, scree_error *error) {
  SCREE_TRY(visit_parts(run, check_file, error));
  SCREE_TRY(visit_answer(run, check_file, error));
  if (run->arguments->overwrite) SCREE_TRY(visit_earlier(run, check_file, error));
  return SCREE_OK;
}

static scree_status move_files(const choose_run *run, scree_error *error) {
  SCREE_TRY(visit_parts(run, move_file, error));
  if (run->arguments->overwrite) SCREE_TRY(visit_earlier(run, remove_file, error));
  return visit_answer(run, move_file, error);
}

static scree_status make_subfolders(const choose_run *run, const char *folder, scree_error *error) {
  char path[CHOOSE_PATH_BYTES];
  for (int i = 0; i < (run->count > 1 ? 2 : 1); i++) {
    SCREE_TRY(join_in(folder, SUBFOLDERS[i], "", "", path, error));
    SCREE_TRY(cli_make_folder(path, error));
  }
  return SCREE_OK;
}

scree_status choose_prepare_folder(choose_run *run, scree_error *error) {
  SCREE_TRY(cli_stage_open(run->arguments->output, &run->stage, error));
  if (run->stage.existed) {
    SCREE_TRY(make_subfolders(run, run->arguments->output, error));
    SCREE_TRY(check_files(run, error));
  }
  return make_subfolders(run, run->stage.path, error);
}

/* A file that came into the folder meanwhile is spared, unless it may be overwritten. */
static scree_status put_in_place(choose_run *run, scree_error *error) {
  if (!cli_terminal_settle())
    return cli_refuse(error, SCREE_CANCELLED, run->arguments->output, "cancelled while writing");
  char empty[CHOOSE_PATH_BYTES];
  if (run->count == 1 && join(run, "set", "", "", empty, error) == SCREE_OK)
    (void)scree_folder_remove(empty); /* the others failed */
  if (!run->stage.existed) return cli_stage_rename(&run->stage, error);
  SCREE_TRY(check_files(run, error));
  return move_files(run, error);
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
  if (status == SCREE_OK && lost >= CLI_NOTABLE_LOSS && !strstr(object->note, "single precision"))
    cli_add_line(run->objects[index].note, sizeof object->note,
                 "An STL's single precision changes the volume by %.2g of it.", lost);
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
  char path[CHOOSE_PATH_BYTES];
  scree_output output;
  SCREE_TRY(join(run, "", "choice.txt", "", path, error));
  SCREE_TRY(scree_output_open(path, run->arguments->overwrite, &output, error));
  choose_print(output.stream, run);
  return scree_output_commit(&output, error);
}

/* What is made of the other files, so the last. */
static scree_status write_page(const choose_run *run, scree_error *error) {
  char path[CHOOSE_PATH_BYTES];
  bool overwrite = run->arguments->overwrite;
  SCREE_TRY(write_text(run, error));
  SCREE_TRY(join(run, "", "provenance.json", "", path, error));
  SCREE_TRY(scree_provenance_write(&run->start, run->call->command_line, path, overwrite, error));
  SCREE_TRY(join(run, "", "report.html", "", path, error));
  return scree_page_write_named(run->stage.path, run->arguments->output, path, overwrite, error);
}

scree_status choose_write_reports(choose_run *run, const scree_choice_report *report,
                                  scree_error *error) {
  bool overwrite = run->arguments->overwrite;
  char path[CHOOSE_PATH_BYTES];
  for (size_t i = 0; i < run->count; i++) {
    SCREE_TRY(join(run, "", run->objects[i].name, ".curve.csv", path, error));
    SCREE_TRY(scree_choice_curve_csv_write(&report->entries[i], path, overwrite, error));
  }
  for (int i = first_figure(); i < FIGURE_COUNT; i++) {
    SCREE_TRY(join(run, "", FIGURES[i], "", path, error));
    SCREE_TRY(scree_choice_figure_write(report, path, overwrite, error));
  }
  SCREE_TRY(join(run, "", "choice.csv", "", path, error));
  SCREE_TRY(scree_choice_csv_write(report, path, overwrite, error));
  SCREE_TRY(join(run, "", "choice.json", "", path, error));
  SCREE_TRY(scree_choice_json_write(report, path, overwrite, error));
  SCREE_TRY(write_page(run, error));
  return put_in_place(run, error);
}
