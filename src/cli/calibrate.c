#include "cli/calibrate.h"
#include "cli/terminal.h"

#include <string.h>

#define AT(field) offsetof(study_arguments, field)
const cli_option calibrate_options[CALIBRATE_OPTIONS] = {
    {"output", CLI_TEXT, AT(output), "DIR",
     "Folder of all that is made. Default: the file's name without its ending, in the present "
     "folder.",
     0, 0, NULL},
    {"jobs", CLI_COUNT, AT(jobs), "N",
     "Runs at the same time, each in a process of its own; with --backend cuda in threads that "
     "share the device. Default: one per processor, or 80 on a device. As many runs are planned at "
     "a time, at least the file's batch.",
     0, 1024, NULL},
    {"lease", CLI_REAL, AT(lease), "SECONDS",
     "A run whose worker on another machine gave no sign of life for so long is taken over. "
     "Default: 300.",
     5, 1e6, NULL},
    {"worker", CLI_FLAG, AT(worker), NULL,
     "Only work on runs, in this process, and print nothing: for more workers, here or on other "
     "machines that share the folder.",
     0, 0, NULL},
    {"no-wait", CLI_FLAG, AT(no_wait), NULL, "Do not wait for runs that others are at work on.", 0,
     0, NULL},
    {"slurm", CLI_FLAG, AT(slurm), NULL,
     "Write DIR/study.sbatch, a job array of workers, and submit it.", 0, 0, NULL},
    {"tasks", CLI_COUNT, AT(tasks), "N", "Tasks of that array. Default: 8.", 1, 1000, NULL},
    {"dry-run", CLI_FLAG, AT(dry_run), NULL, "With --slurm: write it, do not submit it.", 0, 0,
     NULL},
    {"json", CLI_FLAG, AT(json), NULL, "Print the results as JSON.", 0, 0, NULL},
    {"csv", CLI_FLAG, AT(csv), NULL, "Print the samples as CSV, or what was tried.", 0, 0, NULL},
};
const study_arguments calibrate_defaults = {.lease = 300};
enum { MOST_JOBS = 1000, SLURM_TASKS = 8 };

static scree_status report(const cli_call *call, scree_calibration *c, const char *folder,
                           bool files, scree_error *error) {
  const study_arguments *a = call->options;
  scree_calibration_result result;
  char path[4200];
  scree_status status = scree_calibration_analyse(c, &result, error);
  if (status != SCREE_OK) return status;
  if (files) status = scree_calibration_report_write(&result, folder, error);
  snprintf(path, sizeof path, "%.4100s/report.html", folder);
  if (status == SCREE_OK && files) status = scree_page_write(&folder, 1, path, true, error);
  if (status == SCREE_OK && a->json)
    status = scree_calibration_json_write(&result, "-", true, error);
  if (status == SCREE_OK && a->csv) status = scree_calibration_csv_write(&result, "-", true, error);
  if (status == SCREE_OK && !a->json && !a->csv) scree_calibration_print(&result, stdout);
  scree_calibration_result_free(&result);
  return status;
}

static int show_status(const cli_call *call) {
  scree_calibration *c = NULL;
  scree_error error;
  if (call->input_count != 2) return cli_misuse(call->verb, "status needs the folder");
  scree_status status = scree_calibration_open_folder(call->inputs[1], &c, &error);
  if (status == SCREE_OK) status = report(call, c, call->inputs[1], false, &error);
  scree_calibration_free(c);
  return status == SCREE_OK ? 0 : cli_fail(&error);
}

static double fraction_done(void *context) {
  scree_calibration_progress p;
  if (scree_calibration_look(context, &p, NULL) != SCREE_OK) return 0;
  return (double)(p.done + p.failed) / (double)p.budget;
}

static scree_status work_as_one(const cli_call *call, const char *folder,
                                const scree_study_options *options, const scree_progress *progress,
                                scree_error *error) {
  const study_arguments *a = call->options;
  scree_calibration *c = NULL;
  scree_status status = scree_calibration_read(call->inputs[0], &c, error);
  if (status == SCREE_OK) status = scree_calibration_open(c, folder, error);
  if (status == SCREE_OK) status = scree_calibration_work(c, a->jobs, options, progress, error);
  scree_calibration_free(c);
  return status;
}

static int work(const cli_call *call, scree_calibration *c, const char *folder) {
  const study_arguments *a = call->options;
  bool worker = a->worker || study_rank() > 0;
  scree_error error;
  study_crew crew = {.call = call,
                     .folder = folder,
                     .jobs = study_jobs_wanted(call, MOST_JOBS),
                     .fraction = fraction_done,
                     .context = c,
                     .work = work_as_one};
  if (scree_calibration_open(c, folder, &error) != SCREE_OK) return cli_fail(&error);
  if (a->slurm) return study_run_slurm(call, folder, a->tasks ? a->tasks : SLURM_TASKS);
  int code = study_run_crew(&crew, worker);
  if (worker) return code;
  cli_terminal_end();
  if (code != 0) return code;
  return report(call, c, folder, true, &error) == SCREE_OK ? 0 : cli_fail(&error);
}

int calibrate_run(const cli_call *call, bool search) {
  scree_calibration *c = NULL;
  scree_error error;
  char folder[256];
  int code = study_check_call(call);
  if (code) return code;
  if (!strcmp(call->inputs[0], "status")) return show_status(call);
  if (scree_calibration_read(call->inputs[0], &c, &error) != SCREE_OK) return cli_fail(&error);
  if (scree_calibration_is_search(c) != search)
    code = cli_misuse(call->verb,
                      search ? "the file has no minimise or maximise: `scree calibrate` is for it"
                             : "the file has minimise or maximise: `scree optimise` is for it");
  else
    code = work(call, c, study_folder(call, call->verb->name, folder, sizeof folder));
  scree_calibration_free(c);
  return code;
}
