/* Scenes of tests: from their text, and to their end. */
#ifndef SCREE_TEST_SCENE_H
#define SCREE_TEST_SCENE_H

#include "support/check.h"

#include <scree.h>
#include <string.h>

static inline scree_scene *create(const char *text) {
  scree_error error;
  scree_scene_file *file = NULL;
  scree_scene *scene = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  scree_scene_file_free(file);
  return scene;
}

static inline void run_to_end(scree_scene *scene) {
  scree_error error;
  while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, 1000, &error), error);
}

#endif
