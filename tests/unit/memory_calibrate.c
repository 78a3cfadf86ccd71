/* Memory running out in a calibration: every public call refuses with a sentence and leaks nothing.
 */
#include "report/program.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"

static const char file[] = "experiments: {echo: {command: [sh, -c, 'echo angle: {a}']}}\n"
                           "parameters: {a: {from: 1, to: 3}}\n"
                           "targets:\n"
                           "  angle: {answer: angle, value: 2, uncertainty: 0.1}\n"
                           "predict:\n"
                           "  again: {answer: angle}\n"
                           "budget: {runs: 3}\nstart: {points: 2}\n";

static void write_file(void) {
  FILE *stream = fopen(in_folder("c.yaml"), "w");
  assert_non_null(stream);
  fputs(file, stream);
  assert_int_equal(fclose(stream), 0);
}

/* Works anew, and goes on with what was done. */
static scree_status work(void *context, scree_error *error) {
  (void)context;
  scree_calibration *c = NULL;
  scree_status status = scree_calibration_read(in_folder("c.yaml"), &c, error);
  if (status == SCREE_OK) status = scree_calibration_open(c, in_folder("out"), error);
  if (status == SCREE_OK) status = scree_calibration_work(c, 1, NULL, NULL, error);
  scree_calibration_free(c);
  return status;
}

static scree_status look(void *context, scree_error *error) {
  (void)context;
  scree_calibration *c = NULL;
  scree_calibration_progress progress;
  scree_status status = scree_calibration_open_folder(in_folder("out"), &c, error);
  if (status != SCREE_OK) return status;
  status = scree_calibration_look(c, &progress, error);
  scree_calibration_free(c);
  return status;
}

static scree_status analyse(void *context, scree_error *error) {
  (void)context;
  scree_calibration *c = NULL;
  scree_calibration_result result = {0};
  scree_status status = scree_calibration_open_folder(in_folder("out"), &c, error);
  if (status != SCREE_OK) return status;
  status = scree_calibration_analyse(c, &result, error);
  scree_calibration_result_free(&result);
  scree_calibration_free(c);
  return status;
}

static scree_status write_all(void *context, scree_error *error) {
  const scree_calibration_result *r = context;
  scree_status status = scree_calibration_json_write(r, in_folder("c.json"), true, error);
  if (status == SCREE_OK) status = scree_calibration_csv_write(r, in_folder("c.csv"), true, error);
  return status;
}

static scree_status report(void *context, scree_error *error) {
  return scree_calibration_report_write(context, in_folder("out"), error);
}

static void calibration_without_memory(void **state) {
  (void)state;
  scree_calibration *c;
  scree_calibration_result result;
  scree_error error;
  write_file();
  CHECK_OK(work(NULL, &error), error);
  check_allocation_failures_survivable(work, NULL);
  check_allocation_failures_survivable(look, NULL);
  check_allocation_failures_survivable(analyse, NULL);
  CHECK_OK(scree_calibration_open_folder(in_folder("out"), &c, &error), error);
  CHECK_OK(scree_calibration_analyse(c, &result, &error), error);
  CHECK_NEAR(result.parameters[0].mean, 2, 0.3);
  assert_int_equal(result.progress.done, 6); /* three, and the check */
  check_allocation_failures(write_all, &result);
  check_allocation_failures_survivable(report, &result);
  scree_calibration_result_free(&result);
  scree_calibration_free(c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(calibration_without_memory)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
