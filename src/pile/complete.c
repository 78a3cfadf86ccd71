/* A whole run in a folder: chunks of steps, and between them frames, checkpoints and the watcher.
 * Frames fall on the first step at or past their time, whatever the chunks, so an interrupted run
 * writes the same frames as an uninterrupted one. */
#include "pile/run.h"
#include "scene/motion.h"

#include "base/alloc.h"
#include "base/file.h"
#include "base/platform.h"
#include "base/progress.h"

#include <string.h>

static const double chunk_seconds = 0.1; /* of the clock, between looks at it */
static const double watch_seconds = 0.2; /* between calls of the watcher */
static const double speed_seconds = 5;   /* the speed shown is over about as long */
static const char stopped_name[] = "stopped.scree";
enum { KEEP_STEPS = 2000 }; /* between states kept: a thousandth of the time */
enum { FIRST_CHUNK = 20, LONGEST_CHUNK = 100000 };
enum { MOTION_FRAMES = 240 }; /* of the longest schedule: enough to be played, some 4 MB */

typedef struct work {
  const scree_run_job *job;
  scree_run *run;
  scree_motion_file motion;
  size_t frame_count;                           /* frames due so far */
  size_t chunk;                                 /* steps */
  double last_checkpoint, last_watch;           /* on the clock */
  double speed_since, speed, speed_at_fraction; /* on the clock; steps/s */
  double fraction_speed;                        /* of the fraction, 1/s */
  uint64_t speed_steps;
} work;

/* folder/name, to be freed; NULL after filling the error. */
static char *path_in(const work *w, const char *name, scree_error *error) {
  size_t size = strlen(w->job->folder) + strlen(name) + 2;
  char *path = scree_alloc(size, 1);
  if (!path)
    scree_fail_memory(error, size, "a path");
  else
    snprintf(path, size, "%s/%s", w->job->folder, name);
  return path;
}

static scree_status save_as(const work *w, const char *name, bool as_frame, scree_error *error) {
  if (!w->job->folder) return SCREE_OK;
  char *path = path_in(w, name, error);
  if (!path) return SCREE_OUT_OF_MEMORY;
  scree_status status = as_frame ? scree_run_save_frame(w->run, path, true, error)
                                 : scree_run_save(w->run, path, true, error);
  scree_free(path);
  return status;
}

static scree_status checkpoint(work *w, scree_error *error) {
  scree_status status = save_as(w, "checkpoint.scree", false, error);
  w->last_checkpoint = scree_now();
  return status;
}

/* ---- frames ---- */

static double next_frame(const work *w) {
  double interval = w->run->experiment.frame_interval;
  return interval > 0 ? (double)w->frame_count * interval : INFINITY;
}

static scree_status write_frames(work *w, scree_error *error) {
  scree_status status = SCREE_OK;
  while (status == SCREE_OK && scree_world_time(w->run->world) >= next_frame(w)) {
    char name[48];
    snprintf(name, sizeof name, "frame-%04zu.scree", w->frame_count);
    status = save_as(w, name, true, error);
    if (status == SCREE_OK && w->job->frame)
      status = w->job->frame(w->job->context, w->run, w->frame_count, error);
    w->frame_count++;
  }
  return status;
}

static scree_status open_motion(work *w, bool go_on, scree_error *error) {
  const scree_experiment *e = &w->run->experiment;
  double schedule = e->pack_time + e->settle_time + e->lift_time + e->hold_time;
  char *path = path_in(w, "motion.scree", error);
  if (!path) return SCREE_OUT_OF_MEMORY;
  scree_status status = scree_motion_open(&w->motion, path, schedule / MOTION_FRAMES, go_on,
                                          scree_world_time(w->run->world), error);
  scree_free(path);
  return status;
}

static scree_status put_motion(work *w, bool last, scree_error *error) {
  bool due = scree_world_time(w->run->world) >= scree_motion_next(&w->motion);
  if (!due && !last) return SCREE_OK;
  return scree_motion_put(&w->motion, w->run->world, scree_run_cylinder_height(w->run), error);
}

/* As many steps as stay before the next frame of either kind, or one. */
static size_t steps_to_frame(const work *w) {
  double dt = scree_world_time_step(w->run->world, NULL);
  double next = fmin(next_frame(w), scree_motion_next(&w->motion));
  double until = floor((next - scree_world_time(w->run->world)) / dt) - 1;
  if (until >= (double)w->chunk) return w->chunk;
  return until > 1 ? (size_t)until : 1;
}

/* ---- watching ---- */

static void measure_speed(work *w, double now) {
  uint64_t steps = scree_world_step_count(w->run->world);
  double span = now - w->speed_since;
  if (span < (isnan(w->speed) ? 1 : speed_seconds)) return;
  double fraction = scree_run_fraction(w->run);
  w->speed = (double)(steps - w->speed_steps) / span;
  w->fraction_speed = (fraction - w->speed_at_fraction) / span;
  w->speed_since = now;
  w->speed_steps = steps;
  w->speed_at_fraction = fraction;
}

static bool watch(work *w, bool always) {
  double now = scree_now();
  if (!w->job->watch || (!always && now - w->last_watch < watch_seconds)) return true;
  w->last_watch = now;
  measure_speed(w, now);
  scree_run_state state = {.run = w->run,
                           .now = scree_run_point_now(w->run),
                           .fraction = scree_run_fraction(w->run),
                           .steps_per_second = w->speed,
                           .seconds_left = NAN};
  if (w->fraction_speed > 0) state.seconds_left = (1 - state.fraction) / w->fraction_speed;
  return w->job->watch(w->job->context, &state);
}

/* ---- the loop ---- */

static void tune_chunk(work *w, double seconds) {
  if (seconds < 0.5 * chunk_seconds && w->chunk < LONGEST_CHUNK) w->chunk *= 2;
  if (seconds > 2 * chunk_seconds && w->chunk > 1) w->chunk /= 2;
}

/* A run that leaves the range of the contact law leaves a state shortly before. */
static scree_status keep_state(work *w, scree_error *error) {
  if (!w->job->folder) return SCREE_OK;
  char *path = path_in(w, stopped_name, error);
  if (!path) return SCREE_OUT_OF_MEMORY;
  scree_status status =
      scree_world_keep_all(w->run->world, path, KEEP_STEPS, scree_run_pack, w->run, error);
  scree_free(path);
  return status;
}

/* What an earlier try left is not of this run any more. */
static scree_status forget_failure(const work *w, scree_error *error) {
  if (!w->job->folder) return SCREE_OK;
  char *path = path_in(w, stopped_name, error);
  if (!path) return SCREE_OUT_OF_MEMORY;
  (void)remove(path); /* mostly there is none */
  scree_free(path);
  return SCREE_OK;
}

static scree_status go_on(work *w, scree_error *error) {
  while (scree_run_phase(w->run) != SCREE_PHASE_DONE) {
    scree_status status = write_frames(w, error);
    if (status == SCREE_OK) status = put_motion(w, false, error);
    if (status != SCREE_OK) return status;
    double start = scree_now();
    size_t steps = steps_to_frame(w);
    status = scree_run_advance(w->run, steps, error);
    if (status != SCREE_OK) return status;
    if (steps == w->chunk) tune_chunk(w, scree_now() - start);
    bool more = watch(w, false);
    if (!more || scree_now() - w->last_checkpoint >= w->run->experiment.checkpoint_interval)
      status = checkpoint(w, error);
    if (status != SCREE_OK) return status;
    if (!more)
      return scree_fail(error, SCREE_CANCELLED, "cancelled at %.6g s of simulated time%s",
                        scree_world_time(w->run->world),
                        w->job->folder ? "; the checkpoint is written" : "");
  }
  scree_status status = write_frames(w, error);
  if (status == SCREE_OK) status = put_motion(w, true, error);
  if (status == SCREE_OK) status = save_as(w, "last.scree", true, error);
  if (status == SCREE_OK) status = checkpoint(w, error);
  if (status == SCREE_OK) status = forget_failure(w, error);
  watch(w, true);
  return status;
}

/* ---- beginning, or going on ---- */

/* Only where and how often things are written may differ. */
static scree_status check_experiment(const scree_experiment *now, const scree_experiment *saved,
                                     const char *path, scree_error *error) {
  for (size_t i = 0; scree_experiment_key(i); i++) {
    const char *key = scree_experiment_key(i);
    char a[64], b[64];
    if (!strcmp(key, "output.frame_interval") || !strcmp(key, "output.checkpoint_interval"))
      continue;
    scree_experiment_get(now, key, a, sizeof a);
    scree_experiment_get(saved, key, b, sizeof b);
    if (strcmp(a, b) != 0)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "%s: is of another experiment: %s is %s there and %s here", path, key, b,
                        a);
  }
  return SCREE_OK;
}

static bool same_shape(const scree_run_shape *a, const scree_run_shape *b) {
  const scree_particle_measures *m = &a->particle->measures, *n = &b->particle->measures;
  return a->density_factor == b->density_factor && m->kind == n->kind && m->volume == n->volume &&
         m->bounding_radius == n->bounding_radius && m->triangle_count == n->triangle_count &&
         m->point_count == n->point_count && m->inertia[0] == n->inertia[0] &&
         m->inertia[2] == n->inertia[2];
}

static scree_status check_job(const scree_run_job *job, const scree_run *run, const char *path,
                              scree_error *error) {
  if (run->is_frame)
    return scree_fail(error, SCREE_BAD_FILE, "%s: is a frame, not a checkpoint", path);
  if (run->world->diverged)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: was saved after its run had failed, and cannot go on: %.700s", path,
                      run->world->failure.message);
  if (!job->experiment) return SCREE_OK;
  scree_status status = check_experiment(job->experiment, &run->experiment, path, error);
  if (status != SCREE_OK || !job->shapes) return status;
  bool same = job->shape_count == run->shape_count;
  for (size_t i = 0; same && i < run->shape_count; i++)
    same = same_shape(&job->shapes[i], &run->shapes[i]);
  if (!same) return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: is of other shapes", path);
  return SCREE_OK;
}

/* Loads the checkpoint into w->run, which stays NULL where there is none. */
static scree_status find_checkpoint(work *w, scree_error *error) {
  char *path = path_in(w, "checkpoint.scree", error);
  if (!path) return SCREE_OUT_OF_MEMORY;
  scree_status status = SCREE_OK;
  if (!scree_path_exists(path)) goto done;
  if (!w->job->resume) {
    if (!w->job->overwrite)
      status = scree_fail(error, SCREE_EXISTS, "%s: exists already: a run was begun here", path);
    goto done;
  }
  status = scree_run_load(path, &w->run, error);
  if (status == SCREE_OK) status = check_job(w->job, w->run, path, error);
  if (status != SCREE_OK) goto done;
  if (w->job->experiment) {
    w->run->experiment.frame_interval = w->job->experiment->frame_interval;
    w->run->experiment.checkpoint_interval = w->job->experiment->checkpoint_interval;
  }
  w->run->piece_count++;
  while (scree_world_time(w->run->world) >= next_frame(w)) w->frame_count++;
done:
  scree_free(path);
  return status;
}

static scree_status begin(work *w, scree_error *error) {
  const scree_run_job *job = w->job;
  if (!job->experiment || !job->shapes)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no checkpoint to go on from",
                      job->folder ? job->folder : "no folder");
  return scree_run_create(job->experiment, job->shapes, job->shape_count, &w->run, error);
}

static scree_status prepare(work *w, scree_error *error) {
  const scree_run_job *job = w->job;
  scree_status status = SCREE_OK;
  if (job->folder) status = scree_folder_create(job->folder, error);
  if (job->folder && status == SCREE_OK) status = find_checkpoint(w, error);
  bool go_on = w->run != NULL;
  if (status == SCREE_OK && !go_on) status = begin(w, error);
  return status == SCREE_OK && job->folder && job->motion ? open_motion(w, go_on, error) : status;
}

scree_status scree_run_complete(const scree_run_job *job, scree_run **run, scree_error *error) {
  double now = scree_now();
  work w = {.job = job,
            .chunk = FIRST_CHUNK,
            .last_checkpoint = now,
            .last_watch = -INFINITY,
            .speed_since = now,
            .speed = NAN};
  scree_status status = prepare(&w, error);
  if (status == SCREE_OK) {
    w.speed_steps = scree_world_step_count(w.run->world);
    w.speed_at_fraction = scree_run_fraction(w.run);
    status = keep_state(&w, error);
    if (status == SCREE_OK) status = go_on(&w, error);
  }
  scree_motion_close(&w.motion);
  if (status == SCREE_OK)
    *run = w.run;
  else
    scree_run_free(w.run);
  return status;
}
