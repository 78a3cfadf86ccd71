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

static void count_items(void *context, scree_block block) {
  tally *t = context;
  if (block.worker < 0 || block.worker >= WORKERS ||
      atomic_fetch_add(&t->inside[block.worker], 1) != 0)
    atomic_store(&t->wrong, true);
  for (size_t i = block.begin; i < block.end; i++) atomic_fetch_add(&t->seen[i], 1);
  if (block.worker >= 0 && block.worker < WORKERS) atomic_fetch_sub(&t->inside[block.worker], 1);
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

static void nest(void *context, scree_block block) {
  tally *t = context;
  if (scree_worker_count() != 1) atomic_store(&t->wrong, true);
  for (size_t i = block.begin; i < block.end; i++) {
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

/* Chains of tasks, each ready when the one before has ended; at every tenth link all chains wait
 * for the last. What is left loose at a link is ready at once, and done when no chain goes on. */
enum { CHAINS = 3, LINKS = 60, MEET = 10, LOOSE = CHAINS * LINKS };

typedef struct chains {
  size_t links[CHAINS];  /* done */
  bool busy[CHAINS];     /* with the next one */
  size_t waiting, begun; /* loose ones: numbers from `begun` up to `waiting` */
  atomic_uchar seen[2 * LOOSE];
  atomic_int exclusive; /* in take or end */
  atomic_bool wrong;
  size_t fails_at; /* ends after which nothing is ready any more */
  size_t ends;
  int nested; /* workers that a loop within a task has */
} chains;

static void enter_exclusive(chains *c) {
  if (atomic_fetch_add(&c->exclusive, 1) != 0) atomic_store(&c->wrong, true);
}

static bool take_link(void *context, int worker, size_t *task) {
  chains *c = context;
  bool taken = false;
  enter_exclusive(c);
  if (worker < 0 || worker >= WORKERS) atomic_store(&c->wrong, true);
  size_t least = LINKS;
  for (size_t i = 0; i < CHAINS; i++)
    if (c->links[i] < least) least = c->links[i];
  for (size_t i = 0; i < CHAINS && !taken && c->ends < c->fails_at; i++) {
    size_t most = MEET * (least / MEET + 1);
    if (c->busy[i] || c->links[i] >= most || c->links[i] == LINKS) continue;
    c->busy[i] = taken = true;
    *task = i * LINKS + c->links[i];
  }
  if (!taken && c->begun < c->waiting && c->ends < c->fails_at) {
    *task = LOOSE + c->begun++;
    taken = true;
  }
  atomic_fetch_sub(&c->exclusive, 1);
  return taken;
}

static void do_link(void *context, size_t task) {
  chains *c = context;
  tally own = {.wrong = false};
  atomic_fetch_add(&c->seen[task], 1);
  if (scree_worker_count() != c->nested) atomic_store(&c->wrong, true);
  scree_parallel_for(1 + task % 50, 3, count_items, &own);
  if (!all_once(&own, 1 + task % 50)) atomic_store(&c->wrong, true);
}

static void end_link(void *context, size_t task) {
  chains *c = context;
  enter_exclusive(c);
  c->ends++;
  if (task < LOOSE) {
    size_t i = task / LINKS;
    if (!c->busy[i] || c->links[i] != task % LINKS) atomic_store(&c->wrong, true);
    c->busy[i] = false;
    c->links[i]++;
    c->waiting++;
  }
  atomic_fetch_sub(&c->exclusive, 1);
}

static const scree_tasks links = {take_link, do_link, end_link};

static void tasks_are_done_as_they_come_ready(void **state) {
  (void)state;
  for (int round = 0; round < 400; round++) {
    chains c = {.fails_at = SIZE_MAX};
    int threads = 1 + round % WORKERS;
    bool alone = round % 5 == 0; /* then a task's own loops have all threads */
    c.nested = alone ? threads : 1;
    scree_set_threads(threads);
    scree_parallel_tasks(alone ? 1 : WORKERS, &links, &c);
    assert_false(atomic_load(&c.wrong));
    for (size_t i = 0; i < 2 * (size_t)LOOSE; i++)
      if (atomic_load(&c.seen[i]) != 1) fail_msg("round %d: task %zu", round, i);
  }
  scree_set_threads(0);
}

/* Where none is ready any more, those under way are ended, and no others begun. */
static void tasks_may_stop_in_between(void **state) {
  (void)state;
  for (int round = 0; round < 200; round++) {
    chains c = {.fails_at = (size_t)round, .nested = 1};
    size_t begun = 0;
    scree_set_threads(1 + round % WORKERS);
    scree_parallel_tasks(WORKERS, &links, &c);
    for (size_t i = 0; i < 2 * (size_t)LOOSE; i++) begun += atomic_load(&c.seen[i]);
    assert_false(atomic_load(&c.wrong));
    assert_int_equal(begun, c.ends);
    assert_true(c.ends >= (size_t)round && c.ends < (size_t)round + WORKERS);
    for (size_t i = 0; i < CHAINS; i++) assert_false(c.busy[i]);
  }
  scree_set_threads(0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_item_is_handled_once),
      cmocka_unit_test(nested_loops_are_serial),
      cmocka_unit_test(several_threads_may_call),
      cmocka_unit_test(a_forked_child_may_call),
      cmocka_unit_test(tasks_are_done_as_they_come_ready),
      cmocka_unit_test(tasks_may_stop_in_between),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
