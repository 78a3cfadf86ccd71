/* scree study: many runs. */
#include "base/file.h"
#include "base/owned.h"
#include "base/path.h"
#include "cli/output.h"
#include "cli/study.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <errno.h>
#include <string.h>

#define ARGUMENTS study_arguments
/* The last two are of a study alone. */
const cli_option study_options[STUDY_OPTIONS] = {
    CLI_ROW(CLI_TEXT, "output", output, "DIR",
            "Folder of all that is made. Default: the file's name without its ending, in the "
            "present folder."),
    CLI_RANGE_ROW(
        CLI_COUNT, "jobs", jobs, "N", 0, 1024,
        "Runs at the same time, each in a process of its own; with --backend cuda in threads that "
        "share the device. Default: one per processor, or 80 on a device; of a study at most one "
        "per run. A calibration plans as many runs at a time, at least its batch."),
    CLI_RANGE_ROW(CLI_REAL, "lease", lease, "SECONDS", 5, 1e6,
                  "A run whose worker on another machine gave no sign of life for so long is taken "
                  "over. Default: 300."),
    CLI_FLAG_ROW("worker", worker,
                 "Only work on runs, in this process, and print no results: for more workers, here "
                 "or on other machines that share the folder."),
    CLI_FLAG_ROW("no-wait", no_wait, "Do not wait for runs that others are at work on."),
    CLI_FLAG_ROW(
        "slurm", slurm,
        "Prepare a study's shapes, write DIR/study.sbatch, a job array of workers, and submit it."),
    CLI_RANGE_ROW(CLI_COUNT, "tasks", tasks, "N", 1, 100000,
                  "Tasks of that array. Default: one per run of a study, 8 of a calibration."),
    CLI_FLAG_ROW("dry-run", dry_run,
                 "With --slurm: write it, do not submit it. Else: read the file, and list the runs "
                 "of a study."),
    CLI_FLAG_ROW("json", json, "Print the results as JSON."),
    CLI_FLAG_ROW(
        "csv", csv,
        "Print the results as CSV: a row per point, per sample, or per setting that was tried."),
    CLI_FLAG_ROW("keep-failed", keep_failed,
                 "Leave runs that failed before as they are; else they are tried once more."),
    CLI_FLAG_ROW("force", overwrite,
                 "Begin anew: what an earlier study left in the folder is removed."),
};
const study_arguments study_defaults = {.lease = 300};
enum { RUNS_ON_DEVICE = 80 };

bool study_asks_status(const cli_call *call) {
  return !strcmp(call->inputs[0], "status");
}

scree_status study_check_call(const cli_call *call) {
  if (study_asks_status(call) && call->input_count != 2)
    return cli_misuse(call->verb, "status needs the folder");
  if (!study_asks_status(call) && call->input_count > 1)
    return cli_misuse(call->verb, "one file at a time; '%s' is one too many", call->inputs[1]);
  return SCREE_OK;
}

const char *study_folder(const cli_call *call, const char *usual, char *buffer, size_t size) {
  const study_arguments *a = call->options;
  const char *slash = strrchr(call->inputs[0], '/');
  if (a->output) return a->output;
  snprintf(buffer, size, "%s", slash ? slash + 1 : call->inputs[0]);
  char *dot = strrchr(buffer, '.');
  if (dot && dot != buffer)
    *dot = 0;
  else
    snprintf(buffer, size, "%s", usual);
  return buffer;
}

scree_status study_write_page(const char *folder, scree_error *error) {
  return scree_page_write(&folder, 1, SCREE_PATH_IN(folder, "report.html"), true, error);
}

/* Prints, and with `files` writes tables, figures and the page of them to the folder. */
static scree_status report(const cli_call *call, const scree_study *study, const char *folder,
                           bool files, bool *failed, scree_error *error) {
  const study_arguments *a = call->options;
  SCREE_CLEANUP(scree_study_result_free) scree_study_result result = {0};
  SCREE_TRY(scree_study_analyse(study, &result, error));
  result.origin.command = call->command_line;
  *failed = result.counts.failed > 0;
  if (files) SCREE_TRY(scree_study_report_write(&result, folder, error));
  if (files) SCREE_TRY(study_write_page(folder, error));
  if (a->json) return scree_study_json_write(&result, "-", true, error);
  if (a->csv) return scree_study_csv_write(&result, "-", true, error);
  study_print(stdout, &result, call->verbose);
  return SCREE_OK;
}

static scree_status show_status(const cli_call *call, scree_error *error) {
  SCREE_OWNED(scree_study, study);
  bool failed;
  SCREE_TRY(scree_study_open_folder(call->inputs[1], &study, error));
  SCREE_TRY(scree_study_collect(study, true, error));
  return report(call, study, call->inputs[1], false, &failed, error);
}

static scree_status list_runs(const scree_study *study, scree_error *error) {
  for (size_t i = 0; i < scree_study_run_count(study); i++) {
    scree_study_run run;
    SCREE_TRY(scree_study_get_run(study, i, &run, error));
    printf("%6zu  point %zu  replicate %zu  seed %llu  %s%s%s\n", i, run.point, run.replicate,
           (unsigned long long)run.seed, run.shapes, run.label[0] ? ": " : "", run.label);
  }
  return SCREE_OK;
}

scree_study_options study_work_options(const study_arguments *a) {
  scree_study_options o = scree_default_study_options();
  o.lease_s = a->lease;
  o.wait = !a->no_wait;
  return o;
}

static double fraction_done(void *context) {
  SCREE_CLEANUP(scree_study_result_free) scree_study_result result = {0};
  if (scree_study_collect(context, false, NULL) != SCREE_OK ||
      scree_study_analyse(context, &result, NULL) != SCREE_OK)
    return 0;
  return (double)(result.counts.done + result.counts.failed) /
         (double)scree_study_run_count(context);
}

static scree_status work_as_one(const cli_call *call, const char *folder,
                                const scree_study_options *o, const scree_progress *progress,
                                scree_error *error) {
  SCREE_OWNED(scree_study, study);
  SCREE_TRY(scree_study_read(call->inputs[0], &study, error));
  SCREE_TRY(scree_study_open(study, folder, error));
  SCREE_TRY(scree_study_prepare(study, o, progress, error));
  return scree_study_work(study, o, progress, NULL, error);
}

size_t study_jobs_wanted(const cli_call *call, size_t most) {
  const study_arguments *a = call->options;
  bool on_device = call->backend && strncmp(call->backend, "cuda", 4) == 0;
  size_t jobs = a->jobs ? a->jobs : on_device ? RUNS_ON_DEVICE : (size_t)scree_threads();
  return jobs > most ? most : jobs;
}

/* ---- an earlier study of the folder ---- */

#define ASIDE ".earlier"
static const char *const made[] = {"shapes",           "leases",           "runs",
                                   "results",          "scene.yaml",       "study.sqlite",
                                   "study.sqlite-wal", "study.sqlite-shm", "study.yaml"};
enum { MADE_COUNT = sizeof made / sizeof *made };

static void remove_made(const char *folder) {
  for (size_t i = 0; i < MADE_COUNT; i++) cli_remove_tree(SCREE_PATH_IN(folder, made[i]));
}

static void put_back(const char *folder) {
  for (size_t i = 0; i < MADE_COUNT; i++)
    (void)scree_path_rename(SCREE_PATH_IN(SCREE_PATH_IN(folder, ASIDE), made[i]),
                            SCREE_PATH_IN(folder, made[i]));
  (void)scree_folder_remove(SCREE_PATH_IN(folder, ASIDE));
}

/* Puts it aside until the new one has its shapes, unless somebody is at work on it. */
static scree_status put_aside(const char *folder, scree_error *error) {
  SCREE_OWNED(scree_study, study);
  if (!scree_path_exists(SCREE_PATH_IN(folder, "study.yaml"))) return SCREE_OK;
  if (scree_study_open_folder(folder, &study, NULL) == SCREE_OK) {
    SCREE_CLEANUP(scree_study_result_free) scree_study_result result = {0};
    if (scree_study_collect(study, true, NULL) == SCREE_OK &&
        scree_study_analyse(study, &result, NULL) == SCREE_OK && result.counts.running > 0)
      return cli_refuse(error, SCREE_EXISTS, folder,
                        "others are at work on this study; not begun anew");
  }
  remove_made(SCREE_PATH_IN(folder, ASIDE)); /* of a call that was killed */
  SCREE_TRY(scree_folder_create(SCREE_PATH_IN(folder, ASIDE), error));
  for (size_t i = 0; i < MADE_COUNT; i++)
    if (scree_path_exists(SCREE_PATH_IN(folder, made[i])) &&
        !scree_path_rename(SCREE_PATH_IN(folder, made[i]),
                           SCREE_PATH_IN(SCREE_PATH_IN(folder, ASIDE), made[i]))) {
      scree_status status =
          cli_refuse(error, SCREE_IO, SCREE_PATH_IN(folder, made[i]), strerror(errno));
      put_back(folder);
      return status;
    }
  return SCREE_OK;
}

/* What is wrong with a new study, or ends it before it has its shapes, costs no earlier run. */
static scree_status begin(const cli_call *call, scree_study *study, const char *folder,
                          const scree_study_options *o, scree_error *error) {
  const study_arguments *a = call->options;
  const bool anew = a->overwrite && study_rank() == 0;
  if (anew) SCREE_TRY(put_aside(folder, error));
  scree_status status = scree_study_open(study, folder, error);
  if (status == SCREE_OK) status = scree_study_prepare(study, o, call->progress, error);
  if (!anew || !scree_path_exists(SCREE_PATH_IN(folder, ASIDE))) return status;
  remove_made(status == SCREE_OK ? SCREE_PATH_IN(folder, ASIDE) : folder);
  put_back(folder); /* nothing, where the new one has taken its place */
  return status;
}

static scree_status run_study(const cli_call *call, scree_study *study, const char *folder,
                              scree_error *error) {
  const study_arguments *a = call->options;
  const size_t runs = scree_study_run_count(study);
  bool worker = a->worker || study_rank() > 0, failed = false;
  scree_study_options o = study_work_options(a);
  const study_crew crew = {.call = call,
                           .folder = folder,
                           .jobs = study_jobs_wanted(call, runs),
                           .fraction = fraction_done,
                           .context = study,
                           .work = work_as_one};
  SCREE_TRY(begin(call, study, folder, &o, error));
  if (a->slurm) return study_run_slurm(call, folder, runs, error);
  if (!worker && !a->keep_failed) SCREE_TRY(scree_study_reopen(study, error));
  scree_status status = study_run_crew(&crew, worker);
  if (worker) return status;
  cli_terminal_end();
  SCREE_TRY(scree_study_collect(study, true, error));
  SCREE_TRY(report(call, study, folder, status == SCREE_OK, &failed, error));
  return failed ? CLI_TOLD : status;
}

static scree_status run(const cli_call *call, scree_error *error) {
  const study_arguments *a = call->options;
  SCREE_OWNED(scree_study, study);
  char folder[256];
  SCREE_TRY(study_check_call(call));
  if (study_asks_status(call)) return show_status(call, error);
  SCREE_TRY(scree_study_read(call->inputs[0], &study, error));
  if (a->dry_run && !a->slurm) return list_runs(study, error);
  const char *output = study_folder(call, "study", folder, sizeof folder);
  return run_study(call, study, output, error);
}

const cli_verb cli_verb_study = {
    .name = "study",
    .group = CLI_DECIDE,
    .summary = "run an experiment many times: mean, spread, convergence",
    .inputs = "STUDY.yaml | status DIR",
    .description =
        "Runs the angle-of-repose experiment, or a scene of your own (base: {scene: my.yaml}), at "
        "every point of a design, several times each: shapes, Rp levels (also spheres), friction, "
        "lift speed or any other field of the experiment, on a full grid or a space-filling "
        "design. The folder holds everything; the same command goes on where it was interrupted, "
        "and any number of processes and machines that share the folder work on it together. "
        "Results go to DIR/study.sqlite, tables, figures and report.html beside it. "
        "docs/reference/study.md describes the file and the statistics.\n"
        "\n"
        "With the word status and its folder it shows how far a study is and what is known so far. "
        "Under mpirun or srun every rank is a worker.",
    .examples = "scree study repose.yaml -o repose --jobs 4\n"
                "scree study status repose\n"
                "scree study repose.yaml -o repose --slurm --dry-run\n"
                "mpirun -n 16 scree study repose.yaml -o repose\n",
    CLI_OPTIONS(study_options, study_defaults),
    .input_minimum = 1,
    .input_maximum = 2,
    .partners = "tasks:slurm",
    .exclusive = STUDY_EXCLUSIVE " force|worker",
    .run = run,
};
