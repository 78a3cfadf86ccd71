/* Handles whose end is that of the block they are declared in. */
#pragma once

#include "base/alloc.h"
#include "base/platform.h"

#define SCREE_FREE_AT(type)                                                                        \
  static inline void type##_free_at(type **handle) {                                               \
    type##_free(*handle);                                                                          \
  }
SCREE_FREE_AT(scree_calibration)
SCREE_FREE_AT(scree_curve)
SCREE_FREE_AT(scree_particle)
SCREE_FREE_AT(scree_replay)
SCREE_FREE_AT(scree_scene)
SCREE_FREE_AT(scree_scene_file)
SCREE_FREE_AT(scree_shape_store)
SCREE_FREE_AT(scree_study)
SCREE_FREE_AT(scree_surface)
SCREE_FREE_AT(scree_world)
#undef SCREE_FREE_AT

static inline void scree_folder_close_at(scree_folder **folder) {
  if (*folder) scree_folder_close(*folder);
}

/* One that is NULL so far. */
#define SCREE_OWNED(type, name) SCREE_CLEANUP(type##_free_at) type *name = NULL
