/* Scenes of tests: from their text, and to their end. */
#pragma once

#include "support/check.h"

#include <scree.h>
#include <stdlib.h>
#include <string.h>

/* Files that it names lie beside `path`. */
static inline scree_scene *create_at(const char *text, const char *path) {
  scree_error error;
  scree_scene_file *file = NULL;
  scree_scene *scene = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), path, &file, &error), error);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  scree_scene_file_free(file);
  return scene;
}

static inline scree_scene *create(const char *text) {
  return create_at(text, "test.yaml");
}

static inline scree_body body_of(const scree_scene *scene, size_t index) {
  scree_body body;
  scree_world_get_body(scree_scene_view(scene), index, &body);
  return body;
}

static inline void run_to_end(scree_scene *scene) {
  scree_error error;
  while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, 1000, &error), error);
}

static inline size_t column_of(const scree_scene *scene, const char *name) {
  size_t k = 0;
  while (scree_scene_column_name(scene, k) && strcmp(scree_scene_column_name(scene, k), name) != 0)
    k++;
  if (k == scree_scene_column_count(scene)) fail_msg("no column %s", name);
  return k;
}

/* The series of a column: row i at i * interval. */
static inline double at_row(const scree_scene *scene, const char *name, size_t row) {
  size_t rows, columns = scree_scene_column_count(scene);
  const double *series = scree_scene_series(scene, &rows);
  assert_true(row < rows);
  return series[row * columns + column_of(scene, name)];
}

static inline size_t row_count(const scree_scene *scene) {
  size_t rows;
  scree_scene_series(scene, &rows);
  return rows;
}

/* A column as it stands. */
static inline double now_of(const scree_scene *scene, const char *name) {
  scree_error error;
  double *values = malloc(scree_scene_column_count(scene) * sizeof *values);
  assert_non_null(values);
  CHECK_OK(scree_scene_measure(scene, values, &error), error);
  double value = values[column_of(scene, name)];
  free(values);
  return value;
}

/* Up to a time; false where the scene ended before. */
static inline bool run_until(scree_scene *scene, double time) {
  scree_error error;
  double dt = scree_world_time_step(scree_scene_view(scene), NULL);
  while (!scree_scene_end(scene) && scree_world_time(scree_scene_view(scene)) < time) {
    double left = (time - scree_world_time(scree_scene_view(scene))) / dt;
    CHECK_OK(scree_scene_advance(scene, left > 2 ? (size_t)left : 1, &error), error);
  }
  return !scree_scene_end(scene);
}
