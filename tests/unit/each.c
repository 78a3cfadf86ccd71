/* scree_choose_each: objects that fail end it all, or are left out where that is asked for; the
 * same choices for any number of threads, and cancelling at any report: either every object was
 * handed over, or the answer is SCREE_CANCELLED. */
#include "support/check.h"
#include "support/shapes.h"

#include <stdatomic.h>

enum { OBJECTS = 3 };

typedef struct watch {
  scree_mesh ball;
  bool fails[OBJECTS], told[OBJECTS];
  scree_status how;
  atomic_int handed;
  int reports, cancel_at; /* negative: never */
} watch;

static scree_status load(void *context, size_t index, const scree_progress *progress,
                         scree_mesh *mesh, double *scale, scree_error *error) {
  const watch *w = context;
  (void)progress;
  if (w->fails[index]) {
    *error = (scree_error){w->how, "no mesh"};
    snprintf(error->message, sizeof error->message, "object %zu", index);
    return w->how;
  }
  *scale = (double)(1 + index);
  return scree_mesh_copy(&w->ball, mesh, error);
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

static void failed(void *context, size_t index, const scree_error *error) {
  watch *w = context;
  assert_int_equal(error->message[7], '0' + (int)index);
  assert_int_equal(atomic_load(&w->handed), 0);
  w->told[index] = true;
}

static scree_choice_job job_of(watch *w, bool goes_on) {
  return (scree_choice_job){
      OBJECTS, scree_default_simplify_options(), scree_default_choice_options(), load, done,
      w,       goes_on ? failed : NULL};
}

/* Bit i of `which`: object i fails. */
static void check_failures(watch *w, int which, bool goes_on, const scree_choice *whole) {
  scree_choice_job job = job_of(w, goes_on);
  scree_choice choices[OBJECTS];
  scree_set_choice set = {0};
  scree_error error;
  size_t first = OBJECTS, left = 0, ends = w->how == SCREE_OUT_OF_MEMORY;
  atomic_store(&w->handed, 0);
  for (size_t i = OBJECTS; i-- > 0;) {
    w->fails[i] = which >> i & 1;
    w->told[i] = false;
    first = w->fails[i] ? i : first;
    left += !w->fails[i];
  }
  scree_status status = scree_choose_each(&job, NULL, choices, &set, &error);
  bool expected = first == OBJECTS || (goes_on && left > 0 && !ends), told = goes_on && !ends;
  assert_int_equal(status, expected ? SCREE_OK : w->how);
  if (!expected) assert_int_equal(error.message[7], '0' + (int)first);
  assert_int_equal(atomic_load(&w->handed), expected ? left : 0);
  if (expected) assert_int_equal(set.object_count, left);
  for (size_t i = 0; i < OBJECTS; i++) {
    assert_true(w->told[i] == (told && w->fails[i]));
    assert_true((choices[i].levels != NULL) == (expected && !w->fails[i]));
    if (choices[i].levels)
      assert_memory_equal(&choices[i].robust, &whole[i].robust, sizeof whole[i].robust);
    scree_choice_free(&choices[i]);
  }
  scree_set_choice_free(&set);
}

static void what_fails_is_left_out(void **state) {
  (void)state;
  watch w = {.ball = shape_icosphere(0.02, 0), .how = SCREE_BAD_FILE, .cancel_at = -1};
  scree_choice_job job = job_of(&w, false);
  scree_choice whole[OBJECTS];
  scree_set_choice set;
  scree_error error;
  CHECK_OK(scree_choose_each(&job, NULL, whole, &set, &error), error);
  for (int i = 1; i < OBJECTS; i++) { /* each is scaled by its own factor */
    double square = (1 + i) * (1 + i);
    assert_true(fabs(whole[i].area - square * whole[0].area) < 1e-12 * whole[i].area);
    assert_int_equal(whole[i].robust.triangle_count, whole[0].robust.triangle_count);
  }
  scree_set_choice_free(&set);
  for (int threads = 1; threads <= 3; threads += 2) {
    scree_set_threads(threads);
    for (int which = 0; which < 1 << OBJECTS; which++) {
      w.how = SCREE_BAD_FILE;
      check_failures(&w, which, false, whole);
      check_failures(&w, which, true, whole);
      w.how = SCREE_OUT_OF_MEMORY;
      check_failures(&w, which, true, whole);
    }
  }
  for (int i = 0; i < OBJECTS; i++) scree_choice_free(&whole[i]);
  scree_set_threads(0);
  scree_mesh_free(&w.ball);
}

static scree_status choose(watch *w, scree_choice *choices, scree_set_choice *set) {
  scree_choice_job job = job_of(w, false);
  const scree_progress progress = {report, w, 0};
  scree_error error;
  atomic_store(&w->handed, 0);
  w->reports = 0;
  return scree_choose_each(&job, &progress, choices, set, &error);
}

static void cancelled_or_complete(void **state) {
  (void)state;
  watch w = {.ball = shape_icosphere(0.02, 0), .cancel_at = -1};
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
    assert_memory_equal(&set.paper, &first_set.paper, sizeof set.paper);
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
                                     cmocka_unit_test(what_fails_is_left_out),
                                     cmocka_unit_test(same_for_any_number_of_threads)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
