/* A whole pour in a folder: what scree_scene_drive_on makes of its scene. */
#include "pile/pour.h"

typedef struct work {
  const scree_pour_job *job;
  scree_pour *pour;
} work;

static scree_status begin(void *context, scree_scene **scene, scree_error *error) {
  work *w = context;
  const scree_pour_job *job = w->job;
  scree_pour_options o = job->options ? *job->options : scree_default_pour_options();
  if (job->shape_count == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: no checkpoint to go on from",
                      job->folder ? job->folder : "no folder");
  scree_status status = scree_pour_describe(job->shapes, job->shape_count, &o, &w->pour, error);
  if (status != SCREE_OK) return status;
  w->pour->schedule = job->schedule;
  status = scree_pour_make_scene(w->pour, job->shapes, error);
  if (status == SCREE_OK) *scene = w->pour->scene;
  return status;
}

static bool are_shapes(const scree_pour_job *job, const scree_pour *pour) {
  bool same = job->shape_count == pour->shape_count;
  for (size_t i = 0; same && i < pour->shape_count; i++)
    same = job->shapes[i].count == pour->counts[i] &&
           scree_particle_is_like(job->shapes[i].particle, pour->scene->shapes[i].particle);
  return same;
}

/* By a file that has its options, or those of the job, and the job's schedule. */
static scree_status take_over(const work *w, const char *path, scree_error *error) {
  const scree_pour_job *job = w->job;
  scree_pour *other = w->pour;
  scree_scene_file *file;
  scree_pour_options o = job->options ? *job->options : scree_default_pour_options();
  scree_status status = SCREE_OK;
  if (job->shape_count)
    status = scree_pour_describe(job->shapes, job->shape_count, &o, &other, error);
  if (status != SCREE_OK) return status;
  other->schedule = job->schedule;
  status = scree_pour_file(other, &file, error);
  if (status == SCREE_OK) {
    status = scree_scene_take_over(w->pour->scene, file, path, error);
    scree_scene_file_free(file);
  }
  if (other != w->pour) scree_pour_free(other);
  w->pour->schedule = job->schedule;
  return status;
}

static scree_status go_on(void *context, scree_scene *scene, const char *path, scree_error *error) {
  work *w = context;
  scree_status status = scree_pour_of_scene(scene, path, &w->pour, error);
  if (status == SCREE_OK && w->job->shape_count && !are_shapes(w->job, w->pour))
    status = scree_fail(error, SCREE_BAD_ARGUMENT, "%s: is of other shapes", path);
  return status == SCREE_OK ? take_over(w, path, error) : status;
}

static bool watch(void *context, const scree_scene_state *state) {
  const work *w = context;
  return w->job->watch(w->job->context, w->pour, state->fraction);
}

static scree_status on_begin(void *context, scree_scene *scene, bool resumed, scree_error *error) {
  const work *w = context;
  (void)scene;
  return w->job->begun(w->job->context, w->pour, resumed, error);
}

static scree_status on_frame(void *context, scree_scene *scene, size_t index, scree_error *error) {
  const work *w = context;
  (void)scene;
  (void)index;
  return w->job->frame(w->job->context, w->pour, error);
}

scree_status scree_pour_complete(const scree_pour_job *job, scree_pour **pour, scree_error *error) {
  work w = {.job = job};
  scree_scene *scene = NULL;
  const scree_scene_job own = {.folder = job->folder,
                               .resume = job->resume,
                               .overwrite = job->overwrite,
                               .watch = job->watch ? watch : NULL,
                               .begun = job->begun ? on_begin : NULL,
                               .frame = job->frame ? on_frame : NULL,
                               .context = &w};
  const scree_scene_drive drive = {.job = &own,
                                   .seal = &scree_pour_seal,
                                   .motion = true,
                                   .series = true,
                                   .closing = true,
                                   .make = begin,
                                   .check = go_on,
                                   .context = &w};
  scree_status status = scree_scene_drive_on(&drive, &scene, error);
  if (w.pour) w.pour->scene = scene; /* NULL: it is freed */
  if (scene) {
    *pour = w.pour;
    return status;
  }
  scree_pour_free(w.pour);
  return status;
}
