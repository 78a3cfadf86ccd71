/* scree calibrate: parameters from measurements. scree optimise differs in its words only. */
#include "base/owned.h"
#include "cli/study.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <string.h>

enum { MOST_JOBS = 1000, SLURM_TASKS = 8 };

static scree_status report(const cli_call *call, scree_calibration *c, const char *folder,
                           bool files, scree_error *error) {
  const study_arguments *a = call->options;
  SCREE_CLEANUP(scree_calibration_result_free) scree_calibration_result result = {0};
  SCREE_TRY(scree_calibration_analyse(c, &result, error));
  result.origin.command = call->command_line;
  if (files) SCREE_TRY(scree_calibration_report_write(&result, folder, error));
  if (files) SCREE_TRY(study_write_page(folder, error));
  if (a->json) return scree_calibration_json_write(&result, "-", true, error);
  if (a->csv) return scree_calibration_csv_write(&result, "-", true, error);
  scree_calibration_print(&result, call->verbose, stdout);
  return SCREE_OK;
}

static scree_status show_status(const cli_call *call, scree_error *error) {
  SCREE_OWNED(scree_calibration, c);
  SCREE_TRY(scree_calibration_open_folder(call->inputs[1], &c, error));
  return report(call, c, call->inputs[1], false, error);
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
  SCREE_OWNED(scree_calibration, c);
  SCREE_TRY(scree_calibration_read(call->inputs[0], &c, error));
  SCREE_TRY(scree_calibration_open(c, folder, error));
  return scree_calibration_work(c, a->jobs, options, progress, error);
}

static scree_status work(const cli_call *call, scree_calibration *c, const char *folder,
                         scree_error *error) {
  const study_arguments *a = call->options;
  bool worker = a->worker || study_rank() > 0;
  const study_crew crew = {.call = call,
                           .folder = folder,
                           .jobs = study_jobs_wanted(call, MOST_JOBS),
                           .fraction = fraction_done,
                           .context = c,
                           .work = work_as_one};
  SCREE_TRY(scree_calibration_open(c, folder, error));
  if (a->slurm) return study_run_slurm(call, folder, a->tasks ? a->tasks : SLURM_TASKS, error);
  SCREE_TRY(study_run_crew(&crew, worker));
  if (worker) return SCREE_OK;
  cli_terminal_end();
  return report(call, c, folder, true, error);
}

scree_status calibrate_run(const cli_call *call, scree_error *error) {
  const study_arguments *a = call->options;
  const bool search = !strcmp(call->verb->name, "optimise");
  SCREE_OWNED(scree_calibration, c);
  char folder[256];
  SCREE_TRY(study_check_call(call));
  if (study_asks_status(call)) return show_status(call, error);
  SCREE_TRY(scree_calibration_read(call->inputs[0], &c, error));
  if (scree_calibration_is_search(c) != search)
    return cli_misuse(call->verb,
                      search ? "the file has no minimise or maximise: `scree calibrate` is for it"
                             : "the file has minimise or maximise: `scree optimise` is for it");
  if (!a->dry_run || a->slurm)
    return work(call, c, study_folder(call, call->verb->name, folder, sizeof folder), error);
  printf("%s can be run\n", call->inputs[0]);
  return SCREE_OK;
}

const cli_verb cli_verb_calibrate = {
    .name = "calibrate",
    .group = CLI_DECIDE,
    .summary = "the parameters that measurements can tell, and those that they cannot",
    .inputs = "FILE.yaml | status DIR",
    .description =
        "Runs scenes at settings of their parameters, compares their answers with what was "
        "measured, and says which settings agree: of every parameter the mean and an interval, "
        "which pairs trade against each other, what the answers would be in scenes that were not "
        "fitted, and which further measurement would tell most. The next runs are made where they "
        "tell most, until the budget is spent or more would tell no more. In place of a scene a "
        "command may give the answers, any other program.\n"
        "\n"
        "The runs are those of studies, one for each experiment: the same command goes on where it "
        "was interrupted, and any number of processes and machines that share the folder work on "
        "it together. With the word status and its folder it shows what is known so far. "
        "docs/reference/calibrate.md describes the file.",
    .examples = "scree calibrate heap.yaml -o heap --jobs 4\n"
                "scree calibrate status heap\n",
    CALIBRATION,
};
