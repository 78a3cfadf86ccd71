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
#include "base/owned.h"
#include "base/path.h"
#include "base/platform.h"
#include "cli/choose.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"
#include "report/provenance.h"

#include <errno.h>
#include <string.h>

/* choice.txt: what choose_print says. */
static scree_status write_text(const void *report, const char *path, bool overwrite,
                               scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  choose_print(output.stream, choose_run_of(report), true);
  return scree_output_commit(&output, error);
}

static scree_status write_provenance(const void *report, const char *path, bool overwrite,
                                     scree_error *error) {
  const choose_run *run = choose_run_of(report);
  return scree_provenance_write(&run->start, run->call->command_line, path, overwrite, error);
}

static scree_status write_page(const void *report, const char *path, bool overwrite,
                               scree_error *error) {
  const choose_run *run = choose_run_of(report);
  return scree_page_write_named(run->stage.path, run->arguments->output, path, overwrite, error);
}

/* Figures, and then what a finished choice is known by: the page is made of the others. */
static const scree_product PRODUCTS[] = {
    {"figure.png", scree_choice_figure_write},     {"figure.svg", scree_choice_figure_write},
    {"figure.pdf", scree_choice_figure_write},     {"figure.csv", scree_choice_figure_write},
    {"figure.gnuplot", scree_choice_figure_write}, {"choice.csv", scree_choice_csv_write},
    {"choice.json", scree_choice_json_write},      {"choice.txt", write_text},
    {"provenance.json", write_provenance},         {"report.html", write_page}};
enum { FIGURE_COUNT = 5, PRODUCT_COUNT = sizeof PRODUCTS / sizeof *PRODUCTS };
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

const char *choose_first_figure(void) {
  size_t i = 0;
  while (!scree_product_is_made(&PRODUCTS[i])) i++;
  return PRODUCTS[i].name;
}

static bool in_set(const char *before) {
  return !strcmp(before, "set/");
}

static scree_status visit_products(const choose_run *run, size_t begin, size_t end,
                                   visit_file *visit, scree_error *error) {
  for (size_t i = begin; i < end; i++)
    if (scree_product_is_made(&PRODUCTS[i])) SCREE_TRY(visit(run, "", PRODUCTS[i].name, "", error));
  return SCREE_OK;
}

/* All files but those that a finished choice is known by. */
static scree_status visit_parts(const choose_run *run, visit_file *visit, scree_error *error) {
  SCREE_TRY(visit_products(run, 0, FIGURE_COUNT, visit, error));
  for (size_t i = 0; i < run->count; i++)
    for (int k = 0; k < OBJECT_FILE_COUNT; k++)
      if (run->count > 1 || !in_set(OBJECT_FILES[k].before))
        SCREE_TRY(
            visit(run, OBJECT_FILES[k].before, run->objects[i].name, OBJECT_FILES[k].after, error));
  return SCREE_OK;
}

static scree_status visit_answer(const choose_run *run, visit_file *visit, scree_error *error) {
  return visit_products(run, FIGURE_COUNT, PRODUCT_COUNT, visit, error);
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
  SCREE_TRY(join_in(run->arguments->output, "levels", "", "", path, error));
  SCREE_CLEANUP(scree_folder_close_at) scree_folder *entries = scree_folder_open(path);
  for (const char *found; entries && (found = scree_folder_next(entries));) {
    size_t stem = strlen(found) - (sizeof ending - 1);
    if (!scree_ends_with(found, ending) || stem == 0) continue;
    SCREE_TRY(join_in(path, found, "", "", name, error));
    if (!begins_with(name, OBJECT_FILES[LEVELS_FILE].begin)) continue;
    snprintf(name, sizeof name, "%.*s", (int)stem, found);
    SCREE_TRY(visit_stale(run, name, visit, error));
  }
  return SCREE_OK;
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
    SCREE_TRY(cli_lock_folder(run->arguments->output, error));
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

/* One level of object `index` into `before`, and what it weighs beside it. */
static scree_status write_level(const choose_run *run, size_t index, const scree_curve *curve,
                                size_t level_index, const char *before, scree_error *error) {
  choose_object *object = &run->objects[index];
  scree_export_options options = scree_default_export_options();
  char path[CHOOSE_PATH_BYTES], mass_path[CHOOSE_PATH_BYTES];
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  options.density = run->arguments->density;
  options.unit_m = run->arguments->source.unit;
  options.overwrite = run->arguments->overwrite;
  options.source = object->word;
  options.command_line = run->call->command_line;
  options.checksum = object->checksum;
  SCREE_TRY(join(run, before, object->name, ".stl", path, error));
  SCREE_TRY(join(run, before, object->name, ".mass.json", mass_path, error));
  SCREE_TRY(scree_curve_mesh(curve, level_index, &mesh, error));
  SCREE_TRY(cli_check_rounded(&mesh, path, options.unit_m, NULL, NULL, error));
  SCREE_TRY(scree_particle_export(&mesh, &options, path, mass_path, NULL, error));
  double lost = cli_volume_lost(&mesh, path, options.unit_m);
  if (lost >= CLI_NOTABLE_LOSS && !strstr(object->note, "single precision"))
    cli_add_line(object->note, sizeof object->note,
                 "An STL's single precision changes the volume by %.2g of it.", lost);
  return SCREE_OK;
}

scree_status choose_write_meshes(const choose_run *run, size_t index, const scree_curve *curve,
                                 const scree_choice *choice, const scree_set_choice *set,
                                 scree_error *error) {
  choose_object *object = &run->objects[index];
  size_t level = scree_choice_pick(choice, run->report.rule)->level_index;
  char path[CHOOSE_PATH_BYTES];
  SCREE_TRY(write_level(run, index, curve, level, "", error));
  SCREE_TRY(join_in(run->arguments->output, "", object->name, ".stl", object->mesh_path, error));
  SCREE_TRY(join(run, "levels/", object->name, ".levels", path, error));
  SCREE_TRY(scree_levels_write(curve, choice, SCREE_LEVELS_BYTES / run->left, path,
                               run->arguments->overwrite, error));
  if (run->left < 2) return SCREE_OK;
  level = scree_curve_find(curve, scree_choice_target(set->paper.rp, choice->triangle_count));
  return write_level(run, index, curve, level, "set/", error);
}

scree_status choose_write_reports(choose_run *run, scree_error *error) {
  bool overwrite = run->arguments->overwrite;
  char path[CHOOSE_PATH_BYTES];
  for (size_t i = 0; i < run->count; i++) {
    SCREE_TRY(join(run, "", run->objects[i].name, ".curve.csv", path, error));
    SCREE_TRY(scree_choice_curve_csv_write(&run->report.entries[i], path, overwrite, error));
  }
  SCREE_TRY(scree_products_write(PRODUCTS, PRODUCT_COUNT, &run->report, run->stage.path, overwrite,
                                 error));
  return put_in_place(run, error);
}
