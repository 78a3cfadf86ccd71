/* The template `repose` with a few small particles, which go through it in a moment. */
#pragma once

#include "support/check.h"

static inline void set_field(scree_scene_file *file, const char *field, const char *value) {
  scree_error error;
  CHECK_OK(scree_scene_file_set(file, field, value, &error), error);
}

/* A pot of 80 mm, lifted at 1 m/s after a tenth of a second. Free it with scree_scene_file_free. */
static inline scree_scene_file *pot_file(const char *count, const scree_poured *shapes,
                                         size_t shape_count) {
  static const char *const fields[][2] = {{"cylinder.diameter", "0.08"},
                                          {"disc.diameter", "0.3"},
                                          {"phases.pack_time", "0.1"},
                                          {"phases.settle_time", "0.05"},
                                          {"phases.lift_speed", "1"},
                                          {"phases.lift_time", "0.08"},
                                          {"phases.hold_time", "0.02"},
                                          {"phases.drop_height", "0.01"},
                                          {"contact.young_particle", "1e7" /* fewer steps */}};
  scree_scene_file *file;
  scree_error error;
  CHECK_OK(scree_scene_file_template("repose", &file, &error), error);
  CHECK_OK(scree_scene_file_pour(file, shapes, shape_count, &error), error);
  set_field(file, "particles", count);
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
    set_field(file, fields[i][0], fields[i][1]);
  return file;
}

static inline scree_scene *pot_scene(const scree_scene_file *file) {
  scree_scene *scene;
  scree_error error;
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  return scene;
}
