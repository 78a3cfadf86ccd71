/* A program around the library may have asked for decimal commas: what is written is the same
 * bytes, and what is read the same numbers. The locale is made for the test where none is
 * installed. */
#define _XOPEN_SOURCE 700 /* setenv */
#include "base/alloc.h"
#include "base/file.h"
#include "report/program.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

#include <locale.h>

static const char *path_of(const char *prefix, const char *name) {
  char path[300];
  snprintf(path, sizeof path, "%s/%s", prefix, name);
  return in_folder(path);
}

static bool set_comma(void) {
  char command[400];
  if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
    snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 '%s' >/dev/null 2>&1",
             in_folder("de_DE.UTF-8"));
    if (system(command) != 0) return false;
    setenv("LOCPATH", in_folder(""), 1);
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) return false;
  }
  char text[8];
  snprintf(text, sizeof text, "%.1f", 0.5);
  return !strcmp(text, "0,5");
}

static void write_scene(const char *prefix) {
  scree_scene_file *file, *again;
  scree_error error;
  char *text;
  size_t size;
  CHECK_OK(scree_scene_file_template("repose", &file, &error), error);
  CHECK_OK(scree_scene_file_set(file, "friction", "0.25", &error), error);
  CHECK_OK(scree_scene_file_set(file, "gravity", "1.62", &error), error);
  FILE *stream = fopen(path_of(prefix, "scene.yaml"), "w");
  assert_non_null(stream);
  CHECK_OK(scree_scene_file_print(file, stream, &error), error);
  fclose(stream);
  CHECK_OK(scree_file_read(path_of(prefix, "scene.yaml"), 0, &text, &size, &error), error);
  assert_non_null(strstr(text, "friction: 0.25"));
  assert_non_null(strstr(text, "-1.62"));
  scree_free(text);
  CHECK_OK(scree_scene_file_read(path_of(prefix, "scene.yaml"), &again, &error), error);
  CHECK_OK(scree_scene_file_check(again, &error), error);
  scree_scene_file_free(file);
  scree_scene_file_free(again);
}

static void write_tables(const char *prefix, const scree_mesh *ball) {
  static const char *const frames[] = {"a.vtp", "b.vtp"};
  static const double times[] = {0.25, 1.5};
  scree_measure_entry measured = {.file = "a", .format = "test", .unit_m = 1e-3};
  scree_vtk_data data = {.points = ball->positions,
                         .point_count = ball->vertex_count,
                         .triangles = ball->triangles,
                         .cell_count = ball->triangle_count,
                         .time = 0.125};
  scree_error error;
  CHECK_OK(scree_mesh_measure(ball, &measured.measures, &error), error);
  CHECK_OK(scree_measure_json_write(&measured, 1, NULL, path_of(prefix, "m.json"), true, &error),
           error);
  CHECK_OK(scree_measure_csv_write(&measured, 1, path_of(prefix, "m.csv"), true, &error), error);
  CHECK_OK(scree_vtp_write(&data, path_of(prefix, "a.vtp"), true, &error), error);
  CHECK_OK(scree_pvd_write(frames, times, 2, path_of(prefix, "a.pvd"), true, &error), error);
  CHECK_OK(scree_mesh_write(ball, path_of(prefix, "a.off"), NULL, &error), error);
}

static void write_choice(const char *prefix, const scree_mesh *ball) {
  const scree_simplify_options simplify = scree_default_simplify_options();
  const scree_choice_options options = scree_default_choice_options();
  scree_curve *curve = NULL;
  scree_choice choice = {0};
  scree_set_choice set = {0};
  scree_error error;
  CHECK_OK(scree_curve_build(ball, &simplify, NULL, &curve, &error), error);
  CHECK_OK(scree_choose(curve, ball, &options, NULL, &choice, &error), error);
  CHECK_OK(scree_choose_set(&choice, 1, &set, &error), error);
  const scree_choice_entry entry = {.name = "a", .file = "a", .format = "test", .choice = &choice};
  const scree_choice_report report = {
      .entries = &entry, .entry_count = 1, .set = &set, .options = &options};
  CHECK_OK(scree_choice_json_write(&report, path_of(prefix, "c.json"), true, &error), error);
  CHECK_OK(scree_choice_figure_write(&report, path_of(prefix, "f.csv"), true, &error), error);
  CHECK_OK(scree_choice_figure_write(&report, path_of(prefix, "f.gnuplot"), true, &error), error);
  scree_set_choice_free(&set);
  scree_choice_free(&choice);
  scree_curve_free(curve);
}

static void write_study(const char *prefix) {
  static const char text[] = "name: tiny\nreplicates: 1\nshapes: [sample:icosphere-1]\n"
                             "base: {preset: demo, particles: 8}\n"
                             "factors:\n  friction_all: [0.2, 0.55]\n  rp: [0.5]\n";
  scree_study *study = NULL;
  scree_study_run run;
  scree_error error;
  CHECK_OK(scree_text_write(text, path_of(prefix, "study.yaml"), true, &error), error);
  CHECK_OK(scree_study_read(path_of(prefix, "study.yaml"), &study, &error), error);
  CHECK_OK(scree_study_open(study, path_of(prefix, "study"), &error), error);
  CHECK_OK(scree_study_prepare(study, NULL, NULL, &error), error);
  CHECK_OK(scree_study_get_run(study, 1, &run, &error), error);
  CHECK_OK(scree_text_write(run.key, path_of(prefix, "key"), true, &error), error);
  CHECK_OK(scree_text_write(run.label, path_of(prefix, "label"), true, &error), error);
  scree_study_free(study);
}

static void expect_same(const char *name) {
  char *plain, *comma;
  size_t plain_size, comma_size;
  scree_error error;
  CHECK_OK(scree_file_read(path_of("plain", name), 0, &plain, &plain_size, &error), error);
  CHECK_OK(scree_file_read(path_of("comma", name), 0, &comma, &comma_size, &error), error);
  if (plain_size != comma_size || memcmp(plain, comma, plain_size) != 0)
    fail_msg("%s differs with decimal commas", name);
  scree_free(plain);
  scree_free(comma);
}

static void write_all(const char *prefix, const scree_mesh *ball) {
  scree_error error;
  CHECK_OK(scree_folder_create(path_of(prefix, ""), &error), error);
  write_scene(prefix);
  write_tables(prefix, ball);
  write_choice(prefix, ball);
  write_study(prefix);
}

static void commas_change_nothing(void **state) {
  static const char *const names[] = {"scene.yaml", "m.json", "m.csv", "a.vtp", "a.pvd",    "a.off",
                                      "c.json",     "f.csv",  "key",   "label", "f.gnuplot"};
  (void)state;
  scree_mesh ball = shape_icosphere(0.0123, 3);
  write_all("plain", &ball);
  bool comma = set_comma();
  if (comma) write_all("comma", &ball);
  setlocale(LC_ALL, "C");
  scree_mesh_free(&ball);
  if (!comma) skip();
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) expect_same(names[i]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(commas_change_nothing)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
