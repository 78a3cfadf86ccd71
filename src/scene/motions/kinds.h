/* The kinds of motions, a row each, in the order in which a scene's file is printed, as those of
 * sensors (scene/sensors/kinds.h). A new kind is a row here and a file beside this one (kind.h). */
#pragma once

#include "base/schema_rows.h"

#define SCREE_MOTION_KINDS(ROW, T)                                                                 \
  ROW(T, GROUP, translate, scree_plan_translate, "")                                               \
  ROW(T, GROUP, rotate, scree_plan_rotate, "")                                                     \
  ROW(T, GROUP, vibrate, scree_plan_vibrate, "")                                                   \
  ROW(T, GROUP, crank, scree_plan_crank, "to and fro by crank and rod")                            \
  ROW(T, GROUP, round, scree_plan_travel, "of copies along a chain: with it")                      \
  ROW(T, GROUP, path, scree_plan_path, "by a table in a file")

SCREE_MOTION_KINDS(SCREE_KIND_RECORD, )
