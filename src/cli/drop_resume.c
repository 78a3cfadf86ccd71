/* Checkpoints of a drop, and going on from one. Beside the pour a checkpoint has, as its notes,
 * where the files stand: what was written after it is written again. */
#include "cli/drop.h"

#include "base/platform.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NOTES = 5 }; /* then the times of the frames */

scree_status drop_save(drop_run *run, scree_error *error) {
  char path[DROP_PATH_BYTES];
  const drop_schedule *s = &run->schedule;
  size_t count = NOTES + run->frames.count;
  scree_status status = drop_path(run, "checkpoint.scree", path, error);
  if (status != SCREE_OK) return status;
  if (fflush(run->series) != 0) return drop_no_series(error);
  double *notes = malloc(count * sizeof *notes);
  if (!notes) return drop_no_memory(error);
  const double first[NOTES] = {s->next_frame, s->next_line, s->still_since, s->still ? 1 : 0,
                               (double)ftello(run->series)};
  memcpy(notes, first, sizeof first);
  for (size_t i = 0; i < run->frames.count; i++) notes[NOTES + i] = run->frames.times[i];
  status = scree_pour_set_notes(run->pour, notes, count, error);
  free(notes);
  return status == SCREE_OK ? scree_pour_save(run->pour, path, true, error) : status;
}

/* ---- whether it is the same pour ---- */

/* What the command line says of a pour, by the names of its options. */
static const char *const setting_names[] = {"container",
                                            "width",
                                            "depth",
                                            "drop-height",
                                            "speed",
                                            "seed",
                                            "law",
                                            "density",
                                            "young",
                                            "young-wall",
                                            "friction",
                                            "friction-wall",
                                            "restitution",
                                            "steps-per-contact",
                                            "stiffness-factor"};
enum { SETTINGS = sizeof setting_names / sizeof *setting_names };

static void list_settings(const scree_pour_options *o, double settings[SETTINGS]) {
  const scree_world_options *w = &o->world;
  const double all[SETTINGS] = {(double)o->container,
                                o->width,
                                o->depth,
                                o->drop_height,
                                o->entry_speed,
                                (double)o->seed,
                                (double)w->law,
                                o->particles.density,
                                o->particles.stiffness,
                                o->walls.stiffness,
                                o->particles.friction,
                                o->walls.friction,
                                o->particles.restitution,
                                w->steps_per_contact,
                                w->stiffness_factor};
  memcpy(settings, all, sizeof all);
}

/* A setting left at its default is not asked for where no shapes are given. */
static scree_status check_settings(const drop_run *run, const char *path, scree_error *error) {
  scree_pour_options saved, asked = drop_pour_options(run->arguments),
                            usual = drop_pour_options(drop_defaults()),
                            raw = drop_pour_options(run->given);
  double there[SETTINGS], here[SETTINGS], defaults[SETTINGS], given[SETTINGS];
  scree_pour_get_options(run->pour, &saved);
  list_settings(&saved, there);
  list_settings(&asked, here);
  list_settings(&usual, defaults);
  list_settings(&raw, given);
  for (int i = 0; i < SETTINGS; i++) {
    bool open = (i == 1 || i == 2) && here[i] == 0; /* width and depth: chosen by the pour */
    open = open || (run->shape_count == 0 && isnan(given[i]));
    if (here[i] == there[i] || open || (run->shape_count == 0 && here[i] == defaults[i])) continue;
    char reason[160];
    snprintf(reason, sizeof reason, "is of another pour: %s is %g there and %g here",
             setting_names[i], there[i], here[i]);
    return cli_refuse(error, SCREE_BAD_ARGUMENT, path, reason);
  }
  return SCREE_OK;
}

static bool same_particle(const scree_particle *a, const scree_particle *b) {
  scree_particle_measures m, n;
  scree_particle_measure(a, &m);
  scree_particle_measure(b, &n);
  return m.kind == n.kind && m.volume == n.volume && m.triangle_count == n.triangle_count &&
         m.point_count == n.point_count && m.bounding_radius == n.bounding_radius &&
         m.inertia[0] == n.inertia[0] && m.inertia[2] == n.inertia[2];
}

static scree_status check_shapes(drop_run *run, const char *path, scree_error *error) {
  if (run->shape_count == 0) return SCREE_OK;
  scree_status status = drop_make_particles(run, error);
  if (status != SCREE_OK) return status;
  bool same = scree_pour_shape_count(run->pour) == run->shape_count;
  for (size_t i = 0; same && i < run->shape_count; i++) {
    scree_pour_shape shape = scree_pour_get_shape(run->pour, i);
    same = shape.count == run->shapes[i].count &&
           same_particle(shape.particle, run->shapes[i].particle);
  }
  return same ? SCREE_OK : cli_refuse(error, SCREE_BAD_ARGUMENT, path, "is of other shapes");
}

/* ---- where the files stand ---- */

/* series.csv as it was: cut behind the last line of the checkpoint. */
static scree_status reopen_series(drop_run *run, double length, scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = drop_path(run, "series.csv", path, error);
  if (status != SCREE_OK) return status;
  run->series = scree_open_stream(path, "r+");
  scree_path_info info;
  if (!run->series || !scree_descriptor_look(fileno(run->series), &info))
    return cli_refuse(error, SCREE_IO, path, strerror(errno));
  if (!(length >= 0 && length <= (double)info.byte_count))
    return cli_refuse(error, SCREE_BAD_FILE, path, "is shorter than the checkpoint knows it");
  if (!scree_cut(run->series, (uint64_t)length))
    return cli_refuse(error, SCREE_IO, path, strerror(errno));
  return SCREE_OK;
}

static scree_status take_notes(drop_run *run, const char *path, scree_error *error) {
  size_t count;
  const double *notes = scree_pour_notes(run->pour, &count);
  if (count < NOTES) return cli_refuse(error, SCREE_BAD_FILE, path, "is not of scree drop");
  run->schedule.next_frame = notes[0];
  run->schedule.next_line = notes[1];
  run->schedule.still_since = notes[2];
  run->schedule.still = notes[3] != 0;
  scree_status status = SCREE_OK;
  for (size_t i = NOTES; i < count && status == SCREE_OK; i++)
    status = drop_note_frame(run, notes[i], error);
  return status == SCREE_OK ? reopen_series(run, notes[4], error) : status;
}

scree_status drop_resume(drop_run *run, scree_error *error) {
  char path[DROP_PATH_BYTES];
  if (!run->arguments->resume) return SCREE_OK;
  scree_status status = drop_path(run, "checkpoint.scree", path, error);
  if (status != SCREE_OK) return status;
  if (!scree_path_exists(path))
    return run->shape_count ? SCREE_OK
                            : cli_refuse(error, SCREE_IO, path, "no checkpoint to go on from");
  status = scree_pour_load(path, &run->pour, error);
  if (status == SCREE_OK) drop_settle(run);
  if (status == SCREE_OK) status = check_settings(run, path, error);
  if (status == SCREE_OK) status = check_shapes(run, path, error);
  return status == SCREE_OK ? take_notes(run, path, error) : status;
}
