/* A Slurm job array whose tasks are workers in the shared folder. Slurm queues a task again whose
 * node fails or which is pre-empted; the run of one that is killed is gone on with by the others.
 */
#include "cli/study.h"

#include "base/file.h"
#include "base/path.h"
#include "base/platform.h"
#include "base/quote.h"

#include <errno.h>
#include <string.h>

enum { MOST_PATH = 4096, MOST_JOBS = 1024 };

/* In the names of Slurm's files % begins what it fills in. */
static void put_file_name(FILE *stream, const char *folder) {
  char doubled[2 * MOST_PATH], *at = doubled;
  for (; *folder; folder++) {
    if (*folder == '%') *at++ = '%';
    *at++ = *folder;
  }
  *at = 0;
  scree_quote(stream, SCREE_QUOTE_SHELL, doubled);
}

static void write_script(FILE *stream, const cli_call *call, const char *study, const char *folder,
                         size_t tasks) {
  const study_arguments *a = call->options;
  char program[MOST_PATH];
  if (!scree_program_path(program, sizeof program)) snprintf(program, sizeof program, "scree");
  fprintf(stream,
          "#!/bin/sh\n"
          "# scree %s: workers of one %s; more of them, here or elsewhere, may join at any time.\n"
          "#SBATCH --job-name=scree-%s\n"
          "#SBATCH --array=0-%zu\n"
          "#SBATCH --ntasks=1\n"
          "#SBATCH --cpus-per-task=1\n"
          "#SBATCH --requeue\n"
          "#SBATCH --open-mode=append\n"
          "#SBATCH --signal=B:TERM@60\n"
          "#SBATCH --output=",
          scree_version(), call->verb->name, call->verb->name, tasks - 1);
  put_file_name(stream, folder);
  fputs("/slurm-%A_%a.out\nexec ", stream);
  scree_quote(stream, SCREE_QUOTE_SHELL, program);
  fprintf(stream, " %s -o ", call->verb->name);
  scree_quote(stream, SCREE_QUOTE_SHELL, folder);
  if (call->max_memory) fprintf(stream, " --max-memory %zu", call->max_memory);
  if (call->backend) fprintf(stream, " --backend %s", call->backend);
  fprintf(stream, " --worker --jobs %zu --lease %.9g --threads \"${SLURM_CPUS_PER_TASK:-1}\" -- ",
          tasks < MOST_JOBS ? tasks : MOST_JOBS, a->lease);
  scree_quote(stream, SCREE_QUOTE_SHELL, study);
  putc('\n', stream);
}

static scree_status submit(const char *script, scree_error *error) {
  const char *words[] = {"sbatch", script, NULL};
  long process;
  int result, code = scree_process_run(words, NULL, NULL, &process);
  if (code == 0 && scree_process_look(process, true, &result) == SCREE_PROCESS_ENDED && result == 0)
    return SCREE_OK;
  return scree_fail(error, SCREE_IO, "%s could not be submitted: %s", script,
                    code ? strerror(code) : "sbatch failed");
}

scree_status study_run_slurm(const cli_call *call, const char *folder, size_t most_tasks,
                             scree_error *error) {
  const study_arguments *a = call->options;
  char file[MOST_PATH], full[MOST_PATH], shown[CLI_PRINTABLE_BYTES];
  size_t tasks = a->tasks ? a->tasks : most_tasks;
  if (!scree_path_full(call->inputs[0], file, sizeof file) ||
      !scree_path_full(folder, full, sizeof full))
    return cli_refuse(error, SCREE_IO, folder, strerror(errno));
  if (full[strcspn(full, "\r\n")])
    return cli_refuse(error, SCREE_BAD_ARGUMENT, folder,
                      "a line end in its name is none of Slurm's");
  const char *script = SCREE_PATH_IN(full, "study.sbatch");
  scree_output output;
  SCREE_TRY(scree_output_open(script, true, &output, error));
  write_script(output.stream, call, file, full, tasks < most_tasks ? tasks : most_tasks);
  SCREE_TRY(scree_output_commit(&output, error));
  if (!a->dry_run) return submit(script, error);
  printf("%s: not submitted; `sbatch %s` does\n", cli_printable(script, shown), shown);
  return SCREE_OK;
}
