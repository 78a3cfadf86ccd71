/* How far classes of bodies are mixed, in cubes all over space. */
#include "scene/sensors/mixing.h"

#define SCREE_PLAN_SEGREGATION(ROW, T)                                                             \
  ROW(T, REAL, cells, NAN, 1e-9, 1e6, "m", "side of the cells that are compared")                  \
  ROW(T, WORD, by, 0, "size|shape|material",                                                       \
      "classes: of a shape's sizes each, all of a shape, all of a material")
SCREE_RECORD_TYPE(scree_plan_segregation, SCREE_PLAN_SEGREGATION)
SCREE_RECORD_TABLE(scree_plan_segregation, SCREE_PLAN_SEGREGATION, "segregation",
                   "cells: their side", NULL)

static scree_status check(const scree_reader *r, const scree_plan *plan,
                          const scree_plan_sensor *s) {
  if (plan->shapes.count >= 2 || plan->shapes.items[0].size) return SCREE_OK;
  return scree_fail_place(r, &s->place, "segregation needs two shapes at least");
}

static bool find_cube(const scree_scene *scene, const scree_scene_sensor *sensor,
                      const double position[3], int64_t cell[3]) {
  (void)scene;
  double side = sensor->plan->segregation->cells;
  for (int k = 0; k < 3; k++) cell[k] = (int64_t)floor(position[k] / side);
  return true;
}

static const scree_sensor_column columns[] = {
    {"per_cell", "", SCREE_OF_ALL}, {"lacey", "", SCREE_OF_EACH}, {0}};

static scree_sensor_classes classes(const scree_scene *scene, const scree_scene_sensor *sensor) {
  return scree_classes_by(scene, sensor->plan->segregation->by);
}

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  (void)now;
  return scree_mixing_measure(scene, sensor, find_cube, sensor->plan->segregation->by, at, at + 1,
                              error);
}

static bool doubt(const scree_scene *scene, const scree_scene_sensor *sensor,
                  char text[SCREE_REMARK]) {
  return scree_mixing_doubt(scene, sensor, find_cube, sensor->plan->segregation->by, text);
}

const scree_sensor_kind scree_sensor_segregation = {
    .check = check, .columns = columns, .classes = classes, .read = read, .doubt = doubt};
