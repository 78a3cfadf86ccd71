/* What the parts of the verb `study` share. */
#pragma once

#include "cli/args.h"

typedef struct study_arguments {
  const char *output;
  size_t jobs, tasks;
  double lease;
  bool worker, no_wait, keep_failed, overwrite, slurm, dry_run, json, csv;
} study_arguments;

/* Options of study, calibrate and optimise. */
enum { STUDY_OPTIONS = 12, STUDY_ALONE = 2 };
extern const cli_option study_options[STUDY_OPTIONS];
extern const study_arguments study_defaults;

#define STUDY_EXCLUSIVE "json|csv slurm|worker"

/* FOLDER/report.html of what lies there. */
scree_status study_write_page(const char *folder, scree_error *error);

/* The answer and the states; all: also a table of the points, and what follows from them. */
void study_print(FILE *stream, const scree_study_result *result, bool all);

/* Workers of a study or of what is made of studies; the verb's options begin with
 * study_arguments. */
typedef struct study_crew {
  const cli_call *call;
  const char *folder;
  size_t jobs;
  double (*fraction)(void *context); /* how much is done, 0 to 1 */
  void *context;
  /* The work of one that shares this process with others. */
  scree_status (*work)(const cli_call *call, const char *folder, const scree_study_options *options,
                       const scree_progress *progress, scree_error *error);
} study_crew;

/* Checks a call of study, calibrate or optimise: one file, or the word status and a folder. */
scree_status study_check_call(const cli_call *call);
/* Whether it is that word. */
bool study_asks_status(const cli_call *call);
/* The folder by -o, else the file's name without its ending, else `usual`. */
const char *study_folder(const cli_call *call, const char *usual, char *buffer, size_t size);

/* How a worker takes part, by its options. */
scree_study_options study_work_options(const study_arguments *arguments);

/* Workers by --jobs, else as many as there are processors, or as fit a device; at most so many. */
size_t study_jobs_wanted(const cli_call *call, size_t most);

/* In as many processes of one thread or more each. Dead ones are replaced. CLI_TOLD after telling
 * stderr what went wrong. */
scree_status study_run_jobs(const study_crew *crew);

/* The same in as many threads of this process. */
scree_status study_run_lanes(const study_crew *crew);

/* Writes FOLDER/study.sbatch and, unless only that is asked for, submits it; at most so many tasks.
 */
scree_status study_run_slurm(const cli_call *call, const char *folder, size_t most_tasks,
                             scree_error *error);

/* As the options and the launcher want it: by this process, in several, or in lanes of a device. */
scree_status study_run_crew(const study_crew *crew, bool worker);

/* Number of this process among those that mpirun or srun started together, 0 without these. */
size_t study_rank(void);

/* The verbs calibrate and optimise, which differ in their words and refuse each other's files. */
scree_status calibrate_run(const cli_call *call, scree_error *error);

/* All but what a study alone has. */
#define CALIBRATION                                                                                \
  .options = study_options, .option_count = STUDY_OPTIONS - STUDY_ALONE,                           \
  .defaults = &study_defaults, .options_size = sizeof study_defaults, .input_minimum = 1,          \
  .input_maximum = 2, .partners = "tasks:slurm", .exclusive = STUDY_EXCLUSIVE,                     \
  .run = calibrate_run
