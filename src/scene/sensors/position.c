/* Where a geometry is: its origin. */
#include "scene/sensors/sensor.h"

#include <string.h>

static const char *geometry(const scree_plan_sensor *plan) {
  return plan->position;
}

static const scree_sensor_column columns[] = {
    {"x", "m", SCREE_OF_ALL}, {"y", "m", SCREE_OF_ALL}, {"z", "m", SCREE_OF_ALL}, {0}};

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  scree_wall wall;
  (void)now, (void)error;
  scree_world_get_wall(scene->world, scene->geometry[sensor->geometry].first_wall, &wall);
  memcpy(at, wall.position, sizeof wall.position);
  return SCREE_OK;
}

const scree_sensor_kind scree_sensor_position = {
    .geometry = geometry, .columns = columns, .read = read};
