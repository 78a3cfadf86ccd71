/* Worlds of tests are small: they share out their steps all the same. */
#pragma once

#include "world/device/backend.h"

#include <scree.h>

static inline void use_threads(int count) {
  scree_share_all_steps = true;
  scree_set_threads(count);
}
