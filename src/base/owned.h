/* Handles whose end is that of the block they are declared in: SCREE_OWNED(scree_world, made) is
 * a scree_world *made, NULL so far, for which scree_world_free is called then. */
#pragma once

#include "base/alloc.h"
#include "base/platform.h"

#define SCREE_OWNABLE(type)                                                                        \
  static inline void type##_free_at(type **handle) {                                               \
    type##_free(*handle);                                                                          \
  }
SCREE_OWNABLE(scree_calibration)
SCREE_OWNABLE(scree_curve)
SCREE_OWNABLE(scree_particle)
SCREE_OWNABLE(scree_replay)
SCREE_OWNABLE(scree_scene)
SCREE_OWNABLE(scree_scene_file)
SCREE_OWNABLE(scree_shape_store)
SCREE_OWNABLE(scree_study)
SCREE_OWNABLE(scree_surface)
SCREE_OWNABLE(scree_world)

static inline void scree_folder_close_at(scree_folder **folder) {
  if (*folder) scree_folder_close(*folder);
}

#define SCREE_OWNED(type, name) SCREE_CLEANUP(type##_free_at) type *name = NULL
