/* scree study: many runs. */
#include "cli/study.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <string.h>

#define AT(field) offsetof(study_arguments, field)
/* The last is of a study alone. */
const cli_option study_options[STUDY_OPTIONS] = {
    {"output", CLI_TEXT, AT(output), "DIR",
     "Folder of all that is made. Default: the file's name without its ending, in the present "
     "folder.",
     0, 0, NULL},
    {"jobs", CLI_COUNT, AT(jobs), "N",
     "Runs at the same time, each in a process of its own; with --backend cuda in threads that "
     "share the device. Default: one per processor, or 80 on a device; of a study at most one per "
     "run. A calibration plans as many runs at a time, at least its batch.",
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
     "Prepare a study's shapes, write DIR/study.sbatch, a job array of workers, and submit it.", 0,
     0, NULL},
    {"tasks", CLI_COUNT, AT(tasks), "N",
     "Tasks of that array. Default: one per run of a study, 8 of a calibration.", 1, 100000, NULL},
    {"dry-run", CLI_FLAG, AT(dry_run), NULL,
     "With --slurm: write it, do not submit it. Else: read the file, and list the runs of a study.",
     0, 0, NULL},
    {"json", CLI_FLAG, AT(json), NULL, "Print the results as JSON.", 0, 0, NULL},
    {"csv", CLI_FLAG, AT(csv), NULL,
     "Print the results as CSV: a row per point, per sample, or per setting that was tried.", 0, 0,
     NULL},
    {"keep-failed", CLI_FLAG, AT(keep_failed), NULL,
     "Leave runs that failed before as they are; else they are tried once more.", 0, 0, NULL},
};
const study_arguments study_defaults = {.lease = 300};
enum { RUNS_ON_DEVICE = 80 };

int study_check_call(const cli_call *call) {
  const study_arguments *a = call->options;
  if (a->json && a->csv) return cli_misuse(call->verb, "--json and --csv exclude each other");
  if (a->slurm && a->worker)
    return cli_misuse(call->verb, "--slurm and --worker exclude each other");
  if (strcmp(call->inputs[0], "status") != 0 && call->input_count > 1)
    return cli_misuse(call->verb, "one file at a time; '%s' is one too many", call->inputs[1]);
  return 0;
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
  char path[4200];
  snprintf(path, sizeof path, "%.4100s/report.html", folder);
  return scree_page_write(&folder, 1, path, true, error);
}

/* Tables, figures and the page of them. */
static scree_status write_files(const scree_study_result *result, const char *folder,
                                scree_error *error) {
  SCREE_TRY(scree_study_report_write(result, folder, error));
  return study_write_page(folder, error);
}

/* Prints, and with `files` writes tables and figures to the folder. */
static scree_status report(const cli_call *call, const scree_study *study, const char *folder,
                           bool files, bool *failed, scree_error *error) {
  const study_arguments *a = call->options;
  scree_study_result result;
  scree_status status = scree_study_analyse(study, &result, error);
  if (status != SCREE_OK) return status;
  *failed = result.counts.failed > 0;
  if (files) status = write_files(&result, folder, error);
  if (status == SCREE_OK && a->json) status = scree_study_json_write(&result, "-", true, error);
  if (status == SCREE_OK && a->csv) status = scree_study_csv_write(&result, "-", true, error);
  if (status == SCREE_OK && !a->json && !a->csv) study_print(stdout, &result);
  scree_study_result_free(&result);
  return status;
}

static int show_status(const cli_call *call) {
  scree_study *study = NULL;
  scree_error error;
  bool failed = false;
  if (call->input_count != 2) return cli_misuse(call->verb, "status needs the study's folder");
  scree_status status = scree_study_open_folder(call->inputs[1], &study, &error);
  if (status == SCREE_OK) status = scree_study_collect(study, true, &error);
  if (status == SCREE_OK) status = report(call, study, call->inputs[1], false, &failed, &error);
  scree_study_free(study);
  return status == SCREE_OK ? 0 : cli_fail(&error);
}

static int list_runs(const scree_study *study) {
  scree_error error;
  for (size_t i = 0; i < scree_study_run_count(study); i++) {
    scree_study_run run;
    if (scree_study_get_run(study, i, &run, &error) != SCREE_OK) return cli_fail(&error);
    printf("%6zu  point %zu  replicate %zu  seed %llu  %s%s%s\n", i, run.point, run.replicate,
           (unsigned long long)run.seed, run.shapes, run.label[0] ? ": " : "", run.label);
  }
  return 0;
}

scree_study_options study_work_options(const study_arguments *a) {
  scree_study_options o = scree_default_study_options();
  o.lease_s = a->lease;
  o.wait = !a->no_wait;
  return o;
}

static double fraction_done(void *context) {
  scree_study *study = context;
  scree_study_result result;
  double fraction = 0;
  if (scree_study_collect(study, false, NULL) == SCREE_OK &&
      scree_study_analyse(study, &result, NULL) == SCREE_OK) {
    size_t count = scree_study_run_count(study);
    fraction = (double)(result.counts.done + result.counts.failed) / (double)count;
    scree_study_result_free(&result);
  }
  return fraction;
}

static scree_status work_as_one(const cli_call *call, const char *folder,
                                const scree_study_options *o, const scree_progress *progress,
                                scree_error *error) {
  scree_study *study = NULL;
  scree_status status = scree_study_read(call->inputs[0], &study, error);
  if (status == SCREE_OK) status = scree_study_open(study, folder, error);
  if (status == SCREE_OK) status = scree_study_prepare(study, o, progress, error);
  if (status == SCREE_OK) status = scree_study_work(study, o, progress, NULL, error);
  scree_study_free(study);
  return status;
}

size_t study_jobs_wanted(const cli_call *call, size_t most) {
  const study_arguments *a = call->options;
  bool on_device = call->backend && strncmp(call->backend, "cuda", 4) == 0;
  size_t jobs = a->jobs ? a->jobs : on_device ? RUNS_ON_DEVICE : (size_t)scree_threads();
  return jobs > most ? most : jobs;
}

/* Works in this process, or in several. */
static int work(const cli_call *call, scree_study *study, const char *folder, bool worker,
                scree_error *error) {
  const study_arguments *a = call->options;
  study_crew crew = {.call = call,
                     .folder = folder,
                     .jobs = study_jobs_wanted(call, scree_study_run_count(study)),
                     .fraction = fraction_done,
                     .context = study,
                     .work = work_as_one};
  if (!worker && !a->keep_failed && scree_study_reopen(study, error) != SCREE_OK)
    return cli_fail(error);
  return study_run_crew(&crew, worker);
}

static int run_study(const cli_call *call, scree_study *study, const char *folder,
                     scree_error *error) {
  const study_arguments *a = call->options;
  bool worker = a->worker || study_rank() > 0, failed = false;
  scree_study_options o = study_work_options(a);
  scree_status status = scree_study_open(study, folder, error);
  if (status == SCREE_OK) status = scree_study_prepare(study, &o, call->progress, error);
  if (status != SCREE_OK) return cli_fail(error);
  if (a->slurm) return study_run_slurm(call, folder, scree_study_run_count(study));
  int code = work(call, study, folder, worker, error);
  if (worker) return code;
  scree_error late; /* what happened first is what is told */
  cli_terminal_end();
  status = scree_study_collect(study, true, &late);
  if (status == SCREE_OK) status = report(call, study, folder, code == 0, &failed, &late);
  if (status != SCREE_OK) return cli_fail(&late);
  return code == 0 && failed ? 1 : code;
}

static int run(const cli_call *call) {
  const study_arguments *a = call->options;
  scree_study *study = NULL;
  scree_error error;
  char folder[256];
  int code = study_check_call(call);
  if (code) return code;
  if (!strcmp(call->inputs[0], "status")) return show_status(call);
  if (scree_study_read(call->inputs[0], &study, &error) != SCREE_OK) return cli_fail(&error);
  code = a->dry_run && !a->slurm
             ? list_runs(study)
             : run_study(call, study, study_folder(call, "study", folder, sizeof folder), &error);
  scree_study_free(study);
  return code;
}

const cli_verb cli_verb_study = {
    .name = "study",
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
    .run = run,
};
