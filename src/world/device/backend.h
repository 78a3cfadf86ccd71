/* Backends: where a world's steps are computed. The processor's (cpu.c) is always there; the cuda
 * one (cuda.c) takes the state to a device (remote.h) and runs the same stages there. */
#pragma once

#include "world/state/world.h"

typedef struct scree_backend {
  const char *name;
  /* The state may be stepped there from now on; on which device, where there are several. */
  scree_status (*begin)(scree_world *world, int device, scree_error *error);
  /* Some steps, at least one and at most `most`; how many. What is wrong is in world->failure. */
  scree_status (*step)(scree_world *world, size_t most, size_t *done);
} scree_backend;

extern const scree_backend scree_backend_cpu, scree_backend_cuda;
/* cpu.c: steps of small worlds are shared out among the threads too, for tests. */
extern bool scree_share_all_steps;

/* Where the world steps: what scree_world_set_backend chose for it, or scree_set_backend for all.
 */
const scree_backend *scree_backend_of(const scree_world *world);
int scree_backend_device_of(const scree_world *world);
/* cuda.c: of a world that has stepped on a device the number of that device; else -1. */
int scree_cuda_device_of(const scree_world *world);
