/* Memory running out in experiments, runs on disk and studies: every public call refuses with a
 * sentence and leaks nothing; a study goes on afterwards. tests/allocations.sh keeps the list. */
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

/* ---- experiments ---- */

static const char pot[] = "particles: 4\nmeasure: {cell: 0.004}\n"
                          "cylinder: {diameter: 0.08}\ndisc: {diameter: 0.2}\n"
                          "phases: {pack_time: 0.02, settle_time: 0.002, lift_speed: 1,\n"
                          "         lift_time: 0.002, hold_time: 0.002, drop_height: 0.01}\n"
                          "contact: {young_particle: 1e6}\noutput: {frame_interval: 0.01}\n";

static scree_status make_experiment(void *context, scree_error *error) {
  (void)context;
  scree_experiment made = {0}, copy = {0};
  scree_status status = scree_experiment_preset("paper", &made, error);
  if (status == SCREE_OK) status = scree_experiment_parse(pot, sizeof pot - 1, "pot", &made, error);
  if (status == SCREE_OK) status = scree_experiment_check(&made, error);
  if (status == SCREE_OK) status = scree_experiment_copy(&made, &copy, error);
  scree_experiment_free(&copy);
  scree_experiment_free(&made);
  return status;
}

static void experiments(void **state) {
  (void)state;
  check_allocation_failures(make_experiment, NULL);
}

/* ---- runs on disk ---- */

typedef struct setting {
  scree_experiment experiment;
  scree_run_shape shape;
  scree_run *run;
  scree_run_result result;
} setting;

static scree_status complete(void *context, scree_error *error) {
  setting *s = context;
  scree_run *run = NULL;
  scree_run_job job = {.experiment = &s->experiment,
                       .shapes = &s->shape,
                       .shape_count = 1,
                       .folder = in_folder("run"),
                       .overwrite = true};
  scree_status status = scree_run_complete(&job, &run, error);
  if (status == SCREE_OK) scree_run_free(run);
  return status;
}

static scree_status save(void *context, scree_error *error) {
  const setting *s = context;
  scree_status status = scree_run_save(s->run, in_folder("saved"), true, error);
  if (status == SCREE_OK) status = scree_run_save_frame(s->run, in_folder("frame"), true, error);
  return status;
}

static scree_status load(void *context, scree_error *error) {
  const setting *s = context;
  scree_run *run = NULL;
  scree_run_result result;
  scree_status status = scree_run_load(in_folder("saved"), &run, error);
  if (status == SCREE_OK) status = scree_run_measure_with(run, &s->experiment, &result, error);
  scree_run_free(run);
  return status;
}

static scree_status write_run(void *context, scree_error *error) {
  setting *s = context;
  scree_heap_entry entry = {.run = s->run, .result = &s->result};
  scree_status status = scree_heap_json_write(&entry, in_folder("json"), true, error);
  if (status == SCREE_OK) status = scree_series_csv_write(s->run, in_folder("csv"), true, error);
  return status;
}

static void runs(void **state) {
  (void)state;
  setting s = {.shape = {.density_factor = 1, .name = "ball", .source = "none"}};
  scree_error error;
  CHECK_OK(scree_experiment_preset("paper", &s.experiment, &error), error);
  CHECK_OK(scree_experiment_parse(pot, sizeof pot - 1, "pot", &s.experiment, &error), error);
  CHECK_OK(scree_particle_sphere(0.01, &s.shape.particle, &error), error);
  check_allocation_failures(complete, &s);
  CHECK_OK(scree_run_create(&s.experiment, &s.shape, 1, &s.run, &error), error);
  CHECK_OK(scree_run_advance(s.run, 100, &error), error);
  CHECK_OK(scree_run_measure(s.run, &s.result, &error), error);
  check_allocation_failures(save, &s);
  check_allocation_failures(load, &s);
  check_allocation_failures(write_run, &s);
  scree_run_free(s.run);
  scree_particle_free(s.shape.particle);
  scree_experiment_free(&s.experiment);
}

static scree_status make_grains(void *context, scree_error *error) {
  scree_grain grain = {0};
  scree_grain_options o = scree_default_grain_options();
  o.rp = 0.5;
  scree_status status = scree_grain_make(context, NULL, &o, NULL, &grain, error);
  scree_grain_free(&grain);
  return status;
}

static void grains(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(0.02, 1);
  check_allocation_failures(make_grains, &ball);
  scree_mesh_free(&ball);
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
      cmocka_unit_test(experiments),
      cmocka_unit_test(runs),
      cmocka_unit_test(grains),
      cmocka_unit_test(studies),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
