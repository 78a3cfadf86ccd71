/* Workers as processes: the program itself again, with --worker. They share nothing but the folder,
 * so that the death of one harms no other. */
#include "base/platform.h"
#include "cli/study.h"
#include "cli/terminal.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_JOBS = 1024, LOOKS_A_COLLECT = 25 };
static const double look_s = 0.2;

size_t study_rank(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK",
                                      "SLURM_PROCID"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    const char *text = getenv(names[i]);
    if (text && *text) return (size_t)strtoull(text, NULL, 10);
  }
  return 0;
}

typedef struct pool {
  const study_crew *crew;
  const cli_call *call;
  char threads[24], lease[40], memory[24], jobs[24];
  long workers[MOST_JOBS];
  size_t alive, replaced;
  bool told; /* the workers, to end */
  scree_status result;
} pool;

static bool start_worker(pool *p, size_t slot) {
  const study_arguments *a = p->call->options;
  const char *words[20] = {"scree",     p->call->verb->name, "-o",      p->crew->folder,
                           "--worker",  "--quiet",           "--jobs",  p->jobs,
                           "--threads", p->threads,          "--lease", p->lease};
  size_t count = 12;
  if (a->no_wait) words[count++] = "--no-wait";
  if (p->call->max_memory) {
    words[count++] = "--max-memory";
    words[count++] = p->memory;
  }
  if (p->call->backend) {
    words[count++] = "--backend";
    words[count++] = p->call->backend;
  }
  words[count++] = "--";
  words[count++] = p->call->inputs[0];
  int code = scree_process_run(words, NULL, NULL, &p->workers[slot]);
  if (code != 0) {
    fprintf(stderr, "scree: cannot start a worker: %s\n", strerror(code));
    p->workers[slot] = 0;
    p->result = CLI_TOLD;
    return false;
  }
  p->alive++;
  return true;
}

static void bury(pool *p, size_t slot, scree_process_state state, int code, size_t jobs) {
  long process = p->workers[slot];
  p->workers[slot] = 0;
  p->alive--;
  if (cli_interrupted()) return;
  if (state == SCREE_PROCESS_ENDED) {
    if (code != 0) p->result = CLI_TOLD; /* it has told why */
    return;
  }
  fprintf(stderr, "scree: worker %ld was killed (signal %d); another one takes its place\n",
          process, code);
  if (p->replaced++ < 10 * jobs)
    start_worker(p, slot);
  else
    p->result = CLI_TOLD;
}

/* A signal sent to this process alone is passed on, once: the second one would end a worker that is
 * still writing its checkpoint. */
static void pass_on(pool *p, size_t jobs) {
  for (size_t i = 0; i < jobs; i++)
    if (p->workers[i] > 0) scree_process_stop(p->workers[i]);
  p->told = true;
}

static void look_around(const pool *p) {
  const scree_progress *progress = p->call->progress;
  progress->report(progress->context, "runs", p->crew->fraction(p->crew->context));
}

scree_status study_run_jobs(const study_crew *crew) {
  const study_arguments *a = crew->call->options;
  pool p = {.crew = crew, .call = crew->call};
  size_t jobs = crew->jobs > MOST_JOBS ? MOST_JOBS : crew->jobs;
  int threads = scree_threads() / (int)jobs;
  snprintf(p.threads, sizeof p.threads, "%d", threads > 1 ? threads : 1);
  snprintf(p.lease, sizeof p.lease, "%.9g", a->lease);
  snprintf(p.memory, sizeof p.memory, "%zu", crew->call->max_memory);
  snprintf(p.jobs, sizeof p.jobs, "%zu", jobs);
  for (size_t i = 0; i < jobs; i++)
    if (!start_worker(&p, i)) break;
  for (size_t look = 1; p.alive > 0; look++) {
    scree_sleep(look_s);
    for (size_t i = 0; i < jobs; i++) {
      int code;
      if (p.workers[i] <= 0) continue;
      scree_process_state state = scree_process_look(p.workers[i], false, &code);
      if (state != SCREE_PROCESS_RUNS) bury(&p, i, state, code, jobs);
    }
    if (cli_interrupted() && !p.told && look % 5 == 0) pass_on(&p, jobs);
    if (look % LOOKS_A_COLLECT == 0) look_around(&p);
  }
  return p.result;
}

scree_status study_run_crew(const study_crew *crew, bool worker) {
  const study_arguments *a = crew->call->options;
  const char *backend = crew->call->backend;
  scree_study_options o = study_work_options(a);
  bool launched = getenv("OMPI_COMM_WORLD_RANK") || getenv("PMI_RANK");
  scree_error error;
  scree_status status;
  if (worker || crew->jobs == 1 || launched) {
    status = crew->work(crew->call, crew->folder, &o, crew->call->progress, &error);
    if (status != SCREE_OK) status = cli_fail(&error);
  } else if (backend && strncmp(backend, "cuda", 4) == 0) {
    status = study_run_lanes(crew);
  } else {
    status = study_run_jobs(crew);
  }
  if (cli_interrupted() && !worker && !launched)
    fputs("scree: the same command goes on from there\n", stderr);
  return status;
}
