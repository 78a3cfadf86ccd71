/* The kinds of sensors, a row each, in the order in which a scene's file is printed: its key there,
 * what stands behind the key, and a sentence. Everything that goes through all kinds is made from
 * these rows: the fields of scree_plan_sensor, the table of scree_sensor_kind, what is offered
 * where a key is wrong. A new kind is a row here and a file beside this one (sensor.h). */
#pragma once

#include "base/schema_rows.h"

#define SCREE_SENSOR_KINDS(ROW, T)                                                                 \
  ROW(T, GROUP, flow, scree_plan_flow, "count and mass through a plane, by shape")                 \
  ROW(T, GROUP, region, scree_plan_region, "what is in a box")                                     \
  ROW(T, TEXT, wall, "force, torque, power and wear of a geometry")                                \
  ROW(T, TEXT, position, "where a geometry is")                                                    \
  ROW(T, TEXT, part, "of a geometry that forces move")                                             \
  ROW(T, GROUP, pile, scree_plan_pile, "angle of repose three ways")                               \
  ROW(T, GROUP, slope, scree_plan_slope, "angle of the surface")                                   \
  ROW(T, GROUP, segregation, scree_plan_segregation, "Lacey's index by shape")                     \
  ROW(T, GROUP, residence, scree_plan_residence, "time from inlet to outlet")                      \
  ROW(T, GROUP, grid, scree_plan_grid, "fields of means over time, for ParaView")                  \
  ROW(T, GROUP, impacts, scree_plan_impacts, "energies of contacts, by class")                     \
  ROW(T, GROUP, speed, scree_plan_speed, "how fast bodies are, with a histogram")                  \
  ROW(T, GROUP, fragments, scree_plan_fragments, "of shapes that break: number, size, energy")

SCREE_SENSOR_KINDS(SCREE_KIND_RECORD, )
