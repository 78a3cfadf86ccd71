/* Backends: where a world's steps are computed. The processor's (step.c) is always there; the cuda
 * one (cuda.c) takes the state to a device and runs the same stages there.
 *
 * The state stays on the device. What the world's own arrays do not have comes when it is asked
 * for: every reader of arrays calls scree_world_bring first, everything that changes them
 * scree_world_change. Until then the world's pointers to what is newer there are NULL, so that none
 * can be forgotten. */
#pragma once

#include "world/sums.h"

typedef struct scree_backend {
  const char *name;
  /* The state may be stepped there from now on. */
  scree_status (*begin)(scree_world *world, scree_error *error);
  /* Some steps, at least one and at most `most`; how many. What is wrong is in world->failure. */
  scree_status (*step)(scree_world *world, size_t most, size_t *done);
  /* Of a world on a device. Parts come to the world's arrays. */
  scree_status (*bring)(struct scree_device_world *there, unsigned parts, scree_error *error);
  /* They are newer here now. */
  void (*change)(struct scree_device_world *there, unsigned parts);
  /* Sums of an observation; false where the world's arrays have all. */
  bool (*sum)(struct scree_device_world *there, scree_sums *sums);
  void (*release)(scree_world *world);
} scree_backend;

extern const scree_backend scree_backend_cpu, scree_backend_cuda;

/* Where the world steps: what scree_world_set_backend chose for it, or scree_set_backend for all.
 */
const scree_backend *scree_backend_of(const scree_world *world);
int scree_backend_device_of(const scree_world *world);
/* cuda.c: of a world that has stepped on a device the number of that device; else -1. */
int scree_cuda_device_of(const scree_world *world);

/* Before arrays of these parts are read. Where a device does not give them back, the world has
 * diverged; it shows what it had before, without its neighbours. */
scree_status scree_world_bring(const scree_world *world, unsigned parts, scree_error *error);
/* Before they are changed: brings them, and the next step takes them from here. */
scree_status scree_world_change(scree_world *world, unsigned parts, scree_error *error);
