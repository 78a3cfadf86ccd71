/* Where the state is. The world's own arrays have it, but for what is newer on a device: that comes
 * when it is asked for. Every reader of arrays calls scree_world_bring first, everything that
 * changes them scree_world_change. Until then the world's pointers to what is newer there are NULL,
 * so that none can be forgotten. */
#pragma once

#include "world/state/world.h"

struct scree_sums;

/* The functions of who has taken the state of a world. */
typedef struct scree_remote {
  /* Parts come to the world's arrays. */
  scree_status (*bring)(struct scree_device_world *there, unsigned parts, scree_error *error);
  /* They are newer here now. */
  void (*change)(struct scree_device_world *there, unsigned parts);
  /* Sums of an observation; false where the world's arrays have all. */
  bool (*sum)(struct scree_device_world *there, struct scree_sums *sums);
  void (*release)(scree_world *world);
} scree_remote;

/* Before arrays of these parts are read. Where a device does not give them back, the world has
 * diverged; it shows what it had before, without its neighbours. */
scree_status scree_world_bring(const scree_world *world, unsigned parts, scree_error *error);
/* Before they are changed: brings them, and the next step takes them from here. */
scree_status scree_world_change(scree_world *world, unsigned parts, scree_error *error);
