/* Lacey's index of mixing between cells. */
#pragma once

#include "scene/sensors/sensor.h"

/* The cell that a body is in; false: none. */
typedef bool scree_find_cell(const scree_scene *scene, const scree_scene_sensor *sensor,
                             const double position[3], int64_t cell[3]);
/* Bodies in a cell, unless NULL, and of several classes the index of each, NaN: there is none. */
scree_status scree_mixing_measure(const scree_scene *scene, const scree_scene_sensor *sensor,
                                  scree_find_cell *find, int by, double *per_cell, double *indices,
                                  scree_error *error);
/* Whether the cells are too small or too few for the index. */
bool scree_mixing_doubt(const scree_scene *scene, const scree_scene_sensor *sensor,
                        scree_find_cell *find, int by, char text[SCREE_REMARK]);
