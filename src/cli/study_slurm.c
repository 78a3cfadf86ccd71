/* A Slurm job array whose tasks are workers in the shared folder. Slurm queues a task again whose
 * node fails or which is pre-empted; the run of one that is killed is gone on with by the others.
 */
#define _XOPEN_SOURCE 700 /* realpath */
#include "cli/study.h"

#include <errno.h>
#include <limits.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

extern char **environ;

/* In single quotes, for a shell. */
static void write_quoted(FILE *stream, const char *text) {
  putc('\'', stream);
  for (; *text; text++) fprintf(stream, *text == '\'' ? "'\\''" : "%c", *text);
  putc('\'', stream);
}

static void write_script(FILE *stream, const cli_call *call, const char *study, const char *folder,
                         size_t tasks) {
  const study_arguments *a = call->options;
  char program[PATH_MAX];
  if (!realpath("/proc/self/exe", program)) snprintf(program, sizeof program, "scree");
  fprintf(stream,
          "#!/bin/sh\n"
          "# scree %s: workers of a study; more of them, here or elsewhere, may join at any time.\n"
          "#SBATCH --job-name=scree-study\n"
          "#SBATCH --array=0-%zu\n"
          "#SBATCH --ntasks=1\n"
          "#SBATCH --cpus-per-task=1\n"
          "#SBATCH --requeue\n"
          "#SBATCH --open-mode=append\n"
          "#SBATCH --signal=B:TERM@60\n"
          "#SBATCH --output=",
          scree_version(), tasks - 1);
  write_quoted(stream, folder);
  fputs("/slurm-%A_%a.out\nexec ", stream);
  write_quoted(stream, program);
  fputs(" study -o ", stream);
  write_quoted(stream, folder);
  if (call->max_memory) fprintf(stream, " --max-memory %zu", call->max_memory);
  fprintf(stream, " --worker --lease %.9g --threads \"${SLURM_CPUS_PER_TASK:-1}\" -- ", a->lease);
  write_quoted(stream, study);
  putc('\n', stream);
}

static int submit(const char *script) {
  union {
    const char *fixed[3];
    char *words[3];
  } line = {{"sbatch", script}};
  char shown[CLI_PRINTABLE_BYTES];
  pid_t pid;
  int status;
  int code = posix_spawnp(&pid, "sbatch", NULL, NULL, line.words, environ);
  if (code == 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0)
    return 0;
  fprintf(stderr, "scree: %s could not be submitted: %s\n", cli_printable(script, shown),
          code ? strerror(code) : "sbatch failed");
  return 1;
}

int study_run_slurm(const cli_call *call, const scree_study *study, const char *folder) {
  const study_arguments *a = call->options;
  char file[PATH_MAX], full[PATH_MAX], script[PATH_MAX + 16], shown[CLI_PRINTABLE_BYTES];
  size_t runs = scree_study_run_count(study), tasks = a->tasks ? a->tasks : runs;
  if (!realpath(call->inputs[0], file) || !realpath(folder, full)) {
    fprintf(stderr, "scree: %s: %s\n", cli_printable(folder, shown), strerror(errno));
    return 1;
  }
  snprintf(script, sizeof script, "%s/study.sbatch", full);
  char *text = NULL;
  size_t size;
  scree_error error;
  FILE *stream = open_memstream(&text, &size);
  if (stream) write_script(stream, call, file, full, tasks < runs ? tasks : runs);
  if (!stream || fclose(stream) != 0) {
    fprintf(stderr, "scree: %s: out of memory\n", cli_printable(script, shown));
    free(text);
    return 1;
  }
  scree_status status = scree_text_write(text, script, true, &error);
  free(text);
  if (status != SCREE_OK) return cli_fail(&error);
  if (!a->dry_run) return submit(script);
  printf("%s: not submitted; `sbatch %s` does\n", cli_printable(script, shown), shown);
  return 0;
}
