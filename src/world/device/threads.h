/* Kernels as loops over their elements: whatever the number of threads is, each takes its share. */
#ifndef SCREE_WORLD_DEVICE_THREADS_H
#define SCREE_WORLD_DEVICE_THREADS_H

#include <stddef.h>

#define FIRST_ELEMENT                                                                              \
  ((size_t)__nvvm_read_ptx_sreg_ctaid_x() * __nvvm_read_ptx_sreg_ntid_x() +                        \
   __nvvm_read_ptx_sreg_tid_x())
#define THREAD_COUNT   ((size_t)__nvvm_read_ptx_sreg_nctaid_x() * __nvvm_read_ptx_sreg_ntid_x())
#define EACH(i, count) (size_t i = FIRST_ELEMENT, end_ = (count); i < end_; i += THREAD_COUNT)

#endif
