/* Steps of several worlds in the same launches: each is too small to fill a device. */
#pragma once

#include "world/cuda_driver.h"

/* What a world asks for: up to `steps` steps, by its struct on the device. */
typedef struct scree_cuda_request {
  scree_device_address world;
  scree_device_step *step; /* goes to the device and comes back */
  size_t steps;
  size_t counts[SCREE_STEP_KERNELS]; /* about how many elements each kernel has */
} scree_cuda_request;

/* Does it, together with what other threads ask for meanwhile; waits for it. */
scree_status scree_cuda_do_steps(int device, const scree_cuda_request *request, scree_error *error);
