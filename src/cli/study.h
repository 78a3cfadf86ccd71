/* What the parts of the verb `study` share. */
#ifndef SCREE_CLI_STUDY_H
#define SCREE_CLI_STUDY_H

#include "cli/args.h"

typedef struct study_arguments {
  const char *output;
  size_t jobs, tasks;
  double lease;
  bool worker, no_wait, keep_failed, slurm, dry_run, json, csv;
} study_arguments;

/* The states, a table of the points, and what follows from them, on one screen. */
void study_print(FILE *stream, const scree_study_result *result);

/* Works on the study in `jobs` processes of one thread or more each. Dead ones are replaced.
 * Returns an exit code after telling stderr what went wrong. */
int study_run_jobs(const cli_call *call, scree_study *study, const char *folder, size_t jobs);

/* The same in as many threads of this process. */
int study_run_lanes(const cli_call *call, const scree_study_options *options, const char *folder,
                    size_t count);

/* Writes FOLDER/study.sbatch and, unless only that is asked for, submits it. */
int study_run_slurm(const cli_call *call, const scree_study *study, const char *folder);

/* Number of this process among those that mpirun or srun started together, 0 without these. */
size_t study_rank(void);

#endif
