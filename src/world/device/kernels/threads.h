/* Kernels as loops over their elements: whatever the number of threads is, each takes its share.
 * A launch is of several worlds. */
#pragma once

#include "world/device/kernels/device.h"

#include <stddef.h>

#define FIRST_ELEMENT                                                                              \
  ((size_t)__nvvm_read_ptx_sreg_ctaid_x() * __nvvm_read_ptx_sreg_ntid_x() +                        \
   __nvvm_read_ptx_sreg_tid_x())
#define THREAD_COUNT ((size_t)__nvvm_read_ptx_sreg_nctaid_x() * __nvvm_read_ptx_sreg_ntid_x())
#define WORLD_INDEX  __nvvm_read_ptx_sreg_ctaid_y()
#define FOR_EACH(i, count)                                                                         \
  for (size_t i = FIRST_ELEMENT, end_ = (count); i < end_; i += THREAD_COUNT)

/* A kernel that calls a function for each element of a world. */
#define STAGE(name, function, count)                                                               \
  void scree_kernel_##name(scree_world **worlds, scree_device_step *steps) {                       \
    scree_world *world = worlds[WORLD_INDEX];                                                      \
    (void)steps;                                                                                   \
    FOR_EACH (i, count) function(world, i);                                                        \
  }
