/* The only door to threads. Work is cut into blocks whose size depends on the count alone, never on
 * the number of threads: a reduction that combines its blocks in block order is therefore the same
 * bits for any number of threads. Nested calls run serially. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Items [begin, end), the block of that index; worker is in [0, scree_worker_count()). */
typedef struct scree_block {
  size_t begin, end, index;
  int worker;
} scree_block;
typedef void scree_block_function(void *context, scree_block block);

/* Calls body for every block of block_size items in [0, count), on all threads, in any order;
 * returns when all are done. Blocks are handed out as workers come free. */
void scree_parallel_for(size_t count, size_t block_size, scree_block_function *body, void *context);

/* Tasks of which some are ready only when others have ended. take and end are called one at a time,
 * run side by side; run's nested loops are serial, unless `most` is 1. */
typedef struct scree_tasks {
  /* Takes one that is ready. False: none is, for now; it is asked again after every end. */
  bool (*take)(void *context, int worker, size_t *task);
  void (*run)(void *context, size_t task);
  void (*end)(void *context, size_t task);
} scree_tasks;

/* Does all on at most so many threads; returns when none is ready and none runs. The caller's is
 * worker 0. */
void scree_parallel_tasks(int most, const scree_tasks *tasks, void *context);

static inline size_t scree_block_count(size_t count, size_t block_size) {
  return count / block_size + (count % block_size != 0);
}

/* Whether loops of this thread run on it alone from now on. */
void scree_work_alone(bool alone);

/* Between these only one worker of all loops at a time: for what is rare and short. */
void scree_enter_alone(void);
void scree_leave_alone(void);

/* How many workers a scree_parallel_for called here may use: the size of per-worker scratch. */
int scree_worker_count(void);
