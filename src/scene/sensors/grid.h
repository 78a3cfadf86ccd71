/* Fields over the cells of a grid. */
#pragma once

#include "scene/sensors/sensor.h"

/* Sums over samples in a cell: places of numbers; of density, momentum and its flux by mass. Behind
 * them the density of each family. */
enum {
  SCREE_GRID_SOLID,
  SCREE_GRID_DENSITY,
  SCREE_GRID_MOMENTUM,
  SCREE_GRID_FLUX = SCREE_GRID_MOMENTUM + 3,
  SCREE_GRID_CONTACT = SCREE_GRID_FLUX + 6,
  SCREE_GRID_SUMS = SCREE_GRID_CONTACT + 6
};

typedef struct scree_scene_grid {
  size_t cell_count, number_count;
  double *sums;
  double *mixing;        /* of each family: sum of its Lacey's index over samples, their count */
  vec3 *middles;         /* of the cells, in the grid's frame */
  uint64_t next;         /* step of the next sample */
  uint64_t sample_count; /* taken */
  double *indices;       /* of each family: scratch */
} scree_scene_grid;

static inline scree_scene_grid *scree_grid_of(const scree_scene_sensor *sensor) {
  return scree_sensor_state(sensor, &scree_sensor_grid);
}

/* Means over the samples: kg/m3, m/s, m2/s2, Pa. */
typedef struct scree_grid_fields {
  double solid, density, velocity[3], temperature, stress[6];
  const double *shares; /* density of each family, as sums */
} scree_grid_fields;
scree_grid_fields scree_grid_fields_at(const scree_scene *scene, const scree_scene_sensor *sensor,
                                       size_t cell);
