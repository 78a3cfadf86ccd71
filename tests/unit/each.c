/* scree_choose_each: the same choices for any number of threads, and cancelling at any report:
 * either every object was handed over, or the answer is SCREE_CANCELLED. */
#include "support/check.h"
#include "support/shapes.h"

#include <stdatomic.h>

enum { OBJECTS = 3 };

typedef struct watch {
  scree_mesh ball;
  atomic_int handed;
  int reports, cancel_at; /* negative: never */
} watch;

static scree_status load(void *context, size_t index, const scree_progress *progress,
                         scree_mesh *mesh, scree_error *error) {
  const watch *w = context;
  (void)progress;
  scree_status status = scree_mesh_copy(&w->ball, mesh, error);
  for (size_t i = 0; status == SCREE_OK && i < 3 * mesh->vertex_count; i++)
    mesh->positions[i] *= (double)(1 + index);
  return status;
}

static scree_status done(void *context, size_t index, const scree_curve *curve,
                         const scree_choice *choice, const scree_set_choice *set,
                         scree_error *error) {
  watch *w = context;
  (void)index, (void)curve, (void)choice, (void)set, (void)error;
  atomic_fetch_add(&w->handed, 1);
  return SCREE_OK;
}

static bool report(void *context, const char *phase, double fraction) {
  watch *w = context;
  (void)phase, (void)fraction;
  return w->reports++ != w->cancel_at;
}

static scree_status choose(watch *w, scree_choice *choices, scree_set_choice *set) {
  scree_choice_job job = {.count = OBJECTS,
                          .simplify = scree_default_simplify_options(),
                          .options = scree_default_choice_options(),
                          .load = load,
                          .done = done,
                          .context = w};
  const scree_progress progress = {report, w, 0};
  scree_error error;
  atomic_store(&w->handed, 0);
  w->reports = 0;
  return scree_choose_each(&job, &progress, choices, set, &error);
}

static void cancelled_or_complete(void **state) {
  (void)state;
  watch w = {.ball = shape_icosphere(0.02, 2), .cancel_at = -1};
  size_t cancelled = 0;
  for (int threads = 1; threads <= 3; threads += 2) {
    scree_set_threads(threads);
    scree_status status = SCREE_CANCELLED;
    for (w.cancel_at = 0; status == SCREE_CANCELLED; w.cancel_at++) {
      scree_choice choices[OBJECTS];
      scree_set_choice set = {0};
      status = choose(&w, choices, &set);
      cancelled += status == SCREE_CANCELLED;
      if (status == SCREE_OK) assert_int_equal(atomic_load(&w.handed), OBJECTS);
      for (int i = 0; i < OBJECTS; i++) scree_choice_free(&choices[i]);
      scree_set_choice_free(&set);
    }
    assert_int_equal(status, SCREE_OK);
  }
  assert_true(cancelled > 2 * OBJECTS);
  scree_set_threads(0);
  scree_mesh_free(&w.ball);
}

static void same_for_any_number_of_threads(void **state) {
  (void)state;
  watch w = {.ball = shape_icosphere(0.02, 3), .cancel_at = -1};
  scree_choice first[OBJECTS], choices[OBJECTS];
  scree_set_choice first_set = {0}, set = {0};
  for (int threads = 1; threads <= 3; threads++) {
    scree_set_threads(threads);
    bool one = threads == 1;
    assert_int_equal(choose(&w, one ? first : choices, one ? &first_set : &set), SCREE_OK);
    if (one) continue;
    assert_memory_equal(&set.robust, &first_set.robust, sizeof set.robust);
    for (int i = 0; i < OBJECTS; i++) {
      assert_memory_equal(&choices[i].paper, &first[i].paper, sizeof first[i].paper);
      assert_memory_equal(&choices[i].robust, &first[i].robust, sizeof first[i].robust);
      scree_choice_free(&choices[i]);
    }
    scree_set_choice_free(&set);
  }
  for (int i = 0; i < OBJECTS; i++) scree_choice_free(&first[i]);
  scree_set_choice_free(&first_set);
  scree_set_threads(0);
  scree_mesh_free(&w.ball);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cancelled_or_complete),
                                     cmocka_unit_test(same_for_any_number_of_threads)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
