/* The pool of threads: every block once, whatever the threads, the callers and the nesting. */
#include "base/parallel.h"
#include "scree.h"
#include "support/check.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST = 4000, WORKERS = 8 };

typedef struct tally {
  atomic_uchar seen[MOST];    /* how often each item was handled */
  atomic_int inside[WORKERS]; /* bodies under way under each worker's number */
  atomic_bool wrong;
} tally;

static void count_items(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block;
  tally *t = context;
  if (worker < 0 || worker >= WORKERS || atomic_fetch_add(&t->inside[worker], 1) != 0)
    atomic_store(&t->wrong, true);
  for (size_t i = begin; i < end; i++) atomic_fetch_add(&t->seen[i], 1);
  if (worker >= 0 && worker < WORKERS) atomic_fetch_sub(&t->inside[worker], 1);
}

static bool all_once(tally *t, size_t count) {
  bool good = !atomic_load(&t->wrong);
  for (size_t i = 0; i < MOST; i++) good = good && atomic_load(&t->seen[i]) == (i < count);
  return good;
}

static void every_item_is_handled_once(void **state) {
  (void)state;
  tally t;
  for (int round = 0; round < 6000; round++) {
    size_t count = (size_t)(round * 7919) % MOST, block = 1 + (size_t)(round * 31) % 700;
    memset(&t, 0, sizeof t);
    scree_set_threads(1 + round % WORKERS);
    scree_parallel_for(count, block, count_items, &t);
    if (!all_once(&t, count)) fail_msg("round %d: %zu items in blocks of %zu", round, count, block);
  }
  scree_set_threads(0);
}

static void nest(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  tally *t = context;
  if (scree_worker_count() != 1) atomic_store(&t->wrong, true);
  for (size_t i = begin; i < end; i++) {
    tally *own = calloc(1, sizeof *own);
    scree_parallel_for(100, 3, count_items, own);
    if (!all_once(own, 100)) atomic_store(&t->wrong, true);
    free(own);
    atomic_fetch_add(&t->seen[i], 1);
  }
}

static void nested_loops_are_serial(void **state) {
  (void)state;
  tally t = {.wrong = false};
  scree_set_threads(3);
  scree_parallel_for(200, 7, nest, &t);
  assert_true(all_once(&t, 200));
  assert_int_equal(scree_worker_count(), 3);
  scree_set_threads(0);
}

static void *call_often(void *context) {
  bool *good = context;
  for (int round = 0; round < 500; round++) {
    tally t = {.wrong = false};
    scree_parallel_for(1000, 50, count_items, &t);
    *good = *good && all_once(&t, 1000);
  }
  return NULL;
}

static void several_threads_may_call(void **state) {
  (void)state;
  enum { CALLERS = 3 };
  pthread_t callers[CALLERS];
  bool good[CALLERS];
  scree_set_threads(4);
  for (int i = 0; i < CALLERS; i++) {
    good[i] = true;
    assert_int_equal(pthread_create(&callers[i], NULL, call_often, &good[i]), 0);
  }
  for (int i = 0; i < CALLERS; i++) {
    pthread_join(callers[i], NULL);
    assert_true(good[i]);
  }
  scree_set_threads(0);
}

static void a_forked_child_may_call(void **state) {
  (void)state;
  tally t = {.wrong = false};
  scree_set_threads(3);
  scree_parallel_for(MOST, 10, count_items, &t);
  pid_t child = fork();
  if (child == 0) {
    memset(&t, 0, sizeof t);
    scree_parallel_for(MOST, 10, count_items, &t);
    _exit(all_once(&t, MOST) ? 0 : 1);
  }
  int status = -1;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_int_equal(status, 0);
  scree_set_threads(0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_item_is_handled_once),
      cmocka_unit_test(nested_loops_are_serial),
      cmocka_unit_test(several_threads_may_call),
      cmocka_unit_test(a_forked_child_may_call),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
