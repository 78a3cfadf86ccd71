/* One run of the experiment: made as a scene, looked at as a run. */
#include "pile/run.h"

#include "base/alloc.h"

#include <string.h>

const char *scree_phase_name(scree_phase phase) {
  static const char *const names[] = {"packing", "settling", "lifting", "holding", "done"};
  return (unsigned)phase <= SCREE_PHASE_DONE ? names[phase] : "?";
}

/* ---- creation ---- */

static scree_status check_shapes(const scree_experiment *e, const scree_run_shape *shapes,
                                 size_t count, scree_error *error) {
  if (count < 1 || count > SCREE_MOST_SHAPES)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu shapes: must be 1 to %d", count,
                      SCREE_MOST_SHAPES);
  if (count > e->particle_count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu shapes for %zu particles", count,
                      e->particle_count);
  for (size_t i = 0; i < count; i++)
    if (!(shapes[i].density_factor > 0))
      return scree_fail(error, SCREE_BAD_ARGUMENT, "shape %zu: density factor %g must be positive",
                        i, shapes[i].density_factor);
  return SCREE_OK;
}

static scree_status copy_shapes(scree_run *run, const scree_run_shape *shapes, size_t count,
                                scree_error *error) {
  run->shapes = scree_alloc_zero(count, sizeof *run->shapes);
  run->names = scree_alloc_zero(2 * count, sizeof *run->names);
  if (!run->shapes || !run->names) return scree_fail_memory(error, count, "a run's shapes");
  run->shape_count = count;
  for (size_t i = 0; i < count; i++) {
    const char *texts[2] = {shapes[i].name, shapes[i].source};
    run->shapes[i] = shapes[i];
    scree_particle_retain(shapes[i].particle);
    for (size_t k = 0; k < 2; k++) {
      run->names[2 * i + k] = scree_strdup(texts[k] ? texts[k] : "");
      if (!run->names[2 * i + k]) {
        for (size_t left = i + 1; left < count; left++) run->shapes[left].particle = NULL;
        return scree_fail_memory(error, 0, "a shape's name");
      }
    }
    run->shapes[i].name = run->names[2 * i];
    run->shapes[i].source = run->names[2 * i + 1];
  }
  return SCREE_OK;
}

/* Size and volume over all particles, in their order. */
static scree_status measure_shapes(scree_run *run, scree_error *error) {
  size_t count = run->experiment.particle_count;
  uint32_t *order = scree_alloc(count, sizeof *order);
  if (!order) return scree_fail_memory(error, count * sizeof *order, "an order");
  scree_status status =
      scree_fill_order(run->experiment.seed, NULL, run->shape_count, order, count, error);
  for (size_t i = 0; status == SCREE_OK && i < count; i++) {
    scree_particle_measures m;
    scree_particle_measure(run->shapes[order[i]].particle, &m);
    run->solid_volume += m.volume;
    run->size += m.size / (double)count;
  }
  scree_free(order);
  return status;
}

scree_status scree_run_describe(const scree_experiment *experiment, const scree_run_shape *shapes,
                                size_t shape_count, scree_run **run, scree_error *error) {
  scree_status status = scree_experiment_check(experiment, error);
  if (status == SCREE_OK) status = check_shapes(experiment, shapes, shape_count, error);
  if (status != SCREE_OK) return status;
  scree_run *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a run");
  status = scree_experiment_copy(experiment, &made->experiment, error);
  if (status == SCREE_OK) status = copy_shapes(made, shapes, shape_count, error);
  if (status == SCREE_OK) status = measure_shapes(made, error);
  if (status == SCREE_OK) status = scree_run_check_measure(made, experiment, error);
  if (status == SCREE_OK)
    *run = made;
  else
    scree_run_free(made);
  return status;
}

static scree_status make_scene(scree_run *run, scree_error *error) {
  scree_particle *particles[SCREE_MOST_SHAPES];
  const char *sources[SCREE_MOST_SHAPES];
  unsigned char *notes;
  size_t note_bytes;
  scree_scene_file *file;
  scree_status status = scree_run_file(run, &file, error);
  if (status != SCREE_OK) return status;
  status = scree_run_pack_notes(run, &notes, &note_bytes, error);
  for (size_t i = 0; i < run->shape_count; i++) {
    particles[i] = run->shapes[i].particle;
    sources[i] = run->shapes[i].source;
  }
  if (status == SCREE_OK) {
    scree_scene_gift gift = {.seal = &scree_run_seal,
                             .particles = particles,
                             .sources = sources,
                             .notes = notes,
                             .note_bytes = note_bytes};
    status = scree_scene_make(file, &gift, NULL, &run->scene, error);
    scree_free(notes);
  }
  scree_scene_file_free(file);
  return status;
}

scree_status scree_run_create(const scree_experiment *experiment, const scree_run_shape *shapes,
                              size_t shape_count, scree_run **run, scree_error *error) {
  scree_run *made;
  scree_status status = scree_run_describe(experiment, shapes, shape_count, &made, error);
  if (status != SCREE_OK) return status;
  status = make_scene(made, error);
  if (status == SCREE_OK)
    *run = made;
  else
    scree_run_free(made);
  return status;
}

void scree_run_free(scree_run *run) {
  if (!run) return;
  scree_scene_free(run->scene);
  scree_experiment_free(&run->experiment);
  for (size_t i = 0; run->shapes && i < run->shape_count; i++)
    scree_particle_free(run->shapes[i].particle);
  for (size_t i = 0; run->names && i < 2 * run->shape_count; i++) scree_free(run->names[i]);
  scree_free(run->names);
  scree_free(run->shapes);
  scree_free(run->series.items);
  scree_free(run);
}

/* ---- going on ---- */

scree_status scree_run_advance(scree_run *run, size_t step_count, scree_error *error) {
  scree_status status = scree_scene_advance(run->scene, step_count, error);
  return status == SCREE_OK ? scree_run_follow(run, error) : status;
}

double scree_run_cylinder_height(const scree_run *run) {
  scree_wall wall;
  scree_world_get_wall(run->scene->world, run->scene->geometry[1].first_wall, &wall);
  return wall.position[2];
}

scree_phase scree_run_phase(const scree_run *run) {
  return (scree_phase)run->scene->phase;
}
scree_world *scree_run_world(scree_run *run) {
  return run->scene->world;
}
const scree_world *scree_run_view(const scree_run *run) {
  return run->scene->world;
}
const scree_experiment *scree_run_experiment(const scree_run *run) {
  return &run->experiment;
}
size_t scree_run_shape_count(const scree_run *run) {
  return run->shape_count;
}
void scree_run_get_shape(const scree_run *run, size_t index, scree_run_shape *shape) {
  *shape = run->shapes[index];
}
size_t scree_run_body_shape(const scree_run *run, size_t index) {
  return run->scene->shape_of.items[index];
}
bool scree_run_is_frame(const scree_run *run) {
  return run->scene->is_frame;
}
double scree_run_fraction(const scree_run *run) {
  return scree_scene_fraction(run->scene);
}

/* ---- a whole run ---- */

typedef struct work {
  const scree_run_job *job;
  scree_run *run;
} work;

static double cylinder_height(const scree_scene *scene) {
  scree_wall wall;
  scree_world_get_wall(scene->world, scene->geometry[1].first_wall, &wall);
  return wall.position[2];
}

static scree_status begin(void *context, scree_scene **scene, scree_error *error) {
  work *w = context;
  const scree_run_job *job = w->job;
  if (!job->experiment || !job->shapes)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no checkpoint to go on from",
                      job->folder ? job->folder : "no folder");
  scree_status status =
      scree_run_create(job->experiment, job->shapes, job->shape_count, &w->run, error);
  if (status == SCREE_OK) *scene = w->run->scene;
  return status;
}

/* Only how often a checkpoint is written may differ. */
static scree_status check_experiment(const scree_experiment *now, const scree_experiment *saved,
                                     const char *path, scree_error *error) {
  for (size_t i = 0; scree_experiment_key(i); i++) {
    const char *key = scree_experiment_key(i);
    char a[64], b[64];
    if (!strcmp(key, "output.checkpoint_interval")) continue;
    scree_experiment_get(now, key, a, sizeof a);
    scree_experiment_get(saved, key, b, sizeof b);
    if (strcmp(a, b) != 0)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "%s: is of another experiment: %s is %s there and %s here", path, key, b,
                        a);
  }
  return SCREE_OK;
}

static scree_status check_job(const work *w, const char *path, scree_error *error) {
  const scree_run_job *job = w->job;
  const scree_run *run = w->run;
  scree_status status = check_experiment(job->experiment, &run->experiment, path, error);
  if (status != SCREE_OK || !job->shapes) return status;
  bool same = job->shape_count == run->shape_count;
  for (size_t i = 0; same && i < run->shape_count; i++)
    same = job->shapes[i].density_factor == run->shapes[i].density_factor &&
           scree_particle_is_like(job->shapes[i].particle, run->shapes[i].particle);
  return same ? SCREE_OK : scree_fail(error, SCREE_BAD_ARGUMENT, "%s: is of other shapes", path);
}

static scree_status take_over(scree_run *run, const scree_experiment *experiment, const char *path,
                              scree_error *error) {
  scree_scene_file *file;
  unsigned char *notes;
  size_t note_bytes;
  run->experiment.checkpoint_interval = experiment->checkpoint_interval;
  scree_status status = scree_run_file(run, &file, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_take_over(run->scene, file, path, error);
  scree_scene_file_free(file);
  if (status == SCREE_OK) status = scree_run_pack_notes(run, &notes, &note_bytes, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_set_notes(run->scene, notes, note_bytes, error);
  scree_free(notes);
  return status;
}

static scree_status go_on(void *context, scree_scene *scene, const char *path, scree_error *error) {
  work *w = context;
  scree_status status = scree_run_of_scene(scene, path, &w->run, error);
  if (status != SCREE_OK || !w->job->experiment) return status;
  status = check_job(w, path, error);
  return status == SCREE_OK ? take_over(w->run, w->job->experiment, path, error) : status;
}

static bool watch(void *context, const scree_scene_state *state) {
  work *w = context;
  scree_run_state seen = {.run = w->run,
                          .now = scree_run_point_now(w->run),
                          .fraction = state->fraction,
                          .steps_per_second = state->steps_per_second,
                          .seconds_left = state->seconds_left};
  return w->job->watch(w->job->context, &seen);
}

static scree_status save_frame(const work *w, const char *name, scree_error *error) {
  if (!w->job->folder) return SCREE_OK;
  size_t size = strlen(w->job->folder) + strlen(name) + 2;
  char *path = scree_alloc(size, 1);
  if (!path) return scree_fail_memory(error, size, "a path");
  snprintf(path, size, "%s/%s", w->job->folder, name);
  scree_status status = scree_run_save_frame(w->run, path, true, error);
  scree_free(path);
  return status;
}

static scree_status on_frame(void *context, scree_scene *scene, size_t index, scree_error *error) {
  work *w = context;
  char name[48];
  (void)scene;
  snprintf(name, sizeof name, "frame-%04zu.scree", index);
  scree_status status = scree_run_follow(w->run, error);
  if (status == SCREE_OK) status = save_frame(w, name, error);
  return status == SCREE_OK && w->job->frame ? w->job->frame(w->job->context, w->run, index, error)
                                             : status;
}

scree_status scree_run_complete(const scree_run_job *job, scree_run **run, scree_error *error) {
  work w = {.job = job};
  scree_scene *scene;
  const scree_scene_job own = {.folder = job->folder,
                               .resume = job->resume,
                               .overwrite = job->overwrite,
                               .watch = job->watch ? watch : NULL,
                               .frame = on_frame,
                               .context = &w};
  const scree_scene_drive drive = {.job = &own,
                                   .seal = &scree_run_seal,
                                   .motion = job->motion,
                                   .cylinder_height = cylinder_height,
                                   .make = begin,
                                   .check = go_on,
                                   .context = &w};
  scree_status status = scree_scene_drive_on(&drive, &scene, error);
  if (status != SCREE_OK && w.run) w.run->scene = NULL; /* freed */
  if (status == SCREE_OK) status = scree_run_follow(w.run, error);
  if (status == SCREE_OK) status = save_frame(&w, "last.scree", error);
  if (status == SCREE_OK)
    *run = w.run;
  else
    scree_run_free(w.run);
  return status;
}
