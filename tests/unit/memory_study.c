/* Memory running out in scenes of templates and studies: every public call refuses with a
 * sentence and leaks nothing; a study goes on afterwards. tests/allocations.sh keeps the list. */
#include "report/program.h"
#include "scene/scene.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

#include <unistd.h>

static void write_text(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static void delete_all(const char *name) {
  char command[160];
  snprintf(command, sizeof command, "rm -rf %s", in_folder(name));
  assert_int_equal(system(command), 0);
}

static const char pot[] = "particles: 4\nmeasure: {cell: 0.004}\n"
                          "cylinder: {diameter: 0.08}\ndisc: {diameter: 0.2}\n"
                          "phases: {pack_time: 0.02, settle_time: 0.002, lift_speed: 1,\n"
                          "         lift_time: 0.002, hold_time: 0.002, drop_height: 0.01}\n"
                          "contact: {young_particle: 1e6}\noutput: {frame_interval: 0.01}\n";

/* ---- scenes of templates ---- */

static scree_status change_template(void *context, scree_error *error) {
  const scree_poured ball = {"ball", "sphere", "0.02", 1};
  scree_scene_file *file = NULL, *over = NULL;
  (void)context;
  scree_status status = scree_scene_file_template("repose", &file, error);
  if (status == SCREE_OK) status = scree_scene_file_pour(file, &ball, 1, error);
  if (status == SCREE_OK) status = scree_scene_file_try(file, "particles", "4", error);
  if (status == SCREE_OK)
    status = scree_scene_file_read_over(in_folder("pot.yaml"), "repose", NULL, &over, error);
  scree_scene_file_free(over);
  scree_scene_file_free(file);
  return status;
}

/* One whose values shrink with its particles. */
static scree_status make_drop(void *context, scree_error *error) {
  scree_scene_file *file = NULL;
  scree_scene *scene = NULL;
  (void)context;
  scree_status status = scree_scene_file_template("drop", &file, error);
  if (status == SCREE_OK) status = scree_scene_create(file, NULL, &scene, error);
  scree_scene_free(scene);
  scree_scene_file_free(file);
  return status;
}

static scree_status run_template(void *context, scree_error *error) {
  scree_scene_file *file = context;
  scree_shape_store *store = NULL;
  scree_scene *scene = NULL;
  scree_pile pile;
  scree_status status = scree_shape_store_create(&store, error);
  if (status == SCREE_OK) status = scree_scene_create_from(file, store, NULL, &scene, error);
  if (status == SCREE_OK) status = scree_scene_measure_pile(scene, 0, NULL, &pile, error);
  if (status == SCREE_OK)
    status = scree_scene_save_frame(scene, in_folder("frame.scree"), true, error);
  if (status == SCREE_OK) status = scree_scene_csv_write(scene, in_folder("csv"), true, error);
  scree_scene_free(scene);
  scree_shape_store_free(store);
  return status;
}

static scree_status make_level(void *context, scree_error *error) {
  scree_shape_spec spec = scree_default_shape_spec();
  scree_shape_made made = {0}, again = {0};
  scree_shape_store *store = NULL;
  (void)context;
  spec.sample = "icosphere-1";
  spec.level = "0.5";
  scree_status status = scree_shape_make(&spec, NULL, NULL, &made, error);
  if (status == SCREE_OK) status = scree_shape_store_create(&store, error);
  if (status == SCREE_OK) status = scree_shape_store_give(store, "own", made.particle, error);
  spec = scree_default_shape_spec();
  spec.file = "own";
  if (status == SCREE_OK) status = scree_shape_make(&spec, store, NULL, &again, error);
  assert_ptr_equal(again.particle, status == SCREE_OK ? made.particle : NULL);
  scree_particle_free(again.particle);
  scree_particle_free(made.particle);
  scree_shape_store_free(store);
  return status;
}

static void templates(void **state) {
  (void)state;
  scree_scene_file *file;
  scree_error error;
  write_text(in_folder("pot.yaml"), pot);
  check_allocation_failures(change_template, NULL);
  check_allocation_failures(make_drop, NULL);
  const scree_poured ball = {"ball", "sphere", "0.02", 1};
  CHECK_OK(scree_scene_file_read_over(in_folder("pot.yaml"), "repose", NULL, &file, &error), error);
  CHECK_OK(scree_scene_file_pour(file, &ball, 1, &error), error);
  check_allocation_failures(run_template, file);
  scree_scene_file_free(file);
  check_allocation_failures(make_level, NULL);
}

/* ---- studies ---- */

static const char tiny[] = "name: tiny\nreplicates: 1\nshapes: [sample:icosphere-1]\n"
                           "base:\n  preset: demo\n  particles: 4\n  cylinder: {diameter: 0.4}\n"
                           "  phases: {pack_time: 0.02, settle_time: 0.002, lift_speed: 1,\n"
                           "           lift_time: 0.002, hold_time: 0.002}\n"
                           "factors:\n  rp: [spheres, 0.5, 0.9]\n";

static scree_status read_study(void *context, scree_error *error) {
  (void)context;
  scree_study *study = NULL;
  scree_study_run run;
  scree_status status = scree_study_read(in_folder("tiny.yaml"), &study, error);
  if (status == SCREE_OK) status = scree_study_get_run(study, 0, &run, error);
  scree_study_free(study);
  return status;
}

static scree_status prepare_study(void *context, scree_error *error) {
  (void)context;
  scree_study *study = NULL;
  scree_study_options o = scree_default_study_options();
  delete_all("prepared");
  scree_status status = scree_study_read(in_folder("tiny.yaml"), &study, error);
  if (status == SCREE_OK) status = scree_study_open(study, in_folder("prepared"), error);
  if (status == SCREE_OK) status = scree_study_prepare(study, &o, NULL, error);
  scree_study_free(study);
  return status;
}

static scree_status work_on_study(void *context, scree_error *error) {
  scree_study *study = context;
  scree_study_options o = scree_default_study_options();
  delete_all("study/results/*");
  delete_all("study/runs/*");
  delete_all("study/leases/*");
  o.wait = false;
  scree_status status = scree_study_reopen(study, error);
  if (status == SCREE_OK) status = scree_study_work(study, &o, NULL, NULL, error);
  return status;
}

static scree_status collect_study(void *context, scree_error *error) {
  delete_all("study/study.sqlite");
  delete_all("study/leases/*");
  return scree_study_collect(context, true, error);
}

static scree_status analyse_study(void *context, scree_error *error) {
  (void)context;
  scree_study *study = NULL;
  scree_study_result result = {0};
  scree_status status = scree_study_open_folder(in_folder("study"), &study, error);
  if (status == SCREE_OK) status = scree_study_analyse(study, &result, error);
  scree_study_result_free(&result);
  scree_study_free(study);
  return status;
}

static scree_status write_study(void *context, scree_error *error) {
  const scree_study_result *r = context;
  scree_status status = scree_study_json_write(r, in_folder("json"), true, error);
  if (status == SCREE_OK) status = scree_study_csv_write(r, in_folder("csv"), true, error);
  return status;
}

static scree_status draw_study(void *context, scree_error *error) {
  const scree_study_result *r = context;
  scree_status status = scree_study_angle_figure(r, in_folder("angle.svg"), true, error);
  if (status == SCREE_OK) status = scree_study_rotation_figure(r, in_folder("w.svg"), true, error);
  if (status == SCREE_OK) status = scree_study_time_figure(r, in_folder("t.svg"), true, error);
  if (status == SCREE_OK) status = scree_study_report_write(r, in_folder("."), error);
  return status;
}

static void studies(void **state) {
  (void)state;
  scree_study *study;
  scree_study_result result;
  scree_study_options o = scree_default_study_options();
  scree_error error;
  write_text(in_folder("tiny.yaml"), tiny);
  check_allocation_failures(read_study, NULL);
  check_allocation_failures(prepare_study, NULL);
  CHECK_OK(scree_study_read(in_folder("tiny.yaml"), &study, &error), error);
  CHECK_OK(scree_study_open(study, in_folder("study"), &error), error);
  CHECK_OK(scree_study_prepare(study, &o, NULL, &error), error);
  check_allocation_failures_survivable(work_on_study, study);
  CHECK_OK(work_on_study(study, &error), error); /* none of it is left behind */
  check_allocation_failures(collect_study, study);
  CHECK_OK(collect_study(study, &error), error);
  check_allocation_failures(analyse_study, NULL);
  CHECK_OK(scree_study_analyse(study, &result, &error), error);
  assert_int_equal(result.counts.done, 3);
  check_allocation_failures(write_study, &result);
  check_allocation_failures(draw_study, &result);
  scree_study_result_free(&result);
  scree_study_free(study);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(templates),
      cmocka_unit_test(studies),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
