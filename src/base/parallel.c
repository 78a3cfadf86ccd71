/* A pool of threads. A loop is published in one word: its number, how many workers it has room for,
 * whether it is still open, and how many are in it. The caller takes blocks like any worker and
 * closes the loop when none is left, so it never waits for a thread that the system has not yet
 * woken: on a busy machine a loop costs what it costs on one thread. Whoever waits spins for a
 * moment first, as loops follow each other closely, and then sleeps. */
#include "base/parallel.h"

#include "base/platform.h"
#include "scree.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>

enum {
  MOST_THREADS = 1024,
  SPINS = 8000, /* pauses before sleep, 0.1 to 0.4 ms: to be woken costs as much as a short wait */
  /* the word: number of the loop above, then its room for workers, open or not, workers in it */
  NUMBER_SHIFT = 32,
  ROOM_SHIFT = 16,
};
static const uint64_t open_bit = (uint64_t)1 << 15, inside_mask = open_bit - 1, room_mask = 0xffff;

static struct {
  pthread_mutex_t caller; /* held by whoever runs a loop on the pool */
  pthread_mutex_t alone;  /* scree_enter_alone */
  pthread_mutex_t lock;   /* guards sleeping, waking and the two conditions */
  pthread_cond_t wake, left;
  atomic_int sleeping;
  atomic_bool caller_sleeps;
  int started; /* threads beside the caller's; guarded by `caller` */
  _Atomic uint64_t word;
  /* The loop; written by the caller while nobody is inside. */
  size_t count, block_size, blocks;
  scree_block_function *body;
  void *context;
  atomic_size_t next;
} pool = {.caller = PTHREAD_MUTEX_INITIALIZER,
          .alone = PTHREAD_MUTEX_INITIALIZER,
          .lock = PTHREAD_MUTEX_INITIALIZER,
          .wake = PTHREAD_COND_INITIALIZER,
          .left = PTHREAD_COND_INITIALIZER};

static atomic_int requested_threads;
static _Thread_local bool inside_loop;

void scree_set_threads(int thread_count) {
  atomic_store(&requested_threads, thread_count > 0 ? thread_count : 0);
}

/* OMP_NUM_THREADS, as batch systems set it; else the processors this process may use. */
static int default_threads(void) {
  static atomic_int found;
  int threads = atomic_load(&found);
  if (threads > 0) return threads;
  const char *text = getenv("OMP_NUM_THREADS");
  long wanted = text ? strtol(text, NULL, 10) : 0;
  if (wanted > 0)
    threads = wanted < MOST_THREADS ? (int)wanted : MOST_THREADS;
  else
    threads = scree_processor_count();
  atomic_store(&found, threads);
  return threads;
}

int scree_threads(void) {
  int requested = atomic_load(&requested_threads);
  if (requested > MOST_THREADS) return MOST_THREADS;
  return requested > 0 ? requested : default_threads();
}

int scree_worker_count(void) {
  return inside_loop ? 1 : scree_threads();
}

void scree_work_alone(bool alone) {
  inside_loop = alone;
}

static void pause_briefly(void) {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

void scree_enter_alone(void) {
  pthread_mutex_lock(&pool.alone);
}
void scree_leave_alone(void) {
  pthread_mutex_unlock(&pool.alone);
}

static scree_block block_of(size_t index, size_t count, size_t size, int worker) {
  size_t begin = index * size;
  return (scree_block){begin, count - begin < size ? count : begin + size, index, worker};
}

static void take_blocks(int worker) {
  size_t block;
  inside_loop = true;
  while ((block = atomic_fetch_add_explicit(&pool.next, 1, memory_order_relaxed)) < pool.blocks)
    pool.body(pool.context, block_of(block, pool.count, pool.block_size, worker));
  inside_loop = false;
}

/* Whether worker got into the loop that `word` tells of. */
static bool enter(uint64_t word, int worker) {
  while (word & open_bit && (uint64_t)worker <= (word >> ROOM_SHIFT & room_mask)) {
    uint64_t seen = word;
    if (atomic_compare_exchange_weak(&pool.word, &word, word + 1)) return true;
    if (seen >> NUMBER_SHIFT != word >> NUMBER_SHIFT) return false;
  }
  return false;
}

static void leave(void) {
  uint64_t before = atomic_fetch_sub(&pool.word, 1);
  if ((before & inside_mask) != 1 || before & open_bit || !atomic_load(&pool.caller_sleeps)) return;
  pthread_mutex_lock(&pool.lock);
  pthread_cond_signal(&pool.left);
  pthread_mutex_unlock(&pool.lock);
}

static bool is_news(uint64_t number) {
  uint64_t word = atomic_load(&pool.word);
  return word >> NUMBER_SHIFT != number && word & open_bit;
}

/* Returns when a loop is open that is not the one numbered. */
static void await_loop(uint64_t number) {
  for (int spin = 0; spin < SPINS; spin++) {
    if (is_news(number)) return;
    pause_briefly();
  }
  pthread_mutex_lock(&pool.lock);
  atomic_fetch_add(&pool.sleeping, 1);
  while (!is_news(number)) pthread_cond_wait(&pool.wake, &pool.lock);
  atomic_fetch_sub(&pool.sleeping, 1);
  pthread_mutex_unlock(&pool.lock);
}

static void *work(void *argument) {
  int worker = (int)(intptr_t)argument;
  uint64_t number = 0;
  for (;;) {
    await_loop(number);
    uint64_t word = atomic_load(&pool.word);
    number = word >> NUMBER_SHIFT;
    if (!enter(word, worker)) continue;
    take_blocks(worker);
    leave();
  }
  return NULL;
}

/* In a child of fork no thread but the one that forked goes on. */
static void forget_threads(void) {
  pool.caller = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER;
  pool.alone = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER;
  pool.lock = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER;
  pool.wake = (pthread_cond_t)PTHREAD_COND_INITIALIZER;
  pool.left = (pthread_cond_t)PTHREAD_COND_INITIALIZER;
  atomic_store(&pool.sleeping, 0);
  atomic_store(&pool.caller_sleeps, false);
  atomic_store(&pool.word, 0);
  pool.started = 0;
}

static void start_threads(int wanted) {
  static bool told;
  if (!told) scree_at_fork(forget_threads);
  told = true;
  while (pool.started < wanted && scree_thread_start(work, (void *)(intptr_t)(pool.started + 1)))
    pool.started++;
}

static void open_loop(int workers) {
  uint64_t number = (atomic_load(&pool.word) >> NUMBER_SHIFT) + 1;
  if (number >> (64 - NUMBER_SHIFT)) number = 1; /* 0 is what a new thread has seen */
  atomic_store(&pool.word, number << NUMBER_SHIFT | (uint64_t)workers << ROOM_SHIFT | open_bit);
  if (atomic_load(&pool.sleeping) == 0) return;
  pthread_mutex_lock(&pool.lock);
  pthread_cond_broadcast(&pool.wake);
  pthread_mutex_unlock(&pool.lock);
}

static void close_loop(void) {
  uint64_t word = atomic_fetch_and(&pool.word, ~open_bit);
  for (int spin = 0; spin < SPINS && word & inside_mask; spin++) {
    pause_briefly();
    word = atomic_load(&pool.word);
  }
  if (!(word & inside_mask)) return;
  pthread_mutex_lock(&pool.lock);
  atomic_store(&pool.caller_sleeps, true);
  while (atomic_load(&pool.word) & inside_mask) pthread_cond_wait(&pool.left, &pool.lock);
  atomic_store(&pool.caller_sleeps, false);
  pthread_mutex_unlock(&pool.lock);
}

void scree_parallel_for(size_t count, size_t block_size, scree_block_function *body,
                        void *context) {
  size_t blocks = scree_block_count(count, block_size);
  int threads = scree_worker_count();
  if ((size_t)threads > blocks) threads = (int)blocks;
  if (threads > 1 && pthread_mutex_trylock(&pool.caller) == 0) {
    start_threads(threads - 1);
    pool.count = count;
    pool.block_size = block_size;
    pool.blocks = blocks;
    pool.body = body;
    pool.context = context;
    atomic_store(&pool.next, 0);
    open_loop(threads - 1);
    take_blocks(0);
    close_loop();
    pthread_mutex_unlock(&pool.caller);
  } else { /* one thread, or the pool works for another one */
    for (size_t i = 0; i < blocks; i++) body(context, block_of(i, count, block_size, 0));
  }
}

/* Tasks under way. */
typedef struct tasking {
  const scree_tasks *tasks;
  void *context;
  pthread_mutex_t lock; /* held for take and end, and for the count */
  pthread_cond_t ended;
  int running;
  atomic_uint ends; /* so far, and once more when all is done */
} tasking;

/* Waits until a task has ended after so many ends. The lock is held, but meanwhile. */
static void await_end(tasking *t, unsigned ends) {
  pthread_mutex_unlock(&t->lock);
  for (int spin = 0; spin < SPINS && atomic_load(&t->ends) == ends; spin++) pause_briefly();
  pthread_mutex_lock(&t->lock);
  while (atomic_load(&t->ends) == ends) pthread_cond_wait(&t->ended, &t->lock);
}

static void tell_end(tasking *t) {
  atomic_fetch_add(&t->ends, 1);
  pthread_cond_broadcast(&t->ended);
}

static void do_tasks(void *context, scree_block block) {
  tasking *t = context;
  size_t task;
  pthread_mutex_lock(&t->lock);
  for (;;) {
    if (t->tasks->take(t->context, block.worker, &task)) {
      t->running++;
      pthread_mutex_unlock(&t->lock);
      t->tasks->run(t->context, task);
      pthread_mutex_lock(&t->lock);
      t->running--;
      t->tasks->end(t->context, task);
      tell_end(t);
    } else if (t->running > 0) {
      await_end(t, atomic_load(&t->ends));
    } else {
      break;
    }
  }
  tell_end(t); /* whoever waits finds that none is ready */
  pthread_mutex_unlock(&t->lock);
}

void scree_parallel_tasks(int most, const scree_tasks *tasks, void *context) {
  tasking t = {.tasks = tasks,
               .context = context,
               .lock = PTHREAD_MUTEX_INITIALIZER,
               .ended = PTHREAD_COND_INITIALIZER};
  int workers = scree_worker_count();
  scree_parallel_for((size_t)(most < workers ? most : workers), 1, do_tasks, &t);
  pthread_mutex_destroy(&t.lock);
  pthread_cond_destroy(&t.ended);
}
