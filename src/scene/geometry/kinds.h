/* The kinds of geometry, a row each, in the order in which a scene's file is printed, as those of
 * sensors (scene/sensors/kinds.h). A new kind is a row here and a file beside this one (kind.h). */
#pragma once

#include "base/schema_rows.h"

#define SCREE_GEOMETRY_KINDS(ROW, T)                                                               \
  ROW(T, TEXTS, file, "a mesh, or several that move together")                                     \
  ROW(T, VECTOR, box, SCREE_NONE, 1e-9, 1e6, "m", "three sides, about `at`")                       \
  ROW(T, DIRECTION, plane, SCREE_NONE, "normal, out of the solid")                                 \
  ROW(T, GROUP, disc, scree_plan_disc, "")                                                         \
  ROW(T, GROUP, cylinder, scree_plan_cylinder, "a sheet from `at` along its axis")                 \
  ROW(T, GROUP, shaft, scree_plan_shaft, "four endless walls about z")                             \
  ROW(T, GROUP, loop, scree_plan_loop, "a sheet round two wheels, one of them at `at`")            \
  ROW(T, GROUP, screw, scree_plan_screw, "a flight on a shaft")                                    \
  ROW(T, GROUP, sieve, scree_plan_sieve, "a plate with round holes, flat or bent")

SCREE_GEOMETRY_KINDS(SCREE_KIND_RECORD, )
