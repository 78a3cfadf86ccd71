/* Backends: where a world's steps are computed. The processor's (step.c) is always there; the cuda
 * one (cuda.c) takes the state to a device, runs the same stages there, and gives it back. */
#ifndef SCREE_WORLD_BACKEND_H
#define SCREE_WORLD_BACKEND_H

#include "scree.h"

typedef struct scree_backend {
  const char *name;
  /* The state goes to where it is stepped; nothing else changes it until it is fetched. */
  scree_status (*begin)(scree_world *world, scree_error *error);
  /* Some steps, at least one and at most `most`; how many. What is wrong is in world->failure. */
  scree_status (*step)(scree_world *world, size_t most, size_t *done);
  /* The world's own arrays hold the state. */
  scree_status (*fetch)(scree_world *world, scree_error *error);
  void (*release)(scree_world *world);
} scree_backend;

extern const scree_backend scree_backend_cpu, scree_backend_cuda;

/* What scree_set_backend chose last. */
const scree_backend *scree_backend_chosen(void);
int scree_backend_device(void);

#endif
