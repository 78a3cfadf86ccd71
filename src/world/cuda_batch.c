#include "world/cuda_batch.h"

#include "base/alloc.h"
#include "base/error.h"

#ifdef SCREE_WITH_CUDA
#include <pthread.h>
#include <string.h>
#include <time.h>

/* A world's request in the list of those that wait. */
typedef struct waiting {
  const scree_cuda_request *request;
  scree_status status;
  scree_error error;
  bool done;
  struct waiting *next;
} waiting;

/* Of a device. One of the threads that wait leads: it does the steps of all that wait then, while
 * others come and wait for the next round. */
static struct batch {
  pthread_mutex_t mutex;
  pthread_cond_t changed;
  waiting *first;
  size_t count, last_count; /* who wait; who were in the last round */
  bool led;
  scree_cuda_queue queue;
  scree_cuda_block worlds, steps;
} batches[SCREE_MOST_DEVICES];
static pthread_once_t once = PTHREAD_ONCE_INIT;
static const long patience = 300000; /* ns, for those of the last round to come again */

static void set_up(void) {
  for (int i = 0; i < SCREE_MOST_DEVICES; i++) {
    pthread_mutex_init(&batches[i].mutex, NULL);
    pthread_cond_init(&batches[i].changed, NULL);
    batches[i].queue.device = i;
  }
}

static size_t most_elements(const waiting *first, int kernel) {
  size_t most = 0;
  for (const waiting *w = first; w; w = w->next)
    if (w->request->counts[kernel] > most) most = w->request->counts[kernel];
  return most;
}

static scree_status launch_all(struct batch *b, const waiting *first, size_t count,
                               scree_error *error) {
  size_t steps = 0;
  for (const waiting *w = first; w; w = w->next)
    if (w->request->steps > steps) steps = w->request->steps;
  for (size_t i = 0; i < steps; i++)
    for (int k = 0; k < SCREE_STEP_KERNELS; k++)
      SCREE_TRY(scree_cuda_launch(&b->queue, (scree_kernel)k, most_elements(first, k), count,
                                  b->worlds.at, b->steps.at, error));
  return SCREE_OK;
}

/* The structs of all lie side by side. */
static scree_status do_all(struct batch *b, waiting *first, size_t count, scree_error *error) {
  const size_t world_bytes = count * sizeof(scree_device_address),
               step_bytes = count * sizeof(scree_device_step);
  SCREE_SCRATCH(scree_device_address, worlds, count, error);
  SCREE_SCRATCH(scree_device_step, steps, count, error);
  if (!b->queue.stream) SCREE_TRY(scree_cuda_open_queue(&b->queue, error));
  SCREE_TRY(scree_cuda_reserve(&b->worlds, world_bytes, error));
  SCREE_TRY(scree_cuda_reserve(&b->steps, step_bytes, error));
  size_t i = 0;
  for (const waiting *w = first; w; w = w->next, i++) {
    worlds[i] = w->request->world;
    steps[i] = *w->request->step;
  }
  SCREE_TRY(scree_cuda_write(&b->queue, b->worlds.at, worlds, world_bytes, error));
  SCREE_TRY(scree_cuda_write(&b->queue, b->steps.at, steps, step_bytes, error));
  SCREE_TRY(launch_all(b, first, count, error));
  SCREE_TRY(scree_cuda_read(&b->queue, steps, b->steps.at, step_bytes, error));
  i = 0;
  for (const waiting *w = first; w; w = w->next, i++) *w->request->step = steps[i];
  return SCREE_OK;
}

/* Those of the last round are back soon, as a rule. */
static void wait_for_others(struct batch *b) {
  struct timespec until;
  clock_gettime(CLOCK_REALTIME, &until);
  until.tv_nsec += patience;
  until.tv_sec += until.tv_nsec / 1000000000;
  until.tv_nsec %= 1000000000;
  while (b->count < b->last_count)
    if (pthread_cond_timedwait(&b->changed, &b->mutex, &until)) break;
}

/* The mutex is held, but while the device works. */
static void lead(struct batch *b) {
  b->led = true;
  wait_for_others(b);
  waiting *first = b->first;
  size_t count = b->last_count = b->count;
  b->first = NULL;
  b->count = 0;
  pthread_mutex_unlock(&b->mutex);
  scree_error error;
  scree_status status = do_all(b, first, count, &error);
  pthread_mutex_lock(&b->mutex);
  for (waiting *w = first; w; w = w->next) {
    w->status = status;
    if (status) w->error = error;
    w->done = true;
  }
  b->led = false;
  pthread_cond_broadcast(&b->changed);
}

scree_status scree_cuda_do_steps(int device, const scree_cuda_request *request,
                                 scree_error *error) {
  pthread_once(&once, set_up);
  struct batch *b = &batches[device];
  waiting own = {.request = request};
  pthread_mutex_lock(&b->mutex);
  own.next = b->first;
  b->first = &own;
  b->count++;
  pthread_cond_broadcast(&b->changed);
  while (!own.done) {
    if (b->led)
      pthread_cond_wait(&b->changed, &b->mutex);
    else
      lead(b);
  }
  pthread_mutex_unlock(&b->mutex);
  if (own.status) *error = own.error;
  return own.status;
}

#endif
