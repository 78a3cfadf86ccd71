/* Working on runs. A run is taken by its lease, worked on from its last checkpoint, and ends with a
 * record. What is the run's fault (its shapes, its numbers, a run that diverges) is recorded and
 * the next run taken; what is the machine's (no memory, no disk, no device) ends the work and
 * leaves the run to others. A run in which several workers died one after the other is a failed
 * one: whatever kills them is in it. */
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "scene/file.h"
#include "study/lease.h"
#include "study/record.h"

#include <math.h>
#include <string.h>

enum { RETRIES_KEPT = 1000 };

typedef struct work {
  scree_study *study;
  const scree_study_options *options;
  const scree_progress *progress;
  char worker[SCREE_LEASE_NAME], machine[160];
  const char *leases; /* folder */
  size_t first;       /* run to look at first: all before it have ended */
  /* the run at hand */
  size_t run;
  scree_lease lease;
  bool lost;      /* somebody else has it now */
  bool cancelled; /* from outside */
  scree_status renewal;
  scree_error renewal_error;
} work;

static void describe_machine(char machine[160]) {
  char host[SCREE_SYSTEM_TEXT], processor[SCREE_SYSTEM_TEXT];
  scree_host_name(host);
  scree_processor_name(processor);
  snprintf(machine, 160, "%.63s, %.80s", host, processor);
}

/* A file of the run, until the end of the block. */
#define RUN_FILE(w, kind, ending)                                                                  \
  SCREE_STUDY_PATH((w)->study, kind, (w)->study->keys[(w)->run], ending)

/* Whether the run has a record. One that cannot be read is put aside, and the run waits again. */
static bool has_ended(const work *w) {
  return scree_path_exists(RUN_FILE(w, "results", ".yaml"));
}

/* ---- one run ---- */

/* A sign of life, and progress; false: the run is to stop. */
static bool keep_lease(work *w, double done, const char *what) {
  char note[SCREE_LEASE_NOTE], phase[200], fraction[SCREE_NUMBER_SIZE];
  double interval = fmin(5, 0.2 * w->options->lease_s);
  if (scree_now() - w->lease.last_renewal > interval) {
    bool kept = true;
    scree_number_format_digits(done, 4, fraction);
    snprintf(note, sizeof note, "running %s %s", fraction, what);
    w->renewal = scree_lease_renew(&w->lease, note, &kept, &w->renewal_error);
    w->lost = !kept;
  }
  snprintf(phase, sizeof phase, "run %zu: %s", w->run + 1, what);
  if (w->progress && w->progress->report)
    w->cancelled = !w->progress->report(w->progress->context, phase, done);
  return !w->cancelled && !w->lost && w->renewal == SCREE_OK;
}

static bool watch(void *context, const scree_scene_state *state) {
  const char *phase = scree_scene_phase(state->scene);
  return keep_lease(context, state->fraction, phase ? phase : "scene");
}

/* To its end; a checkpoint that cannot be read is thrown away once. */
static scree_status simulate(work *w, const scree_scene_file *file, scree_shape_store *store,
                             scree_study_record *record, scree_error *error) {
  SCREE_OWNED(scree_scene, scene);
  scree_scene_job job = {.file = file,
                         .folder = RUN_FILE(w, "runs", ""),
                         .resume = true,
                         .states = true,
                         /* one of each point to look at */
                         .no_motion = scree_study_run_replicate(w->study, w->run) > 0,
                         .store = store,
                         .watch = watch,
                         .context = w};
  scree_error own;
  scree_status status = scree_scene_complete(&job, &scene, &own);
  if (status == SCREE_BAD_FILE) {
    job.resume = false;
    job.overwrite = true;
    status = scree_scene_complete(&job, &scene, &own);
  }
  if (status == SCREE_OK) return scree_study_record_scene(w->study, scene, record, error);
  if (error) *error = own;
  return status;
}

/* ---- one run of a command ---- */

static bool watch_command(void *context) {
  return keep_lease(context, 0, "command");
}

static scree_status run_command(work *w, scree_study_record *record, scree_error *error) {
  const char *folder = RUN_FILE(w, "runs", "");
  double wall = scree_now();
  scree_status status = scree_folder_create(folder, error);
  if (status == SCREE_OK)
    status = scree_study_record_command(w->study, w->run, folder, watch_command, w, record, error);
  record->costs.wall_seconds = record->costs.processor_seconds = scree_now() - wall;
  return status;
}

static scree_status make_and_simulate(work *w, scree_study_record *record, scree_error *error) {
  SCREE_OWNED(scree_scene_file, file);
  SCREE_OWNED(scree_shape_store, store);
  if (w->study->command.count) return run_command(w, record, error);
  SCREE_TRY(scree_study_run_scene(w->study, w->run, &file, error));
  SCREE_TRY(scree_shape_store_create(&store, error));
  SCREE_TRY(scree_study_stock(w->study, w->run, file, store, &record->triangle_count, error));
  return simulate(w, file, store, record, error);
}

/* What says that another run would fare no better here. */
static bool is_machines_fault(scree_status status) {
  return status == SCREE_IO || status == SCREE_OUT_OF_MEMORY || status == SCREE_CANCELLED ||
         status == SCREE_NO_BACKEND; /* a device that is lost */
}

static scree_status write_record(const work *w, const scree_study_record *record,
                                 scree_error *error) {
  SCREE_TRY(scree_study_record_write(record, RUN_FILE(w, "results", ".yaml"), error));
  scree_path_remove(RUN_FILE(w, "runs", "/checkpoint.scree")); /* the last frame stays */
  return SCREE_OK;
}

static void record_failure(scree_study_record *record, const char *reason) {
  scree_study_record_free(record);
  record->failed = true;
  record->result.pile.repose = (scree_repose){.sector_deg = NAN,
                                              .sector_sd_deg = NAN,
                                              .cone_deg = NAN,
                                              .silhouette_deg = NAN,
                                              .silhouette_sd_deg = NAN};
  snprintf(record->reason, sizeof record->reason, "%.500s", reason);
}

/* Whether a run has given what was asked: then names are right. */
static bool any_succeeded(work *w) {
  size_t run = w->run;
  bool found = false;
  for (w->run = 0; !found && w->run < scree_study_run_count(w->study); w->run++) {
    SCREE_CLEANUP(scree_study_record_free) scree_study_record record = {0};
    const char *path = RUN_FILE(w, "results", ".yaml");
    found = scree_path_exists(path) && scree_study_record_read(path, &record, NULL) == SCREE_OK &&
            !record.failed;
  }
  w->run = run;
  return found;
}

/* Works on w->run, whose lease is ours. */
static scree_status do_run(work *w, scree_error *error) {
  SCREE_CLEANUP(scree_study_record_free)
  scree_study_record record = {.started = scree_calendar_time()};
  scree_error reason = {0};
  char last[SCREE_LEASE_NAME] = "", name[64];
  snprintf(record.worker, sizeof record.worker, "%s", w->worker);
  snprintf(record.machine, sizeof record.machine, "%s", w->machine);
  snprintf(record.version, sizeof record.version, "%s", scree_version());
  snprintf(name, sizeof name, "run-%s", w->study->keys[w->run]);
  w->lost = w->cancelled = false;
  w->renewal = SCREE_OK;
  scree_status status = SCREE_LIMIT;
  size_t deaths = scree_lease_deaths(w->leases, name, last);
  if (deaths >= w->study->attempt_limit)
    scree_fail(&reason, status, "%zu workers died in it, the last one was %s", deaths, last);
  else
    status = make_and_simulate(w, &record, &reason);
  record.ended = scree_calendar_time();
  bool slip = w->study->command.count && status == SCREE_UNSUPPORTED && !any_succeeded(w);
  if (w->lost || slip || is_machines_fault(status)) {
    if (w->lost) return SCREE_OK; /* whoever has it now goes on */
    if (w->renewal != SCREE_OK) reason = w->renewal_error;
    if (error) *error = reason;
    return w->renewal != SCREE_OK ? w->renewal : status;
  }
  if (status != SCREE_OK) record_failure(&record, reason.message);
  SCREE_TRY(write_record(w, &record, error));
  scree_lease_forget_deaths(w->leases, name);
  return SCREE_OK;
}

/* ---- many runs ---- */

/* Takes the first run that waits; *taken false where all have ended or are in good hands; *open
 * counts those that have not ended. */
static scree_status take_run(work *w, bool *taken, size_t *open, scree_error *error) {
  size_t count = scree_study_run_count(w->study);
  *taken = false;
  *open = 0;
  for (size_t i = w->first; i < count && !*taken; i++) {
    char name[64];
    w->run = i;
    bool ended = has_ended(w);
    if (ended && *open == 0) w->first = i + 1;
    if (ended) continue;
    ++*open;
    snprintf(name, sizeof name, "run-%s", w->study->keys[i]);
    SCREE_TRY(
        scree_lease_take(w->leases, name, w->options->lease_s, w->worker, taken, &w->lease, error));
    if (!*taken) continue;
    /* it may have ended between the look and the lease */
    if (!has_ended(w)) continue;
    scree_lease_release(&w->lease);
    *taken = false;
  }
  return SCREE_OK;
}

/* Records of failures are moved aside: KEY.failed-N. */
static void reopen_failed(work *w) {
  for (w->run = 0; w->run < scree_study_run_count(w->study); w->run++) {
    const char *path = RUN_FILE(w, "results", ".yaml");
    SCREE_CLEANUP(scree_study_record_free) scree_study_record record = {0};
    if (!scree_path_exists(path) || scree_study_record_read(path, &record, NULL) != SCREE_OK)
      continue;
    for (int n = 1; record.failed && n < RETRIES_KEPT; n++) {
      char ending[32];
      snprintf(ending, sizeof ending, ".failed-%d", n);
      const char *aside = RUN_FILE(w, "results", ending);
      if (scree_path_exists(aside)) continue;
      scree_path_rename(path, aside);
      break;
    }
  }
}

/* Takes the answers anew from the last frame, or what the command printed. SCREE_IO and
 * SCREE_BAD_FILE where these are gone: the run has to be made again. */
static scree_status answer_again(const scree_study *study, size_t run, scree_study_record *record,
                                 scree_error *error) {
  bool command = study->command.count > 0;
  const char *path =
      SCREE_STUDY_PATH(study, "runs", study->keys[run], command ? "" : "/last.scree");
  SCREE_OWNED(scree_scene, scene);
  scree_status status = command ? scree_study_answer_command(study, path, record, error)
                                : scree_scene_load(path, &scene, error);
  if (scene) status = scree_study_answer_scene(study, scene, record, error);
  record->ended = nextafter(record->ended, INFINITY); /* the database sees that it is another */
  return status;
}

/* Answers anew for a run that ended before the study asked for what it asks now; SCREE_BAD_FILE
 * where it has to be made again. */
static scree_status renew_answers(const work *w, const char *path, scree_study_record *record) {
  char mark[SCREE_CHECKSUM_TEXT];
  scree_study_answers_mark(w->study, mark);
  if (record->failed || !strcmp(mark, record->answered)) return SCREE_OK;
  scree_status status = answer_again(w->study, w->run, record, NULL);
  if (status == SCREE_OK) return scree_study_record_write(record, path, NULL);
  return status == SCREE_OUT_OF_MEMORY ? status : SCREE_BAD_FILE;
}

/* A record that cannot be read is no result, nor is one without what is asked for: the run waits
 * again. */
static void put_broken_aside(work *w) {
  for (w->run = 0; w->run < scree_study_run_count(w->study); w->run++) {
    const char *path = RUN_FILE(w, "results", ".yaml");
    SCREE_CLEANUP(scree_study_record_free) scree_study_record record = {0};
    if (!scree_path_exists(path)) continue;
    scree_status status = scree_study_record_read(path, &record, NULL);
    if (status == SCREE_OK) status = renew_answers(w, path, &record);
    if (status == SCREE_BAD_FILE) scree_path_rename(path, RUN_FILE(w, "results", ".broken"));
  }
}

static scree_status work_on(work *w, size_t *completed, scree_error *error) {
  for (;;) {
    bool taken;
    size_t open;
    if (w->options->run_limit && *completed >= w->options->run_limit) return SCREE_OK;
    SCREE_TRY(take_run(w, &taken, &open, error));
    if (taken) {
      scree_status status = do_run(w, error);
      scree_lease_release(&w->lease);
      SCREE_TRY(status);
      ++*completed;
      /* for those who look; what is wrong with the database is told at the end */
      scree_study_collect(w->study, false, NULL);
    } else {
      if (open == 0 || !w->options->wait) return SCREE_OK;
      SCREE_TRY(scree_study_pause(w->options, w->progress, "others work on what is left", error));
    }
  }
}

scree_status scree_study_reopen(scree_study *study, scree_error *error) {
  work w = {.study = study};
  if (!study->keys)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a study must be prepared before work on it");
  reopen_failed(&w);
  return SCREE_OK;
}

scree_status scree_study_work(scree_study *study, const scree_study_options *options,
                              const scree_progress *progress, size_t *completed,
                              scree_error *error) {
  const scree_study_options defaults = scree_default_study_options();
  if (!options) options = &defaults;
  work w = {.study = study, .options = options, .progress = progress};
  size_t done = 0;
  if (!study->keys)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a study must be prepared before work on it");
  if (options->worker)
    snprintf(w.worker, sizeof w.worker, "%s", options->worker);
  else
    scree_lease_default_worker(w.worker);
  describe_machine(w.machine);
  w.leases = SCREE_STUDY_PATH(study, "leases", "", "");
  put_broken_aside(&w);
  scree_status status = work_on(&w, &done, error);
  if (completed) *completed = done;
  return status;
}
