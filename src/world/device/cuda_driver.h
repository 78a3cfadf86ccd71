/* NVIDIA's driver, loaded where there is one: no toolkit is needed to build or to run. */
#pragma once

#include "scree.h"
#include "world/device/kernels/device.h"

typedef unsigned long long scree_device_address;

enum { SCREE_MOST_DEVICES = 16 };

typedef enum scree_kernel {
#define SCREE_NAME(name) SCREE_KERNEL_##name,
  SCREE_KERNELS(SCREE_NAME) SCREE_STEP_KERNELS,
  SCREE_STEP_LAST = SCREE_STEP_KERNELS - 1,
  SCREE_BROAD_KERNELS(SCREE_NAME) SCREE_OBSERVE_KERNELS(SCREE_NAME)
#undef SCREE_NAME
      SCREE_KERNEL_COUNT
} scree_kernel;

/* The device is opened once, and stays open. Says what it is, or in a sentence what is missing. */
scree_status scree_cuda_open(int device, char description[256], scree_error *error);

/* The calling thread's calls go to this device, which is open. */
scree_status scree_cuda_use(int device, scree_error *error);

/* What is asked of a queue is done in that order, beside what other queues do. */
typedef struct scree_cuda_queue {
  int device;
  void *stream;
} scree_cuda_queue;
scree_status scree_cuda_open_queue(scree_cuda_queue *queue, scree_error *error);
void scree_cuda_close_queue(scree_cuda_queue *queue);

/* Memory of the device. */
typedef struct scree_cuda_block {
  scree_device_address at;
  size_t capacity; /* bytes */
} scree_cuda_block;
/* Larger, when it is too small; its content goes then. */
scree_status scree_cuda_reserve(scree_cuda_block *block, size_t size, scree_error *error);
/* The same with a quarter more, for what grows. */
scree_status scree_cuda_reserve_more(scree_cuda_block *block, size_t size, scree_error *error);
void scree_cuda_free(scree_cuda_block block);
/* Until all that was asked of the queue is done. */
scree_status scree_cuda_wait(const scree_cuda_queue *queue, scree_error *error);
scree_status scree_cuda_write(const scree_cuda_queue *queue, scree_device_address to,
                              const void *from, size_t size, scree_error *error);
/* To zeros. */
scree_status scree_cuda_clear(const scree_cuda_queue *queue, scree_device_address at, size_t size,
                              scree_error *error);
/* Waits for all that was asked of the queue. */
scree_status scree_cuda_read(const scree_cuda_queue *queue, void *to, scree_device_address from,
                             size_t size, scree_error *error);
/* Threads for about so many elements of each of `worlds` worlds, over which kernels loop; of the
 * two arguments that every kernel has: arrays of the worlds' and the steps' structs. */
scree_status scree_cuda_launch(const scree_cuda_queue *queue, scree_kernel kernel, size_t count,
                               size_t worlds, scree_device_address world, scree_device_address step,
                               scree_error *error);
