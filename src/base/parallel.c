#include "base/parallel.h"

#include "scree.h"

#include <omp.h>
#include <stdatomic.h>

static atomic_int requested_threads;

void scree_set_threads(int thread_count) {
  atomic_store(&requested_threads, thread_count > 0 ? thread_count : 0);
}

int scree_threads(void) {
  int requested = atomic_load(&requested_threads);
  return requested > 0 ? requested : omp_get_max_threads();
}

int scree_worker_count(void) {
  return omp_in_parallel() ? 1 : scree_threads();
}

void scree_parallel_for(size_t count, size_t block_size, scree_block_function *body,
                        void *context) {
  size_t blocks = scree_block_count(count, block_size);
  int threads = scree_worker_count();
  if ((size_t)threads > blocks) threads = (int)blocks;
  if (threads <= 1) {
    for (size_t block = 0; block < blocks; block++) {
      size_t begin = block * block_size,
             end = count - begin < block_size ? count : begin + block_size;
      body(context, begin, end, block, 0);
    }
    return;
  }
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
  for (size_t block = 0; block < blocks; block++) {
    size_t begin = block * block_size,
           end = count - begin < block_size ? count : begin + block_size;
    body(context, begin, end, block, omp_get_thread_num());
  }
}
