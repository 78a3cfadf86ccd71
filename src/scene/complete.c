/* A whole scene in a folder: chunks of steps, and between them frames, the series, the motion,
 * checkpoints and the watcher. Frames fall on the first step at or past their time, whatever the
 * chunks, so an interrupted scene writes the same frames as an uninterrupted one. */
#include "scene/scene.h"
#include "world/step/checkpoint.h"

#include "base/alloc.h"
#include "base/file.h"
#include "base/path.h"
#include "base/platform.h"
#include "base/quote.h"

#include <errno.h>
#include <string.h>

static const double chunk_seconds = 0.1; /* of the clock, between looks at it */
static const double watch_seconds = 0.2; /* between calls of the watcher */
static const double speed_seconds = 5;   /* the speed shown is over about as long */
enum { KEEP_STEPS = 2000 };              /* between states kept for a failure */
enum { FIRST_CHUNK = 20, LONGEST_CHUNK = 100000 };
enum { MOTION_FRAMES = 240 }; /* enough to be played */
static const char checkpoint_name[] = "checkpoint.scree", stopped_name[] = "stopped.scree";

typedef struct work {
  const scree_scene_job *job;
  scree_scene *scene;
  scree_motion_file motion;
  FILE *series;
  size_t rows_written, frame_count, chunk;
  double last_checkpoint, last_watch; /* on the clock */
  double speed_since, speed;
  uint64_t speed_steps;
} work;

static double now_of(const work *w) {
  return scree_world_time(w->scene->world);
}

static scree_status checkpoint(work *w, scree_error *error) {
  w->last_checkpoint = scree_now();
  if (!w->job->folder) return SCREE_OK;
  SCREE_TRY(
      scree_scene_save(w->scene, SCREE_PATH_IN(w->job->folder, checkpoint_name), true, error));
  return scree_scene_write_tables(w->scene, w->job->folder, error);
}

/* ---- series.csv ---- */

static scree_status fail_series(scree_error *error) {
  return scree_fail(error, SCREE_IO, "series.csv: cannot write: %s", strerror(errno));
}

/* The rows that are not written yet. A column is `NAME [UNIT]`, as in `time [s]`. */
static scree_status write_rows(work *w, scree_error *error) {
  const scree_scene *scene = w->scene;
  size_t columns = scene->columns.count;
  if (!w->series) return SCREE_OK;
  for (; w->rows_written < scene->row_count; w->rows_written++)
    for (size_t k = 0; k < columns; k++)
      fprintf(w->series, "%.9g%c", scene->series.items[w->rows_written * columns + k],
              k + 1 < columns ? ',' : '\n');
  return fflush(w->series) == 0 && !ferror(w->series) ? SCREE_OK : fail_series(error);
}

/* The series anew, with all rows so far: what was written after a checkpoint is written again. */
static scree_status open_series(work *w, scree_error *error) {
  const scree_scene *scene = w->scene;
  w->series = scree_open_stream(SCREE_PATH_IN(w->job->folder, "series.csv"), "wb");
  if (!w->series) return fail_series(error);
  fprintf(w->series, "# scree %s, ", scree_version());
  scree_quote(w->series, SCREE_QUOTE_COMMENT, scene->plan.title ? scene->plan.title : "");
  putc('\n', w->series);
  for (size_t k = 0; k < scene->columns.count; k++) {
    const scree_scene_column *c = &scene->columns.items[k];
    char title[160];
    snprintf(title, sizeof title, *c->unit ? "%s [%s]" : "%s", c->name, c->unit);
    if (k) putc(',', w->series);
    scree_quote(w->series, SCREE_QUOTE_CSV, title);
  }
  putc('\n', w->series);
  return write_rows(w, error);
}

/* ---- frames ---- */

static double next_frame(const work *w) {
  double interval = w->scene->plan.output->frames;
  return interval > 0 ? (double)w->frame_count * interval : INFINITY;
}

static scree_status save_state(work *w, const char *name, scree_error *error) {
  if (!w->job->folder || !w->job->states) return SCREE_OK;
  return scree_scene_save_frame(w->scene, SCREE_PATH_IN(w->job->folder, name), true, error);
}

static scree_status put_frames(work *w, bool last, scree_error *error) {
  char name[48];
  snprintf(name, sizeof name, "frame-%06zu.scree", w->frame_count);
  bool due = now_of(w) >= next_frame(w) || (last && isfinite(next_frame(w)));
  if (due) SCREE_TRY(save_state(w, name, error));
  if (due && w->job->frame)
    SCREE_TRY(w->job->frame(w->job->context, w->scene, w->frame_count, error));
  if (due) w->frame_count++;
  while (now_of(w) >= next_frame(w)) w->frame_count++; /* an interval shorter than a step */
  return SCREE_OK;
}

static scree_status open_motion(work *w, bool go_on, scree_error *error) {
  const scree_plan *plan = &w->scene->plan;
  double interval = plan->output->motion > 0 ? plan->output->motion
                                             : scree_scene_duration(w->scene) / MOTION_FRAMES;
  interval = fmax(interval, w->scene->time_step); /* one may end at its beginning */
  return scree_motion_open(&w->motion, SCREE_PATH_IN(w->job->folder, "motion.scree"), interval,
                           go_on, now_of(w), error);
}

static scree_status put_motion(work *w, bool last, scree_error *error) {
  if (now_of(w) < scree_motion_next(&w->motion) && !last) return SCREE_OK;
  return scree_motion_put(&w->motion, w->scene->world, error);
}

/* Steps that stay before the next frame of either kind, or one. */
static size_t steps_to_frame(const work *w) {
  double next = fmin(next_frame(w), scree_motion_next(&w->motion));
  double until = floor((next - now_of(w)) / w->scene->time_step) - 1;
  if (until >= (double)w->chunk) return w->chunk;
  return until > 1 ? (size_t)until : 1;
}

/* ---- watching ---- */

static void measure_speed(work *w, double now) {
  uint64_t steps = scree_world_step_count(w->scene->world);
  double span = now - w->speed_since;
  if (span < (isnan(w->speed) ? 1 : speed_seconds)) return;
  w->speed = (double)(steps - w->speed_steps) / span;
  w->speed_since = now;
  w->speed_steps = steps;
}

/* Time left on the clock, by what the steps so far have cost; NAN: these are too few to say. What a
 * full machine makes it wait for in its first seconds says little of the rest. */
static double seconds_left(const work *w) {
  const double doubted = 5; /* s */
  scree_scene_costs c = scree_scene_get_costs(w->scene);
  scree_scene_forecast f;
  if (isnan(w->speed) || fmin(c.wall_seconds, c.processor_seconds) < 0.1) return NAN;
  scree_scene_foretell(w->scene, &f);
  return f.seconds * (c.wall_seconds + doubted) / (c.processor_seconds + doubted);
}

static bool watch(work *w, bool always) {
  double now = scree_now(), fraction = scree_scene_fraction(w->scene);
  if (!w->job->watch || (!always && now - w->last_watch < watch_seconds)) return true;
  w->last_watch = now;
  measure_speed(w, now);
  scree_scene_state state = {w->scene, now_of(w), fraction, w->speed, seconds_left(w)};
  return w->job->watch(w->job->context, &state);
}

/* ---- the loop ---- */

static void tune_chunk(work *w, double seconds) {
  if (seconds < 0.5 * chunk_seconds && w->chunk < LONGEST_CHUNK) w->chunk *= 2;
  if (seconds > 2 * chunk_seconds && w->chunk > 1) w->chunk /= 2;
}

/* One that leaves the range of the contact law leaves a state shortly before. */
static scree_status keep_state(work *w, scree_error *error) {
  if (!w->job->folder) return SCREE_OK;
  const char *path = SCREE_PATH_IN(w->job->folder, stopped_name);
  (void)scree_path_remove(path); /* what an earlier try left; mostly there is none */
  return scree_world_keep_all(w->scene->world, path, KEEP_STEPS, scree_scene_pack, w->scene, error);
}

static scree_status cancel(work *w, scree_error *error) {
  SCREE_TRY(checkpoint(w, error));
  return scree_fail(error, SCREE_CANCELLED, "cancelled at %.6g s of simulated time%s", now_of(w),
                    w->job->folder ? "; it can be resumed from its checkpoint" : "");
}

static scree_status go_on(work *w, scree_error *error) {
  while (!w->scene->end) {
    SCREE_TRY(put_frames(w, false, error));
    SCREE_TRY(put_motion(w, false, error));
    double start = scree_now();
    size_t steps = steps_to_frame(w);
    SCREE_TRY(scree_scene_advance(w->scene, steps, error));
    SCREE_TRY(write_rows(w, error));
    if (steps == w->chunk) tune_chunk(w, scree_now() - start);
    if (!watch(w, false)) return cancel(w, error);
    if (scree_now() - w->last_checkpoint >= w->scene->plan.output->checkpoint)
      SCREE_TRY(checkpoint(w, error));
  }
  SCREE_TRY(put_frames(w, true, error));
  SCREE_TRY(put_motion(w, true, error));
  SCREE_TRY(checkpoint(w, error));
  SCREE_TRY(save_state(w, "last.scree", error));
  watch(w, true);
  return SCREE_OK;
}

/* ---- beginning, or going on ---- */

/* A checkpoint's scene goes on by this file, where it says the same. */
static scree_status take_over(scree_scene *scene, const scree_scene_file *file, const char *path,
                              scree_error *error) {
  scree_plan plan;
  SCREE_OWNED(scree_scene_file, scaled);
  const scree_scene_extent extent = scree_scene_get_extent(scene);
  SCREE_CLEANUP(scree_free_at) char *text = NULL;
  if (scree_scene_file_scales(file))
    SCREE_TRY(scree_scene_file_scale(file, &extent, &scaled, error));
  if (scaled) file = scaled;
  SCREE_TRY(scree_scene_file_text(file, &text, error));
  SCREE_TRY(scree_scene_check_same(scene, text, path, error));
  SCREE_TRY(scree_scene_file_plan(file, &scene->arena, &plan, error));
  scree_scene_reopen(scene, &plan);
  scene->plan.title = plan.title;
  scene->plan.time = plan.time;
  scene->plan.stop = plan.stop;
  scene->plan.output = plan.output;
  scree_free(scene->text);
  scene->text = text;
  text = NULL;
  return SCREE_OK;
}

static scree_status check_found(work *w, const char *path, scree_error *error) {
  const scree_scene *scene = w->scene;
  if (scene->is_frame)
    return scree_fail(error, SCREE_BAD_FILE, "%s: is a frame, not a checkpoint", path);
  if (scene->world->diverged)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: was saved after its scene had failed, and cannot go on: %.700s", path,
                      scene->world->failure.message);
  return w->job->file ? take_over(w->scene, w->job->file, path, error) : SCREE_OK;
}

/* Loads the checkpoint into w->scene, which stays NULL where there is none. */
static scree_status find_checkpoint(work *w, scree_error *error) {
  const char *path = SCREE_PATH_IN(w->job->folder, checkpoint_name);
  if (!scree_path_exists(path) || (!w->job->resume && w->job->overwrite)) return SCREE_OK;
  if (!w->job->resume)
    return scree_fail(error, SCREE_EXISTS, "%s: exists already: a scene was begun here", path);
  SCREE_TRY(scree_scene_load(path, &w->scene, error));
  SCREE_TRY(check_found(w, path, error));
  w->scene->costs.piece_count++;
  if (w->job->change_count) {
    SCREE_TRY(scree_scene_change(&w->scene, w->job->changes, w->job->change_count, error));
    SCREE_TRY(scree_scene_save(w->scene, path, true, error));
  }
  /* that of this very moment comes after its checkpoint */
  while (now_of(w) - 0.5 * w->scene->time_step > next_frame(w)) w->frame_count++;
  return SCREE_OK;
}

static scree_status make_scene(work *w, scree_error *error) {
  const scree_scene_job *job = w->job;
  if (job->file)
    return scree_scene_create_from(job->file, job->store, job->progress, &w->scene, error);
  return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no checkpoint to go on from",
                    job->folder ? job->folder : "no folder");
}

static scree_status prepare(work *w, scree_error *error) {
  const scree_scene_job *job = w->job;
  if (job->folder) SCREE_TRY(scree_folder_create(job->folder, error));
  if (job->folder) SCREE_TRY(find_checkpoint(w, error));
  bool resumed = w->scene != NULL;
  if (!resumed) SCREE_TRY(make_scene(w, error));
  if (job->begun) SCREE_TRY(job->begun(job->context, w->scene, resumed, error));
  if (job->folder) SCREE_TRY(open_series(w, error));
  if (job->folder && !job->no_motion) SCREE_TRY(open_motion(w, resumed, error));
  return keep_state(w, error);
}

scree_status scree_scene_complete(const scree_scene_job *job, scree_scene **scene,
                                  scree_error *error) {
  double now = scree_now();
  work w = {.job = job,
            .chunk = FIRST_CHUNK,
            .last_checkpoint = now,
            .last_watch = -INFINITY,
            .speed_since = now,
            .speed = NAN};
  scree_status status = prepare(&w, error);
  if (status == SCREE_OK) {
    w.speed_steps = scree_world_step_count(w.scene->world);
    status = go_on(&w, error);
  }
  bool stopped = status == SCREE_CANCELLED || status == SCREE_DIVERGED;
  bool stands = status == SCREE_OK || stopped;
  if (stopped && w.scene) put_motion(&w, true, NULL);
  scree_motion_close(&w.motion);
  if (w.series && fclose(w.series) != 0 && status == SCREE_OK) {
    status = fail_series(error);
    stands = false;
  }
  if (!stands) scree_scene_free(w.scene);
  *scene = stands ? w.scene : NULL;
  return status;
}
