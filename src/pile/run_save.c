/* Checkpoints and frames of a run: those of its scene, under a seal of their own. The notes hold
 * what the scene does not say: the experiment as its own YAML, and of each shape its density factor
 * and its name. */
#include "pile/run.h"
#include "world/checkpoint.h"

#include "base/alloc.h"
#include "base/platform.h"

#include <stdlib.h>
#include <string.h>

const scree_seal scree_run_seal = {"screeRUN", "checkpoint or frame of a scree run", "run", 3};

/* ---- saving ---- */

static scree_status save_experiment(scree_codec *c, const scree_run *run, scree_error *error) {
  char *text = NULL;
  size_t length = 0;
  FILE *stream = scree_memory_open(&text, &length);
  if (stream) scree_experiment_print(&run->experiment, stream);
  bool good = stream && scree_memory_close(stream);
  if (good) scree_code_text(c, text, length);
  free(text);
  return good ? SCREE_OK : scree_fail_memory(error, 0, "an experiment's text");
}

scree_status scree_run_pack_notes(const scree_run *run, unsigned char **bytes, size_t *byte_count,
                                  scree_error *error) {
  scree_codec c = {0};
  scree_status status = save_experiment(&c, run, error);
  for (size_t i = 0; i < run->shape_count; i++) {
    scree_code_real(&c, &run->shapes[i].density_factor);
    scree_code_text(&c, run->names[2 * i], strlen(run->names[2 * i]));
  }
  if (status == SCREE_OK && c.out_of_memory)
    status = scree_fail_memory(error, c.count, "a run's notes");
  if (status != SCREE_OK) {
    scree_free(c.bytes);
    return status;
  }
  *bytes = c.bytes;
  *byte_count = c.count;
  return SCREE_OK;
}

scree_status scree_run_save(const scree_run *run, const char *path, bool overwrite,
                            scree_error *error) {
  return scree_scene_save_as(run->scene, false, path, overwrite, error);
}

scree_status scree_run_save_frame(const scree_run *run, const char *path, bool overwrite,
                                  scree_error *error) {
  return scree_scene_save_as(run->scene, true, path, overwrite, error);
}

/* ---- loading ---- */

typedef struct loader {
  scree_codec codec;
  const char *name;
  scree_error *error;
  scree_experiment experiment;
  scree_run_shape *shapes;
  char **names;
} loader;

static scree_status refuse(loader *l) {
  l->codec.failed = !l->codec.out_of_memory;
  return scree_seal_refuse(&l->codec, &scree_run_seal, l->name, l->error);
}

static scree_status load_experiment(loader *l) {
  scree_status status = scree_experiment_preset("paper", &l->experiment, l->error);
  char *text = status == SCREE_OK ? scree_decode_text(&l->codec) : NULL;
  if (status != SCREE_OK) return status;
  if (!text) return refuse(l);
  status = scree_experiment_parse(text, strlen(text), l->name, &l->experiment, l->error);
  scree_free(text);
  return status;
}

static scree_status load_shapes(loader *l, const scree_scene *scene) {
  size_t count = SCREE_SCENE_SHAPES(scene);
  l->shapes = scree_alloc_zero(count, sizeof *l->shapes);
  l->names = scree_alloc_zero(count, sizeof *l->names);
  if (!l->shapes || !l->names) return scree_fail_memory(l->error, 0, "a run's shapes");
  for (size_t i = 0; i < count; i++) {
    scree_code_real(&l->codec, &l->shapes[i].density_factor);
    l->names[i] = scree_decode_text(&l->codec);
    if (!l->names[i]) return refuse(l);
    l->shapes[i].name = l->names[i];
    l->shapes[i].source = scene->shapes[i].source;
    l->shapes[i].particle = scene->shapes[i].particle;
  }
  if (l->codec.position != l->codec.count) l->codec.failed = true;
  return scree_codec_good(&l->codec) ? SCREE_OK : refuse(l);
}

/* The scene must be the one that the experiment makes. */
static scree_status compare(loader *l, const scree_run *run, const scree_scene *scene) {
  scree_scene_file *file;
  bool same;
  scree_status status = scree_run_file(run, &file, l->error);
  if (status != SCREE_OK) return status;
  status = scree_scene_matches(scene, file, &same, l->error);
  scree_scene_file_free(file);
  return status == SCREE_OK && !same ? refuse(l) : status;
}

static scree_status load(loader *l, const scree_scene *scene, scree_run **run) {
  scree_status status = load_experiment(l);
  if (status == SCREE_OK) status = load_shapes(l, scene);
  if (status == SCREE_OK)
    status =
        scree_run_describe(&l->experiment, l->shapes, SCREE_SCENE_SHAPES(scene), run, l->error);
  return status == SCREE_OK ? compare(l, *run, scene) : status;
}

scree_status scree_run_of_scene(scree_scene *scene, const char *path, scree_run **run,
                                scree_error *error) {
  loader l = {.codec = {.source = scene->notes.bytes, .count = scene->notes.count, .loading = true},
              .name = path,
              .error = error};
  scree_run *made = NULL;
  scree_status status = load(&l, scene, &made);
  for (size_t i = 0; l.names && i < SCREE_SCENE_SHAPES(scene); i++) scree_free(l.names[i]);
  scree_free(l.names);
  scree_free(l.shapes);
  scree_experiment_free(&l.experiment);
  if (status == SCREE_OK) {
    made->scene = scene;
    status = scree_run_follow(made, error);
    if (status != SCREE_OK) made->scene = NULL;
  }
  if (status == SCREE_OK)
    *run = made;
  else
    scree_run_free(made);
  return status;
}

scree_status scree_run_load(const char *path, scree_run **run, scree_error *error) {
  scree_scene *scene;
  scree_status status = scree_scene_load_as(&scree_run_seal, path, &scene, error);
  if (status != SCREE_OK) return status;
  status = scree_run_of_scene(scene, path, run, error);
  if (status != SCREE_OK) scree_scene_free(scene);
  return status;
}
